// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "OptionValue.h"

#include "SafeText.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

//------------------------------------------------------------------------------
bool ParseNumber(const std::string& text, double& value)
{
  // from_chars reads 1.5 as 1.5 in every locale, but knows no leading plus.
  const char* begin = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(begin, end, value);
  return result.ec == std::errc() && result.ptr == end && std::isfinite(value);
}

//------------------------------------------------------------------------------
double ToNumber(const std::string& option, const std::string& text)
{
  double value = 0.0;
  if (!ParseNumber(text, value))
  {
    throw UsageError(option + " needs a finite number, not '" + text + "'");
  }
  return value;
}

//------------------------------------------------------------------------------
double ToPositive(const std::string& option, const std::string& text)
{
  const double value = ToNumber(option, text);
  if (value <= 0.0)
  {
    throw UsageError(option + " must be greater than 0, not " + text);
  }
  return value;
}

//------------------------------------------------------------------------------
double ToThreshold(const std::string& option, const std::string& text)
{
  const double value = ToNumber(option, text);
  if (value < 0.0)
  {
    throw UsageError(option + " must be 0 or greater, not " + text);
  }
  return value;
}

//------------------------------------------------------------------------------
int ToCount(const std::string& option, const std::string& text, int smallest)
{
  int value = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || value < smallest)
  {
    const bool tooLarge = result.ec == std::errc::result_out_of_range && text[0] != '-';
    throw UsageError(option + " needs a whole number " +
      (tooLarge ? "up to " + std::to_string(std::numeric_limits<int>::max())
                : "from " + std::to_string(smallest)) +
      ", not '" + text + "'");
  }
  return value;
}

//------------------------------------------------------------------------------
int ToLevel(const std::string& option, const std::string& text)
{
  const int level = ToCount(option, text, 0);
  if (level > 24)
  {
    throw UsageError(option + " needs a whole number up to 24, not '" + text + "'");
  }
  return level;
}

//------------------------------------------------------------------------------
std::string ToChoice(
  const std::string& option, const std::string& text, const std::vector<std::string>& choices)
{
  if (std::find(choices.begin(), choices.end(), text) == choices.end())
  {
    std::string list;
    for (const std::string& choice : choices)
    {
      list += (list.empty() ? "" : ", ") + choice;
    }
    throw UsageError(option + " is one of " + list + ", not '" + text + "'");
  }
  return text;
}

//------------------------------------------------------------------------------
std::string ToQuantity(const std::string& option, const std::string& text)
{
  double value = 0.0;
  if (ParseNumber(text, value))
  {
    ToPositive(option, text);
  }
  return Printable(text);
}

//------------------------------------------------------------------------------
std::vector<double> ToNumbers(const std::string& option, const std::string& text)
{
  std::vector<double> values;
  std::istringstream stream(text + ",");
  for (std::string item; std::getline(stream, item, ',');)
  {
    values.push_back(ToNumber(option, item));
  }
  return values;
}

//------------------------------------------------------------------------------
double ToShare(const std::string& option, const std::string& text)
{
  if (text == "measured")
  {
    return 0.0;
  }
  const double number = ToNumber(option, text);
  if (!(number > 0.0 && number < 1.0))
  {
    throw UsageError(
      option + " needs a number above 0 and below 1, or 'measured', not '" + text + "'");
  }
  return number;
}

//------------------------------------------------------------------------------
std::vector<double> ToBox(const std::string& option, const std::string& text)
{
  std::vector<double> box;
  std::istringstream stream(text + ",");
  for (std::string item; std::getline(stream, item, ',');)
  {
    const bool open = item == "inf" || item == "-inf";
    const double infinity = std::numeric_limits<double>::infinity();
    box.push_back(!open ? ToNumber(option, item) : item[0] == '-' ? -infinity : infinity);
  }
  if (box.size() != 6)
  {
    throw UsageError(option + " needs six numbers, x0,x1,y0,y1,z0,z1, not '" + text + "'");
  }
  for (std::size_t a = 0; a < 3; ++a)
  {
    if (!(box[2 * a] < box[2 * a + 1]))
    {
      throw UsageError(
        option + " needs the lower number first along " + "xyz"[a] + ", not '" + text + "'");
    }
  }
  return box;
}

//------------------------------------------------------------------------------
std::vector<double> ToPeriod(const std::string& option, const std::string& text)
{
  const std::vector<double> period = ToNumbers(option, text);
  if (period.size() != 3 && period.size() != 6)
  {
    throw UsageError(option +
      " needs three lengths, or six bounds x0,x1,y0,y1,z0,z1, or auto, not '" + text + "'");
  }
  const std::size_t step = period.size() / 3;
  for (std::size_t a = 0; a < 3; ++a)
  {
    if (period[step * a + step - 1] < (step == 1 ? 0.0 : period[2 * a]))
    {
      throw UsageError(
        option + " needs a period of 0 or more along " + "xyz"[a] + ", not '" + text + "'");
    }
  }
  return period;
}

//------------------------------------------------------------------------------
std::vector<std::string> ToNames(const std::string& option, const std::string& text)
{
  std::vector<std::string> names;
  std::istringstream stream(text + ",");
  for (std::string name; std::getline(stream, name, ',');)
  {
    if (name.empty())
    {
      throw UsageError(option + " needs names with a comma between each two, not '" + text + "'");
    }
    names.push_back(Printable(name));
  }
  return names;
}
