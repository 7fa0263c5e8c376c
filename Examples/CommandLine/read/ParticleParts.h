// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ParticleParts_h
#define ParticleParts_h

#include "vtkSmartPointer.h"

#include <vector>

class vtkPointSet;

/// Joins parts to one set of particles, with the arrays that all of them have. Leaves out particles
/// that a part marks as copies of another part's ("vtkGhostType").
vtkSmartPointer<vtkPointSet> JoinParts(const std::vector<vtkSmartPointer<vtkPointSet>>& parts);

/// The array that AddWalls() makes: 0 for fluid, 1 for walls.
extern const char* const WallArrayName;

/// The fluid, followed by the walls; the fluid itself where `walls` is null. It keeps the fluid's
/// arrays of numbers. One that walls lack has the fluid's median there: solids take part in no
/// field, so only the smoothing length, and what volumes are made of, count. Throws
/// std::runtime_error.
vtkSmartPointer<vtkPointSet> AddWalls(vtkPointSet* fluid, vtkPointSet* walls);

#endif
