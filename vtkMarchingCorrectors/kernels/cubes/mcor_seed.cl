/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Complete seeds [III-C]: which bricks of nodes are to be evaluated, so that no crossed edge is
 * missed. Nodes are left out where the side of the iso value that they are on is certain without,
 * or where their weight is certain to be too low: whole blocks (32^3 nodes) or more of them,
 * regions (8^3) and bricks (4^3). A crossed edge has nodes on both sides. If both were left out,
 * two neighbouring bricks would be certain of different sides: those are evaluated after all
 * (mcor_seed_request). If one was, an evaluated brick would have a node on the other side than its
 * neighbour: that is evaluated then (mcor_seed_grow). All bricks of regions that are not certain
 * have slots while they are tested, so that the particles gathered for the bound serve the nodes'
 * values, too (mcor_seed_bricks). */

#if !MCOR_OF_LATTICE
/* Whether the range of raw values decides: a Shepard mean with weights >= 0 lies between the least
 * and the greatest of its values. */
#define MCOR_RANGE_DECIDES (MCOR_FIELD == 0 && !MCOR_TENSOR)

/* Parameters on which a node's side depends. side_margin: how far rounding may move a mean of values that are
 * all on one side, as a share of each; see mcor_side_margin in mcor_seed.c. */
typedef struct
{
  __global const uchar* side_flags; /* see mcor_seed_side_flags */
  real side_margin, iso, node_threshold;
} mcor_seed_limits;

#define MCOR_SEED_PARAMS                                                                           \
  __global const uchar *side_flags, const real side_margin, const real iso,                        \
    const real node_threshold
#define MCOR_SEED_LIMITS                                                                           \
  {                                                                                                \
    side_flags, side_margin, iso, node_threshold                                                   \
  }

/* Sides of the iso value on which particles are: bit 0 above, bit 1 below; both where it is so close
 * that a mean of such values may round to the other side. Kept for every MCOR_SIDE_PARTICLES successive
 * sorted particles, so that most queries need not look at particles. */

#if MCOR_OF_FIELD
/* One work-item = one run. Writes its fluid particles' sides. */
__kernel void mcor_seed_side_flags(const int particle_count, __global const real* weight,
  __global const real* value, const real side_margin, const real iso, __global uchar* side_flags)
{
  const int begin = get_global_id(0) * MCOR_SIDE_PARTICLES;
  if (begin >= particle_count)
  {
    return;
  }
  int seen = 0;
  for (int j = begin; j < min(begin + MCOR_SIDE_PARTICLES, particle_count); ++j)
  {
    const real margin = side_margin * fabs(value[j]);
    const int side = (value[j] - margin >= iso ? 0 : 2) | (value[j] + margin < iso ? 0 : 1);
    seen |= (MCOR_SOLIDS && weight[j] == 0) ? 0 : side;
  }
  side_flags[get_global_id(0)] = (uchar)seen;
}
#endif

/* Sides of all particles that may reach a query's box, and maybe some more. */
int mcor_query_side_flags(
  const mcor_grid* grid, mcor_query* query, __global const uchar* side_flags)
{
  int seen = 0;
  mcor_query_next_level(grid, query, 0);
  while (seen != 3 && (query->begin < query->end || mcor_query_next_row(grid, query)))
  {
    for (int c = query->begin / MCOR_SIDE_PARTICLES;
         c <= (query->end - 1) / MCOR_SIDE_PARTICLES && seen != 3; ++c)
    {
      seen |= side_flags[c];
    }
    query->begin = query->end;
  }
  return seen;
}

/* The query for a cube of nodes, `cubes` long, from the first one of a brick on. */
MCOR_ONE_COPY mcor_query mcor_seed_query(const mcor_grid* grid, int4 brick, int cubes)
{
  mcor_query query;
  query.radius = -1;
  query.low[0] = (fix)(brick.x * MCOR_BRICK) * grid->step[0];
  query.low[1] = (fix)(brick.y * MCOR_BRICK) * grid->step[1];
  query.low[2] = (fix)(brick.z * MCOR_BRICK) * grid->step[2];
  for (int a = 0; a < 3; ++a)
  {
    query.high[a] = query.low[a] + (fix)cubes * grid->step[a];
  }
  mcor_query_in_region(grid, brick, &query);
  return query;
}

/* Sides of the tile's particles. */
int mcor_tile_sides(const mcor_tile* tile, real side_margin, real iso)
{
  fixv above = 0, below = 0;
  for (int i = 0; i < tile->count; i += MCOR_LANES)
  {
    const realv value = MCOR_TILE(tile, value, i), margin = side_margin * fabs(value);
    const fixv counts = MCOR_TILE(tile, weight, i) != 0;
    above = above || (counts && !(value + margin < iso));
    below = below || (counts && !(value - margin >= iso));
  }
  return (MCOR_ANY(above) ? 1 : 0) | (MCOR_ANY(below) ? 2 : 0);
}

/* A coarse cube that more particles reach is divided without a bound. */
#define MCOR_COARSE_PARTICLES 1024

/* State of a cube of nodes, the query's box, whose particles are left in the tile; it may hold them
 * before. Of a coarse one, less is asked: it may be taken for certain where a part is void, and for
 * undecided. */
int mcor_seed_state(const mcor_grid* grid, mcor_query* query, mcor_tile* tile, bool coarse,
  const mcor_seed_limits* limits)
{
  const int of_sides[3] = { MCOR_VOID, MCOR_ABOVE, MCOR_BELOW };
  if (MCOR_RANGE_DECIDES && coarse)
  {
    const int seen = mcor_query_side_flags(grid, query, limits->side_flags);
    if (seen != 3)
    {
      return of_sides[seen];
    }
  }
  mcor_bound bound = mcor_bound_start();
  int seen = 0;
  for (bool first = true; mcor_tile_next(grid, query, tile, first); first = false)
  {
    seen |= MCOR_RANGE_DECIDES ? mcor_tile_sides(tile, limits->side_margin, limits->iso) : 3;
    if (coarse && bound.count + tile->count > MCOR_COARSE_PARTICLES)
    {
      return MCOR_EXAMINE;
    }
    if (tile->complete && seen != 3)
    {
      break;
    }
    mcor_bound_add(query, tile, limits->iso, &bound);
  }
  if (MCOR_RANGE_DECIDES && seen != 3)
  {
    return of_sides[seen];
  }
  if (bound.count == 0)
  {
    const bool is_void = MCOR_FIELD == 0 || (MCOR_FIELD == 1 && limits->node_threshold > 0);
    return is_void ? MCOR_VOID : limits->iso <= 0 ? MCOR_ABOVE : MCOR_BELOW;
  }
  return mcor_bound_state(&bound, limits->iso, limits->node_threshold);
}

#define MCOR_REGION_CUBES (MCOR_REGION_BRICKS * MCOR_BRICK)

/* Number of a region's first brick, and offsets of the numbers of all of them. */
int mcor_region_number(int region)
{
  const int block = region / MCOR_BLOCK_REGIONS, r = region % MCOR_BLOCK_REGIONS;
  return block * MCOR_BLOCK_BRICKS + 2 * (r & 3) + 16 * (r >> 2 & 3) + 128 * (r >> 4);
}
int mcor_region_offset(int b)
{
  return (b & 1) + 8 * (b >> 1 & 1) + 64 * (b >> 2);
}

/* Share of the query's box and what is in reach of it that the tile's particles fill, roughly. */
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

/* With less than this filled, a brick is taken to be near the surface. */
#define MCOR_INSIDE_FILLED ((real)0.8f)

/* A share of each particle's support. */
#define MCOR_INSIDE_SHARE 0.5f

/* Whether that proof is tried: by regions, where a work-item evaluates whole bricks, else by
 * bricks. */
#define MCOR_PROVES_INSIDE (MCOR_FIELD == 2 && !MCOR_TENSOR)

#if MCOR_PROVES_INSIDE && MCOR_LANES > 1
/* Whether those of a tile's particles that are close to any of 2 x 2 points, as many above each other as there are
 * lanes, `step` apart from `at` on, lift all points above the iso value. The order of the sum is not that of nodes:
 * the margin covers it, too. */
bool mcor_points_are_inside(const mcor_tile* tile, const real at[3], const real step[3], real iso)
{
  const fixv lane = mcor_lane_index();
  const real ex = (real)0.5 * step[0], ey = (real)0.5 * step[1],
             ez = (real)0.5 * step[2] * (MCOR_LANES / 4 - 1);
  const realv px = at[0] + step[0] * MCOR_CONVERT_REALV(lane & 1);
  const realv py = at[1] + step[1] * MCOR_CONVERT_REALV(lane >> 1 & 1);
  const realv pz = at[2] + step[2] * MCOR_CONVERT_REALV(lane >> 2);
  realv w = 0;
  for (int begin = 0; begin < tile->count && !MCOR_ALL(w > iso * (real)1.0001f);
       begin += MCOR_LANES)
  {
    const fixv near = mcor_tile_near(MCOR_TILE(tile, x, begin), MCOR_TILE(tile, y, begin),
      MCOR_TILE(tile, z, begin), MCOR_TILE(tile, inv_h, begin), at[0] + ex, at[1] + ey, at[2] + ez,
      ex, ey, ez, MCOR_INSIDE_SHARE);
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

/* Whether they do so at the nodes on a leaf's far sides, of its level. The finer ones there are nodes of finer leaves,
 * too: either own ones, which a proof of those knows, or on their far sides, where a leaf beside a larger one is
 * chosen. The march goes on from there. tile: what is close to all of the leaf. */
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

/* A brick is MCOR_ABOVE if the particles within half their support of its nodes, an eighth of all, which make
 * up most of the weight sum there, alone lift all nodes above the iso value: with a kernel w >= 0
 * the rest can only add, in rounded sums, too, as rounding is monotone and the order is the same.
 * The margin is for a compiler that rounds the same term in another way in another place. Far inside
 * the fluid, no more is ever evaluated. Else MCOR_EXAMINE. Of a leaf beside others, `finer` or coarser, that does not
 * hold on its far sides, too, these are open. wide: those of the brick's region, if it is complete. */
int mcor_seed_proof(
  const mcor_grid* grid, int4 brick, uint finer, const mcor_tile* wide, real iso)
{
  int state = MCOR_ABOVE;
  for (int first = 0; first < 64 && state != MCOR_EXAMINE; first += MCOR_ITEM_NODES)
  {
    mcor_query query = mcor_node_query(grid, brick, first, finer != 0, MCOR_INSIDE_SHARE);
    mcor_node_sums sums;
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
    mcor_node_sum(grid, &query, &tile, &sums);
    for (int g = 0; g < MCOR_NODE_GROUPS; ++g)
    {
      state = MCOR_ALL(sums.w[g] > iso * (real)1.0001f) ? state : MCOR_EXAMINE;
    }
    if (state == MCOR_ABOVE && finer &&
      !(tile.complete && mcor_sides_are_inside(grid, &query, &tile, iso)))
    {
      state |= MCOR_OPEN_SIDES;
    }
  }
  return state;
}

/* The bricks of a region, bits x, y, z, that are leaves; with one level all are. */
uint mcor_region_leaves(MCOR_TREE_PARAMS, int number)
{
  uint found = 0;
  for (int b = 0; b < 8 && has_leaves; ++b)
  {
    found |= (uint)mcor_has_brick(leaves, number + mcor_region_offset(b)) << b;
  }
  return has_leaves ? found : 0xff;
}

/* What the range of raw values tells of a query's box, as a state. */
int mcor_seed_range(const mcor_grid* grid, mcor_query* query, const mcor_seed_limits* limits)
{
  const int of_sides[4] = { MCOR_VOID, MCOR_ABOVE, MCOR_BELOW, MCOR_EXAMINE };
  return of_sides[MCOR_RANGE_DECIDES ? mcor_query_side_flags(grid, query, limits->side_flags) : 3];
}

/* Parameters of mcor_seed_regions and mcor_plane_seeds, which are launched alike. */
#define MCOR_REGION_PARAMS                                                                         \
  MCOR_GRID_PARAMS, const int first, const int count, __global const mcor_rung *rungs,             \
    __global const ulong *block_keys, __global const uchar *block_states, MCOR_TREE_PARAMS,        \
    MCOR_SEED_PARAMS, __global uchar *states, __global uint *brick_bits, __global int *list,       \
    __global int *list_count

/* One work-item = one region, of `count` from `first` on. Reads the particles that reach it, and the states of blocks,
 * which with several levels are not known. Writes the states of its bricks, or leaves, as far as the region tells;
 * requests those that are not certain, and lists the regions that have such, in any order from
 * number `first` on; list_count: of each level. With several levels, a
 * region has the nodes on its far sides, too. */
__kernel void mcor_seed_regions(MCOR_REGION_PARAMS)
{
  const int region = first + get_global_id(0);
  if (region >= first + count)
  {
    return;
  }
  const int number = mcor_region_number(region);
  const uint own = mcor_region_leaves(MCOR_TREE_ARGS, number);
  if (own == 0)
  {
    return;
  }
  int state = has_leaves ? MCOR_EXAMINE : block_states[region / MCOR_BLOCK_REGIONS];
  const mcor_grid grid = MCOR_GRID;
  const mcor_seed_limits limits = MCOR_SEED_LIMITS;
  const int4 brick = mcor_brick_of_number(rungs, block_keys, number);
  mcor_query query = mcor_seed_query(&grid, brick, MCOR_REGION_CUBES - 1 + has_leaves);
  mcor_tile tile;
  mcor_tile_init(&tile);
  uint inside = 0, open = 0; /* bricks */
  if (has_leaves)
  {
    state = mcor_seed_range(&grid, &query, &limits);
  }
  if (MCOR_PROVES_INSIDE && MCOR_ITEM_NODES == 64 && state == MCOR_EXAMINE)
  {
    query.radius = -MCOR_INSIDE_SHARE;
    mcor_tile_next(&grid, &query, &tile, true);
    for (uint rest = tile.count > 0 ? own : 0; rest; rest &= rest - 1)
    {
      const int b = mcor_ctz(rest), m = number + mcor_region_offset(b);
      const int proof = mcor_seed_proof(&grid, brick + (int4)(b & 1, b >> 1 & 1, b >> 2, 0),
        has_leaves ? finer[m] : 0, &tile, iso);
      inside |= (uint)(proof != MCOR_EXAMINE) << b;
      open |= (uint)((proof & MCOR_OPEN_SIDES) != 0) << b;
    }
    query.radius = -1;
    mcor_tile_init(&tile);
  }
  if (state == MCOR_EXAMINE && inside == 0)
  {
    state = mcor_seed_state(&grid, &query, &tile, false, &limits);
  }
  for (uint rest = own; rest; rest &= rest - 1)
  {
    const int b = mcor_ctz(rest), m = number + mcor_region_offset(b);
    states[m] = (uchar)(inside >> b & 1 ? MCOR_ABOVE | (open >> b & 1) * MCOR_OPEN_SIDES : state);
    if (states[m] == MCOR_EXAMINE)
    {
      mcor_request_brick(brick_bits, m);
    }
  }
  if (state == MCOR_EXAMINE && (own & ~inside))
  {
    list[first + atomic_inc(list_count + brick.w)] = region;
  }
}

/* State of a brick whose region is not certain: of its nodes, of a leaf beside other levels also of those on its far
 * sides. wide: the particles of the region, if it is complete. As the brick's are at hand, its nodes are evaluated if they are to be, where a
 * work-item evaluates whole bricks; returns the known ones. */
ulong mcor_seed_brick(const mcor_grid* grid, int4 brick, uint finer, const mcor_tile* wide,
  const mcor_seed_limits* limits, __global uchar* state, __global real* value,
  __global real* weight)
{
  mcor_tile tile;
  const int proof = MCOR_PROVES_INSIDE && MCOR_ITEM_NODES != 64
    ? mcor_seed_proof(grid, brick, finer, wide, limits->iso)
    : MCOR_EXAMINE;
  if (proof != MCOR_EXAMINE)
  {
    *state = (uchar)proof;
    return 0;
  }
  mcor_query query = mcor_seed_query(grid, brick, MCOR_BRICK - (finer == 0));
  mcor_tile_init(&tile);
  if (wide->complete)
  {
    mcor_tile_narrow(wide, &query, &tile);
  }
  *state = (uchar)mcor_seed_state(grid, &query, &tile, false, limits);
  if (*state != MCOR_EXAMINE || MCOR_ITEM_NODES != 64)
  {
    return 0;
  }
  mcor_node_sums sums;
  mcor_node_sum(grid, &query, &tile, &sums);
  mcor_node_store(&sums, value, weight);
  return ~0UL;
}

/* Bricks of a region that a work-item treats. */
#define MCOR_ITEM_BRICKS (MCOR_ITEM_NODES == 64 ? 8 : 1)

/* One work-item = MCOR_ITEM_BRICKS bricks of a region of the list, of `count` from `first` on. Reads the particles that reach
 * it. Of bricks of which nothing is known, writes the states, and the nodes known by now with their
 * values and signs. */
__kernel void mcor_seed_bricks(MCOR_GRID_PARAMS, const int first, const int count,
  MCOR_BRICK_PARAMS, MCOR_TREE_PARAMS, __global const int* list, MCOR_SEED_PARAMS, __global uchar* states, __global ulong* known,
  __global real* node_value, __global real* node_weight, __global ulong* above,
  __global ulong* valid)
{
  const int i = get_global_id(0) / (8 / MCOR_ITEM_BRICKS);
  if (i >= count)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const mcor_seed_limits limits = MCOR_SEED_LIMITS;
  const int number = mcor_region_number(list[first + i]);
  const int4 region = mcor_brick_of_number(rungs, block_keys, number);
  mcor_query query = mcor_seed_query(&grid, region, MCOR_REGION_CUBES - 1 + has_leaves);
  mcor_tile wide;
  mcor_tile_init(&wide);
  if (MCOR_ITEM_BRICKS > 1)
  {
    mcor_tile_next(&grid, &query, &wide, true);
  }
  const int own = get_global_id(0) % (8 / MCOR_ITEM_BRICKS) * MCOR_ITEM_BRICKS;
  for (int b = own; b < own + MCOR_ITEM_BRICKS; ++b)
  {
    const int m = number + mcor_region_offset(b);
    const int slot = mcor_slot_of_number(brick_bits, brick_base, m);
    if (slot >= 0 && !known[slot])
    {
      const int4 brick = region + (int4)(b & 1, b >> 1 & 1, b >> 2, 0);
      __global real *value = node_value + slot * 64L, *weight = node_weight + slot * 64L;
      known[slot] = mcor_seed_brick(
        &grid, brick, has_leaves ? finer[m] : 0, &wide, &limits, states + m, value, weight);
      if (known[slot])
      {
        const ulong2 signs = mcor_node_signs(value, weight, iso, node_threshold);
        above[slot] = signs.x;
        valid[slot] = signs.y;
      }
    }
  }
}

#if MCOR_PROVES_INSIDE
/* One work-item = one slot, of `count` from `first` on. Tries the proof where its nodes are neither known nor
 * certain, and it was not tried. */
__kernel void mcor_seed_prove(MCOR_GRID_PARAMS, const int first, const int count,
  __global const int4* bricks, __global const ulong* known, const real iso, __global uchar* proofs,
  __global ulong* above, __global ulong* valid)
{
  const int slot = first + get_global_id(0);
  if (slot >= first + count || known[slot] || proofs[slot] != MCOR_UNTRIED)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  mcor_tile none;
  mcor_tile_init(&none);
  proofs[slot] = (uchar)mcor_seed_proof(&grid, bricks[slot], 0, &none, iso);
  if (proofs[slot] == MCOR_ABOVE)
  {
    above[slot] = valid[slot] = ~0UL;
  }
}
#endif
#endif

#if MCOR_OF_LATTICE
/* A block and those left and right of it, or -1. */
int3 mcor_seed_blocks(MCOR_BLOCK_PARAMS, int level, int x, int y, int z)
{
  return (int3)(mcor_find_block(MCOR_BLOCK_ARGS, level, x - 1, y, z),
    mcor_find_block(MCOR_BLOCK_ARGS, level, x, y, z),
    mcor_find_block(MCOR_BLOCK_ARGS, level, x + 1, y, z));
}

/* Which of the bricks x = -1 to 8 (bits 0 to 9) of a row are certain to be above, and to be below
 * (from bit 16 on). row: place of the row in the blocks. */
uint mcor_seed_row(int3 blocks, int row, __global const uchar* states)
{
  uint sides = 0;
  for (int x = -1; x <= 8; ++x)
  {
    const int block = x < 0 ? blocks.x : x < 8 ? blocks.y : blocks.z;
    const int state = block < 0 ? MCOR_VOID : states[block * MCOR_BLOCK_BRICKS + row + (x & 7)];
    sides |= (uint)(state == MCOR_ABOVE) << (x + 1) | (uint)(state == MCOR_BELOW) << (x + 17);
  }
  return sides;
}

/* One work-item = one row of 8 bricks of a block. Reads the states. Requests each brick that is to
 * be examined, or certain to be on another side than one next to it. */
__kernel void mcor_seed_request(MCOR_BLOCK_PARAMS, __global const uchar* inactive,
  __global const uchar* states, __global uint* brick_bits)
{
  const int m = get_global_id(0) * 8;
  if (m >= block_count * MCOR_BLOCK_BRICKS || inactive[m / MCOR_BLOCK_BRICKS])
  {
    return;
  }
  int seen = 0;
  for (int x = 0; x < 8; ++x)
  {
    seen |= 1 << states[m + x];
  }
  uint beside = 0;
  if (seen & (1 << MCOR_ABOVE | 1 << MCOR_BELOW))
  {
    const int4 brick = mcor_brick_of_number(rungs, block_keys, m), own = brick >> 3;
    const int3 blocks = mcor_seed_blocks(MCOR_BLOCK_ARGS, brick.w, own.x, own.y, own.z);
    for (int d = 0; d < 9; ++d)
    {
      const int y = brick.y + d % 3 - 1, z = brick.z + d / 3 - 1;
      const bool within = y >> 3 == own.y && z >> 3 == own.z;
      beside |= mcor_seed_row(
        within ? blocks : mcor_seed_blocks(MCOR_BLOCK_ARGS, brick.w, own.x, y >> 3, z >> 3),
        (z & 7) * 64 + (y & 7) * 8, states);
    }
  }
  for (int x = 0; x < 8; ++x)
  {
    const int state = states[m + x];
    if (state == MCOR_EXAMINE || (state == MCOR_ABOVE && beside >> (x + 16) & 7) ||
      (state == MCOR_BELOW && beside >> x & 7))
    {
      mcor_request_brick(brick_bits, m + x);
    }
  }
}

/* One work-item = one brick; those without `fresh` nodes have been looked at before. Reads its
 * nodes' sides, and the states of bricks around it that are not evaluated. Requests those certain
 * of another side than a valid node next to them. */
__kernel void mcor_seed_grow(MCOR_BLOCK_PARAMS, const int brick_count, __global const int4* bricks,
  __global const ulong* fresh, __global const ulong* above, __global const ulong* valid,
  __global const uchar* states, __global uint* brick_bits, __global int* grown)
{
  const int slot = get_global_id(0);
  if (slot >= brick_count || fresh[slot] == 0)
  {
    return;
  }
  const int4 brick = bricks[slot];
  const int own = mcor_brick_number(MCOR_BLOCK_ARGS, brick.w, brick.x, brick.y, brick.z);
  for (int d = 0; d < 27; ++d)
  {
    const int x = d % 3, y = d / 3 % 3, z = d / 9;
    const int m = mcor_number_beside(MCOR_BLOCK_ARGS, own, brick, x - 1, y - 1, z - 1);
    const int state = m < 0 ? MCOR_VOID : states[m];
    if (state != MCOR_ABOVE && state != MCOR_BELOW)
    {
      continue;
    }
    const ulong beside = (x == 1 ? ~0UL : MCOR_LOW_X << (x == 0 ? 0 : 3)) &
      (y == 1 ? ~0UL : MCOR_LOW_Y << (y == 0 ? 0 : 12)) &
      (z == 1 ? ~0UL : MCOR_LOW_Z << (z == 0 ? 0 : 48));
    if ((beside & valid[slot] & (state == MCOR_ABOVE ? ~above[slot] : above[slot])) &&
      mcor_request_brick(brick_bits, m))
    {
      atomic_or(grown, 1);
    }
  }
}
#endif
