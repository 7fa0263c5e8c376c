// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Finds which piece encloses a point: a ray along x leaves an enclosing piece once more than it
// enters it. Triangles are listed in columns along x, and a ray tests the triangles of its column.
#include "vtkSPHPieces.h"

#include "vtkSMPTools.h"

#include <algorithm>
#include <cmath>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Triple = std::array<double, 3>;
using Face = vtkSPHPieces::Face;

/**
 * Whether the edge between two corners passes y, and the point (y, z) lies below the edge. The
 * result is the same for both triangles at an edge, so no ray slips between them.
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
 * Returns 1 if the ray from the point leaves through this face, -1 if it enters, 0 if it passes
 * by. *at: where along x.
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

/** The faces, listed by column. */
class Columns
{
public:
  explicit Columns(std::vector<Face> faces)
    : Faces(std::move(faces))
  {
    double high[2] = { 0.0, 0.0 };
    for (int a = 0; a < 2 && !this->Faces.empty(); ++a)
    {
      this->Low[a] = high[a] = this->Faces[0].Corner[0][a + 1];
      for (const Face& face : this->Faces)
      {
        for (const auto& corner : face.Corner)
        {
          this->Low[a] = std::min(this->Low[a], corner[a + 1]);
          high[a] = std::max(high[a], corner[a + 1]);
        }
      }
    }
    const double side = std::sqrt(static_cast<double>(this->Faces.size()));
    for (int a = 0; a < 2; ++a)
    {
      this->Counts[a] = std::max(1, std::min(2048, static_cast<int>(side)));
      this->Size[a] = high[a] > this->Low[a] ? (high[a] - this->Low[a]) / this->Counts[a] : 1.0;
    }
    this->Lists.resize(this->Place(0, this->Counts[1]));
    for (size_t f = 0; f < this->Faces.size(); ++f)
    {
      int first[2], last[2];
      for (int a = 0; a < 2; ++a)
      {
        const auto& c = this->Faces[f].Corner;
        first[a] = this->IndexOf(a, std::min({ c[0][a + 1], c[1][a + 1], c[2][a + 1] }));
        last[a] = this->IndexOf(a, std::max({ c[0][a + 1], c[1][a + 1], c[2][a + 1] }));
      }
      for (int j = first[1]; j <= last[1]; ++j)
      {
        for (int i = first[0]; i <= last[0]; ++i)
        {
          this->Lists[this->Place(i, j)].push_back(f);
        }
      }
    }
  }

  const std::vector<size_t>& At(double y, double z) const
  {
    const int i = this->IndexOf(0, y), j = this->IndexOf(1, z);
    const bool isIn = i >= 0 && i < this->Counts[0] && j >= 0 && j < this->Counts[1];
    return isIn ? this->Lists[this->Place(i, j)] : this->None;
  }

  const std::vector<Face> Faces;

private:
  int IndexOf(int a, double x) const
  {
    const double i = std::floor((x - this->Low[a]) / this->Size[a]);
    return i == this->Counts[a] ? this->Counts[a] - 1
                                : static_cast<int>(std::max(-1.0, std::min(i, 1e9)));
  }

  size_t Place(int i, int j) const
  {
    return static_cast<size_t>(j) * static_cast<size_t>(this->Counts[0]) + static_cast<size_t>(i);
  }

  double Low[2] = { 0.0, 0.0 }, Size[2];
  int Counts[2];
  std::vector<std::vector<size_t>> Lists;
  const std::vector<size_t> None;
};

/**
 * Sets `innermost` to the piece with the volume of least magnitude, among the pieces around the
 * point and the present `innermost`.
 */
void Enclose(const Columns& columns, const std::vector<vtkSPHPiece>& pieces, const Triple& point,
  vtkIdType without, vtkIdType& innermost)
{
  // For each piece: how often the ray leaves it, minus how often the ray enters it.
  std::vector<std::pair<vtkIdType, int>> turns;
  for (const size_t f : columns.At(point[1], point[2]))
  {
    const Face& face = columns.Faces[f];
    double at;
    const int crossing = face.Piece == without ? 0 : Crossing(face, point, &at);
    if (crossing != 0)
    {
      auto turn = std::find_if(turns.begin(), turns.end(),
        [&face](const std::pair<vtkIdType, int>& one) { return one.first == face.Piece; });
      turn = turn == turns.end() ? turns.insert(turn, { face.Piece, 0 }) : turn;
      turn->second += crossing;
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

/** Returns the image of a point that lies in the period. */
Triple WithinPeriod(const double period[6], const Triple& point)
{
  Triple at = point;
  for (int a = 0; a < 3; ++a)
  {
    const double low = period[2 * a], length = period[2 * a + 1] - low;
    at[a] -= length > 0.0 ? std::floor((at[a] - low) / length) * length : 0.0;
  }
  return at;
}
}

// Lists the shifts that move a point within the period to each of its images where pieces may be.
std::vector<Triple> vtkSPHPieces::ListShifts(bool hasVolume) const
{
  std::vector<Triple> shifts = { { { 0.0, 0.0, 0.0 } } };
  for (int a = 0; a < 3; ++a)
  {
    const double low = this->Period[2 * a], period = this->Period[2 * a + 1] - low;
    int first = 0, last = 0;
    for (const vtkSPHPiece& piece : this->Pieces)
    {
      if (period > 0.0 && piece.HasVolume() == hasVolume)
      {
        first = std::min(first, static_cast<int>(std::floor((piece.Bounds[2 * a] - low) / period)));
        last =
          std::max(last, static_cast<int>(std::floor((piece.Bounds[2 * a + 1] - low) / period)));
      }
    }
    const std::vector<Triple> before = std::move(shifts);
    shifts.clear();
    for (int k = first; k <= last; ++k)
    {
      for (Triple shift : before)
      {
        shift[a] = k * period;
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

std::vector<vtkIdType> vtkSPHPieces::FindEnclosing(
  const std::vector<Triple>& points, double isoValue, const std::vector<vtkIdType>& without) const
{
  const Columns columns(points.empty() ? std::vector<Face>() : this->ListFaces(true, isoValue));
  const std::vector<Triple> shifts = this->ListShifts(true);
  std::vector<vtkIdType> found(points.size(), -1);
  vtkSMPTools::For(0, static_cast<vtkIdType>(points.size()),
    [this, &points, &without, &columns, &shifts, &found](vtkIdType begin, vtkIdType end)
    {
      for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
      {
        const Triple home = WithinPeriod(this->Period, points[i]);
        vtkIdType innermost = -1;
        for (const Triple& shift : shifts)
        {
          const Triple at = { { home[0] + shift[0], home[1] + shift[1], home[2] + shift[2] } };
          Enclose(columns, this->Pieces, at, without.empty() ? -1 : without[i], innermost);
        }
        const bool isFluid = innermost >= 0 && this->Pieces[innermost].Volume > 0.0;
        found[i] = isFluid ? innermost : -1;
      }
    });
  return found;
}

// Rays go both ways along each axis. Each ray ends at the first face of a piece without a volume:
// there the ray leaves or enters the piece. The majority decides, because an open piece has holes.
std::vector<vtkIdType> vtkSPHPieces::FindAround(
  const std::vector<Triple>& points, double isoValue) const
{
  std::vector<int> left(points.size(), 0); // rays that left, minus rays that entered
  std::vector<vtkIdType> found(points.size(), -1);
  std::vector<double> nearest(points.size(), VTK_DOUBLE_MAX);
  const std::vector<Triple> shifts = this->ListShifts(false);
  const std::vector<Face> all = this->ListFaces(false, isoValue);
  for (int ray = 0; ray < 6; ++ray)
  {
    const int axis = ray / 2;
    const double way = ray % 2 ? -1.0 : 1.0; // a mirrored face has its other side in front
    const auto turn = [axis, way](const double* x) {
      return Triple{ { way * x[axis], x[(axis + 1) % 3], x[(axis + 2) % 3] } };
    };
    std::vector<Face> faces = all;
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
      const Triple home = WithinPeriod(this->Period, points[i]);
      double first = VTK_DOUBLE_MAX, at;
      int side = 0;
      vtkIdType piece = -1;
      for (const Triple& shift : shifts)
      {
        const Triple moved = { { home[0] + shift[0], home[1] + shift[1], home[2] + shift[2] } };
        const Triple point = turn(moved.data());
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
