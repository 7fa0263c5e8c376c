// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: how much work a surface will be, before it is made.
 */
#ifndef vtkSPHRanksWork_h
#define vtkSPHRanksWork_h

#include "mcor_parts.h"
#include "vtkType.h" // For VTK's namespace

#include <cstdint>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkSPHRanks;

/**
 * Of each of this rank's particles 1, but 0 of those without which the surface is the same: solid ones
 * where it does not depend on these.
 */
std::vector<std::int64_t> vtkSPHCountWork(const mcor_input& input, const mcor_options& options);

/**
 * The same, and where the surface is expected a share of what that costs. The surface is expected in cells of a
 * coarse grid, whose number does not grow with the particles, around which values are on both sides of an iso value; the free surface in
 * those beside which there are far fewer particles. The same to the last bit however particles are
 * strewn over ranks. Collective.
 */
std::vector<std::int64_t> vtkSPHExpectWork(vtkSPHRanks& ranks, const mcor_input& input,
  const mcor_options& options, const mcor_globals& globals);
VTK_ABI_NAMESPACE_END

#endif
