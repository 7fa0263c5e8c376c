// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the project: what is found among particles' arrays where the user has chosen
 * nothing.
 */
#ifndef vtkSPHFound_h
#define vtkSPHFound_h

#include "vtkMarchingCorrectorsModule.h"

#include <string>

VTK_ABI_NAMESPACE_BEGIN
class vtkPointSet;

/** Names of arrays; empty: not found. */
struct vtkSPHFound
{
  std::string SmoothingLength, Volume, Mass, Density, Velocity;
  std::string
    Fluid; ///< it clearly tells which particles are fluid, see vtkSPHAlgorithm::SetDetectFluid()
  double FluidValue = 0.0;
};

VTKMARCHINGCORRECTORS_EXPORT vtkSPHFound vtkSPHFindArrays(vtkPointSet* particles);
VTK_ABI_NAMESPACE_END

#endif
