// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Finds which piece encloses a point: a ray along x leaves an enclosing piece once more than it
// enters the piece (a cavity: once less). Triangles are listed in columns along x, and a ray tests
// the triangles of its column.
#include "vtkSPHPieces.h"

#include "vtkSMPTools.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Triple = std::array<double, 3>;
using Face = vtkSPHPieces::Face;

/**
 * Seen along x: whether `y` lies between the y of `a` and the y of `b`, and the point (y, z) lies
 * below the edge from `a` to `b`. The result is the same if `a` and `b` change places, so no ray
 * along x slips between two triangles that share the edge.
 */
bool IsBelow(const double* a, const double* b, double y, double z)
{
  if ((a[1] > y) == (b[1] > y))
  {
    return false;
  }
  const double *first = a, *second = b;
  if (std::lexicographical_compare(b, b + 3, a, a + 3))
  {
    std::swap(first, second);
  }
  return z < first[2] + (y - first[1]) * ((second[2] - first[2]) / (second[1] - first[1]));
}

/**
 * Returns 1 if the ray from the point leaves through this face, -1 if it enters, 0 if it misses the
 * face. *at: the x at which the line of the ray goes through the face's plane.
 */
int Crossing(const Face& face, const Triple& point, double* at)
{
  const double(&c)[3][3] = face.Corner;
  const double y = point[1], z = point[2];
  bool inside = false;
  for (int i = 0; i < 3; ++i)
  {
    inside = inside != IsBelow(c[i], c[(i + 1) % 3], y, z);
  }
  if (!inside)
  {
    return 0;
  }
  double n[3];
  for (int a = 0; a < 3; ++a)
  {
    const int b = (a + 1) % 3, d = (a + 2) % 3;
    n[a] = (c[1][b] - c[0][b]) * (c[2][d] - c[0][d]) - (c[1][d] - c[0][d]) * (c[2][b] - c[0][b]);
  }
  if (n[0] == 0.0)
  {
    return 0;
  }
  *at = c[0][0] - (n[1] * (y - c[0][1]) + n[2] * (z - c[0][2])) / n[0];
  return *at <= point[0] ? 0 : n[0] > 0.0 ? 1 : -1;
}

/** Divides space into columns along x. Lists, for each column, the faces that reach into it. */
class Columns
{
public:
  explicit Columns(std::vector<Face> faces)
    : Faces(std::move(faces))
    , Count(std::max(
        1, std::min(2048, static_cast<int>(std::sqrt(static_cast<double>(this->Faces.size()))))))
    , Lists(this->Place(0, this->Count))
  {
    const auto rangeOf = [](const Face& face, int a) {
      return std::minmax({ face.Corner[0][a + 1], face.Corner[1][a + 1], face.Corner[2][a + 1] });
    };
    for (int a = 0; a < 2; ++a)
    {
      double high = -VTK_DOUBLE_MAX;
      this->Low[a] = VTK_DOUBLE_MAX;
      for (const Face& face : this->Faces)
      {
        this->Low[a] = std::min(this->Low[a], rangeOf(face, a).first);
        high = std::max(high, rangeOf(face, a).second);
      }
      this->Size[a] = high > this->Low[a] ? (high - this->Low[a]) / this->Count : 1.0;
    }
    for (size_t f = 0; f < this->Faces.size(); ++f)
    {
      const auto y = rangeOf(this->Faces[f], 0), z = rangeOf(this->Faces[f], 1);
      const int last[2] = { this->IndexOf(0, y.second), this->IndexOf(1, z.second) };
      for (int j = this->IndexOf(1, z.first); j <= last[1]; ++j)
      {
        for (int i = this->IndexOf(0, y.first); i <= last[0]; ++i)
        {
          this->Lists[this->Place(i, j)].push_back(f);
        }
      }
    }
  }

  const std::vector<size_t>& At(double y, double z) const
  {
    const int i = this->IndexOf(0, y), j = this->IndexOf(1, z);
    const bool isIn = i >= 0 && i < this->Count && j >= 0 && j < this->Count;
    return isIn ? this->Lists[this->Place(i, j)] : this->None;
  }

  const std::vector<Face> Faces;

private:
  int IndexOf(int a, double x) const
  {
    const double i = std::floor((x - this->Low[a]) / this->Size[a]);
    return i == this->Count ? this->Count - 1 : static_cast<int>(std::max(-1.0, std::min(i, 1e9)));
  }

  size_t Place(int i, int j) const
  {
    return static_cast<size_t>(j) * static_cast<size_t>(this->Count) + static_cast<size_t>(i);
  }

  const int Count; // columns along y, and along z
  double Low[2], Size[2];
  std::vector<std::vector<size_t>> Lists;
  const std::vector<size_t> None;
};

/**
 * Finds the pieces that enclose the point, except `without`. Of these pieces and the piece `innermost`
 * (-1: none yet), the one whose volume has the smallest magnitude becomes `innermost`.
 */
void Enclose(const Columns& columns, const std::vector<vtkSPHPiece>& pieces, const Triple& point,
  vtkIdType without, vtkIdType& innermost)
{
  // For each piece: how often the ray leaves it, minus how often the ray enters it.
  std::map<vtkIdType, int> turns;
  for (const size_t f : columns.At(point[1], point[2]))
  {
    const Face& face = columns.Faces[f];
    double at;
    const int crossing = face.Piece == without ? 0 : Crossing(face, point, &at);
    if (crossing != 0)
    {
      turns[face.Piece] += crossing;
    }
  }
  const auto sizeOf = [&pieces](vtkIdType piece) { return std::abs(pieces[piece].Volume); };
  for (const auto& turn : turns)
  {
    const bool encloses =
      (turn.second > 0) == (pieces[turn.first].Volume > 0.0) && turn.second != 0;
    if (encloses && (innermost < 0 || sizeOf(turn.first) < sizeOf(innermost)))
    {
      innermost = turn.first;
    }
  }
}
}

// Lists the shifts by whole periods that may bring a point in the period into a piece. hasVolume:
// considers the pieces with a volume if true, the pieces without a volume if false.
std::vector<Triple> vtkSPHPieces::ListShifts(bool hasVolume) const
{
  std::vector<Triple> shifts = { { { 0.0, 0.0, 0.0 } } };
  for (int a = 0; a < 3; ++a)
  {
    int first = 0, last = 0;
    for (const vtkSPHPiece& piece : this->Pieces)
    {
      if (piece.HasVolume() == hasVolume)
      {
        first = std::min(first, static_cast<int>(this->PeriodOf(piece.Bounds[2 * a], a)));
        last = std::max(last, static_cast<int>(this->PeriodOf(piece.Bounds[2 * a + 1], a)));
      }
    }
    const std::vector<Triple> before = std::move(shifts);
    shifts.clear();
    for (int k = first; k <= last; ++k)
    {
      for (Triple shift : before)
      {
        shift[a] = k * this->Length[a];
        shifts.push_back(shift);
      }
    }
  }
  return shifts;
}

std::vector<vtkSPHPieces::Face> vtkSPHPieces::ListFaces(bool hasVolume, double isoValue) const
{
  std::vector<Face> faces;
  for (size_t t = 0; t < this->Triangles.size(); ++t)
  {
    Face face;
    face.Piece = this->PieceOfTriangle[t];
    const vtkSPHPiece& piece = this->Pieces[face.Piece];
    if (piece.HasVolume() == hasVolume && piece.Iso == isoValue)
    {
      this->CornersOf(static_cast<vtkIdType>(t), face.Corner);
      faces.push_back(face);
    }
  }
  return faces;
}

// Returns an image of a point: the point is moved into the period, then by the shift.
Triple vtkSPHPieces::ImageOf(const Triple& point, Triple shift) const
{
  for (int a = 0; a < 3; ++a)
  {
    shift[a] += point[a] - this->PeriodOf(point[a], a) * this->Length[a];
  }
  return shift;
}

std::vector<vtkIdType> vtkSPHPieces::FindEnclosing(
  const std::vector<Triple>& points, double isoValue, const std::vector<vtkIdType>& without) const
{
  const Columns columns(points.empty() ? std::vector<Face>() : this->ListFaces(true, isoValue));
  const std::vector<Triple> shifts = this->ListShifts(true);
  std::vector<vtkIdType> found(points.size(), -1);
  vtkSMPTools::For(0, static_cast<vtkIdType>(points.size()),
    [&](vtkIdType begin, vtkIdType end)
    {
      for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
      {
        vtkIdType innermost = -1;
        for (const Triple& shift : shifts)
        {
          const Triple image = this->ImageOf(points[i], shift);
          Enclose(columns, this->Pieces, image, without.empty() ? -1 : without[i], innermost);
        }
        const bool isFluid = innermost >= 0 && this->Pieces[innermost].Volume > 0.0;
        found[i] = isFluid ? innermost : -1;
      }
    });
  return found;
}

// Rays go both ways along each axis. Each ray ends at the first face of a piece without a volume,
// where it leaves or enters the piece. If more rays leave than enter, the nearest piece that a ray
// leaves is the result, else -1. One ray is not enough, because an open piece has holes.
std::vector<vtkIdType> vtkSPHPieces::FindAround(
  const std::vector<Triple>& points, double isoValue) const
{
  std::vector<int> left(points.size(), 0); // rays that left, minus rays that entered
  std::vector<vtkIdType> found(points.size(), -1);
  std::vector<double> nearest(points.size(), VTK_DOUBLE_MAX);
  const std::vector<Triple> shifts = this->ListShifts(false);
  for (int ray = 0; ray < 6; ++ray)
  {
    const int axis = ray / 2;
    const double way = ray % 2 ? -1.0 : 1.0; // a mirrored face has its other side in front
    const auto turn = [axis, way](const double* x) {
      return Triple{ { way * x[axis], x[(axis + 1) % 3], x[(axis + 2) % 3] } };
    };
    std::vector<Face> faces = this->ListFaces(false, isoValue);
    for (Face& face : faces)
    {
      for (double(&corner)[3] : face.Corner)
      {
        const Triple turned = turn(corner);
        std::copy(turned.begin(), turned.end(), corner);
      }
    }
    const Columns columns(std::move(faces));
    for (size_t i = 0; i < points.size(); ++i)
    {
      double first = VTK_DOUBLE_MAX, at;
      int side = 0;
      vtkIdType piece = -1;
      for (const Triple& shift : shifts)
      {
        const Triple point = turn(this->ImageOf(points[i], shift).data());
        for (const size_t f : columns.At(point[1], point[2]))
        {
          const int crossing = Crossing(columns.Faces[f], point, &at);
          if (crossing != 0 && at - point[0] < first)
          {
            first = at - point[0];
            side = way > 0.0 ? crossing : -crossing;
            piece = columns.Faces[f].Piece;
          }
        }
      }
      left[i] += side;
      if (side > 0 && first < nearest[i])
      {
        nearest[i] = first;
        found[i] = piece;
      }
    }
  }
  std::transform(found.begin(), found.end(), left.begin(), found.begin(),
    [](vtkIdType piece, int rays) { return rays > 0 ? piece : -1; });
  return found;
}
VTK_ABI_NAMESPACE_END
