// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// What the filters that many processes share have in common. All of this is collective.
#include "vtkSPHAlgorithm.h"

#include "mcor.h"
#include "mcor_parts.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksCalls.h"
#include "vtkSPHRanksParticles.h"

#include <limits>
#include <string>
#include <vector>

bool vtkSPHAlgorithm::CallCoreDistributed(vtkSPHRanks& ranks, vtkSPHParticles& particles,
  mcor_options& options, const std::function<int(mcor_context*)>& call,
  const std::function<void(const double at[3], double reach, std::vector<int>& found)>& near)
{
  int place, count;
  ranks.FindNeighbors(place, count);
  vtkSPHRanksCalls calls(ranks, near);
  options.ranks = calls.Get();
  std::string message;
  const int status = this->RunCore(particles, options, call, message, place, count);
  options.ranks = nullptr;
  calls.End(status != MCOR_OK);
  std::int64_t cancelled = status == MCOR_CANCELLED && !calls.WasStopped() ? 1 : 0;
  ranks.Reduce(vtkSPHRanks::GREATEST, &cancelled, 1);
  const bool good = ranks.Agree(message);
  if (!good)
  {
    this->Fail(message);
  }
  return good && cancelled == 0;
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

bool vtkSPHAlgorithm::HasFluidDistributed(
  vtkSPHRanks& ranks, vtkSPHParticles& particles, const std::string& consequence)
{
  std::int64_t fluid = particles.FluidCount;
  ranks.Reduce(vtkSPHRanks::SUM, &fluid, 1);
  if (ranks.GetRank() == 0)
  {
    this->WarnOfFluid(particles, fluid, consequence);
  }
  return fluid > 0;
}

bool vtkSPHAlgorithm::MeasureGlobalsDistributed(vtkSPHRanks& ranks, vtkSPHParticles& particles,
  mcor_options& options, bool forSamples, mcor_globals& globals)
{
  const auto measure = forSamples ? mcor_measure_probe_globals : mcor_measure_globals;
  if (!this->CallCoreDistributed(ranks, particles, options,
        [&](mcor_context* context)
        { return measure(context, &particles.Core, &options, &globals); }))
  {
    return false;
  }
  const int axis = globals.measured.plane.axis - 1;
  options.dimension = axis >= 0 ? 2 : 3;
  if (axis >= 0)
  { // a period across the plane means nothing
    options.periodic[2 * axis] = options.periodic[2 * axis + 1] = 0.0;
    double* box = options.box + 2 * axis;
    if (mcor_has_box(&options) && box[0] == box[1] && box[0] == globals.measured.plane.at)
    {
      box[0] = -std::numeric_limits<double>::infinity(); // flat boxes cannot be divided
      box[1] = -box[0];
    }
  }
  return true;
}

// All have the same arrays; what varies on one of them varies.
vtkSPHRequest vtkSPHAlgorithm::FindFirstRequestDistributed(
  vtkSPHRanks& ranks, vtkPointSet* particles)
{
  return this->FindFirstRequest(particles,
    [&ranks](std::vector<double>& ends)
    { ranks.Reduce(vtkSPHRanks::LEAST, ends.data(), static_cast<int>(ends.size())); });
}

// All have the same arrays, or no particles.
void vtkSPHAlgorithm::FindFluidDistributed(
  vtkSPHRanks& ranks, vtkSPHParticlesChoice& choice, vtkPointSet* particles)
{
  if (this->DetectFluid)
  {
    vtkSPHParticles::FindFluid(
      choice, particles, [&ranks](double ends[2]) { ranks.Reduce(vtkSPHRanks::LEAST, ends, 2); });
  }
}

int vtkSPHAlgorithm::FindDimensionDistributed(vtkPointSet* particles)
{
  vtkSPHParticlesChoice choice(*this);
  vtkSPHRanks ranks(this->Controller);
  const vtkSmartPointer<vtkPolyData> own = vtkSPHTakeParticles(ranks, particles);
  this->FindFluidDistributed(ranks, choice, own);
  vtkSPHRanksCalls calls(ranks);
  const int found = vtkSPHParticles(choice, own).FindDimension(calls.Get(), this->Dimension);
  calls.End(false);
  return found;
}
