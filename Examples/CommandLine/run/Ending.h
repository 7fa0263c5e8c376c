// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Ending_h
#define Ending_h

#include <string>

/// Must be called before any thread starts. From then on the program prints a sentence if it
/// crashes, and removes its temporary files if a crash, or a signal that people and batch systems
/// send, ends it.
void PrepareForEnding();

/// Must be called again after drivers were loaded: LLVM, which PoCL brings, has handlers of its
/// own.
void KeepWatchOfCrashes();

/// Names possible causes of a crash. A file that PoCL has kept half-written makes it crash whenever
/// it loads that. Its folder is named if there is one and `device` does not name the built-in one.
std::string FaultsOfDrivers(const std::string& device);

/// The sentence if the program crashes while this object lives: "FAILURE: ...; HINT".
class Activity
{
public:
  Activity(const std::string& failure, const std::string& hint);
  ~Activity();
  Activity(const Activity&) = delete;
  void operator=(const Activity&) = delete;

private:
  std::string OuterFailure;
  std::string OuterHint;
};

/// While one lives, nothing but the program's own sentence about a crash reaches standard error:
/// libraries write there what they think of a damaged file.
class Silence
{
public:
  Silence();
  ~Silence();
  Silence(const Silence&) = delete;
  void operator=(const Silence&) = delete;
};

/// A new file that nobody could name before, and that goes away with the object or the program
/// unless it takes the place of another one.
class TemporaryFile
{
public:
  /// Makes a file named `begin` and six more characters. If that fails, errno tells why.
  explicit TemporaryFile(const std::string& begin);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  void operator=(const TemporaryFile&) = delete;

  int GetDescriptor() const { return this->Descriptor; } ///< below 0: there is no file

  /// Returns false, and sets errno, if the written bytes could not be kept.
  bool Close();
  bool TakePlaceOf(const std::string& file);

private:
  std::string Name;
  int Descriptor = -1;
};

#endif
