// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Derivatives that many processes share. Space is divided among them as for a surface; the rank that
// owns a particle's place finds its derivatives, which then travel to where the particle came from.
#include "vtkSPHDerivatives.h"

#include "mcor.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHDerivativesWanted.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksRoute.h"
#include "vtkSPHRanksStatistics.h"
#include "vtkSPHRanksTuples.h"

#include <algorithm>
#include <memory>

namespace
{
using Lists = vtkSPHRanksLists;

/** Of particles that came, those from each rank that this one owns. */
Lists ListOwned(
  vtkPolyData* near, const std::vector<vtkIdType>& from, const vtkSPHRanksRoute& route, int self)
{
  Lists owned;
  vtkIdType next = 0;
  for (const vtkIdType count : from)
  {
    owned.emplace_back();
    for (const vtkIdType end = next + count; next < end; ++next)
    {
      double at[3];
      near->GetPoint(next, at);
      if (route.FindOwner(at) == self)
      {
        owned.back().push_back(next);
      }
    }
  }
  return owned;
}

/** Of this rank's particles, the numbers of those that each rank owns. */
Lists ListOwners(vtkPolyData* own, vtkIdList* numbers, const vtkSPHRanksRoute& route, int ranks)
{
  Lists owners(static_cast<std::size_t>(ranks));
  for (vtkIdType i = 0; i < own->GetNumberOfPoints(); ++i)
  {
    double at[3];
    own->GetPoint(i, at);
    owners[static_cast<std::size_t>(route.FindOwner(at))].push_back(numbers->GetId(i));
  }
  return owners;
}
}

// Nothing here may return on one rank and go on on another: what one finds, all agree on first.
void vtkSPHDerivatives::ProcessDistributed(vtkPointSet* particles, vtkPointSet* output)
{
  vtkSPHRanks ranks(this->Controller);
  vtkNew<vtkIdList> numbers;
  const vtkSmartPointer<vtkPolyData> own = vtkSPHTakeParticles(ranks, particles, numbers);
  std::int64_t counts[2] = { own->GetNumberOfPoints(), this->IsAborted() ? 1 : 0 };
  ranks.Reduce(vtkSPHRanks::SUM, counts, 2);
  if (counts[1] > 0)
  {
    return;
  }
  bool hasFluid = false;
  vtkSPHParticlesChoice choice;
  this->FillChoice(choice);
  this->FindFluidDistributed(ranks, choice, own);
  vtkSPHParticles mine(choice, own);
  if (counts[0] > 0)
  {
    const bool isUsable =
      mine.CollectArray(this->FindFirstRequestDistributed(ranks, own)) && mine.CollectParticles();
    this->SetUsedNames(&mine);
    if (!this->AgreeDistributed(ranks, isUsable ? "" : mine.Error))
    {
      return;
    }
    hasFluid = this->HasFluidDistributed(ranks, choice, mine, "there are no derivatives");
  }
  vtkNew<vtkPointData> found;
  const vtkIdType count = particles ? particles->GetNumberOfPoints() : 0;
  if ((!hasFluid || this->DeriveDistributed(ranks, own, mine, numbers, count, found)) &&
    particles && output)
  {
    output->ShallowCopy(particles);
    for (int i = 0; i < found->GetNumberOfArrays(); ++i)
    {
      output->GetPointData()->AddArray(found->GetArray(i));
    }
  }
}

bool vtkSPHDerivatives::DeriveDistributed(vtkSPHRanks& ranks, vtkPolyData* own,
  vtkSPHParticles& mine, vtkIdList* numbers, vtkIdType count, vtkPointData* results)
{
  const vtkWanted wanted = this->ListWanted(own);
  const mcor_gradient form =
    this->CorrectGradients ? MCOR_GRADIENT_CORRECTED : MCOR_GRADIENT_STANDARD;
  mcor_options options;
  this->FillOptions(options);
  if (!this->SetPeriodDistributed(ranks, own, options))
  {
    return false;
  }
  mcor_globals globals = {};
  const std::unique_ptr<mcor_globals, decltype(&mcor_free_globals)> freeGlobals(
    &globals, mcor_free_globals);
  if (!this->MeasureGlobalsDistributed(ranks, mine, options, true, globals))
  {
    return false;
  }
  const std::string name = mine.Interpolated[0].Name;
  if (globals.components[0].not_finite >= 0)
  {
    this->FailNotFinite(name, globals.components[0].not_finite);
    return false;
  }
  const vtkSPHRanksRoute route = vtkSPHFindRoute(ranks, mine.Core, options, globals);
  std::vector<vtkIdType> from;
  const vtkSmartPointer<vtkPolyData> near =
    vtkSPHSendParticles(ranks, vtkSPHKeepUsed(own, mine), route.To, &from);
  vtkSPHParticles input(mine.Description, near);
  const vtkSPHRequest request = { near->GetPointData()->GetAbstractArray(name.c_str()), name,
    true };
  const bool isUsable = input.CollectArray(request) && input.CollectParticles();
  if (!this->AgreeDistributed(ranks, isUsable ? "" : input.Error))
  {
    return false;
  }
  options.globals = &globals;
  std::copy(route.Box, route.Box + 6, options.box);
  mcor_derivatives derivatives = {};
  const std::unique_ptr<mcor_derivatives, decltype(&mcor_free_derivatives)> freeDerivatives(
    &derivatives, mcor_free_derivatives);
  if (!this->CallCoreDistributed(ranks, input, options,
        [&](mcor_context* context)
        { return mcor_derive(context, &input.Core, &options, form, &derivatives); }))
  {
    return false;
  }
  vtkNew<vtkPointData> found;
  const bool hasRoom = wanted.AddTo(found, derivatives, input.Interpolated[0]);
  if (!this->AgreeDistributed(ranks, hasRoom ? "" : vtkWanted::DescribeNoMemory(derivatives.count)))
  {
    return false;
  }
  vtkSPHReturnArrays(ranks, found, ListOwned(near, from, route, ranks.GetRank()),
    ListOwners(own, numbers, route, ranks.GetCount()), count, results);
  vtkSPHAddRunStatistics(this->RunStatistics, derivatives.statistics);
  vtkSPHAddSampleShares(ranks, this->RunStatistics, route, route.OwnedParticles);
  return true;
}
