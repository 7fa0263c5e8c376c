/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Evaluation of the field at nodes in the plane. Each node has the bits that mcor_node_values
 * would give it. */

/* Work-items that share a brick's 16 nodes; nodes of one along y. */
#define MCOR_PLANE_ITEMS (16 / MCOR_LANES)
#define MCOR_PLANE_ROWS (MCOR_LANES == 1 ? 1 : MCOR_LANES / 4)

/* Sums at MCOR_LANES nodes. */
typedef struct
{
  realv s, w, t;
} mcor_plane_sums;

/* Adds a tile's particles. x, y, z: the nodes from the query's origin. */
void mcor_plane_add(const mcor_tile* tile, realv x, realv y, realv z, mcor_plane_sums* sums)
{
  for (int from = 0; from < tile->count; from += MCOR_STEP)
  {
    realv distance[MCOR_STEP];
    const int end = min(from + MCOR_STEP, tile->count);
    for (int i = from; i < end; ++i)
    {
      distance[i - from] = mcor_distance(MCOR_EACH(tile, x, i) - x, MCOR_EACH(tile, y, i) - y,
        MCOR_EACH(tile, z, i) - z, MCOR_EACH(tile, inv_h, i));
    }
    for (int i = from; i < end; ++i)
    {
      const real weight = MCOR_EACH(tile, weight, i);
      const realv v = mcor_weight(distance[i - from], MCOR_EACH(tile, inv_h, i));
#if MCOR_FIELD != 2
      sums->s = MCOR_FMA((realv)(weight * MCOR_EACH(tile, value, i)), v, sums->s);
#endif
      sums->w = MCOR_FMA((realv)weight, v, sums->w);
#if MCOR_SOLIDS
      sums->t = MCOR_FMA((realv)MCOR_EACH(tile, trim_weight, i), v, sums->t);
#endif
    }
  }
}

/* Writes values and weights as mcor_node_store does, also to the nodes above. */
void mcor_plane_store(const mcor_plane_sums* sums, __global real* value, __global real* weight)
{
  for (int n = 0; n < MCOR_LANES; ++n)
  {
    const real s = MCOR_GET(sums->s, n), w = MCOR_GET(sums->w, n);
    const real t = MCOR_SOLIDS ? MCOR_GET(sums->t, n) : w;
    const bool defined = MCOR_FIELD != 0 || w >= (real)MCOR_LEAST_NODE_WEIGHT;
    const real mean = defined && MCOR_FIELD == 0 ? s / w : (real)0;
    value[n] = value[n + 16] = MCOR_FIELD == 2 ? w : MCOR_FIELD == 1 ? s : mean;
    weight[n] = weight[n + 16] = defined ? t : (real)-1;
  }
}

/* Returns the query for positions in the plane, so many cubes along x and y, from a brick's node
 * on. */
mcor_query mcor_plane_query(const mcor_grid* grid, int4 brick, int first, int x, int y)
{
  const int corner[3] = { brick.x * MCOR_BRICK + (first & 3), brick.y * MCOR_BRICK + (first >> 2),
    0 };
  const int extent[3] = { x, y, 0 };
  mcor_query query;
  query.radius = -1;
  for (int a = 0; a < 3; ++a)
  {
    query.low[a] = (fix)corner[a] * grid->step[a];
    query.high[a] = query.low[a] + (fix)extent[a] * grid->step[a];
  }
  mcor_query_in_region(grid, brick, &query);
  return query;
}

/* Evaluates MCOR_LANES nodes of a brick from `first` on, and writes their values and weights,
 * also to the nodes above them, see mcor_plane_spread. */
void mcor_plane_evaluate(const mcor_grid* grid, int4 brick, int first, __global real* node_value,
  __global real* node_weight)
{
  mcor_query query =
    mcor_plane_query(grid, brick, first, MCOR_LANES == 1 ? 0 : MCOR_BRICK - 1, MCOR_PLANE_ROWS - 1);
  real at[3];
  for (int a = 0; a < 3; ++a)
  {
    at[a] = (real)(query.low[a] - query.origin[a]) * grid->unit;
  }
  const fixv lane = mcor_lane_index();
  const realv x = at[0] + MCOR_CONVERT_REALV(lane & 3) * grid->edge[0];
  const realv y = at[1] + MCOR_CONVERT_REALV(lane >> 2) * grid->edge[1];
  mcor_plane_sums sums;
  sums.s = sums.w = sums.t = 0;
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool begin = true; mcor_tile_next(grid, &query, &tile, begin); begin = false)
  {
    mcor_plane_add(&tile, x, y, at[2], &sums);
  }
  mcor_plane_store(&sums, node_value + first, node_weight + first);
}

/* One work-item = MCOR_LANES nodes of a brick, of `count` from `first` on. Evaluates them if
 * they are needed. */
__kernel void mcor_plane_nodes(MCOR_GRID_PARAMS, const int first, const int count,
  __global const int4* bricks, __global const ulong* need, __global real* node_value,
  __global real* node_weight)
{
  const long item = get_global_id(0);
  const int slot = first + (int)(item / MCOR_PLANE_ITEMS);
  if (slot >= first + count || need[slot] == 0)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  mcor_plane_evaluate(&grid, bricks[slot], (int)(item % MCOR_PLANE_ITEMS) * MCOR_LANES,
    node_value + slot * 64L, node_weight + slot * 64L);
}
