// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleParts.h"

#include "vtkAbstractArray.h"
#include "vtkAppendPolyData.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace
{

/// The same without copies of other parts' particles.
vtkSmartPointer<vtkPolyData> Own(vtkPointSet* part)
{
  auto own = vtkSmartPointer<vtkPolyData>::New();
  own->ShallowCopy(part);
  vtkUnsignedCharArray* marks = part->GetPointGhostArray();
  if (!marks)
  {
    return own;
  }
  vtkPointData *from = part->GetPointData(), *to = own->GetPointData();
  vtkNew<vtkPoints> points;
  points->SetDataType(part->GetPoints()->GetDataType());
  to->Initialize();
  to->CopyAllOn();
  to->CopyAllocate(from, part->GetNumberOfPoints());
  for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
  {
    if (!(marks->GetValue(i) & vtkDataSetAttributes::DUPLICATEPOINT))
    {
      to->CopyData(from, i, points->InsertNextPoint(part->GetPoint(i)));
    }
  }
  to->Squeeze();
  own->SetPoints(points);
  return own;
}

bool HaveOneType(const std::vector<vtkSmartPointer<vtkPolyData>>& parts, const char* name)
{
  vtkDataArray* first = parts.front()->GetPointData()->GetArray(name);
  return std::all_of(parts.begin(), parts.end(),
    [&](vtkPolyData* part)
    {
      vtkDataArray* array = part->GetPointData()->GetArray(name);
      return !first || !array || array->GetDataType() == first->GetDataType();
    });
}

/// Arrays of one name and several types become doubles: VTK would leave them out.
void MakeTypesAlike(const std::vector<vtkSmartPointer<vtkPolyData>>& parts)
{
  vtkPointData* arrays = parts.front()->GetPointData();
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    const std::string name = arrays->GetArrayName(i);
    for (std::size_t p = 0; p < parts.size() && !HaveOneType(parts, name.c_str()); ++p)
    {
      vtkNew<vtkDoubleArray> values;
      values->DeepCopy(parts[p]->GetPointData()->GetArray(name.c_str()));
      parts[p]->GetPointData()->AddArray(values);
    }
  }
}

}

vtkSmartPointer<vtkPointSet> JoinParts(const std::vector<vtkSmartPointer<vtkPointSet>>& parts)
{
  std::vector<vtkSmartPointer<vtkPolyData>> own(parts.size());
  std::transform(parts.begin(), parts.end(), own.begin(), Own);
  MakeTypesAlike(own);
  vtkNew<vtkAppendPolyData> append;
  for (const vtkSmartPointer<vtkPolyData>& part : own)
  {
    append->AddInputData(part);
  }
  append->Update();
  vtkPolyData* all = append->GetOutput();
  auto joined = vtkSmartPointer<vtkPolyData>::New();
  joined->SetPoints(all->GetPoints());
  vtkPointData* order = parts.front()->GetPointData(); // VTK sorts the arrays by name
  for (int i = 0; i < order->GetNumberOfArrays(); ++i)
  {
    if (vtkAbstractArray* array = all->GetPointData()->GetAbstractArray(order->GetArrayName(i)))
    {
      joined->GetPointData()->AddArray(array);
    }
  }
  joined->SetFieldData(parts.front()->GetFieldData());
  return joined;
}
