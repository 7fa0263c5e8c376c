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

std::string NameOfStep(const std::string& name, std::size_t step)
{
  const std::size_t percent = name.find('%');
  const std::size_t letter = EndOfPlace(name, percent);
  const auto width = static_cast<std::size_t>(std::atoi(name.c_str() + percent + 1));
  std::string number = std::to_string(step);
  number.insert(0, width > number.size() ? width - number.size() : 0, '0');
  return name.substr(0, percent) + number + name.substr(letter + 1);
}
