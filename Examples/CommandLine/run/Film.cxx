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
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <utility>

namespace
{

namespace fs = std::filesystem;

/// Lists the files of the steps: film_0000.vtp, ... for film.pvd; film_0000.ply, ... for film_%04d.ply.
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

/// Makes the image of a step in which no particle is seen, at the place of another image. Its values
/// are 0, or NaN if the image shows a mean.
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

class Film : public Series
{
public:
  explicit Film(Sharing& sharing)
    : Series(sharing)
    , Surfaces(ListSurfaces(this->Options, this->Times.Get().size()))
    , Colors(this->Options.Picture)
    , FrameColors(this->Options.Picture)
    , ListFile(IsCollectionFile(this->Options.Output) ? this->Options.Output : "")
    , PieceFile(this->Options.Text("--components"))
    , NumberFile(this->Options.Text("--numbers"))
  {
    const Job& job = this->Options;
    if (job.Has("--numbers"))
    {
      AddGauges(job);
    }
    sharing.OnFirst(
      [this, &job]
      {
        std::vector<std::string> outputs = this->Surfaces;
        for (std::size_t i = 0; !job.Picture.File.empty() && i < this->Surfaces.size(); ++i)
        {
          outputs.push_back(NameOfStep(job.Picture.File, i));
        }
        outputs.insert(outputs.end(),
          { job.Text("--stats"), job.Text("--components"), job.Text("--numbers"),
            IsCollectionFile(job.Output) ? job.Output : "" });
        this->Times.OpenFiles();
        CheckOutputs(outputs);
        Need(Printable(job.Output) == job.Output,
          job.Output + " has characters in its name that a .pvd file cannot hold");
        // The user has not named the files beside a .pvd file, so each must be new, or a step of an
        // older film.
        for (const std::string& surface : this->Surfaces)
        {
          std::error_code error;
          Need(!IsCollectionFile(job.Output) || !fs::exists(fs::symlink_status(surface, error)) ||
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
    const bool isGood = this->MakeAll();
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
  std::string Label(std::size_t i) const override
  {
    return this->Surfaces[i] + " (time " + TimeText(this->Times.Get()[i]) + ")";
  }

  bool IsOfTimes() const override
  {
    return this->Options.Has("--numbers") || this->Options.Has("--components");
  }

  void MakeStep(std::size_t i, vtkPointSet* particles, std::vector<std::string>& warnings) override
  {
    const std::string progress = "step " + std::to_string(i + 1) + " of " +
      std::to_string(this->Surfaces.size()) + ", time " + TimeText(this->Times.Get()[i]) + ": ";
    this->Options.Has("--project") ? this->MakeImage(i, particles, progress, warnings)
                                   : this->MakeSurface(i, particles, progress, warnings);
  }

  void Miss(std::size_t i, const std::string& error) override
  {
    const double time = this->Times.Get()[i];
    this->Reports.push_back(StepAsJson(time, this->Times.ListFiles(time), error, nullptr, 0.0));
  }

  void MakeImage(std::size_t i, vtkPointSet* particles, const std::string& progress,
    std::vector<std::string>& warnings)
  {
    vtkSPHProjection* projection = this->Options.Projection;
    double seconds = 0.0;
    this->Shared.OnAll(
      [&] { projection->SetInputData(SetUpParticles(projection, this->Options, particles)); });
    this->Shared.OnAll([&] { seconds = Update(projection, this->Shared, progress); });
    Messages().AddWarningsTo(warnings);
    this->Shared.OnFirst(
      [&]
      {
        vtkImageData* image = projection->GetImage();
        const bool isSeen = image->GetNumberOfPoints() > 0 && image->GetPointData()->GetScalars();
        this->Waiting.emplace_back(i, seconds);
        if (isSeen)
        {
          this->Empty = EmptyImage(this->Options, image);
        }
        if (this->Empty)
        {
          for (const auto& [step, cost] : std::exchange(this->Waiting, {}))
          {
            vtkImageData* shown = isSeen && step == i ? image : this->Empty.Get();
            this->Write(step, DataSetBytes(this->Surfaces[step], shown),
              [&](const std::string& frame)
              { return DrawField(this->Options, shown, frame, this->Drawn, this->FrameColors); });
            this->Keep(step, nullptr, DescribeSize(shown), cost);
          }
        }
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
        run = Extract(this->Shared, progress);
      });
    this->Shared.OnAll([&] { AddPieces(this->Pieces, this->Shared, run, particles, time); });
    if (const vtkSmartPointer<vtkPolyData> whole = this->Shared.Merge(run.Surface))
    {
      run.Surface = whole;
    }
    this->Shared.OnAll([&] { AddFilmNumbers(this->Numbers, this->Shared, run, particles, time); });
    this->Shared.OnFirst(
      [&]
      {
        const std::string& file = this->Surfaces[i];
        vtkPolyData* surface = run.Surface;
        Inspect(this->Options, file, run, particles, this->Colors, i == 0);
        this->Write(i, SurfaceBytes(file, surface, this->Colors),
          [&](const std::string& frame) {
            return DrawSurface(
              this->Shared, frame, surface, particles, this->Drawn, this->FrameColors);
          });
        this->Last = run.Statistics;
        const vtkIdType triangles = surface->GetNumberOfPolys(),
                        lines = triangles > 0 ? 0 : surface->GetNumberOfLines();
        this->Keep(i, run.Statistics,
          std::to_string(surface->GetNumberOfPoints()) + " points, " +
            std::to_string(lines + triangles) + (lines > 0 ? " lines" : " triangles"),
          run.WallSeconds);
      });
    warnings.insert(warnings.end(), run.Warnings.begin(), run.Warnings.end());
  }

  /// Writes the step's file and picture: both or neither.
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

  /// Lists a step that was written, and says so.
  void Keep(std::size_t i, vtkFieldData* statistics, const std::string& what, double seconds)
  {
    const double time = this->Times.Get()[i];
    this->Entries += "    <DataSet timestep=\"" + DigitsOf(time) + "\" part=\"0\" file=\"" +
      EscapedForXml(fs::path(this->Surfaces[i]).filename().string()) + "\"/>\n";
    if (this->Options.Has("--stats"))
    {
      this->Reports.push_back(
        StepAsJson(time, this->Times.ListFiles(time), this->Surfaces[i], statistics, seconds));
    }
    this->List(false);
    if (!this->Options.Has("--quiet"))
    {
      std::cout << Printable(this->Label(i)) << ": " << what << ", " << DigitsOf(seconds, 3) << " s"
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

  const std::vector<std::string> Surfaces;
  std::string Entries;                ///< entries of the .pvd file
  std::vector<std::string> Reports;   ///< JSON of all steps, for the statistics
  vtkSmartPointer<vtkFieldData> Last; ///< the last step that went well
  ColorScale Colors, FrameColors;
  std::string Pieces, Numbers; ///< texts of the tables
  GrowingFile ListFile, PieceFile, NumberFile;
  Picture Drawn;                       ///< empty if no pictures are wanted
  vtkSmartPointer<vtkImageData> Empty; ///< the image of a step without fluid; null: no place known
  std::vector<std::pair<std::size_t, double>> Waiting; ///< steps without a known place, and seconds
};

}

bool MakeFilm(Sharing& sharing)
{
  sharing.Options.Surface->KeepDeviceDataOn(); // the next step uses this step's buffers
  return Film(sharing).Make();
}
