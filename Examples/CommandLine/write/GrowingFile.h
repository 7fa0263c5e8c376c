// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef GrowingFile_h
#define GrowingFile_h

#include <chrono>
#include <functional>
#include <string>

/// A file of all steps so far, that can be looked at while there are more and more of them, and where the program is ended.
/// That of a long series is not written after each step, but as often as it takes a twentieth of the time. A device
/// or a pipe gets it once, at the end.
class GrowingFile
{
public:
  explicit GrowingFile(const std::string& name);

  /// There may be more in it: `text` gives the whole. Throws std::runtime_error with one sentence.
  void Write(const std::function<std::string()>& text, bool isLast);

private:
  using Clock = std::chrono::steady_clock;
  const std::string Name;
  const bool IsRegular;
  Clock::time_point Next;
};

#endif
