/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_adaptive_h
#define mcor_adaptive_h

/* Adaptive cubes: what takes the place of seeds, and what other phases see of it. Vertices are on
 * edges of their level's lattice: node, offset, gradient and correction are in its cells, 2^level cubes. */

#include "mcor_internal.h"

/* Whether this call's cubes are of several levels. */
static inline bool mcor_is_adaptive(const mcor_context* context)
{
  return context->lattice.top > 0;
}

/* Kernel arguments of MCOR_LEAF_PARAMS and MCOR_PLAIN_PARAMS. */
#define MCOR_LEAF_ARGS(c)                                                                          \
  MCOR_INT((c)->adaptive.count), MCOR_INT(mcor_is_plane(c)), MCOR_BUFFER(&(c)->adaptive.finer),    \
    MCOR_BUFFER(&(c)->adaptive.tables), MCOR_BUFFER(&(c)->bricks.now.above),                       \
    MCOR_BUFFER(&(c)->bricks.now.valid)
#define MCOR_PLAIN_ARGS(c)                                                                         \
  MCOR_INT(mcor_is_adaptive(c)), MCOR_BUFFER(&(c)->bricks.plain), MCOR_BUFFER(&(c)->bricks.leaf_of)

/* Vertices on lattice edges, of the trim boundary, or both. */
enum
{
  MCOR_ON_EDGES = 1,
  MCOR_ON_BOUNDARY = 2,
  MCOR_ALL_VERTICES = 3
};
/* Launches what evaluates the field at vertices: level by level, each seen in its cells. The kernel takes
 * MCOR_GRID_PARAMS, groups, nodes, and up to MCOR_VERTEX_ARGS more. */
#define MCOR_VERTEX_ARGS 32
#define MCOR_LAUNCH_AT_VERTICES(context, vertices, name, ...)                                      \
  mcor_launch_at_vertices(context, vertices, name, (const mcor_arg[]){ __VA_ARGS__ },              \
    sizeof((const mcor_arg[]){ __VA_ARGS__ }) / sizeof(mcor_arg))
mcor_status mcor_launch_at_vertices(
  mcor_context* context, int vertices, const char* name, const mcor_arg* more, size_t count);

/* From now on MCOR_GRID_ARGS are in cells of a level. */
mcor_status mcor_view_level(mcor_context* context, int level);

/* Work-items [first, first + count) of a heavy loop. On a CPU, where they are launched at once, so many that
 * they take some 0.1 s, as far as one does not take longer:
 *
 *   mcor_span span = { .end = count };
 *   MCOR_TRY(mcor_next_span(context, &span));
 *   while (span.count > 0)
 *     ... MCOR_INT(span.first), MCOR_INT(span.count) ...
 *     MCOR_TRY(mcor_next_span(context, &span)); */
typedef struct mcor_span
{
  int first, count, end;
  double begin; /* when it began */
} mcor_span;

mcor_status mcor_next_span(mcor_context* context, mcor_span* span);

/* In place of mcor_select_seeds: the leaves where there may be surface, with their nodes' values. */
mcor_status mcor_select_leaves(mcor_context* context, const mcor_input* input);
void mcor_release_adaptive(mcor_context* context);

/* mcor_adaptive_seed.c. What is known of the nodes of all leaves, while slots are made. */
typedef struct mcor_leaf_nodes
{
  mcor_buffer value, weight; /* of the leaves that are evaluated, in their order */
  mcor_buffer place;         /* int, of each leaf: where these begin */
  int count, room;           /* evaluated leaves, and for how many there is room */
  mcor_buffer part_value,
    part_weight;      /* of all leaves of a part, before it is known which are evaluated */
  mcor_buffer counts; /* int: 1 where a leaf of the part is */
} mcor_leaf_nodes;

/* Takes the tree to the device. */
mcor_status mcor_write_tree(mcor_context* context);
/* Finds the leaves that may have surface: adaptive.count, cells, finer. found: their nodes' values are kept
 * there; NULL: they are not evaluated. */
mcor_status mcor_choose_leaves(mcor_context* context, mcor_leaf_nodes* found);
/* Takes over to the slots what was found. */
mcor_status mcor_take_leaf_nodes(mcor_context* context, const mcor_leaf_nodes* found);

/* The used cells that no finer ones touch. */
static inline const mcor_buffer* mcor_plain_used(const mcor_context* context)
{
  return mcor_is_adaptive(context) ? &context->mesh.plain_used : &context->mesh.used;
}

#endif
