/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sums at the nodes of a brick, in groups of nodes, see mcor_group_of. */

/* mcor_group_place returns the nodes of a group, in cubes from the query's origin.
 * mcor_group_distance and mcor_group_weight compute a particle's weights at the nodes in two steps,
 * as mcor_distance and mcor_weight do. */
#if MCOR_TENSOR
/* A tensor kernel is a product of three factors w, one for each axis. The nodes of a group have two
 * different x, two different y and MCOR_GROUP_Z different z. One evaluation gives w for all these
 * coordinates: lanes 0 and 1 hold x, lanes 2 and 3 hold y, the lanes from 4 on hold z. */
typedef struct
{
  realv at;
} mcor_group_nodes;

mcor_group_nodes mcor_group_place(const real edge[3], const real first[3])
{
  const real x = first[0], y = first[1], z = first[2], ex = edge[0], ey = edge[1], ez = edge[2];
#if MCOR_LANES == 8
  const mcor_group_nodes nodes = { (realv)(x, x + ex, y, y + ey, z, z + ez, z, z) };
#else
  const mcor_group_nodes nodes = { (
    realv)(x, x + ex, y, y + ey, z, z + ez, z + 2 * ez, z + 3 * ez, z, z, z, z, z, z, z, z) };
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

mcor_group_nodes mcor_group_place(const real edge[3], const real first[3])
{
  const fixv lane = mcor_lane_index();
  const mcor_group_nodes nodes = { first[0] + MCOR_CONVERT_REALV(lane & 1) * edge[0],
    first[1] + MCOR_CONVERT_REALV(lane >> 1 & 1) * edge[1],
    first[2] + MCOR_CONVERT_REALV(lane >> 2) * edge[2] };
  return nodes;
}

realv mcor_group_distance(const mcor_group_nodes* nodes, real x, real y, real z, real inv_h)
{
  return mcor_distance(x - nodes->x, y - nodes->y, z - nodes->z, inv_h);
}

#define mcor_group_weight mcor_weight
#endif

/* Adds the tile's particles to the sums of a group. A particle counts within `share` of its
 * support. term: each particle's weight times its value. edge: the distance of neighbouring nodes
 * along each axis, in cubes; first: the group's first node, in cubes from the query's origin. */
void mcor_node_add(const mcor_tile* tile, const real* term, const real edge[3], const real first[3],
  real share, mcor_node_sums* sums)
{
  const mcor_group_nodes nodes = mcor_group_place(edge, first);
  const real ex = (real)0.5 * edge[0], ey = (real)0.5 * edge[1],
             ez = (real)0.5 * (MCOR_GROUP_Z - 1) * edge[2];
  const mcor_span box = { { first[0] + ex, first[1] + ey, first[2] + ez }, { ex, ey, ez } };
  int list[MCOR_TILE_SIZE + 16];
  const int count = mcor_tile_list(tile, &box, share, list);
  realv s = sums->s, w = sums->w, t = sums->t;
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
#if MCOR_FIELD != MCOR_WEIGHT_SUM
      s = MCOR_FMA(term[i], v, s);
#endif
      w = MCOR_FMA(tile->weight[i], v, w);
#if MCOR_SOLIDS
      t = MCOR_FMA(tile->trim_weight[i], v, t);
#endif
    }
  }
  sums->s = s;
  sums->w = w;
  sums->t = t;
}

/* Computes the sums at all groups of nodes of a query that mcor_node_query made. The tile may
 * already hold the query's particles. */
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
    sums[g].s = sums[g].w = sums[g].t = 0;
  }
  for (bool begin = true; mcor_tile_next(grid, query, tile, begin); begin = false)
  {
    MCOR_ALIGNED real term[MCOR_TILE_SIZE + 16];
#if MCOR_FIELD != MCOR_WEIGHT_SUM
    for (int i = 0; i < tile->count; ++i)
    {
      term[i] = tile->weight[i] * tile->value[i];
    }
#endif
    for (int g = 0; g < MCOR_NODE_GROUPS; ++g)
    {
      const int node[3] = { 2 * (g & 1), 2 * (g >> 1 & 1), MCOR_GROUP_Z * (g >> 2) };
      real at[3];
      for (int a = 0; a < 3; ++a)
      {
        at[a] = first[a] + (real)node[a] * grid->edge[a];
      }
      mcor_node_add(tile, term, grid->edge, at, share, sums + g);
    }
  }
}
