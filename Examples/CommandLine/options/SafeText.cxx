// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "SafeText.h"

#include "Job.h"

#include <cstddef>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <stdexcept>

namespace
{

struct Character
{
  std::size_t Bytes; ///< how many bytes the character has
  unsigned Code;
  bool Valid; ///< false: Code is the value of one byte that is not UTF-8
};

/// Returns the character at text[i].
Character At(const std::string& text, std::size_t i)
{
  const auto byte = [&](std::size_t k)
  { return i + k < text.size() ? static_cast<unsigned char>(text[i + k]) : 0u; };
  const unsigned first = byte(0);
  if (first < 0x80)
  {
    return { 1, first, true };
  }
  const std::size_t count = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  unsigned code = first & (0xffu >> (count + 1));
  bool valid = first >= 0xc2 && first <= 0xf4;
  for (std::size_t k = 1; k < count; ++k)
  {
    valid = valid && (byte(k) & 0xc0u) == 0x80u;
    code = code << 6 | (byte(k) & 0x3fu);
  }
  const unsigned smallest[] = { 0x80, 0x800, 0x10000 };
  valid = valid && code >= smallest[count - 2] && code <= 0x10ffff && (code & ~0x7ffu) != 0xd800;
  return valid ? Character{ count, code, true } : Character{ 1, first, false };
}

bool IsControl(unsigned code)
{
  return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

/// Whether this character must not reach a terminal or XML: line breaks, direction marks, and
/// characters that XML does not allow.
bool IsInvisible(unsigned code)
{
  return code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
    (code >= 0x2066 && code <= 0x2069) || code == 0xfeff || (code & 0xfffe) == 0xfffe;
}

std::string Escape(const char* format, unsigned code)
{
  char digits[16];
  std::snprintf(digits, sizeof(digits), format, code);
  return digits;
}

/// Returns the text with each character replaced by written(c), unless this is empty.
std::string Rewritten(const std::string& text, std::string (*written)(const Character& c))
{
  std::string result;
  for (std::size_t i = 0; i < text.size();)
  {
    const Character c = At(text, i);
    const std::string other = written(c);
    result += other.empty() ? text.substr(i, c.Bytes) : other;
    i += c.Bytes;
  }
  return result;
}
}

std::string Printable(const std::string& text)
{
  return Rewritten(text,
    [](const Character& c)
    {
      return !c.Valid || IsControl(c.Code) ? Escape("\\x%02x", c.Code)
        : IsInvisible(c.Code)              ? Escape("\\u%04x", c.Code)
                                           : "";
    });
}

std::string QuotedForJson(const std::string& text)
{
  const auto written = [](const Character& c) -> std::string
  {
    const bool isCode = IsControl(c.Code) || (IsInvisible(c.Code) && c.Code < 0x10000);
    return !c.Valid    ? "\\ufffd"
      : isCode         ? Escape("\\u%04x", c.Code)
      : c.Code == '"'  ? "\\\""
      : c.Code == '\\' ? "\\\\"
                       : "";
  };
  return '"' + Rewritten(text, written) + '"';
}

int OptionWord(void*, const char* name, const char* value, char* word, std::size_t size)
{
  const std::string member = name;
  const bool isEstimate = member == "estimate_smoothing_length";
  const std::string option = isEstimate ? "--smoothing-length estimate" : WordOf(member);
  std::snprintf(word, size, "%s%s%s%s", option.c_str(), *value ? " " : "", value,
    member == "fluid" && *value ? "=VALUE" : "");
  return !option.empty();
}

void Say(const std::string& sentence)
{
  std::cerr << "marching-correctors: " << Printable(sentence) << "\n";
}

void FailToRead(const std::string& file, const std::string& why)
{
  throw std::runtime_error(file + " cannot be read: " + why);
}

void FailToWrite(const std::string& file, const std::string& why)
{
  throw std::runtime_error(file + " could not be written" + (why.empty() ? "" : ": " + why));
}

std::string EscapedForXml(const std::string& text)
{
  std::string escaped;
  for (const char c : text)
  {
    escaped += c == '"' ? "&quot;" : c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
  }
  return escaped;
}

std::string FailureOf(const std::function<void()>& work)
{
  try
  {
    work();
    return "";
  }
  catch (const std::bad_alloc&)
  {
    return "host memory ran out";
  }
  catch (const std::exception& error)
  {
    return std::string(error.what()).find("pthread_create") == std::string::npos
      ? error.what()
      : "no thread can be started; raise the limit of processes (ulimit -u)";
  }
}
