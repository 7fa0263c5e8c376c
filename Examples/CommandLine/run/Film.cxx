// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Film.h"

#include "CollectionFile.h"
#include "ColorScale.h"
#include "ComponentRun.h"
#include "Ending.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OptionValue.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "ParticleSteps.h"
#include "Picture.h"
#include "RunStatistics.h"
#include "SafeText.h"
#include "Sentences.h"
#include "StepName.h"
#include "SurfaceFile.h"
#include "SurfaceRun.h"

#include "vtkNew.h"
#include "vtkSPHTemporalInterpolator.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace
{

namespace fs = std::filesystem;
using Steps = std::vector<ParticleSteps::Step>;
using Clock = std::chrono::steady_clock;

std::string Text(double value)
{
  std::ostringstream stream;
  stream << std::setprecision(12) << value;
  return stream.str();
}

/// The stored times, or those that were asked for.
std::vector<double> ListTimes(const Job& job, const Steps& steps)
{
  std::vector<double> times = job.Times;
  for (std::size_t i = 0; job.Times.empty() && i < steps.size(); ++i)
  {
    times.push_back(steps[i].Time);
  }
  const double begin = steps.front().Time, end = steps.back().Time;
  for (double& time : times)
  {
    // 3 * 0.1 is meant to be 0.3.
    const double tolerance = 1e-12 * (end - begin);
    const auto next = FindStep(steps, time - tolerance);
    if (next != steps.end() && next->Time <= time + tolerance)
    {
      time = next->Time;
    }
    if (time < begin || time > end)
    {
      throw UsageError("--times: " + Text(time) + " is outside the times of the steps, " +
        Text(begin) + " to " + Text(end));
    }
  }
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// "film.pvd" -> "film_0000.vtp", ...; "film_%04d.ply" -> "film_0000.ply", ...
std::vector<std::string> ListSurfaces(const std::string& output, std::size_t count)
{
  std::string stem, name = output;
  if (IsCollectionFile(output))
  {
    const std::size_t width = std::max<std::size_t>(4, std::to_string(count - 1).size());
    stem = output.substr(0, output.size() - std::string(".pvd").size());
    name = "_%0" + std::to_string(width) + "d.vtp";
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i)
  {
    names.push_back(stem + NameOfStep(name, i));
  }
  return names;
}

/// No file is written over another, and, beside a .pvd file, none over one that is no step of an older
/// film: nobody named these.
void CheckFiles(const Job& job, const Steps& steps, const std::vector<std::string>& surfaces,
  MessageCapture* messages)
{
  if (Printable(job.Output) != job.Output)
  {
    throw UsageError(job.Output + " has characters in its name that a .pvd file cannot hold");
  }
  std::vector<std::string> inputs = job.Inputs, outputs = surfaces;
  for (const ParticleSteps::Step& step : steps)
  {
    inputs.insert(inputs.end(), step.Files.begin(), step.Files.end());
  }
  for (std::size_t i = 0; !job.Picture.File.empty() && i < surfaces.size(); ++i)
  {
    outputs.push_back(NameOfStep(job.Picture.File, i));
  }
  if (!job.StatisticsFile.empty())
  {
    outputs.push_back(job.StatisticsFile);
  }
  if (!job.ComponentFile.empty())
  {
    outputs.push_back(job.ComponentFile);
  }
  if (IsCollectionFile(job.Output))
  {
    outputs.push_back(job.Output);
  }
  CheckOutputs(ListFiles(inputs, messages), outputs);
  for (const std::string& surface : surfaces)
  {
    std::error_code error;
    if (IsCollectionFile(job.Output) && fs::exists(fs::symlink_status(surface, error)) &&
      !IsFilmSurface(surface))
    {
      throw UsageError(surface +
        " already exists and is not a step of a film; choose another name "
        "for the film, or remove the file");
    }
  }
}

class Film
{
public:
  Film(const Job& job, MessageCapture* messages)
    : Options(job)
    , Messages(messages)
    , Stored(ListSteps(job, messages))
    , Times(ListTimes(job, this->Stored))
    , Surfaces(ListSurfaces(job.Output, this->Times.size()))
    , Colors(job.Picture)
    , Pieces(job)
  {
    CheckFiles(job, this->Stored, this->Surfaces, messages);
    if (!job.Picture.File.empty())
    {
      this->Drawn.reset(new Picture(job.Picture));
    }
  }

  bool Make()
  {
    this->Connect();
    bool isGood = true;
    for (std::size_t i = 0; i < this->Times.size(); ++i)
    {
      const Activity making(this->Label(i) + ": the run failed",
        "the OpenCL driver may be at fault, or memory ran out");
      isGood = this->TryStep(i) && isGood;
    }
    this->List(true);
    this->Said.TellCounts();
    if (!this->Pieces.Text().empty())
    {
      WriteOutput(this->Options.ComponentFile, this->Pieces.Text());
    }
    if (!this->Options.StatisticsFile.empty())
    {
      std::cout.flush(); // the file may be /dev/stdout
      WriteOutput(
        this->Options.StatisticsFile, FilmAsJson(this->Options, this->Made, this->Setting));
    }
    return isGood;
  }

private:
  std::string Label(std::size_t i) const
  {
    return this->Surfaces[i] + " (time " + Text(this->Times[i]) + ")";
  }

  bool TryStep(std::size_t i)
  {
    std::string sentence = "host memory ran out";
    try
    {
      this->MakeStep(i);
      return true;
    }
    catch (const std::bad_alloc&)
    {
    }
    catch (const std::exception& error)
    {
      sentence = error.what();
    }
    if (ShowsProgress(this->Options))
    {
      std::fputs("\r\033[K", stderr);
    }
    this->Said.Tell("", this->Label(i), sentence);
    FilmStep step = this->Describe(i);
    step.Error = sentence;
    this->Add(step, StepAsJson(step, nullptr, 0.0));
    this->Connect(); // nothing is left of what failed halfway
    return false;
  }

  void Connect()
  {
    vtkNew<ParticleSteps> source;
    vtkNew<vtkSPHTemporalInterpolator> interpolator;
    source->SetSteps(&this->Stored, this->Messages);
    interpolator->SetInputConnection(source->GetOutputPort());
    this->Source = source;
    this->Interpolator = interpolator;
  }

  /// Without its statistics.
  FilmStep Describe(std::size_t i) const
  {
    FilmStep step;
    step.Time = this->Times[i];
    step.Output = this->Surfaces[i];
    const auto next = FindStep(this->Stored, step.Time);
    for (auto used = next->Time == step.Time ? next : next - 1; used <= next; ++used)
    {
      step.Inputs.insert(step.Inputs.end(), used->Files.begin(), used->Files.end());
    }
    return step;
  }

  /// What was made of a step. The statistics of many are kept where somebody wants them only.
  void Add(FilmStep step, const std::string& statistics)
  {
    if (!this->Options.StatisticsFile.empty())
    {
      step.Statistics = statistics;
    }
    this->Made.push_back(step);
  }

  vtkSmartPointer<vtkPointSet> ParticlesAt(double time, std::vector<std::string>& warnings)
  {
    this->Messages->Clear();
    this->Source->ClearError();
    this->Interpolator->UpdateTimeStep(time);
    std::string error = this->Source->GetError();
    error = error.empty() ? this->Interpolator->GetErrorMessage() : error;
    if (!error.empty() || !this->Messages->GetErrors().empty())
    {
      throw std::runtime_error(error.empty() ? this->Messages->GetErrors().front() : error);
    }
    warnings = this->Messages->GetWarnings();
    auto particles = vtkSmartPointer<vtkPolyData>::New();
    particles->ShallowCopy(this->Interpolator->GetOutput());
    return particles;
  }

  void MakeStep(std::size_t i)
  {
    const std::string progress = "step " + std::to_string(i + 1) + " of " +
      std::to_string(this->Times.size()) + ", time " + Text(this->Times[i]) + ": ";
    std::vector<std::string> warnings;
    const vtkSmartPointer<vtkPointSet> particles = this->ParticlesAt(this->Times[i], warnings);
    SetUpSurface(this->Options, particles);
    Run run = Extract(this->Options, this->Messages, progress);
    this->Pieces.Add(run, particles, this->Messages, this->Times[i]);
    for (const std::string& warning : Warnings(run.Surface, run.Statistics, this->Messages))
    {
      warnings.push_back(warning);
    }
    if (i == 0)
    {
      AddHintOfPeriod(this->Options, particles, warnings);
    }
    this->Write(i, run.Surface, particles, warnings);
    this->Setting = SettingAsJson(this->Options, run.Statistics);
    const FilmStep step = this->Describe(i);
    this->Add(step, StepAsJson(step, run.Statistics, run.WallSeconds));
    this->List(false);
    if (!this->Options.Quiet)
    {
      std::cout << Printable(this->Label(i)) << ": " << run.Surface->GetNumberOfPoints()
                << " points, " << run.Surface->GetNumberOfPolys() << " triangles, "
                << std::setprecision(3) << run.WallSeconds << " s" << std::endl;
    }
    for (const std::string& warning : warnings)
    {
      this->Said.Tell("warning: ", this->Label(i), WithOptions(this->Options, warning));
    }
  }

  /// The step's surface and picture, both or none.
  void Write(
    std::size_t i, vtkPolyData* surface, vtkPointSet* particles, std::vector<std::string>& warnings)
  {
    const std::string& file = this->Surfaces[i];
    this->Colors.Include(surface);
    OutputFiles files;
    files.Write(file,
      IsCollectionFile(this->Options.Output)
        ? FilmSurfaceBytes(file, surface, this->Messages)
        : SurfaceBytes(file, surface, this->Colors, this->Messages));
    if (this->Drawn)
    {
      const std::string frame = NameOfStep(this->Options.Picture.File, i);
      files.Write(
        frame, this->Drawn->Draw(frame, surface, particles, this->Colors, this->Messages));
    }
    files.Commit();
    const std::string lost = LostArrays(file, surface, this->Colors);
    if (!lost.empty())
    {
      warnings.push_back(lost);
    }
  }

  /// All surfaces so far: the film can be looked at while it grows, and where the program is ended. The
  /// list of a long film is not written after each step, but as often as it takes a twentieth of the time.
  void List(bool isLast)
  {
    const auto begin = Clock::now();
    if (!IsCollectionFile(this->Options.Output) || this->Made.size() == this->Listed ||
      (!isLast && begin < this->NextList))
    {
      return;
    }
    std::vector<CollectionEntry> entries;
    for (const FilmStep& step : this->Made)
    {
      if (step.Error.empty())
      {
        entries.push_back({ step.Time, step.Output });
      }
    }
    if (!entries.empty())
    {
      WriteOutput(this->Options.Output, CollectionText(entries));
    }
    this->Listed = this->Made.size();
    this->NextList = Clock::now() + 19 * (Clock::now() - begin);
  }

  const Job& Options;
  MessageCapture* const Messages;
  const Steps Stored;
  const std::vector<double> Times;
  const std::vector<std::string> Surfaces;
  std::vector<FilmStep> Made;
  std::string Setting;    ///< of the last one that went well
  std::size_t Listed = 0; ///< how many of them the list knows of
  Clock::time_point NextList;
  Sentences Said;
  ColorScale Colors;
  ComponentTable Pieces;
  std::unique_ptr<Picture> Drawn; ///< where pictures are asked for
  vtkSmartPointer<ParticleSteps> Source;
  vtkSmartPointer<vtkSPHTemporalInterpolator> Interpolator;
};

}

//------------------------------------------------------------------------------
bool MakeFilm(const Job& job, MessageCapture* messages)
{
  job.Surface->KeepDeviceDataOn(); // the next step takes the buffers of this one
  return Film(job, messages).Make();
}
