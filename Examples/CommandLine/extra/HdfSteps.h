// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef HdfSteps_h
#define HdfSteps_h

// Points of .vtkhdf files that older VTK does not read: poly data, and one of several steps.

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkDataObject;

/// The times of its steps; none where it has none. What is wrong is said where it is read.
std::vector<double> ListHdfTimes(const std::string& file);

/// The points and their arrays, of one step. Null for an unstructured grid without steps, whose
/// cells VTK reads. Throws std::runtime_error.
vtkSmartPointer<vtkDataObject> ReadHdfPoints(const std::string& file, std::size_t step);

#endif
