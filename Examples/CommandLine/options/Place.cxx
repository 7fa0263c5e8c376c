// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Job.h"

#include "Formats.h"
#include "ParticleFile.h"
#include "Text.h"

#include <algorithm>
#include <cmath>
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

/// Returns `text`, made printable, as the name of a table's row. noun: what has this name, such as a gauge. Throws UsageError.
std::string ToRowName(Text option, Text noun, Text text)
{
  const std::string name = Printable(text);
  Need(std::string("=+-@").find(name[0]) == std::string::npos,
    option + ": the name of " + noun + " '" + name + "' begins with '" + name[0] +
      "', so that spreadsheets would take it for a formula; begin it with a letter");
  return name;
}

}

Place ToGauge(Text option, Text text)
{
  const std::size_t equals = std::min(text.rfind('='), text.size());
  const std::vector<double> ends =
    ParsePlaces(text.substr(std::min(equals + 1, text.size())), { 3, 3 });
  Need(
    equals > 0 && !ends.empty(), option, std::string("a name and two places, ") + GaugeForm, text);
  const std::string name = ToRowName(option, "gauge", text.substr(0, equals));
  Need(!std::equal(ends.begin(), ends.begin() + 3, ends.begin() + 3),
    option + ": gauge '" + name +
      "' has no length, because both its ends are the same; give it two");
  return { name, "",
    [name, e = ends](const Job& job)
    { job.Gauge->AddGauge(name.c_str(), e[0], e[1], e[2], e[3], e[4], e[5]); } };
}

std::vector<double> ToGaugeGrid(Text option, Text text)
{
  const std::vector<double> n = ParsePlaces(text, { 2, 6 });
  Need(!n.empty() && n[2] <= n[3] && n[4] <= n[5] && n[6] < n[7], option,
    "two counts and bounds with z0 below z1, NX,NY:X0,X1,Y0,Y1,Z0,Z1", text);
  Need(std::min(n[0], n[1]) >= 1.0 && n[0] == std::floor(n[0]) && n[1] == std::floor(n[1]), option,
    "whole numbers of gauges, 1 or more", text);
  Need(n[0] * n[1] <= 1e6,
    option +
      " has more than a million gauges, which take minutes and gigabytes; take fewer, or a part of "
      "the bounds at a time");
  return n;
}

Place ToFlux(Text option, Text text)
{
  static const struct
  {
    const char* Begin;
    std::vector<std::size_t> Counts;
    void (*Add)(vtkSPHFlux* flux, const char* name, const double* n);
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
  const std::string name = ToRowName(option, "section", text.substr(0, equals));
  const std::string section = text.substr(equals + 1);
  for (const char* ending : { ".vtp", ".vtu", ".vtk", ".stl", ".ply", ".obj" })
  {
    if (EndsWith(text, ending))
    {
      return { name, section,
        [name, section](const Job& job)
        { job.Flux->AddSurface(name.c_str(), ReadDataSet(section)); } };
    }
  }
  for (const auto& form : forms)
  {
    const std::string begin = form.Begin;
    const std::vector<double> numbers = section.compare(0, begin.size(), begin) == 0
      ? ParsePlaces(section.substr(begin.size()), form.Counts)
      : std::vector<double>();
    if (!numbers.empty())
    {
      return { name, "",
        [name, numbers, add = form.Add](const Job& job)
        { add(job.Flux, name.c_str(), numbers.data()); } };
    }
  }
  throw UsageError(option + " needs a section with a name, " + FluxForm + ", not '" + text + "'");
}

std::size_t AddPlaces(const Job& job)
{
  const bool isFlux = job.Mode() == FLUX;
  const char* option = isFlux ? "--fluxes" : "--gauges";
  const std::string nouns = isFlux ? "sections" : "gauges";
  std::vector<Place> places = job.Places;
  if (job.Has(option))
  {
    const std::string file = job.Text(option), origin = option + (" " + file);
    CheckRegularFile(file); // /dev/zero and some pipes never end, so reading stops here
    std::ifstream source(file, std::ios::binary);
    for (std::string line; std::getline(source, line);)
    {
      const std::size_t first = line.find_first_not_of(" \t\r");
      if (first != std::string::npos && line[first] != '#')
      {
        const std::size_t last = line.find_last_not_of(" \t\r");
        places.push_back(
          (isFlux ? ToFlux : ToGauge)(origin, line.substr(first, last + 1 - first)));
      }
    }
    Need(places.size() > job.Places.size(),
      origin + " has no " + nouns + "; it needs lines " + (isFlux ? FluxForm : GaugeForm));
  }
  std::set<std::string> known;
  for (const Place& place : places)
  {
    Need(known.insert(place.Name).second,
      "two " + nouns + " have the name '" + place.Name + "'; give each a name of its own");
    place.Add(job);
  }
  const std::vector<double> n = job.Grid.empty() ? std::vector<double>(8) : job.Grid;
  const auto at = [&n](std::size_t axis, int i)
  {
    const double t = n[axis] > 1.0 ? i / (n[axis] - 1.0) : 0.0;
    return (1.0 - t) * n[2 + 2 * axis] + t * n[3 + 2 * axis];
  };
  for (int j = 0; j < n[1]; ++j)
  {
    for (int i = 0; i < n[0]; ++i)
    {
      const double x = at(0, i), y = at(1, j);
      const std::string name = std::to_string(i) + " " + std::to_string(j);
      job.Gauge->AddGauge(name.c_str(), x, y, n[6], x, y, n[7]);
    }
  }
  return places.size() + static_cast<std::size_t>(n[0] * n[1]);
}
