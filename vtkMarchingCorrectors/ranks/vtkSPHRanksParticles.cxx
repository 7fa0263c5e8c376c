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
#include "vtkSPHRanksBytes.h"
#include "vtkSPHRanksTuples.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string>

namespace
{
// ---- Which point arrays particles have on all ranks ----

/** What a point array is, but for its values. */
struct Form
{
  std::string Name;
  int Type;
  int Attribute; // of vtkDataSetAttributes, or -1
  std::vector<std::string> Components;
  bool HasLabels;

  bool IsLike(const Form& other) const
  {
    return this->Name == other.Name && this->Type == other.Type &&
      this->Components.size() == other.Components.size();
  }

  bool operator==(const Form& other) const
  {
    return this->IsLike(other) && this->Attribute == other.Attribute &&
      this->HasLabels == other.HasLabels && this->Components == other.Components;
  }
};

struct Layout
{
  std::int64_t Points = 0;
  std::int64_t IsDouble = 0;
  std::vector<Form> Forms;
};

using Bytes = vtkSPHRanks::Bytes;

Bytes Pack(const Layout& layout)
{
  Bytes bytes;
  vtkSPHPutNumber(bytes, layout.Points);
  vtkSPHPutNumber(bytes, layout.IsDouble);
  vtkSPHPutNumber(bytes, static_cast<std::int64_t>(layout.Forms.size()));
  for (const Form& form : layout.Forms)
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

Layout Unpack(const Bytes& bytes)
{
  vtkSPHRanksReader reader(bytes);
  Layout layout;
  layout.Points = reader.GetNumber();
  layout.IsDouble = reader.GetNumber();
  layout.Forms.resize(static_cast<std::size_t>(reader.GetNumber()));
  for (Form& form : layout.Forms)
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

/** Of the arrays with so many tuples that have a name, but for vtkGhostType. */
Layout DescribeArrays(vtkPointData* arrays, vtkIdType count)
{
  Layout layout;
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
      Form form = { name, array->GetDataType(), arrays->IsArrayAnAttribute(i), {},
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

Layout Describe(vtkPolyData* particles)
{
  Layout layout = DescribeArrays(particles->GetPointData(), particles->GetNumberOfPoints());
  layout.IsDouble = particles->GetPoints() && particles->GetPoints()->GetDataType() != VTK_FLOAT;
  return layout;
}

/** What all ranks that have particles have. Collective. */
Layout AgreeOnLayout(vtkSPHRanks& ranks, const Layout& mine)
{
  Layout common;
  for (const vtkSPHRanks::Bytes& bytes : ranks.Gather(Pack(mine)))
  {
    const Layout other = Unpack(bytes);
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
    const auto isMissing = [&other](const Form& form)
    {
      return std::none_of(other.Forms.begin(), other.Forms.end(),
        [&form](const Form& theirs) { return form.IsLike(theirs); });
    };
    common.Forms.erase(
      std::remove_if(common.Forms.begin(), common.Forms.end(), isMissing), common.Forms.end());
  }
  return common;
}

vtkSmartPointer<vtkAbstractArray> MakeArray(const Form& form, vtkIdType count)
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

/** Arrays of so many tuples, without values yet. */
void AddArrays(vtkPointData* data, const Layout& layout, vtkIdType count)
{
  for (const Form& form : layout.Forms)
  {
    const int at = data->AddArray(MakeArray(form, count));
    if (form.Attribute >= 0)
    {
      data->SetActiveAttribute(at, form.Attribute);
    }
  }
}

vtkSmartPointer<vtkPolyData> MakeParticles(const Layout& layout, vtkIdType count)
{
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataType(layout.IsDouble ? VTK_DOUBLE : VTK_FLOAT);
  points->SetNumberOfPoints(count);
  particles->SetPoints(points);
  AddArrays(particles->GetPointData(), layout, count);
  return particles;
}

// ---- Particles that travel ----

/** Whether it can travel as it is. */
bool LiesPlain(vtkAbstractArray* array)
{
  const auto* numbers = vtkArrayDownCast<vtkDataArray>(array);
  return !numbers || numbers->HasStandardMemoryLayout();
}

/** The particles themselves, where they have these arrays and lie as the others will; else null. */
vtkSmartPointer<vtkPolyData> ShareParticles(const Layout& layout, vtkPolyData* particles)
{
  const Layout own = Describe(particles);
  if (own.Points == 0 || own.Forms != layout.Forms)
  {
    return nullptr;
  }
  vtkDataArray* positions = particles->GetPoints()->GetData();
  bool isPlain =
    positions->GetDataType() == (layout.IsDouble ? VTK_DOUBLE : VTK_FLOAT) && LiesPlain(positions);
  for (const Form& form : layout.Forms)
  {
    isPlain = isPlain && LiesPlain(particles->GetPointData()->GetAbstractArray(form.Name.c_str()));
  }
  if (!isPlain)
  {
    return nullptr;
  }
  auto shared = vtkSmartPointer<vtkPolyData>::New();
  shared->SetPoints(particles->GetPoints());
  for (const Form& form : layout.Forms)
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

vtkSmartPointer<vtkPolyData> vtkSPHTakeParticles(
  vtkSPHRanks& ranks, vtkPointSet* data, vtkIdList* taken)
{
  vtkNew<vtkPolyData> view;
  if (data && data->GetNumberOfPoints() > 0)
  {
    view->SetPoints(data->GetPoints());
    view->GetPointData()->ShallowCopy(data->GetPointData());
  }
  const Layout common = AgreeOnLayout(ranks, Describe(view));
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
  auto particles = MakeParticles(common, own->GetNumberOfIds());
  if (data)
  {
    particles->GetFieldData()->ShallowCopy(data->GetFieldData());
  }
  if (own->GetNumberOfIds() > 0)
  {
    view->GetPoints()->GetData()->GetTuples(own, particles->GetPoints()->GetData());
    for (const Form& form : common.Forms)
    {
      view->GetPointData()
        ->GetAbstractArray(form.Name.c_str())
        ->GetTuples(own, particles->GetPointData()->GetAbstractArray(form.Name.c_str()));
    }
  }
  return particles;
}

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

vtkSmartPointer<vtkPolyData> vtkSPHSendParticles(vtkSPHRanks& ranks, vtkPolyData* particles,
  const std::vector<std::vector<vtkIdType>>& to, std::vector<vtkIdType>* from)
{
  const std::vector<vtkSPHRanks::Bytes> received =
    vtkSPHSendTuples(ranks, vtkSPHListArrays(particles), to);
  const std::vector<vtkIdType> counts = vtkSPHCountTuples(received);
  auto near =
    MakeParticles(Describe(particles), std::accumulate(counts.begin(), counts.end(), vtkIdType(0)));
  vtkSPHReceiveTuples(received, vtkSPHListArrays(near));
  if (from)
  {
    *from = counts;
  }
  return near;
}

void vtkSPHReturnArrays(vtkSPHRanks& ranks, vtkPointData* results, vtkIdType count,
  const std::vector<std::vector<vtkIdType>>& back, const std::vector<std::vector<vtkIdType>>& home,
  vtkIdType homeCount, vtkPointData* to)
{
  const Layout layout = DescribeArrays(results, count);
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
  AddArrays(came, layout, places->GetNumberOfIds());
  vtkSPHReceiveTuples(received, vtkSPHListArrays(came));
  vtkNew<vtkIdList> order;
  order->SetNumberOfIds(places->GetNumberOfIds());
  std::iota(order->begin(), order->end(), vtkIdType(0));
  for (const Form& form : layout.Forms)
  {
    vtkSmartPointer<vtkAbstractArray> array = MakeArray(form, homeCount);
    if (auto* numbers = vtkArrayDownCast<vtkDataArray>(array))
    {
      numbers->Fill(0.0);
    }
    array->InsertTuples(places, order, came->GetAbstractArray(form.Name.c_str()));
    to->AddArray(array);
  }
}

void vtkSPHMatchEmpty(vtkSPHRanks& ranks, vtkPolyData* result)
{
  const Layout common = AgreeOnLayout(ranks, Describe(result));
  if (result->GetNumberOfPoints() == 0)
  {
    const vtkSmartPointer<vtkPolyData> empty = MakeParticles(common, 0);
    result->SetPoints(empty->GetPoints());
    result->GetPointData()->ShallowCopy(empty->GetPointData());
  }
}
