// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: values of arrays of any type and layout, as real numbers. */
#ifndef vtkSPHReals_h
#define vtkSPHReals_h

#include "mcor.h"
#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
inline bool vtkSPHIsReal(vtkAbstractArray* array)
{
  return array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE;
}

/** Returns the array itself if vtkSPHReals can read its type and layout, else a copy. */
vtkSmartPointer<vtkDataArray> vtkSPHAsReal(vtkDataArray* array);

/** The values of an array that vtkSPHAsReal() has returned. */
class vtkSPHReals
{
public:
  explicit vtkSPHReals(vtkDataArray* array)
    : Components(array->GetNumberOfComponents())
    , Floats(
        array->GetDataType() == VTK_FLOAT ? static_cast<float*>(array->GetVoidPointer(0)) : nullptr)
    , Doubles(this->Floats ? nullptr : static_cast<double*>(array->GetVoidPointer(0)))
  {
  }

  double operator()(vtkIdType tuple, int component) const
  {
    const vtkIdType i = tuple * this->Components + component;
    return this->Floats ? static_cast<double>(this->Floats[i]) : this->Doubles[i];
  }

  const int Components;

private:
  const float* const Floats;
  const double* const Doubles;
};

/**
 * Sets `solid` to 0 where the array has the value `fluid`, else to 1. Returns the number of
 * zeros.
 */
vtkIdType vtkSPHMarkSolids(vtkDataArray* array, double fluid, std::uint8_t* solid);

struct vtkSPHParticlesChoice;
class vtkPointSet;

/**
 * Whether the choice leaves any particles out, and which ones stay. A choice by an array that is
 * not there leaves none out.
 */
bool vtkSPHLeavesOut(const vtkSPHParticlesChoice& choice);
std::vector<bool> vtkSPHFindPresent(const vtkSPHParticlesChoice& choice, vtkPointSet* points);

/**
 * Counts how often each value occurs in an array of one component; empty if there are more than
 * `most` values.
 */
std::map<double, vtkIdType> vtkSPHCountValues(vtkDataArray* array, std::size_t most);

/** Returns an element of the core's array, or the constant that stands for it. */
double vtkSPHValueOf(const mcor_array& array, std::int64_t i);

/** Returns the scalar to contour at a particle. */
double vtkSPHScalarOf(const mcor_input& core, vtkIdType particle);
VTK_ABI_NAMESPACE_END

#endif
