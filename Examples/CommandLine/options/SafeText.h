// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef SafeText_h
#define SafeText_h

#include <charconv>
#include <cstddef>
#include <functional>
#include <string>

/// Makes text from a file or the command line fit for a terminal and for XML: one line of UTF-8.
/// Characters that could steer a terminal (control characters, marks that turn the direction of
/// writing) and bytes that are not UTF-8 become codes, "\x1b" or "\u202e". Other text stays.
std::string Printable(const std::string& text);

/// Returns the text in double quotes, as a JSON string: bytes that are not UTF-8 become U+FFFD.
std::string QuotedForJson(const std::string& text);

/// Writes the program's word for a slot of a sentence of the core, such as --cube-size, as an
/// mcor_word of mcor.h. Returns 0 if there is none.
int OptionWord(void* user, const char* name, const char* value, char* word, std::size_t size);

/// Prints an error or a warning as one line on standard error, after the program's name. Names and
/// files may have put anything into the sentence.
void Say(const std::string& sentence);

/// Throws std::runtime_error, "FILE cannot be read: WHY", or a sentence that it cannot be written.
///@{
[[noreturn]] void FailToRead(const std::string& file, const std::string& why);
[[noreturn]] void FailToWrite(const std::string& file, const std::string& why);
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

/// Returns the text as it is written in an attribute of an XML element.
std::string EscapedForXml(const std::string& text);

#endif
