// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Gauges: weird input first; then levels against brute force, from each way to name lines.
#include "TestParticles.h"

#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkLineSource.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkSPHGauge.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <limits>

namespace
{
int failures = 0;

double NumberAt(vtkTable* table, vtkIdType row, const char* column)
{
  return table->GetValueByName(row, column).ToDouble();
}

std::string TextAt(vtkTable* table, vtkIdType row, const char* column)
{
  return table->GetValueByName(row, column).ToString();
}

double WeightAt(vtkPolyData* cube, const double x[3])
{
  return test::EvaluateField(
    cube, cube->GetPointData()->GetArray("Radius"), test::SmoothingLength, x)
    .Weight;
}

/// An upright line through the cube is in fluid from its lower to its upper side.
void CheckRow(vtkTable* table, vtkIdType row, vtkPolyData* cube, double level)
{
  const double x[3] = { NumberAt(table, row, "x"), NumberAt(table, row, "y"),
    NumberAt(table, row, "z") };
  CHECK(TextAt(table, row, "state") == "wet");
  CHECK(NumberAt(table, row, "crossings") == 2);
  CHECK(x[2] > 0.9 && x[2] < 1.2);
  CHECK(std::abs(WeightAt(cube, x) - level) < 1e-4);
  CHECK(NumberAt(table, row, "first") == NumberAt(table, row, "last"));
  CHECK(std::abs(NumberAt(table, row, "last") - (x[2] + 2.0)) < 1e-9);
  CHECK(std::abs(NumberAt(table, row, "depth") - 2.0 * x[2]) < 0.05);
}

vtkSmartPointer<vtkSPHGauge> MakeGauge(vtkDataObject* particles)
{
  auto gauge = vtkSmartPointer<vtkSPHGauge>::New();
  gauge->SetInputDataObject(particles);
  return gauge;
}

void CheckWeird()
{
  auto cube = test::MakeCube();
  vtkNew<vtkPolyData> nothing;
  auto gauge = MakeGauge(nothing);
  gauge->Update();
  CHECK(gauge->GetOutput()->GetNumberOfRows() == 1);
  CHECK(TextAt(gauge->GetOutput(), 0, "state") == "dry");
  CHECK(std::isnan(NumberAt(gauge->GetOutput(), 0, "last")));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double ends[][2] = { { 0.0, 0.0 }, { 0.0, nan } };
  const char* const sentences[] = { "Gauge 'mast' has no length", "not finite" };
  for (int i = 0; i < 3; ++i)
  {
    gauge = MakeGauge(cube);
    int errors = 0;
    test::CountEvents(gauge, vtkCommand::ErrorEvent, &errors);
    gauge->AddGauge("mast", 0, 0, i < 2 ? ends[i][0] : 0.0, 0, 0, i < 2 ? ends[i][1] : 1.0);
    if (i == 2)
    {
      gauge->AddGauge("mast", 0, 0, 0, 1, 0, 1);
    }
    gauge->Update();
    CHECK(errors > 0 && gauge->GetOutput()->GetNumberOfRows() == 0);
    const std::string sentence = i < 2 ? sentences[i] : "Two gauges have the name 'mast'";
    CHECK(std::string(gauge->GetErrorMessage()).find(sentence) != std::string::npos);
  }
  gauge = MakeGauge(cube);
  int warnings = 0;
  test::CountEvents(gauge, vtkCommand::WarningEvent, &warnings);
  gauge->AddGauge("far", 1e6, 0, 0, 1e6, 0, 1);
  gauge->AddGauge("near", 0, 0, 0, 0, 0, 1.5);
  gauge->Update();
  CHECK(warnings == 1 && TextAt(gauge->GetOutput(), 0, "state") == "dry");
}

void CheckLevels()
{
  auto cube = test::MakeCube();
  cube->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), 0.75);
  auto gauge = MakeGauge(cube);
  gauge->AddGauge("mast", 0.02, 0.1, -2, 0.02, 0.1, 2);
  gauge->AddGauge("inside", 0, 0, 0, 0, 0, 0.5);
  for (const double level : { 0.5, 0.2, 0.8 })
  {
    gauge->SetLevel(level);
    gauge->Update();
    vtkTable* table = gauge->GetOutput();
    CHECK(table->GetNumberOfRows() == 2 && table->GetNumberOfColumns() == 10);
    CHECK(TextAt(table, 0, "gauge") == "mast" && NumberAt(table, 0, "time") == 0.75);
    CheckRow(table, 0, cube, level);
    CHECK(TextAt(table, 1, "state") == "full" && NumberAt(table, 1, "last") == 0.5);
  }
}

/// Lines of the second input, with and without names; and two points alone.
void CheckLines()
{
  auto cube = test::MakeCube();
  vtkNew<vtkLineSource> line;
  line->SetPoint1(0.3, 0.1, -2.0);
  line->SetPoint2(0.3, 0.1, 2.0);
  line->SetResolution(7); // one polyline, and one gauge
  auto gauge = MakeGauge(cube);
  gauge->SetLinesConnection(line->GetOutputPort());
  gauge->AddGauge("mast", 0.02, 0.1, -2, 0.02, 0.1, 2);
  gauge->Update();
  vtkTable* table = gauge->GetOutput();
  CHECK(table->GetNumberOfRows() == 2);
  CHECK(TextAt(table, 0, "gauge") == "mast" && TextAt(table, 1, "gauge") == "line 0");
  CheckRow(table, 0, cube, 0.5);
  CheckRow(table, 1, cube, 0.5);
  CHECK(std::abs(NumberAt(table, 1, "x") - 0.3) < 1e-6);
  vtkNew<vtkPolyData> named;
  named->ShallowCopy(line->GetOutput());
  vtkNew<vtkStringArray> names;
  names->SetName("Name");
  names->InsertNextValue("bow");
  named->GetCellData()->AddArray(names);
  gauge->SetLinesData(named);
  gauge->ClearGauges();
  gauge->Update();
  CHECK(TextAt(gauge->GetOutput(), 0, "gauge") == "bow");
  auto two = MakeGauge(cube);
  two->SetPoint1(0.3, 0.1, -2.0);
  two->SetPoint2(0.3, 0.1, 2.0);
  two->Update();
  CHECK(two->GetOutput()->GetNumberOfRows() == 1);
  CHECK(std::abs(NumberAt(two->GetOutput(), 0, "last") - NumberAt(gauge->GetOutput(), 0, "last")) <
    1e-5);
}

/// Blocks are one set of particles; solids do not count.
void CheckBlocksAndSolids()
{
  auto cube = test::MakeCube();
  test::AddArray<vtkDoubleArray>(
    cube, "Kind", 1, [&](vtkIdType i, int) { return cube->GetPoint(i)[2] > 0.45 ? 1.0 : 0.0; });
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, cube);
  auto gauge = MakeGauge(blocks);
  gauge->AddGauge("mast", 0.02, 0.1, -2, 0.02, 0.1, 2);
  gauge->Update();
  CHECK(gauge->GetOutput()->GetNumberOfRows() == 1);
  CheckRow(gauge->GetOutput(), 0, cube, 0.5);
  gauge->SetFluidArrayName("Kind");
  gauge->SetFluidValue(0.0);
  gauge->Update();
  const double top = NumberAt(gauge->GetOutput(), 0, "z");
  CHECK(std::abs(top - 0.45) < 0.04);
}
}

int TestGauge(int, char*[])
{
  CheckWeird();
  CheckLevels();
  CheckLines();
  CheckBlocksAndSolids();
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
