// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksStatistics.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksRoute.h"
#include "vtkTypeInt64Array.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace
{
/** `all` becomes factor * all + one. */
void AddCounts(mcor_statistics& all, const mcor_statistics& one, int factor)
{
  std::int64_t mcor_statistics::*const counts[] = { &mcor_statistics::particles_in_reach,
    &mcor_statistics::virtual_cells, &mcor_statistics::seed_cells,
    &mcor_statistics::seed_cells_not_intersected, &mcor_statistics::bricks,
    &mcor_statistics::nodes_evaluated, &mcor_statistics::cells_used,
    &mcor_statistics::triangles_before_trimming, &mcor_statistics::cap_triangles,
    &mcor_statistics::ambiguous_faces, &mcor_statistics::joined_faces,
    &mcor_statistics::ambiguous_cells, &mcor_statistics::tunnels,
    &mcor_statistics::correction_count, &mcor_statistics::vertices_corrected,
    &mcor_statistics::newton_evaluations, &mcor_statistics::vertices_above_tolerance,
    &mcor_statistics::trim_vertices, &mcor_statistics::trim_vertices_linear,
    &mcor_statistics::flat_loops };
  for (const auto count : counts)
  {
    all.*count = factor * all.*count + one.*count;
  }
  for (int level = 0; level < MCOR_CUBE_LEVELS; ++level)
  {
    all.cells_of_level[level] = factor * all.cells_of_level[level] + one.cells_of_level[level];
    all.triangles_of_level[level] =
      factor * all.triangles_of_level[level] + one.triangles_of_level[level];
  }
}

void TakeGreatest(mcor_statistics& all, const mcor_statistics& one)
{
  for (int phase = 0; phase < MCOR_PHASE_COUNT; ++phase)
  {
    all.seconds[phase] = std::max(all.seconds[phase], one.seconds[phase]);
  }
  double mcor_statistics::*const reals[] = { &mcor_statistics::build_seconds,
    &mcor_statistics::correction_max, &mcor_statistics::residual_max };
  for (const auto real : reals)
  {
    all.*real = std::max(all.*real, one.*real);
  }
  all.march_rounds = std::max(all.march_rounds, one.march_rounds);
  all.device_bytes_peak = std::max(all.device_bytes_peak, one.device_bytes_peak);
  all.iterations_max = std::max(all.iterations_max, one.iterations_max);
}

/** The box around both. */
void AddCells(mcor_statistics& all, const mcor_statistics& one)
{
  if (one.virtual_cells == 0)
  {
    return;
  }
  for (int a = 0; a < 3; ++a)
  {
    const std::int64_t first = one.lattice_origin[a], last = first + one.lattice_cells[a];
    const bool isFirst = all.virtual_cells == 0;
    const std::int64_t end = isFirst ? last : all.lattice_origin[a] + all.lattice_cells[a];
    all.lattice_origin[a] = isFirst ? first : std::min(all.lattice_origin[a], first);
    all.lattice_cells[a] = std::max(end, last) - all.lattice_origin[a];
  }
}

/** Sums from which means are made again. */
struct Sums
{
  double Points = 0.0, Length = 0.0, Squares = 0.0, Vertices = 0.0, Evaluations = 0.0;

  void Add(const vtkSPHRanksShare& share)
  {
    const mcor_statistics& s = share.Statistics;
    const auto points = static_cast<double>(s.correction_count);
    const auto vertices = static_cast<double>(s.vertices_corrected);
    this->Points += points;
    this->Length += points * s.correction_mean;
    this->Squares += points *
      (s.correction_deviation * s.correction_deviation + s.correction_mean * s.correction_mean);
    this->Vertices += vertices;
    this->Evaluations += std::round(vertices * (s.iterations_mean + 1.0)); // a whole number
  }

  void Take(mcor_statistics& all) const
  {
    const double points = std::max(this->Points, 1.0);
    all.correction_mean = this->Length / points;
    all.correction_deviation =
      std::sqrt(std::max(0.0, this->Squares / points - all.correction_mean * all.correction_mean));
    all.iterations_mean = this->Vertices > 0.0 ? this->Evaluations / this->Vertices - 1.0 : 0.0;
  }
};

using Share = vtkSPHRanksShare;

/** One component for each rank. */
template <typename ArrayT, typename ValueOf>
void Add(vtkFieldData* run, const char* name, const std::vector<Share>& shares, ValueOf valueOf)
{
  auto array = vtkSmartPointer<ArrayT>::New();
  array->SetNumberOfComponents(static_cast<int>(shares.size()));
  array->SetNumberOfTuples(1);
  std::transform(shares.begin(), shares.end(), array->GetPointer(0), valueOf);
  vtkSPHAddArray(run, name, array);
}

void AddCount(
  vtkFieldData* run, const char* name, const std::vector<Share>& shares, std::int64_t Share::*count)
{
  Add<vtkTypeInt64Array>(run, name, shares, std::mem_fn(count));
}

void AddExchange(vtkFieldData* run, const std::vector<Share>& shares)
{
  AddCount(run, "RankParticles", shares, &Share::OwnedParticles);
  AddCount(run, "RankCopies", shares, &Share::CopiedParticles);
  AddCount(run, "RankBytesSent", shares, &Share::BytesSent);
}

void AddSeconds(vtkFieldData* run, const std::vector<Share>& shares)
{
  Add<vtkDoubleArray>(run, "RankSeconds", shares,
    [](const Share& share)
    {
      const double* seconds = share.Statistics.seconds;
      return std::accumulate(seconds, seconds + MCOR_PHASE_COUNT, 0.0);
    });
}
}

mcor_statistics vtkSPHMergeShares(const std::vector<vtkSPHRanksShare>& shares)
{
  // Of the first rank that had something to do: what is global is the same on all of these.
  const auto known = std::find_if(shares.begin(), shares.end(),
    [](const vtkSPHRanksShare& share) { return share.Statistics.cube_size > 0.0; });
  mcor_statistics all = known == shares.end() ? mcor_statistics() : known->Statistics;
  AddCounts(all, mcor_statistics(), 0);
  Sums sums;
  for (const vtkSPHRanksShare& share : shares)
  {
    AddCells(all, share.Statistics);
    AddCounts(all, share.Statistics, 1);
    TakeGreatest(all, share.Statistics);
    sums.Add(share);
  }
  sums.Take(all);
  return all;
}

void vtkSPHAddShares(vtkFieldData* run, const std::vector<vtkSPHRanksShare>& shares)
{
  AddExchange(run, shares);
  AddCount(run, "RankWork", shares, &Share::Work);
  Add<vtkTypeInt64Array>(run, "RankNodesEvaluated", shares,
    [](const Share& share) { return share.Statistics.nodes_evaluated; });
  AddCount(run, "RankTriangles", shares, &Share::Triangles);
  AddSeconds(run, shares);
}

void vtkSPHAddSampleShares(
  vtkSPHRanks& ranks, vtkFieldData* run, const vtkSPHRanksRoute& route, std::int64_t points)
{
  vtkDataArray* seconds = run->GetArray("Seconds");
  Share mine = {};
  mine.Points = points;
  mine.OwnedParticles = route.OwnedParticles;
  mine.CopiedParticles = route.Particles - route.OwnedParticles;
  mine.BytesSent = ranks.GetBytesSent();
  mine.Statistics.seconds[0] =
    seconds ? seconds->GetComponent(0, seconds->GetNumberOfComponents() - 1) : 0.0;
  const std::vector<Share> shares = ranks.Gather(mine);
  AddExchange(run, shares);
  AddCount(run, "RankPoints", shares, &Share::Points);
  AddSeconds(run, shares);
}
