// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef TableText_h
#define TableText_h

#include <string>

class vtkTable;

/// The names of the columns, one line: as CSV (RFC 4180, but for line ends).
std::string TableHeader(vtkTable* table);

/// A line for each row. Numbers read back as the same; NaN is an empty place.
std::string TableRows(vtkTable* table);

#endif
