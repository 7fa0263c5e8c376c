// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksLines.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkIdTypeArray.h"
#include "vtkMarchingCorrectorsOutput.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHRanksTuples.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <numeric>

VTK_ABI_NAMESPACE_BEGIN
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
  vtkSPHPlaceOnFirst(ranks, this->Numbers, List(surface.points, 3 * points), this->Whole.points);
  vtkSPHPlaceOnFirst(ranks, this->Numbers, List(surface.iso_value, points), this->Whole.iso_value);
  const vtkSPHRanksLists ofTriangles =
    ranks.GatherOnFirst(List(numbers.OfTriangles->GetPointer(0), triangles));
  std::vector<std::int32_t> corners = List(surface.triangles, 3 * triangles);
  std::transform(corners.begin(), corners.end(), corners.begin(), numberOf);
  vtkSPHPlaceOnFirst(ranks, ofTriangles, std::move(corners), this->Whole.triangles);
  vtkSPHPlaceOnFirst(
    ranks, ofTriangles, List(surface.band_value, triangles), this->Whole.band_value);
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
  vtkSPHRanksLists back(static_cast<std::size_t>(ranks.GetCount()));
  back[0].resize(static_cast<std::size_t>(output->GetNumberOfPoints()));
  std::iota(back[0].begin(), back[0].end(), vtkIdType(0));
  const auto count = static_cast<vtkIdType>(this->Whole.point_count);
  const vtkSmartPointer<vtkPolyData> moved = vtkSPHMakePoints(
    vtkSPHReturnTuples(ranks, vtkSPHListArrays(output), back, this->Numbers, count), output);
  vtkPointData* arrays = output->GetPointData();
  output->SetPoints(moved->GetPoints());
  arrays->ShallowCopy(moved->GetPointData());
  const auto cells = static_cast<vtkIdType>(this->Whole.line_count + this->Whole.triangle_count);
  vtkMarchingCorrectorsOutput::BuildCells(this->Whole, output);
  arrays->SetGlobalIds(CountUp("GlobalPointIds", output->GetNumberOfPoints()));
  output->GetCellData()->SetGlobalIds(CountUp("GlobalCellIds", cells));
}
VTK_ABI_NAMESPACE_END
