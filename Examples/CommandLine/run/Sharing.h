// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Sharing_h
#define Sharing_h

#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <functional>
#include <memory>
#include <string>

struct Job;

/// A job, and how processes share its work; this base class is for one process alone. If one
/// process throws, all throw.
class Sharing
{
public:
  using Particles = vtkSmartPointer<vtkPointSet>;

  explicit Sharing(Job& job)
    : Options(job)
  {
  }
  virtual ~Sharing() = default;
  Sharing(const Sharing&) = delete;
  void operator=(const Sharing&) = delete;

  virtual int GetRank() const { return 0; }
  virtual int GetCount() const { return 1; }

  /// Whether this process writes the files and prints the messages.
  bool IsFirst() const { return this->GetRank() == 0; }

  /// Calls work() on all processes. Each process may have another `work`.
  virtual void OnAll(const std::function<void()>& work) { work(); }

  void OnFirst(const std::function<void()>& work)
  {
    this->OnAll(this->IsFirst() ? work : [] {});
  }

  /// Returns this process's part of the particles that read() gives. If `file` is not empty, this file
  /// holds all the particles, and each process may read a part of the file instead. Throws if there
  /// are no particles, unless `mayBeEmpty`.
  virtual Particles Read(const std::string& /*file*/, bool /*mayBeEmpty*/,
    const std::function<Particles()>& read)
  {
    return read();
  }

  /// Reads the particles of the only input, and its walls, see Read().
  Particles ReadInput();

  /// Returns the whole surface on the first process, null on others.
  virtual vtkSmartPointer<vtkPolyData> Merge(vtkPolyData* part) { return part; }

  /// Returns the particles of all processes, in the order of processes, on the first process.
  virtual Particles Append(vtkPointSet* particles) { return particles; }

  Job& Options;
};

/// Returns how many processes mpirun started (1 without mpirun), and the number of this one. mpirun's
/// environment variables tell this before MPI begins. In a build without MPI there is one process.
///@{
int LaunchedCount();
int LaunchedRank();
///@}

/// Begins MPI for a job that processes share; MPI ends with the object. Call this once in a
/// process. Returns null in a build without MPI.
std::unique_ptr<Sharing> NewRankSession(Job& job);

#endif
