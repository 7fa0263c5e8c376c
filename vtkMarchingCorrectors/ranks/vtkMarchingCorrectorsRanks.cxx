// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// A run that several processes (ranks) share. Each hands over the particles that it has. Space is
// divided among the ranks, and particles are sent where they are needed. Each rank extracts the
// part of the surface in its box, as the core does for any box. Points and triangles get the
// numbers that they have in the whole surface.
#include "vtkMarchingCorrectors.h"

#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkMarchingCorrectorsInput.h"
#include "vtkMarchingCorrectorsOutput.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHRanksCalls.h"
#include "vtkSPHRanksLines.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksPoints.h"
#include "vtkSPHRanksRun.h"
#include "vtkSPHRanksStatistics.h"
#include "vtkSPHRanksTuples.h"
#include "vtkSPHRanksWork.h"

#include <algorithm>
#include <memory>

VTK_ABI_NAMESPACE_BEGIN
void vtkMarchingCorrectors::EstimateDistributed(
  vtkSPHRanks& ranks, const mcor_input& own, const mcor_options& options)
{
  double least = mcor_least_smoothing_length(&own);
  ranks.Reduce(vtkSPHRanks::LEAST, &least, 1);
  this->EstimatedCells = mcor_estimate_cells(&own, &options, least);
  ranks.Reduce(vtkSPHRanks::SUM, &this->EstimatedCells, 1);
  if (ranks.GetRank() == 0)
  {
    this->WarnOfHugeRun();
  }
}

// No rank may return here while another goes on: all agree first on what one of them has found.
void vtkMarchingCorrectors::ProcessDistributed(vtkPointSet* particles, vtkPolyData* output)
{
  vtkSPHRanksRun run(this->Controller);
  if (!this->BeginDistributed(run, particles) || run.Particles == 0)
  {
    this->SetUsedNames(nullptr);
    return;
  }
  const auto merge = run.Ranks.MergeRanges();
  mcor_options& options = run.Options;
  vtkMarchingCorrectorsChoice choice;
  this->FillOptions(options);
  this->FillChoice(choice, run.Own);
  this->FindFluid(choice, run.Own, merge);
  choice.Scalar = this->FindFirstRequest(run.Own, merge);
  choice.ComputedArrays = vtkMarchingCorrectorsOutput::ComputedArrays(options);
  vtkMarchingCorrectorsInput mine(choice, run.Own);
  if (!this->AcceptDistributed(run, mine, mine.Collect(), "no surface") || !run.HasFluid)
  {
    return;
  }
  std::vector<double> isoValues;
  vtkSPHRanksCalls calls(run.Ranks);
  this->ListIsoValues(mine, calls.Get(), isoValues);
  calls.End(isoValues.empty());
  options.iso_values = isoValues.data();
  options.iso_count = static_cast<int>(isoValues.size());
  options = mcor_spell_out(&options);
  if (!(options.widen > 1.0))
  {
    this->ContourDistributed(run, choice, mine, output);
    return;
  }
  if (this->WidenDistributed(run, mine))
  {
    options.widen = 1.0;
    choice.IsWidened = true;
    choice.Scalar = this->FindFirstRequest(run.Own, merge);
    vtkMarchingCorrectorsInput widened(choice, run.Own);
    widened.Collect(); // as before
    this->ContourDistributed(run, choice, widened, output);
  }
}

// The rank that owns a particle's place finds its factor, which then travels to where the particle came from.
bool vtkMarchingCorrectors::WidenDistributed(vtkSPHRanksRun& run, vtkMarchingCorrectorsInput& mine)
{
  vtkSPHRanksRun sums(this->Controller);
  sums.Own = run.Own;
  sums.Options = run.Options;
  sums.Options.level_limit = 0;
  std::fill(sums.Options.box, sums.Options.box + 6, 0.0);
  if (!this->MeasureDistributed(sums, mine, false))
  {
    return false;
  }
  this->ShareDistributed(sums, mine.Core, vtkSPHKeepUsed(sums.Own, mine), {});
  vtkSPHParticles input(mine.Description, sums.Near);
  if (!this->AgreeDistributed(sums.Ranks, input.CollectParticles() ? "" : input.Error))
  {
    return false;
  }
  mcor_widening widening = {};
  if (!this->CallCoreDistributed(sums, input,
        [&](mcor_context* context)
        { return mcor_widen(context, &input.Core, &sums.Options, &widening); }))
  {
    mcor_free_widening(&widening);
    return false;
  }
  const vtkIdType near = sums.Near->GetNumberOfPoints();
  vtkNew<vtkPointData> found;
  vtkSPHAddArray(found, "Widening", vtkSPHAdopt(widening.factor, 1, near));
  if (vtkSPHComputesVolumes(mine.Core))
  {
    vtkSPHAddArray(found, "WideningVolume", vtkSPHAdopt(widening.volume, 1, near));
  }
  mcor_free_widening(&widening);
  for (const auto& array :
    vtkSPHReturnTuples(sums.Ranks, vtkSPHListArrays(found), vtkSPHListOwned(sums),
      sums.Route.ListOwners(run.Own), run.Own->GetNumberOfPoints()))
  {
    run.Own->GetPointData()->AddArray(array);
  }
  return true;
}

void vtkMarchingCorrectors::ContourDistributed(vtkSPHRanksRun& run,
  vtkMarchingCorrectorsChoice& choice, vtkMarchingCorrectorsInput& mine, vtkPolyData* output)
{
  mcor_options& options = run.Options;
  options.outputs |= MCOR_OUT_POINT_KEYS | MCOR_OUT_TRIANGLE_KEYS;
  options.outputs |= mine.FromNearest.empty() ? 0 : MCOR_OUT_NEAREST_PARTICLE;
  if (this->MeasureDistributed(run, mine, false))
  {
    this->EstimateDistributed(run.Ranks, mine.Core, options);
    this->ExtractDistributed(run, choice, mine.Core, output);
  }
}

// Extracts this rank's part from the particles near its box.
void vtkMarchingCorrectors::ExtractDistributed(vtkSPHRanksRun& run,
  vtkMarchingCorrectorsChoice& choice, const mcor_input& own, vtkPolyData* output)
{
  mcor_options& options = run.Options;
  const mcor_options whole = options;
  vtkSPHRanksBalance balance;
  balance.Work = this->Partition == BY_WORK ? vtkSPHExpectWork(run.Ranks, own, options, run.Globals)
                                            : vtkSPHCountWork(own, options);
  this->ShareDistributed(run, own, run.Own, balance);
  const bool isNamed =
    choice.Scalar.Name.empty() && choice.Scalar.Array && choice.Scalar.Array->GetName();
  const std::string scalarName = isNamed ? choice.Scalar.Array->GetName() : "";
  this->FillRequests(choice, run.Near);
  if (isNamed)
  {
    choice.Scalar.Array = run.Near->GetPointData()->GetAbstractArray(scalarName.c_str());
  }
  vtkMarchingCorrectorsInput input(choice, run.Near);
  if (!this->AgreeDistributed(run.Ranks, input.Collect() ? "" : input.Error))
  {
    return;
  }
  mcor_surface surface = {};
  const std::unique_ptr<mcor_surface, decltype(&mcor_free_surface)> freeSurface(
    &surface, mcor_free_surface);
  if (this->CallCoreDistributed(run, input,
        [&](mcor_context* context)
        { return mcor_extract(context, &input.Core, &options, &surface); }))
  {
    this->FinishDistributed(run, input, whole, surface, output);
  }
}

void vtkMarchingCorrectors::FinishDistributed(vtkSPHRanksRun& run,
  vtkMarchingCorrectorsInput& input, mcor_options options, mcor_surface& surface,
  vtkPolyData* output)
{
  vtkSPHRanks& ranks = run.Ranks;
  const mcor_plane& plane = run.Globals.measured.plane;
  const vtkSPHRanksNumbers numbers = vtkSPHNumber(ranks, surface);
  const std::vector<vtkSPHRanksShare> shares = ranks.Gather(vtkSPHRanksShare{ surface.statistics,
    surface.point_count, surface.triangle_count, run.Route.OwnedParticles,
    run.Route.Particles - run.Route.OwnedParticles, ranks.GetBytesSent(), run.Route.Work });
  surface.statistics = vtkSPHMergeShares(shares);
  const std::unique_ptr<vtkSPHRanksLines> lines = plane.axis > 0
    ? std::make_unique<vtkSPHRanksLines>(ranks, surface, numbers, plane, options.filled != 0)
    : nullptr;
  if (lines && lines->HasFailed())
  {
    this->Fail("Memory for the lines of all processes could not be allocated.");
    return;
  }
  if (!lines)
  {
    vtkSPHMeasure(ranks, surface, numbers.OfPoints, surface.statistics);
  }
  vtkMarchingCorrectorsOutput builder(input, options, surface);
  const std::vector<double> largest =
    ranks.Gather(builder.FindLargestFloat(this->OutputPointsPrecision));
  if (ranks.GetRank() == 0)
  {
    mcor_surface all = {};
    all.statistics = surface.statistics;
    all.point_count = numbers.Points;
    all.triangle_count = numbers.Triangles;
    all.line_count = lines ? lines->GetCount() : 0;
    all.attribute_not_finite = surface.attribute_not_finite;
    mcor_input core = input.Core;
    mcor_options asked = options;
    run.OfAll(core, asked);
    asked.dimension = this->Dimension; // the user's choice, not what was found
    this->WarnOf(input, all, core, asked, *std::max_element(largest.begin(), largest.end()));
  }
  this->Summarize(input, options, surface.statistics);
  builder.AddRun(this->RunStatistics);
  vtkSPHAddCount(this->RunStatistics, "Points", { numbers.Points });
  vtkSPHAddCount(this->RunStatistics, "Triangles", { numbers.Triangles });
  if (lines)
  {
    vtkSPHAddCount(this->RunStatistics, "Lines", { lines->GetCount() });
  }
  vtkSPHAddShares(this->RunStatistics, shares);
  builder.BuildMesh(output, this->OutputPointsPrecision, ranks.MergeRanges());
  output->GetPointData()->SetGlobalIds(numbers.OfPoints);
  output->GetCellData()->SetGlobalIds(numbers.OfTriangles);
  vtkSPHMatchEmpty(ranks, output);
  if (lines)
  {
    lines->Move(ranks, output);
    vtkSPHMatchEmpty(ranks, output);
  }
}
VTK_ABI_NAMESPACE_END
