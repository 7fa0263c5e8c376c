// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Advice_h
#define Advice_h

#include <string>

/// A sentence of the filters, whose advice is the same for all interfaces, in the words of this one: with its options.
std::string WithOptions(const std::string& sentence);

/// The sentence with some words replaced, if it has them.
std::string Reworded(
  const std::string& sentence, const std::string& words, const std::string& instead);

#endif
