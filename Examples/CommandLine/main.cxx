// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// The command line program: particles from a file, surface to a file. See --help.
#include "CommandLineOptions.h"
#include "Film.h"
#include "FilmRecord.h"
#include "MessageCapture.h"
#include "OptionValue.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "ProbeRun.h"
#include "RankLaunch.h"
#include "RunStatistics.h"
#include "SafeText.h"
#include "Supervisor.h"
#include "SurfaceFile.h"
#include "SurfacePicture.h"
#include "SurfaceRun.h"
#if MCOR_HAS_RANKS
#include "RankRun.h"
#endif

#include "vtkFieldData.h"
#include "vtkLogger.h"
#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkVersion.h"

#include <exception>
#include <functional>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <unistd.h>

namespace
{

const char* const ProgramName = "marching-correctors";

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
    CheckOutputs(options.Inputs, outputs);
  }
  catch (const std::invalid_argument& error)
  {
    throw UsageError(error.what());
  }
}

void MakeSurface(const CommandLineOptions& options, MessageCapture* messages)
{
  CheckFiles(options);
  vtkSmartPointer<vtkPointSet> particles = ReadParticles(options.Inputs.front(), messages);
  vtkNew<vtkMarchingCorrectors> filter;
  SetUpFilter(filter, options, particles);
  std::string nothing;
  ShowProgress(filter, options, &nothing);
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
  std::vector<std::string> warnings = Warnings(surface, runs.back(), messages);
  AddHintOfPeriod(options, particles, warnings);
  for (const std::string& warning : warnings)
  {
    Say("warning: " + warning);
  }
  const double peakResidentBytes = PeakResidentBytes(); // of reading and extracting alone
  WriteSurface(options.Output, surface, messages);
  if (!options.StatisticsFile.empty())
  {
    std::cout.flush(); // the file may be /dev/stdout
    WriteOutput(options.StatisticsFile,
      StatisticsAsJson(options, runs, wallSeconds, warnings, peakResidentBytes));
  }
  if (!options.PictureFile.empty())
  {
    WritePicture(options.PictureFile, surface, particles, messages);
  }
}

/// From the part `first` of the work on. False if something failed, of which all was said.
bool Execute(const CommandLineOptions& options, int first, FilmRecord* record)
{
  vtkNew<MessageCapture> messages;
  vtkOutputWindow::SetInstance(messages);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
#if MCOR_HAS_RANKS
  if (LaunchedCount() > 1)
  {
    return RunTogether(options, messages);
  }
#endif
  if (record)
  {
    return MakeFilm(options, first, *record, messages);
  }
  if (options.ListDevices)
  {
    ListDevices();
  }
  else if (!options.Probe.empty())
  {
    ProbePoints(options, messages);
  }
  else
  {
    MakeSurface(options, messages);
  }
  return true;
}

/// Exit status and sentence of what `run` throws, or of standard output that cannot be written.
int Status(const std::function<bool()>& run)
{
  bool good = false;
  try
  {
    good = run();
    std::cout.flush();
    if (!std::cout)
    {
      throw std::runtime_error("standard output could not be written");
    }
  }
  catch (const UsageError& error)
  {
    if (LaunchedRank() == 0) // all of them say the same
    {
      Say(std::string(error.what()) + " (see --help)");
    }
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
  return good ? 0 : 1;
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
  std::unique_ptr<FilmRecord> record;
  const int status = Status(
    [&]
    {
      options = ParseCommandLine(argc, argv);
      if ((options.Help || options.Version) && LaunchedRank() > 0)
      {
      }
      else if (options.Help)
      {
        std::cout << CommandLineHelp();
      }
      else if (options.Version)
      {
        std::cout << ProgramName << " " MCOR_PROGRAM_VERSION " (VTK " << vtkVersion::GetVTKVersion()
                  << ")\n";
      }
      else if (!options.ListDevices && IsFilm(options))
      {
        record.reset(new FilmRecord); // here, for all processes that take part
      }
      return true;
    });
  if (status != 0 || options.Help || options.Version)
  {
    return status;
  }
  return RunSupervised([&](int first)
    { return Status([&] { return Execute(options, first, record.get()); }); });
}
