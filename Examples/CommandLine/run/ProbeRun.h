// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ProbeRun_h
#define ProbeRun_h

#include "vtkSmartPointer.h"

class MessageCapture;
class vtkDataSet;
class vtkPointSet;
struct Job;

/// Evaluates the field at the points of a file, of a slice or of a line, and writes their data set with the
/// arrays. Throws UsageError or std::runtime_error with one sentence.
void ProbePoints(const Job& job, MessageCapture* messages);

/// What is said before the work. Throws UsageError where the output would replace an input.
void CheckProbeFiles(const Job& job, MessageCapture* messages);

/// The points of the file, or nullptr where there is none. Throws std::runtime_error.
vtkSmartPointer<vtkDataSet> ReadPoints(const Job& job, MessageCapture* messages);

/// Those of a slice or a line, which needs the bounds of all particles. Throws std::runtime_error.
vtkSmartPointer<vtkDataSet> MakePoints(const Job& job, vtkPointSet* particles);

/// As SetUpSurface() of SurfaceRun.h.
void SetUpProbe(const Job& job, vtkDataSet* points, vtkPointSet* particles);

/// Returns the seconds that it took. Throws std::runtime_error with the filter's sentence.
double RunProbe(const Job& job, MessageCapture* messages);

/// Says how many points are valid, and what the user should know.
void ReportProbe(const Job& job, double seconds, MessageCapture* messages);

#endif
