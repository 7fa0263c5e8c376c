// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMarchingCorrectors.h"

#include "mcor.h"
#include "vtkDataObjectTree.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkDataSetAttributes.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMarchingCorrectorsBlocks.h"
#include "vtkMarchingCorrectorsInput.h"
#include "vtkMarchingCorrectorsInternals.h"
#include "vtkMarchingCorrectorsOutput.h"
#include "vtkMarchingCorrectorsValues.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkVersionMacros.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

// These are handed to the core as they are.
static_assert(static_cast<int>(vtkMarchingCorrectors::CUBIC_SPLINE) == MCOR_CUBIC_SPLINE &&
    static_cast<int>(vtkMarchingCorrectors::QUADRATIC) == MCOR_QUADRATIC &&
    static_cast<int>(vtkMarchingCorrectors::M_PRIME_4) == MCOR_M_PRIME_4 &&
    static_cast<int>(vtkMarchingCorrectors::QUINTIC_SPLINE) == MCOR_QUINTIC_SPLINE &&
    static_cast<int>(vtkMarchingCorrectors::WENDLAND_C2) == MCOR_WENDLAND_C2 &&
    static_cast<int>(vtkMarchingCorrectors::WENDLAND_C2) + 1 == MCOR_SPH_KERNEL_COUNT &&
    static_cast<int>(vtkMarchingCorrectors::MAGNITUDE) == MCOR_MAGNITUDE,
  "the filter's numbers are the core's");

namespace
{
bool IsAborted(vtkMarchingCorrectors* filter)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20230101)
  return filter->CheckAbort();
#else
  return filter->GetAbortExecute() != 0;
#endif
}

// Runs between device launches; returns nonzero to stop.
int ReportProgress(void* user, double fraction, const char* phase)
{
  auto* filter = static_cast<vtkMarchingCorrectors*>(user);
  filter->SetProgressText(phase);
  filter->UpdateProgress(fraction);
  return IsAborted(filter) ? 1 : 0;
}

void PrintName(ostream& os, vtkIndent indent, const char* label, const std::string& name)
{
  os << indent << label << ": " << (name.empty() ? "(none)" : name) << "\n";
}
}

//------------------------------------------------------------------------------
vtkStandardNewMacro(vtkMarchingCorrectors);

//------------------------------------------------------------------------------
// The context is created by the first run: constructing the filter must not touch OpenCL.
vtkMarchingCorrectors::vtkMarchingCorrectors()
  : Internals(new vtkInternals)
{
  this->RunStatistics = vtkSmartPointer<vtkFieldData>::New();
  this->ContourValues->SetNumberOfContours(0);
  this->FreeSurfaceValues->SetValue(0, 0.5);
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
}

vtkMarchingCorrectors::~vtkMarchingCorrectors() = default;

//------------------------------------------------------------------------------
vtkMTimeType vtkMarchingCorrectors::GetMTime()
{
  return std::max({ this->Superclass::GetMTime(), this->ContourValues->GetMTime(),
    this->FreeSurfaceValues->GetMTime() });
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectors::SetFreeSurfaceValue(double value)
{
  this->FreeSurfaceValues->SetNumberOfContours(1);
  this->FreeSurfaceValues->SetValue(0, value);
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectors::AddExcludedArray(const std::string& name)
{
  this->ExcludedArrays.push_back(name);
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectors::ClearExcludedArrays()
{
  this->ExcludedArrays.clear();
  this->Modified();
}

//------------------------------------------------------------------------------
int vtkMarchingCorrectors::GetNumberOfExcludedArrays() const
{
  return static_cast<int>(this->ExcludedArrays.size());
}

//------------------------------------------------------------------------------
const char* vtkMarchingCorrectors::GetExcludedArray(int i) const
{
  return i >= 0 && i < this->GetNumberOfExcludedArrays()
    ? this->ExcludedArrays[static_cast<size_t>(i)].c_str()
    : nullptr;
}

//------------------------------------------------------------------------------
bool vtkMarchingCorrectors::SetKernelByName(const char* name)
{
  const int kernel = name ? mcor_find_sph_kernel(name) : -1;
  if (kernel >= 0)
  {
    this->SetKernel(kernel);
  }
  return kernel >= 0;
}

//------------------------------------------------------------------------------
const char* vtkMarchingCorrectors::GetKernelName() const
{
  return mcor_sph_kernel_name(static_cast<mcor_sph_kernel>(this->Kernel));
}

//------------------------------------------------------------------------------
std::string vtkMarchingCorrectors::ListDevices()
{
  char* text = nullptr;
  mcor_list_devices(&text);
  const std::string result = text ? text : "";
  std::free(text);
  return result;
}

//------------------------------------------------------------------------------
vtkFieldData* vtkMarchingCorrectors::GetRunStatistics()
{
  return this->RunStatistics;
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectors::ReleaseDeviceMemory()
{
  this->Internals->Release();
}

//------------------------------------------------------------------------------
int vtkMarchingCorrectors::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPointSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
  return 1;
}

//------------------------------------------------------------------------------
int vtkMarchingCorrectors::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataObject");
  return 1;
}

//------------------------------------------------------------------------------
vtkTypeBool vtkMarchingCorrectors::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA_OBJECT()))
  {
    return this->RequestDataObject(inputVector, outputVector);
  }
  return this->Superclass::ProcessRequest(request, inputVector, outputVector);
}

//------------------------------------------------------------------------------
// A poly data, or blocks of them as the input has.
int vtkMarchingCorrectors::RequestDataObject(
  vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* blocks = vtkDataObjectTree::GetData(inputVector[0]);
  vtkDataObject* output = vtkDataObject::GetData(outputVector);
  if (!output || !output->IsA(blocks ? blocks->GetClassName() : "vtkPolyData"))
  {
    auto made = vtkSmartPointer<vtkDataObject>::Take(
      blocks ? static_cast<vtkDataObject*>(blocks->NewInstance()) : vtkPolyData::New());
    outputVector->GetInformationObject(0)->Set(vtkDataObject::DATA_OBJECT(), made);
  }
  return 1;
}

//------------------------------------------------------------------------------
// Superclasses would report an error for a second array that was never asked for.
vtkMarchingCorrectorsRequest vtkMarchingCorrectors::FindRequest(int index, vtkPointSet* particles)
{
  vtkMarchingCorrectorsRequest request;
  vtkInformationVector* all = this->GetInformation()->Get(INPUT_ARRAYS_TO_PROCESS());
  if (!all || index >= all->GetNumberOfInformationObjects())
  {
    return request;
  }
  vtkInformation* info = all->GetInformationObject(index);
  const char* name = info->Get(vtkDataObject::FIELD_NAME());
  request.Name = name ? name : "";
  if (!request.Name.empty() || info->Has(vtkDataObject::FIELD_ATTRIBUTE_TYPE()))
  {
    int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
    request.Array = this->GetInputAbstractArrayToProcess(index, particles, association);
    request.OnPoints = association == vtkDataObject::FIELD_ASSOCIATION_POINTS;
  }
  return request;
}

//------------------------------------------------------------------------------
// The sentences of all blocks are kept, one a line.
int vtkMarchingCorrectors::Fail(const std::string& message)
{
  const std::string sentence = this->BlockName + message;
  this->ErrorMessage += (this->ErrorMessage.empty() ? "" : "\n") + sentence;
  vtkErrorMacro(<< sentence);
  return 0;
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectors::FillOptions(mcor_options& options) const
{
  mcor_set_default_options(&options);
  options.sph_kernel = static_cast<mcor_sph_kernel>(this->Kernel);
  options.field = this->FreeSurface ? MCOR_WEIGHT_SUM
    : this->ShepardNormalization    ? MCOR_SHEPARD
                                    : MCOR_SUM;
  options.seeds = this->SeedMode == PAIRS && !this->FreeSurface ? MCOR_PAIRS : MCOR_COMPLETE;
  options.topology = this->Topology == TOPOLOGY_FIELD ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
  options.h_scale = this->HScaleFactor;
  options.cube_size_factor = this->CubeSizeFactor;
  options.cube_size = this->CubeSize;
  options.node_threshold = this->NodeThreshold;
  options.boundary_detection =
    this->BoundaryDetection == EIGENVALUE ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
  options.vertex_threshold = this->VertexThreshold;
  options.preview = this->Preview;
  options.tolerance = this->Tolerance;
  options.iteration_limit = this->IterationLimit;
  options.memory_limit = static_cast<int64_t>(this->DeviceMemoryLimit) << 20;
  options.precision = this->Precision == DOUBLE_PRECISION ? MCOR_FLOAT64 : MCOR_FLOAT32;
  options.normals = this->ComputeNormals;
  options.gradients = this->ComputeGradients;
  options.weight_sum = this->ComputeWeightSum;
  options.boundary_eigenvalue = this->ComputeBoundaryEigenvalue;
  options.correction_length = this->ComputeCorrectionLength;
  options.residual = this->ComputeResidual;
  options.boundary_flag = this->ComputeBoundaryFlag;
  options.iso_value = this->ComputeScalars;
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectors::FillChoice(vtkMarchingCorrectorsChoice& choice, vtkPointSet* particles)
{
  choice.Scalar = this->FindRequest(0, particles);
  choice.ScalarDot = this->FindRequest(1, particles);
  choice.ScalarComponent = this->ScalarComponent;
  choice.FreeSurface = this->FreeSurface != 0;
  choice.SmoothingLengthArrayName = this->SmoothingLengthArrayName;
  choice.SmoothingLength = this->SmoothingLength;
  choice.EstimateSmoothingLength = this->EstimateSmoothingLength != 0;
  choice.SmoothingLengthIsSupportRadius = this->SmoothingLengthIsSupportRadius != 0;
  choice.VolumeArrayName = this->VolumeArrayName;
  choice.MassArrayName = this->MassArrayName;
  choice.DensityArrayName = this->DensityArrayName;
  choice.Mass = this->Mass;
  choice.Density = this->Density;
  choice.DetectArrays = this->DetectArrays != 0;
  choice.FluidArrayName = this->FluidArrayName;
  choice.FluidValue = this->FluidValue;
  choice.IgnoreSolids = this->IgnoreSolids != 0;
  choice.Kernel = this->Kernel;
  choice.InterpolateAttributes = this->InterpolateAttributes != 0;
  choice.ExcludedArrays = this->ExcludedArrays;
  choice.ComputeScalars = this->ComputeScalars != 0;
}

//------------------------------------------------------------------------------
std::vector<double> vtkMarchingCorrectors::ListIsoValues(const vtkMarchingCorrectorsInput& input)
{
  vtkContourValues* values =
    input.Choice.FreeSurface ? this->FreeSurfaceValues : this->ContourValues;
  if (values->GetNumberOfContours() == 0)
  {
    return { input.Choice.FreeSurface ? 0.5 : vtkMarchingCorrectorsMiddleOfRange(input.Core) };
  }
  return { values->GetValues(), values->GetValues() + values->GetNumberOfContours() };
}

//------------------------------------------------------------------------------
int vtkMarchingCorrectors::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  this->ErrorMessage.clear();
  this->BlockName.clear();
  this->RunStatistics = vtkSmartPointer<vtkFieldData>::New();
  this->Internals->BeginRun();
  const int done = vtkDataObjectTree::GetData(inputVector[0])
    ? this->ExtractBlocks(
        vtkDataObjectTree::GetData(inputVector[0]), vtkDataObjectTree::GetData(outputVector))
    : this->ExtractFrom(vtkPointSet::GetData(inputVector[0]), vtkPolyData::GetData(outputVector));
  this->Internals->EndRun();
  return done;
}

//------------------------------------------------------------------------------
// A block that fails leaves its place empty, and the others as they are.
int vtkMarchingCorrectors::ExtractBlocks(vtkDataObjectTree* input, vtkDataObjectTree* output)
{
  output->CopyStructure(input);
  const std::vector<std::string> names = vtkMarchingCorrectorsNameBlocks(input);
  vtkSmartPointer<vtkDataObjectTreeIterator> iterator;
  iterator.TakeReference(input->NewTreeIterator());
  iterator->InitTraversal();
  const double share = 1.0 / static_cast<double>(names.size());
  for (size_t i = 0; i < names.size(); ++i, iterator->GoToNextItem())
  {
    this->SetProgressShiftScale(static_cast<double>(i) * share, share);
    this->BlockName = names[i] + ": ";
    vtkDataObject* block = iterator->GetCurrentDataObject();
    vtkNew<vtkPolyData> surface;
    surface->GetFieldData()->PassData(block->GetFieldData());
    if (auto* particles = vtkPointSet::SafeDownCast(block))
    {
      this->ExtractFrom(particles, surface);
    }
    else
    {
      vtkWarningMacro(<< this->BlockName << "A " << block->GetClassName()
                      << " has no points of its own, and so no surface.");
    }
    output->SetDataSetFrom(iterator, surface);
  }
  this->SetProgressShiftScale(0.0, 1.0);
  if (IsAborted(this))
  {
    output->CopyStructure(input); // not some blocks of a surface
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkMarchingCorrectors::ExtractFrom(vtkPointSet* particles, vtkPolyData* output)
{
  if (!particles || !output || particles->GetNumberOfPoints() == 0 || IsAborted(this))
  {
    this->SetUsedNames({ {}, particles });
    return 1;
  }
  mcor_options options;
  vtkMarchingCorrectorsChoice choice;
  this->FillOptions(options);
  this->FillChoice(choice, particles);
  choice.ComputedArrays = vtkMarchingCorrectorsOutput::ComputedArrays(options);
  vtkMarchingCorrectorsInput input(choice, particles);
  const bool usable = input.Collect();
  this->SetUsedNames(input);
  if (!usable)
  {
    return this->Fail(input.Error);
  }
  if (input.FluidCount == 0)
  {
    vtkWarningMacro(<< this->BlockName << "No particle has " << choice.FluidArrayName << " = "
                    << choice.FluidValue << ", so there is no fluid and no surface.");
    return 1;
  }
  const std::string lacking = this->Internals->Prepare(this->Device);
  return lacking.empty() ? this->Extract(input, options, output) : this->Fail(lacking);
}

//------------------------------------------------------------------------------
// What an observer of the progress may change is read before the run.
int vtkMarchingCorrectors::Extract(
  vtkMarchingCorrectorsInput& input, mcor_options& options, vtkPolyData* output)
{
  const int precision = this->OutputPointsPrecision;
  const bool keep = this->KeepDeviceData != 0;
  const std::vector<double> isoValues = this->ListIsoValues(input);
  options.iso_values = isoValues.data();
  options.iso_count = static_cast<int>(isoValues.size());
  options.nearest_particle = input.FromNearest.empty() ? 0 : 1;
  options.progress = ReportProgress;
  options.progress_user = this;
  if (keep)
  {
    this->Internals->SetVersions(input);
  }
  mcor_context* context = this->Internals->Context;
  mcor_surface surface = {};
  const mcor_status status = mcor_extract(context, &input.Core, &options, &surface);
  if (!keep)
  {
    mcor_release_memory(context);
  }
  if (status != MCOR_OK)
  {
    const std::string message = mcor_last_error(context);
    this->Internals->Forget(status);
    return status == MCOR_CANCELLED ? 1 : this->Fail(message);
  }
  vtkMarchingCorrectorsOutput builder(input, options, surface);
  for (const std::string& sentence : builder.ListLeftOut())
  {
    vtkWarningMacro(<< this->BlockName << sentence);
  }
  builder.BuildFieldData(output->GetFieldData());
  builder.AddRunStatistics(this->RunStatistics);
  builder.BuildMesh(output, precision);
  mcor_free_surface(&surface);
  return 1;
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectors::SetUsedNames(const vtkMarchingCorrectorsInput& input)
{
  const auto nameOf = [](vtkDataArray* array)
  { return std::string(array && array->GetName() ? array->GetName() : ""); };
  this->UsedSmoothingLengthArrayName = nameOf(input.SmoothingLength);
  this->UsedVolumeArrayName = nameOf(input.Volume);
  this->UsedMassArrayName = nameOf(input.Mass);
  this->UsedDensityArrayName = nameOf(input.Density);
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectors::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  this->ContourValues->PrintSelf(os, indent.GetNextIndent());
  os << indent << "Scalar Component: " << this->ScalarComponent << "\n";
  os << indent << "Shepard Normalization: " << this->ShepardNormalization << "\n";
  os << indent << "Free Surface: " << this->FreeSurface << "\n";
  this->FreeSurfaceValues->PrintSelf(os, indent.GetNextIndent());
  PrintName(os, indent, "Smoothing Length Array Name", this->SmoothingLengthArrayName);
  os << indent << "Smoothing Length: " << this->SmoothingLength << "\n";
  os << indent << "Estimate Smoothing Length: " << this->EstimateSmoothingLength << "\n";
  os << indent << "Smoothing Length Is Support Radius: " << this->SmoothingLengthIsSupportRadius
     << "\n";
  PrintName(os, indent, "Volume Array Name", this->VolumeArrayName);
  PrintName(os, indent, "Mass Array Name", this->MassArrayName);
  PrintName(os, indent, "Density Array Name", this->DensityArrayName);
  os << indent << "Mass: " << this->Mass << "\n";
  os << indent << "Density: " << this->Density << "\n";
  os << indent << "Detect Arrays: " << this->DetectArrays << "\n";
  PrintName(os, indent, "Used Smoothing Length Array Name", this->UsedSmoothingLengthArrayName);
  PrintName(os, indent, "Used Volume Array Name", this->UsedVolumeArrayName);
  PrintName(os, indent, "Used Mass Array Name", this->UsedMassArrayName);
  PrintName(os, indent, "Used Density Array Name", this->UsedDensityArrayName);
  os << indent << "Kernel: " << this->GetKernelName() << "\n";
  os << indent << "H Scale Factor: " << this->HScaleFactor << "\n";
  os << indent << "Cube Size Factor: " << this->CubeSizeFactor << "\n";
  os << indent << "Cube Size: " << this->CubeSize << "\n";
  os << indent << "Seed Mode: " << (this->SeedMode == PAIRS ? "pairs" : "complete") << "\n";
  os << indent << "Topology: " << (this->Topology == TOPOLOGY_FIELD ? "field" : "table") << "\n";
  os << indent << "Preview: " << this->Preview << "\n";
  os << indent << "Node Threshold: " << this->NodeThreshold << "\n";
  os << indent << "Boundary Detection: "
     << (this->BoundaryDetection == EIGENVALUE ? "eigenvalue" : "weight sum") << "\n";
  os << indent << "Vertex Threshold: " << this->VertexThreshold << "\n";
  PrintName(os, indent, "Fluid Array Name", this->FluidArrayName);
  os << indent << "Fluid Value: " << this->FluidValue << "\n";
  os << indent << "Ignore Solids: " << this->IgnoreSolids << "\n";
  os << indent << "Compute Normals: " << this->ComputeNormals << "\n";
  os << indent << "Compute Gradients: " << this->ComputeGradients << "\n";
  os << indent << "Compute Scalars: " << this->ComputeScalars << "\n";
  os << indent << "Compute Weight Sum: " << this->ComputeWeightSum << "\n";
  os << indent << "Compute Boundary Eigenvalue: " << this->ComputeBoundaryEigenvalue << "\n";
  os << indent << "Compute Correction Length: " << this->ComputeCorrectionLength << "\n";
  os << indent << "Compute Residual: " << this->ComputeResidual << "\n";
  os << indent << "Compute Boundary Flag: " << this->ComputeBoundaryFlag << "\n";
  os << indent << "Interpolate Attributes: " << this->InterpolateAttributes << "\n";
  for (const std::string& name : this->ExcludedArrays)
  {
    PrintName(os, indent, "Excluded Array", name);
  }
  os << indent << "Output Points Precision: " << this->OutputPointsPrecision << "\n";
  os << indent << "Precision: " << this->Precision << "\n";
  PrintName(os, indent, "Device", this->Device);
  os << indent << "Tolerance: " << this->Tolerance << "\n";
  os << indent << "Iteration Limit: " << this->IterationLimit << "\n";
  os << indent << "Device Memory Limit: " << this->DeviceMemoryLimit << " MiB\n";
  os << indent << "Keep Device Data: " << this->KeepDeviceData << "\n";
  PrintName(os, indent, "Error Message", this->ErrorMessage);
}
