// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "SurfaceRun.h"

#include "CommandLineOptions.h"
#include "MessageCapture.h"
#include "OptionValue.h"
#include "PeriodOfData.h"
#include "SafeText.h"

#include "vtkCallbackCommand.h"
#include "vtkMarchingCorrectors.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSPHDerivatives.h"
#include "vtkSPHPeriod.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include <unistd.h>

namespace
{

/// True, and the value, where the text is a constant and not the name of an array of the input.
bool IsConstant(const std::string& text, vtkPointSet* particles, double& value)
{
  return !particles->GetPointData()->HasArray(text.c_str()) && ParseNumber(text, value);
}

void SetParticles(
  vtkSPHAlgorithm* filter, const CommandLineOptions& options, vtkPointSet* particles)
{
  double value = 0.0;
  if (options.SmoothingLength == "estimate" && !particles->GetPointData()->HasArray("estimate"))
  {
    filter->EstimateSmoothingLengthOn();
  }
  else if (IsConstant(options.SmoothingLength, particles, value))
  {
    filter->SetSmoothingLength(value);
  }
  else
  {
    filter->SetSmoothingLengthArrayName(options.SmoothingLength.c_str());
  }
  if (options.ParticleDistance > 0.0)
  {
    filter->SetSmoothingLength(options.CoefH * std::sqrt(3.0) * options.ParticleDistance);
  }
  filter->SetSmoothingLengthIsSupportRadius(options.SupportRadius);
  filter->SetVolumeArrayName(options.Volume.c_str());
  if (IsConstant(options.Mass, particles, value))
  {
    filter->SetMass(value);
  }
  else
  {
    filter->SetMassArrayName(options.Mass.c_str());
  }
  if (IsConstant(options.Density, particles, value))
  {
    filter->SetDensity(value);
  }
  else
  {
    filter->SetDensityArrayName(options.Density.c_str());
  }
  filter->SetFluidArrayName(options.FluidArray.c_str());
  filter->SetFluidValue(options.FluidValue);
  filter->SetIgnoreSolids(options.Solids == "ignore");
  filter->SetKernelByName(options.Kernel.c_str());
  filter->SetHScaleFactor(options.HScale);
}

void SetSolids(vtkMarchingCorrectors* filter, const CommandLineOptions& options)
{
  filter->SetSolids(options.Solids == "wall" ? vtkMarchingCorrectors::SOLIDS_WALL
      : options.Solids == "ignore"           ? vtkMarchingCorrectors::SOLIDS_IGNORE
      : options.Solids == "weight"           ? vtkMarchingCorrectors::SOLIDS_WEIGHT
                                             : vtkMarchingCorrectors::SOLIDS_AUTO);
  filter->SetWallShare(options.WallShare);
}

void SetDevice(vtkSPHAlgorithm* filter, const CommandLineOptions& options)
{
  filter->SetPrecision(options.Precision == "double" ? vtkAlgorithm::DOUBLE_PRECISION
                                                     : vtkAlgorithm::SINGLE_PRECISION);
  filter->SetDevice(options.Device.c_str());
  filter->SetDeviceMemoryLimit(options.MemoryLimit);
  filter->KeepDeviceDataOff();
}

void SetContour(vtkMarchingCorrectors* filter, const CommandLineOptions& options)
{
  const int count = static_cast<int>(options.IsoValues.size());
  filter->SetFreeSurface(options.FreeSurface);
  if (options.FreeSurface)
  {
    if (count > 0)
    {
      filter->SetNumberOfFreeSurfaceValues(count);
    }
    for (int i = 0; i < count; ++i)
    {
      filter->SetFreeSurfaceValue(i, options.IsoValues[static_cast<std::size_t>(i)]);
    }
    return;
  }
  filter->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, options.Scalar.c_str());
  filter->SetScalarComponent(
    options.Magnitude ? static_cast<int>(vtkMarchingCorrectors::MAGNITUDE) : options.Component);
  filter->SetNumberOfContours(count);
  for (int i = 0; i < count; ++i)
  {
    filter->SetValue(i, options.IsoValues[static_cast<std::size_t>(i)]);
  }
}

void SetMethod(vtkMarchingCorrectors* filter, const CommandLineOptions& options)
{
  filter->SetShepardNormalization(options.Field == "shepard");
  filter->SetSeedMode(
    options.Seeds == "pairs" ? vtkMarchingCorrectors::PAIRS : vtkMarchingCorrectors::COMPLETE);
  filter->SetTopology(options.Topology == "field" ? vtkMarchingCorrectors::TOPOLOGY_FIELD
                                                  : vtkMarchingCorrectors::TOPOLOGY_TABLE);
  filter->SetCubeSizeFactor(options.CubeFactor);
  filter->SetCubeSize(options.CubeSize);
  filter->SetCubeSizeMode(
    options.Cubes == "adaptive" ? vtkMarchingCorrectors::ADAPTIVE : vtkMarchingCorrectors::UNIFORM);
  filter->SetCubeLevelLimit(options.MaxLevel);
  filter->SetPartition(options.Partition == "work" ? vtkMarchingCorrectors::BY_WORK
                                                   : vtkMarchingCorrectors::BY_PARTICLES);
  filter->SetUseBox(!options.Box.empty());
  if (!options.Box.empty())
  {
    filter->SetBox(options.Box.data());
  }
  filter->SetPreview(options.Preview);
  filter->SetNodeThreshold(options.NodeThreshold);
  const bool eigenvalue = options.Boundary == "eigenvalue";
  filter->SetBoundaryDetection(
    eigenvalue ? vtkMarchingCorrectors::EIGENVALUE : vtkMarchingCorrectors::WEIGHT_SUM);
  filter->SetVertexThreshold(options.VertexThreshold >= 0.0 ? options.VertexThreshold
      : eigenvalue                                          ? 0.3
                                                            : 0.5);
  filter->SetComputeWeightSum(options.WeightSum);
  filter->SetComputeBoundaryEigenvalue(options.BoundaryEigenvalue);
  filter->SetComputeGradients(options.Gradients);
  filter->SetOutputPointsPrecision(options.OutputPrecision == "single"
      ? vtkAlgorithm::SINGLE_PRECISION
      : options.OutputPrecision == "double" ? vtkAlgorithm::DOUBLE_PRECISION
                                            : vtkAlgorithm::DEFAULT_PRECISION);
}

void SetPeriod(vtkSPHAlgorithm* filter, const CommandLineOptions& options, vtkPointSet* particles)
{
  const std::vector<double> period =
    options.DetectPeriod ? DetectPeriod(particles) : options.Periodic;
  if (!period.empty())
  {
    filter->SetPeriodicBounds(vtkSPHBoundsOfPeriod(period, particles->GetBounds()).data());
  }
}

/// The particles with the arrays that are made of one of theirs, if that is asked for, by the filter.
vtkSmartPointer<vtkPointSet> AddDerivedArrays(
  const CommandLineOptions& options, vtkPointSet* particles, vtkSPHDerivatives* filter)
{
  if (options.Derive.empty())
  {
    return particles;
  }
  SetParticles(filter, options, particles);
  SetPeriod(filter, options, particles);
  SetDevice(filter, options);
  filter->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, options.Derive.c_str());
  filter->ComputeStrainRateOn();
  filter->ReplaceArraysOn(); // the next step is to find them under their names
  filter->SetInputData(particles);
  filter->Update();
  const std::string error = filter->GetErrorMessage();
  if (!error.empty())
  {
    throw std::runtime_error(error);
  }
  auto derived = vtk::TakeSmartPointer(particles->NewInstance());
  derived->ShallowCopy(filter->GetOutput()); // the next step has the output itself
  return derived;
}

/// All arrays, or those that are named.
void SetAttributes(
  vtkSPHAlgorithm* filter, const CommandLineOptions& options, vtkPointSet* particles)
{
  const std::vector<std::string>& names = options.AttributeNames;
  vtkPointData* data = particles->GetPointData();
  filter->ClearExcludedArrays(); // of the step before
  for (const std::string& name : names)
  {
    if (!data->HasArray(name.c_str()))
    {
      throw std::runtime_error("there is no point array '" + name + "' to carry");
    }
  }
  for (int i = 0; !names.empty() && i < data->GetNumberOfArrays(); ++i)
  {
    const char* name = data->GetArrayName(i);
    if (name && std::find(names.begin(), names.end(), name) == names.end())
    {
      filter->AddExcludedArray(name);
    }
  }
}

/// Why there is none, as far as the ranges tell.
std::string ReasonForNoSurface(vtkFieldData* statistics)
{
  vtkDataArray* values = statistics->GetArray("IsoValues");
  if (!values)
  {
    return "";
  }
  vtkDataArray* range = statistics->GetArray("ScalarRange");
  std::ostringstream stream;
  const bool inBox = statistics->HasArray("Box");
  stream << "no part of the field" << (inBox ? " in the box" : "") << " reaches the iso value";
  if (values->GetNumberOfValues() == 1)
  {
    stream << " " << values->GetComponent(0, 0);
  }
  if (range)
  {
    stream << "; the particles have values from " << range->GetComponent(0, 0) << " to "
           << range->GetComponent(0, 1);
  }
  return stream.str();
}

/// The words before it come from `data`, a std::string.
void PrintProgress(vtkObject* caller, unsigned long, void* data, void*)
{
  auto* filter = static_cast<vtkAlgorithm*>(caller);
  const char* phase = filter->GetProgressText();
  std::fprintf(stderr, "\r\033[K%s%3.0f %% %s", static_cast<std::string*>(data)->c_str(),
    100.0 * filter->GetProgress(), Printable(phase ? phase : "").c_str());
  std::fflush(stderr);
}

}

//------------------------------------------------------------------------------
bool ShowsProgress(const CommandLineOptions& options)
{
  return !options.Quiet && isatty(STDERR_FILENO);
}

//------------------------------------------------------------------------------
void ShowProgress(vtkAlgorithm* filter, const CommandLineOptions& options, std::string* before)
{
  if (ShowsProgress(options))
  {
    vtkNew<vtkCallbackCommand> observer;
    observer->SetCallback(PrintProgress);
    observer->SetClientData(before);
    filter->AddObserver(vtkCommand::ProgressEvent, observer);
  }
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPointSet> SetUpParticles(vtkSPHAlgorithm* filter,
  const CommandLineOptions& options, vtkPointSet* input, vtkSPHDerivatives* derivatives)
{
  vtkNew<vtkSPHDerivatives> own;
  vtkSmartPointer<vtkPointSet> particles =
    AddDerivedArrays(options, input, derivatives ? derivatives : own.Get());
  SetParticles(filter, options, particles);
  SetPeriod(filter, options, input);
  SetDevice(filter, options);
  SetAttributes(filter, options, particles);
  return particles;
}

//------------------------------------------------------------------------------
void SetUpFilter(vtkMarchingCorrectors* filter, const CommandLineOptions& options,
  vtkPointSet* input, vtkSPHDerivatives* derivatives)
{
  vtkSmartPointer<vtkPointSet> particles = SetUpParticles(filter, options, input, derivatives);
  vtkNew<vtkPolyData> bare; // VTK would give the surface the particles' field data
  bare->SetPoints(particles->GetPoints());
  bare->GetPointData()->ShallowCopy(particles->GetPointData());
  filter->SetInputData(bare);
  filter->SetCapping(options.Capping);
  filter->SetInterpolateAttributes(options.Attributes);
  SetSolids(filter, options);
  SetContour(filter, options);
  SetMethod(filter, options);
}

//------------------------------------------------------------------------------
Run Extract(
  vtkMarchingCorrectors* filter, const CommandLineOptions& options, MessageCapture* messages)
{
  messages->Clear();
  filter->Modified();
  const auto start = std::chrono::steady_clock::now();
  filter->Update();
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  if (ShowsProgress(options))
  {
    std::fputs("\r\033[K", stderr);
  }
  const std::string error = filter->GetErrorMessage();
  if (!error.empty() || !messages->GetErrors().empty())
  {
    throw std::runtime_error(error.empty() ? messages->GetErrors().front() : error);
  }
  Run run;
  run.Surface = vtkSmartPointer<vtkPolyData>::New();
  run.Surface->ShallowCopy(filter->GetOutput());
  filter->GetOutput()->Initialize(); // not two at once: the peak of memory is a statistic
  run.Statistics->PassData(filter->GetRunStatistics());
  run.WallSeconds = elapsed.count();
  return run;
}

//------------------------------------------------------------------------------
std::vector<std::string> Warnings(
  vtkPolyData* surface, vtkFieldData* statistics, MessageCapture* messages)
{
  if (surface->GetNumberOfCells() > 0)
  {
    return messages->GetWarnings();
  }
  std::vector<std::string> all = messages->GetWarnings();
  if (all.empty())
  {
    all.push_back(ReasonForNoSurface(statistics));
  }
  all.front() = "the surface is empty" + (all.front().empty() ? "" : ": " + all.front());
  return all;
}

//------------------------------------------------------------------------------
void AddHintOfPeriod(
  const CommandLineOptions& options, vtkPointSet* particles, std::vector<std::string>& warnings)
{
  const std::string hint =
    options.Periodic.empty() && !options.DetectPeriod ? HintOfPeriod(particles) : "";
  if (!hint.empty())
  {
    warnings.push_back(hint);
  }
}
