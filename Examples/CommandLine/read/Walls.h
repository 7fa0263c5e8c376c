// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Walls_h
#define Walls_h

#include "vtkSmartPointer.h"

class vtkPointSet;

/// The array that AddWalls() makes: 0 for fluid, 1 for walls.
extern const char* const WallArrayName;

/// The fluid, followed by the walls; the fluid itself where `walls` is null. It keeps the fluid's arrays of
/// numbers. One that walls lack has the fluid's median there: solids take part in no field, so only the smoothing
/// length, and what volumes are made of, count. Throws std::runtime_error.
vtkSmartPointer<vtkPointSet> AddWalls(vtkPointSet* fluid, vtkPointSet* walls);

#endif
