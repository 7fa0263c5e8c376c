/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cap_h
#define mcor_cap_h

/* Caps: what closes the surface at the sides of a period or a box, see mcor_cap_make.c. Filling in two dimensions
 * uses the same nodes and points. */

#include "mcor_plane.h"

/* Boundary flag of vertices that caps alone have. */
#define MCOR_CAP_FLAG 8

/* Whether the free surface is closed where it ends at solids, see mcor_cap_wall.c. */
static inline bool mcor_caps_walls(const mcor_context* context)
{
  return context->run.options->capping && context->run.options->field == MCOR_WEIGHT_SUM &&
    !mcor_is_plane(context) && mcor_fluid_share(context) > 0;
}

/* Adds the caps to the trimmed mesh. */
mcor_status mcor_cap(mcor_context* context);

/* The key of a node, or of anything with three such numbers; an axis has at most 2^20 + 64 nodes. */
static inline uint64_t mcor_cap_key(const cl_int node[3])
{
  return (uint64_t)node[0] | (uint64_t)node[1] << 21 | (uint64_t)node[2] << 42 | UINT64_C(1) << 63;
}

/* ---- mcor_cap_points.c: the field at points ---- */

/* Where the field is asked for, up to so many points at a time, and what it is there. */
#define MCOR_CAP_BATCH (1 << 18)
typedef struct mcor_cap_points mcor_cap_points;
typedef void (*mcor_take_cap_point)(
  const mcor_context* context, const mcor_cap_points* points, int64_t i, void* data);
struct mcor_cap_points
{
  int count;
  cl_int* node;                                 /* [MCOR_CAP_BATCH][4] */
  void* offset;                                 /* real [MCOR_CAP_BATCH][4] */
  int64_t* to;                                  /* [MCOR_CAP_BATCH]: what each point is of */
  mcor_take_cap_point take;                     /* takes what was found at point i */
  void* data;                                   /* of the one who takes it */
  void *value, *gradient, *weight, *eigenvalue; /* while points are taken */
  mcor_buffer nodes, offsets, values, gradients, weights, eigenvalues;
};

/* One more point, at a node or at an offset from it; NULL: 0. Evaluates a batch when it is full. */
mcor_status mcor_add_cap_point(mcor_context* context, mcor_cap_points* points, const cl_int node[3],
  const double offset[3], int64_t to);
/* Evaluates at the points that are left. */
mcor_status mcor_take_cap_points(mcor_context* context, mcor_cap_points* points);
void mcor_free_cap_points(mcor_context* context, mcor_cap_points* points);
/* How far point i is inside of what trimming leaves. */
double mcor_cap_margin(const mcor_context* context, const mcor_cap_points* points, int64_t i);
bool mcor_cap_is_valid(const mcor_context* context, const mcor_cap_points* points, int64_t i);

/* A vertex only caps have, or what is filled. */
typedef struct mcor_cap_vertex
{
  cl_int node[3];
  int32_t band; /* of what is filled */
  double offset[3];
  uint64_t key[2]; /* of a cap: the first square that met it, and when it did */
  uint8_t flag;    /* as the surface has it: MCOR_CAP_FLAG; of cuts 2, or 1 where they are exact */
} mcor_cap_vertex;

/* Appends vertices to the mesh, and evaluates the field there. */
mcor_status mcor_append_cap_vertices(
  mcor_context* context, const mcor_cap_vertex* vertices, int64_t count);
/* Appends to a buffer of `old` bytes. */
mcor_status mcor_append_bytes(
  mcor_context* context, mcor_buffer* to, size_t old, const void* data, size_t bytes);
void mcor_end_caps(mcor_context* context);
/* Whether vertex v of the mesh is one of a cap alone; then which way the sides it is on face. */
static inline bool mcor_is_cap(const mcor_context* context, int64_t v)
{
  return v >= context->mesh.cap_first;
}
void mcor_cap_normal(const mcor_context* context, const cl_int node[4], float normal[3]);

/* A cut keeps off the ends of its line, as those of the surface do. */
#define MCOR_CAP_CUT_MARGIN 1e-5
#define MCOR_CAP_ROOT 2e-5 /* how near to 0 a margin is a root */

/* ---- mcor_cap_face.c: nodes of one side ---- */

enum
{
  MCOR_CAP_KNOWN = 1, /* as marching has it */
  MCOR_CAP_ABOVE = 2,
  MCOR_CAP_VALID = 4,
  /* Flags of the cell beside the side, and of the side itself, whose lowest node this is. */
  MCOR_CAP_USED = 8,
  MCOR_CAP_JOINED = 16 /* nodes above are joined where the side is ambiguous */
};

typedef struct mcor_cap_face
{
  int axis, upper;        /* upper: the higher one of the two sides */
  int plane;              /* nodes along the axis; the next ones within are beside it */
  int across[2];          /* the other axes: right-handed, this one being the third */
  int first[2], count[2]; /* of nodes along these */
  /* Tiles, MCOR_CAP_TILE nodes along an edge: how many there might be along the axes; the number of each,
   * 0 of those that no particle reaches; how many others; where each of these is. */
  int tiles[2];
  int32_t* tile; /* [tiles[1]][tiles[0]] */
  int tile_count;
  int32_t* place; /* [tile_count + 1] */
  /* See mcor_cap_index: of the nodes, and of the next ones within. */
  int64_t node_count;
  uint8_t *state, *within;
  double* margin; /* how far nodes above are inside of what trimming leaves */
} mcor_cap_face;

#define MCOR_CAP_TILE 16
#define MCOR_CAP_TILE_NODES (MCOR_CAP_TILE * MCOR_CAP_TILE)

/* The place of a node: below MCOR_CAP_TILE_NODES, and the same for all, where no particle reaches it. */
static inline int64_t mcor_cap_index(const mcor_cap_face* face, int u, int v)
{
  const int64_t tile =
    face->tile[(int64_t)(v / MCOR_CAP_TILE) * face->tiles[0] + u / MCOR_CAP_TILE];
  return tile * MCOR_CAP_TILE_NODES + (v % MCOR_CAP_TILE) * MCOR_CAP_TILE + u % MCOR_CAP_TILE;
}

/* Where node (u, v) is: in two dimensions, in the plane. */
static inline void mcor_cap_node(
  const mcor_context* context, const mcor_cap_face* face, int u, int v, cl_int node[3])
{
  node[face->axis] = face->plane;
  node[face->across[0]] = face->first[0] + u;
  node[face->across[1]] = face->first[1] + v;
  node[2] = mcor_is_plane(context) ? 0 : node[2];
}

/* mcor_cap_points.c. Nodes along an axis to its lower or upper side, where a cap closes that (of ranks: of the whole
 * box); -1: none does. */
int mcor_cap_plane(const mcor_context* context, int axis, int upper);
bool mcor_makes_caps(const mcor_context* context);
/* Whether it is a side of this call's box, too. */
bool mcor_has_cap_side(const mcor_context* context, int axis, int upper);
/* The nodes of caps along an axis, [range[0], range[1]]: of the box and its ring. */
void mcor_cap_range(const mcor_context* context, int axis, int range[2]);
/* Whether there is room for the caps. */
mcor_status mcor_check_caps(mcor_context* context);

/* Notes which tiles a face of known extent has, or that they are too many; iso_value: of the field itself. */
mcor_status mcor_note_cap_tiles(mcor_context* context, double iso_value, mcor_cap_face* face);
/* Then numbers of the tiles, and room for their nodes. */
mcor_status mcor_make_cap_nodes(mcor_context* context, mcor_cap_face* face);
/* Takes the masks of the bricks that are marched. */
mcor_status mcor_take_cap_masks(mcor_context* context, mcor_cap_face* face);
/* Asks for the field at the nodes of which it is needed: of the side, or of those within. */
mcor_status mcor_ask_cap_nodes(
  mcor_context* context, const mcor_cap_face* face, bool within, mcor_cap_points* points);
/* Calls `visit` for all squares, by their lower nodes, of tiles that there are. */
mcor_status mcor_visit_cap_squares(mcor_context* context, const mcor_cap_face* face,
  mcor_status (*visit)(void* data, const mcor_cap_face* face, int u, int v), void* data);
/* All of axis a's lower or upper side; opposite: the other one, where that is known. */
mcor_status mcor_load_cap_face(mcor_context* context, int axis, int upper,
  const mcor_cap_face* opposite, mcor_cap_points* points, mcor_cap_face* face);
void mcor_free_cap_face(mcor_cap_face* face);

/* A brick that is marched, where it is, and masks: of nodes, and of the cells and faces that have their lowest node
 * there. */
typedef struct mcor_seen_brick
{
  const cl_int* at; /* in bricks */
  cl_ulong known, above, valid, used, joined[3];
} mcor_seen_brick;
typedef void (*mcor_see_brick)(const mcor_seen_brick* brick, void* data);
mcor_status mcor_see_bricks(mcor_context* context, mcor_see_brick see, void* data);

/* Calls `visit` for all particles on the device: where each is, in nodes from the lattice's origin; how far it
 * reaches, in cubes, or a bit more. */
typedef mcor_status (*mcor_visit_particle)(
  mcor_context* context, const double x[3], double reach, bool is_solid, void* data);
mcor_status mcor_visit_particles(mcor_context* context, mcor_visit_particle visit, void* data);

#endif
