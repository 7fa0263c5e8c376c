// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Computes sums over neighbours that lie on several ranks. Each rank gets the particles in its box
// of space. Smoothing lengths that are found from these particles alone are never too short. So
// spheres that are somewhat larger than the supports of these lengths hold all neighbours: the rank
// asks the other ranks for the particles in the spheres. For densities, the smoothing lengths are
// known.
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkIncrementalOctreePointLocator.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHSharedRun.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** All particles within this number of support radii around a particle must be known, see mcor_find_smoothing_lengths. */
constexpr double Around = 1.25;
/** Radii are multiplied by this number, because places that are moved into the period are rounded. */
constexpr double Rounding = 1.0001;

/** The arrays of an input that are sent to other ranks. */
using Members = std::vector<mcor_array mcor_input::*>;

/** Returns the input `like` with the particles of `arrays` in place of the rank's own. In the result, no particle is solid. */
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

/**
 * Lists, for each rank, the points in that rank's spheres, or in images of these spheres. Points far
 * away do not slow an octree down, but would slow down a locator with buckets of one size. VTK's
 * other trees keep places in single precision, so they would miss neighbours far from the origin.
 */
vtkSPHRanksLists ListWithin(const vtkSPHRanksSpace& space,
  const std::vector<std::vector<Sphere>>& spheresOfRanks, vtkPoints* points)
{
  if (points->GetNumberOfPoints() == 0) // VTK makes no tree of nothing
  {
    return vtkSPHRanksLists(spheresOfRanks.size());
  }
  vtkNew<vtkPolyData> set;
  set->SetPoints(points);
  vtkNew<vtkIncrementalOctreePointLocator> tree;
  tree->SetDataSet(set);
  tree->BuildLocator();
  // The number of images on each side.
  const int last[3] = { space.IsPeriodic(0), space.IsPeriodic(1), space.IsPeriodic(2) };
  vtkSPHRanksLists lists;
  vtkNew<vtkIdList> within;
  for (const std::vector<Sphere>& spheres : spheresOfRanks)
  {
    std::set<vtkIdType> all;
    for (const Sphere& sphere : spheres)
    {
      for (int x = -last[0]; x <= last[0]; ++x)
      {
        for (int y = -last[1]; y <= last[1]; ++y)
        {
          for (int z = -last[2]; z <= last[2]; ++z)
          {
            const double at[3] = { sphere[0] + x * space.Length[0], sphere[1] + y * space.Length[1],
              sphere[2] + z * space.Length[2] };
            tree->FindPointsWithinRadius(sphere[3], at, within);
            all.insert(within->begin(), within->end());
          }
        }
      }
    }
    lists.emplace_back(all.begin(), all.end());
  }
  return lists;
}

/**
 * Gets the particles of other ranks that lie in spheres of these radii around this rank's particles,
 * and appends them to `arrays`. Returns the number of particles whose spheres reach
 * other ranks' boxes; these come first in `order`, the new order of this rank's particles. Collective.
 */
vtkIdType AskAround(vtkSPHRanks& ranks, const vtkSPHRanksSpace& space,
  const std::vector<double>& radii, vtkSPHRanksArrays& arrays, vtkIdList* order)
{
  const vtkIdType own = arrays[0]->GetNumberOfTuples();
  std::vector<std::vector<Sphere>> asked(static_cast<std::size_t>(ranks.GetCount()));
  vtkNew<vtkPoints> places;
  places->SetDataTypeToDouble();
  std::vector<int> reached;
  std::vector<vtkIdType> others;
  for (vtkIdType i = 0; i < own; ++i)
  {
    double at[3];
    vtkDataArray::SafeDownCast(arrays[0])->GetTuple(i, at);
    space.Enter(at);
    places->InsertNextPoint(at);
    const double radius = Rounding * radii[static_cast<std::size_t>(i)];
    reached.clear();
    if (radius > 0.0 && std::isfinite(radius)) // the core reports any other radius
    {
      space.FindReached(at, radius, reached);
    }
    reached.erase(std::remove(reached.begin(), reached.end(), ranks.GetRank()), reached.end());
    for (const int rank : reached)
    {
      asked[static_cast<std::size_t>(rank)].push_back({ at[0], at[1], at[2], radius });
    }
    if (reached.empty())
    {
      others.push_back(i);
    }
    else
    {
      order->InsertNextId(i);
    }
  }
  const vtkIdType asking = order->GetNumberOfIds();
  std::for_each(others.begin(), others.end(), [order](vtkIdType i) { order->InsertNextId(i); });
  const vtkSPHRanksArrays came =
    vtkSPHSendTuples(ranks, arrays, ListWithin(space, ranks.Exchange(std::move(asked)), places));
  const vtkIdType count = own + came[0]->GetNumberOfTuples();
  for (std::size_t a = 0; a < arrays.size(); ++a)
  {
    const vtkSmartPointer<vtkAbstractArray> all = vtkSPHMakeLike(arrays[a], count);
    arrays[a]->GetTuples(order, all);
    all->InsertTuples(own, count - own, 0, came[a]);
    arrays[a] = all;
  }
  return asking;
}
}

std::string vtkSPHAlgorithm::vtkSharedRun::SumNeighbors(vtkPointSet* points, const mcor_input& mine,
  const mcor_options& asked, const double* ratio, double* values)
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

  // For the first `count` particles in `arrays`, computes sums over all particles in `arrays`. Returns false if a rank failed.
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
  const auto explain = [&] // the rank that the particle came from knows its number
  {
    std::string known = vtkSPHSumNeighbors(mine, options, ratio, mine.count, values);
    return ranks.Agree(known) ? problem : known;
  };
  if (ratio && !sum(own, found->GetPointer(0)))
  {
    return explain();
  }
  const double support = mcor_support_factor(options.sph_kernel);
  const double unit = ratio                   ? Around * support
    : mine.smoothing_length_is_support_radius ? 1.0
                                              : support;
  const mcor_input near = ViewOf(arrays, members, mine);
  std::vector<double> sums;
  for (vtkIdType i = 0; i < own; ++i)
  {
    sums.push_back(unit * (ratio ? found->GetValue(i) : vtkSPHValueOf(near.smoothing_length, i)));
  }
  vtkNew<vtkIdList> order;
  const vtkIdType asking = AskAround(ranks, space, sums, arrays, order);
  this->AddShare("RankNeighbors", static_cast<std::int64_t>(arrays[0]->GetNumberOfTuples() - own));
  const vtkIdType count = ratio ? asking : own;
  if (!sum(count, sums.data()))
  {
    return explain();
  }
  for (vtkIdType k = 0; k < count; ++k)
  {
    found->SetValue(order->GetId(k), sums[static_cast<std::size_t>(k)]);
  }
  const vtkSPHRanksArrays came =
    vtkSPHReturnTuples(ranks, { found.Get() }, from, nullptr, to, mine.count);
  std::copy_n(static_cast<double*>(came[0]->GetVoidPointer(0)), mine.count, values);
  return "";
}
VTK_ABI_NAMESPACE_END
