// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: tuples of arrays, and particles with all their arrays, that travel
 * between ranks.
 */
#ifndef vtkSPHRanksParticles_h
#define vtkSPHRanksParticles_h

#include "vtkSPHArrays.h"
#include "vtkSPHRanks.h"

#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkPointSet;
class vtkPolyData;
class vtkSPHParticles;
struct vtkSPHParticlesChoice;

using vtkSPHRanksArrays = std::vector<vtkSmartPointer<vtkAbstractArray>>;

/** Lists the positions, then the point arrays. */
vtkSPHRanksArrays vtkSPHListArrays(vtkPointSet* points);
/** Makes points of arrays that vtkSPHListArrays() lists, with the same roles (scalars, vectors, ...) as in `like`. */
vtkSmartPointer<vtkPolyData> vtkSPHMakePoints(const vtkSPHRanksArrays& arrays, vtkPointSet* like);

/**
 * Sends to each rank the tuples listed for it. The arrays must have the same types on all ranks.
 * Returns arrays of the tuples that came, in the order of ranks. from: how many tuples came from
 * each rank. Collective.
 */
vtkSPHRanksArrays vtkSPHSendTuples(vtkSPHRanks& ranks, const vtkSPHRanksArrays& arrays,
  const vtkSPHRanksLists& to, std::vector<vtkIdType>* from = nullptr);

/**
 * Sends each element's tuple back to the rank from which the element came. Returns arrays of
 * `count` tuples; a tuple that no rank sent is 0. from: how many elements came from each rank.
 * owned: marks the elements whose tuples are sent; null: all are sent. to: for each rank, the places
 * of its tuples in the result. Collective.
 */
vtkSPHRanksArrays vtkSPHReturnTuples(vtkSPHRanks& ranks, const vtkSPHRanksArrays& arrays,
  const std::vector<vtkIdType>& from, const std::uint8_t* owned, const vtkSPHRanksLists& to,
  vtkIdType count);

/**
 * Gathers all ranks' tuples on the first rank; the other ranks get none. numbers: the place of each
 * of this rank's tuples in the result; null: tuples come in the order of ranks. Collective.
 */
vtkSPHRanksArrays vtkSPHGatherTuples(
  vtkSPHRanks& ranks, vtkSPHRanksArrays arrays, vtkDataArray* numbers);

/**
 * Takes this rank's particles, except particles that vtkGhostType marks as another rank's, or that
 * the choice leaves out. `data` may be null. All ranks get the same point arrays in one order: the
 * arrays that all ranks with particles have, with the same number of components, as doubles if
 * types differ. Field data stay. taken: the particles' indices in `data`.
 * Collective.
 */
vtkSmartPointer<vtkPolyData> vtkSPHTakeParticles(vtkSPHRanks& ranks, vtkPointSet* data,
  const vtkSPHParticlesChoice& choice, std::vector<vtkIdType>* taken = nullptr);

/** Returns the particles with only the arrays that describe them or are interpolated. */
vtkSmartPointer<vtkPolyData> vtkSPHKeepUsed(vtkPointSet* own, const vtkSPHParticles& used);
VTK_ABI_NAMESPACE_END

#endif
