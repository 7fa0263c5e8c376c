/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sums at one node per work-item; the interface is that of mcor_node.cl. */

int mcor_group_of(int n)
{
  return 0;
}

int mcor_lane_of(int n)
{
  return 0;
}

void mcor_node_sum(const mcor_grid* grid, mcor_query* query, mcor_tile* tile, mcor_node_sums* sums)
{
  const real x = (real)(query->low[0] - query->origin[0]) * grid->unit;
  const real y = (real)(query->low[1] - query->origin[1]) * grid->unit;
  const real z = (real)(query->low[2] - query->origin[2]) * grid->unit;
  real s = 0, w = 0, t = 0;
  for (bool begin = true; mcor_tile_next(grid, query, tile, begin); begin = false)
  {
    for (int i = 0; i < tile->count; ++i)
    {
      const real inv_h = MCOR_EACH(tile, inv_h, i), weight = MCOR_EACH(tile, weight, i);
      const real v =
        mcor_weight(mcor_distance(MCOR_EACH(tile, x, i) - x, MCOR_EACH(tile, y, i) - y,
                      MCOR_EACH(tile, z, i) - z, inv_h),
          inv_h);
#if MCOR_FIELD != 2
      s = MCOR_FMA(weight * MCOR_EACH(tile, value, i), v, s);
#endif
      w = MCOR_FMA(weight, v, w);
#if MCOR_SOLIDS
      t = MCOR_FMA(MCOR_EACH(tile, trim_weight, i), v, t);
#endif
    }
  }
  sums->s[0] = s;
  sums->w[0] = w;
#if MCOR_SOLIDS
  sums->t[0] = t;
#endif
}
