// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Projections that many processes share. Each projects its own particles, and sums are exact, so that they are added up
// as they are; only where volumes are computed do particles go to the rank that owns their place.
#include "vtkSPHProjection.h"

#include "mcor.h"
#include "vtkImageData.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksRun.h"

#include <cstdint>
#include <memory>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
bool ComputesVolumes(const mcor_input& input, const mcor_view& view)
{
  return (input.scalar.data || view.weight.data || !mcor_is_given(&input.mass)) &&
    vtkSPHComputesVolumes(input);
}

/** A smoothing length that was estimated from all particles, as if it had been given. */
void SetEstimate(mcor_input& input, const mcor_globals& globals)
{
  if (input.estimate_smoothing_length)
  {
    input.estimate_smoothing_length = input.smoothing_length_is_support_radius = 0;
    input.smoothing_length = {};
    input.smoothing_length.constant = globals.measured.h_estimate;
  }
}
}

void vtkSPHProjection::PlaceDistributed(vtkPointSet* particles, mcor_projection& placed)
{
  vtkSPHRanksRun run(this->Controller);
  if (!this->BeginDistributed(run, particles) || run.Particles == 0)
  {
    return;
  }
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, run.Own, run.Ranks.MergeRanges());
  vtkSPHParticles mine(choice, run.Own);
  std::string problem = mine.CollectParticles() ? "" : mine.Error;
  this->FillOptions(run.Options);
  if (!run.Ranks.Agree(problem) ||
    !(mine.Core.estimate_smoothing_length ? this->MeasureDistributed(run, mine, true)
                                          : this->SetPeriodDistributed(run.Own, run.Options)))
  {
    return;
  }
  SetEstimate(mine.Core, run.Globals);
  const mcor_view view = this->MakeView();
  this->CallCoreDistributed(run, mine,
    [&](mcor_context* context)
    { return mcor_place_view(context, &mine.Core, &run.Options, &view, &placed); });
}

// Nothing here may return on one rank and go on on another: what one finds, all agree on first.
void vtkSPHProjection::ProcessDistributed(vtkPointSet* particles, vtkImageData* image)
{
  vtkSPHRanksRun run(this->Controller);
  if (!this->BeginDistributed(run, particles) || run.Particles == 0)
  {
    return;
  }
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, run.Own, run.Ranks.MergeRanges());
  vtkSPHParticles mine(choice, run.Own);
  mcor_view view = this->MakeView();
  if (!this->AcceptDistributed(run, mine, this->Collect(mine, run.Own, view), "nothing is seen"))
  {
    return;
  }
  this->FillOptions(run.Options);
  const bool computes = ComputesVolumes(mine.Core, view);
  if (!(computes || mine.Core.estimate_smoothing_length
          ? this->MeasureDistributed(run, mine, true)
          : this->SetPeriodDistributed(run.Own, run.Options)))
  {
    return;
  }
  const std::string name = mine.Core.scalar.data ? mine.Interpolated[0].Name : "ColumnDensity";
  std::unique_ptr<vtkSPHParticles> near;
  std::vector<std::uint8_t> counted;
  if (computes && run.HasFluid)
  {
    this->ShareDistributed(run, mine.Core, vtkSPHKeepUsed(run.Own, mine), {});
    near = std::make_unique<vtkSPHParticles>(mine.Description, run.Near);
    const bool isUsable = this->Collect(*near, run.Near, view);
    if (!this->AgreeDistributed(run.Ranks, isUsable ? "" : near->Error))
    {
      return;
    }
    for (vtkIdType i = 0; i < run.Near->GetNumberOfPoints(); ++i)
    {
      counted.push_back(run.Route.FindOwner(run.Near->GetPoint(i)) == run.Ranks.GetRank() ? 1 : 0);
    }
    counted.push_back(0); // not null where there are none
    view.counted = counted.data();
  }
  vtkSPHParticles& input = near ? *near : mine;
  if (!near)
  {
    SetEstimate(mine.Core, run.Globals);
  }
  mcor_projection found = {};
  const std::unique_ptr<mcor_projection, decltype(&mcor_free_projection)> freeFound(
    &found, mcor_free_projection);
  if (this->CallCoreDistributed(run, input,
        [&](mcor_context* context)
        { return mcor_project(context, &input.Core, &run.Options, &view, &found); }))
  {
    vtkSPHAddRunStatistics(this->RunStatistics, found.statistics);
    this->Fill(image, name, found);
  }
}
VTK_ABI_NAMESPACE_END
