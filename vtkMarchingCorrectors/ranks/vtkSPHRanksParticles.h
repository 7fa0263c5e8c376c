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
 * This rank's particles (`data` may be null), without those that vtkGhostType marks as another
 * rank's, and those that the choice leaves out. They have the same point arrays on all ranks, in one order: those that all ranks with
 * particles have, with one number of components, as doubles where types differ. Their field data stay. `taken`: their indices in `data`,
 * if that is wanted. Collective.
 */
vtkSmartPointer<vtkPolyData> vtkSPHTakeParticles(vtkSPHRanks& ranks, vtkPointSet* data,
  const vtkSPHParticlesChoice& choice, std::vector<vtkIdType>* taken = nullptr);

/**
 * The same with those arrays alone that describe the particles or are interpolated.
 */
vtkSmartPointer<vtkPolyData> vtkSPHKeepUsed(vtkPolyData* own, const vtkSPHParticles& used);

/**
 * Sends to each rank the particles whose indices are listed for it; returns what came, in the order
 * of ranks; `from`: how many from each of them. The particles are of vtkSPHTakeParticles().
 * Collective.
 */
vtkSmartPointer<vtkPolyData> vtkSPHSendParticles(vtkSPHRanks& ranks, vtkPolyData* particles,
  const vtkSPHRanksLists& to, std::vector<vtkIdType>* from = nullptr);

/**
 * Gives a result without points the arrays that it has on other ranks, as writers of pieces want.
 * Collective.
 */
void vtkSPHMatchEmpty(vtkSPHRanks& ranks, vtkPolyData* result);
VTK_ABI_NAMESPACE_END

#endif
