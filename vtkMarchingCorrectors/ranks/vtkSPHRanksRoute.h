// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: which rank owns which part of space, and which particles it needs. */
#ifndef vtkSPHRanksRoute_h
#define vtkSPHRanksRoute_h

#include "mcor_parts.h"
#include "vtkSPHRanks.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkDataSet;

/** Low and high sides of x, y, z. The low sides belong to the box, the high ones do not. */
using vtkSPHRanksBox = std::array<double, 6>;

struct vtkSPHRanksPlace
{
  double At[3]; ///< within the whole
  std::int64_t Work;
};

/**
 * Divides space among ranks by a k-d tree over samples of the particles, with cuts between the
 * lattice's bricks. All ranks have the same samples, and so the same tree.
 */
class vtkSPHRanksPartition
{
public:
  /**
   * Divides `whole`, whose sides may be infinite, so that each rank has about the same sum of
   * Work. places: this rank's particles. Cuts lie on multiples of `brick`. Collective.
   */
  vtkSPHRanksPartition(vtkSPHRanks& ranks, const vtkSPHRanksBox& whole,
    const std::vector<vtkSPHRanksPlace>& places, double brick);

  const vtkSPHRanksBox& GetBox(int rank) const
  {
    return this->Boxes[static_cast<std::size_t>(rank)];
  }

  /** Returns the rank whose box holds the point, which must be within the whole. */
  int FindOwner(const double point[3]) const;

  /** Adds the ranks whose boxes overlap this box. */
  void FindOverlaps(const vtkSPHRanksBox& box, std::vector<int>& found) const;

private:
  struct Node
  {
    int FirstRank, Ranks; ///< the ranks that share it
    vtkSPHRanksBox Box;
    int Axis = 0;
    double Plane = 0.0;
    int Low = -1, High = -1; ///< children
  };
  using Samples = std::vector<vtkSPHRanksPlace>::iterator;
  int Divide(Samples begin, Samples end, const Node& node, double brick);

  std::vector<Node> Nodes;
  std::vector<vtkSPHRanksBox> Boxes;
};
/** One period, as the core has it: it begins at a node of the lattice. */
struct vtkSPHRanksPeriod
{
  vtkSPHRanksPeriod() = default;
  vtkSPHRanksPeriod(const mcor_options& options, const mcor_globals& globals);

  /** Moves a place into the period. */
  void Take(double at[3]) const;

  double First[3] = { 0.0, 0.0, 0.0 }, Length[3] = { 0.0, 0.0, 0.0 }; ///< 0: open
};

/** Which ranks get this rank's particles, and what this rank will have. */
struct vtkSPHRanksRoute
{
  /** Returns the rank whose box holds a place, or an image of it. */
  int FindOwner(const double at[3]) const;

  /** Lists, for each rank, those of this rank's points that its box holds. */
  vtkSPHRanksLists ListOwners(vtkDataSet* points) const;

  /** Finds the ranks whose boxes, or images of them, are within `reach` of a place. */
  void FindReached(const double at[3], double reach, std::vector<int>& found) const;

  vtkSPHRanksLists To;             ///< indices of the particles that each rank gets
  double Box[6] = {};              ///< this rank's, as in mcor_options; may hold nothing
  vtkSPHRanksBox Whole = {};       ///< holds all ranks' boxes
  std::int64_t OwnedParticles = 0; ///< particles in this rank's box
  std::int64_t Particles = 0;      ///< these, and copies of others'
  std::shared_ptr<const vtkSPHRanksPartition> Partition;
  vtkSPHRanksPeriod Period;
  std::int64_t Work = 0; ///< of all ranks' particles in this rank's box, see vtkSPHRanksBalance
};

/** The work to divide evenly. */
struct vtkSPHRanksBalance
{
  std::vector<std::int64_t> Work; ///< of each particle; 0: it is needed nowhere; empty: 1 each
  std::vector<vtkSPHRanksPlace> Others; ///< this rank's further work, besides the particles

  std::int64_t Of(std::int64_t particle) const
  {
    return this->Work.empty() ? 1 : this->Work[static_cast<std::size_t>(particle)];
  }
};

/**
 * Returns 1 for each of this rank's particles, but 0 for those that the surface does not depend
 * on: solids, if it uses none.
 */
std::vector<std::int64_t> vtkSPHCountWork(const mcor_input& input, const mcor_options& options);

/**
 * Adds a share of the surface's cost where the surface is expected: in cells of a coarse grid
 * that have values on both sides of an iso value around them, or, for a free surface, far fewer
 * particles beside them. The number of cells does not grow with the particles. The result is the
 * same to the last bit however particles are spread over ranks. Collective.
 */
std::vector<std::int64_t> vtkSPHExpectWork(vtkSPHRanks& ranks, const mcor_input& input,
  const mcor_options& options, const mcor_globals& globals);

/**
 * Divides space evenly, and finds for each particle, by its own smoothing length, the ranks
 * whose boxes it reaches. input: this rank's particles; globals: measures of all particles.
 * Collective.
 */
vtkSPHRanksRoute vtkSPHFindRoute(vtkSPHRanks& ranks, const mcor_input& input,
  const mcor_options& options, const mcor_globals& globals, const vtkSPHRanksBalance& balance);
VTK_ABI_NAMESPACE_END

#endif
