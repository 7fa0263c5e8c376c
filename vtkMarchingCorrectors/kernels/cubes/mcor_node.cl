/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Evaluation of the field at nodes. This file has mcor_node_sum for GPUs, mcor_node_lanes.cl has it
 * for CPUs. */

/* MCOR_ITEM_NODES: how many nodes one work-item evaluates. With one lane, the number is 1. With
 * several lanes, it is 64, the nodes of a brick, in MCOR_NODE_GROUPS groups of MCOR_LANES nodes.
 * MCOR_ITEM_EXTENT: how many cubes lie between the first and the last of these nodes along each
 * axis. */
#define MCOR_ITEM_NODES (MCOR_LANES == 1 ? 1 : 64)
#define MCOR_NODE_GROUPS (MCOR_ITEM_NODES / MCOR_LANES)
#define MCOR_ITEM_EXTENT (MCOR_ITEM_NODES == 1 ? 0 : MCOR_BRICK - 1)

/* Sums at a group of nodes, one node in each lane: s = sum V (A - A0) W, w = sum V W, and, with
 * solids, the trimming weight t. A0 is a shift of all particles' values. */
typedef struct
{
  realv s, w, t;
} mcor_node_sums;

/* mcor_group_of returns the group of a work-item's n-th node, mcor_lane_of the node's lane in the
 * group. A group has 2 x 2 x MCOR_GROUP_Z nodes, which are close together. If MCOR_LANES is 1, a
 * group is a single node. */
#define MCOR_GROUP_Z (MCOR_LANES == 1 ? 1 : MCOR_LANES / 4)
int mcor_group_of(int n)
{
  return (n >> 1 & 1) | (n >> 3 & 1) << 1 | (n >> 4) / MCOR_GROUP_Z << 2;
}
int mcor_lane_of(int n)
{
  return (n & 1) | (n >> 2 & 1) << 1 | (n >> 4) % MCOR_GROUP_Z << 2;
}

/* Adds all particles of a tile to the sums at MCOR_LANES nodes. x, y, z: the nodes, in cubes from
 * the query's origin. */
void mcor_sums_add(const mcor_tile* tile, realv x, realv y, realv z, mcor_node_sums* sums)
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
#if MCOR_FIELD != MCOR_WEIGHT_SUM
      sums->s = MCOR_FMA(weight * MCOR_EACH(tile, value, i), v, sums->s);
#endif
      sums->w = MCOR_FMA(weight, v, sums->w);
#if MCOR_SOLIDS
      sums->t = MCOR_FMA(MCOR_EACH(tile, trim_weight, i), v, sums->t);
#endif
    }
  }
}

#if MCOR_LANES == 1
/* Computes the sums at the only node of a query that mcor_node_query made. */
void mcor_node_sum(const mcor_grid* grid, mcor_query* query, mcor_tile* tile, mcor_node_sums* sums)
{
  const real x = (real)(query->low[0] - query->origin[0]) * grid->unit;
  const real y = (real)(query->low[1] - query->origin[1]) * grid->unit;
  const real z = (real)(query->low[2] - query->origin[2]) * grid->unit;
  sums->s = sums->w = sums->t = 0;
  for (bool begin = true; mcor_tile_next(grid, query, tile, begin); begin = false)
  {
    mcor_sums_add(tile, x, y, z, sums);
  }
}
#endif

/* Returns the query for the box of nodes of a brick from node `first` to node first + extent. A
 * particle counts within `share` of its support. All bricks of a region (2 x 2 x 2 bricks) count
 * positions from the region's first node. So a node's value is the same whether the particles were
 * gathered for the brick or for the whole region. */
MCOR_ONE_COPY mcor_query mcor_node_query(
  const mcor_grid* grid, int4 brick, int4 first, int4 extent, float share)
{
  const int4 low = brick * MCOR_BRICK + first, high = low + extent;
  const int4 region = brick / MCOR_REGION_BRICKS * MCOR_REGION_BRICKS * MCOR_BRICK;
  const int from[3] = { low.x, low.y, low.z }, to[3] = { high.x, high.y, high.z };
  const int begin[3] = { region.x, region.y, region.z };
  fix origin[3];
  mcor_query query;
  query.radius = -share;
  for (int a = 0; a < 3; ++a)
  {
    query.low[a] = (fix)from[a] * grid->step[a];
    query.high[a] = (fix)to[a] * grid->step[a];
    origin[a] = (fix)begin[a] * grid->step[a];
  }
  mcor_query_place(grid, &query, origin);
  return query;
}

/* Writes the field's value (less A0) and the trimming weight (-1: there is no Shepard mean) of the
 * node whose sums are in a lane. */
void mcor_sums_store(
  const mcor_node_sums* sums, int lane, __global real* value, __global real* weight)
{
  const real s = MCOR_GET(sums->s, lane), w = MCOR_GET(sums->w, lane);
  const real t = MCOR_SOLIDS ? MCOR_GET(sums->t, lane) : w;
  const bool defined = MCOR_FIELD != MCOR_SHEPARD || w >= (real)MCOR_LEAST_NODE_WEIGHT;
  *value = MCOR_FIELD == MCOR_WEIGHT_SUM ? w : MCOR_FIELD == MCOR_SUM ? s : defined ? s / w : (real)0;
  *weight = defined ? t : (real)-1;
}

/* Writes the field's values and the trimming weights of a work-item's nodes. */
void mcor_node_store(const mcor_node_sums* sums, __global real* value, __global real* weight)
{
  for (int n = 0; n < MCOR_ITEM_NODES; ++n)
  {
    mcor_sums_store(sums + mcor_group_of(n), mcor_lane_of(n), value + n, weight + n);
  }
}

/* Returns two masks of a brick's nodes: the nodes above the iso value, and the valid nodes. A node
 * is valid if its weight is not below the node threshold; for a weight sum, all nodes are valid. */
ulong2 mcor_node_signs(
  __global const real* value, __global const real* weight, real iso, real node_threshold)
{
  ulong a = 0, v = 0;
  for (int n = 0; n < 64; ++n)
  {
    a |= (ulong)(value[n] >= iso) << n;
    v |= (ulong)(MCOR_FIELD == MCOR_WEIGHT_SUM || weight[n] >= node_threshold) << n;
  }
  return (ulong2)(a, v);
}
