// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Gauges that ranks share. Space around the lines is divided, particles are sent where they reach,
// and each rank measures the parts of all lines in its box. The core puts these together.
#include "vtkSPHGauge.h"

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
#include <memory>
#include <set>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/**
 * A margin around the lines, in cubes, so that even a single line has a box with bricks to cut
 * at.
 */
constexpr double MarginCubes = 4.0;

/**
 * Finds the box around the lines, as far as there are particles; along periods it is without
 * end.
 */
void FindBox(
  const std::vector<mcor_gauge_line>& lines, const mcor_globals& globals, mcor_options& options)
{
  const vtkSPHRanksPeriod period(options, globals);
  const double infinity = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    double low = infinity, high = -infinity;
    for (const mcor_gauge_line& line : lines)
    {
      low = std::min({ low, line.from[a], line.to[a] });
      high = std::max({ high, line.from[a], line.to[a] });
    }
    const auto clamp = [&](double x)
    { return std::min(std::max(x, globals.measured.low[a]), globals.measured.high[a]); };
    const bool isPeriodic = period.Length[a] > 0.0;
    const double margin = MarginCubes * globals.measured.cube;
    options.box[2 * a] = isPeriodic ? -infinity : clamp(low) - margin;
    options.box[2 * a + 1] = isPeriodic ? infinity : clamp(high) + margin;
  }
}
}

// Merges the gauges of all ranks, each once.
std::vector<vtkSPHGauge::Gauge> vtkSPHGauge::Merge(
  vtkSPHRanks& ranks, const std::vector<Gauge>& mine)
{
  using Known =
    std::pair<std::string, std::string>; // the name, and the bytes of the ends, which may be NaN
  std::vector<Known> own;
  for (const Gauge& gauge : mine)
  {
    own.emplace_back(gauge.Name,
      std::string(reinterpret_cast<const char*>(gauge.Ends.data()), sizeof(gauge.Ends)));
  }
  std::vector<Gauge> all;
  std::set<Known> known;
  for (const std::vector<Known>& theirs : ranks.Gather(own))
  {
    const std::set<Known> before = known; // CheckNames() reports two of one rank
    for (const Known& one : theirs)
    {
      if (before.count(one) == 0)
      {
        known.insert(one);
        all.push_back({ one.first, {} });
        std::memcpy(all.back().Ends.data(), one.second.data(), one.second.size());
      }
    }
  }
  return all;
}

// No rank may return here while another goes on: all agree first on what one of them has found.
void vtkSPHGauge::ProcessDistributed(vtkPointSet* particles, vtkTable* output)
{
  vtkSPHRanksRun run(this->Controller);
  const std::vector<Gauge> gauges = Merge(run.Ranks, this->ListGauges());
  if (!this->BeginDistributed(run, particles) || !this->CheckNames(gauges))
  {
    return;
  }
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, run.Own, run.Ranks.MergeRanges());
  vtkSPHParticles mine(choice, run.Own);
  if (run.Particles > 0 &&
    !this->AcceptDistributed(run, mine, mine.CollectParticles(), "all gauges are dry"))
  {
    return;
  }
  if (run.HasFluid)
  {
    this->GaugeDistributed(run, mine, gauges, output);
  }
  else
  {
    this->Measure(mine, run.Own, gauges, output); // without fluid, all ranks write empty readings
  }
  if (run.Ranks.GetRank() > 0)
  {
    output->SetNumberOfRows(0);
  }
}

void vtkSPHGauge::GaugeDistributed(
  vtkSPHRanksRun& run, vtkSPHParticles& mine, const std::vector<Gauge>& gauges, vtkTable* output)
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
  const std::vector<mcor_gauge_line> lines = ListLines(gauges);
  FindBox(lines, run.Globals, options);
  this->ShareDistributed(run, mine.Core, vtkSPHKeepUsed(run.Own, mine), {});
  vtkSPHParticles input(mine.Description, run.Near);
  if (!this->AgreeDistributed(run.Ranks, input.CollectParticles() ? "" : input.Error))
  {
    return;
  }
  mcor_gauges found = {};
  const std::unique_ptr<mcor_gauges, decltype(&mcor_free_gauges)> freeGauges(
    &found, mcor_free_gauges);
  const auto count = static_cast<std::int64_t>(lines.size());
  if (!this->CallCoreDistributed(run, input,
        [&](mcor_context* context)
        { return mcor_gauge(context, &input.Core, &options, lines.data(), count, &found); }))
  {
    return;
  }
  vtkSPHAddRunStatistics(this->RunStatistics, found.statistics);
  this->WarnOfParticlesDistributed(run, input.Core, found.statistics);
  if (run.Ranks.GetRank() > 0)
  {
    mcor_free_gauges(&found); // the first rank has the table, and tells the warnings
  }
  this->Fill(output, gauges, found, true);
}
VTK_ABI_NAMESPACE_END
