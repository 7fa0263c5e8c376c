// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ParticleTimes_h
#define ParticleTimes_h

#include "ParticleSteps.h"

#include "vtkNew.h"
#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class MessageCapture;
class vtkPointSet;
class vtkSPHTemporalInterpolator;
struct Job;

/// A number of a time, with the digits that it was given with.
std::string TimeText(double time);

/// The particles of a series at the times that it stores, or those that are asked for, between two
/// steps.
class ParticleTimes
{
public:
  using Steps = std::vector<ParticleSteps::Step>;

  /// Throws UsageError or std::runtime_error with one sentence.
  ParticleTimes(const Job& job, MessageCapture* messages);
  ~ParticleTimes();
  ParticleTimes(const ParticleTimes&) = delete;
  void operator=(const ParticleTimes&) = delete;

  const std::vector<double>& Get() const { return this->Times; }

  /// Whether that time is one of the series, and not between two.
  bool IsStored(double time) const;

  /// Lists all files that are read.
  std::vector<std::string> ListFiles() const;

  /// Files that a time is made of, without walls.
  std::vector<std::string> ListFiles(double time) const;

  /// The walls of a time that is stored, or of all times.
  const std::vector<std::string>& ListWalls(double time) const;

  /// Returns the particles at a time. Throws std::runtime_error; call Reset() then, so that nothing
  /// is left of the failure.
  vtkSmartPointer<vtkPointSet> At(double time, std::vector<std::string>& warnings);
  void Reset();

private:
  MessageCapture* const Messages;
  const bool HasTimes; ///< of their own, in a .pvd file
  const std::string Ids;
  std::vector<std::string> Notes; ///< what is said of the list of steps
  const Steps Stored;
  const std::vector<double> Times;
  vtkSmartPointer<vtkPointSet> Walls;
  std::vector<std::string>
    WallFiles; ///< that Walls were read from: once where all steps have the same
  vtkSmartPointer<ParticleSteps> Source;
  vtkSmartPointer<vtkSPHTemporalInterpolator> Interpolator;
};

#endif
