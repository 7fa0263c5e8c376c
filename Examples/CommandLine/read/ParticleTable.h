// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ParticleTable_h
#define ParticleTable_h

#include "vtkSmartPointer.h"

#include <cstddef>
#include <string>
#include <vector>

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

#endif
