// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Sums over neighbours that several ranks have. Space is divided among the ranks, and each gets the
// particles in its box. Its smoothing lengths without the others' particles are too long, so the
// spheres of these lengths hold all neighbours: it asks the other ranks for the particles there.
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
#include <limits>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** So many support radii around a particle must be known, see mcor_find_smoothing_lengths. */
constexpr double Around = 1.25;
/** Allows for the rounding of places in periods. */
constexpr double Rounding = 1.0001;

using Doubles = vtkSmartPointer<vtkDoubleArray>;

Doubles MakeDoubles(int components, vtkIdType count)
{
  auto array = Doubles::New();
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(count);
  return array;
}

/** Copies positions, masses and lengths as the core reads them. Returns whether places are finite. */
bool CopyInput(const mcor_input& mine, vtkSPHRanksArrays& copies)
{
  const Doubles x = MakeDoubles(3, mine.count), m = MakeDoubles(1, mine.count),
                h = MakeDoubles(1, mine.count);
  bool isFinite = true;
  for (vtkIdType i = 0; i < mine.count; ++i)
  {
    m->SetValue(i, vtkSPHValueOf(mine.mass, i));
    h->SetValue(i, vtkSPHValueOf(mine.smoothing_length, i));
    for (vtkIdType k = 3 * i; k < 3 * i + 3; ++k)
    {
      x->SetValue(k, vtkSPHValueOf(mine.positions, k));
      const bool counts = !mine.solid || mine.solid[i] != MCOR_ABSENT;
      isFinite = isFinite && (!counts || std::isfinite(x->GetValue(k)));
    }
  }
  copies = { x.Get(), m.Get(), h.Get() };
  return isFinite;
}

double* ValuesOf(const vtkSmartPointer<vtkAbstractArray>& array)
{
  return static_cast<double*>(array->GetVoidPointer(0));
}

/** The input with these particles, which all play a part, in place of the rank's own. */
mcor_input ViewOf(const vtkSPHRanksArrays& arrays, const mcor_input& like)
{
  mcor_input input = like;
  input.count = arrays[0]->GetNumberOfTuples();
  input.solid = nullptr;
  input.positions = vtkSPHView(vtkDataArray::SafeDownCast(arrays[0]));
  if (like.mass.data)
  {
    input.mass = vtkSPHView(vtkDataArray::SafeDownCast(arrays[1]));
  }
  if (like.smoothing_length.data)
  {
    input.smoothing_length = vtkSPHView(vtkDataArray::SafeDownCast(arrays[2]));
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
 * Adds the cell that a sphere's middle is in, and those of its images that reach into the period. The
 * sphere lies within this cell and the 26 around it.
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

/** Sorts, and leaves each one once. */
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
 * Gets the particles of other ranks that may lie in the spheres around this rank's own, and puts them
 * behind these. order: the places of its own among all; those whose spheres leave its box come
 * first, and their count is returned. Collective.
 */
vtkIdType AskAround(vtkSPHRanks& ranks, const vtkSPHRanksSpace& space, const double* radii,
  vtkSPHRanksArrays& arrays, vtkIdList* order)
{
  const vtkIdType own = arrays[0]->GetNumberOfTuples();
  std::vector<std::vector<Cell>> cells(static_cast<std::size_t>(ranks.GetCount()));
  std::vector<std::array<double, 3>> places(static_cast<std::size_t>(own));
  std::vector<int> reached;
  std::vector<vtkIdType> asking, others;
  for (vtkIdType i = 0; i < own; ++i)
  {
    double* at = places[static_cast<std::size_t>(i)].data();
    std::copy_n(ValuesOf(arrays[0]) + 3 * i, 3, at);
    space.Enter(at);
    const double radius = Rounding * radii[i];
    reached.clear();
    if (radius > 0.0 && std::isfinite(radius)) // else the core reports it
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
    std::string ignored; // SetPeriod() reports it
    const std::vector<double> period = this->FindPeriod(ignored);
    std::fill_n(options.periodic, 6, 0.0);
    std::copy(period.begin(), period.end(), options.periodic);
  }
  vtkSPHRanksArrays arrays;
  const bool isFinite = CopyInput(mine, arrays);
  std::string problem =
    isFinite ? "" : vtkSPHSumNeighbors(mine, options, ratio, 0, values); // the core names it
  if (!ranks.Agree(problem))
  {
    return problem;
  }
  options.dimension = this->Ask([&](const mcor_ranks* shared)
    { return mcor_find_dimension(&mine, shared, options.dimension); });

  // Space is divided: cuts may lie anywhere.
  const double infinity = std::numeric_limits<double>::infinity();
  double box[6] = { infinity, -infinity, infinity, -infinity, infinity, -infinity };
  std::vector<vtkSPHRanksPlace> places;
  for (vtkIdType i = 0; i < mine.count; ++i)
  {
    const int mark = mine.solid ? mine.solid[i] : 0;
    if (mark != MCOR_ABSENT && (mark == 0 || !mine.ignore_solids))
    {
      places.push_back({ {}, 1, i });
      std::copy_n(ValuesOf(arrays[0]) + 3 * i, 3, places.back().At);
      for (int a = 0; a < 3; ++a)
      {
        box[2 * a] = std::min(box[2 * a], places.back().At[a]);
        box[2 * a + 1] = std::max(box[2 * a + 1], places.back().At[a]);
      }
    }
  }
  ranks.ReduceRanges(box, 3);
  const double extent = std::max({ box[1] - box[0], box[3] - box[2], box[5] - box[4] });
  mcor_globals frame = {};
  frame.measured.h_min = frame.measured.h_max = 1.0;
  frame.measured.cube = extent > 0.0 ? std::ldexp(extent, -30) : 1.0;
  for (int a = 0; a < 3; ++a)
  {
    const double length = options.periodic[2 * a + 1] - options.periodic[2 * a];
    frame.measured.edge[a] = length > 0.0 ? length : 1.0;
  }
  vtkSPHRanksSpace space(options, frame);
  std::for_each(
    places.begin(), places.end(), [&](vtkSPHRanksPlace& place) { space.Enter(place.At); });
  space.Divide(ranks, places);

  // Each rank gets the particles in its box.
  vtkSPHRanksLists to(static_cast<std::size_t>(ranks.GetCount()));
  for (const vtkSPHRanksPlace& place : places)
  {
    to[static_cast<std::size_t>(space.FindOwner(place.At))].push_back(place.Particle);
  }
  std::vector<vtkIdType> from;
  arrays = vtkSPHSendTuples(ranks, arrays, to, &from);
  const vtkIdType own = arrays[0]->GetNumberOfTuples();

  // Sums for the first particles, with all as neighbours. Returns whether all ranks have done that.
  const auto sum = [&](vtkIdType count, double* sums)
  {
    this->CallAside(
      [&](const mcor_ranks* shared)
      {
        options.ranks = shared;
        problem = vtkSPHSumNeighbors(ViewOf(arrays, mine), options, ratio, count, sums);
        return problem.empty();
      });
    options.ranks = nullptr;
    return ranks.Agree(problem);
  };
  const Doubles found = MakeDoubles(1, own), sums = MakeDoubles(1, own);
  double* radii = sums->GetPointer(0);
  bool isGood = ratio > 0.0 ? sum(own, found->GetPointer(0)) : true;
  if (isGood)
  {
    const double support = mcor_support_factor(options.sph_kernel);
    const double unit = ratio > 0.0             ? Around * support
      : mine.smoothing_length_is_support_radius ? 1.0
                                                : support;
    const double* lengths = ratio > 0.0 ? found->GetPointer(0) : ValuesOf(arrays[2]);
    std::transform(lengths, lengths + own, radii, [unit](double h) { return unit * h; });
    vtkNew<vtkIdList> order;
    const vtkIdType asking = AskAround(ranks, space, radii, arrays, order);
    vtkSPHAddCount(this->Filter->RunStatistics, "RankNeighbors",
      ranks.Gather(static_cast<std::int64_t>(arrays[0]->GetNumberOfTuples() - own)));
    const vtkIdType count = ratio > 0.0 ? asking : own;
    isGood = sum(count, sums->GetPointer(0));
    for (vtkIdType k = 0; k < count; ++k)
    {
      found->SetValue(order->GetId(k), sums->GetValue(k));
    }
  }
  if (!isGood) // a rank that has the particle in question knows its number
  {
    std::string known = vtkSPHSumNeighbors(mine, options, ratio, mine.count, values);
    return ranks.Agree(known) ? problem : known;
  }

  // Values go back to where the particles came from.
  vtkSPHRanksLists back;
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
  std::copy_n(ValuesOf(came[0]), mine.count, values);
  return "";
}
VTK_ABI_NAMESPACE_END
