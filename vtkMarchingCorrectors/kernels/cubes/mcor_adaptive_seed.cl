/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: of which leaves it is certain that there is no surface.
 *
 * A leaf is a brick of 4 x 4 x 4 cells of its level, (x, y, z; level). Its cells have the nodes of that
 * level, 5 along an edge, and where a leaf beside is finer those of the level below on its sides: 9
 * along an edge. Where all leaves up from it are of its level, each tells of its own nodes, 4 along an
 * edge: by a bound, a proof, or their values. Then there is no surface in it where it and they are on one
 * side. Beside leaves of other levels a bound, or a proof, has to tell of all its points, sides included.
 * All lengths are in cells of the level, as which the search grid is seen (mcor_view_level). */

/* Bits d = x + 3 y + 9 z, x, y, z 0 to 2: of the 27 bricks in and around a leaf, those that are
 * finer. */
#define MCOR_DIRECTION(x, y, z) ((x) + 3 * (y) + 9 * (z))

#if MCOR_OF_LATTICE
/* One work-item = one element, with the padding. Writes inverse smoothing lengths in other cells. */
__kernel void mcor_adaptive_scale(
  const int count, __global const real* inv_h, const real factor, __global real* scaled)
{
  MCOR_ITEM(i, i < count);
  scaled[i] = inv_h[i] * factor;
}

#endif

/* The state of a slot: a known one, MCOR_EXAMINE where its nodes' values are needed, or MCOR_UNTRIED. */
#define MCOR_IS_CERTAIN(state) ((state) < MCOR_EXAMINE)

/* ---- Bounds and proofs ---- */

#if MCOR_OF_ADAPTIVE
/* Whether that proof is tried: where a work-item evaluates whole bricks. */
#define MCOR_LEAF_PROOFS (MCOR_FIELD == 2 && !MCOR_TENSOR && MCOR_LANES > 1)

/* The nodes of a leaf of which its state is to tell, as an extent. */
#define MCOR_LEAF_EXTENT(finer) ((finer) ? MCOR_BRICK : MCOR_BRICK - 1)

/* The entry for a leaf of which a state is known. */
int mcor_leaf_state(int state, uint finer)
{
  return state * MCOR_EVERYWHERE | (state == MCOR_EXAMINE && finer ? MCOR_OPEN_SIDES : 0);
}

#if MCOR_LANES == 1
/* One work-item = one leaf, of `count` from `first` on. Reads the particles that reach it. Writes its
 * state. */
__kernel void mcor_adaptive_states(MCOR_GRID_PARAMS, const int first, const int count,
  __global const int4* leaves, __global const uint* finer, MCOR_SEED_PARAMS, __global int* states)
{
  const int i = first + get_global_id(0);
  if (i >= first + count)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const mcor_seed_limits limits = MCOR_SEED_LIMITS;
  mcor_query query = mcor_seed_query(&grid, leaves[i], MCOR_LEAF_EXTENT(finer[i]));
  mcor_tile tile;
  mcor_tile_init(&tile);
  states[i] = mcor_leaf_state(mcor_seed_state(&grid, &query, &tile, false, &limits), finer[i]);
}
#else
#if MCOR_LEAF_PROOFS
/* Whether the particles close to a brick's nodes alone lift them all above the iso value, see
 * mcor_seed_is_inside. The tile may hold them already. */
bool mcor_brick_is_inside(const mcor_grid* grid, mcor_query* query, mcor_tile* tile, real iso)
{
  mcor_node_sums sums;
  bool inside = true;
  mcor_node_sum(grid, query, tile, &sums);
  for (int g = 0; g < MCOR_NODE_GROUPS; ++g)
  {
    inside = inside && MCOR_ALL(sums.w[g] > iso * (real)1.0001f);
  }
  return inside;
}

/* The same of 2 x 2 points, as many above each other as there are lanes, `step` apart from `at` on. The
 * order of the sum is not that of nodes: the margin covers it, too. */
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

/* Whether all points of a box are, `step` apart, from `at` in the tile on: numbers [low, high]. */
bool mcor_box_is_inside(const mcor_tile* tile, const real at[3], const int low[3],
  const int high[3], const real step[3], real iso)
{
  bool inside = true;
  for (int z = low[2]; z <= high[2] && inside; z += MCOR_LANES / 4)
  {
    for (int y = low[1]; y <= high[1] && inside; y += 2)
    {
      for (int x = low[0]; x <= high[0] && inside; x += 2)
      {
        const real to[3] = { at[0] + step[0] * x, at[1] + step[1] * y, at[2] + step[2] * z };
        inside = mcor_points_are_inside(tile, to, step, iso);
      }
    }
  }
  return inside;
}

/* Whether the nodes of its level on a leaf's far sides do. The finer ones are nodes of finer leaves, too: either
 * own ones, which a proof of those knows, or on their far sides, where a leaf beside a larger one is chosen. The
 * march goes on from there. tile: what is close to all of the leaf. */
bool mcor_sides_are_inside(
  const mcor_grid* grid, const mcor_query* query, const mcor_tile* tile, real iso)
{
  bool inside = true;
  real at[3];
  for (int a = 0; a < 3; ++a)
  {
    at[a] = (real)(query->low[a] - query->origin[a]) * grid->unit;
  }
  for (int a = 0; a < 3 && inside; ++a)
  {
    const int low[3] = { a == 0 ? 4 : 0, a == 1 ? 4 : 0, a == 2 ? 4 : 0 }, high[3] = { 4, 4, 4 };
    inside = mcor_box_is_inside(tile, at, low, high, grid->edge, iso);
  }
  return inside;
}

/* What the proof says of a leaf: if it holds for its own nodes, but not for its far sides, next to finer
 * leaves, these are open. wide: what is close to its region, if it is complete. */
int mcor_leaf_proof(const mcor_grid* grid, int4 leaf, uint finer, const mcor_tile* wide, real iso)
{
  mcor_query query = mcor_seed_query(grid, leaf, MCOR_LEAF_EXTENT(finer));
  mcor_tile tile;
  query.radius = -MCOR_INSIDE_SHARE;
  mcor_tile_init(&tile);
  if (wide->complete)
  {
    mcor_tile_narrow(wide, &query, &tile);
  }
  if (!mcor_brick_is_inside(grid, &query, &tile, iso))
  {
    return mcor_leaf_state(MCOR_EXAMINE, finer);
  }
  const bool all = !finer || (tile.complete && mcor_sides_are_inside(grid, &query, &tile, iso));
  return MCOR_ABOVE * MCOR_EVERYWHERE | (all ? 0 : MCOR_OPEN_SIDES);
}
#endif

/* Proves what can be of the leaves of a region, from `begin` to before `end`; returns which are left. */
uint mcor_region_proofs(const mcor_grid* grid, int4 brick, int begin, int end,
  __global const int4* leaves, __global const uint* finer, real iso, mcor_tile* wide,
  __global int* states)
{
  uint left = (1u << (end - begin)) - 1;
#if MCOR_LEAF_PROOFS
  mcor_query query = mcor_seed_query(grid, brick, MCOR_REGION_CUBES);
  query.radius = -MCOR_INSIDE_SHARE;
  mcor_tile_init(wide);
  mcor_tile_next(grid, &query, wide, true);
  for (int i = begin; i < end && wide->count > 0; ++i)
  {
    states[i] = mcor_leaf_proof(grid, leaves[i], finer[i], wide, iso);
    left &= ~((uint)MCOR_IS_CERTAIN(states[i] & MCOR_EXAMINE) << (i - begin));
  }
#endif
  return left;
}

/* The state of all of a region's leaves where raw values tell it, else MCOR_EXAMINE. */
int mcor_region_range(const mcor_grid* grid, mcor_query* query, const mcor_seed_limits* limits)
{
  const int of_sides[4] = { MCOR_VOID, MCOR_ABOVE, MCOR_BELOW, MCOR_EXAMINE };
  return of_sides[MCOR_RANGE_DECIDES ? mcor_query_side_flags(grid, query, limits->side_flags) : 3];
}

/* The state of a leaf that is certain of nothing, by its nodes' values, which it writes. tile: what reaches
 * them. */
int mcor_leaf_evaluate(const mcor_grid* grid, mcor_query* query, mcor_tile* tile, uint finer,
  const mcor_seed_limits* limits, __global real* value, __global real* weight)
{
  mcor_node_sums sums;
  mcor_node_sum(grid, query, tile, &sums);
  mcor_node_store(&sums, value, weight);
  const ulong2 signs = mcor_node_signs(value, weight, limits->iso, limits->node_threshold);
  int state = MCOR_EVALUATED | (finer ? MCOR_OPEN_SIDES : 0);
  for (int d = 0; d < 8; ++d)
  {
    const ulong valid = signs.y & (d & 1 ? MCOR_LOW_X : ~0UL) & (d & 2 ? MCOR_LOW_Y : ~0UL) &
      (d & 4 ? MCOR_LOW_Z : ~0UL);
    state |= ((valid & signs.x ? MCOR_ABOVE : 0) | (valid & ~signs.x ? MCOR_BELOW : 0)) << 2 * d;
  }
  return state;
}

/* One work-item = one region, of `count` from `first` on: the leaves that are parts of one brick, the
 * particles of which are gathered once. Reads the particles that reach it. Writes the leaves' states
 * and, of those to be examined, if `evaluates`, their nodes' values and weights, from those of `first_leaf` on. */
__kernel void mcor_adaptive_regions(MCOR_GRID_PARAMS, const int first, const int count,
  __global const int* regions, __global const int4* leaves, __global const uint* finer,
  MCOR_SEED_PARAMS, const int evaluates, const int first_leaf, __global int* states,
  __global real* node_value, __global real* node_weight)
{
  const int region = first + get_global_id(0);
  if (region >= first + count)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const mcor_seed_limits limits = MCOR_SEED_LIMITS;
  const int begin = regions[region], end = regions[region + 1];
  const int4 brick = leaves[begin] / MCOR_REGION_BRICKS * MCOR_REGION_BRICKS;
  mcor_query query = mcor_seed_query(&grid, brick, MCOR_REGION_CUBES);
  mcor_tile wide, tile;
  int all = mcor_region_range(&grid, &query, &limits);
  uint left = all == MCOR_EXAMINE ? (1u << (end - begin)) - 1 : 0;
  if (left)
  {
    left = mcor_region_proofs(&grid, brick, begin, end, leaves, finer, iso, &wide, states);
    mcor_tile_init(&wide);
    all = left + 1 == 1u << (end - begin) ? mcor_seed_state(&grid, &query, &wide, false, &limits)
                                          : MCOR_EXAMINE;
    if (all == MCOR_EXAMINE && left)
    {
      mcor_tile_next(&grid, &query, &wide, true);
    }
  }
  for (int i = begin; i < end && all != MCOR_EXAMINE; ++i)
  {
    states[i] = all * MCOR_EVERYWHERE;
  }
  for (uint rest = all == MCOR_EXAMINE ? left : 0; rest; rest &= rest - 1)
  {
    const int i = begin + mcor_ctz(rest);
    query = mcor_seed_query(&grid, leaves[i], MCOR_LEAF_EXTENT(finer[i]));
    mcor_tile_init(&tile);
    if (wide.complete)
    {
      mcor_tile_narrow(&wide, &query, &tile);
    }
    const int state = mcor_seed_state(&grid, &query, &tile, false, &limits);
    states[i] = state == MCOR_EXAMINE && evaluates
      ? mcor_leaf_evaluate(&grid, &query, &tile, finer[i], &limits,
          node_value + 64L * (i - first_leaf), node_weight + 64L * (i - first_leaf))
      : mcor_leaf_state(state, finer[i]);
  }
}
#endif
#endif

/* ---- Leaves by their place ---- */

#if MCOR_OF_LATTICE
/* One work-item = one region. Writes the key of the brick whose parts its leaves are. */
__kernel void mcor_adaptive_region_keys(const int region_count, __global const mcor_rung* rungs,
  __global const int* regions, __global const int4* leaves, __global ulong* keys)
{
  MCOR_ITEM(r, r < region_count);
  const int4 leaf = leaves[regions[r]];
  keys[r] = mcor_brick_key(rungs, leaf.w + 1, leaf.x >> 1, leaf.y >> 1, leaf.z >> 1);
}

#endif

/* Regions by their sorted keys; `order`: which one has a key. */
#define MCOR_REGION_PARAMS                                                                         \
  const int region_count, __global const mcor_rung *rungs, __global const int *regions,            \
    __global const int4 *leaves, __global const ulong *region_keys,                                \
    __global const int *region_order
#define MCOR_REGION_ARGS region_count, rungs, regions, leaves, region_keys, region_order

/* The region of parts of a brick, or -1. */
int mcor_find_region(MCOR_REGION_PARAMS, int level, int x, int y, int z)
{
  const ulong key = mcor_brick_key(rungs, level, x, y, z);
  const int at = mcor_find_key(region_keys, 0, region_count, key);
  return at < region_count && region_keys[at] == key ? region_order[at] : -1;
}

/* The leaf of a region at a place, or -1. */
int mcor_leaf_of_region(
  __global const int* regions, __global const int4* leaves, int region, int x, int y, int z)
{
  for (int i = region < 0 ? 0 : regions[region]; i < (region < 0 ? 0 : regions[region + 1]); ++i)
  {
    const int4 leaf = leaves[i];
    if (leaf.x == x && leaf.y == y && leaf.z == z)
    {
      return i;
    }
  }
  return -1;
}

#if MCOR_OF_LATTICE
/* One work-item = one region. Writes of its leaves whether they are to be examined: nodes that cells of
 * theirs may have are on both sides. In the plane, none are up from it. */
__kernel void mcor_adaptive_choose(MCOR_REGION_PARAMS, const int plane, __global const uint* finer,
  __global const int* states, __global uchar* chosen)
{
  MCOR_ITEM(r, r < region_count);
  const int4 parent = leaves[regions[r]] >> 1;
  const int level = leaves[regions[r]].w;
  const int directions = plane ? 4 : 8;
  int up[8] = { r };
  for (int d = 1; d < directions; ++d)
  {
    up[d] = mcor_find_region(MCOR_REGION_ARGS, level + 1, parent.x + (d & 1),
      parent.y + (d >> 1 & 1), parent.z + (d >> 2));
  }
  for (int i = regions[r]; i < regions[r + 1]; ++i)
  {
    int sides = states[i] & MCOR_EXAMINE;
    const bool open = states[i] & MCOR_OPEN_SIDES, alone = open || finer[i] != 0;
    for (int d = 1; d < directions && !alone && sides != MCOR_EXAMINE; ++d)
    {
      const int x = leaves[i].x + (d & 1), y = leaves[i].y + (d >> 1 & 1),
                z = leaves[i].z + (d >> 2);
      const int in =
        up[((x >> 1) - parent.x) | ((y >> 1) - parent.y) << 1 | ((z >> 1) - parent.z) << 2];
      const int other = mcor_leaf_of_region(regions, leaves, in, x, y, z);
      sides |= other < 0 ? MCOR_EXAMINE : states[other] >> 2 * d & MCOR_EXAMINE;
    }
    /* No branch asks `sides` after the loop: into such a one, LLVM 18 moves what the loop left, and PoCL
     * 6.0 then ends the process ("Instruction Combining did not reach a fixpoint"). */
    chosen[i] = (uchar)((open | (sides == MCOR_EXAMINE)) * MCOR_CHOSEN |
      (states[i] & MCOR_EVALUATED ? MCOR_CHOSEN_EVALUATED : 0));
  }
}

#endif

#if MCOR_OF_LATTICE
/* One work-item = one leaf, of `count` from `first` on. Writes 1 where its nodes are evaluated, else 0. */
__kernel void mcor_adaptive_count_values(
  const int first, const int count, __global const int* states, __global int* counts)
{
  MCOR_ITEM(i, i < count);
  counts[i] = states[first + i] & MCOR_EVALUATED ? 1 : 0;
}

/* One work-item = one of these leaves. Reads the scanned counts. Moves its nodes' values, if they are evaluated, to
 * where there is room for those alone, from number `base` on. */
__kernel void mcor_adaptive_pack_values(const int first, const int count, const int base,
  __global const int* scanned, const int words, __global const uint* part_value,
  __global const uint* part_weight, __global int* place, __global uint* value,
  __global uint* weight)
{
  MCOR_ITEM(i, i < count && scanned[i + 1] > scanned[i]);
  const int to = base + scanned[i];
  place[first + i] = to;
  for (int n = 0; n < words; ++n)
  {
    value[to * (long)words + n] = part_value[i * (long)words + n];
    weight[to * (long)words + n] = part_weight[i * (long)words + n];
  }
}
#endif

#if MCOR_OF_ADAPTIVE
/* One work-item = one slot. Takes over what was found of the leaf whose brick it is, if it is one's:
 * words: of 4 bytes, that the values of a brick's nodes take; 0: there are none. */
__kernel void mcor_adaptive_take(MCOR_REGION_PARAMS, const int slot_count,
  __global const int4* bricks, __global const int* states, const int words,
  __global const int* place, __global const uint* leaf_value, __global const uint* leaf_weight,
  __global uchar* proofs, __global ulong* known, __global uint* node_value,
  __global uint* node_weight)
{
  MCOR_ITEM(slot, slot < slot_count);
  const int4 b = bricks[slot];
  const int region = mcor_find_region(MCOR_REGION_ARGS, b.w + 1, b.x >> 1, b.y >> 1, b.z >> 1);
  const int i = mcor_leaf_of_region(regions, leaves, region, b.x, b.y, b.z);
  const int state = i < 0 ? MCOR_UNTRIED : states[i];
  proofs[slot] = (uchar)(i < 0 ? MCOR_UNTRIED
      : state & MCOR_EVALUATED ? MCOR_EXAMINE
                               : state & MCOR_EXAMINE);
  if (state & MCOR_EVALUATED)
  {
    const long from = place[i] * (long)words;
    known[slot] = ~0UL;
    for (int n = 0; n < words; ++n)
    {
      node_value[slot * (long)words + n] = leaf_value[from + n];
      node_weight[slot * (long)words + n] = leaf_weight[from + n];
    }
  }
}
#endif
