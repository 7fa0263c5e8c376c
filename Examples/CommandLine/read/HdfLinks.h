// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef HdfLinks_h
#define HdfLinks_h

#include <string>

/// Throws std::runtime_error where an HDF5 file points to other files, by links, external storage or
/// virtual data sets: it could name any file of the reader's, whose bytes would come out as an array.
/// One that is no HDF5 passes.
void RefuseHdfLinks(const std::string& file);

#endif
