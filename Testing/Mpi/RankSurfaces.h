// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Surfaces of ranks, put together by the numbers of their points.
 */
#ifndef RankSurfaces_h
#define RankSurfaces_h

#include "vtkType.h"

#include <string>

class vtkDataArray;
class vtkMultiProcessController;
class vtkPolyData;

/// Tuples of the same type and size, bit for bit the same.
bool IsSameTuple(vtkDataArray* a, vtkIdType i, vtkDataArray* b, vtkIdType j);

/// Compares what all ranks have with rank 0's `whole`, which others leave null: the same points under
/// the same numbers, bit for bit, with all their arrays, and the same triangles, each of them once.
/// Returns, on rank 0, one sentence; empty where nothing differs.
std::string CompareWithWhole(
  vtkMultiProcessController* controller, vtkPolyData* part, vtkPolyData* whole);

#endif
