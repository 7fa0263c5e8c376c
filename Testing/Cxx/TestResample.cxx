// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Slices, lines and volumes: where their points are, their values as the probe has them, NaN outside.
#include "TestParticles.h"

#include "vtkCommand.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkSPHResample.h"

#include <algorithm>

namespace
{
int failures = 0;

vtkSmartPointer<vtkPolyData> MakeParticles()
{
  auto cube = test::MakeCube();
  test::AddArray<vtkDoubleArray>(
    cube, "Velocity", 3, [&](vtkIdType i, int c) { return cube->GetPoint(i)[c] + 3.0; });
  return cube;
}

vtkSmartPointer<vtkSPHResample> MakeResample(vtkDataObject* particles, int shape)
{
  auto filter = vtkSmartPointer<vtkSPHResample>::New();
  filter->SetInputDataObject(particles);
  filter->SetShape(shape);
  filter->SetResolution(41);
  filter->SetWeightThreshold(0.4); // so that the fluid ends before the points do
  return filter;
}

/// The filter's points and values against the probe's at these points.
void CheckValues(vtkSPHResample* filter, vtkPolyData* particles)
{
  auto* made = vtkDataSet::SafeDownCast(filter->GetOutput());
  auto bare = vtk::TakeSmartPointer(made->NewInstance());
  bare->CopyStructure(made);
  vtkNew<vtkSPHProbe> probe;
  probe->SetInputDataObject(bare);
  probe->SetSourceData(particles);
  probe->SetWeightThreshold(filter->GetWeightThreshold());
  probe->Update();
  vtkPointData* expected = vtkDataSet::SafeDownCast(probe->GetOutput())->GetPointData();
  vtkPointData* data = made->GetPointData();
  CHECK(test::SameValues(expected->GetArray("WeightSum"), data->GetArray("WeightSum")));
  vtkDataArray *mask = data->GetArray("vtkValidPointMask"), *radius = data->GetArray("Radius");
  CHECK(mask && radius && data->GetScalars() == data->GetArray("Velocity"));
  int valid = 0;
  for (vtkIdType i = 0; mask && radius && i < made->GetNumberOfPoints(); ++i)
  {
    const bool isValid = mask->GetComponent(i, 0) != 0.0;
    CHECK(isValid ? radius->GetComponent(i, 0) == expected->GetArray("Radius")->GetComponent(i, 0)
                  : std::isnan(radius->GetComponent(i, 0)) &&
          expected->GetArray("Radius")->GetComponent(i, 0) == 0.0);
    valid += isValid ? 1 : 0;
  }
  CHECK(valid > 10 && valid < made->GetNumberOfPoints());
}

void TestSlice()
{
  auto cube = MakeParticles();
  auto filter = MakeResample(cube, vtkSPHResample::SLICE);
  filter->SetNormal(0.0, 2.0, 0.0);
  filter->Update();
  auto* slice = vtkPolyData::SafeDownCast(filter->GetOutput());
  double bounds[6];
  slice->GetPoints()->GetBounds(bounds);
  CHECK(slice->GetNumberOfPoints() >= 41 * 40 && slice->GetNumberOfPoints() <= 41 * 41);
  CHECK(std::fabs(bounds[2]) < 0.02 && bounds[3] == bounds[2]);
  CHECK(bounds[0] < -1.0 && bounds[0] > -1.2 && bounds[5] > 1.0 && bounds[5] < 1.2);
  CheckValues(filter, cube);
  // Quads end where the fluid does.
  CHECK(slice->GetNumberOfCells() > 30 * 30 && slice->GetNumberOfCells() < 40 * 39);
  filter->OnlyFluidOff();
  filter->Update();
  slice = vtkPolyData::SafeDownCast(filter->GetOutput());
  CHECK(slice->GetNumberOfCells() >= 40 * 39);

  // An inclined plane: its points are on it, and the cube's corner is cut off.
  filter->FitBoundsOff();
  filter->SetOrigin(0.5, 0.5, 0.5);
  filter->SetNormal(1.0, 1.0, 1.0);
  filter->Update();
  slice = vtkPolyData::SafeDownCast(filter->GetOutput());
  for (vtkIdType i = 0; i < slice->GetNumberOfPoints(); ++i)
  {
    const double* x = slice->GetPoint(i);
    CHECK(std::fabs(x[0] + x[1] + x[2] - 1.5) < 1e-12);
  }
  slice->GetPoints()->GetBounds(bounds);
  CHECK(bounds[1] > 1.0 && bounds[0] < 0.0);
  CheckValues(filter, cube);

  filter->SetOrigin(5.0, 0.0, 0.0); // beside the fluid
  filter->SetNormal(1.0, 0.0, 0.0);
  filter->Update();
  CHECK(vtkPolyData::SafeDownCast(filter->GetOutput())->GetNumberOfPoints() == 0);
  CHECK(!*filter->GetErrorMessage());
}

void TestLine()
{
  auto cube = MakeParticles();
  auto filter = MakeResample(cube, vtkSPHResample::LINE);
  filter->FitBoundsOff();
  filter->SetPoint1(-2.0, 0.1, 0.1);
  filter->SetPoint2(2.0, 0.1, 0.1);
  filter->Update();
  auto* line = vtkPolyData::SafeDownCast(filter->GetOutput());
  CHECK(line->GetNumberOfPoints() == 41 && line->GetNumberOfLines() == 1);
  vtkDataArray* along = line->GetPointData()->GetArray("arc_length");
  CHECK(along && along->GetComponent(0, 0) == 0.0 &&
    std::fabs(along->GetComponent(40, 0) - 4.0) < 1e-12);
  CheckValues(filter, cube);
  filter->FitBoundsOn();
  filter->Update();
  line = vtkPolyData::SafeDownCast(filter->GetOutput());
  CHECK(line->GetLength() > 2.0 && line->GetLength() < 2.3);
}

void TestVolume()
{
  auto cube = MakeParticles();
  auto filter = MakeResample(cube, vtkSPHResample::VOLUME);
  filter->SetDimensions(20, 10, 5);
  filter->Update();
  auto* image = vtkImageData::SafeDownCast(filter->GetOutput());
  CHECK(image && image->GetNumberOfPoints() == 1000 && image->GetDimensions()[1] == 10);
  CHECK(image->GetBounds()[0] < -1.0 && image->GetBounds()[5] > 1.0);
  CheckValues(filter, cube);
  filter->FitBoundsOff();
  filter->SetBounds(0.0, 3.0, 0.0, 0.5, -0.5, 0.5);
  filter->NaNOutsideOff();
  filter->SetNullValue(-9.0);
  filter->Update();
  image = vtkImageData::SafeDownCast(filter->GetOutput());
  CHECK(image->GetBounds()[1] == 3.0);
  CHECK(image->GetPointData()->GetArray("Radius")->GetRange()[0] == -9.0);
  filter->SetShape(vtkSPHResample::SLICE); // another class of output
  filter->Update();
  CHECK(vtkPolyData::SafeDownCast(filter->GetOutput()));
}

// Walls do not count, in the bounds neither; blocks are one set; nothing is no error.
void TestInputs()
{
  auto cube = MakeParticles();
  test::AddArray<vtkIntArray>(
    cube, "ParticleType", 1, [&](vtkIdType i, int) { return cube->GetPoint(i)[0] > 0.05 ? 1 : 0; });
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, cube);
  auto filter = MakeResample(blocks, vtkSPHResample::SLICE);
  filter->DetectFluidOn();
  filter->Update();
  auto* slice = vtkPolyData::SafeDownCast(filter->GetOutput());
  CHECK(slice && slice->GetPoints()->GetBounds()[1] < 0.2 && slice->GetNumberOfCells() > 0);
  CHECK(!std::strcmp(filter->GetUsedFluid(), "ParticleType = 0"));
  filter->SetInputDataObject(vtkNew<vtkPolyData>());
  int errors = 0;
  test::CountEvents(filter, vtkCommand::ErrorEvent, &errors);
  filter->Update();
  CHECK(errors == 0 && vtkPolyData::SafeDownCast(filter->GetOutput())->GetNumberOfPoints() == 0);
}
}

int TestResample(int, char*[])
{
  TestSlice();
  TestLine();
  TestVolume();
  TestInputs();
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
