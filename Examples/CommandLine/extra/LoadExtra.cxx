// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Extra.h"

#include <stdexcept>

#include <dlfcn.h>

const Extra& LoadExtra()
{
  // By its name alone it is looked for where this program's other libraries are.
  static void* const library = dlopen(MCOR_EXTRA_LIBRARY, RTLD_NOW | RTLD_GLOBAL);
  static const void* const extra = library ? dlsym(library, "MarchingCorrectorsExtra") : nullptr;
  if (!extra)
  {
    const char* why = dlerror();
    throw std::runtime_error("the part of this program for pictures, .vtkhdf, .stl, .ply and .obj "
                             "files cannot be loaded (" +
      std::string(why ? why : MCOR_EXTRA_LIBRARY) + "); install it again");
  }
  return *static_cast<const Extra*>(extra);
}
