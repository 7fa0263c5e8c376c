// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: the processes (ranks) that share one run, and what they tell each other.
 *
 * A shared run in ten points:
 *  1. Each rank begins with some of the particles, without particles that are marked as copies of
 *     another rank's. All ranks agree on one list of arrays (vtkSPHRanksParticles.h).
 *  2. The core measures the particles of all ranks: their range, the cube size, and so on. The
 *     results are called the globals (mcor_measure_globals).
 *  3. All ranks build the same k-d tree over samples of the work, so each owns a box of space
 *     (vtkSPHRanksSpace.h).
 *  4. A particle is sent to each rank whose box the particle's support, or an image of the support,
 *     reaches. A point is sent to the rank whose box holds the point (vtkSPHSendTuples).
 *  5. Each rank calls the core for its box, as one process may for any box; thanks to the globals,
 *     the result is this part of the whole surface, to the last bit.
 *  6. The core's callbacks reduce and gather over all ranks. If the core fails on one rank, the next
 *     callback on each other rank ends that rank's call, too (vtkSPHSharedRun.cxx).
 *  7. Results at points and particles go back to the ranks from which the points and particles
 *     came (vtkSPHReturnTuples).
 *  8. A surface stays where it was made. Its points and triangles get their numbers in the whole
 *     surface by their keys; each rank sorts a range of the keys
 *     (vtkMarchingCorrectorsRanks.cxx).
 *  9. The first rank does what needs a whole surface. For pieces or a file it gets all tuples, and
 *     puts them in the order of their numbers (vtkSPHGatherTuples). For lines it gets all
 *     particles, and makes all lines.
 * 10. No rank returns while another rank waits for it: all ranks first agree on any problem.
 *
 * All functions except the getters are collective: all ranks call them in the same order. The
 * module needs a VTK with MPI and DIY; DIY turns values into bytes (diy::Serialization).
 */
#ifndef vtkSPHRanks_h
#define vtkSPHRanks_h

#include "vtkDIYUtilities.h"
#include "vtkMPIController.h"
#include "vtkSPHRanksWait.h"
#include "vtkType.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
/** A list of ids for each rank, or from each rank. */
using vtkSPHRanksLists = std::vector<std::vector<vtkIdType>>;

class vtkSPHRanks
{
public:
  /** `controller` must be an MPI controller. */
  explicit vtkSPHRanks(vtkMultiProcessController* controller)
    : Controller(vtkMPIController::SafeDownCast(controller))
    , Communicator(vtkDIYUtilities::GetCommunicator(controller))
  {
  }

  int GetRank() const { return this->Controller->GetLocalProcessId(); }
  int GetCount() const { return this->Controller->GetNumberOfProcesses(); }

  /** Returns the bytes that this rank has sent to others by Exchange(). */
  std::int64_t GetBytesSent() const { return this->BytesSent; }

  /**
   * Returns true if no rank failed, that is, `sentence` is empty everywhere. Else all ranks get the
   * sentence of the first rank that failed, with the rank's number unless all ranks say the same.
   */
  bool Agree(std::string& sentence)
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

  enum Operation
  {
    LEAST = vtkCommunicator::MIN_OP,
    GREATEST = vtkCommunicator::MAX_OP,
    SUM = vtkCommunicator::SUM_OP
  };
  /** Replaces each value by the least, greatest or sum of all ranks' values. Returns false, and changes nothing, if a rank has stopped. */
  template <typename T>
  bool Reduce(Operation operation, T* values, int count)
  {
    if (!vtkSPHAwaitRanks(this->Controller))
    {
      return false;
    }
    const std::vector<T> own(values, values + count);
    this->Controller->AllReduce(own.data(), values, count, operation);
    return true;
  }

  /** Call this where other ranks call Reduce() or Gather(). If `stops` is set, the other ranks' calls do nothing. Returns true if no rank stops. */
  bool Stop(bool stops) { return vtkSPHAwaitRanks(this->Controller, !stops); }

  /** Merges each range, a least and a greatest value, over all ranks. An empty range goes from infinity to -infinity. */
  void ReduceRanges(double* ranges, int count)
  {
    // A greatest value is found as the least of the negated values, so that one Reduce() is enough.
    const auto negateGreatest = [ranges, count]
    {
      for (int i = 1; i < 2 * count; i += 2)
      {
        ranges[i] = -ranges[i];
      }
    };
    negateGreatest();
    this->Reduce(LEAST, ranges, 2 * count);
    negateGreatest();
  }

  /** Gathers one value from each rank, in the order of ranks; nothing if a rank has stopped. */
  template <typename T>
  std::vector<T> Gather(const T& mine)
  {
    diy::MemoryBuffer buffer;
    diy::save(buffer, mine);
    std::vector<std::vector<char>> all;
    std::vector<T> values;
    if (!vtkSPHAwaitRanks(this->Controller))
    {
      return values;
    }
    diy::mpi::all_gather(this->Communicator, buffer.buffer, all);
    for (std::vector<char>& theirs : all)
    {
      buffer.buffer.swap(theirs);
      buffer.reset();
      values.emplace_back();
      diy::load(buffer, values.back());
    }
    return values;
  }

  /** Joins the lists of all ranks, in the order of ranks. */
  template <typename T>
  std::vector<T> Join(const std::vector<T>& mine)
  {
    std::vector<T> all;
    for (const std::vector<T>& theirs : this->Gather(mine))
    {
      all.insert(all.end(), theirs.begin(), theirs.end());
    }
    return all;
  }

  /** Sends messages[i] to rank i; element i of the result came from rank i. */
  template <typename T>
  std::vector<std::vector<T>> Exchange(std::vector<std::vector<T>> messages)
  {
    const auto self = static_cast<std::size_t>(this->GetRank());
    std::vector<std::vector<T>> received(messages.size());
    received[self].swap(messages[self]);
    char block = 0; // each rank is one block, without data of its own
    vtkSPHAwaitRanks(this->Controller);
    diy::Master master(this->Communicator, 1);
    master.add(this->GetRank(), &block, new diy::Link);
    for (std::size_t rank = 0; rank < messages.size(); ++rank)
    {
      if (!messages[rank].empty())
      {
        const int to = static_cast<int>(rank);
        master.proxy(0).enqueue(diy::BlockID{ to, to }, messages[rank]);
        this->BytesSent += static_cast<std::int64_t>(messages[rank].size() * sizeof(T));
      }
    }
    master.exchange(true); // finds out who has something for whom
    std::vector<int> from;
    master.proxy(0).incoming(from);
    for (const int rank : from)
    {
      if (master.proxy(0).incoming(rank).size() > 0)
      {
        master.proxy(0).dequeue(rank, received[static_cast<std::size_t>(rank)]);
      }
    }
    return received;
  }

private:
  vtkSPHRanks(const vtkSPHRanks&) = delete;
  void operator=(const vtkSPHRanks&) = delete;

  vtkMPIController* Controller;
  diy::mpi::communicator Communicator;
  std::int64_t BytesSent = 0;
};
VTK_ABI_NAMESPACE_END

#endif
