// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleTable.h"

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
#include <fstream>
#include <limits>
#include <map>
#include <stdexcept>
#include <string_view>

namespace
{

using View = std::string_view;

[[noreturn]] void Fail(const std::string& file, const std::string& why)
{
  throw std::runtime_error(file + " cannot be read: " + why);
}

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

/// A number as it stands in tables: with a leading plus, a D of Fortran, or a comma; nan, inf; nothing is no number
/// either.
bool ToNumber(View text, double& value)
{
  std::string copy;
  if (text.size() > 1 && text[0] == '+' && text[1] != '-')
  {
    text.remove_prefix(1);
  }
  auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec == std::errc() && end.ptr != text.data() + text.size() && text.size() < 512)
  {
    copy = std::string(text);
    std::replace_if(
      copy.begin(), copy.end(), [](char c) { return c == 'd' || c == 'D'; }, 'e');
    std::replace(copy.begin(), copy.end(), ',', '.');
    text = copy;
    end = std::from_chars(text.data(), text.data() + text.size(), value);
  }
  if (end.ec == std::errc::result_out_of_range)
  {
    value = text.find("e-") != View::npos || text.find("E-") != View::npos
      ? 0.0
      : std::numeric_limits<double>::infinity();
    return true;
  }
  return end.ec == std::errc() && end.ptr == text.data() + text.size();
}

bool ToInteger(View text, vtkTypeInt64& value)
{
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  return end.ec == std::errc() && end.ptr == text.data() + text.size();
}

/// The cells of a line: between separators, of which blanks count as one, unless they are in quotes.
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
      Fail(this->File, "line " + std::to_string(this->Number) + " is no text");
    }
    if (!this->Line.empty() && this->Line.back() == '\r')
    {
      this->Line.pop_back();
    }
    return true;
  }

  void Need(const char* what)
  {
    if (!this->Next())
    {
      Fail(this->File, std::string("it ends before ") + what);
    }
  }

  View Get() const { return this->Line; }
  std::string Where() const { return "line " + std::to_string(this->Number); }

  const std::string File;

private:
  std::ifstream Stream;
  std::string Line;
  std::size_t Number = 0;
};

/// Columns of numbers, and of words.
struct Table
{
  std::vector<std::string> Names;
  std::vector<std::vector<double>> Numbers;
  std::vector<std::vector<std::string>> Words; ///< of a column that is not of numbers; else empty
  std::vector<std::vector<vtkTypeInt64>>
    Whole; ///< of a column that may have identifiers; else empty
  vtkIdType Rows = 0;

  void SetNames(const std::vector<std::string>& names)
  {
    this->Names = names;
    this->Numbers.resize(names.size());
    this->Words.resize(names.size());
    this->Whole.resize(names.size());
  }

  void AddRow(const Lines& lines, const std::vector<View>& cells)
  {
    if (cells.size() != this->Names.size())
    {
      Fail(lines.File,
        lines.Where() + " has " + std::to_string(cells.size()) + " values for " +
          std::to_string(this->Names.size()) + " columns");
    }
    for (std::size_t c = 0; c < cells.size(); ++c)
    {
      this->AddCell(c, cells[c]);
    }
    ++this->Rows;
  }

private:
  void AddCell(std::size_t c, View cell)
  {
    const double none = std::numeric_limits<double>::quiet_NaN();
    double number = none;
    const auto rows = static_cast<std::size_t>(this->Rows);
    const bool isNumber = cell.empty() || ToNumber(cell, number);
    vtkTypeInt64 whole = 0;
    if (this->Whole[c].size() == rows && ToInteger(cell, whole))
    {
      this->Whole[c].push_back(whole);
    }
    else
    {
      this->Whole[c].clear();
    }
    if (!this->Words[c].empty() || (!isNumber && rows == 0))
    {
      this->Words[c].emplace_back(cell);
    }
    // One word among numbers is no number; a column of words has words from its beginning on.
    this->Numbers[c].push_back(isNumber ? number : none);
  }
};

/// Whether a column of whole numbers tells particles, or kinds of them, apart.
bool IsIdentifier(const std::string& name)
{
  std::string letters;
  for (const char c : Small(name))
  {
    letters += std::isalpha(static_cast<unsigned char>(c)) ? std::string(1, c) : "";
  }
  const auto ends = [&letters](const std::string& end)
  {
    return letters.size() >= end.size() &&
      letters.compare(letters.size() - end.size(), end.size(), end) == 0;
  };
  return ends("id") || ends("ids") || ends("idp") || ends("type") || ends("types") ||
    ends("index") || ends("mk") || ends("tag") || ends("mol") || ends("iorig");
}

/// A name without what makes it a component, and which one it is; below 0: it is none.
int ComponentOf(const std::string& name, std::string& base)
{
  const std::size_t n = name.size();
  const auto number = [](char c) { return c >= '0' && c <= '8' ? c - '0' : -1; };
  const auto letter = [](char c) {
    return c == 'x' || c == 'X' ? 0 : c == 'y' || c == 'Y' ? 1 : c == 'z' || c == 'Z' ? 2 : -1;
  };
  if (n > 3 && (name[n - 3] == '[' || name[n - 3] == '(') && number(name[n - 2]) >= 0)
  {
    base = name.substr(0, n - 3);
    return number(name[n - 2]);
  }
  if (n > 2 && (name[n - 2] == ':' || name[n - 2] == '_' || name[n - 2] == '.'))
  {
    base = name.substr(0, n - 2);
    return std::max(number(name[n - 1]), letter(name[n - 1]));
  }
  if (n > 3 && std::islower(static_cast<unsigned char>(name[n - 2])) && name[n - 1] >= 'X' &&
    name[n - 1] <= 'Z') // VelX
  {
    base = name.substr(0, n - 1);
    return letter(name[n - 1]);
  }
  return -1;
}

/// Columns that are the components of a vector, by its name.
std::map<std::string, std::vector<std::size_t>> FindVectors(const std::vector<std::string>& names)
{
  std::map<std::string, std::map<int, std::size_t>> parts;
  for (std::size_t c = 0; c < names.size(); ++c)
  {
    std::string base;
    const int component = ComponentOf(names[c], base);
    if (component >= 0 && !base.empty())
    {
      parts[base].emplace(component, c);
    }
  }
  std::map<std::string, std::vector<std::size_t>> vectors;
  for (const auto& [base, columns] : parts)
  {
    const auto count = static_cast<int>(columns.size());
    const bool isFree = std::find(names.begin(), names.end(), base) == names.end();
    if ((count == 2 || count == 3 || count == 6 || count == 9) && isFree &&
      columns.rbegin()->first == count - 1)
    {
      for (const auto& column : columns)
      {
        vectors[base].push_back(column.second);
      }
    }
  }
  return vectors;
}

/// The columns of positions, two or three; none where no name tells.
std::vector<std::size_t> FindPositions(const std::vector<std::string>& names,
  const std::map<std::string, std::vector<std::size_t>>& vectors)
{
  for (const char* usual : { "points", "point", "position", "positions", "pos", "coordinates",
         "coordinate", "coords", "coord", "xyz", "r" })
  {
    for (const auto& [name, columns] : vectors)
    {
      if (Small(name) == usual && columns.size() <= 3)
      {
        return columns;
      }
    }
  }
  std::vector<std::size_t> found;
  for (const char* axis : { "x", "y", "z" })
  {
    const auto at = std::find_if(
      names.begin(), names.end(), [axis](const std::string& name) { return Small(name) == axis; });
    if (at != names.end())
    {
      found.push_back(static_cast<std::size_t>(at - names.begin()));
    }
  }
  return found.size() >= 2 ? found : std::vector<std::size_t>();
}

vtkSmartPointer<vtkDataArray> JoinColumns(
  const Table& table, const std::vector<std::size_t>& columns)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetNumberOfComponents(static_cast<int>(columns.size()));
  array->SetNumberOfTuples(table.Rows);
  for (std::size_t k = 0; k < columns.size(); ++k)
  {
    for (vtkIdType row = 0; row < table.Rows; ++row)
    {
      array->SetTypedComponent(
        row, static_cast<int>(k), table.Numbers[columns[k]][static_cast<std::size_t>(row)]);
    }
  }
  return array;
}

vtkSmartPointer<vtkAbstractArray> ColumnOf(const Table& table, std::size_t c)
{
  const auto rows = static_cast<std::size_t>(table.Rows);
  if (table.Words[c].size() == rows && rows > 0)
  {
    auto words = vtkSmartPointer<vtkStringArray>::New();
    for (const std::string& word : table.Words[c])
    {
      words->InsertNextValue(word);
    }
    return words;
  }
  if (table.Whole[c].size() == rows && IsIdentifier(table.Names[c]))
  {
    auto whole = vtkSmartPointer<vtkTypeInt64Array>::New();
    whole->SetNumberOfTuples(table.Rows);
    std::copy(table.Whole[c].begin(), table.Whole[c].end(), whole->GetPointer(0));
    return whole;
  }
  return JoinColumns(table, { c });
}

/// `positions`: the columns of positions where no names tell.
vtkSmartPointer<vtkPolyData> ParticlesOf(
  const std::string& file, const Table& table, std::vector<std::size_t> positions = {})
{
  const auto vectors = FindVectors(table.Names);
  if (positions.empty())
  {
    positions = FindPositions(table.Names, vectors);
  }
  if (positions.empty())
  {
    std::string list;
    for (std::size_t c = 0; c < table.Names.size() && list.size() < 200; ++c)
    {
      list += (c ? ", " : "") + table.Names[c];
    }
    Fail(file,
      "it has no columns of positions, which are called x, y and z, or Points:0, Points:1 and "
      "Points:2; there are " +
        list);
  }
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(table.Rows);
  for (vtkIdType row = 0; row < table.Rows; ++row)
  {
    double x[3] = { 0.0, 0.0, 0.0 };
    for (std::size_t a = 0; a < positions.size(); ++a)
    {
      x[a] = table.Numbers[positions[a]][static_cast<std::size_t>(row)];
    }
    points->SetPoint(row, x);
  }
  particles->SetPoints(points);
  std::vector<bool> isDone(table.Names.size());
  for (const std::size_t c : positions)
  {
    isDone[c] = true;
  }
  const auto add = [&particles](
                     const vtkSmartPointer<vtkAbstractArray>& array, const std::string& name)
  {
    array->SetName(name.c_str());
    particles->GetPointData()->AddArray(array);
  };
  for (std::size_t c = 0; c < table.Names.size(); ++c)
  {
    const auto vector = std::find_if(vectors.begin(), vectors.end(),
      [c](const auto& each)
      { return std::find(each.second.begin(), each.second.end(), c) != each.second.end(); });
    if (isDone[c])
    {
      continue;
    }
    if (vector == vectors.end())
    {
      add(ColumnOf(table, c), table.Names[c]);
      continue;
    }
    add(JoinColumns(table, vector->second), vector->first);
    for (const std::size_t column : vector->second)
    {
      isDone[column] = true;
    }
  }
  return particles;
}

/// Returns names of columns, without units in brackets; no two are the same.
std::vector<std::string> NamesOf(const std::vector<View>& cells)
{
  std::vector<std::string> names;
  for (const View cell : cells)
  {
    const std::size_t unit = cell.find(" [");
    std::string name(Trimmed(unit == View::npos ? cell : cell.substr(0, unit)));
    name = name.empty() ? "Column" + std::to_string(names.size() + 1) : name;
    while (std::find(names.begin(), names.end(), name) != names.end())
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

/// Rows of values, after one of names, which may stand in a comment.
vtkSmartPointer<vtkDataObject> ReadRows(const std::string& file, char separator)
{
  constexpr std::size_t mostColumns = 10000;
  Lines lines(file);
  Table table;
  std::vector<View> cells;
  std::string comment;
  while (lines.Next())
  {
    View line = Trimmed(lines.Get());
    if (line.empty() || line[0] == '#' || line[0] == '%' || line[0] == '!')
    {
      comment = line.empty() ? comment
                             : std::string(line.substr(line.find_first_not_of("#%! ") == View::npos
                                   ? line.size()
                                   : line.find_first_not_of("#%! ")));
      continue;
    }
    line = separator == ' ' ? line.substr(0, line.find('#')) : lines.Get();
    if (table.Names.empty() && separator == 0)
    {
      separator = line.find(';') != View::npos ? ';'
        : line.find('\t') != View::npos        ? '\t'
        : line.find(',') != View::npos         ? ','
                                               : ' ';
    }
    Split(line, separator, cells);
    if (table.Names.empty())
    {
      if (cells.size() > mostColumns)
      {
        Fail(file, lines.Where() + " has " + std::to_string(cells.size()) + " columns");
      }
      if (!AreNumbers(cells))
      {
        table.SetNames(NamesOf(cells));
        continue;
      }
      std::vector<View> words;
      Split(comment, comment.find(',') != std::string::npos ? ',' : ' ', words);
      const bool areNames = words.size() == cells.size() && !AreNumbers(words);
      table.SetNames(areNames ? NamesOf(words) : NumberedNames(cells.size()));
    }
    table.AddRow(lines, cells);
  }
  if (table.Names.empty())
  {
    Fail(file, "it has no row of values");
  }
  const bool isTold = !FindPositions(table.Names, FindVectors(table.Names)).empty();
  std::vector<std::size_t> first;
  for (std::size_t c = 0; !isTold && separator == ' ' && c < 3 && c < table.Names.size(); ++c)
  {
    first.push_back(c);
  }
  return ParticlesOf(file, table, first);
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

/// Adds the period as six bounds, which are 0 for axes without a period.
void AddPeriod(vtkPolyData* particles, const std::array<double, 6>& bounds, const bool periodic[3])
{
  std::vector<double> period(6);
  for (std::size_t a = 0; a < 3; ++a)
  {
    const bool isGood = periodic[a] && bounds[2 * a] < bounds[2 * a + 1];
    period[2 * a] = isGood ? bounds[2 * a] : 0.0;
    period[2 * a + 1] = isGood ? bounds[2 * a + 1] : 0.0;
  }
  if (std::any_of(period.begin(), period.end(), [](double side) { return side != 0.0; }))
  {
    AddNumbers(particles, "PeriodicBounds", period);
  }
}

/// A count that a line says, or one below 0 that it does not.
vtkTypeInt64 CountOf(View line)
{
  vtkTypeInt64 count = -1;
  return ToInteger(Trimmed(line), count) ? count : -1;
}

/// The text behind KEY= in the second line of extended XYZ, with or without quotes.
std::string ValueOf(const std::string& comment, const std::string& key)
{
  const std::string small = Small(comment);
  std::size_t at = 0;
  while ((at = small.find(key + "=", at)) != std::string::npos && at > 0 && small[at - 1] != ' ')
  {
    ++at;
  }
  if (at == std::string::npos)
  {
    return "";
  }
  at += key.size() + 1;
  const bool quoted = at < comment.size() && comment[at] == '"';
  const std::size_t end = comment.find(quoted ? '"' : ' ', at + 1);
  return comment.substr(at + quoted, end == std::string::npos ? end : end - at - quoted);
}

std::vector<double> NumbersOf(const std::string& text)
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
  std::size_t begin = 0;
  std::vector<std::string> parts;
  while (begin <= text.size())
  {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  for (std::size_t p = 0; p + 2 < parts.size(); p += 3)
  {
    const vtkTypeInt64 width = CountOf(parts[p + 2]);
    if (width < 1 || width > 100)
    {
      Fail(file, "its Properties give " + parts[p] + " " + parts[p + 2] + " columns");
    }
    for (vtkTypeInt64 c = 0; c < width; ++c)
    {
      names.push_back(width == 1 ? parts[p] : parts[p] + ":" + std::to_string(c));
    }
  }
  return names;
}

/// Reads one step of an .xyz file, from the line after its count on.
vtkSmartPointer<vtkPolyData> ReadXyzStep(Lines& lines, vtkTypeInt64 count)
{
  lines.Need("the second line of a step");
  const std::string comment(lines.Get());
  Table table;
  std::vector<View> cells;
  const std::string properties = ValueOf(comment, "properties");
  if (!properties.empty())
  {
    table.SetNames(PropertiesOf(lines.File, properties));
  }
  for (vtkTypeInt64 i = 0; i < count; ++i)
  {
    lines.Need("all particles of a step");
    Split(lines.Get(), ' ', cells);
    if (table.Names.empty())
    {
      std::vector<std::string> names = NumberedNames(cells.size());
      if (cells.size() > 3)
      {
        names = NumberedNames(cells.size() - 1);
        names.insert(names.begin(), "species");
      }
      table.SetNames(names);
    }
    table.AddRow(lines, cells);
  }
  if (count == 0)
  {
    table.SetNames({ "x", "y", "z" });
  }
  const vtkSmartPointer<vtkPolyData> particles = ParticlesOf(lines.File, table);
  const std::vector<double> lattice = NumbersOf(ValueOf(comment, "lattice"));
  const std::string periodic = ValueOf(comment, "pbc");
  const bool isBox = lattice.size() == 9 && lattice[1] == 0.0 && lattice[2] == 0.0 &&
    lattice[3] == 0.0 && lattice[5] == 0.0 && lattice[6] == 0.0 && lattice[7] == 0.0;
  if (isBox)
  {
    std::vector<View> words;
    Split(periodic, ' ', words);
    bool isPeriodic[3] = { true, true, true };
    for (std::size_t a = 0; a < 3 && words.size() == 3; ++a)
    {
      isPeriodic[a] = words[a] != "F" && words[a] != "0" && words[a] != "False";
    }
    const std::vector<double> o = NumbersOf(ValueOf(comment, "origin"));
    const double low[3] = { o.size() == 3 ? o[0] : 0.0, o.size() == 3 ? o[1] : 0.0,
      o.size() == 3 ? o[2] : 0.0 };
    AddPeriod(particles,
      { low[0], low[0] + lattice[0], low[1], low[1] + lattice[4], low[2], low[2] + lattice[8] },
      isPeriodic);
  }
  const std::vector<double> time = NumbersOf(ValueOf(comment, "time"));
  if (time.size() == 1)
  {
    AddNumbers(particles, "TimeValue", time);
  }
  return particles;
}

/// Goes to the next step of an .xyz file. Returns its number of particles, below 0 if there is
/// none; its second line is still to be read.
vtkTypeInt64 FindXyzStep(Lines& lines)
{
  while (lines.Next())
  {
    if (!Trimmed(lines.Get()).empty())
    {
      const vtkTypeInt64 count = CountOf(lines.Get());
      if (count < 0)
      {
        Fail(lines.File, lines.Where() + " does not say how many particles a step has");
      }
      return count;
    }
  }
  return -1;
}

/// Numbers that a dump gives of a step before its particles.
struct DumpHead
{
  double Time = 0.0;
  vtkTypeInt64 Count = 0;
  std::array<double, 6> Bounds = {};
  bool Periodic[3] = { false, false, false };
  std::vector<std::string> Names;
};

bool StartsWith(View text, View start)
{
  return text.substr(0, start.size()) == start;
}

/// Goes to the next step of a dump; its particles are still to be read. Returns false if there is
/// none.
bool FindDumpStep(Lines& lines, DumpHead& head)
{
  head = {};
  bool isTold = false; // of a time in its own unit
  while (lines.Next())
  {
    const View line = Trimmed(lines.Get());
    if (StartsWith(line, "ITEM: TIMESTEP") || StartsWith(line, "ITEM: TIME"))
    {
      const bool isStep = StartsWith(line, "ITEM: TIMESTEP");
      lines.Need("the number of a step");
      double time = 0.0;
      if (!ToNumber(Trimmed(lines.Get()), time))
      {
        Fail(lines.File, lines.Where() + " is no time");
      }
      head.Time = isStep && isTold ? head.Time : time;
      isTold = isTold || !isStep;
    }
    else if (StartsWith(line, "ITEM: NUMBER OF ATOMS"))
    {
      lines.Need("the number of particles");
      head.Count = CountOf(lines.Get());
      if (head.Count < 0)
      {
        Fail(lines.File, lines.Where() + " is no number of particles");
      }
    }
    else if (StartsWith(line, "ITEM: BOX BOUNDS"))
    {
      std::vector<View> words;
      const std::string copy(line);
      Split(copy, ' ', words);
      for (std::size_t a = 0; a < 3; ++a)
      {
        head.Periodic[a] = words.size() >= 6 && words[words.size() - 3 + a] == "pp";
        lines.Need("the bounds of the box");
        const std::vector<double> bounds = NumbersOf(std::string(lines.Get()));
        head.Bounds[2 * a] = bounds.empty() ? 0.0 : bounds[0];
        head.Bounds[2 * a + 1] = bounds.size() < 2 ? 0.0 : bounds[1];
      }
    }
    else if (StartsWith(line, "ITEM: ATOMS"))
    {
      std::vector<View> words;
      Split(line, ' ', words);
      words.erase(words.begin(), words.begin() + 2);
      head.Names = NamesOf(words);
      return true;
    }
    else if (StartsWith(line, "ITEM:"))
    {
      lines.Need("what an item holds"); // UNITS
    }
    else if (!line.empty())
    {
      Fail(lines.File, lines.Where() + " is none of a dump of LAMMPS");
    }
  }
  return false;
}

vtkSmartPointer<vtkPolyData> ReadDumpStep(Lines& lines, DumpHead& head)
{
  Table table;
  std::vector<View> cells;
  table.SetNames(head.Names);
  for (vtkTypeInt64 i = 0; i < head.Count; ++i)
  {
    lines.Need("all particles of a step");
    Split(lines.Get(), ' ', cells);
    table.AddRow(lines, cells);
  }
  std::vector<std::size_t> positions;
  for (const char* kind : { "", "u", "s", "su" }) // as they are, unwrapped, in units of the box
  {
    positions.clear();
    for (const char axis : { 'x', 'y', 'z' })
    {
      const auto at = std::find(head.Names.begin(), head.Names.end(), std::string(1, axis) + kind);
      if (at != head.Names.end())
      {
        positions.push_back(static_cast<std::size_t>(at - head.Names.begin()));
      }
    }
    if (positions.size() < 2)
    {
      continue;
    }
    for (std::size_t a = 0; *kind == 's' && a < positions.size(); ++a)
    {
      for (double& x : table.Numbers[positions[a]])
      {
        x = head.Bounds[2 * a] + x * (head.Bounds[2 * a + 1] - head.Bounds[2 * a]);
      }
    }
    break;
  }
  if (positions.size() < 2)
  {
    positions.clear();
  }
  const vtkSmartPointer<vtkPolyData> particles = ParticlesOf(lines.File, table, positions);
  AddPeriod(particles, head.Bounds, head.Periodic);
  AddNumbers(particles, "TimeValue", { head.Time });
  return particles;
}

bool IsDump(const std::string& file)
{
  std::ifstream stream(file, std::ios::binary);
  char begin[5] = {};
  stream.read(begin, 5);
  return View(begin, 5) == "ITEM:";
}

/// Whether a file begins with a count of particles, and is no table of positions.
bool HasCount(const std::string& file)
{
  Lines lines(file);
  return lines.Next() && CountOf(lines.Get()) >= 0;
}

}

vtkSmartPointer<vtkDataObject> ReadCsv(const std::string& file)
{
  return ReadRows(file, 0);
}

vtkSmartPointer<vtkDataObject> ReadColumns(const std::string& file, std::size_t step)
{
  return IsDump(file) ? ReadLammps(file, step) : ReadRows(file, ' ');
}

vtkSmartPointer<vtkDataObject> ReadXyz(const std::string& file, std::size_t step)
{
  if (!HasCount(file))
  {
    return ReadRows(file, ' ');
  }
  Lines lines(file);
  vtkTypeInt64 count = FindXyzStep(lines);
  for (std::size_t k = 0; k < step && count >= 0; ++k)
  {
    for (vtkTypeInt64 i = -1; i < count; ++i)
    {
      lines.Need("all particles of a step");
    }
    count = FindXyzStep(lines);
  }
  if (count < 0)
  {
    Fail(file, "it has no step " + std::to_string(step));
  }
  return ReadXyzStep(lines, count);
}

vtkSmartPointer<vtkDataObject> ReadLammps(const std::string& file, std::size_t step)
{
  Lines lines(file);
  DumpHead head;
  for (std::size_t k = 0; k <= step; ++k)
  {
    for (vtkTypeInt64 i = 0; k > 0 && i < head.Count; ++i)
    {
      lines.Need("all particles of a step");
    }
    if (!FindDumpStep(lines, head))
    {
      Fail(file, "it has no step " + std::to_string(step));
    }
  }
  return ReadDumpStep(lines, head);
}

std::vector<double> ListTimesInText(const std::string& file)
{
  std::vector<double> times;
  Lines lines(file);
  if (IsDump(file))
  {
    DumpHead head;
    while (FindDumpStep(lines, head))
    {
      times.push_back(head.Time);
      for (vtkTypeInt64 i = 0; i < head.Count && lines.Next(); ++i)
      {
      }
    }
    return times;
  }
  vtkTypeInt64 count = HasCount(file) ? FindXyzStep(lines) : -1;
  for (; count >= 0; count = FindXyzStep(lines))
  {
    lines.Need("the second line of a step");
    const std::vector<double> time = NumbersOf(ValueOf(std::string(lines.Get()), "time"));
    times.push_back(time.size() == 1 ? time[0] : static_cast<double>(times.size()));
    for (vtkTypeInt64 i = 0; i < count && lines.Next(); ++i)
    {
    }
  }
  return times;
}
