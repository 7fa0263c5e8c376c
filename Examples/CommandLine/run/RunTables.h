// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RunTables_h
#define RunTables_h

#include <string>
#include <vector>

class MessageCapture;
class vtkPointSet;
struct Job;
struct Run;

/// The table of the pieces of the surfaces of a run, or of the steps of a film, which have a column
/// of times.
class ComponentTable
{
public:
  explicit ComponentTable(const Job& job)
    : Options(&job)
  {
  }

  /// Does nothing if no table is wanted. Else gives the run's surface the array ComponentId,
  /// without the pieces that are to be left out, and the table a row for each piece. Throws
  /// std::runtime_error.
  void Add(Run& run, vtkPointSet* particles, MessageCapture* messages, double time = 0.0);

  const std::string& Text() const { return this->Lines; }

private:
  const Job* Options;
  std::string Lines;
};

/// A table of a film's numbers, a row for each step: the surface's triangles, area, volume and
/// pieces, and what gauges read.
class FilmNumbers
{
public:
  explicit FilmNumbers(const Job& job);

  /// Adds a row. Does nothing if no table is wanted. Throws std::runtime_error.
  void Add(const Run& run, vtkPointSet* particles, MessageCapture* messages, double time,
    std::vector<std::string>& warnings);

  const std::string& Text() const { return this->Lines; }

private:
  const Job& Options;
  std::string Lines;
};

#endif
