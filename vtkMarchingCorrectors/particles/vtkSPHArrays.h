// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: VTK arrays made of what the core returns. */
#ifndef vtkSPHArrays_h
#define vtkSPHArrays_h

#include "mcor.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkSPHAlgorithm.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"
#include "vtkTypeTraits.h"

#include <cstdint>
#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkCellArray;
class vtkDataSetAttributes;
class vtkIdList;
class vtkPoints;
class vtkPointSet;

/** Returns the array's name, empty for none. */
std::string vtkSPHNameOf(vtkAbstractArray* array);

/** The array's name; empty for entries that lists of arrays, as in ParaView's panel, show in place
 * of one. */
std::string vtkSPHRealName(const std::string& name);

/** "Point arrays: A, B." */
std::string vtkSPHListNames(vtkPointSet* points);

/** VTK's modification times are unique in a process: object and time identify a state. */
void vtkSPHSign(std::vector<std::uint64_t>& signature, vtkObject* object);

/** Makes an array of this name, type and components for so many tuples. */
vtkSmartPointer<vtkAbstractArray> vtkSPHMakeLike(vtkAbstractArray* array, vtkIdType count);

/** Copies the tuples with these numbers, in this order, of all arrays, normals and ids, too. */
VTKMARCHINGCORRECTORS_EXPORT void vtkSPHTakeTuples(
  vtkDataSetAttributes* from, vtkIdList* ids, vtkDataSetAttributes* to);

/** Adds all arrays, in place of those of their names; scalars become the active ones. */
void vtkSPHAddArrays(vtkDataSetAttributes* from, vtkDataSetAttributes* to);

/** Returns the points with these numbers, in this order. */
VTKMARCHINGCORRECTORS_EXPORT vtkSmartPointer<vtkPoints> vtkSPHTakePoints(
  vtkPoints* from, vtkIdList* ids);

/** Makes a vertex of each of so many points. */
vtkSmartPointer<vtkCellArray> vtkSPHMakeVertices(vtkIdType count);

/** Takes over a text of the core, which it frees; empty for null. */
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

/**
 * Makes an array of either precision from malloc'ed double values, without a second copy of
 * them.
 */
vtkSmartPointer<vtkDataArray> vtkSPHAdoptReal(
  double*& values, int components, vtkIdType tuples, bool asFloat);

void vtkSPHAddArray(
  vtkFieldData* data, const char* name, const vtkSmartPointer<vtkAbstractArray>& array);
void vtkSPHAddText(vtkFieldData* data, const char* name, const std::string& text);
///@{
/** Adds numbers as one tuple. */
void vtkSPHAddReal(vtkFieldData* data, const char* name, const std::vector<double>& values);
void vtkSPHAddCount(vtkFieldData* data, const char* name, const std::vector<std::int64_t>& values);
///@}

///@{
/**
 * Adds a number, or an array; counts of levels as a tuple each, up to the last level that
 * has any.
 */
inline void vtkSPHAdd(vtkFieldData* data, const char* name, double value)
{
  vtkSPHAddReal(data, name, { value });
}
inline void vtkSPHAdd(vtkFieldData* data, const char* name, std::int64_t value)
{
  vtkSPHAddCount(data, name, { value });
}
inline void vtkSPHAdd(vtkFieldData* data, const char* name, int value)
{
  vtkSPHAddCount(data, name, { value });
}
void vtkSPHAdd(
  vtkFieldData* data, const char* name, const std::int64_t (&levels)[MCOR_CUBE_LEVELS]);
inline void vtkSPHAdd(vtkFieldData* data, const char* name, const std::int64_t (&values)[3])
{
  vtkSPHAddCount(data, name, std::vector<std::int64_t>(values, values + 3));
}
template <std::size_t N>
void vtkSPHAdd(vtkFieldData* data, const char* name, const double (&values)[N])
{
  vtkSPHAddReal(data, name, std::vector<double>(values, values + N));
}
///@}

/** Adds a column, without values, to a table. */
template <typename ArrayT>
ArrayT* vtkSPHAddColumn(vtkTable* table, const char* name, vtkIdType rows)
{
  vtkNew<ArrayT> column;
  column->SetName(name);
  column->SetNumberOfTuples(rows);
  table->AddColumn(column);
  return column;
}

/** The ways in which a statistic of several parts or runs becomes one, see mcor_statistics.def. */
enum vtkSPHHow
{
  SAME,
  SUM,
  MOST,
  OTHER
};

/** Adds the cost of a call of the core to that of earlier calls. Costs differ from run to run. */
void vtkSPHAddRunStatistics(vtkFieldData* run, const mcor_statistics& statistics);

/**
 * Finds the point array with the most usual name for this quantity and this number of
 * components; nullptr: there is none.
 */
vtkDataArray* vtkSPHDetect(vtkPointSet* points, mcor_quantity quantity, int components);

/**
 * Finds, among arrays, the one to show first where nobody has chosen one, see
 * mcor_view_priority().
 */
struct vtkSPHArrayChoice
{
  void Consider(const std::string& name, int components, bool isReal, bool varies);

  std::string Best; ///< empty where no array is fit
  int Rank = -1;
};

/** The name of the fittest array to show; empty: there is none. */
std::string vtkSPHChooseArray(vtkFieldData* data, const vtkSPHMergeRanges& merge = nullptr);
/** Whether an array is fit to show. */
bool vtkSPHIsFit(vtkDataArray* array, const vtkSPHMergeRanges& merge = nullptr);

/** Writes a line "Name: values" for each array. */
std::string vtkSPHDescribe(vtkFieldData* data);
VTK_ABI_NAMESPACE_END

#endif
