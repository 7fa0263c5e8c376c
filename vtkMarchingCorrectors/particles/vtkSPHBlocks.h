// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: blocks of composite data, what to call them in messages, and all their
 * particles as one set.
 */
#ifndef vtkSPHBlocks_h
#define vtkSPHBlocks_h

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkDataObject;
class vtkDataObjectTree;
class vtkPointSet;

/**
 * "Block 'NAME', index N" of each block that is there, in the order of their iteration: the name of
 * the block, or of what it is a partition of, if there is one, and the flat index that ParaView
 * shows.
 */
std::vector<std::string> vtkSPHNameBlocks(vtkDataObjectTree* tree);

/**
 * The data set itself, or the blocks, that are point sets with points.
 */
std::vector<vtkPointSet*> vtkSPHListPointSets(vtkDataObject* data);

/**
 * The points of all blocks that are point sets, one block after the other, with the point arrays
 * that all of them have: same name, type and number of components. Where the names of some blocks, but
 * not of all, tell of walls, there is an array MCOR_WALL_BLOCK too, 1 for particles of these; and what these
 * lack that all others have is there, with a value that means nothing. A fluid array that is a block, see
 * vtkSPHListFluidBlocks(), makes all others walls. Field data are those of all.
 */
vtkSmartPointer<vtkPointSet> vtkSPHJoinBlocks(
  vtkDataObjectTree* tree, const std::string& fluidArray = "");

/**
 * "Block: NAME" of each name that blocks have, if there are several: what stands for a fluid array.
 */
std::vector<std::string> vtkSPHListFluidBlocks(vtkDataObjectTree* tree);

/**
 * Gives the blocks, as they are, the point arrays that `joined`, made of vtkSPHJoinBlocks(), has and
 * `before` has not.
 */
void vtkSPHSplitBlocks(
  vtkDataObjectTree* tree, vtkPointSet* before, vtkPointSet* joined, vtkDataObjectTree* output);

/** The latest time of the data set, and of all that it is made of. */
vtkMTimeType vtkSPHTimeOfBlocks(vtkDataObjectTree* tree);

/**
 * A sentence where the name of a block, but not those of all, tells of walls, and blocks are contoured
 * by themselves. Empty otherwise.
 */
std::string vtkSPHFindWalls(const std::vector<std::string>& names);
VTK_ABI_NAMESPACE_END

#endif
