// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHProjection.h"

#include "mcor.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSPHArrays.h"
#include "vtkSPHParticles.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <memory>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;

/** The axis of the world along which the image's axis k goes; -1 where they are turned. */
int AxisOf(const mcor_projection& found, int k)
{
  const double* axis = found.axes + 3 * k;
  const auto one = std::find(axis, axis + 3, 1.0);
  return one < axis + 3 ? static_cast<int>(one - axis) : -1;
}

/** Along x, y and z of the image. */
void FindExtent(const mcor_projection& found, int extent[6])
{
  for (int k = 0; k < 3; ++k)
  {
    const int axis = AxisOf(found, 2) < 0 ? k : AxisOf(found, k);
    extent[2 * axis] = 0;
    extent[2 * axis + 1] = k < 2 ? found.size[k] - 1 : 0;
  }
}
}

vtkStandardNewMacro(vtkSPHProjection);

vtkSPHProjection::vtkSPHProjection() = default;
vtkSPHProjection::~vtkSPHProjection() = default;

vtkImageData* vtkSPHProjection::GetImage()
{
  return vtkImageData::SafeDownCast(this->GetOutputDataObject(0));
}

const char* vtkSPHProjection::GetOutputClassName(const char*)
{
  return "vtkImageData";
}

mcor_view vtkSPHProjection::MakeView() const
{
  mcor_view view = {};
  std::copy_n(this->Direction, 3, view.direction);
  std::copy_n(this->Box, this->UseBox ? 6 : 0, view.box);
  view.resolution = this->Resolution;
  return view;
}

// Origin and spacing come with the data.
int vtkSPHProjection::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* info = outputVector->GetInformationObject(0);
  vtkDataObject* data = vtkDataObject::GetData(inputVector[0]);
  auto* points = vtkPointSet::SafeDownCast(data);
  if (!this->IsShared() && points && points->GetNumberOfPoints() == 0)
  {
    this->GetInputAlgorithm(0, 0)->Update(); // not read so far
  }
  const vtkSmartPointer<vtkPointSet> particles = this->TakeParticles(data);
  mcor_projection placed = {};
#if MCOR_HAS_RANKS
  if (this->IsShared())
  {
    this->PlaceDistributed(particles, placed);
  }
  else
#endif
  {
    this->Place(particles, placed);
  }
  int extent[6] = { 0, 0, 0, 0, 0, 0 };
  if (placed.size[0] > 0)
  {
    FindExtent(placed, extent);
  }
  info->Set(Pipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  return 1;
}

// Finds the image without values. Errors are left to the run.
void vtkSPHProjection::Place(vtkPointSet* particles, mcor_projection& placed)
{
  if (!particles || particles->GetNumberOfPoints() == 0)
  {
    return;
  }
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, particles);
  vtkSPHParticles input(choice, particles);
  mcor_options options;
  this->FillOptions(options);
  const mcor_view view = this->MakeView();
  std::string message;
  if (input.CollectParticles() && this->SetPeriod(particles, options))
  {
    this->RunCore(
      input, options,
      [&](mcor_context* context)
      { return mcor_place_view(context, &input.Core, &options, &view, &placed); },
      message, 0, 1);
  }
}

int vtkSPHProjection::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* info = outputVector->GetInformationObject(0);
  const int none[6] = { 0, -1, 0, -1, 0, -1 };
  std::copy_n(none, 6, this->UpdateExtent);
  if (info->Has(Pipeline::UPDATE_EXTENT()))
  {
    info->Get(Pipeline::UPDATE_EXTENT(), this->UpdateExtent);
  }
  return this->Superclass::RequestData(request, inputVector, outputVector);
}

bool vtkSPHProjection::Collect(vtkSPHParticles& particles, vtkPointSet* points, mcor_view& view)
{
  vtkSPHRequest scalar = this->FindRequest(0, points);
  if (!this->ScalarArrayName.empty() && this->ScalarArrayName != "(density)")
  {
    scalar = { points->GetPointData()->GetAbstractArray(this->ScalarArrayName.c_str()),
      this->ScalarArrayName, true };
  }
  return particles.CollectProjection(
    scalar, this->ScalarComponent, this->WeightArrayName, view.weight);
}

void vtkSPHProjection::Process(vtkDataObject* data, vtkDataObject* output)
{
  auto* particles = vtkPointSet::SafeDownCast(data);
  auto* image = vtkImageData::SafeDownCast(output);
  this->SetUsedNames(nullptr);
#if MCOR_HAS_RANKS
  if (this->IsShared())
  {
    this->ProcessDistributed(particles, image);
    return;
  }
#endif
  if (!particles || particles->GetNumberOfPoints() == 0 || this->IsAborted())
  {
    return;
  }
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, particles);
  vtkSPHParticles input(choice, particles);
  mcor_view view = this->MakeView();
  mcor_options options;
  this->FillOptions(options);
  if (!this->Accept(input, this->Collect(input, particles, view), "nothing is seen") ||
    !this->SetPeriod(particles, options))
  {
    return;
  }
  mcor_projection found = {};
  const std::unique_ptr<mcor_projection, decltype(&mcor_free_projection)> freeFound(
    &found, mcor_free_projection);
  if (this->CallCore(input, options,
        [&](mcor_context* context)
        { return mcor_project(context, &input.Core, &options, &view, &found); }))
  {
    vtkSPHAddRunStatistics(this->RunStatistics, found.statistics);
    this->WarnOfParticles(input.Core, options, found.statistics);
    this->Fill(image, input.Core.scalar.data ? input.Interpolated[0].Name : "ColumnDensity", found);
  }
}

void vtkSPHProjection::Fill(vtkImageData* image, const std::string& name, mcor_projection& found)
{
  if (found.size[0] == 0)
  {
    return;
  }
  int extent[6];
  FindExtent(found, extent);
  double origin[3] = { 0.0, 0.0, 0.0 };
  double spacing[3] = { 1.0, 1.0, 1.0 };
  const double thickness = std::min(found.pixel[0], found.pixel[1]);
  for (int k = 0; k < 3; ++k)
  {
    const bool isTurned = AxisOf(found, 2) < 0;
    const double at = found.low[k] + (k < 2 ? 0.5 * found.pixel[k] : 0.0);
    spacing[isTurned ? k : AxisOf(found, k)] = k < 2 ? found.pixel[k] : thickness;
    for (int a = 0; a < 3; ++a)
    {
      origin[a] += at * found.axes[3 * k + a];
    }
  }
  if (AxisOf(found, 2) < 0)
  {
    const double* e = found.axes;
    image->SetDirectionMatrix(e[0], e[3], e[6], e[1], e[4], e[7], e[2], e[5], e[8]);
  }
  image->SetExtent(extent);
  image->SetOrigin(origin);
  image->SetSpacing(spacing);
  vtkSPHAddArray(
    image->GetPointData(), name.c_str(), vtkSPHAdopt(found.values, 1, image->GetNumberOfPoints()));
  image->GetPointData()->SetActiveScalars(name.c_str());
  if (this->UpdateExtent[0] <= this->UpdateExtent[1])
  {
    image->Crop(this->UpdateExtent);
  }
}

void vtkSPHProjection::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  PrintNumbers(os, indent, "Direction", this->Direction, 3);
  os << indent << "Resolution: " << this->Resolution << "\n";
  os << indent << "Use Box: " << this->UseBox << "\n";
  PrintNumbers(os, indent, "Box", this->Box, 6);
  os << indent << "Weight Array Name: " << this->WeightArrayName << "\n";
  os << indent << "Scalar Array Name: " << this->ScalarArrayName << "\n";
  os << indent << "Scalar Component: " << this->ScalarComponent << "\n";
}
VTK_ABI_NAMESPACE_END
