// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Checks that the free surface of a ball of particles is closed, and as large as the ball.
#include "vtkMarchingCorrectors.h"

#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <cmath>
#include <cstdlib>
#include <iostream>

int TestMarchingCorrectorsBall(int, char*[])
{
  vtkNew<vtkPoints> points;
  for (int x = -10; x <= 10; ++x)
  {
    for (int y = -10; y <= 10; ++y)
    {
      for (int z = -10; z <= 10; ++z)
      {
        if (x * x + y * y + z * z <= 100)
        {
          points->InsertNextPoint(0.1 * x, 0.1 * y, 0.1 * z);
        }
      }
    }
  }
  vtkNew<vtkPolyData> particles;
  particles->SetPoints(points);
  vtkNew<vtkMarchingCorrectors> surface;
  surface->SetInputData(particles);
  surface->SetSmoothingLength(0.13);
  surface->FreeSurfaceOn();
  surface->Update();
  vtkDataArray* volume = surface->GetRunStatistics()->GetArray("Volume");
  const double found = volume ? volume->GetComponent(0, 0) : 0.0;
  const double expected = 0.001 * static_cast<double>(points->GetNumberOfPoints());
  if (std::fabs(found / expected - 1.0) > 0.15)
  {
    std::cerr << "the volume is " << found << ", not about " << expected << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
