// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: the parts of a surface that ranks have, as one whole. */
#ifndef vtkSPHRanksSurface_h
#define vtkSPHRanksSurface_h

#include "mcor.h"
#include "mcor_parts.h"
#include "vtkIdTypeArray.h"
#include "vtkPolyData.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRun.h"
#include "vtkSmartPointer.h"

VTK_ABI_NAMESPACE_BEGIN
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

/**
 * Puts parts together on the first rank, with all arrays, by GlobalPointIds and GlobalCellIds,
 * which go; null on other ranks. Collective.
 */
vtkSmartPointer<vtkPolyData> vtkSPHGatherSurface(vtkSPHRanks& ranks, vtkPolyData* part);

/**
 * Lines of particles in a plane, and filled regions. Each rank makes its part; the first rank
 * gathers all, and joins lines as one process does.
 */
struct vtkSPHRanksLines
{
  /**
   * Gathers the lines of all ranks. `numbers` are those of this rank's points and triangles in
   * the whole. Sets the measures in the surface's statistics, on all ranks. Collective.
   */
  vtkSPHRanksLines(vtkSPHRanks& ranks, mcor_surface& surface, const vtkSPHRanksNumbers& numbers,
    const mcor_plane& plane, bool isFilled);

  /**
   * Moves the points and their arrays to the first rank, which gets all cells; the others end
   * empty. Collective.
   */
  void Move(vtkSPHRanks& ranks, vtkPolyData* output);

  vtkIdType Count = 0; ///< of all lines
  bool Failed = false; ///< memory ran out on any rank

private:
  vtkSPHOwned<mcor_surface, mcor_free_surface> Whole; ///< all cells and points, on the first rank
  const vtkSmartPointer<vtkIdTypeArray> Numbers;      ///< of this rank's points
};
VTK_ABI_NAMESPACE_END

#endif
