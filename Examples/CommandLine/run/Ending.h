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

/// Sets the sentence for a crash while this object lives: "FAILURE: ...; HINT".
class Activity
{
public:
  Activity(const std::string& failure, const std::string& hint);
  ~Activity();
  Activity(const Activity&) = delete;
  void operator=(const Activity&) = delete;

private:
  const std::pair<std::string, std::string> Outer; ///< the sentence around this object's life
};

/// While such an object lives, only the program's own sentence about a crash reaches standard
/// error, where libraries would write messages about a damaged file.
class Silence
{
public:
  Silence();
  ~Silence();
  Silence(const Silence&) = delete;
  void operator=(const Silence&) = delete;
};

/// A new file with an unpredictable name. It is removed with the object, or when the program ends,
/// unless it takes the place of another file.
class TemporaryFile
{
public:
  /// Makes a file named `begin` and six more characters. If this fails, errno tells why.
  explicit TemporaryFile(const std::string& begin);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  void operator=(const TemporaryFile&) = delete;

  int GetDescriptor() const { return this->Descriptor; } ///< below 0: there is no file

  /// Returns false, and sets errno, if the written bytes were not stored.
  bool Close();
  bool TakePlaceOf(const std::string& file);

private:
  std::string Name;
  int Descriptor = -1;
};

#endif
