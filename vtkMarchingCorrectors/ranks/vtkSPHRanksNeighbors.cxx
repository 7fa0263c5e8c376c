// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Sums over neighbours that several ranks have. Each rank gets the particles in its box of space.
// Smoothing lengths from these particles alone are too long, so spheres with these radii hold all
// neighbours: the rank asks the other ranks for the particles in the spheres.
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkSPHArrays.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHSharedRun.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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

/** Makes a VTK array of an array of the core, which it borrows; empty for a constant. */
vtkSmartPointer<vtkDataArray> Borrow(const mcor_array& array, vtkIdType count)
{
  auto made = vtkSmartPointer<vtkDataArray>::Take(
    vtkDataArray::CreateDataArray(array.type == MCOR_FLOAT32 ? VTK_FLOAT : VTK_DOUBLE));
  made->SetNumberOfComponents(std::max(array.components, 1));
  if (array.data && count > 0)
  {
    made->SetVoidArray(const_cast<void*>(array.data), count * made->GetNumberOfComponents(), 1);
  }
  return made;
}

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

/** A cube with an edge of 2^level, and its number along x, y and z. */
using Cell = std::array<std::int64_t, 4>;

Cell CellOf(std::int64_t level, const double at[3])
{
  Cell cell = { level, 0, 0, 0 };
  for (std::size_t a = 0; a < 3; ++a)
  {
    const double number = std::floor(std::ldexp(at[a], -static_cast<int>(level)));
    cell[a + 1] = static_cast<std::int64_t>(std::min(std::max(number, -4e18), 4e18));
  }
  return cell;
}

/**
 * Adds the cell of a sphere's centre, and the cells of its images that reach into the period. The
 * sphere lies within its cell and the 26 cells around it.
 */
void AddCells(
  const vtkSPHRanksSpace& space, const double at[3], double radius, std::vector<Cell>& cells)
{
  for (int image = 0; image < 27; ++image)
  {
    const int way[3] = { image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1 };
    double x[3];
    bool reaches = true;
    for (int a = 0; a < 3; ++a)
    {
      const double first = space.First[a], length = space.Length[a];
      x[a] = at[a] + way[a] * length;
      reaches = reaches &&
        (way[a] == 0 ||
          (length > 0.0 && x[a] + radius >= first && x[a] - radius <= first + length));
    }
    if (reaches)
    {
      cells.push_back(CellOf(std::ilogb(radius) + 1, x));
    }
  }
}

/** Sorts the cells, and keeps each once. */
void SortOnce(std::vector<Cell>& cells)
{
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

/** Lists the places that lie in these cells, or in one around them. */
std::vector<vtkIdType> ListWithin(
  const std::vector<Cell>& cells, const std::vector<std::array<double, 3>>& places)
{
  std::vector<Cell> all;
  std::vector<std::int64_t> levels;
  for (const Cell& cell : cells)
  {
    for (int i = 0; i < 27; ++i)
    {
      all.push_back({ cell[0], cell[1] + i % 3 - 1, cell[2] + i / 3 % 3 - 1, cell[3] + i / 9 - 1 });
    }
    if (levels.empty() || levels.back() != cell[0])
    {
      levels.push_back(cell[0]);
    }
  }
  SortOnce(all);
  std::vector<vtkIdType> found;
  for (std::size_t i = 0; i < places.size() && !all.empty(); ++i)
  {
    if (std::any_of(levels.begin(), levels.end(),
          [&](std::int64_t level)
          { return std::binary_search(all.begin(), all.end(), CellOf(level, places[i].data())); }))
    {
      found.push_back(static_cast<vtkIdType>(i));
    }
  }
  return found;
}

/**
 * Gets the particles of other ranks that may lie in the spheres around this rank's particles, and
 * appends them to these. order: becomes the new order of this rank's particles: first those whose
 * spheres leave its box. Returns how many these are. Collective.
 */
vtkIdType AskAround(vtkSPHRanks& ranks, const vtkSPHRanksSpace& space,
  const std::vector<double>& radii, vtkSPHRanksArrays& arrays, vtkIdList* order)
{
  auto* positions = vtkDataArray::SafeDownCast(arrays[0]);
  const vtkIdType own = positions->GetNumberOfTuples();
  std::vector<std::vector<Cell>> cells(static_cast<std::size_t>(ranks.GetCount()));
  std::vector<std::array<double, 3>> places(static_cast<std::size_t>(own));
  std::vector<int> reached;
  std::vector<vtkIdType> asking, others;
  for (vtkIdType i = 0; i < own; ++i)
  {
    double* at = places[static_cast<std::size_t>(i)].data();
    positions->GetTuple(i, at);
    space.Enter(at);
    const double radius = Rounding * radii[static_cast<std::size_t>(i)];
    reached.clear();
    if (radius > 0.0 && std::isfinite(radius)) // the core reports any other radius
    {
      space.FindReached(at, radius, reached);
    }
    bool isInside = true;
    for (const int rank : reached)
    {
      if (rank != ranks.GetRank())
      {
        AddCells(space, at, radius, cells[static_cast<std::size_t>(rank)]);
        isInside = false;
      }
    }
    (isInside ? others : asking).push_back(i);
  }
  std::for_each(cells.begin(), cells.end(), SortOnce);
  vtkSPHRanksLists to;
  for (const std::vector<Cell>& asked : ranks.Exchange(std::move(cells)))
  {
    to.push_back(ListWithin(asked, places));
  }
  const vtkSPHRanksArrays came = vtkSPHSendTuples(ranks, arrays, to);
  const vtkIdType count = own + came[0]->GetNumberOfTuples();
  for (const std::vector<vtkIdType>& list : { asking, others })
  {
    std::for_each(list.begin(), list.end(), [order](vtkIdType i) { order->InsertNextId(i); });
  }
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
  space.Divide(ranks, places);
  vtkSPHRanksLists to(static_cast<std::size_t>(ranks.GetCount())), back;
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
      arrays.emplace_back(Borrow(mine.*member, mine.count));
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
    vtkSPHAddCount(this->Filter->RunStatistics, "RankNeighbors",
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

  // Values go back to where the particles came from.
  vtkIdType next = 0;
  for (const vtkIdType count : from)
  {
    back.emplace_back();
    for (const vtkIdType end = next + count; next < end; ++next)
    {
      back.back().push_back(next);
    }
  }
  vtkNew<vtkIdList> numbers;
  for (const std::vector<vtkIdType>& list : to)
  {
    std::for_each(list.begin(), list.end(), [&](vtkIdType i) { numbers->InsertNextId(i); });
  }
  const vtkSPHRanksArrays came =
    vtkSPHPutTuples(vtkSPHSendTuples(ranks, { found.Get() }, back), numbers, mine.count);
  std::copy_n(static_cast<double*>(came[0]->GetVoidPointer(0)), mine.count, values);
  return "";
}
VTK_ABI_NAMESPACE_END
