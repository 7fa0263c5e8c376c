// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ReadingLimits.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <unistd.h>

#ifdef __linux__
#include <sys/sysinfo.h>
#endif

namespace
{

/// What this process has of the memory that RLIMIT_DATA counts; below 0 where that is not known.
double DataBytes()
{
  std::ifstream stream("/proc/self/statm");
  double pages = -1.0;
  for (int i = 0; i < 6 && stream; ++i) // the sixth number
  {
    stream >> pages;
  }
  return stream ? pages * static_cast<double>(sysconf(_SC_PAGESIZE)) : -1.0;
}

/// Memory and swap of the machine; 0 where that is not known.
double MachineBytes()
{
#ifdef __linux__
  struct sysinfo info;
  if (sysinfo(&info) == 0)
  {
    return (static_cast<double>(info.totalram) + static_cast<double>(info.totalswap)) *
      static_cast<double>(info.mem_unit);
  }
#endif
  return 0.0;
}

/// What reading a good file of this size cannot need more of: of all that VTK reads, LZMA packs
/// zeros closest, 7,000 to 1. What VTK needs anyway, with some threads, is small beside 1 GiB.
double MostBytes(double fileBytes)
{
  const double most = 1073741824.0 + 10000.0 * fileBytes;
  const double machine = MachineBytes();
  return machine > 0.0 ? std::min(most, machine) : most;
}

/// The slowest form, numbers as text, is read at 10 MB a second.
double MostSeconds(double fileBytes)
{
  return 10.0 + fileBytes / 100000.0;
}

double SecondsUsed()
{
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec);
}

}

//------------------------------------------------------------------------------
ReadingLimits::ReadingLimits(const std::string& file)
  : Reading(file + " cannot be read", "the file may be damaged")
{
  std::error_code error;
  const double bytes = static_cast<double>(std::filesystem::file_size(file, error));
  const double now = DataBytes();
  if (!error && now >= 0.0)
  {
    this->Lower(RLIMIT_DATA, now + MostBytes(bytes));
  }
  if (!error)
  {
    this->Lower(RLIMIT_CPU, SecondsUsed() + MostSeconds(bytes));
  }
  this->Lower(RLIMIT_CORE, 0.0);
  std::fflush(stderr);
  this->StandardError = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (this->StandardError >= 0 && nowhere >= 0)
  {
    dup2(nowhere, STDERR_FILENO);
  }
  if (nowhere >= 0)
  {
    close(nowhere);
  }
}

//------------------------------------------------------------------------------
ReadingLimits::~ReadingLimits()
{
  if (this->StandardError >= 0)
  {
    std::fflush(stderr);
    dup2(this->StandardError, STDERR_FILENO);
    close(this->StandardError);
  }
  for (const auto& limit : this->Before)
  {
    setrlimit(limit.first, &limit.second);
  }
}

//------------------------------------------------------------------------------
void ReadingLimits::Lower(Resource resource, double limit)
{
  rlimit before = {};
  const rlim_t wanted = static_cast<rlim_t>(limit);
  if (getrlimit(resource, &before) != 0 ||
    (before.rlim_cur != RLIM_INFINITY && before.rlim_cur <= wanted))
  {
    return;
  }
  rlimit lowered = before;
  lowered.rlim_cur = wanted;
  if (setrlimit(resource, &lowered) == 0)
  {
    this->Before.emplace_back(resource, before);
  }
}
