// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMarchingCorrectors.h"

#include "mcor.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkMarchingCorrectorsInput.h"
#include "vtkMarchingCorrectorsOutput.h"
#include "vtkMarchingCorrectorsSummary.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHBlocks.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <vector>

static_assert(static_cast<int>(vtkMarchingCorrectors::MAGNITUDE) == MCOR_MAGNITUDE,
  "the filter's numbers are the core's");

vtkStandardNewMacro(vtkMarchingCorrectors);

vtkMarchingCorrectors::vtkMarchingCorrectors()
{
  this->SharesRuns = true;
  this->ContourValues->SetNumberOfContours(0);
  this->FreeSurfaceValues->SetValue(0, 0.5);
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
}

vtkMarchingCorrectors::~vtkMarchingCorrectors() = default;

vtkMTimeType vtkMarchingCorrectors::GetMTime()
{
  return std::max({ this->Superclass::GetMTime(), this->ContourValues->GetMTime(),
    this->FreeSurfaceValues->GetMTime() });
}

void vtkMarchingCorrectors::SetFreeSurfaceValue(double value)
{
  this->FreeSurfaceValues->SetNumberOfContours(1);
  this->FreeSurfaceValues->SetValue(0, value);
}

void vtkMarchingCorrectors::SetSolids(int solids)
{
  const int legal = std::min(std::max<int>(solids, SOLIDS_WEIGHT), static_cast<int>(SOLIDS_AUTO));
  if (legal != this->Solids)
  {
    this->Solids = legal;
    this->IgnoreSolids = legal == SOLIDS_IGNORE;
    this->Modified();
  }
}

// What is not a number, as an empty row of a panel's list, is none.
// `isFound`: false where a value was sought and there is none.
std::vector<double> vtkMarchingCorrectors::ListIsoValues(
  const vtkMarchingCorrectorsInput& input, const mcor_ranks* ranks, bool& isFound)
{
  vtkContourValues* values =
    input.Choice.FreeSurface ? this->FreeSurfaceValues : this->ContourValues;
  std::vector<double> list(
    values->GetValues(), values->GetValues() + values->GetNumberOfContours());
  list.erase(
    std::remove_if(list.begin(), list.end(), [](double value) { return std::isnan(value); }),
    list.end());
  isFound = true;
  if (list.empty())
  {
    double range[2], value = 0.5;
    isFound =
      input.Choice.FreeSurface || mcor_find_iso_value(&input.Core, ranks, range, &value) != 0;
    list.push_back(isFound ? value : 0.0);
  }
  return list;
}

void vtkMarchingCorrectors::SetPanelBoxPosition(double x, double y, double z)
{
  const double* b = this->Box;
  this->SetBox(x, x + b[1] - b[0], y, y + b[3] - b[2], z, z + b[5] - b[4]);
}

void vtkMarchingCorrectors::SetPanelBoxLength(double x, double y, double z)
{
  const double* b = this->Box;
  this->SetBox(b[0], b[0] + x, b[2], b[2] + y, b[4], b[4] + z);
}

const char* vtkMarchingCorrectors::GetOutputClassName(const char*)
{
  return "vtkPolyData";
}

void vtkMarchingCorrectors::FillOptions(mcor_options& options)
{
  this->Superclass::FillOptions(options);
  options.field = this->FreeSurface ? MCOR_WEIGHT_SUM
    : this->ShepardNormalization    ? MCOR_SHEPARD
                                    : MCOR_SUM;
  options.seeds = this->SeedMode == PAIRS && !this->FreeSurface ? MCOR_PAIRS : MCOR_COMPLETE;
  options.topology = this->Topology == TOPOLOGY_FIELD ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
  options.cube_size_factor = this->CubeSizeFactor;
  options.cube_size = this->CubeSize;
  options.level_limit = this->CubeSizeMode == ADAPTIVE ? this->CubeLevelLimit : 0;
  if (this->UseBox)
  {
    std::copy(this->Box, this->Box + 6, options.box);
    // Of zeros, it is no box to the core; here it is one that was not thought of, and is refused.
    options.box[0] += mcor_has_box(&options) ? 0.0 : std::numeric_limits<double>::denorm_min();
  }
  options.filled = this->Filled;
  options.capping = !this->Capping ? MCOR_CAP_NONE : this->UseBox ? MCOR_CAP_BOX : MCOR_CAP_PERIOD;
  options.node_threshold = this->NodeThreshold;
  options.boundary_detection = this->Trim && this->BoundaryDetection == EIGENVALUE
    ? MCOR_BOUNDARY_EIGENVALUE
    : MCOR_BOUNDARY_WEIGHT_SUM;
  options.vertex_threshold = this->Trim ? this->VertexThreshold : 0.0;
  const bool endsAtSolids =
    this->Solids == SOLIDS_WALL || (this->Solids == SOLIDS_AUTO && !this->FreeSurface);
  options.wall_share = endsAtSolids && (this->Trim || this->FreeSurface) ? this->WallShare : 0.0;
  options.preview = this->Preview;
  options.tolerance = this->Tolerance;
  options.iteration_limit = this->IterationLimit;
  options.normals = this->ComputeNormals;
  options.gradients = this->ComputeGradients;
  options.weight_sum = this->ComputeWeightSum;
  options.boundary_eigenvalue = this->ComputeBoundaryEigenvalue;
  options.correction_length = this->ComputeCorrectionLength;
  options.residual = this->ComputeResidual;
  options.boundary_flag = this->ComputeBoundaryFlag;
  options.iso_value = this->ComputeScalars;
}

void vtkMarchingCorrectors::FillChoice(vtkMarchingCorrectorsChoice& choice, vtkPointSet* particles)
{
  this->Superclass::FillChoice(choice);
  this->FillRequests(choice, particles);
  choice.ScalarComponent = this->ScalarComponent;
  choice.FreeSurface = this->FreeSurface != 0;
  choice.InterpolateAttributes = this->InterpolateAttributes != 0;
  choice.ComputeScalars = this->ComputeScalars != 0;
}

void vtkMarchingCorrectors::FillRequests(
  vtkMarchingCorrectorsChoice& choice, vtkPointSet* particles)
{
  choice.Scalar = this->FindFirstRequest(particles);
  choice.ScalarDot = this->FindRequest(1, particles);
}

void vtkMarchingCorrectors::Process(vtkDataObject* data, vtkDataObject* output)
{
  this->ClearSummary();
  auto* particles = vtkPointSet::SafeDownCast(data);
#if MCOR_HAS_RANKS
  if (this->IsShared())
  {
    this->ProcessDistributed(particles, vtkPolyData::SafeDownCast(output));
    return;
  }
#endif
  if (data && !particles)
  {
    this->Warn(
      std::string("A ") + data->GetClassName() + " has no points of its own, and so no surface.");
    return;
  }
  if (!particles || particles->GetNumberOfPoints() == 0 || this->IsAborted())
  {
    this->SetUsedNames(nullptr);
    return;
  }
  mcor_options options;
  vtkMarchingCorrectorsChoice choice;
  this->FillOptions(options);
  this->FillChoice(choice, particles);
  this->FindFluid(choice, particles);
  choice.ComputedArrays = vtkMarchingCorrectorsOutput::ComputedArrays(options);
  vtkMarchingCorrectorsInput input(choice, particles);
  const bool usable = input.Collect();
  this->SetUsedNames(&input);
  if (!usable)
  {
    this->Fail(input.Error);
  }
  else if (input.FluidCount == 0)
  {
    this->WarnOfNoFluid(choice, "no surface");
  }
  else
  {
    this->WarnOnce(WARN_TYPE_ARRAY, input.DescribeUnusedType());
    if (!this->SetPeriod(particles, options))
    {
      return;
    }
    this->Extract(input, options, vtkPolyData::SafeDownCast(output));
  }
}

// What an observer of the progress may change is read before the run.
void vtkMarchingCorrectors::Extract(
  vtkMarchingCorrectorsInput& input, mcor_options& options, vtkPolyData* output)
{
  const int precision = this->OutputPointsPrecision;
  bool isFound;
  const std::vector<double> isoValues = this->ListIsoValues(input, nullptr, isFound);
  options.iso_values = isoValues.data();
  options.iso_count = static_cast<int>(isoValues.size());
  options.nearest_particle = input.FromNearest.empty() ? 0 : 1;
  this->EstimatedCells = vtkMarchingCorrectorsEstimateCells(
    input.Core, options, vtkMarchingCorrectorsLeastLength(input.Core));
  this->WarnOfHugeRun();
  mcor_surface surface = {};
  if (!this->CallCore(input, options,
        [&](mcor_context* context)
        { return mcor_extract(context, &input.Core, &options, &surface); }))
  {
    return;
  }
  vtkMarchingCorrectorsOutput builder(input, options, surface);
  this->Summarize(input, options, surface.statistics);
  this->WarnOf(input, surface, input.Core, options);
  builder.AddIsoValues(output->GetFieldData());
  builder.AddRun(this->RunStatistics);
  builder.AddMeasures(this->RunStatistics);
  builder.BuildMesh(output, precision);
  mcor_free_surface(&surface);
}

void vtkMarchingCorrectors::WarnOf(const vtkMarchingCorrectorsInput& input,
  const mcor_surface& surface, const mcor_input& core, const mcor_options& options)
{
  for (const std::string& sentence : input.ListLeftOut(surface.attribute_not_finite, "the surface"))
  {
    this->Warn(sentence);
  }
  for (int kind = 0; kind < MCOR_WARNING_COUNT; ++kind)
  {
    const std::unique_ptr<char, decltype(&std::free)> text(
      mcor_describe_warning(static_cast<mcor_warning>(kind), &core, &options, &surface), std::free);
    this->WarnOnce(kind, text ? text.get() : "");
  }
}

void vtkMarchingCorrectors::ClearSummary()
{
  std::fill_n(this->FluidScalarRange, 2, 0.0);
  this->UsedIsoValues.clear();
  this->IsoValueArrayName.clear();
  this->UsedSmoothingLength.clear();
  this->UsedVolume.clear();
  this->UsedCubeSize = 0.0;
  this->SurfaceMeasures.clear();
  this->EstimatedCells = 0.0;
}

void vtkMarchingCorrectors::WarnOfHugeRun()
{
  if (this->EstimatedCells >= vtkMarchingCorrectorsHugeCells)
  {
    vtkWarningMacro(<< this->BlockName << "The fluid fills about " << this->EstimatedCells
                    << " cells of the virtual grid, so this may take minutes and much memory. "
                    << "A larger cube size takes less; the run can be cancelled.");
  }
}

vtkMarchingCorrectors& vtkMarchingCorrectors::LookAhead()
{
  if (this->IsShared())
  {
    std::copy_n(this->FluidScalarRange, 2, this->NextScalarRange);
    this->NextIsoValue = std::numeric_limits<double>::quiet_NaN();
    this->NextFluid = this->UsedFluid;
    this->NextComponents = 0;
    this->NextArray.clear();
    this->NextCells = this->EstimatedCells;
    return *this;
  }
  vtkDataObject* data =
    this->GetNumberOfInputConnections(0) > 0 ? this->GetInputDataObject(0, 0) : nullptr;
  if (data && std::max(this->GetMTime(), data->GetMTime()) < this->LookTime.GetMTime())
  {
    return *this;
  }
  const double none = std::numeric_limits<double>::infinity();
  mcor_options options;
  this->FillOptions(options);
  this->NextScalarRange[0] = none;
  this->NextScalarRange[1] = -none;
  this->NextIsoValue = std::numeric_limits<double>::quiet_NaN();
  this->NextCells = 0.0;
  this->NextComponents = 0;
  this->NextFluid.clear();
  this->NextArray.clear();
  const bool together = this->TakesTogether();
  const vtkSmartPointer<vtkPointSet> all = together ? this->TakeParticles(data) : nullptr;
  for (vtkPointSet* particles :
    vtkSPHListPointSets(together ? static_cast<vtkDataObject*>(all) : data))
  {
    this->LookAhead(particles, options);
  }
  if (this->NextScalarRange[0] > this->NextScalarRange[1])
  {
    std::fill_n(this->NextScalarRange, 2, 0.0);
  }
  this->LookTime.Modified();
  return *this;
}

// What is known does not wait for the rest: the range needs no smoothing length, the number of cells
// no scalar. Of several blocks the first one's iso value.
void vtkMarchingCorrectors::LookAhead(vtkPointSet* particles, const mcor_options& options)
{
  vtkMarchingCorrectorsChoice choice;
  this->FillChoice(choice, particles);
  this->FindFluid(choice, particles);
  choice.InterpolateAttributes = false;
  this->NextArray =
    this->NextArray.empty() ? vtkSPHChooseArray(particles->GetPointData()) : this->NextArray;
  vtkMarchingCorrectorsInput contoured(choice, particles);
  double range[2], value;
  if (!choice.FreeSurface && contoured.CollectContoured() &&
    mcor_find_iso_value(&contoured.Core, nullptr, range, &value))
  {
    this->NextScalarRange[0] = std::min(this->NextScalarRange[0], range[0]);
    this->NextScalarRange[1] = std::max(this->NextScalarRange[1], range[1]);
    this->NextIsoValue = std::isnan(this->NextIsoValue) ? value : this->NextIsoValue;
    this->NextComponents = contoured.ScalarDot ? 1 : contoured.Scalar->GetNumberOfComponents();
  }
  choice.FreeSurface = true;
  vtkMarchingCorrectorsInput input(choice, particles);
  if (input.Collect())
  {
    this->NextFluid = input.DescribeFluid();
    this->NextCells += vtkMarchingCorrectorsEstimateCells(
      input.Core, options, vtkMarchingCorrectorsLeastLength(input.Core));
  }
}

void vtkMarchingCorrectors::Summarize(const vtkMarchingCorrectorsInput& input,
  const mcor_options& options, const mcor_statistics& statistics)
{
  if (options.field != MCOR_WEIGHT_SUM)
  {
    this->FluidScalarRange[0] = statistics.scalar_min;
    this->FluidScalarRange[1] = statistics.scalar_max;
  }
  this->UsedIsoValues = vtkMarchingCorrectorsDescribeIsoValues(options);
  this->IsoValueArrayName = options.iso_value ? input.IsoValueName : "";
  this->UsedSmoothingLength = vtkMarchingCorrectorsDescribeSmoothingLength(input.Core, statistics);
  this->UsedVolume = vtkMarchingCorrectorsDescribeVolume(input.Core);
  this->UsedCubeSize = statistics.cube_size;
  this->SurfaceMeasures = vtkMarchingCorrectorsDescribeMeasures(statistics);
}

void vtkMarchingCorrectors::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  this->ContourValues->PrintSelf(os, indent.GetNextIndent());
  os << indent << "Scalar Component: " << this->ScalarComponent << "\n";
  os << indent << "Shepard Normalization: " << this->ShepardNormalization << "\n";
  os << indent << "Free Surface: " << this->FreeSurface << "\n";
  this->FreeSurfaceValues->PrintSelf(os, indent.GetNextIndent());
  os << indent << "Cube Size Factor: " << this->CubeSizeFactor << "\n";
  os << indent << "Cube Size: " << this->CubeSize << "\n";
  os << indent << "Cube Size Mode: " << (this->CubeSizeMode == ADAPTIVE ? "adaptive" : "uniform")
     << "\n";
  os << indent << "Cube Level Limit: " << this->CubeLevelLimit << "\n";
  os << indent << "Partition: " << (this->Partition == BY_WORK ? "by work" : "by particles")
     << "\n";
  os << indent << "Use Box: " << this->UseBox << "\n";
  os << indent << "Box:";
  for (const double side : this->Box)
  {
    os << " " << side;
  }
  os << "\n";
  os << indent << "Capping: " << this->Capping << "\n";
  os << indent << "Filled: " << this->Filled << "\n";
  os << indent << "Seed Mode: " << (this->SeedMode == PAIRS ? "pairs" : "complete") << "\n";
  os << indent << "Topology: " << (this->Topology == TOPOLOGY_FIELD ? "field" : "table") << "\n";
  os << indent << "Preview: " << this->Preview << "\n";
  os << indent << "Trim: " << this->Trim << "\n";
  os << indent << "Node Threshold: " << this->NodeThreshold << "\n";
  os << indent << "Boundary Detection: "
     << (this->BoundaryDetection == EIGENVALUE ? "eigenvalue" : "weight sum") << "\n";
  os << indent << "Vertex Threshold: " << this->VertexThreshold << "\n";
  os << indent << "Solids: " << this->GetSolids() << "\n";
  os << indent << "Wall Share: " << this->WallShare << "\n";
  os << indent << "Compute Normals: " << this->ComputeNormals << "\n";
  os << indent << "Compute Gradients: " << this->ComputeGradients << "\n";
  os << indent << "Compute Scalars: " << this->ComputeScalars << "\n";
  os << indent << "Compute Weight Sum: " << this->ComputeWeightSum << "\n";
  os << indent << "Compute Boundary Eigenvalue: " << this->ComputeBoundaryEigenvalue << "\n";
  os << indent << "Compute Correction Length: " << this->ComputeCorrectionLength << "\n";
  os << indent << "Compute Residual: " << this->ComputeResidual << "\n";
  os << indent << "Compute Boundary Flag: " << this->ComputeBoundaryFlag << "\n";
  os << indent << "Interpolate Attributes: " << this->InterpolateAttributes << "\n";
  os << indent << "Output Points Precision: " << this->OutputPointsPrecision << "\n";
  os << indent << "Tolerance: " << this->Tolerance << "\n";
  os << indent << "Iteration Limit: " << this->IterationLimit << "\n";
  os << indent << "Fluid Scalar Range: " << this->FluidScalarRange[0] << " "
     << this->FluidScalarRange[1] << "\n";
  os << indent << "Used Iso Values: " << this->UsedIsoValues << "\n";
  os << indent << "Used Smoothing Length: " << this->UsedSmoothingLength << "\n";
  os << indent << "Used Volume: " << this->UsedVolume << "\n";
  os << indent << "Used Cube Size: " << this->UsedCubeSize << "\n";
  os << indent << "Surface Measures: " << this->SurfaceMeasures << "\n";
  os << indent << "Estimated Cells: " << this->EstimatedCells << "\n";
}
