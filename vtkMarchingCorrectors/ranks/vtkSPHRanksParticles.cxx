// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksParticles.h"

#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksLayout.h"
#include "vtkSPHRanksTuples.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <numeric>

namespace
{
/** Whether it can travel as it is. */
bool LiesPlain(vtkAbstractArray* array)
{
  const auto* numbers = vtkArrayDownCast<vtkDataArray>(array);
  return !numbers || numbers->HasStandardMemoryLayout();
}

/** The particles themselves, where they have these arrays and lie as the others will; else null. */
vtkSmartPointer<vtkPolyData> ShareParticles(const vtkSPHRanksLayout& layout, vtkPolyData* particles)
{
  const vtkSPHRanksLayout own = vtkSPHDescribe(particles);
  if (own.Points == 0 || own.Forms != layout.Forms)
  {
    return nullptr;
  }
  vtkDataArray* positions = particles->GetPoints()->GetData();
  bool isPlain =
    positions->GetDataType() == (layout.IsDouble ? VTK_DOUBLE : VTK_FLOAT) && LiesPlain(positions);
  for (const vtkSPHRanksForm& form : layout.Forms)
  {
    isPlain = isPlain && LiesPlain(particles->GetPointData()->GetAbstractArray(form.Name.c_str()));
  }
  if (!isPlain)
  {
    return nullptr;
  }
  auto shared = vtkSmartPointer<vtkPolyData>::New();
  shared->SetPoints(particles->GetPoints());
  for (const vtkSPHRanksForm& form : layout.Forms)
  {
    const int at = shared->GetPointData()->AddArray(
      particles->GetPointData()->GetAbstractArray(form.Name.c_str()));
    if (form.Attribute >= 0)
    {
      shared->GetPointData()->SetActiveAttribute(at, form.Attribute);
    }
  }
  return shared;
}

bool HasDuplicates(vtkPointSet* data)
{
  vtkUnsignedCharArray* marks = data ? data->GetPointGhostArray() : nullptr;
  const vtkIdType count = marks ? marks->GetNumberOfTuples() : 0;
  vtkIdType i = 0;
  while (i < count && !(marks->GetValue(i) & vtkDataSetAttributes::DUPLICATEPOINT))
  {
    ++i;
  }
  return i < count;
}

vtkSmartPointer<vtkIdList> ListOwn(vtkPointSet* data)
{
  auto own = vtkSmartPointer<vtkIdList>::New();
  const vtkIdType count = data ? data->GetNumberOfPoints() : 0;
  vtkUnsignedCharArray* marks = count > 0 ? data->GetPointGhostArray() : nullptr;
  own->Allocate(count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    if (!marks || !(marks->GetValue(i) & vtkDataSetAttributes::DUPLICATEPOINT))
    {
      own->InsertNextId(i);
    }
  }
  return own;
}

}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkSPHTakeParticles(
  vtkSPHRanks& ranks, vtkPointSet* data, vtkIdList* taken)
{
  vtkNew<vtkPolyData> view;
  if (data && data->GetNumberOfPoints() > 0)
  {
    view->SetPoints(data->GetPoints());
    view->GetPointData()->ShallowCopy(data->GetPointData());
  }
  const vtkSPHRanksLayout common = vtkSPHAgreeOnLayout(ranks, vtkSPHDescribe(view));
  if (const vtkSmartPointer<vtkPolyData> shared =
        taken || HasDuplicates(data) ? nullptr : ShareParticles(common, view))
  {
    return shared;
  }
  const vtkSmartPointer<vtkIdList> own = ListOwn(data);
  if (taken)
  {
    taken->DeepCopy(own);
  }
  auto particles = vtkSPHMakeParticles(common, own->GetNumberOfIds());
  if (data)
  {
    particles->GetFieldData()->ShallowCopy(data->GetFieldData());
  }
  if (own->GetNumberOfIds() > 0)
  {
    view->GetPoints()->GetData()->GetTuples(own, particles->GetPoints()->GetData());
    for (const vtkSPHRanksForm& form : common.Forms)
    {
      view->GetPointData()
        ->GetAbstractArray(form.Name.c_str())
        ->GetTuples(own, particles->GetPointData()->GetAbstractArray(form.Name.c_str()));
    }
  }
  return particles;
}

//------------------------------------------------------------------------------
// In the order in which they are, and what was made of some of them last: so they are found again.
vtkSmartPointer<vtkPolyData> vtkSPHKeepUsed(vtkPolyData* own, const vtkSPHParticles& used)
{
  vtkSPHRanksArrays arrays = { used.SmoothingLength, used.Volume, used.Mass, used.Density,
    used.Fluid };
  for (const vtkSPHAttribute& attribute : used.Interpolated)
  {
    arrays.push_back(attribute.Array);
  }
  auto kept = vtkSmartPointer<vtkPolyData>::New();
  kept->SetPoints(own->GetPoints());
  vtkPointData *from = own->GetPointData(), *to = kept->GetPointData();
  for (int i = 0; i < from->GetNumberOfArrays(); ++i)
  {
    if (std::find(arrays.begin(), arrays.end(), from->GetAbstractArray(i)) != arrays.end())
    {
      const int at = to->AddArray(from->GetAbstractArray(i)),
                attribute = from->IsArrayAnAttribute(i);
      if (attribute >= 0)
      {
        to->SetActiveAttribute(at, attribute);
      }
    }
  }
  for (vtkAbstractArray* array : arrays)
  {
    if (array && !to->HasArray(array->GetName()))
    {
      to->AddArray(array);
    }
  }
  return kept;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkSPHSendParticles(vtkSPHRanks& ranks, vtkPolyData* particles,
  const std::vector<std::vector<vtkIdType>>& to, std::vector<vtkIdType>* from)
{
  const std::vector<vtkSPHRanks::Bytes> received =
    vtkSPHSendTuples(ranks, vtkSPHListArrays(particles), to);
  const std::vector<vtkIdType> counts = vtkSPHCountTuples(received);
  auto near = vtkSPHMakeParticles(
    vtkSPHDescribe(particles), std::accumulate(counts.begin(), counts.end(), vtkIdType(0)));
  vtkSPHReceiveTuples(received, vtkSPHListArrays(near));
  if (from)
  {
    *from = counts;
  }
  return near;
}

//------------------------------------------------------------------------------
void vtkSPHReturnArrays(vtkSPHRanks& ranks, vtkPointData* results, vtkIdType count,
  const std::vector<std::vector<vtkIdType>>& back, const std::vector<std::vector<vtkIdType>>& home,
  vtkIdType homeCount, vtkPointData* to)
{
  const vtkSPHRanksLayout layout = vtkSPHDescribeArrays(results, count);
  const std::vector<vtkSPHRanks::Bytes> received =
    vtkSPHSendTuples(ranks, vtkSPHListArrays(results), back);
  vtkNew<vtkIdList> places;
  for (const std::vector<vtkIdType>& ids : home)
  {
    for (const vtkIdType id : ids)
    {
      places->InsertNextId(id);
    }
  }
  vtkNew<vtkPointData> came;
  vtkSPHAddArrays(came, layout, places->GetNumberOfIds());
  vtkSPHReceiveTuples(received, vtkSPHListArrays(came));
  vtkNew<vtkIdList> order;
  order->SetNumberOfIds(places->GetNumberOfIds());
  std::iota(order->begin(), order->end(), vtkIdType(0));
  for (const vtkSPHRanksForm& form : layout.Forms)
  {
    vtkSmartPointer<vtkAbstractArray> array = vtkSPHMakeArray(form, homeCount);
    if (auto* numbers = vtkArrayDownCast<vtkDataArray>(array))
    {
      numbers->Fill(0.0);
    }
    array->InsertTuples(places, order, came->GetAbstractArray(form.Name.c_str()));
    to->AddArray(array);
  }
}

//------------------------------------------------------------------------------
void vtkSPHMatchEmpty(vtkSPHRanks& ranks, vtkPolyData* result)
{
  const vtkSPHRanksLayout common = vtkSPHAgreeOnLayout(ranks, vtkSPHDescribe(result));
  if (result->GetNumberOfPoints() == 0)
  {
    const vtkSmartPointer<vtkPolyData> empty = vtkSPHMakeParticles(common, 0);
    result->SetPoints(empty->GetPoints());
    result->GetPointData()->ShallowCopy(empty->GetPointData());
  }
}
