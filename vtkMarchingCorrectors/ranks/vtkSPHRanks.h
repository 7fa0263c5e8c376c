// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: the processes (ranks) that share one run, and what they tell each other.
 * Every function but the getters is collective: all ranks call it, in the same order. Built where VTK
 * has MPI and DIY.
 */
#ifndef vtkSPHRanks_h
#define vtkSPHRanks_h

#include "vtkType.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

class vtkMPIController;
class vtkMultiProcessController;

class vtkSPHRanks
{
public:
  /** `controller` is one of MPI's. */
  explicit vtkSPHRanks(vtkMultiProcessController* controller);
  ~vtkSPHRanks();

  int GetRank() const { return this->Rank; }
  int GetCount() const { return this->Count; }

  /** Bytes that this rank has handed to others by Exchange(). */
  std::int64_t GetBytesSent() const { return this->BytesSent; }

  /**
   * True if no rank failed: `sentence` is empty everywhere. Else it becomes, on all ranks, that of
   * the first one that failed, which it names where not all say the same.
   */
  bool Agree(std::string& sentence);

  /** Of the `count` ranks on this machine, by its name, this one is number `place`. */
  void FindNeighbors(int& place, int& count);

  enum Operation
  {
    LEAST,
    GREATEST,
    SUM
  };
  void Reduce(Operation operation, double* values, int count);
  void Reduce(Operation operation, std::int64_t* values, int count);

  using Bytes = std::vector<char>;

  /** What each rank gives, in the order of ranks. */
  std::vector<Bytes> Gather(const Bytes& mine);

  /** Number i of `messages` goes to rank i; number i of the result came from rank i. */
  std::vector<Bytes> Exchange(std::vector<Bytes> messages);

private:
  vtkSPHRanks(const vtkSPHRanks&) = delete;
  void operator=(const vtkSPHRanks&) = delete;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
  vtkMPIController* Controller;
  int Rank, Count;
  std::int64_t BytesSent = 0;
};

#endif
