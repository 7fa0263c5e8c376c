// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMarchingCorrectorsOutput.h"

#include "vtkAlgorithm.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkMarchingCorrectorsInput.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <utility>

namespace
{
/** Hands a malloc'ed buffer over to a VTK array. */
template <typename ArrayT, typename ValueT>
vtkSmartPointer<ArrayT> Adopt(ValueT*& values, int components, vtkIdType tuples)
{
  auto array = vtkSmartPointer<ArrayT>::New();
  array->SetNumberOfComponents(components);
  if (values && tuples > 0)
  {
    array->SetArray(values, tuples * components, 0, ArrayT::VTK_DATA_ARRAY_FREE);
    values = nullptr;
  }
  return array;
}

/** Rounds in place: the surface is the largest thing at this time. */
vtkSmartPointer<vtkDataArray> RoundToFloat(double*& values, int components, vtkIdType tuples)
{
  const vtkIdType count = values ? tuples * components : 0;
  char* to = reinterpret_cast<char*>(values);
  for (vtkIdType first = 0; first < count;)
  {
    std::array<float, 1024> rounded;
    const vtkIdType n = std::min<vtkIdType>(count - first, rounded.size());
    std::transform(values + first, values + first + n, rounded.begin(),
      [](double value) { return static_cast<float>(value); });
    std::memcpy(to + first * sizeof(float), rounded.data(), n * sizeof(float));
    first += n;
  }
  void* kept = count > 0 ? std::realloc(values, count * sizeof(float)) : nullptr;
  float* floats = static_cast<float*>(kept ? kept : values);
  auto array = Adopt<vtkFloatArray>(floats, components, count > 0 ? tuples : 0);
  values = count > 0 ? nullptr : values;
  return array;
}

/** double values as an array of either precision. */
vtkSmartPointer<vtkDataArray> AdoptReal(
  double*& values, int components, vtkIdType tuples, bool asFloat)
{
  if (asFloat)
  {
    return RoundToFloat(values, components, tuples);
  }
  return Adopt<vtkDoubleArray>(values, components, tuples);
}

void Add(vtkFieldData* data, const char* name, vtkSmartPointer<vtkAbstractArray> array)
{
  array->SetName(name);
  data->AddArray(array);
}

void AddReal(vtkFieldData* data, const char* name, std::initializer_list<double> values)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetNumberOfComponents(static_cast<int>(values.size()));
  array->SetNumberOfTuples(1);
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  Add(data, name, array);
}

void AddCount(vtkFieldData* data, const char* name, std::initializer_list<std::int64_t> values)
{
  auto array = vtkSmartPointer<vtkTypeInt64Array>::New();
  array->SetNumberOfComponents(static_cast<int>(values.size()));
  array->SetNumberOfTuples(1);
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  Add(data, name, array);
}

void AddText(vtkFieldData* data, const char* name, const std::string& text)
{
  auto array = vtkSmartPointer<vtkStringArray>::New();
  array->InsertNextValue(text);
  Add(data, name, array);
}

// As it was when the run began.
void AddArrayName(vtkFieldData* data, const char* name, const mcor_array& array)
{
  AddText(data, name, array.name ? array.name : "");
}

// One component per phase, building the program and the total; 0 so far.
void AddSeconds(vtkFieldData* run)
{
  auto seconds = vtkSmartPointer<vtkDoubleArray>::New();
  seconds->SetNumberOfComponents(MCOR_PHASE_COUNT + 2);
  seconds->SetNumberOfTuples(1);
  seconds->Fill(0.0);
  for (int phase = 0; phase < MCOR_PHASE_COUNT; ++phase)
  {
    seconds->SetComponentName(phase, mcor_phase_name(static_cast<mcor_phase>(phase)));
  }
  seconds->SetComponentName(MCOR_PHASE_COUNT, "program build");
  seconds->SetComponentName(MCOR_PHASE_COUNT + 1, "total");
  Add(run, "Seconds", seconds);
}

// The array's name, or the value for all particles where it was used.
void AddQuantity(vtkFieldData* data, const std::string& name, int given, const mcor_array& array)
{
  AddArrayName(data, (name + "Array").c_str(), array);
  if (given && !array.data)
  {
    AddReal(data, name.c_str(), { array.constant });
  }
}
}

//------------------------------------------------------------------------------
vtkMarchingCorrectorsOutput::vtkMarchingCorrectorsOutput(
  const vtkMarchingCorrectorsInput& input, const mcor_options& options, mcor_surface& surface)
  : Input(input)
  , Options(options)
  , Surface(surface)
{
}

//------------------------------------------------------------------------------
std::vector<std::string> vtkMarchingCorrectorsOutput::ComputedArrays(const mcor_options& options)
{
  const std::pair<int, const char*> arrays[] = { { options.normals, "Normals" },
    { options.gradients, "Gradients" }, { options.weight_sum, "WeightSum" },
    { options.boundary_eigenvalue, "BoundaryEigenvalue" },
    { options.correction_length, "CorrectionLength" }, { options.residual, "Residual" },
    { options.boundary_flag, "BoundaryFlag" } };
  std::vector<std::string> names;
  for (const auto& array : arrays)
  {
    if (array.first)
    {
      names.emplace_back(array.second);
    }
  }
  return names;
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectorsOutput::BuildMesh(vtkPolyData* output, int precision)
{
  const bool asFloat = precision == vtkAlgorithm::SINGLE_PRECISION ||
    (precision == vtkAlgorithm::DEFAULT_PRECISION &&
      this->Input.Core.positions.type == MCOR_FLOAT32);
  vtkNew<vtkPoints> points;
  points->SetData(AdoptReal(this->Surface.points, 3, this->Surface.point_count, asFloat));
  output->SetPoints(points);
  this->BuildTriangles(output);
  this->BuildInterpolatedArrays(output);
  this->BuildComputedArrays(output);
  this->BuildIsoValue(output);
}

//------------------------------------------------------------------------------
// With ids of VTK's own type, as from vtkContourFilter: some filters take a mesh with others for
// non-manifold.
void vtkMarchingCorrectorsOutput::BuildTriangles(vtkPolyData* output)
{
  const vtkIdType count = this->Surface.triangle_count;
  vtkNew<vtkIdTypeArray> corners, offsets;
  corners->SetNumberOfValues(3 * count);
  offsets->SetNumberOfValues(count + 1);
  vtkIdType *corner = corners->GetPointer(0), *offset = offsets->GetPointer(0);
  const std::int32_t* from = this->Surface.triangles;
  vtkSMPTools::For(0, count,
    [=](vtkIdType begin, vtkIdType end)
    {
      std::copy(from + 3 * begin, from + 3 * end, corner + 3 * begin);
      for (vtkIdType i = begin; i < end; ++i)
      {
        offset[i] = 3 * i;
      }
    });
  offset[count] = 3 * count;
  std::free(this->Surface.triangles);
  this->Surface.triangles = nullptr;
  vtkNew<vtkCellArray> triangles;
  triangles->SetData(offsets, corners);
  output->SetPolys(triangles);
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectorsOutput::BuildInterpolatedArrays(vtkPolyData* output)
{
  const vtkIdType count = this->Surface.point_count;
  const auto add = [output](const vtkMarchingCorrectorsAttribute& from, vtkAbstractArray* to)
  {
    to->CopyComponentNames(from.Array);
    Add(output->GetPointData(), from.Name.c_str(), to);
  };
  for (size_t i = 0; this->Surface.attributes && i < this->Input.Interpolated.size(); ++i)
  {
    const vtkMarchingCorrectorsAttribute& from = this->Input.Interpolated[i];
    if (this->Surface.attribute_not_finite[i] < 0)
    {
      add(from,
        AdoptReal(this->Surface.attributes[i], from.Components, count,
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
  for (const vtkMarchingCorrectorsAttribute& from : this->Input.FromNearest)
  {
    auto to = vtkSmartPointer<vtkAbstractArray>::Take(
      vtkAbstractArray::CreateArray(from.Array->GetDataType()));
    to->SetNumberOfComponents(from.Components);
    to->SetNumberOfTuples(count);
    from.Array->GetTuples(nearest, to);
    add(from, to);
  }
}

//------------------------------------------------------------------------------
std::vector<std::string> vtkMarchingCorrectorsOutput::ListLeftOut() const
{
  std::vector<std::string> sentences;
  for (size_t i = 0; this->Surface.attribute_not_finite && i < this->Input.Interpolated.size(); ++i)
  {
    if (this->Surface.attribute_not_finite[i] >= 0)
    {
      sentences.push_back("The point array '" + this->Input.Interpolated[i].Name +
        "' is NaN or infinite at particle " +
        std::to_string(this->Surface.attribute_not_finite[i]) +
        " and was left out of the surface. Correct its values, or exclude it.");
    }
  }
  return sentences;
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectorsOutput::BuildComputedArrays(vtkPolyData* output)
{
  vtkPointData* pointData = output->GetPointData();
  mcor_surface& s = this->Surface;
  const vtkIdType count = s.point_count;
  if (s.normals)
  {
    Add(pointData, "Normals", Adopt<vtkFloatArray>(s.normals, 3, count));
    pointData->SetActiveNormals("Normals");
  }
  if (s.gradients)
  {
    Add(pointData, "Gradients", Adopt<vtkDoubleArray>(s.gradients, 3, count));
  }
  if (s.weight_sum)
  {
    Add(pointData, "WeightSum", Adopt<vtkFloatArray>(s.weight_sum, 1, count));
  }
  if (s.boundary_eigenvalue)
  {
    Add(pointData, "BoundaryEigenvalue", Adopt<vtkFloatArray>(s.boundary_eigenvalue, 1, count));
  }
  if (s.correction_length)
  {
    Add(pointData, "CorrectionLength", Adopt<vtkFloatArray>(s.correction_length, 1, count));
  }
  if (s.residual)
  {
    Add(pointData, "Residual", Adopt<vtkFloatArray>(s.residual, 1, count));
  }
  if (s.boundary_flag)
  {
    Add(pointData, "BoundaryFlag", Adopt<vtkUnsignedCharArray>(s.boundary_flag, 1, count));
  }
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectorsOutput::BuildIsoValue(vtkPolyData* output)
{
  if (!this->Surface.iso_value)
  {
    return;
  }
  const char* name = this->Input.IsoValueName.c_str();
  const bool asFloat = this->Input.Scalar && this->Input.Scalar->GetDataType() == VTK_FLOAT;
  Add(output->GetPointData(), name,
    AdoptReal(this->Surface.iso_value, 1, this->Surface.point_count, asFloat));
  output->GetPointData()->SetActiveScalars(name);
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectorsOutput::BuildFieldData(vtkFieldData* fieldData) const
{
  AddText(fieldData, "Device", this->Surface.statistics.device);
  AddText(fieldData, "Platform", this->Surface.statistics.platform);
  this->AddStatistics(fieldData);
  this->AddParameters(fieldData);
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectorsOutput::AddRunStatistics(vtkFieldData* run) const
{
  const mcor_statistics& s = this->Surface.statistics;
  if (run->GetNumberOfArrays() == 0)
  {
    AddSeconds(run);
  }
  vtkDataArray* seconds = run->GetArray("Seconds");
  const auto addSeconds = [seconds](int component, double value)
  { seconds->SetComponent(0, component, seconds->GetComponent(0, component) + value); };
  double total = s.build_seconds;
  for (int phase = 0; phase < MCOR_PHASE_COUNT; ++phase)
  {
    addSeconds(phase, s.seconds[phase]);
    total += s.seconds[phase];
  }
  addSeconds(MCOR_PHASE_COUNT, s.build_seconds);
  addSeconds(MCOR_PHASE_COUNT + 1, total);
  const auto count = [run](const char* name)
  {
    vtkDataArray* array = run->GetArray(name);
    return array ? static_cast<std::int64_t>(array->GetComponent(0, 0)) : 0;
  };
  AddCount(run, "Bricks", { count("Bricks") + s.bricks });
  AddCount(run, "NodesEvaluated", { count("NodesEvaluated") + s.nodes_evaluated });
  AddCount(run, "MarchRounds", { count("MarchRounds") + s.march_rounds });
  AddCount(run, "DeviceBytesPeak", { std::max(count("DeviceBytesPeak"), s.device_bytes_peak) });
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectorsOutput::AddStatistics(vtkFieldData* fieldData) const
{
  const mcor_statistics& s = this->Surface.statistics;
  AddCount(fieldData, "FluidParticles", { s.fluid_particles });
  AddCount(fieldData, "SolidParticles", { s.solid_particles });
  AddReal(fieldData, "SmoothingLengthRange", { s.smoothing_length_min, s.smoothing_length_max });
  if (this->Options.field != MCOR_WEIGHT_SUM)
  {
    AddReal(fieldData, "ScalarRange", { s.scalar_min, s.scalar_max });
  }
  AddReal(fieldData, "CubeSize", { s.cube_size });
  AddCount(
    fieldData, "LatticeOrigin", { s.lattice_origin[0], s.lattice_origin[1], s.lattice_origin[2] });
  AddCount(
    fieldData, "LatticeCells", { s.lattice_cells[0], s.lattice_cells[1], s.lattice_cells[2] });
  AddCount(fieldData, "VirtualCells", { s.virtual_cells });
  AddCount(fieldData, "SeedCells", { s.seed_cells });
  AddCount(fieldData, "SeedCellsNotIntersected", { s.seed_cells_not_intersected });
  AddCount(fieldData, "CellsUsed", { s.cells_used });
  AddCount(fieldData, "AmbiguousFaces", { s.ambiguous_faces });
  AddCount(fieldData, "JoinedFaces", { s.joined_faces });
  AddCount(fieldData, "AmbiguousCells", { s.ambiguous_cells });
  AddCount(fieldData, "Tunnels", { s.tunnels });
  AddCount(fieldData, "Points", { this->Surface.point_count });
  AddCount(fieldData, "Triangles", { this->Surface.triangle_count });
  AddCount(fieldData, "TrianglesBeforeTrimming", { s.triangles_before_trimming });
  AddReal(fieldData, "CorrectionMean", { s.correction_mean });
  AddReal(fieldData, "CorrectionMax", { s.correction_max });
  AddReal(fieldData, "CorrectionStandardDeviation", { s.correction_deviation });
  AddCount(fieldData, "VerticesCorrected", { s.vertices_corrected });
  AddCount(fieldData, "VerticesAboveTolerance", { s.vertices_above_tolerance });
  AddReal(fieldData, "IterationsMean", { s.iterations_mean });
  AddCount(fieldData, "IterationsMax", { s.iterations_max });
  AddCount(fieldData, "NewtonEvaluations", { s.newton_evaluations });
  AddReal(fieldData, "ResidualMax", { s.residual_max });
  AddCount(fieldData, "TrimVertices", { s.trim_vertices });
  AddCount(fieldData, "TrimVerticesLinear", { s.trim_vertices_linear });
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectorsOutput::AddParameters(vtkFieldData* fieldData) const
{
  const mcor_options& o = this->Options;
  auto isoValues = vtkSmartPointer<vtkDoubleArray>::New();
  for (int i = 0; i < o.iso_count; ++i)
  {
    isoValues->InsertNextValue(o.iso_values[i]);
  }
  Add(fieldData, "IsoValues", isoValues);
  const char* const fields[] = { "shepard", "sum", "weight sum" };
  AddText(fieldData, "Field", fields[o.field]);
  AddText(fieldData, "Scalar", this->Input.ScalarName);
  AddArrayName(fieldData, "SmoothingLengthArray", this->Input.Core.smoothing_length);
  AddCount(fieldData, "SmoothingLengthIsSupportRadius",
    { this->Input.Core.smoothing_length_is_support_radius });
  AddCount(fieldData, "EstimateSmoothingLength", { this->Input.Core.estimate_smoothing_length });
  AddArrayName(fieldData, "VolumeArray", this->Input.Core.volume);
  AddQuantity(fieldData, "Mass", this->Input.Core.has_mass, this->Input.Core.mass);
  AddQuantity(fieldData, "Density", this->Input.Core.has_density, this->Input.Core.density);
  AddText(fieldData, "FluidArray", this->Input.Fluid ? this->Input.Choice.FluidArrayName : "");
  if (this->Input.Fluid)
  {
    AddReal(fieldData, "FluidValue", { this->Input.Choice.FluidValue });
    AddCount(fieldData, "IgnoreSolids", { this->Input.Core.ignore_solids });
  }
  AddText(fieldData, "Kernel", mcor_sph_kernel_name(o.sph_kernel));
  AddText(fieldData, "SeedMode", o.seeds == MCOR_PAIRS ? "pairs" : "complete");
  AddText(fieldData, "Topology", o.topology == MCOR_TOPOLOGY_FIELD ? "field" : "table");
  AddText(fieldData, "Precision", o.precision == MCOR_FLOAT64 ? "double" : "single");
  AddReal(fieldData, "CubeSizeFactor", { o.cube_size_factor });
  AddReal(fieldData, "HScaleFactor", { o.h_scale });
  AddReal(fieldData, "NodeThreshold", { o.node_threshold });
  AddText(fieldData, "BoundaryDetection",
    o.boundary_detection == MCOR_BOUNDARY_EIGENVALUE ? "eigenvalue" : "weight sum");
  AddReal(fieldData, "VertexThreshold", { o.vertex_threshold });
  AddReal(fieldData, "Tolerance", { o.tolerance });
  AddCount(fieldData, "IterationLimit", { o.iteration_limit });
  AddCount(fieldData, "Preview", { o.preview });
}
