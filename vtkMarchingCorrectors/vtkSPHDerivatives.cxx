// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHDerivatives.h"

#include "mcor.h"
#include "vtkDataSetAttributes.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSPHArrays.h"
#include "vtkSPHParticles.h"
#include "vtkUnsignedCharArray.h"

#include <cstdlib>
#include <vector>

namespace
{
/** One of the arrays made of the gradient of a vector. */
struct Quantity
{
  const char* Name;
  int Components;
  double* mcor_flow::*Values;
  bool Wanted;
};

/** Adds one to the point data. False if memory ran out. */
bool AddQuantity(
  const Quantity& quantity, const mcor_derivatives& derivatives, bool asFloat, vtkPointData* data)
{
  const auto values =
    static_cast<size_t>(derivatives.count) * static_cast<size_t>(quantity.Components);
  auto* made = static_cast<double*>(std::malloc(values * sizeof(double)));
  if (!made)
  {
    return false;
  }
  mcor_flow flow = {};
  flow.*quantity.Values = made;
  mcor_decompose_gradients(derivatives.gradients[0], derivatives.count, &flow);
  vtkSPHAddArray(
    data, quantity.Name, vtkSPHAdoptReal(made, quantity.Components, derivatives.count, asFloat));
  return true;
}
}

// What a run adds to the particles, as it was asked for when the run began.
struct vtkSPHDerivatives::vtkWanted
{
  std::vector<Quantity> Quantities;
  bool Gradient;
  std::string GradientName;

  /** False if memory ran out. */
  bool AddTo(vtkPointData* data, mcor_derivatives& derivatives, const vtkSPHAttribute& from) const
  {
    const bool asFloat = from.Array->GetDataType() == VTK_FLOAT;
    for (const Quantity& quantity : this->Quantities)
    {
      if (quantity.Wanted && from.Components == 3 &&
        !AddQuantity(quantity, derivatives, asFloat, data))
      {
        return false;
      }
    }
    if (this->Gradient)
    {
      vtkSPHAddArray(data, this->GradientName.c_str(),
        vtkSPHAdoptReal(derivatives.gradients[0], 3 * from.Components, derivatives.count, asFloat));
    }
    vtkSPHAddArray(data, (this->GradientName + "Corrected").c_str(),
      vtkSPHAdopt<vtkUnsignedCharArray>(derivatives.corrected, 1, derivatives.count));
    return true;
  }
};

//------------------------------------------------------------------------------
vtkStandardNewMacro(vtkSPHDerivatives);

//------------------------------------------------------------------------------
vtkSPHDerivatives::vtkSPHDerivatives()
{
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
}

vtkSPHDerivatives::~vtkSPHDerivatives() = default;

//------------------------------------------------------------------------------
const char* vtkSPHDerivatives::GetOutputClassName(const char* inputClassName)
{
  return inputClassName;
}

//------------------------------------------------------------------------------
vtkSPHDerivatives::vtkWanted vtkSPHDerivatives::ListWanted() const
{
  return { { { "Divergence", 1, &mcor_flow::divergence, this->ComputeDivergence != 0 },
             { "Vorticity", 3, &mcor_flow::vorticity, this->ComputeVorticity != 0 },
             { "Q-criterion", 1, &mcor_flow::q_criterion, this->ComputeQCriterion != 0 },
             { "Lambda2", 1, &mcor_flow::lambda2, this->ComputeLambda2 != 0 },
             { "StrainRate", 9, &mcor_flow::strain_rate, this->ComputeStrainRate != 0 } },
    this->ComputeGradient != 0, this->ResultArrayName };
}

//------------------------------------------------------------------------------
void vtkSPHDerivatives::Process(vtkDataObject* data, vtkDataObject* output)
{
  auto* particles = vtkPointSet::SafeDownCast(data);
  this->SetUsedNames(nullptr);
  if (data && !particles)
  {
    this->Warn(std::string("A ") + data->GetClassName() +
      " has no points of its own, and so no derivatives.");
    return;
  }
  if (!particles || this->IsAborted())
  {
    return;
  }
  if (particles->GetNumberOfPoints() == 0)
  {
    output->ShallowCopy(particles);
    return;
  }
  vtkSPHParticlesChoice choice;
  this->FillChoice(choice);
  vtkSPHParticles input(choice, particles);
  const bool usable =
    input.CollectArray(this->FindRequest(0, particles)) && input.CollectParticles();
  this->SetUsedNames(&input);
  if (!usable)
  {
    this->Fail(input.Error);
  }
  else if (input.FluidCount == 0)
  {
    this->WarnOfNoFluid(choice, "there are no derivatives");
    output->ShallowCopy(particles);
  }
  else
  {
    this->Derive(input, particles, vtkPointSet::SafeDownCast(output));
  }
}

//------------------------------------------------------------------------------
// What an observer of the progress may change is read before the run.
void vtkSPHDerivatives::Derive(vtkSPHParticles& input, vtkPointSet* particles, vtkPointSet* output)
{
  const vtkWanted wanted = this->ListWanted();
  const mcor_gradient form =
    this->CorrectGradients ? MCOR_GRADIENT_CORRECTED : MCOR_GRADIENT_STANDARD;
  mcor_options options;
  this->FillOptions(options);
  mcor_derivatives derivatives = {};
  if (!this->CallCore(input, options,
        [&](mcor_context* context)
        { return mcor_derive(context, &input.Core, &options, form, &derivatives); }))
  {
    return;
  }
  vtkSPHAddRunStatistics(this->RunStatistics, derivatives.statistics);
  const vtkSPHAttribute& array = input.Interpolated[0];
  if (derivatives.attribute_not_finite[0] >= 0)
  {
    this->Fail("The point array '" + array.Name + "' is NaN or infinite at particle " +
      std::to_string(derivatives.attribute_not_finite[0]) +
      ", so that its gradients are not defined around. Correct its values.");
  }
  else
  {
    output->ShallowCopy(particles);
    if (!wanted.AddTo(output->GetPointData(), derivatives, array))
    {
      output->Initialize();
      this->Fail("Host memory for the derivatives of " + std::to_string(derivatives.count) +
        " particles could not be allocated.");
    }
  }
  mcor_free_derivatives(&derivatives);
}

//------------------------------------------------------------------------------
void vtkSPHDerivatives::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Correct Gradients: " << this->CorrectGradients << "\n";
  os << indent << "Compute Gradient: " << this->ComputeGradient << "\n";
  os << indent << "Result Array Name: " << this->ResultArrayName << "\n";
  os << indent << "Compute Divergence: " << this->ComputeDivergence << "\n";
  os << indent << "Compute Vorticity: " << this->ComputeVorticity << "\n";
  os << indent << "Compute Q Criterion: " << this->ComputeQCriterion << "\n";
  os << indent << "Compute Lambda2: " << this->ComputeLambda2 << "\n";
  os << indent << "Compute Strain Rate: " << this->ComputeStrainRate << "\n";
}
