// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Formats_h
#define Formats_h

#include "vtkSmartPointer.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

class MessageCapture;
class vtkDataObject;

/// Particles from text, one in each line: .csv (with commas, semicolons or tabs), columns between
/// blanks with comments behind #, .xyz and extended XYZ, dumps of LAMMPS. Numbers in columns of one
/// name and :0, :1, :2, or _x, _y, _z, ... are vectors. Throws std::runtime_error with one
/// sentence.

/// The first step of a file that may hold several, or that of this number.
vtkSmartPointer<vtkDataObject> ReadCsv(const std::string& file);
vtkSmartPointer<vtkDataObject> ReadColumns(const std::string& file, std::size_t step = 0);
vtkSmartPointer<vtkDataObject> ReadXyz(const std::string& file, std::size_t step = 0);
vtkSmartPointer<vtkDataObject> ReadLammps(const std::string& file, std::size_t step = 0);

/// The times of the steps in an .xyz file or a dump; numbers from 0 on where it tells of none.
std::vector<double> ListTimesInText(const std::string& file);

// Snapshots of GADGET's binary formats 1 and 2, of any name.

/// Whether a file begins as one does.
bool IsGadget(const std::string& file);

/// The files of its snapshot. Throws std::runtime_error.
std::vector<std::string> ListGadget(const std::string& file);

/// The gas in a file. SmoothingLength is half of GADGET's, which is the support radius. Throws
/// std::runtime_error.
vtkSmartPointer<vtkDataObject> ReadGadget(const std::string& file);

double TimeOfGadget(const std::string& file);

/// Whether the field data at the beginning of a VTK file tell of its time (TimeValue, TIME, time).
/// Points and their arrays are not read.
bool ReadTime(const std::string& file, MessageCapture* messages, double& time);

/// VTK's readers ask for memory, and go round in loops, by the counts that a file declares. Throws
/// std::runtime_error with one sentence where one is below 0, or greater than a file of its size
/// can hold: so it is damaged. Knows VTK's XML and legacy files.
void CheckDeclaredSizes(const std::string& file);
/// Checks a part of the file.
void CheckDeclaredSizes(const std::string& file, std::string_view text);

#endif
