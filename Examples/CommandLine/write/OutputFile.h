// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef OutputFile_h
#define OutputFile_h

#include <chrono>
#include <string>
#include <vector>

struct OutputTarget;

/// Checks that the outputs can be written. Call it before the work, after OpenSources() for all inputs.
/// Throws UsageError if an output is the same file as an input or as another output, under any name or
/// link, or if standard output or standard error goes to the output; std::runtime_error if an output
/// cannot be written. An empty name means no output.
void CheckOutputs(const std::vector<std::string>& outputs);

/// Outputs that belong together. Each is written under a fresh name beside its target; Commit()
/// lets them replace their targets. Without Commit(), also if the program is ended, targets stay as
/// they were. If a target is a symbolic link, the file that it leads to is replaced. Mode, owner and
/// group stay, as far as the system allows. Other hard links of a replaced file keep the old
/// contents. Commit() writes into a target that is not a regular file (a device, a FIFO,
/// /dev/stdout). All functions throw std::runtime_error with one sentence.
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
  std::vector<OutputTarget> Files;
};

/// Writes a single file in the way of OutputFiles: under a fresh name, which then replaces `file`.
void WriteOutput(const std::string& file, const std::string& bytes);

/// A file of all steps so far, which can be read during the run, and after the program was ended. In a long series it
/// is not written after each step, so that writing takes at most a twentieth of the time. A device or a pipe gets the
/// text once, at the end.
class GrowingFile
{
public:
  explicit GrowingFile(const std::string& name)
    : Name(name)
  {
  }

  /// Call this with the whole text whenever it may have grown. Does nothing if the file has no name. Throws
  /// std::runtime_error with one sentence.
  void Write(const std::string& text, bool isLast);

private:
  using Clock = std::chrono::steady_clock;
  const std::string Name;
  Clock::time_point Next;
};

#endif
