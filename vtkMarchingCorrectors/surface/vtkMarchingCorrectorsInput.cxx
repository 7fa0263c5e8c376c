// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMarchingCorrectorsInput.h"

#include "vtkPointData.h"
#include "vtkSPHArrays.h"

VTK_ABI_NAMESPACE_BEGIN
bool vtkMarchingCorrectorsInput::Collect()
{
  if ((!this->Choice.FreeSurface && !this->CollectScalar()) || !this->CollectParticles())
  {
    return false;
  }
  this->NameScalar();
  if (this->Choice.InterpolateAttributes)
  {
    std::vector<std::string> taken = this->Choice.ComputedArrays;
    if (this->Choice.ComputeScalars)
    {
      taken.push_back(this->IsoValueName);
    }
    this->CollectAttributes(taken);
  }
  vtkSPHSign(this->ScalarSignature, this->Scalar);
  vtkSPHSign(this->ScalarSignature, this->ScalarDot);
  this->ScalarSignature.push_back(static_cast<std::uint64_t>(this->Core.scalar_component));
  return true;
}

void vtkMarchingCorrectorsInput::TakeWidening(vtkDataArray* factors, vtkDataArray* volumes)
{
  vtkSPHSign(this->ParticlesSignature, factors);
  this->Interpolate(factors);
  this->Interpolated.pop_back();
  this->Core.widening = this->Core.attributes[this->Core.attribute_count - 1];
  if (volumes)
  {
    this->Core.volume = this->View(volumes);
    this->Core.volume.name = nullptr; // they were computed, and are told as such
  }
}

bool vtkMarchingCorrectorsInput::CollectScalar()
{
  const vtkSPHRequest &scalar = this->Choice.Scalar, &dot = this->Choice.ScalarDot;
  if (scalar.Name.empty() && !scalar.Array)
  {
    this->Error = "No scalar to contour was chosen: choose a point array, or turn the free surface "
                  "on. " +
      vtkSPHListNames(this->Points);
    return false;
  }
  if (!scalar.OnPoints || !dot.OnPoints)
  {
    this->Error = "The scalar " + Quote(scalar.OnPoints ? dot.Name : scalar.Name) +
      " is not a point array; SPH particles are points. " + vtkSPHListNames(this->Points);
    return false;
  }
  this->Scalar = this->Take("scalar", scalar.Name, scalar.Array, true);
  if (!this->Scalar)
  {
    return false;
  }
  const int components = this->Scalar->GetNumberOfComponents();
  const int component = this->Choice.ScalarComponent;
  if (!vtkSPHRealName(dot.Name).empty())
  {
    this->ScalarDot = this->Check("second vector of the dot product", dot.Name, dot.Array);
    if (this->ScalarDot && this->ScalarDot->GetNumberOfComponents() != components)
    {
      this->Error = "The dot product needs two arrays with the same number of components; " +
        Quote(vtkSPHNameOf(this->Scalar)) + " has " + std::to_string(components) + ", " +
        Quote(vtkSPHNameOf(this->ScalarDot)) + " has " +
        std::to_string(this->ScalarDot->GetNumberOfComponents()) + ".";
      return false;
    }
    if (!this->ScalarDot)
    {
      return false;
    }
    this->Core.scalar_dot = this->View(this->ScalarDot);
  }
  else if (components > 1 && component != MCOR_MAGNITUDE &&
    (component < 0 || component >= components))
  {
    this->Error = "The scalar " + Quote(vtkSPHNameOf(this->Scalar)) + " has no component " +
      std::to_string(component) + "; choose 0 to " + std::to_string(components - 1) +
      ", or -1 for the magnitude.";
    return false;
  }
  this->Core.scalar = this->View(this->Scalar);
  this->Core.scalar_component = components > 1 ? component : 0;
  return true;
}

// The iso value's array takes another name if a computed array has this one, because users look for
// computed arrays by name. In filled regions the scalar is interpolated as other arrays are.
void vtkMarchingCorrectorsInput::NameScalar()
{
  this->IsoValueName = "IsoValue";
  if (this->Choice.FreeSurface)
  {
    return;
  }
  const int component = this->Core.scalar_component;
  this->ScalarName = vtkSPHNameOf(this->Scalar);
  if (this->ScalarDot)
  {
    this->ScalarName += "_Dot_" + vtkSPHNameOf(this->ScalarDot);
  }
  else if (this->Scalar->GetNumberOfComponents() > 1)
  {
    const char* label = component >= 0 ? this->Scalar->GetComponentName(component) : "Magnitude";
    const bool isVector = this->Scalar->GetNumberOfComponents() <= 3;
    this->ScalarName += "_" +
      (label         ? std::string(label)
          : isVector ? std::string(1, "XYZ"[component])
                     : std::to_string(component));
  }
  if (!this->Choice.Filled && !this->ScalarName.empty() &&
    !Contains(this->Choice.ComputedArrays, this->ScalarName))
  {
    this->IsoValueName = this->ScalarName;
  }
}

VTK_ABI_NAMESPACE_END
