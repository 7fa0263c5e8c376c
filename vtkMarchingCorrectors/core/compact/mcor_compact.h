/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_compact_h
#define mcor_compact_h

/* Compact contours: merges vertices of one lattice node, and corrects them. See mcor_compact.c. */

#include "mcor_internal.h"

#include <stdatomic.h>
#include <string.h>

/* Merges vertices of the current iso value, after trimming and caps, whose borders stay as they
 * are, and corrects the merged vertices. */
mcor_status mcor_compact(mcor_context* context);

/* Vertices in a box depend on this number of cells around it: four decide whether a vertex is
 * merged, two more for each round of taking bunches apart, four whether it moves, and one the
 * normals of triangles. */
#define MCOR_COMPACT_ROUNDS 2
#define MCOR_COMPACT_RING (2 * MCOR_COMPACT_ROUNDS + 9)

/* ---- Private to the module ---- */

/* A vertex that stays has this key in place of its node. */
#define MCOR_FROZEN UINT64_MAX

/* Axis of a merged vertex, which is not on an edge. Its node is its bunch's node. */
#define MCOR_MERGED_AXIS 3

/* State of a bunch. */
enum
{
  MCOR_BUNCH_APART,   /* its vertices stay */
  MCOR_BUNCH_CLASHES, /* may be merged only if another bunch stays apart */
  MCOR_BUNCH_FRESH,   /* was taken apart in this round */
  MCOR_BUNCH_MERGED,  /* this and the following states are merged */
  MCOR_BUNCH_LEANING, /* must be taken apart if a sure bunch beside it is */
  MCOR_BUNCH_BAD      /* is to be taken apart */
};

typedef struct mcor_point mcor_point; /* mcor_compact_face.c */

/* The mesh before merging, and its bunches. A bunch is a set of vertices that belong to one lattice
 * node and are joined by edges of triangles. Most vertices are in bunches. The first vertex stands
 * for its bunch. A vertex in no bunch counts as a bunch that stays apart. */
typedef struct mcor_bunches
{
  mcor_context* context;
  int corners; /* 3: of a triangle; 2: of a line */
  int march_count, vertex_count, triangle_count; /* numbers of the mesh before merging */
  int cut_count;                                 /* number of cut vertices */
  int cut_first[MCOR_TREE_LEVEL_LIMIT + 2];      /* the mesh's level_first[1] */
  uint8_t* memory;                               /* memory of the arrays below */
  cl_int* node;                                  /* [vertex_count][4] */
  cl_ulong* cut;                                 /* [cut_count]: the mesh's cut_edges */
  void *ends, *offset;   /* real [march_count][2]; real [vertex_count][4] */
  cl_int* triangles;     /* [triangle_count][3] */
  cl_ulong* cells;       /* [triangle_count], if mcor_follows_cells */
  uint64_t* key;         /* [vertex_count]: the lattice node that the vertex belongs to */
  int32_t *first, *next; /* [vertex_count]: the bunch's first vertex; its next vertex, or -1 */
  int32_t *star,
    *before; /* by bunch: a corner of its last triangle; by corner: a corner of the bunch's
              * triangle before, or -1 */
  atomic_uchar* state; /* [vertex_count], by bunch */
  uint8_t* leans;      /* [vertex_count], by bunch: it is not sure, but can be merged */
  struct mcor_sorted_bunch*
    sorted; /* bunches that were merged at first, in the order of vertices */
  int sorted_count;
  mcor_point* points; /* [point_room]: the mesh's vertices; point_count of them exist */
  int point_count;
  int64_t point_room;
  int round;          /* number of the round in which bunches are taken apart */
  atomic_int bad;     /* whether this round has found a bunch to take apart */
  int32_t* now;       /* [vertex_count]: place of a vertex in the mesh, see mcor_place_of */
  atomic_uchar* wide; /* [vertex_count]: whether the vertex is the widest corner of a sliver */
  uint8_t* held;      /* [vertex_count]: keys of cuts refer to the vertex, even if it is merged */
  /* order: [2 vertex_count], the mesh's vertices in order: v, or -1 - the first vertex of a merged
   * bunch; place: [vertex_count], of vertices; merged_place: of merged bunches, by first vertex. */
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

/* Whether a triangle, or line, is left, because its corners differ. */
static inline bool mcor_is_left(const int32_t corner[3], int corners)
{
  return corner[0] != corner[1] &&
    (corners == 2 || (corner[1] != corner[2] && corner[2] != corner[0]));
}

/* Returns the place in the mesh of vertex v, or of the merged vertex that replaced it. */
static inline int32_t mcor_place_of(const mcor_bunches* bunches, int32_t v)
{
  const int32_t first = bunches->first[v];
  return mcor_is_merged(bunches, first) ? bunches->merged_place[first] : bunches->place[v];
}

/* Return the vertex of an entry of `order`, for a merged bunch its first vertex; and the entry's
 * place. */
static inline int32_t mcor_vertex_of(int32_t entry)
{
  return entry < 0 ? -1 - entry : entry;
}

static inline int32_t* mcor_place_in(const mcor_bunches* bunches, int32_t entry)
{
  return (entry < 0 ? bunches->merged_place : bunches->place) + mcor_vertex_of(entry);
}

/* Finds the corners of a triangle in the mesh. Returns whether it is left. */
static inline bool mcor_places_of(const mcor_bunches* bunches, int64_t t, int32_t place[3])
{
  const cl_int* corner = bunches->triangles + 3 * t;
  for (int c = 0; c < 3; ++c)
  {
    place[c] = bunches->now[corner[c]];
  }
  return mcor_is_left(place, bunches->corners);
}

/* Finds the node of an entry of `order`; for a bunch, the node of its merged vertex. */
static inline void mcor_entry_node(const mcor_bunches* bunches, int32_t entry, cl_int node[4])
{
  const int32_t v = mcor_vertex_of(entry);
  const uint64_t key = bunches->key[v];
  memcpy(node, bunches->node + 4 * (int64_t)v, 4 * sizeof *node);
  for (int a = 0; a < 3 && entry < 0; ++a)
  {
    node[a] = (cl_int)(key >> 21 * a & 0x1fffff);
  }
  node[3] =
    entry < 0 ? node[3] >> MCOR_LEVEL_SHIFT << MCOR_LEVEL_SHIFT | MCOR_MERGED_AXIS : node[3];
}

/* mcor_compact.c. Appends the vertices in `order` to the mesh, and corrects them on lines. starts:
 * where the lines begin, in edges from the nodes; NULL: at the means of bunches. */
mcor_status mcor_add_vertices(mcor_bunches* bunches, const double (*starts)[3], int count);

/* mcor_compact_face.c. mcor_find_places finds the current places of vertices (`now`), mcor_find_bad
 * the merged bunches to take apart; mcor_move_slivers moves vertices of slivers. */
mcor_status mcor_find_places(mcor_bunches* bunches);
mcor_status mcor_find_bad(mcor_bunches* bunches);
mcor_status mcor_move_slivers(mcor_bunches* bunches);

/* mcor_compact_bunch.c. Finds the bunches, and which of them may be merged, independently of what
 * happens to other bunches. */
mcor_status mcor_find_bunches(mcor_bunches* bunches);

#endif
