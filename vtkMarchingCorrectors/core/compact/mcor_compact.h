/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_compact_h
#define mcor_compact_h

/* Compact contours: correction of a mesh whose vertices of one lattice node are merged. See
 * mcor_compact.c. */

#include "mcor_internal.h"

#include <stdatomic.h>

/* Merges the vertices of the iso value under way, and corrects what is merged. Where the surface is
 * neither trimmed nor capped this takes the place of the correction; elsewhere it comes after caps,
 * whose borders stay as they are. */
bool mcor_compacts_late(const mcor_context* context);
mcor_status mcor_compact(mcor_context* context);

/* A vertex depends on cells so far away, which a box has as its ring: whether it is merged on four,
 * and on two more with each round of taking bunches apart; then there are normals of triangles. */
#define MCOR_COMPACT_ROUNDS 2
#define MCOR_COMPACT_RING (2 * MCOR_COMPACT_ROUNDS + 5)

/* ---- Private to the module ---- */

/* The axis of a vertex that is none on an edge, but merged: its node is that of its bunch. */
#define MCOR_MERGED_AXIS 3

/* What is done with a bunch. */
enum
{
  MCOR_BUNCH_APART,   /* its vertices stay */
  MCOR_BUNCH_CLASHES, /* may not be merged along with some other one */
  MCOR_BUNCH_FRESH,   /* taken apart in this round */
  MCOR_BUNCH_MERGED,  /* from here on they are */
  MCOR_BUNCH_LEANING, /* may not stay merged where one beside it is taken apart */
  MCOR_BUNCH_BAD      /* is to be taken apart */
};

/* The mesh as it was, and its bunches: vertices that belong to one lattice node and that edges of
 * triangles join. Most vertices are in one; the first stands for it. A vertex in no bunch counts as
 * one that stays apart. */
typedef struct mcor_bunches
{
  mcor_context* context;
  bool late;   /* see mcor_compacts_late */
  int corners; /* of a triangle that differ: 2 of one that stands for a line */
  int march_count, vertex_count, triangle_count; /* of the mesh as it was */
  int cut_first[MCOR_TREE_LEVEL_LIMIT + 2];      /* its level_first[1] */
  cl_int level_end[MCOR_TREE_LEVEL_LIMIT + 1];   /* where marched triangles of each level end */
  cl_int* node;                                  /* [vertex_count][4] */
  void *ends, *offset; /* real [march_count][2]; [vertex_count][4], where late */
  mcor_buffer corner_buffer, cell_buffer;
  void *triangles, *cells; /* their views */
  uint64_t* key;           /* [vertex_count]: the lattice node that a vertex belongs to */
  int32_t *first, *next;   /* [vertex_count]: first vertex of the bunch; next one, or -1 */
  int32_t *star, *before;  /* by bunch, the last of its triangles' corners; [3 triangle_count]: the
                              one before, or -1 */
  atomic_uchar* state;     /* [vertex_count], by bunch */
  uint8_t* leans; /* [vertex_count], by bunch: whether one that is not sure can be merged */
  struct mcor_sorted_bunch* sorted; /* that were merged at first, as their vertices are sorted */
  int sorted_count;
  uint8_t* held; /* [vertex_count]: the keys of cuts need the vertex, even where it is merged */
  /* [2 vertex_count]: the mesh's vertices: v, or -1 - first of a merged bunch; [vertex_count]:
   * where a vertex is, and, by first vertex, a merged bunch. */
  int32_t *order, *place, *merged_place;
} mcor_bunches;

static inline const cl_int* mcor_marched_node(const mcor_bunches* bunches, int32_t v)
{
  return bunches->node + 4 * (int64_t)v;
}

static inline int mcor_state_of(const mcor_bunches* bunches, int32_t first)
{
  return atomic_load_explicit(&bunches->state[first], memory_order_relaxed);
}

static inline void mcor_set_state(const mcor_bunches* bunches, int32_t first, int state)
{
  atomic_store_explicit(&bunches->state[first], (unsigned char)state, memory_order_relaxed);
}

static inline bool mcor_is_merged(const mcor_bunches* bunches, int32_t first)
{
  return mcor_state_of(bunches, first) >= MCOR_BUNCH_MERGED;
}

/* Where the mesh has what has become of vertex v. */
static inline int32_t mcor_place_of(const mcor_bunches* bunches, int32_t v)
{
  const int32_t first = bunches->first[v];
  return mcor_is_merged(bunches, first) ? bunches->merged_place[first] : bunches->place[v];
}

/* mcor_compact_bunch.c. Finds the bunches; merges those that can be, whatever becomes of the
 * others. */
mcor_status mcor_find_bunches(mcor_bunches* bunches);

#endif
