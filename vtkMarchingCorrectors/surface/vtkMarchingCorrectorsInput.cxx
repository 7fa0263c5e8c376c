// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMarchingCorrectorsInput.h"

VTK_ABI_NAMESPACE_BEGIN
bool vtkMarchingCorrectorsInput::Collect(unsigned wants)
{
  const vtkMarchingCorrectorsChoice& f = this->Choice;
  vtkSPHWanted wanted;
  wanted.Wants = wants;
  wanted.FreeSurface = f.FreeSurface;
  wanted.Scalar = f.Scalar;
  wanted.ScalarDot = f.ScalarDot;
  wanted.ScalarComponent = f.ScalarComponent;
  wanted.Taken = f.ComputedArrays;
  wanted.HasIsoValues = f.ComputeScalars;
  wanted.Filled = f.Filled;
  if (!this->vtkSPHParticles::Collect(wanted))
  {
    return false;
  }
  this->Scalar = vtkArrayDownCast<vtkDataArray>(this->ArrayFor(MCOR_ROLE_SCALAR));
  this->ScalarDot = vtkArrayDownCast<vtkDataArray>(this->ArrayFor(MCOR_ROLE_SCALAR_DOT));
  this->IsoValueName = this->Found.iso_value_name;
  vtkSPHSign(this->ScalarSignature, this->Scalar);
  vtkSPHSign(this->ScalarSignature, this->ScalarDot);
  this->ScalarSignature.push_back(static_cast<std::uint64_t>(this->Core.scalar_component));
  return true;
}

void vtkMarchingCorrectorsInput::TakeWidening(vtkDataArray* factors, vtkDataArray* volumes)
{
  vtkSPHSign(this->ParticlesSignature, factors);
  vtkSPHSign(this->AttributesSignature, factors);
  this->Core.widening = vtkSPHView(factors);
  this->Attributes.assign(
    this->Core.attributes, this->Core.attributes + this->Core.attribute_count);
  this->Attributes.push_back(this->Core.widening);
  this->Core.attributes = this->Attributes.data();
  this->Core.attribute_count = static_cast<int>(this->Attributes.size());
  if (volumes)
  {
    this->Core.volume = vtkSPHView(volumes);
    this->Core.volume.name = nullptr; // they were computed, which the statistics say
  }
}
VTK_ABI_NAMESPACE_END
