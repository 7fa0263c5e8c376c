// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: who owns which part of space, and which particles must be where.
 */
#ifndef vtkSPHRanksRoute_h
#define vtkSPHRanksRoute_h

#include "mcor_parts.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksPartition.h"

#include <cstdint>
#include <memory>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkPolyData;

/** One period, as the core has it: it begins at a node of the lattice. */
struct vtkSPHRanksPeriod
{
  vtkSPHRanksPeriod() = default;
  vtkSPHRanksPeriod(const mcor_options& options, const mcor_globals& globals);

  /** Moves a place into it. */
  void Take(double at[3]) const;

  double First[3] = { 0.0, 0.0, 0.0 }, Length[3] = { 0.0, 0.0, 0.0 }; ///< 0: open
};

/** To whom this rank's particles go, and what this rank will have. */
struct vtkSPHRanksRoute
{
  /** The rank whose box holds a place, or an image of it. */
  int FindOwner(const double at[3]) const;

  /** Lists, for each rank, those of this rank's points that are in its boxes. */
  vtkSPHRanksLists ListOwners(vtkPolyData* points) const;

  /** Lists the ranks whose boxes, or images of them, are within `reach` of a place. */
  void FindReached(const double at[3], double reach, std::vector<int>& found) const;

  vtkSPHRanksLists To;             ///< indices of the particles that each rank gets
  double Box[6] = {};              ///< this rank's, as in mcor_options; may hold nothing
  vtkSPHRanksBox Whole = {};       ///< of all ranks' boxes
  std::int64_t OwnedParticles = 0; ///< those in its box
  std::int64_t Particles = 0;      ///< the same and copies
  std::shared_ptr<const vtkSPHRanksPartition> Partition;
  vtkSPHRanksPeriod Period;
  std::int64_t Work = 0; ///< of all ranks' particles in its box, see vtkSPHRanksBalance
};

/** Lists the numbers at these places. */
vtkSPHRanksLists vtkSPHListAt(vtkSPHRanksLists places, const std::vector<vtkIdType>& numbers);

/** The work that is divided evenly. */
struct vtkSPHRanksBalance
{
  std::vector<std::int64_t> Work; ///< of each particle, 0: it is needed nowhere; empty: 1 each
  std::vector<vtkSPHRanksPlace> Others; ///< of this rank's, beside the particles

  std::int64_t Of(std::int64_t particle) const
  {
    return this->Work.empty() ? 1 : this->Work[static_cast<std::size_t>(particle)];
  }
};

/**
 * Divides space evenly, and finds for each particle the ranks whose boxes it reaches, by its own
 * smoothing length. `input` are this rank's particles, `globals` those of all. Collective.
 */
vtkSPHRanksRoute vtkSPHFindRoute(vtkSPHRanks& ranks, const mcor_input& input,
  const mcor_options& options, const mcor_globals& globals, const vtkSPHRanksBalance& balance);
VTK_ABI_NAMESPACE_END

#endif
