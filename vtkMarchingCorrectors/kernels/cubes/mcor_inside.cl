/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Bricks far inside of the fluid [III-C]: the few particles close to a brick's nodes prove that the
 * nodes are above the iso value of the free surface, so that no other particles are read. */

/* Returns roughly which share of a box the tile's particles fill. The box is the query's box,
 * widened on all sides by the distance at which a particle of mean size still counts. unit: see
 * mcor_grid. */
real mcor_seed_filled(const mcor_query* query, real unit, const mcor_tile* tile)
{
  realv volume = 0, inv_h = 0;
  for (int i = 0; i < tile->count; i += MCOR_LANES)
  {
    const realv s = MCOR_TILE(tile, inv_h, i);
    volume += MCOR_TILE(tile, weight, i) / fmax(s * s * s, (realv)1e-30f);
    inv_h += s;
  }
  const real r = -query->radius * MCOR_SUPPORT * tile->count / mcor_lane_sum(inv_h);
  const real e = (real)(query->high[0] - query->low[0]) * unit;
  const real box = e * e * e + 6 * e * e * r + M_PI_F * r * r * (3 * e + 4 * r / 3);
  return mcor_lane_sum(volume) / (MCOR_NORM * box);
}

/* If particles fill less than this share of the space around a brick, the brick counts as near the
 * surface, and the proof fails. */
#define MCOR_INSIDE_FILLED ((real)0.8f)

/* The proof reads a particle only at nodes within this share of the particle's support. */
#define MCOR_INSIDE_SHARE 0.5f

/* Whether kernels try to prove that bricks are inside of the fluid: mcor_seed_regions if a
 * work-item evaluates whole bricks, mcor_seed_brick if a work-item evaluates single nodes. */
#define MCOR_PROVES_INSIDE (MCOR_FIELD == MCOR_WEIGHT_SUM && !MCOR_TENSOR)

#if MCOR_PROVES_INSIDE && MCOR_LANES > 1
/* Whether 2 x 2 x MCOR_LANES / 4 points are all above the iso value because of the tile's particles
 * that are close to them. at: the lowest point, in cubes from the query's origin; step: the
 * distance between points along each axis. The terms are added in another order than where a node
 * is evaluated; the margin of 1.0001 is larger than the difference of the sums. */
bool mcor_points_are_inside(const mcor_tile* tile, const real at[3], const real step[3], real iso)
{
  const fixv lane = mcor_lane_index();
  const real ex = (real)0.5 * step[0], ey = (real)0.5 * step[1],
             ez = (real)0.5 * step[2] * (MCOR_LANES / 4 - 1);
  const mcor_span box = { { at[0] + ex, at[1] + ey, at[2] + ez }, { ex, ey, ez } };
  const realv px = at[0] + step[0] * MCOR_CONVERT_REALV(lane & 1);
  const realv py = at[1] + step[1] * MCOR_CONVERT_REALV(lane >> 1 & 1);
  const realv pz = at[2] + step[2] * MCOR_CONVERT_REALV(lane >> 2);
  realv w = 0;
  for (int begin = 0; begin < tile->count && !MCOR_ALL(w > iso * (real)1.0001f);
       begin += MCOR_LANES)
  {
    const fixv near = mcor_tile_near(tile, begin, &box, MCOR_INSIDE_SHARE);
    int list[MCOR_LANES];
    const int count = mcor_list_lanes(near, min(MCOR_LANES, tile->count - begin), list);
    for (int k = 0; k < count; ++k)
    {
      const int i = begin + list[k];
      const real inv_h = tile->inv_h[i];
      const realv d = mcor_distance(tile->x[i] - px, tile->y[i] - py, tile->z[i] - pz, inv_h);
      w = MCOR_FMA(tile->weight[i], mcor_weight(d, inv_h), w);
    }
  }
  return MCOR_ALL(w > iso * (real)1.0001f);
}

/* Whether particles close to a leaf's nodes lift the nodes on the leaf's far sides (its upper
 * faces) above the iso value. Only nodes of the leaf's own level are tested. Finer nodes on the far
 * sides belong to finer leaves, which have proofs of their own. If the test fails, mcor_leaf_choose
 * chooses the leaf as one that may have surface. query: the box of the leaf's nodes; tile: the
 * close particles. */
bool mcor_sides_are_inside(
  const mcor_grid* grid, const mcor_query* query, const mcor_tile* tile, real iso)
{
  bool inside = true;
  for (int side = 0; side < 3; ++side)
  {
    const int x0 = side == 0 ? MCOR_BRICK : 0, y0 = side == 1 ? MCOR_BRICK : 0,
              z0 = side == 2 ? MCOR_BRICK : 0;
    for (int z = z0; z <= MCOR_BRICK && inside; z += MCOR_LANES / 4)
    {
      for (int y = y0; y <= MCOR_BRICK && inside; y += 2)
      {
        for (int x = x0; x <= MCOR_BRICK && inside; x += 2)
        {
          const int node[3] = { x, y, z };
          real at[3];
          for (int a = 0; a < 3; ++a)
          {
            at[a] = (real)(query->low[a] - query->origin[a]) * grid->unit + grid->edge[a] * node[a];
          }
          inside = mcor_points_are_inside(tile, at, grid->edge, iso);
        }
      }
    }
  }
  return inside;
}
#else
bool mcor_sides_are_inside(
  const mcor_grid* grid, const mcor_query* query, const mcor_tile* tile, real iso)
{
  return false;
}
#endif

/* Returns MCOR_ABOVE if close particles alone lift all nodes of a brick above the iso value. If
 * they do not, or fill less than MCOR_INSIDE_FILLED of the space, returns MCOR_EXAMINE. A particle
 * is close to nodes within half its support. About an eighth of the particles that reach a node are
 * close to the node, and make up most of the weight sum. Other particles can only add to the sum:
 * w >= 0, rounding is monotone, and terms keep their order. The margin of 1.0001 allows for a
 * compiler that rounds the same term differently elsewhere.
 *
 * beside: whether the brick is a leaf beside finer or coarser leaves. If so, the nodes on the
 * leaf's far sides are tested, too; if this test fails, MCOR_OPEN_SIDES is added to MCOR_ABOVE.
 * wide: a tile of the particles close to the brick's region. If `wide` is not complete, the brick's
 * own close particles are gathered instead. */
int mcor_seed_proof(
  const mcor_grid* grid, int4 brick, bool beside, const mcor_tile* wide, real iso)
{
  int state = MCOR_ABOVE;
  for (int first = 0; first < 64 && state != MCOR_EXAMINE; first += MCOR_ITEM_NODES)
  {
    mcor_query query = mcor_node_query(grid, brick, mcor_place_of(first),
      MCOR_ITEM_NODES == 1 ? 0 : MCOR_ITEM_EXTENT + beside, MCOR_INSIDE_SHARE);
    mcor_node_sums sums[MCOR_NODE_GROUPS];
    mcor_tile tile;
    mcor_tile_init(&tile);
    if (wide->complete)
    {
      mcor_tile_narrow(wide, &query, &tile);
    }
    else
    {
      mcor_tile_next(grid, &query, &tile, true);
    }
    if (tile.count == 0 ||
      (tile.complete && mcor_seed_filled(&query, grid->unit, &tile) < MCOR_INSIDE_FILLED))
    {
      return MCOR_EXAMINE;
    }
    mcor_node_sum(grid, &query, &tile, sums);
    for (int g = 0; g < MCOR_NODE_GROUPS; ++g)
    {
      state = MCOR_ALL(sums[g].w > iso * (real)1.0001f) ? state : MCOR_EXAMINE;
    }
    if (state == MCOR_ABOVE && beside &&
      !(tile.complete && mcor_sides_are_inside(grid, &query, &tile, iso)))
    {
      state |= MCOR_OPEN_SIDES;
    }
  }
  return state;
}
