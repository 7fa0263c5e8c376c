// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleFile.h"

#include "Formats.h"
#include "Text.h"

#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHBlocks.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

const char* const WallArrayName = "IsWall";

namespace
{

/// Returns the part without copies of other parts' particles.
vtkSmartPointer<vtkPolyData> Own(vtkPointSet* part)
{
  auto own = vtkSmartPointer<vtkPolyData>::New();
  own->ShallowCopy(part);
  vtkUnsignedCharArray* marks = part->GetPointGhostArray();
  if (!marks)
  {
    return own;
  }
  vtkNew<vtkIdList> kept;
  for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
  {
    if (!(marks->GetValue(i) & vtkDataSetAttributes::DUPLICATEPOINT))
    {
      kept->InsertNextId(i);
    }
  }
  own->SetPoints(vtkSPHTakePoints(part->GetPoints(), kept));
  own->GetPointData()->Initialize();
  vtkSPHTakeTuples(part->GetPointData(), kept, own->GetPointData());
  return own;
}

/// Returns each component's median; 0 for vtkGhostType, because walls are not copies.
std::vector<double> Median(vtkDataArray* array)
{
  const bool isGhost = std::string(array->GetName()) == vtkDataSetAttributes::GhostArrayName();
  std::vector<double> median(static_cast<std::size_t>(array->GetNumberOfComponents()));
  std::vector<double> values(static_cast<std::size_t>(array->GetNumberOfTuples()));
  for (std::size_t c = 0; c < median.size() && !isGhost; ++c)
  {
    for (std::size_t i = 0; i < values.size(); ++i)
    {
      values[i] = array->GetComponent(static_cast<vtkIdType>(i), static_cast<int>(c));
    }
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[c] = *middle;
  }
  return median;
}

/// Joins both arrays, the fluid's first, in the fluid's type.
vtkSmartPointer<vtkDataArray> Append(vtkDataArray* fluid, vtkDataArray* walls, vtkIdType wallCount)
{
  const vtkIdType count = fluid->GetNumberOfTuples();
  auto all = vtk::TakeSmartPointer(fluid->NewInstance());
  all->SetName(fluid->GetName());
  all->SetNumberOfComponents(fluid->GetNumberOfComponents());
  all->SetNumberOfTuples(count + wallCount);
  all->InsertTuples(0, count, 0, fluid);
  const bool haveOwn = walls && walls->GetNumberOfComponents() == fluid->GetNumberOfComponents();
  const std::vector<double> median = haveOwn ? std::vector<double>() : Median(fluid);
  for (vtkIdType i = 0; i < wallCount; ++i)
  {
    all->SetTuple(count + i, haveOwn ? walls->GetTuple(i) : median.data());
  }
  return all;
}

}

vtkSmartPointer<vtkPolyData> PointsAt(vtkDataArray* places)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetData(places);
  data->SetPoints(points);
  return data;
}

vtkSmartPointer<vtkPointSet> JoinParts(const std::vector<vtkSmartPointer<vtkPointSet>>& parts)
{
  vtkNew<vtkMultiBlockDataSet> blocks;
  std::map<std::string, std::set<int>> types; // the types of each array
  for (const vtkSmartPointer<vtkPointSet>& part : parts)
  {
    const vtkSmartPointer<vtkPolyData> own = Own(part);
    for (vtkAbstractArray* array : ArraysOf(own->GetPointData()))
    {
      types[array->GetName()].insert(array->GetDataType());
    }
    blocks->SetBlock(blocks->GetNumberOfBlocks(), own);
  }
  for (unsigned b = 0; b < blocks->GetNumberOfBlocks(); ++b)
  {
    vtkPointData* arrays = vtkPolyData::SafeDownCast(blocks->GetBlock(b))->GetPointData();
    for (vtkAbstractArray* array : ArraysOf(arrays))
    {
      if (types[array->GetName()].size() > 1 && !types[array->GetName()].count(VTK_STRING))
      {
        vtkNew<vtkDoubleArray> values; // VTK would leave out arrays that have different types
        values->DeepCopy(array);
        arrays->AddArray(values);
      }
    }
  }
  const vtkSmartPointer<vtkPointSet> joined = vtkSPHJoinBlocks(blocks);
  joined->SetFieldData(parts.front()->GetFieldData());
  return joined;
}

vtkSmartPointer<vtkPointSet> AddWalls(vtkPointSet* fluid, vtkPointSet* walls)
{
  if (!walls || fluid->GetNumberOfPoints() == 0)
  {
    return fluid; // without fluid there is nothing for walls to end
  }
  Require(!fluid->GetPointData()->HasArray(WallArrayName),
    std::string("the particles have an array '") + WallArrayName +
      "', the name by which --walls marks walls; use --fluid " + WallArrayName +
      "=VALUE, or rename it");
  const vtkIdType count = fluid->GetNumberOfPoints(), wallCount = walls->GetNumberOfPoints();
  const vtkSmartPointer<vtkPolyData> all =
    PointsAt(Append(fluid->GetPoints()->GetData(), walls->GetPoints()->GetData(), wallCount));
  for (vtkAbstractArray* each : ArraysOf(fluid->GetPointData()))
  {
    if (vtkDataArray* array = vtkDataArray::SafeDownCast(each)) // texts are left out
    {
      all->GetPointData()->AddArray(
        Append(array, walls->GetPointData()->GetArray(array->GetName()), wallCount));
    }
  }
  vtkNew<vtkUnsignedCharArray> marks;
  marks->SetName(WallArrayName);
  marks->SetNumberOfTuples(count + wallCount);
  for (vtkIdType i = 0; i < count + wallCount; ++i)
  {
    marks->SetValue(i, i < count ? 0 : 1);
  }
  all->GetPointData()->AddArray(marks);
  all->SetFieldData(fluid->GetFieldData());
  return all;
}
