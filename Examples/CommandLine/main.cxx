// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// The command line program: particles from a file, surface to a file. See --help.
#include "ArrayList.h"
#include "ColorScale.h"
#include "ComponentRun.h"
#include "Ending.h"
#include "Film.h"
#include "GaugeRun.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OptionValue.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "Picture.h"
#include "ProbeRun.h"
#include "RankLaunch.h"
#include "RunStatistics.h"
#include "SafeText.h"
#include "SurfaceFile.h"
#include "SurfaceRun.h"
#include "Walls.h"
#if MCOR_HAS_RANKS
#include "RankRun.h"
#endif

#include "vtkFieldData.h"
#include "vtkLogger.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkVersion.h"

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

/// The last of the runs, and what is known of all.
Run RunAndTell(const Job& job, vtkPointSet* particles, MessageCapture* messages,
  std::vector<vtkSmartPointer<vtkFieldData>>& runs, std::vector<double>& wallSeconds,
  std::vector<std::string>& warnings, ComponentTable& pieces)
{
  Run run;
  for (int i = 0; i < job.Repeat; ++i)
  {
    run.Surface = nullptr; // not two at once
    run = Extract(job, messages);
    warnings = Warnings(run, messages);
    pieces = ComponentTable(job);
    pieces.Add(run, particles, messages);
    runs.emplace_back(run.Statistics);
    wallSeconds.push_back(run.WallSeconds);
    if (!job.Quiet)
    {
      std::cout << (i == 0 ? DescribeRun(runs.back()) : "") << DescribeSeconds(runs.back())
                << std::flush;
    }
  }
  return run;
}

void MakeSurface(const Job& job, MessageCapture* messages)
{
  CheckOutputs(ListFiles(job.InputFiles(), messages),
    { job.Output, job.StatisticsFile, job.ComponentFile, job.Picture.File });
  vtkSmartPointer<vtkPointSet> particles =
    AddWalls(ReadParticles(job.Inputs.front(), messages), ReadWalls(job.Walls, messages));
  SetUpSurface(job, particles);
  std::vector<vtkSmartPointer<vtkFieldData>> runs;
  std::vector<double> wallSeconds;
  std::vector<std::string> warnings;
  ComponentTable pieces(job);
  const Run run = RunAndTell(job, particles, messages, runs, wallSeconds, warnings, pieces);
  vtkPolyData* surface = run.Surface;
  const double peakResidentBytes = PeakResidentBytes();
  AddHintOfPeriod(job, particles, warnings);
  ColorScale colors(job.Picture);
  colors.Include(surface);
  const std::string lost =
    LostArrays(job.Output, surface, colors, ArraysWithoutPlace(job, particles));
  if (!lost.empty())
  {
    warnings.push_back(lost);
  }
  for (const std::string& warning : warnings)
  {
    Say("warning: " + warning);
  }
  OutputFiles files; // both, or none
  files.Write(job.Output, SurfaceBytes(job.Output, surface, colors, messages));
  if (!job.ComponentFile.empty())
  {
    files.Write(job.ComponentFile, pieces.Text());
  }
  files.Commit();
  if (!job.StatisticsFile.empty())
  {
    std::cout.flush(); // the file may be /dev/stdout
    WriteOutput(
      job.StatisticsFile, StatisticsAsJson(job, runs, wallSeconds, warnings, peakResidentBytes));
  }
  if (!job.Picture.File.empty())
  {
    colors.Suggest(surface, job.Surface->GetIsoValueArrayName());
    colors.Include(surface);
    Picture picture(job.Picture);
    WriteOutput(
      job.Picture.File, picture.Draw(job.Picture.File, surface, particles, colors, messages));
  }
}

/// False if something failed, of which all was said.
bool Execute(Job& job)
{
  vtkNew<MessageCapture> messages;
  vtkOutputWindow::SetInstance(messages);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  if (job.ListArrays)
  {
    if (LaunchedRank() == 0)
    {
      std::cout << DescribeArrays(*ReadParticles(job.Inputs.front(), messages));
    }
    return true;
  }
#if MCOR_HAS_RANKS
  if (LaunchedCount() > 1)
  {
    return RunDistributed(job, messages);
  }
#endif
  if (job.ListDevices)
  {
    ListDevices();
    return true;
  }
  LoadDriversAhead(job.Surface->GetDevice());
  if (job.IsGauge())
  {
    return MakeGaugeTable(job, messages);
  }
  else if (job.IsProbe())
  {
    ProbePoints(job, messages);
  }
  else if (job.IsFilm())
  {
    return MakeFilm(job, messages);
  }
  else
  {
    MakeSurface(job, messages);
  }
  return true;
}

bool ParseAndExecute(int argc, char* argv[])
{
  Job job;
  ParseCommandLine(argc, argv, job);
  if ((job.Help || job.Version) && LaunchedRank() > 0)
  {
    return true;
  }
  if (job.Help)
  {
    std::cout << CommandLineHelp();
    return true;
  }
  if (job.Version)
  {
    std::cout << ProgramName << " " MCOR_PROGRAM_VERSION " (VTK " << vtkVersion::GetVTKVersion()
              << ")\n";
    return true;
  }
  const Activity running("the run failed", FaultsOfDrivers(job.Surface->GetDevice()));
  return Execute(job);
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
  PrepareForEnding();
  const int status = Status([&] { return ParseAndExecute(argc, argv); });
  AwaitDrivers();
  return Finish(status);
}
