// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHDerivatives.h"

#include "mcor.h"
#include "vtkDataSetAttributes.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSPHArrays.h"
#include "vtkSPHDerivativesWanted.h"
#include "vtkSPHParticles.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** Returns gradients of vectors of two components, in a plane, as gradients of vectors in space. */
std::vector<double> InSpace(const mcor_derivatives& derivatives)
{
  const double* extent = derivatives.statistics.fluid_extent;
  const size_t normal = extent[2] == 0.0 ? 2 : extent[1] == 0.0 ? 1 : 0;
  const size_t axes[2] = { normal == 0 ? 1U : 0U, normal == 2 ? 1U : 2U };
  std::vector<double> gradients(9 * static_cast<size_t>(derivatives.count));
  for (size_t i = 0; i < static_cast<size_t>(derivatives.count); ++i)
  {
    for (size_t c = 0; c < 2; ++c)
    {
      std::copy_n(
        derivatives.gradients[0] + 6 * i + 3 * c, 3, gradients.data() + 9 * i + 3 * axes[c]);
    }
  }
  return gradients;
}
}

bool vtkSPHDerivatives::vtkWanted::Quantity::AddTo(vtkPointData* data,
  const mcor_derivatives& derivatives, const double* gradients, bool asFloat) const
{
  const auto values =
    static_cast<size_t>(derivatives.count) * static_cast<size_t>(this->Components);
  auto* made = static_cast<double*>(std::malloc((values + 1) * sizeof(double)));
  if (!made)
  {
    return false;
  }
  mcor_flow flow = {};
  flow.*this->Values = made;
  mcor_decompose_gradients(gradients, derivatives.count, &flow);
  vtkSPHAddArray(
    data, this->Name.c_str(), vtkSPHAdoptReal(made, this->Components, derivatives.count, asFloat));
  std::free(made); // where there are no particles
  return true;
}

bool vtkSPHDerivatives::vtkWanted::AddTo(
  vtkPointData* data, mcor_derivatives& derivatives, const vtkSPHAttribute& from) const
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
    if (quantity.IsWanted && exists && from.Components == (inSpace.empty() ? 3 : 2) &&
      !quantity.AddTo(data, derivatives, gradients, asFloat))
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
    vtkSPHAdopt(derivatives.corrected, 1, derivatives.count));
  for (const Quantity& quantity : this->Quantities)
  {
    if (quantity.Values == &mcor_flow::vorticity && quantity.IsWanted && from.Components == 3)
    {
      data->SetActiveScalars(quantity.Name.c_str()); // the array that most users want to see
    }
  }
  return true;
}

std::string vtkSPHDerivatives::vtkWanted::DescribeNoMemory(vtkIdType particles)
{
  return "Host memory for the derivatives of " + std::to_string(particles) +
    " particles could not be allocated.";
}

vtkStandardNewMacro(vtkSPHDerivatives);

vtkSPHDerivatives::vtkSPHDerivatives()
{
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
}

vtkSPHDerivatives::~vtkSPHDerivatives() = default;

const char* vtkSPHDerivatives::GetOutputClassName(const char* inputClassName)
{
  return inputClassName;
}

// A file may have another array of that name: made with another kernel, or by the solver.
std::string vtkSPHDerivatives::NameResult(const std::string& name, vtkPointSet* particles) const
{
  std::string free = name;
  while (!this->ReplaceArrays && particles->GetPointData()->HasArray(free.c_str()))
  {
    free += "_SPH";
  }
  return free;
}

vtkSPHDerivatives::vtkWanted vtkSPHDerivatives::ListWanted(vtkPointSet* particles) const
{
  const auto name = [&](const char* usual) { return this->NameResult(usual, particles); };
  return { { { name("Divergence"), 1, &mcor_flow::divergence, this->ComputeDivergence != 0 },
             { name("Vorticity"), 3, &mcor_flow::vorticity, this->ComputeVorticity != 0 },
             { name("Q-criterion"), 1, &mcor_flow::q_criterion, this->ComputeQCriterion != 0 },
             { name("Lambda2"), 1, &mcor_flow::lambda2, this->ComputeLambda2 != 0 },
             { name("StrainRate"), 9, &mcor_flow::strain_rate, this->ComputeStrainRate != 0 } },
    this->ComputeGradient != 0, name(this->ResultArrayName.c_str()) };
}

void vtkSPHDerivatives::Process(vtkDataObject* data, vtkDataObject* output)
{
  auto* particles = vtkPointSet::SafeDownCast(data);
  this->SetUsedNames(nullptr);
#if MCOR_HAS_RANKS
  if (this->IsShared())
  {
    this->ProcessDistributed(particles, vtkPointSet::SafeDownCast(output));
    return;
  }
#endif
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
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, particles);
  vtkSPHParticles input(choice, particles);
  const bool isUsable =
    input.CollectArray(this->FindFirstRequest(particles)) && input.CollectParticles();
  if (!this->Accept(input, isUsable, "there are no derivatives"))
  {
    return;
  }
  if (input.FluidCount == 0)
  {
    output->ShallowCopy(particles);
    return;
  }
  this->Derive(input, particles, vtkPointSet::SafeDownCast(output));
}

// Reads first what an observer of the progress may change during the run.
void vtkSPHDerivatives::Derive(vtkSPHParticles& input, vtkPointSet* particles, vtkPointSet* output)
{
  const vtkWanted wanted = this->ListWanted(particles);
  const mcor_gradient form =
    this->CorrectGradients ? MCOR_GRADIENT_CORRECTED : MCOR_GRADIENT_STANDARD;
  mcor_options options;
  this->FillOptions(options);
  if (!this->SetPeriod(particles, options))
  {
    return;
  }
  mcor_derivatives derivatives = {};
  if (!this->CallCore(input, options,
        [&](mcor_context* context)
        { return mcor_derive(context, &input.Core, &options, form, &derivatives); }))
  {
    return;
  }
  vtkSPHAddRunStatistics(this->RunStatistics, derivatives.statistics);
  this->WarnOfParticles(input.Core, options, derivatives.statistics);
  const vtkSPHAttribute& array = input.Interpolated[0];
  if (derivatives.attribute_not_finite[0] >= 0)
  {
    this->FailNotFinite(array.Name, derivatives.attribute_not_finite[0]);
  }
  else
  {
    output->ShallowCopy(particles);
    if (!wanted.AddTo(output->GetPointData(), derivatives, array))
    {
      output->Initialize();
      this->Fail(vtkWanted::DescribeNoMemory(derivatives.count));
    }
  }
  mcor_free_derivatives(&derivatives);
}

void vtkSPHDerivatives::FailNotFinite(const std::string& array, vtkIdType particle)
{
  this->Fail("The point array '" + array + "' is NaN or infinite at particle " +
    std::to_string(particle) +
    ", so its gradients are undefined there. Correct its values, or choose another array.");
}

void vtkSPHDerivatives::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Correct Gradients: " << this->CorrectGradients << "\n";
  os << indent << "Compute Gradient: " << this->ComputeGradient << "\n";
  os << indent << "Result Array Name: " << this->ResultArrayName << "\n";
  os << indent << "Replace Arrays: " << this->ReplaceArrays << "\n";
  os << indent << "Compute Divergence: " << this->ComputeDivergence << "\n";
  os << indent << "Compute Vorticity: " << this->ComputeVorticity << "\n";
  os << indent << "Compute Q Criterion: " << this->ComputeQCriterion << "\n";
  os << indent << "Compute Lambda2: " << this->ComputeLambda2 << "\n";
  os << indent << "Compute Strain Rate: " << this->ComputeStrainRate << "\n";
}
VTK_ABI_NAMESPACE_END
