// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef SurfaceRun_h
#define SurfaceRun_h

#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class MessageCapture;
class vtkAlgorithm;
class vtkMarchingCorrectors;
class vtkPointSet;
class vtkSPHAlgorithm;
class vtkSPHDerivatives;
struct CommandLineOptions;

/// Whether standard error is a terminal whose user has not asked for silence.
bool ShowsProgress(const CommandLineOptions& options);

/// Shows the filter's progress there. `before` is printed before it; it may change between runs.
void ShowProgress(vtkAlgorithm* filter, const CommandLineOptions& options, std::string* before);

/// What describes the particles, the arrays to carry and the device, as the options say. Returns the
/// particles, with the arrays derived from theirs by the last one, or by a new one. Throws as SetUpFilter().
vtkSmartPointer<vtkPointSet> SetUpParticles(vtkSPHAlgorithm* filter,
  const CommandLineOptions& options, vtkPointSet* input, vtkSPHDerivatives* derivatives = nullptr);

/// The filter's particles, with the arrays derived from theirs, and properties as the options say. Throws std::runtime_error with one
/// sentence where the particles lack an array that is to be carried.
void SetUpFilter(vtkMarchingCorrectors* filter, const CommandLineOptions& options,
  vtkPointSet* input, vtkSPHDerivatives* derivatives = nullptr);

struct Run
{
  vtkSmartPointer<vtkPolyData> Surface;
  vtkNew<vtkFieldData> Statistics; // of the surface, and of what the run cost
  double WallSeconds = 0.0;
};

/// One run. Throws std::runtime_error with the filter's sentence.
Run Extract(
  vtkMarchingCorrectors* filter, const CommandLineOptions& options, MessageCapture* messages);

/// What the user should know of a run that went well, one sentence each.
std::vector<std::string> Warnings(
  vtkPolyData* surface, vtkFieldData* statistics, MessageCapture* messages);

/// Where --periodic is not given, and the particles' field data may tell of a period: that.
void AddHintOfPeriod(
  const CommandLineOptions& options, vtkPointSet* particles, std::vector<std::string>& warnings);

#endif
