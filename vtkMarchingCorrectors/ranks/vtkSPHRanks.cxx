// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanks.h"

#include "vtkDIYUtilities.h"
#include "vtkMPIController.h"
#include "vtkSPHRanksWait.h"

#include "vtk_diy2.h"

// clang-format off
#include VTK_DIY2(diy/master.hpp)
#include VTK_DIY2(diy/mpi.hpp)
// clang-format on

#include <algorithm>
#include <utility>

class vtkSPHRanks::vtkInternals
{
public:
  explicit vtkInternals(vtkMultiProcessController* controller)
    : Communicator(vtkDIYUtilities::GetCommunicator(controller))
  {
  }

  template <typename T>
  void Reduce(Operation operation, T* values, int count)
  {
    const std::vector<T> in(values, values + count);
    std::vector<T> out(in.size());
    switch (operation)
    {
      case LEAST:
        diy::mpi::all_reduce(this->Communicator, in, out, diy::mpi::minimum<T>());
        break;
      case GREATEST:
        diy::mpi::all_reduce(this->Communicator, in, out, diy::mpi::maximum<T>());
        break;
      case SUM:
        diy::mpi::all_reduce(this->Communicator, in, out, std::plus<T>());
        break;
    }
    std::copy(out.begin(), out.end(), values);
  }

  diy::mpi::communicator Communicator;
};

vtkSPHRanks::vtkSPHRanks(vtkMultiProcessController* controller)
  : Internals(new vtkInternals(controller))
  , Controller(vtkMPIController::SafeDownCast(controller))
  , Rank(controller->GetLocalProcessId())
  , Count(controller->GetNumberOfProcesses())
{
}

vtkSPHRanks::~vtkSPHRanks() = default;

bool vtkSPHRanks::Agree(std::string& sentence)
{
  std::int64_t failed = sentence.empty() ? 0 : 1;
  this->Reduce(SUM, &failed, 1);
  if (failed == 0)
  {
    return true;
  }
  const std::vector<Bytes> all = this->Gather(Bytes(sentence.begin(), sentence.end()));
  const auto first =
    std::find_if(all.begin(), all.end(), [](const Bytes& text) { return !text.empty(); });
  const bool isSame =
    std::all_of(all.begin(), all.end(), [first](const Bytes& text) { return text == *first; });
  sentence = isSame ? "" : "Rank " + std::to_string(first - all.begin()) + ": ";
  sentence.append(first->begin(), first->end());
  return false;
}

void vtkSPHRanks::FindNeighbors(int& place, int& count)
{
  const std::string name = vtkMPIController::GetProcessorName();
  const Bytes mine(name.begin(), name.end());
  const std::vector<Bytes> all = this->Gather(mine);
  place = static_cast<int>(std::count(all.begin(), all.begin() + this->Rank, mine));
  count = static_cast<int>(std::count(all.begin(), all.end(), mine));
}

void vtkSPHRanks::Reduce(Operation operation, double* values, int count)
{
  vtkSPHAwaitRanks(this->Controller);
  this->Internals->Reduce(operation, values, count);
}

void vtkSPHRanks::Reduce(Operation operation, std::int64_t* values, int count)
{
  vtkSPHAwaitRanks(this->Controller);
  std::vector<long long> same(values, values + count); // MPI's types have no name for the other
  this->Internals->Reduce(operation, same.data(), count);
  std::copy(same.begin(), same.end(), values);
}

std::vector<vtkSPHRanks::Bytes> vtkSPHRanks::Gather(const Bytes& mine)
{
  std::vector<Bytes> all;
  vtkSPHAwaitRanks(this->Controller);
  diy::mpi::all_gather(this->Internals->Communicator, mine, all);
  return all;
}

std::vector<vtkSPHRanks::Bytes> vtkSPHRanks::Exchange(std::vector<Bytes> messages)
{
  struct Block
  {
  };
  vtkSPHAwaitRanks(this->Controller);
  using Proxy = diy::Master::ProxyWithLink;
  std::vector<Bytes> received(messages.size());
  const auto self = static_cast<std::size_t>(this->Rank);
  received[self].swap(messages[self]);
  Block block;
  diy::Master master(this->Internals->Communicator, 1);
  master.add(this->Rank, &block, new diy::Link);
  master.foreach (
    [&](Block*, const Proxy& proxy)
    {
      for (int rank = 0; rank < this->Count; ++rank)
      {
        const Bytes& message = messages[static_cast<std::size_t>(rank)];
        if (!message.empty())
        {
          proxy.enqueue(diy::BlockID{ rank, rank }, message);
          this->BytesSent += static_cast<std::int64_t>(message.size());
        }
      }
    });
  master.exchange(true); // to whom there is something to say, no neighbours being known
  master.foreach (
    [&](Block*, const Proxy& proxy)
    {
      std::vector<int> from;
      proxy.incoming(from);
      for (const int rank : from)
      {
        if (proxy.incoming(rank).size() > 0)
        {
          proxy.dequeue(rank, received[static_cast<std::size_t>(rank)]);
        }
      }
    });
  return received;
}
