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

class vtkAbstractArray;
class vtkPointData;

/**
 * To each rank the tuples listed for it, of arrays that have the same forms on all ranks and lie plain in memory.
 * Returns such arrays of what came, in the order of ranks; `from`: how many tuples from each of them. Collective.
 */
std::vector<vtkSmartPointer<vtkAbstractArray>> vtkSPHSendTuples(vtkSPHRanks& ranks,
  const std::vector<vtkAbstractArray*>& arrays, const vtkSPHRanksLists& to,
  std::vector<vtkIdType>* from = nullptr);

/**
 * Sends results back to where they are wanted: of the arrays of `results`, the tuples listed for each rank in
 * `back`. What comes from a rank goes to the places listed for it in `home`, in arrays of `homeCount` tuples
 * that are 0 elsewhere and are added to `to`. Collective.
 */
void vtkSPHReturnArrays(vtkSPHRanks& ranks, vtkPointData* results, const vtkSPHRanksLists& back,
  const vtkSPHRanksLists& home, vtkIdType homeCount, vtkPointData* to);

/** Adds an array as `from` has its number i: with what it is to be used for. */
void vtkSPHAddAs(vtkPointData* from, int i, vtkAbstractArray* array, vtkPointData* to);

#endif
