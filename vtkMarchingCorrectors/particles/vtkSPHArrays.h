// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: VTK arrays made of what the core returns.
 */
#ifndef vtkSPHArrays_h
#define vtkSPHArrays_h

#include "mcor.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkSPHAlgorithm.h"
#include "vtkSmartPointer.h"
#include "vtkTypeTraits.h"

#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkPointSet;

/** A text of the core, which is freed; empty for null. */
std::string vtkSPHTakeText(char* text);

/** Hands a malloc'ed buffer over to a VTK array. */
template <typename ValueT>
vtkSmartPointer<vtkDataArray> vtkSPHAdopt(ValueT*& values, int components, vtkIdType tuples)
{
  auto array = vtkSmartPointer<vtkDataArray>::Take(
    vtkDataArray::CreateDataArray(vtkTypeTraits<ValueT>::VTK_TYPE_ID));
  array->SetNumberOfComponents(components);
  if (values && tuples > 0)
  {
    array->SetVoidArray(values, tuples * components, 0, vtkAbstractArray::VTK_DATA_ARRAY_FREE);
    values = nullptr;
  }
  return array;
}

/** malloc'ed double values as an array of either precision; no second copy of them is made. */
vtkSmartPointer<vtkDataArray> vtkSPHAdoptReal(
  double*& values, int components, vtkIdType tuples, bool asFloat);

void vtkSPHAddArray(
  vtkFieldData* data, const char* name, const vtkSmartPointer<vtkAbstractArray>& array);
void vtkSPHAddReal(vtkFieldData* data, const char* name, std::initializer_list<double> values);
void vtkSPHAddCount(
  vtkFieldData* data, const char* name, std::initializer_list<std::int64_t> values);
void vtkSPHAddText(vtkFieldData* data, const char* name, const std::string& text);

/** A number, or an array of them; counts of levels up to the last that has any, a tuple each. */
///@{
void vtkSPHAdd(vtkFieldData* data, const char* name, double value);
void vtkSPHAdd(vtkFieldData* data, const char* name, std::int64_t value);
void vtkSPHAdd(vtkFieldData* data, const char* name, const std::int64_t (&levels)[MCOR_CUBE_LEVELS]);
inline void vtkSPHAdd(vtkFieldData* data, const char* name, int value)
{
  vtkSPHAdd(data, name, static_cast<std::int64_t>(value));
}
template <std::size_t N>
void vtkSPHAdd(vtkFieldData* data, const char* name, const std::int64_t (&v)[N])
{
  vtkSPHAddCount(data, name, { v[0], v[1], v[2] });
}
template <std::size_t N>
void vtkSPHAdd(vtkFieldData* data, const char* name, const double (&v)[N])
{
  vtkSPHAddReal(data, name, { v[0], v[1], v[2] });
}
///@}

/** Adds what a call of the core cost to what calls before it did: not the same for each run. */
void vtkSPHAddRunStatistics(vtkFieldData* run, const mcor_statistics& statistics);

/** The point array with the most usual name for this quantity and so many components; nullptr: there is none. */
vtkDataArray* vtkSPHDetect(vtkPointSet* points, mcor_quantity quantity, int components);

/** Finds among arrays the one to be looked at where nobody has chosen one, see mcor_view_priority(). */
struct vtkSPHArrayChoice
{
  void Consider(const std::string& name, int components, bool isReal, bool varies);

  std::string Best; ///< empty where none is fit
  int Rank = -1;
};

/** Which of the arrays, of so many components, have two different values in one. Null: there is none here. */
std::vector<bool> vtkSPHFindVarying(const std::vector<std::pair<vtkDataArray*, int>>& arrays,
  const vtkSPHMergeRanges& merge = nullptr);

/** The name of the fittest array to be looked at; empty where none is. */
std::string vtkSPHChooseArray(vtkFieldData* data, const vtkSPHMergeRanges& merge = nullptr);
/** Whether an array is fit. */
bool vtkSPHIsFit(vtkDataArray* array, const vtkSPHMergeRanges& merge = nullptr);

/** A line "Name: values" for each array. */
std::string vtkSPHDescribe(vtkFieldData* data);
VTK_ABI_NAMESPACE_END

#endif
