// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Which piece encloses a point: a ray along x leaves a closed piece once more than it enters it. Triangles
// are in columns along x, by their y and z; a ray looks at those of its column.
#include "vtkSPHPieces.h"

#include "vtkSMPTools.h"

#include <algorithm>
#include <cmath>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Triple = std::array<double, 3>;

struct Face
{
  double Corner[3][3];
  vtkIdType Piece;
};

/** Where the edge between two corners passes y, and whether the point (y, z) has it at greater z. Either
 * triangle beside an edge asks with the same numbers, so that no ray passes between them. */
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

/** 1: the ray from the point leaves through this face; -1: it enters; 0: it passes by. */
int Crossing(const Face& face, const Triple& point)
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
  const double x = c[0][0] - (n[1] * (y - c[0][1]) + n[2] * (z - c[0][2])) / n[0];
  return x <= point[0] ? 0 : n[0] > 0.0 ? 1 : -1;
}

/** Faces by columns. */
class Columns
{
public:
  explicit Columns(std::vector<Face> faces)
    : Faces(std::move(faces))
  {
    std::fill_n(this->Low, 2, 0.0);
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
    this->Lists.resize(static_cast<size_t>(this->Counts[0]) * static_cast<size_t>(this->Counts[1]));
    for (size_t f = 0; f < this->Faces.size(); ++f)
    {
      this->Put(f);
    }
  }

  const std::vector<size_t>& At(double y, double z) const
  {
    const bool isIn = this->IndexOf(0, y) >= 0 && this->IndexOf(0, y) < this->Counts[0] &&
      this->IndexOf(1, z) >= 0 && this->IndexOf(1, z) < this->Counts[1];
    return isIn ? this->Lists[this->Place(this->IndexOf(0, y), this->IndexOf(1, z))] : this->None;
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

  void Put(size_t f)
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

  double Low[2], Size[2];
  int Counts[2];
  std::vector<std::vector<size_t>> Lists;
  const std::vector<size_t> None;
};

/** The innermost piece around the point: of those that the ray leaves, the one of least volume; none where
 * it enters as many, being in a cavity. */
vtkIdType Enclosing(const Columns& columns, const std::vector<vtkSPHPiece>& pieces,
  const Triple& point, vtkIdType without)
{
  std::vector<std::pair<vtkIdType, int>> turns; // of pieces
  for (const size_t f : columns.At(point[1], point[2]))
  {
    const Face& face = columns.Faces[f];
    const int crossing = face.Piece == without ? 0 : Crossing(face, point);
    if (crossing != 0)
    {
      auto at = std::find_if(turns.begin(), turns.end(),
        [&](const std::pair<vtkIdType, int>& turn) { return turn.first == face.Piece; });
      at = at == turns.end() ? turns.insert(at, { face.Piece, 0 }) : at;
      at->second += crossing;
    }
  }
  int total = 0;
  vtkIdType found = -1;
  for (const auto& turn : turns)
  {
    const double volume = pieces[static_cast<size_t>(turn.first)].Volume;
    total += turn.second;
    const bool encloses = turn.second > 0 && volume > 0.0;
    if (encloses && (found < 0 || volume < pieces[static_cast<size_t>(found)].Volume))
    {
      found = turn.first;
    }
  }
  return total > 0 ? found : -1;
}

/** Moves the place into the period. */
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

// A point may be whole periods away; within the period, in a piece that sticks out of it at the other side.
std::vector<vtkIdType> vtkSPHPieces::FindEnclosing(
  const std::vector<Triple>& points, const std::vector<vtkIdType>& without) const
{
  std::vector<Face> faces;
  for (size_t t = 0; t < this->Triangles.size() && !points.empty(); ++t)
  {
    Face face;
    face.Piece = this->PieceOfTriangle[t];
    if (this->Pieces[static_cast<size_t>(face.Piece)].HasVolume())
    {
      this->CornersOf(static_cast<vtkIdType>(t), face.Corner);
      faces.push_back(face);
    }
  }
  const Columns columns(std::move(faces));
  std::vector<Triple> shifts = { { { 0.0, 0.0, 0.0 } } };
  for (int a = 0; a < 3; ++a)
  {
    const double period = this->Period[2 * a + 1] - this->Period[2 * a];
    const size_t count = shifts.size();
    for (size_t i = 0; i < count && period > 0.0; ++i)
    {
      for (const double way : { period, -period })
      {
        shifts.push_back(shifts[i]);
        shifts.back()[a] += way;
      }
    }
  }
  std::vector<vtkIdType> found(points.size(), -1);
  vtkSMPTools::For(0, static_cast<vtkIdType>(points.size()),
    [&](vtkIdType begin, vtkIdType end)
    {
      for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
      {
        const Triple home = WithinPeriod(this->Period, points[i]);
        for (size_t s = 0; s < shifts.size() && found[i] < 0; ++s)
        {
          const Triple at = { { home[0] + shifts[s][0], home[1] + shifts[s][1],
            home[2] + shifts[s][2] } };
          found[i] = Enclosing(columns, this->Pieces, at, without.empty() ? -1 : without[i]);
        }
      }
    });
  return found;
}
VTK_ABI_NAMESPACE_END
