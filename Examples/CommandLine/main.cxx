// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// The command line program: reads particles from a file, writes a surface to a file. See --help.
#include "ColorScale.h"
#include "DataFile.h"
#include "Extra.h"
#include "Failures.h"
#include "Job.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "Runs.h"
#include "Sharing.h"
#include "Text.h"

#include "vtkFieldData.h"
#include "vtkLogger.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkVersion.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace
{

/// Makes the outputs. Returns false if a step failed, after its error was printed.
bool Make(Sharing& sharing)
{
  const Job& job = sharing.Options;
  return job.IsFilm()      ? MakeFilm(sharing)
    : job.Mode() & METER   ? MakeMeterTable(sharing)
    : job.IsPointTable()   ? MakePointTable(sharing)
    : job.Mode() & SURFACE ? MakeSurface(sharing)
                           : MakeField(sharing);
}

/// Returns the number of characters in a line of standard output.
std::size_t WidthOfTerminal()
{
  winsize size = {};
  const char* columns = std::getenv("COLUMNS");
  const int asked = columns ? std::atoi(columns) : 0;
  const bool isTerminal = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return static_cast<std::size_t>(std::max(asked > 0 ? asked : isTerminal ? size.ws_col : 80, 60));
}

/// Whether the reader of standard output has gone, as in --help | head. This is no fault.
bool IsReaderGone()
{
  pollfd output = { STDOUT_FILENO, POLLOUT, 0 };
  return poll(&output, 1, 0) == 1 && (output.revents & POLLERR);
}

/// Runs the command line. Returns false if something failed, after the error was printed.
bool Execute(int argc, char* argv[])
{
  Job job;
  ParseCommandLine(argc, argv, job);
  const bool isQuestion = job.Has("--help") || job.Has("--version") || job.Has("--list-devices") ||
    job.Has("--list-arrays");
  if (isQuestion && LaunchedRank() > 0)
  {
    return true;
  }
  if (job.Has("--help"))
  {
    std::cout << CommandLineHelp(job.Word, WidthOfTerminal());
    return true;
  }
  if (job.Has("--version"))
  {
    std::cout << "marching-correctors " MCOR_PROGRAM_VERSION " (VTK " << vtkVersion::GetVTKVersion()
              << ")\n";
    return true;
  }
  const Activity running("the run failed", FaultsOfDrivers(job.Surface->GetDevice()));
  Messages(); // keeps VTK's messages from here on
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  if (job.Has("--list-arrays"))
  {
    std::cout << DescribeArrays(*ReadParticles({ job.Inputs.front() }));
    return true;
  }
  if (job.Has("--list-devices"))
  {
    const std::string devices = vtkMarchingCorrectors::ListDevices();
    Require(!devices.empty(),
      "there is no OpenCL device; a CPU becomes one with PoCL (Debian: pocl-opencl-icd)");
    std::istringstream lines(devices);
    for (std::string line; std::getline(lines, line);)
    {
      std::cout << Printable(line) << "\n";
    }
    return true;
  }
  if (LaunchedCount() > 1)
  {
    const std::unique_ptr<Sharing> session = NewRankSession(job);
    bool isGood = false;
    const std::string failure = FailureOf(
      [&]
      {
        session->OnAll(
          [&job]
          {
            Require(job.Picture.File.empty() && job.Repeat == 1,
              "several processes share a surface, a film, a probe, a projection, gauges or fluxes, "
              "but no --screenshot or --repeat; run these without mpirun");
          });
        isGood = Make(*session);
      });
    if (!failure.empty() && session->IsFirst())
    {
      Say(failure);
    }
    return isGood;
  }
  Sharing alone(job);
  return Make(alone);
}

}

bool MakeSurface(Sharing& sharing)
{
  const Job& job = sharing.Options;
  std::vector<std::string> outputs; // this process's files; on the first process, all files
  const bool isInPieces = EndsWith(job.Output, ".pvtp");
  for (int rank = 0; isInPieces && rank < sharing.GetCount(); ++rank)
  {
    if (sharing.IsFirst() || rank == sharing.GetRank())
    {
      outputs.push_back(PieceName(job.Output, rank));
    }
  }
  if (sharing.IsFirst())
  {
    outputs.insert(outputs.end(),
      { job.Output, job.Text("--stats"), job.Text("--components"), job.Picture.File,
        job.Text("--widening") });
  }
  sharing.OnAll(
    [&]
    {
      OpenSources(job.InputFiles());
      CheckOutputs(outputs);
    });
  const vtkSmartPointer<vtkPointSet> particles = sharing.Read();
  sharing.OnAll([&] { SetUpSurface(job, particles); });
  std::vector<vtkSmartPointer<vtkFieldData>> runs;
  std::vector<double> wallSeconds;
  std::string pieces;
  Run run;
  for (int i = 0; i < job.Repeat; ++i)
  {
    run.Surface = nullptr; // one run must end before the next begins
    sharing.OnAll([&] { run = Extract(sharing); });
    pieces.clear();
    sharing.OnAll([&] { AddPieces(pieces, sharing, run, particles); });
    runs.emplace_back(run.Statistics);
    wallSeconds.push_back(run.WallSeconds);
    if (!job.Has("--quiet") && sharing.IsFirst())
    {
      std::cout << (i == 0 ? DescribeRun(runs.back(), job.Has("--verbose")) : "")
                << DescribeSeconds(runs.back(), job.Has("--verbose")) << std::flush;
    }
  }
  const double peakResidentBytes = PeakResidentBytes();
  run.Surface = isInPieces ? run.Surface : sharing.Merge(run.Surface);
  ColorScale colors(job.Picture);
  OutputFiles files;
  sharing.OnAll(
    [&]
    {
      if (isInPieces)
      {
        const std::string piece = PieceName(job.Output, sharing.GetRank());
        files.Write(piece, SurfaceBytes(piece, run.Surface, colors));
      }
      if (!sharing.IsFirst())
      {
        return;
      }
      if (!isInPieces)
      {
        Inspect(job, job.Output, run, particles, colors, sharing.GetCount() == 1);
      }
      for (const std::string& warning : run.Warnings)
      {
        Say("warning: " + warning);
      }
      files.Write(job.Output,
        isInPieces ? ListPieces(job.Output, sharing.GetCount(), run.Surface)
                   : SurfaceBytes(job.Output, run.Surface, colors));
      if (job.Has("--components"))
      {
        files.Write(job.Text("--components"), pieces);
      }
    });
  sharing.OnAll([&] { files.Commit(); }); // only if all processes have written all files
  if (job.Has("--widening"))
  {
    vtkSmartPointer<vtkPolyData> widened;
    const vtkSmartPointer<vtkPointSet> used = vtkPointSet::SafeDownCast(job.Surface->GetInput());
    sharing.OnAll([&] { widened = Widen(job, used); });
    widened = sharing.Append(widened);
    sharing.OnFirst([&] { WriteDataSet(job.Text("--widening"), widened); });
  }
  sharing.OnFirst(
    [&]
    {
      if (job.Has("--stats"))
      {
        std::cout.flush(); // the file may be /dev/stdout
        WriteOutput(job.Text("--stats"),
          StatisticsAsJson(job, runs, wallSeconds, run.Warnings, peakResidentBytes));
      }
      if (!job.Picture.File.empty())
      {
        const Picture picture = LoadExtra().NewPicture(job.Picture);
        WriteOutput(job.Picture.File,
          DrawSurface(sharing, job.Picture.File, run.Surface, particles, picture, colors));
      }
    });
  return true;
}

const Extra& LoadExtra()
{
  // A name without a folder is searched for in the folder of this program's other libraries.
  static void* const library = dlopen(MCOR_EXTRA_LIBRARY, RTLD_NOW | RTLD_GLOBAL);
  static const void* const extra = library ? dlsym(library, "MarchingCorrectorsExtra") : nullptr;
  const char* why = extra ? nullptr : dlerror();
  Require(extra,
    "the part of this program for pictures, .vtkhdf, .stl, .ply and .obj files cannot be loaded (" +
      std::string(why ? why : MCOR_EXTRA_LIBRARY) + "); install it again");
  return *static_cast<const Extra*>(extra);
}

int main(int argc, char* argv[])
{
  // If standard output was closed, the next file that the program opens would become standard
  // output. An open /dev/null keeps its place.
  int descriptor = 0;
  while (descriptor >= 0 && descriptor <= STDERR_FILENO)
  {
    descriptor = open("/dev/null", O_RDWR);
  }
  close(descriptor);
  PrepareForEnding();
  vtkSPHAlgorithm::SetWord(OptionWord);
  bool isGood = false, isMisused = false;
  const std::string failure = FailureOf(
    [&]
    {
      try
      {
        isGood = Execute(argc, argv);
      }
      catch (const UsageError& error)
      {
        isMisused = true;
        throw std::runtime_error(std::string(error.what()) + " (see --help)");
      }
      std::cout.flush();
      Require(std::cout || IsReaderGone(), "standard output could not be written");
    });
  // The first process reports wrong usage; the others are silent, and do not fail: a failure could
  // end the first process before it has reported.
  const bool isSilent = isMisused && LaunchedRank() > 0;
  if (!failure.empty() && !isSilent)
  {
    Say(failure);
  }
  std::fflush(nullptr);
  // Skips the libraries' code at the program's end, which may take time, crash, or print messages
  // about a damaged file.
  _exit(isSilent ? 0 : isMisused ? 2 : isGood && failure.empty() ? 0 : 1);
}
