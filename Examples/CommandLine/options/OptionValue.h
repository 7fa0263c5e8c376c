// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef OptionValue_h
#define OptionValue_h

#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// Wrong usage; what() is one sentence.
class UsageError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Throws a UsageError, "OPTION needs WORDS, not 'TEXT'", unless `isGood`.
void Need(
  bool isGood, const std::string& option, const std::string& words, const std::string& text);

/// Returns the texts between the signs `sign`.
std::vector<std::string> ItemsOf(const std::string& text, char sign = ',');

/// Returns true, and sets the value, if the whole text is one finite number.
bool ParseNumber(const std::string& text, double& value);

/// Returns "; did you mean NAME?" with the name that is most like the text; empty if none is near.
std::string NearestOf(const std::string& text, const std::vector<std::string>& names);

/// These read the text behind an option. If it has no meaning, a UsageError names the option.
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
std::vector<double> ToNumbers(const std::string& option, const std::string& text);
/// Returns x0, x1, y0, y1, z0, z1. A side may be open: inf, or -inf.
std::vector<double> ToBox(const std::string& option, const std::string& text);
///@}

#endif
