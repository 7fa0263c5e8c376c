/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Evaluation of the field at the 64 nodes of a brick, MCOR_LANES nodes at a time. */

#define MCOR_NODE_GROUPS (64 / MCOR_LANES)
#define MCOR_PLANE_GROUPS (16 / MCOR_LANES)

/* Sums at the nodes of a brick: S = sum V (A - A0) W, w = sum V W, and the trimming weight. */
typedef struct
{
  realv s[MCOR_NODE_GROUPS], w[MCOR_NODE_GROUPS];
#if MCOR_SOLIDS
  realv t[MCOR_NODE_GROUPS];
#endif
} mcor_node_sums;

/* Adds particle j to the planes of `need`; its position relative to the brick is (x, y, z). */
void mcor_node_add(const mcor_grid* grid, int j, real x, real y, real z, ulong need,
  const realv* lane_x, const realv* lane_y, mcor_node_sums* sums)
{
  const real inv_h = grid->inv_h[j];
#if MCOR_SOLIDS
  const real trim = grid->trim_weight[j];
#endif
  const real weight = grid->weight[j], c = MCOR_FIELD == 2 ? (real)0 : weight * grid->value[j];
  realv planar[MCOR_PLANE_GROUPS];
  for (int g = 0; g < MCOR_PLANE_GROUPS; ++g)
  {
    planar[g] = mcor_planar(x - lane_x[g], y - lane_y[g], inv_h);
  }
  const real beside_x = fmax(fabs(x - (real)1.5) - (real)1.5, (real)0);
  const real beside_y = fmax(fabs(y - (real)1.5) - (real)1.5, (real)0);
  for (int plane = 0; plane < 4; ++plane)
  {
    const real dz = z - plane;
#if MCOR_TENSOR
    const bool near = fabs(dz) * inv_h < MCOR_SUPPORT;
#else
    const bool near = (beside_x * beside_x + beside_y * beside_y + dz * dz) * inv_h * inv_h <
      MCOR_SUPPORT * MCOR_SUPPORT * (real)1.0001;
#endif
    if ((need >> (16 * plane) & 1) && near)
    {
      for (int g = 0; g < MCOR_PLANE_GROUPS; ++g)
      {
        const int n = plane * MCOR_PLANE_GROUPS + g;
        const realv w = mcor_weight(planar[g], (realv)dz, inv_h);
        sums->s[n] += c * w;
        sums->w[n] += weight * w;
#if MCOR_SOLIDS
        sums->t[n] += trim * w;
#endif
      }
    }
  }
}

/* Sums over all particles of the query, at the nodes of the planes that `need` has. The query's x and
 * y range is the brick's; origin_z is its lowest plane. */
void mcor_node_sum(
  const mcor_grid* grid, mcor_query* query, fix origin_z, ulong need, mcor_node_sums* sums)
{
  realv lane_x[MCOR_PLANE_GROUPS], lane_y[MCOR_PLANE_GROUPS];
  for (int n = 0; n < 16; ++n)
  {
    MCOR_SET(lane_x[n / MCOR_LANES], n % MCOR_LANES) = n & 3;
    MCOR_SET(lane_y[n / MCOR_LANES], n % MCOR_LANES) = n >> 2;
  }
  for (int g = 0; g < MCOR_NODE_GROUPS; ++g)
  {
    sums->s[g] = sums->w[g] = 0;
#if MCOR_SOLIDS
    sums->t[g] = 0;
#endif
  }
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool first = true; mcor_tile_next(grid, query, &tile, first); first = false)
  {
    for (int i = 0; i < tile.count; ++i)
    {
      const int j = tile.list[i];
      mcor_node_add(grid, j, (real)(grid->px[j] - query->low[0]) * grid->unit,
        (real)(grid->py[j] - query->low[1]) * grid->unit,
        (real)(grid->pz[j] - origin_z) * grid->unit, need, lane_x, lane_y, sums);
    }
  }
}
