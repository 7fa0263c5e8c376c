// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHResample.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSPHShapes.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;

/**
 * Margin around the fluid's box, as a share of its longest side: the fluid ends somewhat beyond
 * its particles.
 */
constexpr double Margin = 0.03;

/** Points of a volume whose dimensions are not set. */
constexpr double UsualPoints = 1e6;

/** Returns the axis along which the fluid is flat, or -1. */
int FindFlatAxis(const double bounds[6])
{
  int axis = -1, count = 0;
  for (int a = 0; a < 3; ++a)
  {
    const bool flat = bounds[2 * a] == bounds[2 * a + 1];
    axis = flat ? a : axis;
    count += flat ? 1 : 0;
  }
  return count == 1 ? axis : -1;
}
}

vtkStandardNewMacro(vtkSPHResample);

vtkSPHResample::vtkSPHResample()
{
  this->SetNumberOfInputPorts(1);
  this->NaNOutside = 1;
}

vtkSPHResample::~vtkSPHResample() = default;

const char* vtkSPHResample::GetOutputClassName(const char*)
{
  return this->Shape == VOLUME ? "vtkImageData" : "vtkPolyData";
}

// Origin and spacing depend on the particles, and come with the data. Dimensions that follow the
// shape of the fluid are those of the particles as they are now.
int vtkSPHResample::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* info = outputVector->GetInformationObject(0);
  if (this->Shape == VOLUME)
  {
    int* d = this->UsedDimensions;
    std::copy_n(this->Dimensions, 3, d);
    if (std::min({ d[0], d[1], d[2] }) == 0)
    {
      this->ChooseDimensions(vtkDataObject::GetData(inputVector[0]));
    }
    info->Set(Pipeline::WHOLE_EXTENT(), 0, d[0] - 1, 0, d[1] - 1, 0, d[2] - 1);
    info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  }
  else
  {
    info->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  }
  return 1;
}

// Makes cells that are about cubes; one layer if the fluid is flat.
void vtkSPHResample::ChooseDimensions(vtkDataObject* data)
{
  double bounds[6];
  std::copy_n(this->Bounds, 6, bounds);
  if (this->FitBounds)
  {
    auto* points = vtkPointSet::SafeDownCast(data);
    if (!this->IsShared() && points && points->GetNumberOfPoints() == 0)
    {
      this->GetInputAlgorithm(0, 0)->Update(); // not read so far
    }
    this->Particles = this->TakeParticles(data);
    const bool isFound = (this->Particles || this->IsShared()) && this->FindBounds(bounds);
    this->Particles = nullptr;
    std::fill_n(bounds, isFound ? 0 : 6, 0.0);
  }
  double product = 1.0;
  int axes = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double length = bounds[2 * a + 1] - bounds[2 * a];
    product *= length > 0.0 ? length : 1.0;
    axes += length > 0.0 ? 1 : 0;
  }
  const double spacing = std::pow(product / UsualPoints, 1.0 / std::max(axes, 1));
  for (int a = 0; a < 3; ++a)
  {
    const double count = (bounds[2 * a + 1] - bounds[2 * a]) / spacing;
    const int fitting = count > 0.0 ? static_cast<int>(std::min(count, UsualPoints)) + 2 : 1;
    this->UsedDimensions[a] = this->Dimensions[a] > 0 ? this->Dimensions[a] : fitting;
  }
}

int vtkSPHResample::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* info = outputVector->GetInformationObject(0);
  const int* d = this->UsedDimensions;
  const int whole[6] = { 0, d[0] - 1, 0, d[1] - 1, 0, d[2] - 1 };
  std::copy(whole, whole + 6, this->UpdateExtent);
  if (this->Shape == VOLUME && info->Has(Pipeline::UPDATE_EXTENT()))
  {
    info->Get(Pipeline::UPDATE_EXTENT(), this->UpdateExtent);
  }
  this->HasPoints = this->IsShared() ? this->Controller->GetLocalProcessId() == 0
                                     : !info->Has(Pipeline::UPDATE_PIECE_NUMBER()) ||
      info->Get(Pipeline::UPDATE_PIECE_NUMBER()) <= 0;
  const int done = this->vtkSPHAlgorithm::RequestData(request, inputVector, outputVector);
  this->Particles = nullptr;
  return done;
}

// Finds the fluid's box with a margin, but without one along the axis of a plane. Returns false if
// no particle is fluid.
bool vtkSPHResample::FindBounds(double bounds[6])
{
  if (!this->FindFluidBounds(this->Particles, bounds))
  {
    return false;
  }
  this->FlatAxis = this->Dimension == DIMENSION_3 ? -1 : FindFlatAxis(bounds);
  const double longest =
    std::max({ bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4] });
  for (int a = 0; a < 3; ++a)
  {
    const double margin = a == this->FlatAxis ? 0.0 : Margin * longest;
    bounds[2 * a] -= margin;
    bounds[2 * a + 1] += margin;
  }
  return true;
}

vtkSmartPointer<vtkDataSet> vtkSPHResample::MakePoints(const double b[6])
{
  const double middle[3] = { 0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.5 * (b[4] + b[5]) };
  if (this->Shape == VOLUME)
  {
    auto image = vtkSmartPointer<vtkImageData>::New();
    const double* box = this->FitBounds ? b : this->Bounds;
    double spacing[3];
    for (int a = 0; a < 3; ++a)
    {
      const double length = box[2 * a + 1] - box[2 * a];
      spacing[a] = length > 0.0 ? length / std::max(this->UsedDimensions[a] - 1, 1) : 1.0;
    }
    image->SetOrigin(box[0], box[2], box[4]);
    image->SetSpacing(spacing);
    image->SetExtent(this->UpdateExtent);
    return image;
  }
  auto made = vtkSmartPointer<vtkPolyData>::New();
  if (this->HasPoints && this->Shape == SLICE)
  {
    // A slice cuts a plane of particles in a line, unless it is that plane.
    const bool isFlat = this->FlatAxis >= 0;
    const double along[3] = { this->FlatAxis == 0 ? 1.0 : 0.0, this->FlatAxis == 1 ? 1.0 : 0.0,
      this->FlatAxis == 2 ? 1.0 : 0.0 };
    vtkSPHMakeSlice(b, isFlat || this->FitBounds ? middle : this->Origin,
      isFlat ? along : this->Normal, this->Resolution, made);
  }
  else if (this->HasPoints)
  {
    int longest = 0;
    for (int a = 1; a < 3; ++a)
    {
      longest = b[2 * a + 1] - b[2 * a] > b[2 * longest + 1] - b[2 * longest] ? a : longest;
    }
    double from[3], to[3];
    for (int a = 0; a < 3; ++a)
    {
      from[a] = !this->FitBounds ? this->Point1[a] : a == longest ? b[2 * a] : middle[a];
      to[a] = !this->FitBounds ? this->Point2[a] : a == longest ? b[2 * a + 1] : middle[a];
    }
    vtkSPHMakeLine(from, to, this->Resolution, made);
  }
  return made;
}

void vtkSPHResample::Process(vtkDataObject* data, vtkDataObject* output)
{
  this->Particles = vtkPointSet::SafeDownCast(data);
  double bounds[6];
  if (!this->Particles && !this->IsShared())
  {
    return;
  }
  if (!this->FindBounds(bounds))
  {
    this->Warn("No particle is fluid, so there is nothing to show.");
    return;
  }
  this->Superclass::Process(this->MakePoints(bounds), output);
  auto* slice = vtkPolyData::SafeDownCast(output);
  if (slice && this->Shape == SLICE && this->OnlyFluid)
  {
    vtkSPHCropSlice(slice, this->ValidPointMaskArrayName.c_str());
  }
}

void vtkSPHResample::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const char* const shapes[] = { "slice", "line", "volume" };
  os << indent << "Shape: " << shapes[this->Shape] << "\n";
  os << indent << "Fit Bounds: " << this->FitBounds << "\n";
  PrintNumbers(os, indent, "Origin", this->Origin, 3);
  PrintNumbers(os, indent, "Normal", this->Normal, 3);
  PrintNumbers(os, indent, "Point1", this->Point1, 3);
  PrintNumbers(os, indent, "Point2", this->Point2, 3);
  PrintNumbers(os, indent, "Bounds", this->Bounds, 6);
  os << indent << "Resolution: " << this->Resolution << "\n";
  os << indent << "Dimensions: " << this->Dimensions[0] << " " << this->Dimensions[1] << " "
     << this->Dimensions[2] << "\n";
  os << indent << "Only Fluid: " << this->OnlyFluid << "\n";
}
VTK_ABI_NAMESPACE_END
