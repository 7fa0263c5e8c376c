// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ParticleTimes_h
#define ParticleTimes_h

#include "Sharing.h"

#include <string>
#include <vector>

class StoredSteps;
class vtkSPHTemporalInterpolator;

/// A number of a time, with the digits that it was given with.
std::string TimeText(double time);

/// The particles of a series at the times that it stores, or those that are asked for, between two
/// steps.
class ParticleTimes
{
public:
  struct Step
  {
    double Time;
    std::vector<std::string> Files; ///< parts of one set of particles
    std::vector<std::string> Walls; ///< likewise, of walls beside these
  };

  /// Throws UsageError or std::runtime_error with one sentence.
  explicit ParticleTimes(const Sharing& sharing);
  ~ParticleTimes();
  ParticleTimes(const ParticleTimes&) = delete;
  void operator=(const ParticleTimes&) = delete;

  const std::vector<double>& Get() const { return this->Times; }

  /// The step of that time; null where it is between two.
  const Step* GetStored(double time) const;

  /// Files that a time is made of, without walls.
  std::vector<std::string> ListFiles(double time) const;

  /// Opens all that is read, see OpenSources().
  void OpenFiles() const;

  /// A sentence where the times of several steps are nobody's: of tables, in which they count. Says
  /// what they should be, where velocities tell.
  std::string CheckTold();

  /// Returns the particles at a time. Throws std::runtime_error; call Reset() then, so that nothing
  /// is left of the failure.
  Sharing::Particles At(double time, std::vector<std::string>& warnings);
  void Reset();

private:
  const Sharing& Shared;
  std::vector<Step> Steps; ///< in the order of time
  std::vector<double> Times;
  bool AreTold = true; ///< by the files, a .pvd file or --time-step
  Sharing::Particles Walls;
  std::vector<std::string>
    WallFiles; ///< that Walls were read from: once where all steps have the same
  vtkSmartPointer<StoredSteps> Source;
  vtkSmartPointer<vtkSPHTemporalInterpolator> Interpolator;
};

/// Work on each time of the input, and what is said of it.
class Series
{
public:
  explicit Series(Sharing& sharing);
  virtual ~Series() = default;
  Series(const Series&) = delete;
  void operator=(const Series&) = delete;

  /// Where a time fails, says so, and does the others; returns false then.
  bool MakeAll();

protected:
  /// A step in sentences: its file, and its time where it was asked for.
  virtual std::string Label(std::size_t i) const;
  virtual void MakeStep(
    std::size_t i, vtkPointSet* particles, std::vector<std::string>& warnings) = 0;
  /// Takes note of a step that failed. The error of an only one is that of the program.
  virtual void Miss(std::size_t i, const std::string& error);
  /// Whether the times are numbers of the results, and not only the order of the steps.
  virtual bool IsOfTimes() const { return true; }

  Sharing& Shared;
  const Job& Options;
  ParticleTimes Times;
};

#endif
