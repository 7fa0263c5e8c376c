// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: the pieces of a triangle mesh, and what they measure.
 */
#ifndef vtkSPHPieces_h
#define vtkSPHPieces_h

#include "vtkType.h"

#include <array>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkPolyData;

/** One piece. Lengths have the unit of the positions. */
struct vtkSPHPiece
{
  vtkIdType Parent = -1; ///< of a cavity: the piece around it; -1: none
  bool Closed = false;   ///< each edge has a triangle on either side
  bool Endless = false;  ///< closed by going around a period, so that it has no volume
  double Area = 0.0;
  double Volume = 0.0; ///< of a closed one; below 0 of a cavity
  double Centre[3] = { 0.0, 0.0, 0.0 };
  double Bounds[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
  vtkIdType FirstTriangle = 0;

  bool HasVolume() const { return this->Closed && !this->Endless; }
};

/**
 * Triangles that share points are one piece, also across the sides of a period (bounds, 0 0 where there is
 * none): points there have the same other coordinates, to the last bit. A surface ends at planes of its lattice, up
 * to a cube from these bounds and a period from each other: where it passes them, its own bounds are these sides.
 * Pieces are in the order of their areas, the largest first. Each is where its centre is within the period.
 */
class vtkSPHPieces
{
public:
  vtkSPHPieces(vtkPolyData* mesh, const double period[6]);

  std::vector<vtkSPHPiece> Pieces;
  std::vector<vtkIdType> PieceOfTriangle;
  std::vector<vtkIdType> PieceOfPoint; ///< -1: no triangle uses it

  /**
   * For each point the innermost piece with a volume that encloses it: -1 if that is a cavity or there is none.
   * `without`: of each point, a piece that is as if it were not there; may be empty.
   */
  std::vector<vtkIdType> FindEnclosing(const std::vector<std::array<double, 3>>& points,
    const std::vector<vtkIdType>& without = {}) const;

private:
  using Shift = std::array<int, 3>; // in periods
  void ReadTriangles(vtkPolyData* mesh);
  void JoinPoints();
  void JoinSides();
  void JoinParts(
    vtkIdType lower, vtkIdType upper, int axis, std::vector<std::vector<vtkIdType>>& members);
  void NumberPieces();
  void Measure();
  void FindClosed();
  void MoveHome();
  void FindParents();
  std::vector<std::array<double, 3>> ListShifts(bool hasVolume) const;
  std::vector<vtkIdType> FindAround(const std::vector<std::array<double, 3>>& points) const;
  vtkIdType RootOf(vtkIdType point);
  Shift ShiftOf(vtkIdType point) const;
  void CornersOf(vtkIdType triangle, double corners[3][3]) const;

  double Period[6];
  std::vector<std::array<double, 3>> Points;
  std::vector<std::array<vtkIdType, 3>> Triangles;
  std::vector<vtkIdType> Root; // of points: union by shared triangles; shrinks to one for each part
  std::vector<vtkIdType> Twin; // the point that stands for all that are a period apart
  std::vector<vtkIdType> Group;  // of parts, by their roots: joined across sides
  std::vector<Shift> GroupShift; // of a part: from it to its group's first part
  std::vector<char> GroupEndless;
};
VTK_ABI_NAMESPACE_END

#endif
