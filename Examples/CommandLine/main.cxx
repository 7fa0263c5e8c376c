// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// The command line program: particles from a file, surface to a file. See --help.
#include "CommandLineOptions.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "RunStatistics.h"
#include "SafeText.h"
#include "Supervisor.h"
#include "SurfaceFile.h"
#include "SurfacePicture.h"
#include "TemporaryCache.h"

#include "vtkCallbackCommand.h"
#include "vtkFieldData.h"
#include "vtkLogger.h"
#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkVersion.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <functional>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <unistd.h>

namespace
{

const char* const ProgramName = "marching-correctors";

/// Errors and warnings: one line, whatever names and files have put into them.
void Say(const std::string& sentence)
{
  std::cerr << ProgramName << ": " << Printable(sentence) << "\n";
}

bool ShowsProgress(const CommandLineOptions& options)
{
  return !options.Quiet && isatty(STDERR_FILENO);
}

void ShowProgress(vtkObject* caller, unsigned long, void*, void*)
{
  auto* filter = static_cast<vtkMarchingCorrectors*>(caller);
  const char* phase = filter->GetProgressText();
  std::fprintf(stderr, "\r\033[K%3.0f %% %s", 100.0 * filter->GetProgress(),
    Printable(phase ? phase : "").c_str());
  std::fflush(stderr);
}

/// True, and the value, where the text is a constant and not the name of an array of the input.
bool IsConstant(const std::string& text, vtkPointSet* particles, double& value)
{
  return !particles->GetPointData()->HasArray(text.c_str()) && ParseNumber(text, value);
}

void SetParticles(
  vtkMarchingCorrectors* filter, const CommandLineOptions& options, vtkPointSet* particles)
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
  filter->SetIgnoreSolids(options.IgnoreSolids);
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
  filter->SetKernelByName(options.Kernel.c_str());
  filter->SetShepardNormalization(options.Field == "shepard");
  filter->SetSeedMode(
    options.Seeds == "pairs" ? vtkMarchingCorrectors::PAIRS : vtkMarchingCorrectors::COMPLETE);
  filter->SetTopology(options.Topology == "field" ? vtkMarchingCorrectors::TOPOLOGY_FIELD
                                                  : vtkMarchingCorrectors::TOPOLOGY_TABLE);
  filter->SetPrecision(options.Precision == "double" ? vtkAlgorithm::DOUBLE_PRECISION
                                                     : vtkAlgorithm::SINGLE_PRECISION);
  filter->SetHScaleFactor(options.HScale);
  filter->SetCubeSizeFactor(options.CubeFactor);
  filter->SetCubeSize(options.CubeSize);
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
  filter->SetDevice(options.Device.c_str());
  filter->SetDeviceMemoryLimit(options.MemoryLimit);
  filter->KeepDeviceDataOff();
}

/// All arrays, none, or those that are named.
void SetAttributes(
  vtkMarchingCorrectors* filter, const CommandLineOptions& options, vtkPointSet* particles)
{
  const std::vector<std::string>& names = options.AttributeNames;
  vtkPointData* data = particles->GetPointData();
  filter->SetInterpolateAttributes(options.Attributes);
  for (const std::string& name : names)
  {
    if (!data->HasArray(name.c_str()))
    {
      throw std::runtime_error("there is no point array '" + name + "' to carry to the surface");
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

struct Run
{
  vtkSmartPointer<vtkPolyData> Surface;
  vtkNew<vtkFieldData> Statistics; // of the surface, and of what the run cost
  double WallSeconds = 0.0;
};

/// One run, from scratch but for the program on the device. Throws std::runtime_error with the
/// filter's sentence.
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
  run.Statistics->PassData(run.Surface->GetFieldData());
  run.Statistics->PassData(filter->GetRunStatistics());
  run.WallSeconds = elapsed.count();
  return run;
}

void Warn(vtkPolyData* surface, MessageCapture* messages)
{
  if (surface->GetNumberOfCells() > 0)
  {
    for (const std::string& warning : messages->GetWarnings())
    {
      Say("warning: " + warning);
    }
    return;
  }
  std::string why;
  if (!messages->GetWarnings().empty())
  {
    why = messages->GetWarnings().front();
  }
  else if (vtkDataArray* values = surface->GetFieldData()->GetArray("IsoValues"))
  {
    vtkDataArray* range = surface->GetFieldData()->GetArray("ScalarRange");
    std::ostringstream stream;
    stream << "no part of the field reaches the iso value";
    if (values->GetNumberOfValues() == 1)
    {
      stream << " " << values->GetComponent(0, 0);
    }
    if (range)
    {
      stream << "; the particles have values from " << range->GetComponent(0, 0) << " to "
             << range->GetComponent(0, 1);
    }
    why = stream.str();
  }
  Say("warning: the surface is empty" + (why.empty() ? "" : ": " + why));
}

void ListDevices()
{
  const std::string devices = vtkMarchingCorrectors::ListDevices();
  if (devices.empty())
  {
    throw std::runtime_error("there is no OpenCL device; a CPU becomes one with PoCL (Debian: "
                             "pocl-opencl-icd)");
  }
  std::istringstream lines(devices);
  for (std::string line; std::getline(lines, line);)
  {
    std::cout << Printable(line) << "\n";
  }
}

/// No file is written over another, and all can be written: said before the work, not after it.
void CheckFiles(const CommandLineOptions& options)
{
  std::vector<std::string> outputs;
  for (const std::string& file : { options.Output, options.StatisticsFile, options.PictureFile })
  {
    if (!file.empty())
    {
      outputs.push_back(file);
    }
  }
  try
  {
    CheckOutputs(options.Input, outputs);
  }
  catch (const std::invalid_argument& error)
  {
    throw UsageError(error.what());
  }
}

void Execute(const CommandLineOptions& options)
{
  vtkNew<MessageCapture> messages;
  vtkOutputWindow::SetInstance(messages);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  if (options.ListDevices)
  {
    ListDevices();
    return;
  }
  CheckFiles(options);
  vtkSmartPointer<vtkPointSet> particles = ReadParticles(options.Input, messages);
  vtkNew<vtkMarchingCorrectors> filter;
  SetParticles(filter, options, particles);
  SetContour(filter, options);
  SetMethod(filter, options);
  SetAttributes(filter, options, particles);
  filter->SetInputData(particles);
  if (ShowsProgress(options))
  {
    vtkNew<vtkCallbackCommand> observer;
    observer->SetCallback(ShowProgress);
    filter->AddObserver(vtkCommand::ProgressEvent, observer);
  }
  std::vector<vtkSmartPointer<vtkFieldData>> runs;
  std::vector<double> wallSeconds;
  vtkSmartPointer<vtkPolyData> surface;
  for (int i = 0; i < options.Repeat; ++i)
  {
    surface = nullptr;
    Run run = Extract(filter, options, messages);
    surface = run.Surface;
    runs.emplace_back(run.Statistics);
    wallSeconds.push_back(run.WallSeconds);
    if (!options.Quiet)
    {
      std::cout << (i == 0 ? DescribeRun(runs.back()) : "") << DescribeSeconds(runs.back())
                << std::flush;
    }
  }
  Warn(surface, messages);
  const double peakResidentBytes = PeakResidentBytes(); // of reading and extracting alone
  WriteSurface(options.Output, surface, messages);
  if (!options.StatisticsFile.empty())
  {
    std::cout.flush(); // the file may be /dev/stdout
    WriteOutput(
      options.StatisticsFile, StatisticsAsJson(options, runs, wallSeconds, peakResidentBytes));
  }
  if (!options.PictureFile.empty())
  {
    WritePicture(options.PictureFile, surface, particles, messages);
  }
}

/// Exit status and sentence of what `run` throws, or of standard output that cannot be written.
int Status(const std::function<void()>& run)
{
  try
  {
    run();
    std::cout.flush();
    if (!std::cout)
    {
      throw std::runtime_error("standard output could not be written");
    }
  }
  catch (const UsageError& error)
  {
    Say(std::string(error.what()) + " (see --help)");
    return 2;
  }
  catch (const std::bad_alloc&)
  {
    Say("host memory ran out");
    return 1;
  }
  catch (const std::exception& error)
  {
    Say(error.what());
    return 1;
  }
  return 0;
}

/// A file opened by this program must not become its standard output, where that was closed.
void OpenStandardStreams()
{
  int descriptor = 0;
  while (descriptor >= 0 && descriptor <= STDERR_FILENO)
  {
    descriptor = open("/dev/null", O_RDWR);
  }
  close(descriptor);
}

}

int main(int argc, char* argv[])
{
  OpenStandardStreams();
  CommandLineOptions options;
  const int status = Status(
    [&]
    {
      options = ParseCommandLine(argc, argv);
      if (options.Help)
      {
        std::cout << CommandLineHelp();
      }
      else if (options.Version)
      {
        std::cout << ProgramName << " " MCOR_PROGRAM_VERSION " (VTK " << vtkVersion::GetVTKVersion()
                  << ")\n";
      }
    });
  if (status != 0 || options.Help || options.Version)
  {
    return status;
  }
  TemporaryCache cache;
  return RunSupervised([&] { return Status([&] { Execute(options); }); }, [&] { cache.Remove(); });
}
