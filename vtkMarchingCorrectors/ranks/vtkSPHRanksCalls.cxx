// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksCalls.h"

#include "vtkSPHRanksRoute.h"

#include <algorithm>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
vtkSPHRanksCalls::vtkSPHRanksCalls(vtkSPHRanks& ranks, const vtkSPHRanksRoute* route)
  : Ranks(ranks)
{
  this->Core.user = this;
  this->Core.reduce_doubles = Reduce<double>;
  this->Core.reduce_counts = Reduce<std::int64_t>;
  this->Core.gather = Gather;
  if (route)
  {
    std::copy(route->Whole.begin(), route->Whole.end(), this->Core.whole_box);
  }
}

// Every callback, and the end, begins with this call. So all ranks meet here equally often until
// one has failed, and never after that.
bool vtkSPHRanksCalls::AllGoOn(bool self)
{
  std::int64_t goesOn = self ? 1 : 0;
  this->Ranks.Reduce(vtkSPHRanks::LEAST, &goesOn, 1);
  this->Stopped = self && goesOn == 0;
  return goesOn != 0;
}

void vtkSPHRanksCalls::End(bool failed)
{
  if (!this->Stopped)
  {
    this->AllGoOn(!failed);
  }
}

template <typename T>
int vtkSPHRanksCalls::Reduce(void* user, mcor_reduction reduction, T* values, int count)
{
  auto* self = static_cast<vtkSPHRanksCalls*>(user);
  if (!self->AllGoOn(true))
  {
    return 1;
  }
  const vtkSPHRanks::Operation operations[] = { vtkSPHRanks::LEAST, vtkSPHRanks::GREATEST,
    vtkSPHRanks::SUM };
  self->Ranks.Reduce(operations[reduction], values, count);
  return 0;
}

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
  return self->Deliver(
    self->Ranks.Gather(Bytes(first, first + (first ? size : 0))), width, all, allCount);
}

int vtkSPHRanksCalls::Deliver(
  const std::vector<Bytes>& received, std::size_t width, const void** all, std::int64_t* allCount)
{
  this->Gathered.clear();
  for (const Bytes& theirs : received)
  {
    this->Gathered.insert(this->Gathered.end(), theirs.begin(), theirs.end());
  }
  *all = this->Gathered.data();
  *allCount = static_cast<std::int64_t>(this->Gathered.size() / width);
  return 0;
}
VTK_ABI_NAMESPACE_END
