// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "OptionValue.h"

#include "SafeText.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

bool ParseNumber(const std::string& text, double& value)
{
  // from_chars reads 1.5 as 1.5 in every locale, but knows no leading plus.
  const char* begin = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(begin, end, value);
  return result.ec == std::errc() && result.ptr == end && std::isfinite(value);
}

double ToNumber(const std::string& option, const std::string& text)
{
  double value = 0.0;
  if (!ParseNumber(text, value))
  {
    throw UsageError(option + " needs a finite number, not '" + text + "'");
  }
  return value;
}

double ToPositive(const std::string& option, const std::string& text)
{
  const double value = ToNumber(option, text);
  if (value <= 0.0)
  {
    throw UsageError(option + " must be greater than 0, not " + text);
  }
  return value;
}

double ToThreshold(const std::string& option, const std::string& text)
{
  const double value = ToNumber(option, text);
  if (value < 0.0)
  {
    throw UsageError(option + " must be 0 or greater, not " + text);
  }
  return value;
}

int ToCount(const std::string& option, const std::string& text, int smallest, int largest)
{
  int value = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || value < smallest || value > largest)
  {
    const bool tooLarge =
      value > largest || (result.ec == std::errc::result_out_of_range && text[0] != '-');
    throw UsageError(option + " needs a whole number " +
      (tooLarge ? "up to " + std::to_string(largest) : "from " + std::to_string(smallest)) +
      ", not '" + text + "'");
  }
  return value;
}

int ToChoice(const std::string& option, const std::string& text,
  const std::vector<std::pair<const char*, int>>& choices)
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
  throw UsageError(option + " must be one of " + list + ", not '" + text + "'");
}

std::string ToQuantity(const std::string& option, const std::string& text)
{
  double value = 0.0;
  if (ParseNumber(text, value))
  {
    ToPositive(option, text);
  }
  return Printable(text);
}

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

double ToShare(const std::string& option, const std::string& text)
{
  if (text == "measured")
  {
    return -1.0; // see vtkMarchingCorrectors::SetWallShare
  }
  const double number = ToNumber(option, text);
  if (!(number > 0.0 && number < 1.0))
  {
    throw UsageError(
      option + " needs a number above 0 and below 1, or 'measured', not '" + text + "'");
  }
  return number;
}

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
    const double low = box[2 * a], high = box[2 * a + 1];
    if (!(low < high || (low == high && std::isfinite(low)))) // flat: particles in that plane
    {
      throw UsageError(
        option + " needs the lower number first along " + "xyz"[a] + ", not '" + text + "'");
    }
  }
  return box;
}

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

void ToSlice(const std::string& option, const std::string& text, int& axis, double& place)
{
  const std::size_t found = std::string("xyz").find(text.substr(0, 1));
  if (text.size() < 3 || text[1] != '=' || found == std::string::npos)
  {
    throw UsageError(option + " needs an axis and a position, such as z=0.1, not '" + text + "'");
  }
  axis = static_cast<int>(found);
  place = ToNumber(option, text.substr(2));
}

std::vector<double> ToLine(const std::string& option, const std::string& text)
{
  const std::vector<double> line = ToNumbers(option, text);
  if (line.size() != 6 || std::equal(line.begin(), line.begin() + 3, line.begin() + 3))
  {
    throw UsageError(option + " needs two different points, X,Y,Z,X,Y,Z, not '" + text + "'");
  }
  return line;
}

std::vector<double> ToRange(const std::string& option, const std::string& text)
{
  const std::vector<double> range = ToNumbers(option, text);
  if (range.size() != 2 || !(range[0] < range[1]))
  {
    throw UsageError(option + " needs two numbers, the lower one first, not '" + text + "'");
  }
  return range;
}

std::vector<double> ToDirection(const std::string& option, const std::string& text)
{
  const std::vector<double> direction = ToNumbers(option, text);
  if (direction.size() != 3 || std::count(direction.begin(), direction.end(), 0.0) == 3)
  {
    throw UsageError(option + " needs three numbers, not all 0, not '" + text + "'");
  }
  return direction;
}

std::vector<std::string> ToNames(const std::string& option, const std::string& text)
{
  std::vector<std::string> names;
  std::istringstream stream(text + ",");
  for (std::string name; std::getline(stream, name, ',');)
  {
    if (name.empty())
    {
      throw UsageError(option + " needs names separated by commas, not '" + text + "'");
    }
    names.push_back(Printable(name));
  }
  return names;
}
