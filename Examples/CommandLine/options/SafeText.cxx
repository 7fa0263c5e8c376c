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
  std::size_t Bytes; ///< how many stand for it
  unsigned Code;
  bool Valid; ///< false: one byte that is no UTF-8, and Code is its value
};

/// The character at text[i].
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

/// Line breaks, direction marks, and what XML does not allow.
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

/// The text, each character as `written` has it; as it is where that is empty.
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

/// What replaces words of the filters, whose advice is the same for all interfaces.
struct Advice
{
  const char* Words;
  const char* Instead; ///< where the sentence does not name that option already
  const char* Option;
};

const Advice Advices[] = {
  { "Turn Estimate Smoothing Length on, or choose Smoothing Length Array",
    "Give --smoothing-length NAME, VALUE or estimate", "--smoothing-length" },
  { "Name its array, give a constant, or have it estimated.",
    "Give --smoothing-length NAME, VALUE or estimate.", "--smoothing-length" },
  { "it is coefh x sqrt(3) x dp.", "it is coefh x sqrt(3) x dp: give --dp and --coefh.", "--dp" },
  { "which its shape cannot have. See mcor_section_shape.",
    "as its file has no triangles; give one of a surface (--flux NAME=FILE).", "--flux" },
  { "Choose Velocity Array", "Give --velocity NAME", "--velocity" },
  { "Name the array of ids", "Name the array of ids (--ids NAME)", "--ids" },
  { "arger cube size", "arger cube size (--cube-size)", "--cube-size" },
  { "maller cube size", "maller cube size (--cube-size)", "--cube-size" },
  { "another cube size", "another cube size (--cube-size)", "--cube-size" },
  { "a cube size of no more", "a cube size (--cube-size) of no more", "--cube-size" },
  { "fewer levels", "fewer levels (--max-level)", "--max-level" },
  { "complete seeds", "complete seeds (--seeds complete)", "--seeds" },
  { "uniform cubes", "uniform cubes (--cubes uniform)", "--cubes" },
  { "lacks. Turn one of them off",
    "lacks. Turn one of them off (leave out --filled, or --compact and --smooth)", "--compact" },
  { "box. Turn one of them off", "box. Turn one of them off (leave out --filled or --capping)",
    "--capping" },
  { "urn filling off", "urn filling off (leave out --filled)", "--filled" },
  { "urn capping off", "urn capping off (leave out --capping)", "--capping" },
  { "set the dimension to 3", "set the dimension to 3 (--dimension 3)", "--dimension" },
  { "use three dimensions", "use three dimensions (--dimension 3)", "--dimension" },
  { "hoose another device", "hoose another device (--device)", "--device" },
  { "se single precision", "se single precision (--precision single)", "--precision" },
  { "or single precision", "or single precision (--precision single)", "--precision" },
  { "a higher memory limit", "a higher memory limit (--memory-limit)", "--memory-limit" },
  { "choose a larger factor", "choose a larger factor (--h-scale)", "--h-scale" },
  { "masses and densities, or remove",
    "masses and densities (--volume, or --mass and --density), or remove", "--volume" },
  { "Use a node threshold", "Use a node threshold (--node-threshold)", "--node-threshold" },
  { "for the fluid. Point arrays",
    "for the fluid; leave out --fluid if all particles are fluid. Point arrays", "--fluid" },
  { "pthread_create has failed: Resource temporarily unavailable",
    "no thread can be started; raise the limit of processes (ulimit -u)", "ulimit -u" },
  { "by a range of positions", "by a range of positions (--within)", "--within" },
  { "et the periodic bounds", "et the periodic bounds (--periodic)", "--periodic" },
};
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

std::string Reworded(
  const std::string& sentence, const std::string& words, const std::string& instead)
{
  const std::size_t at = sentence.find(words);
  return at == std::string::npos ? sentence
                                 : std::string(sentence).replace(at, words.size(), instead);
}

std::string WithOptions(const std::string& sentence)
{
  std::string result = sentence;
  for (const Advice& advice : Advices)
  {
    if (result.find(advice.Option) == std::string::npos)
    {
      result = Reworded(result, advice.Words, advice.Instead);
    }
  }
  return result;
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
  std::cerr << "marching-correctors: " << Printable(WithOptions(sentence)) << "\n";
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
    return error.what();
  }
}
