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
#include "vtkSmartPointer.h"

#include <array>

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
 * which go; null on other ranks. points, triangles: on the first rank, the numbers in the whole of
 * what each rank has. Collective.
 */
vtkSmartPointer<vtkPolyData> vtkSPHGatherSurface(
  vtkSPHRanks& ranks, vtkPolyData* part, vtkSPHRanksLists& points, vtkSPHRanksLists& triangles);

/**
 * Lines of particles in a plane, and filled regions. Each rank makes its part; the first rank
 * gathers all, and joins lines as one process does.
 */
class vtkSPHRanksLines
{
public:
  /**
   * Gathers the lines of all ranks. `numbers` are those of this rank's points and triangles in
   * the whole. Sets the measures in the surface's statistics, on all ranks. Collective.
   */
  vtkSPHRanksLines(vtkSPHRanks& ranks, mcor_surface& surface, const vtkSPHRanksNumbers& numbers,
    const mcor_plane& plane, bool isFilled);
  ~vtkSPHRanksLines();

  vtkIdType GetCount() const { return this->Count; }

  /** Whether memory ran out on any rank. */
  bool HasFailed() const { return this->Failed; }

  /**
   * Moves the points and their arrays to the first rank, which gets all cells; the others end
   * empty. Collective.
   */
  void Move(vtkSPHRanks& ranks, vtkPolyData* output);

private:
  vtkSPHRanksLines(const vtkSPHRanksLines&) = delete;
  void operator=(const vtkSPHRanksLines&) = delete;

  using Piece = std::array<std::int32_t, 2>;
  std::vector<Piece> Gather(
    vtkSPHRanks& ranks, const mcor_surface& surface, const vtkSPHRanksNumbers& numbers);

  mcor_surface Whole = {};  ///< points, lines and triangles, on the first rank
  vtkSPHRanksLists Numbers; ///< on the first rank: the points of each rank
  vtkIdType Count = 0;
  bool Failed = false;
};
VTK_ABI_NAMESPACE_END

#endif
