// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: what each rank did, and what all of them did together.
 */
#ifndef vtkSPHRanksStatistics_h
#define vtkSPHRanksStatistics_h

#include "mcor.h"
#include "vtkType.h" // For VTK's namespace

#include <cstdint>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkFieldData;
class vtkSPHRanks;
struct vtkSPHRanksRoute;

/** One rank's part of a run. */
struct vtkSPHRanksShare
{
  mcor_statistics Statistics;
  std::int64_t Points, Triangles;
  std::int64_t OwnedParticles, CopiedParticles; ///< of its box; of others' that reach it
  std::int64_t BytesSent;
  std::int64_t Work; ///< as in vtkSPHRanksRoute
};

/**
 * Sums of counts, the longest seconds, means over all points, of which each was counted by one rank. What
 * is evaluated on both sides of a seam is in the counts of bricks, nodes and evaluations twice.
 */
mcor_statistics vtkSPHMergeShares(const std::vector<vtkSPHRanksShare>& shares);

/**
 * Adds "RankParticles", "RankCopies", "RankBytesSent", "RankWork", "RankNodesEvaluated",
 * "RankTriangles" and "RankSeconds", one component for each rank.
 */
void vtkSPHAddShares(vtkFieldData* run, const std::vector<vtkSPHRanksShare>& shares);

/**
 * Adds what each rank did of a run without a surface: "RankParticles", "RankCopies", "RankPoints"
 * (where it evaluated), "RankBytesSent" and "RankSeconds", taken from the total of `run`'s "Seconds".
 * Collective.
 */
void vtkSPHAddSampleShares(
  vtkSPHRanks& ranks, vtkFieldData* run, const vtkSPHRanksRoute& route, std::int64_t points);
VTK_ABI_NAMESPACE_END

#endif
