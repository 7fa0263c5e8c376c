// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "FileName.h"

#include <algorithm>
#include <cstdlib>

namespace
{

/// Returns the place of the letter after the percent sign; npos if there is no number to put in.
std::size_t EndOfPlace(const std::string& name, std::size_t percent)
{
  const std::size_t letter =
    percent == std::string::npos ? percent : name.find_first_not_of("0123456789", percent + 1);
  const bool isPlace = letter != std::string::npos && name[letter] == 'd' && letter - percent <= 3;
  return isPlace ? letter : std::string::npos;
}

}

bool HasStepNumber(const std::string& name)
{
  return std::count(name.begin(), name.end(), '%') == 1 &&
    EndOfPlace(name, name.find('%')) != std::string::npos;
}

bool FindStepNumber(const std::string& file, std::size_t& number)
{
  const char* const digits = "0123456789";
  const std::size_t folder = file.find_last_of("/\\");
  const std::size_t last = file.find_last_of(digits);
  if (last == std::string::npos || (folder != std::string::npos && last < folder))
  {
    return false;
  }
  const std::size_t before = file.find_last_not_of(digits, last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  number = std::strtoull(file.substr(first, last - first + 1).c_str(), nullptr, 10);
  return true;
}

std::string NameOfStep(const std::string& name, std::size_t step)
{
  const std::size_t percent = name.find('%');
  const std::size_t letter = EndOfPlace(name, percent);
  const auto width = static_cast<std::size_t>(std::atoi(name.c_str() + percent + 1));
  std::string number = std::to_string(step);
  number.insert(0, width > number.size() ? width - number.size() : 0, '0');
  return name.substr(0, percent) + number + name.substr(letter + 1);
}
