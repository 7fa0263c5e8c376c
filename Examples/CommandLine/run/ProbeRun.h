// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ProbeRun_h
#define ProbeRun_h

class MessageCapture;
class vtkDataSet;
class vtkPointSet;
class vtkSPHProbe;
struct CommandLineOptions;

/// Evaluates the field at the points of a file and writes their data set with the arrays. Throws
/// UsageError or std::runtime_error with one sentence.
void ProbePoints(const CommandLineOptions& options, MessageCapture* messages);

/// Throws std::invalid_argument where the output would replace an input.
void CheckProbeFiles(const CommandLineOptions& options);

/// As SetUpFilter() of SurfaceRun.h.
void SetUpProbe(vtkSPHProbe* probe, const CommandLineOptions& options, vtkDataSet* points,
  vtkPointSet* particles);

/// Returns the seconds that it took. Throws std::runtime_error with the filter's sentence.
double RunProbe(vtkSPHProbe* probe, const CommandLineOptions& options, MessageCapture* messages);

/// Says how many points are valid, and what the user should know.
void ReportProbe(
  vtkSPHProbe* probe, const CommandLineOptions& options, double seconds, MessageCapture* messages);

#endif
