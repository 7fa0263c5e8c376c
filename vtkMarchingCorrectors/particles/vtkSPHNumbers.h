// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: which particles of two sets are the same ones.
 */
#ifndef vtkSPHNumbers_h
#define vtkSPHNumbers_h

#include "vtkType.h"

#include <array>
#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkDataArray;

/**
 * Finds the partner of each particle in the other one of two sets, -1 where it has none, by arrays
 * of whole numbers. The result does not depend on the number of threads. Returns nothing, or why not:
 * `sets` is what to call them.
 */
std::string vtkSPHMatchNumbers(const std::array<vtkDataArray*, 2>& arrays,
  const std::array<std::string, 2>& sets, const std::array<std::vector<vtkIdType>*, 2>& partners);
VTK_ABI_NAMESPACE_END

#endif
