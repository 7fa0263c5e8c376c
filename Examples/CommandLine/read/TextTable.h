// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/// Tables in text files: lines, their cells, columns, and the particles that the columns describe.
#ifndef TextTable_h
#define TextTable_h

#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstddef>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

using View = std::string_view;

View Trimmed(View text);
std::string Small(View text);

/// Reads a number as tables have it: also with a leading plus, Fortran's D, or a decimal comma, and
/// nan and inf.
bool ToNumber(View text, double& value);
bool ToInteger(View text, vtkTypeInt64& value);

/// Splits a line at the separators that are not in quotes; several blanks are one separator.
void Split(View line, char separator, std::vector<View>& cells);

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
  bool Next();

  /// Reads the next line. Fails at the end; `what` tells the user what the line should hold.
  void Need(const char* what);

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
  std::vector<std::string> Words;  ///< texts of a column that has no numbers; else empty
  std::vector<vtkTypeInt64> Whole; ///< texts of a column that may have identifiers; else empty

  void Add(View cell);
};

using Table = std::vector<Column>;

Table TableOf(const std::vector<std::string>& names);
void AddRow(Table& table, const Lines& lines, const std::vector<View>& cells, char separator);

/// Returns the columns x, y and z, with these letters behind the names, as far as they exist.
std::vector<std::size_t> FindAxes(const Table& table, const std::string& behind);

/// Finds the columns of positions by their names; none if no name tells. Fails if only some of x, y
/// and z exist, unless two of them are the whole table.
std::vector<std::size_t> FindPositions(const std::string& file, const Table& table);

/// Makes particles of a table. positions: their columns; if empty, names tell them.
vtkSmartPointer<vtkPolyData> ParticlesOf(
  const std::string& file, const Table& table, std::vector<std::size_t> positions);

/// Returns names of columns, without units in brackets; no two are the same.
std::vector<std::string> NamesOf(const std::vector<View>& cells);

#endif
