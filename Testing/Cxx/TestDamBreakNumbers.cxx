// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Real particles, for the surfaces that TestSpeedImage and TestFreeSurfaceImage draw: what is found in the file, how
// large surfaces are, and where they end at walls. The oracle has their points (oracle_data).
#include "TestDamBreak.h"

#include "vtkFieldData.h"

namespace
{
int failures = 0;

}

int TestDamBreakNumbers(int argc, char* argv[])
{
  auto filter = test::MakeDamBreakFilter(argc, argv);
  filter->SetSolids(vtkMarchingCorrectors::SOLIDS_WEIGHT);
  filter->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  filter->ComputeBoundaryFlagOn();
  filter->ComputeWeightSumOn();
  filter->Update();
  CHECK(!std::strcmp(filter->GetUsedMassArrayName(), "Mass"));
  CHECK(!std::strcmp(filter->GetUsedDensityArrayName(), "Density"));
  vtkPolyData* surface = filter->GetOutput();
  CHECK(surface->GetNumberOfCells() > 8000 && surface->GetNumberOfCells() < 20000);
  vtkFieldData* run = filter->GetRunStatistics();
  CHECK(run->GetArray("SolidParticles")->GetComponent(0, 0) == 55348.0);

  // By default a scalar's surface ends at the walls, and only there is less of it.
  const vtkIdType behind = surface->GetNumberOfCells();
  filter->SetSolids(vtkMarchingCorrectors::SOLIDS_AUTO);
  filter->Update();
  std::cout << "to the walls: " << filter->GetOutput()->GetNumberOfCells() << " triangles\n";
  CHECK(vtkNew<vtkMarchingCorrectors>()->GetSolids() == vtkMarchingCorrectors::SOLIDS_AUTO);
  CHECK(filter->GetOutput()->GetNumberOfCells() < behind);
  CHECK(filter->GetOutput()->GetNumberOfCells() > behind / 2);
  auto byHand = test::MakeDamBreakFilter(argc, argv);
  byHand->SetSolids(vtkMarchingCorrectors::SOLIDS_WALL);
  byHand->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  byHand->ComputeBoundaryFlagOn();
  byHand->ComputeWeightSumOn();
  byHand->Update();
  CHECK(test::SameSurface(byHand->GetOutput(), filter->GetOutput()));
  filter->SetSolids(vtkMarchingCorrectors::SOLIDS_WEIGHT);

  filter->SetBoundaryDetectionToEigenvalue();
  filter->SetVertexThreshold(0.3);
  filter->ComputeBoundaryEigenvalueOn();
  filter->Update();
  surface = filter->GetOutput();
  std::cout << "trimmed by the eigenvalue: " << surface->GetNumberOfCells() << " triangles\n";
  CHECK(surface->GetNumberOfCells() > 8000 && surface->GetNumberOfCells() < 20000);
  CHECK(surface->GetPointData()->HasArray("BoundaryEigenvalue"));

  filter->FreeSurfaceOn();
  filter->Update();
  vtkNew<vtkPolyData> closed;
  closed->ShallowCopy(filter->GetOutput());
  filter->SetSolids(vtkMarchingCorrectors::SOLIDS_AUTO);
  filter->Update();
  CHECK(test::SameSurface(closed, filter->GetOutput())); // the free surface goes on as it did
  surface = filter->GetOutput();
  const double* bounds = surface->GetBounds();
  CHECK(surface->GetNumberOfCells() > 100000);
  CHECK(bounds[0] > -0.05 && bounds[1] < 3.27 && bounds[4] > -0.55 && bounds[5] < 0.55);
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
