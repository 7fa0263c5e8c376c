// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef HdfFile_h
#define HdfFile_h

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkDataObject;

/// The times of a .vtkhdf file's steps; none where it has none. What is wrong is said where it is
/// read.
std::vector<double> ListHdfTimes(const std::string& file);

/// The points and their arrays, of one step; of an unstructured grid without steps all, by VTK's
/// reader, whose older versions know nothing else. Throws std::runtime_error, where values lie in
/// other files, too.
vtkSmartPointer<vtkDataObject> ReadHdf(const std::string& file, std::size_t step);

#endif
