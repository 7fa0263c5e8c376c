// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankSurfaces.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkIdList.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cstring>
#include <vector>

bool IsSameTuple(vtkDataArray* a, vtkIdType i, vtkDataArray* b, vtkIdType j)
{
  const auto size = static_cast<std::size_t>(a->GetNumberOfComponents()) *
    static_cast<std::size_t>(a->GetDataTypeSize());
  return a->GetDataType() == b->GetDataType() &&
    a->GetNumberOfComponents() == b->GetNumberOfComponents() &&
    std::memcmp(static_cast<char*>(a->GetVoidPointer(0)) + static_cast<std::size_t>(i) * size,
      static_cast<char*>(b->GetVoidPointer(0)) + static_cast<std::size_t>(j) * size, size) == 0;
}

namespace
{

/** A triangle or line, by points' numbers. */
std::vector<vtkIdType> Corners(vtkPolyData* surface, vtkDataArray* numbers, vtkIdType i)
{
  vtkNew<vtkIdList> corners;
  surface->GetCellPoints(i, corners);
  std::vector<vtkIdType> found(corners->begin(), corners->end());
  for (vtkIdType& id : found)
  {
    id = numbers ? static_cast<vtkIdType>(numbers->GetComponent(id, 0)) : id;
  }
  return found;
}

/** Each triangle and line has a number, and is the one that has it in the whole surface. */
std::string CompareCells(vtkPolyData* part, vtkPolyData* whole, std::vector<bool>& seen)
{
  const vtkIdType count = part->GetNumberOfCells();
  if (count == 0)
  {
    return "";
  }
  vtkDataArray* numbers = part->GetCellData()->GetGlobalIds();
  if (!numbers || std::string(numbers->GetName()) != "GlobalCellIds" ||
    numbers->GetNumberOfTuples() != count)
  {
    return "there are no global cell ids";
  }
  for (vtkIdType i = 0; i < count; ++i)
  {
    const auto number = static_cast<vtkIdType>(numbers->GetComponent(i, 0));
    if (number < 0 || number >= whole->GetNumberOfCells() || seen[static_cast<std::size_t>(number)])
    {
      return "a cell has number " + std::to_string(number);
    }
    seen[static_cast<std::size_t>(number)] = true;
    if (Corners(part, part->GetPointData()->GetGlobalIds(), i) != Corners(whole, nullptr, number))
    {
      return "cell " + std::to_string(number) + " has other corners";
    }
  }
  return "";
}

std::string ComparePoints(vtkPolyData* part, vtkPolyData* whole, std::vector<bool>& seen)
{
  vtkPointData *arrays = part->GetPointData(), *expected = whole->GetPointData();
  vtkDataArray* numbers = arrays->GetGlobalIds();
  if (part->GetNumberOfPoints() == 0)
  {
    return ""; // VTK sends no arrays then
  }
  if (!numbers || std::string(numbers->GetName()) != "GlobalPointIds")
  {
    return "there are no global point ids";
  }
  if (arrays->GetNumberOfArrays() != expected->GetNumberOfArrays() + 1)
  {
    return std::to_string(arrays->GetNumberOfArrays()) + " arrays";
  }
  for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
  {
    const auto number = static_cast<vtkIdType>(numbers->GetComponent(i, 0));
    if (number < 0 || number >= whole->GetNumberOfPoints())
    {
      return "a point has number " + std::to_string(number);
    }
    seen[static_cast<std::size_t>(number)] = true;
    if (!IsSameTuple(part->GetPoints()->GetData(), i, whole->GetPoints()->GetData(), number))
    {
      return "point " + std::to_string(number) + " is elsewhere";
    }
    for (int k = 0; k < expected->GetNumberOfArrays(); ++k)
    {
      vtkDataArray* array = arrays->GetArray(expected->GetArrayName(k));
      if (!array || !IsSameTuple(array, i, expected->GetArray(k), number))
      {
        return std::string(expected->GetArrayName(k)) + " of point " + std::to_string(number);
      }
    }
  }
  return "";
}

std::string Compare(const std::vector<vtkSmartPointer<vtkPolyData>>& parts, vtkPolyData* whole)
{
  std::vector<bool> seen(static_cast<std::size_t>(whole->GetNumberOfPoints()), false);
  std::vector<bool> seenCells(static_cast<std::size_t>(whole->GetNumberOfCells()), false);
  if (whole->GetNumberOfPoints() < 200)
  {
    return "only " + std::to_string(whole->GetNumberOfPoints()) + " points to compare with";
  }
  for (std::size_t rank = 0; rank < parts.size(); ++rank)
  {
    std::string problem = ComparePoints(parts[rank], whole, seen);
    problem = problem.empty() ? CompareCells(parts[rank], whole, seenCells) : problem;
    if (!problem.empty())
    {
      return "rank " + std::to_string(rank) + ": " + problem;
    }
  }
  const auto lost = std::count(seenCells.begin(), seenCells.end(), false);
  if (lost > 0)
  {
    return std::to_string(lost) + " cells are missing";
  }
  const auto missing = std::count(seen.begin(), seen.end(), false);
  return missing == 0 ? "" : std::to_string(missing) + " points are missing";
}

}

std::string CompareWithWhole(
  vtkMultiProcessController* controller, vtkPolyData* part, vtkPolyData* whole)
{
  constexpr int tag = 1717;
  if (controller->GetLocalProcessId() != 0)
  {
    controller->Send(part, 0, tag);
    return "";
  }
  std::vector<vtkSmartPointer<vtkPolyData>> parts = { part };
  for (int rank = 1; rank < controller->GetNumberOfProcesses(); ++rank)
  {
    parts.emplace_back(vtkSmartPointer<vtkPolyData>::New());
    controller->Receive(parts.back(), rank, tag);
  }
  return Compare(parts, whole);
}
