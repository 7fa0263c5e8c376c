// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "CollectionFile.h"
#include "ColorScale.h"
#include "DataFile.h"
#include "Ending.h"
#include "Extra.h"
#include "FileName.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OptionValue.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "ParticleTimes.h"
#include "Picture.h"
#include "RunStatistics.h"
#include "Runs.h"
#include "SafeText.h"
#include "Sharing.h"

#include "vtkImageData.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace
{

namespace fs = std::filesystem;

/// "film.pvd" -> "film_0000.vtp", ...; "film_%04d.ply" -> "film_0000.ply", ...
std::vector<std::string> ListSurfaces(const Job& job, std::size_t count)
{
  const std::string& output = job.Output;
  std::string stem, name = output;
  if (IsCollectionFile(output))
  {
    const std::size_t width = std::max<std::size_t>(4, std::to_string(count - 1).size());
    stem = output.substr(0, output.size() - std::string(".pvd").size());
    name = "_%0" + std::to_string(width) + "d" + (job.Has("--project") ? ".vti" : ".vtp");
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i)
  {
    names.push_back(stem + NameOfStep(name, i));
  }
  return names;
}

/// No file is written over another, and, beside a .pvd file, none over one that is no step of an
/// older film: nobody named these.
void CheckFiles(const Job& job, const std::vector<std::string>& stored,
  const std::vector<std::string>& surfaces, MessageCapture* messages)
{
  if (Printable(job.Output) != job.Output)
  {
    throw UsageError(job.Output + " has characters in its name that a .pvd file cannot hold");
  }
  std::vector<std::string> inputs = job.InputFiles(), outputs = surfaces;
  inputs.insert(inputs.end(), stored.begin(), stored.end());
  for (std::size_t i = 0; !job.Picture.File.empty() && i < surfaces.size(); ++i)
  {
    outputs.push_back(NameOfStep(job.Picture.File, i));
  }
  outputs.insert(outputs.end(),
    { job.StatisticsFile, job.ComponentFile, job.NumbersFile,
      IsCollectionFile(job.Output) ? job.Output : "" });
  CheckOutputs(ListFiles(inputs, messages), outputs);
  for (const std::string& surface : surfaces)
  {
    std::error_code error;
    if (IsCollectionFile(job.Output) && fs::exists(fs::symlink_status(surface, error)) &&
      !IsFilmStep(surface))
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
  Film(const Job& job, MessageCapture* messages, Sharing& sharing)
    : Options(job)
    , Messages(messages)
    , Shared(sharing)
    , Times(job, messages)
    , Surfaces(ListSurfaces(job, this->Times.Get().size()))
    , Colors(job.Picture)
    , FrameColors(job.Picture)
    , Pieces(job)
    , Numbers(job)
    , ListFile(job.Output)
    , PieceFile(job.ComponentFile)
    , NumberFile(job.NumbersFile)
  {
    sharing.OnFirst([&] { CheckFiles(job, this->Times.ListFiles(), this->Surfaces, messages); });
    if (!job.Picture.File.empty())
    {
      this->Drawn = LoadExtra().NewPicture(job.Picture);
    }
  }

  bool Make()
  {
    bool isGood = true;
    for (std::size_t i = 0; i < this->Times.Get().size(); ++i)
    {
      const Activity making(
        this->Label(i) + ": the run failed", FaultsOfDrivers(this->Options.Surface->GetDevice()));
      isGood = this->TryStep(i) && isGood;
    }
    this->Shared.OnFirst(
      [this]
      {
        this->List(true);
        this->Said.TellCounts();
        this->WriteStatistics();
      });
    return isGood;
  }

private:
  std::string Label(std::size_t i) const
  {
    return this->Surfaces[i] + " (time " + TimeText(this->Times.Get()[i]) + ")";
  }

  bool TryStep(std::size_t i)
  {
    const std::string sentence = FailureOf([&] { this->MakeStep(i); });
    if (sentence.empty())
    {
      return true;
    }
    if (ShowsProgress(this->Options))
    {
      std::fputs("\r\033[K", stderr);
    }
    this->Tell("", i, sentence);
    FilmStep step = this->Describe(i);
    step.Error = sentence;
    this->Add(step, StepAsJson(step, nullptr, 0.0));
    this->Times.Reset();
    return false;
  }

  void Tell(const std::string& kind, std::size_t i, const std::string& sentence)
  {
    if (this->Shared.IsFirst())
    {
      this->Said.Tell(kind, this->Label(i), sentence);
    }
  }

  /// Describes a step without its statistics.
  FilmStep Describe(std::size_t i) const
  {
    FilmStep step;
    step.Time = this->Times.Get()[i];
    step.Output = this->Surfaces[i];
    step.Inputs = this->Times.ListFiles(step.Time);
    return step;
  }

  /// Keeps what was made of a step. The statistics of many are kept where somebody wants them only.
  void Add(FilmStep step, const std::string& statistics)
  {
    if (!this->Options.StatisticsFile.empty())
    {
      step.Statistics = statistics;
    }
    this->Made.push_back(step);
  }

  void MakeStep(std::size_t i)
  {
    const double time = this->Times.Get()[i];
    const std::string progress = "step " + std::to_string(i + 1) + " of " +
      std::to_string(this->Times.Get().size()) + ", time " + TimeText(time) + ": ";
    std::vector<std::string> warnings;
    const vtkSmartPointer<vtkPointSet> particles = this->Shared.Read(this->Times, time, warnings);
    this->Options.Has("--project") ? this->MakeImage(i, particles, progress, warnings)
                                   : this->MakeSurface(i, particles, progress, warnings);
    for (const std::string& warning : warnings)
    {
      this->Tell("warning: ", i, warning);
    }
  }

  void MakeImage(std::size_t i, vtkPointSet* particles, const std::string& progress,
    std::vector<std::string>& warnings)
  {
    const double seconds =
      Project(this->Options, particles, this->Messages, this->Shared, progress);
    this->Messages->AppendWarnings(warnings);
    this->Shared.OnFirst(
      [&]
      {
        vtkImageData* image = SeenImage(this->Options);
        const int* size = image->GetDimensions();
        this->Write(i, DataSetBytes(this->Surfaces[i], image, this->Messages),
          [&](const std::string& frame) {
            return DrawProjection(
              this->Options, frame, *this->Drawn, this->FrameColors, this->Messages);
          });
        this->Add(this->Describe(i), "");
        this->List(false);
        std::ostringstream what;
        what << size[0] << " x " << size[1] << " x " << size[2] << " pixels, ";
        this->TellStep(i, what.str(), seconds);
      });
  }

  void MakeSurface(std::size_t i, vtkPointSet* particles, const std::string& progress,
    std::vector<std::string>& warnings)
  {
    const double time = this->Times.Get()[i];
    Run run;
    this->Shared.OnAll(
      [&]
      {
        SetUpSurface(this->Options, particles);
        run = Extract(this->Options, this->Messages, progress);
      });
    for (const std::string& warning : Warnings(run, this->Messages))
    {
      warnings.push_back(warning);
    }
    this->Shared.OnAll([&] { this->Pieces.Add(run, particles, this->Messages, time); });
    if (const vtkSmartPointer<vtkPolyData> whole = this->Shared.Merge(run.Surface))
    {
      run.Surface = whole;
    }
    this->Shared.OnAll([&] { this->Numbers.Add(run, particles, this->Messages, time, warnings); });
    this->Shared.OnFirst([&] { this->Keep(i, run, particles, warnings); });
  }

  /// Writes what was made of a step.
  void Keep(
    std::size_t i, const Run& run, vtkPointSet* particles, std::vector<std::string>& warnings)
  {
    if (i == 0)
    {
      AddHintOfPeriod(this->Options, particles, warnings);
    }
    vtkPolyData* surface = run.Surface;
    const std::string& file = this->Surfaces[i];
    this->Colors.Include(surface);
    this->Write(i, SurfaceBytes(file, surface, this->Colors, this->Messages),
      [&](const std::string& frame)
      {
        this->FrameColors.Suggest(surface, this->Options.Surface->GetIsoValueArrayName());
        this->FrameColors.Include(surface);
        return this->Drawn->Draw(frame, surface, particles, this->FrameColors, this->Messages);
      });
    const std::string lost =
      LostArrays(file, surface, this->Colors, ArraysWithoutPlace(this->Options, particles));
    warnings.insert(warnings.end(), lost.empty() ? 0 : 1, lost);
    this->Last = run.Statistics;
    const FilmStep step = this->Describe(i);
    this->Add(step, StepAsJson(step, run.Statistics, run.WallSeconds));
    this->List(false);
    const vtkIdType triangles = surface->GetNumberOfPolys(),
                    lines = triangles > 0 ? 0 : surface->GetNumberOfLines();
    std::ostringstream what;
    what << surface->GetNumberOfPoints() << " points, " << (lines > 0 ? lines : triangles)
         << (lines > 0 ? " lines, " : " triangles, ");
    this->TellStep(i, what.str(), run.WallSeconds);
  }

  void TellStep(std::size_t i, const std::string& what, double seconds) const
  {
    if (!this->Options.Quiet)
    {
      std::cout << Printable(this->Label(i)) << ": " << what << std::setprecision(3) << seconds
                << " s" << std::endl;
    }
  }

  /// The step's file and picture, both or none.
  void Write(std::size_t i, const std::string& bytes,
    const std::function<std::string(const std::string& frame)>& draw)
  {
    OutputFiles files;
    files.Write(
      this->Surfaces[i], IsCollectionFile(this->Options.Output) ? MarkedStep(bytes) : bytes);
    if (this->Drawn)
    {
      const std::string frame = NameOfStep(this->Options.Picture.File, i);
      files.Write(frame, draw(frame));
    }
    files.Commit();
  }

  std::string ListText() const
  {
    std::vector<CollectionEntry> entries;
    for (const FilmStep& step : this->Made)
    {
      if (step.Error.empty())
      {
        entries.push_back({ step.Time, step.Output, "" });
      }
    }
    return CollectionText(entries);
  }

  /// The lists and tables of all surfaces so far.
  void List(bool isLast)
  {
    if (std::all_of(this->Made.begin(), this->Made.end(),
          [](const FilmStep& step) { return !step.Error.empty(); }))
    {
      return;
    }
    if (IsCollectionFile(this->Options.Output))
    {
      this->ListFile.Write([this] { return this->ListText(); }, isLast);
    }
    if (!this->Options.ComponentFile.empty())
    {
      this->PieceFile.Write([this] { return this->Pieces.Text(); }, isLast);
    }
    if (!this->Options.NumbersFile.empty())
    {
      this->NumberFile.Write([this] { return this->Numbers.Text(); }, isLast);
    }
  }

  void WriteStatistics() const
  {
    if (!this->Options.StatisticsFile.empty())
    {
      std::cout.flush(); // the file may be /dev/stdout
      WriteOutput(this->Options.StatisticsFile, FilmAsJson(this->Options, this->Made, this->Last));
    }
  }

  const Job& Options;
  MessageCapture* const Messages;
  Sharing& Shared;
  ParticleTimes Times;
  const std::vector<std::string> Surfaces;
  std::vector<FilmStep> Made;
  vtkSmartPointer<vtkFieldData> Last; ///< of the last one that went well
  Sentences Said;
  ColorScale Colors, FrameColors;
  ComponentTable Pieces;
  FilmNumbers Numbers;
  GrowingFile ListFile, PieceFile, NumberFile;
  std::unique_ptr<Picture> Drawn; ///< where pictures are asked for
};

}

bool MakeFilm(const Job& job, MessageCapture* messages, Sharing& sharing)
{
  job.Surface->KeepDeviceDataOn(); // the next step takes the buffers of this one
  return Film(job, messages, sharing).Make();
}
