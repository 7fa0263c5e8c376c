/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_compact_h
#define mcor_compact_h

/* Compact contours: merges vertices of one lattice node, and corrects them. See mcor_compact.c. */

#include "mcor_internal.h"
#include "mcor_parallel.h"

#include <stdatomic.h>

/* Merges vertices of the surface of the current iso value, and corrects the merged vertices. Call
 * this after trimming and capping. Vertices that trimming or capping made stay where they are. */
mcor_status mcor_compact(mcor_context* context);

/* MCOR_COMPACT_RING: vertices in a box depend on cells up to this many cells away from the box. It
 * is a sum: whether a vertex is merged depends on 4 cells; each round, in which bad merged vertices
 * are taken apart again, on 2; whether a vertex moves, on 4; normals of triangles, on 1. */
#define MCOR_COMPACT_ROUNDS 2
#define MCOR_COMPACT_RING (2 * MCOR_COMPACT_ROUNDS + 9)

/* ---- Private to the module ---- */

/* This key, in place of a node's key, marks a vertex that is neither merged nor moved. */
#define MCOR_FROZEN UINT64_MAX

/* State of a bunch of vertices, see below. */
enum
{
  MCOR_BUNCH_APART,  /* its vertices stay */
  MCOR_BUNCH_UNSURE, /* stays apart, too, unless mcor_choose_slice chooses it */
  MCOR_BUNCH_MERGED,
  MCOR_BUNCH_BAD /* is merged, but is to be taken apart */
};

/* A vertex before merging. A bunch is a set of vertices that belong to one lattice node and are
 * joined by edges of triangles; the set's first vertex stands for it. A vertex that is joined to no
 * other is a bunch by itself, and stays apart. */
typedef struct mcor_bunch_vertex
{
  uint64_t key;                /* the lattice node that the vertex belongs to, or MCOR_FROZEN */
  _Atomic int32_t first, next; /* its bunch's first vertex; another vertex of the bunch, or -1 */
  int32_t star;                /* of a bunch: first corner of its list, see `before`; -1: none */
  int32_t now;        /* the present place in the mesh of the vertex, or of its merged bunch */
  atomic_uchar state; /* of a bunch */
  atomic_bool wide; /* the vertex, or its merged bunch, may move: it is a sliver's widest corner */
  bool held;        /* keys of cuts refer to the vertex: it may merge, but does not move alone */
  bool leans;       /* of a bunch: if a bunch beside it is taken apart, so is this bunch */
} mcor_bunch_vertex;

/* A vertex of the mesh. Its position is in whole units of 2^-MCOR_POINT_FIX edges of the smallest
 * cubes. So sums of positions do not depend on the order of the terms, and the difference of two
 * positions stays the same if both points move by a period. */
#define MCOR_POINT_FIX 30
typedef struct mcor_point
{
  int64_t at[3];
  cl_int node[4];
  int32_t replaces; /* of an appended vertex: the vertex that it replaces, see mcor_compact.c */
  float uphill[3];  /* unit gradient, or 0 without a gradient */
  bool missed;      /* the correction did not bring the vertex onto the surface */
} mcor_point;

/* A vertex to correct; the line on which it moves begins at `at`. vertex: its number or, for a
 * merged bunch, the number of the bunch's first vertex. */
typedef struct mcor_start
{
  int64_t at[3];
  int32_t vertex, last; /* last: its place in the mesh before the correction */
  double worst;         /* the greatest badness of the triangles around that place */
} mcor_start;

typedef struct mcor_bunches
{
  mcor_context* context;
  int corners;    /* 3: of a triangle; 2: of a line */
  double edge[3]; /* lengths of the lattice's edges, in cubes */
  /* The mesh before merging. */
  int march_count, vertex_count, triangle_count;
  cl_int* triangles;     /* [triangle_count][3] */
  mcor_bunch_vertex* of; /* [vertex_count] */
  /* [triangle_count][3]. Corners are numbered 3 * triangle + corner. For each bunch, a linked list
   * has one corner of each triangle around the bunch. The list begins at the corner `star` of the
   * bunch. before[i] is the corner that follows corner i in the list; -1: the list ends. */
  int32_t* before;
  mcor_point* points; /* [point_room], of which point_count are the mesh's vertices */
  size_t point_room;
  int point_count;
  MCOR_LIST(mcor_start) starts;
  /* Views of the mesh's buffers, which loops over vertices read or write. But in mcor_add_vertices,
   * `node` and `offset` are arrays of the appended vertices, and `offset` (real [][4]) tells where
   * the correction of each vertex begins. */
  void *node, *offset, *linear, *gradient, *ends;
  /* Along each axis, in cubes: the lower and upper side that caps close, then the lower and upper
   * side of the period. Vertices on these sides stay. -1: no such side. */
  int side[3][4];
  cl_ulong* cells; /* [triangle_count] if mcor_follows_cells, else NULL */
  cl_int* pairs;   /* of vertices: one that is replaced, then the one that replaces it */
  /* For each slice of the triangles: its first triangle, and how many of its triangles are left.
   * These stand at the front of the slice. */
  int64_t slice_first[MCOR_SLICES], slice_left[MCOR_SLICES];
} mcor_bunches;

static inline bool mcor_is_merged(const mcor_bunches* bunches, int32_t v)
{
  const mcor_bunch_vertex* first = &bunches->of[bunches->of[v].first];
  return atomic_load_explicit(&first->state, memory_order_relaxed) >= MCOR_BUNCH_MERGED;
}

static inline void mcor_set_state(const mcor_bunches* bunches, int32_t v, int state)
{
  atomic_store_explicit(
    &bunches->of[bunches->of[v].first].state, (unsigned char)state, memory_order_relaxed);
}

/* Returns v or, if v is merged, its bunch's first vertex, which stands for the merged vertex. */
static inline int32_t mcor_stand_in(const mcor_bunches* bunches, int32_t v)
{
  return mcor_is_merged(bunches, v) ? bunches->of[v].first : v;
}

/* Finds the places that the corners of triangle or line t have in the mesh after merging. Returns
 * whether these places differ; if not, the triangle or line vanishes. */
static inline bool mcor_places_of(const mcor_bunches* bunches, int64_t t, int32_t place[3])
{
  for (int c = 0; c < 3; ++c)
  {
    place[c] = bunches->of[bunches->triangles[3 * t + c]].now;
  }
  return place[0] != place[1] &&
    (bunches->corners == 2 || (place[1] != place[2] && place[2] != place[0]));
}

/* Sets the place in the mesh of vertex v. If v is the first vertex of a merged bunch, sets the
 * place of all vertices of the bunch. */
static inline void mcor_set_place(const mcor_bunches* bunches, int32_t v, int32_t place)
{
  for (int32_t w = v; w >= 0; w = mcor_is_merged(bunches, v) ? bunches->of[w].next : -1)
  {
    bunches->of[w].now = place;
  }
}

/* mcor_compact.c. Appends to the mesh a vertex for each element of `starts`, and corrects it. */
mcor_status mcor_add_vertices(mcor_bunches* bunches);

/* mcor_compact_bunch.c. Finds the bunches. First merges each bunch that can be merged both if all
 * other bunches are merged and if none is. Then merges each bunch that can be merged only while
 * some of these first bunches are merged; it `leans` on them. Fills `starts` with the merged
 * bunches. */
mcor_status mcor_find_bunches(mcor_bunches* bunches);

/* mcor_compact_face.c. mcor_take_apart takes apart merged bunches that did not reach the surface,
 * or that turn triangles over. mcor_move_slivers moves vertices of slivers. */
mcor_status mcor_take_apart(mcor_bunches* bunches);
mcor_status mcor_move_slivers(mcor_bunches* bunches);

#endif
