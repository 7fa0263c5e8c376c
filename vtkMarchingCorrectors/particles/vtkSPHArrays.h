// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: shows VTK arrays to the core, and makes VTK arrays of the core's results. */
#ifndef vtkSPHArrays_h
#define vtkSPHArrays_h

#include "mcor_find.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkMarchingCorrectorsModule.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"
#include "vtkTypeInt64Array.h"
#include "vtkTypeTraits.h"

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkCellArray;
class vtkDataSet;
class vtkDataSetAttributes;
class vtkIdList;
class vtkPoints;
class vtkPointSet;

/** Lists all arrays of the data; no array if the data is null. */
VTKMARCHINGCORRECTORS_EXPORT std::vector<vtkSmartPointer<vtkAbstractArray>> vtkSPHListArrays(
  vtkFieldData* data);

/** Returns the array's name; empty if the array has none, or is null. */
std::string vtkSPHNameOf(vtkAbstractArray* array);

/** Returns the name, or "" for "(automatic)" and "(none)", which ParaView's lists of arrays show in place of a name. */
std::string vtkSPHRealName(const std::string& name);

/** Returns the sentence "Point arrays: A, B.", or "The input has no point arrays." */
std::string vtkSPHListNames(vtkPointSet* points);

/** Adds an object's address and modification time to a signature. No two changes in VTK have the same time. */
void vtkSPHSign(std::vector<std::uint64_t>& signature, vtkObject* object);
void vtkSPHSign(std::vector<std::uint64_t>& signature, double number);

/** Makes an array of `count` tuples that has this array's name, components and, by default, type. */
vtkSmartPointer<vtkAbstractArray> vtkSPHMakeLike(
  vtkAbstractArray* array, vtkIdType count, int type = VTK_VOID);

/** Copies the tuples `ids`, in this order, of all arrays, also of normals and of global ids. */
VTKMARCHINGCORRECTORS_EXPORT void vtkSPHTakeTuples(
  vtkDataSetAttributes* from, vtkIdList* ids, vtkDataSetAttributes* to);

/** Adds all arrays of `from` to `to`, in place of arrays of the same names. Active scalars of `from` become active in `to`. */
void vtkSPHAddArrays(vtkDataSetAttributes* from, vtkDataSetAttributes* to);

/** Returns the array of a surface that says which iso value each point has; null: there is none. */
vtkDataArray* vtkSPHFindIsoValues(vtkDataSet* surface);

/** Returns the points `ids`, in this order. */
VTKMARCHINGCORRECTORS_EXPORT vtkSmartPointer<vtkPoints> vtkSPHTakePoints(
  vtkPoints* from, vtkIdList* ids);

/** Makes a vertex of each point from 0 to count - 1. */
vtkSmartPointer<vtkCellArray> vtkSPHMakeVertices(vtkIdType count);

/** Copies a text of the core, and frees the core's text; returns an empty text for null. */
std::string vtkSPHTakeText(char* text);
/** Returns a sentence of the core with its slots filled, see vtkSPHAlgorithm::SetWord(), and frees the core's text. */
std::string vtkSPHTakeText(mcor_message message);
/** The function that gives the words for a sentence's slots, such as {cube_size}, see vtkSPHAlgorithm::SetWord(). */
extern mcor_word vtkSPHWord;

/** Makes a VTK array that points to these values. The caller still owns and frees them. */
template <typename ValueT>
vtkSmartPointer<vtkDataArray> vtkSPHBorrow(const ValueT* values, int components, vtkIdType tuples)
{
  auto array = vtkSmartPointer<vtkDataArray>::Take(
    vtkDataArray::CreateDataArray(vtkTypeTraits<ValueT>::VTK_TYPE_ID));
  array->SetNumberOfComponents(components);
  if (values && tuples > 0)
  {
    array->SetVoidArray(const_cast<ValueT*>(values), tuples * components, 1);
  }
  return array;
}

/** Makes a VTK array that owns these malloc'ed values, and sets `values` to null. If `tuples` is
 * 0, the caller still owns the values. */
template <typename ValueT>
vtkSmartPointer<vtkDataArray> vtkSPHAdopt(ValueT*& values, int components, vtkIdType tuples)
{
  auto array = vtkSPHBorrow<ValueT>(nullptr, components, 0);
  if (values && tuples > 0)
  {
    array->SetVoidArray(values, tuples * components, 0, vtkAbstractArray::VTK_DATA_ARRAY_FREE);
    values = nullptr;
  }
  return array;
}

/** Makes a VTK array of these malloc'ed doubles, as vtkSPHAdopt() does. If `asFloat` is set, the array holds floats. */
vtkSmartPointer<vtkDataArray> vtkSPHAdoptReal(
  double*& values, int components, vtkIdType tuples, bool asFloat);

void vtkSPHAddArray(
  vtkFieldData* data, const char* name, const vtkSmartPointer<vtkAbstractArray>& array);
void vtkSPHAddText(vtkFieldData* data, const char* name, const std::string& text);
///@{
/** Adds an array with the values as its only tuple: as 64-bit integers if T is an integer type, else as doubles. */
template <typename T>
void vtkSPHAdd(vtkFieldData* data, const char* name, const std::vector<T>& values)
{
  vtkNew<
    typename std::conditional<std::is_integral<T>::value, vtkTypeInt64Array, vtkDoubleArray>::type>
    array;
  array->SetNumberOfComponents(static_cast<int>(values.size()));
  array->SetNumberOfTuples(1);
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  vtkSPHAddArray(data, name, array.Get());
}
template <typename T>
typename std::enable_if<std::is_arithmetic<T>::value>::type vtkSPHAdd(
  vtkFieldData* data, const char* name, T value)
{
  vtkSPHAdd(data, name, std::vector<T>{ value });
}
template <typename T, std::size_t N>
void vtkSPHAdd(vtkFieldData* data, const char* name, const T (&values)[N])
{
  vtkSPHAdd(data, name, std::vector<T>(values, values + N));
}
///@}
/** Adds an array with one count for each level of cubes, up to the last level with a count above 0, but at least for the first level. */
void vtkSPHAdd(
  vtkFieldData* data, const char* name, const std::int64_t (&levels)[MCOR_CUBE_LEVELS]);

/** Adds a column of values(row) to a table. */
template <typename ArrayT, typename ValuesT>
void vtkSPHAddColumn(vtkTable* table, const char* name, vtkIdType rows, const ValuesT& values)
{
  vtkNew<ArrayT> column;
  column->SetName(name);
  column->SetNumberOfTuples(rows);
  for (vtkIdType row = 0; row < rows; ++row)
  {
    column->SetValue(row, values(row));
  }
  table->AddColumn(column);
}

/** Adds a column of doubles for each listed member of the rows. */
template <typename RowT>
void vtkSPHAddColumns(vtkTable* table, const RowT* rows, vtkIdType count,
  std::initializer_list<std::pair<const char*, double RowT::*>> members)
{
  for (const auto& member : members)
  {
    const auto of = member.second;
    vtkSPHAddColumn<vtkDoubleArray>(
      table, member.first, count, [rows, of](vtkIdType row) { return rows[row].*of; });
  }
}

/** A result of the core. The destructor frees the memory that the core allocated for it. */
template <typename ResultT, void (*Free)(ResultT*)>
struct vtkSPHOwned : ResultT
{
  vtkSPHOwned()
    : ResultT()
  {
  }
  ~vtkSPHOwned() { Free(this); }
  vtkSPHOwned(const vtkSPHOwned&) = delete;
  void operator=(const vtkSPHOwned&) = delete;
};

/** How a statistic of several parts or runs is merged into one, see mcor_statistics.def. */
enum vtkSPHHow
{
  SAME,
  SUM,
  MOST,
  OTHER
};

/** Adds the costs of one call of the core to the costs of earlier calls in `run`. */
void vtkSPHAddRunStatistics(vtkFieldData* run, const mcor_statistics& statistics);

/**
 * Returns the point array of this name; without a name, the point array that has the most usual name
 * for this quantity and `components` components. nullptr: there is none.
 */
vtkDataArray* vtkSPHDetect(
  vtkPointSet* points, mcor_quantity quantity, int components, const std::string& name = "");

/** Lists VTK arrays for the core, and keeps the arrays alive. Copies arrays whose values the core cannot read in place. */
class vtkSPHNamed
{
public:
  explicit vtkSPHNamed(vtkFieldData* arrays);
  /** Lists a single array, which must hold numbers. */
  explicit vtkSPHNamed(vtkAbstractArray* array) { this->Add(array); }

  std::vector<mcor_named> List; // in the order of the arrays

private:
  void Add(vtkAbstractArray* array);

  std::vector<vtkSmartPointer<vtkAbstractArray>> Held;
};

/** Returns the name of the most suitable array to show; "" if none is suitable. */
VTKMARCHINGCORRECTORS_EXPORT std::string vtkSPHChooseArray(
  vtkFieldData* data, const mcor_ranks* ranks = nullptr);
inline bool vtkSPHIsReal(vtkAbstractArray* array)
{
  return array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE;
}

/** Returns the array itself if it holds floats or doubles, one after another; else a copy as doubles. */
vtkSmartPointer<vtkDataArray> vtkSPHAsReal(vtkDataArray* array);

/** Views an array of floats or doubles that lie one after another. */
mcor_array vtkSPHView(vtkDataArray* array);

/** Returns element `i` of the core's array, or the array's constant. */
inline double vtkSPHValueOf(const mcor_array& array, std::int64_t i)
{
  return !array.data             ? array.constant
    : array.type == MCOR_FLOAT32 ? static_cast<const float*>(array.data)[i]
                                 : static_cast<const double*>(array.data)[i];
}

/** Whether the core computes the particles' volumes. */
inline bool vtkSPHComputesVolumes(const mcor_input& input)
{
  return !mcor_is_given(&input.volume) &&
    !(mcor_is_given(&input.mass) && mcor_is_given(&input.density));
}

/** Returns the scalar to contour at a particle. */
double vtkSPHScalarOf(const mcor_input& core, vtkIdType particle);
VTK_ABI_NAMESPACE_END

#endif
