// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef OutputFile_h
#define OutputFile_h

#include <string>
#include <vector>

/// Says before the work what would prevent writing after it. Throws std::invalid_argument if an
/// output is the same file as an input or another output, by whatever name or link;
/// std::runtime_error if one cannot be written.
void CheckOutputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

/// Writes a file, completely or not at all: under a fresh name beside it first, which then takes its
/// place. A symbolic link is followed, and the file that it leads to replaced; mode, owner and group
/// stay as they were. Other hard links of a replaced file keep what was in it. What is no regular
/// file (a device, a FIFO, /dev/stdout) is written to straight. Throws std::runtime_error with one
/// sentence.
void WriteOutput(const std::string& file, const std::string& bytes);

#endif
