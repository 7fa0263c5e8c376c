// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Messages_h
#define Messages_h

#include <string>
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

/// Returns the messages since they were last emptied. VTK has one window for all objects: after the
/// first call of this, all messages come here.
KeptMessages& Messages();

#endif
