// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHPieces.h"

#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkMath.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Triple = std::array<double, 3>;

/** How far rounding may have moved a point away from a side of the period, as a share of the period. */
constexpr double SideTolerance = 1e-5;
}

vtkSPHPieces::vtkSPHPieces(vtkPolyData* mesh, vtkDataArray* isoValues, const double period[6])
  : Points(mesh->GetNumberOfPoints())
  , Root(this->Points.size())
  , Shifts(this->Points.size(), Shift{ { 0, 0, 0 } })
  , Endless(this->Points.size(), 0)
{
  for (int a = 0; a < 3; ++a)
  {
    this->Low[a] = period[2 * a];
    this->Length[a] = std::max(0.0, period[2 * a + 1] - period[2 * a]);
  }
  std::iota(this->Root.begin(), this->Root.end(), vtkIdType(0));
  for (size_t i = 0; i < this->Points.size(); ++i)
  {
    mesh->GetPoint(static_cast<vtkIdType>(i), this->Points[i].data());
  }
  auto cells = vtk::TakeSmartPointer(mesh->GetPolys()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell())
  {
    vtkIdType count;
    const vtkIdType* corners;
    cells->GetCurrentCell(count, corners);
    this->Triangles.push_back({ { corners[0], corners[1], corners[2] } });
    this->Join(corners[1], corners[0], -1);
    this->Join(corners[2], corners[0], -1);
  }
  vtkDataArray* caps = mesh->GetFieldData()->GetArray("Capping"); // of vtkMarchingCorrectors
  std::vector<vtkIdType> twins(this->Points.size());
  std::iota(twins.begin(), twins.end(), vtkIdType(0));
  if (!caps || caps->GetComponent(0, 0) == 0.0)
  {
    double bounds[6];
    mesh->GetCellsBounds(bounds);
    this->JoinSides(bounds, twins);
  }
  for (size_t i = 0; i < this->Points.size(); ++i)
  {
    this->FindRoot(static_cast<vtkIdType>(i));
  }
  this->NumberPieces();
  // A piece is closed if its triangles pass each edge equally often in both directions.
  for (const Edge& edge : this->ListOpenEdges(twins))
  {
    this->Pieces[this->PieceOfTriangle[edge[0]]].Closed = false;
  }
  this->Measure();
  this->MoveHome();
  for (vtkSPHPiece& piece : this->Pieces)
  {
    const vtkIdType point = this->Triangles[piece.FirstTriangle][0];
    piece.Iso = isoValues ? isoValues->GetComponent(point, 0) : 0.0;
    this->IsoValues.push_back(piece.Iso);
  }
  std::sort(this->IsoValues.begin(), this->IsoValues.end());
  this->IsoValues.erase(
    std::unique(this->IsoValues.begin(), this->IsoValues.end()), this->IsoValues.end());
  for (const double isoValue : this->IsoValues)
  {
    this->FindParents(isoValue);
  }
}

// A piece's root is the point that stands for the whole piece. Returns the root of the piece of
// `point`, and stores it in Root[point].
vtkIdType vtkSPHPieces::FindRoot(vtkIdType point)
{
  const auto passOver = [this](vtkIdType one) // leaves the next point out of the way to the root
  {
    const vtkIdType next = this->Root[one];
    for (int a = 0; a < 3; ++a)
    {
      this->Shifts[one][a] += this->Shifts[next][a];
    }
    this->Root[one] = this->Root[next];
  };
  for (vtkIdType one = point; this->Root[one] != one; one = this->Root[one])
  {
    passOver(one); // later ways through these points are then shorter, too
  }
  while (this->Root[this->Root[point]] != this->Root[point])
  {
    passOver(point);
  }
  return this->Root[point];
}

// Joins the pieces of two points. The piece of `one` moves up by a period along this axis; it does
// not move if the axis is -1. If two paths through a piece lead to one point with different
// shifts, the piece goes around the period.
void vtkSPHPieces::Join(vtkIdType one, vtkIdType other, int axis)
{
  const vtkIdType old = this->FindRoot(one), kept = this->FindRoot(other);
  Shift shift;
  for (int a = 0; a < 3; ++a)
  {
    shift[a] = this->Shifts[other][a] - this->Shifts[one][a] + (a == axis ? 1 : 0);
  }
  if (old != kept)
  {
    this->Root[old] = kept;
    this->Shifts[old] = shift;
    this->Endless[kept] |= this->Endless[old];
  }
  else if (shift != Shift{ { 0, 0, 0 } })
  {
    this->Endless[kept] = 1;
  }
}

// Lists the edges that triangles do not pass equally often in both directions. Points with the same
// number in `of` count as one point.
std::vector<vtkSPHPieces::Edge> vtkSPHPieces::ListOpenEdges(const std::vector<vtkIdType>& of) const
{
  std::vector<std::array<vtkIdType, 5>> edges; // lower and higher point, way, triangle, corner
  edges.reserve(3 * this->Triangles.size());
  for (size_t t = 0; t < this->Triangles.size(); ++t)
  {
    for (vtkIdType i = 0; i < 3; ++i)
    {
      const vtkIdType a = of[this->Triangles[t][i]], b = of[this->Triangles[t][(i + 1) % 3]];
      edges.push_back(
        { { std::min(a, b), std::max(a, b), a < b ? 1 : -1, static_cast<vtkIdType>(t), i } });
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<Edge> open;
  for (size_t i = 0, next; i < edges.size(); i = next)
  {
    vtkIdType balance = 0;
    for (next = i; next < edges.size() && std::equal(&edges[i][0], &edges[i][2], &edges[next][0]);
         ++next)
    {
      balance += edges[next][2];
    }
    if (balance != 0)
    {
      const auto& corners = this->Triangles[edges[i][3]];
      open.push_back({ { edges[i][3], corners[edges[i][4]], corners[(edges[i][4] + 1) % 3] } });
    }
  }
  return open;
}

// Joins pieces across the period's sides. At an open edge in a side, the surface goes on beyond the
// side, or a cap was trimmed. Points of open edges on opposite sides match if
// their other two coordinates are equal. Two matching points get one number in `twins`. bounds: the
// bounds of the points that triangles use.
void vtkSPHPieces::JoinSides(const double bounds[6], std::vector<vtkIdType>& twins)
{
  std::vector<Edge> open;
  for (int a = 0; a < 3; ++a)
  {
    const double tolerance = SideTolerance * this->Length[a];
    const double low = bounds[2 * a], high = bounds[2 * a + 1];
    if (this->Length[a] == 0.0 || !(std::abs(high - low - this->Length[a]) <= tolerance))
    {
      continue;
    }
    open = open.empty() ? this->ListOpenEdges(twins) : open; // no points are twins yet
    const auto listEnds = [&](double side)
    {
      const auto isThere = [&](vtkIdType point)
      { return std::abs(this->Points[point][a] - side) <= tolerance; };
      std::set<vtkIdType> ends;
      for (const Edge& edge : open)
      {
        if (isThere(edge[1]) && isThere(edge[2]))
        {
          ends.insert({ edge[1], edge[2] });
        }
      }
      return ends;
    };
    const auto keyOf = [&](vtkIdType point)
    { return std::make_pair(this->Points[point][(a + 1) % 3], this->Points[point][(a + 2) % 3]); };
    std::map<std::pair<double, double>, vtkIdType> lower;
    for (const vtkIdType point : listEnds(low))
    {
      lower.emplace(keyOf(point), point);
    }
    for (const vtkIdType point : listEnds(high))
    {
      const auto found = lower.find(keyOf(point));
      if (found != lower.end())
      {
        twins[point] = twins[found->second];
        this->Join(found->second, point, a);
      }
    }
  }
}

// Returns how many periods a coordinate lies above the given period; 0 if there is no period.
double vtkSPHPieces::PeriodOf(double at, int axis, double tolerance) const
{
  const double length = this->Length[axis];
  return length > 0.0 ? std::floor((at - this->Low[axis]) / length + tolerance) : 0.0;
}

// Writes a triangle's corners, moved by whole periods to where the triangle's piece is not cut by the period's sides.
void vtkSPHPieces::CornersOf(vtkIdType triangle, double corners[3][3]) const
{
  const auto& points = this->Triangles[triangle];
  const Shift& shift = this->Shifts[points[0]];
  for (int i = 0; i < 3; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      corners[i][a] = this->Points[points[i]][a] + shift[a] * this->Length[a];
    }
  }
}

// Numbers the pieces by area, the largest first; among equal areas, by their first triangles.
void vtkSPHPieces::NumberPieces()
{
  std::map<vtkIdType, vtkIdType> numbers; // by root
  for (size_t t = 0; t < this->Triangles.size(); ++t)
  {
    const vtkIdType root = this->Root[this->Triangles[t][0]];
    const auto at = numbers.emplace(root, static_cast<vtkIdType>(this->Pieces.size()));
    if (at.second)
    {
      this->Pieces.emplace_back();
      this->Pieces.back().FirstTriangle = static_cast<vtkIdType>(t);
      this->Pieces.back().Endless = this->Endless[root] != 0;
    }
    vtkSPHPiece& piece = this->Pieces[at.first->second];
    double c[3][3], u[3], v[3], n[3];
    this->CornersOf(static_cast<vtkIdType>(t), c);
    for (int i = 0; i < 9; ++i)
    {
      piece.Bounds[2 * (i % 3)] = std::min(piece.Bounds[2 * (i % 3)], c[i / 3][i % 3]);
      piece.Bounds[2 * (i % 3) + 1] = std::max(piece.Bounds[2 * (i % 3) + 1], c[i / 3][i % 3]);
    }
    vtkMath::Subtract(c[1], c[0], u);
    vtkMath::Subtract(c[2], c[0], v);
    vtkMath::Cross(u, v, n);
    piece.Area += 0.5 * vtkMath::Norm(n);
  }
  std::sort(this->Pieces.begin(), this->Pieces.end(),
    [](const vtkSPHPiece& p, const vtkSPHPiece& q)
    { return p.Area > q.Area || (p.Area == q.Area && p.FirstTriangle < q.FirstTriangle); });
  for (size_t i = 0; i < this->Pieces.size(); ++i)
  {
    const vtkIdType point = this->Triangles[this->Pieces[i].FirstTriangle][0];
    numbers[this->Root[point]] = static_cast<vtkIdType>(i);
  }
  this->PieceOfPoint.assign(this->Points.size(), -1);
  for (const auto& triangle : this->Triangles)
  {
    this->PieceOfTriangle.push_back(numbers[this->Root[triangle[0]]]);
    for (const vtkIdType point : triangle)
    {
      this->PieceOfPoint[point] = this->PieceOfTriangle.back();
    }
  }
}

// Measures each piece's volume and centre, relative to the middle of the piece's bounds, because
// coordinates may be large. The centre is the volume's centre; without a volume, the area's centre.
void vtkSPHPieces::Measure()
{
  std::vector<Triple> byArea(this->Pieces.size()), byVolume(this->Pieces.size());
  const auto count = static_cast<vtkIdType>(this->Triangles.size());
  for (vtkIdType t = 0; t < count; ++t)
  {
    const vtkIdType number = this->PieceOfTriangle[t];
    vtkSPHPiece& piece = this->Pieces[number];
    double c[3][3], u[3], v[3], n[3];
    this->CornersOf(t, c);
    for (int i = 0; i < 9; ++i)
    {
      c[i / 3][i % 3] -= 0.5 * (piece.Bounds[2 * (i % 3)] + piece.Bounds[2 * (i % 3) + 1]);
    }
    vtkMath::Subtract(c[1], c[0], u);
    vtkMath::Subtract(c[2], c[0], v);
    vtkMath::Cross(u, v, n);
    const double area = 0.5 * vtkMath::Norm(n), volume = vtkMath::Dot(c[0], n) / 6.0;
    piece.Volume += volume;
    for (int a = 0; a < 3; ++a)
    {
      const double sum = c[0][a] + c[1][a] + c[2][a];
      byArea[number][a] += area * sum / 3.0;
      byVolume[number][a] += volume * sum / 4.0;
    }
  }
  for (size_t i = 0; i < this->Pieces.size(); ++i)
  {
    vtkSPHPiece& piece = this->Pieces[i];
    const bool solid = piece.HasVolume() && piece.Volume != 0.0;
    const double whole = solid ? piece.Volume : piece.Area > 0.0 ? piece.Area : 1.0;
    for (int a = 0; a < 3; ++a)
    {
      piece.Centre[a] = 0.5 * (piece.Bounds[2 * a] + piece.Bounds[2 * a + 1]) +
        (solid ? byVolume : byArea)[i][a] / whole;
    }
  }
}

// Moves each piece so that its centre is within the period. A centre on the period's upper side, up
// to rounding, moves to the lower side.
void vtkSPHPieces::MoveHome()
{
  std::vector<Shift> moves(this->Pieces.size());
  for (size_t i = 0; i < this->Pieces.size(); ++i)
  {
    vtkSPHPiece& piece = this->Pieces[i];
    for (int a = 0; a < 3; ++a)
    {
      const double away = this->PeriodOf(piece.Centre[a], a, SideTolerance);
      moves[i][a] = static_cast<int>(-away);
      piece.Centre[a] -= away * this->Length[a];
      piece.Bounds[2 * a] -= away * this->Length[a];
      piece.Bounds[2 * a + 1] -= away * this->Length[a];
    }
  }
  for (size_t i = 0; i < this->Points.size(); ++i)
  {
    for (int a = 0; a < 3 && this->PieceOfPoint[i] >= 0; ++a)
    {
      this->Shifts[i][a] += moves[this->PieceOfPoint[i]][a];
    }
  }
}

// Finds the parent of each cavity: the piece that encloses the cavity. The parent may also be a piece
// without a volume, such as a layer over the whole period.
void vtkSPHPieces::FindParents(double isoValue)
{
  std::vector<Triple> places;
  std::vector<vtkIdType> cavities;
  for (size_t i = 0; i < this->Pieces.size(); ++i)
  {
    const vtkSPHPiece& piece = this->Pieces[i];
    if (piece.Iso == isoValue && piece.HasVolume() && piece.Volume < 0.0)
    {
      double c[3][3];
      this->CornersOf(piece.FirstTriangle, c);
      places.push_back({ { c[0][0], c[0][1], c[0][2] } });
      cavities.push_back(static_cast<vtkIdType>(i));
    }
  }
  const std::vector<vtkIdType> within = this->FindEnclosing(places, isoValue, cavities);
  const bool isAll = std::count(within.begin(), within.end(), -1) == 0;
  const std::vector<vtkIdType> around = isAll ? within : this->FindAround(places, isoValue);
  for (size_t i = 0; i < cavities.size(); ++i)
  {
    this->Pieces[cavities[i]].Parent = within[i] >= 0 ? within[i] : around[i];
  }
}
VTK_ABI_NAMESPACE_END
