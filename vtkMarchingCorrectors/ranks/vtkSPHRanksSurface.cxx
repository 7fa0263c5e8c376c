// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksSurface.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkMarchingCorrectorsOutput.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksWait.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Key = std::array<std::uint64_t, MCOR_POINT_KEY>;
using Keys = std::vector<Key>;
using Numbers = std::vector<std::int64_t>;

/** Samples per rank's range of keys: ranges come out even within about an eighth. */
constexpr std::int64_t Samples = 64;

/** Finds where the range of keys of each rank ends; the same on all ranks. */
Keys FindEnds(vtkSPHRanks& ranks, const Keys& keys)
{
  const auto count = static_cast<std::size_t>(ranks.GetCount());
  const auto own = static_cast<std::int64_t>(keys.size());
  std::int64_t all = own;
  ranks.Reduce(vtkSPHRanks::SUM, &all, 1);
  const auto wanted =
    static_cast<std::size_t>(std::ceil(static_cast<double>(Samples * ranks.GetCount()) *
      static_cast<double>(own) / static_cast<double>(std::max<std::int64_t>(all, 1))));
  Keys samples;
  for (std::size_t i = 0; i < wanted; ++i)
  {
    samples.push_back(keys[i * keys.size() / wanted]);
  }
  Keys sampled;
  for (const Keys& theirs : ranks.Gather(samples))
  {
    sampled.insert(sampled.end(), theirs.begin(), theirs.end());
  }
  std::sort(sampled.begin(), sampled.end());
  Keys ends;
  for (std::size_t rank = 1; rank < count && !sampled.empty(); ++rank)
  {
    ends.push_back(sampled[rank * sampled.size() / count]);
  }
  return ends;
}

/** Returns how many numbers a key takes. */
using Weight = std::int64_t (*)(const Key& key);

/**
 * Numbers the distinct keys of all ranks in order, and returns the numbers of this rank's keys,
 * which must ascend. total: how many numbers there are. Each rank sorts a range of the keys.
 */
vtkSmartPointer<vtkIdTypeArray> NumberKeys(
  vtkSPHRanks& ranks, const Keys& keys, Weight weight, const char* name, vtkIdType& total)
{
  const Keys ends = FindEnds(ranks, keys);
  std::vector<Keys> sent(static_cast<std::size_t>(ranks.GetCount()));
  auto from = keys.begin();
  for (std::size_t rank = 0; rank < sent.size(); ++rank)
  {
    const auto to =
      rank < ends.size() ? std::lower_bound(from, keys.end(), ends[rank]) : keys.end();
    sent[rank].assign(from, to);
    from = to;
  }
  sent = ranks.Exchange(std::move(sent));
  Keys distinct;
  for (const Keys& theirs : sent)
  {
    distinct.insert(distinct.end(), theirs.begin(), theirs.end());
  }
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  Numbers first(1, 0); // and, last, the number behind them
  for (const Key& key : distinct)
  {
    first.push_back(first.back() + weight(key));
  }
  const Numbers all = ranks.Gather(first.back()); // how many numbers each rank has given
  const std::int64_t before =
    std::accumulate(all.begin(), all.begin() + ranks.GetRank(), std::int64_t(0));
  total = static_cast<vtkIdType>(std::accumulate(all.begin(), all.end(), std::int64_t(0)));
  std::vector<Numbers> answers;
  for (const Keys& theirs : sent)
  {
    answers.emplace_back();
    auto at = distinct.begin();
    for (const Key& key : theirs) // which ascend
    {
      at = std::lower_bound(at, distinct.end(), key);
      answers.back().push_back(before + first[static_cast<std::size_t>(at - distinct.begin())]);
    }
  }
  auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
  numbers->SetName(name);
  auto key = keys.begin();
  for (const Numbers& found : ranks.Exchange(std::move(answers)))
  {
    for (const std::int64_t number : found)
    {
      const std::int64_t count = weight(*key++);
      for (std::int64_t i = 0; i < count; ++i)
      {
        numbers->InsertNextValue(static_cast<vtkIdType>(number + i));
      }
    }
  }
  return numbers;
}
}

// All triangles of a cell are on one rank, one behind the other, so one key stands for them all.
vtkSPHRanksNumbers vtkSPHNumber(vtkSPHRanks& ranks, const mcor_surface& surface)
{
  static_assert(MCOR_TRIANGLE_KEY + 1 == MCOR_POINT_KEY, "a key and how many have it");
  const auto* first = reinterpret_cast<const Key*>(surface.point_keys);
  const Keys points(first, first + (first ? surface.point_count : 0));
  Keys cells;
  const std::uint64_t* from = surface.triangle_keys;
  for (std::int64_t i = 0; from && i < surface.triangle_count; ++i, from += MCOR_TRIANGLE_KEY)
  {
    if (cells.empty() || cells.back()[0] != from[0] || cells.back()[1] != from[1])
    {
      cells.push_back({ from[0], from[1], 0 });
    }
    ++cells.back()[2];
  }
  vtkSPHRanksNumbers numbers;
  numbers.OfPoints = NumberKeys(
    ranks, points, [](const Key&) { return std::int64_t(1); }, "GlobalPointIds", numbers.Points);
  numbers.OfTriangles = NumberKeys(
    ranks, cells, [](const Key& cell) { return static_cast<std::int64_t>(cell[2]); },
    "GlobalCellIds", numbers.Triangles);
  return numbers;
}

void vtkSPHMeasure(vtkSPHRanks& ranks, const mcor_surface& surface, vtkIdTypeArray* numbers,
  mcor_statistics& statistics)
{
  mcor_measures measures = {};
  const Numbers own(numbers->GetPointer(0), numbers->GetPointer(0) + numbers->GetNumberOfTuples());
  const auto first =
    std::find(own.begin(), own.end(), std::int64_t(0)); // the first point of the whole surface
  for (int a = 0; a < 3; ++a)
  {
    measures.origin[a] = first == own.end() ? std::numeric_limits<double>::infinity()
                                            : surface.points[3 * (first - own.begin()) + a];
  }
  ranks.Reduce(vtkSPHRanks::LEAST, measures.origin, 3);
  mcor_measure_terms(&surface, &measures);
  ranks.Reduce(vtkSPHRanks::SUM, &measures.triangle_count, 1);
  double most[2] = { measures.area_most, measures.volume_most };
  ranks.Reduce(vtkSPHRanks::GREATEST, most, 2);
  measures.area_most = most[0];
  measures.volume_most = most[1];
  mcor_measure_sums(&surface, own.data(), &measures);
  double sums[2] = { measures.area, measures.volume };
  ranks.Reduce(vtkSPHRanks::SUM, sums, 2);
  measures.area = sums[0];
  measures.volume = sums[1];
  ranks.Reduce(vtkSPHRanks::SUM, &measures.open, 1);
  mcor_keep_measures(&measures, &statistics);
}

namespace
{
/** Returns numbers of any type as ids. */
std::vector<vtkIdType> NumbersOf(vtkDataSetAttributes* data, vtkIdType count)
{
  std::vector<vtkIdType> numbers;
  for (vtkIdType i = 0; i < count; ++i)
  {
    numbers.push_back(static_cast<vtkIdType>(data->GetGlobalIds()->GetComponent(i, 0)));
  }
  return numbers;
}

/** Returns how many there are in the whole, whose numbers go from 0 on. */
vtkIdType CountOf(const vtkSPHRanksLists& numbers)
{
  vtkIdType count = 0;
  for (const std::vector<vtkIdType>& theirs : numbers)
  {
    count =
      theirs.empty() ? count : std::max(count, 1 + *std::max_element(theirs.begin(), theirs.end()));
  }
  return count;
}
}

vtkSmartPointer<vtkPolyData> vtkSPHGatherSurface(
  vtkSPHRanks& ranks, vtkPolyData* part, vtkSPHRanksLists& points, vtkSPHRanksLists& triangles)
{
  const vtkIdType pointCount = part->GetNumberOfPoints(), triangleCount = part->GetNumberOfPolys();
  const std::vector<vtkIdType> numbers = NumbersOf(part->GetPointData(), pointCount);
  points = ranks.GatherOnFirst(numbers);
  triangles = ranks.GatherOnFirst(NumbersOf(part->GetCellData(), triangleCount));
  vtkNew<vtkIdTypeArray> corners;
  vtkNew<vtkIdList> triangle;
  corners->SetNumberOfComponents(3);
  for (vtkIdType t = 0; t < triangleCount; ++t)
  {
    part->GetPolys()->GetCellAtId(t, triangle);
    for (const vtkIdType corner : *triangle)
    {
      corners->InsertNextValue(numbers[static_cast<std::size_t>(corner)]);
    }
  }
  vtkNew<vtkPolyData> own;
  own->ShallowCopy(part);
  for (vtkDataSetAttributes* data : { static_cast<vtkDataSetAttributes*>(own->GetPointData()),
         static_cast<vtkDataSetAttributes*>(own->GetCellData()) })
  {
    if (data->GetGlobalIds())
    {
      data->RemoveArray(data->GetGlobalIds()->GetName());
    }
  }
  vtkSPHMatchEmpty(ranks, own);
  vtkSmartPointer<vtkPolyData> whole =
    vtkSPHMakePoints(vtkSPHReturnTuples(ranks, vtkSPHListArrays(own),
                       vtkSPHAllToFirst(ranks, pointCount), points, CountOf(points)),
      own);
  vtkSPHRanksArrays arrays = vtkSPHListArrays(own->GetCellData());
  arrays.emplace_back(corners);
  arrays = vtkSPHReturnTuples(
    ranks, arrays, vtkSPHAllToFirst(ranks, triangleCount), triangles, CountOf(triangles));
  auto* wholeCorners = vtkDataArray::SafeDownCast(arrays.back());
  wholeCorners->SetNumberOfComponents(1); // one after the other
  vtkNew<vtkCellArray> cells;
  cells->SetData(3, wholeCorners);
  whole->SetPolys(cells);
  arrays.pop_back();
  for (const auto& array : arrays)
  {
    whole->GetCellData()->AddArray(array);
  }
  whole->GetFieldData()->ShallowCopy(part->GetFieldData());
  return ranks.GetRank() == 0 ? whole : nullptr;
}

vtkSmartPointer<vtkPolyData> vtkSPHMergeSurface(
  vtkMultiProcessController* controller, vtkPolyData* part)
{
  vtkSPHRanks ranks(controller);
  std::int64_t others = ranks.GetRank() > 0 ? part->GetNumberOfPoints() : 0;
  ranks.Reduce(vtkSPHRanks::SUM, &others, 1);
  vtkSPHRanksLists points, triangles;
  if (others > 0)
  {
    return vtkSPHGatherSurface(ranks, part, points, triangles);
  }
  auto whole = vtkSmartPointer<vtkPolyData>::New(); // the first rank has all, as of lines
  whole->ShallowCopy(part);
  whole->GetPointData()->RemoveArray("GlobalPointIds");
  whole->GetCellData()->RemoveArray("GlobalCellIds");
  return ranks.GetRank() == 0 ? whole : nullptr;
}

namespace
{
/** Copies the values of an array that the surface may lack. */
template <typename T>
std::vector<T> List(const T* values, std::int64_t count)
{
  return std::vector<T>(values, values + (values ? count : 0));
}

/** Allocates, uninitialized; not null for 0 elements either. */
template <typename T>
bool Allocate(T*& array, vtkIdType count)
{
  array = static_cast<T*>(std::malloc(static_cast<std::size_t>(count) * sizeof(T) + 1));
  return array != nullptr;
}

/**
 * Moves the values of all ranks, the same number of values for each of `numbers`, to the first
 * rank, and there to the places that `numbers` (of GatherOnFirst()) say. `to` may be null.
 * Collective.
 */
template <typename T>
void PlaceOnFirst(vtkSPHRanks& ranks, const vtkSPHRanksLists& numbers, std::vector<T> values, T* to)
{
  const std::vector<std::vector<T>> all = ranks.GatherOnFirst(std::move(values));
  for (std::size_t rank = 0; to && rank < all.size(); ++rank)
  {
    const std::size_t width = all[rank].empty() ? 0 : all[rank].size() / numbers[rank].size();
    const T* from = all[rank].data();
    for (const vtkIdType number : numbers[rank])
    {
      std::copy_n(from, width, to + static_cast<std::size_t>(number) * width);
      from += width;
    }
  }
}

/** Returns the whole numbers from 0 on. */
vtkSmartPointer<vtkIdTypeArray> CountUp(const char* name, vtkIdType count)
{
  auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
  numbers->SetName(name);
  numbers->SetNumberOfTuples(count);
  std::iota(numbers->GetPointer(0), numbers->GetPointer(0) + count, vtkIdType(0));
  return numbers;
}
}

vtkSPHRanksLines::vtkSPHRanksLines(vtkSPHRanks& ranks, mcor_surface& surface,
  const vtkSPHRanksNumbers& numbers, const mcor_plane& plane, bool isFilled)
{
  const bool isFirst = ranks.GetRank() == 0;
  mcor_surface& whole = this->Whole;
  whole.point_count = isFirst ? numbers.Points : 0;
  whole.triangle_count = isFirst && isFilled ? numbers.Triangles : 0;
  this->Failed = whole.point_count > std::numeric_limits<std::int32_t>::max() ||
    !Allocate(whole.points, 3 * whole.point_count) ||
    (isFilled &&
      (!Allocate(whole.iso_value, whole.point_count) ||
        !Allocate(whole.triangles, 3 * whole.triangle_count) ||
        !Allocate(whole.band_value, whole.triangle_count)));
  const std::vector<Piece> pieces = this->Gather(ranks, surface, numbers);
  if (isFirst && !this->Failed)
  {
    this->Failed =
      mcor_join_lines(&plane, reinterpret_cast<const std::int32_t(*)[2]>(pieces.data()),
        static_cast<std::int64_t>(pieces.size()), &whole) != MCOR_OK;
  }
  const mcor_statistics& s = whole.statistics;
  std::int64_t counts[2] = { whole.line_count, this->Failed ? 1 : 0 };
  double measures[3] = { s.length, s.area, s.is_closed ? 1.0 : 0.0 };
  ranks.Reduce(vtkSPHRanks::SUM, counts, 2); // the other ranks have no lines or measures
  ranks.Reduce(vtkSPHRanks::SUM, measures, 3);
  this->Count = counts[0];
  this->Failed = counts[1] > 0;
  surface.statistics.length = measures[0];
  surface.statistics.area = measures[1];
  surface.statistics.is_closed = measures[2] > 0.0;
}

// Gathers points and triangles into the whole. Returns the pieces of lines, each between two points
// of the whole.
std::vector<vtkSPHRanksLines::Piece> vtkSPHRanksLines::Gather(
  vtkSPHRanks& ranks, const mcor_surface& surface, const vtkSPHRanksNumbers& numbers)
{
  const std::int64_t points = surface.point_count,
                     triangles = surface.band_value ? surface.triangle_count : 0;
  const vtkIdType* number = numbers.OfPoints->GetPointer(0);
  const auto numberOf = [number](std::int32_t point)
  { return static_cast<std::int32_t>(number[point]); };
  this->Numbers = ranks.GatherOnFirst(List(number, points));
  PlaceOnFirst(ranks, this->Numbers, List(surface.points, 3 * points), this->Whole.points);
  PlaceOnFirst(ranks, this->Numbers, List(surface.iso_value, points), this->Whole.iso_value);
  const vtkSPHRanksLists ofTriangles =
    ranks.GatherOnFirst(List(numbers.OfTriangles->GetPointer(0), triangles));
  std::vector<std::int32_t> corners = List(surface.triangles, 3 * triangles);
  std::transform(corners.begin(), corners.end(), corners.begin(), numberOf);
  PlaceOnFirst(ranks, ofTriangles, std::move(corners), this->Whole.triangles);
  PlaceOnFirst(ranks, ofTriangles, List(surface.band_value, triangles), this->Whole.band_value);
  std::vector<Piece> own, all;
  for (std::int64_t line = 0; line < surface.line_count; ++line)
  {
    for (std::int64_t i = surface.line_offsets[line]; i + 1 < surface.line_offsets[line + 1]; ++i)
    {
      own.push_back({ numberOf(surface.line_points[i]), numberOf(surface.line_points[i + 1]) });
    }
  }
  for (const std::vector<Piece>& pieces : ranks.GatherOnFirst(std::move(own)))
  {
    all.insert(all.end(), pieces.begin(), pieces.end());
  }
  return all;
}

vtkSPHRanksLines::~vtkSPHRanksLines()
{
  mcor_free_surface(&this->Whole);
}

void vtkSPHRanksLines::Move(vtkSPHRanks& ranks, vtkPolyData* output)
{
  const auto count = static_cast<vtkIdType>(this->Whole.point_count);
  const vtkSmartPointer<vtkPolyData> moved =
    vtkSPHMakePoints(vtkSPHReturnTuples(ranks, vtkSPHListArrays(output),
                       vtkSPHAllToFirst(ranks, output->GetNumberOfPoints()), this->Numbers, count),
      output);
  vtkPointData* arrays = output->GetPointData();
  output->SetPoints(moved->GetPoints());
  arrays->ShallowCopy(moved->GetPointData());
  const auto cells = static_cast<vtkIdType>(this->Whole.line_count + this->Whole.triangle_count);
  vtkMarchingCorrectorsOutput::BuildCells(this->Whole, output);
  arrays->SetGlobalIds(CountUp("GlobalPointIds", output->GetNumberOfPoints()));
  output->GetCellData()->SetGlobalIds(CountUp("GlobalCellIds", cells));
}
VTK_ABI_NAMESPACE_END
