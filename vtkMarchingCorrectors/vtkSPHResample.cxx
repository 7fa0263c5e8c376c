// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHResample.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSPHParticles.h"
#include "vtkSPHShapes.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#if MCOR_HAS_RANKS
#include "vtkSPHRanks.h"
#include "vtkSPHRanksParticles.h"
#endif

#include <algorithm>
#include <cmath>
#include <limits>

namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;

/** A share of the longest side of the fluid's box, added around it: the fluid ends somewhat beyond its particles. */
constexpr double Margin = 0.03;

/** The fluid's particles are within; infinite the wrong way where there are none. */
void FindEnds(const vtkSPHParticlesChoice& choice, vtkPointSet* particles, double ends[6])
{
  const double none = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    ends[2 * a] = none;
    ends[2 * a + 1] = -none;
  }
  vtkDataArray* fluid = particles->GetPointData()->GetArray(choice.FluidArrayName.c_str());
  for (vtkIdType i = 0; i < particles->GetNumberOfPoints(); ++i)
  {
    double x[3];
    particles->GetPoint(i, x);
    const bool counts = (!fluid || fluid->GetComponent(i, 0) == choice.FluidValue) &&
      std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
    for (int a = 0; counts && a < 3; ++a)
    {
      ends[2 * a] = std::min(ends[2 * a], x[a]);
      ends[2 * a + 1] = std::max(ends[2 * a + 1], x[a]);
    }
  }
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

// Origin and spacing depend on the particles, and come with the data.
int vtkSPHResample::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkInformation* info = outputVector->GetInformationObject(0);
  if (this->Shape == VOLUME)
  {
    const int* d = this->Dimensions;
    info->Set(Pipeline::WHOLE_EXTENT(), 0, d[0] - 1, 0, d[1] - 1, 0, d[2] - 1);
    info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  }
  else
  {
    info->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  }
  return 1;
}

int vtkSPHResample::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* info = outputVector->GetInformationObject(0);
  const int* d = this->Dimensions;
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

// False where no particle is fluid.
bool vtkSPHResample::FindBounds(double bounds[6])
{
  vtkSPHParticlesChoice choice(*this);
  double ends[6];
#if MCOR_HAS_RANKS
  if (this->IsShared())
  {
    vtkSPHRanks ranks(this->Controller);
    const vtkSmartPointer<vtkPolyData> own = vtkSPHTakeParticles(ranks, this->Particles);
    this->FindFluid(choice, own, ranks.MergeRanges());
    FindEnds(choice, own, ends);
    ranks.ReduceRanges(ends, 3);
  }
  else
#endif
  {
    this->FindFluid(choice, this->Particles);
    FindEnds(choice, this->Particles, ends);
  }
  double longest = 0.0;
  for (int a = 0; a < 3; ++a)
  {
    longest = std::max(longest, ends[2 * a + 1] - ends[2 * a]);
  }
  for (int a = 0; a < 3; ++a)
  {
    bounds[2 * a] = ends[2 * a] - Margin * longest;
    bounds[2 * a + 1] = ends[2 * a + 1] + Margin * longest;
  }
  return std::isfinite(ends[0]);
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
      spacing[a] = (box[2 * a + 1] - box[2 * a]) / std::max(this->Dimensions[a] - 1, 1);
    }
    image->SetOrigin(box[0], box[2], box[4]);
    image->SetSpacing(spacing);
    image->SetExtent(this->UpdateExtent);
    return image;
  }
  auto made = vtkSmartPointer<vtkPolyData>::New();
  if (this->HasPoints && this->Shape == SLICE)
  {
    vtkSPHMakeSlice(
      b, this->FitBounds ? middle : this->Origin, this->Normal, this->Resolution, made);
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
