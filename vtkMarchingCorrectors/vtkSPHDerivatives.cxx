// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHDerivatives.h"

#include "vtkDataSetAttributes.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkSPHArrays.h"
#include "vtkSPHPrint.h"
#include "vtkSPHRun.h"
#include "vtkSPHSay.h"

#include <algorithm>
#include <cstdlib>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** Returns gradients of vectors with 2 components as gradients of vectors with 3. The component across the plane gets gradients of 0. */
std::vector<double> InSpace(const mcor_derivatives& derivatives)
{
  const double* extent = derivatives.statistics.fluid_extent;
  const int normal = extent[2] == 0.0 ? 2 : extent[1] == 0.0 ? 1 : 0;
  const int axes[2] = { normal == 0 ? 1 : 0, normal == 2 ? 1 : 2 };
  std::vector<double> gradients(9 * derivatives.count);
  for (std::int64_t i = 0; i < derivatives.count; ++i)
  {
    for (int c = 0; c < 2; ++c)
    {
      std::copy_n(
        derivatives.gradients[0] + 6 * i + 3 * c, 3, gradients.data() + 9 * i + 3 * axes[c]);
    }
  }
  return gradients;
}
}

/** The arrays that a run adds to the particles, by the settings at the beginning of the run. */
struct vtkSPHDerivatives::vtkWanted
{
  /** An array that is made of the gradient of a vector. */
  struct Quantity
  {
    std::string Name;
    int Components;
    double* mcor_flow::*Values;
    bool IsWanted;
  };

  /**
   * Adds the arrays of `derivatives`, made from the array `from`, and takes over their memory.
   * Returns false if memory ran out.
   */
  bool AddTo(vtkPointData* data, mcor_derivatives& derivatives, const vtkSPHAttribute& from) const
  {
    const bool asFloat = from.Array->GetDataType() == VTK_FLOAT;
    const bool isPlane = derivatives.statistics.dimension == 2;
    const std::vector<double> inSpace =
      isPlane && from.Components == 2 ? InSpace(derivatives) : std::vector<double>();
    const double* gradients = inSpace.empty() ? derivatives.gradients[0] : inSpace.data();
    for (const Quantity& quantity : this->Quantities)
    {
      const bool exists = // two dimensions have no middle eigenvalue
        !isPlane || quantity.Values != &mcor_flow::lambda2;
      if (!quantity.IsWanted || !exists || from.Components != (inSpace.empty() ? 3 : 2))
      {
        continue;
      }
      const std::int64_t values = derivatives.count * quantity.Components;
      auto* made = static_cast<double*>(std::malloc((values + 1) * sizeof(double)));
      if (!made)
      {
        return false;
      }
      mcor_flow flow = {};
      flow.*quantity.Values = made;
      mcor_decompose_gradients(gradients, derivatives.count, &flow);
      vtkSPHAddArray(data, quantity.Name.c_str(),
        vtkSPHAdoptReal(made, quantity.Components, derivatives.count, asFloat));
      std::free(made); // made is left only if there are no particles
      if (quantity.Values == &mcor_flow::vorticity && from.Components == 3)
      {
        data->SetActiveScalars(quantity.Name.c_str()); // most users want to see this array
      }
    }
    if (this->Gradient)
    {
      vtkSPHAddArray(data, this->GradientName.c_str(),
        vtkSPHAdoptReal(derivatives.gradients[0], 3 * from.Components, derivatives.count, asFloat));
    }
    vtkSPHAddArray(data, (this->GradientName + "Corrected").c_str(),
      vtkSPHAdopt(derivatives.corrected, 1, derivatives.count));
    return true;
  }

  std::vector<Quantity> Quantities;
  bool Gradient;
  std::string GradientName;
};

vtkStandardNewMacro(vtkSPHDerivatives);

vtkSPHDerivatives::vtkSPHDerivatives()
{
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
}

vtkSPHDerivatives::vtkWanted vtkSPHDerivatives::ListWanted(vtkPointSet* particles) const
{
  // Returns the name of a new array: another one if the particles have an array of this name.
  const auto name = [this, particles](std::string free)
  {
    while (!this->ReplaceArrays && particles->GetPointData()->HasArray(free.c_str()))
    {
      free += "_SPH";
    }
    return free;
  };
  return { { { name("Divergence"), 1, &mcor_flow::divergence, this->ComputeDivergence != 0 },
             { name("Vorticity"), 3, &mcor_flow::vorticity, this->ComputeVorticity != 0 },
             { name("Q-criterion"), 1, &mcor_flow::q_criterion, this->ComputeQCriterion != 0 },
             { name("Lambda2"), 1, &mcor_flow::lambda2, this->ComputeLambda2 != 0 },
             { name("StrainRate"), 9, &mcor_flow::strain_rate, this->ComputeStrainRate != 0 } },
    this->ComputeGradient != 0, name(this->ResultArrayName) };
}

// A progress observer may change this filter's settings, so they are copied first.
void vtkSPHDerivatives::Process(vtkDataObject* data, vtkDataObject* output)
{
  auto* particles = vtkPointSet::SafeDownCast(data);
  auto* derived = vtkPointSet::SafeDownCast(output);
  const std::unique_ptr<vtkRun> run = vtkRun::Make(this);
  this->SetUsedNames(nullptr);
  if (data && !particles && !run->IsShared())
  {
    this->Warn(vtkSPHSay(MCOR_SAY(NO_POINTS), data->GetClassName(), "derivatives"));
    return;
  }
  if (!run->Begin(particles))
  {
    return;
  }
  vtkSPHWanted sizesAndArray;
  sizesAndArray.Wants |= MCOR_WANT_ARRAY;
  sizesAndArray.Scalar = this->FindRequest(0, run->Own);
  const vtkSPHParticlesChoice choice = run->Choose(&sizesAndArray.Scalar);
  vtkSPHParticles mine(choice, run->Own, sizesAndArray);
  if (!run->Accept(mine, "there are no derivatives"))
  {
    return;
  }
  if (!run->HasFluid)
  {
    if (particles && derived)
    {
      derived->ShallowCopy(particles);
    }
    return;
  }
  const vtkWanted wanted = this->ListWanted(run->Own);
  const mcor_gradient form =
    this->CorrectGradients ? MCOR_GRADIENT_CORRECTED : MCOR_GRADIENT_STANDARD;
  this->FillOptions(run->Options);
  if (!run->Measure(mine, true))
  {
    return;
  }
  const std::string name = mine.Interpolated[0].Name;
  vtkSPHParticles* input = run->Share(mine);
  vtkSPHOwned<mcor_derivatives, mcor_free_derivatives> derivatives;
  if (!input ||
    !run->Call(*input,
      [&](mcor_context* context)
      { return mcor_derive(context, &input->Core, &run->Options, form, &derivatives); }))
  {
    return;
  }
  vtkSPHAddRunStatistics(this->RunStatistics, derivatives.statistics);
  vtkNew<vtkPointData> found;
  std::string problem;
  if (derivatives.attribute_not_finite && derivatives.attribute_not_finite[0] >= 0)
  {
    problem = "The point array '" + name + "' is NaN or infinite at particle " +
      std::to_string(derivatives.attribute_not_finite[0]) +
      ", so its gradients are undefined there. Correct its values, or choose another array.";
  }
  else if (!wanted.AddTo(found, derivatives, input->Interpolated[0]))
  {
    problem = "Host memory for the derivatives of " + std::to_string(derivatives.count) +
      " particles could not be allocated.";
  }
  run->WarnOfParticles(input->Core, derivatives.statistics);
  if (!run->Agree(problem))
  {
    return;
  }
  run->Return(found, particles);
  run->AddShares();
  if (particles && derived)
  {
    derived->ShallowCopy(particles);
    vtkSPHAddArrays(found, derived->GetPointData());
  }
}

void vtkSPHDerivatives::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkSPHPrintMacro(CorrectGradients, ComputeGradient, ResultArrayName, ReplaceArrays,
    ComputeDivergence, ComputeVorticity, ComputeQCriterion, ComputeLambda2, ComputeStrainRate);
}
VTK_ABI_NAMESPACE_END
