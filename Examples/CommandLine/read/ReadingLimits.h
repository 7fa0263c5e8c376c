// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ReadingLimits_h
#define ReadingLimits_h

#include "Supervisor.h"

#include <string>
#include <utility>
#include <vector>

#include <sys/resource.h>

/// For as long as it lives, the process reads a file that may be damaged: memory and processor time
/// end at what a good file of that size can need, nothing but the sentence for the user reaches
/// standard error (malloc and std::terminate would write there), and no core is dumped.
class ReadingLimits
{
public:
  explicit ReadingLimits(const std::string& file);
  ~ReadingLimits();
  ReadingLimits(const ReadingLimits&) = delete;
  void operator=(const ReadingLimits&) = delete;

private:
  using Resource = decltype(RLIMIT_CPU);

  void Lower(Resource resource, double limit);

  Activity Reading;
  std::vector<std::pair<Resource, rlimit>> Before;
  int StandardError;
};

#endif
