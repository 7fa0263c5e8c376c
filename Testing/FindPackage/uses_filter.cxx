// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers SPDX-License-Identifier: BSD-3-Clause
// Extracts the free surface of one particle with the installed filter.
#include <vtkMarchingCorrectors.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <iostream>

int main()
{
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(1.0, 2.0, 3.0);
  vtkNew<vtkPolyData> particles;
  particles->SetPoints(points);
  vtkNew<vtkMarchingCorrectors> filter;
  filter->SetInputData(particles);
  filter->SetSmoothingLength(0.1);
  filter->FreeSurfaceOn();
  filter->Update();
  std::cout << "filter: " << filter->GetOutput()->GetNumberOfCells() << " triangles\n";
  return filter->GetOutput()->GetNumberOfCells() > 0 ? 0 : 1;
}
