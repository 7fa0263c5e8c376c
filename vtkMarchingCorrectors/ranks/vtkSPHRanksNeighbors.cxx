// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Sums over neighbours that several ranks have. Each rank gets the particles in its box of space.
// Smoothing lengths that are found from these particles alone are too long. So spheres with these
// lengths as radii hold all neighbours: the rank asks the other ranks for the particles in the
// spheres.
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkSPHArrays.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHSharedRun.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** How many support radii around a particle must be known, see mcor_find_smoothing_lengths. */
constexpr double Around = 1.25;
/** Allows for the rounding of places in periods. */
constexpr double Rounding = 1.0001;

/** The arrays of an input that travel. */
using Members = std::vector<mcor_array mcor_input::*>;

/** Returns the input with these particles, none of them solid, in place of the rank's own. */
mcor_input ViewOf(const vtkSPHRanksArrays& arrays, const Members& members, const mcor_input& like)
{
  mcor_input input = like;
  input.count = arrays[0]->GetNumberOfTuples();
  input.solid = nullptr;
  for (std::size_t k = 0; k < arrays.size(); ++k)
  {
    input.*members[k] = vtkSPHView(vtkDataArray::SafeDownCast(arrays[k]));
  }
  return input;
}

/** A sphere around a particle: its centre and its radius. */
using Sphere = std::array<double, 4>;

/** A point, and its number. */
using Point = std::pair<std::array<double, 3>, vtkIdType>;

/**
 * Finds points within spheres. Points are sorted as a tree: the middle point of a range divides the
 * others along one axis, and both halves are divided along the next axis. Points far away do not
 * slow the tree down, but would slow down a locator with buckets of one size. VTK's trees keep
 * places in single precision, so they would miss neighbours far from the origin.
 */
class PointTree
{
public:
  explicit PointTree(std::vector<Point> points)
    : Points(std::move(points))
  {
    Sort(this->Points.begin(), this->Points.end(), 0);
  }

  /** Sets within[number] for each point that lies in the sphere. */
  void Mark(const double at[3], double radius, std::vector<bool>& within) const
  {
    Mark(this->Points.begin(), this->Points.end(), 0, at, radius, within);
  }

private:
  using Place = std::vector<Point>::iterator;
  using ConstPlace = std::vector<Point>::const_iterator;

  static void Sort(Place first, Place last, std::size_t axis)
  {
    if (last - first > 1)
    {
      const Place middle = first + (last - first) / 2;
      std::nth_element(first, middle, last,
        [axis](const Point& p, const Point& q) { return p.first[axis] < q.first[axis]; });
      Sort(first, middle, (axis + 1) % 3);
      Sort(middle + 1, last, (axis + 1) % 3);
    }
  }

  static void Mark(ConstPlace first, ConstPlace last, std::size_t axis, const double at[3],
    double radius, std::vector<bool>& within)
  {
    if (first == last)
    {
      return;
    }
    const ConstPlace middle = first + (last - first) / 2;
    const double way = at[axis] - middle->first[axis];
    if (vtkMath::Distance2BetweenPoints(at, middle->first.data()) <= radius * radius)
    {
      within[static_cast<std::size_t>(middle->second)] = true;
    }
    if (way <= radius)
    {
      Mark(first, middle, (axis + 1) % 3, at, radius, within);
    }
    if (-way <= radius)
    {
      Mark(middle + 1, last, (axis + 1) % 3, at, radius, within);
    }
  }

  std::vector<Point> Points;
};

/**
 * Lists the numbers, below `count`, of the tree's points that lie in a sphere, or in an image of
 * one.
 */
std::vector<vtkIdType> ListWithin(const vtkSPHRanksSpace& space, const std::vector<Sphere>& spheres,
  const PointTree& tree, vtkIdType count)
{
  std::vector<bool> areWithin(static_cast<std::size_t>(count));
  for (const Sphere& sphere : spheres)
  {
    for (int image = 0; image < 27; ++image)
    {
      const int way[3] = { image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1 };
      double at[3];
      bool isThere = true;
      for (int a = 0; a < 3; ++a)
      {
        at[a] = sphere[a] + way[a] * space.Length[a];
        isThere = isThere && (way[a] == 0 || space.IsPeriodic(a));
      }
      if (isThere)
      {
        tree.Mark(at, sphere[3], areWithin);
      }
    }
  }
  std::vector<vtkIdType> within;
  for (std::size_t i = 0; i < areWithin.size(); ++i)
  {
    if (areWithin[i])
    {
      within.push_back(static_cast<vtkIdType>(i));
    }
  }
  return within;
}

/**
 * Gets the particles of other ranks that lie in the spheres around this rank's particles, and
 * appends them to `arrays`. order: the new order of this rank's particles: first the particles whose
 * spheres reach other ranks' boxes. Returns the number of these first ones. Collective.
 */
vtkIdType AskAround(vtkSPHRanks& ranks, const vtkSPHRanksSpace& space,
  const std::vector<double>& radii, vtkSPHRanksArrays& arrays, vtkIdList* order)
{
  auto* positions = vtkDataArray::SafeDownCast(arrays[0]);
  const vtkIdType own = positions->GetNumberOfTuples();
  std::vector<std::vector<Sphere>> asked(static_cast<std::size_t>(ranks.GetCount()));
  std::vector<Point> places;
  std::vector<int> reached;
  std::vector<vtkIdType> asking, others;
  for (vtkIdType i = 0; i < own; ++i)
  {
    double at[3];
    positions->GetTuple(i, at);
    space.Enter(at);
    if (std::isfinite(at[0]) && std::isfinite(at[1]) && std::isfinite(at[2]))
    {
      places.push_back({ { at[0], at[1], at[2] }, i });
    }
    const double radius = Rounding * radii[static_cast<std::size_t>(i)];
    reached.clear();
    if (radius > 0.0 && std::isfinite(radius)) // the core reports any other radius
    {
      space.FindReached(at, radius, reached);
    }
    bool asks = false;
    for (const int rank : reached)
    {
      if (rank != ranks.GetRank())
      {
        asked[static_cast<std::size_t>(rank)].push_back({ at[0], at[1], at[2], radius });
        asks = true;
      }
    }
    (asks ? asking : others).push_back(i);
  }
  for (const std::vector<vtkIdType>& list : { asking, others })
  {
    std::for_each(list.begin(), list.end(), [order](vtkIdType i) { order->InsertNextId(i); });
  }
  const PointTree tree(std::move(places));
  vtkSPHRanksLists to;
  for (const std::vector<Sphere>& spheres : ranks.Exchange(std::move(asked)))
  {
    to.push_back(ListWithin(space, spheres, tree, own));
  }
  const vtkSPHRanksArrays came = vtkSPHSendTuples(ranks, arrays, to);
  const vtkIdType count = own + came[0]->GetNumberOfTuples();
  for (std::size_t a = 0; a < arrays.size(); ++a)
  {
    const vtkSmartPointer<vtkAbstractArray> all = vtkSPHMakeLike(arrays[a], count);
    arrays[a]->GetTuples(order, all);
    all->InsertTuples(own, count - own, 0, came[a]);
    arrays[a] = all;
  }
  return static_cast<vtkIdType>(asking.size());
}
}

std::string vtkSPHAlgorithm::vtkSharedRun::SumNeighbors(vtkPointSet* points, const mcor_input& mine,
  const mcor_options& asked, double ratio, double* values)
{
  vtkSPHRanks& ranks = this->Ranks;
  mcor_options options = asked;
  if (this->Filter->DetectPeriod)
  {
    this->Own = points;
    std::string ignored; // SetPeriod() reports the problem
    const std::vector<double> period = this->FindPeriod(ignored);
    std::fill_n(options.periodic, 6, 0.0);
    std::copy(period.begin(), period.end(), options.periodic);
  }
  std::vector<vtkSPHRanksPlace> places;
  bool isFinite = true;
  for (vtkIdType i = 0; i < mine.count; ++i)
  {
    const int mark = mine.solid ? mine.solid[i] : 0;
    if (mark != MCOR_ABSENT && (mark == 0 || !mine.ignore_solids))
    {
      places.push_back({ {}, 1, i });
      for (int a = 0; a < 3; ++a)
      {
        places.back().At[a] = vtkSPHValueOf(mine.positions, 3 * i + a);
        isFinite = isFinite && std::isfinite(places.back().At[a]);
      }
    }
  }
  std::string problem =
    isFinite ? "" : vtkSPHSumNeighbors(mine, options, ratio, 0, values); // the core names the place
  if (!ranks.Agree(problem))
  {
    return problem;
  }
  options.dimension = this->Ask([&](const mcor_ranks* shared)
    { return mcor_find_dimension(&mine, shared, options.dimension); });

  // Each rank gets the particles in its box.
  mcor_globals frame = {};
  frame.measured.h_min = frame.measured.h_max = 1.0;
  for (int a = 0; a < 3; ++a)
  {
    const double length = options.periodic[2 * a + 1] - options.periodic[2 * a];
    frame.measured.edge[a] = length > 0.0 ? length : 1.0;
  }
  vtkSPHRanksSpace space(options, frame);
  for (vtkSPHRanksPlace& place : places)
  {
    space.Enter(place.At);
  }
  space.Divide(ranks, places, ranks.GetCount());
  vtkSPHRanksLists to(static_cast<std::size_t>(ranks.GetCount()));
  for (const vtkSPHRanksPlace& place : places)
  {
    to[static_cast<std::size_t>(space.FindOwner(place.At))].push_back(place.Particle);
  }
  Members members;
  vtkSPHRanksArrays arrays;
  for (const auto member :
    { &mcor_input::positions, &mcor_input::mass, &mcor_input::smoothing_length })
  {
    if ((mine.*member).data)
    {
      members.push_back(member);
      const mcor_array& from = mine.*member;
      const int components = std::max(from.components, 1);
      arrays.emplace_back(from.type == MCOR_FLOAT32
          ? vtkSPHBorrow(static_cast<const float*>(from.data), components, mine.count)
          : vtkSPHBorrow(static_cast<const double*>(from.data), components, mine.count));
    }
  }
  std::vector<vtkIdType> from;
  arrays = vtkSPHSendTuples(ranks, arrays, to, &from);
  const vtkIdType own = arrays[0]->GetNumberOfTuples();

  // Computes sums for the first `count` particles, with all as neighbours. Returns false if a rank
  // failed.
  const auto sum = [&](vtkIdType count, double* sums)
  {
    this->CallAside(
      [&](const mcor_ranks* shared)
      {
        options.ranks = shared;
        problem = vtkSPHSumNeighbors(ViewOf(arrays, members, mine), options, ratio, count, sums);
        return problem.empty();
      });
    options.ranks = nullptr;
    return ranks.Agree(problem);
  };
  vtkNew<vtkDoubleArray> found;
  found->SetNumberOfValues(own);
  bool isGood = ratio > 0.0 ? sum(own, found->GetPointer(0)) : true;
  if (isGood)
  {
    const double support = mcor_support_factor(options.sph_kernel);
    const double unit = ratio > 0.0             ? Around * support
      : mine.smoothing_length_is_support_radius ? 1.0
                                                : support;
    const mcor_input near = ViewOf(arrays, members, mine);
    std::vector<double> sums;
    for (vtkIdType i = 0; i < own; ++i)
    {
      sums.push_back(
        unit * (ratio > 0.0 ? found->GetValue(i) : vtkSPHValueOf(near.smoothing_length, i)));
    }
    vtkNew<vtkIdList> order;
    const vtkIdType asking = AskAround(ranks, space, sums, arrays, order);
    vtkSPHAdd(this->Filter->RunStatistics, "RankNeighbors",
      ranks.Gather(static_cast<std::int64_t>(arrays[0]->GetNumberOfTuples() - own)));
    const vtkIdType count = ratio > 0.0 ? asking : own;
    isGood = sum(count, sums.data());
    for (vtkIdType k = 0; k < count; ++k)
    {
      found->SetValue(order->GetId(k), sums[static_cast<std::size_t>(k)]);
    }
  }
  if (!isGood) // the rank that the particle came from knows its number
  {
    std::string known = vtkSPHSumNeighbors(mine, options, ratio, mine.count, values);
    return ranks.Agree(known) ? problem : known;
  }

  const vtkSPHRanksArrays came =
    vtkSPHReturnTuples(ranks, { found.Get() }, from, nullptr, to, mine.count);
  std::copy_n(static_cast<double*>(came[0]->GetVoidPointer(0)), mine.count, values);
  return "";
}
VTK_ABI_NAMESPACE_END
