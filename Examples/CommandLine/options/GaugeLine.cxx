// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "GaugeLine.h"

#include "OptionValue.h"
#include "SafeText.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

bool ParseNumbers(
  const std::string& option, const std::string& text, std::size_t count, double* numbers)
{
  std::vector<double> found;
  try
  {
    found = ToNumbers(option, text);
  }
  catch (const UsageError&)
  {
    return false; // the whole text is to be named, not a part of it
  }
  std::copy_n(found.data(), std::min(count, found.size()), numbers);
  return found.size() == count;
}

std::string ToRowName(const std::string& option, const std::string& noun, const std::string& text)
{
  const std::string name = Printable(text);
  if (std::string("=+-@").find(name[0]) != std::string::npos)
  {
    throw UsageError(option + ": the name of " + noun + " '" + name + "' begins with '" + name[0] +
      "', so that spreadsheets would take it for a formula; begin it with a letter");
  }
  return name;
}

std::vector<std::string> ReadRows(const std::string& option, const std::string& file,
  const std::string& nouns, const std::string& form)
{
  const std::size_t most = std::size_t(64) << 20; // a device has no end
  std::ifstream source(file, std::ios::binary);
  std::string text;
  for (char part[1 << 16]; source && text.size() <= most;)
  {
    source.read(part, sizeof(part));
    text.append(part, static_cast<std::size_t>(source.gcount()));
  }
  if (!source.eof()) // a folder opens, but does not read
  {
    throw std::runtime_error("the " + nouns + "' file " + file +
      (text.size() > most ? " is larger than 64 MiB; give one of fewer " + nouns
                          : " cannot be read"));
  }
  std::istringstream stream(text);
  std::vector<std::string> rows;
  for (std::string line; std::getline(stream, line);)
  {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#')
    {
      continue;
    }
    const std::size_t last = line.find_last_not_of(" \t\r");
    rows.push_back(line.substr(first, last + 1 - first));
  }
  if (rows.empty())
  {
    throw UsageError(option + " " + file + " has no " + nouns + "; it needs lines " + form);
  }
  return rows;
}

GaugeLine ToGauge(const std::string& option, const std::string& text)
{
  const std::size_t equals = text.rfind('='), colon = text.rfind(':');
  GaugeLine gauge;
  Need(equals != std::string::npos && equals > 0 && colon != std::string::npos && colon > equals &&
      ParseNumbers(option, text.substr(equals + 1, colon - equals - 1), 3, gauge.Ends.data()) &&
      ParseNumbers(option, text.substr(colon + 1), 3, gauge.Ends.data() + 3),
    option, "a name and two places, NAME=X,Y,Z:X,Y,Z", text);
  gauge.Name = ToRowName(option, "gauge", text.substr(0, equals));
  if (std::equal(gauge.Ends.begin(), gauge.Ends.begin() + 3, gauge.Ends.begin() + 3))
  {
    throw UsageError(option + ": gauge '" + gauge.Name +
      "' has no length, because both its ends are the same; give it two");
  }
  return gauge;
}

GaugeGrid ToGaugeGrid(const std::string& option, const std::string& text)
{
  const std::size_t colon = text.find(':');
  GaugeGrid grid;
  double counts[2];
  double* b = grid.Bounds.data();
  Need(colon != std::string::npos && ParseNumbers(option, text.substr(0, colon), 2, counts) &&
      ParseNumbers(option, text.substr(colon + 1), 6, b) && b[0] <= b[1] && b[2] <= b[3] &&
      b[4] < b[5],
    option, "two counts and bounds with z0 below z1, NX,NY:X0,X1,Y0,Y1,Z0,Z1", text);
  for (int a = 0; a < 2; ++a)
  {
    grid.Counts[a] = static_cast<int>(std::clamp(counts[a], 0.0, 1e6));
    Need(counts[a] >= 1.0 && counts[a] == grid.Counts[a], option,
      "whole numbers of gauges, 1 or more", text);
  }
  if (static_cast<double>(grid.Counts[0]) * grid.Counts[1] > 1e6)
  {
    throw UsageError(option +
      " has more than a million gauges, which take minutes and gigabytes; take fewer, or a part of "
      "the bounds at a time");
  }
  return grid;
}

std::vector<GaugeLine> LinesOf(const GaugeGrid& grid)
{
  std::vector<GaugeLine> lines;
  const std::array<double, 6>& b = grid.Bounds;
  const auto at = [&](int axis, int i)
  {
    const int last = grid.Counts[axis] - 1;
    const double t = last > 0 ? static_cast<double>(i) / last : 0.0;
    return (1.0 - t) * b[2 * axis] + t * b[2 * axis + 1];
  };
  for (int j = 0; j < grid.Counts[1]; ++j)
  {
    for (int i = 0; i < grid.Counts[0]; ++i)
    {
      const double x = at(0, i), y = at(1, j);
      lines.push_back({ std::to_string(i) + " " + std::to_string(j), { x, y, b[4], x, y, b[5] } });
    }
  }
  return lines;
}

void CheckNames(const std::vector<std::string>& names, const std::string& nouns)
{
  std::set<std::string> known;
  for (const std::string& name : names)
  {
    if (!known.insert(name).second)
    {
      throw UsageError(
        "two " + nouns + " have the name '" + name + "'; give each a name of its own");
    }
  }
}
