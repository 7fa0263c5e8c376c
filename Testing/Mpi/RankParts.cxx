// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankParts.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkMPIController.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkXMLPolyDataReader.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace
{

struct Particle
{
  vtkIdType Index;
  double At[3]; // the particle's place within the bounds, 0 to 1
};

struct Part
{
  const char* Name;
  std::function<int(const Particle&, int count)> RankOf;
};

/// Returns a number that looks random but is the same on every machine.
std::uint32_t PseudoRandom(vtkIdType index)
{
  auto bits = static_cast<std::uint32_t>(index) * 2654435761u;
  bits ^= bits >> 15;
  return bits * 2246822519u >> 8;
}

/// Returns the slab of a place; NaN counts as the first slab.
int Slab(double at, int count)
{
  return std::isfinite(at) ? std::min(static_cast<int>(at * count), count - 1) : 0;
}

const Part Parts[PartCount] = {
  { "scattered at random",
    [](const Particle& p, int count)
    { return static_cast<int>(PseudoRandom(p.Index) % static_cast<std::uint32_t>(count)); } },
  { "all on one rank", [](const Particle&, int count) { return count - 1; } },
  { "slabs through the surface",
    [](const Particle& p, int count) { return Slab(p.At[1], count); } },
  { "slabs thinner than a support",
    [](const Particle& p, int count) { return static_cast<int>(p.At[0] * 200.0) % count; } },
  { "ranks without particles",
    [](const Particle& p, int count) { return 2 * Slab(p.At[2], (count + 1) / 2); } },
  { "copies marked as duplicates",
    [](const Particle& p, int count) { return Slab(p.At[0], count); } },
};

constexpr int Duplicates = 5; // in this part several ranks have the same particles

}

const char* PartName(int part)
{
  return Parts[part].Name;
}

vtkSmartPointer<vtkPolyData> ReadParticles(const std::string& file)
{
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutput();
}

vtkSmartPointer<vtkPolyData> TakePart(vtkPolyData* particles, int part, int rank, int count)
{
  auto own = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  vtkNew<vtkUnsignedCharArray> marks;
  points->SetDataType(particles->GetPoints()->GetDataType());
  vtkPointData *from = particles->GetPointData(), *to = own->GetPointData();
  to->CopyAllocate(from, particles->GetNumberOfPoints());
  double bounds[6];
  particles->GetBounds(bounds);
  for (vtkIdType i = 0; i < particles->GetNumberOfPoints(); ++i)
  {
    Particle particle = { i, {} };
    for (int a = 0; a < 3; ++a)
    {
      particle.At[a] =
        (particles->GetPoint(i)[a] - bounds[2 * a]) / (bounds[2 * a + 1] - bounds[2 * a] + 1e-9);
    }
    const bool isOwn = Parts[part].RankOf(particle, count) == rank;
    if (isOwn || (part == Duplicates && i % 5 == rank % 5))
    {
      to->CopyData(from, i, points->InsertNextPoint(particles->GetPoint(i)));
      marks->InsertNextValue(isOwn ? 0 : vtkDataSetAttributes::DUPLICATEPOINT);
    }
  }
  own->SetPoints(points);
  own->GetFieldData()->PassData(particles->GetFieldData());
  if (part == Duplicates)
  {
    marks->SetName(vtkDataSetAttributes::GhostArrayName());
    to->AddArray(marks);
  }
  return own;
}

namespace
{

/// Returns whether both tuples have the same type, size and bits.
bool IsSameTuple(vtkDataArray* a, vtkIdType i, vtkDataArray* b, vtkIdType j)
{
  const auto size = static_cast<std::size_t>(a->GetNumberOfComponents()) *
    static_cast<std::size_t>(a->GetDataTypeSize());
  return a->GetDataType() == b->GetDataType() &&
    a->GetNumberOfComponents() == b->GetNumberOfComponents() &&
    std::memcmp(static_cast<char*>(a->GetVoidPointer(0)) + static_cast<std::size_t>(i) * size,
      static_cast<char*>(b->GetVoidPointer(0)) + static_cast<std::size_t>(j) * size, size) == 0;
}

/// Compares each triangle and line with the cell that has its number in the whole surface.
std::string CompareCells(vtkPolyData* part, vtkPolyData* whole, std::vector<int>& seen)
{
  vtkDataArray* cells = part->GetCellData()->GetArray("GlobalCellIds");
  vtkDataArray* points = part->GetPointData()->GetArray("GlobalPointIds");
  for (vtkIdType i = 0; i < part->GetNumberOfCells(); ++i)
  {
    const auto number = static_cast<vtkIdType>(cells->GetComponent(i, 0));
    if (number < 0 || number >= whole->GetNumberOfCells())
    {
      return "a cell has number " + std::to_string(number);
    }
    ++seen[static_cast<std::size_t>(number)];
    vtkNew<vtkIdList> corners, expected;
    part->GetCellPoints(i, corners);
    whole->GetCellPoints(number, expected);
    if (!std::equal(corners->begin(), corners->end(), expected->begin(), expected->end(),
          [points](vtkIdType corner, vtkIdType id)
          { return static_cast<vtkIdType>(points->GetComponent(corner, 0)) == id; }))
    {
      return "cell " + std::to_string(number) + " has other corners";
    }
  }
  return "";
}

std::string ComparePart(
  vtkPolyData* part, vtkPolyData* whole, std::vector<int>& seenPoints, std::vector<int>& seenCells)
{
  vtkDataArray* points = part->GetPointData()->GetGlobalIds();
  vtkDataArray* cells = part->GetCellData()->GetGlobalIds();
  if (part->GetNumberOfPoints() == 0)
  {
    return ""; // VTK sends no arrays then
  }
  if (!points || std::string(points->GetName()) != "GlobalPointIds" || !cells ||
    std::string(cells->GetName()) != "GlobalCellIds")
  {
    return "there are no global ids";
  }
  const int count = part->GetPointData()->GetNumberOfArrays();
  if (count != whole->GetPointData()->GetNumberOfArrays() + 1)
  {
    return std::to_string(count) + " arrays";
  }
  const std::string problem = ComparePoints(part, points, part, whole, seenPoints);
  return problem.empty() ? CompareCells(part, whole, seenCells) : problem;
}

}

std::string ComparePoints(vtkPolyData* part, vtkDataArray* numbers, vtkPolyData* given,
  vtkPolyData* whole, std::vector<int>& seen)
{
  vtkPointData* expected = whole->GetPointData();
  vtkUnsignedCharArray* marks = given->GetPointGhostArray();
  for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
  {
    const auto number = static_cast<vtkIdType>(numbers->GetComponent(i, 0));
    const std::string point = "point " + std::to_string(number);
    if (marks && marks->GetValue(i))
    {
      continue;
    }
    if (number < 0 || number >= whole->GetNumberOfPoints() ||
      !IsSameTuple(part->GetPoints()->GetData(), i, whole->GetPoints()->GetData(), number))
    {
      return point + " is elsewhere";
    }
    ++seen[static_cast<std::size_t>(number)];
    for (int k = 0; k < expected->GetNumberOfArrays(); ++k)
    {
      vtkDataArray* array = part->GetPointData()->GetArray(expected->GetArrayName(k));
      if (!array || !IsSameTuple(array, i, expected->GetArray(k), number))
      {
        return std::string(expected->GetArrayName(k)) + " of " + point;
      }
    }
  }
  return "";
}

std::string CompareWithWhole(
  vtkMultiProcessController* controller, vtkPolyData* part, vtkPolyData* whole)
{
  constexpr int tag = 1717;
  if (controller->GetLocalProcessId() != 0)
  {
    controller->Send(part, 0, tag);
    return "";
  }
  std::vector<int> points(static_cast<std::size_t>(whole->GetNumberOfPoints()), 0),
    cells(static_cast<std::size_t>(whole->GetNumberOfCells()), 0);
  std::string problem;
  for (int rank = 0; rank < controller->GetNumberOfProcesses(); ++rank)
  {
    vtkNew<vtkPolyData> theirs;
    if (rank > 0)
    {
      controller->Receive(theirs, rank, tag);
    }
    const std::string found = ComparePart(rank > 0 ? theirs.Get() : part, whole, points, cells);
    problem += found.empty() ? "" : "rank " + std::to_string(rank) + ": " + found + "; ";
  }
  const auto missing = std::count(points.begin(), points.end(), 0);
  const auto once = std::count(cells.begin(), cells.end(), 1);
  problem += missing > 0 ? std::to_string(missing) + " points are missing; " : "";
  problem +=
    once < whole->GetNumberOfCells() ? std::to_string(once) + " cells are there once; " : "";
  return problem + (points.size() < 200 ? "too few points to compare" : "");
}

int RunRanks(int argc, char* argv[], const std::function<int(vtkMPIController*)>& test)
{
  vtkNew<vtkMPIController> controller;
  controller->Initialize(&argc, &argv);
  vtkMultiProcessController::SetGlobalController(controller);
  const int failures = test(controller);
  int all = 0;
  controller->AllReduce(&failures, &all, 1, vtkCommunicator::SUM_OP);
  controller->Finalize();
  return all == 0 ? 0 : 1;
}
