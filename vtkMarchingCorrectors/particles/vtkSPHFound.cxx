// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHFound.h"

#include "vtkSPHArrays.h"
#include "vtkSPHParticles.h"

VTK_ABI_NAMESPACE_BEGIN
vtkSPHFound vtkSPHFindArrays(vtkPointSet* particles)
{
  const auto find = [particles](mcor_quantity quantity, int components)
  {
    vtkDataArray* array = vtkSPHDetect(particles, quantity, components);
    return std::string(array ? array->GetName() : "");
  };
  vtkSPHFound found;
  found.SmoothingLength = find(MCOR_SMOOTHING_LENGTH, 1);
  found.Volume = find(MCOR_VOLUME, 1);
  found.Mass = find(MCOR_MASS, 1);
  found.Density = find(MCOR_DENSITY, 1);
  vtkSPHParticlesChoice choice;
  const bool isJoined = vtkSPHParticles(choice, particles).JoinVelocity() != nullptr;
  found.Velocity = isJoined ? "vx, vy, vz as Velocity" : find(MCOR_VELOCITY, 3);
  found.Velocity = found.Velocity.empty() ? find(MCOR_VELOCITY, 2) : found.Velocity; // in a plane
  vtkSPHParticles::FindFluid(choice, particles);
  found.Fluid = choice.FluidArrayName;
  found.FluidValue = choice.FluidValue;
  return found;
}
VTK_ABI_NAMESPACE_END
