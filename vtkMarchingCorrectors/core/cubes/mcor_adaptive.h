/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_adaptive_h
#define mcor_adaptive_h

/* Adaptive cubes: the interface for other phases. A vertex lies on an edge of its level's lattice.
 * Its node, offset, gradient and correction are in cells of this level, which are 2^level cubes
 * long. */

#include "mcor_internal.h"

static inline bool mcor_is_adaptive(const mcor_lattice* lattice)
{
  return lattice->levels > 1;
}

/* Kernel arguments of MCOR_LEAF_PARAMS. */
#define MCOR_LEAF_ARGS(c)                                                                          \
  MCOR_INT((c)->adaptive.count), MCOR_INT((c)->space.flat), MCOR_BUFFER(&(c)->adaptive.finer),    \
    MCOR_BUFFER(&(c)->adaptive.tables), MCOR_BUFFER(&(c)->bricks.now.above),                       \
    MCOR_BUFFER(&(c)->bricks.now.valid)

/* Which vertices a kernel is launched for: those on lattice edges, those made later (by trimming,
 * capping or merging), or all. */
enum
{
  MCOR_ON_EDGES = 1,
  MCOR_ON_BOUNDARY = 2,
  MCOR_ALL_VERTICES = 3
};
/* Launch a heavy kernel for each level; the kernel then measures lengths in cells of this level. It
 * takes MCOR_GRID_PARAMS, then the arguments that these functions add, then up to MCOR_MORE_ARGS
 * `more`. mcor_launch_at_vertices adds three: the number of groups of vertices, the array of
 * groups, and the vertices' nodes. mcor_launch_by_level adds two for the elements [first[l],
 * end[l]) of level l: the first element, and their number; each element has `items` work-items. */
#define MCOR_MORE_ARGS 32
#define MCOR_LAUNCH_BY_LEVEL(context, name, items, first, end, ...)                                \
  mcor_launch_by_level(context, name, items, first, end, (const mcor_arg[]){ __VA_ARGS__ },        \
    sizeof((const mcor_arg[]){ __VA_ARGS__ }) / sizeof(mcor_arg))
mcor_status mcor_launch_by_level(mcor_context* context, const char* name, int items,
  const int* first, const int* end, const mcor_arg* more, size_t count);
#define MCOR_LAUNCH_AT_VERTICES(context, vertices, name, ...)                                      \
  mcor_launch_at_vertices(context, vertices, name, (const mcor_arg[]){ __VA_ARGS__ },              \
    sizeof((const mcor_arg[]){ __VA_ARGS__ }) / sizeof(mcor_arg))
mcor_status mcor_launch_at_vertices(
  mcor_context* context, int vertices, const char* name, const mcor_arg* more, size_t count);

/* mcor_correct.c. Launches the correction of vertices, level by level. Vertices move along their
 * lattice edges or, with `lines`, along the gradient from the places that their offsets give. */
mcor_status mcor_launch_correction(mcor_context* context, int vertices, bool lines);

/* mcor_leaf.c. Makes the leaves (bricks of cells of one level, see mcor_tree.h), and writes their
 * blocks to the device, unless this is done already. */
mcor_status mcor_begin_leaves(mcor_context* context, const mcor_input* input);
/* Lists the leaves that may have surface. */
mcor_status mcor_choose_leaves(mcor_context* context);
/* Gives slots (places for node values) to the bricks whose nodes the listed leaves need, evaluates
 * these nodes, and finds which leaves the surface passes through. */
mcor_status mcor_complete_leaves(mcor_context* context);
void mcor_release_adaptive(mcor_context* context);

#define MCOR_TREE_ARGS(c)                                                                          \
  MCOR_INT(mcor_is_adaptive(&(c)->lattice)), MCOR_BUFFER(&(c)->bricks.leaves),                     \
    MCOR_BUFFER(&(c)->bricks.beside)

#endif
