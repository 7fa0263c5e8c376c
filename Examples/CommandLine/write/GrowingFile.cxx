// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "GrowingFile.h"

#include "OutputFile.h"

#include <filesystem>

namespace fs = std::filesystem;

namespace
{

bool IsRegularFile(const std::string& name)
{
  std::error_code error;
  return !fs::exists(name, error) || fs::is_regular_file(name, error);
}

}

GrowingFile::GrowingFile(const std::string& name)
  : Name(name)
  , IsRegular(IsRegularFile(name))
{
}

void GrowingFile::Write(const std::function<std::string()>& text, bool isLast)
{
  const auto begin = Clock::now();
  if (!isLast && (!this->IsRegular || begin < this->Next))
  {
    return;
  }
  WriteOutput(this->Name, text());
  this->Next = Clock::now() + 19 * (Clock::now() - begin);
}
