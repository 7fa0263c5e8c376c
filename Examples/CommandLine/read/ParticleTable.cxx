// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "ParticleFile.h"
#include "Text.h"

#include "vtkFieldData.h"
#include "vtkSPHSay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

namespace
{

/// Returns columns for values without names: x, y, z, Column4, ...
Table NumberedColumns(std::size_t count)
{
  Table table;
  for (std::size_t c = 0; c < count; ++c)
  {
    table.emplace_back(c < 3 ? std::string(1, "xyz"[c]) : "Column" + std::to_string(c + 1));
  }
  return table;
}

bool AreNumbers(const std::vector<View>& cells)
{
  double number;
  return std::all_of(cells.begin(), cells.end(),
    [&number](View cell) { return cell.empty() || ToNumber(cell, number); });
}

/// Splits a comment into possible names: x y z, or x, y, z, or [01 x] [02 y] [03 z].
std::vector<View> WordsOf(View comment)
{
  std::vector<View> words;
  const std::vector<View> parts = Split(comment, '[');
  for (std::size_t p = 1; p < parts.size(); ++p)
  {
    const View part = parts[p].substr(0, parts[p].find(']'));
    const std::size_t blank = part.find(' ');
    double number;
    if (blank != View::npos && ToNumber(part.substr(0, blank), number))
    {
      words.push_back(Trimmed(part.substr(blank)));
    }
  }
  return !words.empty() ? words : Split(comment, comment.find(',') != View::npos ? ',' : ' ');
}

/// Reads rows of values. Before the first one there may be a row of names, or a comment with names.
vtkSmartPointer<vtkDataObject> ReadRows(const std::string& file)
{
  constexpr std::size_t mostColumns = 10000;
  const bool isBlankTab = !EndsWith(file, ".csv") && !EndsWith(file, ".tsv");
  Lines lines(file);
  Table table;
  View comment;
  char separator = 0; // blanks and tabs count as one separator
  while (lines.Next())
  {
    View line = Trimmed(lines.Get());
    if (line.empty() || line[0] == '#' || line[0] == '%' || line[0] == '!')
    {
      const std::size_t begin = line.find_first_not_of("#%! \t");
      comment = line.empty() ? comment : line.substr(std::min(begin, line.size()));
      continue;
    }
    if (separator == 0)
    {
      const auto has = [line](char sign) { return line.find(sign) != View::npos; };
      separator = has(';') ? ';' : has('\t') && !isBlankTab ? '\t' : has(',') ? ',' : ' ';
    }
    line = separator == ' ' ? line.substr(0, line.find('#')) : lines.Get();
    const std::vector<View> cells = Split(line, separator);
    if (table.empty())
    {
      const std::size_t count = cells.size();
      lines.Check(count <= mostColumns, " has " + std::to_string(count) + " columns");
      const std::vector<View> words = WordsOf(comment);
      const bool isHead = !AreNumbers(cells);
      table = isHead                                  ? ColumnsOf(cells)
        : words.size() == count && !AreNumbers(words) ? ColumnsOf(words)
                                                      : NumberedColumns(count);
      if (isHead)
      {
        continue;
      }
    }
    AddRow(table, lines, cells, separator);
  }
  RequireToRead(!table.empty(), file, "it has no row of values");
  std::vector<std::size_t> positions = FindPositions(file, table);
  // Without names, the first three columns are positions if blanks separate the columns.
  if (positions.empty() && separator == ' ' && table.size() > 1)
  {
    positions = { 0, 1, 2 };
    positions.resize(std::min<std::size_t>(table.size(), 3));
  }
  return ParticlesOf(file, table, positions);
}

/// Returns the count that a line gives, or a negative number if it gives none.
vtkTypeInt64 CountOf(View line)
{
  vtkTypeInt64 count = -1;
  return ToInteger(Trimmed(line), count) ? count : -1;
}

/// Returns the texts behind KEY= in the second line of extended XYZ, by the keys in small letters.
/// Texts may have quotes.
std::map<std::string, std::string> ValuesOf(View comment)
{
  std::map<std::string, std::string> values;
  for (const View word : Split(comment, ' '))
  {
    const std::size_t equals = word.find('=');
    if (equals != View::npos)
    {
      values.emplace(Small(word.substr(0, equals)), Trimmed(word.substr(equals + 1)));
    }
  }
  return values;
}

std::vector<double> NumbersOf(View text)
{
  std::vector<double> numbers;
  for (const View word : Split(text, ' '))
  {
    double number = 0.0;
    numbers.insert(numbers.end(), ToNumber(word, number) ? 1 : 0, number);
  }
  return numbers;
}

/// Returns columns from the names, types and widths in Properties=species:S:1:pos:R:3:...
Table PropertiesOf(const Lines& lines, const std::string& text)
{
  Table table;
  const std::vector<View> parts = Split(text, ':');
  for (std::size_t p = 0; p + 2 < parts.size(); p += 3)
  {
    const std::string name(parts[p]);
    const vtkTypeInt64 width = CountOf(parts[p + 2]);
    RequireToRead(width >= 1 && width <= 100, lines.File,
      "its Properties give " + name + " " + std::string(parts[p + 2]) + " columns");
    for (vtkTypeInt64 c = 0; c < width; ++c)
    {
      table.emplace_back(name + (width == 1 ? "" : ":" + std::to_string(c)));
    }
  }
  return table;
}

/// What a file says of one of its steps, before the step's particles.
struct Step
{
  vtkTypeInt64 Count = 0;
  Table Columns;            ///< empty: the first row decides how many there are
  std::vector<double> Cell; ///< the cell's three sides, as vectors; empty: it has none
  std::array<double, 3> Origin = {};
  std::array<bool, 3> Periodic = {};
  double Time = std::numeric_limits<double>::quiet_NaN(); ///< NaN: not given
};

/// Goes to the next step; its particles are still to be read. Returns false if there is none.
using StepFinder = bool (*)(Lines& lines, Step& step);

bool FindXyzStep(Lines& lines, Step& step)
{
  step = {};
  do
  {
    if (!lines.Next())
    {
      return false;
    }
  } while (Trimmed(lines.Get()).empty());
  step.Count = CountOf(lines.Get());
  Require(step.Count >= 0,
    vtkSPHSay(MCOR_SAY(STEP_WITHOUT_COUNT), lines.File.c_str(), lines.Where().c_str()));
  lines.Need("the second line of a step");
  std::map<std::string, std::string> values = ValuesOf(lines.Get());
  step.Columns = PropertiesOf(lines, values["properties"]);
  step.Cell = NumbersOf(values["lattice"]);
  const std::vector<View> words = Split(values["pbc"], ' ');
  const std::vector<double> origin = NumbersOf(values["origin"]), time = NumbersOf(values["time"]);
  for (const auto& [key, count, least] : { std::tuple("lattice", step.Cell.size(), 9U),
         std::tuple("pbc", words.size(), 3U), std::tuple("origin", origin.size(), 3U) })
  {
    lines.Check(count == least || values[key].empty(),
      " has " + std::to_string(count) + " values as its " + key + ", which are " +
        std::to_string(least));
  }
  for (std::size_t a = 0; a < 3 && !step.Cell.empty(); ++a)
  {
    step.Periodic[a] = words.empty() || (words[a] != "F" && words[a] != "0" && words[a] != "False");
    step.Origin[a] = origin.empty() ? 0.0 : origin[a];
  }
  step.Time = time.size() == 1 ? time[0] : step.Time;
  return true;
}

bool StartsWith(View text, View start)
{
  return text.substr(0, start.size()) == start;
}

/// Reads the box of a dump: a cell along the axes; or a tilted cell (xy xz yz), where the first two
/// numbers of each line are the bounds of the box around the cell; or vectors with their origin (abc
/// origin).
void ReadBox(Lines& lines, std::vector<View> words, Step& step)
{
  const auto isFlag = [](View word)
  { return word.size() == 2 && word.find_first_not_of("pfsm") == View::npos; };
  if (words.size() >= 3 && std::all_of(words.end() - 3, words.end(), isFlag))
  {
    std::transform(
      words.end() - 3, words.end(), step.Periodic.begin(), [](View word) { return word == "pp"; });
    words.resize(words.size() - 3);
  }
  const bool isTilted = words == std::vector<View>{ "xy", "xz", "yz" };
  const bool isOfVectors = words == std::vector<View>{ "abc", "origin" };
  lines.Check(
    words.empty() || isTilted || isOfVectors, " begins a box of a kind that is not known here");
  const std::size_t count = isOfVectors ? 4 : isTilted ? 3 : 2;
  std::array<std::vector<double>, 3> s; // the lines' numbers
  for (std::vector<double>& side : s)
  {
    lines.Need("the bounds of the box");
    side = NumbersOf(lines.Get());
    lines.Check(side.size() == count,
      " has " + std::to_string(side.size()) + " numbers, where a side of its box has " +
        std::to_string(count));
  }
  if (isOfVectors)
  {
    step.Origin = { s[0][3], s[1][3], s[2][3] };
    step.Cell = { s[0][0], s[0][1], s[0][2], s[1][0], s[1][1], s[1][2], s[2][0], s[2][1], s[2][2] };
    return;
  }
  const double xy = isTilted ? s[0][2] : 0.0, xz = isTilted ? s[1][2] : 0.0,
               yz = isTilted ? s[2][2] : 0.0;
  step.Origin = { s[0][0] - std::min({ 0.0, xy, xz, xy + xz }), s[1][0] - std::min(0.0, yz),
    s[2][0] };
  const double highX = s[0][1] - std::max({ 0.0, xy, xz, xy + xz }),
               highY = s[1][1] - std::max(0.0, yz);
  step.Cell = { highX - step.Origin[0], 0.0, 0.0, xy, highY - step.Origin[1], 0.0, xz, yz,
    s[2][1] - step.Origin[2] };
}

bool FindDumpStep(Lines& lines, Step& step)
{
  step = {};
  bool isTold = false; // whether TIME has given the time
  bool hasBegun = false;
  while (lines.Next())
  {
    const View line = Trimmed(lines.Get());
    hasBegun = hasBegun || !line.empty();
    std::vector<View> words = Split(line, ' ');
    if (StartsWith(line, "ITEM: TIME"))
    {
      const bool isStep = words[1] == "TIMESTEP";
      double time = 0.0;
      lines.Need("the number of a step");
      lines.Check(ToNumber(Trimmed(lines.Get()), time), " is no time");
      step.Time = isStep && isTold ? step.Time : time;
      isTold = isTold || !isStep;
    }
    else if (StartsWith(line, "ITEM: NUMBER OF ATOMS"))
    {
      lines.Need("the number of particles");
      step.Count = CountOf(lines.Get());
      lines.Check(step.Count >= 0, " is no number of particles");
    }
    else if (StartsWith(line, "ITEM: BOX BOUNDS"))
    {
      ReadBox(lines, { words.begin() + 3, words.end() }, step);
    }
    else if (StartsWith(line, "ITEM: ATOMS"))
    {
      step.Columns = ColumnsOf({ words.begin() + 2, words.end() });
      return true;
    }
    else if (line == "ITEM: UNITS")
    {
      lines.Need("the name of its units");
    }
    else
    {
      lines.Check(line.empty(), " is no item of a dump of LAMMPS that is known here");
    }
  }
  RequireToRead(!hasBegun, lines.File, "it ends before the particles of a step");
  return false;
}

/// Returns the columns of a step's positions: x, y, z, or xu, yu, zu (unwrapped). If the step only has
/// shares of the cell (xs, ys, zs or xsu, ysu, zsu), replaces the shares by positions, and returns their
/// columns.
std::vector<std::size_t> PositionsOf(const std::string& file, Step& step)
{
  Table& table = step.Columns;
  const std::vector<std::size_t> unwrapped = FindAxes(table, "u"), scaled = FindAxes(table, "s");
  const std::vector<std::size_t> shares = scaled.size() < 3 ? FindAxes(table, "su") : scaled;
  if (FindAxes(table, "").size() == 3 || (unwrapped.size() < 3 && shares.size() < 3))
  {
    return FindPositions(file, table);
  }
  if (unwrapped.size() == 3)
  {
    return unwrapped;
  }
  RequireToRead(
    !step.Cell.empty(), file, "its positions are shares of a box (xs, ys, zs), and it has no box");
  for (std::size_t row = 0; row < table.front().Numbers.size(); ++row)
  {
    std::array<double, 3> place = step.Origin;
    for (std::size_t k = 0; k < 9; ++k)
    {
      place[k % 3] += table[shares[k / 3]].Numbers[row] * step.Cell[k];
    }
    for (std::size_t a = 0; a < 3; ++a)
    {
      table[shares[a]].Numbers[row] = place[a];
    }
  }
  return shares;
}

/// Returns the period for the field data: six bounds, 0 for axes without a period. If a side with a period is tilted,
/// returns the cell's three sides as vectors; vtkSPHFindPeriod() then finds a tilted cell in place of a period.
std::vector<double> PeriodOf(const Step& step)
{
  std::vector<double> period(6);
  for (std::size_t a = 0; a < 3 && !step.Cell.empty(); ++a)
  {
    for (std::size_t b = 0; b < 3 && step.Periodic[a]; ++b)
    {
      if (a != b && step.Cell[3 * a + b] != 0.0)
      {
        return step.Cell;
      }
    }
    if (step.Periodic[a] && step.Cell[4 * a] > 0.0)
    {
      period[2 * a] = step.Origin[a];
      period[2 * a + 1] = step.Origin[a] + step.Cell[4 * a];
    }
  }
  return period;
}

/// Returns the function that finds a file's steps; null for a table, which is one step.
StepFinder FinderOf(const std::string& file)
{
  Lines lines(file);
  const View first = lines.Next() ? lines.Get() : View();
  // A .xyz file begins with a count of particles, unless it is a table.
  const bool isCounted = EndsWith(file, "xyz") && CountOf(first) >= 0;
  return StartsWith(first, "ITEM:") || EndsWith(file, ".lammpstrj") || EndsWith(file, ".dump")
    ? FindDumpStep
    : isCounted ? FindXyzStep
                : nullptr;
}

/// Where the steps of a file begin, as ListTimesInText() has found. A film thus reads a step without
/// going through all earlier steps.
std::map<std::string, std::vector<Lines>> KnownSteps;

vtkSmartPointer<vtkDataObject> ReadStep(
  const std::string& file, StepFinder find, std::size_t number)
{
  Lines lines(file);
  if (number > 0)
  {
    const std::vector<Lines>& known = KnownSteps[file];
    if (known.empty() || known.front().GetRest().size() != lines.GetRest().size()) // it has grown
    {
      ListTimesInText(file);
    }
    RequireToRead(number < known.size(), file, "it has no step " + std::to_string(number));
    lines = known[number];
  }
  Step step;
  Table& table = step.Columns;
  RequireToRead(find(lines, step), file, "it has no step " + std::to_string(number));
  for (vtkTypeInt64 i = 0; i < step.Count; ++i)
  {
    lines.Need("all particles of a step");
    const std::vector<View> cells = Split(lines.Get(), ' ');
    if (table.empty())
    {
      const bool hasSpecies = cells.size() > 3;
      table = NumberedColumns(cells.size() - hasSpecies);
      table.insert(table.begin(), hasSpecies, Column("species"));
    }
    AddRow(table, lines, cells, ' ');
  }
  std::vector<View> behind; // the first words behind the step
  while (behind.empty() && lines.Next())
  {
    behind = Split(lines.Get(), ' ');
  }
  const bool beginsStep = behind.empty() ||
    (find == FindXyzStep ? CountOf(lines.Get()) >= 0 : StartsWith(behind[0], "ITEM:"));
  // The line behind a step must begin another step. A line that does not is reported here if it has as many
  // words as a particle, or if this step is the first one; otherwise, it is reported when the next step is read.
  lines.Check(beginsStep || (number > 0 && behind.size() != table.size()),
    " is one more than the " + std::to_string(step.Count) +
      " particles that the step says it has; correct that number");
  if (table.empty())
  {
    table = NumberedColumns(3);
  }
  const std::vector<std::size_t> positions = PositionsOf(file, step);
  const vtkSmartPointer<vtkPolyData> particles = ParticlesOf(file, table, positions);
  const std::vector<double> period = PeriodOf(step);
  if (period != std::vector<double>(6))
  {
    AddNumbers(particles->GetFieldData(), "PeriodicBounds", period);
  }
  if (!std::isnan(step.Time))
  {
    AddNumbers(particles->GetFieldData(), "TimeValue", { step.Time });
  }
  return particles;
}
}

vtkSmartPointer<vtkDataObject> ReadText(const std::string& file, std::size_t step)
{
  const StepFinder find = FinderOf(file);
  RequireToRead(find || step == 0, file, "it has no step " + std::to_string(step));
  return find ? ReadStep(file, find, step) : ReadRows(file);
}

std::vector<double> ListTimesInText(const std::string& file)
{
  std::vector<double> times;
  const StepFinder find = FinderOf(file);
  Lines lines(file);
  Step step;
  std::vector<Lines> begins;
  try
  {
    for (begins.push_back(lines); find && find(lines, step); begins.push_back(lines))
    {
      times.push_back(std::isnan(step.Time) ? static_cast<double>(times.size()) : step.Time);
      for (vtkTypeInt64 i = 0; i < step.Count && lines.Next(); ++i)
      {
      }
    }
  }
  catch (const std::runtime_error&)
  {
    const std::size_t good = times.size();
    if (good == 0)
    {
      throw;
    }
    // The steps before a damaged one are good. The damaged step is listed, too: reading it reports
    // the error.
    times.push_back(times.back() + (good > 1 ? times.back() - times[good - 2] : 1.0));
  }
  // A file of one step does not stay mapped into memory: a film may have more files than a process may map.
  KnownSteps[file] = times.size() > 1 ? begins : std::vector<Lines>();
  return times;
}
