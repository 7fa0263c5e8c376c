// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksRoute.h"

#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace
{
/** Along an edge; cuts need not lie on bricks, but those that do cost least. */
constexpr double BrickCubes = 4.0;

double ValueOf(const mcor_array& array, std::int64_t i)
{
  if (!array.data)
  {
    return array.constant;
  }
  return array.type == MCOR_FLOAT32 ? static_cast<const float*>(array.data)[i]
                                    : static_cast<const double*>(array.data)[i];
}

std::size_t Side(int axis)
{
  return static_cast<std::size_t>(2 * axis);
}

/** The ranks whose boxes are within `reach` of a place or an image of it. */
void FindBoxes(const vtkSPHRanksPartition& partition, const double period[3], const double at[3],
  double reach, std::vector<int>& found)
{
  int last[3];
  for (int a = 0; a < 3; ++a)
  {
    // The core refuses supports of more than two periods.
    const double periods = period[a] > 0.0 ? std::ceil(reach / period[a]) : 0.0;
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
          const double place = at[a] + image[a] * period[a];
          box[Side(a)] = place - reach;
          box[Side(a) + 1] = place + reach;
        }
        partition.FindOverlaps(box, found);
      }
    }
  }
}

/** Whether all within `reach` of a place is. */
bool IsWithin(const vtkSPHRanksBox& box, const double at[3], double reach)
{
  bool isWithin = true;
  for (int a = 0; a < 3; ++a)
  {
    isWithin = isWithin && at[a] - reach > box[Side(a)] && at[a] + reach < box[Side(a) + 1];
  }
  return isWithin;
}

class Router
{
public:
  Router(const mcor_input& input, const mcor_options& options, const mcor_globals& globals)
    : Input(input)
    , Options(options)
    , Globals(globals)
    , Period(options, globals)
  {
    const double factor = mcor_support_factor(options.sph_kernel);
    this->Factor = options.h_scale * factor;
    this->Support = options.h_scale * (input.smoothing_length_is_support_radius ? 1.0 : factor);
    this->LeastMargin = mcor_reach_margin(&options, &globals, 0.0);
    this->HasLevels =
      mcor_reach_margin(&options, &globals, globals.measured.h_max) > this->LeastMargin;
    this->ComputesVolumes = !mcor_is_given(&input.volume) &&
      !(mcor_is_given(&input.mass) && mcor_is_given(&input.density));
    for (int a = 0; a < 3; ++a)
    {
      const double first = this->Period.First[a];
      const bool isPeriodic = this->Period.Length[a] > 0.0;
      const double infinity = std::numeric_limits<double>::infinity();
      double low = isPeriodic ? first : -infinity;
      double high = isPeriodic ? first + this->Period.Length[a] : infinity;
      if (mcor_has_box(&options))
      {
        low = std::min(std::max(low, options.box[2 * a]), high);
        high = std::max(std::min(high, options.box[2 * a + 1]), low);
        // A flat box in the plane of particles holds them.
        high = globals.measured.plane.axis == a + 1 && low == globals.measured.plane.at
          ? std::max(high, std::nextafter(low, infinity))
          : high;
      }
      this->Whole[Side(a)] = low;
      this->Whole[Side(a) + 1] = high;
    }
  }

  /** Where a particle is, within the first period. */
  void Place(std::int64_t i, double at[3]) const
  {
    mcor_array positions = this->Input.positions;
    for (int a = 0; a < 3; ++a)
    {
      at[a] = ValueOf(positions, 3 * i + a);
    }
    this->Period.Take(at);
  }

  bool IsInWhole(const double at[3]) const
  {
    bool isIn = true;
    for (int a = 0; a < 3; ++a)
    {
      isIn = isIn && at[a] >= this->Whole[Side(a)] && at[a] < this->Whole[Side(a) + 1];
    }
    return isIn;
  }

  std::shared_ptr<const vtkSPHRanksPartition> Divide(
    vtkSPHRanks& ranks, const vtkSPHRanksBalance& balance) const
  {
    std::vector<vtkSPHRanksPlace> places;
    places.reserve(balance.Others.size() + static_cast<std::size_t>(this->Input.count));
    places = balance.Others;
    for (std::int64_t i = 0; i < this->Input.count; ++i)
    {
      vtkSPHRanksPlace place = { { 0.0, 0.0, 0.0 }, balance.Of(i) };
      this->Place(i, place.At);
      if (place.Work > 0 && this->IsInWhole(place.At))
      {
        places.push_back(place);
      }
    }
    return std::make_shared<vtkSPHRanksPartition>(
      ranks, this->Whole, std::move(places), BrickCubes * this->Globals.measured.cube);
  }

  /** Scaled support radius. */
  double SupportOf(std::int64_t i) const
  {
    return this->Input.estimate_smoothing_length
      ? this->Globals.measured.h_estimate * this->Factor
      : ValueOf(this->Input.smoothing_length, i) * this->Support;
  }

  /** The scaled support radius, and by how much more a large particle matters than a small one. */
  double ReachOf(std::int64_t i) const
  {
    const double support = this->SupportOf(i);
    return !this->HasLevels ? support
                            : support - this->LeastMargin +
        mcor_reach_margin(&this->Options, &this->Globals, support / this->Factor);
  }

  /** The ranks that a particle at this place, or an image of it, reaches by `radius`. */
  void FindReached(const vtkSPHRanksPartition& partition, const double at[3], double radius,
    std::vector<int>& found) const
  {
    const double reach = radius + this->LeastMargin;
    const int owner = this->IsInWhole(at) ? partition.FindOwner(at) : -1;
    if (owner >= 0 && IsWithin(partition.GetBox(owner), at, reach))
    {
      found.assign(1, owner); // as most are
      return;
    }
    FindBoxes(partition, this->Period.Length, at, reach, found);
  }

  /**
   * How far around its box each rank needs all particles, whatever their supports are: for volumes
   * that are computed, nearest particles and pairs.
   */
  std::vector<double> FindRadii(vtkSPHRanks& ranks, const vtkSPHRanksPartition& partition,
    const vtkSPHRanksBalance& balance) const
  {
    std::vector<double> radii(static_cast<std::size_t>(ranks.GetCount()), 0.0);
    const mcor_options& o = this->Options;
    if (this->ComputesVolumes || o.nearest_particle)
    {
      std::vector<int> found;
      for (std::int64_t i = 0; i < this->Input.count; ++i)
      {
        if (balance.Of(i) == 0)
        {
          continue;
        }
        double at[3];
        this->Place(i, at);
        const double reach = this->ReachOf(i);
        this->FindReached(partition, at, reach, found);
        for (const int rank : found)
        {
          double& radius = radii[static_cast<std::size_t>(rank)];
          radius = std::max(radius, reach);
        }
      }
      ranks.Reduce(vtkSPHRanks::GREATEST, radii.data(), ranks.GetCount());
    }
    const double h = this->Globals.measured.h_max;
    const double pairs = o.seeds == MCOR_PAIRS && o.field != MCOR_WEIGHT_SUM
      ? h + std::max(h, this->Globals.measured.support_max) +
        mcor_reach_margin(&this->Options, &this->Globals, h) - this->LeastMargin
      : 0.0;
    for (double& radius : radii)
    {
      const double cubes = this->LeastMargin;
      const double volumes = this->ComputesVolumes ? radius * (1.0 + 1.0 / o.h_scale) + cubes : 0.0;
      const double nearest = o.nearest_particle ? radius + cubes : 0.0;
      radius = std::max({ radius > 0.0 ? volumes : 0.0, radius > 0.0 ? nearest : 0.0, pairs });
    }
    return radii;
  }

  const mcor_input& Input;
  const mcor_options& Options;
  const mcor_globals& Globals;
  double Support; ///< scaled support radius / what the input's array holds
  double Factor;  ///< scaled support radius / smoothing length
  double LeastMargin;
  bool HasLevels; ///< margins differ
  bool ComputesVolumes;
  vtkSPHRanksPeriod Period;
  vtkSPHRanksBox Whole;
};
}

vtkSPHRanksPeriod::vtkSPHRanksPeriod(const mcor_options& options, const mcor_globals& globals)
{
  for (int a = 0; a < 3; ++a)
  {
    const double edge = globals.measured.edge[a];
    const double first = options.periodic[2 * a];
    // Across the plane of particles in two dimensions it means nothing.
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

vtkSPHRanksLists vtkSPHRanksRoute::ListOwners(vtkPolyData* points) const
{
  vtkSPHRanksLists owners(this->To.size());
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    owners[static_cast<std::size_t>(this->FindOwner(points->GetPoint(i)))].push_back(i);
  }
  return owners;
}

vtkSPHRanksLists vtkSPHListAt(vtkSPHRanksLists places, const std::vector<vtkIdType>& numbers)
{
  for (std::vector<vtkIdType>& list : places)
  {
    for (vtkIdType& place : list)
    {
      place = numbers[static_cast<std::size_t>(place)];
    }
  }
  return places;
}

void vtkSPHRanksRoute::FindReached(const double at[3], double reach, std::vector<int>& found) const
{
  FindBoxes(*this->Partition, this->Period.Length, at, reach, found);
}

vtkSPHRanksRoute vtkSPHFindRoute(vtkSPHRanks& ranks, const mcor_input& input,
  const mcor_options& options, const mcor_globals& globals, const vtkSPHRanksBalance& balance)
{
  const Router router(input, options, globals);
  vtkSPHRanksRoute route = { {}, {}, router.Whole, 0, 0, nullptr, router.Period, 0 };
  route.Partition = router.Divide(ranks, balance);
  const vtkSPHRanksPartition& partition = *route.Partition;
  const std::vector<double> radii = router.FindRadii(ranks, partition, balance);
  const double widest = *std::max_element(radii.begin(), radii.end());
  const auto count = static_cast<std::size_t>(ranks.GetCount());
  route.To.resize(count);
  std::vector<std::int64_t> totals(3 * count, 0);
  std::vector<int> found;
  for (std::int64_t i = 0; i < input.count; ++i)
  {
    if (balance.Of(i) == 0)
    {
      continue;
    }
    double at[3];
    router.Place(i, at);
    const int owner = router.IsInWhole(at) ? partition.FindOwner(at) : -1;
    if (owner >= 0)
    {
      ++totals[static_cast<std::size_t>(owner)];
      totals[2 * count + static_cast<std::size_t>(owner)] += balance.Of(i);
    }
    const double reach = router.ReachOf(i);
    router.FindReached(partition, at, std::max(reach, widest), found);
    for (const int rank : found)
    {
      const auto to = static_cast<std::size_t>(rank);
      std::vector<int> own;
      if (rank != owner && radii[to] < widest && reach < widest)
      {
        router.FindReached(partition, at, std::max(reach, radii[to]), own);
        if (std::find(own.begin(), own.end(), rank) == own.end())
        {
          continue;
        }
      }
      route.To[to].push_back(static_cast<vtkIdType>(i));
      ++totals[count + to];
    }
  }
  ranks.Reduce(vtkSPHRanks::SUM, totals.data(), static_cast<int>(totals.size()));
  const auto self = static_cast<std::size_t>(ranks.GetRank());
  const vtkSPHRanksBox& box = partition.GetBox(ranks.GetRank());
  std::copy(box.begin(), box.end(), route.Box);
  if (box[0] >= box[1] || box[2] >= box[3] || box[4] >= box[5])
  {
    // More ranks than bricks: to the core, which wants a box, one where there is nothing.
    const double nowhere[6] = { 1e300, 2e300, 1e300, 2e300, 1e300, 2e300 };
    std::copy(nowhere, nowhere + 6, route.Box);
  }
  route.OwnedParticles = totals[self];
  route.Particles = totals[count + self];
  route.Work = totals[2 * count + self];
  return route;
}
