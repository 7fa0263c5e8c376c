// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: the processes (ranks) that share one run, and what they tell each
 * other. All functions except the getters are collective: all ranks call them in the same order.
 * Built where VTK has MPI and DIY, whose serialization turns values into bytes
 * (diy::Serialization).
 */
#ifndef vtkSPHRanks_h
#define vtkSPHRanks_h

#include "mcor_parts.h"
#include "vtkDIYUtilities.h"
#include "vtkMPIController.h"
#include "vtkSPHAlgorithm.h"
#include "vtkSPHRanksWait.h"
#include "vtkType.h"

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
/** A list for each rank, or from each. */
using vtkSPHRanksLists = std::vector<std::vector<vtkIdType>>;

class vtkSPHRanks
{
public:
  /** `controller` must be an MPI controller. */
  explicit vtkSPHRanks(vtkMultiProcessController* controller);

  int GetRank() const { return this->Controller->GetLocalProcessId(); }
  int GetCount() const { return this->Controller->GetNumberOfProcesses(); }

  /** Returns the bytes that this rank has sent to others by Exchange(). */
  std::int64_t GetBytesSent() const { return this->BytesSent; }

  /**
   * Returns true if no rank failed, that is, `sentence` is empty everywhere. Else `sentence`
   * becomes, on all ranks, that of the first rank that failed, whose number it names unless all
   * say the same.
   */
  bool Agree(std::string& sentence);

  /** Finds the number of ranks on this machine, by its name, and this rank's place among them. */
  void FindNeighbors(int& place, int& count);

  enum Operation
  {
    LEAST = vtkCommunicator::MIN_OP,
    GREATEST = vtkCommunicator::MAX_OP,
    SUM = vtkCommunicator::SUM_OP
  };
  template <typename T>
  void Reduce(Operation operation, T* values, int count)
  {
    const std::vector<T> own(values, values + count);
    vtkSPHAwaitRanks(this->Controller);
    this->Controller->AllReduce(own.data(), values, count, operation);
  }

  /**
   * Merges ranges, each a least and a greatest value; an empty range is infinite the wrong way
   * round.
   */
  void ReduceRanges(double* ranges, int count);

  /** Gathers one value from each rank, in the order of ranks. */
  template <typename T>
  std::vector<T> Gather(const T& mine)
  {
    diy::MemoryBuffer buffer;
    diy::save(buffer, mine);
    std::vector<T> values;
    for (std::vector<char>& theirs : this->GatherBytes(buffer.buffer))
    {
      buffer.buffer.swap(theirs);
      buffer.reset();
      values.emplace_back();
      diy::load(buffer, values.back());
    }
    return values;
  }

  /** Sends messages[i] to rank i; element i of the result came from rank i. */
  template <typename T>
  std::vector<std::vector<T>> Exchange(std::vector<std::vector<T>> messages)
  {
    const auto self = static_cast<std::size_t>(this->GetRank());
    std::vector<std::vector<T>> received(messages.size());
    received[self].swap(messages[self]);
    const auto send = [&](char*, const diy::Master::ProxyWithLink& proxy)
    {
      for (std::size_t rank = 0; rank < messages.size(); ++rank)
      {
        if (!messages[rank].empty())
        {
          const int to = static_cast<int>(rank);
          proxy.enqueue(diy::BlockID{ to, to }, messages[rank]);
          this->BytesSent += static_cast<std::int64_t>(messages[rank].size() * sizeof(T));
        }
      }
    };
    const auto receive = [&](char*, const diy::Master::ProxyWithLink& proxy)
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
    };
    this->ExchangeBlocks(send, receive);
    return received;
  }

  /** Gathers on the first rank alone; the other ranks get nothing. */
  template <typename T>
  std::vector<std::vector<T>> GatherOnFirst(std::vector<T> mine)
  {
    std::vector<std::vector<T>> messages(static_cast<std::size_t>(this->GetCount()));
    messages[0] = std::move(mine);
    return this->Exchange(std::move(messages));
  }

private:
  vtkSPHRanks(const vtkSPHRanks&) = delete;
  void operator=(const vtkSPHRanks&) = delete;

  std::vector<std::vector<char>> GatherBytes(const std::vector<char>& mine);
  using Visit = std::function<void(char* block, const diy::Master::ProxyWithLink& proxy)>;
  void ExchangeBlocks(const Visit& send, const Visit& receive);

  vtkMPIController* Controller;
  diy::mpi::communicator Communicator;
  std::int64_t BytesSent = 0;
};

/** The ranks' callbacks for the core. A rank that fails does not leave the others waiting. */
class vtkSPHRanksCalls
{
public:
  /** `whole`: the box of all ranks; null until space is divided. */
  explicit vtkSPHRanksCalls(vtkSPHRanks& ranks, const double* whole = nullptr);

  /** Returns the callbacks, for mcor_options during one call of the core. */
  const mcor_ranks* Get() const { return &this->Core; }

  /** Called by all ranks after the core's call, however that ended. */
  void End(bool failed);

  /** Whether this rank was told that another one failed. */
  bool WasStopped() const { return this->Stopped; }

private:
  vtkSPHRanksCalls(const vtkSPHRanksCalls&) = delete;
  void operator=(const vtkSPHRanksCalls&) = delete;

  bool AllGoOn(bool self);
  template <typename T>
  static int Reduce(void* user, mcor_reduction reduction, T* values, int count);
  static int Gather(void* user, const void* records, std::int64_t count, std::size_t width,
    const void** all, std::int64_t* allCount);

  vtkSPHRanks& Ranks;
  mcor_ranks Core = {};
  bool Stopped = false;
  std::vector<char> Gathered;
};
VTK_ABI_NAMESPACE_END

#endif
