// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ParticleParts_h
#define ParticleParts_h

#include "vtkSmartPointer.h"

#include <vector>

class vtkPointSet;

/// One set of particles from its parts, with the arrays that all of them have. Particles that a part
/// marks as copies of another part's ("vtkGhostType") are left out.
vtkSmartPointer<vtkPointSet> JoinParts(const std::vector<vtkSmartPointer<vtkPointSet>>& parts);

#endif
