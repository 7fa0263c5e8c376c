// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Observers of the progress do not change the update that runs, whatever they do; and filters in
// several threads do not disturb each other.
#include "TestParticles.h"

#include "vtkCommand.h"
#include "vtkSOADataArrayTemplate.h"
#include "vtkUnsignedCharArray.h"

#include <thread>
#include <vector>

namespace
{
int failures = 0;
using Filter = vtkMarchingCorrectors;

struct Observer
{
  std::function<void(Filter*)> Act;
  int Calls = 0;
  bool Acts = false;
};

vtkSmartPointer<vtkPolyData> MakeParticles()
{
  auto cube = test::MakeCube();
  test::AddArray<vtkSOADataArrayTemplate<float>>(
    cube, "Soa", 3, [&](vtkIdType i, int c) { return cube->GetPoint(i)[c]; });
  test::AddArray<vtkUnsignedCharArray>(
    cube, "Type", 1, [&](vtkIdType i, int) { return cube->GetPoint(i)[1] > 0.3 ? 1.0 : 0.0; });
  return cube;
}

vtkSmartPointer<Filter> MakeFilter(vtkPolyData* particles)
{
  auto filter = test::MakeSphereFilter(particles);
  filter->SetValue(1, 0.5);
  filter->SetValue(2, 0.7);
  filter->SetFluidArrayName("Type");
  filter->ComputeWeightSumOn();
  return filter;
}

vtkSmartPointer<vtkPolyData> Copy(vtkPolyData* surface)
{
  auto copy = vtkSmartPointer<vtkPolyData>::New();
  copy->DeepCopy(surface);
  return copy;
}

// The surface of a filter with an observer that acts at each call but the first, which VTK makes
// before the filter runs.
vtkSmartPointer<vtkPolyData> ExtractObserved(Filter* filter, Observer& observer)
{
  vtkNew<vtkCallbackCommand> command;
  command->SetCallback(
    [](vtkObject* caller, unsigned long, void* data, void*)
    {
      auto* o = static_cast<Observer*>(data);
      if (++o->Calls > 1 && !o->Acts)
      {
        o->Acts = true;
        o->Act(static_cast<Filter*>(caller));
        o->Acts = false;
      }
    });
  command->SetClientData(&observer);
  const unsigned long tag = filter->AddObserver(vtkCommand::ProgressEvent, command);
  filter->Update();
  filter->RemoveObserver(tag);
  return Copy(filter->GetOutput());
}

void TestChanges()
{
  auto plain = MakeFilter(MakeParticles());
  plain->Update();
  const auto expected = Copy(plain->GetOutput());
  vtkFieldData* statistics = plain->GetRunStatistics();
  CHECK(expected->GetNumberOfCells() > 0);
  const auto dataOf = [](Filter* f)
  { return vtkDataSet::SafeDownCast(f->GetInputDataObject(0, 0))->GetPointData(); };
  const std::pair<const char*, std::function<void(Filter*)>> changes[] = {
    { "contour values", [](Filter* f) { f->GenerateValues(2000, 0.1, 0.2); } },
    { "one contour value", [](Filter* f) { f->SetValue(1, 0.1 + f->GetValue(1)); } },
    { "scalar and free surface",
      [](Filter* f)
      {
        f->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Soa");
        f->FreeSurfaceOn();
      } },
    { "names",
      [](Filter* f)
      {
        f->SetFluidArrayName("a name that is longer than the one that it replaces");
        f->SetFluidValue(77.0);
        f->AddExcludedArray("Volume");
        f->SetDevice("none");
        f->SetSmoothingLength(3.0);
      } },
    { "output",
      [](Filter* f)
      {
        f->SetOutputPointsPrecision(vtkAlgorithm::SINGLE_PRECISION);
        f->ComputeNormalsOff();
        f->ComputeWeightSumOff();
        f->InterpolateAttributesOff();
        f->PreviewOn();
      } },
    { "memory",
      [](Filter* f)
      {
        f->ReleaseDeviceMemory();
        f->KeepDeviceDataOff();
      } },
    { "arrays taken from the input",
      [&](Filter* f)
      {
        while (dataOf(f)->GetNumberOfArrays() > 0)
        {
          dataOf(f)->GetAbstractArray(0)->SetName("another name, and no short one");
          dataOf(f)->RemoveArray(0);
        }
      } },
    { "another input", [](Filter* f) { f->SetInputData(vtkNew<vtkPolyData>()); } },
  };
  for (const auto& change : changes)
  {
    auto filter = MakeFilter(MakeParticles());
    Observer observer{ change.second };
    const auto surface = ExtractObserved(filter, observer);
    const bool same = test::SameSurface(expected, surface) &&
      test::SameStatistics(statistics, filter->GetRunStatistics());
    std::cout << change.first << ": " << observer.Calls << " calls" << (same ? "" : ", differs")
              << "\n";
    CHECK(observer.Calls > 3 && same);
    CHECK(surface->GetPoints()->GetDataType() == VTK_DOUBLE);
    CHECK(!*filter->GetErrorMessage());
  }
}

// An update within an update is refused by VTK, and changes nothing; one after it works.
void TestUpdateWithin()
{
  auto filter = MakeFilter(MakeParticles());
  filter->Update();
  const auto expected = Copy(filter->GetOutput());
  filter->Modified();
  int errors = 0;
  test::CountEvents(filter, vtkCommand::ErrorEvent, &errors);
  Observer observer{ [](Filter* f) { f->Update(); } };
  CHECK(test::SameSurface(expected, ExtractObserved(filter, observer)));
  CHECK(errors > 0);
  filter->SetValue(0, 0.65);
  filter->Update();
  CHECK(!test::SameSurface(expected, filter->GetOutput()));
  CHECK(filter->GetOutput()->GetNumberOfCells() > 0);
}

// Memory that an observer wants released is released when the update is done with it.
void TestReleaseWithin()
{
  auto filter = MakeFilter(MakeParticles());
  const auto peak = [&filter]()
  { return filter->GetRunStatistics()->GetArray("DeviceBytesPeak")->GetComponent(0, 0); };
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(0.0, 0.0, 0.0);
  vtkNew<vtkPolyData> particle;
  particle->SetPoints(points);
  const auto peakOfParticle = [&]()
  {
    filter->SetInputData(particle);
    filter->SetFluidArrayName("");
    filter->SetSmoothingLength(0.1);
    filter->FreeSurfaceOn();
    filter->Update();
    CHECK(filter->GetOutput()->GetNumberOfCells() > 0);
    return peak();
  };
  const double alone = peakOfParticle();
  filter = MakeFilter(MakeParticles());
  Observer observer{ [](Filter* f) { f->ReleaseDeviceMemory(); } };
  ExtractObserved(filter, observer);
  CHECK(peakOfParticle() == alone);
}

void TestThreads()
{
  const int count = 4;
  std::vector<vtkSmartPointer<vtkPolyData>> surfaces(count);
  std::vector<std::thread> threads;
  for (int i = 0; i < count; ++i)
  {
    threads.emplace_back(
      [&surfaces, i]()
      {
        auto filter = MakeFilter(MakeParticles());
        filter->SetFreeSurface(i % 2);
        Observer observer{ [](Filter*) {} };
        surfaces[static_cast<size_t>(i)] = ExtractObserved(filter, observer);
      });
  }
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  CHECK(surfaces[0]->GetNumberOfCells() > 0 && surfaces[1]->GetNumberOfCells() > 0);
  CHECK(test::SameSurface(surfaces[0], surfaces[2]));
  CHECK(test::SameSurface(surfaces[1], surfaces[3]));
}
}

int TestObservers(int, char*[])
{
  TestChanges();
  TestUpdateWithin();
  TestReleaseWithin();
  TestThreads();
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
