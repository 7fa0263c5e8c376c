// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "FileName.h"
#include "SafeText.h"
#include "TextTable.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkSPHSay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

namespace
{

std::vector<std::string> NumberedNames(std::size_t count)
{
  std::vector<std::string> names;
  for (std::size_t c = 0; c < count; ++c)
  {
    names.push_back(c < 3 ? std::string(1, "xyz"[c]) : "Column" + std::to_string(c + 1));
  }
  return names;
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
  const std::size_t open = comment.find('['), blank = comment.find(' ', open);
  double number;
  if (blank == View::npos || !ToNumber(comment.substr(open + 1, blank - open - 1), number))
  {
    Split(comment, comment.find(',') != View::npos ? ',' : ' ', words);
    return words;
  }
  for (std::size_t at = open; at != View::npos; at = comment.find('[', at + 1))
  {
    const View part = comment.substr(at, comment.find(']', at) - at);
    words.push_back(Trimmed(part.substr(std::min(part.find(' '), part.size()))));
  }
  return words;
}

/// Reads rows of values below a row of names, which may be a comment.
vtkSmartPointer<vtkDataObject> ReadRows(const std::string& file)
{
  constexpr std::size_t mostColumns = 10000;
  const bool isBlankTab = !EndsWith(file, ".csv") && !EndsWith(file, ".tsv");
  Lines lines(file);
  Table table;
  std::vector<View> cells;
  std::string comment;
  char separator = 0; // blanks and tabs count as one separator
  while (lines.Next())
  {
    View line = Trimmed(lines.Get());
    if (line.empty() || line[0] == '#' || line[0] == '%' || line[0] == '!')
    {
      const std::size_t begin = line.find_first_not_of("#%! \t");
      comment = line.empty() ? comment : std::string(line.substr(std::min(begin, line.size())));
      continue;
    }
    if (separator == 0)
    {
      const auto has = [line](char sign) { return line.find(sign) != View::npos; };
      separator = has(';') ? ';' : has('\t') && !isBlankTab ? '\t' : has(',') ? ',' : ' ';
    }
    line = separator == ' ' ? line.substr(0, line.find('#')) : lines.Get();
    Split(line, separator, cells);
    if (table.empty())
    {
      if (cells.size() > mostColumns)
      {
        FailToRead(file, lines.Where() + " has " + std::to_string(cells.size()) + " columns");
      }
      const std::vector<View> words = WordsOf(comment);
      const bool isHead = !AreNumbers(cells);
      table = TableOf(isHead                                   ? NamesOf(cells)
          : words.size() == cells.size() && !AreNumbers(words) ? NamesOf(words)
                                                               : NumberedNames(cells.size()));
      if (isHead)
      {
        continue;
      }
    }
    AddRow(table, lines, cells, separator);
  }
  if (table.empty())
  {
    FailToRead(file, "it has no row of values");
  }
  std::vector<std::size_t> positions = FindPositions(file, table);
  // Without names, the first three columns are positions, but only between blanks.
  const std::size_t first = separator == ' ' && table.size() > 1 ? 3 : 0;
  for (std::size_t c = 0; c < std::min(first, table.size()) && positions.size() == c; ++c)
  {
    positions.push_back(c);
  }
  return ParticlesOf(file, table, positions);
}

void AddNumbers(vtkPolyData* particles, const char* name, const std::vector<double>& values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  for (const double value : values)
  {
    array->InsertNextValue(value);
  }
  particles->GetFieldData()->AddArray(array);
}

/// Returns the count that a line gives, or a negative number if it gives none.
vtkTypeInt64 CountOf(View line)
{
  vtkTypeInt64 count = -1;
  return ToInteger(Trimmed(line), count) ? count : -1;
}

/// Returns the texts behind KEY= in the second line of extended XYZ, with or without quotes, by the
/// keys in small letters.
std::map<std::string, std::string> ValuesOf(View comment)
{
  std::map<std::string, std::string> values;
  std::vector<View> words;
  Split(comment, ' ', words);
  for (const View word : words)
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
  std::vector<View> words;
  std::vector<double> numbers;
  Split(text, ' ', words);
  for (const View word : words)
  {
    double number = 0.0;
    if (ToNumber(word, number))
    {
      numbers.push_back(number);
    }
  }
  return numbers;
}

/// Returns names of columns from the names, types and widths in Properties=species:S:1:pos:R:3:...
std::vector<std::string> PropertiesOf(const std::string& file, const std::string& text)
{
  std::vector<std::string> names;
  std::vector<View> parts;
  Split(text, ':', parts);
  for (std::size_t p = 0; p + 2 < parts.size(); p += 3)
  {
    const vtkTypeInt64 width = CountOf(parts[p + 2]);
    if (width < 1 || width > 100)
    {
      FailToRead(file,
        "its Properties give " + std::string(parts[p]) + " " + std::string(parts[p + 2]) +
          " columns");
    }
    for (vtkTypeInt64 c = 0; c < width; ++c)
    {
      names.push_back(std::string(parts[p]) + (width == 1 ? "" : ":" + std::to_string(c)));
    }
  }
  return names;
}

/// What a file says of one of its steps, before the step's particles.
struct Step
{
  vtkTypeInt64 Count = 0;
  std::vector<std::string> Names; ///< empty: the first row decides how many there are
  std::vector<double> Cell;       ///< the cell's three sides, as vectors; empty: it has none
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
  if (step.Count < 0)
  {
    throw std::runtime_error(
      vtkSPHSay(MCOR_SAY(STEP_WITHOUT_COUNT), lines.File.c_str(), lines.Where().c_str()));
  }
  lines.Need("the second line of a step");
  std::map<std::string, std::string> values = ValuesOf(lines.Get());
  step.Names = PropertiesOf(lines.File, values["properties"]);
  step.Cell = NumbersOf(values["lattice"]);
  std::vector<View> words;
  Split(values["pbc"], ' ', words);
  const std::vector<double> origin = NumbersOf(values["origin"]);
  for (const auto& [key, count, least] : { std::tuple("lattice", step.Cell.size(), 9U),
         std::tuple("pbc", words.size(), 3U), std::tuple("origin", origin.size(), 3U) })
  {
    if (count != least && !values[key].empty())
    {
      FailToRead(lines.File,
        lines.Where() + " has " + std::to_string(count) + " values as its " + key + ", which are " +
          std::to_string(least));
    }
  }
  for (std::size_t a = 0; a < 3 && !step.Cell.empty(); ++a)
  {
    step.Periodic[a] = words.empty() || (words[a] != "F" && words[a] != "0" && words[a] != "False");
    step.Origin[a] = origin.empty() ? 0.0 : origin[a];
  }
  const std::vector<double> time = NumbersOf(values["time"]);
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
  const std::string kind = lines.Where();
  const auto isFlag = [](View word)
  { return word.size() == 2 && word.find_first_not_of("pfsm") == View::npos; };
  if (words.size() >= 3 && std::all_of(words.end() - 3, words.end(), isFlag))
  {
    for (std::size_t a = 0; a < 3; ++a)
    {
      step.Periodic[a] = words[words.size() - 3 + a] == "pp";
    }
    words.resize(words.size() - 3);
  }
  const bool isTilted = words == std::vector<View>{ "xy", "xz", "yz" };
  const bool isOfVectors = words == std::vector<View>{ "abc", "origin" };
  if (!words.empty() && !isTilted && !isOfVectors)
  {
    FailToRead(lines.File, kind + " begins a box of a kind that is not known here");
  }
  const std::size_t count = isOfVectors ? 4 : isTilted ? 3 : 2;
  std::array<std::vector<double>, 3> sides;
  for (std::vector<double>& side : sides)
  {
    lines.Need("the bounds of the box");
    side = NumbersOf(lines.Get());
    if (side.size() != count)
    {
      FailToRead(lines.File,
        lines.Where() + " has " + std::to_string(side.size()) +
          " numbers, where a side of its box has " + std::to_string(count));
    }
  }
  step.Cell.assign(9, 0.0);
  for (std::size_t a = 0; a < 3; ++a)
  {
    step.Origin[a] = sides[a][isOfVectors ? 3 : 0];
    step.Cell[4 * a] = sides[a][1];
    for (std::size_t b = 0; b < 3 && isOfVectors; ++b)
    {
      step.Cell[3 * a + b] = sides[a][b];
    }
  }
  if (isOfVectors)
  {
    return;
  }
  if (isTilted)
  {
    const double xy = sides[0][2], xz = sides[1][2], yz = sides[2][2];
    step.Cell[3] = xy;
    step.Cell[6] = xz;
    step.Cell[7] = yz;
    step.Origin[0] -= std::min({ 0.0, xy, xz, xy + xz });
    step.Cell[0] -= std::max({ 0.0, xy, xz, xy + xz });
    step.Origin[1] -= std::min(0.0, yz);
    step.Cell[4] -= std::max(0.0, yz);
  }
  for (std::size_t a = 0; a < 3; ++a)
  {
    step.Cell[4 * a] -= step.Origin[a];
  }
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
    std::vector<View> words;
    Split(line, ' ', words);
    if (StartsWith(line, "ITEM: TIME"))
    {
      const bool isStep = words[1] == "TIMESTEP";
      double time = 0.0;
      lines.Need("the number of a step");
      if (!ToNumber(Trimmed(lines.Get()), time))
      {
        FailToRead(lines.File, lines.Where() + " is no time");
      }
      step.Time = isStep && isTold ? step.Time : time;
      isTold = isTold || !isStep;
    }
    else if (StartsWith(line, "ITEM: NUMBER OF ATOMS"))
    {
      lines.Need("the number of particles");
      step.Count = CountOf(lines.Get());
      if (step.Count < 0)
      {
        FailToRead(lines.File, lines.Where() + " is no number of particles");
      }
    }
    else if (StartsWith(line, "ITEM: BOX BOUNDS"))
    {
      words.erase(words.begin(), words.begin() + 3);
      ReadBox(lines, words, step);
    }
    else if (StartsWith(line, "ITEM: ATOMS"))
    {
      words.erase(words.begin(), words.begin() + 2);
      step.Names = NamesOf(words);
      return true;
    }
    else if (line == "ITEM: UNITS")
    {
      lines.Need("the name of its units");
    }
    else if (!line.empty())
    {
      FailToRead(lines.File, lines.Where() + " is none of a dump of LAMMPS");
    }
  }
  if (hasBegun)
  {
    FailToRead(lines.File, "it ends before the particles of a step");
  }
  return false;
}

/// Returns the columns of a step's positions: x, unwrapped xu, or xs and xsu, which are multiplied
/// by the cell's sides first.
std::vector<std::size_t> PositionsOf(const std::string& file, Table& table, const Step& step)
{
  for (const char* kind : { "u", "s", "su" })
  {
    const std::vector<std::size_t> positions = FindAxes(table, kind);
    if (positions.size() < 3 || FindAxes(table, "").size() == 3)
    {
      continue;
    }
    if (*kind == 's' && step.Cell.empty())
    {
      FailToRead(file, "its positions are shares of a box (xs, ys, zs), and it has no box");
    }
    for (std::size_t row = 0; row < table.front().Numbers.size() && *kind == 's'; ++row)
    {
      std::array<double, 3> place = step.Origin;
      for (std::size_t k = 0; k < 9; ++k)
      {
        place[k % 3] += table[positions[k / 3]].Numbers[row] * step.Cell[k];
      }
      for (std::size_t a = 0; a < 3; ++a)
      {
        table[positions[a]].Numbers[row] = place[a];
      }
    }
    return positions;
  }
  return FindPositions(file, table);
}

/// Returns the cell for the field data: six bounds, 0 for axes without a period; or, if a side with a
/// period is tilted, the cell itself, which vtkSPHFindPeriod() does not take as a period.
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
  // A count of particles stands in the first line of such a file, but not of a table.
  const bool isCounted = EndsWith(file, "xyz") && CountOf(first) >= 0;
  return StartsWith(first, "ITEM:") || EndsWith(file, ".lammpstrj") || EndsWith(file, ".dump")
    ? FindDumpStep
    : isCounted ? FindXyzStep
                : nullptr;
}

/// Where steps begin, as ListTimesInText() has found in a file of this size. A film therefore need
/// not go through all earlier steps to read one.
struct Steps
{
  std::uintmax_t Size = 0;
  std::vector<Lines::Place> Places;
};
std::map<std::string, Steps> KnownSteps;

vtkSmartPointer<vtkDataObject> ReadStep(
  const std::string& file, StepFinder find, std::size_t number)
{
  Lines lines(file);
  Step step;
  bool isThere = number == 0;
  if (!isThere)
  {
    if (KnownSteps[file].Size != std::filesystem::file_size(file))
    {
      ListTimesInText(file);
    }
    const std::vector<Lines::Place>& places = KnownSteps[file].Places;
    isThere = number < places.size();
    lines.GoTo(isThere ? places[number] : lines.Here());
  }
  if (!isThere || !find(lines, step))
  {
    FailToRead(file, "it has no step " + std::to_string(number));
  }
  Table table = TableOf(step.Names);
  std::vector<View> cells;
  for (vtkTypeInt64 i = 0; i < step.Count; ++i)
  {
    lines.Need("all particles of a step");
    Split(lines.Get(), ' ', cells);
    if (table.empty())
    {
      const bool hasSpecies = cells.size() > 3;
      std::vector<std::string> names = NumberedNames(cells.size() - hasSpecies);
      names.insert(names.begin(), hasSpecies, "species");
      table = TableOf(names);
    }
    AddRow(table, lines, cells, ' ');
  }
  for (cells.clear(); cells.empty() && lines.Next();)
  {
    Split(lines.Get(), ' ', cells);
  }
  const bool beginsStep = cells.empty() ||
    (find == FindXyzStep ? CountOf(lines.Get()) >= 0 : StartsWith(cells[0], "ITEM:"));
  // Other lines behind later steps are reported when the next step is read.
  if (!beginsStep && (number == 0 || cells.size() == table.size()))
  {
    FailToRead(file,
      lines.Where() + " is one more than the " + std::to_string(step.Count) +
        " particles that the step says it has; correct that number");
  }
  table = table.empty() ? TableOf({ "x", "y", "z" }) : table;
  const vtkSmartPointer<vtkPolyData> particles =
    ParticlesOf(file, table, PositionsOf(file, table, step));
  const std::vector<double> period = PeriodOf(step);
  if (period != std::vector<double>(6))
  {
    AddNumbers(particles, "PeriodicBounds", period);
  }
  if (!std::isnan(step.Time))
  {
    AddNumbers(particles, "TimeValue", { step.Time });
  }
  return particles;
}

}

vtkSmartPointer<vtkDataObject> ReadText(const std::string& file, std::size_t step)
{
  const StepFinder find = FinderOf(file);
  if (!find && step > 0)
  {
    FailToRead(file, "it has no step " + std::to_string(step));
  }
  return find ? ReadStep(file, find, step) : ReadRows(file);
}

std::vector<double> ListTimesInText(const std::string& file)
{
  std::vector<double> times;
  const StepFinder find = FinderOf(file);
  Lines lines(file);
  Step step;
  std::error_code error; // it is reported when the file is read
  Steps known = { std::filesystem::file_size(file, error), {} };
  try
  {
    while (find)
    {
      known.Places.push_back(lines.Here());
      if (!find(lines, step))
      {
        known.Places.pop_back();
        break;
      }
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
    // The steps before this one are good; its error is reported when the step is read.
    times.push_back(times.back() + (good > 1 ? times.back() - times[good - 2] : 1.0));
  }
  KnownSteps[file] = known;
  return times;
}
