// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Text_h
#define Text_h

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// ---- Texts for people and files ----

/// Makes text from a file or the command line fit for a terminal and for XML: one line of UTF-8.
/// Characters that could steer a terminal (control characters, marks that turn the direction of
/// writing) and bytes that are not UTF-8 become codes, "\x1b" or "\u202e". Other text stays.
std::string Printable(const std::string& text);

/// Returns the text in double quotes, as a JSON string: bytes that are not UTF-8 become U+FFFD.
std::string QuotedForJson(const std::string& text);

/// A function of type mcor_word, see mcor.h. The core's sentences have slots, which each program fills with its own words.
/// This function writes this program's word for the slot `name`, such as --cube-size, to `word`. It returns 0 if there is none.
int OptionWord(void* user, const char* name, const char* value, char* word, std::size_t size);

/// Prints an error or a warning as one line on standard error, after the program's name. The
/// sentence is made printable first, because it may contain names from files.
void Say(const std::string& sentence);

/// Throws std::runtime_error, "FILE cannot be read: WHY".
[[noreturn]] void FailToRead(const std::string& file, const std::string& why);

/// The functions below throw std::runtime_error unless `isGood`, with the sentence, or with why the file cannot be read
/// or written.
///@{
void Require(bool isGood, const std::string& sentence);
void RequireToRead(bool isGood, const std::string& file, const std::string& why);
void RequireToWrite(bool isGood, const std::string& file, const std::string& why);
///@}

/// Returns why the work failed, in one sentence; empty if it did not fail.
std::string FailureOf(const std::function<void()>& work);

/// Returns the fewest digits that read back as the same number, in every locale.
template <typename T>
std::string DigitsOf(T number)
{
  char digits[32];
  return { digits, std::to_chars(digits, digits + sizeof(digits), number).ptr };
}

/// Returns the number with at most this many digits. The locale does not matter.
std::string DigitsOf(double number, int digits);

/// Rounds to 15 digits: 3 x 0.05 is 0.15, not 0.15000000000000002.
double Rounded(double number);

/// Returns the text as it is written in an attribute of an XML element.
std::string EscapedForXml(const std::string& text);

/// Returns the texts with this sign between them; "" for none. last: the sign before the last text.
std::string Joined(const std::vector<std::string>& texts, const std::string& sign = ", ",
  const char* last = nullptr);

/// Returns the text with valueOf(NAME) in place of each {NAME}.
std::string Filled(
  std::string text, const std::function<std::string(const std::string& name)>& valueOf);

// ---- Values of options ----

/// Wrong usage; what() is one sentence.
class UsageError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Throws a UsageError unless `isGood`, with the sentence, or with "OPTION needs WORDS, not 'TEXT'".
void Need(bool isGood, const std::string& sentence);
void Need(
  bool isGood, const std::string& option, const std::string& words, const std::string& text);

/// Returns the texts between the signs `sign`.
std::vector<std::string> ItemsOf(const std::string& text, char sign = ',');

/// Returns true, and sets the value, if the whole text is one finite number. Else the value may have
/// changed, too.
bool ParseNumber(const std::string& text, double& value);

/// Returns "; did you mean NAME?" with the name that is most like the text; empty if none is near.
std::string NearestOf(const std::string& text, const std::vector<std::string>& names);

/// The functions below read the text behind an option. If it is not valid, a UsageError names the
/// option.
///@{
double ToNumber(const std::string& option, const std::string& text);
double ToPositive(const std::string& option, const std::string& text);
double ToThreshold(const std::string& option, const std::string& text); ///< 0 or greater
int ToCount(const std::string& option, const std::string& text, int smallest,
  int largest = std::numeric_limits<int>::max());
/// Words and their numbers; ToChoice() returns the number of a word.
using Choices = std::vector<std::pair<const char*, int>>;
int ToChoice(const std::string& option, const std::string& text, const Choices& choices);
/// Accepts an array name, or a constant, which must be greater than 0.
std::string ToQuantity(const std::string& option, const std::string& text);
double ToLimit(const std::string& option, const std::string& text); ///< may be inf or -inf
std::vector<double> ToNumbers(const std::string& option, const std::string& text,
  double (*read)(const std::string& option, const std::string& text) = ToNumber);
/// Returns x0, x1, y0, y1, z0, z1. A side may be open: inf, or -inf.
std::vector<double> ToBox(const std::string& option, const std::string& text);
///@}

// ---- Names of files ----

bool EndsWith(const std::string& text, const std::string& end);

/// Whether this is the name of a .pvd file, ParaView's list of files and their times.
inline bool IsCollectionFile(const std::string& file)
{
  return EndsWith(file, ".pvd");
}

/// Whether this is the name of a list of files and their times: .pvd, .vtk.series, ...
inline bool IsListOfSteps(const std::string& file)
{
  return IsCollectionFile(file) || EndsWith(file, ".series");
}

/// A file format: the ending of its names, and the function that reads or writes it.
template <typename FunctionT>
struct FileFormat
{
  const char* Ending;
  FunctionT Process;
};

/// Returns the format with the ending of this name; nullptr if there is none.
template <typename FunctionT>
const FileFormat<FunctionT>* FindFormat(
  const std::vector<FileFormat<FunctionT>>& formats, const std::string& file)
{
  const auto found = std::find_if(formats.begin(), formats.end(),
    [&file](const FileFormat<FunctionT>& format) { return EndsWith(file, format.Ending); });
  return found == formats.end() ? nullptr : &*found;
}

/// Returns the endings as ".vtp, .vtu or .vtk".
template <typename FunctionT>
std::string ListEndings(const std::vector<FileFormat<FunctionT>>& formats)
{
  std::vector<std::string> endings;
  for (const FileFormat<FunctionT>& format : formats)
  {
    endings.push_back(format.Ending);
  }
  return Joined(endings, ", ", " or ");
}

/// Whether a film's name has one place for the number of a step, %d, perhaps with one or two digits
/// as in %04d, and no other percent sign.
bool HasStepNumber(const std::string& name);

/// Returns the name of a step: frame_0007.png for frame_%04d.png.
std::string NameOfStep(const std::string& name, std::size_t step);

#endif
