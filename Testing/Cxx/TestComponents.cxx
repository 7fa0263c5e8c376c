// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Pieces: weird input first; then against VTK's own connectivity and mass properties, and shapes of
// known volume.
#include "TestParticles.h"

#include "vtkAppendPolyData.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMassProperties.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPlaneSource.h"
#include "vtkPolyDataConnectivityFilter.h"
#include "vtkReverseSense.h"
#include "vtkSPHComponents.h"
#include "vtkSphereSource.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <array>
#include <functional>
#include <vector>

namespace
{
int failures = 0;

double At(vtkTable* table, vtkIdType row, const char* column)
{
  return table->GetValueByName(row, column).ToDouble();
}

vtkSmartPointer<vtkSPHComponents> Split(vtkPolyData* surface, vtkPointSet* particles = nullptr)
{
  auto split = vtkSmartPointer<vtkSPHComponents>::New();
  split->SetInputData(surface);
  split->SetParticlesData(particles);
  return split;
}

/// A sphere; `inwards` as the surface of a cavity is.
vtkSmartPointer<vtkPolyData> Sphere(double radius, double x, double y, bool inwards = false)
{
  vtkNew<vtkSphereSource> source;
  source->SetRadius(radius);
  source->SetCenter(x, y, 0.0);
  source->SetThetaResolution(60);
  source->SetPhiResolution(40);
  source->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  vtkNew<vtkReverseSense> reverse;
  reverse->SetInputConnection(source->GetOutputPort());
  reverse->SetReverseCells(inwards);
  reverse->Update();
  return reverse->GetOutput();
}

vtkSmartPointer<vtkPolyData> Together(const std::vector<vtkSmartPointer<vtkPolyData>>& parts)
{
  vtkNew<vtkAppendPolyData> append;
  append->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  for (const auto& part : parts)
  {
    append->AddInputData(part);
  }
  append->Update();
  return append->GetOutput();
}

/// Particles at these places, of mass 2, with velocities that are twice the place.
vtkSmartPointer<vtkPolyData> Particles(const std::vector<std::array<double, 3>>& places)
{
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const auto& place : places)
  {
    points->InsertNextPoint(place.data());
  }
  particles->SetPoints(points);
  test::AddArray<vtkDoubleArray>(particles, "Mass", 1, [](vtkIdType, int) { return 2.0; });
  test::AddArray<vtkDoubleArray>(
    particles, "Velocity", 3, [&](vtkIdType i, int c) { return 2.0 * points->GetPoint(i)[c]; });
  return particles;
}

void CheckWeird()
{
  vtkNew<vtkPolyData> nothing;
  auto split = Split(nothing, nothing);
  split->Update();
  CHECK(split->GetTable()->GetNumberOfRows() == 0 && split->GetTable()->GetNumberOfColumns() == 20);
  CHECK(split->GetOutput()->GetNumberOfPoints() == 0);
  vtkNew<vtkPlaneSource> plane; // a quad
  plane->Update();
  split = Split(plane->GetOutput());
  int errors = 0;
  test::CountEvents(split, vtkCommand::ErrorEvent, &errors);
  split->Update();
  CHECK(errors > 0);
}

/// A shell with a cavity in which a drop flies that has a bubble; another ball, an open one.
void CheckParents()
{
  auto open = Sphere(0.4, 0.0, 8.0);
  open->GetPolys()->ReplaceCellAtId(7, { 0, 0, 0 });
  auto surface = Together({ Sphere(0.5, 5.0, 0.0), Sphere(2.0, 0.0, 0.0), Sphere(0.6, 0.1, 0.0),
    Sphere(0.3, 0.1, 0.0, true), Sphere(1.5, 0.0, 0.0, true), open });
  auto particles = Particles(
    { { { 0.0, 1.7, 0.0 } }, { { 0.0, -1.7, 0.1 } }, { { 0.1, 0.5, 0.0 } }, { { 0.1, 0.0, 0.0 } },
      { { 0.0, 1.2, 0.0 } }, { { 9.0, 9.0, 9.0 } }, { { 5.0, 0.0, 0.0 } }, { { 0.0, 8.0, 0.0 } } });
  auto split = Split(surface, particles);
  split->Update();
  vtkTable* table = split->GetTable();
  CHECK(table->GetNumberOfRows() == 6);
  const double radius[6] = { 2.0, 1.5, 0.6, 0.5, 0.4, 0.3 };
  const double parent[6] = { -1, 0, -1, -1, -1, 2 }, held[6] = { 2, -1, 1, 1, -1, -1 };
  for (int i = 0; i < 6; ++i)
  {
    const double r = radius[i], volume = 4.0 / 3.0 * 3.14159265 * r * r * r;
    const bool closed = i != 4, cavity = i == 1 || i == 5;
    CHECK(At(table, i, "component") == i && At(table, i, "closed") == (closed ? 1 : 0));
    CHECK(std::abs(At(table, i, "area") / (4.0 * 3.14159265 * r * r) - 1.0) < 0.01);
    CHECK(closed ? std::abs(At(table, i, "volume") / (cavity ? -volume : volume) - 1.0) < 0.01
                 : std::isnan(At(table, i, "volume")));
    CHECK(!closed || std::abs(At(table, i, "diameter") / (2.0 * r) - 1.0) < 0.005);
    CHECK(parent[i] < 0 ? std::isnan(At(table, i, "parent")) : At(table, i, "parent") == parent[i]);
    CHECK(held[i] < 0
        ? std::isnan(At(table, i, "particles"))
        : At(table, i, "particles") == held[i] && At(table, i, "mass") == 2.0 * held[i]);
  }
  CHECK(std::abs(At(table, 0, "vy")) < 1e-12 && std::abs(At(table, 0, "vz") - 0.1) < 1e-12);
  CHECK(At(table, 3, "vx") == 10.0 && std::abs(At(table, 3, "x") - 5.0) < 1e-9);
  CHECK(std::abs(At(table, 3, "xmax") - 5.5) < 0.01 && std::abs(At(table, 3, "zmin") + 0.5) < 0.01);
  // The drop goes, and the bubble in it; so does the ball of one particle.
  split->SetLeastParticles(2);
  split->Update();
  CHECK(split->GetTable()->GetNumberOfRows() == 3);
  CHECK(At(split->GetTable(), 2, "component") == 2 && At(split->GetTable(), 2, "closed") == 0);
  split->SetLeastParticles(0);
  split->SetLeastVolume(4.0 / 3.0 * 3.14159265 * 0.55 * 0.55 * 0.55);
  split->Update();
  CHECK(split->GetTable()->GetNumberOfRows() == 4);
  auto* ids = split->GetOutput()->GetPointData()->GetArray("ComponentId");
  CHECK(ids && ids->GetNumberOfTuples() == split->GetOutput()->GetNumberOfPoints());
  CHECK(ids && ids->GetRange()[1] == 3.0);
}

/// Walls do not count where they are found; blocks of particles are one set.
void CheckFluid()
{
  auto surface = Together({ Sphere(2.0, 0.0, 0.0), Sphere(0.5, 5.0, 0.0) });
  auto particles =
    Particles({ { { 0.0, 1.7, 0.0 } }, { { 0.0, -1.0, 0.1 } }, { { 5.0, 0.0, 0.0 } } });
  test::AddArray<vtkIntArray>(
    particles, "ParticleType", 1, [](vtkIdType i, int) { return i == 1 ? 1 : 0; });
  auto split = Split(surface, particles);
  split->SetFluidArrayName("(automatic)"); // of a panel's list
  split->Update();
  CHECK(At(split->GetTable(), 0, "particles") == 2);
  split->DetectFluidOn();
  split->Update();
  CHECK(At(split->GetTable(), 0, "particles") == 1 && At(split->GetTable(), 1, "particles") == 1);
  split->SetFluidArrayName("ParticleType");
  split->SetFluidValue(1.0);
  split->Update();
  CHECK(At(split->GetTable(), 0, "particles") == 1 && At(split->GetTable(), 1, "particles") == 0);

  // Likewise in blocks, whose names tell of walls.
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, Particles({ { { 0.0, 1.7, 0.0 } } }));
  blocks->SetBlock(1, Particles({ { { 5.0, 0.0, 0.0 } } }));
  blocks->SetBlock(2, Particles({ { { 0.0, -1.0, 0.1 } } }));
  blocks->GetMetaData(2u)->Set(vtkCompositeDataSet::NAME(), "Walls");
  vtkNew<vtkSPHComponents> joined;
  joined->SetInputData(surface);
  joined->SetParticlesData(blocks);
  for (const bool detects : { false, true })
  {
    joined->SetDetectFluid(detects);
    joined->Update();
    CHECK(joined->GetTable() && At(joined->GetTable(), 0, "particles") == (detects ? 1 : 2));
    CHECK(joined->GetTable() && At(joined->GetTable(), 1, "particles") == 1);
  }
}

/// Each piece of a surface of noise, with VTK's own filters.
void CheckAgainstVtk()
{
  auto cube = test::MakeCube();
  test::AddArray<vtkDoubleArray>(cube, "Wave", 1,
    [&](vtkIdType i, int)
    {
      const double* x = cube->GetPoint(i);
      return std::sin(7.0 * x[0]) * std::sin(8.0 * x[1]) * std::sin(6.0 * x[2]);
    });
  vtkNew<vtkMarchingCorrectors> filter;
  filter->SetInputData(cube);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Wave");
  filter->SetValue(0, 0.3);
  filter->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  filter->Update();
  auto split = Split(filter->GetOutput(), cube);
  split->Update();
  vtkTable* table = split->GetTable();
  vtkPolyData* output = split->GetOutput();
  auto* pointIds = vtkIdTypeArray::SafeDownCast(output->GetPointData()->GetArray("ComponentId"));
  auto* cellIds = vtkIdTypeArray::SafeDownCast(output->GetCellData()->GetArray("ComponentId"));
  CHECK(output->GetNumberOfCells() == filter->GetOutput()->GetNumberOfCells());
  CHECK(pointIds && cellIds && output->GetPointData()->GetNormals());
  vtkNew<vtkPolyDataConnectivityFilter> connectivity;
  connectivity->SetInputData(output);
  connectivity->SetExtractionModeToAllRegions();
  connectivity->Update();
  CHECK(connectivity->GetNumberOfExtractedRegions() == table->GetNumberOfRows());
  CHECK(table->GetNumberOfRows() > 30);
  int closed = 0;
  double area = VTK_DOUBLE_MAX;
  for (vtkIdType i = 0; pointIds && cellIds && i < table->GetNumberOfRows(); ++i)
  {
    vtkNew<vtkPolyData> piece;
    vtkNew<vtkCellArray> cells;
    piece->SetPoints(output->GetPoints());
    for (vtkIdType t = 0; t < output->GetNumberOfCells(); ++t)
    {
      if (cellIds->GetValue(t) == i)
      {
        vtkNew<vtkIdList> corners;
        output->GetCellPoints(t, corners);
        cells->InsertNextCell(corners);
        CHECK(pointIds->GetValue(corners->GetId(1)) == i);
      }
    }
    piece->SetPolys(cells);
    vtkNew<vtkMassProperties> mass;
    mass->SetInputData(piece);
    mass->Update();
    CHECK(std::abs(At(table, i, "area") / mass->GetSurfaceArea() - 1.0) < 1e-5);
    CHECK(At(table, i, "area") <= area);
    area = At(table, i, "area");
    if (At(table, i, "closed") == 1.0)
    {
      ++closed;
      CHECK(std::abs(std::abs(At(table, i, "volume")) / mass->GetVolume() - 1.0) < 1e-5);
    }
  }
  CHECK(closed > 10);
}

/// A lattice of spacing 0.1 in the period 2, moved by `shift`: those whose way from the origin is wanted.
vtkSmartPointer<vtkPolyData> PeriodicLattice(
  const std::array<double, 3>& shift, const std::function<bool(const double way[3])>& wanted)
{
  std::vector<std::array<double, 3>> places;
  const int n = 20;
  for (int i = 0; i < n * n * n; ++i)
  {
    const double x[3] = { (i % n) * 0.1, (i / n % n) * 0.1, (i / n / n) * 0.1 };
    const double way[3] = { std::remainder(x[0], 2.0), std::remainder(x[1], 2.0),
      std::remainder(x[2], 2.0) };
    if (wanted(way))
    {
      places.push_back({ { way[0] + shift[0], way[1] + shift[1], way[2] + shift[2] } });
    }
  }
  return Particles(places);
}

vtkSmartPointer<vtkTable> PiecesOf(vtkPolyData* particles, const double period[6])
{
  vtkNew<vtkMarchingCorrectors> filter;
  filter->SetInputData(particles);
  filter->SetSmoothingLength(0.1);
  filter->FreeSurfaceOn();
  filter->SetCubeSize(0.05);
  filter->SetPeriodicBounds(period);
  filter->Update();
  auto split = Split(filter->GetOutput(), particles);
  split->SetPeriodicBounds(period);
  split->Update();
  return split->GetTable();
}

/// Wherever the period begins: its sides need not be planes of the lattice, where the surface ends.
void CheckSides()
{
  auto particles = PeriodicLattice({ { 0.01, 0.02, 0.03 } },
    [](const double x[3])
    {
      return std::hypot(std::hypot(x[0], x[1]), x[2]) < 0.45 ||
        std::hypot(std::hypot(x[0] - 0.8, x[1] - 0.8), x[2] - 0.8) < 0.3;
    });
  vtkSmartPointer<vtkTable> first;
  for (const double begin : { 0.0, -1.0, -0.33, 0.77, -7.12 })
  {
    const double period[6] = { begin, begin + 2.0, begin + 0.1, begin + 2.1, begin, begin + 2.0 };
    vtkSmartPointer<vtkTable> table = PiecesOf(particles, period);
    first = first ? first : table;
    CHECK(table->GetNumberOfRows() == 2);
    for (vtkIdType row = 0; row < table->GetNumberOfRows(); ++row)
    {
      CHECK(At(table, row, "closed") == 1.0);
      for (const char* column : { "area", "volume", "particles", "mass" })
      {
        CHECK(std::abs(At(table, row, column) / At(first, row, column) - 1.0) < 1e-5);
      }
      CHECK(At(table, row, "xmax") - At(table, row, "xmin") < 1.3);
      for (int a = 0; a < 3; ++a)
      {
        const char* const centres[3] = { "x", "y", "z" };
        const double centre = At(table, row, centres[a]);
        CHECK(std::abs(std::remainder(centre - At(first, row, centres[a]), 2.0)) < 1e-5);
        CHECK(centre > period[2 * a] - 1e-3 && centre < period[2 * a + 1] + 1e-3);
      }
    }
  }
}

/// A drop in a bubble of a ball, and of a layer without an end, holds its particles wherever sides cut these.
void CheckDropsInBubbles()
{
  for (const bool isLayer : { false, true })
  {
    for (const std::array<double, 3>& shift :
      { std::array<double, 3>{ { 1.0, 1.0, 1.0 } }, std::array<double, 3>{ { 0.0, 1.0, 1.0 } },
        std::array<double, 3>{ { 0.5, 0.1, 1.0 } }, std::array<double, 3>{ { 0.4, 1.8, 1.0 } } })
    {
      const auto radius = [](const double x[3])
      { return std::hypot(std::hypot(x[0], x[1]), x[2]); };
      auto particles = PeriodicLattice(shift,
        [isLayer, &radius](const double x[3])
        {
          const double r = radius(x);
          return r < 0.16 || (r > 0.42 && (isLayer ? std::abs(x[2]) < 0.75 : r < 0.75));
        });
      double dropped = 0.0;
      for (vtkIdType i = 0; i < particles->GetNumberOfPoints(); ++i)
      {
        double x[3];
        particles->GetPoint(i, x);
        for (int a = 0; a < 3; ++a)
        {
          x[a] -= shift[static_cast<size_t>(a)];
        }
        dropped += radius(x) < 0.16;
      }
      const double period[6] = { 0.0, 2.0, 0.0, 2.0, 0.0, isLayer ? 0.0 : 2.0 };
      vtkSmartPointer<vtkTable> table = PiecesOf(particles, period);
      const vtkIdType rows = isLayer ? 4 : 3;
      CHECK(table->GetNumberOfRows() == rows);
      int bubbles = 0, drops = 0;
      for (vtkIdType row = 0; row < table->GetNumberOfRows(); ++row)
      {
        const double volume = At(table, row, "volume");
        if (volume < 0.0)
        {
          const double parent = At(table, row, "parent");
          CHECK(parent >= 0.0 &&
            std::isnan(At(table, static_cast<vtkIdType>(parent), "volume")) == isLayer);
          ++bubbles;
        }
        else if (volume < 0.1)
        {
          CHECK(At(table, row, "particles") == dropped);
          ++drops;
        }
        else if (volume > 0.1)
        {
          CHECK(At(table, row, "particles") ==
            static_cast<double>(particles->GetNumberOfPoints()) - dropped);
        }
      }
      CHECK(bubbles == 1 && drops == 1);
    }
  }
}

}

int TestComponents(int, char*[])
{
  CheckWeird();
  CheckParents();
  CheckFluid();
  CheckAgainstVtk();
  CheckSides();
  CheckDropsInBubbles();
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
