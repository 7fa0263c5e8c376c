// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Data kept on the device between runs never change a result and can be given back; a run that is
// aborted, or short of device memory, leaves an empty output and a filter that works.
#include "TestParticles.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"

#include <vector>

namespace
{
int failures = 0;
using Filter = vtkMarchingCorrectors;

struct Step
{
  const char* Name;
  std::function<void(Filter*, vtkPolyData*)> Change;
};

void MoveParticle(vtkPolyData* cube)
{
  vtkIdType i = cube->GetNumberOfPoints() / 3;
  double x[3];
  cube->GetPoint(i, x);
  cube->GetPoints()->SetPoint(i, x[0] + 0.03, x[1], x[2]);
}

// A filter that lives through all steps against a new one for each: what versions tell of arrays; core_reuse has all
// options.
std::vector<Step> Steps()
{
  return {
    { "first run", [](Filter*, vtkPolyData*) {} },
    { "other iso value", [](Filter* f, vtkPolyData*) { f->SetValue(0, 0.5); } },
    { "other scalar",
      [](Filter* f, vtkPolyData*)
      { f->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Other"); } },
    { "adaptive cubes", [](Filter* f, vtkPolyData*) { f->SetCubeSizeModeToAdaptive(); } },
    { "one level", [](Filter* f, vtkPolyData*) { f->SetCubeLevelLimit(1); } },
    { "uniform cubes", [](Filter* f, vtkPolyData*) { f->SetCubeSizeModeToUniform(); } },
    { "box",
      [](Filter* f, vtkPolyData*)
      {
        f->SetBox(-2.0, 0.1, -0.2, 0.6, -2.0, 2.0);
        f->UseBoxOn();
      } },
    { "no box", [](Filter* f, vtkPolyData*) { f->UseBoxOff(); } },
    { "free surface", [](Filter* f, vtkPolyData*) { f->FreeSurfaceOn(); } },
    { "scalar again", [](Filter* f, vtkPolyData*) { f->FreeSurfaceOff(); } },
    { "particle moved, data set told",
      [](Filter*, vtkPolyData* cube)
      {
        MoveParticle(cube);
        cube->Modified();
      } },
    { "particle moved, points told",
      [](Filter*, vtkPolyData* cube)
      {
        MoveParticle(cube);
        cube->GetPoints()->Modified();
      } },
    { "scalar changed in place",
      [](Filter*, vtkPolyData* cube)
      {
        vtkDataArray* other = cube->GetPointData()->GetArray("Other");
        for (vtkIdType i = 0; i < other->GetNumberOfTuples(); ++i)
        {
          other->SetComponent(i, 0, 1.1 * other->GetComponent(i, 0));
        }
        other->Modified();
      } },
    { "constant smoothing length", [](Filter* f, vtkPolyData*) { f->SetSmoothingLength(0.15); } },
    { "solids", [](Filter* f, vtkPolyData*) { f->SetFluidArrayName("Type"); } },
    { "other solids", [](Filter* f, vtkPolyData*) { f->SetFluidValue(1.0); } },
    { "memory released", [](Filter* f, vtkPolyData*) { f->ReleaseDeviceMemory(); } },
    { "nothing kept", [](Filter* f, vtkPolyData*) { f->KeepDeviceDataOff(); } },
    { "iso value, nothing kept", [](Filter* f, vtkPolyData*) { f->SetValue(0, 0.35); } },
    { "kept again", [](Filter* f, vtkPolyData*) { f->KeepDeviceDataOn(); } },
    { "nothing new", [](Filter* f, vtkPolyData*) { f->Modified(); } },
  };
}

vtkSmartPointer<vtkPolyData> MakeParticles()
{
  auto cube = test::MakeCube();
  vtkDataArray* radius = cube->GetPointData()->GetArray("Radius");
  test::AddArray<vtkFloatArray>(cube, "Other", 1,
    [&](vtkIdType i, int) { return radius->GetComponent(i, 0) + 0.1 * cube->GetPoint(i)[0]; });
  test::AddArray<vtkFloatArray>(
    cube, "Type", 1, [&](vtkIdType i, int) { return cube->GetPoint(i)[1] > 0.3 ? 1.0 : 0.0; });
  return cube;
}

void TestSteps()
{
  auto cube = MakeParticles();
  auto lasting = test::MakeSphereFilter(cube);
  const std::vector<Step> steps = Steps();
  for (size_t last = 0; last < steps.size(); ++last)
  {
    steps[last].Change(lasting, cube);
    lasting->Update();
    auto fresh = test::MakeSphereFilter(cube);
    vtkNew<vtkPolyData> ignored; // the particles have been changed already
    ignored->DeepCopy(cube);
    for (size_t i = 0; i <= last; ++i)
    {
      steps[i].Change(fresh, ignored);
    }
    fresh->Update();
    const bool same = test::SameSurface(lasting->GetOutput(), fresh->GetOutput());
    std::cout << steps[last].Name << ": " << fresh->GetOutput()->GetNumberOfCells() << " triangles"
              << (same ? "" : ", differs") << "\n";
    CHECK(same);
    CHECK(test::SameStatistics(lasting->GetRunStatistics(), fresh->GetRunStatistics()));
    CHECK(std::strcmp(lasting->GetErrorMessage(), fresh->GetErrorMessage()) == 0);
  }
}

void Abort(vtkObject* caller, unsigned long, void* calls, void*)
{
  ++*static_cast<int*>(calls);
  vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
}

void TestAbort()
{
  auto filter = test::MakeSphereFilter(test::MakeCube());
  int calls = 0;
  vtkNew<vtkCallbackCommand> observer;
  observer->SetCallback(Abort);
  observer->SetClientData(&calls);
  const unsigned long tag = filter->AddObserver(vtkCommand::ProgressEvent, observer);
  filter->Update();
  CHECK(calls > 0);
  CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
  CHECK(!*filter->GetErrorMessage());

  filter->RemoveObserver(tag);
  filter->SetAbortExecute(0);
  filter->Modified();
  filter->Update();
  auto fresh = test::MakeSphereFilter(test::MakeCube());
  fresh->Update();
  CHECK(fresh->GetOutput()->GetNumberOfPoints() > 0);
  CHECK(test::SameSurface(filter->GetOutput(), fresh->GetOutput()));
}

void TestDeviceChange()
{
  auto filter = test::MakeSphereFilter(test::MakeCube());
  filter->Update();
  vtkNew<vtkPolyData> first;
  first->DeepCopy(filter->GetOutput());
  CHECK(!Filter::ListDevices().empty());
  filter->SetDevice("0");
  filter->Update();
  CHECK(!*filter->GetErrorMessage());
  CHECK(test::SameSurface(first, filter->GetOutput()));
}

// Most device memory of the last run; it begins with what was kept.
double PeakBytes(Filter* filter)
{
  vtkDataArray* peak = filter->GetRunStatistics()->GetArray("DeviceBytesPeak");
  CHECK(peak && peak->GetComponent(0, 0) > 0.0);
  return peak ? peak->GetComponent(0, 0) : 0.0;
}

void TestRelease()
{
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(0.0, 0.0, 0.0);
  vtkNew<vtkPolyData> particle;
  particle->SetPoints(points);
  auto cube = test::MakeCube();
  const auto makeFilter = [](vtkPolyData* particles)
  {
    auto filter = vtkSmartPointer<Filter>::New();
    filter->SetInputData(particles);
    filter->SetSmoothingLength(test::SmoothingLength);
    filter->FreeSurfaceOn();
    filter->Update();
    return filter;
  };
  const auto peakAfterCube = [&](const std::function<void(Filter*)>& change)
  {
    auto filter = makeFilter(cube);
    change(filter);
    filter->SetInputData(particle);
    filter->Update();
    CHECK(filter->GetOutput()->GetNumberOfPoints() > 0);
    return PeakBytes(filter);
  };
  const double kept = peakAfterCube([](Filter*) {});
  const double released = peakAfterCube([](Filter* f) { f->ReleaseDeviceMemory(); });
  const double off = peakAfterCube(
    [](Filter* f)
    {
      f->KeepDeviceDataOff();
      f->Update();
    });
  const double alone = PeakBytes(makeFilter(particle));
  std::cout << "bytes for one particle after many: kept " << kept << ", released " << released
            << ", nothing kept " << off << "; alone " << alone << "\n";
  CHECK(kept > alone);
  CHECK(released == alone);
  CHECK(off == alone);
}

void TestMemoryLimit()
{
  auto filter = test::MakeSphereFilter(test::MakeCube());
  filter->SetCubeSize(0.02);
  filter->Update();
  vtkNew<vtkPolyData> expected;
  expected->DeepCopy(filter->GetOutput());
  CHECK(PeakBytes(filter) > 2 << 20);

  int errors = 0;
  test::CountEvents(filter, vtkCommand::ErrorEvent, &errors);
  filter->SetDeviceMemoryLimit(1);
  filter->Update();
  std::cout << "memory limit: " << filter->GetErrorMessage() << "\n";
  CHECK(errors > 0);
  CHECK(std::strstr(filter->GetErrorMessage(), "may be used"));
  CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);

  filter->SetDeviceMemoryLimit(1000);
  filter->Update();
  CHECK(!*filter->GetErrorMessage());
  CHECK(expected->GetNumberOfPoints() > 0);
  CHECK(test::SameSurface(expected, filter->GetOutput()));
}
}

int TestReuse(int, char*[])
{
  TestSteps();
  TestAbort();
  TestDeviceChange();
  TestRelease();
  TestMemoryLimit();
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
