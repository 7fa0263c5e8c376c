// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/// Tables in text files: lines, their cells, columns, and the particles that the columns describe.
#ifndef TextTable_h
#define TextTable_h

#include "Formats.h"

#include "vtkPolyData.h"
#include "vtkType.h"

#include <cstddef>
#include <string>
#include <vector>

View Trimmed(View text);
std::string Small(View text);

/// Reads a number as tables have it: also with a leading plus, Fortran's D, or a decimal comma, and
/// nan and inf.
bool ToNumber(View text, double& value);
bool ToInteger(View text, vtkTypeInt64& value);

/// Splits a line at the separators that are not in quotes; several blanks are one separator.
std::vector<View> Split(View line, char separator);

/// The lines of a file, one at a time. A copy stays at the line where it was made.
class Lines
{
public:
  explicit Lines(const std::string& file);

  /// Goes to the next line. Returns false at the end.
  bool Next();

  /// Goes to the next line. Fails at the end; `what` tells the user what the line should hold.
  void Need(const char* what);

  View Get() const { return this->Line; }
  View GetRest() const { return this->Rest; } ///< all bytes behind this line
  std::string Where() const { return "line " + std::to_string(this->Number); }

  /// Throws std::runtime_error with a sentence about this line unless `isGood`.
  void Check(bool isGood, const std::string& why) const;

  std::string File;

private:
  FileBytes Bytes;
  View Rest, Line;
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

void AddRow(Table& table, const Lines& lines, const std::vector<View>& cells, char separator);

/// Returns the columns x, y and z, with these letters behind the names, as far as they exist.
std::vector<std::size_t> FindAxes(const Table& table, const std::string& behind);

/// Finds the columns of positions by their names; none if no name tells. Fails if only some of x, y
/// and z exist, unless two of them are the whole table.
std::vector<std::size_t> FindPositions(const std::string& file, const Table& table);

/// Makes particles of a table, whose positions are in these columns.
vtkSmartPointer<vtkPolyData> ParticlesOf(
  const std::string& file, const Table& table, const std::vector<std::size_t>& positions);

/// Returns columns with these names, without units in brackets; no two names are the same.
Table ColumnsOf(const std::vector<View>& cells);

#endif
