// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Formats_h
#define Formats_h

#include "vtkSmartPointer.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

class vtkDataArray;
class vtkDataObject;
class vtkPolyData;

using View = std::string_view;

// These functions read files. All throw std::runtime_error with one sentence.

/// Returns the bytes of a file; none if the file cannot be opened. The bytes stay in memory while a copy of the pointer
/// exists.
using FileBytes = std::shared_ptr<const View>;
FileBytes BytesOf(const std::string& file);

/// Returns points without arrays at these places.
vtkSmartPointer<vtkPolyData> PointsAt(vtkDataArray* places);

/// Opens a file that is to be read, so that IsSource() knows it. Refuses a name that is not a file, a file that cannot
/// be opened, and one that can only be read from its begin to its end, such as a pipe.
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
/// Returns the time in the field data at the file's beginning (TimeValue, TIME, time), or nothing. Points and their
/// arrays are not read.
std::vector<double> ListTimesOfVtk(const std::string& file);
/// Returns, in the same way, the number in the first of the arrays `names` that the file has.
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
/// file, or a part, twice at one time, the last entry counts. `warnings` gets sentences.
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

#endif
