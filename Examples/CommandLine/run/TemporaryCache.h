// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef TemporaryCache_h
#define TemporaryCache_h

#include <string>

/// PoCL builds programs in a folder below the user's home, and has no device where it cannot make
/// one: no home, as of a service, or one that may not be written. Then it gets a temporary folder.
class TemporaryCache
{
public:
  TemporaryCache();
  TemporaryCache(const TemporaryCache&) = delete;
  void operator=(const TemporaryCache&) = delete;

  /// Deletes the folder, if there is one.
  void Remove();

private:
  std::string Folder;
};

#endif
