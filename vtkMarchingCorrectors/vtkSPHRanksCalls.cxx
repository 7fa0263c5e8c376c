// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksCalls.h"

namespace
{
vtkSPHRanks::Operation OperationOf(mcor_reduction reduction)
{
  return reduction == MCOR_LEAST ? vtkSPHRanks::LEAST
    : reduction == MCOR_GREATEST ? vtkSPHRanks::GREATEST
                                 : vtkSPHRanks::SUM;
}
}

//------------------------------------------------------------------------------
vtkSPHRanksCalls::vtkSPHRanksCalls(vtkSPHRanks& ranks)
  : Ranks(ranks)
{
  this->Core.user = this;
  this->Core.reduce_doubles = ReduceDoubles;
  this->Core.reduce_counts = ReduceCounts;
  this->Core.gather = Gather;
}

//------------------------------------------------------------------------------
// Every callback, and the end, begin with this one: so all ranks meet here the same number of times
// until one has failed, and not any more after that.
bool vtkSPHRanksCalls::AllGoOn(bool self)
{
  std::int64_t goesOn = self ? 1 : 0;
  this->Ranks.Reduce(vtkSPHRanks::LEAST, &goesOn, 1);
  this->Stopped = self && goesOn == 0;
  return goesOn != 0;
}

//------------------------------------------------------------------------------
void vtkSPHRanksCalls::End(bool failed)
{
  if (!this->Stopped)
  {
    this->AllGoOn(!failed);
  }
}

//------------------------------------------------------------------------------
int vtkSPHRanksCalls::ReduceDoubles(void* user, mcor_reduction reduction, double* values, int count)
{
  auto* self = static_cast<vtkSPHRanksCalls*>(user);
  if (!self->AllGoOn(true))
  {
    return 1;
  }
  self->Ranks.Reduce(OperationOf(reduction), values, count);
  return 0;
}

//------------------------------------------------------------------------------
int vtkSPHRanksCalls::ReduceCounts(
  void* user, mcor_reduction reduction, std::int64_t* values, int count)
{
  auto* self = static_cast<vtkSPHRanksCalls*>(user);
  if (!self->AllGoOn(true))
  {
    return 1;
  }
  self->Ranks.Reduce(OperationOf(reduction), values, count);
  return 0;
}

//------------------------------------------------------------------------------
int vtkSPHRanksCalls::Gather(void* user, const void* records, std::int64_t count, std::size_t width,
  const void** all, std::int64_t* allCount)
{
  auto* self = static_cast<vtkSPHRanksCalls*>(user);
  if (!self->AllGoOn(true))
  {
    return 1;
  }
  const auto* first = static_cast<const char*>(records);
  const std::size_t size = static_cast<std::size_t>(count) * width;
  self->Gathered.clear();
  for (const vtkSPHRanks::Bytes& theirs :
    self->Ranks.Gather(vtkSPHRanks::Bytes(first, first + (first ? size : 0))))
  {
    self->Gathered.insert(self->Gathered.end(), theirs.begin(), theirs.end());
  }
  *all = self->Gathered.data();
  *allCount = static_cast<std::int64_t>(self->Gathered.size() / width);
  return 0;
}
