// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: lines of particles in a plane, and what is filled. Ranks make their parts of them;
 * these come together on the first rank, which joins lines as one process does.
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
   * Of this rank's surface, whose points and triangles have these numbers among all of them. Puts measures
   * into the surface's statistics, on all ranks. Collective.
   */
  vtkSPHRanksLines(vtkSPHRanks& ranks, mcor_surface& surface, const vtkSPHRanksNumbers& numbers,
    const mcor_plane& plane, bool isFilled);
  ~vtkSPHRanksLines();

  vtkIdType GetCount() const { return this->Count; }

  /** Memory did not suffice, on any rank. */
  bool HasFailed() const { return this->Failed; }

  /** Moves the points and their arrays to the first rank, with all cells; others have none. Collective. */
  void Move(vtkSPHRanks& ranks, vtkPolyData* output);

private:
  vtkSPHRanksLines(const vtkSPHRanksLines&) = delete;
  void operator=(const vtkSPHRanksLines&) = delete;

  using Piece = std::array<std::int32_t, 2>;
  std::vector<Piece> Gather(
    vtkSPHRanks& ranks, const mcor_surface& surface, const vtkSPHRanksNumbers& numbers);

  mcor_surface Whole = {};  ///< points, lines and triangles, on the first rank
  vtkSPHRanksLists Numbers; ///< on the first rank, of the points of each
  vtkIdType Count = 0;
  bool Failed = false;
};
VTK_ABI_NAMESPACE_END

#endif
