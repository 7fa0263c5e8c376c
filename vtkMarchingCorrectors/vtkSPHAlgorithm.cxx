// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHAlgorithm.h"

#include "vtkDataObjectTree.h"
#include "vtkDataObjectTypes.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkSPHArrays.h"
#include "vtkSPHBlocks.h"
#include "vtkSPHPrint.h"
#include "vtkSPHRun.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkVariant.h"
#include "vtkVersionMacros.h"

#include <algorithm>
#include <cstring>
#include <sstream>

VTK_ABI_NAMESPACE_BEGIN
// The filters pass these values to the core as they are.
static_assert(static_cast<int>(vtkSPHAlgorithm::CUBIC_SPLINE) == MCOR_CUBIC_SPLINE &&
    static_cast<int>(vtkSPHAlgorithm::QUADRATIC) == MCOR_QUADRATIC &&
    static_cast<int>(vtkSPHAlgorithm::M_PRIME_4) == MCOR_M_PRIME_4 &&
    static_cast<int>(vtkSPHAlgorithm::QUINTIC_SPLINE) == MCOR_QUINTIC_SPLINE &&
    static_cast<int>(vtkSPHAlgorithm::WENDLAND_C2) == MCOR_WENDLAND_C2 &&
    static_cast<int>(vtkSPHAlgorithm::QUARTIC_SPLINE) == MCOR_QUARTIC_SPLINE &&
    static_cast<int>(vtkSPHAlgorithm::WENDLAND_C4) == MCOR_WENDLAND_C4 &&
    static_cast<int>(vtkSPHAlgorithm::WENDLAND_C6) == MCOR_WENDLAND_C6 &&
    static_cast<int>(vtkSPHAlgorithm::SINC_6) == MCOR_SINC_6 &&
    static_cast<int>(vtkSPHAlgorithm::SINC_6) + 1 == MCOR_SPH_KERNEL_COUNT,
  "the filter's numbers are the core's");

// The context is created by the first run: constructing the filter must not touch OpenCL.
vtkSPHAlgorithm::vtkSPHAlgorithm()
  : RunStatistics(vtkSmartPointer<vtkFieldData>::New())
  , Internals(new vtkInternals)
{
  this->SetController(vtkMultiProcessController::GetGlobalController());
}

vtkSPHAlgorithm::~vtkSPHAlgorithm()
{
  this->SetController(nullptr);
}

vtkCxxSetObjectMacro(vtkSPHAlgorithm, Controller, vtkMultiProcessController);

bool vtkSPHAlgorithm::SetKernelByName(const char* name)
{
  const int kernel = name ? mcor_find_sph_kernel(name) : -1;
  if (kernel >= 0)
  {
    this->SetKernel(kernel);
  }
  return kernel >= 0;
}

const char* vtkSPHAlgorithm::GetKernelName(int kernel)
{
  return mcor_sph_kernel_name(static_cast<mcor_sph_kernel>(kernel));
}

const char* vtkSPHAlgorithm::GetExcludedArray(int i) const
{
  return i >= 0 && i < this->GetNumberOfExcludedArrays() ? this->ExcludedArrays[i].c_str()
                                                         : nullptr;
}

void vtkSPHAlgorithm::SetWord(mcor_word word)
{
  vtkSPHWord = word;
}

std::string vtkSPHAlgorithm::ListDevices()
{
  char* text = nullptr;
  mcor_list_devices(&text);
  return vtkSPHTakeText(text);
}

vtkFieldData* vtkSPHAlgorithm::GetRunStatistics()
{
  return this->RunStatistics;
}

const char* vtkSPHAlgorithm::GetStatistics()
{
  std::ostringstream text;
  for (const auto& array : vtkSPHListArrays(this->RunStatistics))
  {
    text << array->GetName() << ":";
    for (vtkIdType v = 0; v < array->GetNumberOfValues(); ++v)
    {
      text << (v ? ", " : " ") << array->GetVariantValue(v).ToString();
    }
    text << "\n";
  }
  this->Statistics = text.str();
  return this->Statistics.c_str();
}

void vtkSPHAlgorithm::ReleaseDeviceMemory()
{
  this->Internals->Release();
}

int vtkSPHAlgorithm::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPointSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
  return 1;
}

int vtkSPHAlgorithm::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataObject");
  return 1;
}

// VTK 9.1 cannot make a vtkPointSet from the name of its class, so `like` makes it.
vtkSmartPointer<vtkDataObject> vtkSPHAlgorithm::NewOutput(
  const std::string& className, vtkDataObject* like)
{
  const bool isLike = like && className == like->GetClassName();
  return vtkSmartPointer<vtkDataObject>::Take(
    isLike ? like->NewInstance() : vtkDataObjectTypes::NewDataObject(className.c_str()));
}

// Makes an output. Its class is the input's if the output has blocks, else GetOutputClassName().
vtkTypeBool vtkSPHAlgorithm::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!request->Has(vtkStreamingDemandDrivenPipeline::REQUEST_DATA_OBJECT()))
  {
    return this->Superclass::ProcessRequest(request, inputVector, outputVector);
  }
  vtkDataObject* input = vtkDataObject::GetData(inputVector[0]);
  vtkDataObject* output = vtkDataObject::GetData(outputVector);
  const bool isTree = vtkDataObjectTree::SafeDownCast(input) != nullptr;
  const bool blocks = isTree && (!this->TakesTogether() || this->KeepsBlocks());
  const std::string name = blocks
    ? input->GetClassName()
    : this->GetOutputClassName(isTree || !input ? "vtkPolyData" : input->GetClassName());
  if (!output || name != output->GetClassName())
  {
    const auto made = NewOutput(name, input);
    outputVector->GetInformationObject(0)->Set(vtkDataObject::DATA_OBJECT(), made);
  }
  return 1;
}

void vtkSPHAlgorithm::AskForAll(vtkInformation* input)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  input->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
  input->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  input->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  if (input->Has(Pipeline::WHOLE_EXTENT()))
  {
    int extent[6];
    input->Get(Pipeline::WHOLE_EXTENT(), extent);
    input->Set(Pipeline::UPDATE_EXTENT(), extent, 6);
  }
}

bool vtkSPHAlgorithm::IsAborted()
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20230101)
  return this->CheckAbort();
#else
  return this->GetAbortExecute() != 0;
#endif
}

// Returns an empty request if no array was chosen for `index`; the superclass would report an error.
vtkSPHRequest vtkSPHAlgorithm::FindRequest(int index, vtkPointSet* particles)
{
  vtkSPHRequest request;
  vtkInformationVector* all = this->GetInformation()->Get(INPUT_ARRAYS_TO_PROCESS());
  if (!all || index >= all->GetNumberOfInformationObjects())
  {
    return request;
  }
  vtkInformation* info = all->GetInformationObject(index);
  const char* name = info->Get(vtkDataObject::FIELD_NAME());
  request.Name = name && std::strcmp(name, "(automatic)") != 0 ? name : "";
  if (!request.Name.empty() || (!name && info->Has(vtkDataObject::FIELD_ATTRIBUTE_TYPE())))
  {
    int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
    request.Array = this->GetInputAbstractArrayToProcess(index, particles, association);
    // Arrays of cells may have become arrays of particles, see TakeVertices().
    request.OnPoints = association == vtkDataObject::FIELD_ASSOCIATION_POINTS;
    if (!request.Array && association == vtkDataObject::FIELD_ASSOCIATION_CELLS)
    {
      request.Array = particles->GetPointData()->GetAbstractArray(request.Name.c_str());
      request.OnPoints = request.Array != nullptr;
    }
  }
  return request;
}

// ErrorMessage keeps the sentences of all blocks, one a line.
void vtkSPHAlgorithm::Fail(const std::string& message)
{
  const std::string sentence = this->BlockName + message;
  this->ErrorMessage += (this->ErrorMessage.empty() ? "" : "\n") + sentence;
  ++this->MessageCount;
  vtkErrorMacro(<< sentence);
}

void vtkSPHAlgorithm::Warn(const std::string& message)
{
  ++this->MessageCount;
  vtkWarningMacro(<< this->BlockName << message);
}

void vtkSPHAlgorithm::WarnOnce(int kind, const std::string& message)
{
  if (!message.empty() && this->Warned.insert(kind).second)
  {
    this->Warn(message);
  }
}

void vtkSPHAlgorithm::FillOptions(mcor_options& options) const
{
  mcor_set_default_options(&options);
  options.sph_kernel = static_cast<mcor_sph_kernel>(this->Kernel);
  options.h_scale = this->HScaleFactor;
  options.dimension = this->Dimension;
  std::copy(this->PeriodicBounds, this->PeriodicBounds + 6, options.periodic);
  options.memory_limit = static_cast<int64_t>(this->DeviceMemoryLimit) << 20;
  options.precision = this->Precision == DOUBLE_PRECISION ? MCOR_FLOAT64 : MCOR_FLOAT32;
}

// An update that fails has an empty output but succeeds for the pipeline. Otherwise ParaView would
// never again update a view of the output.
int vtkSPHAlgorithm::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  this->ErrorMessage.clear();
  this->MessageCount = 0;
  this->BlockName.clear();
  this->Warned.clear();
  this->RunStatistics = vtkSmartPointer<vtkFieldData>::New();
  this->Internals->BeginRun();
  this->SumShared = nullptr;
  if (this->IsShared())
  {
    this->SumShared = [this](vtkPointSet* points, const mcor_input& mine,
                        const mcor_options& options, const double* ratio, double* values)
    { return vtkRun::Make(this)->SumNeighbors(points, mine, options, ratio, values); };
  }
  vtkDataObject* all = vtkDataObject::GetData(inputVector[this->GetParticlesPort()]);
  vtkDataObject* particles = this->TakeVertices(all);
  this->WarnOfMesh(all, particles);
  const bool isSecond = this->GetParticlesPort() > 0;
  this->Particles = isSecond ? this->JoinParticles(particles) : nullptr;
  if ((isSecond || this->TakesTogether()) && vtkRun::Make(this)->IsFirst())
  {
    this->WarnOnce(WARN_LOST_ARRAYS, vtkSPHDescribeLost(particles, this->JoinParticles(particles)));
  }
  vtkDataObject* input = isSecond ? vtkDataObject::GetData(inputVector[0]) : particles;
  auto* tree = vtkDataObjectTree::SafeDownCast(input);
  vtkDataObjectTree* apart = this->TakesTogether() ? nullptr : tree;
  vtkDataObject* output = vtkDataObject::GetData(outputVector);
  const bool agree = !this->IsShared() || this->AgreeOnBlocks(apart);
  if (agree && apart)
  {
    this->ProcessBlocks(apart, vtkDataObjectTree::SafeDownCast(output));
  }
  else if (agree && tree)
  {
    this->ProcessJoined(tree, output);
  }
  else if (agree)
  {
    this->Process(input, output);
  }
  this->Particles = nullptr;
  this->Internals->EndRun();
  return 1;
}

bool vtkSPHAlgorithm::IsShared() const
{
#if MCOR_HAS_RANKS
  return this->Controller && this->Controller->IsA("vtkMPIController") &&
    this->Controller->GetNumberOfProcesses() > 1;
#else
  return false;
#endif
}

void vtkSPHAlgorithm::SetUsedNames(const vtkSPHParticles* particles, bool isUsable)
{
  const auto nameFor = [particles](mcor_role role)
  { return particles ? particles->NameFor(role) : std::string(); };
  this->UsedSmoothingLengthArrayName = nameFor(MCOR_ROLE_SMOOTHING_LENGTH);
  this->UsedVolumeArrayName = nameFor(MCOR_ROLE_VOLUME);
  this->UsedVolume =
    particles && isUsable ? vtkSPHTakeText(mcor_describe_volume(&particles->Core)) : std::string();
  this->UsedMassArrayName = nameFor(MCOR_ROLE_MASS);
  this->UsedDensityArrayName = nameFor(MCOR_ROLE_DENSITY);
  this->UsedFluid = particles ? particles->DescribeFluid() : "";
}

void vtkSPHAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkSPHPrintMacro(SmoothingLengthArrayName, SmoothingLength, EstimateSmoothingLength,
    SmoothingLengthEstimate, NeighborRatio, SmoothingLengthIsSupportRadius, VolumeArrayName,
    MassArrayName, DensityArrayName, Mass, Density, ParticleVolume, ComputeVolumes, DetectArrays, PeriodicBounds,
    DetectPeriod, UsedSmoothingLengthArrayName, UsedVolume, UsedVolumeArrayName, UsedMassArrayName,
    UsedDensityArrayName, HScaleFactor, Dimension, FluidArrayName, FluidValue, DetectFluid,
    UsedFluid, IgnoreSolids, Within, Precision, Device, DeviceMemoryLimit, KeepDeviceData,
    Controller, ErrorMessage);
  os << indent << "Kernel: " << this->GetKernelName() << "\n"
     << indent << "Blocks: " << (this->Blocks == APART ? "apart" : "together") << "\n";
  for (const vtkSPHOnly& only : this->Only)
  {
    os << indent << "Only: " << only.Name << " " << only.Low << " " << only.High << "\n";
  }
  for (const std::string& name : this->ExcludedArrays)
  {
    os << indent << "Excluded Array: " << name << "\n";
  }
}
VTK_ABI_NAMESPACE_END
