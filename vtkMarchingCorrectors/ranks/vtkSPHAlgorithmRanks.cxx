// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Steps that all filters share when ranks share a run. Every function here is collective.
#include "vtkSPHAlgorithm.h"

#include "mcor.h"
#include "mcor_parts.h"
#include "vtkPointSet.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanksCalls.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksRun.h"

#include <algorithm>
#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
vtkSPHRanksLists vtkSPHListOwned(const vtkSPHRanksRun& run)
{
  vtkSPHRanksLists owned;
  vtkIdType next = 0;
  for (const vtkIdType count : run.From)
  {
    owned.emplace_back();
    for (const vtkIdType end = next + count; next < end; ++next)
    {
      if (run.Route.FindOwner(run.Near->GetPoint(next)) == run.Ranks.GetRank())
      {
        owned.back().push_back(next);
      }
    }
  }
  return owned;
}

bool vtkSPHAlgorithm::BeginDistributed(
  vtkSPHRanksRun& run, vtkPointSet* particles, std::vector<vtkIdType>* taken)
{
  run.Own = vtkSPHTakeParticles(run.Ranks, particles, *this, taken);
  std::int64_t counts[2] = { run.Own->GetNumberOfPoints(), this->IsAborted() ? 1 : 0 };
  run.Ranks.Reduce(vtkSPHRanks::SUM, counts, 2);
  run.Particles = counts[0];
  return counts[1] == 0;
}

bool vtkSPHAlgorithm::AcceptDistributed(
  vtkSPHRanksRun& run, vtkSPHParticles& particles, bool isUsable, const std::string& consequence)
{
  this->SetUsedNames(&particles, isUsable);
  if (!this->AgreeDistributed(run.Ranks, isUsable ? "" : particles.Error))
  {
    return false;
  }
  std::int64_t fluid = particles.FluidCount;
  run.Ranks.Reduce(vtkSPHRanks::SUM, &fluid, 1);
  run.HasFluid = fluid > 0;
  if (run.Ranks.GetRank() == 0)
  {
    this->WarnOfFluid(particles, fluid, consequence);
  }
  return true;
}

// A rank without points has called nothing, and has no statistics.
void vtkSPHAlgorithm::WarnOfParticlesDistributed(
  vtkSPHRanksRun& run, mcor_input core, const mcor_statistics& statistics)
{
  const std::vector<mcor_statistics> all = run.Ranks.Gather(statistics);
  const auto some = std::find_if(
    all.begin(), all.end(), [](const mcor_statistics& each) { return each.fluid_particles > 0; });
  if (run.Ranks.GetRank() == 0 && some != all.end())
  {
    mcor_options asked = run.Options;
    run.OfAll(core, asked);
    this->WarnOfParticles(core, asked, *some);
  }
}

bool vtkSPHAlgorithm::MeasureDistributed(
  vtkSPHRanksRun& run, vtkSPHParticles& particles, bool forSamples)
{
  const auto measure = forSamples ? mcor_measure_probe_globals : mcor_measure_globals;
  if (!this->SetPeriodDistributed(run.Own, run.Options) ||
    !this->CallCoreDistributed(run, particles,
      [&](mcor_context* context)
      { return measure(context, &particles.Core, &run.Options, &run.Globals); }))
  {
    return false;
  }
  run.Options.dimension = run.Globals.measured.plane.axis > 0 ? 2 : 3;
  return true;
}

void vtkSPHAlgorithm::ShareDistributed(vtkSPHRanksRun& run, const mcor_input& input,
  vtkPolyData* particles, const vtkSPHRanksBalance& balance)
{
  run.Route = vtkSPHFindRoute(run.Ranks, input, run.Options, run.Globals, balance);
  run.Near = vtkSPHSendParticles(run.Ranks, particles, run.Route.To, &run.From);
  run.Options.globals = &run.Globals;
  std::copy(run.Route.Box, run.Route.Box + 6, run.Options.box);
}

bool vtkSPHAlgorithm::AgreeDistributed(vtkSPHRanks& ranks, std::string problem)
{
  const bool good = ranks.Agree(problem);
  if (!good)
  {
    this->Fail(problem);
  }
  return good;
}

bool vtkSPHAlgorithm::CallCoreDistributed(
  vtkSPHRanksRun& run, vtkSPHParticles& particles, const std::function<int(mcor_context*)>& call)
{
  int place, count;
  run.Ranks.FindNeighbors(place, count);
  vtkSPHRanksCalls calls(run.Ranks, run.Route.Partition ? &run.Route : nullptr);
  run.Options.ranks = calls.Get();
  std::string message;
  const int status = this->RunCore(particles, run.Options, call, message, place, count);
  run.Options.ranks = nullptr;
  calls.End(status != MCOR_OK);
  std::int64_t cancelled = status == MCOR_CANCELLED && !calls.WasStopped() ? 1 : 0;
  run.Ranks.Reduce(vtkSPHRanks::GREATEST, &cancelled, 1);
  return this->AgreeDistributed(run.Ranks, message) && cancelled == 0;
}

int vtkSPHAlgorithm::FindDimensionDistributed(vtkPointSet* particles)
{
  vtkSPHParticlesChoice choice(*this);
  vtkSPHRanks ranks(this->Controller);
  const vtkSmartPointer<vtkPolyData> own = vtkSPHTakeParticles(ranks, particles, choice);
  this->FindFluid(choice, own, ranks.MergeRanges());
  vtkSPHRanksCalls calls(ranks);
  const int found = vtkSPHParticles(choice, own).FindDimension(calls.Get(), this->Dimension);
  calls.End(false);
  return found;
}
VTK_ABI_NAMESPACE_END
