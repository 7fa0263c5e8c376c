// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Sentences_h
#define Sentences_h

#include <functional>
#include <map>
#include <string>

/// Why the work failed, in one sentence; empty if it did not.
std::string FailureOf(const std::function<void()>& work);

/// Says each sentence of many steps once, with the first step's name, and at the end how often it came.
class Sentences
{
public:
  void Tell(const std::string& kind, const std::string& step, const std::string& sentence);
  void TellCounts() const;

private:
  std::map<std::string, int> Counts;
};

#endif
