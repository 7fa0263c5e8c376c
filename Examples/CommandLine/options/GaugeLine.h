// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef GaugeLine_h
#define GaugeLine_h

#include <array>
#include <string>
#include <vector>

/// A line along which the free surface is measured.
struct GaugeLine
{
  std::string Name;
  std::array<double, 6> Ends; ///< x, y, z of the one end, then of the other
};

/// Many upright ones, over a rectangle.
struct GaugeGrid
{
  int Counts[2] = { 0, 0 }; ///< along x and y; 0: there is none
  std::array<double, 6> Bounds = {};
};

/// NAME=x0,y0,z0:x1,y1,z1. Throws UsageError.
GaugeLine ToGauge(const std::string& option, const std::string& text);

/// A line of the file each; empty ones, and those that begin with #, are left out. Throws UsageError, or
/// std::runtime_error where it cannot be read.
std::vector<GaugeLine> ReadGauges(const std::string& file);

/// nx,ny:x0,x1,y0,y1,z0,z1. Throws UsageError.
GaugeGrid ToGaugeGrid(const std::string& option, const std::string& text);

/// Its lines, from z0 to z1, x fastest.
std::vector<GaugeLine> LinesOf(const GaugeGrid& grid);

/// Throws UsageError where two have one name.
void CheckNames(const std::vector<GaugeLine>& gauges);

#endif
