// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the project: takes particles out of a mesh, lists and names the blocks of composite
 * data, and joins the particles of all blocks.
 */
#ifndef vtkSPHBlocks_h
#define vtkSPHBlocks_h

#include "vtkMarchingCorrectorsModule.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkDataObject;
class vtkDataObjectTree;
class vtkPointSet;

/** Whether there are vertices among the cells of the data set, or of one of its blocks. */
VTKMARCHINGCORRECTORS_EXPORT bool vtkSPHHaveVertices(vtkDataObject* data);

/**
 * Returns the particles of a data set, or of each of its blocks, in data of the same class.
 * haveVertices: whether any block of any process has vertices. If so, and a block also has other
 * cells, the block's points without a vertex are nodes of a mesh, and are left out. Cell arrays of vertices
 * become arrays of the vertices' points, unless the points have an array of the same name, or a point
 * that stays has no vertex. Returns the data set itself if nothing changes.
 */
VTKMARCHINGCORRECTORS_EXPORT vtkSmartPointer<vtkDataObject> vtkSPHTakeVertices(
  vtkDataObject* data, bool haveVertices);

/**
 * Lists "Block 'NAME', index N" for each block that is not null, in the order of iteration. A
 * partition without a name has the name of its partitioned data set. A block without any name is
 * "Block index N". N is the flat index that ParaView shows.
 */
std::vector<std::string> vtkSPHNameBlocks(vtkDataObjectTree* tree);

/** Lists the point sets with points: the data set itself, or its blocks. */
std::vector<vtkPointSet*> vtkSPHListPointSets(vtkDataObject* data);

/**
 * Joins the points of all blocks that are point sets, one block after the other, with the point
 * arrays that all of them have (same name and number of components). If the names of some
 * blocks, but not of all, tell of walls, the array MCOR_WALL_BLOCK is 1 for particles of walls. An
 * array that only walls lack is kept, unless it tells the particles' types; its values for the walls
 * mean nothing. If `fluidArray` names a block, see vtkSPHListFluidBlocks(), all other blocks are
 * walls. Field data of all blocks are kept.
 */
VTKMARCHINGCORRECTORS_EXPORT vtkSmartPointer<vtkPointSet> vtkSPHJoinBlocks(
  vtkDataObjectTree* tree, const std::string& fluidArray = "");

/** Returns a warning that names the arrays of blocks that vtkSPHJoinBlocks() did not take; else no text. */
VTKMARCHINGCORRECTORS_EXPORT std::string vtkSPHDescribeLost(
  vtkDataObject* blocks, vtkPointSet* joined);

/** Lists "Block: NAME", to be used as name of the fluid array, for each different name of a block; nothing if there is only one name. */
std::vector<std::string> vtkSPHListFluidBlocks(vtkDataObjectTree* tree);

/**
 * Makes `output` a copy of `tree`, and adds to each block its part of the arrays that a filter has
 * made: the point arrays of `joined` that `before` does not have. Blocks that are no point sets
 * become empty. before: the particles that vtkSPHJoinBlocks() made of `tree`.
 */
void vtkSPHSplitBlocks(
  vtkDataObjectTree* tree, vtkPointSet* before, vtkPointSet* joined, vtkDataObjectTree* output);

/** Returns the latest modification time of the data set and its blocks. */
vtkMTimeType vtkSPHTimeOfBlocks(vtkDataObjectTree* tree);

/** Returns a warning if some of these blocks' names, but not all, tell of walls; else no text. */
std::string vtkSPHFindWalls(const std::vector<std::string>& names);
VTK_ABI_NAMESPACE_END

#endif
