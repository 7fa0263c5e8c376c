// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// The command line program: particles from a file, surface to a file. See --help.
#include "ColorScale.h"
#include "DataFile.h"
#include "Ending.h"
#include "Extra.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OptionValue.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "Picture.h"
#include "RunStatistics.h"
#include "Runs.h"
#include "SafeText.h"
#include "Sharing.h"
#if MCOR_HAS_RANKS
#include "RankSession.h"
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

/// Lists the outputs of a process; to the first one, those of all.
std::vector<std::string> ListOutputs(const Job& job, const Sharing& sharing)
{
  std::vector<std::string> outputs;
  for (int rank = 0; IsInPieces(job.Output) && rank < sharing.GetCount(); ++rank)
  {
    if (sharing.IsFirst() || rank == sharing.GetRank())
    {
      outputs.push_back(PieceName(job.Output, rank));
    }
  }
  if (sharing.IsFirst())
  {
    outputs.insert(outputs.end(),
      { job.Output, job.StatisticsFile, job.ComponentFile, job.Picture.File, job.WideningFile });
  }
  return outputs;
}

/// Extracts the surface, and writes it with its tables: all files, or none.
void MakeSurface(const Job& job, MessageCapture* messages, Sharing& sharing)
{
  sharing.OnAll(
    [&] { CheckOutputs(ListFiles(job.InputFiles(), messages), ListOutputs(job, sharing)); });
  const vtkSmartPointer<vtkPointSet> particles =
    sharing.Read(job.Inputs.front(), job.Walls, messages);
  sharing.OnAll([&] { SetUpSurface(job, particles); });
  std::vector<vtkSmartPointer<vtkFieldData>> runs;
  std::vector<double> wallSeconds;
  std::vector<std::string> warnings;
  ComponentTable pieces(job);
  Run run;
  for (int i = 0; i < job.Repeat; ++i)
  {
    run.Surface = nullptr; // not two at once
    sharing.OnAll([&] { run = Extract(job, messages); });
    warnings = Warnings(run, messages);
    pieces = ComponentTable(job);
    sharing.OnAll([&] { pieces.Add(run, particles, messages); });
    runs.emplace_back(run.Statistics);
    wallSeconds.push_back(run.WallSeconds);
    if (!job.Quiet && sharing.IsFirst())
    {
      std::cout << (i == 0 ? DescribeRun(runs.back()) : "") << DescribeSeconds(runs.back())
                << std::flush;
    }
  }
  const double peakResidentBytes = PeakResidentBytes();
  const vtkSmartPointer<vtkPolyData> whole =
    IsInPieces(job.Output) ? nullptr : sharing.Merge(run.Surface);
  ColorScale colors(job.Picture);
  OutputFiles files;
  sharing.OnAll(
    [&]
    {
      if (IsInPieces(job.Output))
      {
        const std::string piece = PieceName(job.Output, sharing.GetRank());
        files.Write(piece, SurfaceBytes(piece, run.Surface, colors, messages));
      }
      if (!sharing.IsFirst())
      {
        return;
      }
      if (whole)
      {
        if (sharing.GetCount() == 1)
        {
          AddHintOfPeriod(job, particles, warnings);
        }
        colors.Include(whole);
        const std::string lost =
          LostArrays(job.Output, whole, colors, ArraysWithoutPlace(job, particles));
        warnings.insert(warnings.end(), lost.empty() ? 0 : 1, lost);
      }
      for (const std::string& warning : warnings)
      {
        Say("warning: " + warning);
      }
      files.Write(job.Output,
        whole ? SurfaceBytes(job.Output, whole, colors, messages)
              : ListPieces(job.Output, sharing.GetCount(), run.Surface));
      if (!job.ComponentFile.empty())
      {
        files.Write(job.ComponentFile, pieces.Text());
      }
    });
  sharing.OnAll([&] { files.Commit(); }); // only where all have written all
  if (!job.WideningFile.empty())
  {
    vtkSmartPointer<vtkPolyData> widened;
    sharing.OnAll([&] { widened = Widen(job, messages); });
    widened = sharing.Append(widened);
    sharing.OnFirst([&] { WriteDataSet(job.WideningFile, widened, messages); });
  }
  sharing.OnFirst(
    [&]
    {
      if (!job.StatisticsFile.empty())
      {
        std::cout.flush(); // the file may be /dev/stdout
        WriteOutput(job.StatisticsFile,
          StatisticsAsJson(job, runs, wallSeconds, warnings, peakResidentBytes));
      }
      if (!job.Picture.File.empty())
      {
        colors.Suggest(whole, job.Surface->GetIsoValueArrayName());
        colors.Include(whole);
        const auto picture = LoadExtra().NewPicture(job.Picture);
        WriteOutput(
          job.Picture.File, picture->Draw(job.Picture.File, whole, particles, colors, messages));
      }
    });
}

/// Makes the outputs. Returns false if a step failed; its error was printed.
bool Make(const Job& job, MessageCapture* messages, Sharing& sharing)
{
  if (job.IsFilm())
  {
    return MakeFilm(job, messages, sharing);
  }
  if (job.Has("--project"))
  {
    ProjectParticles(job, messages, sharing);
    return true;
  }
  if (job.IsGauge())
  {
    return MakeGaugeTable(job, messages, sharing);
  }
  if (job.IsFlux())
  {
    return MakeFluxTable(job, messages, sharing);
  }
  job.IsProbe() ? ProbePoints(job, messages, sharing) : MakeSurface(job, messages, sharing);
  return true;
}

#if MCOR_HAS_RANKS
bool MakeOnRanks(Job& job, MessageCapture* messages)
{
  RankSession session(job, messages);
  try
  {
    session.OnAll(
      [&job]
      {
        if (!job.Picture.File.empty() || job.Repeat > 1)
        {
          throw std::runtime_error(
            "several processes share a surface, a film, a probe, a projection, gauges or fluxes, "
            "but no --screenshot or --repeat; run these without mpirun");
        }
      });
    return Make(job, messages, session);
  }
  catch (const std::exception& error)
  {
    if (session.IsFirst())
    {
      Say(error.what());
    }
    return false;
  }
}
#endif

/// Does what the command line asks for. Returns false if something failed; its error was printed.
bool Execute(int argc, char* argv[])
{
  Job job;
  ParseCommandLine(argc, argv, job);
  const bool isQuestion =
    job.Has("--help") || job.Has("--version") || job.Has("--list-devices") || job.ListArrays;
  if (isQuestion && LaunchedRank() > 0)
  {
    return true;
  }
  if (job.Has("--help"))
  {
    std::cout << CommandLineHelp();
    return true;
  }
  if (job.Has("--version"))
  {
    std::cout << "marching-correctors " MCOR_PROGRAM_VERSION " (VTK " << vtkVersion::GetVTKVersion()
              << ")\n";
    return true;
  }
  const Activity running("the run failed", FaultsOfDrivers(job.Surface->GetDevice()));
  vtkNew<MessageCapture> messages;
  vtkOutputWindow::SetInstance(messages);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  if (job.ListArrays)
  {
    std::cout << DescribeArrays(*ReadParticles({ job.Inputs.front() }, messages));
    return true;
  }
  if (job.Has("--list-devices"))
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
    return true;
  }
#if MCOR_HAS_RANKS
  if (LaunchedCount() > 1)
  {
    return MakeOnRanks(job, messages);
  }
#endif
  LoadDriversAhead(job.Surface->GetDevice());
  Sharing alone;
  return Make(job, messages, alone);
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
    if (LaunchedRank() > 0)
    {
      return 0; // the first process says it; a failure here could end that one before it has
    }
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
  Finish(Status([&] { return Execute(argc, argv); }));
}
