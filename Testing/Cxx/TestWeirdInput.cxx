// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Start with something weird: each kind of unusable input gives an empty output and one sentence
// that names what was wrong; nothing crashes, and the same filter works again afterwards.
#include "TestParticles.h"

#include "vtkCommand.h"
#include "vtkObject.h"
#include "vtkPointSet.h"
#include "vtkStringArray.h"

#include <limits>
#include <vector>

namespace
{
int failures = 0;
using Filter = vtkMarchingCorrectors;

struct Case
{
  const char* Name;
  std::vector<const char*> Words; // that the sentence must contain
  std::function<void(Filter*)> SetUp;
  std::function<void(vtkPolyData*)> Spoil;
};

void SetComponent(vtkPolyData* data, const char* array, vtkIdType i, double value)
{
  data->GetPointData()->GetArray(array)->SetComponent(i, 0, value);
}

void Scalar(Filter* f, const char* name)
{
  f->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, name);
}

void AddText(vtkPolyData* data)
{
  vtkNew<vtkStringArray> text;
  text->SetName("Text");
  text->SetNumberOfTuples(data->GetNumberOfPoints());
  data->GetPointData()->AddArray(text);
}

void AddShort(vtkPolyData* data)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName("Short");
  array->InsertNextValue(1.0);
  data->GetPointData()->AddArray(array);
}

void AddVectors(vtkPolyData* data)
{
  test::AddArray<vtkDoubleArray>(data, "Vector", 3, [](vtkIdType, int) { return 1.0; });
}

void Nothing(vtkPolyData*) {}

const double NaN = std::numeric_limits<double>::quiet_NaN();

std::vector<Case> MissingOrMistyped()
{
  return {
    { "no scalar", { "scalar", "free surface", "Volume" },
      [](Filter* f)
      { f->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, ""); },
      [](vtkPolyData* data)
      { data->GetPointData()->RemoveArray("Radius"); } }, // no other one varies
    { "unknown scalar", { "'NoSuch'", "scalar", "Radius" }, [](Filter* f) { Scalar(f, "NoSuch"); },
      Nothing },
    { "cell scalar", { "'NoSuch'", "scalar" },
      [](Filter* f)
      { f->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, "NoSuch"); },
      Nothing },
    { "text scalar", { "'Text'", "numbers" }, [](Filter* f) { Scalar(f, "Text"); }, AddText },
    { "short scalar", { "'Short'", "9261 points" }, [](Filter* f) { Scalar(f, "Short"); },
      AddShort },
    { "no such component", { "'Vector'", "component 7" },
      [](Filter* f)
      {
        Scalar(f, "Vector");
        f->SetScalarComponent(7);
      },
      AddVectors },
    { "dot product of unequal arrays", { "dot product", "'Vector'" },
      [](Filter* f)
      { f->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Vector"); },
      AddVectors },
    { "unknown smoothing length", { "'NoSuch'", "smoothing length", "Point arrays" },
      [](Filter* f) { f->SetSmoothingLengthArrayName("NoSuch"); }, Nothing },
    { "vector smoothing length", { "'Vector'", "smoothing length", "3 components" },
      [](Filter* f) { f->SetSmoothingLengthArrayName("Vector"); }, AddVectors },
    { "no smoothing length", { "no smoothing length", "estimate" }, [](Filter*) {},
      [](vtkPolyData* d) { d->GetPointData()->RemoveArray("SmoothingLength"); } },
    { "detection off", { "no smoothing length" }, [](Filter* f) { f->DetectArraysOff(); },
      Nothing },
    { "unknown volume", { "'NoSuch'", "volume" },
      [](Filter* f) { f->SetVolumeArrayName("NoSuch"); }, Nothing },
    { "unknown mass", { "'NoSuch'", "mass" }, [](Filter* f) { f->SetMassArrayName("NoSuch"); },
      Nothing },
    { "unknown density", { "'NoSuch'", "density" },
      [](Filter* f) { f->SetDensityArrayName("NoSuch"); }, Nothing },
    { "unknown fluid array", { "'NoSuch'", "fluid" },
      [](Filter* f) { f->SetFluidArrayName("NoSuch"); }, Nothing },
  };
}

// The core's sentence arrives; core_input has all that it refuses.
std::vector<Case> IllegalValues()
{
  const auto keep = [](Filter*) {};
  return {
    { "smoothing length NaN", { "17", "SmoothingLength" }, keep,
      [](vtkPolyData* d) { SetComponent(d, "SmoothingLength", 17, NaN); } },
    { "scalar infinite", { "18", "Radius" }, keep,
      [](vtkPolyData* d) { SetComponent(d, "Radius", 18, HUGE_VAL); } },
    { "position NaN", { "20", "position" }, keep,
      [](vtkPolyData* d) { d->GetPoints()->SetPoint(20, 0.0, NaN, 0.0); } },
    { "constant smoothing length negative", { "smoothing length" },
      [](Filter* f) { f->SetSmoothingLength(-0.1); }, Nothing },
    { "cube size tiny", { "cube size" }, [](Filter* f) { f->SetCubeSize(1e-12); }, Nothing },
    { "no such device", { "NoSuchDevice" }, [](Filter* f) { f->SetDevice("NoSuchDevice"); },
      Nothing },
  };
}

bool Contains(const std::string& sentence, const char* word)
{
  const auto lower = [](std::string s)
  {
    for (char& c : s)
    {
      c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return s;
  };
  return lower(sentence).find(lower(word)) != std::string::npos;
}

void Run(const Case& c)
{
  auto bad = test::MakeCube();
  c.Spoil(bad);
  auto filter = test::MakeSphereFilter(bad);
  c.SetUp(filter);
  int errors = 0;
  test::CountEvents(filter, vtkCommand::ErrorEvent, &errors);
  filter->Update();
  const std::string sentence = filter->GetErrorMessage();
  std::cout << c.Name << ": " << sentence << "\n";
  CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
  CHECK(filter->GetOutput()->GetNumberOfCells() == 0);
  CHECK(errors > 0);
  CHECK(!sentence.empty() && sentence.find('\n') == std::string::npos);
  for (const char* word : c.Words)
  {
    if (!Contains(sentence, word))
    {
      std::cerr << c.Name << ": '" << word << "' is not in: " << sentence << std::endl;
      ++failures;
    }
  }
}

void TestEmptyInputs()
{
  vtkNew<vtkPolyData> empty;
  auto filter = test::MakeSphereFilter(empty);
  filter->Update();
  CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
  CHECK(!*filter->GetErrorMessage());

  vtkNew<vtkPoints> none;
  empty->SetPoints(none);
  filter->FreeSurfaceOn();
  filter->Update();
  CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
  CHECK(!*filter->GetErrorMessage());
}

// Solid particles alone: a warning, no surface, no error.
void TestNoFluid()
{
  auto filter = test::MakeSphereFilter(test::MakeCube());
  filter->SetFluidArrayName("Radius");
  filter->SetFluidValue(-5.0);
  int warnings = 0;
  test::CountEvents(filter, vtkCommand::WarningEvent, &warnings);
  filter->Update();
  CHECK(warnings == 1);
  CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
}

void TestRecovery()
{
  auto filter = test::MakeSphereFilter(test::MakeCube());
  int errors = 0;
  test::CountEvents(filter, vtkCommand::ErrorEvent, &errors);
  filter->SetHScaleFactor(-1.0);
  filter->Update();
  CHECK(*filter->GetErrorMessage());
  filter->SetHScaleFactor(1.0);
  filter->Update();
  CHECK(!*filter->GetErrorMessage());
  CHECK(filter->GetOutput()->GetNumberOfPoints() > 0);
}

// One lonely particle, two at the same place, an iso value outside the range: legal.
void TestDegenerate()
{
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(1.0, 2.0, 3.0);
  vtkNew<vtkPolyData> particles;
  particles->SetPoints(points);
  auto filter = vtkSmartPointer<Filter>::New();
  filter->SetInputData(particles);
  filter->SetSmoothingLength(0.1);
  filter->FreeSurfaceOn();
  filter->Update();
  CHECK(!*filter->GetErrorMessage());
  CHECK(filter->GetOutput()->GetNumberOfPoints() > 0);

  points->InsertNextPoint(1.0, 2.0, 3.0);
  points->Modified();
  filter->Update();
  CHECK(!*filter->GetErrorMessage());

  auto sphere = test::MakeSphereFilter(test::MakeCube());
  sphere->SetValue(0, 99.0);
  sphere->Update();
  CHECK(!*sphere->GetErrorMessage());
  CHECK(sphere->GetOutput()->GetNumberOfPoints() == 0);
}
}

int TestWeirdInput(int, char*[])
{
  TestEmptyInputs();
  for (const Case& c : MissingOrMistyped())
  {
    Run(c);
  }
  for (const Case& c : IllegalValues())
  {
    Run(c);
  }
  TestNoFluid();
  TestRecovery();
  TestDegenerate();
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
