// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHArrays.h"

#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkSPHReals.h"
#include "vtkStringArray.h"
#include "vtkTypeInt64Array.h"
#include "vtkVariant.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <sstream>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** Rounds in place: the surface is the largest object in memory at this time. */
vtkSmartPointer<vtkDataArray> RoundToFloat(double*& values, int components, vtkIdType tuples)
{
  const vtkIdType count = values ? tuples * components : 0;
  char* to = reinterpret_cast<char*>(values);
  for (vtkIdType first = 0; first < count;)
  {
    std::array<float, 1024> rounded;
    const vtkIdType n = std::min<vtkIdType>(count - first, rounded.size());
    std::transform(values + first, values + first + n, rounded.begin(),
      [](double value) { return static_cast<float>(value); });
    std::memcpy(to + first * sizeof(float), rounded.data(), n * sizeof(float));
    first += n;
  }
  void* kept = count > 0 ? std::realloc(values, count * sizeof(float)) : nullptr;
  float* floats = static_cast<float*>(kept ? kept : values);
  auto array = vtkSPHAdopt(floats, components, count > 0 ? tuples : 0);
  values = count > 0 ? nullptr : values;
  return array;
}

template <typename ArrayT, typename ValueT>
void AddTuple(vtkFieldData* data, const char* name, const std::vector<ValueT>& values)
{
  vtkNew<ArrayT> array;
  array->SetNumberOfComponents(static_cast<int>(values.size()));
  array->SetNumberOfTuples(1);
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  vtkSPHAddArray(data, name, array.Get());
}

// One component for each phase, one for building programs, and the total; 0 before the first run.
void AddSeconds(vtkFieldData* run)
{
  auto seconds = vtkSmartPointer<vtkDoubleArray>::New();
  seconds->SetNumberOfComponents(MCOR_PHASE_COUNT + 2);
  seconds->SetNumberOfTuples(1);
  seconds->Fill(0.0);
  for (int phase = 0; phase < MCOR_PHASE_COUNT; ++phase)
  {
    seconds->SetComponentName(phase, mcor_phase_name(static_cast<mcor_phase>(phase)));
  }
  seconds->SetComponentName(MCOR_PHASE_COUNT, "program build");
  seconds->SetComponentName(MCOR_PHASE_COUNT + 1, "total");
  vtkSPHAddArray(run, "Seconds", seconds);
}
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
  vtkPointData* pointData = points->GetPointData();
  std::string list;
  for (int i = 0; i < pointData->GetNumberOfArrays(); ++i)
  {
    list += (i ? ", " : "") + vtkSPHNameOf(pointData->GetAbstractArray(i));
  }
  return list.empty() ? "The input has no point arrays." : "Point arrays: " + list + ".";
}

void vtkSPHSign(std::vector<std::uint64_t>& signature, vtkObject* object)
{
  signature.push_back(static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(object)));
  signature.push_back(object ? object->GetMTime() : 0);
}

vtkSmartPointer<vtkAbstractArray> vtkSPHMakeLike(vtkAbstractArray* array, vtkIdType count)
{
  auto made =
    vtkSmartPointer<vtkAbstractArray>::Take(vtkAbstractArray::CreateArray(array->GetDataType()));
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
  for (int i = 0; i < from->GetNumberOfArrays(); ++i)
  {
    to->AddArray(from->GetAbstractArray(i));
  }
  if (from->GetScalars())
  {
    to->SetActiveScalars(from->GetScalars()->GetName());
  }
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

vtkSmartPointer<vtkDataArray> vtkSPHAdoptReal(
  double*& values, int components, vtkIdType tuples, bool asFloat)
{
  if (asFloat)
  {
    return RoundToFloat(values, components, tuples);
  }
  return vtkSPHAdopt(values, components, tuples);
}

void vtkSPHAddArray(
  vtkFieldData* data, const char* name, const vtkSmartPointer<vtkAbstractArray>& array)
{
  array->SetName(name);
  data->AddArray(array);
}

void vtkSPHAddReal(vtkFieldData* data, const char* name, const std::vector<double>& values)
{
  AddTuple<vtkDoubleArray>(data, name, values);
}

void vtkSPHAddCount(vtkFieldData* data, const char* name, const std::vector<std::int64_t>& values)
{
  AddTuple<vtkTypeInt64Array>(data, name, values);
}

void vtkSPHAddText(vtkFieldData* data, const char* name, const std::string& text)
{
  auto array = vtkSmartPointer<vtkStringArray>::New();
  array->InsertNextValue(text);
  vtkSPHAddArray(data, name, array);
}

namespace
{
/// Adds up the counts of several runs.
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
  if (!run->GetArray("Seconds"))
  {
    AddSeconds(run);
  }
  vtkDataArray* seconds = run->GetArray("Seconds");
  const auto addSeconds = [seconds](int component, double value)
  { seconds->SetComponent(0, component, seconds->GetComponent(0, component) + value); };
  double total = s.build_seconds;
  for (int phase = 0; phase < MCOR_PHASE_COUNT; ++phase)
  {
    addSeconds(phase, s.seconds[phase]);
    total += s.seconds[phase];
  }
  addSeconds(MCOR_PHASE_COUNT, s.build_seconds);
  addSeconds(MCOR_PHASE_COUNT + 1, total);
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

vtkDataArray* vtkSPHDetect(vtkPointSet* points, mcor_quantity quantity, int components)
{
  vtkPointData* data = points->GetPointData();
  vtkDataArray* found = nullptr;
  int best = -1;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    const int rank = array ? mcor_name_priority(quantity, array->GetName()) : -1;
    if (rank >= 0 && (!found || rank < best) && array->GetNumberOfComponents() == components &&
      array->GetNumberOfTuples() == points->GetNumberOfPoints())
    {
      found = array;
      best = rank;
    }
  }
  return found;
}

std::string vtkSPHDescribe(vtkFieldData* data)
{
  std::ostringstream text;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = data->GetAbstractArray(i);
    text << array->GetName() << ":";
    for (vtkIdType v = 0; v < array->GetNumberOfValues(); ++v)
    {
      text << (v ? ", " : " ") << array->GetVariantValue(v).ToString();
    }
    text << "\n";
  }
  return text.str();
}

void vtkSPHArrayChoice::Consider(const std::string& name, int components, bool isReal, bool varies)
{
  const int rank = mcor_view_priority(name.c_str(), components, isReal, varies);
  if (rank >= 0 && (this->Rank < 0 || rank < this->Rank))
  {
    this->Best = name;
    this->Rank = rank;
  }
}

namespace
{
vtkSPHArrayChoice Consider(const std::vector<vtkDataArray*>& arrays, const vtkSPHMergeRanges& merge)
{
  std::vector<double> ranges; // of each component
  for (vtkDataArray* array : arrays)
  {
    for (int c = 0; c < array->GetNumberOfComponents(); ++c)
    {
      double range[2] = { VTK_DOUBLE_MAX, VTK_DOUBLE_MIN };
      if (array->GetNumberOfTuples() > 0)
      {
        array->GetRange(range, c);
      }
      ranges.insert(ranges.end(), range, range + 2);
    }
  }
  if (merge)
  {
    merge(ranges.data(), static_cast<int>(ranges.size() / 2));
  }
  vtkSPHArrayChoice choice;
  const double* range = ranges.data();
  for (vtkDataArray* array : arrays)
  {
    bool varies = false; // in a component
    for (int c = 0; c < array->GetNumberOfComponents(); ++c, range += 2)
    {
      varies = varies || range[0] < range[1];
    }
    choice.Consider(
      vtkSPHNameOf(array), array->GetNumberOfComponents(), vtkSPHIsReal(array), varies);
  }
  return choice;
}
}

std::string vtkSPHChooseArray(vtkFieldData* data, const vtkSPHMergeRanges& merge)
{
  std::vector<vtkDataArray*> arrays;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    if (array && array->GetName())
    {
      arrays.push_back(array);
    }
  }
  return Consider(arrays, merge).Best;
}

bool vtkSPHIsFit(vtkDataArray* array, const vtkSPHMergeRanges& merge)
{
  return Consider({ array }, merge).Rank >= 0;
}
VTK_ABI_NAMESPACE_END
