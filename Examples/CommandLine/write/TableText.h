// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef TableText_h
#define TableText_h

#include "vtkType.h"

#include <string>

class vtkAbstractArray;
class vtkTable;

/// A text between two commas of CSV (RFC 4180). No spreadsheet takes it for a formula.
std::string TableField(const std::string& text);

/// Reads back as the same number; NaN is an empty place.
std::string TableField(vtkAbstractArray* array, vtkIdType tuple, int component = 0);

/// The names of the columns, one line.
std::string TableHeader(vtkTable* table);

/// A line for each row.
std::string TableRows(vtkTable* table);

#endif
