// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeclaredSizes_h
#define DeclaredSizes_h

#include <string>
#include <string_view>

/// VTK's readers ask for memory, and go round in loops, by the counts that a file declares. Throws
/// std::runtime_error with one sentence where one is below 0, or greater than a file of its size
/// can hold: so it is damaged. Knows VTK's XML and legacy files.
void CheckDeclaredSizes(const std::string& file);
/// Checks a part of the file.
void CheckDeclaredSizes(const std::string& file, std::string_view text);

#endif
