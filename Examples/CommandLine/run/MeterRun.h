// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef MeterRun_h
#define MeterRun_h

#include "vtkSPHMeter.h"

#include <functional>
#include <string>

class MessageCapture;
class Sharing;
class vtkPointSet;
class vtkTable;
struct Job;

/// A measurement at each time of the input.
struct MeterTask
{
  vtkSPHMeter* Meter;
  std::string Places; ///< how many there are: "2 gauges"
  /// Completes the table of a time, on all processes; may be empty.
  std::function<void(vtkTable* table, double time)> Finish;
  /// Writes the only table in another form; may be empty: OUTPUT is a .csv file.
  std::function<void(vtkTable* table)> WriteImage;
};

/// The meter's table; shows its progress behind the words `progress`. Throws std::runtime_error.
vtkTable* MeasureWith(vtkSPHMeter* meter, const Job& job, vtkPointSet* particles, double time,
  MessageCapture* messages, const std::string& progress);

/// Measures at each time of the input, and writes the table. False if a step failed, of which all was said; the
/// table has the others. Throws UsageError or std::runtime_error with one sentence.
bool MakeMeterTable(
  const Job& job, const MeterTask& task, MessageCapture* messages, Sharing& sharing);

#endif
