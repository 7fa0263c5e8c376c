// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/// These functions tell the user of failures and crashes, and remove temporary files if a crash or a signal ends the program.
#ifndef Failures_h
#define Failures_h

#include <string>
#include <utility>
#include <vector>

/// VTK's messages, which are kept instead of printed: for one failure, VTK prints several messages
/// of many lines, with source files and addresses, but the user needs one sentence.
struct KeptMessages
{
  std::vector<std::string> Errors, Warnings; ///< sentences without file, line and address

  std::string FirstError() const { return this->Errors.empty() ? "" : this->Errors.front(); }
  void AddWarningsTo(std::vector<std::string>& list) const
  {
    list.insert(list.end(), this->Warnings.begin(), this->Warnings.end());
  }

  /// Throws std::runtime_error with `error` or, if it is empty, with the first kept error, if any.
  void Check(const std::string& error = "") const;
};

/// Returns the messages since the list was last emptied. The first call makes VTK send all messages
/// to this list, because VTK has one output window for all objects.
KeptMessages& Messages();

/// Must be called before any thread starts. From then on the program prints a sentence if it
/// crashes, and removes its temporary files if a crash, or a signal that people and batch systems
/// send, ends it.
void PrepareForEnding();

/// Must be called again after drivers were loaded: LLVM, which PoCL brings, has handlers of its
/// own.
void KeepWatchOfCrashes();

/// Names possible causes of a crash. PoCL crashes whenever it loads a half-written file from its cache; so,
/// unless `device` is the built-in one, names the cache's folder if there is one.
std::string FaultsOfDrivers(const std::string& device);

/// While this object lives, a crash prints the sentence "FAILURE: ...; HINT". isSilent: standard error
/// gets only this sentence then, not the messages that libraries write about a damaged file.
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
/// file's descriptor; if it is below 0, `name` is "", and errno tells why. The file is removed if a
/// crash or a signal ends the program before EndTemporary() is called.
int MakeTemporary(std::string& name);

/// Lets the file replace `target` or, if `target` is empty, removes the file. If the file cannot
/// replace the target, keeps the file, sets errno, and returns false.
bool EndTemporary(const std::string& name, const std::string& target = "");

#endif
