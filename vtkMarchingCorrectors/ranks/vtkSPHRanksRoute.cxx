// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksRoute.h"

#include "vtkSPHReals.h"
#include "vtkSPHRun.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** Cubes along an edge of a brick. Cuts may lie anywhere, but those between bricks cost least. */
constexpr double BrickCubes = 4.0;

/** Samples for each rank's share of the work: shares come out even within some percent. */
constexpr std::int64_t SamplesPerRank = 1024;

constexpr double Infinity = std::numeric_limits<double>::infinity();

std::size_t Index(int i)
{
  return static_cast<std::size_t>(i);
}

/** Whether everything within `reach` of a place is in the box. */
bool IsWithin(const vtkSPHRanksBox& box, const double at[3], double reach)
{
  bool isWithin = true;
  for (int a = 0; a < 3; ++a)
  {
    isWithin =
      isWithin && at[a] - reach > box[Index(2 * a)] && at[a] + reach < box[Index(2 * a + 1)];
  }
  return isWithin;
}

/** Finds a route, step by step. */
class Router
{
public:
  Router(const mcor_input& input, const mcor_options& options, const mcor_globals& globals,
    const vtkSPHRanksBalance& balance)
    : Input(input)
    , Options(options)
    , Globals(globals)
    , Balance(balance)
  {
    const double factor = mcor_support_factor(options.sph_kernel);
    this->Factor = options.h_scale * factor;
    this->Support = options.h_scale * (input.smoothing_length_is_support_radius ? 1.0 : factor);
    this->LeastMargin = mcor_reach_margin(&options, &globals, 0.0);
    this->HasLevels =
      mcor_reach_margin(&options, &globals, globals.measured.h_max) > this->LeastMargin;
    this->ComputesVolumes = vtkSPHComputesVolumes(input);
    this->Route.Period = vtkSPHRanksPeriod(options, globals);
  }

  vtkSPHRanksRoute Find(vtkSPHRanks& ranks)
  {
    this->FindWhole();
    this->Divide(ranks);
    this->Send(ranks, this->FindRadii(ranks));
    const vtkSPHRanksBox& box = this->Route.Partition->GetBox(ranks.GetRank());
    std::copy(box.begin(), box.end(), this->Route.Box);
    if (box[0] >= box[1] || box[2] >= box[3] || box[4] >= box[5])
    {
      // There are more ranks than bricks: the core wants a box, so this rank gets one where there
      // is nothing.
      const double nowhere[6] = { 1e300, 2e300, 1e300, 2e300, 1e300, 2e300 };
      std::copy(nowhere, nowhere + 6, this->Route.Box);
    }
    return std::move(this->Route);
  }

private:
  void FindWhole()
  {
    const vtkSPHRanksPeriod& period = this->Route.Period;
    const mcor_plane& plane = this->Globals.measured.plane;
    const double* box = this->Options.box;
    for (int a = 0; a < 3; ++a)
    {
      const bool isPeriodic = period.Length[a] > 0.0;
      double low = isPeriodic ? period.First[a] : -Infinity;
      double high = isPeriodic ? period.First[a] + period.Length[a] : Infinity;
      if (mcor_has_box(&this->Options))
      {
        low = std::min(std::max(low, box[2 * a]), high);
        high = std::max(std::min(high, box[2 * a + 1]), low);
        // A flat box in the plane of particles must hold them.
        high = plane.axis == a + 1 && low == plane.at
          ? std::max(high, std::nextafter(low, Infinity))
          : high;
      }
      this->Route.Whole[Index(2 * a)] = low;
      this->Route.Whole[Index(2 * a + 1)] = high;
    }
  }

  /**
   * Calls visit(i, at, owner) for each particle that is needed. at: its place in the first
   * period; owner: the rank that owns it, -1 beyond all boxes, and until space is divided.
   */
  template <typename Visit>
  void ForEach(const Visit& visit) const
  {
    for (std::int64_t i = 0; i < this->Input.count; ++i)
    {
      if (this->Balance.Of(i) > 0)
      {
        double at[3];
        for (int a = 0; a < 3; ++a)
        {
          at[a] = vtkSPHValueOf(this->Input.positions, 3 * i + a);
        }
        this->Route.Period.Take(at);
        const bool isOwned = this->Route.Partition && this->IsInWhole(at);
        visit(i, at, isOwned ? this->Route.Partition->FindOwner(at) : -1);
      }
    }
  }

  bool IsInWhole(const double at[3]) const
  {
    bool isIn = true;
    for (int a = 0; a < 3; ++a)
    {
      isIn = isIn && at[a] >= this->Route.Whole[Index(2 * a)] &&
        at[a] < this->Route.Whole[Index(2 * a + 1)];
    }
    return isIn;
  }

  void Divide(vtkSPHRanks& ranks)
  {
    std::vector<vtkSPHRanksPlace> places;
    places.reserve(this->Balance.Others.size() + static_cast<std::size_t>(this->Input.count));
    places = this->Balance.Others;
    this->ForEach(
      [&](std::int64_t i, const double at[3], int)
      {
        if (this->IsInWhole(at))
        {
          places.push_back({ { at[0], at[1], at[2] }, this->Balance.Of(i) });
        }
      });
    this->Route.Partition = std::make_shared<vtkSPHRanksPartition>(
      ranks, this->Route.Whole, places, BrickCubes * this->Globals.measured.cube);
  }

  /**
   * Returns the scaled and widened support radius, enlarged by the margin that a large particle
   * needs more than a small one.
   */
  double ReachOf(std::int64_t i) const
  {
    const double support = this->Input.estimate_smoothing_length
      ? this->Globals.measured.h_estimate * this->Factor
      : vtkSPHValueOf(this->Input.smoothing_length, i) * this->Support;
    const mcor_array& factors = this->Input.widening; // levels are those of the lengths before
    return support * (factors.data ? vtkSPHValueOf(factors, i) : 1.0) +
      (this->HasLevels ? mcor_reach_margin(&this->Options, &this->Globals, support / this->Factor) -
            this->LeastMargin
                       : 0.0);
  }

  /** Finds the ranks that a particle at this place, or an image of it, reaches by `radius`. */
  void FindReached(const double at[3], int owner, double radius, std::vector<int>& found) const
  {
    const double reach = radius + this->LeastMargin;
    if (owner >= 0 && IsWithin(this->Route.Partition->GetBox(owner), at, reach))
    {
      found.assign(1, owner); // the usual case
      return;
    }
    this->Route.FindReached(at, reach, found);
  }

  /**
   * Finds how far around its box each rank needs all particles, whatever their supports: for
   * computed volumes, and for nearest particles.
   */
  std::vector<double> FindRadii(vtkSPHRanks& ranks) const
  {
    std::vector<double> radii(static_cast<std::size_t>(ranks.GetCount()), 0.0);
    const mcor_options& o = this->Options;
    if (this->ComputesVolumes || o.widen > 1.0 || (o.outputs & MCOR_OUT_NEAREST_PARTICLE))
    {
      std::vector<int> found;
      this->ForEach(
        [&](std::int64_t i, const double at[3], int owner)
        {
          const double reach = this->ReachOf(i);
          this->FindReached(at, owner, reach, found);
          for (const int rank : found)
          {
            double& radius = radii[static_cast<std::size_t>(rank)];
            radius = std::max(radius, reach);
          }
        });
      ranks.Reduce(vtkSPHRanks::GREATEST, radii.data(), ranks.GetCount());
    }
    for (double& radius : radii)
    {
      const double cubes = this->LeastMargin;
      const double volumes = this->ComputesVolumes ? radius * (1.0 + 1.0 / o.h_scale) + cubes : 0.0;
      const double nearest = (o.outputs & MCOR_OUT_NEAREST_PARTICLE) ? radius + cubes : 0.0;
      // Sums at particles whose lengths are widened: see mcor_widen.
      const double widened =
        o.widen > 1.0 ? std::max(volumes, radius) * (1.0 + o.widen) + cubes : 0.0;
      radius = radius > 0.0 ? std::max({ volumes, nearest, widened }) : 0.0;
    }
    return radii;
  }

  /** Lists each particle for the ranks that it reaches, or that need all particles so near. */
  void Send(vtkSPHRanks& ranks, const std::vector<double>& radii)
  {
    const double widest = *std::max_element(radii.begin(), radii.end());
    const std::size_t count = radii.size();
    std::vector<std::int64_t> totals(3 * count, 0);
    std::vector<int> found, own;
    this->Route.To.resize(count);
    this->ForEach(
      [&](std::int64_t i, const double at[3], int owner)
      {
        if (owner >= 0)
        {
          ++totals[static_cast<std::size_t>(owner)];
          totals[2 * count + static_cast<std::size_t>(owner)] += this->Balance.Of(i);
        }
        const double reach = this->ReachOf(i);
        this->FindReached(at, owner, std::max(reach, widest), found);
        for (const int rank : found)
        {
          const auto to = static_cast<std::size_t>(rank);
          if (rank != owner && radii[to] < widest && reach < widest)
          {
            this->FindReached(at, owner, std::max(reach, radii[to]), own);
            if (std::find(own.begin(), own.end(), rank) == own.end())
            {
              continue;
            }
          }
          this->Route.To[to].push_back(static_cast<vtkIdType>(i));
          ++totals[count + to];
        }
      });
    ranks.Reduce(vtkSPHRanks::SUM, totals.data(), static_cast<int>(totals.size()));
    const auto self = static_cast<std::size_t>(ranks.GetRank());
    this->Route.OwnedParticles = totals[self];
    this->Route.Particles = totals[count + self];
    this->Route.Work = totals[2 * count + self];
  }

  const mcor_input& Input;
  const mcor_options& Options;
  const mcor_globals& Globals;
  const vtkSPHRanksBalance& Balance;
  double Support; ///< scaled support radius per value of the input's array
  double Factor;  ///< scaled support radius per smoothing length
  double LeastMargin;
  bool HasLevels; ///< the margin depends on the particle
  bool ComputesVolumes;
  vtkSPHRanksRoute Route;
};
}

vtkSPHRanksPeriod::vtkSPHRanksPeriod(const mcor_options& options, const mcor_globals& globals)
{
  for (int a = 0; a < 3; ++a)
  {
    const double edge = globals.measured.edge[a];
    const double first = options.periodic[2 * a];
    // A period across the plane of two dimensions means nothing.
    const bool isAcross = globals.measured.plane.axis == a + 1;
    this->Length[a] = isAcross ? 0.0 : std::max(0.0, options.periodic[2 * a + 1] - first);
    this->First[a] = this->Length[a] > 0.0 ? edge * std::ceil(first / edge - 0.5) : 0.0;
  }
}

void vtkSPHRanksPeriod::Take(double at[3]) const
{
  for (int a = 0; a < 3; ++a)
  {
    if (this->Length[a] > 0.0)
    {
      at[a] -= std::floor((at[a] - this->First[a]) / this->Length[a]) * this->Length[a];
    }
  }
}

int vtkSPHRanksRoute::FindOwner(const double at[3]) const
{
  double place[3] = { at[0], at[1], at[2] };
  this->Period.Take(place);
  return this->Partition->FindOwner(place);
}

vtkSPHRanksLists vtkSPHRanksRoute::ListOwners(vtkDataSet* points) const
{
  vtkSPHRanksLists owners(this->To.size());
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    owners[static_cast<std::size_t>(this->FindOwner(points->GetPoint(i)))].push_back(i);
  }
  return owners;
}

void vtkSPHRanksRoute::FindReached(const double at[3], double reach, std::vector<int>& found) const
{
  int last[3];
  for (int a = 0; a < 3; ++a)
  {
    // The core refuses supports of more than two periods.
    const double periods =
      this->Period.Length[a] > 0.0 ? std::ceil(reach / this->Period.Length[a]) : 0.0;
    last[a] = static_cast<int>(std::min(periods, 3.0));
  }
  found.clear();
  for (int z = -last[2]; z <= last[2]; ++z)
  {
    for (int y = -last[1]; y <= last[1]; ++y)
    {
      for (int x = -last[0]; x <= last[0]; ++x)
      {
        const int image[3] = { x, y, z };
        vtkSPHRanksBox box;
        for (int a = 0; a < 3; ++a)
        {
          const double place = at[a] + image[a] * this->Period.Length[a];
          box[Index(2 * a)] = place - reach;
          box[Index(2 * a + 1)] = place + reach;
        }
        this->Partition->FindOverlaps(box, found);
      }
    }
  }
}

vtkSPHRanksRoute vtkSPHFindRoute(vtkSPHRanks& ranks, const mcor_input& input,
  const mcor_options& options, const mcor_globals& globals, const vtkSPHRanksBalance& balance)
{
  return Router(input, options, globals, balance).Find(ranks);
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
