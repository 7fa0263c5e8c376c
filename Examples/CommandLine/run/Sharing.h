// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Sharing_h
#define Sharing_h

#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <functional>
#include <string>
#include <vector>

class MessageCapture;
class ParticleTimes;

/// Hides whether processes share the work; this class is that of one process. If one of them
/// throws, all throw.
class Sharing
{
public:
  virtual ~Sharing() = default;

  virtual int GetRank() const { return 0; }
  virtual int GetCount() const { return 1; }

  /// The one that writes, and tells.
  bool IsFirst() const { return this->GetRank() == 0; }

  /// Does work on all processes, which may differ.
  virtual void OnAll(const std::function<void()>& work) { work(); }

  void OnFirst(const std::function<void()>& work)
  {
    this->OnAll(this->IsFirst() ? work : [] {});
  }

  /// This process's part of the particles of a file, and of walls.
  virtual vtkSmartPointer<vtkPointSet> Read(
    const std::string& file, const std::vector<std::string>& walls, MessageCapture* messages);

  /// Reads a time, as Read() above reads files.
  virtual vtkSmartPointer<vtkPointSet> Read(
    ParticleTimes& times, double time, std::vector<std::string>& warnings);

  /// The whole surface on the first process, null on others.
  virtual vtkSmartPointer<vtkPolyData> Merge(vtkPolyData* part) { return part; }

  /// The particles of all processes, in their order, on the first process.
  virtual vtkSmartPointer<vtkPolyData> Append(vtkPolyData* particles) { return particles; }
};

/// The environment tells of mpirun before MPI is asked. Built without MPI, there is none.

/// Returns the number of processes that mpirun started; 1 without mpirun.
int LaunchedCount();

/// The number of this process, 0 where it was started alone.
int LaunchedRank();

#endif
