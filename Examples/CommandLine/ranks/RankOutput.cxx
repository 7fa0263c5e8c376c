// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankOutput.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <vector>

namespace
{

/// Gives the whole room for all arrays that the first part has, but for the numbers.
void Allocate(vtkDataSetAttributes* whole, vtkDataSetAttributes* first, vtkIdType count)
{
  whole->CopyAllOn();
  whole->CopyGlobalIdsOff();
  whole->CopyAllocate(first, count);
  whole->SetNumberOfTuples(count);
}

/// Puts what a part has of each array where its numbers say; returns these.
vtkSmartPointer<vtkIdList> Place(vtkDataSetAttributes* from, vtkDataSetAttributes* to)
{
  vtkDataArray* numbers = from->GetGlobalIds();
  const vtkIdType count = numbers ? numbers->GetNumberOfTuples() : 0;
  vtkNew<vtkIdList> own;
  auto places = vtkSmartPointer<vtkIdList>::New();
  for (vtkIdType i = 0; i < count; ++i)
  {
    own->InsertNextId(i);
    places->InsertNextId(static_cast<vtkIdType>(numbers->GetComponent(i, 0)));
  }
  for (int a = 0; count > 0 && a < to->GetNumberOfArrays(); ++a)
  {
    vtkAbstractArray* array = to->GetAbstractArray(a);
    array->InsertTuples(places, own, from->GetAbstractArray(array->GetName()));
  }
  return places;
}

/// Puts a part's points and triangles, with their arrays, where their numbers say.
void Place(vtkPolyData* part, vtkPolyData* whole, vtkIdTypeArray* corners)
{
  if (part->GetNumberOfPoints() == 0)
  {
    return; // VTK sends no arrays then
  }
  vtkNew<vtkIdList> triangle;
  const vtkSmartPointer<vtkIdList> places = Place(part->GetPointData(), whole->GetPointData());
  const vtkSmartPointer<vtkIdList> triangles = Place(part->GetCellData(), whole->GetCellData());
  for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
  {
    whole->GetPoints()->SetPoint(places->GetId(i), part->GetPoint(i));
  }
  for (vtkIdType i = 0; i < part->GetNumberOfPolys(); ++i)
  {
    part->GetPolys()->GetCellAtId(i, triangle);
    for (vtkIdType c = 0; c < 3; ++c)
    {
      corners->SetValue(3 * triangles->GetId(i) + c, places->GetId(triangle->GetId(c)));
    }
  }
}

vtkSmartPointer<vtkPolyData> Merge(const std::vector<vtkSmartPointer<vtkPolyData>>& parts)
{
  auto whole = vtkSmartPointer<vtkPolyData>::New();
  vtkPolyData* first = parts.front();
  whole->GetFieldData()->ShallowCopy(first->GetFieldData());
  if (!first->GetPoints())
  {
    return whole;
  }
  if (std::all_of(parts.begin() + 1, parts.end(),
        [](vtkPolyData* part) { return part->GetNumberOfPoints() == 0; }))
  {
    whole->ShallowCopy(first); // as of lines, and what is filled
    whole->GetPointData()->RemoveArray("GlobalPointIds");
    whole->GetCellData()->RemoveArray("GlobalCellIds");
    return whole;
  }
  vtkIdType count = 0, triangleCount = 0; // numbers go from 0 on; a triangle is in one part
  for (const auto& part : parts)
  {
    vtkDataArray* numbers = part->GetPointData()->GetGlobalIds();
    for (vtkIdType i = 0; numbers && i < part->GetNumberOfPoints(); ++i)
    {
      count = std::max(count, static_cast<vtkIdType>(numbers->GetComponent(i, 0)) + 1);
    }
    triangleCount += part->GetNumberOfPolys();
  }
  vtkNew<vtkPoints> points;
  vtkNew<vtkIdTypeArray> corners;
  corners->SetNumberOfValues(3 * triangleCount);
  points->SetDataType(first->GetPoints()->GetDataType());
  points->SetNumberOfPoints(count);
  whole->SetPoints(points);
  Allocate(whole->GetPointData(), first->GetPointData(), count);
  Allocate(whole->GetCellData(), first->GetCellData(), triangleCount);
  for (const auto& part : parts)
  {
    Place(part, whole, corners);
  }
  vtkNew<vtkCellArray> triangles;
  triangles->SetData(3, corners);
  whole->SetPolys(triangles);
  return whole;
}

}

vtkSmartPointer<vtkPolyData> MergeOnFirst(vtkMultiProcessController* controller, vtkPolyData* part)
{
  constexpr int tag = 1717;
  if (controller->GetLocalProcessId() != 0)
  {
    controller->Send(part, 0, tag);
    return nullptr;
  }
  std::vector<vtkSmartPointer<vtkPolyData>> parts = { part };
  for (int rank = 1; rank < controller->GetNumberOfProcesses(); ++rank)
  {
    parts.emplace_back(vtkSmartPointer<vtkPolyData>::New());
    controller->Receive(parts.back(), rank, tag);
  }
  return Merge(parts);
}
