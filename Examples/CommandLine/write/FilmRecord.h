// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FilmRecord_h
#define FilmRecord_h

#include "RunStatistics.h"
#include "ScratchFile.h"

#include <vector>

/// What became of the steps of a film so far. It outlives the process that did them: the next one,
/// where that one crashed, reads it.
class FilmRecord
{
public:
  void Add(const FilmStep& step);
  std::vector<FilmStep> Read() const;

private:
  ScratchFile File;
};

#endif
