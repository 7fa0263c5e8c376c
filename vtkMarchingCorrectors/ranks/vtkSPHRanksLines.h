// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: lines of particles in a plane. Ranks make their parts of them; as they are few, they
 * come together on the first rank, which joins them as one process does.
 */
#ifndef vtkSPHRanksLines_h
#define vtkSPHRanksLines_h

#include "mcor.h"
#include "mcor_parts.h"
#include "vtkType.h"

#include <vector>

class vtkIdTypeArray;
class vtkPolyData;
class vtkSPHRanks;

/** Extents and edges along the axes of the particles, not turned into the plane's, as the ranks divide space. */
mcor_globals vtkSPHPlaceInPlane(const mcor_globals& globals);

/** The period, but for the constant axis, along which it means nothing. */
mcor_options vtkSPHPlaceInPlane(const mcor_options& options, const mcor_globals& globals);

class vtkSPHRanksLines
{
public:
  /**
   * Of this rank's surface; numbers: of its points among all `total` ones. Puts the number of lines and their
   * measures into the surface's statistics, on all ranks. Collective.
   */
  vtkSPHRanksLines(vtkSPHRanks& ranks, mcor_surface& surface, vtkIdTypeArray* numbers,
    vtkIdType total, const mcor_plane& plane);
  ~vtkSPHRanksLines();

  vtkIdType GetCount() const { return this->Count; }

  /** Memory did not suffice, on any rank. */
  bool HasFailed() const { return this->Failed; }

  /** Moves the points and their arrays to the first rank, with all lines; others have none. Collective. */
  void Move(vtkSPHRanks& ranks, vtkPolyData* output) const;

private:
  vtkSPHRanksLines(const vtkSPHRanksLines&) = delete;
  void operator=(const vtkSPHRanksLines&) = delete;

  mcor_surface Whole = {};                     ///< points and lines, on the first rank
  std::vector<std::vector<vtkIdType>> Numbers; ///< on the first rank, of the points of each
  vtkIdType Count = 0;
  bool Failed = false;
};

#endif
