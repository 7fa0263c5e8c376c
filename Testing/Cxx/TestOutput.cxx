// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Contents of the output: arrays, their names and types, precision of the points, field data; and
// the filter's own state.
#include "TestParticles.h"

#include "vtkCommand.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkMassProperties.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <sstream>

namespace
{
int failures = 0;

double Number(vtkFieldData* data, const char* name)
{
  vtkDataArray* array = data->GetArray(name);
  CHECK(array && array->GetNumberOfTuples() == 1);
  return array ? array->GetComponent(0, 0) : 0.0;
}

std::string Text(vtkFieldData* data, const char* name)
{
  auto* array = vtkStringArray::SafeDownCast(data->GetAbstractArray(name));
  CHECK(array && array->GetNumberOfValues() == 1);
  return array ? std::string(array->GetValue(0)) : "";
}

// The particle nearest to a point, by brute force.
vtkIdType Nearest(vtkPolyData* particles, const double x[3])
{
  vtkIdType best = -1;
  double bestDistance = 1e99;
  for (vtkIdType i = 0; i < particles->GetNumberOfPoints(); ++i)
  {
    double p[3];
    particles->GetPoint(i, p);
    const double dx = x[0] - p[0], dy = x[1] - p[1], dz = x[2] - p[2];
    const double distance = dx * dx + dy * dy + dz * dz;
    if (distance < bestDistance)
    {
      bestDistance = distance;
      best = i;
    }
  }
  return best;
}

vtkSmartPointer<vtkPolyData> MakeParticles()
{
  auto cube = test::MakeCube();
  auto vectors = test::AddArray<vtkFloatArray>(
    cube, "Position", 3, [&](vtkIdType i, int c) { return cube->GetPoint(i)[c]; });
  vectors->SetComponentName(1, "Height");
  test::AddArray<vtkIdTypeArray>(
    cube, "Id", 1, [](vtkIdType i, int) { return static_cast<double>(i); });
  test::AddArray<vtkUnsignedCharArray>(
    cube, vtkDataSetAttributes::GhostArrayName(), 1, [](vtkIdType, int) { return 1.0; });
  vtkNew<vtkStringArray> names;
  names->SetName("Name");
  for (vtkIdType i = 0; i < cube->GetNumberOfPoints(); ++i)
  {
    names->InsertNextValue("particle " + std::to_string(i));
  }
  cube->GetPointData()->AddArray(names);
  vtkNew<vtkDoubleArray> time;
  time->SetName("TimeValue");
  time->InsertNextValue(0.9);
  cube->GetFieldData()->AddArray(time);
  return cube;
}

void TestAttributes()
{
  auto cube = MakeParticles();
  auto filter = test::MakeSphereFilter(cube);
  filter->Update();
  vtkPolyData* surface = filter->GetOutput();
  vtkPointData* data = surface->GetPointData();
  CHECK(surface->GetNumberOfPoints() > 0);
  CHECK(!data->HasArray(vtkDataSetAttributes::GhostArrayName()));

  vtkDataArray* position = data->GetArray("Position");
  CHECK(position && position->GetDataType() == VTK_FLOAT);
  CHECK(position && position->GetNumberOfComponents() == 3);
  CHECK(position && position->GetComponentName(1) &&
    !std::strcmp(position->GetComponentName(1), "Height"));
  CHECK(data->GetArray("Volume") && data->GetArray("Volume")->GetDataType() == VTK_DOUBLE);
  vtkDataArray* id = data->GetArray("Id");
  auto* name = vtkStringArray::SafeDownCast(data->GetAbstractArray("Name"));
  CHECK(id && id->GetDataType() == VTK_ID_TYPE);
  CHECK(name != nullptr);
  for (vtkIdType i = 0; position && id && name && i < surface->GetNumberOfPoints(); i += 53)
  {
    double x[3];
    surface->GetPoint(i, x);
    const vtkIdType nearest = Nearest(cube, x);
    CHECK(static_cast<vtkIdType>(id->GetComponent(i, 0)) == nearest);
    CHECK(name->GetValue(i) == "particle " + std::to_string(nearest));
    for (int c = 0; c < 3; ++c)
    {
      vtkNew<vtkDoubleArray> component;
      cube->GetPointData()
        ->GetArray("Position")
        ->GetData(0, cube->GetNumberOfPoints() - 1, c, c, component);
      const double expected =
        test::EvaluateField(cube, component, test::SmoothingLength, x).Shepard;
      CHECK(std::fabs(position->GetComponent(i, c) - expected) < 1e-5);
    }
  }
  filter->InterpolateAttributesOff();
  filter->Update();
  CHECK(!filter->GetOutput()->GetPointData()->HasArray("Position"));
  CHECK(!filter->GetOutput()->GetPointData()->HasArray("Id"));
}

// Some are left out: those that the user excludes, and with a warning those that are not finite
// where there is fluid.
void TestArraysLeftOut()
{
  auto cube = MakeParticles();
  const auto broken = [&](double solid)
  {
    return [&cube, solid](vtkIdType i, int c) {
      return i == 31 && c == 1 ? std::nan("") : cube->GetPoint(i)[0] < -0.9 ? solid : 1.0;
    };
  };
  test::AddArray<vtkFloatArray>(cube, "Broken", 3, broken(1.0));
  test::AddArray<vtkDoubleArray>(cube, "BrokenWall", 1, broken(HUGE_VAL));
  test::AddArray<vtkDoubleArray>(
    cube, "Wall", 1, [&](vtkIdType i, int) { return cube->GetPoint(i)[0] < -0.9 ? 1.0 : 0.0; });
  auto filter = test::MakeSphereFilter(cube);
  filter->SetFluidArrayName("Wall");
  std::string warning;
  vtkNew<vtkCallbackCommand> observer;
  observer->SetCallback([](vtkObject*, unsigned long, void* data, void* text)
    { *static_cast<std::string*>(data) += static_cast<const char*>(text); });
  observer->SetClientData(&warning);
  filter->AddObserver(vtkCommand::WarningEvent, observer);
  filter->Update();
  std::cout << warning;
  vtkPointData* data = filter->GetOutput()->GetPointData();
  CHECK(warning.find("'Broken' is NaN or infinite at particle 31 ") != std::string::npos);
  CHECK(warning.find("BrokenWall") == std::string::npos);
  CHECK(!*filter->GetErrorMessage());
  CHECK(filter->GetOutput()->GetNumberOfPoints() > 0);
  CHECK(!data->HasArray("Broken") && data->HasArray("BrokenWall") && data->HasArray("Position"));

  warning.clear();
  const vtkMTimeType time = filter->GetMTime();
  for (const char* name : { "Broken", "Id", "Name", "Volume", "no such array" })
  {
    filter->AddExcludedArray(name);
  }
  CHECK(filter->GetMTime() > time);
  CHECK(filter->GetNumberOfExcludedArrays() == 5);
  CHECK(!std::strcmp(filter->GetExcludedArray(1), "Id"));
  CHECK(!filter->GetExcludedArray(5) && !filter->GetExcludedArray(-1));
  filter->Update();
  data = filter->GetOutput()->GetPointData();
  CHECK(warning.empty());
  CHECK(!data->HasArray("Id") && !data->HasArray("Name") && !data->HasArray("Volume"));
  CHECK(data->HasArray("Position") && data->HasArray("Radius"));
  CHECK(!std::strcmp(filter->GetUsedVolumeArrayName(), "Volume"));
  filter->ClearExcludedArrays();
  filter->Update();
  CHECK(filter->GetOutput()->GetPointData()->HasArray("Id"));
}

// A computed array has its place whatever the input's arrays are called, the contoured one too.
void TestNames()
{
  auto cube = test::MakeCube();
  vtkDataArray* radius = cube->GetPointData()->GetArray("Radius");
  for (const char* name : { "Normals", "WeightSum", "IsoValue" })
  {
    test::AddArray<vtkFloatArray>(
      cube, name, 1, [&](vtkIdType i, int) { return radius->GetComponent(i, 0); });
  }
  auto filter = test::MakeSphereFilter(cube);
  vtkPolyData* surface = filter->GetOutput();
  const auto extract = [&](const char* scalar)
  {
    filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, scalar);
    filter->Update();
    CHECK(surface->GetNumberOfPoints() > 0);
    return surface->GetPointData();
  };
  const auto isoArray = [](vtkPointData* data)
  {
    std::string name; // of the one that is the iso value everywhere
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      vtkDataArray* array = data->GetArray(i);
      if (array && std::fabs(array->GetRange()[0] - 0.6) < 1e-6 &&
        array->GetRange()[0] == array->GetRange()[1])
      {
        CHECK(name.empty());
        name = array->GetName();
      }
    }
    return name;
  };
  const auto count = [](vtkPointData* data, const char* name)
  {
    int found = 0;
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      found += std::strcmp(data->GetArrayName(i), name) == 0 ? 1 : 0;
    }
    return found;
  };
  for (const char* scalar : { "Radius", "Normals" })
  {
    vtkPointData* data = extract(scalar);
    CHECK(data->GetNormals() && data->GetNormals() == data->GetArray("Normals"));
    CHECK(data->GetNormals() && data->GetNormals()->GetNumberOfComponents() == 3);
    CHECK(count(data, "Normals") == 1 && count(data, "IsoValue") == 1);
    CHECK(isoArray(data) == (std::strcmp(scalar, "Normals") ? "Radius" : "IsoValue"));
    CHECK(Text(filter->GetRunStatistics(), "Scalar") == scalar);
  }
  filter->ComputeWeightSumOn();
  CHECK(isoArray(extract("WeightSum")) == "IsoValue");
  CHECK(surface->GetPointData()->GetArray("WeightSum")->GetRange()[1] > 0.9);

  // Not computed: an array like all others, and no normals.
  filter->ComputeNormalsOff();
  filter->ComputeWeightSumOff();
  vtkPointData* data = extract("Radius");
  CHECK(!data->GetNormals() && data->GetArray("Normals")->GetNumberOfComponents() == 1);
  CHECK(std::fabs(data->GetArray("WeightSum")->GetComponent(0, 0) - 0.6) < 0.05);
  CHECK(isoArray(extract("Normals")) == "Normals");
  filter->ComputeScalarsOff();
  data = extract("Normals");
  CHECK(data->GetArray("Normals")->GetRange()[1] > 0.6);

  // Active scalars without a name are the default.
  vtkNew<vtkDoubleArray> unnamed;
  unnamed->DeepCopy(radius);
  unnamed->SetName(nullptr);
  cube->GetPointData()->SetScalars(unnamed);
  vtkNew<vtkMarchingCorrectors> untold;
  untold->SetInputData(cube);
  untold->SetValue(0, 0.6);
  untold->Update();
  CHECK(!*untold->GetErrorMessage() && untold->GetOutput()->GetNumberOfPoints() > 0);
  CHECK(isoArray(untold->GetOutput()->GetPointData()) == "IsoValue");
}

void TestComputedArrays()
{
  auto filter = test::MakeSphereFilter(MakeParticles());
  filter->ComputeGradientsOn();
  filter->ComputeWeightSumOn();
  filter->ComputeBoundaryEigenvalueOn();
  filter->ComputeCurvatureOn();
  filter->ComputeCorrectionLengthOn();
  filter->ComputeResidualOn();
  filter->ComputeBoundaryFlagOn();
  filter->Update();
  vtkPointData* data = filter->GetOutput()->GetPointData();
  for (const char* name : { "Normals", "Gradients", "WeightSum", "BoundaryEigenvalue",
         "MeanCurvature", "GaussCurvature", "CorrectionLength", "Residual", "BoundaryFlag" })
  {
    CHECK(data->GetArray(name) &&
      data->GetArray(name)->GetNumberOfTuples() == filter->GetOutput()->GetNumberOfPoints());
  }
  double mean = 0.0; // of a sphere of 0.6, around lower values
  for (vtkIdType i = 0; i < filter->GetOutput()->GetNumberOfPoints(); ++i)
  {
    mean += data->GetArray("MeanCurvature")->GetComponent(i, 0);
  }
  mean /= static_cast<double>(filter->GetOutput()->GetNumberOfPoints());
  CHECK(std::abs(mean * 0.6 + 1.0) < 0.05);
  vtkDataArray* iso = data->GetArray("Radius");
  CHECK(iso && iso->GetDataType() == VTK_DOUBLE && iso->GetRange()[0] == 0.6);

  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Position");
  filter->Update();
  data = filter->GetOutput()->GetPointData();
  CHECK(data->HasArray("Position_Magnitude") && data->HasArray("Position"));
  filter->SetScalarComponent(1);
  filter->SetValue(0, 0.05);
  filter->Update();
  CHECK(filter->GetOutput()->GetPointData()->HasArray("Position_Height"));

  filter->ComputeNormalsOff();
  filter->ComputeScalarsOff();
  filter->Update();
  data = filter->GetOutput()->GetPointData();
  CHECK(!data->GetNormals() && !data->HasArray("Position_Height"));
}

void TestPrecision()
{
  auto filter = test::MakeSphereFilter(test::MakeCube(VTK_FLOAT));
  filter->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  filter->Update();
  CHECK(filter->GetOutput()->GetPoints()->GetDataType() == VTK_DOUBLE);
  filter->SetOutputPointsPrecision(vtkAlgorithm::SINGLE_PRECISION);
  filter->Update();
  CHECK(filter->GetOutput()->GetPoints()->GetDataType() == VTK_FLOAT);
}

// Floats that are too coarse for the surface are told of; these steps are 0.0625, the cubes 0.065.
void TestCoarsePoints()
{
  auto cube = test::MakeCube();
  auto filter = test::MakeSphereFilter(cube);
  int warnings = 0;
  test::CountEvents(filter, vtkCommand::WarningEvent, &warnings);
  const auto warned = [&filter, &warnings](int precision)
  {
    warnings = 0;
    filter->SetOutputPointsPrecision(precision);
    filter->Update();
    CHECK(filter->GetOutput()->GetNumberOfCells() > 100);
    return warnings;
  };
  CHECK(warned(vtkAlgorithm::SINGLE_PRECISION) == 0);
  vtkNew<vtkPoints> far;
  far->SetDataTypeToDouble();
  for (vtkIdType i = 0; i < cube->GetNumberOfPoints(); ++i)
  {
    const double* x = cube->GetPoint(i);
    far->InsertNextPoint(x[0], x[1] - 1e6, x[2]);
  }
  cube->SetPoints(far);
  CHECK(warned(vtkAlgorithm::DOUBLE_PRECISION) == 0);
  CHECK(warned(vtkAlgorithm::DEFAULT_PRECISION) == 0);
  CHECK(warned(vtkAlgorithm::SINGLE_PRECISION) == 1);
}

void TestFieldData()
{
  auto filter = test::MakeSphereFilter(MakeParticles());
  filter->Update();
  vtkPolyData* surface = filter->GetOutput();
  vtkFieldData* data = surface->GetFieldData();
  vtkFieldData* run = filter->GetRunStatistics();
  CHECK(Number(data, "TimeValue") == 0.9);
  CHECK(Number(data, "IsoValues") == 0.6);
  CHECK(data->GetNumberOfArrays() == 2); // more would fill ParaView's menus of colours
  const std::string text = filter->GetStatistics();
  CHECK(text.find("Kernel: cubic\n") != std::string::npos);
  CHECK(text.find("Triangles: " + std::to_string(surface->GetNumberOfCells()) + "\n") !=
    std::string::npos);
  CHECK(Number(run, "Triangles") == static_cast<double>(surface->GetNumberOfCells()));
  CHECK(Number(run, "Points") == static_cast<double>(surface->GetNumberOfPoints()));
  CHECK(Number(run, "FluidParticles") == 9261.0);
  CHECK(Number(run, "VirtualCells") > Number(run, "CellsUsed"));
  CHECK(Number(run, "CellsUsed") > 0.0);
  CHECK(Number(run, "CorrectionMax") >= Number(run, "CorrectionMean"));
  CHECK(Number(run, "CorrectionMean") > 0.0);
  CHECK(Number(run, "CorrectionStandardDeviation") > 0.0);
  CHECK(std::fabs(Number(run, "CubeSize") - 0.5 * test::SmoothingLength) < 1e-12);
  CHECK(Number(run, "IsoValues") == 0.6);
  CHECK(Text(run, "Kernel") == "cubic");
  CHECK(Text(run, "Field") == "shepard");
  CHECK(Text(run, "SeedMode") == "complete");
  CHECK(Text(run, "Topology") == "table" && Number(run, "AmbiguousFaces") == 0.0);
  CHECK(Text(run, "BoundaryDetection") == "weight_sum");
  CHECK(Text(run, "Scalar") == "Radius");
  CHECK(Text(run, "SmoothingLengthArray") == "SmoothingLength");
  CHECK(Text(run, "VolumeArray") == "Volume");
  CHECK(Text(run, "MassArray").empty());
  CHECK(!Text(run, "Device").empty());
}

// As VTK measures them; a cut surface has no volume.
void TestMeasures()
{
  auto filter = test::MakeSphereFilter(MakeParticles());
  filter->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  filter->Update();
  vtkNew<vtkMassProperties> mass;
  mass->SetInputData(filter->GetOutput());
  vtkFieldData* run = filter->GetRunStatistics();
  CHECK(std::fabs(Number(run, "Area") / mass->GetSurfaceArea() - 1.0) < 1e-5);
  // Values grow outwards: what is above the iso value is outside.
  CHECK(std::fabs(Number(run, "Volume") / -mass->GetVolume() - 1.0) < 1e-5);
  const double area = Number(run, "Area");
  filter->SetBox(-2.0, 0.0, -2.0, 2.0, -2.0, 2.0);
  filter->UseBoxOn();
  filter->Update();
  run = filter->GetRunStatistics();
  CHECK(!run->HasArray("Volume") && Number(run, "Area") > 0.3 * area &&
    Number(run, "Area") < 0.7 * area);
}

// Costs of a run, which another run for the same surface may not have, are no part of the surface.
void TestCompact()
{
  auto filter = test::MakeSphereFilter(MakeParticles());
  filter->Update();
  const vtkIdType triangles = filter->GetOutput()->GetNumberOfPolys();
  filter->CompactOn();
  filter->Update();
  const vtkIdType left = filter->GetOutput()->GetNumberOfPolys();
  CHECK(left > triangles / 2 && 5 * left < 4 * triangles);
  std::ostringstream text;
  filter->Print(text);
  CHECK(text.str().find("Compact: 1") != std::string::npos);
}

void TestRunStatistics()
{
  vtkNew<vtkMarchingCorrectors> idle;
  CHECK(idle->GetRunStatistics() && idle->GetRunStatistics()->GetNumberOfArrays() == 0);
  auto filter = test::MakeSphereFilter(MakeParticles());
  filter->Update();
  vtkSmartPointer<vtkFieldData> run = filter->GetRunStatistics();
  for (const char* name :
    { "Seconds", "DeviceBytesPeak", "Bricks", "NodesEvaluated", "MarchRounds" })
  {
    CHECK(run->GetArray(name) && run->GetArray(name)->GetComponent(0, 0) > 0.0);
    CHECK(!filter->GetOutput()->GetFieldData()->HasArray(name));
  }
  vtkDataArray* seconds = run->GetArray("Seconds");
  CHECK(seconds && seconds->GetComponentName(1) &&
    !std::strcmp(seconds->GetComponentName(1), "search grid"));
  const int last = seconds ? seconds->GetNumberOfComponents() - 1 : 0;
  CHECK(seconds && !std::strcmp(seconds->GetComponentName(last), "total"));
  CHECK(seconds && seconds->GetComponent(0, last) > 0.0);

  filter->SetInputData(vtkNew<vtkPolyData>());
  filter->Update();
  CHECK(filter->GetRunStatistics()->GetNumberOfArrays() == 0);
  CHECK(run->GetArray("Seconds") == seconds);
}

void TestState()
{
  vtkNew<vtkMarchingCorrectors> filter;
  CHECK(filter->GetNumberOfContours() == 0);
  CHECK(filter->SetKernelByName("wendland"));
  CHECK(filter->GetKernel() == vtkMarchingCorrectors::WENDLAND_C2);
  CHECK(!filter->SetKernelByName("no such kernel") && !filter->SetKernelByName(nullptr));
  CHECK(!std::strcmp(filter->GetKernelName(), "wendland"));
  const vtkMTimeType time = filter->GetMTime();
  filter->SetValue(0, 1.0);
  CHECK(filter->GetMTime() > time);
  const vtkMTimeType later = filter->GetMTime();
  filter->SetFreeSurfaceValue(0.4);
  CHECK(filter->GetMTime() > later);
  std::ostringstream text;
  filter->Print(text);
  for (const char* word : { "Kernel: wendland", "Boundary Detection: weight sum",
         "Vertex Threshold: 0.5", "Iteration Limit: 30" })
  {
    CHECK(text.str().find(word) != std::string::npos);
  }
}
}

int TestOutput(int, char*[])
{
  TestAttributes();
  TestArraysLeftOut();
  TestNames();
  TestComputedArrays();
  TestPrecision();
  TestCoarsePoints();
  TestFieldData();
  TestCompact();
  TestRunStatistics();
  TestMeasures();
  TestState();
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
