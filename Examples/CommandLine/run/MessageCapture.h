// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef MessageCapture_h
#define MessageCapture_h

#include "vtkOutputWindow.h"

#include <string>
#include <vector>

/// Keeps VTK's messages instead of printing them: one failure makes VTK report several times, over
/// many lines, with source files and addresses, where the user needs one sentence.
class MessageCapture : public vtkOutputWindow
{
public:
  static MessageCapture* New();
  vtkTypeMacro(MessageCapture, vtkOutputWindow);

  void DisplayText(const char* text) override;
  void DisplayErrorText(const char* text) override;
  void DisplayDebugText(const char* text) override;

  /// Errors that have been reported since the last Clear(), without file, line and address.
  const std::vector<std::string>& GetErrors() const { return this->Errors; }
  const std::vector<std::string>& GetWarnings() const { return this->Warnings; }
  void Clear();

  /// Throws std::runtime_error with `error`, or with the first one that was reported, if any.
  void Check(const std::string& error = "") const;
  void AppendWarnings(std::vector<std::string>& to) const;

private:
  std::vector<std::string> Errors;
  std::vector<std::string> Warnings;
};

/// VTK has one window for messages of all objects: this one, from its first use on.
MessageCapture& Messages();

#endif
