// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Numbers: the surface of Radius = 0.6 against a brute-force evaluation of the same field, in double precision.
#include "TestParticles.h"

#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkPolygon.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace
{
int failures = 0;

double Residual(vtkPolyData* cube, const double x[3], double iso, bool shepard)
{
  const test::FieldValue f =
    test::EvaluateField(cube, cube->GetPointData()->GetArray("Radius"), test::SmoothingLength, x);
  return std::fabs((shepard ? f.Shepard : f.Sum) - iso);
}

// Radius grows outward; normals point to lower values, as those of vtkContourFilter do, and triangles as they do.
void CheckTriangles(vtkPolyData* surface)
{
  vtkDataArray* normals = surface->GetPointData()->GetNormals();
  CHECK(normals && !std::strcmp(normals->GetName(), "Normals"));
  int disagree = 0, outward = 0;
  for (vtkIdType i = 0; normals && i < surface->GetNumberOfCells(); ++i)
  {
    double a[3], n[3], g[3];
    vtkCell* triangle = surface->GetCell(i);
    triangle->GetPoints()->GetPoint(0, a);
    vtkPolygon::ComputeNormal(triangle->GetPoints(), g);
    normals->GetTuple(triangle->GetPointId(0), n);
    disagree += vtkMath::Dot(g, n) < 0.0 ? 1 : 0;
    outward += vtkMath::Dot(a, n) > 0.0 ? 1 : 0;
  }
  CHECK(disagree == 0 && outward == 0);
}

void TestSphere(bool shepard)
{
  auto cube = test::MakeCube();
  auto filter = test::MakeSphereFilter(cube);
  filter->SetShepardNormalization(shepard);
  filter->Update();
  vtkPolyData* surface = filter->GetOutput();
  CHECK(surface->GetNumberOfPoints() > 1000);
  double worst = 0.0;
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); i += 13)
  {
    worst = std::max(worst, Residual(cube, surface->GetPoint(i), 0.6, shepard));
  }
  std::cout << (shepard ? "Shepard" : "sum") << ": " << surface->GetNumberOfPoints()
            << " points, residual " << worst << "\n";
  CHECK(worst < 1e-5 * std::sqrt(3.0));
  if (shepard) // the sum has a second sheet along the faces of the cube
  {
    CheckTriangles(surface);
  }
}

void TestSeveralValues()
{
  auto filter = test::MakeSphereFilter(test::MakeCube());
  filter->GenerateValues(3, 0.3, 0.7);
  filter->Update();
  const vtkIdType all = filter->GetOutput()->GetNumberOfCells();
  vtkIdType sum = 0;
  for (const double value : { 0.3, 0.5, 0.7 })
  {
    filter->SetNumberOfContours(1);
    filter->SetValue(0, value);
    filter->Update();
    sum += filter->GetOutput()->GetNumberOfCells();
  }
  CHECK(all > 0 && all == sum);

  filter->FreeSurfaceOn();
  filter->SetFreeSurfaceValue(0, 0.3);
  filter->SetFreeSurfaceValue(1, 0.6);
  filter->Update();
  double range[2];
  vtkDataArray* iso = filter->GetOutput()->GetPointData()->GetArray("IsoValue");
  CHECK(iso != nullptr);
  if (iso)
  {
    iso->GetRange(range);
    CHECK(range[0] == 0.3 && range[1] == 0.6);
  }
}

// Without an iso value: the median of the fluid, not moved by single extreme particles; of values that range
// over decades the middle in logarithms. Whole numbers stay whole.
void TestDefaultValue()
{
  auto cube = test::MakeCube();
  vtkDataArray* radius = cube->GetPointData()->GetArray("Radius");
  auto filter = test::MakeSphereFilter(cube);
  const auto used = [&filter]()
  {
    filter->Update();
    CHECK(filter->GetOutput()->GetNumberOfCells() > 0);
    vtkDataArray* values = filter->GetOutput()->GetFieldData()->GetArray("IsoValues");
    CHECK(values && values->GetNumberOfTuples() == 1);
    return values ? values->GetComponent(0, 0) : 0.0;
  };
  filter->SetNumberOfContours(0);
  const double middle = used();
  std::vector<double> sorted;
  for (vtkIdType i = 0; i < radius->GetNumberOfTuples(); ++i)
  {
    sorted.push_back(radius->GetComponent(i, 0));
  }
  std::sort(sorted.begin(), sorted.end());
  CHECK(middle == sorted[(sorted.size() - 1) / 2]);
  CHECK(filter->GetNextIsoValue() == middle);
  for (vtkIdType i = 0; i < 10; ++i)
  {
    radius->SetComponent(i, 0, 1e6);
  }
  radius->Modified();
  CHECK(std::fabs(used() - middle) < 0.02);
  filter->SetNumberOfContours(1);
  filter->SetValue(0, std::numeric_limits<double>::quiet_NaN()); // an empty row
  CHECK(std::fabs(used() - middle) < 0.02);
  filter->SetNumberOfContours(0);
  test::AddArray<vtkDoubleArray>(cube, "Decades", 1,
    [&](vtkIdType i, int) { return std::pow(10.0, -3.0 + 2.0 * cube->GetPoint(i)[0]); });
  test::AddArray<vtkIntArray>(
    cube, "Whole", 1, [&](vtkIdType i, int) { return std::floor(9.0 * cube->GetPoint(i)[0]); });
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Decades");
  CHECK(std::fabs(std::log10(used()) + 3.0) < 0.1);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Whole");
  const double whole = used();
  CHECK(whole == std::floor(whole) && std::fabs(whole) < 2.0);
  filter->FreeSurfaceOn();
  filter->SetNumberOfFreeSurfaceValues(0);
  CHECK(used() == 0.5);
}

// A lower tolerance takes more iterations; where these are too few, vertices stay above it.
void TestTolerance()
{
  auto cube = test::MakeCube();
  auto filter = test::MakeSphereFilter(cube);
  filter->SetPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  const auto worst = [&]()
  {
    filter->Update();
    vtkPolyData* surface = filter->GetOutput();
    double residual = 0.0;
    for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); i += 7)
    {
      residual = std::max(residual, Residual(cube, surface->GetPoint(i), 0.6, true));
    }
    std::cout << "tolerance " << filter->GetTolerance() << ", " << filter->GetIterationLimit()
              << " iterations: residual " << residual << "\n";
    return residual;
  };
  const auto number = [&](const char* name)
  {
    vtkDataArray* array = filter->GetRunStatistics()->GetArray(name);
    CHECK(array != nullptr);
    return array ? array->GetComponent(0, 0) : -1.0;
  };
  const double bound = 1e-12 * std::sqrt(3.0);
  CHECK(worst() > 10.0 * bound);
  const double evaluations = number("NewtonEvaluations");

  filter->SetTolerance(1e-12);
  CHECK(worst() < 1.1 * bound);
  CHECK(number("NewtonEvaluations") > evaluations);
  CHECK(number("IterationsMax") > 1.0);
  CHECK(number("VerticesAboveTolerance") == 0.0);

  filter->SetIterationLimit(1);
  CHECK(worst() > 10.0 * bound);
  CHECK(number("IterationsMax") == 1.0);
  CHECK(number("VerticesAboveTolerance") > 0.0);
}
}

int TestAnalyticField(int, char*[])
{
  TestSphere(true);
  TestSphere(false);
  TestSeveralValues();
  TestDefaultValue();
  TestTolerance();
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
