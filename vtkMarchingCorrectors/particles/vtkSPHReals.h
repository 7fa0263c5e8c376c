// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: values of arrays of real numbers, in double.
 */
#ifndef vtkSPHReals_h
#define vtkSPHReals_h

#include "vtkAOSDataArrayTemplate.h"
#include "vtkDataArray.h"
#include "vtkMarchingCorrectorsValues.h"
#include "vtkSmartPointer.h"

inline bool vtkSPHIsReal(vtkAbstractArray* array)
{
  return array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE;
}

/** Itself where it is of a type and layout for vtkSPHReals, else a copy. */
inline vtkSmartPointer<vtkDataArray> vtkSPHAsReal(vtkDataArray* array)
{
  const bool plain = vtkAOSDataArrayTemplate<float>::FastDownCast(array) ||
    vtkAOSDataArrayTemplate<double>::FastDownCast(array);
  return plain ? vtkSmartPointer<vtkDataArray>(array) : vtkMarchingCorrectorsCopyAsDouble(array);
}

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

#endif
