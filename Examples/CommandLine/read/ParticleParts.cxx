// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleParts.h"

#include "vtkAbstractArray.h"
#include "vtkAppendPolyData.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

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

}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPointSet> JoinParts(const std::vector<vtkSmartPointer<vtkPointSet>>& parts)
{
  vtkNew<vtkAppendPolyData> append;
  for (const vtkSmartPointer<vtkPointSet>& part : parts)
  {
    append->AddInputData(Own(part));
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
