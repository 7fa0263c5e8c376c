// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Compares the library with the oracle on particles of real simulations. VTK only reads the files,
// because the core is called directly.
//
// TestOracleData DIR [--case NAME]: with the shipped sets, which lie in DIR. TestOracleData --large: with the sets in the
// directory that the environment variable MCOR_DATA_DIR names; exit status 77 (skipped) if it is not set.

#include "oracle_case.h"

#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace
{

// One surface of one file. Zero and nullptr stand for the library's defaults.
struct DataCase
{
  const char* File;
  const char* Scalar; // nullptr: the free surface
  double Iso;
  mcor_field Field;
  mcor_sph_kernel Kernel;
  const char* SmoothingLength;
  double CubeFactor;
  double CubeSize;
  double HScale;
  bool Double;
  double Eigenvalue = 0.0; // above 0: trimmed where the boundary eigenvalue is lower
  bool Adaptive = false;   // adaptive cubes
  char PeriodAxis = 0;     // 'x', 'y' or 'z'; from 0 on, through the middle of the data
  double Period = 0.0;
};

constexpr mcor_sph_kernel Cubic = MCOR_CUBIC_SPLINE;
constexpr const char* H = "SmoothingLength";
constexpr const char* Adaptive = "SmoothingLengthAdaptive";

const DataCase ShippedCases[] = {
  { "double_dam_break_small", "Speed", 1.5, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false },
  { "double_dam_break_small", "Speed", 2.0, MCOR_SHEPARD, Cubic, H, 0, 0, 0, true },
  { "double_dam_break_small", "Speed", 2.0, MCOR_SUM, Cubic, H, 0, 0, 0, false },
  { "double_dam_break_small", "Velocity", 2.0, MCOR_SHEPARD, MCOR_WENDLAND_C2, H, 1, 0, 0, false },
  { "double_dam_break_small", nullptr, 0.5, MCOR_WEIGHT_SUM, Cubic, H, 0, 0, 0, false },
  { "double_dam_break_small", nullptr, 0.5, MCOR_WEIGHT_SUM, Cubic, H, 0, 0, 0.75, false },
  { "bunny_splash_small", "Speed", 2.0, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false },
  { "bunny_splash_small", "Speed", 3.0, MCOR_SHEPARD, MCOR_QUADRATIC, H, 0, 0, 0, false },
  { "bunny_splash_small", nullptr, 0.5, MCOR_WEIGHT_SUM, Cubic, H, 0, 0, 0, false },
  { "bunny_splash_small", nullptr, 0.5, MCOR_WEIGHT_SUM, Cubic, H, 1, 0, 0, true },
  { "dam_break_45k", "Velocity", 1.0, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false },
  { "dam_break_45k", "Velocity", 1.0, MCOR_SUM, Cubic, H, 0, 0, 0, false },
  { "dam_break_45k", "Pressure", 2000.0, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false },
  { "dam_break_45k", "Pressure", 2000.0, MCOR_SHEPARD, Cubic, Adaptive, 1, 0, 0, false },
  { "dam_break_45k", "Velocity", 1.0, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false, 0.3 },
  { "dam_break_45k", "Pressure", 2000.0, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false, 0.3 },
  { "dam_break_45k", "Pressure", 2000.0, MCOR_SHEPARD, Cubic, H, 0, 0, 0, true, 0.75 },
  { "dam_break_45k", "Lambda2", -150.0, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false },
  { "dam_break_45k", nullptr, 0.5, MCOR_WEIGHT_SUM, Cubic, H, 1, 0, 0, false },
};

const DataCase LargeCases[] = {
  { "dam_break_45k", "Pressure", 2000.0, MCOR_SUM, Cubic, H, 0, 0, 0, false },
  { "dam_break_45k", "Velocity", 1.0, MCOR_SHEPARD, Cubic, H, 0, 0, 0, true },
  { "dam_break_45k", "VorticityMagnitude", 5.0, MCOR_SHEPARD, Cubic, Adaptive, 0, 0, 0, false },
  { "sedov_blast_148k", "Density", 0.3, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false },
  { "sedov_blast_148k", "Density", 1.5, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false },
  { "sedov_blast_148k", "Density", 1.5, MCOR_SUM, Cubic, H, 0, 0, 0, false },
  { "evrard_collapse_74k", "Density", 1.0, MCOR_SHEPARD, Cubic, H, 0, 0.01, 0, false },
  { "evrard_collapse_74k", "Density", 50.0, MCOR_SHEPARD, Cubic, H, 0, 0.007, 0, false },
  { "evrard_collapse_74k", "LogDensity", 0.5, MCOR_SUM, Cubic, H, 0, 0.01, 0, false },
  { "evrard_collapse_74k", nullptr, 0.5, MCOR_WEIGHT_SUM, Cubic, H, 0, 0, 0, false, 0, true },
  { "evrard_collapse_74k", "Density", 1.0, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false, 0, true },
  { "sedov_blast_148k", "Density", 1.5, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false, 0, true },
  { "sedov_blast_148k", "Density", 1.5, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false, 0, false, 'x',
    1.0 },
  { "sedov_blast_148k", "Density", 0.3, MCOR_SHEPARD, Cubic, H, 0, 0, 0, true, 0, false, 'y',
    0.9923207 },
  { "sedov_blast_148k", "Pressure", 1.0, MCOR_SUM, MCOR_WENDLAND_C2, H, 1, 0, 0, false, 0, false,
    'z', 1.0036104 },
  { "sedov_blast_148k", nullptr, 0.5, MCOR_WEIGHT_SUM, Cubic, H, 1, 0, 0, false, 0, false, 'x',
    1.0 },
  { "vortex_rings_200k", "VorticityMagnitude", 5.0, MCOR_SHEPARD, MCOR_M_PRIME_4, H, 0, 0, 0,
    false },
  { "vortex_rings_200k", "VorticityMagnitude", 20.0, MCOR_SUM, MCOR_M_PRIME_4, H, 0, 0, 0, false },
  { "vortex_rings_200k", "Vorticity", 20.0, MCOR_SHEPARD, MCOR_M_PRIME_4, H, 1, 0, 0, true },
  { "dam_break_467k", "Pressure", 2000.0, MCOR_SHEPARD, Cubic, H, 0, 0, 0, false },
  { "dam_break_467k", "VorticityMagnitude", 10.0, MCOR_SHEPARD, Cubic, H, 1, 0, 0, false },
  { "dam_break_467k", nullptr, 0.5, MCOR_WEIGHT_SUM, Cubic, H, 0, 0, 0, false },
};

// Lends the array to the core; returns false if it is missing or holds no floating-point numbers.
bool Borrow(vtkDataArray* array, mcor_array& result)
{
  if (!array || (array->GetDataType() != VTK_FLOAT && array->GetDataType() != VTK_DOUBLE))
  {
    return false;
  }
  result.data = array->GetVoidPointer(0);
  result.type = array->GetDataType() == VTK_DOUBLE ? MCOR_FLOAT64 : MCOR_FLOAT32;
  result.components = array->GetNumberOfComponents();
  return true;
}

bool FillInput(
  const DataCase& one, vtkPolyData* particles, std::vector<uint8_t>& solid, mcor_input& input)
{
  vtkPointData* arrays = particles->GetPointData();
  input.count = particles->GetNumberOfPoints();
  Borrow(particles->GetPoints()->GetData(), input.positions);
  Borrow(arrays->GetArray("Volume"), input.volume);
  Borrow(arrays->GetArray("Mass"), input.mass);
  Borrow(arrays->GetArray("Density"), input.density);
  if (!Borrow(arrays->GetArray(one.SmoothingLength), input.smoothing_length) ||
    (one.Scalar && !Borrow(arrays->GetArray(one.Scalar), input.scalar)))
  {
    return false;
  }
  input.scalar_component = input.scalar.components > 1 ? MCOR_MAGNITUDE : 0;
  if (vtkDataArray* type = arrays->GetArray("ParticleType"))
  {
    solid.resize(static_cast<size_t>(input.count));
    for (int64_t j = 0; j < input.count; ++j)
    {
      solid[static_cast<size_t>(j)] = type->GetComponent(j, 0) != 0.0;
    }
    input.solid = solid.data();
  }
  return true;
}

void RunCase(oracle_suite& suite, const std::string& directory, const DataCase& one, int number)
{
  oracle_case at;
  std::memset(&at, 0, sizeof(at));
  at.options = oracle_case_options(&one.Iso);
  at.options.field = one.Field;
  at.options.sph_kernel = one.Kernel;
  at.options.cube_size = one.CubeSize;
  at.options.cube_size_factor = one.CubeFactor > 0.0 ? one.CubeFactor : 0.5;
  at.options.h_scale = one.HScale > 0.0 ? one.HScale : 1.0;
  at.options.precision = one.Double ? MCOR_FLOAT64 : MCOR_FLOAT32;
  if (one.Eigenvalue > 0.0)
  {
    at.options.boundary_detection = MCOR_BOUNDARY_EIGENVALUE;
    at.options.vertex_threshold = one.Eigenvalue;
    at.options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE;
  }
  at.options.level_limit = one.Adaptive ? MCOR_CUBE_LEVELS - 1 : 0;
  at.skip_pairs = one.Field == MCOR_WEIGHT_SUM || one.Eigenvalue > 0.0;
  if (one.PeriodAxis)
  {
    at.options.periodic[2 * (one.PeriodAxis - 'x') + 1] = one.Period;
  }
  std::snprintf(
    at.name, sizeof(at.name), "%s/%d/%s", one.File, number, one.Scalar ? one.Scalar : "free");
  if (!oracle_wants_case(&suite, at.name))
  {
    return;
  }
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((directory + "/" + one.File + ".vtp").c_str());
  reader->Update();
  std::vector<uint8_t> solid;
  if (reader->GetOutput()->GetNumberOfPoints() == 0 ||
    !FillInput(one, reader->GetOutput(), solid, at.input))
  {
    // A possible cause: Debian 12's ParaView 5.11 cannot read appended data. VTK can, and every
    // reader can read inline data.
    std::printf("  FAILED: %s: the file cannot be read or lacks an array\n", at.name);
    ++suite.failures;
    return;
  }
  oracle_run_case(&suite, &at);
}

} // end anon namespace

int main(int argc, char** argv)
{
  const bool large = argc > 1 && std::strcmp(argv[1], "--large") == 0;
  const char* directory = large ? std::getenv("MCOR_DATA_DIR") : argc > 1 ? argv[1] : ".";
  if (!directory || !*directory)
  {
    std::printf("skipped: MCOR_DATA_DIR is not set\n");
    return 77;
  }
  oracle_suite suite;
  if (!oracle_begin_suite(&suite, std::max(argc - 1, 1), argv + (argc > 1)))
  {
    return 1;
  }
  const DataCase* begin = large ? std::begin(LargeCases) : std::begin(ShippedCases);
  const DataCase* end = large ? std::end(LargeCases) : std::end(ShippedCases);
  for (const DataCase* one = begin; one != end; ++one)
  {
    RunCase(suite, directory, *one, static_cast<int>(one - begin));
  }
  return oracle_end_suite(&suite);
}
