// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Filters in several threads do not disturb each other.
#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

namespace
{
/// Returns a new ball of particles, because each filter gets its own.
vtkSmartPointer<vtkPolyData> MakeParticles()
{
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  vtkNew<vtkDoubleArray> radius;
  points->SetDataTypeToDouble();
  radius->SetName("Radius");
  for (int i = 0; i < 21 * 21 * 21; ++i)
  {
    const double x = 0.1 * (i % 21 - 10), y = 0.1 * (i / 21 % 21 - 10), z = 0.1 * (i / 441 - 10);
    points->InsertNextPoint(x, y, z);
    radius->InsertNextValue(std::sqrt(x * x + y * y + z * z));
  }
  particles->SetPoints(points);
  particles->GetPointData()->AddArray(radius);
  return particles;
}

/// Returns all numbers of a surface as text.
std::string Extract(bool isFree)
{
  vtkNew<vtkMarchingCorrectors> filter;
  filter->SetInputData(MakeParticles());
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Radius");
  filter->SetValue(0, 0.6);
  filter->SetSmoothingLength(0.13);
  filter->SetFreeSurface(isFree);
  vtkNew<vtkCallbackCommand> observer;
  observer->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
  filter->AddObserver(vtkCommand::ProgressEvent, observer);
  filter->Update();
  vtkPolyData* surface = filter->GetOutput();
  std::string numbers;
  for (vtkDataArray* array : { surface->GetPoints()->GetData(),
         surface->GetPolys()->GetConnectivityArray(), surface->GetPointData()->GetNormals() })
  {
    for (vtkIdType i = 0; array && i < array->GetNumberOfValues(); ++i)
    {
      numbers += array->GetVariantValue(i).ToString() + " ";
    }
  }
  return numbers;
}
}

int TestThreads(int, char*[])
{
  std::vector<std::string> surfaces(4);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < surfaces.size(); ++i)
  {
    threads.emplace_back([&surfaces, i] { surfaces[i] = Extract(i % 2 != 0); });
  }
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  const bool good = surfaces[0].size() > 10000 && surfaces[1].size() > 10000 &&
    surfaces[0] == surfaces[2] && surfaces[1] == surfaces[3] && surfaces[0] == Extract(false);
  std::cout << (good ? "" : "The surfaces differ.\n");
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
