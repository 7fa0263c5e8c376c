/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cap_wall_h
#define mcor_cap_wall_h

/* Private to the caps: what closes the free surface where it ends at solids. See mcor_cap_wall.c. */

#include "mcor_cap_job.h"

/* A brick of nodes near both fluid and solids. */
typedef struct mcor_wall_brick
{
  cl_ulong key; /* of its first cell */
  cl_int at[3]; /* in bricks */
  bool has_fluid, is_known;
  /* Of nodes, and of the cells and faces that have their lowest node here. */
  cl_ulong above, used, joined[3];
  double margin[MCOR_BRICK_NODES]; /* of nodes above */
} mcor_wall_brick;

typedef struct mcor_wall
{
  mcor_table index; /* numbers of bricks */
  mcor_wall_brick* bricks;
  int64_t count, room;
  int first[3], end[3]; /* nodes: of the box, the ring around it, and what is beside */
} mcor_wall;

/* mcor_cap_brick.c. The bricks where there may be caps, in the order of their keys. */
mcor_status mcor_load_wall(
  mcor_context* context, double iso, mcor_cap_points* points, mcor_wall* wall);
/* NULL: there is none. */
const mcor_wall_brick* mcor_find_wall_brick(const mcor_wall* wall, const int at[3]);
void mcor_free_wall(mcor_wall* wall);

/* mcor_cap_wall.c. Caps where the surface ends at solids. */
mcor_status mcor_cap_walls(mcor_cap_job* job, double iso, mcor_cap_points* points);

#endif
