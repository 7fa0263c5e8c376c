// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// A run that many processes share. Each hands over the particles that it has; space is divided among
// them; particles go to where they are needed; each process extracts its box's part of the surface, as
// the core does for any box; points and triangles get the numbers that they have in the whole.
#include "vtkMarchingCorrectors.h"

#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkMarchingCorrectorsInput.h"
#include "vtkMarchingCorrectorsOutput.h"
#include "vtkMarchingCorrectorsSummary.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksCalls.h"
#include "vtkSPHRanksLines.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksPoints.h"
#include "vtkSPHRanksRoute.h"
#include "vtkSPHRanksStatistics.h"
#include "vtkSPHRanksWork.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

/** What one rank has made, before the ranks put it together. */
struct vtkMarchingCorrectorsRun
{
  vtkMarchingCorrectorsInput& Input; ///< the particles that reach this rank's box
  mcor_options& Options;             ///< with the user's box
  const vtkSPHRanksRoute& Route;
  mcor_surface& Surface;
  std::int64_t Particles; ///< of all ranks
  const mcor_plane& Plane;
};

std::vector<double> vtkMarchingCorrectors::ListIsoValuesDistributed(
  vtkSPHRanks& ranks, const vtkMarchingCorrectorsInput& input)
{
  if (this->GetNumberOfContours() > 0 || input.Choice.FreeSurface)
  {
    return this->ListIsoValues(input);
  }
  vtkSPHRanksCalls calls(ranks);
  double range[2], value = 0.0;
  calls.End(!mcor_find_iso_value(&input.Core, calls.Get(), range, &value));
  return { value };
}

void vtkMarchingCorrectors::EstimateDistributed(
  vtkSPHRanks& ranks, const mcor_input& own, const mcor_options& options)
{
  double least = vtkMarchingCorrectorsLeastLength(own);
  ranks.Reduce(vtkSPHRanks::LEAST, &least, 1);
  this->EstimatedCells = vtkMarchingCorrectorsEstimateCells(own, options, least);
  ranks.Reduce(vtkSPHRanks::SUM, &this->EstimatedCells, 1);
  if (ranks.GetRank() == 0)
  {
    this->WarnOfHugeRun();
  }
}

// Nothing here may return on one rank and go on on another: what one finds, all agree on first.
void vtkMarchingCorrectors::ProcessDistributed(vtkPointSet* particles, vtkPolyData* output)
{
  vtkSPHRanks ranks(this->Controller);
  const vtkSmartPointer<vtkPolyData> own = vtkSPHTakeParticles(ranks, particles);
  std::int64_t counts[2] = { own->GetNumberOfPoints(), this->IsAborted() ? 1 : 0 };
  ranks.Reduce(vtkSPHRanks::SUM, counts, 2);
  if (counts[0] == 0 || counts[1] > 0)
  {
    this->SetUsedNames(nullptr);
    return;
  }
  mcor_options options;
  vtkMarchingCorrectorsChoice choice;
  this->FillOptions(options);
  this->FillChoice(choice, own);
  this->FindFluidDistributed(ranks, choice, own);
  choice.Scalar = this->FindFirstRequestDistributed(ranks, own);
  choice.ComputedArrays = vtkMarchingCorrectorsOutput::ComputedArrays(options);
  vtkMarchingCorrectorsInput mine(choice, own);
  const bool isUsable = mine.Collect();
  this->SetUsedNames(&mine);
  if (!this->AgreeDistributed(ranks, isUsable ? "" : mine.Error) ||
    !this->HasFluidDistributed(ranks, choice, mine, "no surface") ||
    !this->SetPeriodDistributed(ranks, own, options))
  {
    return;
  }
  const std::vector<double> isoValues = this->ListIsoValuesDistributed(ranks, mine);
  options.iso_values = isoValues.data();
  options.iso_count = static_cast<int>(isoValues.size());
  options.nearest_particle = mine.FromNearest.empty() ? 0 : 1;
  options.point_keys = options.triangle_keys = 1;

  mcor_globals globals = {};
  const std::unique_ptr<mcor_globals, decltype(&mcor_free_globals)> freeGlobals(
    &globals, mcor_free_globals);
  if (!this->MeasureGlobalsDistributed(ranks, mine, options, false, globals))
  {
    return;
  }
  this->EstimateDistributed(ranks, mine.Core, options);
  vtkSPHRanksBalance balance;
  balance.HasWork = true;
  balance.Work = this->Partition == BY_WORK ? vtkSPHExpectWork(ranks, mine.Core, options, globals)
                                            : vtkSPHCountWork(mine.Core, options);
  const vtkSPHRanksRoute route = vtkSPHFindRoute(ranks, mine.Core, options, globals, balance);
  options.globals = &globals;
  this->ExtractDistributed(ranks, choice, own, route, options, counts[0], output);
}

// Of the particles that this rank has, `count` on all, to those that are near its box.
void vtkMarchingCorrectors::ExtractDistributed(vtkSPHRanks& ranks,
  vtkMarchingCorrectorsChoice& choice, vtkPolyData* own, const vtkSPHRanksRoute& route,
  mcor_options options, std::int64_t count, vtkPolyData* output)
{
  const vtkSmartPointer<vtkPolyData> near = vtkSPHSendParticles(ranks, own, route.To);
  const bool isNamed =
    choice.Scalar.Name.empty() && choice.Scalar.Array && choice.Scalar.Array->GetName();
  const std::string scalarName = isNamed ? choice.Scalar.Array->GetName() : "";
  this->FillRequests(choice, near);
  if (isNamed)
  {
    choice.Scalar.Array = near->GetPointData()->GetAbstractArray(scalarName.c_str());
  }
  vtkMarchingCorrectorsInput input(choice, near);
  if (!this->AgreeDistributed(ranks, input.Collect() ? "" : input.Error))
  {
    return;
  }
  mcor_options boxed = options;
  std::copy(route.Box, route.Box + 6, boxed.box);
  mcor_surface surface = {};
  const std::unique_ptr<mcor_surface, decltype(&mcor_free_surface)> freeSurface(
    &surface, mcor_free_surface);
  if (this->CallCoreDistributed(
        ranks, input, boxed,
        [&](mcor_context* context)
        {
          mcor_options shared = boxed;
          mcor_ranks all = *boxed.ranks;
          std::copy(route.Whole.begin(), route.Whole.end(), all.whole_box);
          shared.ranks = &all;
          return mcor_extract(context, &input.Core, &shared, &surface);
        },
        [&route](const double at[3], double reach, std::vector<int>& found)
        { route.FindReached(at, reach, found); }))
  {
    this->FinishDistributed(
      ranks, { input, options, route, surface, count, options.globals->measured.plane }, output);
  }
}

void vtkMarchingCorrectors::FinishDistributed(
  vtkSPHRanks& ranks, const vtkMarchingCorrectorsRun& run, vtkPolyData* output)
{
  mcor_surface& surface = run.Surface;
  vtkIdType points = 0, triangles = 0;
  const vtkSmartPointer<vtkIdTypeArray> numbers = vtkSPHNumberPoints(ranks, surface, points);
  const vtkSmartPointer<vtkIdTypeArray> triangleNumbers =
    vtkSPHNumberTriangles(ranks, surface, triangles);
  const std::vector<vtkSPHRanksShare> shares = ranks.Gather(vtkSPHRanksShare{ surface.statistics,
    surface.point_count, surface.triangle_count, run.Route.OwnedParticles,
    run.Route.Particles - run.Route.OwnedParticles, ranks.GetBytesSent(), run.Route.Work });
  surface.statistics = vtkSPHMergeShares(shares);
  const std::unique_ptr<vtkSPHRanksLines> lines = run.Plane.axis > 0
    ? std::make_unique<vtkSPHRanksLines>(ranks, surface,
        vtkSPHRanksNumbers{ numbers, triangleNumbers, points, triangles }, run.Plane,
        run.Options.filled != 0)
    : nullptr;
  if (lines && lines->HasFailed())
  {
    this->Fail("Memory for the lines of all processes could not be allocated.");
    return;
  }
  if (!lines)
  {
    vtkSPHMeasure(ranks, surface, numbers, surface.statistics);
  }
  if (ranks.GetRank() == 0)
  {
    mcor_surface all = {};
    all.statistics = surface.statistics;
    all.point_count = points;
    all.triangle_count = triangles;
    all.line_count = lines ? lines->GetCount() : 0;
    all.attribute_not_finite = surface.attribute_not_finite;
    mcor_input input = run.Input.Core;
    input.count = run.Particles;
    mcor_options whole = run.Options; // with globals, the core takes all of this for a part
    whole.globals = nullptr;
    whole.dimension = this->Dimension; // as asked for, not as found
    this->WarnOf(run.Input, all, input, whole);
  }
  this->Summarize(run.Input, run.Options, surface.statistics);
  vtkMarchingCorrectorsOutput builder(run.Input, run.Options, surface);
  builder.AddIsoValues(output->GetFieldData());
  builder.AddRun(this->RunStatistics);
  builder.AddMeasures(this->RunStatistics);
  vtkSPHAddCount(this->RunStatistics, "Points", { points });
  vtkSPHAddCount(this->RunStatistics, "Triangles", { triangles });
  if (lines)
  {
    vtkSPHAddCount(this->RunStatistics, "Lines", { lines->GetCount() });
  }
  vtkSPHAddShares(this->RunStatistics, shares);
  builder.BuildMesh(output, this->OutputPointsPrecision,
    [&ranks](std::vector<double>& ends)
    { ranks.Reduce(vtkSPHRanks::LEAST, ends.data(), static_cast<int>(ends.size())); });
  output->GetPointData()->SetGlobalIds(numbers);
  output->GetCellData()->SetGlobalIds(triangleNumbers);
  vtkSPHMatchEmpty(ranks, output);
  if (lines)
  {
    lines->Move(ranks, output);
    vtkSPHMatchEmpty(ranks, output);
  }
}
