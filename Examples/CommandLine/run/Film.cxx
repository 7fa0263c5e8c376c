// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Film.h"

#include "CollectionFile.h"
#include "CommandLineOptions.h"
#include "FilmRecord.h"
#include "MessageCapture.h"
#include "OptionValue.h"
#include "OutputFile.h"
#include "ParticleSteps.h"
#include "RunStatistics.h"
#include "SafeText.h"
#include "Supervisor.h"
#include "SurfaceFile.h"
#include "SurfaceRun.h"

#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkSPHDerivatives.h"
#include "vtkSPHTemporalInterpolator.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include <unistd.h>

namespace
{

namespace fs = std::filesystem;

std::string Text(double value)
{
  std::ostringstream stream;
  stream << std::setprecision(12) << value;
  return stream.str();
}

/// The stored times, or those that were asked for.
std::vector<double> ListTimes(
  const CommandLineOptions& options, const std::vector<ParticleSteps::Step>& steps)
{
  std::vector<double> times = options.Times;
  for (std::size_t i = 0; options.Times.empty() && i < steps.size(); ++i)
  {
    times.push_back(steps[i].Time);
  }
  const double begin = steps.front().Time, end = steps.back().Time;
  for (double& time : times)
  {
    // 3 * 0.1 is meant to be 0.3.
    const auto nearest = std::min_element(steps.begin(), steps.end(),
      [&](const ParticleSteps::Step& a, const ParticleSteps::Step& b)
      { return std::abs(a.Time - time) < std::abs(b.Time - time); });
    const bool isStored = std::abs(nearest->Time - time) <= 1e-12 * (end - begin);
    time = isStored ? nearest->Time : time;
    if (time < begin || time > end)
    {
      throw UsageError("--times: " + Text(time) + " is outside of the steps' times, " +
        Text(begin) + " to " + Text(end));
    }
  }
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// "film.pvd" -> "film_0000.vtp", ...
std::vector<std::string> ListSurfaces(const std::string& output, std::size_t count)
{
  const std::string stem = output.substr(0, output.size() - std::string(".pvd").size());
  const int width = std::max(4, static_cast<int>(std::to_string(count - 1).size()));
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i)
  {
    std::ostringstream name;
    name << stem << "_" << std::setw(width) << std::setfill('0') << i << ".vtp";
    names.push_back(name.str());
  }
  return names;
}

/// No file is written over another, and none over one that is no step of an older film: nobody named
/// these files.
void CheckFiles(const CommandLineOptions& options, const std::vector<ParticleSteps::Step>& steps,
  const std::vector<std::string>& surfaces)
{
  if (Printable(options.Output) != options.Output)
  {
    throw UsageError(options.Output + " has characters in its name that a .pvd file cannot hold");
  }
  std::vector<std::string> inputs = options.Inputs, outputs = surfaces;
  for (const ParticleSteps::Step& step : steps)
  {
    inputs.insert(inputs.end(), step.Files.begin(), step.Files.end());
  }
  outputs.push_back(options.Output);
  if (!options.StatisticsFile.empty())
  {
    outputs.push_back(options.StatisticsFile);
  }
  try
  {
    CheckOutputs(inputs, outputs);
  }
  catch (const std::invalid_argument& error)
  {
    throw UsageError(error.what());
  }
  for (const std::string& surface : surfaces)
  {
    std::error_code error;
    if (fs::exists(fs::symlink_status(surface, error)) && !IsFilmSurface(surface))
    {
      throw UsageError(surface +
        " is there already, and is no step of a film; choose another name "
        "for the film, or remove the file");
    }
  }
}

class Film
{
public:
  Film(const CommandLineOptions& options, FilmRecord& record, MessageCapture* messages)
    : Options(options)
    , Record(record)
    , Messages(messages)
    , Steps(ListSteps(options, messages))
    , Times(ListTimes(options, this->Steps))
    , Surfaces(ListSurfaces(options.Output, this->Times.size()))
    , Made(record.Read())
  {
    ShowProgress(this->Filter, this->Options, &this->Progress);
  }

  bool Make(int first)
  {
    if (first == 0)
    {
      CheckFiles(this->Options, this->Steps, this->Surfaces);
    }
    else
    {
      this->Fail(static_cast<std::size_t>(first - 1), LastEnd());
    }
    this->Connect();
    for (std::size_t i = static_cast<std::size_t>(first); i < this->Times.size(); ++i)
    {
      BeginPart(static_cast<int>(i));
      const Activity making(this->Label(i) + ": the run failed",
        "the OpenCL driver may be at fault, or memory ran out");
      try
      {
        this->MakeStep(i);
      }
      catch (const std::runtime_error& error)
      {
        this->EndProgress();
        Say(this->Label(i) + ": " + error.what());
        this->Fail(i, error.what());
        this->Connect(); // nothing is left of what failed halfway
      }
    }
    BeginPart(-1);
    if (!this->Options.StatisticsFile.empty())
    {
      std::cout.flush(); // the file may be /dev/stdout
      WriteOutput(this->Options.StatisticsFile, FilmAsJson(this->Options, this->Made));
    }
    return std::all_of(this->Made.begin(), this->Made.end(),
      [](const FilmStep& step) { return step.Error.empty(); });
  }

private:
  std::string Label(std::size_t i) const
  {
    return this->Surfaces[i] + " (time " + Text(this->Times[i]) + ")";
  }

  void EndProgress() const
  {
    if (ShowsProgress(this->Options))
    {
      std::fputs("\r\033[K", stderr);
    }
  }

  void Connect()
  {
    vtkNew<ParticleSteps> source;
    vtkNew<vtkSPHTemporalInterpolator> interpolator;
    source->SetSteps(this->Steps, this->Messages);
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
    for (std::size_t k = 0; k < this->Steps.size(); ++k)
    {
      const bool isThis = this->Steps[k].Time == step.Time;
      const bool isBefore = k + 1 < this->Steps.size() &&
        this->Steps[k].Time<step.Time&& this->Steps[k + 1].Time> step.Time;
      const bool isAfter =
        k > 0 && this->Steps[k].Time > step.Time && this->Steps[k - 1].Time < step.Time;
      if (isThis || isBefore || isAfter)
      {
        step.Inputs.insert(
          step.Inputs.end(), this->Steps[k].Files.begin(), this->Steps[k].Files.end());
      }
    }
    return step;
  }

  void Fail(std::size_t i, const std::string& sentence)
  {
    FilmStep step = this->Describe(i);
    step.Error = sentence;
    step.Statistics = StepAsJson(step, nullptr, 0.0);
    this->Add(step);
  }

  void Add(const FilmStep& step)
  {
    this->Record.Add(step);
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
    this->Progress = "step " + std::to_string(i + 1) + " of " + std::to_string(this->Times.size()) +
      ", time " + Text(this->Times[i]) + ": ";
    std::vector<std::string> warnings;
    const vtkSmartPointer<vtkPointSet> particles = this->ParticlesAt(this->Times[i], warnings);
    SetUpFilter(this->Filter, this->Options, particles, this->Derivatives);
    this->Filter->KeepDeviceDataOn(); // the next step takes the buffers of this one
    const Run run = Extract(this->Filter, this->Options, this->Messages);
    for (const std::string& warning : Warnings(run.Surface, run.Statistics, this->Messages))
    {
      warnings.push_back(warning);
    }
    if (i == 0)
    {
      AddHintOfPeriod(this->Options, particles, warnings);
    }
    WriteFilmSurface(this->Surfaces[i], run.Surface, this->Messages);
    FilmStep step = this->Describe(i);
    step.Statistics = StepAsJson(step, run.Statistics, run.WallSeconds);
    step.Setting = SettingAsJson(this->Options, run.Statistics);
    this->Add(step);
    this->List();
    if (!this->Options.Quiet)
    {
      std::cout << Printable(this->Label(i)) << ": " << run.Surface->GetNumberOfPoints()
                << " points, " << run.Surface->GetNumberOfPolys() << " triangles, "
                << std::setprecision(3) << run.WallSeconds << " s" << std::endl;
    }
    for (const std::string& warning : warnings)
    {
      Say("warning: " + this->Label(i) + ": " + warning);
    }
  }

  /// All surfaces so far: the film can be looked at while it grows, and where the program is ended.
  void List() const
  {
    std::vector<CollectionEntry> entries;
    for (const FilmStep& step : this->Made)
    {
      if (step.Error.empty())
      {
        entries.push_back({ step.Time, step.Output });
      }
    }
    WriteOutput(this->Options.Output, CollectionText(entries));
  }

  const CommandLineOptions& Options;
  FilmRecord& Record;
  MessageCapture* const Messages;
  const std::vector<ParticleSteps::Step> Steps;
  const std::vector<double> Times;
  const std::vector<std::string> Surfaces;
  std::vector<FilmStep> Made;
  std::string Progress;
  vtkNew<vtkMarchingCorrectors> Filter;  // for all steps, with its program and its buffers
  vtkNew<vtkSPHDerivatives> Derivatives; // its device and buffers, too, are those of all steps
  vtkSmartPointer<ParticleSteps> Source;
  vtkSmartPointer<vtkSPHTemporalInterpolator> Interpolator;
};

}

//------------------------------------------------------------------------------
bool MakeFilm(
  const CommandLineOptions& options, int first, FilmRecord& record, MessageCapture* messages)
{
  return Film(options, record, messages).Make(first);
}
