// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Fluxes: weird input first; then uniform flow through each way to name sections.
#include "TestParticles.h"

#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkCubeSource.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkPlaneSource.h"
#include "vtkSPHFlux.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkVariant.h"

namespace
{
int failures = 0;

double NumberAt(vtkTable* table, vtkIdType row, const char* column)
{
  return table->GetValueByName(row, column).ToDouble();
}

/// The cube, which moves by (1, -2, 3).
vtkSmartPointer<vtkPolyData> MakeMoving()
{
  auto cube = test::MakeCube();
  cube->GetPointData()->RemoveArray("Velocity");
  test::AddArray<vtkDoubleArray>(
    cube, "Velocity", 3, [](vtkIdType, int c) { return c == 0 ? 1.0
                                                  : c == 1    ? -2.0
                                                              : 3.0; });
  return cube;
}

vtkSmartPointer<vtkSPHFlux> MakeFlux(vtkDataObject* particles)
{
  auto flux = vtkSmartPointer<vtkSPHFlux>::New();
  flux->SetInputDataObject(particles);
  return flux;
}

const double Corner[3] = { 0.1, -0.3, -0.3 }, End1[3] = { 0.1, 0.3, -0.3 },
             End2[3] = { 0.1, -0.3, 0.4 }, Center[3] = { 0, 0, 0.1 }, Along[3] = { 0, 0, -3 },
             Box[6] = { -0.3, 0.2, -0.2, 0.3, -0.4, 0.1 };

void CheckWeird()
{
  vtkNew<vtkPolyData> nothing;
  auto flux = MakeFlux(nothing);
  flux->Update();
  CHECK(flux->GetOutput()->GetNumberOfRows() == 1);
  CHECK(NumberAt(flux->GetOutput(), 0, "area") == 0);
  CHECK(std::isnan(NumberAt(flux->GetOutput(), 0, "velocity")));
  auto still = test::MakeCube();
  still->GetPointData()->RemoveArray("Velocity");
  const char* const sentences[] = { "The particles have no velocity", "Section 'a' has no area",
    "Two sections have the name 'a'", "There is no point array 'Drift' for the velocity" };
  for (int i = 0; i < 4; ++i)
  {
    int errors = 0;
    flux = MakeFlux(i == 0 ? still : MakeMoving());
    test::CountEvents(flux, vtkCommand::ErrorEvent, &errors);
    flux->AddDisc("a", Center, Along, i == 1 ? 0.0 : 0.3);
    if (i == 2)
    {
      flux->AddBox("a", Box);
    }
    flux->SetVelocityArrayName(i == 3 ? "Drift" : "");
    flux->Update();
    CHECK(errors > 0 && flux->GetOutput()->GetNumberOfRows() == 0);
    CHECK(std::string(flux->GetErrorMessage()).find(sentences[i]) != std::string::npos);
  }
}

void CheckRow(vtkTable* table, vtkIdType row, const char* name, double area, double volumeFlux)
{
  CHECK(table->GetValueByName(row, "section").ToString() == name);
  CHECK(std::abs(NumberAt(table, row, "area") - area) < 1e-6 * area);
  CHECK(std::abs(NumberAt(table, row, "volume_flux") - volumeFlux) < 4e-6 * area);
  CHECK(std::abs(NumberAt(table, row, "velocity") - volumeFlux / area) < 4e-6);
}

/// By methods, and of the second input by names, closed or not; and the disc alone.
void CheckSections()
{
  auto cube = MakeMoving();
  cube->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), 0.75);
  auto flux = MakeFlux(cube);
  flux->AddRectangle("wall", Corner, End1, End2);
  flux->AddDisc("disc", Center, Along, 0.5);
  flux->AddBox("box", Box);
  vtkNew<vtkCubeSource> sides;
  sides->SetXLength(0.6);
  sides->Update();
  flux->AddSurface("sides", sides->GetOutput());
  vtkNew<vtkPlaneSource> plane;
  plane->SetOrigin(-0.2, -0.2, 0.1);
  plane->SetPoint1(0.2, -0.2, 0.1);
  plane->SetPoint2(-0.2, 0.2, 0.1);
  plane->SetResolution(3, 2);
  flux->SetSectionsConnection(plane->GetOutputPort());
  flux->Update();
  vtkTable* table = flux->GetOutput();
  CHECK(table->GetNumberOfRows() == 5 && table->GetNumberOfColumns() == 6);
  CHECK(NumberAt(table, 0, "time") == 0.75);
  const double pi = 3.14159265358979323846;
  CheckRow(table, 0, "wall", 0.42, 0.42);
  CheckRow(table, 1, "disc", 0.25 * pi, -0.75 * pi);
  CheckRow(table, 2, "box", 2 * (0.25 + 0.25 + 0.25), 0.0);
  CheckRow(table, 3, "sides", 2 * (0.6 + 0.6 + 1.0), 0.0);
  CheckRow(table, 4, "section", 0.16, 0.48);
  vtkNew<vtkPolyData> named;
  named->ShallowCopy(plane->GetOutput());
  vtkNew<vtkStringArray> names;
  names->SetName("Name");
  for (int i = 0; i < 6; ++i)
  {
    names->InsertNextValue(i < 3 ? "low" : "high");
  }
  named->GetCellData()->AddArray(names);
  flux->ClearSections();
  flux->SetSectionsData(named);
  flux->Update();
  CHECK(flux->GetOutput()->GetNumberOfRows() == 2);
  CheckRow(flux->GetOutput(), 0, "low", 0.08, 0.24);
  CheckRow(flux->GetOutput(), 1, "high", 0.08, 0.24);
  auto alone = MakeFlux(cube);
  alone->SetRadius(0.4);
  alone->Update();
  CheckRow(alone->GetOutput(), 0, "section", 0.16 * pi, 0.16 * pi);
  int warnings = 0;
  test::CountEvents(alone, vtkCommand::WarningEvent, &warnings);
  alone->SetOrigin(1e6, 0, 0);
  alone->Update();
  CHECK(warnings == 1 && NumberAt(alone->GetOutput(), 0, "area") == 0);
}

/// The density is an array, one value, mass / volume, or not known.
void CheckDensity()
{
  for (int kind = 0; kind < 4; ++kind)
  {
    auto cube = MakeMoving();
    vtkPointData* arrays = cube->GetPointData();
    const vtkIdType count = cube->GetNumberOfPoints();
    for (const char* name : { "Density", "Mass", "Volume" })
    {
      arrays->RemoveArray(name);
    }
    auto flux = MakeFlux(cube);
    const double volume = std::pow(test::Spacing, 3);
    test::AddArray<vtkDoubleArray>(cube, "Volume", 1, [=](vtkIdType, int) { return volume; });
    if (kind == 0)
    {
      test::AddArray<vtkDoubleArray>(cube, "Density", 1, [](vtkIdType, int) { return 7.0; });
    }
    else if (kind == 2)
    {
      test::AddArray<vtkDoubleArray>(cube, "Mass", 1, [=](vtkIdType, int) { return 7 * volume; });
    }
    flux->SetDensity(kind == 1 ? 7.0 : 0.0);
    flux->SetVolumeArrayName("Volume");
    flux->AddRectangle("wall", Corner, End1, End2);
    flux->Update();
    const double mass = NumberAt(flux->GetOutput(), 0, "mass_flux");
    CHECK(count > 0 && (kind == 3 ? std::isnan(mass) : std::abs(mass - 7 * 0.42) < 1e-5));
  }
}
}

int TestFlux(int, char*[])
{
  CheckWeird();
  CheckSections();
  CheckDensity();
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
