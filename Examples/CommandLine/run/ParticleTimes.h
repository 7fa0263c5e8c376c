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

/// Returns a number near the time with as few digits as it was given with.
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
    std::vector<std::string> Walls; ///< likewise, files of walls
  };

  /// Throws UsageError or std::runtime_error with one sentence.
  explicit ParticleTimes(const Sharing& sharing);
  ~ParticleTimes();
  ParticleTimes(const ParticleTimes&) = delete;
  void operator=(const ParticleTimes&) = delete;

  const std::vector<double>& Get() const { return this->Times; }

  /// Returns the step of that time; null if the time is between two.
  const Step* GetStored(double time) const;

  /// Lists the files that a time is made of, without walls.
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
  bool AreTold = true; ///< the times are told: by the files, a .pvd file or --time-step
  double StoredStep = 0.0; ///< the time between steps, where files store that instead; else 0
  Sharing::Particles Walls;
  std::vector<std::string>
    WallFiles; ///< the files that Walls were read from: once, if all steps have the same
  vtkSmartPointer<StoredSteps> Source;
  vtkSmartPointer<vtkSPHTemporalInterpolator> Interpolator;
};

/// Works on each time of the input, and says what happens.
class Series
{
public:
  explicit Series(Sharing& sharing);
  virtual ~Series() = default;
  Series(const Series&) = delete;
  void operator=(const Series&) = delete;

  /// If a time fails, says so and goes on with the others; returns false then.
  bool MakeAll();

protected:
  /// A step in sentences: its file, and its time where it was asked for.
  virtual std::string Label(std::size_t i) const;
  virtual void MakeStep(
    std::size_t i, vtkPointSet* particles, std::vector<std::string>& warnings) = 0;
  /// Notes that a step failed. If there is only one step, its error is the program's.
  virtual void Miss(std::size_t i, const std::string& error);
  /// Whether the times are numbers of the results, and not only the order of the steps.
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
  /// file: empty where rows are not written.
  TableSeries(Sharing& sharing, const std::string& file);

  /// Returns false if a step failed. what: things and their number, to be told at the end.
  bool Make(const std::string& what);

protected:
  /// Adds a step's rows to the text, which only the first process needs to have.
  virtual void AddRows(std::size_t i, vtkPointSet* particles) = 0;
  virtual bool IsTold(const std::string&) const { return true; } ///< of a warning
  virtual std::string Finish() { return ""; } ///< returns more to tell

  std::string Text;

private:
  void MakeStep(
    std::size_t i, vtkPointSet* particles, std::vector<std::string>& warnings) override;

  GrowingFile File;
};

#endif
