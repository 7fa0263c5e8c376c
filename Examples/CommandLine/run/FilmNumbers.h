// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FilmNumbers_h
#define FilmNumbers_h

#include <string>
#include <vector>

class MessageCapture;
class vtkPointSet;
struct Job;
struct Run;

/// A table of a film's numbers, a row for each step: the surface's triangles, area, volume and pieces, and what gauges
/// read.
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
