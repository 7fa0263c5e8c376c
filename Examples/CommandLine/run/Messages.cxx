// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Messages.h"

#include "Text.h"

#include "vtkObjectFactory.h"
#include "vtkOutputWindow.h"

#include <algorithm>

namespace
{

/// Returns the sentence: of "ERROR: In F.cxx, line 1\nvtkClass (0x55): It failed.\n\n" and of
/// "Generic Warning: In F.cxx, line 1\nIt failed.\n\n" it is "It failed."
std::string Sentence(const char* text)
{
  std::string message = text ? text : "";
  const std::size_t colon = message.find("): ", message.find(" (0x"));
  if (colon != std::string::npos)
  {
    message.erase(0, colon + 3);
  }
  else if (message.find(": In ") < message.find('\n'))
  {
    message.erase(0, message.find('\n') + 1);
  }
  if (message.find(" returned failure for request: ") != std::string::npos)
  {
    message = "VTK's reader gave up"; // the message has only a page of addresses
  }
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::replace(message.begin(), message.end(), '\r', ' ');
  message.erase(message.find_last_not_of(' ') + 1);
  return message;
}

/// Takes the place of VTK's window.
class Window : public vtkOutputWindow
{
public:
  static Window* New();
  vtkTypeMacro(Window, vtkOutputWindow);

  /// Warnings are kept here, too: if a file ends in mid-array, the legacy readers only warn ("Error
  /// reading ascii data").
  void DisplayText(const char* text) override
  {
    const std::string sentence = Sentence(text);
    (sentence.compare(0, 5, "Error") == 0 ? this->Kept.Errors : this->Kept.Warnings)
      .push_back(sentence);
  }

  void DisplayErrorText(const char* text) override
  {
    const std::string sentence = Sentence(text);
    // Two errors are ignored: VTK writes inf in the range of an array, and cannot read it (arrays
    // are checked when they are used); and VTK cannot read files that it wrote without points.
    if (sentence.find("reading InformationKey element") == std::string::npos &&
      sentence.find("No Points element available") == std::string::npos)
    {
      this->Kept.Errors.push_back(sentence);
    }
  }

  void DisplayDebugText(const char*) override {}

  KeptMessages Kept;
};
vtkStandardNewMacro(Window);

}

void KeptMessages::Check(const std::string& error) const
{
  Require(error.empty() && this->Errors.empty(), error.empty() ? this->FirstError() : error);
}

KeptMessages& Messages()
{
  static Window* const window = []
  {
    Window* const made = Window::New();
    vtkOutputWindow::SetInstance(made);
    return made;
  }();
  return window->Kept;
}
