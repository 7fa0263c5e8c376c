// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef GadgetFile_h
#define GadgetFile_h

// Snapshots of GADGET's binary formats 1 and 2, of any name.

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkDataObject;

/// Whether a file begins as one does.
bool IsGadget(const std::string& file);

/// The files of its snapshot. Throws std::runtime_error.
std::vector<std::string> ListGadget(const std::string& file);

/// The gas in a file. SmoothingLength is half of GADGET's, which is the support radius. Throws
/// std::runtime_error.
vtkSmartPointer<vtkDataObject> ReadGadget(const std::string& file);

double TimeOfGadget(const std::string& file);

#endif
