// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "Text.h"

#include "vtkDoubleArray.h"
#include "vtkPointData.h"
#include "vtkSPHFound.h"
#include "vtkStringArray.h"
#include "vtkTypeInt64Array.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>

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

bool ToNumber(View text, double& value)
{
  const auto parse = [&value](View digits)
  {
    const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (end.ec == std::errc::result_out_of_range)
    {
      value = std::strtod(std::string(digits).c_str(), nullptr); // infinity, or 0
    }
    return end.ec != std::errc::invalid_argument && end.ptr == digits.data() + digits.size();
  };
  text.remove_prefix(text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
  if (parse(text))
  {
    return true;
  }
  std::string other(text);
  for (char& c : other)
  {
    c = c == 'd' || c == 'D' ? 'e' : c == ',' ? '.' : c;
  }
  return parse(other);
}

bool ToInteger(View text, vtkTypeInt64& value)
{
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  return end.ec == std::errc() && end.ptr == text.data() + text.size();
}

std::vector<View> Split(View line, char separator)
{
  const bool isBlank = separator == ' ';
  std::vector<View> cells;
  cells.reserve(16); // one allocation for most lines
  std::size_t begin = 0;
  bool isQuoted = false;
  for (std::size_t i = 0; i <= line.size(); ++i)
  {
    const char c = i < line.size() ? line[i] : separator;
    isQuoted = i < line.size() && isQuoted != (c == '"');
    if (!isQuoted && (c == separator || (isBlank && (c == '\t' || c == '\r'))))
    {
      if (!isBlank || i > begin)
      {
        cells.push_back(Trimmed(line.substr(begin, i - begin)));
      }
      begin = i + 1;
    }
  }
  return cells;
}

Lines::Lines(const std::string& file)
  : File(file)
  , Bytes(BytesOf(file))
  , Rest(*Bytes)
{
  const View mark = "\xEF\xBB\xBF"; // UTF-8's byte order mark
  this->Rest.remove_prefix(this->Rest.substr(0, 3) == mark ? 3 : 0);
}

bool Lines::Next()
{
  if (this->Rest.empty())
  {
    return false;
  }
  const std::size_t end = std::min(this->Rest.find('\n'), this->Rest.size());
  this->Line = this->Rest.substr(0, end);
  this->Rest.remove_prefix(std::min(end + 1, this->Rest.size()));
  ++this->Number;
  if (this->Line.find('\0') != View::npos)
  {
    this->Check(false, " is no text; if it is UTF-16, save it as UTF-8");
  }
  this->Line.remove_suffix(!this->Line.empty() && this->Line.back() == '\r' ? 1 : 0);
  if (this->Line.find('\r') != View::npos)
  {
    FailToRead(this->File, "its lines end in carriage returns alone; save it with line feeds");
  }
  return true;
}

void Lines::Need(const char* what)
{
  if (!this->Next())
  {
    FailToRead(this->File, std::string("it ends before ") + what);
  }
}

void Lines::Check(bool isGood, const std::string& why) const
{
  RequireToRead(isGood, this->File, this->Where() + why);
}

void Column::Add(View cell)
{
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  double number = none;
  vtkTypeInt64 whole = 0;
  const std::size_t rows = this->Numbers.size();
  const bool isNumber = cell.empty() || ToNumber(cell, number);
  const bool isWhole = this->Whole.size() == rows && ToInteger(cell, whole);
  isWhole ? this->Whole.push_back(whole) : this->Whole.clear();
  if (!this->Words.empty() || (!isNumber && rows == 0))
  {
    this->Words.emplace_back(cell);
  }
  // A word among numbers becomes NaN. Only a column that begins with a word keeps its words.
  this->Numbers.push_back(isNumber ? number : none);
}

void AddRow(Table& table, const Lines& lines, const std::vector<View>& cells, char separator)
{
  if (cells.size() != table.size())
  {
    lines.Check(false,
      " has " + std::to_string(cells.size()) + " values for " + std::to_string(table.size()) +
        " columns");
  }
  for (std::size_t c = 0; c < cells.size(); ++c)
  {
    if (separator == ',' && cells[c].find(',') != View::npos && table[c].Words.empty() &&
      cells[c].find_first_not_of("0123456789+-.,eEdD ") == View::npos)
    {
      lines.Check(false,
        " has '" + std::string(cells[c]) +
          "' in a table with commas between columns: write it without a comma, or semicolons "
          "between columns, where a comma is that of decimals");
    }
    table[c].Add(cells[c]);
  }
}

namespace
{

/// Finds the component that a name ends in (v:0, v_x, v.x, v[0], v(0), VelX). Returns the component's
/// number; below 0: the name has none. base: becomes the name without the component.
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

std::string ListNames(const Table& table)
{
  std::string list;
  for (std::size_t c = 0; c < table.size() && list.size() < 200; ++c)
  {
    list += (c ? ", " : "") + table[c].Name;
  }
  return list;
}

using Indices = std::vector<std::size_t>;

/// Lists the arrays of a table without the columns `positions`, each with its name and columns, in the order of
/// their first columns. 2, 3, 6 or 9 columns whose names tell all components of a vector are one array; each
/// other column is an array.
std::map<std::size_t, std::pair<std::string, Indices>> FindArrays(
  const Table& table, const Indices& positions = {})
{
  std::map<std::size_t, std::pair<std::string, Indices>> arrays;
  std::map<std::string, std::map<int, std::size_t>> vectors; // columns by name and component
  for (std::size_t c = 0; c < table.size(); ++c)
  {
    std::string base;
    const int component = ComponentOf(table[c].Name, base);
    if (std::find(positions.begin(), positions.end(), c) == positions.end())
    {
      arrays[c] = { table[c].Name, { c } };
      if (component >= 0)
      {
        vectors[base].emplace(component, c);
      }
    }
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
      Indices columns;
      for (const auto& [component, column] : components)
      {
        columns.push_back(column);
        arrays.erase(column);
      }
      arrays[*std::min_element(columns.begin(), columns.end())] = { base, columns };
    }
  }
  return arrays;
}

vtkSmartPointer<vtkDoubleArray> JoinColumns(
  const Table& table, const Indices& columns, int components)
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
  const std::string& file, const Table& table, const Indices& columns)
{
  const Column& first = table[columns[0]];
  if (columns.size() == 1 && !first.Words.empty())
  {
    return ArrayWith<vtkStringArray>(first.Words);
  }
  const bool areLarge = std::any_of(first.Numbers.begin(), first.Numbers.end(),
    [](double number) { return std::abs(number) >= 9007199254740992.0; }); // from here on, doubles are 2 apart
  const bool isIdentifier = vtkSPHTellsApart(first.Name.c_str()); // it numbers particles or their kinds
  if (columns.size() == 1 && (isIdentifier || areLarge) && !first.Whole.empty())
  {
    return ArrayWith<vtkTypeInt64Array>(first.Whole);
  }
  RequireToRead(columns.size() > 1 || !isIdentifier || !areLarge, file,
    "its column " + first.Name +
      " has numbers from 2^53 on, where some of it are not whole or are 2^63 and more: different "
      "ones would become equal");
  return JoinColumns(table, columns, static_cast<int>(columns.size()));
}

}

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
  return found;
}

std::vector<std::size_t> FindPositions(const std::string& file, const Table& table)
{
  std::vector<std::size_t> found;
  int best = VTK_INT_MAX;
  for (const auto& [first, array] : FindArrays(table))
  {
    const auto& [name, columns] = array;
    const int rank = vtkSPHPositionPriority(name.c_str());
    if ((columns.size() == 2 || columns.size() == 3) && rank >= 0 && rank < best)
    {
      found = columns;
      best = rank;
    }
  }
  found = found.empty() ? FindAxes(table, "") : found;
  std::vector<std::string> names;
  for (const std::size_t column : found)
  {
    names.push_back(table[column].Name);
  }
  RequireToRead(found.empty() || found.size() == 3 || found.size() == table.size(), file,
    "of the three columns of positions only " + Joined(names, " and ") + " is found; there are " +
      ListNames(table) + ". For particles in a plane add the third one, of zeros");
  return found;
}

vtkSmartPointer<vtkPolyData> ParticlesOf(
  const std::string& file, const Table& table, const std::vector<std::size_t>& positions)
{
  RequireToRead(!positions.empty(), file,
    "it has no columns of positions, which are called x, y and z, or Points:0, Points:1 and "
    "Points:2; there are " +
      ListNames(table));
  for (const std::size_t column : positions)
  {
    const std::vector<std::string>& words = table[column].Words;
    RequireToRead(words.empty(), file,
      "its positions are no numbers: '" + (words.empty() ? "" : words.front()) + "'");
  }
  const vtkSmartPointer<vtkPolyData> particles = PointsAt(JoinColumns(table, positions, 3));
  for (const auto& [first, each] : FindArrays(table, positions))
  {
    const vtkSmartPointer<vtkAbstractArray> array = ArrayOf(file, table, each.second);
    array->SetName(each.first.c_str());
    particles->GetPointData()->AddArray(array);
  }
  return particles;
}

Table ColumnsOf(const std::vector<View>& cells)
{
  Table table;
  std::set<std::string> taken;
  for (const View cell : cells)
  {
    const std::size_t bracket = cell.find(" (");
    const View inside = bracket == View::npos ? View() : cell.substr(bracket + 2);
    const bool isUnit = // not a component, as in "v (x)"
      inside.size() != 2 || View("012345678xyzXYZ").find(inside[0]) == View::npos;
    std::string name(
      Trimmed(cell.substr(0, std::min(cell.find(" ["), isUnit ? bracket : View::npos))));
    name = name.empty() ? "Column" + std::to_string(table.size() + 1) : name;
    while (!taken.insert(name).second)
    {
      name += "_";
    }
    table.emplace_back(name);
  }
  return table;
}
