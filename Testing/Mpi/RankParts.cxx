// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankParts.h"

#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkXMLPolyDataReader.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

namespace
{

struct Particle
{
  vtkIdType Index;
  double At[3]; // of the bounds, 0 to 1
};

struct Part
{
  const char* Name;
  std::function<int(const Particle&, int count)> RankOf;
};

/// Returns the same number everywhere, one like a random number.
std::uint32_t Shuffle(vtkIdType index)
{
  auto bits = static_cast<std::uint32_t>(index) * 2654435761u;
  bits ^= bits >> 15;
  return bits * 2246822519u >> 8;
}

/// Points that are nowhere are in the first one.
int Slab(double at, int count)
{
  return std::isfinite(at) ? std::min(static_cast<int>(at * count), count - 1) : 0;
}

const Part Parts[PartCount] = {
  { "scattered at random",
    [](const Particle& p, int count)
    { return static_cast<int>(Shuffle(p.Index) % static_cast<std::uint32_t>(count)); } },
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

constexpr int Duplicates = 5; // the part whose ranks have others' particles as well

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
