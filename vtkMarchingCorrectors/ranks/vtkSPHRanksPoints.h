// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: numbers of the whole surface's points and triangles.
 */
#ifndef vtkSPHRanksPoints_h
#define vtkSPHRanksPoints_h

#include "mcor.h"
#include "vtkIdTypeArray.h"
#include "vtkSmartPointer.h"

VTK_ABI_NAMESPACE_BEGIN
class vtkSPHRanks;

/** Numbers of a rank's points and triangles, and how many there are on all ranks. */
struct vtkSPHRanksNumbers
{
  vtkSmartPointer<vtkIdTypeArray> OfPoints, OfTriangles;
  vtkIdType Points, Triangles;
};

/**
 * The number of each of this rank's points among the points of all ranks, those with the same key
 * being one: the index that it has where one process makes the whole surface. The same of this rank's
 * triangles, which ascend. Collective.
 */
vtkSPHRanksNumbers vtkSPHNumber(vtkSPHRanks& ranks, const mcor_surface& surface);

/** Area and volume of all ranks' surface, into `statistics`; numbers: of this rank's points. Collective. */
void vtkSPHMeasure(vtkSPHRanks& ranks, const mcor_surface& surface, vtkIdTypeArray* numbers,
  mcor_statistics& statistics);
VTK_ABI_NAMESPACE_END

#endif
