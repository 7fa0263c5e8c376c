// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksLines.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkIdTypeArray.h"
#include "vtkMarchingCorrectorsOutput.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksBytes.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <string>

namespace
{
using Piece = std::array<std::int32_t, 2>;

/** Positions, as an array among the others on the way. */
constexpr const char* Positions = "vtkSPHRanksLines positions";

/** How many there are of an array that a surface may lack. */
std::int64_t CountOf(const void* array, std::int64_t count)
{
  return array ? count : 0;
}

/** Of one rank: numbers, positions and iso values of points, pieces of lines between them, triangles. */
vtkSPHRanks::Bytes Pack(const mcor_surface& surface, const vtkSPHRanksNumbers& numbers)
{
  vtkSPHRanks::Bytes bytes;
  std::vector<Piece> pieces;
  for (std::int64_t line = 0; line < surface.line_count; ++line)
  {
    for (std::int64_t i = surface.line_offsets[line]; i + 1 < surface.line_offsets[line + 1]; ++i)
    {
      pieces.push_back({ surface.line_points[i], surface.line_points[i + 1] });
    }
  }
  const auto put = [&bytes](const auto* data, std::int64_t count)
  {
    vtkSPHPutNumber(bytes, count);
    vtkSPHPutBytes(bytes, data, static_cast<std::size_t>(count) * sizeof(*data));
  };
  put(numbers.OfPoints->GetPointer(0), surface.point_count);
  put(surface.points, 3 * surface.point_count);
  put(surface.iso_value, CountOf(surface.iso_value, surface.point_count));
  put(pieces.data(), static_cast<std::int64_t>(pieces.size()));
  const std::int64_t triangles = CountOf(surface.band_value, surface.triangle_count);
  put(numbers.OfTriangles->GetPointer(0), triangles);
  put(surface.triangles, 3 * triangles);
  put(surface.band_value, triangles);
  return bytes;
}

template <typename T>
std::vector<T> GetArray(vtkSPHRanksReader& reader)
{
  std::vector<T> values(static_cast<std::size_t>(reader.GetNumber()));
  reader.GetBytes(values.data(), values.size() * sizeof(T));
  return values;
}

/** Moves tuples to the places that numbers say, where they are given. */
template <typename T>
void Place(const std::vector<T>& values, const std::vector<vtkIdType>& numbers, T* to)
{
  const std::size_t width = values.empty() ? 0 : values.size() / numbers.size();
  for (std::size_t i = 0; i < values.size() && to; ++i)
  {
    to[static_cast<std::size_t>(numbers[i / width]) * width + i % width] = values[i];
  }
}

/** Adds a rank's points, pieces and triangles to the whole; returns the numbers of its points. */
std::vector<vtkIdType> Unpack(
  const vtkSPHRanks::Bytes& bytes, mcor_surface& whole, std::vector<Piece>& pieces)
{
  vtkSPHRanksReader reader(bytes);
  std::vector<vtkIdType> numbers = GetArray<vtkIdType>(reader);
  const auto numberOf = [&numbers](std::int32_t point)
  { return static_cast<std::int32_t>(numbers[static_cast<std::size_t>(point)]); };
  Place(GetArray<double>(reader), numbers, whole.points);
  Place(GetArray<double>(reader), numbers, whole.iso_value);
  for (const Piece& piece : GetArray<Piece>(reader))
  {
    pieces.push_back({ numberOf(piece[0]), numberOf(piece[1]) });
  }
  const std::vector<vtkIdType> triangles = GetArray<vtkIdType>(reader);
  std::vector<std::int32_t> corners = GetArray<std::int32_t>(reader);
  std::transform(corners.begin(), corners.end(), corners.begin(), numberOf);
  Place(corners, triangles, whole.triangles);
  Place(GetArray<double>(reader), triangles, whole.band_value);
  return numbers;
}

/** Uninitialized; not null where there are none. */
template <typename T>
bool Allocate(T*& array, vtkIdType count)
{
  array = static_cast<T*>(std::malloc(static_cast<std::size_t>(count) * sizeof(T) + 1));
  return array != nullptr;
}

/** Whole numbers from 0 on. */
vtkSmartPointer<vtkIdTypeArray> CountUp(const char* name, vtkIdType count)
{
  auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
  numbers->SetName(name);
  numbers->SetNumberOfTuples(count);
  std::iota(numbers->GetPointer(0), numbers->GetPointer(0) + count, vtkIdType(0));
  return numbers;
}
}

vtkSPHRanksLines::vtkSPHRanksLines(vtkSPHRanks& ranks, mcor_surface& surface,
  const vtkSPHRanksNumbers& numbers, const mcor_plane& plane, bool isFilled)
{
  std::vector<vtkSPHRanks::Bytes> messages(static_cast<std::size_t>(ranks.GetCount()));
  messages[0] = Pack(surface, numbers);
  const std::vector<vtkSPHRanks::Bytes> received = ranks.Exchange(std::move(messages));
  const bool isFirst = ranks.GetRank() == 0;
  mcor_surface& whole = this->Whole;
  whole.point_count = isFirst ? numbers.Points : 0;
  whole.triangle_count = isFirst && isFilled ? numbers.Triangles : 0;
  this->Failed = whole.point_count > std::numeric_limits<std::int32_t>::max() ||
    !Allocate(whole.points, 3 * whole.point_count) ||
    (isFilled &&
      (!Allocate(whole.iso_value, whole.point_count) ||
        !Allocate(whole.triangles, 3 * whole.triangle_count) ||
        !Allocate(whole.band_value, whole.triangle_count)));
  if (isFirst && !this->Failed)
  {
    this->Take(received, plane);
  }
  const mcor_statistics& s = whole.statistics;
  std::int64_t counts[2] = { whole.line_count, this->Failed ? 1 : 0 };
  double measures[3] = { s.length, s.area, s.is_closed ? 1.0 : 0.0 };
  ranks.Reduce(vtkSPHRanks::SUM, counts, 2); // of lines and measures the first rank's
  ranks.Reduce(vtkSPHRanks::SUM, measures, 3);
  this->Count = counts[0];
  this->Failed = counts[1] > 0;
  surface.statistics.length = measures[0];
  surface.statistics.area = measures[1];
  surface.statistics.is_closed = measures[2] > 0.0;
}

// What all ranks have sent, on the first one.
void vtkSPHRanksLines::Take(
  const std::vector<vtkSPHRanks::Bytes>& received, const mcor_plane& plane)
{
  std::vector<Piece> pieces;
  for (const vtkSPHRanks::Bytes& bytes : received)
  {
    this->Numbers.push_back(Unpack(bytes, this->Whole, pieces));
  }
  this->Failed = mcor_join_lines(&plane, reinterpret_cast<const std::int32_t(*)[2]>(pieces.data()),
                   static_cast<std::int64_t>(pieces.size()), &this->Whole) != MCOR_OK;
}

vtkSPHRanksLines::~vtkSPHRanksLines()
{
  mcor_free_surface(&this->Whole);
}

void vtkSPHRanksLines::Move(vtkSPHRanks& ranks, vtkPolyData* output)
{
  vtkPointData* arrays = output->GetPointData();
  const auto count = static_cast<std::size_t>(ranks.GetCount());
  std::vector<std::vector<vtkIdType>> back(count), home = this->Numbers;
  home.resize(count);
  back[0].resize(static_cast<std::size_t>(output->GetNumberOfPoints()));
  std::iota(back[0].begin(), back[0].end(), vtkIdType(0));
  const std::string normals = arrays->GetNormals() ? arrays->GetNormals()->GetName() : "";
  const std::string scalars = arrays->GetScalars() ? arrays->GetScalars()->GetName() : "";
  vtkDataArray* positions = output->GetPoints()->GetData();
  positions->SetName(Positions);
  arrays->AddArray(positions);
  vtkNew<vtkPointData> moved;
  vtkSPHReturnArrays(ranks, arrays, output->GetNumberOfPoints(), back, home,
    static_cast<vtkIdType>(this->Whole.point_count), moved);
  vtkNew<vtkPoints> points;
  vtkSmartPointer<vtkDataArray> at = moved->GetArray(Positions);
  moved->RemoveArray(Positions);
  at->SetName("Points");
  points->SetData(at);
  output->SetPoints(points);
  arrays->Initialize();
  for (int i = 0; i < moved->GetNumberOfArrays(); ++i)
  {
    arrays->AddArray(moved->GetAbstractArray(i));
  }
  arrays->SetActiveNormals(normals.empty() ? nullptr : normals.c_str());
  arrays->SetActiveScalars(scalars.empty() ? nullptr : scalars.c_str());
  const auto cells = static_cast<vtkIdType>(this->Whole.line_count + this->Whole.triangle_count);
  vtkMarchingCorrectorsOutput::BuildCells(this->Whole, output);
  arrays->SetGlobalIds(CountUp("GlobalPointIds", output->GetNumberOfPoints()));
  output->GetCellData()->SetGlobalIds(CountUp("GlobalCellIds", cells));
}
