// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: what to call the blocks of composite data in messages.
 */
#ifndef vtkMarchingCorrectorsBlocks_h
#define vtkMarchingCorrectorsBlocks_h

#include <string>
#include <vector>

class vtkDataObjectTree;

/**
 * "Block 'NAME', index N" of each block that is there, in the order of their iteration: the name of
 * the block, or of what it is a partition of, if there is one, and the flat index that ParaView
 * shows.
 */
std::vector<std::string> vtkMarchingCorrectorsNameBlocks(vtkDataObjectTree* tree);

#endif
