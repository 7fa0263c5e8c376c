// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Numbers: the surface of Radius = 0.6 against a brute-force evaluation of the same field, in
// double precision, and against the sphere it nearly is.
#include "TestParticles.h"

#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>
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

// Each edge of a closed, oriented surface is used by two triangles, once in each direction.
bool IsClosedAndOriented(vtkPolyData* surface)
{
  std::map<std::pair<vtkIdType, vtkIdType>, int> edges;
  vtkNew<vtkIdList> t;
  for (vtkIdType i = 0; i < surface->GetNumberOfCells(); ++i)
  {
    surface->GetCellPoints(i, t);
    for (int e = 0; e < 3; ++e)
    {
      ++edges[{ t->GetId(e), t->GetId((e + 1) % 3) }];
    }
  }
  return std::all_of(edges.begin(), edges.end(),
    [&edges](const auto& edge)
    {
      const auto twin = edges.find({ edge.first.second, edge.first.first });
      return edge.second == 1 && twin != edges.end() && twin->second == 1;
    });
}

// Area, and whether the triangles' normals agree with the vertex normals and point inward.
void CheckTriangles(vtkPolyData* surface, double radius)
{
  vtkDataArray* normals = surface->GetPointData()->GetNormals();
  CHECK(normals && !std::strcmp(normals->GetName(), "Normals"));
  vtkNew<vtkIdList> t;
  double area = 0.0;
  int disagree = 0, outward = 0;
  for (vtkIdType i = 0; normals && i < surface->GetNumberOfCells(); ++i)
  {
    surface->GetCellPoints(i, t);
    double a[3], b[3], c[3], n[3];
    surface->GetPoint(t->GetId(0), a);
    surface->GetPoint(t->GetId(1), b);
    surface->GetPoint(t->GetId(2), c);
    normals->GetTuple(t->GetId(0), n);
    const double u[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    const double v[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };
    const double g[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
      u[0] * v[1] - u[1] * v[0] };
    const double length = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    area += 0.5 * length;
    // Slivers have no reliable direction.
    disagree += length > 1e-9 && g[0] * n[0] + g[1] * n[1] + g[2] * n[2] < 0.0 ? 1 : 0;
    outward += a[0] * n[0] + a[1] * n[1] + a[2] * n[2] > 0.0 ? 1 : 0;
  }
  const double pi = 3.14159265358979323846;
  CHECK(std::fabs(area / (4.0 * pi * radius * radius) - 1.0) < 0.03);
  CHECK(disagree == 0);
  // Radius grows outward, and normals point to lower values as those of vtkContourFilter do.
  CHECK(outward == 0);
}

void CheckNormals(vtkPolyData* cube, vtkPolyData* surface)
{
  vtkDataArray* radius = cube->GetPointData()->GetArray("Radius");
  vtkDataArray* normals = surface->GetPointData()->GetNormals();
  vtkDataArray* gradients = surface->GetPointData()->GetArray("Gradients");
  CHECK(gradients && gradients->GetNumberOfComponents() == 3);
  double worst = 0.0;
  for (vtkIdType i = 0; normals && gradients && i < surface->GetNumberOfPoints(); i += 97)
  {
    double x[3], n[3], g[3], length = 0.0, dot = 0.0;
    surface->GetPoint(i, x);
    normals->GetTuple(i, n);
    for (int c = 0; c < 3; ++c)
    {
      const double step = 1e-5;
      double low[3] = { x[0], x[1], x[2] }, high[3] = { x[0], x[1], x[2] };
      low[c] -= step;
      high[c] += step;
      g[c] = (test::EvaluateField(cube, radius, test::SmoothingLength, high).Shepard -
               test::EvaluateField(cube, radius, test::SmoothingLength, low).Shepard) /
        (2.0 * step);
      length += g[c] * g[c];
      dot -= g[c] * n[c];
      CHECK(std::fabs(g[c] - gradients->GetComponent(i, c)) < 1e-3);
    }
    worst = std::max(worst, std::acos(std::min(1.0, dot / std::sqrt(length))));
  }
  std::cout << "normals: at most " << worst * 57.29578 << " degrees off\n";
  CHECK(worst * 57.29578 < 0.5);
}

void TestSphere(bool shepard)
{
  auto cube = test::MakeCube();
  auto filter = test::MakeSphereFilter(cube);
  filter->SetShepardNormalization(shepard);
  filter->ComputeGradientsOn();
  filter->Update();
  vtkPolyData* surface = filter->GetOutput();
  CHECK(surface->GetNumberOfPoints() > 1000);
  double worst = 0.0, shortest = 1e9, longest = 0.0;
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    double x[3];
    surface->GetPoint(i, x);
    const double r = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    shortest = std::min(shortest, r);
    longest = std::max(longest, r);
    worst = i % 13 == 0 ? std::max(worst, Residual(cube, x, 0.6, shepard)) : worst;
  }
  std::cout << (shepard ? "Shepard" : "sum") << ": " << surface->GetNumberOfPoints()
            << " points, residual " << worst << ", radius " << shortest << " to " << longest
            << "\n";
  CHECK(worst < 1e-5 * std::sqrt(3.0));
  if (shepard) // the sum has a second sheet along the faces of the cube
  {
    CHECK(shortest > 0.5 && longest < 0.7);
    CHECK(IsClosedAndOriented(surface));
    CheckTriangles(surface, 0.5 * (shortest + longest));
    CheckNormals(cube, surface);
  }
}

void TestFreeSurface()
{
  auto cube = test::MakeCube();
  auto filter = vtkSmartPointer<vtkMarchingCorrectors>::New();
  filter->SetInputData(cube);
  filter->FreeSurfaceOn();
  filter->Update();
  vtkPolyData* surface = filter->GetOutput();
  double worst = 0.0;
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); i += 31)
  {
    double x[3];
    surface->GetPoint(i, x);
    const double w =
      test::EvaluateField(cube, cube->GetPointData()->GetArray("Radius"), test::SmoothingLength, x)
        .Weight;
    worst = std::max(worst, std::fabs(w - 0.5));
  }
  std::cout << "free surface: " << surface->GetNumberOfPoints() << " points, residual " << worst
            << "\n";
  CHECK(surface->GetNumberOfPoints() > 1000);
  CHECK(worst < 1e-5);
  CHECK(IsClosedAndOriented(surface));
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

// Preview puts vertices on the same edges, but not on the surface.
void TestPreview()
{
  auto cube = test::MakeCube();
  auto filter = test::MakeSphereFilter(cube);
  filter->Update();
  const vtkIdType count = filter->GetOutput()->GetNumberOfPoints();
  filter->PreviewOn();
  filter->Update();
  CHECK(filter->GetOutput()->GetNumberOfPoints() == count);
  double worst = 0.0;
  for (vtkIdType i = 0; i < filter->GetOutput()->GetNumberOfPoints(); i += 13)
  {
    worst = std::max(worst, Residual(cube, filter->GetOutput()->GetPoint(i), 0.6, true));
  }
  CHECK(worst > 1e-5 && worst < 0.01);
  CHECK(filter->GetOutput()->GetPointData()->GetNormals() != nullptr);
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
  TestFreeSurface();
  TestSeveralValues();
  TestDefaultValue();
  TestPreview();
  TestTolerance();
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
