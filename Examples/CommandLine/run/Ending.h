// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Ending_h
#define Ending_h

#include <string>
#include <utility>

/// Must be called before any thread starts. From then on the program prints a sentence if it
/// crashes, and removes its temporary files if a crash, or a signal that people and batch systems
/// send, ends it.
void PrepareForEnding();

/// Must be called again after drivers were loaded: LLVM, which PoCL brings, has handlers of its
/// own.
void KeepWatchOfCrashes();

/// Names possible causes of a crash. If PoCL has kept a half-written file, it crashes whenever it
/// loads this file. Names the folder of such files if it exists, unless `device` is the built-in one.
std::string FaultsOfDrivers(const std::string& device);

/// Sets the sentence for a crash while this object lives: "FAILURE: ...; HINT". isSilent: only this
/// sentence then reaches standard error, where libraries would write messages about a damaged file.
class Activity
{
public:
  Activity(const std::string& failure, const std::string& hint, bool isSilent = false);
  ~Activity();
  Activity(const Activity&) = delete;
  void operator=(const Activity&) = delete;

private:
  const std::pair<std::string, std::string> Outer; ///< the sentence before and after this object's life
  const bool IsSilent;
};

/// Makes a new file, and appends six characters to `name`, which then names the file. Returns the
/// file's descriptor; below 0, `name` is "", and errno tells why. The file is removed when the program
/// ends, unless EndTemporary() was called.
int MakeTemporary(std::string& name);

/// Lets the file take the place of `target`, or, without one, removes the file. Returns false, and
/// sets errno, if this fails.
bool EndTemporary(const std::string& name, const std::string& target = "");

#endif
