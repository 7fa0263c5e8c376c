/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Evaluation of the field at nodes, in groups of MCOR_LANES neighbouring nodes of a brick: with 16
 * lanes a plane, with 8 half a plane, with 1 a node. One work-item treats a whole brick where
 * particles are gathered for many lanes at once, else one node. */

#if MCOR_LANES == 1
#define MCOR_ITEM_NODES 1
#define MCOR_GROUP_X 1
#define MCOR_GROUP_Y 1
#else
#define MCOR_ITEM_NODES 64
#define MCOR_GROUP_X 4
#define MCOR_GROUP_Y (MCOR_LANES / 4)
#endif
#define MCOR_NODE_GROUPS (MCOR_ITEM_NODES / MCOR_LANES)

/* Sums at the nodes of a work-item: S = sum V (A - A0) W, w = sum V W, and the trimming weight. */
typedef struct
{
  realv s[MCOR_NODE_GROUPS], w[MCOR_NODE_GROUPS];
#if MCOR_SOLIDS
  realv t[MCOR_NODE_GROUPS];
#endif
} mcor_node_sums;

/* Places in the tile of the particles that reach a group, and what their distance in z gives;
 * (x, y, z) is the group's first node. */
int mcor_node_list(
  const mcor_tile* tile, real x, real y, real z, real share, int* list, real* height)
{
  const real ex = (real)0.5 * (MCOR_GROUP_X - 1), ey = (real)0.5 * (MCOR_GROUP_Y - 1);
  int count = 0;
  for (int i = 0; i < tile->count; i += MCOR_LANES)
  {
    const realv dx = fmax(fabs(MCOR_LOAD(i, tile->x) - (x + ex)) - ex, (realv)0);
    const realv dy = fmax(fabs(MCOR_LOAD(i, tile->y) - (y + ey)) - ey, (realv)0);
    const realv dz = MCOR_LOAD(i, tile->z) - z;
    const realv inv_h = MCOR_LOAD(i, tile->inv_h);
    const fixv near = mcor_tile_near(dx, dy, fabs(dz), inv_h, share);
    const mcor_mask mask = MCOR_MASK(near, min(MCOR_LANES, tile->count - i));
    MCOR_PACK_INDEX(mask, i, list + count);
    MCOR_PACK_REAL(mask, mcor_height(dz, inv_h), height + count);
    count += MCOR_MASK_COUNT(mask);
  }
  return count;
}

/* Adds the tile's particles to group g, whose first node is (x, y, z) from the query's low corner.
 * term: their weights times values. */
void mcor_node_add(const mcor_tile* tile, const real* term, int g, real x, real y, real z,
  real share, mcor_node_sums* sums)
{
  const fixv lane = mcor_lane_index();
  const realv node_x = x + MCOR_CONVERT_REALV(lane & 3);
  const realv node_y = y + MCOR_CONVERT_REALV(lane >> 2);
  int list[MCOR_TILE + 16];
  real height[MCOR_TILE + 16];
  const int count = mcor_node_list(tile, x, y, z, share, list, height);
  realv s = sums->s[g], w = sums->w[g];
#if MCOR_SOLIDS
  realv t = sums->t[g];
#endif
  for (int begin = 0; begin < count; begin += MCOR_STEP)
  {
    realv distance[MCOR_STEP];
    const int end = min(begin + MCOR_STEP, count);
    for (int k = begin; k < end; ++k)
    {
      const int i = list[k];
      distance[k - begin] = mcor_distance(
        mcor_planar(tile->x[i] - node_x, tile->y[i] - node_y, tile->inv_h[i]), height[k]);
    }
    for (int k = begin; k < end; ++k)
    {
      const int i = list[k];
      const realv v = mcor_weight(distance[k - begin], tile->inv_h[i]);
#if MCOR_FIELD != 2
      s += term[i] * v;
#endif
      w += tile->weight[i] * v;
#if MCOR_SOLIDS
      t += tile->trim_weight[i] * v;
#endif
    }
  }
  sums->s[g] = s;
  sums->w[g] = w;
#if MCOR_SOLIDS
  sums->t[g] = t;
#endif
}

/* The query for the nodes of a work-item, MCOR_ITEM_NODES of a brick from `first` on; only those that
 * `wanted` has need be in it. share: of each particle's support. */
mcor_query mcor_node_query(const mcor_grid* grid, int4 brick, int first, ulong wanted, float share)
{
  /* From the lowest plane, wanted or not: positions count from there, and those of particles that
   * reach far are rounded, which no value may depend on. */
  const int low = first / 16, high = (first + 63 - (int)clz(wanted)) / 16;
  const int corner[3] = { brick.x * MCOR_BRICK + (MCOR_GROUP_X == 1 ? first & 3 : 0),
    brick.y * MCOR_BRICK + (MCOR_GROUP_Y == 1 ? first >> 2 & 3 : 0), brick.z * MCOR_BRICK + low };
  const int extent[3] = { MCOR_GROUP_X - 1, MCOR_GROUP_Y == 1 ? 0 : MCOR_BRICK - 1, high - low };
  mcor_query query;
  query.radius = -share;
  for (int a = 0; a < 3; ++a)
  {
    query.low[a] = (fix)corner[a] << grid->fix_bits;
    query.high[a] = query.low[a] + ((fix)extent[a] << grid->fix_bits);
  }
  return query;
}

/* Sums at those nodes, for the groups that `wanted` has. The tile may hold the query's particles
 * already. */
void mcor_node_sum(const mcor_grid* grid, mcor_query* query, mcor_tile* tile, int first,
  ulong wanted, mcor_node_sums* sums)
{
  const real share = -query->radius;
  for (int g = 0; g < MCOR_NODE_GROUPS; ++g)
  {
    sums->s[g] = sums->w[g] = 0;
#if MCOR_SOLIDS
    sums->t[g] = 0;
#endif
  }
  for (bool begin = true; mcor_tile_next(grid, query, tile, begin); begin = false)
  {
    MCOR_ALIGNED real term[MCOR_TILE + 16];
#if MCOR_FIELD != 2
    for (int i = 0; i < tile->count; ++i)
    {
      term[i] = tile->weight[i] * tile->value[i];
    }
#endif
    for (int g = 0; g < MCOR_NODE_GROUPS; ++g)
    {
      const int n = g * MCOR_LANES;
      if (wanted >> n & 1)
      {
        mcor_node_add(tile, term, g, (real)0, (real)(MCOR_GROUP_Y == 1 ? 0 : n >> 2 & 3),
          (real)(n / 16), share, sums);
      }
    }
  }
}

/* A Shepard mean needs this fluid weight. Where solids make up the rest, cells would otherwise
 * reach over voids without any fluid, and rounding noise of a kernel's rim would count as a
 * value. */
#define MCOR_LEAST_WEIGHT ((real)1e-3)

/* Writes the field's values and the trimming weights (-1: no valid value) at the wanted nodes of a
 * work-item, from its first on. */
void mcor_node_store(
  const mcor_node_sums* sums, ulong wanted, __global real* value, __global real* weight)
{
  for (ulong rest = wanted; rest; rest &= rest - 1)
  {
    const int n = mcor_ctz(rest), g = n / MCOR_LANES, lane = n % MCOR_LANES;
    const real s = MCOR_GET(sums->s[g], lane), w = MCOR_GET(sums->w[g], lane);
#if MCOR_SOLIDS
    const real t = MCOR_GET(sums->t[g], lane);
#else
    const real t = w;
#endif
#if MCOR_FIELD == 0
    const bool defined = w >= MCOR_LEAST_WEIGHT;
    value[n] = defined ? s / w : (real)0;
    weight[n] = defined ? t : (real)-1;
#else
    value[n] = MCOR_FIELD == 1 ? s : w;
    weight[n] = t;
#endif
  }
}

/* Writes which known nodes of a brick are above the iso value, and which are valid: their weight is
 * not below the node threshold. */
void mcor_node_signs(ulong known, __global const real* value, __global const real* weight, real iso,
  real node_threshold, __global ulong* above, __global ulong* valid)
{
  ulong a = 0, v = 0;
  for (int n = 0; n < 64; ++n)
  {
    a |= (ulong)(value[n] >= iso) << n;
    v |= (ulong)(MCOR_FIELD == 2 || weight[n] >= node_threshold) << n;
  }
  *above = a & known;
  *valid = v & known;
}
