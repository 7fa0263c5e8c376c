// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef OptionValue_h
#define OptionValue_h

#include <stdexcept>
#include <string>
#include <vector>

/// Wrong usage; what() is one sentence.
class UsageError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// True, and the value, if the whole text is one finite number.
bool ParseNumber(const std::string& text, double& value);

/// What the text behind an option means; a UsageError names the option where it means nothing.
///@{
double ToNumber(const std::string& option, const std::string& text);
double ToPositive(const std::string& option, const std::string& text);
double ToThreshold(const std::string& option, const std::string& text); ///< 0 or greater
int ToCount(const std::string& option, const std::string& text, int smallest);
int ToLevel(const std::string& option, const std::string& text); ///< highest one of adaptive cubes
std::string ToChoice(
  const std::string& option, const std::string& text, const std::vector<std::string>& choices);
/// An array name, or a constant, which must then be greater than 0.
std::string ToQuantity(const std::string& option, const std::string& text);
std::vector<double> ToNumbers(const std::string& option, const std::string& text);
double ToShare(const std::string& option, const std::string& text); ///< of walls; measured: 0
/// x0, x1, y0, y1, z0, z1. A side may be open: inf, or -inf.
std::vector<double> ToBox(const std::string& option, const std::string& text);
/// Three lengths, or six bounds.
std::vector<double> ToPeriod(const std::string& option, const std::string& text);
std::vector<std::string> ToNames(const std::string& option, const std::string& text);
///@}

#endif
