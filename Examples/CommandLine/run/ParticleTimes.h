// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ParticleTimes_h
#define ParticleTimes_h

#include "Sharing.h"

#include <functional>
#include <string>
#include <vector>

class StoredSteps;
class vtkSPHTemporalInterpolator;

/// Returns the time as text, rounded to 12 digits, without trailing zeros.
std::string TimeText(double time);

/// The particles of a series at stored times, or at requested times, also between two steps.
class ParticleTimes
{
public:
  struct Step
  {
    double Time;
    std::vector<std::string> Files; ///< parts of one set of particles
    std::vector<std::string> Walls; ///< files of the walls at this step
  };

  /// What ForEach() passes to the work for one time: the particles, and texts for messages.
  struct Moment
  {
    std::size_t Number;
    double Time;
    std::string Label;    ///< what sentences call it
    std::string Progress; ///< stands in front of the line of progress
    Sharing::Particles Particles;
    std::vector<std::string> Warnings; ///< the work adds its own
    std::string Error;                 ///< why reading or the work failed
  };

  /// Throws UsageError or std::runtime_error with one sentence.
  explicit ParticleTimes(Sharing& sharing);
  ~ParticleTimes();
  ParticleTimes(const ParticleTimes&) = delete;
  void operator=(const ParticleTimes&) = delete;

  const std::vector<double>& Get() const { return this->Times; }

  /// Lists the files from which the particles at a time are made, without walls.
  std::vector<std::string> ListFiles(double time) const;

  /// Makes all files that will be read known to IsSource(), and checks the outputs.
  void CheckFiles(const std::vector<std::string>& outputs) const;

  /// Calls work() for each time. outputs: the file of each time, or empty. If a time fails, prints why, calls
  /// miss(), goes on with the other times, and returns false at the end.
  bool ForEach(const std::vector<std::string>& outputs, const std::function<void(Moment&)>& work,
    const std::function<void(const Moment&)>& miss);

private:
  /// Lists the steps if the inputs are files of particles, not a list of files. Also sets AreTold and StoredStep, see below.
  std::vector<Step> GivenSteps(std::vector<std::string>& warnings);

  /// Warns if neither the files nor the user tell the times of several steps, which tables need.
  /// The warning names the time between steps if velocities tell it.
  void CheckTold();

  /// Returns the particles at a time. If this throws std::runtime_error, call Reset(), which
  /// drops what the failure has left.
  Sharing::Particles At(double time, std::vector<std::string>& warnings);
  void Reset();

  Sharing& Shared;
  std::vector<Step> Steps; ///< in the order of time
  std::vector<double> Times;
  bool AreTold = true; ///< whether the files, a .pvd file or --time-step tell the times
  double StoredStep = 0.0; ///< the time between steps, if files store only this; else 0
  Sharing::Particles Walls;
  std::vector<std::string>
    WallFiles; ///< the files that Walls were read from; they are kept while steps have the same
  vtkSmartPointer<StoredSteps> Source;
  vtkSmartPointer<vtkSPHTemporalInterpolator> Interpolator;
};

/// Whether a warning tells of gauges or sections outside of all fluid.
bool TellsOfDryPlaces(const std::string& warning);

/// Writes a table that grows with each time; with --gauge-grid, only finish() writes. Returns false if some
/// steps failed, but not all; throws if all failed. addRows() appends a moment's rows to the text; only
/// the first process' text is written. The message at the end is made of `what`, the number of steps, and the text from finish().
bool MakeTable(Sharing& sharing, const std::string& what,
  const std::function<void(ParticleTimes::Moment& moment, std::string& text)>& addRows,
  const std::function<std::string()>& finish);

#endif
