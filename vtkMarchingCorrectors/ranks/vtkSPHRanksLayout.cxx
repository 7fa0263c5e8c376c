// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksLayout.h"

#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksBytes.h"

#include <algorithm>

namespace
{
using Bytes = vtkSPHRanks::Bytes;

Bytes Pack(const vtkSPHRanksLayout& layout)
{
  Bytes bytes;
  vtkSPHPutNumber(bytes, layout.Points);
  vtkSPHPutNumber(bytes, layout.IsDouble);
  vtkSPHPutNumber(bytes, static_cast<std::int64_t>(layout.Forms.size()));
  for (const vtkSPHRanksForm& form : layout.Forms)
  {
    vtkSPHPutText(bytes, form.Name);
    vtkSPHPutNumber(bytes, form.Type);
    vtkSPHPutNumber(bytes, form.Attribute);
    vtkSPHPutNumber(bytes, form.HasLabels);
    vtkSPHPutNumber(bytes, static_cast<std::int64_t>(form.Components.size()));
    for (const std::string& label : form.Components)
    {
      vtkSPHPutText(bytes, label);
    }
  }
  return bytes;
}

vtkSPHRanksLayout Unpack(const Bytes& bytes)
{
  vtkSPHRanksReader reader(bytes);
  vtkSPHRanksLayout layout;
  layout.Points = reader.GetNumber();
  layout.IsDouble = reader.GetNumber();
  layout.Forms.resize(static_cast<std::size_t>(reader.GetNumber()));
  for (vtkSPHRanksForm& form : layout.Forms)
  {
    form.Name = reader.GetText();
    form.Type = static_cast<int>(reader.GetNumber());
    form.Attribute = static_cast<int>(reader.GetNumber());
    form.HasLabels = reader.GetNumber() != 0;
    form.Components.resize(static_cast<std::size_t>(reader.GetNumber()));
    for (std::string& label : form.Components)
    {
      label = reader.GetText();
    }
  }
  return layout;
}
}

//------------------------------------------------------------------------------
vtkSPHRanksLayout vtkSPHDescribeArrays(vtkPointData* arrays, vtkIdType count)
{
  vtkSPHRanksLayout layout;
  layout.Points = count;
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = arrays->GetAbstractArray(i);
    const std::string name = array->GetName() ? array->GetName() : "";
    const bool isKnown =
      vtkArrayDownCast<vtkDataArray>(array) || array->GetDataType() == VTK_STRING;
    if (isKnown && !name.empty() && name != vtkDataSetAttributes::GhostArrayName() &&
      array->GetNumberOfTuples() == layout.Points)
    {
      vtkSPHRanksForm form = { name, array->GetDataType(), arrays->IsArrayAnAttribute(i), {},
        array->HasAComponentName() };
      for (int c = 0; c < array->GetNumberOfComponents(); ++c)
      {
        const char* label = array->GetComponentName(c);
        form.Components.emplace_back(label ? label : "");
      }
      layout.Forms.push_back(form);
    }
  }
  return layout;
}

//------------------------------------------------------------------------------
vtkSPHRanksLayout vtkSPHDescribe(vtkPolyData* particles)
{
  vtkSPHRanksLayout layout =
    vtkSPHDescribeArrays(particles->GetPointData(), particles->GetNumberOfPoints());
  layout.IsDouble = particles->GetPoints() && particles->GetPoints()->GetDataType() != VTK_FLOAT;
  return layout;
}

//------------------------------------------------------------------------------
vtkSPHRanksLayout vtkSPHAgreeOnLayout(vtkSPHRanks& ranks, const vtkSPHRanksLayout& mine)
{
  vtkSPHRanksLayout common;
  for (const vtkSPHRanks::Bytes& bytes : ranks.Gather(Pack(mine)))
  {
    const vtkSPHRanksLayout other = Unpack(bytes);
    if (other.Points == 0)
    {
      continue;
    }
    if (common.Points == 0)
    {
      common.Forms = other.Forms;
    }
    common.Points += other.Points;
    common.IsDouble = common.IsDouble || other.IsDouble;
    const auto isMissing = [&other](const vtkSPHRanksForm& form)
    {
      return std::none_of(other.Forms.begin(), other.Forms.end(),
        [&form](const vtkSPHRanksForm& theirs) { return form.IsLike(theirs); });
    };
    common.Forms.erase(
      std::remove_if(common.Forms.begin(), common.Forms.end(), isMissing), common.Forms.end());
  }
  return common;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkAbstractArray> vtkSPHMakeArray(const vtkSPHRanksForm& form, vtkIdType count)
{
  auto array = vtkSmartPointer<vtkAbstractArray>::Take(vtkAbstractArray::CreateArray(form.Type));
  const int components = static_cast<int>(form.Components.size());
  array->SetName(form.Name.c_str());
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(count);
  for (int c = 0; form.HasLabels && c < components; ++c)
  {
    array->SetComponentName(c, form.Components[static_cast<std::size_t>(c)].c_str());
  }
  return array;
}

//------------------------------------------------------------------------------
void vtkSPHAddArrays(vtkPointData* data, const vtkSPHRanksLayout& layout, vtkIdType count)
{
  for (const vtkSPHRanksForm& form : layout.Forms)
  {
    const int at = data->AddArray(vtkSPHMakeArray(form, count));
    if (form.Attribute >= 0)
    {
      data->SetActiveAttribute(at, form.Attribute);
    }
  }
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkSPHMakeParticles(const vtkSPHRanksLayout& layout, vtkIdType count)
{
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataType(layout.IsDouble ? VTK_DOUBLE : VTK_FLOAT);
  points->SetNumberOfPoints(count);
  particles->SetPoints(points);
  vtkSPHAddArrays(particles->GetPointData(), layout, count);
  return particles;
}
