/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Evaluation of the field at nodes, in groups of MCOR_LANES nodes of a brick that are close
 * together: with 16 lanes 2 x 2 x 4, with 8 2 x 2 x 2, with 1 a node. One work-item treats a whole
 * brick where particles are gathered for many lanes at once, else one node. */

#if MCOR_LANES == 1
#define MCOR_ITEM_NODES 1
#define MCOR_GROUP_XY 1
#define MCOR_GROUP_Z 1
#else
#define MCOR_ITEM_NODES 64
#define MCOR_GROUP_XY 2
#define MCOR_GROUP_Z (MCOR_LANES / 4)
#endif
#define MCOR_NODE_GROUPS (MCOR_ITEM_NODES / MCOR_LANES)

/* First node of group g. */
int4 mcor_group_node(int g)
{
  return (int4)(2 * (g & 1), 2 * (g >> 1 & 1), MCOR_GROUP_Z * (g >> 2), 0);
}

/* Group and lane of node n of those of a work-item. */
int mcor_group_of(int n)
{
  return MCOR_LANES == 1 ? 0 : (n >> 1 & 1) | (n >> 3 & 1) << 1 | (n >> 4) / MCOR_GROUP_Z << 2;
}
int mcor_lane_of(int n)
{
  return MCOR_LANES == 1 ? 0 : (n & 1) | (n >> 2 & 1) << 1 | (n >> 4) % MCOR_GROUP_Z << 2;
}

/* Sums at the nodes of a work-item: S = sum V (A - A0) W, w = sum V W, and the trimming weight. */
typedef struct
{
  realv s[MCOR_NODE_GROUPS], w[MCOR_NODE_GROUPS];
#if MCOR_SOLIDS
  realv t[MCOR_NODE_GROUPS];
#endif
} mcor_node_sums;

/* Places in the tile of the particles that reach a group, whose first node is (x, y, z). */
int mcor_node_list(const mcor_tile* tile, real x, real y, real z, real share, int* list)
{
  const real exy = (real)0.5 * (MCOR_GROUP_XY - 1), ez = (real)0.5 * (MCOR_GROUP_Z - 1);
  int count = 0;
  for (int i = 0; i < tile->count; i += MCOR_LANES)
  {
    const fixv near =
      mcor_tile_near(MCOR_LOAD(i, tile->x), MCOR_LOAD(i, tile->y), MCOR_LOAD(i, tile->z),
        MCOR_LOAD(i, tile->inv_h), x + exy, y + exy, z + ez, exy, exy, ez, share);
    const mcor_mask mask = MCOR_MASK(near, min(MCOR_LANES, tile->count - i));
    MCOR_PACK_INDEX(mask, i, list + count);
    count += MCOR_MASK_COUNT(mask);
  }
  return count;
}

/* Nodes of a group from its query's origin, and weights there in two steps, see
 * mcor_distance. */
#if MCOR_TENSOR && MCOR_LANES > 1
/* A group has few different x, y and z, so that one evaluation of w serves them all: lanes 0 and 1
 * are x, 2 and 3 y, from 4 on z. */
typedef struct
{
  realv at;
} mcor_group_nodes;

mcor_group_nodes mcor_group_place(real x, real y, real z)
{
#if MCOR_LANES == 8
  const mcor_group_nodes nodes = { (realv)(x, x + 1, y, y + 1, z, z + 1, z, z) };
#else
  const mcor_group_nodes nodes = { (
    realv)(x, x + 1, y, y + 1, z, z + 1, z + 2, z + 3, z, z, z, z, z, z, z, z) };
#endif
  return nodes;
}

realv mcor_group_distance(const mcor_group_nodes* nodes, real x, real y, real z, real inv_h)
{
#if MCOR_LANES == 8
  const realv from = (realv)(x, x, y, y, z, z, z, z);
#else
  const realv from = (realv)(x, x, y, y, z, z, z, z, z, z, z, z, z, z, z, z);
#endif
  return MCOR_W(fabs(from - nodes->at) * inv_h);
}

realv mcor_group_weight(realv w, real inv_h)
{
#if MCOR_LANES == 8
  return w.s01010101 * w.s22332233 * w.s44445555;
#else
  return w.s0101010101010101 * w.s2233223322332233 * w.s4444555566667777;
#endif
}
#else
typedef struct
{
  realv x, y, z;
} mcor_group_nodes;

mcor_group_nodes mcor_group_place(real x, real y, real z)
{
  const fixv lane = mcor_lane_index();
  const mcor_group_nodes nodes = { x + MCOR_CONVERT_REALV(lane & 1),
    y + MCOR_CONVERT_REALV(lane >> 1 & 1), z + MCOR_CONVERT_REALV(lane >> 2) };
  return nodes;
}

realv mcor_group_distance(const mcor_group_nodes* nodes, real x, real y, real z, real inv_h)
{
  return mcor_distance(x - nodes->x, y - nodes->y, z - nodes->z, inv_h);
}

#define mcor_group_weight mcor_weight
#endif

/* Adds the tile's particles to group g, whose first node is (x, y, z) from the query's origin.
 * term: their weights times values. */
void mcor_node_add(const mcor_tile* tile, const real* term, int g, real x, real y, real z,
  real share, mcor_node_sums* sums)
{
  const mcor_group_nodes nodes = mcor_group_place(x, y, z);
  int list[MCOR_TILE + 16];
  const int count = mcor_node_list(tile, x, y, z, share, list);
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
      distance[k - begin] =
        mcor_group_distance(&nodes, tile->x[i], tile->y[i], tile->z[i], tile->inv_h[i]);
    }
    for (int k = begin; k < end; ++k)
    {
      const int i = list[k];
      const realv v = mcor_group_weight(distance[k - begin], tile->inv_h[i]);
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

/* Completes the query for nodes of a brick. All bricks of a region count positions from its first
 * node, so that a node's value is the same whichever of its tiles is at hand. */
void mcor_query_in_region(const mcor_grid* grid, int4 brick, mcor_query* query)
{
  const int4 first = brick / MCOR_REGION_BRICKS * MCOR_REGION_BRICKS * MCOR_BRICK;
  const fix origin[3] = { (fix)first.x << grid->fix_bits, (fix)first.y << grid->fix_bits,
    (fix)first.z << grid->fix_bits };
  mcor_query_place(grid, query, origin);
}

/* The query for the nodes of a work-item, MCOR_ITEM_NODES of a brick from `first` on. share: of
 * each particle's support. */
mcor_query mcor_node_query(const mcor_grid* grid, int4 brick, int first, float share)
{
  const int corner[3] = { brick.x * MCOR_BRICK + (first & 3),
    brick.y * MCOR_BRICK + (first >> 2 & 3), brick.z * MCOR_BRICK + (first >> 4) };
  const fix extent = (fix)(MCOR_ITEM_NODES == 1 ? 0 : MCOR_BRICK - 1) << grid->fix_bits;
  mcor_query query;
  query.radius = -share;
  for (int a = 0; a < 3; ++a)
  {
    query.low[a] = (fix)corner[a] << grid->fix_bits;
    query.high[a] = query.low[a] + extent;
  }
  mcor_query_in_region(grid, brick, &query);
  return query;
}

/* Sums at those nodes. The tile may hold the query's particles already. */
void mcor_node_sum(const mcor_grid* grid, mcor_query* query, mcor_tile* tile, mcor_node_sums* sums)
{
  const real share = -query->radius;
  real first[3];
  for (int a = 0; a < 3; ++a)
  {
    first[a] = (real)(query->low[a] - query->origin[a]) * grid->unit;
  }
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
      const int4 node = mcor_group_node(g);
      mcor_node_add(tile, term, g, first[0] + (real)node.x, first[1] + (real)node.y,
        first[2] + (real)node.z, share, sums);
    }
  }
}

/* A Shepard mean needs this fluid weight. Where solids make up the rest, cells would otherwise
 * reach over voids without any fluid, and rounding noise of a kernel's rim would count as a
 * value. */
#define MCOR_LEAST_WEIGHT ((real)1e-3)

/* Writes the field's values and the trimming weights (-1: no valid value) at the nodes of a
 * work-item, from its first on. */
void mcor_node_store(const mcor_node_sums* sums, __global real* value, __global real* weight)
{
  for (int n = 0; n < MCOR_ITEM_NODES; ++n)
  {
    const int g = mcor_group_of(n), lane = mcor_lane_of(n);
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

/* Writes which nodes of a brick are above the iso value, and which are valid: their weight is not
 * below the node threshold. */
void mcor_node_signs(__global const real* value, __global const real* weight, real iso,
  real node_threshold, __global ulong* above, __global ulong* valid)
{
  ulong a = 0, v = 0;
  for (int n = 0; n < 64; ++n)
  {
    a |= (ulong)(value[n] >= iso) << n;
    v |= (ulong)(MCOR_FIELD == 2 || weight[n] >= node_threshold) << n;
  }
  *above = a;
  *valid = v;
}
