// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRun.h"

#include "mcor_parts.h"
#include "vtkSPHArrays.h"
#include "vtkSPHFound.h"
#include "vtkSPHSay.h"
#if MCOR_HAS_RANKS
#include "vtkSPHSharedRun.h"
#endif

#include <algorithm>

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
  const std::string why = vtkSPHTakeText(mcor_last_message(this->Context));
  this->Forget(MCOR_DEVICE_ERROR);
  return why;
}

void vtkSPHAlgorithm::vtkInternals::Forget(mcor_status status)
{
  this->Particles.Signature.clear();
  this->Scalar.Signature.clear();
  this->Attributes.Signature.clear();
  this->Factors = nullptr;
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
    return;
  }
  this->Factors = nullptr;
  mcor_release_memory(this->Context);
}

void vtkSPHAlgorithm::vtkInternals::EndRun()
{
  this->InRun = false;
  if (this->ReleaseAfterRun)
  {
    this->Release();
  }
}

std::unique_ptr<vtkSPHAlgorithm::vtkRun> vtkSPHAlgorithm::vtkRun::Make(vtkSPHAlgorithm* filter)
{
#if MCOR_HAS_RANKS
  if (filter->IsShared())
  {
    return std::make_unique<vtkSharedRun>(filter);
  }
#endif
  return std::make_unique<vtkRun>(filter);
}

void vtkSPHAlgorithm::vtkRun::Fail(const std::string& message)
{
  if (!this->IsQuiet && !message.empty())
  {
    this->Filter->Fail(message);
  }
}

bool vtkSPHAlgorithm::vtkRun::Agree(const std::string& problem)
{
  this->Fail(problem);
  return problem.empty();
}

bool vtkSPHAlgorithm::vtkRun::Begin(vtkPointSet* particles)
{
  this->Own = particles;
  this->Particles = particles ? particles->GetNumberOfPoints() : 0;
  return particles && !this->Filter->IsAborted();
}

vtkSPHParticlesChoice vtkSPHAlgorithm::vtkRun::Choose(vtkSPHRequest* first)
{
  vtkSPHParticlesChoice choice(*this->Filter);
  this->CallAside(
    [&](const mcor_ranks* ranks)
    {
      vtkSPHChoose(choice, this->Own, first, ranks);
      return true;
    });
  return choice;
}

bool vtkSPHAlgorithm::vtkRun::Accept(vtkSPHParticles& particles, const std::string& consequence)
{
  if (this->Particles == 0)
  {
    return true;
  }
  const bool isUsable = particles.Collect();
  this->Filter->SetUsedNames(&particles, isUsable);
  if (!this->Agree(isUsable ? "" : particles.Error))
  {
    return false;
  }
  const mcor_found& found = particles.Found;
  std::int64_t fluid = found.fluid_count;
  this->Sum(&fluid, 1);
  this->HasFluid = fluid > 0;
  if (this->IsFirst() && this->HasFluid)
  {
    this->Filter->WarnOnce(WARN_TYPE_ARRAY, particles.Description.UnusedType);
    this->Filter->WarnOnce(WARN_UNUSED, particles.Unused);
  }
  else if (this->IsFirst())
  {
    this->Filter->Warn(vtkSPHSay(MCOR_SAY(NOTHING_WITHOUT_FLUID),
      found.no_fluid ? found.no_fluid : "There are no particles", consequence.c_str()));
  }
  return true;
}

bool vtkSPHAlgorithm::vtkRun::SetPeriod()
{
  if (this->Filter->DetectPeriod)
  {
    std::string problem;
    const std::vector<double> period = this->FindPeriod(problem);
    if (period.empty() || !problem.empty())
    {
      this->Fail(problem.empty() ? vtkSPHSay(MCOR_SAY(NO_PERIOD)) : problem);
      return false;
    }
    std::copy(period.begin(), period.end(), this->Options.periodic);
  }
  mcor_move_period(&this->Options);
  return true;
}

std::vector<double> vtkSPHAlgorithm::vtkRun::FindPeriod(std::string& problem)
{
  const vtkSPHPeriod found = vtkSPHFindPeriod(this->Own->GetFieldData());
  problem = found.IsTilted() ? vtkSPHSay(MCOR_SAY(CELL_TILTED)) : "";
  return vtkSPHBoundsOfPeriod(found.Period, this->Own->GetBounds());
}

bool vtkSPHAlgorithm::vtkRun::Call(
  vtkSPHParticles& particles, const std::function<int(mcor_context*)>& call)
{
  std::string message;
  const int status = this->CallCore(particles, call, message, 0, 1);
  return this->Agree(message) && status == MCOR_OK;
}

// A progress observer may change KeepDeviceData during the call, so it is read first.
int vtkSPHAlgorithm::vtkRun::CallCore(vtkSPHParticles& particles,
  const std::function<int(mcor_context*)>& call, std::string& message, int place, int count)
{
  vtkInternals& internals = *this->Filter->Internals;
  const bool keep = this->Filter->KeepDeviceData != 0;
  message = internals.Prepare(this->Filter->Device, place, count);
  if (!message.empty())
  {
    return MCOR_DEVICE_ERROR;
  }
  if (keep)
  {
    // The core keeps the scalar in the order of the particles, so new particles need a new scalar.
    const bool areOthers = internals.Particles.Take(particles.ParticlesSignature);
    internals.Scalar.Take(particles.ScalarSignature, areOthers);
    internals.Attributes.Take(particles.AttributesSignature);
    particles.Core.particles_version = internals.Particles.Version;
    particles.Core.scalar_version = internals.Scalar.Version;
    particles.Core.attributes_version = internals.Attributes.Version;
  }
  this->Options.progress_user = this->Filter;
  this->Options.progress = [](void* user, double fraction, const char* phase)
  {
    auto* filter = static_cast<vtkSPHAlgorithm*>(user);
    filter->SetProgressText(phase);
    filter->UpdateProgress(fraction);
    return filter->IsAborted() ? 1 : 0;
  };
  mcor_context* context = internals.Context;
  const auto status = static_cast<mcor_status>(call(context));
  if (!keep)
  {
    mcor_release_memory(context);
  }
  if (status != MCOR_OK)
  {
    message = status == MCOR_CANCELLED ? "" : vtkSPHTakeText(mcor_last_message(context));
    internals.Forget(status);
  }
  return status;
}

void vtkSPHAlgorithm::vtkRun::WarnOfParticles(
  const mcor_input& core, const mcor_statistics& statistics)
{
  mcor_surface surface = {};
  surface.statistics = statistics;
  for (const mcor_warning kind : { MCOR_WARN_FAR, MCOR_WARN_PERIOD, MCOR_WARN_COARSE })
  {
    this->Filter->WarnOnce(
      kind, vtkSPHTakeText(mcor_describe_warning(kind, &core, &this->Options, &surface)));
  }
}
VTK_ABI_NAMESPACE_END
