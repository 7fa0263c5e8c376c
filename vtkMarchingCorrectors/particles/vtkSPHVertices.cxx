// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHVertices.h"

#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cstddef>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
vtkSmartPointer<vtkPointSet> vtkSPHTakeVertices(vtkPointSet* data)
{
  const vtkIdType points = data->GetNumberOfPoints(), cells = data->GetNumberOfCells();
  std::vector<vtkIdType> cellOf(static_cast<std::size_t>(points), -1); // the first vertex that uses a point
  vtkIdType vertices = 0;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < cells; ++cell)
  {
    const int type = data->GetCellType(cell);
    if (type != VTK_VERTEX && type != VTK_POLY_VERTEX)
    {
      continue;
    }
    ++vertices;
    data->GetCellPoints(cell, ids);
    for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i)
    {
      const vtkIdType point = ids->GetId(i);
      if (point >= 0 && point < points && cellOf[static_cast<std::size_t>(point)] < 0)
      {
        cellOf[static_cast<std::size_t>(point)] = cell;
      }
    }
  }
  const auto used = points - std::count(cellOf.begin(), cellOf.end(), -1);
  vtkCellData* ofCells = data->GetCellData();
  const bool isMesh = vertices > 0 && vertices < cells;
  if (!isMesh && (used < points || ofCells->GetNumberOfArrays() == 0))
  {
    return data;
  }
  vtkNew<vtkIdList> taken, from; // points, and the vertices whose values are theirs
  for (vtkIdType point = 0; point < points; ++point)
  {
    if (cellOf[static_cast<std::size_t>(point)] >= 0)
    {
      taken->InsertNextId(point);
      from->InsertNextId(cellOf[static_cast<std::size_t>(point)]);
    }
  }
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> places;
  places->SetDataType(data->GetPoints()->GetDataType());
  data->GetPoints()->GetPoints(taken, places);
  particles->SetPoints(places);
  vtkPointData* arrays = particles->GetPointData();
  const auto add = [arrays](vtkFieldData* source, vtkIdList* list)
  {
    for (int i = 0; i < source->GetNumberOfArrays(); ++i)
    {
      vtkAbstractArray* array = source->GetAbstractArray(i);
      if (!array->GetName() || arrays->HasArray(array->GetName()))
      {
        continue;
      }
      auto values = vtkSmartPointer<vtkAbstractArray>::Take(array->NewInstance());
      values->SetName(array->GetName());
      values->SetNumberOfComponents(array->GetNumberOfComponents());
      values->CopyComponentNames(array);
      values->SetNumberOfTuples(list->GetNumberOfIds());
      array->GetTuples(list, values);
      arrays->AddArray(values);
    }
  };
  add(data->GetPointData(), taken);
  add(ofCells, from);
  particles->SetFieldData(data->GetFieldData());
  return particles;
}
VTK_ABI_NAMESPACE_END
