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
#include "vtkSPHArrays.h"
#include "vtkSPHParticles.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVariant.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** Returns the bytes of `tuples` tuples; 0 if values do not lie side by side as bytes. */
std::size_t SizeOf(vtkAbstractArray* array, vtkIdType tuples)
{
  const bool isPlain = vtkArrayDownCast<vtkDataArray>(array) && array->GetDataType() != VTK_BIT;
  return isPlain ? static_cast<std::size_t>(tuples * array->GetNumberOfComponents()) *
      static_cast<std::size_t>(array->GetDataTypeSize())
                 : 0;
}

/** Packs the message for a rank: the number of tuples, then the tuples; empty if there are none. */
std::vector<char> Pack(const vtkSPHRanksArrays& arrays, const std::vector<vtkIdType>& ids)
{
  const auto count = static_cast<vtkIdType>(ids.size());
  if (count == 0)
  {
    return {};
  }
  diy::MemoryBuffer bytes;
  diy::save(bytes, count);
  vtkNew<vtkIdList> list;
  list->SetNumberOfIds(count);
  std::copy(ids.begin(), ids.end(), list->GetPointer(0));
  for (const vtkSmartPointer<vtkAbstractArray>& array : arrays)
  {
    const vtkSmartPointer<vtkAbstractArray> part = vtkSPHMakeLike(array, count);
    array->GetTuples(list, part);
    const std::size_t size = SizeOf(part, count);
    if (size > 0)
    {
      bytes.save_binary(static_cast<char*>(part->GetVoidPointer(0)), size);
    }
    for (vtkIdType i = 0; size == 0 && i < part->GetNumberOfValues(); ++i)
    {
      diy::save(bytes, static_cast<std::string>(part->GetVariantValue(i).ToString()));
    }
  }
  return std::move(bytes.buffer);
}

void Unpack(diy::MemoryBuffer& bytes, vtkAbstractArray* array, vtkIdType first, vtkIdType count)
{
  const std::size_t size = SizeOf(array, count);
  if (size > 0)
  {
    auto* values = static_cast<char*>(array->GetVoidPointer(0));
    bytes.load_binary(values + SizeOf(array, first), size);
  }
  const int components = array->GetNumberOfComponents();
  for (vtkIdType i = first * components; size == 0 && i < (first + count) * components; ++i)
  {
    std::string text;
    diy::load(bytes, text);
    array->SetVariantValue(i, vtkVariant(text));
  }
}
}

vtkSPHRanksArrays vtkSPHListArrays(vtkDataSetAttributes* data)
{
  vtkSPHRanksArrays arrays;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    arrays.emplace_back(data->GetAbstractArray(i));
  }
  return arrays;
}

vtkSPHRanksArrays vtkSPHListArrays(vtkPointSet* points)
{
  vtkSPHRanksArrays arrays = vtkSPHListArrays(points->GetPointData());
  arrays.insert(arrays.begin(), points->GetPoints()->GetData());
  return arrays;
}

void vtkSPHAddLike(
  vtkAbstractArray* array, vtkDataSetAttributes* like, int i, vtkDataSetAttributes* to)
{
  const int at = to->AddArray(array);
  const int attribute = like->IsArrayAnAttribute(i);
  if (attribute >= 0)
  {
    to->SetActiveAttribute(at, attribute);
  }
}

vtkSmartPointer<vtkPolyData> vtkSPHMakePoints(const vtkSPHRanksArrays& arrays, vtkPointSet* like)
{
  auto made = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetData(vtkDataArray::SafeDownCast(arrays[0]));
  made->SetPoints(points);
  for (int i = 0; i + 1 < static_cast<int>(arrays.size()); ++i)
  {
    vtkSPHAddLike(arrays[i + 1], like->GetPointData(), i, made->GetPointData());
  }
  return made;
}

vtkSPHRanksArrays vtkSPHSendTuples(vtkSPHRanks& ranks, const vtkSPHRanksArrays& arrays,
  const vtkSPHRanksLists& to, std::vector<vtkIdType>* from)
{
  std::vector<std::vector<char>> messages;
  for (const std::vector<vtkIdType>& ids : to)
  {
    messages.push_back(Pack(arrays, ids));
  }
  messages = ranks.Exchange(std::move(messages));
  std::vector<vtkIdType> counts(messages.size(), 0);
  std::vector<diy::MemoryBuffer> received(messages.size());
  for (std::size_t rank = 0; rank < messages.size(); ++rank)
  {
    received[rank].buffer.swap(messages[rank]);
    if (!received[rank].empty())
    {
      diy::load(received[rank], counts[rank]);
    }
  }
  const vtkIdType total = std::accumulate(counts.begin(), counts.end(), vtkIdType(0));
  vtkSPHRanksArrays came;
  for (const vtkSmartPointer<vtkAbstractArray>& array : arrays)
  {
    came.push_back(vtkSPHMakeLike(array, total));
    vtkIdType first = 0;
    for (std::size_t rank = 0; rank < received.size(); first += counts[rank++])
    {
      if (counts[rank] > 0)
      {
        Unpack(received[rank], came.back(), first, counts[rank]);
      }
    }
  }
  if (from)
  {
    from->swap(counts);
  }
  return came;
}

namespace
{
/** Puts tuples, in their order, at these places of arrays of `count` tuples; the rest is 0. */
vtkSPHRanksArrays PutTuples(const vtkSPHRanksArrays& tuples, vtkIdList* places, vtkIdType count)
{
  vtkNew<vtkIdList> order;
  order->SetNumberOfIds(places->GetNumberOfIds());
  std::iota(order->begin(), order->end(), vtkIdType(0));
  vtkSPHRanksArrays put;
  for (const vtkSmartPointer<vtkAbstractArray>& array : tuples)
  {
    put.push_back(vtkSPHMakeLike(array, count));
    if (auto* numbers = vtkArrayDownCast<vtkDataArray>(put.back().Get()))
    {
      numbers->Fill(0.0);
    }
    put.back()->InsertTuples(places, order, array);
  }
  return put;
}
}

vtkSPHRanksArrays vtkSPHReturnTuples(vtkSPHRanks& ranks, const vtkSPHRanksArrays& arrays,
  const std::vector<vtkIdType>& from, const std::uint8_t* owned, const vtkSPHRanksLists& to,
  vtkIdType count)
{
  vtkSPHRanksLists back;
  vtkIdType next = 0;
  for (const vtkIdType came : from) // what came from one rank lies together
  {
    back.emplace_back();
    for (const vtkIdType end = next + came; next < end; ++next)
    {
      if (!owned || owned[next])
      {
        back.back().push_back(next);
      }
    }
  }
  vtkNew<vtkIdList> places;
  for (const std::vector<vtkIdType>& list : to)
  {
    std::for_each(list.begin(), list.end(), [&](vtkIdType i) { places->InsertNextId(i); });
  }
  return PutTuples(vtkSPHSendTuples(ranks, arrays, back), places, count);
}

vtkSPHRanksArrays vtkSPHGatherTuples(
  vtkSPHRanks& ranks, vtkSPHRanksArrays arrays, vtkDataArray* numbers)
{
  if (numbers)
  {
    arrays.emplace_back(numbers);
  }
  vtkSPHRanksLists toFirst(static_cast<std::size_t>(ranks.GetCount()));
  toFirst[0].resize(static_cast<std::size_t>(arrays.front()->GetNumberOfTuples()));
  std::iota(toFirst[0].begin(), toFirst[0].end(), vtkIdType(0));
  vtkSPHRanksArrays came = vtkSPHSendTuples(ranks, arrays, toFirst);
  if (!numbers)
  {
    return came;
  }
  auto* theirs = vtkDataArray::SafeDownCast(came.back());
  vtkNew<vtkIdList> places;
  vtkIdType count = 0; // numbers begin at 0
  for (vtkIdType i = 0; i < theirs->GetNumberOfTuples(); ++i)
  {
    places->InsertNextId(static_cast<vtkIdType>(theirs->GetComponent(i, 0)));
    count = std::max(count, places->GetId(i) + 1);
  }
  came.pop_back();
  return PutTuples(came, places, count);
}

namespace
{
/** An array's name, type and components. */
struct Form
{
  std::string Name;
  int Type;
  std::vector<std::string> Labels; // names of its components; empty: they have none
  int Attribute;                   // attribute type of vtkDataSetAttributes, or -1

  bool IsLike(const Form& other) const
  {
    return this->Name == other.Name && this->Labels.size() == other.Labels.size() &&
      (this->Type == VTK_STRING) == (other.Type == VTK_STRING);
  }
};

/** The forms of the positions and of all point arrays. */
using Layout = std::vector<Form>;
}

template <>
struct diy::Serialization<Form>
{
  static void save(BinaryBuffer& to, const Form& form)
  {
    diy::save(to, std::tie(form.Name, form.Type, form.Labels, form.Attribute));
  }

  static void load(BinaryBuffer& from, Form& form)
  {
    auto members = std::tie(form.Name, form.Type, form.Labels, form.Attribute);
    diy::load(from, members);
  }
};

namespace
{
std::vector<std::string> LabelsOf(vtkAbstractArray* array)
{
  std::vector<std::string> labels;
  for (int c = 0; c < array->GetNumberOfComponents(); ++c)
  {
    const char* label = array->GetComponentName(c);
    labels.emplace_back(label ? label : "");
  }
  return labels;
}

/**
 * Lists the positions, then the point arrays with a name and a value for each point, except
 * vtkGhostType.
 */
Layout Describe(vtkPolyData* particles)
{
  vtkDataArray* positions = particles->GetPoints()->GetData();
  Layout layout = { { "Points", positions->GetDataType() == VTK_FLOAT ? VTK_FLOAT : VTK_DOUBLE,
    LabelsOf(positions), -1 } };
  vtkPointData* arrays = particles->GetPointData();
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = arrays->GetAbstractArray(i);
    const std::string name = array->GetName() ? array->GetName() : "";
    const bool isKnown =
      vtkArrayDownCast<vtkDataArray>(array) || array->GetDataType() == VTK_STRING;
    if (isKnown && !name.empty() && name != vtkDataSetAttributes::GhostArrayName() &&
      array->GetNumberOfTuples() == particles->GetNumberOfPoints())
    {
      layout.push_back(
        { name, array->GetDataType(), LabelsOf(array), arrays->IsArrayAnAttribute(i) });
    }
  }
  return layout;
}

/**
 * Lists the arrays that all ranks with points have, in the order of the first such rank. If there
 * are no points at all, lists the arrays of the rank that has most arrays. Collective.
 */
Layout AgreeOnLayout(vtkSPHRanks& ranks, vtkPolyData* particles)
{
  std::int64_t most = particles->GetNumberOfPoints();
  ranks.Reduce(vtkSPHRanks::GREATEST, &most, 1);
  const bool speaks = particles->GetNumberOfPoints() > 0 || (most == 0 && particles->GetPoints());
  Layout common;
  for (const Layout& other : ranks.Gather(speaks ? Describe(particles) : Layout()))
  {
    if (most == 0 || common.empty() || other.empty())
    {
      common = common.size() < other.size() ? other : common;
      continue;
    }
    common[0].Type = std::max(common[0].Type, other[0].Type); // VTK_FLOAT < VTK_DOUBLE
    const auto isMissing = [&other](Form& form)
    {
      const auto theirs = std::find_if(
        other.begin() + 1, other.end(), [&form](const Form& one) { return form.IsLike(one); });
      const bool isThere = theirs != other.end();
      // Numbers of several types become doubles, as when one process joins the pieces of a file.
      form.Type = isThere && form.Type != theirs->Type ? VTK_DOUBLE : form.Type;
      return !isThere;
    };
    common.erase(std::remove_if(common.begin() + 1, common.end(), isMissing), common.end());
  }
  return common;
}

/**
 * Copies these tuples of an array, which may be null. Returns the array itself if all of it is
 * wanted, in this form.
 */
vtkSmartPointer<vtkAbstractArray> TakeTuples(
  vtkAbstractArray* array, const Form& form, vtkIdList* ids)
{
  if (array && array->GetNumberOfTuples() == ids->GetNumberOfIds() &&
    array->GetDataType() == form.Type && LabelsOf(array) == form.Labels)
  {
    return array;
  }
  auto taken = vtkSmartPointer<vtkAbstractArray>::Take(vtkAbstractArray::CreateArray(form.Type));
  taken->SetName(form.Name.c_str());
  taken->SetNumberOfComponents(static_cast<int>(form.Labels.size()));
  taken->SetNumberOfTuples(ids->GetNumberOfIds());
  for (int c = 0; c < taken->GetNumberOfComponents(); ++c)
  {
    const std::string& label = form.Labels[static_cast<std::size_t>(c)];
    if (!label.empty())
    {
      taken->SetComponentName(c, label.c_str());
    }
  }
  if (array)
  {
    array->GetTuples(ids, taken);
  }
  return taken;
}

/** Copies these points, with these arrays. */
vtkSmartPointer<vtkPolyData> TakePoints(vtkPolyData* from, const Layout& layout, vtkIdList* ids)
{
  auto taken = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  taken->SetPoints(points);
  vtkPointData* arrays = from->GetPointData();
  for (const Form& form : layout)
  {
    if (&form == &layout.front())
    {
      vtkDataArray* positions = from->GetPoints() ? from->GetPoints()->GetData() : nullptr;
      points->SetData(vtkDataArray::SafeDownCast(TakeTuples(positions, form, ids)));
      continue;
    }
    const int at = taken->GetPointData()->AddArray(
      TakeTuples(arrays->GetAbstractArray(form.Name.c_str()), form, ids));
    if (form.Attribute >= 0)
    {
      taken->GetPointData()->SetActiveAttribute(at, form.Attribute);
    }
  }
  return taken;
}
}

vtkSmartPointer<vtkPolyData> vtkSPHTakeParticles(vtkSPHRanks& ranks, vtkPointSet* data,
  const vtkSPHParticlesChoice& choice, std::vector<vtkIdType>* taken)
{
  vtkNew<vtkPolyData> view;
  vtkNew<vtkIdList> own;
  const vtkIdType count = data ? data->GetNumberOfPoints() : 0;
  if (count > 0)
  {
    view->SetPoints(data->GetPoints());
    view->GetPointData()->ShallowCopy(data->GetPointData());
    vtkUnsignedCharArray* marks = data->GetPointGhostArray();
    const std::vector<bool> present = vtkSPHFindPresent(choice, data);
    own->Allocate(count);
    for (vtkIdType i = 0; i < count; ++i)
    {
      const bool isCopy = marks && (marks->GetValue(i) & vtkDataSetAttributes::DUPLICATEPOINT);
      if ((present.empty() || present[static_cast<size_t>(i)]) && !isCopy)
      {
        own->InsertNextId(i);
      }
    }
  }
  auto particles = TakePoints(view, AgreeOnLayout(ranks, view), own);
  if (data)
  {
    particles->GetFieldData()->ShallowCopy(data->GetFieldData());
  }
  if (taken)
  {
    taken->assign(own->begin(), own->end());
  }
  return particles;
}

// Keeps the arrays in their order, and appends the computed ones, so that they are found again.
vtkSmartPointer<vtkPolyData> vtkSPHKeepUsed(vtkPointSet* own, const vtkSPHParticles& used)
{
  std::vector<vtkAbstractArray*> arrays;
  for (int role = 0; role < MCOR_ROLE_COUNT; ++role)
  {
    arrays.push_back(used.ArrayFor(static_cast<mcor_role>(role)));
  }
  for (const vtkSPHAttribute& attribute : used.Interpolated)
  {
    arrays.push_back(attribute.Array);
  }
  for (const vtkSPHOnly& only : used.Description.Only)
  {
    arrays.push_back(own->GetPointData()->GetAbstractArray(only.Name.c_str()));
  }
  auto kept = vtkSmartPointer<vtkPolyData>::New();
  kept->SetPoints(own->GetPoints());
  vtkPointData* to = kept->GetPointData();
  for (const auto& array : vtkSPHListArrays(own->GetPointData()))
  {
    if (std::find(arrays.begin(), arrays.end(), array) != arrays.end() ||
      vtkSPHParticles::IsMade(array->GetName()))
    {
      to->AddArray(array);
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

vtkSmartPointer<vtkPolyData> vtkSPHSendParticles(vtkSPHRanks& ranks, vtkPointSet* particles,
  const vtkSPHRanksLists& to, std::vector<vtkIdType>* from)
{
  return vtkSPHMakePoints(
    vtkSPHSendTuples(ranks, vtkSPHListArrays(particles), to, from), particles);
}

void vtkSPHMatchEmpty(vtkSPHRanks& ranks, vtkPolyData* result)
{
  const Layout common = AgreeOnLayout(ranks, result);
  if (result->GetNumberOfPoints() == 0)
  {
    vtkNew<vtkIdList> none;
    const vtkSmartPointer<vtkPolyData> empty = TakePoints(result, common, none);
    result->SetPoints(empty->GetPoints());
    result->GetPointData()->ShallowCopy(empty->GetPointData());
  }
}

void vtkSPHMatchEmpty(vtkMultiProcessController* controller, vtkPolyData* particles)
{
  vtkSPHRanks ranks(controller);
  vtkSPHMatchEmpty(ranks, particles);
}
VTK_ABI_NAMESPACE_END
