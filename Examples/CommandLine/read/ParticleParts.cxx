// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleFile.h"

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
#include <stdexcept>
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
  std::vector<double> median(static_cast<std::size_t>(array->GetNumberOfComponents()));
  if (std::string(array->GetName()) == vtkDataSetAttributes::GhostArrayName())
  {
    return median;
  }
  std::vector<double> values(static_cast<std::size_t>(array->GetNumberOfTuples()));
  for (std::size_t c = 0; c < median.size(); ++c)
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

vtkSmartPointer<vtkPointSet> JoinParts(const std::vector<vtkSmartPointer<vtkPointSet>>& parts)
{
  std::vector<vtkSmartPointer<vtkPolyData>> own(parts.size());
  std::transform(parts.begin(), parts.end(), own.begin(), Own);
  vtkPointData* arrays = own.front()->GetPointData();
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* first = arrays->GetArray(i);
    const std::string name = arrays->GetArrayName(i);
    const bool areAlike = std::all_of(own.begin(), own.end(),
      [first, &name](vtkPolyData* part)
      {
        vtkDataArray* array = first ? part->GetPointData()->GetArray(name.c_str()) : nullptr;
        return !array || array->GetDataType() == first->GetDataType();
      });
    for (std::size_t p = 0; p < own.size() && !areAlike; ++p)
    {
      vtkNew<vtkDoubleArray> values; // VTK would leave out arrays that have different types
      values->DeepCopy(own[p]->GetPointData()->GetArray(name.c_str()));
      own[p]->GetPointData()->AddArray(values);
    }
  }
  vtkNew<vtkMultiBlockDataSet> blocks;
  for (const vtkSmartPointer<vtkPolyData>& part : own)
  {
    blocks->SetBlock(blocks->GetNumberOfBlocks(), part);
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
  vtkPointData* arrays = fluid->GetPointData();
  if (arrays->HasArray(WallArrayName))
  {
    throw std::runtime_error(std::string("the particles have an array '") + WallArrayName +
      "', the name by which --walls marks walls; use --fluid " + WallArrayName +
      "=VALUE, or rename it");
  }
  const vtkIdType count = fluid->GetNumberOfPoints(), wallCount = walls->GetNumberOfPoints();
  auto all = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetData(Append(fluid->GetPoints()->GetData(), walls->GetPoints()->GetData(), wallCount));
  all->SetPoints(points);
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = arrays->GetArray(i); // null for an array of strings
    if (array)
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
