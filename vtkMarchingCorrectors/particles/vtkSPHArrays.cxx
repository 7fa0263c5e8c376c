// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHArrays.h"

#include "vtkAOSDataArrayTemplate.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkSPHSay.h"
#include "vtkStringArray.h"
#include "vtkTypeInt64Array.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numeric>

VTK_ABI_NAMESPACE_BEGIN
std::vector<vtkSmartPointer<vtkAbstractArray>> vtkSPHListArrays(vtkFieldData* data)
{
  std::vector<vtkSmartPointer<vtkAbstractArray>> arrays;
  for (int i = 0; data && i < data->GetNumberOfArrays(); ++i)
  {
    arrays.emplace_back(data->GetAbstractArray(i));
  }
  return arrays;
}

std::string vtkSPHNameOf(vtkAbstractArray* array)
{
  return array && array->GetName() ? array->GetName() : "";
}

std::string vtkSPHRealName(const std::string& name)
{
  return name == "(automatic)" || name == "(none)" ? std::string() : name;
}

std::string vtkSPHListNames(vtkPointSet* points)
{
  std::string list;
  for (const auto& array : vtkSPHListArrays(points->GetPointData()))
  {
    list += (list.empty() ? "" : ", ") + vtkSPHNameOf(array);
  }
  return list.empty() ? "The input has no point arrays." : "Point arrays: " + list + ".";
}

void vtkSPHSign(std::vector<std::uint64_t>& signature, vtkObject* object)
{
  signature.push_back(static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(object)));
  signature.push_back(object ? object->GetMTime() : 0);
}

void vtkSPHSign(std::vector<std::uint64_t>& signature, double number)
{
  std::uint64_t bits;
  std::memcpy(&bits, &number, sizeof(bits));
  signature.push_back(bits);
}

vtkSmartPointer<vtkAbstractArray> vtkSPHMakeLike(
  vtkAbstractArray* array, vtkIdType count, int type)
{
  auto made = vtkSmartPointer<vtkAbstractArray>::Take(
    vtkAbstractArray::CreateArray(type == VTK_VOID ? array->GetDataType() : type));
  made->SetName(array->GetName());
  made->SetNumberOfComponents(array->GetNumberOfComponents());
  made->CopyComponentNames(array);
  made->SetNumberOfTuples(count);
  return made;
}

void vtkSPHTakeTuples(vtkDataSetAttributes* from, vtkIdList* ids, vtkDataSetAttributes* to)
{
  vtkNew<vtkIdList> places;
  places->SetNumberOfIds(ids->GetNumberOfIds());
  std::iota(places->GetPointer(0), places->GetPointer(0) + ids->GetNumberOfIds(), vtkIdType(0));
  to->CopyAllOn();
  to->CopyAllocate(from, ids->GetNumberOfIds());
  to->CopyData(from, ids, places);
}

void vtkSPHAddArrays(vtkDataSetAttributes* from, vtkDataSetAttributes* to)
{
  for (const auto& array : vtkSPHListArrays(from))
  {
    to->AddArray(array);
  }
  if (from->GetScalars())
  {
    to->SetActiveScalars(from->GetScalars()->GetName());
  }
}

// Returns the points' array of iso values, or null. Its name is the component's name of the field
// array "IsoValues".
vtkDataArray* vtkSPHFindIsoValues(vtkDataSet* surface)
{
  vtkDataArray* values = surface->GetFieldData()->GetArray("IsoValues");
  const char* name = values ? values->GetComponentName(0) : nullptr;
  return name ? surface->GetPointData()->GetArray(name) : nullptr;
}

vtkSmartPointer<vtkPoints> vtkSPHTakePoints(vtkPoints* from, vtkIdList* ids)
{
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataType(from->GetDataType());
  points->SetNumberOfPoints(ids->GetNumberOfIds());
  from->GetPoints(ids, points);
  return points;
}

vtkSmartPointer<vtkCellArray> vtkSPHMakeVertices(vtkIdType count)
{
  vtkNew<vtkIdTypeArray> points;
  points->SetNumberOfValues(count);
  std::iota(points->GetPointer(0), points->GetPointer(0) + count, vtkIdType(0));
  auto vertices = vtkSmartPointer<vtkCellArray>::New();
  vertices->SetData(1, points);
  return vertices;
}

std::string vtkSPHTakeText(char* text)
{
  const std::string taken = text ? text : "";
  std::free(text);
  return taken;
}

mcor_word vtkSPHWord = mcor_label_word;

std::string vtkSPHSay(mcor_says, const char* format, ...)
{
  va_list values;
  va_start(values, format);
  std::string text(std::max(std::vsnprintf(nullptr, 0, format, values), 0) + 1, '\0');
  va_end(values);
  va_start(values, format);
  std::vsnprintf(&text[0], text.size(), format, values);
  va_end(values);
  return vtkSPHTakeText(mcor_fill_slots(text.c_str(), vtkSPHWord, nullptr));
}

std::string vtkSPHTakeText(mcor_message message)
{
  const std::string taken = vtkSPHTakeText(mcor_fill_slots(message.text, vtkSPHWord, nullptr));
  const bool isLost = message.code != MCOR_SAYS_NOTHING && taken.empty();
  mcor_free_message(&message);
  return isLost ? mcor_says_text(MCOR_SAYS_HOST_MEMORY) : taken;
}

vtkSmartPointer<vtkDataArray> vtkSPHAdoptReal(
  double*& values, int components, vtkIdType tuples, bool asFloat)
{
  const vtkSmartPointer<vtkDataArray> array = vtkSPHAdopt(values, components, tuples);
  if (!asFloat)
  {
    return array;
  }
  auto floats = vtkSmartPointer<vtkFloatArray>::New();
  floats->DeepCopy(array);
  return floats;
}

void vtkSPHAddArray(
  vtkFieldData* data, const char* name, const vtkSmartPointer<vtkAbstractArray>& array)
{
  array->SetName(name);
  data->AddArray(array);
}

void vtkSPHAddText(vtkFieldData* data, const char* name, const std::string& text)
{
  auto array = vtkSmartPointer<vtkStringArray>::New();
  array->InsertNextValue(text);
  vtkSPHAddArray(data, name, array);
}

namespace
{
/// Merges a statistic of one more run into the run data: SAME replaces the earlier value, MOST keeps
/// the greater one, all others add.
template <typename T>
void AddToRun(vtkFieldData* run, vtkSPHHow how, const char* name, const T& value)
{
  vtkDataArray* array = run->GetArray(name);
  const T before = array && how != SAME ? static_cast<T>(array->GetComponent(0, 0)) : T();
  vtkSPHAdd(run, name, static_cast<T>(how == MOST ? std::max(before, value) : before + value));
}

template <typename T, std::size_t N>
void AddToRun(vtkFieldData*, vtkSPHHow, const char*, const T (&)[N])
{
}
}

void vtkSPHAddRunStatistics(vtkFieldData* run, const mcor_statistics& s)
{
  // The array has a component for each phase, one for building programs, and one for the total; all begin at 0.
  constexpr int build = MCOR_PHASE_COUNT, total = build + 1;
  vtkSmartPointer<vtkDataArray> seconds = run->GetArray("Seconds");
  if (!seconds)
  {
    vtkSPHAdd(run, "Seconds", std::vector<double>(total + 1, 0.0));
    seconds = run->GetArray("Seconds");
    for (int phase = 0; phase < build; ++phase)
    {
      seconds->SetComponentName(phase, mcor_phase_name(static_cast<mcor_phase>(phase)));
    }
    seconds->SetComponentName(build, "program build");
    seconds->SetComponentName(total, "total");
  }
  double sum = 0.0;
  for (int i = 0; i <= total; ++i)
  {
    const double added = i < build ? s.seconds[i] : i == build ? s.build_seconds : sum;
    seconds->SetComponent(0, i, seconds->GetComponent(0, i) + added);
    sum += added;
  }
  const bool is_run = true, always = false, has_scalar = false, has_levels = false,
             is_widened = false, has_caps = false, is_plane = false, has_area = false,
             has_volume = false;
#define STATISTIC(how, when, member, name)                                                         \
  if (when)                                                                                        \
  {                                                                                                \
    AddToRun(run, how, name, s.member);                                                            \
  }
#include "mcor_statistics.def"
}

void vtkSPHAdd(vtkFieldData* data, const char* name, const std::int64_t (&counts)[MCOR_CUBE_LEVELS])
{
  int levels = MCOR_CUBE_LEVELS;
  while (levels > 1 && counts[levels - 1] == 0)
  {
    --levels;
  }
  auto array = vtkSmartPointer<vtkTypeInt64Array>::New();
  for (int level = 0; level < levels; ++level)
  {
    array->InsertNextValue(counts[level]);
  }
  vtkSPHAddArray(data, name, array);
}

vtkSPHNamed::vtkSPHNamed(vtkFieldData* arrays)
{
  for (const auto& array : vtkSPHListArrays(arrays))
  {
    this->Add(array);
  }
}

void vtkSPHNamed::Add(vtkAbstractArray* array)
{
  vtkSmartPointer<vtkDataArray> numbers = vtkArrayDownCast<vtkDataArray>(array);
  if (numbers && (numbers->GetDataType() == VTK_BIT || !numbers->HasStandardMemoryLayout()))
  {
    const int type = numbers->GetDataType() == VTK_BIT ? VTK_UNSIGNED_CHAR : numbers->GetDataType();
    const auto copy = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
    copy->DeepCopy(numbers);
    copy->SetName(numbers->GetName());
    numbers = copy;
  }
  mcor_named named = {};
  named.name = array->GetName();
  named.components = array->GetNumberOfComponents();
  named.tuples = array->GetNumberOfTuples();
  named.type = MCOR_ELEMENT_OTHER;
  if (numbers)
  {
    const int size = numbers->GetDataTypeSize();
    const int kind = size == 1 ? 0 : size == 2 ? 2 : size == 4 ? 4 : 6;
    named.data = numbers->GetVoidPointer(0);
    named.type = numbers->GetDataType() == VTK_FLOAT ? MCOR_ELEMENT_FLOAT32
      : numbers->GetDataType() == VTK_DOUBLE         ? MCOR_ELEMENT_FLOAT64
                                             : static_cast<mcor_element>(MCOR_ELEMENT_INT8 + kind +
                                                 (numbers->GetDataTypeMin() < 0.0 ? 0 : 1));
  }
  this->List.push_back(named);
  this->Held.emplace_back(numbers ? numbers.Get() : array);
}

vtkDataArray* vtkSPHDetect(
  vtkPointSet* points, mcor_quantity quantity, int components, const std::string& name)
{
  if (!name.empty())
  {
    return points->GetPointData()->GetArray(name.c_str());
  }
  const vtkSPHNamed named(points->GetPointData());
  const int found = mcor_find_named(named.List.data(), static_cast<int>(named.List.size()),
    quantity, components, points->GetNumberOfPoints());
  return found < 0 ? nullptr : points->GetPointData()->GetArray(found);
}

std::string vtkSPHChooseArray(vtkFieldData* data, const mcor_ranks* ranks)
{
  const vtkSPHNamed named(data);
  const int best =
    mcor_choose_view(named.List.data(), static_cast<int>(named.List.size()), -1, ranks);
  return best < 0 ? "" : data->GetArrayName(best);
}

mcor_array vtkSPHView(vtkDataArray* array)
{
  // The core takes an array without data as a constant, but empty VTK arrays may have no data.
  static const double none = 0.0;
  mcor_array view = {};
  view.type = array->GetDataType() == VTK_FLOAT ? MCOR_FLOAT32 : MCOR_FLOAT64;
  view.components = array->GetNumberOfComponents();
  view.data = array->GetVoidPointer(0) ? array->GetVoidPointer(0) : &none;
  view.name = array->GetName();
  return view;
}

double vtkSPHScalarOf(const mcor_input& core, vtkIdType particle)
{
  const int components = core.scalar.components;
  const vtkIdType first = particle * components;
  if (core.scalar_component >= 0 && !core.scalar_dot.data)
  {
    return vtkSPHValueOf(core.scalar, first + core.scalar_component);
  }
  double sum = 0.0;
  for (vtkIdType i = first; i < first + components; ++i)
  {
    sum += vtkSPHValueOf(core.scalar, i) *
      vtkSPHValueOf(core.scalar_dot.data ? core.scalar_dot : core.scalar, i);
  }
  return core.scalar_dot.data ? sum : std::sqrt(sum);
}

vtkSmartPointer<vtkDataArray> vtkSPHAsReal(vtkDataArray* array)
{
  if (vtkAOSDataArrayTemplate<float>::FastDownCast(array) ||
    vtkAOSDataArrayTemplate<double>::FastDownCast(array))
  {
    return array;
  }
  auto copy = vtkSmartPointer<vtkDoubleArray>::New();
  copy->DeepCopy(array);
  return copy;
}
VTK_ABI_NAMESPACE_END
