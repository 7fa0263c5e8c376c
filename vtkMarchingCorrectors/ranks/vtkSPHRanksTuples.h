// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: tuples of arrays that travel between ranks.
 */
#ifndef vtkSPHRanksTuples_h
#define vtkSPHRanksTuples_h

#include "vtkSPHRanks.h"
#include "vtkSmartPointer.h"

#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkAbstractArray;
class vtkPointData;
class vtkPolyData;

using vtkSPHRanksArrays = std::vector<vtkSmartPointer<vtkAbstractArray>>;

vtkSPHRanksArrays vtkSPHListArrays(vtkPointData* data);
/** The positions, then the point arrays. */
vtkSPHRanksArrays vtkSPHListArrays(vtkPolyData* points);
/** Points of such arrays, each of which is used as the one in `like` is. */
vtkSmartPointer<vtkPolyData> vtkSPHMakePoints(const vtkSPHRanksArrays& arrays, vtkPolyData* like);

/**
 * To each rank the tuples listed for it, of arrays that have the same forms on all ranks and lie plain in memory.
 * Returns such arrays of what came, in the order of ranks; `from`: how many tuples from each of them. Collective.
 */
vtkSPHRanksArrays vtkSPHSendTuples(vtkSPHRanks& ranks, const vtkSPHRanksArrays& arrays,
  const vtkSPHRanksLists& to, std::vector<vtkIdType>* from = nullptr);

/**
 * Sends results back to where they are wanted: of the arrays, the tuples listed for each rank in `back`. Returns
 * arrays of `homeCount` tuples: what comes from a rank is at the places listed for it in `home`; elsewhere they
 * are 0. Collective.
 */
vtkSPHRanksArrays vtkSPHReturnTuples(vtkSPHRanks& ranks, const vtkSPHRanksArrays& arrays,
  const vtkSPHRanksLists& back, const vtkSPHRanksLists& home, vtkIdType homeCount);
VTK_ABI_NAMESPACE_END

#endif
