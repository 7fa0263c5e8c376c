// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: what is done with every value of an array, on all processors.
 */
#ifndef vtkMarchingCorrectorsValues_h
#define vtkMarchingCorrectorsValues_h

#include "mcor.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstddef>
#include <cstdint>
#include <map>

class vtkDataArray;

/** Of any type and layout. */
vtkSmartPointer<vtkDataArray> vtkMarchingCorrectorsCopyAsDouble(vtkDataArray* array);

/** Writes 0 to `solid` where the array has the value `fluid`, else 1. Returns how many are 0. */
vtkIdType vtkMarchingCorrectorsMarkSolids(vtkDataArray* array, double fluid, std::uint8_t* solid);

/** How often each value occurs in an array of one component; empty if there are more than `most`. */
std::map<double, vtkIdType> vtkMarchingCorrectorsCountValues(vtkDataArray* array, std::size_t most);

/** What is contoured at a particle; and where that is along an axis. */
double vtkMarchingCorrectorsScalarOf(const mcor_input& core, vtkIdType particle);
double vtkMarchingCorrectorsPositionOf(const mcor_input& core, vtkIdType particle, int axis);

#endif
