// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksRoute.h"

#include "vtkSPHReals.h"

#include <algorithm>
#include <cmath>
#include <limits>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** Cells of the coarse grid. */
constexpr double CellLimit = 1 << 18;

/** Edge of a cell in median smoothing lengths, unless that makes too many cells. */
constexpr double CellLengths = 2.0;

/** The cost of a cube with surface, in costs of a particle. */
constexpr double CubeWork = 40.0;

/** A cell has far fewer particles than another if it has less than one in so many. */
constexpr std::int64_t FarFewer = 4;

constexpr double Infinity = std::numeric_limits<double>::infinity();

class CoarseGrid
{
public:
  CoarseGrid(const mcor_input& input, const mcor_options& options, const mcor_globals& globals)
    : Input(input)
    , Options(options)
    , Globals(globals)
  {
    const mcor_measure& m = globals.measured;
    const auto cellsAlong = [&](int a)
    { return std::floor((m.x_high[a] - m.x_low[a]) / this->Edge) + 1.0; };
    this->Edge = std::max(CellLengths * m.h_median, m.cube);
    while (cellsAlong(0) * cellsAlong(1) * cellsAlong(2) > CellLimit)
    {
      this->Edge *= 1.25;
    }
    std::size_t count = 1;
    for (int a = 0; a < 3; ++a)
    {
      this->Size[a] = static_cast<int>(cellsAlong(a));
      count *= static_cast<std::size_t>(this->Size[a]);
    }
    this->Counts.assign(count, 0);
    this->Ranges.assign(count, { Infinity, -Infinity });
  }

  /** Enters this rank's particles into the cells, then merges the cells of all ranks. */
  void Fill(vtkSPHRanks& ranks)
  {
    const bool hasValues = this->Options.field != MCOR_WEIGHT_SUM;
    this->CellOf.resize(static_cast<std::size_t>(this->Input.count));
    for (std::int64_t i = 0; i < this->Input.count; ++i)
    {
      if (!this->Input.solid || !this->Input.solid[i])
      {
        const std::size_t cell = this->Find(i);
        this->CellOf[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(cell);
        ++this->Counts[cell];
        const double value = hasValues ? vtkSPHScalarOf(this->Input, i) : 0.0;
        Range& range = this->Ranges[cell];
        range = { std::min(range[0], value), std::max(range[1], value) };
      }
    }
    const int count = static_cast<int>(this->Counts.size());
    ranks.Reduce(vtkSPHRanks::SUM, this->Counts.data(), count);
    if (hasValues)
    {
      ranks.ReduceRanges(this->Ranges.front().data(), count);
    }
  }

  /** Returns, for each cell, the work that each of its particles stands for. */
  std::vector<std::int64_t> Share() const
  {
    const double across = this->Edge / this->Globals.measured.cube;
    std::vector<std::int64_t> shares(this->Counts.size(), 1);
    for (std::size_t cell = 0; cell < shares.size(); ++cell)
    {
      if (this->Counts[cell] > 0)
      {
        const double work = this->CountSurfaces(cell) * CubeWork * across * across;
        shares[cell] +=
          static_cast<std::int64_t>(std::min(work / static_cast<double>(this->Counts[cell]), 1e9));
      }
    }
    return shares;
  }

  /** Returns the cell of a fluid particle of this rank. */
  std::size_t GetCell(std::int64_t i) const { return this->CellOf[static_cast<std::size_t>(i)]; }

private:
  std::size_t Find(std::int64_t i) const
  {
    std::size_t cell = 0;
    for (int a = 2; a >= 0; --a)
    {
      const double at =
        (vtkSPHValueOf(this->Input.positions, 3 * i + a) - this->Globals.measured.x_low[a]) /
        this->Edge;
      const double within = std::min(std::max(std::floor(at), 0.0), this->Size[a] - 1.0);
      cell = cell * static_cast<std::size_t>(this->Size[a]) + static_cast<std::size_t>(within);
    }
    return cell;
  }

  /**
   * Estimates how many surfaces, each as large as a side of the cell, pass through it, from the
   * cell and the six around it.
   */
  int CountSurfaces(std::size_t cell) const
  {
    double low = this->Ranges[cell][0], high = this->Ranges[cell][1];
    int ends = 0; // sides at which the fluid ends
    std::size_t stride = 1;
    for (int a = 0; a < 3; ++a)
    {
      const int at = static_cast<int>(cell / stride % static_cast<std::size_t>(this->Size[a]));
      for (int step = -1; step <= 1; step += 2)
      {
        const bool isIn = at + step >= 0 && at + step < this->Size[a];
        const std::size_t other = step < 0 ? cell - stride : cell + stride;
        ends += !isIn || FarFewer * this->Counts[other] < this->Counts[cell] ? 1 : 0;
        low = isIn ? std::min(low, this->Ranges[other][0]) : low;
        high = isIn ? std::max(high, this->Ranges[other][1]) : high;
      }
      stride *= static_cast<std::size_t>(this->Size[a]);
    }
    if (this->Options.field == MCOR_WEIGHT_SUM)
    {
      return ends * this->Options.iso_count;
    }
    return static_cast<int>(
      std::count_if(this->Options.iso_values, this->Options.iso_values + this->Options.iso_count,
        [low, high](double iso) { return low <= iso && iso <= high; }));
  }

  const mcor_input& Input;
  const mcor_options& Options;
  const mcor_globals& Globals;
  double Edge;
  int Size[3];
  std::vector<std::int64_t> Counts;
  std::vector<std::uint32_t> CellOf;
  using Range = std::array<double, 2>; // least and greatest
  std::vector<Range> Ranges;           // of what is contoured, by cell
};
}

std::vector<std::int64_t> vtkSPHCountWork(const mcor_input& input, const mcor_options& options)
{
  std::vector<std::int64_t> work(static_cast<std::size_t>(input.count), 1);
  const bool usesSolids =
    !input.ignore_solids && (options.field != MCOR_WEIGHT_SUM || options.wall_share != 0.0);
  for (std::int64_t i = 0; input.solid && !usesSolids && i < input.count; ++i)
  {
    work[static_cast<std::size_t>(i)] = input.solid[i] ? 0 : 1;
  }
  return work;
}

std::vector<std::int64_t> vtkSPHExpectWork(vtkSPHRanks& ranks, const mcor_input& input,
  const mcor_options& options, const mcor_globals& globals)
{
  CoarseGrid grid(input, options, globals);
  grid.Fill(ranks);
  const std::vector<std::int64_t> shares = grid.Share();
  std::vector<std::int64_t> work = vtkSPHCountWork(input, options);
  for (std::int64_t i = 0; i < input.count; ++i)
  {
    if (!input.solid || !input.solid[i])
    {
      work[static_cast<std::size_t>(i)] = shares[grid.GetCell(i)];
    }
  }
  return work;
}
VTK_ABI_NAMESPACE_END
