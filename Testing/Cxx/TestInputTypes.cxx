// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Any numeric array type, memory layout and kind of point set gives the same surface, and the input
// is never modified.
#include "TestParticles.h"

#include "vtkBitArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkSOADataArrayTemplate.h"
#include "vtkShortArray.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVariantArray.h"

#include <vector>

namespace
{
int failures = 0;

vtkSmartPointer<vtkPolyData> Extract(vtkDataSet* input, const char* scalar, double iso)
{
  auto filter = test::MakeSphereFilter(input);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, scalar);
  filter->SetValue(0, iso);
  filter->InterpolateAttributesOff();
  filter->ComputeScalarsOff();
  filter->Update();
  CHECK(!*filter->GetErrorMessage());
  CHECK(filter->GetOutput()->GetNumberOfPoints() > 0);
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->ShallowCopy(filter->GetOutput());
  return surface;
}

// Whole numbers, so that every type can hold them.
template <typename ArrayT>
vtkSmartPointer<vtkPolyData> ExtractAs(vtkPolyData* cube)
{
  vtkNew<vtkPolyData> particles;
  particles->ShallowCopy(cube);
  vtkDataArray* radius = cube->GetPointData()->GetArray("Radius");
  test::AddArray<ArrayT>(particles, "Count", 1,
    [radius](vtkIdType i, int) { return std::floor(100.0 * radius->GetComponent(i, 0)); });
  return Extract(particles, "Count", 60.5);
}

void TestScalarTypes()
{
  auto cube = test::MakeCube();
  auto expected = ExtractAs<vtkDoubleArray>(cube);
  CHECK(test::SameSurface(expected, ExtractAs<vtkFloatArray>(cube)));
  CHECK(test::SameSurface(expected, ExtractAs<vtkIntArray>(cube)));
  CHECK(test::SameSurface(expected, ExtractAs<vtkShortArray>(cube)));
  CHECK(test::SameSurface(expected, ExtractAs<vtkIdTypeArray>(cube)));
  CHECK(test::SameSurface(expected, ExtractAs<vtkUnsignedCharArray>(cube)));
  CHECK(test::SameSurface(expected, ExtractAs<vtkSOADataArrayTemplate<float>>(cube)));
  CHECK(test::SameSurface(expected, ExtractAs<vtkSOADataArrayTemplate<double>>(cube)));
}

// Vectors: magnitude, one component, dot product; each equals the scalar computed beforehand.
void TestVectors()
{
  auto cube = test::MakeCube();
  const auto position = [&cube](vtkIdType i, int c) { return cube->GetPoint(i)[c]; };
  test::AddArray<vtkDoubleArray>(cube, "Vector", 3, position);
  test::AddArray<vtkSOADataArrayTemplate<double>>(cube, "SoaVector", 3, position);
  test::AddArray<vtkDoubleArray>(
    cube, "Third", 1, [&](vtkIdType i, int) { return position(i, 2); });
  test::AddArray<vtkDoubleArray>(cube, "Square", 1,
    [&](vtkIdType i, int)
    {
      const double x = position(i, 0), y = position(i, 1), z = position(i, 2);
      return x * x + y * y + z * z;
    });
  const auto extract = [&cube](const char* first, const char* second, int component, double iso)
  {
    auto filter = test::MakeSphereFilter(cube);
    filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, first);
    if (second)
    {
      filter->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, second);
    }
    filter->SetScalarComponent(component);
    filter->SetValue(0, iso);
    filter->InterpolateAttributesOff();
    filter->ComputeScalarsOff();
    filter->Update();
    CHECK(filter->GetOutput()->GetNumberOfPoints() > 0);
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    surface->ShallowCopy(filter->GetOutput());
    return surface;
  };
  const int magnitude = vtkMarchingCorrectors::MAGNITUDE;
  CHECK(test::SameSurface(
    extract("Vector", nullptr, magnitude, 0.6), extract("SoaVector", nullptr, magnitude, 0.6)));
  CHECK(test::SameSurface(
    extract("Vector", nullptr, 2, 0.03), extract("Third", nullptr, magnitude, 0.03)));
  const auto dot = extract("Vector", "SoaVector", magnitude, 0.36);
  const auto square = extract("Square", nullptr, magnitude, 0.36);
  CHECK(dot->GetNumberOfPoints() == square->GetNumberOfPoints());
  CHECK(dot->GetNumberOfCells() == square->GetNumberOfCells());
}

// Kinds of arrays that are rare: each as scalar, and carried to the surface.
void TestRareArrays()
{
  auto cube = test::MakeCube();
  vtkDataArray* radius = cube->GetPointData()->GetArray("Radius");
  const auto inside = [radius](vtkIdType i, int)
  { return radius->GetComponent(i, 0) < 0.6 ? 1.0 : 0.0; };
  test::AddArray<vtkUnsignedCharArray>(cube, "Byte", 1, inside);
  test::AddArray<vtkBitArray>(cube, "Bit", 1, inside);
  vtkNew<vtkVariantArray> variants;
  variants->SetName("Variant");
  for (vtkIdType i = 0; i < cube->GetNumberOfPoints(); ++i)
  {
    variants->InsertNextValue(vtkVariant(static_cast<int>(i)));
  }
  cube->GetPointData()->AddArray(variants);
  cube->GetPointData()->AddArray(vtkNew<vtkFloatArray>()); // no name, no tuples
  vtkNew<vtkDoubleArray> none;
  none->SetName("hsml");
  cube->GetPointData()->AddArray(none);
  auto shared = vtkSmartPointer<vtkDataArray>(cube->GetPoints()->GetData());
  shared->SetName("Position");
  cube->GetPointData()->AddArray(shared); // the points' own array
  CHECK(test::SameSurface(Extract(cube, "Byte", 0.5), Extract(cube, "Bit", 0.5)));

  auto filter = test::MakeSphereFilter(cube);
  filter->Update();
  vtkPolyData* surface = filter->GetOutput();
  vtkPointData* data = surface->GetPointData();
  CHECK(surface->GetNumberOfPoints() > 0);
  auto* bits = vtkBitArray::SafeDownCast(data->GetArray("Bit"));
  auto* ids = vtkVariantArray::SafeDownCast(data->GetAbstractArray("Variant"));
  vtkDataArray *bytes = data->GetArray("Byte"), *positions = data->GetArray("Position");
  CHECK(bits && ids && bytes && positions && !data->HasArray("hsml"));
  CHECK(positions && positions != surface->GetPoints()->GetData());
  for (vtkIdType i = 0; bits && ids && bytes && i < surface->GetNumberOfPoints(); ++i)
  {
    CHECK(bits->GetValue(i) == static_cast<int>(bytes->GetComponent(i, 0)));
    CHECK(bits->GetValue(i) == inside(ids->GetValue(i).ToInt(), 0));
  }
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    CHECK(data->GetAbstractArray(i)->GetNumberOfTuples() == surface->GetNumberOfPoints());
  }
}

// One array in several roles.
void TestSharedArrays()
{
  auto cube = test::MakeCube();
  auto filter = test::MakeSphereFilter(cube);
  filter->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "SmoothingLength");
  filter->SetFluidArrayName("SmoothingLength");
  filter->SetFluidValue(test::SmoothingLength);
  filter->SetMassArrayName("SmoothingLength");
  filter->SetValue(0, test::SmoothingLength / 2.0);
  filter->Update();
  CHECK(!*filter->GetErrorMessage());
  CHECK(filter->GetOutput()->GetNumberOfPoints() == 0); // constant: nowhere half of it
}

void TestIntegerPoints()
{
  vtkNew<vtkPoints> whole, real;
  whole->SetDataType(VTK_INT);
  for (int i = 0; i < 1000; ++i)
  {
    const double x[] = { static_cast<double>(i % 10), static_cast<double>(i / 10 % 10),
      static_cast<double>(i / 100) };
    whole->InsertNextPoint(x);
    real->InsertNextPoint(x);
  }
  const auto extract = [](vtkPoints* points)
  {
    vtkNew<vtkPolyData> particles;
    particles->SetPoints(points);
    auto filter = vtkSmartPointer<vtkMarchingCorrectors>::New();
    filter->SetInputData(particles);
    filter->SetSmoothingLength(1.3);
    filter->FreeSurfaceOn();
    filter->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    filter->Update();
    CHECK(filter->GetOutput()->GetNumberOfPoints() > 0);
    vtkSmartPointer<vtkPolyData> surface = filter->GetOutput();
    filter->SetOutputPointsPrecision(vtkAlgorithm::DEFAULT_PRECISION);
    return surface;
  };
  CHECK(test::SameSurface(extract(whole), extract(real)));
}

void TestPointTypes()
{
  const auto asFloat = Extract(test::MakeCube(VTK_FLOAT), "Radius", 0.6);
  const auto asDouble = Extract(test::MakeCube(VTK_DOUBLE), "Radius", 0.6);
  CHECK(asFloat->GetPoints()->GetDataType() == VTK_FLOAT);
  CHECK(asDouble->GetPoints()->GetDataType() == VTK_DOUBLE);
  CHECK(asFloat->GetNumberOfCells() > 0);
}

void TestPointSets()
{
  auto cube = test::MakeCube();
  const auto expected = Extract(cube, "Radius", 0.6);

  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(cube->GetPoints());
  grid->GetPointData()->ShallowCopy(cube->GetPointData());
  CHECK(test::SameSurface(expected, Extract(grid, "Radius", 0.6)));

  vtkNew<vtkStructuredGrid> structured;
  structured->SetDimensions(21, 21, 21);
  structured->SetPoints(cube->GetPoints());
  structured->GetPointData()->ShallowCopy(cube->GetPointData());
  CHECK(test::SameSurface(expected, Extract(structured, "Radius", 0.6)));

  vtkNew<vtkPolyData> vertices;
  vertices->ShallowCopy(cube);
  vtkNew<vtkCellArray> cells;
  for (vtkIdType i = 0; i < cube->GetNumberOfPoints(); ++i)
  {
    cells->InsertNextCell(1, &i);
  }
  vertices->SetVerts(cells);
  CHECK(test::SameSurface(expected, Extract(vertices, "Radius", 0.6)));

  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetNumberOfBlocks(2);
  blocks->SetBlock(0, cube);
  blocks->SetBlock(1, grid);
  auto filter = test::MakeSphereFilter(blocks);
  filter->SetBlocksToApart();
  filter->InterpolateAttributesOff();
  filter->ComputeScalarsOff();
  filter->Update();
  auto* output = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
  CHECK(output && output->GetNumberOfBlocks() == 2);
  for (unsigned int i = 0; output && i < 2; ++i)
  {
    auto* surface = vtkPolyData::SafeDownCast(output->GetBlock(i));
    CHECK(surface && test::SameSurface(expected, surface));
  }
}

// All ways to the same volumes; a mass that is set goes before a volume array that is there.
void TestQuantities()
{
  auto cube = test::MakeCube();
  const auto expected = Extract(cube, "Radius", 0.6);
  const double volume = test::Spacing * test::Spacing * test::Spacing;
  test::AddArray<vtkDoubleArray>(
    cube, "my masses", 1, [volume](vtkIdType, int) { return 4.0 * volume; });
  test::AddArray<vtkDoubleArray>(cube, "RHO", 1, [](vtkIdType, int) { return 4.0; });
  auto filter = test::MakeSphereFilter(cube);
  filter->InterpolateAttributesOff();
  filter->ComputeScalarsOff();
  filter->Update();
  CHECK(!std::strcmp(filter->GetUsedSmoothingLengthArrayName(), "SmoothingLength"));
  CHECK(!std::strcmp(filter->GetUsedVolumeArrayName(), "Volume"));
  CHECK(!*filter->GetUsedMassArrayName());
  filter->SetMassArrayName("my masses");
  filter->Update();
  CHECK(!*filter->GetUsedVolumeArrayName());
  CHECK(!std::strcmp(filter->GetUsedMassArrayName(), "my masses"));
  CHECK(!std::strcmp(filter->GetUsedDensityArrayName(), "RHO"));
  CHECK(test::SameSurface(expected, filter->GetOutput()));
  filter->SetMassArrayName("");
  filter->SetMass(4.0 * volume);
  filter->SetDensity(4.0);
  filter->SetSmoothingLength(test::SmoothingLength);
  filter->Update();
  CHECK(!*filter->GetUsedMassArrayName() && !*filter->GetUsedDensityArrayName());
  CHECK(!*filter->GetUsedSmoothingLengthArrayName());
  CHECK(test::SameSurface(expected, filter->GetOutput()));
  filter->SetSmoothingLength(2.0 * test::SmoothingLength);
  filter->SmoothingLengthIsSupportRadiusOn();
  filter->Update();
  CHECK(test::SameSurface(expected, filter->GetOutput()));
}

void TestInputUnmodified()
{
  auto cube = test::MakeCube();
  vtkNew<vtkPolyData> before;
  before->DeepCopy(cube);
  const vtkMTimeType time = cube->GetMTime();
  const int arrays = cube->GetPointData()->GetNumberOfArrays();
  Extract(cube, "Radius", 0.6);
  CHECK(cube->GetMTime() == time);
  CHECK(cube->GetPointData()->GetNumberOfArrays() == arrays);
  CHECK(test::SameValues(before->GetPoints()->GetData(), cube->GetPoints()->GetData()));
  for (int i = 0; i < arrays; ++i)
  {
    CHECK(test::SameValues(before->GetPointData()->GetArray(i), cube->GetPointData()->GetArray(i)));
  }
}
}

int TestInputTypes(int, char*[])
{
  TestScalarTypes();
  TestVectors();
  TestRareArrays();
  TestSharedArrays();
  TestIntegerPoints();
  TestPointTypes();
  TestPointSets();
  TestQuantities();
  TestInputUnmodified();
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
