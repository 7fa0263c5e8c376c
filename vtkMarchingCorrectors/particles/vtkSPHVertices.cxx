// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Finds particles among the cells of a mesh.
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataObjectTree.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHBlocks.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
bool IsVertex(int type)
{
  return type == VTK_VERTEX || type == VTK_POLY_VERTEX;
}

/** The list that has a data set's vertex cells: the verts of poly data, or all cells of a grid. Cell i has tuple i of the cell data. */
struct Cells
{
  vtkCellArray* List = nullptr;
  vtkUnstructuredGrid* Grid; ///< null: all are vertices
  bool HasVertices = false, HasOthers = false;

  explicit Cells(vtkPointSet* data)
    : Grid(vtkUnstructuredGrid::SafeDownCast(data))
  {
    if (auto* poly = vtkPolyData::SafeDownCast(data))
    {
      this->List = poly->GetVerts();
      this->HasVertices = poly->GetNumberOfVerts() > 0;
      this->HasOthers = poly->GetNumberOfCells() > poly->GetNumberOfVerts();
      return;
    }
    this->HasOthers = !this->Grid && data->GetNumberOfCells() > 0;
    this->List = this->Grid ? this->Grid->GetCells() : nullptr;
    for (vtkIdType i = 0; this->Grid && i < this->Grid->GetNumberOfCells(); ++i)
    {
      (IsVertex(this->Grid->GetCellType(i)) ? this->HasVertices : this->HasOthers) = true;
    }
  }
};

/** Copies the tuples `ids` of each array with `count` tuples to `to`, unless `to` has an array of the same name. */
void AddValues(vtkDataSetAttributes* from, vtkIdType count, vtkIdList* ids, vtkPointData* to)
{
  for (int i = 0; i < from->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = from->GetAbstractArray(i);
    if (!array->GetName() || to->HasArray(array->GetName()) || array->GetNumberOfTuples() != count)
    {
      continue;
    }
    const vtkSmartPointer<vtkAbstractArray> values = vtkSPHMakeLike(array, ids->GetNumberOfIds());
    array->GetTuples(ids, values);
    const int at = to->AddArray(values), attribute = from->IsArrayAnAttribute(i);
    if (attribute >= 0 && !to->GetAbstractAttribute(attribute))
    {
      to->SetActiveAttribute(at, attribute);
    }
  }
}

vtkSmartPointer<vtkDataObject> TakeOfSet(vtkPointSet* data, bool haveVertices)
{
  const vtkIdType count = data->GetNumberOfPoints();
  const Cells cells(data);
  const bool isMesh = haveVertices && cells.HasOthers;
  const bool haveArrays = cells.HasVertices && data->GetCellData()->GetNumberOfArrays() > 0;
  if (count == 0 || !(isMesh || haveArrays))
  {
    return data;
  }
  vtkNew<vtkIdList> taken, from;              // points, and the vertices whose values they get
  std::vector<vtkIdType> vertexOf(count, -1); // for each point: the first vertex that uses it
  for (vtkIdType cell = 0; cells.HasVertices && cell < cells.List->GetNumberOfCells(); ++cell)
  {
    vtkIdType corners = 0;
    const vtkIdType* ids = nullptr;
    if (!cells.Grid || IsVertex(cells.Grid->GetCellType(cell)))
    {
      cells.List->GetCellAtId(cell, corners, ids);
    }
    for (vtkIdType i = 0; i < corners; ++i)
    {
      if (ids[i] >= 0 && ids[i] < count && vertexOf[ids[i]] < 0)
      {
        vertexOf[ids[i]] = cell;
      }
    }
  }
  for (vtkIdType point = 0; point < count; ++point)
  {
    if (vertexOf[point] >= 0)
    {
      taken->InsertNextId(point);
      from->InsertNextId(vertexOf[point]);
    }
  }
  if (!isMesh && taken->GetNumberOfIds() < count)
  {
    return data;
  }
  auto particles = vtkSmartPointer<vtkPointSet>::Take(data->NewInstance());
  particles->SetPoints(vtkSPHTakePoints(data->GetPoints(), taken));
  AddValues(data->GetPointData(), count, taken, particles->GetPointData());
  AddValues(data->GetCellData(), data->GetNumberOfCells(), from, particles->GetPointData());
  particles->SetFieldData(data->GetFieldData());
  const vtkSmartPointer<vtkCellArray> vertices = vtkSPHMakeVertices(taken->GetNumberOfIds());
  if (auto* poly = vtkPolyData::SafeDownCast(particles))
  {
    poly->SetVerts(vertices);
  }
  else if (auto* grid = vtkUnstructuredGrid::SafeDownCast(particles))
  {
    grid->SetCells(VTK_VERTEX, vertices);
  }
  return particles;
}
}

bool vtkSPHHaveVertices(vtkDataObject* data)
{
  const std::vector<vtkPointSet*> sets = vtkSPHListPointSets(data);
  return std::any_of(
    sets.begin(), sets.end(), [](vtkPointSet* set) { return Cells(set).HasVertices; });
}

vtkSmartPointer<vtkDataObject> vtkSPHTakeVertices(vtkDataObject* data, bool haveVertices)
{
  if (auto* set = vtkPointSet::SafeDownCast(data))
  {
    return TakeOfSet(set, haveVertices);
  }
  auto* tree = vtkDataObjectTree::SafeDownCast(data);
  if (!tree)
  {
    return data;
  }
  vtkSmartPointer<vtkDataObjectTree> made;
  const auto iterator = vtk::TakeSmartPointer(tree->NewTreeIterator());
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    vtkDataObject* block = iterator->GetCurrentDataObject();
    const vtkSmartPointer<vtkDataObject> taken = vtkSPHTakeVertices(block, haveVertices);
    if (taken != block && !made)
    {
      made.TakeReference(tree->NewInstance());
      made->ShallowCopy(tree);
    }
    if (taken != block)
    {
      made->SetDataSet(iterator, taken);
    }
  }
  return made ? made.Get() : data;
}
VTK_ABI_NAMESPACE_END
