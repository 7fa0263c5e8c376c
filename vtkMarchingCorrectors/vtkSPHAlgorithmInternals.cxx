// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHAlgorithmInternals.h"

#include "mcor_parts.h"
#include "vtkSPHParticles.h"

VTK_ABI_NAMESPACE_BEGIN
vtkSPHAlgorithm::vtkInternals::~vtkInternals()
{
  mcor_free_context(this->Context);
}

std::string vtkSPHAlgorithm::vtkInternals::Prepare(const std::string& device, int place, int count)
{
  if (this->Context && this->Device == device && this->Place == place && this->Count == count)
  {
    return "";
  }
  this->Forget(MCOR_DEVICE_ERROR);
  this->Device = device;
  this->Place = place;
  this->Count = count;
  if (mcor_create_shared_context(device.c_str(), place, count, &this->Context) == MCOR_OK)
  {
    return "";
  }
  const std::string why = mcor_last_error(this->Context);
  this->Forget(MCOR_DEVICE_ERROR);
  return why;
}

bool vtkSPHAlgorithm::vtkInternals::Kept::Take(
  const std::vector<std::uint64_t>& signature, bool isOther)
{
  isOther = isOther || signature != this->Signature;
  this->Version += isOther ? 1 : 0;
  this->Signature = signature;
  return isOther;
}

// The scalar is kept in the order of the particles: new particles make a new scalar.
void vtkSPHAlgorithm::vtkInternals::SetVersions(vtkSPHParticles& input)
{
  const bool areOthers = this->Particles.Take(input.ParticlesSignature);
  this->Scalar.Take(input.ScalarSignature, areOthers);
  this->Attributes.Take(input.AttributesSignature);
  input.Core.particles_version = this->Particles.Version;
  input.Core.scalar_version = this->Scalar.Version;
  input.Core.attributes_version = this->Attributes.Version;
}

void vtkSPHAlgorithm::vtkInternals::Forget(mcor_status status)
{
  this->Particles.Signature.clear();
  this->Scalar.Signature.clear();
  this->Attributes.Signature.clear();
  if (status == MCOR_DEVICE_ERROR)
  {
    mcor_free_context(this->Context);
    this->Context = nullptr;
  }
}

void vtkSPHAlgorithm::vtkInternals::Release()
{
  if (this->InRun)
  {
    this->ReleaseAfterRun = true;
  }
  else if (this->Context)
  {
    mcor_release_memory(this->Context);
  }
}

void vtkSPHAlgorithm::vtkInternals::BeginRun()
{
  this->InRun = true;
  this->ReleaseAfterRun = false;
}

void vtkSPHAlgorithm::vtkInternals::EndRun()
{
  this->InRun = false;
  if (this->ReleaseAfterRun)
  {
    this->Release();
  }
}
VTK_ABI_NAMESPACE_END
