// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ArrayList_h
#define ArrayList_h

#include <string>

class vtkPointSet;

/// The text of --list-arrays: a line for each array of the particles, and for what a run would
/// find.
std::string DescribeArrays(vtkPointSet& particles);

#endif
