// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: particles that travel between ranks, with all their point arrays.
 */
#ifndef vtkSPHRanksParticles_h
#define vtkSPHRanksParticles_h

#include "vtkSPHRanks.h"
#include "vtkSmartPointer.h"

#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkPointSet;
class vtkPolyData;
class vtkSPHParticles;
struct vtkSPHParticlesChoice;

/**
 * Takes this rank's particles, without those that vtkGhostType marks as another rank's, and
 * those that the choice leaves out. `data` may be null. All ranks get the same point arrays in
 * one order: those that all ranks with particles have, with the same number of components, as
 * doubles where types differ. Field data stay. taken: the particles' indices in `data`.
 * Collective.
 */
vtkSmartPointer<vtkPolyData> vtkSPHTakeParticles(vtkSPHRanks& ranks, vtkPointSet* data,
  const vtkSPHParticlesChoice& choice, std::vector<vtkIdType>* taken = nullptr);

/** Keeps only the arrays that describe the particles or are interpolated. */
vtkSmartPointer<vtkPolyData> vtkSPHKeepUsed(vtkPolyData* own, const vtkSPHParticles& used);

/**
 * Sends to each rank the particles listed for it. Returns what has arrived, in the order of
 * ranks; from: how many from each. The particles are those of vtkSPHTakeParticles(). Collective.
 */
vtkSmartPointer<vtkPolyData> vtkSPHSendParticles(vtkSPHRanks& ranks, vtkPolyData* particles,
  const vtkSPHRanksLists& to, std::vector<vtkIdType>* from = nullptr);

/**
 * Gives a result without points the arrays that it has on other ranks, which writers of pieces
 * need. Collective.
 */
void vtkSPHMatchEmpty(vtkSPHRanks& ranks, vtkPolyData* result);
VTK_ABI_NAMESPACE_END

#endif
