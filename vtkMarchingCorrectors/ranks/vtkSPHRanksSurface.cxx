// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksSurface.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"
#include "vtkMarchingCorrectorsOutput.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksWait.h"
#include "vtkTypeTraits.h"

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
  Keys sampled = ranks.Join(samples);
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
  ranks.Reduce(vtkSPHRanks::GREATEST, &measures.area_most, 1);
  ranks.Reduce(vtkSPHRanks::GREATEST, &measures.volume_most, 1);
  mcor_measure_sums(&surface, own.data(), &measures);
  ranks.Reduce(vtkSPHRanks::SUM, &measures.area, 1);
  ranks.Reduce(vtkSPHRanks::SUM, &measures.volume, 1);
  ranks.Reduce(vtkSPHRanks::SUM, &measures.open, 1);
  mcor_keep_measures(&measures, &statistics);
}

vtkSmartPointer<vtkPolyData> vtkSPHGatherSurface(vtkSPHRanks& ranks, vtkPolyData* part)
{
  vtkNew<vtkPolyData> own;
  own->ShallowCopy(part);
  const auto takeNumbers = [](vtkDataSetAttributes* data)
  {
    auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
    if (vtkDataArray* ids = data->GetGlobalIds()) // of any type
    {
      numbers->DeepCopy(ids);
      data->RemoveArray(ids->GetName());
    }
    return numbers;
  };
  const auto points = takeNumbers(own->GetPointData()), triangles = takeNumbers(own->GetCellData());
  vtkNew<vtkIdTypeArray> corners;
  vtkNew<vtkIdList> triangle;
  corners->SetNumberOfComponents(3);
  for (vtkIdType t = 0; t < part->GetNumberOfPolys(); ++t)
  {
    part->GetPolys()->GetCellAtId(t, triangle);
    for (const vtkIdType corner : *triangle)
    {
      corners->InsertNextValue(points->GetValue(corner));
    }
  }
  vtkSPHMatchEmpty(ranks, own);
  vtkSmartPointer<vtkPolyData> whole =
    vtkSPHMakePoints(vtkSPHGatherTuples(ranks, vtkSPHListArrays(own), points), own);
  vtkSPHRanksArrays arrays = vtkSPHListArrays(own->GetCellData());
  arrays.emplace_back(corners);
  arrays = vtkSPHGatherTuples(ranks, arrays, triangles);
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
  if (others > 0)
  {
    return vtkSPHGatherSurface(ranks, part);
  }
  auto whole = vtkSmartPointer<vtkPolyData>::New(); // the first rank has all, as of lines
  whole->ShallowCopy(part);
  whole->GetPointData()->RemoveArray("GlobalPointIds");
  whole->GetCellData()->RemoveArray("GlobalCellIds");
  return ranks.GetRank() == 0 ? whole : nullptr;
}

namespace
{
/** Makes a VTK array of values of the core, which it borrows. */
template <typename T>
vtkSmartPointer<vtkDataArray> View(T* values, int components, std::int64_t tuples)
{
  auto array = vtkSmartPointer<vtkDataArray>::Take(
    vtkDataArray::CreateDataArray(vtkTypeTraits<T>::VTK_TYPE_ID));
  array->SetNumberOfComponents(components);
  array->SetVoidArray(values, values ? tuples * components : 0, 1);
  return array;
}

/** Copies values of a VTK array for the core, which frees them; not null for 0 elements either. */
template <typename T>
bool Copy(vtkAbstractArray* from, T*& to)
{
  const auto count = static_cast<std::size_t>(from->GetNumberOfValues());
  to = static_cast<T*>(std::malloc(count * sizeof(T) + 1));
  std::copy_n(static_cast<const T*>(from->GetVoidPointer(0)), to ? count : 0, to);
  return to != nullptr;
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
  : Numbers(numbers.OfPoints)
{
  const auto numberOf = [this](std::int32_t point)
  { return static_cast<std::int32_t>(this->Numbers->GetValue(point)); };
  vtkNew<vtkIntArray> pieces, corners; // of lines, and of triangles, between points of the whole
  pieces->SetNumberOfComponents(2);
  corners->SetNumberOfComponents(3);
  for (std::int64_t line = 0; line < surface.line_count; ++line)
  {
    for (std::int64_t i = surface.line_offsets[line]; i + 1 < surface.line_offsets[line + 1]; ++i)
    {
      pieces->InsertNextValue(numberOf(surface.line_points[i]));
      pieces->InsertNextValue(numberOf(surface.line_points[i + 1]));
    }
  }
  vtkSPHRanksArrays points = { View(surface.points, 3, surface.point_count) };
  if (isFilled)
  {
    points.emplace_back(View(surface.iso_value, 1, surface.point_count));
    for (std::int64_t i = 0; i < 3 * surface.triangle_count; ++i)
    {
      corners->InsertNextValue(numberOf(surface.triangles[i]));
    }
  }
  const vtkSPHRanksArrays all = vtkSPHGatherTuples(ranks, { pieces.Get() }, nullptr);
  points = vtkSPHGatherTuples(ranks, points, this->Numbers);
  mcor_surface& whole = this->Whole;
  bool isGood = Copy(points[0], whole.points);
  whole.point_count = points[0]->GetNumberOfTuples();
  if (isFilled)
  {
    const vtkSPHRanksArrays triangles = vtkSPHGatherTuples(ranks,
      { corners.Get(), View(surface.band_value, 1, surface.triangle_count) }, numbers.OfTriangles);
    isGood = Copy(points[1], whole.iso_value) && Copy(triangles[0], whole.triangles) &&
      Copy(triangles[1], whole.band_value) && isGood;
    whole.triangle_count = triangles[0]->GetNumberOfTuples();
  }
  if (ranks.GetRank() == 0)
  {
    isGood = isGood && numbers.Points <= std::numeric_limits<std::int32_t>::max() &&
      mcor_join_lines(&plane, static_cast<const std::int32_t(*)[2]>(all[0]->GetVoidPointer(0)),
        all[0]->GetNumberOfTuples(), &whole) == MCOR_OK;
  }
  const mcor_statistics& s = whole.statistics;
  std::int64_t counts[2] = { whole.line_count, isGood ? 0 : 1 };
  double measures[3] = { s.length, s.area, s.is_closed ? 1.0 : 0.0 };
  ranks.Reduce(vtkSPHRanks::SUM, counts, 2); // the other ranks have no lines or measures
  ranks.Reduce(vtkSPHRanks::SUM, measures, 3);
  this->Count = counts[0];
  this->Failed = counts[1] > 0;
  surface.statistics.length = measures[0];
  surface.statistics.area = measures[1];
  surface.statistics.is_closed = measures[2] > 0.0;
}

void vtkSPHRanksLines::Move(vtkSPHRanks& ranks, vtkPolyData* output)
{
  const vtkSmartPointer<vtkPolyData> moved =
    vtkSPHMakePoints(vtkSPHGatherTuples(ranks, vtkSPHListArrays(output), this->Numbers), output);
  vtkPointData* arrays = output->GetPointData();
  output->SetPoints(moved->GetPoints());
  arrays->ShallowCopy(moved->GetPointData());
  const auto cells = static_cast<vtkIdType>(this->Whole.line_count + this->Whole.triangle_count);
  vtkMarchingCorrectorsOutput::BuildCells(this->Whole, output);
  arrays->SetGlobalIds(CountUp("GlobalPointIds", output->GetNumberOfPoints()));
  output->GetCellData()->SetGlobalIds(CountUp("GlobalCellIds", cells));
}
VTK_ABI_NAMESPACE_END
