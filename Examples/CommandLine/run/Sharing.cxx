// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Sharing.h"

#include "ParticleFile.h"
#include "ParticleTimes.h"
#include "Walls.h"

vtkSmartPointer<vtkPointSet> Sharing::Read(
  const std::string& file, const std::vector<std::string>& walls, MessageCapture* messages)
{
  return AddWalls(ReadParticles(file, messages), ReadWalls(walls, messages));
}

vtkSmartPointer<vtkPointSet> Sharing::Read(
  ParticleTimes& times, double time, std::vector<std::string>& warnings)
{
  return times.At(time, warnings);
}
