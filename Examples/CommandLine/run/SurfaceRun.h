// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef SurfaceRun_h
#define SurfaceRun_h

#include "vtkFieldData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class MessageCapture;
class vtkPointSet;
class vtkSPHAlgorithm;
struct Job;

/// Whether standard error is a terminal whose user has not asked for silence.
bool ShowsProgress(const Job& job);

/// Makes the settings that depend on the input, for one of the job's filters. Returns the
/// particles, with the arrays derived from theirs. Throws std::runtime_error with one sentence
/// where an array is lacking.
vtkSmartPointer<vtkPointSet> SetUpParticles(
  vtkSPHAlgorithm* filter, const Job& job, vtkPointSet* input);

/// Does SetUpParticles() for the surface, which gets the particles as its input.
void SetUpSurface(const Job& job, vtkPointSet* input);

/// Arrays of the particles that are not interpolated because the surface's file could not hold
/// them.
std::vector<std::string> ArraysWithoutPlace(const Job& job, vtkPointSet* particles);

struct Run
{
  vtkSmartPointer<vtkPolyData> Surface;
  vtkSmartPointer<vtkFieldData> Statistics; // of the surface, and of what the run cost
  double WallSeconds = 0.0;
};

/// Runs a filter once, and shows its progress after the words `before`. Returns its seconds. Throws
/// std::runtime_error with the filter's sentence.
double Update(vtkSPHAlgorithm* filter, const Job& job, MessageCapture* messages,
  const std::string& before = "");

/// Runs the surface once. Throws as Update().
Run Extract(const Job& job, MessageCapture* messages, const std::string& before = "");

/// The particles of the last run with the factors of their smoothing lengths. Throws
/// std::runtime_error.
vtkSmartPointer<vtkPolyData> Widen(const Job& job, MessageCapture* messages);

/// Sentences that the user should know of a run that went well.
std::vector<std::string> Warnings(const Run& run, MessageCapture* messages);

/// Adds a hint if --periodic is not given and the particles' field data tell of a period.
void AddHintOfPeriod(const Job& job, vtkPointSet* particles, std::vector<std::string>& warnings);

#endif
