// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: the connected pieces of a triangle mesh, and their measures. */
#ifndef vtkSPHPieces_h
#define vtkSPHPieces_h

#include "vtkType.h"

#include <array>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkDataArray;
class vtkPolyData;

/** One piece. Lengths are in the unit of the positions. */
struct vtkSPHPiece
{
  vtkIdType Parent = -1; ///< of a cavity: the piece around it; else -1
  bool Closed = true;    ///< each edge has a triangle on both sides
  bool Endless = false;  ///< closed only around a period, so that it has no volume
  double Iso = 0.0;      ///< the iso value of its points
  double Area = 0.0;
  double Volume = 0.0; ///< only of a closed piece; negative for a cavity
  double Centre[3] = { 0.0, 0.0, 0.0 };
  double Bounds[6] = { VTK_DOUBLE_MAX, VTK_DOUBLE_MIN, VTK_DOUBLE_MAX, VTK_DOUBLE_MIN,
    VTK_DOUBLE_MAX, VTK_DOUBLE_MIN };
  vtkIdType FirstTriangle = 0;

  bool HasVolume() const { return this->Closed && !this->Endless; }
};

/**
 * Finds the pieces of a surface. Triangles that share points belong to one piece. `period` has a
 * low and a high bound for each axis; 0 0: no period along this axis. A surface that goes on beyond
 * the period is cut at planes of the lattice, up to a cube away from the bounds. Triangles at
 * opposite cuts belong to one piece, too, if they have points whose coordinates along the cut are
 * the same, to the last bit. A piece with a cap at a cut ends at this cut. Pieces are sorted by
 * area, the largest first. Each piece is placed so that its centre is within the period. Surfaces
 * of several iso values are nested. Each piece encloses particles, and cavities of its own iso
 * value, as if there were no other iso values.
 */
class vtkSPHPieces
{
public:
  /** isoValues: the iso value of each point; null: there is only one. */
  vtkSPHPieces(vtkPolyData* mesh, vtkDataArray* isoValues, const double period[6]);

  std::vector<vtkSPHPiece> Pieces;
  std::vector<double> IsoValues; ///< iso values of all pieces, ascending, each once
  std::vector<vtkIdType> PieceOfTriangle;
  std::vector<vtkIdType> PieceOfPoint; ///< -1: no triangle uses the point

  /**
   * Finds, for each point, the innermost of the pieces around it that have this iso value and a
   * volume. -1: there is no such piece, or the innermost one is a cavity. without: for each point a
   * piece to ignore; may be empty.
   */
  std::vector<vtkIdType> FindEnclosing(const std::vector<std::array<double, 3>>& points,
    double isoValue, const std::vector<vtkIdType>& without = {}) const;

  struct Face
  {
    double Corner[3][3];
    vtkIdType Piece;
  };

private:
  using Shift = std::array<int, 3>;      // in periods
  using Edge = std::array<vtkIdType, 3>; // a triangle, and the points of one of its edges
  double PeriodOf(double at, int axis, double tolerance = 0.0) const;
  std::vector<Edge> ListOpenEdges(const std::vector<vtkIdType>& of) const;
  vtkIdType FindRoot(vtkIdType point);
  void Join(vtkIdType one, vtkIdType other, int axis);
  void JoinSides(const double bounds[6], std::vector<vtkIdType>& twins);
  void NumberPieces();
  void Measure();
  void MoveHome();
  void FindParents(double isoValue);
  std::vector<std::array<double, 3>> ListShifts(bool hasVolume) const;
  std::array<double, 3> ImageOf(
    const std::array<double, 3>& point, std::array<double, 3> shift) const;
  std::vector<Face> ListFaces(bool hasVolume, double isoValue) const;
  std::vector<vtkIdType> FindAround(
    const std::vector<std::array<double, 3>>& points, double isoValue) const;
  void CornersOf(vtkIdType triangle, double corners[3][3]) const;

  double Low[3], Length[3]; // where the period begins, and its lengths; 0: no period
  std::vector<std::array<double, 3>> Points;
  std::vector<std::array<vtkIdType, 3>> Triangles;
  std::vector<vtkIdType> Root; // the next point on the way to the point that stands for the piece
  std::vector<Shift> Shifts;   // moves a point's part of the piece to its root's part
  std::vector<char> Endless;   // by root: whether the piece goes around a period
};
VTK_ABI_NAMESPACE_END

#endif
