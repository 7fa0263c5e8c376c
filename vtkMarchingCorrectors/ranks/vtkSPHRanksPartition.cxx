// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksPartition.h"

#include "vtkSPHRanks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** Samples for each rank's share of the work: shares come out even within some percent. */
constexpr std::int64_t SamplesPerRank = 1024;

constexpr double Infinity = std::numeric_limits<double>::infinity();

std::size_t Index(int i)
{
  return static_cast<std::size_t>(i);
}
}

// A sample stands for `step` of the work; where there is little, all of it is sampled.
vtkSPHRanksPartition::vtkSPHRanksPartition(vtkSPHRanks& ranks, const vtkSPHRanksBox& whole,
  const std::vector<vtkSPHRanksPlace>& places, double brick)
{
  std::int64_t all = 0, before = 0;
  for (const vtkSPHRanksPlace& place : places)
  {
    all += place.Work;
  }
  ranks.Reduce(vtkSPHRanks::SUM, &all, 1);
  const std::int64_t step = std::max<std::int64_t>(1, all / (SamplesPerRank * ranks.GetCount()));
  std::vector<vtkSPHRanksPlace> own, sampled;
  for (const vtkSPHRanksPlace& place : places)
  {
    const std::int64_t count = (before + place.Work) / step - before / step;
    before += place.Work;
    if (count > 0)
    {
      own.push_back(place);
      own.back().Work = count;
    }
  }
  for (const std::vector<vtkSPHRanksPlace>& theirs : ranks.Gather(own))
  {
    sampled.insert(sampled.end(), theirs.begin(), theirs.end());
  }
  this->Boxes.resize(Index(ranks.GetCount()));
  this->Divide(sampled.begin(), sampled.end(), { 0, ranks.GetCount(), whole }, brick);
}

// Cuts across the longest side of the samples' bounds, at the side of a brick that leaves the work
// below nearest to the goal. Returns the node's number.
int vtkSPHRanksPartition::Divide(Samples begin, Samples end, const Node& node, double brick)
{
  const auto number = this->Nodes.size();
  this->Nodes.push_back(node);
  if (node.Ranks == 1)
  {
    this->Boxes[Index(node.FirstRank)] = node.Box;
    return static_cast<int>(number);
  }
  int axis = 0;
  double longest = -Infinity;
  for (int a = 0; a < 3 && begin != end; ++a)
  {
    const auto ends = std::minmax_element(begin, end,
      [a](const vtkSPHRanksPlace& p, const vtkSPHRanksPlace& q) { return p.At[a] < q.At[a]; });
    const double length = ends.second->At[a] - ends.first->At[a];
    axis = length > longest ? a : axis;
    longest = std::max(longest, length);
  }
  std::sort(begin, end,
    [axis](const vtkSPHRanksPlace& p, const vtkSPHRanksPlace& q)
    { return p.At[axis] < q.At[axis]; });
  const auto workOf = [](Samples from, Samples to)
  {
    return std::accumulate(from, to, std::int64_t(0),
      [](std::int64_t sum, const vtkSPHRanksPlace& place) { return sum + place.Work; });
  };
  const std::int64_t goal = workOf(begin, end) * (node.Ranks / 2) / node.Ranks;
  std::int64_t below = 0;
  Samples middle = begin;
  while (middle != end && below + middle->Work <= goal)
  {
    below += (middle++)->Work;
  }
  const auto isBelow = [axis](const vtkSPHRanksPlace& place, double plane)
  { return place.At[axis] < plane; };
  const double first = middle == end ? 0.0 : std::floor(middle->At[axis] / brick); // or the next
  const std::int64_t less =
    goal - workOf(begin, std::lower_bound(begin, end, first * brick, isBelow));
  const std::int64_t more =
    workOf(begin, std::lower_bound(begin, end, (first + 1.0) * brick, isBelow)) - goal;
  const double plane =
    std::min(std::max((first + (more < less ? 1.0 : 0.0)) * brick, node.Box[Index(2 * axis)]),
      node.Box[Index(2 * axis + 1)]);
  middle = std::lower_bound(begin, end, plane, isBelow);
  Node lower = node, upper = node;
  lower.Ranks = node.Ranks / 2;
  lower.Box[Index(2 * axis + 1)] = plane;
  upper.FirstRank += lower.Ranks;
  upper.Ranks -= lower.Ranks;
  upper.Box[Index(2 * axis)] = plane;
  const int children[2] = { this->Divide(begin, middle, lower, brick),
    this->Divide(middle, end, upper, brick) };
  this->Nodes[number].Axis = axis;
  this->Nodes[number].Plane = plane;
  this->Nodes[number].Low = children[0];
  this->Nodes[number].High = children[1];
  return static_cast<int>(number);
}

int vtkSPHRanksPartition::FindOwner(const double point[3]) const
{
  int at = 0;
  while (this->Nodes[Index(at)].Low >= 0)
  {
    const Node& node = this->Nodes[Index(at)];
    at = point[node.Axis] < node.Plane ? node.Low : node.High;
  }
  return this->Nodes[Index(at)].FirstRank;
}

void vtkSPHRanksPartition::FindOverlaps(const vtkSPHRanksBox& box, std::vector<int>& found) const
{
  int stack[64] = { 0 }; // the tree is as deep as the number of ranks has bits
  for (int depth = 1; depth > 0;)
  {
    const Node& node = this->Nodes[Index(stack[--depth])];
    bool overlaps = true;
    for (int a = 0; a < 3; ++a)
    {
      const double low = node.Box[Index(2 * a)], high = node.Box[Index(2 * a + 1)];
      overlaps =
        overlaps && low < high && box[Index(2 * a)] <= high && box[Index(2 * a + 1)] >= low;
    }
    if (overlaps && node.Low >= 0)
    {
      stack[depth++] = node.High;
      stack[depth++] = node.Low;
    }
    else if (overlaps && std::find(found.begin(), found.end(), node.FirstRank) == found.end())
    {
      found.push_back(node.FirstRank);
    }
  }
}
VTK_ABI_NAMESPACE_END
