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
/** Returns the bytes of `tuples` tuples; 0 if the values are bits or texts, which cannot be copied as bytes. */
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

vtkSPHRanksArrays vtkSPHListArrays(vtkPointSet* points)
{
  vtkSPHRanksArrays arrays = vtkSPHListArrays(points->GetPointData());
  arrays.insert(arrays.begin(), points->GetPoints()->GetData());
  return arrays;
}

vtkSmartPointer<vtkPolyData> vtkSPHMakePoints(const vtkSPHRanksArrays& arrays, vtkPointSet* like)
{
  auto made = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetData(vtkDataArray::SafeDownCast(arrays[0]));
  made->SetPoints(points);
  made->GetPointData()->ShallowCopy(like->GetPointData());
  for (std::size_t i = 1; i < arrays.size(); ++i)
  {
    made->GetPointData()->AddArray(arrays[i]); // replaces the array of the same name
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
/** Returns arrays of `count` tuples. Tuple i of `tuples` becomes tuple number places[i]; all other tuples are 0. */
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
/** The form of an array, which ranks tell each other: its name, its type, the names of its components, its role. */
using Form = std::tuple<std::string, int, std::vector<std::string>, int>;
enum FormMember
{
  NAME,
  TYPE,
  LABELS, ///< empty texts for components without names
  ROLE    ///< attribute type of vtkDataSetAttributes, or -1
};

Form FormOf(vtkAbstractArray* array, const char* name, int role)
{
  std::vector<std::string> labels;
  for (int c = 0; c < array->GetNumberOfComponents(); ++c)
  {
    const char* label = array->GetComponentName(c);
    labels.emplace_back(label ? label : "");
  }
  return Form(name, array->GetDataType(), labels, role);
}

/** Returns the form of the positions, then of each point array that has a name and a value for each point, except vtkGhostType. */
std::vector<Form> Describe(vtkPolyData* particles)
{
  vtkDataArray* positions = particles->GetPoints()->GetData();
  std::vector<Form> forms = { FormOf(positions, "Points", -1) };
  std::get<TYPE>(forms[0]) = positions->GetDataType() == VTK_FLOAT ? VTK_FLOAT : VTK_DOUBLE;
  vtkPointData* arrays = particles->GetPointData();
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = arrays->GetAbstractArray(i);
    const std::string name = vtkSPHNameOf(array);
    const bool isKnown =
      vtkArrayDownCast<vtkDataArray>(array) || array->GetDataType() == VTK_STRING;
    if (isKnown && !name.empty() && name != vtkDataSetAttributes::GhostArrayName() &&
      array->GetNumberOfTuples() == particles->GetNumberOfPoints())
    {
      forms.push_back(FormOf(array, name.c_str(), arrays->IsArrayAnAttribute(i)));
    }
  }
  return forms;
}

/**
 * Lists the forms of the arrays that all ranks with points have, in the order of the first such
 * rank. If no rank has points, lists the arrays of the rank with the largest number of arrays.
 * Collective.
 */
std::vector<Form> AgreeOnForms(vtkSPHRanks& ranks, vtkPolyData* particles)
{
  std::int64_t most = particles->GetNumberOfPoints();
  ranks.Reduce(vtkSPHRanks::GREATEST, &most, 1);
  const bool speaks = particles->GetNumberOfPoints() > 0 || (most == 0 && particles->GetPoints());
  std::vector<Form> common;
  for (const std::vector<Form>& theirs :
    ranks.Gather(speaks ? Describe(particles) : std::vector<Form>()))
  {
    if (most == 0 || common.empty() || theirs.empty())
    {
      common = common.size() < theirs.size() ? theirs : common;
      continue;
    }
    std::get<TYPE>(common[0]) = // VTK_FLOAT < VTK_DOUBLE
      std::max(std::get<TYPE>(common[0]), std::get<TYPE>(theirs[0]));
    const auto isMissing = [&theirs](Form& form)
    {
      const bool isText = std::get<TYPE>(form) == VTK_STRING;
      const auto same = std::find_if(theirs.begin() + 1, theirs.end(),
        [&form, isText](const Form& other)
        {
          return std::get<NAME>(form) == std::get<NAME>(other) &&
            std::get<LABELS>(form).size() == std::get<LABELS>(other).size() &&
            isText == (std::get<TYPE>(other) == VTK_STRING);
        });
      // Numbers of several types become doubles, as when one process joins the pieces of a file.
      if (same != theirs.end() && std::get<TYPE>(form) != std::get<TYPE>(*same))
      {
        std::get<TYPE>(form) = VTK_DOUBLE;
      }
      return same == theirs.end();
    };
    common.erase(std::remove_if(common.begin() + 1, common.end(), isMissing), common.end());
  }
  return common;
}

/**
 * Copies the points `ids`, with arrays of these forms. If all points are wanted, an array that has
 * its form already is shared, not copied. If `from` lacks an array, no values are written to it.
 */
vtkSmartPointer<vtkPolyData> TakePoints(
  vtkPolyData* from, const std::vector<Form>& forms, vtkIdList* ids)
{
  auto made = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  made->SetPoints(points);
  vtkPointData* arrays = made->GetPointData();
  for (const Form& form : forms)
  {
    const char* name = std::get<NAME>(form).c_str();
    const std::vector<std::string>& labels = std::get<LABELS>(form);
    const bool arePositions = &form == &forms.front();
    vtkAbstractArray* given = from->GetPointData()->GetAbstractArray(name);
    if (arePositions)
    {
      given = from->GetPoints() ? from->GetPoints()->GetData() : nullptr;
    }
    vtkSmartPointer<vtkAbstractArray> taken = given;
    if (!given || given->GetNumberOfTuples() != ids->GetNumberOfIds() ||
      FormOf(given, name, std::get<ROLE>(form)) != form)
    {
      taken.TakeReference(vtkAbstractArray::CreateArray(std::get<TYPE>(form)));
      taken->SetName(name);
      taken->SetNumberOfComponents(static_cast<int>(labels.size()));
      taken->SetNumberOfTuples(ids->GetNumberOfIds());
      for (std::size_t c = 0; c < labels.size(); ++c)
      {
        if (!labels[c].empty())
        {
          taken->SetComponentName(static_cast<vtkIdType>(c), labels[c].c_str());
        }
      }
      if (given)
      {
        given->GetTuples(ids, taken);
      }
    }
    if (arePositions)
    {
      points->SetData(vtkDataArray::SafeDownCast(taken));
      continue;
    }
    const int at = arrays->AddArray(taken);
    if (std::get<ROLE>(form) >= 0)
    {
      arrays->SetActiveAttribute(at, std::get<ROLE>(form));
    }
  }
  return made;
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
  auto particles = TakePoints(view, AgreeOnForms(ranks, view), own);
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

// Used arrays stay in their order, with computed arrays last, so that other ranks choose the same arrays by name.
vtkSmartPointer<vtkPolyData> vtkSPHKeepUsed(vtkPointSet* own, const vtkSPHParticles& used)
{
  vtkSPHRanksArrays wanted;
  for (int role = 0; role < MCOR_ROLE_COUNT; ++role)
  {
    wanted.push_back(used.ArrayFor(static_cast<mcor_role>(role)));
  }
  for (const vtkSPHAttribute& attribute : used.Interpolated)
  {
    wanted.emplace_back(attribute.Array);
  }
  for (const vtkSPHOnly& only : used.Description.Only)
  {
    wanted.emplace_back(own->GetPointData()->GetAbstractArray(only.Name.c_str()));
  }
  auto kept = vtkSmartPointer<vtkPolyData>::New();
  kept->SetPoints(own->GetPoints());
  vtkPointData* to = kept->GetPointData();
  for (const auto& array : vtkSPHListArrays(own->GetPointData()))
  {
    if (std::find(wanted.begin(), wanted.end(), array) != wanted.end() ||
      vtkSPHParticles::IsMade(array->GetName()))
    {
      to->AddArray(array);
    }
  }
  for (const auto& array : wanted)
  {
    if (array && !to->HasArray(array->GetName()))
    {
      to->AddArray(array);
    }
  }
  return kept;
}

void vtkSPHMatchEmpty(vtkMultiProcessController* controller, vtkPolyData* result)
{
  vtkSPHRanks ranks(controller);
  const std::vector<Form> common = AgreeOnForms(ranks, result);
  if (result->GetNumberOfPoints() == 0)
  {
    const auto empty = TakePoints(result, common, vtkNew<vtkIdList>());
    result->SetPoints(empty->GetPoints());
    result->GetPointData()->ShallowCopy(empty->GetPointData());
  }
}
VTK_ABI_NAMESPACE_END
