/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Nodes where fluid meets solids: on which side of the iso value they are, and how far from where the solids'
 * share of the weight is too great. Where marching has evaluated them its answer is taken. */

#include "mcor_box.h"
#include "mcor_cap_job.h"

#include <math.h>
#include <stdlib.h>

#define MCOR_WALL_LIMIT (1 << 20) /* bricks */
#define MCOR_WALL_BATCH (1 << 12) /* those evaluated at a time */

void mcor_free_wall(mcor_wall* wall)
{
  mcor_table_free(&wall->index);
  free(wall->bricks);
}

static uint64_t mcor_wall_key(const int at[3])
{
  return (uint64_t)at[0] | (uint64_t)at[1] << 21 | (uint64_t)at[2] << 42 | UINT64_C(1) << 63;
}

const mcor_wall_brick* mcor_find_wall_brick(const mcor_wall* wall, const int at[3])
{
  const int32_t number = mcor_find_number(&wall->index, mcor_wall_key(at));
  return number < 0 ? NULL : &wall->bricks[number];
}

/* ---- which bricks ---- */

/* The nodes of caps: of the box and its ring. */
static void mcor_set_wall_extent(const mcor_context* context, mcor_wall* wall)
{
  const mcor_lattice* lattice = &context->lattice;
  const mcor_box* box = &context->box;
  for (int a = 0; a < 3; ++a)
  {
    const int lower = mcor_cap_plane(context, a, 0), upper = mcor_cap_plane(context, a, 1);
    const int first = lower >= 0 ? lower : (int)lattice->first[a];
    const int last = upper >= 0 ? upper : (int)lattice->last[a];
    const int low = box->first[a] - MCOR_BOX_RING, high = box->last[a] + MCOR_BOX_RING;
    wall->first[a] = low > first ? low : first;
    wall->end[a] = (high < last ? high : last) + 1;
  }
}

static mcor_status mcor_add_wall_brick(mcor_context* context, mcor_wall* wall, const int at[3])
{
  const int32_t next = (int32_t)wall->count;
  const int32_t number = mcor_table_number(&wall->index, mcor_wall_key(at), next);
  if (number != next)
  {
    return mcor_allocated(context, number >= 0);
  }
  MCOR_RETURN_IF(next >= MCOR_WALL_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    "More than %d nodes are near both fluid and solids, with cube size %g: too many for caps. Use "
    "a "
    "larger cube size, or no caps.",
    MCOR_WALL_LIMIT * MCOR_BRICK_NODES, context->lattice.cube);
  MCOR_TRY(
    mcor_make_room(context, (void**)&wall->bricks, wall->count, &wall->room, sizeof *wall->bricks));
  mcor_wall_brick* brick = &wall->bricks[wall->count++];
  *brick = (mcor_wall_brick){ .at = { at[0], at[1], at[2] } };
  const cl_int node[4] = { at[0] * MCOR_BRICK, at[1] * MCOR_BRICK, at[2] * MCOR_BRICK, 0 };
  brick->key = mcor_node_key(&context->lattice, node);
  return MCOR_OK;
}

/* Of a particle at x, in nodes: adds the bricks that it reaches if it is solid; else notes it at those that
 * there are. A cell is looked at from its lowest node: one node more; another one for rounding. */
static mcor_status mcor_reach_wall(
  mcor_context* context, mcor_wall* wall, const double x[3], double reach, bool is_solid)
{
  int from[3], to[3], at[3];
  for (int a = 0; a < 3; ++a)
  {
    const double nodes = reach / mcor_edge_of(&context->lattice, a) + 2;
    from[a] = (int)fmax(floor(x[a] - nodes), wall->first[a]) / MCOR_BRICK;
    to[a] = (int)fmin(ceil(x[a] + nodes), wall->end[a] - 1);
    to[a] = to[a] < wall->first[a] ? -1 : to[a] / MCOR_BRICK;
  }
  for (at[2] = from[2]; at[2] <= to[2]; ++at[2])
  {
    for (at[1] = from[1]; at[1] <= to[1]; ++at[1])
    {
      for (at[0] = from[0]; at[0] <= to[0]; ++at[0])
      {
        const int32_t found = is_solid ? -1 : mcor_find_number(&wall->index, mcor_wall_key(at));
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

static mcor_status mcor_reach_walls(
  mcor_context* context, mcor_wall* wall, const mcor_cap_particles* particles, bool solids)
{
  for (int64_t i = 0; i < context->grid.count; ++i)
  {
    if ((mcor_get_real(context, particles->views[4], i) == 0) == solids)
    {
      double x[3];
      const double reach = mcor_place_cap_particle(context, particles, i, x);
      MCOR_TRY(mcor_reach_wall(context, wall, x, reach, solids));
    }
  }
  return MCOR_OK;
}

static int mcor_compare_wall_bricks(const void* x, const void* y)
{
  const mcor_wall_brick *a = x, *b = y;
  return (a->key > b->key) - (a->key < b->key);
}

/* Leaves the bricks that fluid reaches, too, in order. */
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
    const uint64_t key = mcor_wall_key(wall->bricks[i].at);
    MCOR_TRY(mcor_allocated(context, mcor_table_number(&wall->index, key, (int32_t)i) >= 0));
  }
  return MCOR_OK;
}

static mcor_status mcor_find_wall(mcor_context* context, mcor_wall* wall)
{
  mcor_cap_particles particles = { { NULL } };
  mcor_status status = mcor_map_cap_particles(context, &particles);
  status = status == MCOR_OK ? mcor_reach_walls(context, wall, &particles, true) : status;
  status = status == MCOR_OK ? mcor_reach_walls(context, wall, &particles, false) : status;
  status = mcor_unmap_cap_particles(context, &particles, status);
  return status == MCOR_OK ? mcor_sort_wall(context, wall) : status;
}

/* ---- what marching knows ---- */

static mcor_status mcor_take_wall_masks(
  mcor_context* context, void* const views[MCOR_BRICK_VIEWS], void* data)
{
  const mcor_wall* wall = data;
  const cl_int* bricks = views[MCOR_VIEW_BRICKS];
  const cl_ulong *known = views[MCOR_VIEW_KNOWN], *above = views[MCOR_VIEW_ABOVE],
                 *used = views[MCOR_VIEW_USED], *decisions = views[MCOR_VIEW_DECISIONS];
  for (int slot = 0; slot < context->bricks.now.count; ++slot)
  {
    const int32_t number = mcor_find_number(&wall->index, mcor_wall_key(bricks + 4 * (size_t)slot));
    if (number >= 0)
    {
      mcor_wall_brick* brick = &wall->bricks[number];
      brick->is_known = known[slot] != 0;
      brick->above = known[slot] & above[slot];
      brick->used = used[slot];
      for (size_t a = 0; a < 3 && decisions; ++a)
      {
        brick->joined[a] = decisions[(size_t)slot * MCOR_DECISION_MASKS + a];
      }
    }
  }
  return MCOR_OK;
}

/* ---- what it does not know ---- */

/* Evaluates nodes that are needed, of bricks [first, last): those above, and where it is not known which are. */
static mcor_status mcor_fill_wall_nodes(mcor_context* context, mcor_wall* wall, int64_t first,
  int64_t last, cl_int* nodes, int64_t* to, double iso, mcor_cap_points* points)
{
  int count = 0;
  for (int64_t i = first * MCOR_BRICK_NODES; i < last * MCOR_BRICK_NODES; ++i)
  {
    const mcor_wall_brick* brick = &wall->bricks[i / MCOR_BRICK_NODES];
    const int n = (int)(i % MCOR_BRICK_NODES);
    if (!brick->is_known || (brick->above >> n & 1))
    {
      for (int a = 0; a < 3; ++a)
      {
        nodes[4 * (size_t)count + (size_t)a] = brick->at[a] * MCOR_BRICK + (n >> 2 * a & 3);
      }
      nodes[4 * (size_t)count + 3] = 0;
      to[count++] = i;
    }
  }
  mcor_cap_values v = { NULL, NULL, NULL, NULL };
  mcor_status status =
    count > 0 ? mcor_evaluate_cap_points(context, nodes, NULL, count, iso, points, &v) : MCOR_OK;
  for (int i = 0; i < count && status == MCOR_OK; ++i)
  {
    mcor_wall_brick* brick = &wall->bricks[to[i] / MCOR_BRICK_NODES];
    const int n = (int)(to[i] % MCOR_BRICK_NODES);
    const bool is_above = brick->is_known || mcor_get_real(context, v.value, i) >= 0;
    brick->above |= (cl_ulong)is_above << n;
    brick->margin[n] = mcor_cap_margin(context, &v, i);
  }
  const mcor_status unmapped = mcor_unmap_cap_values(context, points, &v);
  return status == MCOR_OK ? unmapped : status;
}

mcor_status mcor_load_wall(
  mcor_context* context, double iso, mcor_cap_points* points, mcor_wall* wall)
{
  mcor_set_wall_extent(context, wall);
  MCOR_TRY(mcor_find_wall(context, wall));
  MCOR_TRY(mcor_see_bricks(context, mcor_take_wall_masks, wall));
  const size_t room = (size_t)MCOR_WALL_BATCH * MCOR_BRICK_NODES;
  cl_int* nodes = malloc(4 * room * sizeof *nodes);
  int64_t* to = malloc(room * sizeof *to);
  mcor_status status = mcor_allocated(context, nodes && to);
  for (int64_t i = 0; i < wall->count && status == MCOR_OK; i += MCOR_WALL_BATCH)
  {
    const int64_t end = i + MCOR_WALL_BATCH < wall->count ? i + MCOR_WALL_BATCH : wall->count;
    status = mcor_fill_wall_nodes(context, wall, i, end, nodes, to, iso, points);
    status = status == MCOR_OK ? mcor_report_launch(context) : status;
  }
  free(nodes);
  free(to);
  return status;
}
