// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: tuples of arrays that travel between ranks.
 */
#ifndef vtkSPHRanksTuples_h
#define vtkSPHRanksTuples_h

#include "vtkSPHRanks.h"
#include "vtkType.h"

#include <vector>

class vtkAbstractArray;
class vtkPointData;
class vtkPolyData;

using vtkSPHRanksArrays = std::vector<vtkAbstractArray*>;

vtkSPHRanksArrays vtkSPHListArrays(vtkPointData* data);

/** The positions, then the point arrays. */
vtkSPHRanksArrays vtkSPHListArrays(vtkPolyData* particles);

/** To each rank the tuples listed for it. Number i of the result came from rank i. Collective. */
std::vector<vtkSPHRanks::Bytes> vtkSPHSendTuples(vtkSPHRanks& ranks,
  const vtkSPHRanksArrays& arrays, const std::vector<std::vector<vtkIdType>>& to);

/** How many tuples came from each rank. */
std::vector<vtkIdType> vtkSPHCountTuples(const std::vector<vtkSPHRanks::Bytes>& received);

/** To arrays that are as long as all of them together. */
void vtkSPHReceiveTuples(
  const std::vector<vtkSPHRanks::Bytes>& received, const vtkSPHRanksArrays& arrays);

#endif
