// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: numbers points and triangles as in the whole surface. */
#ifndef vtkSPHRanksPoints_h
#define vtkSPHRanksPoints_h

#include "mcor.h"
#include "vtkIdTypeArray.h"
#include "vtkSmartPointer.h"

VTK_ABI_NAMESPACE_BEGIN
class vtkSPHRanks;

/** The numbers of a rank's points and triangles, and how many the whole surface has. */
struct vtkSPHRanksNumbers
{
  vtkSmartPointer<vtkIdTypeArray> OfPoints, OfTriangles;
  vtkIdType Points, Triangles;
};

/**
 * Finds the number of each of this rank's points in the whole surface, which is its index where
 * one process makes all of it. Points with the same key are one. Does the same for this rank's
 * triangles, whose keys ascend. Collective.
 */
vtkSPHRanksNumbers vtkSPHNumber(vtkSPHRanks& ranks, const mcor_surface& surface);

/**
 * Measures area and volume of the whole surface into `statistics`. numbers: those of this rank's
 * points. Collective.
 */
void vtkSPHMeasure(vtkSPHRanks& ranks, const mcor_surface& surface, vtkIdTypeArray* numbers,
  mcor_statistics& statistics);
VTK_ABI_NAMESPACE_END

#endif
