// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: estimates how much work a surface will be. */
#ifndef vtkSPHRanksWork_h
#define vtkSPHRanksWork_h

#include "mcor_parts.h"
#include "vtkType.h" // for VTK's namespace

#include <cstdint>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkSPHRanks;

/**
 * Returns 1 for each of this rank's particles, but 0 for those that the surface does not depend
 * on: solids, if it uses none.
 */
std::vector<std::int64_t> vtkSPHCountWork(const mcor_input& input, const mcor_options& options);

/**
 * The same, plus a share of the surface's cost where the surface is expected: in cells of a
 * coarse grid that have values on both sides of an iso value around them, or, for a free
 * surface, far fewer particles beside them. The number of cells does not grow with the
 * particles. The same to the last bit however particles are spread over ranks. Collective.
 */
std::vector<std::int64_t> vtkSPHExpectWork(vtkSPHRanks& ranks, const mcor_input& input,
  const mcor_options& options, const mcor_globals& globals);
VTK_ABI_NAMESPACE_END

#endif
