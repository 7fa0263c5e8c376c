// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef HdfLinks_h
#define HdfLinks_h

#include <string>

/// Throws std::runtime_error if an HDF5 file points to other files, by links, external storage or
/// virtual data sets. It could name any file that the reader may open, and its bytes would come out
/// as an array. A file that is no HDF5 passes.
void RefuseHdfLinks(const std::string& file);

#endif
