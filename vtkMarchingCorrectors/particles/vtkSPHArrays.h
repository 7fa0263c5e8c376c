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
#include "vtkSmartPointer.h"

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>

class vtkPointSet;

/** Hands a malloc'ed buffer over to a VTK array. */
template <typename ArrayT, typename ValueT>
vtkSmartPointer<ArrayT> vtkSPHAdopt(ValueT*& values, int components, vtkIdType tuples)
{
  auto array = vtkSmartPointer<ArrayT>::New();
  array->SetNumberOfComponents(components);
  if (values && tuples > 0)
  {
    array->SetArray(values, tuples * components, 0, ArrayT::VTK_DATA_ARRAY_FREE);
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

/** Makes ranges, each a least and a greatest value, those of all processes that share a run; empty: of one alone. */
using vtkSPHMergeRanges = std::function<void(double* ranges, int count)>;

/** The same of all that it has. */
std::string vtkSPHChooseArray(vtkFieldData* data, const vtkSPHMergeRanges& merge = nullptr);
/** Whether an array is fit. */
bool vtkSPHIsFit(vtkDataArray* array, const vtkSPHMergeRanges& merge = nullptr);

/** A line "Name: values" for each array. */
std::string vtkSPHDescribe(vtkFieldData* data);

#endif
