// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "FilmRecord.h"

#include <cstdlib>
#include <cstring>

namespace
{

void Put(std::string& bytes, const std::string& text)
{
  bytes += std::to_string(text.size()) + ":" + text;
}

/// The next text; false, at the end or where a process ended in the middle of writing one.
bool Take(const std::string& bytes, std::size_t& next, std::string& text)
{
  const std::size_t colon = bytes.find(':', next);
  if (colon == std::string::npos)
  {
    return false;
  }
  const std::size_t size = std::strtoull(bytes.c_str() + next, nullptr, 10);
  if (size > bytes.size() - colon - 1)
  {
    return false;
  }
  text = bytes.substr(colon + 1, size);
  next = colon + 1 + size;
  return true;
}

}

//------------------------------------------------------------------------------
void FilmRecord::Add(const FilmStep& step)
{
  std::string fields, record;
  Put(fields, std::string(reinterpret_cast<const char*>(&step.Time), sizeof(step.Time)));
  for (const std::string& text : { step.Output, step.Error, step.Statistics, step.Setting })
  {
    Put(fields, text);
  }
  Put(record, fields);
  this->File.Append(record);
}

//------------------------------------------------------------------------------
std::vector<FilmStep> FilmRecord::Read() const
{
  const std::string bytes = this->File.Read();
  std::vector<FilmStep> steps;
  std::string record, time;
  for (std::size_t next = 0; Take(bytes, next, record);)
  {
    FilmStep step;
    std::size_t field = 0;
    if (Take(record, field, time) && time.size() == sizeof(step.Time) &&
      Take(record, field, step.Output) && Take(record, field, step.Error) &&
      Take(record, field, step.Statistics) && Take(record, field, step.Setting))
    {
      std::memcpy(&step.Time, time.data(), sizeof(step.Time));
      steps.push_back(step);
    }
  }
  return steps;
}
