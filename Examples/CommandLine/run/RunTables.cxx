// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Makes the tables of gauges and sections, of pieces of surfaces, and of numbers of films.
#include "DataFile.h"
#include "Failures.h"
#include "Job.h"
#include "ParticleFile.h"
#include "ParticleTimes.h"
#include "Runs.h"
#include "Sharing.h"
#include "Text.h"

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSPHArrays.h"
#include "vtkSPHComponents.h"
#include "vtkTable.h"
#include "vtkVariant.h"
#include "vtkVector.h"
#include "vtkVectorOperators.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace
{

constexpr double NoNumber = std::numeric_limits<double>::quiet_NaN();

/// Writes the readings of a grid of gauges as an image with the arrays Level (z of the surface), Depth and Crossings.
void WriteGrid(const Job& job, vtkTable* table)
{
  const std::vector<double>& n = job.Grid;
  vtkNew<vtkImageData> image;
  const auto spacing = [&n](std::size_t axis)
  {
    const double length = n[3 + 2 * axis] - n[2 + 2 * axis];
    return n[axis] > 1.0 && length > 0.0 ? length / (n[axis] - 1.0) : 1.0;
  };
  image->SetDimensions(static_cast<int>(n[0]), static_cast<int>(n[1]), 1);
  image->SetOrigin(n[2], n[4], n[6]);
  image->SetSpacing(spacing(0), spacing(1), 1.0);
  using Names = std::pair<const char*, const char*>;
  for (const Names& names :
    { Names("z", "Level"), Names("depth", "Depth"), Names("crossings", "Crossings") })
  {
    vtkAbstractArray* column = table->GetColumnByName(names.first);
    column->SetName(names.second);
    image->GetPointData()->AddArray(column);
  }
  image->GetPointData()->SetActiveScalars("Level");
  WriteDataSet(job.Output, image);
}

/// Adds the column `name` (volume or mass) to the table of fluxes: how much has flowed since the first time, by the
/// trapezoidal rule. passed: the time since the last step; before: each section's flux at the last step; sums: each
/// section's integral so far.
void AddIntegrals(vtkTable* table, const std::string& name, double passed,
  std::vector<double>& before, std::vector<double>& sums)
{
  auto* rates = vtkDoubleArray::SafeDownCast(table->GetColumnByName((name + "_flux").c_str()));
  const std::vector<double> now(rates->Begin(), rates->End());
  before = before.empty() ? now : before;
  sums.resize(now.size());
  vtkSPHAddColumn<vtkDoubleArray>(table, name.c_str(), rates->GetNumberOfValues(),
    [&](vtkIdType row)
    {
      const auto i = static_cast<std::size_t>(row);
      // if the flux is NaN, so is the integral
      return sums[i] += passed * 0.5 * (before[i] + now[i]) + 0.0 * now[i];
    });
  before = now;
}

/// Returns the iso values of a run, ascending. If the run had no particles, returns the requested
/// values. If there are no iso values, returns one NaN.
std::vector<double> IsoValuesOf(const Job& job, vtkFieldData* run)
{
  std::vector<double> values = NumbersOf(run, "IsoValues");
  vtkMarchingCorrectors* asked = job.Surface;
  const bool isFree = asked->GetFreeSurface();
  const vtkIdType count = run->HasArray("IsoValues") ? 0
    : isFree                                         ? asked->GetNumberOfFreeSurfaceValues()
                                                     : asked->GetNumberOfContours();
  for (int i = 0; i < static_cast<int>(count); ++i)
  {
    values.push_back(isFree ? asked->GetFreeSurfaceValue(i) : asked->GetValue(i));
  }
  std::sort(values.begin(), values.end());
  return values.empty() ? std::vector<double>{ NoNumber } : values;
}

/// Returns the index of the level nearest to this iso value, which may have been rounded to float.
std::size_t LevelOf(const std::vector<double>& levels, double iso)
{
  const auto next = std::min_element(levels.begin(), levels.end(),
    [iso](double a, double b) { return std::abs(a - iso) < std::abs(b - iso); });
  return static_cast<std::size_t>(next - levels.begin());
}

/// Returns, for each iso value, the area that its lines enclose; NaN if a line is open.
std::vector<double> AreasOfLines(
  vtkPolyData* surface, const std::string& isoName, const std::vector<double>& levels)
{
  vtkDataArray* isoValues = surface->GetPointData()->GetArray(isoName.c_str());
  std::vector<vtkVector3d> sums(levels.size(), vtkVector3d(0.0));
  std::vector<double> areas(levels.size(), 0.0); // NaN: some line is open
  vtkNew<vtkIdList> line;
  for (vtkIdType l = 0; isoValues && l < surface->GetNumberOfLines(); ++l)
  {
    surface->GetLines()->GetCellAtId(l, line);
    const vtkIdType first = line->GetId(0), last = line->GetNumberOfIds() - 1;
    const std::size_t own = LevelOf(levels, isoValues->GetComponent(first, 0));
    areas[own] = first == line->GetId(last) ? areas[own] : NoNumber;
    const auto at = [&](vtkIdType i) // relative to the first point
    { return vtkVector3d(surface->GetPoint(line->GetId(i))) - vtkVector3d(surface->GetPoint(first)); };
    for (vtkIdType i = 0; i < last; ++i)
    {
      sums[own] = sums[own] + at(i).Cross(at(i + 1));
    }
  }
  for (std::size_t i = 0; i < areas.size(); ++i)
  {
    areas[i] += 0.5 * sums[i].Norm();
  }
  return areas;
}

/// Returns the sum of a column over the pieces with this iso value, or over all pieces; without a column, the number of
/// these pieces.
double SumOf(vtkTable* pieces, const char* column, bool areAll, double iso = 0.0)
{
  double sum = 0.0;
  for (vtkIdType row = 0; row < pieces->GetNumberOfRows(); ++row)
  {
    const bool isOwn = areAll || pieces->GetValueByName(row, "iso").ToDouble() == iso;
    sum += !isOwn ? 0.0 : column ? pieces->GetValueByName(row, column).ToDouble() : 1.0;
  }
  return sum;
}

/// Measures the particles with the meter, and returns its table. Shows the progress behind the words
/// `progress`.
vtkTable* MeasureWith(vtkSPHMeter* meter, const Sharing& sharing, vtkPointSet* particles,
  double time, const std::string& progress)
{
  meter->SetInputData(SetUpParticles(meter, sharing.Options, particles));
  meter->SetTime(time);
  Update(meter, sharing, progress);
  return meter->GetOutput();
}
}

bool MakeMeterTable(Sharing& sharing)
{
  const Job& job = sharing.Options;
  const bool isFlux = job.Mode() == FLUX, isImage = job.Has("--gauge-grid");
  vtkSPHMeter* const meter = isFlux ? static_cast<vtkSPHMeter*>(job.Flux) : job.Gauge.Get();
  const std::size_t places = AddPlaces(job);
  double last = 0.0;
  std::map<std::string, std::vector<double>> rates, sums;
  const auto addRows = [&](const ParticleTimes::Moment& moment, std::string& text)
  {
    vtkTable* table = nullptr;
    sharing.OnAll(
      [&]
      { table = MeasureWith(meter, sharing, moment.Particles, moment.Time, moment.Progress); });
    const double passed = rates.empty() ? 0.0 : moment.Time - last; // nothing has passed at the first time
    for (const std::string name : { "volume", "mass" })
    {
      if (isFlux)
      {
        AddIntegrals(table, name, passed, rates[name], sums[name]);
      }
    }
    last = moment.Time;
    std::vector<std::string>& told = Messages().Warnings;
    const auto isDry = [isImage](const std::string& warning) // an image has many dry places
    { return isImage && TellsOfDryPlaces(warning); };
    told.erase(std::remove_if(told.begin(), told.end(), isDry), told.end());
    AppendTable(text, table);
  };
  const auto finish = [&]
  {
    if (isImage)
    {
      WriteGrid(job, meter->GetOutput());
    }
    return std::string("; volumes: ") + meter->GetUsedVolume();
  };
  return MakeTable(sharing,
    std::to_string(places) + (isFlux ? " section" : " gauge") + (places == 1 ? "" : "s"), addRows,
    finish);
}

// The filter of pieces gets the surface filter's settings of the particles. Besides --components, --numbers with
// several iso values needs the pieces: the measures of a value's surface are sums over the surface's pieces.
void AddPieces(
  std::string& text, const Sharing& sharing, Run& run, vtkPointSet* particles, double time)
{
  const Job& job = sharing.Options;
  const bool isTable = job.Has("--components");
  const bool areMany = job.Has("--numbers") && IsoValuesOf(job, run.Statistics).size() > 1;
  if (!isTable && (!areMany || run.Statistics->HasArray("Lines")))
  {
    return;
  }
  Require(run.Surface->GetNumberOfLines() == 0,
    "--components is for surfaces, but particles in a plane give lines; leave it out");
  vtkMarchingCorrectors* surface = job.Surface;
  vtkNew<vtkSPHComponents> split;
  split->SetInputData(run.Surface);
  split->SetParticlesData(surface->TakePresent(particles));
  split->SetPeriodicBounds(surface->GetPeriodicBounds());
  split->SetMassArrayName(surface->GetMassArrayName());
  split->SetMass(surface->GetMass());
  split->SetFluidArrayName(surface->GetFluidArrayName());
  split->SetFluidValue(surface->GetFluidValue());
  split->SetLeastVolume(job.LeastVolume);
  split->SetLeastParticles(job.LeastParticles);
  split->Update();
  Messages().Check();
  vtkTable* pieces = run.Pieces = split->GetTable();
  if (!isTable)
  {
    return;
  }
  run.Surface->ShallowCopy(split->GetOutput());
  AddNumbers(run.Statistics, "Pieces", { static_cast<double>(pieces->GetNumberOfRows()) });
  if (pieces->GetNumberOfRows() == 0 && NumberOf(run.Statistics, "Triangles") > 0.0)
  {
    run.Warnings.emplace_back(
      "the surface is empty: --least-volume or --least-particles leaves out all of its pieces");
  }
  for (const auto& [name, column] : { std::pair("Area", "area"), std::pair("Volume", "volume") })
  {
    if ((job.LeastVolume > 0.0 || job.LeastParticles > 0) && run.Statistics->HasArray(name))
    {
      AddNumbers(run.Statistics, name, { SumOf(pieces, column, true) });
    }
  }
  vtkNew<vtkTable> table;
  if (job.IsFilm())
  {
    vtkSPHAddColumn<vtkDoubleArray>(
      table, "time", pieces->GetNumberOfRows(), [time](vtkIdType) { return time; });
  }
  for (vtkIdType c = 0; c < pieces->GetNumberOfColumns(); ++c)
  {
    table->AddColumn(pieces->GetColumn(c));
  }
  AppendTable(text, table);
}

void AddFilmNumbers(
  std::string& text, const Sharing& sharing, Run& run, vtkPointSet* particles, double time)
{
  const Job& job = sharing.Options;
  if (!job.Has("--numbers"))
  {
    return;
  }
  vtkTable* gauges = nullptr;
  if (job.Gauge->GetNumberOfGauges() > 0)
  {
    gauges = MeasureWith(job.Gauge, sharing, particles, time, "");
    Messages().AddWarningsTo(run.Warnings);
  }
  const std::vector<double> levels = IsoValuesOf(job, run.Statistics);
  const bool areMany = levels.size() > 1, haveLines = areMany && run.Statistics->HasArray("Lines");
  const char* isoName = job.Surface->GetIsoValueArrayName();
  const double none = run.Statistics->HasArray("Triangles") ? NoNumber : 0.0; // without fluid they are 0
  const std::vector<double> areas =
    haveLines ? AreasOfLines(run.Surface, isoName, levels) : std::vector<double>();
  const auto measured = [&](const char* statistic, const char* column, std::size_t i)
  {
    return !areMany ? NumberOf(run.Statistics, statistic, none)
      : haveLines   ? NoNumber
      : i < levels.size() ? SumOf(run.Pieces, column, false, levels[i])
                          : 0.0;
  };
  vtkDataArray* isoValues = areMany ? run.Surface->GetPointData()->GetArray(isoName) : nullptr;
  std::vector<double> triangles(levels.size());
  vtkNew<vtkIdList> corners;
  for (vtkIdType t = 0; isoValues && t < run.Surface->GetNumberOfPolys(); ++t)
  {
    run.Surface->GetPolys()->GetCellAtId(t, corners);
    triangles[LevelOf(levels, isoValues->GetComponent(corners->GetId(0), 0))] += 1.0;
  }
  for (std::size_t i = 0; i < levels.size(); ++i)
  {
    const double volume = measured("Volume", "volume", i);
    vtkNew<vtkTable> table;
    vtkFieldData* row = table->GetRowData();
    AddNumbers(row, "time", { time });
    AddNumbers(row, "iso", { levels[i] });
    AddNumbers(row, "triangles",
      { areMany ? triangles[i] : static_cast<double>(run.Surface->GetNumberOfPolys()) });
    AddNumbers(row, "area", { haveLines ? areas[i] : measured("Area", "area", i) });
    AddNumbers(row, "volume", { volume });
    if (areMany)
    {
      AddNumbers(row, "between", { volume - measured("Volume", "volume", i + 1) });
    }
    if (job.Has("--components"))
    {
      AddNumbers(row, "pieces", { SumOf(run.Pieces, nullptr, !areMany, levels[i]) });
    }
    for (vtkIdType g = 0; gauges && g < gauges->GetNumberOfRows(); ++g)
    {
      const std::string name = gauges->GetValueByName(g, "gauge").ToString();
      for (const char* what : { "last", "depth", "crossings" })
      {
        AddNumbers(row, name + "." + what, { gauges->GetValueByName(g, what).ToDouble() });
      }
    }
    AppendTable(text, table);
  }
}
