// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Place_h
#define Place_h

#include <array>
#include <string>
#include <vector>

struct Job;

/// A place of measurement: the line of a gauge, or a section that fluid flows through.
struct Place
{
  enum Kind
  {
    Line,      ///< two points
    Rectangle, ///< a corner, two ends
    Disc,      ///< centre, normal, radius
    Box,       ///< bounds
    Surface    ///< of a file
  };
  std::string Name;
  Kind Shape = Surface;
  std::vector<double> Numbers;
  std::string File;
};

/// Many upright gauges, over a rectangle.
struct GaugeGrid
{
  int Counts[2] = { 0, 0 }; ///< along x and y; 0: there is none
  std::array<double, 6> Bounds = {};
};

/// NAME=x0,y0,z0:x1,y1,z1. Throws UsageError.
Place ToGauge(const std::string& option, const std::string& text);

/// nx,ny:x0,x1,y0,y1,z0,z1. Throws UsageError.
GaugeGrid ToGaugeGrid(const std::string& option, const std::string& text);

/// NAME=SECTION. Throws UsageError.
Place ToFlux(const std::string& option, const std::string& text);

/// Places of the options, in their order, those of the files among them. Throws UsageError where
/// two have one name, or std::runtime_error where a file cannot be read.
std::vector<Place> ListGauges(const Job& job);
std::vector<Place> ListSections(const Job& job);

#endif
