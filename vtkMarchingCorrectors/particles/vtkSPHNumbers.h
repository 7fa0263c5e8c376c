// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: finds which particles of two sets are the same. */
#ifndef vtkSPHNumbers_h
#define vtkSPHNumbers_h

#include "vtkType.h"

#include <array>
#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkDataArray;

/**
 * Finds each particle's partner in the other of two sets by arrays of whole numbers; -1: it has
 * none. The result does not depend on the number of threads. Returns an empty sentence, or what
 * is wrong; `sets` names the sets in it.
 */
std::string vtkSPHMatchNumbers(const std::array<vtkDataArray*, 2>& arrays,
  const std::array<std::string, 2>& sets, const std::array<std::vector<vtkIdType>*, 2>& partners);
VTK_ABI_NAMESPACE_END

#endif
