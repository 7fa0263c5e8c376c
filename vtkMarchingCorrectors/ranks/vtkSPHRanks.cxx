// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanks.h"

#include <algorithm>

VTK_ABI_NAMESPACE_BEGIN
vtkSPHRanks::vtkSPHRanks(vtkMultiProcessController* controller)
  : Controller(vtkMPIController::SafeDownCast(controller))
  , Communicator(vtkDIYUtilities::GetCommunicator(controller))
{
}

bool vtkSPHRanks::Agree(std::string& sentence)
{
  const std::vector<std::string> all = this->Gather(sentence);
  const auto first =
    std::find_if(all.begin(), all.end(), [](const std::string& text) { return !text.empty(); });
  if (first == all.end())
  {
    return true;
  }
  const bool isSame = std::count(all.begin(), all.end(), *first) == this->GetCount();
  sentence = (isSame ? "" : "Rank " + std::to_string(first - all.begin()) + ": ") + *first;
  return false;
}

void vtkSPHRanks::FindNeighbors(int& place, int& count)
{
  const std::string mine = vtkMPIController::GetProcessorName();
  const std::vector<std::string> all = this->Gather(mine);
  place = static_cast<int>(std::count(all.begin(), all.begin() + this->GetRank(), mine));
  count = static_cast<int>(std::count(all.begin(), all.end(), mine));
}

void vtkSPHRanks::ReduceRanges(double* ranges, int count)
{
  std::vector<double> ends(
    ranges, ranges + 2 * count); // greatest values are negated, so that one message does for both
  for (std::size_t i = 1; i < ends.size(); i += 2)
  {
    ends[i] = -ends[i];
  }
  this->Reduce(LEAST, ends.data(), 2 * count);
  for (std::size_t i = 0; i < ends.size(); ++i)
  {
    ranges[i] = i % 2 == 0 ? ends[i] : -ends[i];
  }
}

std::vector<std::vector<char>> vtkSPHRanks::GatherBytes(const std::vector<char>& mine)
{
  std::vector<std::vector<char>> all;
  vtkSPHAwaitRanks(this->Controller);
  diy::mpi::all_gather(this->Communicator, mine, all);
  return all;
}

void vtkSPHRanks::ExchangeBlocks(const Visit& send, const Visit& receive)
{
  char block = 0; // each rank is one block, without data of its own
  vtkSPHAwaitRanks(this->Controller);
  diy::Master master(this->Communicator, 1);
  master.add(this->GetRank(), &block, new diy::Link);
  master.foreach (send);
  master.exchange(true); // finds out who has something for whom
  master.foreach (receive);
}

vtkSPHRanksCalls::vtkSPHRanksCalls(vtkSPHRanks& ranks, const double* whole)
  : Ranks(ranks)
{
  this->Core.user = this;
  this->Core.reduce_doubles = Reduce<double>;
  this->Core.reduce_counts = Reduce<std::int64_t>;
  this->Core.gather = Gather;
  std::copy_n(whole, whole ? 6 : 0, this->Core.whole_box);
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
  const std::size_t size = first ? static_cast<std::size_t>(count) * width : 0;
  self->Gathered.clear();
  for (const auto& theirs : self->Ranks.Gather(std::vector<char>(first, first + size)))
  {
    self->Gathered.insert(self->Gathered.end(), theirs.begin(), theirs.end());
  }
  *all = self->Gathered.data();
  *allCount = static_cast<std::int64_t>(self->Gathered.size() / width);
  return 0;
}
VTK_ABI_NAMESPACE_END
