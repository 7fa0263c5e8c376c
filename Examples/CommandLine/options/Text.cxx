// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Text.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <numeric>
#include <sstream>

using Text = const std::string&;

namespace
{

struct Character
{
  std::size_t Bytes; ///< how many bytes the character has
  unsigned Code;
  bool Valid; ///< false: Code is the value of one byte that is not UTF-8
};

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

/// Whether this character must not reach a terminal or XML: line separators, marks of direction and of
/// byte order, and code points that end in fffe or ffff.
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

/// Returns the text with written(c) in place of each character c; c stays if written(c) is empty.
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

void Say(const std::string& sentence)
{
  std::cerr << "marching-correctors: " << Printable(sentence) << "\n";
}

void FailToRead(const std::string& file, const std::string& why)
{
  throw std::runtime_error(file + " cannot be read: " + why);
}

void Require(bool isGood, const std::string& sentence)
{
  if (!isGood)
  {
    throw std::runtime_error(sentence);
  }
}

void RequireToRead(bool isGood, const std::string& file, const std::string& why)
{
  Require(isGood, file + " cannot be read: " + why);
}

void RequireToWrite(bool isGood, const std::string& file, const std::string& why)
{
  Require(isGood, file + " could not be written" + (why.empty() ? "" : ": " + why));
}

std::string DigitsOf(double number, int digits)
{
  char text[32];
  return { text,
    std::to_chars(text, text + sizeof(text), number, std::chars_format::general, digits).ptr };
}

double Rounded(double number)
{
  const std::string text = DigitsOf(number, 15);
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

std::string EscapedForXml(const std::string& text)
{
  const auto written = [](const Character& c) -> std::string {
    return c.Code == '"' ? "&quot;" : c.Code == '&' ? "&amp;" : c.Code == '<' ? "&lt;" : "";
  };
  return Rewritten(text, written);
}

std::string Joined(const std::vector<std::string>& texts, const std::string& sign, const char* last)
{
  std::string joined;
  for (std::size_t i = 0; i < texts.size(); ++i)
  {
    const bool isLast = last && i + 1 == texts.size();
    joined += (i == 0 ? "" : isLast ? last : sign) + texts[i];
  }
  return joined;
}

std::string Filled(
  std::string text, const std::function<std::string(const std::string& name)>& valueOf)
{
  for (std::size_t at = 0; (at = text.find('{', at)) != std::string::npos;)
  {
    const std::size_t end = text.find('}', at);
    const std::string value = valueOf(text.substr(at + 1, end - at - 1));
    text.replace(at, end + 1 - at, value);
    at += value.size();
  }
  return text;
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

std::vector<std::string> ItemsOf(Text text, char sign)
{
  std::vector<std::string> items;
  std::istringstream stream(text + sign);
  for (std::string item; std::getline(stream, item, sign);)
  {
    items.push_back(item);
  }
  return items;
}

void Need(bool isGood, Text sentence)
{
  if (!isGood)
  {
    throw UsageError(sentence);
  }
}

void Need(bool isGood, Text option, Text words, Text text)
{
  Need(isGood, option + " needs " + words + ", not '" + text + "'");
}

bool ParseNumber(Text text, double& value)
{
  // from_chars reads 1.5 as 1.5 in every locale, but does not accept a leading plus.
  const char* begin = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(begin, end, value);
  return result.ec == std::errc() && result.ptr == end && std::isfinite(value);
}

double ToNumber(Text option, Text text)
{
  double value = 0.0;
  Need(ParseNumber(text, value), option, "a finite number", text);
  return value;
}

double ToPositive(Text option, Text text)
{
  const double value = ToNumber(option, text);
  Need(value > 0.0, option + " must be greater than 0, not " + text);
  return value;
}

double ToThreshold(Text option, Text text)
{
  const double value = ToNumber(option, text);
  Need(value >= 0.0, option + " must be 0 or greater, not " + text);
  return value;
}

int ToCount(Text option, Text text, int smallest, int largest)
{
  int value = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  const bool isWhole = result.ec == std::errc() && result.ptr == end;
  const bool isTooLarge =
    value > largest || (result.ec == std::errc::result_out_of_range && text[0] != '-');
  Need(isWhole && value >= smallest && value <= largest, option,
    "a whole number " +
      (isTooLarge ? "up to " + std::to_string(largest) : "from " + std::to_string(smallest)),
    text);
  return value;
}

std::string NearestOf(Text text, const std::vector<std::string>& names)
{
  // Compares in small letters, without - and _. If the name begins with the text, or the text with the
  // name (four letters or more), their distance is at most 1, as if one letter were wrong.
  const auto lettersOf = [](std::string word)
  {
    word.erase(
      std::remove_if(word.begin(), word.end(), [](char c) { return c == '-' || c == '_'; }),
      word.end());
    std::transform(word.begin(), word.end(), word.begin(),
      [](char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); });
    return word;
  };
  const std::string wanted = lettersOf(text);
  std::size_t least = 1 + wanted.size() / 3;
  std::string nearest;
  for (Text name : names)
  {
    const std::string letters = lettersOf(name);
    std::vector<std::size_t> row(letters.size() + 1); // row of Levenshtein's table of distances
    std::iota(row.begin(), row.end(), std::size_t(0));
    for (std::size_t i = 0; i < wanted.size(); ++i)
    {
      std::size_t diagonal = std::exchange(row[0], i + 1);
      for (std::size_t j = 0; j < letters.size(); ++j)
      {
        const std::size_t change = diagonal + (wanted[i] == letters[j] ? 0 : 1);
        diagonal = std::exchange(row[j + 1], std::min({ change, row[j] + 1, row[j + 1] + 1 }));
      }
    }
    const std::size_t common = std::min(letters.size(), wanted.size());
    const bool isBegin = common > 3 && letters.compare(0, common, wanted, 0, common) == 0;
    const std::size_t distance = isBegin ? std::min<std::size_t>(row.back(), 1) : row.back();
    if (!letters.empty() && distance < least)
    {
      least = distance;
      nearest = name;
    }
  }
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

int ToChoice(Text option, Text text, const Choices& choices)
{
  std::vector<std::string> words;
  for (const auto& [word, number] : choices)
  {
    if (text == word)
    {
      return number;
    }
    words.emplace_back(word);
  }
  throw UsageError(
    option + " must be one of " + Joined(words) + ", not '" + text + "'" + NearestOf(text, words));
}

std::string ToQuantity(Text option, Text text)
{
  double value = 0.0;
  if (ParseNumber(text, value))
  {
    ToPositive(option, text);
  }
  return Printable(text);
}

std::vector<double> ToNumbers(Text option, Text text, double (*read)(Text option, Text text))
{
  std::vector<double> values;
  for (Text item : ItemsOf(text))
  {
    values.push_back(read(option, item));
  }
  return values;
}

double ToLimit(Text option, Text text)
{
  const double infinity = std::numeric_limits<double>::infinity();
  return text == "inf" ? infinity : text == "-inf" ? -infinity : ToNumber(option, text);
}

std::vector<double> ToBox(Text option, Text text)
{
  const std::vector<double> box = ToNumbers(option, text, ToLimit);
  Need(box.size() == 6, option, "six numbers, x0,x1,y0,y1,z0,z1", text);
  for (std::size_t a = 0; a < 3; ++a)
  {
    const double low = box[2 * a], high = box[2 * a + 1];
    // Particles in a plane may have two equal bounds.
    Need(low < high || (low == high && std::isfinite(low)), option,
      std::string("the lower number first along ") + "xyz"[a], text);
  }
  return box;
}

bool EndsWith(Text text, Text end)
{
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

bool HasStepNumber(Text name)
{
  const std::size_t percent = std::min(name.find('%'), name.size());
  const std::size_t letter = name.find_first_not_of("0123456789", percent + 1);
  return letter != std::string::npos && name[letter] == 'd' && letter - percent <= 3 &&
    std::count(name.begin(), name.end(), '%') == 1;
}

std::string NameOfStep(Text name, std::size_t step)
{
  const std::size_t percent = name.find('%');
  const auto width = static_cast<std::size_t>(std::atoi(name.c_str() + percent + 1));
  std::string number = std::to_string(step);
  number.insert(0, width > number.size() ? width - number.size() : 0, '0');
  return name.substr(0, percent) + number + name.substr(name.find('d', percent) + 1);
}
