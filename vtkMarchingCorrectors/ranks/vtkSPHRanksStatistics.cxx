// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksStatistics.h"

#include "vtkFieldData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksRoute.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
template <typename T>
void Merge(vtkSPHHow how, T& all, T one)
{
  all = how == SUM ? all + one : how == MOST ? std::max(all, one) : all;
}

template <typename T, std::size_t N>
void Merge(vtkSPHHow how, T (&all)[N], const T (&one)[N])
{
  for (std::size_t i = 0; i < N; ++i)
  {
    Merge(how, all[i], one[i]);
  }
}

/** Returns the box around both. */
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

using CountOf = std::function<std::int64_t(const Share&)>;

void AddCount(
  vtkFieldData* run, const char* name, const std::vector<Share>& shares, const CountOf& countOf)
{
  std::vector<std::int64_t> values;
  std::transform(shares.begin(), shares.end(), std::back_inserter(values), countOf);
  vtkSPHAddCount(run, name, values);
}

void AddExchange(vtkFieldData* run, const std::vector<Share>& shares)
{
  AddCount(run, "RankParticles", shares, &Share::OwnedParticles);
  AddCount(run, "RankCopies", shares, &Share::CopiedParticles);
  AddCount(run, "RankBytesSent", shares, &Share::BytesSent);
}

void AddSeconds(vtkFieldData* run, const std::vector<Share>& shares)
{
  std::vector<double> values;
  for (const Share& share : shares)
  {
    const double* seconds = share.Statistics.seconds;
    values.push_back(std::accumulate(seconds, seconds + MCOR_PHASE_COUNT, 0.0));
  }
  vtkSPHAddReal(run, "RankSeconds", values);
}
}

mcor_statistics vtkSPHMergeShares(const std::vector<vtkSPHRanksShare>& shares)
{
  // Takes what is global from the first rank that had work: it is the same on all of these.
  const auto known = std::find_if(shares.begin(), shares.end(),
    [](const vtkSPHRanksShare& share) { return share.Statistics.cube_size > 0.0; });
  mcor_statistics all = known == shares.end() ? mcor_statistics() : known->Statistics;
  Sums sums;
  for (const vtkSPHRanksShare& share : shares)
  {
    AddCells(all, share.Statistics);
    if (known != shares.end() && &share != &*known)
    {
#define STATISTIC(how, when, member, name) Merge(how, all.member, share.Statistics.member);
#include "mcor_statistics.def"
    }
    sums.Add(share);
  }
  sums.Take(all);
  return all;
}

void vtkSPHAddShares(vtkFieldData* run, const std::vector<vtkSPHRanksShare>& shares)
{
  AddExchange(run, shares);
  AddCount(run, "RankWork", shares, &Share::Work);
  AddCount(run, "RankNodesEvaluated", shares,
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
VTK_ABI_NAMESPACE_END
