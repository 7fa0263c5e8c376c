// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHProjection.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkSPHArrays.h"
#include "vtkSPHPrint.h"
#include "vtkSPHRun.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <limits>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;

/** Returns the axis of the world along which the image's axis k goes, or -1 if the image is turned. */
int AxisOf(const mcor_projection& found, int k)
{
  const double* axis = found.axes + 3 * k;
  const auto one = std::find(axis, axis + 3, 1.0);
  return one < axis + 3 ? static_cast<int>(one - axis) : -1;
}

/** Finds the extent along x, y and z of the image. */
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

vtkImageData* vtkSPHProjection::GetImage()
{
  return vtkImageData::SafeDownCast(this->GetOutputDataObject(0));
}

mcor_view vtkSPHProjection::MakeView() const
{
  mcor_view view = {};
  std::copy_n(this->Direction, 3, view.direction);
  std::copy_n(this->Box, this->UseBox ? 6 : 0, view.box);
  if (this->UseBox && std::count(view.box, view.box + 6, 0.0) == 6) // zeros would mean "no box"
  {
    view.box[0] = -std::numeric_limits<double>::denorm_min();
  }
  view.resolution = this->Resolution;
  return view;
}

// Tells the extent of the image; origin and spacing come with the data. Does not report errors, because
// Process() will report them.
int vtkSPHProjection::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* info = outputVector->GetInformationObject(0);
  const vtkSmartPointer<vtkPointSet> particles =
    this->TakeParticlesAhead(vtkDataObject::GetData(inputVector[0]));
  int extent[6] = { 0, 0, 0, 0, 0, 0 };
  const std::unique_ptr<vtkRun> run = vtkRun::Make(this);
  run->IsQuiet = true;
  if (run->Begin(particles) && run->Particles > 0)
  {
    vtkSPHParticles mine(run->Choose(), run->Own);
    mcor_projection placed = {};
    this->FillOptions(run->Options);
    const mcor_view view = this->MakeView();
    if (run->Agree(mine.Collect() ? "" : mine.Error) && run->MeasureLengths(mine))
    {
      run->Call(mine,
        [&](mcor_context* context)
        { return mcor_place_view(context, &mine.Core, &run->Options, &view, &placed); });
    }
    if (placed.size[0] > 0)
    {
      FindExtent(placed, extent);
    }
  }
  info->Set(Pipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  return 1;
}

// Sums are exact, so each process projects its own particles, and the core adds up the images. If
// volumes must be computed, particles first go to the processes that own their places.
void vtkSPHProjection::Process(vtkDataObject* data, vtkDataObject* output)
{
  const std::unique_ptr<vtkRun> run = vtkRun::Make(this);
  this->SetUsedNames(nullptr);
  if (!run->Begin(vtkPointSet::SafeDownCast(data)) || run->Particles == 0)
  {
    return;
  }
  mcor_view view = this->MakeView();
  this->FillOptions(run->Options);
  vtkSPHWanted wanted;
  wanted.Wants |= MCOR_WANT_COLUMN;
  wanted.Scalar = this->FindRequest(0, run->Own);
  if (!this->ScalarArrayName.empty() && this->ScalarArrayName != "(density)")
  {
    vtkPointData* arrays = run->Own->GetPointData();
    wanted.Scalar = { arrays->GetAbstractArray(this->ScalarArrayName.c_str()),
      this->ScalarArrayName, true };
  }
  wanted.ScalarComponent = this->ScalarComponent;
  wanted.Weight = this->WeightArrayName;
  vtkSPHParticles mine(run->Choose(), run->Own, wanted);
  if (!run->Accept(mine, "nothing is seen"))
  {
    return;
  }
  view.weight = mine.Found.views[MCOR_ROLE_WEIGHT];
  const bool needsVolumes =
    mine.Core.scalar.data || view.weight.data || !mcor_is_given(&mine.Core.mass);
  const bool computes =
    run->IsShared() && needsVolumes && run->HasFluid && vtkSPHComputesVolumes(mine.Core);
  if (!(computes ? run->Measure(mine, true) : run->MeasureLengths(mine)))
  {
    return;
  }
  const std::string name = mine.Core.scalar.data ? mine.NameFor(MCOR_ROLE_SCALAR) : "ColumnDensity";
  vtkSPHParticles* input = &mine;
  if (computes)
  {
    input = run->Share(mine);
    view.counted = run->MarkOwned();
    view.weight = input ? input->Found.views[MCOR_ROLE_WEIGHT] : view.weight;
  }
  vtkSPHOwned<mcor_projection, mcor_free_projection> found;
  if (input &&
    run->Call(*input,
      [&](mcor_context* context)
      { return mcor_project(context, &input->Core, &run->Options, &view, &found); }))
  {
    vtkSPHAddRunStatistics(this->RunStatistics, found.statistics);
    run->WarnOfParticles(input->Core, found.statistics);
    this->Fill(vtkImageData::SafeDownCast(output), name, found);
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
  const int* asked = this->GetOutputInformation(0)->Get(Pipeline::UPDATE_EXTENT());
  if (asked && asked[0] <= asked[1])
  {
    image->Crop(asked);
  }
}

void vtkSPHProjection::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkSPHPrintMacro(
    Direction, Resolution, UseBox, Box, WeightArrayName, ScalarArrayName, ScalarComponent);
}
VTK_ABI_NAMESPACE_END
