// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Numbers on real particles, for the surfaces that TestSpeedImage and TestFreeSurfaceImage draw:
// size, extent, residual against a brute-force evaluation, trim boundary.
#include "TestDamBreak.h"

#include "vtkFieldData.h"

#include <algorithm>

namespace
{
int failures = 0;

// The fluid particles alone, with a Volume array and the speed as a scalar.
vtkSmartPointer<vtkPolyData> MakeFluid(vtkPolyData* particles)
{
  vtkPointData* data = particles->GetPointData();
  vtkNew<vtkPoints> points;
  vtkNew<vtkDoubleArray> volume;
  vtkNew<vtkDoubleArray> speed;
  volume->SetName("Volume");
  speed->SetName("Speed");
  for (vtkIdType i = 0; i < particles->GetNumberOfPoints(); ++i)
  {
    if (data->GetArray("ParticleType")->GetComponent(i, 0) == 0.0)
    {
      double v[3];
      points->InsertNextPoint(particles->GetPoint(i));
      data->GetArray("Velocity")->GetTuple(i, v);
      speed->InsertNextValue(std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
      volume->InsertNextValue(
        data->GetArray("Mass")->GetComponent(i, 0) / data->GetArray("Density")->GetComponent(i, 0));
    }
  }
  auto fluid = vtkSmartPointer<vtkPolyData>::New();
  fluid->SetPoints(points);
  fluid->GetPointData()->AddArray(volume);
  fluid->GetPointData()->AddArray(speed);
  return fluid;
}

// Worst |field - iso| over a sample of the vertices that are not on the trim boundary.
double WorstResidual(vtkPolyData* surface, vtkPolyData* fluid, double iso, bool freeSurface)
{
  vtkDataArray* flag = surface->GetPointData()->GetArray("BoundaryFlag");
  double worst = 0.0;
  const vtkIdType step = std::max<vtkIdType>(1, surface->GetNumberOfPoints() / 500);
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); i += step)
  {
    if (!flag || flag->GetComponent(i, 0) == 0.0)
    {
      double x[3];
      surface->GetPoint(i, x);
      const test::FieldValue f =
        test::EvaluateField(fluid, fluid->GetPointData()->GetArray("Speed"), 0.0236f, x);
      worst = std::max(worst, std::fabs((freeSurface ? f.Weight : f.Shepard) - iso));
    }
  }
  return worst;
}
// The surface ends where the weight (or the eigenvalue) is the threshold; a linear cut is only near.
void CheckTrimBoundary(vtkPolyData* surface, const char* name, double threshold)
{
  vtkDataArray* weight = surface->GetPointData()->GetArray(name);
  vtkDataArray* flag = surface->GetPointData()->GetArray("BoundaryFlag");
  CHECK(weight && flag);
  int exact = 0, linear = 0, fluid = 0;
  for (vtkIdType i = 0; weight && flag && i < surface->GetNumberOfPoints(); ++i)
  {
    const double w = weight->GetComponent(i, 0);
    const int f = static_cast<int>(flag->GetComponent(i, 0));
    exact += f == 1 ? 1 : 0;
    linear += f == 2 ? 1 : 0;
    CHECK(w > threshold - (f == 2 ? 0.1 : 1e-4));
    fluid += f == 1 && w >= threshold + 1e-4; // the fluid's own weight ends before that of all
  }
  CHECK(exact > 100 && linear * 20 < exact && fluid * 20 < exact);
}
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
  auto fluid = MakeFluid(vtkPolyData::SafeDownCast(filter->GetInputDataObject(0, 0)));
  double range[2];
  fluid->GetPointData()->GetArray("Speed")->GetRange(range);

  vtkPolyData* surface = filter->GetOutput();
  double worst = WorstResidual(surface, fluid, 1.0, false);
  std::cout << "speed: " << surface->GetNumberOfCells() << " triangles, residual " << worst
            << " of " << range[1] - range[0] << "\n";
  CHECK(surface->GetNumberOfCells() > 8000 && surface->GetNumberOfCells() < 20000);
  CHECK(worst <= 1e-5 * (range[1] - range[0]));
  CheckTrimBoundary(surface, "WeightSum", 0.5);
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
  CheckTrimBoundary(surface, "BoundaryEigenvalue", 0.3);

  filter->FreeSurfaceOn();
  filter->Update();
  vtkNew<vtkPolyData> closed;
  closed->ShallowCopy(filter->GetOutput());
  filter->SetSolids(vtkMarchingCorrectors::SOLIDS_AUTO);
  filter->Update();
  CHECK(test::SameSurface(closed, filter->GetOutput())); // the free surface goes on as it did
  surface = filter->GetOutput();
  worst = WorstResidual(surface, fluid, 0.5, true);
  const double* bounds = surface->GetBounds();
  std::cout << "free surface: " << surface->GetNumberOfCells() << " triangles, residual " << worst
            << "\n";
  CHECK(surface->GetNumberOfCells() > 100000);
  CHECK(worst <= 2e-5);
  CHECK(bounds[0] > -0.05 && bounds[1] < 3.27 && bounds[4] > -0.55 && bounds[5] < 0.55);
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
