// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef OptionTable_h
#define OptionTable_h

#include <functional>
#include <string>
#include <vector>

struct Job;

struct Option
{
  const char* Name;
  const char* Argument; ///< what stands for it in the help; empty: the option has none
  std::string Help;
  std::function<void(Job&, const std::string& option, const std::string& value)> Set;
  bool Repeats = false; ///< whether it may be given more than once
};

/// Lists every option, in the order of the help. An option without a name starts a group.
const std::vector<Option>& AllOptions();

#endif
