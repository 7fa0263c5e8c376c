// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Finding what nobody has said: the fluid, in every filter, and the array to be looked at.
#include "TestParticles.h"

#include "vtkCommand.h"
#include "vtkIntArray.h"
#include "vtkPointSet.h"
#include "vtkSPHDerivatives.h"
#include "vtkSPHProbe.h"

namespace
{
int failures = 0;

bool IsWall(vtkPolyData* cube, vtkIdType i)
{
  return cube->GetPoint(i)[2] < -0.45;
}

vtkSmartPointer<vtkPolyData> MakeTyped(const char* name, double fluid, double wall)
{
  auto cube = test::MakeCube();
  test::AddArray<vtkIntArray>(
    cube, name, 1, [&](vtkIdType i, int) { return IsWall(cube, i) ? wall : fluid; });
  return cube;
}

/// Says what filters find in these particles, and whether they warn where they are not to look.
std::string Find(vtkPolyData* particles, int& warnings)
{
  vtkNew<vtkMarchingCorrectors> contour;
  vtkNew<vtkSPHDerivatives> derivatives;
  vtkNew<vtkSPHProbe> probe;
  probe->SetSourceData(particles);
  probe->SetInputDataObject(test::MakeCube());
  std::string found;
  warnings = 0;
  for (vtkSPHAlgorithm* filter :
    std::initializer_list<vtkSPHAlgorithm*>{ contour.Get(), derivatives.Get(), probe.Get() })
  {
    if (filter != probe.Get())
    {
      filter->SetInputDataObject(particles);
      filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Radius");
    }
    test::CountEvents(filter, vtkCommand::WarningEvent, &warnings);
    filter->Update();
    CHECK(!*filter->GetUsedFluid());
    filter->DetectFluidOn();
    const int before = warnings;
    filter->Update();
    CHECK(!*filter->GetUsedFluid() || warnings == before);
    CHECK(filter == contour.Get() || found == filter->GetUsedFluid());
    found = filter->GetUsedFluid();
  }
  CHECK(found == contour->GetNextFluid());
  return found;
}

void TestFluid()
{
  int warnings = 0;
  CHECK(Find(MakeTyped("ParticleType", 0, 1), warnings) == "ParticleType = 0" && warnings == 3);
  CHECK(Find(MakeTyped("Type", 3, 0), warnings) == "Type = 3" && warnings == 3);
  CHECK(Find(MakeTyped("isFluid", 1, 0), warnings) == "isFluid = 1");
  CHECK(Find(MakeTyped("is_boundary", 0, 1), warnings) == "is_boundary = 0");
  CHECK(Find(MakeTyped("ParticleType", 2, 5), warnings).empty() && warnings == 6); // who knows
  CHECK(Find(MakeTyped("ParticleType", 1, 1), warnings).empty() && warnings == 0); // one kind
  CHECK(Find(MakeTyped("Colour", 0, 1), warnings).empty() && warnings == 0);
}

// Found is as good as named, and what is named goes before.
void TestNamed()
{
  auto cube = MakeTyped("ParticleType", 0, 1);
  auto named = test::MakeSphereFilter(cube), found = test::MakeSphereFilter(cube);
  named->SetFluidArrayName("ParticleType");
  found->DetectFluidOn();
  found->SetFluidArrayName("(automatic)"); // as ParaView's panel says it
  named->Update();
  found->Update();
  CHECK(test::SameSurface(named->GetOutput(), found->GetOutput()));
  CHECK(test::SameStatistics(named->GetRunStatistics(), found->GetRunStatistics()));
  named->SetFluidValue(1.0);
  named->DetectFluidOn();
  named->Update();
  CHECK(!std::strcmp(named->GetUsedFluid(), "ParticleType = 1"));
}

// Nobody has chosen an array: velocities, the first vector, the first scalar that varies; no numbers.
void TestArray()
{
  auto cube = test::MakeCube();
  vtkPointData* data = cube->GetPointData();
  data->RemoveArray("Radius");
  auto number = test::AddArray<vtkIntArray>(cube, "Idp", 1, [](vtkIdType i, int) { return i; });
  test::AddArray<vtkDoubleArray>(cube, "IsoValue", 1, [](vtkIdType, int) { return 0.5; });
  vtkNew<vtkMarchingCorrectors> filter;
  filter->SetInputData(cube);
  CHECK(!*filter->GetNextArray());
  data->SetActiveScalars("Idp");
  test::AddArray<vtkDoubleArray>(
    cube, "Height", 1, [&](vtkIdType i, int) { return cube->GetPoint(i)[2]; });
  cube->Modified();
  CHECK(!std::strcmp(filter->GetNextArray(), "Height"));
  const auto active = [&filter]() -> std::string
  {
    filter->Update();
    CHECK(filter->GetOutput()->GetNumberOfCells() > 0);
    vtkDataArray* scalars = filter->GetOutput()->GetPointData()->GetScalars();
    return scalars ? scalars->GetName() : "";
  };
  CHECK(active().empty()); // Height is the iso value on the surface
  test::AddArray<vtkDoubleArray>(
    cube, "Force", 3, [&](vtkIdType i, int c) { return cube->GetPoint(i)[c]; });
  cube->Modified();
  CHECK(!std::strcmp(filter->GetNextArray(), "Force") && active() == "Height"); // the magnitude is the iso value
  test::AddArray<vtkDoubleArray>(
    cube, "velocity", 3, [&](vtkIdType i, int c) { return cube->GetPoint(i)[2 - c]; });
  cube->Modified();
  CHECK(!std::strcmp(filter->GetNextArray(), "velocity") && active() == "Height");
  data->SetActiveScalars("Height"); // of the file: fit, and so it is taken
  cube->Modified();
  CHECK(active() == "velocity" && filter->GetOutput()->GetPointData()->HasArray("Height"));
  CHECK(filter->GetOutput()->GetPointData()->GetArray("Height")->GetRange()[0] ==
    filter->GetOutput()->GetPointData()->GetArray("Height")->GetRange()[1]);
}

// Components have names; the range is known before there is a smoothing length.
void TestNames()
{
  auto cube = test::MakeCube();
  test::AddArray<vtkDoubleArray>(
    cube, "Velocity", 3, [&](vtkIdType i, int c) { return cube->GetPoint(i)[c]; });
  auto filter = test::MakeSphereFilter(cube);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Velocity");
  filter->SetScalarComponent(1);
  filter->SetValue(0, 0.1);
  filter->Update();
  CHECK(filter->GetOutput()->GetPointData()->HasArray("Velocity_Y"));
  cube->GetPointData()->RemoveArray("SmoothingLength");
  cube->Modified();
  CHECK(filter->GetNextScalarRange()[0] < -0.9 && filter->GetNextScalarRange()[1] > 0.9);
  CHECK(std::fabs(filter->GetNextIsoValue()) < 0.1 && filter->GetNextCells() == 0.0);
}

// Arrays of the file stay, unless they are to be replaced.
void TestDerived()
{
  auto cube = test::MakeCube();
  test::AddArray<vtkDoubleArray>(
    cube, "Velocity", 3, [&](vtkIdType i, int c) { return cube->GetPoint(i)[2 - c]; });
  auto own = test::AddArray<vtkDoubleArray>(cube, "Vorticity", 3, [](vtkIdType, int) { return 7; });
  vtkNew<vtkSPHDerivatives> filter;
  filter->SetInputDataObject(cube); // its default array is Velocity
  filter->Update();
  vtkPointData* data = vtkPointSet::SafeDownCast(filter->GetOutput())->GetPointData();
  CHECK(data->GetArray("Vorticity") == own);
  CHECK(data->HasArray("Vorticity_SPH") && data->HasArray("Lambda2"));
  filter->ReplaceArraysOn();
  filter->Update();
  data = vtkPointSet::SafeDownCast(filter->GetOutput())->GetPointData();
  CHECK(data->GetArray("Vorticity") != own && !data->HasArray("Vorticity_SPH"));
}
}

int TestDetection(int, char*[])
{
  TestFluid();
  TestNamed();
  TestArray();
  TestNames();
  TestDerived();
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
