// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef OutputFile_h
#define OutputFile_h

#include <chrono>
#include <functional>
#include <string>
#include <vector>

/// Says before the work what would prevent writing after it, where OpenSources() was told of all that
/// is read. Throws UsageError if an output is the same file as an input or another output, by whatever
/// name or link; std::runtime_error if one cannot be written. An empty name is an output that nobody
/// asked for.
void CheckOutputs(const std::vector<std::string>& outputs);

/// Outputs that belong together. Each is written under a fresh name beside its target; Commit()
/// lets them take their places. Without it, and where the program is ended, all is as it was. A
/// symbolic link is followed, and the file that it leads to replaced; mode, owner and group stay as
/// they were. Other hard links of a replaced file keep what was in it. What is no regular file (a
/// device, a FIFO, /dev/stdout) is written to by Commit(). All throw std::runtime_error with one
/// sentence.
class OutputFiles
{
public:
  OutputFiles();
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  void operator=(const OutputFiles&) = delete;

  void Write(const std::string& file, const std::string& bytes);
  void Commit();

private:
  struct Output;
  std::vector<Output> Files;
};

/// Writes one file by itself.
void WriteOutput(const std::string& file, const std::string& bytes);

/// A file of all steps so far, which can be read while the run goes on, and after the program is ended. For a long
/// series it is not written after each step, but only as often as takes a twentieth of the time. A device or a pipe
/// gets it once, at the end.
class GrowingFile
{
public:
  explicit GrowingFile(const std::string& name)
    : Name(name)
  {
  }

  /// There may be more in it: `text` gives the whole. Does nothing without a name. Throws
  /// std::runtime_error with one sentence.
  void Write(const std::function<std::string()>& text, bool isLast);

private:
  using Clock = std::chrono::steady_clock;
  const std::string Name;
  Clock::time_point Next;
};

#endif
