// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "FileName.h"
#include "SafeText.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTypeInt64Array.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <string_view>

namespace
{

using View = std::string_view;

View Trimmed(View text)
{
  const std::size_t begin = text.find_first_not_of(" \t\r\"");
  return begin == View::npos ? View()
                             : text.substr(begin, text.find_last_not_of(" \t\r\"") + 1 - begin);
}

std::string Small(View text)
{
  std::string small(text);
  std::transform(small.begin(), small.end(), small.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return small;
}

/// A number as it stands in tables: with a leading plus, a D of Fortran, or a comma; nan, inf.
bool ToNumber(View text, double& value)
{
  if (text.size() > 1 && text[0] == '+' && text[1] != '-')
  {
    text.remove_prefix(1);
  }
  std::string copy;
  auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc::result_out_of_range && end.ptr != text.data() + text.size())
  {
    copy = std::string(text);
    for (char& c : copy)
    {
      c = c == 'd' || c == 'D' ? 'e' : c == ',' ? '.' : c;
    }
    text = copy;
    end = std::from_chars(text.data(), text.data() + text.size(), value);
  }
  if (end.ec == std::errc::result_out_of_range)
  {
    value = std::strtod(std::string(text).c_str(), nullptr); // infinite, or 0
  }
  return end.ec != std::errc::invalid_argument && end.ptr == text.data() + text.size();
}

bool ToInteger(View text, vtkTypeInt64& value)
{
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  return end.ec == std::errc() && end.ptr == text.data() + text.size();
}

/// The cells of a line: between separators, of which blanks count as one, unless they are in
/// quotes.
void Split(View line, char separator, std::vector<View>& cells)
{
  cells.clear();
  const bool isBlank = separator == ' ';
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i <= line.size(); ++i)
  {
    const char c = i < line.size() ? line[i] : separator;
    quoted = quoted != (c == '"' && i < line.size());
    const bool ends =
      i == line.size() || (!quoted && (c == separator || (isBlank && (c == '\t' || c == '\r'))));
    if (!ends)
    {
      continue;
    }
    if (!isBlank || i > begin)
    {
      cells.push_back(Trimmed(line.substr(begin, i - begin)));
    }
    begin = i + 1;
  }
}

/// The lines of a file, one at a time.
class Lines
{
public:
  explicit Lines(const std::string& file)
    : File(file)
    , Stream(file, std::ios::binary)
  {
  }

  /// Reads the next line. Returns false at the end.
  bool Next()
  {
    if (!std::getline(this->Stream, this->Line))
    {
      return false;
    }
    if (++this->Number == 1 && this->Line.compare(0, 3, "\xEF\xBB\xBF") == 0)
    {
      this->Line.erase(0, 3); // a mark of UTF-8
    }
    if (this->Line.find('\0') != std::string::npos)
    {
      FailToRead(this->File,
        "line " + std::to_string(this->Number) + " is no text; if it is UTF-16, save it as UTF-8");
    }
    if (!this->Line.empty() && this->Line.back() == '\r')
    {
      this->Line.pop_back();
    }
    if (this->Line.find('\r') != std::string::npos)
    {
      FailToRead(this->File, "its lines end in carriage returns alone; save it with line feeds");
    }
    return true;
  }

  void Need(const char* what)
  {
    if (!this->Next())
    {
      FailToRead(this->File, std::string("it ends before ") + what);
    }
  }

  /// Where the next line begins.
  struct Place
  {
    std::streamoff Offset;
    std::size_t Number;
  };
  Place Here() { return { this->Stream.tellg(), this->Number }; }
  void GoTo(const Place& place)
  {
    this->Stream.seekg(place.Offset);
    this->Number = place.Number;
  }

  View Get() const { return this->Line; }
  std::string Where() const { return "line " + std::to_string(this->Number); }

  const std::string File;

private:
  std::ifstream Stream;
  std::string Line;
  std::size_t Number = 0;
};

struct Column
{
  explicit Column(const std::string& name)
    : Name(name)
  {
  }

  std::string Name;
  std::vector<double> Numbers;
  std::vector<std::string> Words;  ///< of one that is not of numbers; else empty
  std::vector<vtkTypeInt64> Whole; ///< of one that may have identifiers; else empty

  void Add(View cell)
  {
    double number = std::numeric_limits<double>::quiet_NaN();
    const std::size_t rows = this->Numbers.size();
    const bool isNumber = cell.empty() || ToNumber(cell, number);
    vtkTypeInt64 whole = 0;
    if (this->Whole.size() == rows && ToInteger(cell, whole))
    {
      this->Whole.push_back(whole);
    }
    else
    {
      this->Whole.clear();
    }
    if (!this->Words.empty() || (!isNumber && rows == 0))
    {
      this->Words.emplace_back(cell);
    }
    // One word among numbers is no number; a column of words has words from its beginning on.
    this->Numbers.push_back(isNumber ? number : std::numeric_limits<double>::quiet_NaN());
  }
};

using Table = std::vector<Column>;

Table TableOf(const std::vector<std::string>& names)
{
  return { names.begin(), names.end() };
}

void AddRow(Table& table, const Lines& lines, const std::vector<View>& cells)
{
  if (cells.size() != table.size())
  {
    FailToRead(lines.File,
      lines.Where() + " has " + std::to_string(cells.size()) + " values for " +
        std::to_string(table.size()) + " columns");
  }
  for (std::size_t c = 0; c < cells.size(); ++c)
  {
    table[c].Add(cells[c]);
  }
}

/// A name without what makes it a component (v:0, v_x, v.x, v[0], v(0), VelX), and which one it is;
/// below 0: it is none.
int ComponentOf(const std::string& name, std::string& base)
{
  const std::size_t n = name.size();
  const bool isInBrackets = n > 3 && (name[n - 3] == '[' || name[n - 3] == '(');
  const bool isMarked = n > 2 && (name[n - 2] == ':' || name[n - 2] == '_' || name[n - 2] == '.');
  const bool isCapital = n > 3 && std::islower(static_cast<unsigned char>(name[n - 2])) &&
    std::isupper(static_cast<unsigned char>(name[n - 1]));
  if (!isInBrackets && !isMarked && !isCapital)
  {
    return -1;
  }
  base = name.substr(0, n - (isInBrackets ? 3 : isMarked ? 2 : 1));
  const std::size_t axis = View("xyzXYZ").find(name[n - 1]);
  const char digit = name[isInBrackets ? n - 2 : n - 1];
  return digit >= '0' && digit <= '8'    ? digit - '0'
    : isInBrackets || axis == View::npos ? -1
                                         : static_cast<int>(axis % 3);
}

/// An array, and the columns of its components.
struct Array
{
  std::string Name;
  std::vector<std::size_t> Columns; ///< none: they are positions, or belong to another array
};

/// Lists arrays, each at its first column: columns alone, and vectors, whose names tell components.
std::vector<Array> FindArrays(const Table& table, const std::vector<std::size_t>& positions = {})
{
  std::vector<Array> arrays;
  std::map<std::string, std::map<int, std::size_t>> vectors; // columns by name and component
  for (const Column& column : table)
  {
    std::string base;
    const int component = ComponentOf(column.Name, base);
    const std::size_t c = arrays.size();
    const bool isFree = std::find(positions.begin(), positions.end(), c) == positions.end();
    if (component >= 0 && isFree)
    {
      vectors[base].emplace(component, c);
    }
    arrays.push_back({ column.Name, std::vector<std::size_t>(isFree ? 1 : 0, c) });
  }
  for (const Column& column : table)
  {
    vectors.erase(column.Name);
  }
  for (const auto& [base, components] : vectors)
  {
    const std::size_t count = components.size();
    const bool isUsual = count == 2 || count == 3 || count == 6 || count == 9;
    if (isUsual && components.rbegin()->first == static_cast<int>(count) - 1)
    {
      Array vector = { base, {} };
      for (const auto& component : components)
      {
        vector.Columns.push_back(component.second);
        arrays[component.second].Columns.clear();
      }
      arrays[*std::min_element(vector.Columns.begin(), vector.Columns.end())] = vector;
    }
  }
  return arrays;
}

/// The columns called x, y and z, with these letters behind; one of them is none.
std::vector<std::size_t> FindAxes(const Table& table, const std::string& behind)
{
  std::vector<std::size_t> found;
  for (const char axis : { 'x', 'y', 'z' })
  {
    const auto at = std::find_if(table.begin(), table.end(),
      [name = axis + behind](const Column& column) { return Small(column.Name) == name; });
    if (at != table.end())
    {
      found.push_back(static_cast<std::size_t>(at - table.begin()));
    }
  }
  return found.size() >= 2 ? found : std::vector<std::size_t>();
}

/// The columns of positions, two or three; none where no name tells.
std::vector<std::size_t> FindPositions(const Table& table)
{
  const std::vector<Array> arrays = FindArrays(table);
  for (const char* usual : { "points", "point", "position", "positions", "pos", "coordinates",
         "coordinate", "coords", "coord", "xyz", "r" })
  {
    for (const Array& array : arrays)
    {
      const std::size_t count = array.Columns.size();
      if ((count == 2 || count == 3) && Small(array.Name) == usual)
      {
        return array.Columns;
      }
    }
  }
  return FindAxes(table, "");
}

vtkSmartPointer<vtkDoubleArray> JoinColumns(
  const Table& table, const std::vector<std::size_t>& columns, int components)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  const std::size_t rows = table[columns[0]].Numbers.size();
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(rows));
  array->Fill(0.0);
  for (std::size_t k = 0; k < columns.size(); ++k)
  {
    for (std::size_t row = 0; row < rows; ++row)
    {
      array->SetTypedComponent(
        static_cast<vtkIdType>(row), static_cast<int>(k), table[columns[k]].Numbers[row]);
    }
  }
  return array;
}

template <typename ArrayT, typename ValueT>
vtkSmartPointer<ArrayT> ArrayWith(const std::vector<ValueT>& values)
{
  auto array = vtkSmartPointer<ArrayT>::New();
  array->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}

vtkSmartPointer<vtkAbstractArray> ArrayOf(
  const Table& table, const std::vector<std::size_t>& columns)
{
  const Column& first = table[columns[0]];
  if (columns.size() == 1 && !first.Words.empty())
  {
    return ArrayWith<vtkStringArray>(first.Words);
  }
  std::string letters = Small(first.Name);
  letters.erase(std::remove_if(
                  letters.begin(), letters.end(), [](unsigned char c) { return !std::isalpha(c); }),
    letters.end());
  const auto ends = { "id", "ids", "idp", "type", "types", "index", "mk", "tag", "mol", "iorig" };
  if (columns.size() == 1 && !first.Whole.empty() &&
    std::any_of(ends.begin(), ends.end(),
      [&letters](const char* end) { return letters == end || EndsWith(letters, end); }))
  {
    return ArrayWith<vtkTypeInt64Array>(first.Whole); // which tells particles, or kinds, apart
  }
  return JoinColumns(table, columns, static_cast<int>(columns.size()));
}

/// `positions`: the columns of positions; where there are none, names tell.
vtkSmartPointer<vtkPolyData> ParticlesOf(
  const std::string& file, const Table& table, std::vector<std::size_t> positions)
{
  positions = positions.empty() ? FindPositions(table) : positions;
  if (positions.empty())
  {
    std::string list;
    for (std::size_t c = 0; c < table.size() && list.size() < 200; ++c)
    {
      list += (c ? ", " : "") + table[c].Name;
    }
    FailToRead(file,
      "it has no columns of positions, which are called x, y and z, or Points:0, Points:1 and "
      "Points:2; there are " +
        list);
  }
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetData(JoinColumns(table, positions, 3));
  particles->SetPoints(points);
  for (const Array& each : FindArrays(table, positions))
  {
    if (!each.Columns.empty())
    {
      const vtkSmartPointer<vtkAbstractArray> array = ArrayOf(table, each.Columns);
      array->SetName(each.Name.c_str());
      particles->GetPointData()->AddArray(array);
    }
  }
  return particles;
}

/// Returns names of columns, without units in brackets; no two are the same.
std::vector<std::string> NamesOf(const std::vector<View>& cells)
{
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const View cell : cells)
  {
    const std::size_t bracket = cell.find(" (");
    const View inside = bracket == View::npos ? View() : cell.substr(bracket + 2);
    const bool isUnit = // and not a component, as in "v (x)"
      inside.size() != 2 || View("012345678xyzXYZ").find(inside[0]) == View::npos;
    std::string name(
      Trimmed(cell.substr(0, std::min(cell.find(" ["), isUnit ? bracket : View::npos))));
    name = name.empty() ? "Column" + std::to_string(names.size() + 1) : name;
    while (!taken.insert(name).second)
    {
      name += "_";
    }
    names.push_back(name);
  }
  return names;
}

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

/// Splits what may be names in a comment: x y z, or x, y, z, or [01 x] [02 y] [03 z].
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

/// Rows of values, after one of names, which may stand in a comment.
vtkSmartPointer<vtkDataObject> ReadRows(const std::string& file)
{
  constexpr std::size_t mostColumns = 10000;
  const bool isBlankTab = !EndsWith(file, ".csv") && !EndsWith(file, ".tsv");
  Lines lines(file);
  Table table;
  std::vector<View> cells;
  std::string comment;
  char separator = 0; // blanks, which may be tabs, count as one
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
    AddRow(table, lines, cells);
  }
  if (table.empty())
  {
    FailToRead(file, "it has no row of values");
  }
  std::vector<std::size_t> positions = FindPositions(table);
  const std::size_t first = separator == ' ' && table.size() > 1 ? 3 : 0; // else names have to tell
  for (std::size_t c = 0; c < std::min(first, table.size()) && positions.size() == c; ++c)
  {
    positions.push_back(c);
  }
  return ParticlesOf(file, table, positions);
}

void AddNumbers(vtkPolyData* particles, const char* name, const std::vector<double>& values)
{
  const auto array = ArrayWith<vtkDoubleArray>(values);
  array->SetName(name);
  particles->GetFieldData()->AddArray(array);
}

/// A count that a line says, or one below 0 that it does not.
vtkTypeInt64 CountOf(View line)
{
  vtkTypeInt64 count = -1;
  return ToInteger(Trimmed(line), count) ? count : -1;
}

/// The texts behind KEY= in the second line of extended XYZ, with or without quotes, by the keys in
/// small letters.
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

/// Columns by the names, types and widths in Properties=species:S:1:pos:R:3:...
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

/// One of several steps in a file: what stands before its particles.
struct Step
{
  vtkTypeInt64 Count = 0;
  std::vector<std::string> Names; ///< empty: as many as the first row has values
  std::array<double, 6> Bounds = {};
  std::array<bool, 3> Periodic = {};
  double Time = std::numeric_limits<double>::quiet_NaN(); ///< where it is told
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
    FailToRead(lines.File, lines.Where() + " does not say how many particles a step has");
  }
  lines.Need("the second line of a step");
  std::map<std::string, std::string> values = ValuesOf(lines.Get());
  step.Names = PropertiesOf(lines.File, values["properties"]);
  const std::vector<double> side = NumbersOf(values["lattice"]);
  const bool isBox = side.size() == 9 && side[1] == 0.0 && side[2] == 0.0 && side[3] == 0.0 &&
    side[5] == 0.0 && side[6] == 0.0 && side[7] == 0.0;
  std::vector<View> words;
  Split(values["pbc"], ' ', words);
  const std::vector<double> origin = NumbersOf(values["origin"]);
  for (std::size_t a = 0; a < 3 && isBox; ++a)
  {
    step.Periodic[a] =
      words.size() != 3 || (words[a] != "F" && words[a] != "0" && words[a] != "False");
    step.Bounds[2 * a] = origin.size() == 3 ? origin[a] : 0.0;
    step.Bounds[2 * a + 1] = step.Bounds[2 * a] + side[4 * a];
  }
  const std::vector<double> time = NumbersOf(values["time"]);
  step.Time = time.size() == 1 ? time[0] : step.Time;
  return true;
}

bool StartsWith(View text, View start)
{
  return text.substr(0, start.size()) == start;
}

bool FindDumpStep(Lines& lines, Step& step)
{
  step = {};
  bool isTold = false; // of a time in its own unit
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
      for (std::size_t a = 0; a < 3; ++a)
      {
        step.Periodic[a] = words.size() >= 6 && words[words.size() - 3 + a] == "pp";
      }
      for (std::size_t a = 0; a < 3; ++a)
      {
        lines.Need("the bounds of the box");
        const std::vector<double> bounds = NumbersOf(lines.Get());
        step.Bounds[2 * a] = bounds.empty() ? 0.0 : bounds[0];
        step.Bounds[2 * a + 1] = bounds.size() < 2 ? 0.0 : bounds[1];
      }
    }
    else if (StartsWith(line, "ITEM: ATOMS"))
    {
      words.erase(words.begin(), words.begin() + 2);
      step.Names = NamesOf(words);
      return true;
    }
    else if (StartsWith(line, "ITEM:"))
    {
      lines.Need("what an item holds"); // UNITS
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

/// The columns of positions of a step: as they are, unwrapped, or in units of the box, which are
/// taken away.
std::vector<std::size_t> PositionsOf(Table& table, const Step& step)
{
  std::vector<std::size_t> positions = FindPositions(table);
  for (const char* kind : { "u", "s", "su" })
  {
    if (!positions.empty())
    {
      break;
    }
    positions = FindAxes(table, kind);
    for (const std::size_t column : positions)
    {
      const auto a = static_cast<std::size_t>(Small(table[column].Name)[0] - 'x');
      for (double& x : table[column].Numbers)
      {
        x =
          *kind == 's' ? step.Bounds[2 * a] + x * (step.Bounds[2 * a + 1] - step.Bounds[2 * a]) : x;
      }
    }
  }
  return positions;
}

/// How the steps of a file are found; null where it is a table, which is one.
StepFinder FinderOf(const std::string& file)
{
  Lines lines(file);
  const View first = lines.Next() ? lines.Get() : View();
  const bool isCounted = EndsWith(file, "xyz") && CountOf(first) >= 0; // and no table of positions
  return StartsWith(first, "ITEM:") || EndsWith(file, ".lammpstrj") || EndsWith(file, ".dump")
    ? FindDumpStep
    : isCounted ? FindXyzStep
                : nullptr;
}

/// Where steps begin, as ListTimesInText() has found them in a file of this size: a film does not
/// go through all steps before each.
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
    AddRow(table, lines, cells);
  }
  table = table.empty() ? TableOf({ "x", "y", "z" }) : table;
  const vtkSmartPointer<vtkPolyData> particles = ParticlesOf(file, table, PositionsOf(table, step));
  std::vector<double> period(6);
  for (std::size_t a = 0; a < 3; ++a)
  {
    if (step.Periodic[a] && step.Bounds[2 * a] < step.Bounds[2 * a + 1])
    {
      period[2 * a] = step.Bounds[2 * a];
      period[2 * a + 1] = step.Bounds[2 * a + 1];
    }
  }
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
  std::error_code error; // which is told where the file is read
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
    // The steps before are good; what is wrong with this one is told where it is read.
    times.push_back(times.back() + (good > 1 ? times.back() - times[good - 2] : 1.0));
  }
  KnownSteps[file] = known;
  return times;
}
