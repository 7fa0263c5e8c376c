// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// The command line program: it reads particles from files, and writes surfaces, images or tables. See --help.
#include "Extra.h"
#include "Failures.h"
#include "Job.h"
#include "ParticleFile.h"
#include "Runs.h"
#include "Sharing.h"
#include "Text.h"

#include "vtkLogger.h"
#include "vtkPointSet.h"
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

/// Runs the command line. Returns false if something failed, after the error was printed; throws
/// all other errors.
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
    const std::string failure = FailureOf([&] { isGood = Make(*session); });
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
