// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "HdfLinks.h"

#include "vtk_hdf5.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace
{

const herr_t IsFound = 1;     ///< ends a visit
const long DeepestGroup = 64; ///< a damaged file may hold a circle of groups

/// Whether values of a data set lie in other files.
bool LiesElsewhere(hid_t group, const char* name)
{
  const hid_t data = H5Oopen(group, name, H5P_DEFAULT);
  bool isElsewhere = false;
  if (data >= 0 && H5Iget_type(data) == H5I_DATASET)
  {
    const hid_t list = H5Dget_create_plist(data);
    isElsewhere = H5Pget_layout(list) == H5D_VIRTUAL || H5Pget_external_count(list) > 0;
    H5Pclose(list);
  }
  if (data >= 0)
  {
    H5Oclose(data);
  }
  return isElsewhere;
}

herr_t VisitLink(hid_t root, const char* name, const H5L_info_t* link, void* found)
{
  const bool isInFile = link->type == H5L_TYPE_HARD || link->type == H5L_TYPE_SOFT;
  if (!isInFile || (link->type == H5L_TYPE_HARD && LiesElsewhere(root, name)))
  {
    *static_cast<std::string*>(found) = std::string("its '") + name +
      "' lies in another file, which is not opened; give a file that holds all of its data";
    return IsFound;
  }
  if (std::count(name, name + std::strlen(name), '/') > DeepestGroup)
  {
    *static_cast<std::string*>(found) = "its groups lie too deep in each other; it may be damaged";
    return IsFound;
  }
  return 0;
}

}

void RefuseHdfLinks(const std::string& file)
{
  H5open();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (opened < 0)
  {
    return;
  }
  std::string found;
  const herr_t result =
    H5Lvisit(opened, H5_INDEX_NAME, H5_ITER_NATIVE, VisitLink, static_cast<void*>(&found));
  H5Fclose(opened);
  if (result < 0)
  {
    found = "its groups cannot be listed; it may be damaged";
  }
  if (!found.empty())
  {
    throw std::runtime_error(file + " cannot be read: " + found);
  }
}
