/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cap_h
#define mcor_cap_h

/* Caps: what closes the surface at the sides of a period or a box. See mcor_cap_make.c. */

#include "mcor_plane.h"

/* Boundary flag of vertices that caps alone have. */
#define MCOR_CAP_FLAG 8

/* Whether the free surface is closed where it ends at solids, see mcor_cap_wall.c. */
static inline bool mcor_caps_walls(const mcor_context* context)
{
  return context->run.options->capping && context->run.options->field == MCOR_WEIGHT_SUM &&
    !mcor_is_plane(context) && mcor_fluid_share(context) > 0;
}

/* Adds the caps to the trimmed mesh. iso: relative to A0. */
mcor_status mcor_cap(mcor_context* context, double iso);

/* The last two numbers of the key of a cap's vertex. */
void mcor_store_cap_key(const mcor_context* context, int64_t v, uint64_t key[2]);
void mcor_end_caps(mcor_context* context);

/* Whether vertex v of the mesh is one of a cap alone; then which way the sides it is on face. */
bool mcor_is_cap(const mcor_context* context, int64_t v);
void mcor_cap_normal(const mcor_context* context, const cl_int node[4], float normal[3]);

/* ---- mcor_cap_face.c: nodes of one side of the period ---- */

enum
{
  MCOR_CAP_KNOWN = 1, /* as marching has it */
  MCOR_CAP_ABOVE = 2,
  MCOR_CAP_VALID = 4,
  /* Of the cell beside the side, and of the side itself, that have their lowest node here. */
  MCOR_CAP_USED = 8,
  MCOR_CAP_JOINED = 16 /* nodes above are joined where the side is ambiguous */
};

typedef struct mcor_cap_face
{
  int axis, upper; /* upper: the higher one of the two sides */
  int plane;       /* nodes along the axis; of the next ones within; cells beside */
  int inner, cell;
  int across[2];          /* the other axes: right-handed, this one being the third */
  int first[2], count[2]; /* of nodes along these */
  int owned[2], end[2];   /* squares of the box, from there; others are of the ring around it */
  /* Of tiles, MCOR_CAP_TILE nodes along an edge: how many there might be along these; the number of each,
   * 0 of those that no particle reaches; how many others; where each of these is. */
  int tiles[2];
  int32_t* tile; /* [tiles[1]][tiles[0]] */
  int tile_count;
  int32_t* place; /* [tile_count + 1] */
  /* See mcor_cap_index: of the nodes, and of the next ones within. */
  uint8_t *state, *within;
  double* margin; /* how far nodes above are inside of what trimming leaves */
} mcor_cap_face;

#define MCOR_CAP_TILE 16

/* Where points are evaluated. */
typedef struct mcor_cap_points
{
  mcor_buffer node, offset, value, gradient, weight, eigenvalue;
} mcor_cap_points;

/* Of all nodes that no particle reaches the same, below MCOR_CAP_TILE^2. */
static inline int64_t mcor_cap_index(const mcor_cap_face* face, int u, int v)
{
  const int64_t tile =
    face->tile[(int64_t)(v / MCOR_CAP_TILE) * face->tiles[0] + u / MCOR_CAP_TILE];
  return tile * (MCOR_CAP_TILE * MCOR_CAP_TILE) + (v % MCOR_CAP_TILE) * MCOR_CAP_TILE +
    u % MCOR_CAP_TILE;
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

/* mcor_cap_tile.c. Nodes along an axis to its lower or upper side, where a cap closes that (of ranks: of the whole
 * box); -1: none does. */
int mcor_cap_plane(const mcor_context* context, int axis, int upper);
bool mcor_makes_caps(const mcor_context* context);
/* Of a face whose extent is known: which tiles there are, or that they are too many; iso_value: of the field itself. */
mcor_status mcor_note_cap_tiles(mcor_context* context, double iso_value, mcor_cap_face* face);
/* Then numbers of the tiles, and room for their nodes. */
mcor_status mcor_make_cap_nodes(mcor_context* context, mcor_cap_face* face);
/* Views of the particles on the device. */
typedef struct mcor_cap_particles
{
  void* views
    [5]; /* positions; 1 / scaled smoothing length; with solids the weight in the fluid's sums */
} mcor_cap_particles;
mcor_status mcor_map_cap_particles(mcor_context* context, mcor_cap_particles* particles);
mcor_status mcor_unmap_cap_particles(
  mcor_context* context, mcor_cap_particles* particles, mcor_status status);
/* Where particle i is, in nodes from the lattice's origin. Returns how far it reaches, in cubes, or a bit more. */
double mcor_place_cap_particle(
  const mcor_context* context, const mcor_cap_particles* particles, int64_t i, double x[3]);
/* Calls `visit` for all squares, by their lower nodes, of tiles that there are. */
mcor_status mcor_visit_cap_squares(mcor_context* context, const mcor_cap_face* face,
  mcor_status (*visit)(void* data, const mcor_cap_face* face, int u, int v), void* data);
mcor_status mcor_make_cap_face(
  mcor_context* context, int axis, int upper, double iso_value, mcor_cap_face* face);
/* Whether there is room for the caps. */
mcor_status mcor_check_caps(mcor_context* context);

/* Views of the bricks that are marched; decisions: NULL where the field is not asked. */
enum
{
  MCOR_VIEW_BRICKS,
  MCOR_VIEW_KNOWN,
  MCOR_VIEW_ABOVE,
  MCOR_VIEW_VALID,
  MCOR_VIEW_USED,
  MCOR_VIEW_DECISIONS,
  MCOR_BRICK_VIEWS
};
typedef mcor_status (*mcor_look)(
  mcor_context* context, void* const views[MCOR_BRICK_VIEWS], void* data);
/* Calls `look` with them, if there are any; returns what it does. */
mcor_status mcor_see_bricks(mcor_context* context, mcor_look look, void* data);

/* Axis a's lower or upper side; opposite: the other one, where that is known. */
mcor_status mcor_load_cap_face(mcor_context* context, int axis, int upper,
  const mcor_cap_face* opposite, double iso, mcor_cap_points* points, mcor_cap_face* face);
void mcor_free_cap_face(mcor_cap_face* face);
void mcor_release_cap_points(mcor_context* context, mcor_cap_points* points);

/* What was evaluated, on the host. */
typedef struct mcor_cap_values
{
  void *value, *gradient, *weight, *eigenvalue;
} mcor_cap_values;

/* Evaluates at nodes, at least one, or at offsets from them (as in mesh.offset; NULL: 0); unmap *values after
 * failures, too. */
mcor_status mcor_evaluate_cap_points(mcor_context* context, const cl_int* nodes,
  const void* offsets, int count, double iso, mcor_cap_points* points, mcor_cap_values* values);
mcor_status mcor_unmap_cap_values(
  mcor_context* context, const mcor_cap_points* points, mcor_cap_values* values);
/* How far point i is inside of what trimming leaves. */
double mcor_cap_margin(const mcor_context* context, const mcor_cap_values* values, int64_t i);
bool mcor_cap_is_valid(const mcor_context* context, const mcor_cap_values* values, int64_t i);

#endif
