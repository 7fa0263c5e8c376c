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

/// True, and the numbers, if the text has exactly so many.
bool ParseNumbers(
  const std::string& option, const std::string& text, std::size_t count, double* numbers);

/// A name for a row of a table. noun: what has it. Throws UsageError.
std::string ToRowName(const std::string& option, const std::string& noun, const std::string& text);

/// The lines of a file of "gauges", say, that are not empty and do not begin with #. form: of such a line. Throws UsageError
/// where there are none, or std::runtime_error where it cannot be read.
std::vector<std::string> ReadRows(const std::string& option, const std::string& file,
  const std::string& nouns, const std::string& form);

/// NAME=x0,y0,z0:x1,y1,z1. Throws UsageError.
GaugeLine ToGauge(const std::string& option, const std::string& text);

/// nx,ny:x0,x1,y0,y1,z0,z1. Throws UsageError.
GaugeGrid ToGaugeGrid(const std::string& option, const std::string& text);

/// Returns the grid's lines, from z0 to z1, x fastest.
std::vector<GaugeLine> LinesOf(const GaugeGrid& grid);

/// Throws UsageError if two have one name. nouns: the word for them.
void CheckNames(const std::vector<std::string>& names, const std::string& nouns);

#endif
