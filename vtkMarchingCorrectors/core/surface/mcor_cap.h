/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cap_h
#define mcor_cap_h

/* Caps close the surface at the sides of a period or box, see mcor_cap_make.c. Filled regions in
 * two dimensions use the nodes and points declared here, too. */

#include "mcor_plane.h"
#include "mcor_table.h"

/* Boundary flag of vertices that only caps have. */
#define MCOR_CAP_FLAG 8

/* Adds the caps to the trimmed mesh. */
mcor_status mcor_cap(mcor_context* context);

/* Packs a node, or three other numbers below 2^21, into a key. The coordinates of a surface's nodes
 * are below MCOR_NODE_LIMIT, which is 2^21. */
static inline uint64_t mcor_cap_key(const cl_int node[3])
{
  return (uint64_t)node[0] | (uint64_t)node[1] << 21 | (uint64_t)node[2] << 42 | UINT64_C(1) << 63;
}

/* ---- mcor_cap_points.c: the field at points ---- */

/* A batch of points at which the field is wanted, and the field there. */
#define MCOR_CAP_BATCH (1 << 18)
typedef struct mcor_cap_points mcor_cap_points;
typedef void (*mcor_take_cap_point)(
  const mcor_context* context, const mcor_cap_points* points, int64_t i, void* data);
struct mcor_cap_points
{
  int count;
  cl_int* node;             /* [MCOR_CAP_BATCH][4] */
  void* offset;             /* real [MCOR_CAP_BATCH][4] */
  int64_t* to;              /* [MCOR_CAP_BATCH]: the caller's number of each point */
  mcor_take_cap_point take; /* called with each point once it is evaluated */
  void* data;               /* for `take` */
  void *value, *gradient, *weight, *eigenvalue; /* mapped while points are taken */
  mcor_field_points on_device;
  mcor_buffer eigenvalues;
};

/* Adds a point to the batch, at an offset (NULL: 0) from a node. to: the caller's number of the
 * point, for `take`. Evaluates the batch if it is full. In a new batch, all members are zero,
 * except for `take` and `data`. */
mcor_status mcor_add_cap_point(mcor_context* context, mcor_cap_points* points, const cl_int node[3],
  const double offset[3], int64_t to);
/* Evaluates the points of the last, unfilled batch, and frees the batch. Returns `status` or, if
 * `status` is MCOR_OK, the first failure. */
mcor_status mcor_end_cap_points(mcor_context* context, mcor_cap_points* points, mcor_status status);
/* Returns the trim margin of point i: above 0 if the point remains after trimming. */
double mcor_cap_margin(const mcor_context* context, const mcor_cap_points* points, int64_t i);
bool mcor_cap_is_valid(const mcor_context* context, const mcor_cap_points* points, int64_t i);

/* A vertex that only a cap has, or a point of a filled region. */
typedef struct mcor_cap_vertex
{
  cl_int node[3];
  int32_t band, number; /* in a filled region: its band, and the number that triangles use */
  double offset[3];
  uint64_t key[2]; /* in a cap: its first square, and the number of the look-up that made it */
  uint8_t flag;    /* the surface's flag: MCOR_CAP_FLAG; for cuts 2, or 1 if they are exact */
} mcor_cap_vertex;

/* Appends vertices to the mesh, and evaluates the field at them. */
mcor_status mcor_append_cap_vertices(
  mcor_context* context, const mcor_cap_vertex* vertices, int64_t count);
void mcor_end_caps(mcor_context* context);
/* Whether vertex v of the mesh belongs only to caps. */
static inline bool mcor_is_cap(const mcor_context* context, int64_t v)
{
  return v >= context->mesh.cap_first;
}

/* ---- mcor_cap_nodes.c: the nodes where caps may be ---- */

/* Return where corner k of a square is, 0 or 1 along the square's two axes. Side k goes from corner
 * k to the next corner. */
static inline int mcor_corner_u(int k)
{
  return (k + 1) >> 1 & 1;
}
static inline int mcor_corner_v(int k)
{
  return k >> 1;
}

/* A brick with nodes on a side of a period or box, or with nodes one further in. Its masks have a
 * bit for each node of the brick, see MCOR_BRICK. */
typedef struct mcor_cap_brick
{
  uint64_t key;  /* must be the first member; orders bricks by the side's second axis, then by its
                 * first */
  cl_int at[3];  /* in bricks */
  int32_t up[4]; /* numbers of this brick and of the bricks up from it, bits: along the side's first
                  * axis, along the second; 0: none */
  int32_t inner; /* number of the brick that has the nodes one further in; 0: none */
  bool is_known; /* marching has evaluated its nodes */
  cl_ulong above, valid;
  /* Masks in which a cell or face has its lowest node's bit. used: the used cells. joined: the
   * side's ambiguous faces whose nodes above the iso value are joined. */
  cl_ulong used, joined;
} mcor_cap_brick;

/* Nodes of a side have numbers MCOR_SIDE_NODES * brick + 0 to 15. Brick 0 stands for all bricks
 * that no particle reaches. */
#define MCOR_SIDE_NODES (MCOR_BRICK * MCOR_BRICK)
typedef struct mcor_cap_nodes
{
  int axis, upper;  /* upper: 1 on the upper side of the axis, else 0 */
  int plane, inner; /* coordinates along the axis of the side's nodes, and of the nodes one further
                     * in */
  int across[2];    /* the other two axes, so that across[0], across[1], axis are right-handed */
  int range[3][2];  /* first and last node along each axis */
  mcor_table index; /* numbers of bricks by position */
  MCOR_LIST(mcor_cap_brick) bricks; /* bricks on the side come first */
  int64_t side_count, node_count;   /* numbers of bricks and nodes on the side */
  double* margin;                   /* [node_count], trim margins of nodes above */
  double* value; /* [node_count], the field at nodes, if filled regions want it; else NULL */
} mcor_cap_nodes;

/* Returns a node's bit in the masks of its brick. The node has coordinate `along` on the axis of
 * the side's normal. Its other two coordinates are those of the side's node number `at`. */
static inline int mcor_side_bit(const mcor_cap_nodes* nodes, int along, int64_t at)
{
  return (along & 3) << 2 * nodes->axis | (int)(at & 3) << 2 * nodes->across[0] |
    (int)(at >> 2 & 3) << 2 * nodes->across[1];
}

/* Finds the position of node number `at` of a side. */
static inline void mcor_cap_node(const mcor_cap_nodes* nodes, int64_t at, cl_int node[3])
{
  const cl_int* brick = nodes->bricks.of[at / MCOR_SIDE_NODES].at;
  node[nodes->axis] = nodes->plane;
  node[nodes->across[0]] = brick[nodes->across[0]] * MCOR_BRICK + (cl_int)(at & 3);
  node[nodes->across[1]] = brick[nodes->across[1]] * MCOR_BRICK + (cl_int)(at >> 2 & 3);
}

/* Returns the number of corner k of the square with lowest node `at`. */
static inline int64_t mcor_corner_index(const mcor_cap_nodes* nodes, int64_t at, int k)
{
  const int64_t u = (at & 3) + mcor_corner_u(k), v = (at >> 2 & 3) + mcor_corner_v(k);
  const int32_t brick = nodes->bricks.of[at / MCOR_SIDE_NODES].up[(u >> 2) | (v >> 2) << 1];
  return (int64_t)brick * MCOR_SIDE_NODES + (u & 3) + MCOR_BRICK * (v & 3);
}

/* mcor_cap_points.c. Returns at which coordinate along an axis, in nodes, a cap closes the lower or
 * (if `upper` is 1) the upper side; -1: there is no such cap. With MCOR_CAP_BOX this is the side of
 * the box (with ranks: of the whole box), else the side of the period. */
int mcor_cap_plane(const mcor_context* context, int axis, int upper);
bool mcor_makes_caps(const mcor_context* context);
/* Whether a cap closes this side of this call's box. */
bool mcor_has_cap_side(const mcor_context* context, int axis, int upper);

/* Finds the bricks of `nodes`. The axes and ranges of `nodes` must be set. Fails if there are too
 * many bricks. iso_value: in the caller's unit. */
mcor_status mcor_find_cap_bricks(mcor_context* context, double iso_value, mcor_cap_nodes* nodes);
/* Copies the masks of the marched bricks to the bricks of `nodes`. */
mcor_status mcor_take_cap_masks(mcor_context* context, mcor_cap_nodes* nodes);
/* Evaluates the field at the nodes that need it: at nodes on the side, or, if is_inner is set, one
 * node further in. */
mcor_status mcor_ask_cap_nodes(mcor_context* context, mcor_cap_nodes* nodes, bool is_inner);
/* Calls `visit` for the squares of all bricks. at, node: number and position of a square's lowest
 * node. */
mcor_status mcor_visit_cap_squares(mcor_context* context, const mcor_cap_nodes* nodes,
  mcor_status (*visit)(void* data, const mcor_cap_nodes* nodes, int64_t at, const cl_int node[3]),
  void* data);
/* Loads the nodes of the lower or upper side of an axis. */
mcor_status mcor_load_cap_side(mcor_context* context, int axis, int upper, mcor_cap_nodes* nodes);
void mcor_free_cap_nodes(mcor_cap_nodes* nodes);

/* ---- mcor_cap_make.c: the squares ---- */

/* Corner of a polygon: its vertex, its place in cubes from the lattice's origin, and its trim
 * margin (above 0: the corner remains). */
typedef struct mcor_cap_corner
{
  int32_t vertex;
  double at[3], margin;
} mcor_cap_corner;

/* Trimming makes cut vertices, and moves each of them along a line. Places on the line go from 0 at
 * one end to 1 at the other end. */
typedef struct mcor_cap_line
{
  int32_t vertex; /* index among the caps' vertices */
  double from[3], to[3];
  double at; /* the cut's place */
  /* A bracket of the root of the trim margin: its ends, the margins there, and which end moved last
   * (-1: none). */
  double end[2], margin[2];
  int last;
  int moves; /* how often the cut has moved */
  bool done;
} mcor_cap_line;

typedef struct mcor_cap_triangle
{
  cl_int corner[3];
} mcor_cap_triangle;

/* The vertices and triangles of caps, or of a filled region. The host collects them here before
 * they are added to the mesh. */
typedef struct mcor_cap_job
{
  mcor_context* context;
  /* For each axis, the indices of the surface's vertices, by the lower node of their lattice edge.
   * A pinched edge has two vertices; its entry is the first one. */
  mcor_table edges[3];
  mcor_table nodes, cuts; /* indices of vertices */
  MCOR_LIST(mcor_cap_vertex) vertices;
  MCOR_LIST(mcor_cap_line) lines; /* cuts in a plane that must be placed exactly */
  MCOR_LIST(mcor_cap_triangle) triangles;
  /* The number of each triangle's square, see mcor_triangle_cell.c. */
  MCOR_LIST(cl_ulong) cells;
  int64_t owned_count;
  /* The square that is being cut: its side, its lowest node, its number, and how many vertices have
   * been looked up for the square. */
  const mcor_cap_nodes* side;
  cl_int lowest[3];
  cl_ulong number;
  uint64_t lookups;
  /* Views of the surface's vertices, and of the keys of its cut edges, which ascend. */
  void *node, *offset, *quantity, *cut_edges;
  double threshold;
} mcor_cap_job;

/* mcor_clip_side makes the corner where trimming cuts the side from corner p to q; mcor_add_clipped
 * adds a polygon. */
typedef mcor_status (*mcor_clip_side)(
  void* data, const mcor_cap_corner* p, const mcor_cap_corner* q, mcor_cap_corner* cut);
typedef mcor_status (*mcor_add_clipped)(void* data, const mcor_cap_corner* corners, int count);
/* Adds what trimming leaves of a polygon: for each run of corners that remain, a polygon of the run
 * and the cuts before and behind it. If all corners remain, the polygon begins with corner `first`.
 * MCOR_POLYGON_MOST: the most corners of a polygon. A band between two iso lines may have the 4
 * nodes of a square and 4 vertices of each line. */
#define MCOR_POLYGON_MOST 12
mcor_status mcor_clip_polygon(const mcor_cap_corner* const corners[], int count, int first,
  mcor_clip_side cut, mcor_add_clipped add, void* data);
/* Finds the cut vertex with this key. If there is none, makes the vertex between two corners, where
 * the trim margin would be 0 if it were linear. In a plane, mcor_place_cap_cuts moves the vertex
 * later. cut->vertex: the vertex's index. */
mcor_status mcor_find_cap_cut(mcor_cap_job* job, uint64_t key, const mcor_cap_corner* low,
  const mcor_cap_corner* high, mcor_cap_vertex vertex, mcor_cap_corner* cut);
/* Moves the cuts in a plane to where the trim margin is 0. */
mcor_status mcor_place_cap_cuts(mcor_cap_job* job);
void mcor_free_cap_job(mcor_cap_job* job);

#endif
