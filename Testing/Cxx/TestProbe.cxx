// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// The field at the points of data sets: against brute force, in whatever order and class.
#include "TestParticles.h"

#include "vtkCharArray.h"
#include "vtkCommand.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkRectilinearGrid.h"
#include "vtkSPHProbe.h"

#include <algorithm>

namespace
{
int failures = 0;

/// Points in and around the cube; far ones, too.
vtkSmartPointer<vtkPolyData> MakePoints(int count, bool reversed)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(count);
  unsigned int seed = 7;
  for (int i = 0; i < count; ++i)
  {
    double x[3];
    for (double& c : x)
    {
      seed = seed * 1664525u + 1013904223u;
      c = (static_cast<double>(seed >> 8) / (1 << 24) - 0.5) * (i % 50 == 0 ? 1e6 : 2.6);
    }
    points->SetPoint(reversed ? count - 1 - i : i, x);
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  return data;
}

vtkSmartPointer<vtkSPHProbe> MakeProbe(vtkDataObject* points, vtkDataObject* particles)
{
  auto probe = vtkSmartPointer<vtkSPHProbe>::New();
  probe->SetInputDataObject(points);
  probe->SetSourceData(particles);
  return probe;
}

vtkPointData* OutputOf(vtkSPHProbe* probe)
{
  return vtkDataSet::SafeDownCast(probe->GetOutput())->GetPointData();
}

void CheckValues(bool sum)
{
  auto cube = test::MakeCube();
  auto points = MakePoints(800, false);
  test::AddArray<vtkIntArray>(points, "Number", 1, [](vtkIdType i, int) { return i; });
  auto probe = MakeProbe(points, cube);
  probe->SetShepardNormalization(!sum);
  probe->SetPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  probe->SetWeightThreshold(0.3);
  probe->Update();
  vtkPointData* output = OutputOf(probe);
  vtkDataArray *radius = output->GetArray("Radius"), *weight = output->GetArray("WeightSum");
  auto* mask = vtkCharArray::SafeDownCast(output->GetArray("vtkValidPointMask"));
  CHECK(output->GetArray("Number") == points->GetPointData()->GetArray("Number"));
  CHECK(radius && weight && mask && !output->GetArray("Radius_Gradient"));
  int valid = 0, far = 0;
  for (vtkIdType i = 0; radius && weight && mask && i < points->GetNumberOfPoints(); ++i)
  {
    double x[3];
    points->GetPoint(i, x);
    const test::FieldValue field =
      test::EvaluateField(cube, cube->GetPointData()->GetArray("Radius"), test::SmoothingLength, x);
    const bool isValid = field.Weight >= 0.3;
    const double expected = !isValid ? 0.0 : sum ? field.Sum : field.Shepard;
    CHECK(std::abs(weight->GetComponent(i, 0) - field.Weight) < 1e-12);
    CHECK(mask->GetValue(i) == (isValid ? 1 : 0));
    CHECK(std::abs(radius->GetComponent(i, 0) - expected) < 1e-12);
    valid += isValid;
    far += field.Weight == 0.0;
  }
  CHECK(valid > 200 && far > 16);
}

/// Gradients of a linear array inside of the cube: the particles' gradient to some digits; of the
/// weight, 0.
void CheckGradients()
{
  auto cube = test::MakeCube();
  test::AddArray<vtkFloatArray>(
    cube, "Pair", 2, [&](vtkIdType i, int c) { return (c + 1) * cube->GetPoint(i)[1] + 100.0; });
  vtkNew<vtkImageData> image;
  image->SetDimensions(9, 9, 3);
  image->SetOrigin(-0.4, -0.4, -0.1);
  image->SetSpacing(0.1, 0.1, 0.1);
  auto probe = MakeProbe(image, cube);
  probe->ComputeGradientsOn();
  probe->Update();
  vtkDataArray* gradient = OutputOf(probe)->GetArray("Pair_Gradient");
  CHECK(gradient && gradient->GetNumberOfComponents() == 6 && gradient->GetDataType() == VTK_FLOAT);
  CHECK(OutputOf(probe)->GetArray("WeightSum_Gradient"));
  double mean[6] = {};
  for (vtkIdType i = 0; gradient && i < image->GetNumberOfPoints(); ++i)
  {
    for (int c = 0; c < 6; ++c)
    {
      mean[c] += gradient->GetComponent(i, c) / static_cast<double>(image->GetNumberOfPoints());
    }
  }
  for (int c = 0; c < 6; ++c)
  {
    CHECK(std::abs(mean[c] - (c == 1 ? 1.0 : c == 4 ? 2.0 : 0.0)) < 0.05);
  }
}

/// Same bits in any order, of points in any class, with device data kept or not.
void CheckBits()
{
  auto cube = test::MakeCube();
  const int count = 5000;
  auto probe = MakeProbe(MakePoints(count, false), cube);
  auto back = MakeProbe(MakePoints(count, true), cube);
  back->KeepDeviceDataOff();
  probe->Update();
  back->Update();
  bool same = true;
  for (const char* name : { "Radius", "WeightSum" })
  {
    vtkDataArray *a = OutputOf(probe)->GetArray(name), *b = OutputOf(back)->GetArray(name);
    for (int i = 0; i < count; ++i)
    {
      same = same && a->GetComponent(i, 0) == b->GetComponent(count - 1 - i, 0);
    }
  }
  CHECK(same);
  vtkNew<vtkImageData> image;
  image->SetExtent(-5, 5, 2, 12, 0, 0);
  image->SetSpacing(0.125, 0.125, 0.125);
  vtkNew<vtkRectilinearGrid> grid;
  grid->SetExtent(image->GetExtent());
  vtkNew<vtkDoubleArray> x, y, z;
  for (int i = 0; i < 11; ++i)
  {
    x->InsertNextValue((i - 5) * 0.125);
    y->InsertNextValue((i + 2) * 0.125);
  }
  z->InsertNextValue(0.0);
  grid->SetXCoordinates(x);
  grid->SetYCoordinates(y);
  grid->SetZCoordinates(z);
  vtkNew<vtkMultiBlockDataSet> both;
  both->SetBlock(0, image);
  both->SetBlock(1, grid);
  probe->SetInputDataObject(both);
  probe->Update();
  auto* output = vtkMultiBlockDataSet::SafeDownCast(probe->GetOutput());
  auto* first = vtkImageData::SafeDownCast(output->GetBlock(0));
  auto* second = vtkRectilinearGrid::SafeDownCast(output->GetBlock(1));
  CHECK(first && second &&
    test::SameValues(
      first->GetPointData()->GetArray("Radius"), second->GetPointData()->GetArray("Radius")));
  CHECK(first->GetPointData()->GetArray("WeightSum")->GetComponent(20, 0) > 0.5);
  CHECK(first->GetExtent()[2] == 2);
}

/// More points than are treated at a time, of an image that is turned: one of the last is what it is alone.
void CheckChunks()
{
  auto cube = test::MakeCube();
  vtkNew<vtkImageData> image;
  image->SetExtent(0, 1099, 0, 1099, 3, 3);
  image->SetDirectionMatrix(
    -8.0 / 9, 1.0 / 9, 4.0 / 9, 4.0 / 9, 4.0 / 9, 7.0 / 9, 1.0 / 9, -8.0 / 9, 4.0 / 9);
  image->SetOrigin(0.5, -1.5, 2.6);
  image->SetSpacing(2.4 / 1100, 2.4 / 1100, 0.1);
  auto probe = MakeProbe(image, cube);
  probe->AddExcludedArray("Volume");
  probe->KeepDeviceDataOff();
  probe->Update();
  CHECK(!OutputOf(probe)->GetArray("Volume") && OutputOf(probe)->GetArray("Radius"));
  const vtkIdType last = 1030 * 1100 + 500; // beyond the first 2^20
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->InsertNextPoint(image->GetPoint(last));
  vtkNew<vtkPolyData> one;
  one->SetPoints(points);
  auto alone = MakeProbe(one, cube);
  alone->Update();
  CHECK(OutputOf(alone)->GetArray("Radius")->GetComponent(0, 0) > 0.5);
  CHECK(OutputOf(alone)->GetArray("Radius")->GetComponent(0, 0) ==
    OutputOf(probe)->GetArray("Radius")->GetComponent(last, 0));
}

/// Blocks of particles count as one set, with the arrays that all have; solids do not count.
void CheckSources()
{
  auto cube = test::MakeCube();
  auto points = MakePoints(500, false);
  auto whole = MakeProbe(points, cube);
  whole->Update();
  vtkNew<vtkMultiBlockDataSet> blocks;
  for (int half = 0; half < 2; ++half)
  {
    vtkNew<vtkPolyData> part;
    vtkNew<vtkPoints> places;
    places->SetDataTypeToDouble();
    part->SetPoints(places);
    part->GetPointData()->CopyAllocate(cube->GetPointData());
    for (vtkIdType i = half; i < cube->GetNumberOfPoints(); i += 2)
    {
      part->GetPointData()->CopyData(
        cube->GetPointData(), i, places->InsertNextPoint(cube->GetPoint(i)));
    }
    if (half)
    {
      part->GetPointData()->RemoveArray("Radius");
    }
    blocks->SetBlock(static_cast<unsigned int>(half), part);
  }
  auto joined = MakeProbe(points, blocks);
  joined->Update();
  CHECK(test::SameValues(
    OutputOf(whole)->GetArray("WeightSum"), OutputOf(joined)->GetArray("WeightSum")));
  CHECK(!OutputOf(joined)->GetArray("Radius"));
  test::AddArray<vtkIntArray>(
    cube, "Type", 1, [&](vtkIdType i, int) { return cube->GetPoint(i)[0] > 0.0; });
  whole->SetFluidArrayName("Type");
  whole->Update();
  vtkDataArray* weight = OutputOf(whole)->GetArray("WeightSum");
  bool good = true;
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    const double x = points->GetPoint(i)[0];
    good = good && (x < 0.3 || weight->GetComponent(i, 0) == 0.0);
  }
  CHECK(good && weight->GetRange()[1] > 0.9);
  CHECK(!OutputOf(whole)->GetArray("Type"));
}

/// Nothing to probe, nothing to probe with, what cannot be used, and a run that is stopped.
void CheckOddities()
{
  auto cube = test::MakeCube();
  auto points = MakePoints(100, false);
  auto probe = MakeProbe(points, vtkSmartPointer<vtkPolyData>::New());
  probe->Update();
  CHECK(probe->GetErrorMessage()[0] == '\0');
  CHECK(OutputOf(probe)->GetArray("vtkValidPointMask")->GetNumberOfTuples() == 100);
  CHECK(OutputOf(probe)->GetArray("vtkValidPointMask")->GetRange()[1] == 0.0);
  probe->SetInputDataObject(vtkSmartPointer<vtkPolyData>::New());
  probe->SetSourceData(cube);
  probe->Update();
  CHECK(probe->GetErrorMessage()[0] == '\0');
  CHECK(OutputOf(probe)->GetArray("Radius")->GetNumberOfTuples() == 0);
  for (int port = 0; port < 2; ++port)
  {
    vtkNew<vtkSPHProbe> forgotten;
    int told = 0;
    test::CountEvents(forgotten, vtkCommand::ErrorEvent, &told);
    forgotten->SetInputDataObject(1 - port, cube);
    forgotten->Update();
    CHECK(
      told == 1 && std::strstr(forgotten->GetErrorMessage(), port == 0 ? "points" : "particles"));
  }
  probe->SetInputDataObject(points);
  int warnings = 0, errors = 0;
  test::CountEvents(probe, vtkCommand::WarningEvent, &warnings);
  test::CountEvents(probe, vtkCommand::ErrorEvent, &errors);
  auto* radius = cube->GetPointData()->GetArray("Radius");
  radius->SetComponent(3, 0, std::nan(""));
  cube->Modified();
  probe->Update();
  CHECK(warnings == 1 && !OutputOf(probe)->GetArray("Radius"));
  probe->InterpolateAttributesOff();
  probe->SetValidPointMaskArrayName("Mask");
  probe->Update();
  CHECK(OutputOf(probe)->GetNumberOfArrays() == 2 && OutputOf(probe)->GetArray("Mask"));
  probe->SetSmoothingLengthArrayName("Nonsense");
  probe->Update();
  CHECK(errors > 0 && std::strstr(probe->GetErrorMessage(), "'Nonsense'"));
  CHECK(vtkPolyData::SafeDownCast(probe->GetOutput())->GetNumberOfPoints() == 0);
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
  probe->SetSmoothingLengthArrayName("");
  probe->AddObserver(vtkCommand::ProgressEvent, stop);
  probe->Update();
  CHECK(probe->GetErrorMessage()[0] == '\0');
  CHECK(vtkPolyData::SafeDownCast(probe->GetOutput())->GetNumberOfPoints() == 0);
}
}

int TestProbe(int, char*[])
{
  CheckValues(false);
  CheckValues(true);
  CheckGradients();
  CheckBits();
  CheckChunks();
  CheckSources();
  CheckOddities();
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
