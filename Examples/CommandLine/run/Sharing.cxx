// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Sharing.h"

#include "Job.h"
#include "ParticleFile.h"
#include "ParticleTimes.h"

#include <cstdlib>

namespace
{

/// The first of these variables that is set, as a number.
int Number(const char* ofOpenMpi, const char* ofOthers, int otherwise)
{
  const char* text = std::getenv(ofOpenMpi);
  text = text ? text : std::getenv(ofOthers);
  return text ? std::atoi(text) : otherwise;
}

}

Sharing::Particles Sharing::Read()
{
  return AddWalls(ReadParticles(this->Options.Inputs, this->Messages),
    ReadWalls(this->Options.Walls, this->Messages));
}

Sharing::Particles Sharing::Read(
  ParticleTimes& times, double time, std::vector<std::string>& warnings)
{
  return times.At(time, warnings);
}

int LaunchedCount()
{
#if MCOR_HAS_RANKS
  return Number("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", 1);
#else
  return 1;
#endif
}

int LaunchedRank()
{
  return LaunchedCount() > 1 ? Number("OMPI_COMM_WORLD_RANK", "PMI_RANK", 0) : 0;
}
