// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: divides space among ranks by a k-d tree over samples of the particles,
 * with cuts between the lattice's bricks. All ranks have the same samples, and so the same tree.
 */
#ifndef vtkSPHRanksPartition_h
#define vtkSPHRanksPartition_h

#include "vtkType.h" // for VTK's namespace

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkSPHRanks;

/** Low and high sides of x, y, z. The low sides belong to the box, the high ones do not. */
using vtkSPHRanksBox = std::array<double, 6>;

struct vtkSPHRanksPlace
{
  double At[3]; ///< within the whole
  std::int64_t Work;
};

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
VTK_ABI_NAMESPACE_END

#endif
