// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// The period of particles that many processes hold.
#include "vtkSPHPeriod.h"

#include "mcor.h"
#include "vtkMultiProcessController.h"
#include "vtkPointSet.h"
#include "vtkSPHAlgorithm.h"
#include "vtkSPHRanks.h"

#include <algorithm>
#include <limits>
#include <sstream>

namespace
{
std::string Describe(const vtkSPHPeriod& found)
{
  std::ostringstream text;
  const char* separator = " ";
  text << found.Array;
  for (const double number : found.Period)
  {
    text << separator << number;
    separator = ",";
  }
  return text.str();
}

vtkSPHRanks::Bytes Pack(const vtkSPHPeriod& found)
{
  const std::size_t size = found.Period.size() * sizeof(double);
  vtkSPHRanks::Bytes bytes(1 + size + found.Array.size());
  bytes[0] = static_cast<char>(found.Period.size());
  const auto* period = reinterpret_cast<const char*>(found.Period.data());
  std::copy(period, period + size, bytes.data() + 1); // of nothing, too
  std::copy(found.Array.begin(), found.Array.end(), bytes.data() + 1 + size);
  return bytes;
}

vtkSPHPeriod Unpack(const vtkSPHRanks::Bytes& bytes)
{
  vtkSPHPeriod found;
  found.Period.resize(static_cast<std::size_t>(bytes.front()));
  const std::size_t size = found.Period.size() * sizeof(double);
  std::copy(
    bytes.data() + 1, bytes.data() + 1 + size, reinterpret_cast<char*>(found.Period.data()));
  found.Array.assign(bytes.data() + 1 + size, bytes.data() + bytes.size());
  return found;
}

vtkSPHPeriod FindPeriod(vtkSPHRanks& ranks, vtkFieldData* data, std::string& problem)
{
  vtkSPHPeriod first;
  int rank = 0, firstRank = 0;
  for (const vtkSPHRanks::Bytes& bytes : ranks.Gather(Pack(vtkSPHFindPeriod(data))))
  {
    const vtkSPHPeriod found = Unpack(bytes);
    if (first.Period.empty())
    {
      first = found;
      firstRank = rank;
    }
    else if (!found.Period.empty() && found.Period != first.Period && problem.empty())
    {
      std::ostringstream text;
      text << "The field data of the processes give different periods: " << Describe(first)
           << " on rank " << firstRank << ", " << Describe(found) << " on rank " << rank << ".";
      problem = text.str();
    }
    ++rank;
  }
  return first;
}

std::vector<double> BoundsOfPeriod(
  vtkSPHRanks& ranks, const std::vector<double>& period, vtkPointSet* particles)
{
  double ends[6];
  std::fill_n(ends, 6, std::numeric_limits<double>::infinity());
  if (particles->GetNumberOfPoints() > 0)
  {
    particles->GetBounds(ends);
    for (int side = 1; side < 6; side += 2)
    {
      ends[side] = -ends[side];
    }
  }
  ranks.Reduce(vtkSPHRanks::LEAST, ends, 6);
  for (int side = 1; side < 6; side += 2)
  {
    ends[side] = -ends[side];
  }
  return vtkSPHBoundsOfPeriod(period, ends);
}
}

vtkSPHPeriod vtkSPHFindPeriodDistributed(
  vtkMultiProcessController* controller, vtkFieldData* data, std::string& problem)
{
  vtkSPHRanks ranks(controller);
  return FindPeriod(ranks, data, problem);
}

std::vector<double> vtkSPHBoundsOfPeriodDistributed(
  vtkMultiProcessController* controller, const std::vector<double>& period, vtkPointSet* particles)
{
  vtkSPHRanks ranks(controller);
  return BoundsOfPeriod(ranks, period, particles);
}

bool vtkSPHAlgorithm::SetPeriodDistributed(
  vtkSPHRanks& ranks, vtkPointSet* particles, mcor_options& options)
{
  if (!this->DetectPeriod)
  {
    return true;
  }
  std::string problem;
  const vtkSPHPeriod found = FindPeriod(ranks, particles->GetFieldData(), problem);
  if (!this->CheckPeriod(found, problem))
  {
    return false;
  }
  const std::vector<double> bounds = BoundsOfPeriod(ranks, found.Period, particles);
  std::copy(bounds.begin(), bounds.end(), options.periodic);
  return true;
}
