// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Two dimensions: lines, and what is filled between them.
#include "TestPlaneParticles.h"

#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkFeatureEdges.h"
#include "vtkTriangle.h"

namespace
{
int failures = 0;

// Triangles and lines carry the value with which their band begins.
void TestBands()
{
  auto filter = test::MakePlaneFilter();
  filter->Update();
  CHECK(filter->GetOutput()->GetNumberOfPolys() == 0);
  CHECK(!filter->GetOutput()->GetCellData()->HasArray("BandValue"));
  CHECK(filter->GetOutput()->GetPointData()->HasArray("Normals"));
  CHECK(!filter->GetOutput()->GetPointData()->GetNormals()); // lines would be lit by them
  filter->FilledOn();
  filter->Update();
  vtkPolyData* output = filter->GetOutput();
  vtkDataArray* bands = output->GetCellData()->GetArray("BandValue");
  CHECK(output->GetNumberOfLines() == 2 && output->GetNumberOfPolys() > 500);
  CHECK(bands && bands->GetNumberOfTuples() == output->GetNumberOfCells());
  double areas[3] = { 0.0, 0.0, 0.0 }, sum = 0.0;
  for (vtkIdType i = 0; bands && i < output->GetNumberOfCells(); ++i)
  {
    vtkCell* cell = output->GetCell(i);
    const double value = bands->GetTuple1(i);
    const int band = value == -1.0 ? 0 : value == 0.3 ? 1 : 2;
    CHECK(value == -1.0 || value == 0.3 || value == 0.6);
    CHECK(cell->GetCellDimension() == (i < 2 ? 1 : 2));
    if (cell->GetCellDimension() == 2)
    {
      double a[3], b[3], c[3];
      cell->GetPoints()->GetPoint(0, a);
      cell->GetPoints()->GetPoint(1, b);
      cell->GetPoints()->GetPoint(2, c);
      areas[band] += vtkTriangle::TriangleArea(a, b, c);
      sum += vtkTriangle::TriangleArea(a, b, c);
    }
  }
  const double pi = 3.14159265358979;
  CHECK(std::fabs(areas[0] - 0.09 * pi) < 0.02);
  CHECK(std::fabs(areas[1] - 0.27 * pi) < 0.02);
  CHECK(std::fabs(sum - 4.41) < 0.2);
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputData(output);
  edges->ManifoldEdgesOff();
  edges->FeatureEdgesOff();
  edges->BoundaryEdgesOff();
  edges->Update();
  CHECK(edges->GetOutput()->GetNumberOfCells() ==
    0); // each edge has two triangles, or is on the border
}

void TestSpace()
{
  auto filter = test::MakeSphereFilter(test::MakeCube());
  filter->FilledOn();
  int errors = 0;
  test::CountEvents(filter, vtkCommand::ErrorEvent, &errors);
  filter->Update();
  CHECK(errors > 0 && filter->GetOutput()->GetNumberOfCells() == 0);
  CHECK(std::string(filter->GetErrorMessage()).find("two dimensions") != std::string::npos);
}
}

int TestPlane(int, char*[])
{
  TestBands();
  TestSpace();
  return failures;
}
