// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Runs.h"

#include "ColorScale.h"
#include "DataFile.h"
#include "Failures.h"
#include "Job.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "Sharing.h"
#include "Text.h"

#include "mcor.h"
#include "vtkCommand.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkSPHFound.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <future>
#include <iostream>
#include <utility>

#include <unistd.h>

namespace
{

/// Makes the settings that depend on the input, such as whether a text is a number or the name of an
/// array, and where a period lies.
void SetParticles(vtkSPHAlgorithm* filter, const Job& job, vtkPointSet* particles)
{
  const auto set = [&](const std::string& text, void (vtkSPHAlgorithm::*setNumber)(double),
                     void (vtkSPHAlgorithm::*setName)(const char*))
  {
    double value = 0.0;
    !particles->GetPointData()->HasArray(text.c_str()) && ParseNumber(text, value)
      ? (filter->*setNumber)(value)
      : (filter->*setName)(text.c_str());
  };
  const bool isArray = particles->GetPointData()->HasArray(job.SmoothingLength.c_str());
  if (!isArray && (job.NeighborRatio > 0.0 || job.SmoothingLength == "estimate"))
  {
    filter->EstimateSmoothingLengthOn();
    filter->SetSmoothingLengthEstimate(job.NeighborRatio > 0.0 ? vtkSPHAlgorithm::ESTIMATE_NEIGHBORS
                                                               : vtkSPHAlgorithm::ESTIMATE_SPACING);
    filter->SetNeighborRatio(job.NeighborRatio);
  }
  else
  {
    set(job.SmoothingLength, &vtkSPHAlgorithm::SetSmoothingLength,
      &vtkSPHAlgorithm::SetSmoothingLengthArrayName);
  }
  set(job.Mass, &vtkSPHAlgorithm::SetMass, &vtkSPHAlgorithm::SetMassArrayName);
  set(job.Density, &vtkSPHAlgorithm::SetDensity, &vtkSPHAlgorithm::SetDensityArrayName);
  if (!job.Walls.empty())
  {
    filter->SetFluidArrayName(WallArrayName);
    filter->SetFluidValue(0);
  }
  if (job.ParticleDistance > 0.0)
  {
    const double dimension = filter->FindDimension(particles);
    filter->SetSmoothingLength(job.CoefH * std::sqrt(dimension) * job.ParticleDistance);
    filter->SetParticleVolume(std::pow(job.ParticleDistance, dimension));
  }
  const std::vector<double> period = job.DetectPeriod && job.Periodic.empty()
    ? CheckedPeriod(vtkSPHFindPeriod(particles->GetFieldData()), "")
    : job.Periodic;
  if (!period.empty())
  {
    filter->SetPeriodicBounds(vtkSPHBoundsOfPeriod(period, particles->GetBounds()).data());
  }
}

/// Returns the particles with the arrays of vtkMarchingCorrectors::Widen(), such as the smoothing
/// lengths that --widen or --smooth make.
vtkSmartPointer<vtkPolyData> Widen(const Job& job, vtkPointSet* particles)
{
  auto widened = vtkSmartPointer<vtkPolyData>::New();
  Messages() = {};
  const bool isFound = job.Surface->Widen(particles, widened);
  Require(isFound, Messages().FirstError());
  return widened;
}

/// Returns the particles with the smoothing lengths that --widen and --smooth make for the surface.
/// Tells the filter the names of the new arrays.
vtkSmartPointer<vtkPointSet> WidenFor(vtkSPHAlgorithm* filter, const Job& job, vtkPointSet* input)
{
  SetParticles(job.Surface, job, input);
  const vtkSmartPointer<vtkPolyData> widened = Widen(job, input);
  filter->EstimateSmoothingLengthOff();
  filter->SetSmoothingLengthIsSupportRadius(false);
  filter->SetSmoothingLength(0.0);
  filter->SetSmoothingLengthArrayName("WidenedSmoothingLength");
  if (widened->GetPointData()->HasArray("WideningVolume")) // if volumes are computed
  {
    filter->SetVolumeArrayName("WideningVolume");
  }
  for (const char* name : { "Widening", "WidenedSmoothingLength", "WideningVolume" })
  {
    filter->AddExcludedArray(name);
  }
  return widened;
}

bool Contains(const std::vector<std::string>& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Lists the particles' arrays that are not interpolated because the surface's file could not hold
/// them.
std::vector<std::string> ArraysWithoutPlace(const Job& job, vtkPointSet* particles)
{
  std::vector<std::string> without;
  const std::vector<std::string> names = NamesOf(particles->GetPointData());
  const std::string& color = job.Picture.ColorBy; // if it is unknown, an error lists all arrays
  const bool isKept = HoldsArrays(job.Output) || !job.Surface->GetInterpolateAttributes() ||
    (!color.empty() && !Contains(names, color));
  for (const std::string& name : isKept ? std::vector<std::string>() : names)
  {
    if (!name.empty() && name != job.Scalar && name != color && name != WallArrayName &&
      (job.AttributeNames.empty() || Contains(job.AttributeNames, name)))
    {
      without.push_back(name);
    }
  }
  return without;
}

/// Tells the filter which arrays to interpolate: all, or those of --attributes; but neither arrays that the
/// surface's file could not hold, nor the mark of walls, nor numbers that stand for texts.
void SetAttributes(vtkSPHAlgorithm* filter, const Job& job, vtkPointSet* particles)
{
  const std::vector<std::string>& asked = job.AttributeNames;
  const std::vector<std::string> names = NamesOf(particles->GetPointData());
  std::vector<std::string> without;
  for (const std::string& name : asked)
  {
    Require(particles->GetNumberOfPoints() == 0 || Contains(names, name),
      "there is no point array '" + name + "' to interpolate (--attributes)");
  }
  if (filter == job.Surface)
  {
    // In .ply, an array with one iso value for all points is useless unless it colours the points.
    const std::string& color = job.Picture.ColorBy;
    job.Surface->SetComputeScalars(!EndsWith(job.Output, ".ply") ||
      job.Surface->GetNumberOfContours() > 1 || (!color.empty() && !Contains(names, color)));
    without = ArraysWithoutPlace(job, particles);
  }
  filter->ClearExcludedArrays(); // arrays of the step before
  for (const std::string& name : names)
  {
    const bool isWanted = asked.empty() || Contains(asked, name);
    const bool isMark = name == WallArrayName && !job.Walls.empty(); // it would be the same everywhere
    const bool isOfTexts = ChosenWords().count(name) > 0;            // it has the texts' numbers
    if (!isWanted || isMark || isOfTexts || Contains(without, name))
    {
      filter->AddExcludedArray(name);
    }
  }
}

/// Fails, before the output is made, if the output will not have the array to colour by.
void CheckColorName(vtkSPHAlgorithm* filter, const Job& job, vtkPointSet* particles)
{
  static const std::vector<std::string> ofPoints = { "WeightSum", "Gradients",
    "vtkValidPointMask" };
  static const std::vector<std::string> ofSurface = { "Normals", "IsoValue", "Gradients",
    "WeightSum", "BoundaryEigenvalue", "MeanCurvature", "GaussCurvature", "CorrectionLength",
    "Residual", "BoundaryFlag", "Widening", "BandValue", "ComponentId", "ComponentVolume" };
  const std::string& name = job.Picture.ColorBy;
  std::vector<std::string> names = NamesOf(particles->GetPointData());
  bool isMade = !job.Scalar.empty() && name.compare(0, job.Scalar.size(), job.Scalar) == 0;
  if (filter == job.Projection) // its image has one array
  {
    names.assign(1, job.Scalar.empty() ? "ColumnDensity" : job.Scalar);
  }
  else
  {
    isMade = isMade || Contains(filter == job.Surface ? ofSurface : ofPoints, name);
  }
  if (!name.empty() && particles->GetNumberOfPoints() > 0 && !isMade && !job.Has("--probe"))
  {
    ::CheckColorName(name, names);
  }
}

/// Returns why there is no surface; "" if the run has no iso value.
std::string ReasonForNoSurface(vtkFieldData* run)
{
  const std::size_t values = NumbersOf(run, "IsoValues").size();
  const std::string inBox = run->HasArray("Box") ? " in the box" : "";
  const std::string what = run->HasArray("Lines") ? "lines" : "triangles";
  if (NumberOf(run, "TrianglesBeforeTrimming") > 0.0)
  {
    return Fill(run,
      { "all {TrianglesBeforeTrimming} " + what + inBox +
        " were trimmed, as they lie where the fluid "
        "ends: a lower --vertex-threshold keeps more of them" });
  }
  const std::string isoValue = values == 1 ? Fill(run, { " {IsoValues}" }) : "";
  const char* range = "; the particles have values from {ScalarRange:0} to {ScalarRange:1}";
  return values == 0 ? ""
                     : "no part of the field" + inBox + " reaches the iso value" + isoValue +
      Fill(run, { range, "" });
}

/// Shows a run's progress line. If no line is shown, and the driver compiles for more than three seconds,
/// says once that it compiles.
class Progress
{
public:
  Progress(const std::string& before, bool isShown, bool isQuiet)
    : Before(before)
    , IsShown(isShown)
    , IsQuiet(isQuiet)
  {
  }
  ~Progress()
  {
    std::fputs(this->IsShown ? "\r\033[K" : "", stderr);
    this->End.set_value(); // then Waiting ends, and its thread is joined
  }

  void Take(vtkObject* caller, unsigned long, void*)
  {
    KeepWatchOfCrashes();
    auto* filter = static_cast<vtkAlgorithm*>(caller);
    const std::string phase = filter->GetProgressText() ? filter->GetProgressText() : "";
    if (this->IsShown)
    {
      std::fprintf(stderr, "\r\033[K%s%3.0f %% %s", this->Before.c_str(),
        100.0 * filter->GetProgress(), Printable(phase).c_str());
      std::fflush(stderr);
      return;
    }
    this->IsBuilding = phase.rfind(MCOR_BUILDING, 0) == 0;
    if (!this->IsQuiet && this->IsBuilding && !std::exchange(this->HasBegun, true))
    {
      // If no thread can be started, the user is not told that the driver compiles.
      FailureOf([this] { this->Waiting = std::async(std::launch::async, &Progress::Wait, this); });
    }
  }

private:
  void Wait()
  {
    const std::future<void> end = this->End.get_future();
    while (end.wait_for(std::chrono::seconds(3)) == std::future_status::timeout)
    {
      if (this->IsBuilding) // the driver still compiles
      {
        Say("the OpenCL driver compiles its programs for the first time, which may take a minute");
        return;
      }
    }
  }

  const std::string& Before; ///< the words in front of the line
  const bool IsShown, IsQuiet;
  std::atomic<bool> IsBuilding{ false };
  bool HasBegun = false;
  std::promise<void> End;
  std::future<void> Waiting; ///< the last member, because its thread uses the others
};

}

vtkSmartPointer<vtkPointSet> SetUpParticles(
  vtkSPHAlgorithm* filter, const Job& job, vtkPointSet* input)
{
  vtkSmartPointer<vtkPointSet> particles = input;
  if (!job.Derive.empty())
  {
    vtkSPHDerivatives* derivatives = job.Derivatives;
    SetParticles(derivatives, job, input);
    derivatives->ComputeStrainRateOn();
    derivatives->ReplaceArraysOn(); // the next step needs the same names
    derivatives->SetInputData(input);
    derivatives->Update();
    const std::string error = derivatives->GetErrorMessage();
    Require(error.empty(), error);
    particles.TakeReference(input->NewInstance());
    particles->ShallowCopy(derivatives->GetOutput()); // the next step changes the output
  }
  vtkDataArray* scalar = particles->GetPointData()->GetArray(job.Scalar.c_str());
  Require(!job.Has("--component") || !scalar || scalar->GetNumberOfComponents() > 1,
    "--component is for vectors, and '" + job.Scalar +
      "' has one component; leave out --component");
  SetParticles(filter, job, particles);
  SetAttributes(filter, job, particles);
  if (filter != job.Gauge && filter != job.Flux) // pictures show no tables
  {
    CheckColorName(filter, job, particles);
  }
  const bool isWidened = job.Surface->GetWidening() > 1.0 || job.Surface->GetSmooth();
  return isWidened && filter != job.Surface ? WidenFor(filter, job, particles) : particles;
}

double Update(vtkSPHAlgorithm* filter, const Sharing& sharing, const std::string& before)
{
  const bool isQuiet = sharing.Options.Has("--quiet");
  std::chrono::duration<double> elapsed;
  Messages() = {};
  filter->Modified();
  {
    Progress progress(before, !isQuiet && isatty(STDERR_FILENO), isQuiet || !sharing.IsFirst());
    const unsigned long observed =
      filter->AddObserver(vtkCommand::ProgressEvent, &progress, &Progress::Take);
    const auto start = std::chrono::steady_clock::now();
    filter->Update();
    elapsed = std::chrono::steady_clock::now() - start;
    filter->RemoveObserver(observed);
  }
  Messages().Check(filter->GetErrorMessage());
  return elapsed.count();
}

Run Extract(Sharing& sharing, vtkPointSet* particles, std::string& pieces, double time,
  const std::string& progress)
{
  const Job& job = sharing.Options;
  vtkMarchingCorrectors* filter = job.Surface;
  Run run;
  sharing.OnAll(
    [&]
    {
      const vtkSmartPointer<vtkPointSet> used = SetUpParticles(filter, job, particles);
      vtkNew<vtkPolyData> bare; // VTK would give the surface the particles' field data
      bare->SetPoints(used->GetPoints());
      bare->GetPointData()->ShallowCopy(used->GetPointData());
      filter->SetInputData(bare);
    });
  sharing.OnAll([&] { run.WallSeconds = Update(filter, sharing, progress); });
  run.Surface = vtkSmartPointer<vtkPolyData>::New();
  run.Surface->ShallowCopy(filter->GetOutput());
  filter->GetOutput()->Initialize(); // frees one before the next: the peak of memory is a statistic
  run.Statistics = vtkSmartPointer<vtkFieldData>::New();
  run.Statistics->PassData(filter->GetRunStatistics());
  const std::vector<double> values = NumbersOf(run.Statistics, "IsoValues");
  if (!job.Scalar.empty() && filter->GetNumberOfContours() == 0 &&
    run.Statistics->HasArray("ScalarRange") && !values.empty())
  {
    filter->SetValue(0, values[0]); // it was chosen here, and stays for the next steps
    if (!job.Has("--quiet") && sharing.IsFirst())
    {
      std::cout << Fill(run.Statistics,
                     { "iso value   {IsoValues}, chosen for {Scalar}, whose range is "
                       "{ScalarRange:0} .. {ScalarRange:1} (--iso gives another one)" })
                << std::endl;
    }
  }
  Messages().AddWarningsTo(run.Warnings); // they are in the statistics, too
  // "Triangles" counts the triangles of all processes.
  if (run.Surface->GetNumberOfCells() == 0 && NumberOf(run.Statistics, "Triangles") == 0.0)
  {
    const std::string reason =
      run.Warnings.empty() ? ReasonForNoSurface(run.Statistics) : run.Warnings.front();
    run.Warnings.resize(std::max<std::size_t>(run.Warnings.size(), 1));
    run.Warnings.front() = "the surface is empty" + (reason.empty() ? "" : ": " + reason);
  }
  sharing.OnAll([&] { AddPieces(pieces, sharing, run, particles, time); });
  return run;
}

void Inspect(const Job& job, const std::string& file, Run& run, vtkPointSet* particles,
  ColorScale& colors, bool hasHints)
{
  colors.Include(run.Surface);
  for (const std::string& sentence :
    { hasHints && job.Periodic.empty() && !job.DetectPeriod ? HintOfPeriod(particles) : "",
      LostArrays(file, run.Surface, ArraysWithoutPlace(job, particles)) })
  {
    run.Warnings.insert(run.Warnings.end(), sentence.empty() ? 0 : 1, sentence);
  }
}

bool MakeSurface(Sharing& sharing)
{
  const Job& job = sharing.Options;
  const bool isInPieces = EndsWith(job.Output, ".pvtp");
  std::vector<std::string> outputs; // this process's files; on the first process, all files
  for (int rank = 0; isInPieces && rank < sharing.GetCount(); ++rank)
  {
    if (sharing.IsFirst() || rank == sharing.GetRank())
    {
      outputs.push_back(PieceName(job.Output, rank));
    }
  }
  if (sharing.IsFirst())
  {
    outputs.insert(outputs.end(),
      { job.Output, job.Text("--stats"), job.Text("--components"), job.Picture.File,
        job.Text("--widening") });
  }
  sharing.OnAll(
    [&]
    {
      OpenSources(job.InputFiles());
      CheckOutputs(outputs);
    });
  const vtkSmartPointer<vtkPointSet> particles = sharing.ReadInput();
  std::vector<Run> runs; // without their surfaces
  std::string pieces;
  Run run;
  for (int i = 0; i < job.Repeat; ++i)
  {
    run.Surface = nullptr; // one run must end before the next begins
    pieces.clear();
    run = Extract(sharing, particles, pieces);
    runs.push_back(run);
    runs.back().Surface = nullptr;
    if (!job.Has("--quiet") && sharing.IsFirst())
    {
      std::cout << DescribeRun(run.Statistics, job.Has("--verbose"), i > 0) << std::flush;
    }
  }
  const double peakResidentBytes = PeakResidentBytes();
  run.Surface = isInPieces ? run.Surface : sharing.Merge(run.Surface);
  ColorScale colors(job.Picture);
  OutputFiles files;
  sharing.OnAll(
    [&]
    {
      if (isInPieces)
      {
        const std::string piece = PieceName(job.Output, sharing.GetRank());
        files.Write(piece, SurfaceBytes(piece, run.Surface, colors));
      }
      if (!sharing.IsFirst())
      {
        return;
      }
      if (!isInPieces)
      {
        Inspect(job, job.Output, run, particles, colors, sharing.GetCount() == 1);
      }
      for (const std::string& warning : run.Warnings)
      {
        Say("warning: " + warning);
      }
      files.Write(job.Output,
        isInPieces ? ListPieces(job.Output, sharing.GetCount(), run.Surface)
                   : SurfaceBytes(job.Output, run.Surface, colors));
      if (job.Has("--components"))
      {
        files.Write(job.Text("--components"), pieces);
      }
    });
  sharing.OnAll([&] { files.Commit(); }); // only if all processes have written all files
  if (job.Has("--widening"))
  {
    Sharing::Particles widened;
    const vtkSmartPointer<vtkPointSet> used = vtkPointSet::SafeDownCast(job.Surface->GetInput());
    sharing.OnAll([&] { widened = Widen(job, used); });
    widened = sharing.Append(widened);
    sharing.OnFirst([&] { WriteDataSet(job.Text("--widening"), widened); });
  }
  sharing.OnFirst(
    [&]
    {
      if (job.Has("--stats"))
      {
        std::cout.flush(); // the file may be /dev/stdout
        WriteOutput(
          job.Text("--stats"), StatisticsAsJson(job, runs, run.Warnings, peakResidentBytes));
      }
      WritePicture(job, run.Surface, particles, colors);
    });
  return true;
}
