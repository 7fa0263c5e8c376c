// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Gradients at the particles: exact for linear fields, zeros for solids; the arrays
// by VTK's names; sentences for what cannot be used.
#include "TestParticles.h"

#include "vtkCommand.h"
#include "vtkSPHDerivatives.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>

namespace
{
int failures = 0;

using Matrix = std::array<double, 9>;
const Matrix Rotation = { 0.0, -0.5, -0.2, 0.5, 0.0, -0.3, 0.2, 0.3, 0.0 }; // w = (0.3, -0.2, 0.5)
const Matrix Shear = { 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };

/// The cube, one h or up to 1.5 times as large at one side.
vtkSmartPointer<vtkPolyData> MakeParticles(bool varying)
{
  auto cube = test::MakeCube();
  if (varying)
  {
    vtkDataArray* h = cube->GetPointData()->GetArray("SmoothingLength");
    for (vtkIdType i = 0; i < cube->GetNumberOfPoints(); ++i)
    {
      h->SetComponent(i, 0, test::SmoothingLength * (1.25 + 0.25 * cube->GetPoint(i)[0]));
    }
  }
  return cube;
}

/// Velocity = J x + 7.
template <typename ArrayT>
void AddVelocity(vtkPolyData* particles, const Matrix& j)
{
  test::AddArray<ArrayT>(particles, "Velocity", 3,
    [&](vtkIdType i, int c)
    {
      double x[3];
      particles->GetPoint(i, x);
      return 7.0 + j[3 * c] * x[0] + j[3 * c + 1] * x[1] + j[3 * c + 2] * x[2];
    });
}

vtkSmartPointer<vtkSPHDerivatives> MakeFilter(vtkDataObject* input, const char* array)
{
  auto filter = vtkSmartPointer<vtkSPHDerivatives>::New();
  filter->SetInputDataObject(input);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, array);
  return filter;
}

vtkDataArray* ArrayOf(vtkSPHDerivatives* filter, const char* name)
{
  return vtkPointSet::SafeDownCast(filter->GetOutput())->GetPointData()->GetArray(name);
}

/// The largest difference from these values, over all particles.
double ErrorOf(vtkSPHDerivatives* filter, const char* name, const std::vector<double>& expected)
{
  vtkDataArray* array = ArrayOf(filter, name);
  if (!array || array->GetNumberOfComponents() != static_cast<int>(expected.size()))
  {
    return 1e300;
  }
  double error = 0.0;
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    for (size_t c = 0; c < expected.size(); ++c)
    {
      error = std::max(error, std::abs(array->GetComponent(i, static_cast<int>(c)) - expected[c]));
    }
  }
  return error;
}

void CheckLinear(bool varying, const Matrix& j, bool isDouble)
{
  auto particles = MakeParticles(varying);
  isDouble ? AddVelocity<vtkDoubleArray>(particles, j) : AddVelocity<vtkFloatArray>(particles, j);
  auto filter = MakeFilter(particles, "Velocity");
  filter->SetPrecision(isDouble ? vtkAlgorithm::DOUBLE_PRECISION : vtkAlgorithm::SINGLE_PRECISION);
  filter->ComputeStrainRateOn();
  filter->Update();
  const double tolerance = isDouble ? 1e-12 : 1e-5;
  std::vector<double> strain(9);
  double trace2 = 0.0;
  for (int a = 0; a < 9; ++a)
  {
    const int transposed = a % 3 * 3 + a / 3;
    strain[a] = 0.5 * (j[a] + j[transposed]);
    trace2 += j[a] * j[transposed];
  }
  // The rotation has -|w|^2; a shear's S S + O O is 0.
  const double lambda2 = j == Rotation ? -0.38 : 0.0;
  CHECK(ArrayOf(filter, "Gradients")->GetDataType() == (isDouble ? VTK_DOUBLE : VTK_FLOAT));
  CHECK(ErrorOf(filter, "Gradients", { j.begin(), j.end() }) < tolerance);
  CHECK(ErrorOf(filter, "GradientsCorrected", { 1.0 }) == 0.0);
  CHECK(ErrorOf(filter, "Divergence", { 0.0 }) < 3 * tolerance);
  CHECK(ErrorOf(filter, "Vorticity", { j[7] - j[5], j[2] - j[6], j[3] - j[1] }) < 2 * tolerance);
  CHECK(ErrorOf(filter, "Q-criterion", { -0.5 * trace2 }) < 4 * tolerance);
  CHECK(ErrorOf(filter, "Lambda2", { lambda2 }) < 4 * tolerance);
  CHECK(ErrorOf(filter, "StrainRate", strain) < tolerance);
}

/// Solids have zeros and do not count; arrays of the same names are replaced, others stay.
void CheckSolids()
{
  auto particles = MakeParticles(false);
  AddVelocity<vtkFloatArray>(particles, Shear);
  const auto isSolid = [&](vtkIdType i) { return particles->GetPoint(i)[2] < -0.5; };
  test::AddArray<vtkUnsignedCharArray>(
    particles, "Type", 1, [&](vtkIdType i, int) { return isSolid(i) ? 4.0 : 1.0; });
  test::AddArray<vtkFloatArray>(particles, "Lambda2", 1, [](vtkIdType, int) { return 17.0; });
  vtkDataArray* velocity = particles->GetPointData()->GetArray("Velocity");
  for (vtkIdType i = 0; i < particles->GetNumberOfPoints(); ++i)
  {
    if (isSolid(i))
    {
      velocity->SetComponent(i, 0, std::nan(""));
    }
  }
  auto filter = MakeFilter(particles, "Velocity");
  filter->SetFluidArrayName("Type");
  filter->SetFluidValue(1.0);
  filter->SetResultArrayName("Slope");
  filter->ComputeQCriterionOff();
  filter->Update();
  vtkDataArray *slope = ArrayOf(filter, "Slope"), *corrected = ArrayOf(filter, "SlopeCorrected");
  bool good = slope && corrected;
  for (vtkIdType i = 0; good && i < particles->GetNumberOfPoints(); ++i)
  {
    good = std::abs(slope->GetComponent(i, 1) - (isSolid(i) ? 0.0 : 2.0)) < 1e-5 &&
      corrected->GetComponent(i, 0) == (isSolid(i) ? 0.0 : 1.0);
  }
  CHECK(good);
  CHECK(std::abs(ArrayOf(filter, "Lambda2_SPH")->GetComponent(9000, 0)) < 1e-4);
  CHECK(!ArrayOf(filter, "Q-criterion") && !ArrayOf(filter, "StrainRate"));
  CHECK(ArrayOf(filter, "Type") == particles->GetPointData()->GetArray("Type"));
  CHECK(particles->GetPointData()->GetArray("Lambda2")->GetComponent(0, 0) == 17.0);
  int warnings = 0;
  test::CountEvents(filter, vtkCommand::WarningEvent, &warnings);
  filter->SetFluidValue(2.0);
  filter->Update();
  CHECK(warnings == 1 && filter->GetErrorMessage()[0] == '\0');
  CHECK(vtkPolyData::SafeDownCast(filter->GetOutput())->GetNumberOfPoints() == 9261);
}

/// Input that cannot be used gives a sentence and an empty output.
void CheckErrors()
{
  auto particles = MakeParticles(false);
  const auto fails = [&](vtkSPHDerivatives* filter, const char* part)
  {
    int errors = 0;
    test::CountEvents(filter, vtkCommand::ErrorEvent, &errors);
    filter->Update();
    CHECK(errors > 0);
    CHECK(vtkPolyData::SafeDownCast(filter->GetOutput())->GetNumberOfPoints() == 0);
    CHECK(std::strstr(filter->GetErrorMessage(), part));
  };
  fails(MakeFilter(particles, "Nonsense"), "'Nonsense'");
  auto none = vtkSmartPointer<vtkSPHDerivatives>::New();
  vtkNew<vtkPolyData> bare; // nothing varies
  bare->SetPoints(particles->GetPoints());
  bare->GetPointData()->AddArray(particles->GetPointData()->GetArray("SmoothingLength"));
  none->SetInputData(bare);
  fails(none, "No array was chosen");
  auto radius = vtkSmartPointer<vtkDataArray>(particles->GetPointData()->GetArray("Radius"));
  radius->SetComponent(5, 0, std::nan(""));
  fails(MakeFilter(particles, "Radius"), "particle 5");
  radius->SetComponent(5, 0, 0.0);
  particles->GetPointData()->RemoveArray("SmoothingLength");
  fails(MakeFilter(particles, "Radius"), "smoothing length");
}

/// Empty input, a run that is stopped, another class, the standard form.
void CheckOutputs()
{
  auto filter = MakeFilter(vtkSmartPointer<vtkPolyData>::New(), "Velocity");
  filter->Update();
  CHECK(filter->GetErrorMessage()[0] == '\0');
  auto particles = MakeParticles(false);
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(particles->GetPoints());
  grid->GetPointData()->ShallowCopy(particles->GetPointData());
  filter->SetInputDataObject(grid);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Radius");
  filter->CorrectGradientsOff();
  filter->Update();
  CHECK(vtkUnstructuredGrid::SafeDownCast(filter->GetOutput()));
  CHECK(ErrorOf(filter, "GradientsCorrected", { 0.0 }) == 0.0);
  CHECK(!ArrayOf(filter, "Vorticity") && !ArrayOf(filter, "Lambda2"));
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
  filter->Modified();
  filter->AddObserver(vtkCommand::ProgressEvent, stop);
  filter->Update();
  CHECK(filter->GetErrorMessage()[0] == '\0' &&
    vtkUnstructuredGrid::SafeDownCast(filter->GetOutput())->GetNumberOfPoints() == 0);
}
}

int TestDerivatives(int, char*[])
{
  for (const bool varying : { false, true })
  {
    for (const Matrix& j : { Rotation, Shear })
    {
      CheckLinear(varying, j, false);
      CheckLinear(varying, j, true);
    }
  }
  CheckSolids();
  CheckErrors();
  CheckOutputs();
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
