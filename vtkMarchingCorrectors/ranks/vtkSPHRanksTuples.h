// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: sends tuples of arrays between ranks. */
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
/** Lists the positions, then the point arrays. */
vtkSPHRanksArrays vtkSPHListArrays(vtkPolyData* points);
/**
 * Makes points of such arrays; each array gets the role (scalars, vectors, ...) that it has in
 * `like`.
 */
vtkSmartPointer<vtkPolyData> vtkSPHMakePoints(const vtkSPHRanksArrays& arrays, vtkPolyData* like);

/**
 * Sends to each rank the tuples listed for it. The arrays must have the same forms on all ranks,
 * and values that lie side by side. Returns arrays of what has arrived, in the order of ranks;
 * from: how many tuples from each. Collective.
 */
vtkSPHRanksArrays vtkSPHSendTuples(vtkSPHRanks& ranks, const vtkSPHRanksArrays& arrays,
  const vtkSPHRanksLists& to, std::vector<vtkIdType>* from = nullptr);

/**
 * Sends results back: of each array, to each rank the tuples that `back` lists for it. Returns
 * arrays of `homeCount` tuples, in which `home` lists the places of what comes from each rank;
 * the rest is 0. Collective.
 */
vtkSPHRanksArrays vtkSPHReturnTuples(vtkSPHRanks& ranks, const vtkSPHRanksArrays& arrays,
  const vtkSPHRanksLists& back, const vtkSPHRanksLists& home, vtkIdType homeCount);
VTK_ABI_NAMESPACE_END

#endif
