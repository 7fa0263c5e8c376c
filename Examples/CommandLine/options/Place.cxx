// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Job.h"

#include "Formats.h"
#include "Text.h"

#include <algorithm>
#include <fstream>
#include <set>

namespace
{

using Text = const std::string&;

const char* const GaugeForm = "NAME=X,Y,Z:X,Y,Z";
const char* const FluxForm = "NAME=X,Y,Z:X,Y,Z:X,Y,Z, NAME=disc:X,Y,Z:NX,NY,NZ:R, "
                             "NAME=box:X0,X1,Y0,Y1,Z0,Z1 or NAME=FILE";

/// Returns the numbers of a text like X,Y,Z:X,Y,Z. Part i must have counts[i] numbers; else returns an empty list.
std::vector<double> ParsePlaces(Text text, const std::vector<std::size_t>& counts)
{
  std::vector<double> numbers;
  const std::vector<std::string> parts = ItemsOf(text, ':');
  bool isGood = parts.size() == counts.size();
  for (std::size_t p = 0; isGood && p < parts.size(); ++p)
  {
    const std::vector<std::string> items = ItemsOf(parts[p]);
    isGood = items.size() == counts[p] &&
      std::all_of(items.begin(), items.end(),
        [&numbers](Text item) { return ParseNumber(item, numbers.emplace_back()); });
  }
  return isGood ? numbers : std::vector<double>();
}

/// Returns the name of a table's row. noun: the thing that has the name.
std::string ToRowName(Text option, Text noun, Text text)
{
  const std::string name = Printable(text);
  Need(std::string("=+-@").find(name[0]) == std::string::npos,
    option + ": the name of " + noun + " '" + name + "' begins with '" + name[0] +
      "', so that spreadsheets would take it for a formula; begin it with a letter");
  return name;
}

/// Returns the places, followed by the places in the option's file, if the option is given. Each line of the file is a
/// place, unless it is empty or begins with #.
std::vector<Place> WithFile(std::vector<Place> places, const Job& job, const char* option,
  Text nouns, Text form, Place (*parse)(Text option, Text text))
{
  if (job.Has(option))
  {
    const std::string file = job.Text(option), origin = option + (" " + file);
    CheckRegularFile(file); // /dev/zero and some pipes never end, so reading stops here
    std::ifstream source(file, std::ios::binary);
    const std::size_t before = places.size();
    for (std::string line; std::getline(source, line);)
    {
      const std::size_t first = line.find_first_not_of(" \t\r");
      if (first != std::string::npos && line[first] != '#')
      {
        const std::size_t last = line.find_last_not_of(" \t\r");
        places.push_back(parse(origin, line.substr(first, last + 1 - first)));
      }
    }
    Need(places.size() > before, origin + " has no " + nouns + "; it needs lines " + form);
  }
  std::set<std::string> known;
  for (const Place& place : places)
  {
    Need(known.insert(place.Name).second,
      "two " + nouns + " have the name '" + place.Name + "'; give each a name of its own");
  }
  return places;
}

}

Place ToGauge(Text option, Text text)
{
  const std::size_t equals = std::min(text.rfind('='), text.size());
  const std::vector<double> ends =
    ParsePlaces(text.substr(std::min(equals + 1, text.size())), { 3, 3 });
  Need(
    equals > 0 && !ends.empty(), option, std::string("a name and two places, ") + GaugeForm, text);
  const Place gauge = { ToRowName(option, "gauge", text.substr(0, equals)), ends, "" };
  Need(!std::equal(ends.begin(), ends.begin() + 3, ends.begin() + 3),
    option + ": gauge '" + gauge.Name +
      "' has no length, because both its ends are the same; give it two");
  return gauge;
}

GaugeGrid ToGaugeGrid(Text option, Text text)
{
  GaugeGrid grid;
  const std::vector<double> n = ParsePlaces(text, { 2, 6 });
  Need(!n.empty() && n[2] <= n[3] && n[4] <= n[5] && n[6] < n[7], option,
    "two counts and bounds with z0 below z1, NX,NY:X0,X1,Y0,Y1,Z0,Z1", text);
  std::copy(n.begin() + 2, n.end(), grid.Bounds.begin());
  for (std::size_t a = 0; a < 2; ++a)
  {
    grid.Counts[a] = static_cast<int>(std::clamp(n[a], 0.0, 1e6));
    Need(n[a] >= 1.0 && n[a] == grid.Counts[a], option, "whole numbers of gauges, 1 or more", text);
  }
  Need(static_cast<double>(grid.Counts[0]) * grid.Counts[1] <= 1e6,
    option +
      " has more than a million gauges, which take minutes and gigabytes; take fewer, or a part of "
      "the bounds at a time");
  return grid;
}

Place ToFlux(Text option, Text text)
{
  static const struct
  {
    const char* Begin;
    std::vector<std::size_t> Counts;
    decltype(Place::Add) Add;
  } forms[] = {
    { "disc:", { 3, 3, 1 },
      [](auto* flux, auto* name, auto* n) { flux->AddDisc(name, n, n + 3, n[6]); } },
    { "box:", { 6 }, [](auto* flux, auto* name, auto* n) { flux->AddBox(name, n); } },
    { "", { 3, 3 }, [](auto* flux, auto* name, auto* n) { flux->AddLine(name, n, n + 3); } },
    { "", { 3, 3, 3 },
      [](auto* flux, auto* name, auto* n) { flux->AddRectangle(name, n, n + 3, n + 6); } },
  };
  const std::size_t equals = text.find('=');
  const bool isNamed = equals != std::string::npos && equals > 0 && equals + 1 < text.size();
  Need(isNamed, option, std::string("a section with a name, ") + FluxForm, text);
  Place section;
  section.Name = ToRowName(option, "section", text.substr(0, equals));
  for (const char* ending : { ".vtp", ".vtu", ".vtk", ".stl", ".ply", ".obj" })
  {
    if (EndsWith(text, ending))
    {
      section.File = text.substr(equals + 1);
      return section;
    }
  }
  for (const auto& form : forms)
  {
    const std::string begin = form.Begin;
    section.Add = form.Add;
    section.Numbers =
      ParsePlaces(text.substr(std::min(equals + 1 + begin.size(), text.size())), form.Counts);
    if (text.compare(equals + 1, begin.size(), begin) == 0 && !section.Numbers.empty())
    {
      return section;
    }
  }
  throw UsageError(option + " needs a section with a name, " + FluxForm + ", not '" + text + "'");
}

std::vector<Place> ListGauges(const Job& job)
{
  std::vector<Place> gauges = WithFile(job.Gauges, job, "--gauges", "gauges", GaugeForm, ToGauge);
  const std::array<double, 6>& b = job.Grid.Bounds;
  const auto at = [&job, &b](std::size_t axis, int i)
  {
    const int last = job.Grid.Counts[axis] - 1;
    const double t = last > 0 ? static_cast<double>(i) / last : 0.0;
    return (1.0 - t) * b[2 * axis] + t * b[2 * axis + 1];
  };
  for (int j = 0; j < job.Grid.Counts[1]; ++j)
  {
    for (int i = 0; i < job.Grid.Counts[0]; ++i)
    {
      const double x = at(0, i), y = at(1, j);
      gauges.push_back(
        { std::to_string(i) + " " + std::to_string(j), { x, y, b[4], x, y, b[5] }, "" });
    }
  }
  return gauges;
}

std::vector<Place> ListSections(const Job& job)
{
  return WithFile(job.Fluxes, job, "--fluxes", "sections", FluxForm, ToFlux);
}
