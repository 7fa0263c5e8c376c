// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: which part of space each rank owns, and which particles each rank needs. */
#ifndef vtkSPHRanksSpace_h
#define vtkSPHRanksSpace_h

#include "mcor_parts.h"
#include "vtkSPHRanks.h"

#include <array>
#include <cstdint>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkDataSet;

/** Low and high sides of x, y, z. The low sides belong to the box, the high ones do not. */
using vtkSPHRanksBox = std::array<double, 6>;

/** Work at a place, to be divided evenly: a particle, or a point to evaluate. */
struct vtkSPHRanksPlace
{
  double At[3]; ///< in the first period
  std::int64_t Work;
  vtkIdType Particle = -1; ///< number of the particle; -1: the work is for a point
  double Reach = 0.0;      ///< reach of the particle, without the least margin
};

/**
 * The space of a run: the part of one period that lies in the run's box. Share() divides the space
 * among ranks by a k-d tree over samples of the work; bricks of 4 x 4 x 4 cubes are not cut. All ranks
 * have the same samples, and so the same tree.
 */
class vtkSPHRanksSpace
{
public:
  vtkSPHRanksSpace() = default;
  /** Keeps pointers to both arguments, for Share() and Divide(). globals: measured over all ranks' particles. */
  vtkSPHRanksSpace(const mcor_options& options, const mcor_globals& globals);

  double First[3] = { 0.0, 0.0, 0.0 }; ///< where the first period begins
  double Length[3] = { 0.0, 0.0, 0.0 }; ///< lengths of the periods; 0: open
  bool IsPeriodic(int axis) const { return this->Length[axis] > 0.0; }

  /** Moves a place into the first period, which begins at a node of the lattice. */
  void Enter(double at[3]) const;

  /**
   * Divides the work evenly. input: this rank's particles. work: the work of each particle, or 0 if
   * no rank needs the particle. places: further work of this rank. parts: how many ranks get a box.
   * Returns, for each rank, the particles that the rank needs: particles whose supports, or images of
   * supports, reach the rank's box, and particles that may be their neighbours. Collective.
   */
  vtkSPHRanksLists Share(vtkSPHRanks& ranks, const mcor_input& input,
    const std::vector<std::int64_t>& work, std::vector<vtkSPHRanksPlace> places, int parts);

  /** Divides the work at these places among the boxes of the first `parts` ranks. Without a cube size
   * in the globals, there are no bricks, and cuts may lie anywhere. Collective. */
  void Divide(vtkSPHRanks& ranks, const std::vector<vtkSPHRanksPlace>& places, int parts);

  /**
   * Finds the ranks whose boxes, or images of boxes, are reached by a cube around a place in the
   * first period. radius: half of the cube's edge.
   */
  void FindReached(const double at[3], double radius, std::vector<int>& found) const;

  bool IsShared() const { return !this->Boxes.empty(); }

  /** Returns a rank's box in the form of mcor_options; it may hold nothing. */
  vtkSPHRanksBox GetBox(int rank) const;

  /** Returns the rank whose box holds a place, or an image of the place. */
  int FindOwner(const double at[3]) const;

  /** Lists, for each rank, the points of this rank that lie in the listed rank's box. */
  vtkSPHRanksLists ListOwners(vtkDataSet* points) const;

  vtkSPHRanksBox Whole = {};       ///< holds all ranks' boxes
  std::int64_t OwnedParticles = 0; ///< number of all ranks' particles with work in this rank's box
  std::int64_t Particles = 0;      ///< number of particles that this rank gets, owned or not
  std::int64_t Work = 0;           ///< work of the particles in this rank's box

private:
  using Samples = std::vector<vtkSPHRanksPlace>::iterator;

  double ReachOf(const mcor_input& input, std::int64_t i) const;
  bool Holds(const double at[3]) const;
  void Cut(Samples begin, Samples end, int first, int count, const vtkSPHRanksBox& box);
  std::vector<double> FindRadii(
    vtkSPHRanks& ranks, const mcor_input& input, const std::vector<vtkSPHRanksPlace>& places) const;
  /**
   * Whether a cube around a place, or around an image of the place, reaches the box that the k-d
   * tree divides among the `count` ranks from `rank` on.
   */
  bool Reaches(int rank, int count, const double at[3], double radius) const;
  /** Of the `count` ranks from `rank` on, adds to `found` each rank whose box is reached by a cube around
   * `at`, or around an image of `at`. radius: half of the cube's edge. */
  void AddReached(
    int rank, int count, const double at[3], double radius, std::vector<int>& found) const;

  const mcor_options* Options = nullptr;
  const mcor_globals* Globals = nullptr;
  double Margin = 0.0; ///< a box may need a particle whose support misses the box by less
  std::vector<vtkSPHRanksBox> Boxes; ///< by rank
};

/**
 * Returns the work of each of this rank's particles: 1, or 0 if the surface does not depend on the
 * particle (a solid, if solids are not used). If a surface is expected near the particle, a share of
 * the surface's cost is added. A surface is expected in a cell of a coarse grid if values in or
 * around the cell are on both sides of an iso value, or, for a free surface, if a cell beside it
 * has far fewer particles. The number of cells does not grow with the particles. The result is the
 * same to the last bit however particles are spread over ranks. Collective.
 */
std::vector<std::int64_t> vtkSPHExpectWork(vtkSPHRanks& ranks, const mcor_input& input,
  const mcor_options& options, const mcor_globals& globals);
VTK_ABI_NAMESPACE_END

#endif
