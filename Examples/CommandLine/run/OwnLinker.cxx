// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

#include "OwnLinker.h"

#include "vtkMarchingCorrectors.h"

#include <cstdlib>
#include <string>

#include <dlfcn.h>
#include <unistd.h>

//------------------------------------------------------------------------------
void UseOwnLinker()
{
  Dl_info info = {};
  if (dladdr(reinterpret_cast<const void*>(&vtkMarchingCorrectors::New), &info) == 0 ||
    !info.dli_fname)
  {
    return;
  }
  const std::string library = info.dli_fname;
  const std::string folder =
    library.substr(0, library.rfind('/') + 1) + "marching-correctors-linker";
  if (folder.front() == '/' && access((folder + "/ld").c_str(), X_OK) == 0)
  {
    setenv("COMPILER_PATH", folder.c_str(), 0);
  }
}
