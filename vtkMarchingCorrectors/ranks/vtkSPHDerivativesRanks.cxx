// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Derivatives that ranks share. Space is divided as for a surface. The rank that owns a particle's
// place computes its derivatives, which are then sent to where the particle came from.
#include "vtkSPHDerivatives.h"

#include "mcor.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHDerivativesWanted.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksRun.h"
#include "vtkSPHRanksStatistics.h"
#include "vtkSPHRanksTuples.h"

#include <memory>

VTK_ABI_NAMESPACE_BEGIN
// No rank may return here while another goes on: all agree first on what one of them has found.
void vtkSPHDerivatives::ProcessDistributed(vtkPointSet* particles, vtkPointSet* output)
{
  vtkSPHRanksRun run(this->Controller);
  std::vector<vtkIdType> numbers;
  if (!this->BeginDistributed(run, particles, &numbers))
  {
    return;
  }
  const auto merge = run.Ranks.MergeRanges();
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, run.Own, merge);
  vtkSPHParticles mine(choice, run.Own);
  if (run.Particles > 0)
  {
    const bool isUsable =
      mine.CollectArray(this->FindFirstRequest(run.Own, merge)) && mine.CollectParticles();
    if (!this->AcceptDistributed(run, mine, isUsable, "there are no derivatives"))
    {
      return;
    }
  }
  if (run.HasFluid)
  {
    this->DeriveDistributed(run, mine, numbers, particles, output);
  }
  else if (particles && output)
  {
    output->ShallowCopy(particles);
  }
}

// numbers: the indices of the particles that the run has.
void vtkSPHDerivatives::DeriveDistributed(vtkSPHRanksRun& run, vtkSPHParticles& mine,
  const std::vector<vtkIdType>& numbers, vtkPointSet* particles, vtkPointSet* output)
{
  const vtkWanted wanted = this->ListWanted(run.Own);
  const mcor_gradient form =
    this->CorrectGradients ? MCOR_GRADIENT_CORRECTED : MCOR_GRADIENT_STANDARD;
  this->FillOptions(run.Options);
  if (!this->MeasureDistributed(run, mine, true))
  {
    return;
  }
  const std::string name = mine.Interpolated[0].Name;
  if (run.Globals.components[0].not_finite >= 0)
  {
    this->FailNotFinite(name, run.Globals.components[0].not_finite);
    return;
  }
  this->ShareDistributed(run, mine.Core, vtkSPHKeepUsed(run.Own, mine), {});
  vtkSPHParticles input(mine.Description, run.Near);
  const vtkSPHRequest request = { run.Near->GetPointData()->GetAbstractArray(name.c_str()), name,
    true };
  const bool isUsable = input.CollectArray(request) && input.CollectParticles();
  if (!this->AgreeDistributed(run.Ranks, isUsable ? "" : input.Error))
  {
    return;
  }
  mcor_derivatives derivatives = {};
  const std::unique_ptr<mcor_derivatives, decltype(&mcor_free_derivatives)> freeDerivatives(
    &derivatives, mcor_free_derivatives);
  if (!this->CallCoreDistributed(run, input,
        [&](mcor_context* context)
        { return mcor_derive(context, &input.Core, &run.Options, form, &derivatives); }))
  {
    return;
  }
  vtkNew<vtkPointData> found;
  const bool hasRoom = wanted.AddTo(found, derivatives, input.Interpolated[0]);
  if (!this->AgreeDistributed(
        run.Ranks, hasRoom ? "" : vtkWanted::DescribeNoMemory(derivatives.count)))
  {
    return;
  }
  const vtkSPHRanksLists home = vtkSPHListAt(run.Route.ListOwners(run.Own), numbers);
  const vtkSPHRanksArrays came = vtkSPHReturnTuples(run.Ranks, vtkSPHListArrays(found),
    vtkSPHListOwned(run), home, particles ? particles->GetNumberOfPoints() : 0);
  vtkSPHAddRunStatistics(this->RunStatistics, derivatives.statistics);
  vtkSPHAddSampleShares(run.Ranks, this->RunStatistics, run.Route, run.Route.OwnedParticles);
  this->WarnOfParticlesDistributed(run, input.Core, derivatives.statistics);
  if (particles && output)
  {
    output->ShallowCopy(particles);
    for (const auto& array : came)
    {
      output->GetPointData()->AddArray(array);
    }
  }
}
VTK_ABI_NAMESPACE_END
