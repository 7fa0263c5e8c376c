/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Evaluation of the field at nodes in the plane. Each has the bits that mcor_march_nodes would give it. */

/* Work-items that a brick's 16 nodes are shared among; nodes of one along y. */
#define MCOR_PLANE_ITEMS (16 / MCOR_LANES)
#define MCOR_PLANE_ROWS (MCOR_LANES == 1 ? 1 : MCOR_LANES / 4)

/* One work-item = MCOR_LANES nodes of a brick. Where they are needed, reads the particles that reach them.
 * Writes their values and weights, and the same above them, see mcor_plane_spread. */
__kernel void mcor_plane_nodes(MCOR_GRID_PARAMS, const int brick_count, __global const int4* bricks,
  __global const ulong* need, __global real* node_value, __global real* node_weight)
{
  const long item = get_global_id(0);
  const int slot = (int)(item / MCOR_PLANE_ITEMS);
  if (slot >= brick_count || need[slot] == 0)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const int first = (int)(item % MCOR_PLANE_ITEMS) * MCOR_LANES;
  const int corner[3] = { bricks[slot].x * MCOR_BRICK + (first & 3),
    bricks[slot].y * MCOR_BRICK + (first >> 2), 0 };
  const int extent[3] = { MCOR_LANES == 1 ? 0 : MCOR_BRICK - 1, MCOR_PLANE_ROWS - 1, 0 };
  mcor_query query;
  query.radius = -1;
  for (int a = 0; a < 3; ++a)
  {
    query.low[a] = (fix)corner[a] << grid.fix_bits;
    query.high[a] = query.low[a] + ((fix)extent[a] << grid.fix_bits);
  }
  mcor_query_in_region(&grid, bricks[slot], &query);
  const fixv lane = mcor_lane_index();
  const realv x = (real)(query.low[0] - query.origin[0]) * grid.unit + MCOR_CONVERT_REALV(lane & 3);
  const realv y =
    (real)(query.low[1] - query.origin[1]) * grid.unit + MCOR_CONVERT_REALV(lane >> 2);
  const realv z = (real)(query.low[2] - query.origin[2]) * grid.unit;
  realv s = 0, w = 0, t = 0;
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool begin = true; mcor_tile_next(&grid, &query, &tile, begin); begin = false)
  {
    for (int from = 0; from < tile.count; from += MCOR_STEP)
    {
      realv distance[MCOR_STEP];
      const int end = min(from + MCOR_STEP, tile.count);
      for (int i = from; i < end; ++i)
      {
        distance[i - from] = mcor_distance(MCOR_EACH(&tile, x, i) - x, MCOR_EACH(&tile, y, i) - y,
          MCOR_EACH(&tile, z, i) - z, MCOR_EACH(&tile, inv_h, i));
      }
      for (int i = from; i < end; ++i)
      {
        const real weight = MCOR_EACH(&tile, weight, i);
        const realv v = mcor_weight(distance[i - from], MCOR_EACH(&tile, inv_h, i));
#if MCOR_FIELD != 2
        s = MCOR_FMA((realv)(weight * MCOR_EACH(&tile, value, i)), v, s);
#endif
        w = MCOR_FMA((realv)weight, v, w);
#if MCOR_SOLIDS
        t = MCOR_FMA((realv)MCOR_EACH(&tile, trim_weight, i), v, t);
#endif
      }
    }
  }
  for (int n = 0; n < MCOR_LANES; ++n)
  {
    const real sum = MCOR_GET(s, n), fluid = MCOR_GET(w, n);
    const real trim = MCOR_SOLIDS ? MCOR_GET(t, n) : fluid;
    const bool defined = MCOR_FIELD != 0 || fluid >= (real)MCOR_LEAST_NODE_WEIGHT;
    const long at = slot * 64L + first + n;
    node_value[at] = node_value[at + 16] = MCOR_FIELD == 2 ? fluid
      : MCOR_FIELD == 1                                    ? sum
      : defined                                            ? sum / fluid
                                                           : (real)0;
    node_weight[at] = node_weight[at + 16] = defined ? trim : (real)-1;
  }
}
