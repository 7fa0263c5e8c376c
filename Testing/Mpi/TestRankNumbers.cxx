// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Run by mpirun: gauges, fluxes, and the pieces of surfaces, that ranks measure together are bit for bit those of rank 0
// alone, however particles are strewn over the ranks.
//
//   TestRankNumbers FOLDER OF DATA [some]     some: of each case one partition, all of them in turn
#include "RankParts.h"
#include "RankSurfaces.h"

#include "vtkDataArray.h"
#include "vtkLineSource.h"
#include "vtkMPIController.h"
#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkSPHComponents.h"
#include "vtkSPHFlux.h"
#include "vtkSPHGauge.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace
{

using Data = vtkSmartPointer<vtkPolyData>;
using Table = vtkSmartPointer<vtkTable>;

struct Result
{
  Table Rows;
  Data Surface; // null: there is none
};

using Run = std::function<Result(vtkPolyData*, vtkMultiProcessController*)>;

/// Upright ones, and some that run through all of the particles.
Result Measure(vtkSPHGauge* gauge, vtkPolyData* particles, const double b[6],
  vtkMultiProcessController* controller)
{
  gauge->SetController(controller);
  gauge->SetInputData(particles);
  for (int i = 0; i < 40; ++i)
  {
    const double s = (i % 8 + 0.5) / 8, t = (i / 8 + 0.3) / 5;
    const double x = b[0] + s * (b[1] - b[0]), z = b[4] + t * (b[5] - b[4]);
    gauge->AddGauge(("up " + std::to_string(i)).c_str(), x, b[2] - 0.1, z, x, b[3] + 0.1, z);
  }
  gauge->AddGauge("along", b[0] - 1, b[2] + 0.1, b[4], b[1] + 1, b[2] + 0.1, b[5]);
  gauge->AddGauge("across", b[0], b[2], b[4], b[1], b[3], b[5]);
  gauge->AddGauge("far", 100, 100, 100, 101, 100, 100);
  vtkNew<vtkLineSource> line; // as rank 0 alone has it, if it were asked for its piece
  line->SetPoint1(b[0], b[2] + 0.02, 0.5 * (b[4] + b[5]));
  line->SetPoint2(b[1], b[2] + 0.02, 0.5 * (b[4] + b[5]));
  gauge->SetLinesConnection(line->GetOutputPort());
  gauge->Update();
  return { gauge->GetOutput(), nullptr };
}

/// Of each shape, some through all of the particles, one outside.
Result MeasureFlux(vtkSPHFlux* flux, vtkPolyData* particles, const double b[6],
  vtkMultiProcessController* controller)
{
  flux->SetController(controller);
  flux->SetInputData(particles);
  const double corner[3] = { b[0] - 0.1, 0.2 * b[3], b[4] }, end1[3] = { b[1], 0.3 * b[3], b[4] },
               end2[3] = { b[0], 0.1 * b[3], b[5] + 0.1 },
               center[3] = { 0.5 * (b[0] + b[1]), b[2], 0.5 * (b[4] + b[5]) },
               normal[3] = { 1, 0.2, 0.1 }, far[3] = { 100, 100, 100 };
  flux->AddRectangle("wall", corner, end1, end2);
  flux->AddDisc("disc", center, normal, 0.6);
  flux->AddDisc("far", far, normal, 1);
  flux->AddBox("box", b);
  flux->Update();
  return { flux->GetOutput(), nullptr };
}

Result Split(vtkMarchingCorrectors* filter, vtkSPHComponents* split, vtkPolyData* particles,
  vtkMultiProcessController* controller)
{
  filter->SetController(controller);
  split->SetController(controller);
  filter->SetInputData(particles);
  split->SetInputConnection(filter->GetOutputPort());
  split->SetParticlesData(particles);
  split->Update();
  return { split->GetTable(), split->GetOutput() };
}

struct Case
{
  const char* Name;
  const char* File;
  Run Do;
};

const char* const Dams = "double_dam_break_small"; // a small one, and one with walls and smoothing lengths that differ
const char* const Dam = "dam_break_45k";

const double* BoundsOf(const char* file)
{
  static const double dams[6] = { -1.5, 1.5, 0.0, 1.0, -1.5, 1.5 }, dam[6] = { 0, 3.2, 0, 0.9, -0.45, 0.45 };
  return file == Dams ? dams : dam;
}

Case Gauges(const char* name, const char* file, void (*setUp)(vtkSPHGauge*))
{
  return { name, file,
    [=](vtkPolyData* particles, vtkMultiProcessController* controller)
    {
      vtkNew<vtkSPHGauge> gauge;
      setUp(gauge);
      return Measure(gauge, particles, BoundsOf(file), controller);
    } };
}

Case Fluxes(const char* name, const char* file, void (*setUp)(vtkSPHFlux*))
{
  return { name, file,
    [=](vtkPolyData* particles, vtkMultiProcessController* controller)
    {
      vtkNew<vtkSPHFlux> flux;
      setUp(flux);
      return MeasureFlux(flux, particles, BoundsOf(file), controller);
    } };
}

Case Pieces(const char* name, const char* file, void (*setUp)(vtkMarchingCorrectors*, vtkSPHComponents*))
{
  return { name, file,
    [=](vtkPolyData* particles, vtkMultiProcessController* controller)
    {
      vtkNew<vtkMarchingCorrectors> filter;
      vtkNew<vtkSPHComponents> split;
      setUp(filter, split);
      return Split(filter, split, particles, controller);
    } };
}

const std::vector<Case> Cases = {
  Gauges("gauges", Dams, [](vtkSPHGauge*) {}),
  Gauges("gauges, periods, computed volumes", Dams,
    [](vtkSPHGauge* gauge)
    {
      gauge->SetPeriodicBounds(-1.0, 1.0, 0.0, 0.0, -1.0, 0.5);
      gauge->DetectArraysOff();
      gauge->SetSmoothingLength(0.06);
    }),
  Gauges("gauges, solids, smoothing lengths that differ, a level", Dam,
    [](vtkSPHGauge* gauge)
    {
      gauge->SetSmoothingLengthArrayName("SmoothingLengthAdaptive");
      gauge->SetFluidArrayName("ParticleType");
      gauge->SetLevel(0.3);
    }),
  Fluxes("fluxes", Dams, [](vtkSPHFlux*) {}),
  Fluxes("fluxes, solids, a period", Dam,
    [](vtkSPHFlux* flux)
    {
      flux->SetFluidArrayName("ParticleType");
      flux->SetPeriodicBounds(0.0, 0.0, 0.0, 0.0, -0.5, 0.5);
    }),
  Pieces("pieces of a free surface, some left out", Dam,
    [](vtkMarchingCorrectors* filter, vtkSPHComponents* split)
    {
      filter->FreeSurfaceOn();
      filter->SetFluidArrayName("ParticleType");
      split->SetFluidArrayName("ParticleType");
      split->SetLeastParticles(2);
    }),
  Pieces("pieces that end at walls, closed", Dam,
    [](vtkMarchingCorrectors* filter, vtkSPHComponents* split)
    {
      filter->FreeSurfaceOn();
      filter->SetFluidArrayName("ParticleType");
      filter->SetSolids(vtkMarchingCorrectors::SOLIDS_WALL);
      filter->SetWallShare(0.4);
      filter->CappingOn();
      split->SetFluidArrayName("ParticleType");
    }),
  Pieces("pieces of a surface that is cut, in a period", Dams,
    [](vtkMarchingCorrectors* filter, vtkSPHComponents* split)
    {
      filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Speed");
      filter->SetValue(0, 2.0);
      filter->SetPeriodicBounds(-1.0, 1.0, 0.0, 0.0, -1.0, 0.5);
      split->SetPeriodicBounds(-1.0, 1.0, 0.0, 0.0, -1.0, 0.5);
    }),
};

/// On rank 0 the same rows, bit for bit; on others none.
std::string CompareTables(vtkTable* table, vtkTable* whole)
{
  if (table->GetNumberOfColumns() == 0)
  {
    return "there are no columns";
  }
  if (table->GetNumberOfRows() != (whole ? whole->GetNumberOfRows() : 0))
  {
    return std::to_string(table->GetNumberOfRows()) + " rows";
  }
  for (vtkIdType c = 0; whole && c < whole->GetNumberOfColumns(); ++c)
  {
    auto* column = vtkDataArray::SafeDownCast(table->GetColumn(c));
    for (vtkIdType row = 0; row < whole->GetNumberOfRows(); ++row)
    {
      const bool isSame = column
        ? IsSameTuple(column, row, vtkDataArray::SafeDownCast(whole->GetColumn(c)), row)
        : table->GetValue(row, c).ToString() == whole->GetValue(row, c).ToString();
      if (!isSame)
      {
        return std::string(whole->GetColumnName(c)) + " of row " + std::to_string(row) + ": " +
          table->GetValue(row, c).ToString() + " instead of " + whole->GetValue(row, c).ToString();
      }
    }
  }
  return "";
}

/// Returns how many ranks have something else for this partition.
int CheckPart(const Case& tried, int part, vtkPolyData* particles, const Result& whole,
  vtkMPIController* controller)
{
  const int rank = controller->GetLocalProcessId(), count = controller->GetNumberOfProcesses();
  const Result result = tried.Do(TakePart(particles, part, rank, count), controller);
  std::string problem = CompareTables(result.Rows, rank == 0 ? whole.Rows.Get() : nullptr);
  if (result.Surface)
  {
    const std::string other =
      CompareWithWhole(controller, result.Surface, rank == 0 ? whole.Surface.Get() : nullptr);
    problem = problem.empty() ? other : problem;
  }
  if (!problem.empty() || rank == 0)
  {
    std::printf("%s, %s: %s\n", tried.Name, PartName(part),
      problem.empty() ? "same" : ("rank " + std::to_string(rank) + ": " + problem).c_str());
    std::fflush(stdout);
  }
  return problem.empty() ? 0 : 1;
}

int Check(int number, bool some, const std::string& folder, vtkMPIController* controller)
{
  const Case& tried = Cases[static_cast<std::size_t>(number)];
  const Data particles = ReadParticles(folder + "/" + tried.File + ".vtp");
  const Result alone = tried.Do(particles, nullptr); // each
  const char* column = alone.Rows->GetColumnByName("crossings") ? "crossings" : "area";
  int wet = 0;
  for (vtkIdType row = 0; row < alone.Rows->GetNumberOfRows(); ++row)
  {
    wet += alone.Surface || alone.Rows->GetValueByName(row, column).ToDouble() > 0.0 ? 1 : 0;
  }
  if (wet < 3)
  {
    std::printf("%s: nothing to compare with\n", tried.Name);
    return 1;
  }
  int failures = 0;
  for (int part = 0; part < PartCount; ++part)
  {
    if (!some || part == number % PartCount)
    {
      failures += CheckPart(tried, part, particles, alone, controller);
    }
  }
  return failures;
}

}

int main(int argc, char* argv[])
{
  vtkNew<vtkMPIController> controller;
  controller->Initialize(&argc, &argv);
  vtkMultiProcessController::SetGlobalController(controller);
  vtkObject::GlobalWarningDisplayOff(); // of gauges that are outside
  int failures = 0, all = 0;
  for (int number = 0; number < static_cast<int>(Cases.size()); ++number)
  {
    failures += Check(number, argc > 2, argv[1], controller);
  }
  controller->AllReduce(&failures, &all, 1, vtkCommunicator::SUM_OP);
  controller->Finalize();
  return all == 0 ? 0 : 1;
}
