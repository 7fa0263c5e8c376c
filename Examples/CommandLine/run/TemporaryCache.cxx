// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "TemporaryCache.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include <unistd.h>

namespace
{

namespace fs = std::filesystem;

std::string Variable(const char* name)
{
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// Where PoCL keeps its programs; empty where it does not depend on a home.
fs::path CacheOfPocl()
{
  if (!Variable("POCL_CACHE_DIR").empty())
  {
    return "";
  }
  if (!Variable("XDG_CACHE_HOME").empty())
  {
    return fs::path(Variable("XDG_CACHE_HOME")) / "pocl" / "kcache";
  }
  const std::string home = Variable("HOME");
  return home.empty() ? fs::path() : fs::path(home) / ".cache" / "pocl" / "kcache";
}

/// Whether this folder is there, or can be made, and takes new files.
bool IsUsable(fs::path folder)
{
  std::error_code ignored;
  while (!fs::exists(folder, ignored) && folder.has_relative_path())
  {
    folder = folder.parent_path();
  }
  return fs::is_directory(folder, ignored) && access(folder.c_str(), W_OK | X_OK) == 0;
}

}

//------------------------------------------------------------------------------
TemporaryCache::TemporaryCache()
{
  const fs::path cache = CacheOfPocl();
  if (cache.empty() || IsUsable(cache))
  {
    return;
  }
  std::error_code ignored;
  std::string name = (fs::temp_directory_path(ignored) / "marching-correctors-XXXXXX").string();
  if (mkdtemp(&name[0]))
  {
    this->Folder = name;
    setenv("POCL_CACHE_DIR", name.c_str(), 1);
    setenv("MCOR_COMPILER", "", 1); // nobody else is to write there when it is removed
  }
}

//------------------------------------------------------------------------------
void TemporaryCache::Remove()
{
  std::error_code ignored;
  if (!this->Folder.empty())
  {
    fs::remove_all(this->Folder, ignored);
  }
}
