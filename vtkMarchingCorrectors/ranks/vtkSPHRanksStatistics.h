// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: what each rank has done, and what all have done together. */
#ifndef vtkSPHRanksStatistics_h
#define vtkSPHRanksStatistics_h

#include "mcor.h"
#include "vtkType.h" // for VTK's namespace

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
  std::int64_t OwnedParticles, CopiedParticles; ///< in its box; of others, which reach it
  std::int64_t BytesSent;
  std::int64_t Work; ///< as in vtkSPHRanksRoute
};

/**
 * Merges statistics: sums of counts, the longest seconds, and means over all points (one rank
 * counts each point). What is evaluated on both sides of a seam counts twice among bricks, nodes
 * and evaluations.
 */
mcor_statistics vtkSPHMergeShares(const std::vector<vtkSPHRanksShare>& shares);

/**
 * Adds "RankParticles", "RankCopies", "RankBytesSent", "RankWork", "RankNodesEvaluated",
 * "RankTriangles" and "RankSeconds", one component for each rank.
 */
void vtkSPHAddShares(vtkFieldData* run, const std::vector<vtkSPHRanksShare>& shares);

/**
 * Adds what each rank has done in a run without a surface: "RankParticles", "RankCopies",
 * "RankPoints" (where it evaluated), "RankBytesSent" and "RankSeconds", which is the total of
 * `run`'s "Seconds". Collective.
 */
void vtkSPHAddSampleShares(
  vtkSPHRanks& ranks, vtkFieldData* run, const vtkSPHRanksRoute& route, std::int64_t points);
VTK_ABI_NAMESPACE_END

#endif
