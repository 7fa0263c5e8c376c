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

VTK_ABI_NAMESPACE_BEGIN
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
}

vtkSPHPeriod vtkSPHFindPeriodDistributed(
  vtkMultiProcessController* controller, vtkFieldData* data, std::string& problem)
{
  vtkSPHRanks ranks(controller);
  vtkSPHPeriod first;
  int rank = 0, firstRank = 0;
  const vtkSPHPeriod mine = vtkSPHFindPeriod(data);
  for (const auto& theirs : ranks.Gather(std::make_pair(mine.Period, mine.Array)))
  {
    const vtkSPHPeriod found = { theirs.first, theirs.second };
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

std::vector<double> vtkSPHBoundsOfPeriodDistributed(
  vtkMultiProcessController* controller, const std::vector<double>& period, vtkPointSet* particles)
{
  vtkSPHRanks ranks(controller);
  const double infinity = std::numeric_limits<double>::infinity();
  double ends[6] = { infinity, -infinity, infinity, -infinity, infinity, -infinity };
  if (particles->GetNumberOfPoints() > 0)
  {
    particles->GetBounds(ends);
  }
  ranks.ReduceRanges(ends, 3);
  return vtkSPHBoundsOfPeriod(period, ends);
}

bool vtkSPHAlgorithm::SetPeriodDistributed(vtkPointSet* particles, mcor_options& options)
{
  if (!this->DetectPeriod)
  {
    return true;
  }
  std::string problem;
  const vtkSPHPeriod found =
    vtkSPHFindPeriodDistributed(this->Controller, particles->GetFieldData(), problem);
  if (!this->CheckPeriod(found, problem))
  {
    return false;
  }
  const std::vector<double> bounds =
    vtkSPHBoundsOfPeriodDistributed(this->Controller, found.Period, particles);
  std::copy(bounds.begin(), bounds.end(), options.periodic);
  return true;
}
VTK_ABI_NAMESPACE_END
