// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "OptionValue.h"

#include "SafeText.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <sstream>

using Text = const std::string&;

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

void Need(bool isGood, Text option, Text words, Text text)
{
  if (!isGood)
  {
    throw UsageError(option + " needs " + words + ", not '" + text + "'");
  }
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
  if (value <= 0.0)
  {
    throw UsageError(option + " must be greater than 0, not " + text);
  }
  return value;
}

double ToThreshold(Text option, Text text)
{
  const double value = ToNumber(option, text);
  if (value < 0.0)
  {
    throw UsageError(option + " must be 0 or greater, not " + text);
  }
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
  // Compares small letters only, without - and _. A name that begins with the text is as near as a
  // name with one wrong letter.
  const auto lettersOf = [](Text word)
  {
    std::string letters;
    for (const char c : word)
    {
      const auto lower = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
      letters += lower == '-' || lower == '_' ? "" : std::string(1, lower);
    }
    return letters;
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
  std::string list;
  for (const auto& choice : choices)
  {
    if (text == choice.first)
    {
      return choice.second;
    }
    list += (list.empty() ? "" : ", ") + std::string(choice.first);
  }
  std::vector<std::string> words;
  for (const auto& choice : choices)
  {
    words.emplace_back(choice.first);
  }
  throw UsageError(
    option + " must be one of " + list + ", not '" + text + "'" + NearestOf(text, words));
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

std::vector<double> ToNumbers(Text option, Text text)
{
  std::vector<double> values;
  for (Text item : ItemsOf(text))
  {
    values.push_back(ToNumber(option, item));
  }
  return values;
}

std::vector<double> ToBox(Text option, Text text)
{
  std::vector<double> box;
  for (Text item : ItemsOf(text))
  {
    const bool isOpen = item == "inf" || item == "-inf";
    const double infinity = std::numeric_limits<double>::infinity();
    box.push_back(!isOpen ? ToNumber(option, item) : item[0] == '-' ? -infinity : infinity);
  }
  Need(box.size() == 6, option, "six numbers, x0,x1,y0,y1,z0,z1", text);
  for (std::size_t a = 0; a < 3; ++a)
  {
    const double low = box[2 * a], high = box[2 * a + 1];
    const bool isFlat = low == high && std::isfinite(low); // a flat box means particles in that
                                                           // plane
    Need(
      low < high || isFlat, option, std::string("the lower number first along ") + "xyz"[a], text);
  }
  return box;
}
