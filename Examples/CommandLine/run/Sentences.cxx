// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Sentences.h"

#include "SafeText.h"

#include <exception>
#include <new>

std::string FailureOf(const std::function<void()>& work)
{
  try
  {
    work();
    return "";
  }
  catch (const std::bad_alloc&)
  {
    return "host memory ran out";
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
}

void Sentences::Tell(const std::string& kind, const std::string& step, const std::string& sentence)
{
  if (++this->Counts[kind + sentence] == 1)
  {
    Say(kind + step + ": " + sentence);
  }
}

void Sentences::TellCounts() const
{
  for (const auto& [sentence, count] : this->Counts)
  {
    if (count > 1)
    {
      Say(std::to_string(count - 1) + (count == 2 ? " more step: " : " more steps: ") + sentence);
    }
  }
}
