// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Formats_h
#define Formats_h

#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

class vtkDataArray;
class vtkDataObject;

using View = std::string_view;

// These functions read files. All throw std::runtime_error with one sentence.

/// Returns the bytes of a file; an empty text if it cannot be opened or is no regular file. The bytes stay mapped while a copy
/// of the pointer exists.
using FileBytes = std::shared_ptr<const View>;
FileBytes BytesOf(const std::string& file);

/// Returns points without arrays at these places.
vtkSmartPointer<vtkPolyData> PointsAt(vtkDataArray* places);

/// Checks a file that is to be read, and makes it known to IsSource(). Fails unless it is a regular file that may be
/// read: a directory, a device or a pipe is refused.
void CheckRegularFile(const std::string& file);

/// Runs a library that reads a file. The user gets a sentence if the library crashes over the file, asks for too much
/// memory, or reports an error. VTK alone would go on after an error, with arrays of zeros.
void ReadWithCare(const std::string& file, const std::function<void()>& read);

/// The functions below read VTK's files. VTK's readers trust the counts in a file when they take
/// memory and loop. So a file is refused if a count is below 0, or greater than a file of this size
/// can hold.
///@{
vtkSmartPointer<vtkDataObject> ReadXml(const std::string& file, std::size_t);
vtkSmartPointer<vtkDataObject> ReadLegacy(const std::string& file, std::size_t);
/// Returns the time in the field data (TimeValue, TIME, Time or time) within the first 64 KiB of the file, or nothing.
/// Points and their arrays are not read.
std::vector<double> ListTimesOfVtk(const std::string& file);
/// Looks for the arrays `names`, in this order, in the field data within the first 64 KiB of the file. Returns the
/// number in the first array that holds exactly one finite number, or nothing.
std::vector<double> NumberInVtk(const std::string& file, const std::vector<std::string>& names);
///@}

/// An entry of a .pvd or .series file.
struct CollectionEntry
{
  double Time;
  std::string File; ///< from the working directory, not from the list's folder
  std::string Part; ///< the part's name in the list; empty: none
};

/// Reads the entries in the order of time; entries of the same time keep the order of the file. If a .pvd file lists a
/// file, or a part, twice at one time, the last entry counts, and `warnings` gets a sentence.
std::vector<CollectionEntry> ReadCollection(
  const std::string& file, std::vector<std::string>& warnings);

/// Returns the files that a .pvtp or .pvtu file lists as parts of one set of particles.
std::vector<std::string> ReadPieces(const std::string& file);

/// Reads particles from text, one in each line: .csv (with commas, semicolons or tabs), columns between blanks with
/// comments behind #, .xyz and extended XYZ, dumps of LAMMPS. Columns that share a name and end in :0, :1, :2, or _x,
/// _y, _z, ... are one vector. If a file tells no times, steps have the times 0, 1, ...; a table has none.
///@{
vtkSmartPointer<vtkDataObject> ReadText(const std::string& file, std::size_t step);
std::vector<double> ListTimesInText(const std::string& file);
///@}

/// The names of types in .ply files, and VTK's types. A type's usual name comes first.
using PlyType = std::pair<View, int>;
extern const std::vector<PlyType> PlyTypes;

/// Reads the vertices of a .ply file with all of their properties, which VTK's own reader leaves out.
vtkSmartPointer<vtkDataObject> ReadPly(const std::string& file, std::size_t);

/// The functions below read snapshots in GADGET's binary formats 1 and 2, with files of any name. They return, in this
/// order, whether a file begins like a snapshot, all files of its snapshot, its time, and the gas in this one file.
/// GADGET's smoothing length is the support radius; the array SmoothingLength is half of it.
///@{
bool IsGadget(const std::string& file);
std::vector<std::string> ListGadget(const std::string& file);
std::vector<double> ListTimesOfGadget(const std::string& file);
vtkSmartPointer<vtkDataObject> ReadGadget(const std::string& file, std::size_t);
///@}

// ---- Tables in text files: lines, their cells, columns, and the particles that the columns describe ----

View Trimmed(View text);
std::string Small(View text);

/// Reads a number of a table. It may have a leading plus, Fortran's D or a decimal comma, or be nan or
/// inf.
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
  std::vector<std::string> Words;  ///< texts of a column that begins with a word; else empty
  std::vector<vtkTypeInt64> Whole; ///< the numbers, if all are whole; else empty

  void Add(View cell);
};

using Table = std::vector<Column>;

void AddRow(Table& table, const Lines& lines, const std::vector<View>& cells, char separator);

/// Returns the columns that are called x, y and z, as far as they exist. behind: letters that the
/// names have behind x, y and z, such as "u" in xu.
std::vector<std::size_t> FindAxes(const Table& table, const std::string& behind);

/// Finds the three columns of positions by their names; none if no name fits. Fails if only one or two columns are
/// found, unless the table has no other columns.
std::vector<std::size_t> FindPositions(const std::string& file, const Table& table);

/// Makes particles from a table. positions: the columns of the positions.
vtkSmartPointer<vtkPolyData> ParticlesOf(
  const std::string& file, const Table& table, const std::vector<std::size_t>& positions);

/// Returns columns with these names, without units in brackets; no two names are the same.
Table ColumnsOf(const std::vector<View>& cells);

#endif
