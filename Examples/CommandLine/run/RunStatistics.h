// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RunStatistics_h
#define RunStatistics_h

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

struct Job;
class vtkFieldData;

/// The form with the run's values for names in braces, {Area}, {ScalarRange:1}: texts, also the
/// array of a quantity that has one, and numbers, counts in full, everything else with six digits.
/// [A|B|C] is the first one of these whose names all have values, or nothing.
std::string Fill(vtkFieldData* run, const std::string& form);

/// Describes a run's field data in a few lines; empty if the run had no particles to use.
std::string DescribeRun(vtkFieldData* run);

/// "seconds     input 0.010, search grid 0.020, ..., total 0.500\n", or empty as above.
std::string DescribeSeconds(vtkFieldData* run);

/// The statistics of the last of `runs` as JSON, with the seconds of each. wallSeconds has one
/// entry per run: the time of the filter as a whole, with what VTK adds to the phases.
std::string StatisticsAsJson(const Job& job, const std::vector<vtkSmartPointer<vtkFieldData>>& runs,
  const std::vector<double>& wallSeconds, const std::vector<std::string>& warnings,
  double peakResidentBytes);

/// Report on one step of a film.
struct FilmStep
{
  double Time = 0.0;
  std::vector<std::string> Inputs; ///< the files of the step, or of the two steps around the time
  std::string Output;
  std::string Error;      ///< one sentence; empty: the surface was written
  std::string Statistics; ///< as StepAsJson() gives it
};

/// Reports a step whose surface was written (run is not null), or that failed.
std::string StepAsJson(const FilmStep& step, vtkFieldData* run, double wallSeconds);

/// `run` is the last one that went well, or null.
std::string FilmAsJson(const Job& job, const std::vector<FilmStep>& steps, vtkFieldData* run);

/// The most memory that this process has had so far; 0 where the system does not tell.
double PeakResidentBytes();

#endif
