// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksPartition.h"

#include "vtkSPHRanks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
constexpr int Bins = 64; // of a histogram, in each round of the search for a plane

constexpr double Infinity = std::numeric_limits<double>::infinity();

std::size_t Index(int i)
{
  return static_cast<std::size_t>(i);
}
}

vtkSPHRanksPartition::vtkSPHRanksPartition(vtkSPHRanks& ranks, const vtkSPHRanksBox& whole,
  std::vector<vtkSPHRanksPlace> places, double brick)
  : Places(std::move(places))
{
  Node root;
  root.FirstRank = 0;
  root.Ranks = ranks.GetCount();
  root.First = 0;
  root.Last = this->Places.size();
  root.Box = whole;
  this->Nodes.push_back(root);
  this->Divide(ranks, brick);
  this->Boxes.resize(Index(ranks.GetCount()));
  for (const Node& node : this->Nodes)
  {
    if (node.Ranks == 1)
    {
      this->Boxes[Index(node.FirstRank)] = node.Box;
    }
  }
  this->Places = std::vector<vtkSPHRanksPlace>();
}

// Divides all nodes of a depth at once, with one message for them.
void vtkSPHRanksPartition::Divide(vtkSPHRanks& ranks, double brick)
{
  for (std::size_t begin = 0, end = 1; begin < end; begin = end, end = this->Nodes.size())
  {
    std::vector<int> nodes;
    for (std::size_t n = begin; n < end; ++n)
    {
      if (this->Nodes[n].Ranks > 1)
      {
        nodes.push_back(static_cast<int>(n));
      }
    }
    if (!nodes.empty())
    {
      std::vector<Cut> cuts = this->BeginCuts(ranks, nodes, brick);
      while (this->Refine(ranks, cuts, brick))
      {
      }
      this->Apply(cuts, brick);
    }
  }
}

// Cuts across the longest side of the particles' bounds.
std::vector<vtkSPHRanksPartition::Cut> vtkSPHRanksPartition::BeginCuts(
  vtkSPHRanks& ranks, const std::vector<int>& nodes, double brick)
{
  std::vector<double> bounds; // low and high sides of x, y, z
  std::vector<std::int64_t> work;
  for (const int n : nodes)
  {
    const Node& node = this->Nodes[Index(n)];
    double ends[6] = { Infinity, -Infinity, Infinity, -Infinity, Infinity, -Infinity };
    work.push_back(0);
    for (std::size_t p = node.First; p < node.Last; ++p)
    {
      work.back() += this->Places[p].Work;
      for (int a = 0; a < 3; ++a)
      {
        ends[2 * a] = std::min(ends[2 * a], this->Places[p].At[a]);
        ends[2 * a + 1] = std::max(ends[2 * a + 1], this->Places[p].At[a]);
      }
    }
    bounds.insert(bounds.end(), ends, ends + 6);
  }
  ranks.ReduceRanges(bounds.data(), static_cast<int>(3 * nodes.size()));
  ranks.Reduce(vtkSPHRanks::SUM, work.data(), static_cast<int>(work.size()));
  std::vector<Cut> cuts;
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    Node& node = this->Nodes[Index(nodes[i])];
    const double* side = &bounds[6 * i];
    for (int a = 1; a < 3; ++a)
    {
      const double length = side[2 * a + 1] - side[2 * a];
      node.Axis = length > side[2 * node.Axis + 1] - side[2 * node.Axis] ? a : node.Axis;
    }
    const bool isEmpty = work[i] == 0;
    const double low = isEmpty ? 0.0 : std::floor(side[2 * node.Axis] / brick);
    const double high = isEmpty ? 0.0 : std::floor(side[2 * node.Axis + 1] / brick) + 1.0;
    cuts.push_back({ nodes[i], low, 0.0, high - low,
      work[i] / node.Ranks * (node.Ranks / 2) +
        work[i] % node.Ranks * (node.Ranks / 2) / node.Ranks,
      0 });
  }
  return cuts;
}

// Narrows each cut by a histogram; returns false once each has a single plane left.
bool vtkSPHRanksPartition::Refine(vtkSPHRanks& ranks, std::vector<Cut>& cuts, double brick)
{
  const auto isSought = [](const Cut& cut) { return cut.Most - cut.Least > 0.5; };
  if (std::none_of(cuts.begin(), cuts.end(), isSought))
  {
    return false;
  }
  const auto step = [&](const Cut& cut)
  { return std::max(1.0, std::ceil((cut.Most - cut.Least) / Bins)); };
  std::vector<std::int64_t> work(cuts.size() * Bins, 0);
  for (std::size_t i = 0; i < cuts.size(); ++i)
  {
    const Cut& cut = cuts[i];
    const Node& node = this->Nodes[Index(cut.Node)];
    for (std::size_t p = node.First; p < node.Last && isSought(cut); ++p)
    {
      const double at = std::floor(this->Places[p].At[node.Axis] / brick);
      const double bin = std::floor((at - cut.First - cut.Least) / step(cut));
      if (bin >= 0.0 && bin < Bins)
      {
        work[i * Bins + Index(static_cast<int>(bin))] += this->Places[p].Work;
      }
    }
  }
  ranks.Reduce(vtkSPHRanks::SUM, work.data(), static_cast<int>(work.size()));
  for (std::size_t i = 0; i < cuts.size(); ++i)
  {
    Cut& cut = cuts[i];
    if (!isSought(cut))
    {
      continue;
    }
    // Among single bricks, takes the plane whose work below is nearest to the goal.
    const double width = step(cut), least = cut.Least, most = cut.Most;
    int bin = 0;
    std::int64_t below = cut.Before;
    while (bin < Bins - 1 && below + work[i * Bins + Index(bin)] < cut.Goal)
    {
      below += work[i * Bins + Index(bin++)];
    }
    const std::int64_t after = below + work[i * Bins + Index(bin)];
    const bool isNext = width == 1.0 && after - cut.Goal < cut.Goal - below;
    cut.Before = below;
    cut.Least = std::min(least + width * (bin + (isNext ? 1 : 0)), most);
    cut.Most = width == 1.0 ? cut.Least : std::min(cut.Least + width, most);
  }
  return true;
}

void vtkSPHRanksPartition::Apply(const std::vector<Cut>& cuts, double brick)
{
  for (const Cut& cut : cuts)
  {
    Node low = this->Nodes[Index(cut.Node)], high = low;
    const int axis = low.Axis, lowSide = 2 * axis, highSide = lowSide + 1;
    const double plane = std::min(
      std::max((cut.First + cut.Least) * brick, low.Box[Index(lowSide)]), low.Box[Index(highSide)]);
    low.Box[Index(highSide)] = plane;
    high.Box[Index(lowSide)] = plane;
    low.Ranks = low.Ranks / 2;
    high.FirstRank += low.Ranks;
    high.Ranks -= low.Ranks;
    low.Axis = high.Axis = 0;
    Node& node = this->Nodes[Index(cut.Node)];
    const auto places = this->Places.begin();
    const auto middle = std::partition(places + static_cast<std::ptrdiff_t>(node.First),
      places + static_cast<std::ptrdiff_t>(node.Last),
      [axis, plane](const vtkSPHRanksPlace& place) { return place.At[axis] < plane; });
    low.Last = high.First = static_cast<std::size_t>(middle - places);
    node.Plane = plane;
    node.Low = static_cast<int>(this->Nodes.size());
    node.High = node.Low + 1;
    this->Nodes.push_back(low);
    this->Nodes.push_back(high);
  }
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
