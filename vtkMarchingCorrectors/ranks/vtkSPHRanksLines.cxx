// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksLines.h"

#include "vtkAbstractArray.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkIdTypeArray.h"
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
#include <numeric>
#include <string>

namespace
{
using Piece = std::array<std::int32_t, 2>;

/** Positions, as an array among the others on the way. */
constexpr const char* Positions = "vtkSPHRanksLines positions";

int AxisOf(const mcor_plane& plane, int a)
{
  return (plane.axis + a) % 3; // as the core turns them
}

/** Of one rank: numbers and positions of points, and the pieces between them. */
vtkSPHRanks::Bytes Pack(const mcor_surface& surface, vtkIdTypeArray* numbers)
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
  const auto points = static_cast<std::size_t>(surface.point_count);
  vtkSPHPutNumber(bytes, surface.point_count);
  vtkSPHPutNumber(bytes, static_cast<std::int64_t>(pieces.size()));
  vtkSPHPutBytes(bytes, numbers->GetPointer(0), points * sizeof(vtkIdType));
  vtkSPHPutBytes(bytes, surface.points, 3 * points * sizeof(double));
  vtkSPHPutBytes(bytes, pieces.data(), pieces.size() * sizeof(Piece));
  return bytes;
}

/** Adds a rank's points and pieces to the whole; returns the numbers of its points. */
std::vector<vtkIdType> Unpack(
  const vtkSPHRanks::Bytes& bytes, double* points, std::vector<Piece>& pieces)
{
  vtkSPHRanksReader reader(bytes);
  std::vector<vtkIdType> numbers(static_cast<std::size_t>(reader.GetNumber()));
  std::vector<Piece> own(static_cast<std::size_t>(reader.GetNumber()));
  reader.GetBytes(numbers.data(), numbers.size() * sizeof(vtkIdType));
  for (const vtkIdType number : numbers)
  {
    reader.GetBytes(points + 3 * number, 3 * sizeof(double));
  }
  reader.GetBytes(own.data(), own.size() * sizeof(Piece));
  for (const Piece& piece : own)
  {
    pieces.push_back({ static_cast<std::int32_t>(numbers[static_cast<std::size_t>(piece[0])]),
      static_cast<std::int32_t>(numbers[static_cast<std::size_t>(piece[1])]) });
  }
  return numbers;
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

//------------------------------------------------------------------------------
mcor_globals vtkSPHPlaceInPlane(const mcor_globals& globals)
{
  mcor_globals placed = globals;
  const mcor_measure& from = globals.measured;
  mcor_measure& to = placed.measured;
  for (int a = 0; a < 3 && from.plane.axis > 0; ++a)
  {
    const int axis = AxisOf(from.plane, a);
    const double shift = a == 2 ? from.plane.at : 0.0;
    to.low[axis] = from.low[a] + shift;
    to.high[axis] = from.high[a] + shift;
    to.x_low[axis] = from.x_low[a] + shift;
    to.x_high[axis] = from.x_high[a] + shift;
    to.edge[axis] = from.edge[a];
  }
  return placed;
}

//------------------------------------------------------------------------------
mcor_options vtkSPHPlaceInPlane(const mcor_options& options, const mcor_globals& globals)
{
  mcor_options placed = options;
  if (globals.measured.plane.axis > 0)
  {
    const int axis = AxisOf(globals.measured.plane, 2);
    placed.periodic[2 * axis] = placed.periodic[2 * axis + 1] = 0.0;
  }
  return placed;
}

//------------------------------------------------------------------------------
vtkSPHRanksLines::vtkSPHRanksLines(vtkSPHRanks& ranks, mcor_surface& surface,
  vtkIdTypeArray* numbers, vtkIdType total, const mcor_plane& plane)
{
  std::vector<vtkSPHRanks::Bytes> messages(static_cast<std::size_t>(ranks.GetCount()));
  messages[0] = Pack(surface, numbers);
  const std::vector<vtkSPHRanks::Bytes> received = ranks.Exchange(std::move(messages));
  std::int64_t counts[2] = { 0, 0 }; // of lines; of failures
  double measures[3] = { 0.0, 0.0, 0.0 };
  if (ranks.GetRank() == 0)
  {
    std::vector<Piece> pieces;
    this->Whole.point_count = total;
    this->Whole.points =
      static_cast<double*>(std::malloc(static_cast<std::size_t>(3 * total + 1) * sizeof(double)));
    for (std::size_t rank = 0; this->Whole.points && rank < received.size(); ++rank)
    {
      this->Numbers.push_back(Unpack(received[rank], this->Whole.points, pieces));
    }
    counts[1] = !this->Whole.points ||
        mcor_join_lines(&plane, reinterpret_cast<const std::int32_t(*)[2]>(pieces.data()),
          static_cast<std::int64_t>(pieces.size()), &this->Whole) != MCOR_OK
      ? 1
      : 0;
    const mcor_statistics& s = this->Whole.statistics;
    counts[0] = this->Whole.line_count;
    measures[0] = s.length;
    measures[1] = s.area;
    measures[2] = s.is_closed ? 1.0 : 0.0;
  }
  ranks.Reduce(vtkSPHRanks::SUM, counts, 2); // the first rank's
  ranks.Reduce(vtkSPHRanks::SUM, measures, 3);
  this->Count = counts[0];
  this->Failed = counts[1] > 0;
  surface.statistics.length = measures[0];
  surface.statistics.area = measures[1];
  surface.statistics.is_closed = measures[2] > 0.0;
}

//------------------------------------------------------------------------------
vtkSPHRanksLines::~vtkSPHRanksLines()
{
  mcor_free_surface(&this->Whole);
}

//------------------------------------------------------------------------------
void vtkSPHRanksLines::Move(vtkSPHRanks& ranks, vtkPolyData* output) const
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
  vtkNew<vtkIdTypeArray> corners, offsets;
  const std::int64_t lines = this->Whole.line_count;
  offsets->InsertNextValue(0);
  for (std::int64_t i = 0; i < lines; ++i)
  {
    offsets->InsertNextValue(this->Whole.line_offsets[i + 1]);
  }
  for (std::int64_t i = 0; lines > 0 && i < this->Whole.line_offsets[lines]; ++i)
  {
    corners->InsertNextValue(this->Whole.line_points[i]);
  }
  vtkNew<vtkCellArray> cells;
  cells->SetData(offsets, corners);
  output->SetLines(cells);
  arrays->SetGlobalIds(CountUp("GlobalPointIds", output->GetNumberOfPoints()));
  output->GetCellData()->SetGlobalIds(CountUp("GlobalCellIds", lines));
}
