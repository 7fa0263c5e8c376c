// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Makes the tables of gauges and sections, of pieces of surfaces, and of numbers of films.
#include "DataFile.h"
#include "Failures.h"
#include "Job.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "ParticleTimes.h"
#include "Runs.h"
#include "Sharing.h"
#include "Text.h"

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSPHComponents.h"
#include "vtkTable.h"
#include "vtkVariant.h"
#include "vtkVector.h"
#include "vtkVectorOperators.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace
{

constexpr double NoNumber = std::numeric_limits<double>::quiet_NaN();

/// Writes an elevation map: the array Level is the height of the surface.
void WriteGrid(const Job& job, vtkTable* table)
{
  const GaugeGrid& grid = job.Grid;
  vtkNew<vtkImageData> image;
  double spacing[3] = { 1.0, 1.0, 1.0 };
  for (std::size_t a = 0; a < 2; ++a)
  {
    const double length = grid.Bounds[2 * a + 1] - grid.Bounds[2 * a];
    spacing[a] = grid.Counts[a] > 1 && length > 0.0 ? length / (grid.Counts[a] - 1) : 1.0;
  }
  image->SetDimensions(grid.Counts[0], grid.Counts[1], 1);
  image->SetOrigin(grid.Bounds[0], grid.Bounds[2], grid.Bounds[4]);
  image->SetSpacing(spacing);
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

/// Makes a table of what gauges or sections measure, or, for a grid of gauges, an image.
class MeterTable : public TableSeries
{
public:
  explicit MeterTable(Sharing& sharing)
    : TableSeries(sharing, sharing.Options.Has("--gauge-grid") ? "" : sharing.Options.Output)
    , IsFlux(this->Options.Mode() == FLUX)
    , IsImage(this->Options.Has("--gauge-grid"))
    , Meter(IsFlux ? static_cast<vtkSPHMeter*>(this->Options.Flux) : this->Options.Gauge.Get())
  {
    Require(!this->IsImage || this->Times.Get().size() == 1,
      "--gauge-grid takes one INPUT of one time, as its OUTPUT is one image");
  }

private:
  std::string Finish() override
  {
    if (this->IsImage)
    {
      WriteGrid(this->Options, this->Meter->GetOutput());
    }
    return std::string("; volumes: ") + this->Meter->GetUsedVolume();
  }

  bool IsTold(const std::string& warning) const override
  {
    return !this->IsImage || warning.find("outside of all fluid") == std::string::npos;
  }

  void AddRows(std::size_t i, vtkPointSet* particles) override
  {
    const double time = this->Times.Get()[i];
    vtkTable* table = nullptr;
    this->Shared.OnAll(
      [&] { table = MeasureWith(this->Meter, this->Shared, particles, time, this->Progress(i)); });
    for (std::size_t flux = 0; this->IsFlux && flux < 2; ++flux)
    {
      // Integrates over time, by trapezia between steps.
      const std::string name = flux == 0 ? "volume" : "mass";
      auto* rates = vtkDoubleArray::SafeDownCast(table->GetColumnByName((name + "_flux").c_str()));
      std::vector<double>&before = this->Rates[flux], &sums = this->Sums[flux];
      sums.resize(static_cast<std::size_t>(rates->GetNumberOfValues()));
      const double passed = before.empty() ? 0.0 : time - this->LastTime;
      before = before.empty() ? std::vector<double>(rates->Begin(), rates->End()) : before;
      vtkNew<vtkDoubleArray> column;
      column->SetName(name.c_str());
      for (std::size_t row = 0; row < sums.size(); ++row)
      {
        const double now = rates->GetValue(static_cast<vtkIdType>(row));
        // if the flux is NaN, so is the integral
        sums[row] += passed * 0.5 * (before[row] + now) + 0.0 * now;
        column->InsertNextValue(sums[row]);
      }
      table->AddColumn(column);
      before.assign(rates->Begin(), rates->End());
    }
    this->LastTime = time;
    AppendTable(this->Text, table);
  }

  const bool IsFlux, IsImage;
  vtkSPHMeter* const Meter;
  double LastTime = 0.0;
  std::vector<double> Rates[2], Sums[2]; ///< last fluxes, and integrals: volume, mass; by section
};

/// Returns the iso values of a run, ascending; if it had no particles, the requested ones.
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

/// Returns the number of the level with this iso value, which may have been rounded to float.
std::size_t LevelOf(const std::vector<Level>& levels, double iso)
{
  const auto next = std::min_element(levels.begin(), levels.end(),
    [iso](const Level& a, const Level& b)
    { return std::abs(a.Iso - iso) < std::abs(b.Iso - iso); });
  return static_cast<std::size_t>(next - levels.begin());
}

/// Sets, for each iso value, the area that its lines enclose, if they are closed.
void MeasureLines(Run& run, const std::string& isoName)
{
  vtkDataArray* isoValues = run.Surface->GetPointData()->GetArray(isoName.c_str());
  std::vector<vtkVector3d> sums(run.Levels.size(), vtkVector3d(0.0));
  std::vector<bool> areClosed(run.Levels.size(), true);
  vtkNew<vtkIdList> line;
  for (vtkIdType l = 0; isoValues && l < run.Surface->GetNumberOfLines(); ++l)
  {
    run.Surface->GetLines()->GetCellAtId(l, line);
    const vtkIdType first = line->GetId(0), last = line->GetNumberOfIds() - 1;
    const std::size_t own = LevelOf(run.Levels, isoValues->GetComponent(first, 0));
    areClosed[own] = areClosed[own] && first == line->GetId(last);
    const auto at = [&](vtkIdType i) // relative to the first point
    { return vtkVector3d(run.Surface->GetPoint(line->GetId(i))) - vtkVector3d(run.Surface->GetPoint(first)); };
    for (vtkIdType i = 0; i < last; ++i)
    {
      sums[own] = sums[own] + at(i).Cross(at(i + 1));
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i)
  {
    run.Levels[i].Area = areClosed[i] ? 0.5 * sums[i].Norm() : NoNumber;
  }
}
}

vtkTable* MeasureWith(vtkSPHMeter* meter, const Sharing& sharing, vtkPointSet* particles,
  double time, const std::string& progress)
{
  meter->SetInputData(SetUpParticles(meter, sharing.Options, particles));
  meter->SetTime(time);
  Update(meter, sharing, progress);
  return meter->GetOutput();
}

std::size_t AddGauges(const Job& job)
{
  const std::vector<Place> gauges = ListGauges(job);
  for (const Place& gauge : gauges)
  {
    const std::vector<double>& e = gauge.Numbers;
    job.Gauge->AddGauge(gauge.Name.c_str(), e[0], e[1], e[2], e[3], e[4], e[5]);
  }
  return gauges.size();
}

bool MakeMeterTable(Sharing& sharing)
{
  const Job& job = sharing.Options;
  const bool isFlux = job.Mode() == FLUX;
  const std::vector<Place> sections = isFlux ? ListSections(job) : std::vector<Place>();
  for (const Place& section : sections)
  {
    const char* name = section.Name.c_str();
    section.File.empty() ? section.Add(job.Flux, name, section.Numbers.data())
                         : job.Flux->AddSurface(name, ReadDataSet(section.File));
  }
  const std::size_t places = isFlux ? sections.size() : AddGauges(job);
  return MeterTable(sharing).Make(
    std::to_string(places) + (isFlux ? " section" : " gauge") + (places == 1 ? "" : "s"));
}

// Gives the filter of pieces the same settings of the particles as the surface's filter. Surfaces
// of several iso values are nested, so each is measured by its pieces.
void AddPieces(
  std::string& text, const Sharing& sharing, Run& run, vtkPointSet* particles, double time)
{
  const Job& job = sharing.Options;
  const bool isTable = job.Has("--components");
  for (const double iso : IsoValuesOf(job, run.Statistics))
  {
    run.Levels.push_back({ iso, NoNumber, NoNumber, NoNumber });
  }
  const bool areMany = job.Has("--numbers") && run.Levels.size() > 1;
  const bool hasLines = run.Statistics->HasArray("Lines");
  if (!isTable && areMany && hasLines)
  {
    MeasureLines(run, job.Surface->GetIsoValueArrayName());
  }
  if (!isTable && (!areMany || hasLines))
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
  vtkTable* pieces = split->GetTable();
  double area = 0.0, volume = 0.0; // of all remaining pieces
  for (Level& level : run.Levels)
  {
    level.Area = level.Volume = level.Pieces = 0.0;
  }
  for (vtkIdType row = 0; row < pieces->GetNumberOfRows(); ++row)
  {
    const auto of = [pieces, row](const char* column)
    { return pieces->GetValueByName(row, column).ToDouble(); };
    area += of("area");
    volume += of("volume");
    for (Level& level : run.Levels)
    {
      const bool isOwn = run.Levels.size() == 1 || of("iso") == level.Iso;
      level.Area += isOwn ? of("area") : 0.0;
      level.Volume += isOwn ? of("volume") : 0.0;
      level.Pieces += isOwn ? 1.0 : 0.0;
    }
  }
  if (!isTable)
  {
    return;
  }
  run.Surface->ShallowCopy(split->GetOutput());
  AddNumbers(run.Statistics, "Pieces", { static_cast<double>(pieces->GetNumberOfRows()) });
  for (const auto& [name, number] : { std::pair("Area", area), std::pair("Volume", volume) })
  {
    if ((job.LeastVolume > 0.0 || job.LeastParticles > 0) && run.Statistics->HasArray(name))
    {
      AddNumbers(run.Statistics, name, { number });
    }
  }
  vtkNew<vtkTable> table;
  if (job.IsFilm())
  {
    vtkNew<vtkDoubleArray> times;
    times->SetName("time");
    times->SetNumberOfTuples(pieces->GetNumberOfRows());
    times->FillValue(time);
    table->AddColumn(times);
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
  const bool areMany = run.Levels.size() > 1;
  if (!areMany)
  {
    const double none = run.Statistics->HasArray("Triangles") ? NoNumber : 0.0; // without fluid they are 0
    run.Levels.front().Area = NumberOf(run.Statistics, "Area", none);
    run.Levels.front().Volume = NumberOf(run.Statistics, "Volume", none);
  }
  vtkDataArray* isoValues =
    areMany ? run.Surface->GetPointData()->GetArray(job.Surface->GetIsoValueArrayName()) : nullptr;
  std::vector<double> triangles(run.Levels.size());
  vtkNew<vtkIdList> corners;
  for (vtkIdType t = 0; isoValues && t < run.Surface->GetNumberOfPolys(); ++t)
  {
    run.Surface->GetPolys()->GetCellAtId(t, corners);
    triangles[LevelOf(run.Levels, isoValues->GetComponent(corners->GetId(0), 0))] += 1.0;
  }
  for (std::size_t i = 0; i < run.Levels.size(); ++i)
  {
    const Level& level = run.Levels[i];
    vtkNew<vtkTable> table;
    vtkFieldData* row = table->GetRowData();
    AddNumbers(row, "time", { time });
    AddNumbers(row, "iso", { level.Iso });
    AddNumbers(row, "triangles",
      { areMany ? triangles[i] : static_cast<double>(run.Surface->GetNumberOfPolys()) });
    AddNumbers(row, "area", { level.Area });
    AddNumbers(row, "volume", { level.Volume });
    if (areMany)
    {
      AddNumbers(row, "between",
        { level.Volume - (i + 1 < run.Levels.size() ? run.Levels[i + 1].Volume : 0.0) });
    }
    if (job.Has("--components"))
    {
      AddNumbers(row, "pieces", { level.Pieces });
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
