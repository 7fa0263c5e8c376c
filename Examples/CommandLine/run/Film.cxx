// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ColorScale.h"
#include "DataFile.h"
#include "Extra.h"
#include "Failures.h"
#include "Job.h"
#include "OutputFile.h"
#include "ParticleTimes.h"
#include "Runs.h"
#include "Text.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSPHSay.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <utility>

namespace
{

namespace fs = std::filesystem;

/// Lists the files of the steps: film_0000.vtp (or .vti), ... for film.pvd; film_0000.ply, ... for film_%04d.ply.
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

/// Makes an empty image, which has the place and size of the image `like`, for a step of which no particle
/// lies there. All values are 0, or NaN if the image shows a mean.
vtkSmartPointer<vtkImageData> EmptyImage(const Job& job, vtkImageData* like)
{
  auto empty = vtkSmartPointer<vtkImageData>::New();
  empty->CopyStructure(like);
  vtkNew<vtkDoubleArray> values;
  values->SetName(like->GetPointData()->GetScalars()->GetName());
  values->SetNumberOfTuples(empty->GetNumberOfPoints());
  values->FillValue(job.Has("--weighted-by") ? NAN : 0.0);
  empty->GetPointData()->SetScalars(values);
  return empty;
}

/// Makes a surface, or an image, for each time, with the lists, tables and pictures that belong to them.
class Film
{
public:
  explicit Film(Sharing& sharing)
    : Shared(sharing)
    , Options(sharing.Options)
    , Times(sharing)
    , Surfaces(ListSurfaces(Options, Times.Get().size()))
    , IsListed(IsCollectionFile(Options.Output))
    , Colors(Options.Picture)
    , FrameColors(Options.Picture)
    , ListFile(IsListed ? Options.Output : "")
    , PieceFile(Options.Text("--components"))
    , NumberFile(Options.Text("--numbers"))
  {
    const Job& job = this->Options;
    if (job.Has("--numbers"))
    {
      AddPlaces(job);
    }
    std::vector<std::string> outputs = this->Surfaces;
    for (std::size_t i = 0; !job.Picture.File.empty() && i < this->Surfaces.size(); ++i)
    {
      outputs.push_back(NameOfStep(job.Picture.File, i));
    }
    outputs.insert(outputs.end(),
      { job.Text("--stats"), job.Text("--components"), job.Text("--numbers"),
        this->IsListed ? job.Output : "" });
    sharing.OnFirst(
      [&]
      {
        this->Times.CheckFiles(outputs);
        Need(Printable(job.Output) == job.Output,
          job.Output + " has characters in its name that a .pvd file cannot hold");
        // The user has not named the files beside a .pvd file, so each must be new, or a step of an
        // older film.
        for (const std::string& surface : this->Surfaces)
        {
          std::error_code error;
          Need(!this->IsListed || !fs::exists(fs::symlink_status(surface, error)) ||
              IsFilmStep(surface),
            vtkSPHSay(MCOR_SAY(FILM_STEP_TAKEN), surface.c_str()));
        }
      });
    if (!job.Picture.File.empty())
    {
      this->Drawn = LoadExtra().NewPicture(job.Picture);
    }
  }

  bool Make()
  {
    const bool isGood = this->Times.ForEach(
      this->Surfaces,
      [this](Moment& moment)
      { this->Options.Has("--project") ? this->MakeImage(moment) : this->MakeSurface(moment); },
      [this](const Moment& moment) { this->Report(moment, nullptr, 0.0); });
    this->Shared.OnFirst(
      [this]
      {
        if (!this->Waiting.empty()) // all steps wait: no particle was seen
        {
          SeenImage(this->Options);
        }
        this->List(true);
        if (this->Options.Has("--stats"))
        {
          std::cout.flush(); // the file may be /dev/stdout
          WriteOutput(
            this->Options.Text("--stats"), FilmAsJson(this->Options, this->Reports, this->Last));
        }
      });
    return isGood;
  }

private:
  using Moment = ParticleTimes::Moment;

  void MakeImage(Moment& moment)
  {
    vtkSPHProjection* projection = this->Options.Projection;
    const double seconds = Evaluate(this->Shared, moment.Particles, nullptr, moment.Progress);
    Messages().AddWarningsTo(moment.Warnings);
    this->Shared.OnFirst(
      [&]
      {
        vtkImageData* image = projection->GetImage();
        const bool isSeen = image->GetNumberOfPoints() > 0 && image->GetPointData()->GetScalars();
        this->Waiting.emplace_back(moment, seconds);
        this->Waiting.back().first.Particles = nullptr; // many steps may wait
        if (isSeen)
        {
          this->Empty = EmptyImage(this->Options, image);
        }
        if (this->Empty)
        {
          for (const auto& [step, cost] : std::exchange(this->Waiting, {}))
          {
            const bool isOwn = isSeen && step.Number == moment.Number;
            vtkImageData* shown = isOwn ? image : this->Empty.Get();
            this->Write(step, DataSetBytes(this->Surfaces[step.Number], shown),
              [&](const std::string& frame)
              { return Draw(this->Options, frame, shown, shown, this->Drawn, this->FrameColors); });
            this->Keep(step, nullptr, DescribeSize(shown), cost);
          }
        }
      });
  }

  void MakeSurface(Moment& moment)
  {
    vtkPointSet* particles = moment.Particles;
    Run run = Extract(this->Shared, particles, this->Pieces, moment.Time, moment.Progress);
    if (const vtkSmartPointer<vtkPolyData> whole = this->Shared.Merge(run.Surface))
    {
      run.Surface = whole;
    }
    this->Shared.OnAll(
      [&] { AddFilmNumbers(this->Numbers, this->Shared, run, particles, moment.Time); });
    this->Shared.OnFirst(
      [&]
      {
        const std::string& file = this->Surfaces[moment.Number];
        vtkPolyData* surface = run.Surface;
        Inspect(this->Options, file, run, particles, this->Colors, moment.Number == 0);
        this->Write(moment, SurfaceBytes(file, surface, this->Colors),
          [&](const std::string& frame) {
            return Draw(
              this->Options, frame, surface, particles, this->Drawn, this->FrameColors);
          });
        this->Last = run.Statistics;
        const vtkIdType triangles = surface->GetNumberOfPolys(),
                        lines = triangles > 0 ? 0 : surface->GetNumberOfLines();
        this->Keep(moment, run.Statistics,
          std::to_string(surface->GetNumberOfPoints()) + " points, " +
            std::to_string(lines + triangles) + (lines > 0 ? " lines" : " triangles"),
          run.WallSeconds);
      });
    moment.Warnings.insert(moment.Warnings.end(), run.Warnings.begin(), run.Warnings.end());
  }

  /// Writes the step's file and picture: both or neither.
  void Write(const Moment& moment, const std::string& bytes,
    const std::function<std::string(const std::string& frame)>& draw)
  {
    OutputFiles files;
    files.Write(this->Surfaces[moment.Number], this->IsListed ? MarkedStep(bytes) : bytes);
    if (this->Drawn)
    {
      const std::string frame = NameOfStep(this->Options.Picture.File, moment.Number);
      files.Write(frame, draw(frame));
    }
    files.Commit();
  }

  void Report(const Moment& moment, vtkFieldData* statistics, double seconds)
  {
    if (this->Options.Has("--stats"))
    {
      this->Reports.push_back(StepAsJson(moment.Time, this->Times.ListFiles(moment.Time),
        moment.Error.empty() ? this->Surfaces[moment.Number] : moment.Error, statistics, seconds));
    }
  }

  /// Adds a step, whose file is written, to the list of steps and to the statistics, and prints a line about the step.
  void Keep(
    const Moment& moment, vtkFieldData* statistics, const std::string& what, double seconds)
  {
    this->Entries += "    <DataSet timestep=\"" + DigitsOf(moment.Time) +
      "\" part=\"0\" file=\"" +
      EscapedForXml(fs::path(this->Surfaces[moment.Number]).filename().string()) + "\"/>\n";
    this->Report(moment, statistics, seconds);
    this->List(false);
    if (!this->Options.Has("--quiet"))
    {
      std::cout << Printable(moment.Label) << ": " << what << ", " << DigitsOf(seconds, 3) << " s"
                << std::endl;
    }
  }

  /// Writes the lists and tables of all surfaces so far.
  void List(bool isLast)
  {
    if (!this->Entries.empty())
    {
      this->ListFile.Write(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n"
        "  <Collection>\n" +
          this->Entries + "  </Collection>\n</VTKFile>\n",
        isLast);
      this->PieceFile.Write(this->Pieces, isLast);
      this->NumberFile.Write(this->Numbers, isLast);
    }
  }

  Sharing& Shared;
  const Job& Options;
  ParticleTimes Times;
  const std::vector<std::string> Surfaces;
  const bool IsListed;                ///< whether a .pvd file lists the surfaces
  std::string Entries;                ///< entries of the .pvd file
  std::vector<std::string> Reports;   ///< JSON of all steps, for the statistics
  vtkSmartPointer<vtkFieldData> Last; ///< the last step that went well
  ColorScale Colors, FrameColors;
  std::string Pieces, Numbers; ///< texts of the tables
  GrowingFile ListFile, PieceFile, NumberFile;
  Picture Drawn;                       ///< empty if no pictures are wanted
  vtkSmartPointer<vtkImageData> Empty; ///< the image of a step without fluid; null: no place known
  std::vector<std::pair<Moment, double>> Waiting; ///< steps without a known place, and seconds
};

}

bool MakeFilm(Sharing& sharing)
{
  sharing.Options.Surface->KeepDeviceDataOn(); // the next step uses this step's buffers
  return Film(sharing).Make();
}
