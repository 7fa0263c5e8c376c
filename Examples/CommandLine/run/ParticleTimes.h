// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ParticleTimes_h
#define ParticleTimes_h

#include "OutputFile.h"
#include "Sharing.h"

#include <string>
#include <vector>

class StoredSteps;
class vtkSPHTemporalInterpolator;

/// Returns the time as text, with as few digits as it was given with.
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

  /// Throws UsageError or std::runtime_error with one sentence.
  explicit ParticleTimes(const Sharing& sharing);
  ~ParticleTimes();
  ParticleTimes(const ParticleTimes&) = delete;
  void operator=(const ParticleTimes&) = delete;

  const std::vector<double>& Get() const { return this->Times; }

  /// Returns the step at this time; null if the time is between two steps.
  const Step* GetStored(double time) const;

  /// Lists the files from which the particles at a time are made, without walls.
  std::vector<std::string> ListFiles(double time) const;

  /// Opens all files that will be read, see OpenSources().
  void OpenFiles() const;

  /// Returns a warning if neither the files nor the user tell the times of several steps, which
  /// tables need. Names the time between steps if velocities tell it.
  std::string CheckTold();

  /// Returns the particles at a time. If this throws std::runtime_error, call Reset(), so that
  /// nothing is left of the failure.
  Sharing::Particles At(double time, std::vector<std::string>& warnings);
  void Reset();

private:
  /// Lists the steps of files given one by one, and notes whether their times are told.
  std::vector<Step> GivenSteps(std::vector<std::string>& warnings);

  const Sharing& Shared;
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

/// Works on each time of the input, and reports progress and failures.
class Series
{
public:
  explicit Series(Sharing& sharing);
  virtual ~Series() = default;
  Series(const Series&) = delete;
  void operator=(const Series&) = delete;

  /// If a time fails, reports it, goes on with the others, and returns false at the end.
  bool MakeAll();

protected:
  /// Returns what sentences call a step: its file, and its time if the user asked for times.
  virtual std::string Label(std::size_t i) const;
  virtual void MakeStep(
    std::size_t i, vtkPointSet* particles, std::vector<std::string>& warnings) = 0;
  /// Notes that a step failed. If there is only one step, its error is the program's.
  virtual void Miss(std::size_t i, const std::string& error);
  /// Whether results contain the times. If not, times only order the steps.
  virtual bool IsOfTimes() const { return true; }
  /// Returns the words in front of a step's line of progress.
  std::string Progress(std::size_t i) const;

  Sharing& Shared;
  const Job& Options;
  ParticleTimes Times;
};

/// Makes a table, some rows for each time, which is written as it grows.
class TableSeries : public Series
{
public:
  /// file: empty if rows are not written.
  TableSeries(Sharing& sharing, const std::string& file);

  /// Returns false if a step failed. what: what was measured, for the message at the end.
  bool Make(const std::string& what);

protected:
  /// Adds a step's rows to the text, which only the first process needs to have.
  virtual void AddRows(std::size_t i, vtkPointSet* particles) = 0;
  virtual bool IsTold(const std::string&) const { return true; } ///< whether a warning is told
  virtual std::string Finish() { return ""; } ///< returns more text for the message

  std::string Text;

private:
  void MakeStep(
    std::size_t i, vtkPointSet* particles, std::vector<std::string>& warnings) override;

  GrowingFile File;
};

#endif
