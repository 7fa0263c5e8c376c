// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: values of arrays of any type and layout, as real numbers.
 */
#ifndef vtkSPHReals_h
#define vtkSPHReals_h

#include "mcor.h"
#include "vtkArrayDispatch.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkSMPTools.h"
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

/** Itself where it is of a type and layout for vtkSPHReals, else a copy. */
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

/** work(values, index of the first) for all values, on all processors. */
template <typename WorkT>
void vtkSPHForValues(vtkDataArray* array, const WorkT& work)
{
  const auto run = [&work](auto* typed)
  {
    vtkSMPTools::For(0, typed->GetNumberOfValues(), 65536,
      [&](vtkIdType begin, vtkIdType end)
      { work(vtk::DataArrayValueRange(typed, begin, end), begin); });
  };
  if (!vtkArrayDispatch::Dispatch::Execute(array, run))
  {
    run(array);
  }
}

/** Writes 0 to `solid` where the array has the value `fluid`, else 1. Returns how many are 0. */
vtkIdType vtkSPHMarkSolids(vtkDataArray* array, double fluid, std::uint8_t* solid);

struct vtkSPHParticlesChoice;
class vtkPointSet;

/** Whether the choice leaves any particles out, and which of them it leaves; arrays that are not there choose none. */
bool vtkSPHLeavesOut(const vtkSPHParticlesChoice& choice);
std::vector<bool> vtkSPHFindPresent(const vtkSPHParticlesChoice& choice, vtkPointSet* points);

/** How often each value occurs in an array of one component; empty if there are more than `most`. */
std::map<double, vtkIdType> vtkSPHCountValues(vtkDataArray* array, std::size_t most);

/** An element of the core's array, or the constant that stands for it. */
double vtkSPHValueOf(const mcor_array& array, std::int64_t i);

/** The scalar to contour at a particle. */
double vtkSPHScalarOf(const mcor_input& core, vtkIdType particle);
VTK_ABI_NAMESPACE_END

#endif
