// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Ways to strew particles over ranks.
 */
#ifndef RankParts_h
#define RankParts_h

#include "vtkSmartPointer.h"

#include <string>

class vtkPolyData;

constexpr int PartCount = 6;

const char* PartName(int part);

/// The particles that a .vtp file holds.
vtkSmartPointer<vtkPolyData> ReadParticles(const std::string& file);

/// A rank's share of the particles.
vtkSmartPointer<vtkPolyData> TakePart(vtkPolyData* particles, int part, int rank, int count);

#endif
