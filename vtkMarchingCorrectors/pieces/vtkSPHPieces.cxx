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

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Triple = std::array<double, 3>;

/** How far rounding may have moved a point off its side, as a share of the period. */
constexpr double SideTolerance = 1e-5;
}

// The root of each part is its lowest point, in any order of joining.
vtkSPHPieces::vtkSPHPieces(vtkPolyData* mesh, vtkDataArray* isoValues, const double period[6])
  : Points(mesh->GetNumberOfPoints())
  , Root(this->Points.size())
{
  std::copy_n(period, 6, this->Period);
  std::iota(this->Root.begin(), this->Root.end(), vtkIdType(0));
  for (size_t i = 0; i < this->Points.size(); ++i)
  {
    mesh->GetPoint(static_cast<vtkIdType>(i), this->Points[i].data());
  }
  const auto rootOf = [this](vtkIdType point)
  {
    while (this->Root[point] != point)
    {
      point = this->Root[point] = this->Root[this->Root[point]];
    }
    return point;
  };
  auto cells = vtk::TakeSmartPointer(mesh->GetPolys()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell())
  {
    vtkIdType count;
    const vtkIdType* corners;
    cells->GetCurrentCell(count, corners);
    this->Triangles.push_back({ { corners[0], corners[1], corners[2] } });
    for (int i = 1; i < 3; ++i)
    {
      const vtkIdType a = rootOf(corners[0]), b = rootOf(corners[i]);
      this->Root[std::max(a, b)] = std::min(a, b);
    }
  }
  for (vtkIdType& root : this->Root)
  {
    root = rootOf(root);
  }
  vtkDataArray* caps = mesh->GetFieldData()->GetArray("Capping"); // of vtkMarchingCorrectors
  this->JoinSides(caps && caps->GetComponent(0, 0) != 0.0);
  this->NumberPieces();
  this->FindClosed();
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

// Lists the edges that triangles do not pass equally often in both directions: for each, a triangle
// and the corner of it where the edge begins. Points with the same number in `of` are one.
std::vector<std::array<vtkIdType, 2>> vtkSPHPieces::ListOpenEdges(
  const std::vector<vtkIdType>& of) const
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
  std::vector<std::array<vtkIdType, 2>> open;
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
      open.push_back({ { edges[i][3], edges[i][4] } });
    }
  }
  return open;
}

// At open edges in a side, the surface goes on beyond the side, unless a cap was trimmed there.
// Points of such edges on opposite sides are matched by their other two coordinates. Parts that meet
// at sides form a group, in which each part has a shift, a number of periods. If two ways to one
// part give different shifts, the group goes around the period.
void vtkSPHPieces::JoinSides(bool hasCaps)
{
  const size_t count = this->Points.size();
  this->Twin.resize(count);
  std::iota(this->Twin.begin(), this->Twin.end(), vtkIdType(0));
  this->Group = this->Root;
  this->GroupShift.assign(count, Shift{ { 0, 0, 0 } });
  this->GroupEndless.assign(count, 0);
  std::vector<std::vector<vtkIdType>> members(count); // parts of each group, by its first part
  bool isPeriodic = false;
  for (int a = 0; a < 3; ++a)
  {
    isPeriodic = isPeriodic || this->Period[2 * a + 1] > this->Period[2 * a];
  }
  const std::vector<std::array<vtkIdType, 2>> open = isPeriodic && !hasCaps
    ? this->ListOpenEdges(this->Twin)
    : std::vector<std::array<vtkIdType, 2>>();
  for (int a = 0; a < 3; ++a)
  {
    const double period = this->Period[2 * a + 1] - this->Period[2 * a];
    const double tolerance = SideTolerance * period;
    double low = VTK_DOUBLE_MAX, high = -VTK_DOUBLE_MAX; // range of the points that triangles use
    for (const auto& triangle : this->Triangles)
    {
      for (const vtkIdType point : triangle)
      {
        low = std::min(low, this->Points[point][a]);
        high = std::max(high, this->Points[point][a]);
      }
    }
    if (!(period > 0.0) || !(std::abs(high - low - period) <= tolerance))
    {
      continue;
    }
    const auto listEnds = [&](double side)
    {
      const auto isOn = [&](vtkIdType point)
      { return std::abs(this->Points[point][a] - side) <= tolerance; };
      std::set<vtkIdType> ends;
      for (const auto& edge : open)
      {
        const auto& corners = this->Triangles[edge[0]];
        const vtkIdType from = corners[edge[1]], to = corners[(edge[1] + 1) % 3];
        if (isOn(from) && isOn(to))
        {
          ends.insert({ from, to });
        }
      }
      return ends;
    };
    std::map<std::pair<double, double>, vtkIdType> lower;
    const auto key = [&](vtkIdType i)
    { return std::make_pair(this->Points[i][(a + 1) % 3], this->Points[i][(a + 2) % 3]); };
    for (const vtkIdType i : listEnds(low))
    {
      lower.emplace(key(i), i);
    }
    for (const vtkIdType i : listEnds(high))
    {
      const auto found = lower.find(key(i));
      if (found == lower.end())
      {
        continue;
      }
      const vtkIdType twin = found->second;
      this->Twin[i] = this->Twin[twin];
      // The part at the lower side, moved up by a period, continues the part at the upper side.
      this->JoinParts(this->Root[twin], this->Root[i], a, members);
    }
  }
}

// Joins the groups of two parts; the part `lower` moves up by a period along this axis.
void vtkSPHPieces::JoinParts(
  vtkIdType lower, vtkIdType upper, int axis, std::vector<std::vector<vtkIdType>>& members)
{
  Shift shift = this->GroupShift[upper];
  shift[axis] += 1;
  for (int c = 0; c < 3; ++c)
  {
    shift[c] -= this->GroupShift[lower][c];
  }
  const vtkIdType old = this->Group[lower], kept = this->Group[upper];
  if (old == kept)
  {
    this->GroupEndless[kept] |= shift != Shift{ { 0, 0, 0 } };
    return;
  }
  members[old].push_back(old);
  for (const vtkIdType part : members[old])
  {
    this->Group[part] = kept;
    for (int c = 0; c < 3; ++c)
    {
      this->GroupShift[part][c] += shift[c];
    }
  }
  members[kept].insert(members[kept].end(), members[old].begin(), members[old].end());
  members[old].clear();
  this->GroupEndless[kept] |= this->GroupEndless[old];
}

// Returns a triangle's corners at the place where its piece is not cut by the period's sides.
void vtkSPHPieces::CornersOf(vtkIdType triangle, double corners[3][3]) const
{
  const auto& points = this->Triangles[triangle];
  const vtkIdType root = this->Root[points[0]];
  const Shift& shift = this->GroupShift[root];
  for (int i = 0; i < 3; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      corners[i][a] =
        this->Points[points[i]][a] + shift[a] * (this->Period[2 * a + 1] - this->Period[2 * a]);
    }
  }
}

// Sorts by area; among equal areas the piece with the first triangle comes first.
void vtkSPHPieces::NumberPieces()
{
  std::map<vtkIdType, vtkIdType> numbers; // by group
  std::vector<vtkSPHPiece> found;
  std::vector<vtkIdType> of(this->Triangles.size());
  for (size_t t = 0; t < this->Triangles.size(); ++t)
  {
    const vtkIdType group = this->Group[this->Root[this->Triangles[t][0]]];
    const auto at = numbers.emplace(group, static_cast<vtkIdType>(found.size()));
    if (at.second)
    {
      vtkSPHPiece piece;
      piece.FirstTriangle = static_cast<vtkIdType>(t);
      piece.Endless = this->GroupEndless[group] != 0;
      found.push_back(piece);
    }
    of[t] = at.first->second;
    double c[3][3], u[3], v[3], n[3];
    this->CornersOf(static_cast<vtkIdType>(t), c);
    vtkMath::Subtract(c[1], c[0], u);
    vtkMath::Subtract(c[2], c[0], v);
    vtkMath::Cross(u, v, n);
    found[of[t]].Area += 0.5 * vtkMath::Norm(n);
  }
  std::vector<size_t> order(found.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::stable_sort(
    order.begin(), order.end(), [&](size_t a, size_t b) { return found[a].Area > found[b].Area; });
  std::vector<vtkIdType> place(found.size());
  for (size_t i = 0; i < order.size(); ++i)
  {
    place[order[i]] = static_cast<vtkIdType>(i);
    this->Pieces.push_back(found[order[i]]);
  }
  this->PieceOfTriangle.resize(of.size());
  this->PieceOfPoint.assign(this->Points.size(), -1);
  for (size_t t = 0; t < of.size(); ++t)
  {
    this->PieceOfTriangle[t] = place[of[t]];
    for (const vtkIdType point : this->Triangles[t])
    {
      this->PieceOfPoint[point] = this->PieceOfTriangle[t];
    }
  }
}

// A piece is closed if its triangles pass each edge equally often in both directions.
void vtkSPHPieces::FindClosed()
{
  for (const auto& edge : this->ListOpenEdges(this->Twin))
  {
    this->Pieces[this->PieceOfTriangle[edge[0]]].Closed = false;
  }
}

// Measures relative to the middle of the bounds, because coordinates may be large. The centre is
// the volume's centre; without a volume, the area's.
void vtkSPHPieces::Measure()
{
  std::vector<Triple> byArea(this->Pieces.size()), byVolume(this->Pieces.size());
  const auto count = static_cast<vtkIdType>(this->Triangles.size());
  double c[3][3];
  for (vtkIdType t = 0; t < count; ++t)
  {
    vtkSPHPiece& piece = this->Pieces[this->PieceOfTriangle[t]];
    this->CornersOf(t, c);
    for (int i = 0; i < 9; ++i)
    {
      piece.Bounds[2 * (i % 3)] = std::min(piece.Bounds[2 * (i % 3)], c[i / 3][i % 3]);
      piece.Bounds[2 * (i % 3) + 1] = std::max(piece.Bounds[2 * (i % 3) + 1], c[i / 3][i % 3]);
    }
  }
  for (vtkIdType t = 0; t < count; ++t)
  {
    const vtkIdType number = this->PieceOfTriangle[t];
    vtkSPHPiece& piece = this->Pieces[number];
    double u[3], v[3], n[3];
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

// Moves each piece so that its centre is within the period, wherever the lattice's sides are. A
// centre on a side, up to rounding, belongs to the lower side.
void vtkSPHPieces::MoveHome()
{
  std::vector<Shift> moves(this->Pieces.size());
  for (size_t i = 0; i < this->Pieces.size(); ++i)
  {
    vtkSPHPiece& piece = this->Pieces[i];
    for (int a = 0; a < 3; ++a)
    {
      const double low = this->Period[2 * a], period = this->Period[2 * a + 1] - low;
      const double away =
        period > 0.0 ? std::floor((piece.Centre[a] - low) / period + SideTolerance) : 0.0;
      moves[i][a] = static_cast<int>(-away);
      piece.Centre[a] -= away * period;
      piece.Bounds[2 * a] -= away * period;
      piece.Bounds[2 * a + 1] -= away * period;
    }
  }
  for (size_t i = 0; i < this->Points.size(); ++i)
  {
    if (this->PieceOfPoint[i] >= 0 && this->Root[i] == static_cast<vtkIdType>(i))
    {
      for (int a = 0; a < 3; ++a)
      {
        this->GroupShift[i][a] += moves[this->PieceOfPoint[i]][a];
      }
    }
  }
}

// A piece without a volume, such as a layer over the whole period, is the parent of cavities in it.
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
