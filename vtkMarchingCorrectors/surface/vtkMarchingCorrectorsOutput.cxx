// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMarchingCorrectorsOutput.h"

#include "mcor_parts.h"
#include "vtkAlgorithm.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkSPHArrays.h"
#include "vtkSPHParticles.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <sstream>
#include <type_traits>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/// An array that varies on the surface by less than this share of its range at the particles is noise.
constexpr double LeastShare = 0.03;

// Adds a text named `arrayName`: the name of the quantity's array, or "" if no array was used. If all
// particles had one value, adds a number named `name`: this value.
void AddQuantity(
  vtkFieldData* data, const char* arrayName, const char* name, const mcor_array& array)
{
  const bool isArray = array.data && array.name && !vtkSPHParticles::IsMade(array.name);
  vtkSPHAddText(data, arrayName, isArray ? array.name : "");
  if (name && !array.data && mcor_is_given(&array))
  {
    vtkSPHAdd(data, name, array.constant);
  }
}
}

vtkMarchingCorrectorsOutput::vtkMarchingCorrectorsOutput(
  const vtkSPHParticles& input, const mcor_options& options, mcor_surface& surface)
  : Input(input)
  , Options(options)
  , Surface(surface)
{
}

std::vector<std::string> vtkMarchingCorrectorsOutput::ComputedArrays(const mcor_options& options)
{
  std::vector<std::string> names;
  if (options.widen > 1.0)
  {
    names.emplace_back("Widening");
  }
#define NAME(bit, member, components, name, flag)                                                  \
  if (options.outputs & bit)                                                                       \
  {                                                                                                \
    names.emplace_back(name);                                                                      \
  }
  vtkMarchingCorrectorsArrays(NAME)
#undef NAME
    return names;
}

bool vtkMarchingCorrectorsOutput::StoresFloats(int precision) const
{
  return precision == vtkAlgorithm::SINGLE_PRECISION ||
    (precision == vtkAlgorithm::DEFAULT_PRECISION &&
      this->Input.Core.positions.type == MCOR_FLOAT32);
}

double vtkMarchingCorrectorsOutput::FindLargestFloat(int precision) const
{
  const int64_t count = this->StoresFloats(precision) ? 3 * this->Surface.point_count : 0;
  return std::accumulate(this->Surface.points, this->Surface.points + count, 0.0,
    [](double largest, double x) { return std::max(largest, std::fabs(x)); });
}

void vtkMarchingCorrectorsOutput::BuildMesh(vtkPolyData* output, int precision, const Merge& merge)
{
  vtkNew<vtkPoints> points;
  points->SetData(vtkSPHAdoptReal(
    this->Surface.points, 3, this->Surface.point_count, this->StoresFloats(precision)));
  output->SetPoints(points);
  this->BuildCells(output);
  this->BuildInterpolatedArrays(output);
  vtkPointData* pointData = output->GetPointData();
  mcor_surface& s = this->Surface;
  const auto add = [&](const char* name, auto*& values, int components)
  {
    if (values)
    {
      vtkSPHAddArray(pointData, name, vtkSPHAdopt(values, components, s.point_count));
    }
  };
  // VTK would draw lines with active normals dark.
  const bool areActive = s.normals && (s.statistics.dimension != 2 || this->Options.filled);
#define ADD(bit, member, components, name, flag) add(name, s.member, components);
  vtkMarchingCorrectorsArrays(ADD)
#undef ADD
  if (this->Input.Core.widening.data && s.attributes)
  {
    add("Widening", s.attributes[this->Input.Interpolated.size()], 1);
  }
  if (areActive)
  {
    pointData->SetActiveNormals("Normals");
  }
  if (s.iso_value)
  {
    const auto scalar = this->Input.ArrayFor(MCOR_ROLE_SCALAR);
    const bool asFloat = scalar && scalar->GetDataType() == VTK_FLOAT;
    vtkSPHAddArray(pointData, this->Input.Found.iso_value_name,
      vtkSPHAdoptReal(s.iso_value, 1, s.point_count, asFloat));
  }
  this->AddIsoValues(output->GetFieldData());
  this->ChooseActive(output, merge);
}

// Ids are of VTK's own type, as vtkContourFilter makes them: with other types, some filters think a
// mesh is not a manifold. Band values of lines come first, because VTK numbers lines first.
void vtkMarchingCorrectorsOutput::BuildCells(vtkPolyData* output)
{
  mcor_surface& s = this->Surface;
  vtkNew<vtkIdTypeArray> corners;
  corners->SetNumberOfValues(3 * s.triangle_count);
  const std::int32_t* from = s.triangles;
  vtkIdType* to = corners->GetPointer(0);
  vtkSMPTools::For(0, corners->GetNumberOfValues(),
    [=](vtkIdType begin, vtkIdType end) { std::copy(from + begin, from + end, to + begin); });
  std::free(s.triangles);
  s.triangles = nullptr;
  vtkNew<vtkCellArray> triangles, lines;
  triangles->SetData(3, corners);
  output->SetPolys(triangles);
  if (s.line_offsets) // there are lines, in two dimensions
  {
    vtkNew<vtkIdTypeArray> points, offsets;
    points->SetNumberOfValues(s.line_offsets[s.line_count]);
    offsets->SetNumberOfValues(s.line_count + 1);
    std::copy_n(s.line_points, s.line_offsets[s.line_count], points->GetPointer(0));
    std::copy_n(s.line_offsets, s.line_count + 1, offsets->GetPointer(0));
    lines->SetData(offsets, points);
  }
  output->SetLines(s.line_offsets ? lines.Get() : nullptr);
  if (this->Options.filled) // even if nothing is drawn: all pieces of a file have this array
  {
    vtkNew<vtkDoubleArray> values;
    values->SetNumberOfValues(s.line_count + s.triangle_count);
    for (vtkIdType i = 0; i < s.line_count; ++i)
    {
      values->SetValue(i, s.iso_value[s.line_points[s.line_offsets[i]]]);
    }
    std::copy_n(s.band_value, s.triangle_count, values->GetPointer(0) + s.line_count);
    vtkSPHAddArray(output->GetCellData(), "BandValue", values);
  }
}

void vtkMarchingCorrectorsOutput::BuildInterpolatedArrays(vtkPolyData* output)
{
  const vtkIdType count = this->Surface.point_count;
  const auto add = [output](const vtkSPHAttribute& from, vtkAbstractArray* to)
  {
    to->CopyComponentNames(from.Array);
    vtkSPHAddArray(output->GetPointData(), from.Name.c_str(), to);
  };
  for (size_t i = 0; this->Surface.attributes && i < this->Input.Interpolated.size(); ++i)
  {
    const vtkSPHAttribute& from = this->Input.Interpolated[i];
    if (this->Surface.attribute_not_finite[i] < 0)
    {
      add(from,
        vtkSPHAdoptReal(this->Surface.attributes[i], from.Components, count,
          from.Array->GetDataType() == VTK_FLOAT));
    }
  }
  if (!this->Surface.nearest_particle)
  {
    return;
  }
  vtkNew<vtkIdList> nearest;
  nearest->SetNumberOfIds(count);
  std::copy(
    this->Surface.nearest_particle, this->Surface.nearest_particle + count, nearest->GetPointer(0));
  for (const vtkSPHAttribute& from : this->Input.FromNearest)
  {
    const vtkSmartPointer<vtkAbstractArray> to = vtkSPHMakeLike(from.Array, count);
    from.Array->GetTuples(nearest, to);
    add(from, to);
  }
}

// Chooses the active scalars among the particles' attributes that vary on the surface. If there are
// several iso values, the array of iso values may be chosen, too. With one iso value, the contoured
// scalar is not chosen: it varies by rounding alone. For vectors, the magnitudes must vary.
void vtkMarchingCorrectorsOutput::ChooseActive(vtkPolyData* output, const Merge& merge) const
{
  vtkPointData* data = output->GetPointData();
  const std::vector<vtkSPHAttribute>& attributes = this->Input.Interpolated;
  std::vector<double> ranges; // range of each array on the surface, and among the particles
  for (const vtkSPHAttribute& attribute : attributes)
  {
    for (vtkDataArray* array : { data->GetArray(attribute.Name.c_str()),
           vtkArrayDownCast<vtkDataArray>(attribute.Array.Get()) })
    {
      double range[2] = { VTK_DOUBLE_MAX, VTK_DOUBLE_MIN };
      if (array && array->GetNumberOfTuples() > 0)
      {
        array->GetRange(range, attribute.Components > 1 ? -1 : 0);
      }
      ranges.insert(ranges.end(), range, range + 2);
    }
  }
  merge(ranges.data(), static_cast<int>(ranges.size() / 2));
  const mcor_input& core = this->Input.Core;
  const std::string contoured = this->Input.NameFor(MCOR_ROLE_SCALAR);
  const bool isOne = !contoured.empty() && !core.scalar_dot.data &&
    this->Options.iso_count == 1 && !this->Options.filled &&
    (core.scalar.components == 1 || core.scalar_component == MCOR_MAGNITUDE);
  std::string best;
  int bestRank = -1;
  const auto consider = [&](const std::string& name, int components, bool varies)
  {
    const int rank = mcor_view_priority(name.c_str(), components, 1, varies);
    if (rank >= 0 && (bestRank < 0 || rank < bestRank))
    {
      best = name;
      bestRank = rank;
    }
  };
  for (size_t i = 0; i < attributes.size(); ++i)
  {
    const double* r = ranges.data() + 4 * i;
    const bool isContoured = isOne && attributes[i].Name == contoured;
    consider(attributes[i].Name, attributes[i].Components,
      r[1] - r[0] > LeastShare * (r[3] - r[2]) && r[1] > r[0] && !isContoured);
  }
  consider(this->Input.Found.iso_value_name, 1, this->Options.iso_count > 1);
  if (data->HasArray(best.c_str()))
  {
    data->SetActiveScalars(best.c_str());
  }
}

void vtkMarchingCorrectorsOutput::AddIsoValues(vtkFieldData* fieldData) const
{
  auto isoValues = vtkSmartPointer<vtkDoubleArray>::New();
  for (int i = 0; i < this->Options.iso_count; ++i)
  {
    isoValues->InsertNextValue(this->Options.iso_values[i]);
  }
  if (this->Options.outputs & MCOR_OUT_ISO_VALUE)
  {
    isoValues->SetComponentName(0, this->Input.Found.iso_value_name);
  }
  vtkSPHAddArray(fieldData, "IsoValues", isoValues);
}

void vtkMarchingCorrectorsOutput::AddRun(vtkFieldData* run) const
{
  const mcor_statistics& s = this->Surface.statistics;
  vtkSPHAddText(run, "Device", s.device);
  vtkSPHAddText(run, "Platform", s.platform);
  const bool always = true, is_run = false, is_plane = s.dimension == 2;
  const bool has_scalar = this->Options.field != MCOR_WEIGHT_SUM,
             has_caps = this->Options.capping != 0;
  const bool is_widened = s.widening_max > 0.0;
  const bool has_levels = this->Options.level_limit > 0, has_volume = !is_plane && s.is_closed;
  const bool has_area = !is_plane || s.is_closed || this->Options.filled;
#define STATISTIC(how, when, member, name)                                                         \
  if ((when) && *(name))                                                                           \
  {                                                                                                \
    vtkSPHAdd(run, name, s.member);                                                                \
  }
#include "mcor_statistics.def"
  vtkSPHAdd(run, "SmoothingLengthRange", { s.smoothing_length_min, s.smoothing_length_max });
  if (has_scalar)
  {
    vtkSPHAdd(run, "ScalarRange", { s.scalar_min, s.scalar_max });
  }
  vtkSPHAdd(run, "Points", this->Surface.point_count);
  vtkSPHAdd(run, "Triangles", this->Surface.triangle_count);
  if (is_plane)
  {
    vtkSPHAdd(run, "Lines", this->Surface.line_count);
  }
  this->AddIsoValues(run);
  this->AddParameters(run);
  vtkSPHAddRunStatistics(run, s);
}

namespace
{
/// Adds a parameter: the number `value` or, if `isWord`, the word with the index `value` in `words`.
template <typename T>
void AddOption(vtkFieldData* data, const std::string& name, bool isWord, const char* words, T value)
{
  using Number = typename std::conditional<std::is_enum<T>::value, int, T>::type;
  if (name.empty() || name == "CubeSize" || name == "Dimension" || name == "Kernel" ||
    name == "WallShare")
  {
    return;
  }
  if (!isWord)
  {
    vtkSPHAdd(data, name.c_str(), static_cast<Number>(value));
    return;
  }
  std::istringstream stream(words);
  std::string word;
  for (int i = 0; i <= static_cast<int>(value); ++i)
  {
    std::getline(stream, word, '|');
  }
  vtkSPHAddText(data, name.c_str(), word);
}
}

void vtkMarchingCorrectorsOutput::AddParameters(vtkFieldData* fieldData) const
{
  const mcor_options& o = this->Options;
  const char* const fields[] = { "shepard", "sum", "weight_sum" };
  vtkSPHAddText(fieldData, "Field", fields[o.field]);
  vtkSPHAddText(fieldData, "Scalar", this->Input.Found.scalar_name);
  AddQuantity(fieldData, "SmoothingLengthArray", nullptr, this->Input.Core.smoothing_length);
  vtkSPHAdd(fieldData, "SmoothingLengthIsSupportRadius",
    this->Input.Core.smoothing_length_is_support_radius);
  vtkSPHAdd(fieldData, "EstimateSmoothingLength", this->Input.Core.estimate_smoothing_length);
  AddQuantity(fieldData, "VolumeArray", "ParticleVolume", this->Input.Core.volume);
  AddQuantity(fieldData, "MassArray", "Mass", this->Input.Core.mass);
  AddQuantity(fieldData, "DensityArray", "Density", this->Input.Core.density);
  const char* const fluid = this->Input.Found.views[MCOR_ROLE_FLUID].name;
  vtkSPHAddText(fieldData, "FluidArray", fluid ? fluid : "");
  if (fluid)
  {
    vtkSPHAdd(fieldData, "FluidValue", this->Input.Found.fluid_value);
    vtkSPHAdd(fieldData, "IgnoreSolids", this->Input.Core.ignore_solids);
    vtkSPHAdd(fieldData, "WallShare", this->Surface.statistics.wall_share);
  }
  // AddOption() skips options whose values in use are statistics, or are added below.
#define WORD true
#define FLAG false
#define AT_LEAST_0 false
#define ABOVE_0 false
#define SHARE false
#define FROM(least, greatest) false
#define OPTION(member, usual, legal, words, scope, property)                                       \
  AddOption(fieldData, property, legal, words, o.member);
#include "mcor_options.def"
  vtkSPHAddText(fieldData, "Kernel", mcor_sph_kernel_name(o.sph_kernel));
  vtkSPHAddText(fieldData, "CubeSizeMode", o.level_limit > 0 ? "adaptive" : "uniform");
  const double* p = o.periodic;
  const bool isPeriodic = p[0] < p[1] || p[2] < p[3] || p[4] < p[5];
  if (isPeriodic)
  {
    vtkSPHAdd(fieldData, "PeriodicBounds", std::vector<double>(p, p + 6));
  }
  if (isPeriodic || o.capping != MCOR_CAP_NONE)
  {
    vtkSPHAdd(fieldData, "Capping", o.capping != MCOR_CAP_NONE ? 1 : 0);
  }
  if (mcor_has_box(&o))
  {
    vtkSPHAdd(fieldData, "Box", std::vector<double>(o.box, o.box + 6));
  }
}
VTK_ABI_NAMESPACE_END
