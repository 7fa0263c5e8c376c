// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Compares the library with the oracle on particles of real simulations. VTK only reads the files,
// because the core is called directly.
//
// --data DIR: where the shipped sets are. --large: the sets in the directory that the environment
// variable MCOR_DATA_DIR names, instead; exit status 77 (skipped) if it is not set.

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

// One surface of one file; zero and nullptr mean the library's defaults.
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

// Lends a VTK array to the core; float and double are used as they are.
mcor_array BorrowArray(vtkDataArray* array)
{
  mcor_array result = {};
  std::memset(&result, 0, sizeof(result));
  result.data = array->GetVoidPointer(0);
  result.type = array->GetDataType() == VTK_DOUBLE ? MCOR_FLOAT64 : MCOR_FLOAT32;
  result.components = array->GetNumberOfComponents();
  return result;
}

// Lends the array with this name to the core; returns false if the file lacks it.
bool FindArray(vtkPolyData* particles, const char* name, mcor_array& array)
{
  vtkDataArray* found = particles->GetPointData()->GetArray(name);
  if (!found || (found->GetDataType() != VTK_FLOAT && found->GetDataType() != VTK_DOUBLE))
  {
    return false;
  }
  array = BorrowArray(found);
  return true;
}

bool FillInput(
  const DataCase& one, vtkPolyData* particles, std::vector<uint8_t>& solid, mcor_input& input)
{
  std::memset(&input, 0, sizeof(input));
  input.count = particles->GetNumberOfPoints();
  input.positions = BorrowArray(particles->GetPoints()->GetData());
  FindArray(particles, "Volume", input.volume);
  FindArray(particles, "Mass", input.mass);
  FindArray(particles, "Density", input.density);
  input.scalar_component = MCOR_MAGNITUDE;
  if (!FindArray(particles, one.SmoothingLength, input.smoothing_length) ||
    (one.Scalar && !FindArray(particles, one.Scalar, input.scalar)))
  {
    return false;
  }
  input.scalar_component = input.scalar.components > 1 ? MCOR_MAGNITUDE : 0;
  if (vtkDataArray* type = particles->GetPointData()->GetArray("ParticleType"))
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

void NameCase(const DataCase& one, oracle_case& at)
{
  char eigenvalue[32] = "";
  if (one.Eigenvalue > 0.0)
  {
    std::snprintf(eigenvalue, sizeof(eigenvalue), "/eigenvalue%g", one.Eigenvalue);
  }
  char period[16] = "";
  if (one.PeriodAxis)
  {
    std::snprintf(period, sizeof(period), "/period-%c", one.PeriodAxis);
  }
  static const char* const fields[] = { "shepard", "sum", "weight" };
  std::snprintf(at.name, sizeof(at.name), "%s/%s%g/%s/%s/c%g/h%g%s%s%s%s%s", one.File,
    one.Scalar ? one.Scalar : "free", one.Iso, mcor_sph_kernel_name(one.Kernel), fields[one.Field],
    one.CubeSize > 0.0 ? one.CubeSize : at.options.cube_size_factor, at.options.h_scale,
    std::strcmp(one.SmoothingLength, Adaptive) == 0 ? "/adaptive" : "", one.Double ? "/double" : "",
    eigenvalue, one.Adaptive ? "/adaptive" : "", period);
}

void RunCase(oracle_suite& suite, const std::string& directory, const DataCase& one)
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
  at.no_table = one.Adaptive;
  if (one.PeriodAxis)
  {
    at.options.periodic[2 * (one.PeriodAxis - 'x') + 1] = one.Period;
  }
  NameCase(one, at);
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
    // Debian 12's ParaView 5.11 cannot read appended data; VTK itself, and inline data, are fine.
    std::printf("  FAILED: %s: the file cannot be read or lacks an array\n", at.name);
    ++suite.failures;
    return;
  }
  oracle_run_case(&suite, &at);
}

} // end anon namespace

int main(int argc, char** argv)
{
  std::string directory;
  bool large = false;
  std::vector<char*> others;
  for (int n = 0; n < argc; ++n)
  {
    if (std::strcmp(argv[n], "--large") == 0)
    {
      large = true;
    }
    else if (std::strcmp(argv[n], "--data") == 0 && n + 1 < argc)
    {
      directory = argv[++n];
    }
    else
    {
      others.push_back(argv[n]);
    }
  }
  if (large)
  {
    const char* from = std::getenv("MCOR_DATA_DIR");
    if (!from || !*from)
    {
      std::printf("skipped: MCOR_DATA_DIR is not set\n");
      return 77;
    }
    directory = from;
  }
  oracle_suite suite;
  if (!oracle_begin_suite(&suite, static_cast<int>(others.size()), others.data()))
  {
    return 1;
  }
  const DataCase* begin = large ? std::begin(LargeCases) : std::begin(ShippedCases);
  const DataCase* end = large ? std::end(LargeCases) : std::end(ShippedCases);
  std::for_each(begin, end, [&](const DataCase& one) { RunCase(suite, directory, one); });
  return oracle_end_suite(&suite);
}
