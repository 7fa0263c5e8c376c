/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Complete seeds [III-C]: finds the bricks whose nodes must be evaluated so that no crossed edge is
 * missed. Nodes are left out if their side of the iso value is certain without evaluation, or if
 * their weight is certainly too low. Nodes are tested in cubes: whole blocks (32^3 nodes) or larger
 * cubes, then regions (8^3), then bricks (4^3). A crossed edge joins a node above the iso value to
 * a node below it. If both nodes are left out, their bricks are neighbours, one certainly above and
 * one certainly below: mcor_seed_request has both evaluated after all. If one node is left out, a
 * brick that is certainly on one side touches a valid node on the other side: mcor_seed_grow has
 * this brick evaluated, too. Bricks of uncertain regions have slots (places for node values) while
 * the bricks are tested, because mcor_seed_bricks may compute the nodes' values, from the same
 * particles that it gathers to bound the field. */

#if !MCOR_OF_LATTICE
/* Whether the range of the particles' values can decide on which side of the iso value nodes are: a
 * Shepard mean with weights >= 0 lies between the least and the greatest value. */
#define MCOR_RANGE_DECIDES (MCOR_FIELD == MCOR_SHEPARD && !MCOR_TENSOR)

/* Parameters on which a node's side depends. side_margin: the greatest relative rounding error of a
 * Shepard mean of values that are all on one side of the iso value; see mcor_side_margin in
 * mcor_seed.c. */
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

/* A box of cells. Along each axis, the first cell is `first`, and `last` is one beyond the last. */
#define MCOR_BOX_PARAMS                                                                            \
  const int first_x, const int first_y, const int first_z, const int last_x, const int last_y,     \
    const int last_z
#define MCOR_BOX_ARGS first_x, first_y, first_z, last_x, last_y, last_z

/* Whether any of the box's cells has a node in a cube of nodes. node: the cube's first node; size:
 * the cube's length in nodes. */
bool mcor_box_reaches(MCOR_BOX_PARAMS, int4 node, int size)
{
  return node.x + size > first_x && node.x <= last_x && node.y + size > first_y &&
    node.y <= last_y && node.z + size > first_z && node.z <= last_z;
}

/* Flags tell on which sides of the iso value particles' values are: bit 0 above, bit 1 below. Both
 * bits are set if a value is so close to the iso value that a mean of such values may round to the
 * other side. One flag stands for MCOR_SIDE_PARTICLES successive sorted particles, so most queries
 * need not read particles. */

#if MCOR_OF_FIELD
/* One work-item = one run of MCOR_SIDE_PARTICLES particles. Writes on which sides of the iso value
 * the run's fluid particles are. */
__kernel void mcor_seed_side_flags(const int particle_count, __global const real* weight,
  __global const real* value, const real side_margin, const real iso, __global uchar* side_flags)
{
  MCOR_ITEM(run, run * (long)MCOR_SIDE_PARTICLES < particle_count);
  const int begin = run * MCOR_SIDE_PARTICLES;
  int seen = 0;
  for (int j = begin; j < min(begin + MCOR_SIDE_PARTICLES, particle_count); ++j)
  {
    const real margin = side_margin * fabs(value[j]);
    const int side = (value[j] - margin >= iso ? 0 : 2) | (value[j] + margin < iso ? 0 : 1);
    seen |= (MCOR_SOLIDS && weight[j] == 0) ? 0 : side;
  }
  side_flags[run] = (uchar)seen;
}
#endif

/* Returns a state (MCOR_VOID to MCOR_EXAMINE): whether particles that may reach a query's box have
 * values above the iso value, below it, or both. A few particles that do not reach the box may
 * count, too, because one flag stands for several particles. */
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

/* Returns a state (MCOR_VOID to MCOR_EXAMINE): on which sides of the iso value the tile's fluid
 * particles are. */
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

/* If more particles than this reach a coarse cube, it is divided without computing a bound. */
#define MCOR_COARSE_PARTICLES 1024

/* Returns the state of the query's box, a cube of nodes. The tile may already hold the query's
 * particles, and may be used afterwards. coarse: saves work, but returns MCOR_EXAMINE more
 * often. If MCOR_RANGE_DECIDES, and all particles' values are on one side of the iso value, returns
 * this side, even if the cube, or a part of it, is void. */
int mcor_seed_state(const mcor_grid* grid, mcor_query* query, mcor_tile* tile, bool coarse,
  const mcor_seed_limits* limits)
{
  if (MCOR_RANGE_DECIDES && coarse)
  {
    const int state = mcor_query_side_flags(grid, query, limits->side_flags);
    if (state != MCOR_EXAMINE)
    {
      return state;
    }
  }
  mcor_bound bound = { 0, 0, 0, 0, 0, 0 };
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
    return seen;
  }
  if (bound.count == 0)
  {
    const bool is_void = MCOR_FIELD == MCOR_SHEPARD || (MCOR_FIELD == MCOR_SUM && limits->node_threshold > 0);
    return is_void ? MCOR_VOID : limits->iso <= 0 ? MCOR_ABOVE : MCOR_BELOW;
  }
  return mcor_bound_state(&bound, limits->iso, limits->node_threshold);
}

#define MCOR_REGION_CUBES (MCOR_REGION_BRICKS * MCOR_BRICK)

/* mcor_region_number returns the number of the first of a region's 2 x 2 x 2 bricks. The number of
 * brick b (bits x, y, z) of the region is greater by mcor_region_offset(b). */
int mcor_region_number(int region)
{
  const int block = region / MCOR_BLOCK_REGIONS, r = region % MCOR_BLOCK_REGIONS;
  return block * MCOR_BLOCK_BRICKS + 2 * (r & 3) + 16 * (r >> 2 & 3) + 128 * (r >> 4);
}
int mcor_region_offset(int b)
{
  return (b & 1) + 8 * (b >> 1 & 1) + 64 * (b >> 2);
}

/* Returns the bricks of a region that are leaves, as bits. With one level, all bricks are leaves.
 * number: the number of the region's first brick. */
uint mcor_region_leaves(MCOR_TREE_PARAMS, int number)
{
  uint found = 0;
  for (int b = 0; b < 8 && has_leaves; ++b)
  {
    found |= (uint)mcor_has_brick(leaves, number + mcor_region_offset(b)) << b;
  }
  return has_leaves ? found : 0xff;
}

/* One work-item = one of `count` regions from `first` on. Reads the particles that reach the
 * region, and the states of blocks. In two dimensions (depth 0) or with several levels, first
 * tests whether the range of the particles' values tells the region's side of the iso value. Writes
 * the states of the region's bricks (with several levels, of its leaves). If some of these bricks
 * are uncertain, requests slots for them, and appends the region to `list`: the regions of this
 * call stand from entry `first` on, in any order. list_count: how many entries each level has. With
 * several levels, a region includes the nodes on its far sides. Bricks without a node of a cell in
 * the box first_x to last_z are void, and so are bricks with z > 0 in two dimensions. */
__kernel void mcor_seed_regions(MCOR_GRID_PARAMS, const int first, const int count, const int depth,
  __global const mcor_rung* rungs, __global const ulong* block_keys,
  __global const uchar* block_states, MCOR_TREE_PARAMS, MCOR_SEED_PARAMS, MCOR_BOX_PARAMS,
  __global uchar* states, __global uint* brick_bits, __global int* list, __global int* list_count)
{
  MCOR_ITEM(item, item < count);
  const int region = first + item, number = mcor_region_number(region);
  const int4 brick = mcor_brick_of_number(rungs, block_keys, number);
  const uint layers = depth > 0 ? 0xff : brick.z == 0 ? 0x0f : 0;
  const uint own = layers & mcor_region_leaves(MCOR_TREE_ARGS, number);
  if (has_leaves && own == 0)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const mcor_seed_limits limits = MCOR_SEED_LIMITS;
  const int far = MCOR_REGION_CUBES - 1 + has_leaves;
  mcor_query query = mcor_node_query(&grid, brick, 0, (int4)(far, far, min(far, depth), 0), 1);
  mcor_tile tile;
  mcor_tile_init(&tile);
  int state = own == 0 ? MCOR_VOID
    : has_leaves       ? MCOR_EXAMINE
                       : block_states[region / MCOR_BLOCK_REGIONS];
  if (MCOR_RANGE_DECIDES && state == MCOR_EXAMINE && (has_leaves || depth == 0))
  {
    state = mcor_query_side_flags(&grid, &query, side_flags);
  }
  uint inside = 0, open = 0; /* bits of bricks */
  if (MCOR_PROVES_INSIDE && MCOR_ITEM_NODES == 64 && depth > 0 && state == MCOR_EXAMINE)
  {
    query.radius = -MCOR_INSIDE_SHARE;
    mcor_tile_next(&grid, &query, &tile, true);
    for (uint rest = tile.count > 0 ? own : 0; rest; rest &= rest - 1)
    {
      const int b = mcor_ctz(rest), m = number + mcor_region_offset(b);
      const int proof = mcor_seed_proof(
        &grid, brick + mcor_up(b), has_leaves && mcor_has_brick(beside, m), &tile, iso);
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
  bool uncertain = false;
  for (int b = 0; b < 8; ++b)
  {
    const int m = number + mcor_region_offset(b);
    const int proven = MCOR_ABOVE | (open >> b & 1) * MCOR_OPEN_SIDES;
    const bool counts = own >> b & 1 &&
      mcor_box_reaches(MCOR_BOX_ARGS, (brick + mcor_up(b)) * MCOR_BRICK, MCOR_BRICK);
    states[m] = (uchar)(!counts ? MCOR_VOID : inside >> b & 1 ? proven : state);
    if (states[m] == MCOR_EXAMINE)
    {
      mcor_request_brick(brick_bits, m);
      uncertain = true;
    }
  }
  if (uncertain)
  {
    list[first + atomic_inc(list_count + brick.w)] = region;
  }
}

/* Writes the state of a brick in an uncertain region. The state holds for the brick's nodes and,
 * for a leaf beside other levels, also for the nodes on the leaf's far sides. wide: a tile of the
 * particles that reach the region; it is used only if it is complete. The particles of an uncertain
 * brick are already gathered, so the brick's nodes are evaluated, too, if a work-item evaluates
 * whole bricks. Returns a mask of the evaluated nodes. */
ulong mcor_seed_brick(const mcor_grid* grid, int4 brick, bool beside, const mcor_tile* wide,
  const mcor_seed_limits* limits, __global uchar* state, __global real* value,
  __global real* weight)
{
  mcor_tile tile;
  const int proof = MCOR_PROVES_INSIDE && MCOR_ITEM_NODES != 64
    ? mcor_seed_proof(grid, brick, beside, wide, limits->iso)
    : MCOR_EXAMINE;
  if (proof != MCOR_EXAMINE)
  {
    *state = (uchar)proof;
    return 0;
  }
  mcor_query query = mcor_node_query(grid, brick, 0, MCOR_BRICK - !beside, 1);
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
  mcor_node_sums sums[MCOR_NODE_GROUPS];
  mcor_node_sum(grid, &query, &tile, sums);
  mcor_node_store(sums, value, weight);
  return ~0UL;
}

/* Number of bricks of a region that a work-item treats. */
#define MCOR_ITEM_BRICKS (MCOR_ITEM_NODES == 64 ? 8 : 1)

/* One work-item = MCOR_ITEM_BRICKS bricks of one region; the list has `count` regions from entry
 * `first` on. Reads the particles that reach the bricks. Writes the states of bricks whose nodes
 * are not known yet, and the values and signs of nodes that it evaluates. */
__kernel void mcor_seed_bricks(MCOR_GRID_PARAMS, const int first, const int count,
  MCOR_BRICK_PARAMS, MCOR_TREE_PARAMS, __global const int* list, MCOR_SEED_PARAMS,
  __global uchar* states, __global ulong* known, __global real* node_value,
  __global real* node_weight, __global ulong* above, __global ulong* valid)
{
  MCOR_ITEM(item, item / (8 / MCOR_ITEM_BRICKS) < count);
  const int i = item / (8 / MCOR_ITEM_BRICKS);
  const mcor_grid grid = MCOR_GRID;
  const mcor_seed_limits limits = MCOR_SEED_LIMITS;
  const int number = mcor_region_number(list[first + i]);
  const int4 region = mcor_brick_of_number(rungs, block_keys, number);
  mcor_query query = mcor_node_query(&grid, region, 0, MCOR_REGION_CUBES - 1 + has_leaves, 1);
  mcor_tile wide;
  mcor_tile_init(&wide);
  if (MCOR_ITEM_BRICKS > 1)
  {
    mcor_tile_next(&grid, &query, &wide, true);
  }
  const int own = item % (8 / MCOR_ITEM_BRICKS) * MCOR_ITEM_BRICKS;
  for (int b = own; b < own + MCOR_ITEM_BRICKS; ++b)
  {
    const int m = number + mcor_region_offset(b);
    const int slot = mcor_slot_of_number(brick_bits, brick_base, m);
    if (slot >= 0 && !known[slot])
    {
      const int4 brick = region + mcor_up(b);
      __global real *value = node_value + slot * 64L, *weight = node_weight + slot * 64L;
      known[slot] = mcor_seed_brick(&grid, brick, has_leaves && mcor_has_brick(beside, m), &wide,
        &limits, states + m, value, weight);
      if (known[slot])
      {
        const ulong2 signs = mcor_node_signs(value, weight, iso, node_threshold);
        above[slot] = signs.x;
        valid[slot] = signs.y;
      }
    }
  }
}
#endif

#if MCOR_OF_LATTICE
/* Returns the indices of three blocks: the block before a brick's block along x, the brick's block,
 * and the block after it; -1 for a block that does not exist. */
int3 mcor_seed_blocks(MCOR_BLOCK_PARAMS, int4 brick)
{
  const int4 block = mcor_block_of_brick(brick), step = (int4)(1, 0, 0, 0);
  return (int3)(mcor_find_block(MCOR_BLOCK_ARGS, block - step),
    mcor_find_block(MCOR_BLOCK_ARGS, block), mcor_find_block(MCOR_BLOCK_ARGS, block + step));
}

/* Returns which bricks are certainly above the iso value (bits 0 to 9), and which are certainly
 * below it (bits 16 to 25). The bricks are x = -1 to 8: a row's 8 bricks in a block, and one brick
 * on either side. row: the number of the row's first brick in its block. */
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

/* One work-item = one row of 8 bricks of a block. Reads the states. Requests each uncertain brick.
 * Where a brick that is certainly above the iso value is beside a brick that is certainly below it,
 * requests both bricks. */
__kernel void mcor_seed_request(MCOR_BLOCK_PARAMS, __global const uchar* inactive,
  __global const uchar* states, __global uint* brick_bits)
{
  MCOR_ITEM(
    row, row < block_count * MCOR_BLOCK_BRICKS / 8 && !inactive[row / (MCOR_BLOCK_BRICKS / 8)]);
  const int m = row * 8;
  int seen = 0;
  for (int x = 0; x < 8; ++x)
  {
    seen |= 1 << states[m + x];
  }
  uint beside = 0;
  if (seen & (1 << MCOR_ABOVE | 1 << MCOR_BELOW))
  {
    const int4 brick = mcor_brick_of_number(rungs, block_keys, m);
    const int3 blocks = mcor_seed_blocks(MCOR_BLOCK_ARGS, brick);
    for (int d = 0; d < 9; ++d)
    {
      const int4 row_there = brick + (int4)(0, d % 3 - 1, d / 3 - 1, 0);
      const bool within = row_there.y >> 3 == brick.y >> 3 && row_there.z >> 3 == brick.z >> 3;
      beside |= mcor_seed_row(within ? blocks : mcor_seed_blocks(MCOR_BLOCK_ARGS, row_there),
        mcor_place_in_block(row_there), states);
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

/* One work-item = one brick; bricks without `fresh` nodes were treated before. Reads on which sides
 * of the iso value the brick's nodes are, and the states of bricks around it. Requests each brick
 * that is certainly on one side of the iso value and touches a valid node of this brick on the
 * other side. Sets grown[0] if a requested brick is new. */
__kernel void mcor_seed_grow(MCOR_BLOCK_PARAMS, const int brick_count, __global const int4* bricks,
  __global const ulong* fresh, __global const ulong* above, __global const ulong* valid,
  __global const uchar* states, __global uint* brick_bits, __global int* grown)
{
  MCOR_ITEM(slot, slot < brick_count && fresh[slot] != 0);
  const int4 brick = bricks[slot];
  const int own = mcor_brick_number(MCOR_BLOCK_ARGS, brick);
  for (int d = 0; d < 27; ++d)
  {
    const int m = mcor_number_beside(MCOR_BLOCK_ARGS, own, brick, mcor_around(d));
    const int state = m < 0 ? MCOR_VOID : states[m];
    if ((state == MCOR_ABOVE || state == MCOR_BELOW) &&
      (mcor_on_sides(d % 3, d / 3 % 3, d / 9) & valid[slot] &
        (state == MCOR_ABOVE ? ~above[slot] : above[slot])) &&
      mcor_request_brick(brick_bits, m))
    {
      atomic_or(grown, 1);
    }
  }
}
#endif
