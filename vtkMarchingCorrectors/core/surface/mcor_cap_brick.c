/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The nodes near both fluid and solids: which side of the iso value they are on, and how far
 * they are from the place where the solids' share of the weight becomes too great. Where
 * marching has evaluated a node, its answer is taken. */

#include "mcor_cap_job.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_WALL_LIMIT (1 << 20) /* bricks */

void mcor_free_wall(mcor_wall* wall)
{
  mcor_table_free(&wall->index);
  free(wall->bricks);
}

const mcor_wall_brick* mcor_find_wall_brick(const mcor_wall* wall, const int at[3])
{
  const int32_t number = mcor_find_number(&wall->index, mcor_cap_key(at));
  return number < 0 ? NULL : &wall->bricks[number];
}

/* ---- The bricks ---- */

static mcor_status mcor_add_wall_brick(mcor_context* context, mcor_wall* wall, const int at[3])
{
  const int32_t next = (int32_t)wall->count;
  const int32_t number = mcor_table_number(&wall->index, mcor_cap_key(at), next);
  if (number != next)
  {
    return mcor_allocated(context, number >= 0);
  }
  MCOR_RETURN_IF(next >= MCOR_WALL_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    "More than %d nodes are near both fluid and solids, with cube size %g: too many for caps. Use "
    "a larger cube size, or turn capping off.",
    MCOR_WALL_LIMIT * MCOR_BRICK_NODES, context->lattice.cube);
  MCOR_TRY(
    mcor_make_room(context, (void**)&wall->bricks, wall->count, &wall->room, sizeof *wall->bricks));
  mcor_wall_brick* brick = &wall->bricks[wall->count++];
  *brick = (mcor_wall_brick){ .at = { at[0], at[1], at[2] } };
  const cl_int node[4] = { at[0] * MCOR_BRICK, at[1] * MCOR_BRICK, at[2] * MCOR_BRICK, 0 };
  brick->key = mcor_node_key(&context->lattice, node);
  return MCOR_OK;
}

/* Visits a particle at x (in nodes), in two passes: the first one adds the bricks that solids
 * reach, the second one marks those that fluid reaches, too. Reach is widened by one node,
 * because a cell is looked up by its lowest node, and by another one for rounding. */
static mcor_status mcor_reach_wall(
  mcor_context* context, const double x[3], double reach, bool is_solid, void* data)
{
  mcor_wall* wall = data;
  int from[3], to[3], at[3];
  for (int a = 0; a < 3; ++a)
  {
    const int* range = wall->range[a];
    const double nodes = reach / mcor_edge_of(&context->lattice, a) + 2;
    from[a] = (int)fmax(floor(x[a] - nodes), range[0]) / MCOR_BRICK;
    to[a] = (int)fmin(ceil(x[a] + nodes), range[1]);
    to[a] = to[a] < range[0] || is_solid == wall->has_bricks ? -1 : to[a] / MCOR_BRICK;
  }
  for (at[2] = from[2]; at[2] <= to[2]; ++at[2])
  {
    for (at[1] = from[1]; at[1] <= to[1]; ++at[1])
    {
      for (at[0] = from[0]; at[0] <= to[0]; ++at[0])
      {
        const int32_t found = is_solid ? -1 : mcor_find_number(&wall->index, mcor_cap_key(at));
        MCOR_TRY(is_solid ? mcor_add_wall_brick(context, wall, at) : MCOR_OK);
        if (found >= 0)
        {
          wall->bricks[found].has_fluid = true;
        }
      }
    }
  }
  return MCOR_OK;
}

static int mcor_compare_wall_bricks(const void* x, const void* y)
{
  const mcor_wall_brick *a = x, *b = y;
  return (a->key > b->key) - (a->key < b->key);
}

/* Keeps the bricks that fluid reaches, too, and sorts them by key. */
static mcor_status mcor_sort_wall(mcor_context* context, mcor_wall* wall)
{
  int64_t count = 0;
  for (int64_t i = 0; i < wall->count; ++i)
  {
    if (wall->bricks[i].has_fluid)
    {
      wall->bricks[count++] = wall->bricks[i];
    }
  }
  wall->count = count;
  if (count > 0)
  {
    qsort(wall->bricks, (size_t)count, sizeof *wall->bricks, mcor_compare_wall_bricks);
  }
  mcor_table_free(&wall->index);
  for (int64_t i = 0; i < count; ++i)
  {
    const uint64_t key = mcor_cap_key(wall->bricks[i].at);
    MCOR_TRY(mcor_allocated(context, mcor_table_number(&wall->index, key, (int32_t)i) >= 0));
  }
  return MCOR_OK;
}

/* ---- Nodes that marching has evaluated ---- */

static void mcor_take_wall_masks(const mcor_seen_brick* seen, void* data)
{
  const mcor_wall* wall = data;
  const int32_t number = mcor_find_number(&wall->index, mcor_cap_key(seen->at));
  if (number >= 0)
  {
    mcor_wall_brick* brick = &wall->bricks[number];
    brick->is_known = seen->known != 0;
    brick->above = seen->above;
    brick->used = seen->used;
    memcpy(brick->joined, seen->joined, sizeof seen->joined);
  }
}

/* ---- The other nodes ---- */

/* Takes the field at node points->to[i], which counts the nodes of all bricks. */
static void mcor_take_wall_node(
  const mcor_context* context, const mcor_cap_points* points, int64_t i, void* data)
{
  const mcor_wall* wall = data;
  mcor_wall_brick* brick = &wall->bricks[points->to[i] / MCOR_BRICK_NODES];
  const int n = (int)(points->to[i] % MCOR_BRICK_NODES);
  const bool is_above = brick->is_known || mcor_get_real(context, points->value, i) >= 0;
  brick->above |= (cl_ulong)is_above << n;
  brick->margin[n] = mcor_cap_margin(context, points, i);
}

/* Evaluates the nodes that are above, and those of unknown side. */
static mcor_status mcor_evaluate_wall(
  mcor_context* context, mcor_wall* wall, mcor_cap_points* points)
{
  points->take = mcor_take_wall_node;
  points->data = wall;
  for (int64_t i = 0; i < wall->count * MCOR_BRICK_NODES; ++i)
  {
    const mcor_wall_brick* brick = &wall->bricks[i / MCOR_BRICK_NODES];
    const int n = (int)(i % MCOR_BRICK_NODES);
    if (!brick->is_known || (brick->above >> n & 1))
    {
      cl_int node[3];
      for (int a = 0; a < 3; ++a)
      {
        node[a] = brick->at[a] * MCOR_BRICK + (n >> 2 * a & 3);
      }
      MCOR_TRY(mcor_add_cap_point(context, points, node, NULL, i));
    }
  }
  return mcor_take_cap_points(context, points);
}

mcor_status mcor_load_wall(mcor_context* context, mcor_cap_points* points, mcor_wall* wall)
{
  for (int a = 0; a < 3; ++a)
  {
    mcor_cap_range(context, a, wall->range[a]);
  }
  MCOR_TRY(mcor_visit_particles(context, mcor_reach_wall, wall));
  wall->has_bricks = true;
  MCOR_TRY(mcor_visit_particles(context, mcor_reach_wall, wall));
  MCOR_TRY(mcor_sort_wall(context, wall));
  MCOR_TRY(mcor_see_bricks(context, mcor_take_wall_masks, wall));
  return mcor_evaluate_wall(context, wall, points);
}
