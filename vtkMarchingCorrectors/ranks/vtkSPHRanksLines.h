// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: lines of particles in a plane, and filled regions. Each rank makes its
 * part; the first rank gathers all, and joins lines as one process does.
 */
#ifndef vtkSPHRanksLines_h
#define vtkSPHRanksLines_h

#include "mcor.h"
#include "mcor_parts.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksPoints.h"

#include <array>

VTK_ABI_NAMESPACE_BEGIN
class vtkPolyData;

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
