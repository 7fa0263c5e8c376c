// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Sharing.h"

#include "ParticleFile.h"
#include "ParticleTimes.h"

#include <cstdlib>
#include <initializer_list>

namespace
{

/// The first of these variables that is set, as a number.
int Number(std::initializer_list<const char*> names, int otherwise)
{
  for (const char* name : names)
  {
    if (const char* text = std::getenv(name))
    {
      return std::atoi(text);
    }
  }
  return otherwise;
}

}

vtkSmartPointer<vtkPointSet> Sharing::Read(
  const std::string& file, const std::vector<std::string>& walls, MessageCapture* messages)
{
  return AddWalls(ReadParticles({ file }, messages), ReadWalls(walls, messages));
}

vtkSmartPointer<vtkPointSet> Sharing::Read(
  ParticleTimes& times, double time, std::vector<std::string>& warnings)
{
  return times.At(time, warnings);
}

int LaunchedCount()
{
#if MCOR_HAS_RANKS
  return Number({ "OMPI_COMM_WORLD_SIZE", "PMI_SIZE" }, 1);
#else
  return 1;
#endif
}

int LaunchedRank()
{
  return LaunchedCount() > 1 ? Number({ "OMPI_COMM_WORLD_RANK", "PMI_RANK" }, 0) : 0;
}
