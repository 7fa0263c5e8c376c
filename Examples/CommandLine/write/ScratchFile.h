// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ScratchFile_h
#define ScratchFile_h

#include <string>

/// A file without a place in any folder, which goes away with its last user: for what a library
/// writes to files alone, and for what a process leaves to the next one. In memory where the system
/// has such files.
class ScratchFile
{
public:
  /// Throws std::runtime_error with one sentence.
  ScratchFile();
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  void operator=(const ScratchFile&) = delete;

  /// A name under which this process can open it.
  std::string GetName() const;

  /// At its end. Throws std::runtime_error.
  void Append(const std::string& bytes);

  /// All of it. Throws std::runtime_error.
  std::string Read() const;

private:
  int Descriptor = -1;
};

#endif
