// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Places that ranks measure together. Space around them is divided, particles are sent where they reach,
// and each rank measures the parts of all places in its box. The core puts these together.
#include "vtkSPHMeter.h"

#include "mcor.h"
#include "mcor_parts.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksRun.h"
#include "vtkTable.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <set>
#include <tuple>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/**
 * A margin around the places, in cubes, so that even a single line has a box with bricks to cut
 * at.
 */
constexpr double MarginCubes = 4.0;

/**
 * Finds the box around these bounds, as far as there are particles; along periods it is without
 * end.
 */
void FindBox(
  const double low[3], const double high[3], const mcor_globals& globals, mcor_options& options)
{
  const vtkSPHRanksPeriod period(options, globals);
  const double infinity = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    const auto clamp = [&globals, a](double x)
    { return std::min(std::max(x, globals.measured.low[a]), globals.measured.high[a]); };
    const bool isPeriodic = period.Length[a] > 0.0;
    const double margin = MarginCubes * globals.measured.cube;
    options.box[2 * a] = isPeriodic ? -infinity : clamp(low[a]) - margin;
    options.box[2 * a + 1] = isPeriodic ? infinity : clamp(high[a]) + margin;
  }
}
}

// Merges the places of all ranks, each once.
std::vector<vtkSPHMeter::Place> vtkSPHMeter::Merge(
  vtkSPHRanks& ranks, const std::vector<Place>& mine)
{
  // The name, the shape, and the bytes of the numbers, which may be NaN.
  using Known = std::pair<std::string, std::pair<int, std::string>>;
  std::vector<Known> own;
  for (const Place& place : mine)
  {
    own.push_back({ place.Name,
      { place.Shape,
        std::string(reinterpret_cast<const char*>(place.Numbers.data()),
          place.Numbers.size() * sizeof(double)) } });
  }
  std::vector<Place> all;
  std::set<Known> known;
  for (const std::vector<Known>& theirs : ranks.Gather(own))
  {
    const std::set<Known> before = known; // CheckNames() reports two of one rank
    for (const Known& one : theirs)
    {
      if (before.count(one) == 0)
      {
        known.insert(one);
        const std::string& bytes = one.second.second;
        all.push_back(
          { one.first, one.second.first, std::vector<double>(bytes.size() / sizeof(double)) });
        std::memcpy(all.back().Numbers.data(), bytes.data(), bytes.size());
      }
    }
  }
  return all;
}

// No rank may return here while another goes on: all agree first on what one of them has found.
void vtkSPHMeter::ProcessDistributed(vtkPointSet* particles, vtkTable* output)
{
  vtkSPHRanksRun run(this->Controller);
  const std::vector<Place> places = Merge(run.Ranks, this->ListPlaces(this->More));
  if (!this->BeginDistributed(run, particles) || !this->CheckNames(places))
  {
    return;
  }
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, run.Own, run.Ranks.MergeRanges());
  vtkSPHParticles mine(choice, run.Own);
  if (run.Particles > 0 &&
    !this->AcceptDistributed(run, mine, this->Collect(mine), this->GetConsequence()))
  {
    return;
  }
  if (run.HasFluid)
  {
    this->MeasureTogether(run, mine, places, output);
  }
  else
  {
    this->Measure(mine, run.Own, places, output); // without fluid, all ranks write empty readings
  }
  if (run.Ranks.GetRank() > 0)
  {
    output->SetNumberOfRows(0);
  }
}

void vtkSPHMeter::MeasureTogether(
  vtkSPHRanksRun& run, vtkSPHParticles& mine, const std::vector<Place>& places, vtkTable* output)
{
  mcor_options& options = run.Options;
  this->FillOptions(options);
  options.field = MCOR_WEIGHT_SUM;
  options.level_limit = 0;
  options.iso_values = &this->Level;
  options.iso_count = 1;
  if (!this->MeasureDistributed(run, mine, false))
  {
    return;
  }
  const double infinity = std::numeric_limits<double>::infinity();
  double low[3] = { infinity, infinity, infinity }, high[3] = { -infinity, -infinity, -infinity };
  for (const Place& place : places)
  {
    this->AddBounds(place, low, high);
  }
  FindBox(low, high, run.Globals, options);
  this->ShareDistributed(run, mine.Core, vtkSPHKeepUsed(run.Own, mine), {});
  vtkSPHParticles input(mine.Description, run.Near);
  if (!this->AgreeDistributed(run.Ranks, this->Collect(input) ? "" : input.Error))
  {
    return;
  }
  const std::unique_ptr<Found> found = this->MakeFound();
  if (!this->CallCoreDistributed(run, input,
        [&](mcor_context* context) { return found->Call(context, input.Core, options, places); }))
  {
    return;
  }
  vtkSPHAddRunStatistics(this->RunStatistics, found->GetStatistics());
  this->WarnOfParticlesDistributed(run, input.Core, found->GetStatistics());
  // The first rank has the table, and tells the warnings.
  this->Fill(output, places, *found, run.Ranks.GetRank() == 0);
}
VTK_ABI_NAMESPACE_END
