// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef TestPlaneParticles_h
#define TestPlaneParticles_h

#include "TestParticles.h"

namespace test
{
/** 21^2 particles that fill a square of the plane y = 0.5, by their distance from its middle: two isolines, and
 * the least value below all. */
inline vtkSmartPointer<vtkMarchingCorrectors> MakePlaneFilter()
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int k = -10; k <= 10; ++k)
  {
    for (int i = -10; i <= 10; ++i)
    {
      points->InsertNextPoint(i * Spacing, 0.5, k * Spacing);
    }
  }
  vtkNew<vtkPolyData> plane;
  plane->SetPoints(points);
  AddArray<vtkDoubleArray>(
    plane, "SmoothingLength", 1, [](vtkIdType, int) { return SmoothingLength; });
  AddArray<vtkDoubleArray>(plane, "Volume", 1, [](vtkIdType, int) { return Spacing * Spacing; });
  AddArray<vtkDoubleArray>(plane, "Radius", 1,
    [&](vtkIdType i, int) { return std::hypot(points->GetPoint(i)[0], points->GetPoint(i)[2]); });
  auto filter = MakeSphereFilter(plane);
  filter->SetValue(0, 0.6);
  filter->SetValue(1, -1.0);
  filter->SetValue(2, 0.3);
  return filter;
}
}

#endif
