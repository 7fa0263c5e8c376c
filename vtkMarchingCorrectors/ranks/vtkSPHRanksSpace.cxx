// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksSpace.h"

#include "vtkBoundingBox.h"
#include "vtkDataSet.h"
#include "vtkSPHArrays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** Cubes along an edge of a brick. Cuts may lie anywhere, but cuts between bricks cost least. */
constexpr double BrickCubes = 4.0;

/** Samples of the work for each rank. With this number, the ranks' shares of the work differ by some percent. */
constexpr std::int64_t SamplesPerRank = 1024;

/** The coarse grid has at most this number of cells. */
constexpr double CellLimit = 1 << 18;

/** Least edge of a cell of the coarse grid, in median smoothing lengths. */
constexpr double CellLengths = 2.0;

/** A cube through which the surface passes costs as much as this number of particles. */
constexpr double CubeWork = 40.0;

/** A cell has far fewer particles than another if it has less than 1 / FarFewer of the other's number. */
constexpr std::int64_t FarFewer = 4;

constexpr double Infinity = std::numeric_limits<double>::infinity();

std::size_t Index(int i)
{
  return static_cast<std::size_t>(i);
}
}

vtkSPHRanksSpace::vtkSPHRanksSpace(const mcor_options& options, const mcor_globals& globals)
  : Options(&options)
  , Globals(&globals)
  , Margin(mcor_reach_margin(&options, &globals, 0.0))
{
  const mcor_plane& plane = globals.measured.plane;
  for (int a = 0; a < 3; ++a)
  {
    const double edge = globals.measured.edge[a];
    const double first = options.periodic[2 * a];
    // If the particles lie in a plane, a period across it means nothing.
    this->Length[a] =
      plane.axis == a + 1 ? 0.0 : std::max(0.0, options.periodic[2 * a + 1] - first);
    this->First[a] = this->IsPeriodic(a) ? edge * std::ceil(first / edge - 0.5) : 0.0;
    double low = this->IsPeriodic(a) ? this->First[a] : -Infinity;
    double high = this->IsPeriodic(a) ? this->First[a] + this->Length[a] : Infinity;
    if (mcor_has_box(&options))
    {
      low = std::min(std::max(low, options.box[2 * a]), high);
      high = std::max(std::min(high, options.box[2 * a + 1]), low);
      // A box does not hold places on its high side, so the high side of a flat box in the
      // particles' plane is moved up: the box then holds the particles.
      high = plane.axis == a + 1 && low == plane.at ? std::max(high, std::nextafter(low, Infinity))
                                                    : high;
    }
    this->Whole[Index(2 * a)] = low;
    this->Whole[Index(2 * a + 1)] = high;
  }
}

void vtkSPHRanksSpace::Enter(double at[3]) const
{
  for (int a = 0; a < 3; ++a)
  {
    if (this->IsPeriodic(a))
    {
      at[a] -= std::floor((at[a] - this->First[a]) / this->Length[a]) * this->Length[a];
    }
  }
}

// Returns how far a particle reaches: its support, scaled and widened, plus the difference between its
// margin and the least margin. The margin depends on the smoothing length before widening.
double vtkSPHRanksSpace::ReachOf(const mcor_input& input, std::int64_t i) const
{
  const mcor_options& options = *this->Options;
  const double factor = options.h_scale * mcor_support_factor(options.sph_kernel);
  const double support = input.estimate_smoothing_length
    ? this->Globals->measured.h_estimate * factor
    : vtkSPHValueOf(input.smoothing_length, i) *
      (input.smoothing_length_is_support_radius ? options.h_scale : factor);
  const double more = mcor_reach_margin(&options, this->Globals, support / factor) - this->Margin;
  return support * (input.widening.data ? vtkSPHValueOf(input.widening, i) : 1.0) + more;
}

bool vtkSPHRanksSpace::Holds(const double at[3]) const
{
  bool isIn = true;
  for (int a = 0; a < 3; ++a)
  {
    isIn = isIn && at[a] >= this->Whole[Index(2 * a)] && at[a] < this->Whole[Index(2 * a + 1)];
  }
  return isIn;
}

vtkSPHRanksLists vtkSPHRanksSpace::Share(vtkSPHRanks& ranks, const mcor_input& input,
  const std::vector<std::int64_t>& work, std::vector<vtkSPHRanksPlace> places, int parts)
{
  const std::size_t count = Index(ranks.GetCount());
  places.reserve(places.size() + work.size());
  for (std::size_t i = 0; i < work.size(); ++i)
  {
    if (work[i] > 0)
    {
      vtkSPHRanksPlace place = { {}, work[i], static_cast<vtkIdType>(i) };
      for (int a = 0; a < 3; ++a)
      {
        place.At[a] = vtkSPHValueOf(input.positions, 3 * place.Particle + a);
      }
      this->Enter(place.At);
      place.Reach = this->ReachOf(input, place.Particle);
      places.push_back(place);
    }
  }
  this->Divide(ranks, places, parts);
  const std::vector<double> radii = this->FindRadii(ranks, input, places);
  const double widest = *std::max_element(radii.begin(), radii.end());
  vtkSPHRanksLists to(count);
  std::vector<std::int64_t> totals(3 * count, 0);
  std::vector<int> found;
  for (const vtkSPHRanksPlace& place : places)
  {
    if (place.Particle < 0)
    {
      continue;
    }
    if (this->Holds(place.At))
    {
      const std::size_t owner = Index(this->FindOwner(place.At));
      ++totals[owner];
      totals[2 * count + owner] += place.Work;
    }
    this->FindReached(place.At, std::max(place.Reach, widest) + this->Margin, found);
    for (const int rank : found)
    {
      const double reach = std::max(place.Reach, radii[Index(rank)]);
      if (this->Reaches(rank, 1, place.At, reach + this->Margin))
      {
        to[Index(rank)].push_back(place.Particle);
        ++totals[count + Index(rank)];
      }
    }
  }
  ranks.Reduce(vtkSPHRanks::SUM, totals.data(), static_cast<int>(totals.size()));
  const std::size_t self = Index(ranks.GetRank());
  this->OwnedParticles = totals[self];
  this->Particles = totals[count + self];
  this->Work = totals[2 * count + self];
  return to;
}

// Finds how far around its box each rank needs all particles, see mcor_reach_around().
std::vector<double> vtkSPHRanksSpace::FindRadii(
  vtkSPHRanks& ranks, const mcor_input& input, const std::vector<vtkSPHRanksPlace>& places) const
{
  const mcor_options& o = *this->Options;
  const bool computesVolumes = vtkSPHComputesVolumes(input);
  const bool findsFactors = o.widen > 1.0 && !input.widening.data; // this run calls mcor_widen
  std::vector<double> radii(Index(ranks.GetCount()), 0.0);
  if (mcor_reach_around(&o, computesVolumes, findsFactors, 1.0, 1.0) == 0.0)
  {
    return radii;
  }
  std::vector<int> found;
  for (const vtkSPHRanksPlace& place : places)
  {
    if (place.Particle >= 0)
    {
      this->FindReached(place.At, place.Reach + this->Margin, found);
      for (const int rank : found)
      {
        radii[Index(rank)] = std::max(radii[Index(rank)], place.Reach);
      }
    }
  }
  ranks.Reduce(vtkSPHRanks::GREATEST, radii.data(), ranks.GetCount());
  for (double& radius : radii)
  {
    radius =
      mcor_reach_around(&o, computesVolumes, findsFactors ? o.widen : 0.0, radius, this->Margin);
  }
  return radii;
}

// Samples the work. A sample's work is counted in units of `step`, which is 1 if there is little work.
void vtkSPHRanksSpace::Divide(
  vtkSPHRanks& ranks, const std::vector<vtkSPHRanksPlace>& places, int parts)
{
  std::int64_t all = 0, before = 0;
  for (const vtkSPHRanksPlace& place : places)
  {
    all += this->Holds(place.At) ? place.Work : 0;
  }
  ranks.Reduce(vtkSPHRanks::SUM, &all, 1);
  const std::int64_t step = std::max<std::int64_t>(1, all / (SamplesPerRank * ranks.GetCount()));
  std::vector<vtkSPHRanksPlace> samples;
  for (const vtkSPHRanksPlace& place : places)
  {
    const std::int64_t work = this->Holds(place.At) ? place.Work : 0;
    const std::int64_t count = (before + work) / step - before / step;
    before += work;
    if (count > 0)
    {
      samples.push_back(place);
      samples.back().Work = count;
    }
  }
  samples = ranks.Join(samples);
  this->Boxes.resize(Index(parts));
  this->Cut(samples.begin(), samples.end(), 0, parts, this->Whole);
}

// Divides a box among `count` ranks from `first` on. Cuts it across the longest side of the
// samples' bounds, at the side of a brick where the work below the cut is nearest to the lower
// ranks' share.
void vtkSPHRanksSpace::Cut(
  Samples begin, Samples end, int first, int count, const vtkSPHRanksBox& box)
{
  if (count == 1)
  {
    this->Boxes[Index(first)] = box;
    return;
  }
  vtkBoundingBox bounds;
  std::for_each(begin, end, [&bounds](vtkSPHRanksPlace& place) { bounds.AddPoint(place.At); });
  double lengths[3];
  bounds.GetLengths(lengths);
  const auto axis = static_cast<int>(std::max_element(lengths, lengths + 3) - lengths);
  std::sort(begin, end,
    [axis](const vtkSPHRanksPlace& p, const vtkSPHRanksPlace& q)
    { return p.At[axis] < q.At[axis]; });
  const auto findEnd = [=](double plane)
  {
    return std::partition_point(
      begin, end, [axis, plane](const vtkSPHRanksPlace& place) { return place.At[axis] < plane; });
  };
  const auto workBelow = [=](double plane)
  {
    return std::accumulate(begin, findEnd(plane), std::int64_t(0),
      [](std::int64_t sum, const vtkSPHRanksPlace& place) { return sum + place.Work; });
  };
  const int lower = count / 2;
  const std::int64_t goal = workBelow(Infinity) * lower / count;
  std::int64_t below = 0;
  const Samples last = std::find_if(begin, end,
    [&below, goal](const vtkSPHRanksPlace& place) { return (below += place.Work) > goal; });
  const double brick = BrickCubes * this->Globals->measured.cube;
  const double at = last == end ? 0.0 : last->At[axis], number = std::floor(at / brick);
  const double side = brick > 0.0 ? number * brick : at,
               next = brick > 0.0 ? (number + 1.0) * brick : at;
  const bool isNext = workBelow(next) - goal < goal - workBelow(side);
  const double plane =
    std::min(std::max(isNext ? next : side, box[Index(2 * axis)]), box[Index(2 * axis + 1)]);
  const Samples middle = findEnd(plane);
  vtkSPHRanksBox low = box, high = box;
  low[Index(2 * axis + 1)] = high[Index(2 * axis)] = plane;
  this->Cut(begin, middle, first, lower, low);
  this->Cut(middle, end, first + lower, count - lower, high);
}

// Some ranks may have no box, and some boxes are empty if there are too few bricks to share. The
// core needs a box, so it gets one where there is nothing in both cases.
vtkSPHRanksBox vtkSPHRanksSpace::GetBox(int rank) const
{
  const vtkSPHRanksBox box =
    Index(rank) < this->Boxes.size() ? this->Boxes[Index(rank)] : vtkSPHRanksBox{};
  const bool isEmpty = box[0] >= box[1] || box[2] >= box[3] || box[4] >= box[5];
  return isEmpty ? vtkSPHRanksBox{ 1e300, 2e300, 1e300, 2e300, 1e300, 2e300 } : box;
}

// The k-d tree divides each group of boxes into two halves by a cut. Along the axis of the cut, the
// low sides of the halves' first boxes differ; along other axes they are equal.
int vtkSPHRanksSpace::FindOwner(const double at[3]) const
{
  double place[3] = { at[0], at[1], at[2] };
  this->Enter(place);
  int first = 0;
  for (int count = static_cast<int>(this->Boxes.size()); count > 1;)
  {
    const int lower = count / 2;
    bool isBelow = false;
    for (int a = 0; a < 3; ++a)
    {
      const double cut = this->Boxes[Index(first + lower)][Index(2 * a)];
      isBelow = isBelow || (place[a] < cut && this->Boxes[Index(first)][Index(2 * a)] < cut);
    }
    first += isBelow ? 0 : lower;
    count = isBelow ? lower : count - lower;
  }
  return first;
}

vtkSPHRanksLists vtkSPHRanksSpace::ListOwners(vtkDataSet* points) const
{
  vtkSPHRanksLists owners(this->Boxes.size());
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    owners[Index(this->FindOwner(points->GetPoint(i)))].push_back(i);
  }
  return owners;
}

// The `count` boxes fill a larger box, with the low sides of the first box and the high sides of the last.
bool vtkSPHRanksSpace::Reaches(int rank, int count, const double at[3], double radius) const
{
  bool reaches = true;
  for (int a = 0; a < 3; ++a)
  {
    const double low = this->Boxes[Index(rank)][Index(2 * a)],
                 high = this->Boxes[Index(rank + count - 1)][Index(2 * a + 1)];
    // The cube reaches the box if the cube is moved by at least `first` and at most `last`. Along a
    // periodic axis it may move by whole periods, which are then counted; else it may not move.
    double first = low - radius - at[a], last = high + radius - at[a];
    first = this->IsPeriodic(a) ? std::ceil(first / this->Length[a]) : first;
    last = this->IsPeriodic(a) ? std::floor(last / this->Length[a]) : last;
    reaches =
      reaches && low < high && (this->IsPeriodic(a) ? first <= last : first <= 0.0 && last >= 0.0);
  }
  return reaches;
}

void vtkSPHRanksSpace::FindReached(const double at[3], double radius, std::vector<int>& found) const
{
  found.clear();
  this->AddReached(0, static_cast<int>(this->Boxes.size()), at, radius, found);
}

void vtkSPHRanksSpace::AddReached(
  int rank, int count, const double at[3], double radius, std::vector<int>& found) const
{
  if (this->Reaches(rank, count, at, radius))
  {
    if (count == 1)
    {
      found.push_back(rank);
      return;
    }
    const int lower = count / 2;
    this->AddReached(rank, lower, at, radius, found);
    this->AddReached(rank + lower, count - lower, at, radius, found);
  }
}

namespace
{
using Range = std::array<double, 2>; // least and greatest

/** A grid of cells around the fluid of all ranks. */
struct CoarseGrid
{
  explicit CoarseGrid(const mcor_measure& m)
    : Edge(std::max(CellLengths * m.h_median, m.cube))
    , Low(m.x_low)
  {
    const auto cellsAlong = [this, &m](int a)
    { return std::floor((m.x_high[a] - m.x_low[a]) / this->Edge) + 1.0; };
    while (cellsAlong(0) * cellsAlong(1) * cellsAlong(2) > CellLimit)
    {
      this->Edge *= 1.25;
    }
    for (int a = 0; a < 3; ++a)
    {
      this->Size[a] = static_cast<std::size_t>(cellsAlong(a));
    }
    this->Counts.assign(this->Size[0] * this->Size[1] * this->Size[2], 0);
    this->Ranges.assign(this->Counts.size(), { Infinity, -Infinity });
  }

  std::size_t Find(const mcor_array& positions, std::int64_t i) const
  {
    std::size_t cell = 0;
    for (int a = 2; a >= 0; --a)
    {
      const double at = (vtkSPHValueOf(positions, 3 * i + a) - this->Low[a]) / this->Edge;
      const double last = static_cast<double>(this->Size[a]) - 1.0;
      cell = cell * this->Size[a] +
        static_cast<std::size_t>(std::min(std::max(std::floor(at), 0.0), last));
    }
    return cell;
  }

  /**
   * Estimates from a cell and the six cells around it how many surfaces pass through the cell. Each
   * surface is taken to be as large as a side of the cell.
   */
  int CountSurfaces(const mcor_options& options, std::size_t cell) const
  {
    double low = this->Ranges[cell][0], high = this->Ranges[cell][1];
    int ends = 0; // how many sides the fluid ends at
    std::size_t stride = 1;
    for (const std::size_t size : this->Size)
    {
      const std::size_t at = cell / stride % size;
      for (const bool isUp : { false, true })
      {
        const bool isIn = isUp ? at + 1 < size : at > 0;
        const std::size_t other = isUp ? cell + stride : cell - stride;
        ends += !isIn || FarFewer * this->Counts[other] < this->Counts[cell] ? 1 : 0;
        low = isIn ? std::min(low, this->Ranges[other][0]) : low;
        high = isIn ? std::max(high, this->Ranges[other][1]) : high;
      }
      stride *= size;
    }
    return options.field == MCOR_WEIGHT_SUM
      ? ends * options.iso_count
      : static_cast<int>(std::count_if(options.iso_values, options.iso_values + options.iso_count,
          [low, high](double iso) { return low <= iso && iso <= high; }));
  }

  double Edge;
  const double* const Low;
  std::size_t Size[3];
  std::vector<std::int64_t> Counts; // number of fluid particles
  std::vector<Range> Ranges;        // range of the contoured scalar
};
}

std::vector<std::int64_t> vtkSPHExpectWork(vtkSPHRanks& ranks, const mcor_input& input,
  const mcor_options& options, const mcor_globals& globals)
{
  CoarseGrid grid(globals.measured);
  const bool hasValues = options.field != MCOR_WEIGHT_SUM;
  const auto isFluid = [&input](std::int64_t i) { return !input.solid || !input.solid[i]; };
  for (std::int64_t i = 0; i < input.count; ++i)
  {
    if (isFluid(i))
    {
      const std::size_t cell = grid.Find(input.positions, i);
      const double value = hasValues ? vtkSPHScalarOf(input, i) : 0.0;
      Range& range = grid.Ranges[cell];
      range = { std::min(range[0], value), std::max(range[1], value) };
      ++grid.Counts[cell];
    }
  }
  const int count = static_cast<int>(grid.Counts.size());
  ranks.Reduce(vtkSPHRanks::SUM, grid.Counts.data(), count);
  if (hasValues)
  {
    ranks.ReduceRanges(grid.Ranges.front().data(), count);
  }
  const double across = grid.Edge / globals.measured.cube;
  std::vector<std::int64_t> shares; // the cost of a cell's surface, for each of its particles
  for (std::size_t cell = 0; cell < grid.Counts.size(); ++cell)
  {
    const double particles = static_cast<double>(std::max<std::int64_t>(grid.Counts[cell], 1));
    const double cost = grid.CountSurfaces(options, cell) * CubeWork * across * across;
    shares.push_back(static_cast<std::int64_t>(std::min(cost / particles, 1e9)));
  }
  const bool usesSolids =
    !input.ignore_solids && (options.field != MCOR_WEIGHT_SUM || options.wall_share != 0.0);
  std::vector<std::int64_t> work;
  for (std::int64_t i = 0; i < input.count; ++i)
  {
    work.push_back(isFluid(i) ? 1 + shares[grid.Find(input.positions, i)] : usesSolids ? 1 : 0);
  }
  return work;
}
VTK_ABI_NAMESPACE_END
