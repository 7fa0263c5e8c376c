/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The paper's seed selection [III-C]: pairs of particles closer than the smoothing length with
 * values on both sides, and all cells on the straight line between them; then the growth from cell
 * to cell through crossed faces, also to larger and smaller ones. Of each level's lattice the cells on the line are
 * found; those that may be used are marked. Of bricks where there is certainly no surface nothing is known: they have
 * no used cells. */

/* Places of bricks, by which cells are noted. Without levels these are the numbers of the blocks' bricks, most of which
 * have no slot. With levels they are slots, found by sorted keys: of bricks with cells that may be used, and of those
 * that such bricks are parts of. */
#define MCOR_PLACE_PARAMS                                                                          \
  MCOR_BLOCK_PARAMS, const int by_level, const int place_count, const int place_shift,             \
    __global const ulong *place_keys, __global const int *place_buckets,                           \
    __global const mcor_rung *rungs, __global const int *place_slots
#define MCOR_PLACE_ARGS                                                                            \
  MCOR_BLOCK_ARGS, by_level, place_count, place_shift, place_keys, place_buckets, rungs, place_slots

/* What a brick is that has no cells which may be used. */
#define MCOR_PLACE_SPLIT (-1)
#define MCOR_PLACE_NONE (-2)

int mcor_find_place(MCOR_PLACE_PARAMS, int level, int x, int y, int z)
{
  if (!by_level)
  {
    const int number = mcor_brick_number(MCOR_BLOCK_ARGS, x, y, z);
    return number < 0 ? MCOR_PLACE_NONE : number;
  }
  __global const mcor_rung* rung = rungs + level;
  if (x < 0 || y < 0 || z < 0 || x >= rung->n[0] || y >= rung->n[1] || z >= rung->n[2])
  {
    return MCOR_PLACE_NONE;
  }
  const int at = mcor_adaptive_find(
    place_count, place_shift, place_keys, place_buckets, mcor_adaptive_key(rungs, level, x, y, z));
  return at < 0 ? MCOR_PLACE_NONE : place_slots[at];
}

/* The place of a brick that has a slot. */
int mcor_place_of_slot(MCOR_PLACE_PARAMS, int slot, int4 brick)
{
  return by_level ? slot : mcor_find_place(MCOR_PLACE_ARGS, 0, brick.x, brick.y, brick.z);
}

/* Adds a cell of a level to those of its brick, if that is one. flags: 1 where it is new. */
void mcor_pair_reach(
  MCOR_PLACE_PARAMS, int level, int x, int y, int z, __global uint* reached, __global int* flags)
{
  const int place = mcor_find_place(MCOR_PLACE_ARGS, level, x >> 2, y >> 2, z >> 2);
  const ulong cell = 1UL << ((x & 3) | (y & 3) << 2 | (z & 3) << 4);
  if (place >= 0 && mcor_add_cells(reached, place, cell))
  {
    atomic_or(flags, 1);
  }
}

#if MCOR_OF_LATTICE
/* One work-item = one brick. Where its `cells` may be used, writes its key, and those of the bricks that it is part
 * of: of each level one, of the levels up to its own that of itself; else a key beyond all. */
__kernel void mcor_pair_keys(const int count, const int top, __global const mcor_rung* rungs,
  __global const int4* bricks, __global const ulong* cells, __global ulong* keys)
{
  const int i = get_global_id(0);
  const ulong none = mcor_adaptive_key(rungs, top + 1, 0, 0, rungs[top + 1].n[2]);
  for (int l = 0; l <= top && i < count; ++l)
  {
    const int4 b = bricks[i];
    const int up = max(l - b.w, 0);
    keys[i * (top + 1L) + l] =
      cells[i] ? mcor_adaptive_key(rungs, b.w + up, b.x >> up, b.y >> up, b.z >> up) : none;
  }
}

/* One work-item = one brick of a block, without levels. Requests the bricks that have nodes of its reached cells; flags:
 * 1 where one is new. */
__kernel void mcor_pair_request(
  MCOR_BLOCK_PARAMS, __global const ulong* reached, __global uint* brick_bits, __global int* flags)
{
  MCOR_ITEM(own, own < block_count * MCOR_BLOCK_BRICKS && reached[own] != 0);
  const int4 brick = mcor_brick_of_number(block_keys, blocks_x, blocks_y, own);
  for (int d = 0; d < 8; ++d)
  {
    const int m = mcor_cells_reach(reached[own], d)
      ? mcor_number_beside(MCOR_BLOCK_ARGS, own, brick, d & 1, d >> 1 & 1, d >> 2)
      : -1;
    if (m >= 0 && mcor_request_brick(brick_bits, m))
    {
      atomic_or(flags, 1);
    }
  }
}

/* One work-item = one brick. Enters its slot at its key, of which `index` has the place. */
__kernel void mcor_pair_places(const int count, const int top, __global const int* index,
  __global const ulong* cells, __global int* place_slots)
{
  MCOR_ITEM(i, i < count && cells[i]);
  place_slots[index[i * (top + 1L)]] = i;
}
#endif

/* ---- Cells between pairs ---- */

#if MCOR_OF_FIELD
/* What marking takes, last among a kernel's parameters. top: the highest level. */
#define MCOR_MARK_PARAMS MCOR_PLACE_PARAMS, const int top, __global uint *reached
#define MCOR_MARK_ARGS MCOR_PLACE_ARGS, top, reached

/* Marks a cell of a level if it may be used; whether smaller ones may be there. */
bool mcor_pair_seed_cell(MCOR_MARK_PARAMS, int level, int x, int y, int z)
{
  const int place = mcor_find_place(MCOR_PLACE_ARGS, level, x >> 2, y >> 2, z >> 2);
  if (place >= 0)
  {
    mcor_add_cells(reached, place, 1UL << ((x & 3) | (y & 3) << 2 | (z & 3) << 4));
  }
  return place == MCOR_PLACE_SPLIT;
}

/* Where a line, of which 1 / gap is the extent along an axis, crosses the side by which it leaves the cell
 * from `low` on: as a share of the line; beyond it where it ends in the cell. Of all levels that have
 * this side the same. */
real mcor_pair_crossing(long from, long low, long edge, int step, real gap, bool ends)
{
  const long side = step < 0 ? from - low : low + edge - from;
  return ends ? (real)2 : (real)side * gap;
}

/* Marks cells of a level on the line between two places, fixed-point numbers. Where the line passes an edge
 * or a corner of a cell to within rounding, the cells on both sides are found. Whether smaller ones may
 * be there: those found on a finer lattice are all within these. */
bool mcor_pair_seed_line(
  MCOR_MARK_PARAMS, const fix* from, const fix* to, int level, const fix step_of[3])
{
  real next[3], gap[3];
  int c[3], end[3], step[3], steps = 0;
  long edge[3];
  for (int a = 0; a < 3; ++a)
  {
    edge[a] = (long)step_of[a] << level;
    c[a] = (int)(from[a] / step_of[a]) >> level;
    end[a] = (int)(to[a] / step_of[a]) >> level;
    step[a] = to[a] < from[a] ? -1 : 1;
    gap[a] = to[a] == from[a] ? 0 : 1 / (real)abs(to[a] - from[a]);
    next[a] = mcor_pair_crossing(from[a], c[a] * edge[a], edge[a], step[a], gap[a], c[a] == end[a]);
    steps += abs(end[a] - c[a]);
  }
  bool split = mcor_pair_seed_cell(MCOR_MARK_ARGS, level, c[0], c[1], c[2]);
  for (; steps > 0; --steps)
  {
    int axis = next[1] < next[0] ? 1 : 0;
    axis = next[2] < next[axis] ? 2 : axis;
    for (int a = 0; a < 3; ++a)
    {
      if (a != axis && c[a] != end[a] && next[a] - next[axis] < (real)1e-5f)
      {
        split |= mcor_pair_seed_cell(MCOR_MARK_ARGS, level, c[0] + (a == 0 ? step[0] : 0),
          c[1] + (a == 1 ? step[1] : 0), c[2] + (a == 2 ? step[2] : 0));
      }
    }
    c[axis] += step[axis];
    next[axis] = mcor_pair_crossing(
      from[axis], c[axis] * edge[axis], edge[axis], step[axis], gap[axis], c[axis] == end[axis]);
    split |= mcor_pair_seed_cell(MCOR_MARK_ARGS, level, c[0], c[1], c[2]);
  }
  return split;
}

/* Marks the cells between particles j and k: of large leaves first. */
void mcor_pair_seed_pair(const mcor_grid* grid, MCOR_MARK_PARAMS, int j, int k)
{
  const fix from[3] = { grid->px[j], grid->py[j], grid->pz[j] };
  const fix to[3] = { grid->px[k], grid->py[k], grid->pz[k] };
  bool split = true;
  for (int level = top; level >= 0 && split; --level)
  {
    split = mcor_pair_seed_line(MCOR_MARK_ARGS, from, to, level, grid->step);
  }
}

/* Pairs may be as far apart as the smoothing length, not scaled; and a little more, so that
 * rounding does not decide where particles lie on a lattice of that spacing. */
#define MCOR_PAIR_REACH ((real)1.0001)

/* What rounding may do, at most, to the square of a distance within the smoothing length 1 / inv_h, as
 * positions count from the query's origin. */
real mcor_pair_slack(const mcor_query* query, real inv_h)
{
  const real* half_size = query->half_size;
  const real extent = 2 * fmax(half_size[0], fmax(half_size[1], half_size[2])) + query->radius;
  const real off = 16 * MCOR_UNIT_ROUNDOFF * extent;
  return off * (2 / inv_h + 3 * off);
}

/* Which of particles i, i + 1, ... of the tile may make a pair with particle j. */
fixv mcor_pair_candidates(const mcor_grid* grid, const mcor_query* query, const mcor_tile* tile,
  int i, int j, real iso, real h_scale)
{
  const real x = (real)(grid->px[j] - query->origin[0]) * grid->unit;
  const real y = (real)(grid->py[j] - query->origin[1]) * grid->unit;
  const real z = (real)(grid->pz[j] - query->origin[2]) * grid->unit;
  const real scale = h_scale / MCOR_PAIR_REACH, inv_h = grid->inv_h[j] * scale;
  const real slack = mcor_pair_slack(query, inv_h);
  const fixv above = grid->value[j] >= iso ? (fixv)MCOR_TRUE : (fixv)0;
  const realv dx = MCOR_TILE(tile, x, i) - x, dy = MCOR_TILE(tile, y, i) - y,
              dz = MCOR_TILE(tile, z, i) - z, other = MCOR_TILE(tile, inv_h, i) * scale;
  const realv r2 = mcor_square(dx, dy, dz);
  return (r2 - slack) * inv_h * inv_h < (real)1 && (MCOR_TILE(tile, value, i) >= iso) != above &&
    MCOR_TILE(tile, weight, i) != 0 && (above || (r2 + slack) * other * other >= (real)1);
}

/* Whether particle k, on the other side of the iso value, is closer to particle j than its smoothing
 * length. A pair in which each is closer than the other's is left to the particle above. By exact
 * differences: which particles were looked at together does not matter. */
bool mcor_pair_is_chosen(const mcor_grid* grid, int j, int k, real iso, real h_scale)
{
  const real x = (real)(grid->px[k] - grid->px[j]) * grid->unit;
  const real y = (real)(grid->py[k] - grid->py[j]) * grid->unit;
  const real z = (real)(grid->pz[k] - grid->pz[j]) * grid->unit;
  const real scale = h_scale / MCOR_PAIR_REACH;
  const real own = grid->inv_h[j] * scale, other = grid->inv_h[k] * scale;
  const real r2 = x * x + y * y + z * z;
  return r2 * own * own < 1 && (grid->value[j] >= iso || r2 * other * other >= 1);
}

/* Marks the cells between particle j and the particles of the tile that pair with it. */
void mcor_pair_seed_particle(const mcor_grid* grid, const mcor_query* query, const mcor_tile* tile,
  int j, real iso, real h_scale, MCOR_MARK_PARAMS)
{
  for (int i = 0; i < tile->count; i += MCOR_LANES)
  {
    int lanes[MCOR_LANES];
    const fixv candidates = mcor_pair_candidates(grid, query, tile, i, j, iso, h_scale);
    const int count = mcor_list_lanes(candidates, min(MCOR_LANES, tile->count - i), lanes);
    for (int c = 0; c < count; ++c)
    {
      const int k = MCOR_INDEX(tile, i + lanes[c]);
      if (mcor_pair_is_chosen(grid, j, k, iso, h_scale))
      {
        mcor_pair_seed_pair(grid, MCOR_MARK_ARGS, j, k);
      }
    }
  }
}

/* Fits the query to those of particles [begin, end) that lie in one row, and to what may pair with
 * them. Returns how many. */
int mcor_pair_query(const mcor_grid* grid, int begin, int end, real h_scale, mcor_query* query)
{
  real coarsest;
  const int count = mcor_query_particles(grid, query, begin, end, &coarsest);
  query->radius = (float)(MCOR_PAIR_REACH / (coarsest * h_scale));
  return count;
}

/* Greatest inv_h of the tile's particles. */
real mcor_pair_finest(const mcor_tile* tile)
{
  realv most = 0;
  for (int i = 0; i < tile->count; i += MCOR_LANES)
  {
    most = fmax(most, MCOR_TILE(tile, inv_h, i));
  }
  real finest = 0;
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    finest = fmax(finest, MCOR_GET(most, lane));
  }
  return finest;
}

/* Marks cells for particles [begin, end), which the query was fitted to. */
void mcor_pair_seed_particles(const mcor_grid* grid, mcor_query* query, int begin, int end,
  real iso, real h_scale, MCOR_MARK_PARAMS)
{
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool first = true; mcor_tile_next(grid, query, &tile, first); first = false)
  {
    const int seen = mcor_tile_sides(&tile, 0, iso);
    const real finest = mcor_pair_finest(&tile);
    for (int j = begin; j < end && (seen == 3 || !tile.complete); ++j)
    {
      /* One below that is no coarser than any other leaves all its pairs to those. */
      const bool leaves = grid->value[j] < iso && grid->inv_h[j] >= finest;
      if (!leaves && (!MCOR_SOLIDS || grid->weight[j] != 0))
      {
        mcor_pair_seed_particle(grid, query, &tile, j, iso, h_scale, MCOR_MARK_ARGS);
      }
    }
  }
}

/* One work-item = MCOR_PAIR_VECTORS_OF(MCOR_LANES) groups of MCOR_LANES sorted particles, looked at
 * together first, as most particles are far from the surface. Reads the particles within the
 * smoothing length of each. Marks the cells between pairs that straddle the iso value. */
__kernel void mcor_pair_seed(MCOR_GRID_PARAMS, __global const uchar* side_flags, const real iso,
  const real h_scale, MCOR_MARK_PARAMS)
{
  const mcor_grid grid = MCOR_GRID;
  const int most = MCOR_PAIR_VECTORS_OF(MCOR_LANES) * MCOR_LANES;
  const int begin = get_global_id(0) * most, end = min(begin + most, particle_count);
  mcor_query query;
  for (int row = begin, row_end; row < end; row = row_end)
  {
    row_end = row + mcor_pair_query(&grid, row, end, h_scale, &query);
    const bool far = mcor_query_side_flags(&grid, &query, side_flags) != 3;
    for (int i = row, next; i < row_end && !far; i = next)
    {
      next = i + mcor_pair_query(&grid, i, min(i + MCOR_LANES, row_end), h_scale, &query);
      if (mcor_query_side_flags(&grid, &query, side_flags) == 3)
      {
        mcor_pair_seed_particles(&grid, &query, i, next, iso, h_scale, MCOR_MARK_ARGS);
      }
    }
  }
}

#endif

/* ---- Growth ---- */

#if MCOR_OF_LATTICE
/* Of a cell's nodes those with a coordinate. */
uint mcor_leaf_plane(int axis, int at)
{
  return axis == 0 ? 0x1249249u << at : axis == 1 ? 0x1c0e07u << 3 * at : 0x1ffu << 9 * at;
}

/* Whether nodes on both sides are among these. */
bool mcor_leaf_is_crossed(mcor_adaptive_nodes_of nodes, uint among)
{
  const uint all = among & (nodes.split | mcor_leaf_corner_nodes(0xff));
  return (nodes.above & all) != 0 && (nodes.above & all) != all;
}

/* Used cells of a brick, and those whose lower and upper faces across each axis are crossed. */
typedef struct
{
  ulong used, lower[3], upper[3];
} mcor_pair_faces;

/* Of its plain cells. corners: of all that are above; crossed: see mcor_cell_crossed. */
mcor_pair_faces mcor_pair_plain_faces(const ulong* corners, ulong crossed, ulong hanging)
{
  mcor_pair_faces faces;
  faces.used = crossed & ~hanging;
  for (int a = 0; a < 3; ++a)
  {
    faces.lower[a] = mcor_cell_faces(corners, a, 0) & ~hanging;
    faces.upper[a] = mcor_cell_faces(corners, a, 1) & ~hanging;
  }
  return faces;
}

/* Adds a cell that has finer nodes. */
void mcor_pair_add_faces(const mcor_leaf* leaf, int cell, mcor_pair_faces* faces)
{
  const mcor_adaptive_nodes_of nodes = mcor_leaf_cell(leaf, cell);
  faces->used |= (ulong)nodes.used << cell;
  for (int a = 0; a < 3; ++a)
  {
    faces->lower[a] |= (ulong)mcor_leaf_is_crossed(nodes, mcor_leaf_plane(a, 0)) << cell;
    faces->upper[a] |= (ulong)mcor_leaf_is_crossed(nodes, mcor_leaf_plane(a, 2)) << cell;
  }
}

/* Grows cells within their brick to the end. */
ulong mcor_pair_grow_within(
  const mcor_leaf* leaf, ulong hanging, ulong cells, ulong domain, mcor_pair_faces* faces)
{
  ulong looked_at = 0;
  for (ulong last = 0; cells != last;)
  {
    last = cells;
    for (ulong rest = cells & hanging & ~looked_at; rest; rest &= rest - 1)
    {
      mcor_pair_add_faces(leaf, mcor_ctz(rest), faces);
    }
    looked_at = cells;
    const ulong used = cells & faces->used;
    cells |= domain & mcor_cells_beside(used, faces->lower, faces->upper);
  }
  return cells;
}

/* Reaches across a side of a leaf from one of its cells to smaller ones, through the quarters that are
 * crossed. */
void mcor_pair_reach_finer(const mcor_leaf* leaf, int4 brick, int cell, int axis, int side,
  MCOR_PLACE_PARAMS, __global uint* reached, __global int* flags)
{
  const mcor_adaptive_nodes_of nodes = mcor_leaf_cell(leaf, cell);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  int at[3] = { 2 * (4 * brick.x + (cell & 3)), 2 * (4 * brick.y + (cell >> 2 & 3)),
    2 * (4 * brick.z + (cell >> 4)) };
  at[axis] += side ? 2 : -1;
  for (int quarter = 0; quarter < 4; ++quarter)
  {
    const int i = quarter & 1, j = quarter >> 1;
    const uint among = mcor_leaf_plane(axis, 2 * side) &
      (mcor_leaf_plane(u, i) | mcor_leaf_plane(u, i + 1)) &
      (mcor_leaf_plane(v, j) | mcor_leaf_plane(v, j + 1));
    if (mcor_leaf_is_crossed(nodes, among))
    {
      int to[3] = { at[0], at[1], at[2] };
      to[u] += i;
      to[v] += j;
      mcor_pair_reach(MCOR_PLACE_ARGS, brick.w - 1, to[0], to[1], to[2], reached, flags);
    }
  }
}

/* Reaches across a side of a leaf from `cells` that lie at it, through their faces there. */
void mcor_pair_reach_across(const mcor_leaf* leaf, int4 brick, ulong cells, int axis, int side,
  MCOR_PLACE_PARAMS, __global uint* reached, __global int* flags)
{
  const int by = side ? 1 : -1, shift = 3 << 2 * axis;
  const int4 to = brick + (int4)(axis == 0 ? by : 0, axis == 1 ? by : 0, axis == 2 ? by : 0, 0);
  const int other = mcor_find_place(MCOR_PLACE_ARGS, brick.w, to.x, to.y, to.z);
  if (other >= 0 && mcor_add_cells(reached, other, side ? cells >> shift : cells << shift))
  {
    atomic_or(flags, 1);
  }
  if (other >= 0 || !by_level)
  {
    return;
  }
  for (ulong rest = cells; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest), beyond = side ? cell - shift : cell + shift;
    if (other == MCOR_PLACE_SPLIT)
    {
      mcor_pair_reach_finer(leaf, brick, cell, axis, side, MCOR_PLACE_ARGS, reached, flags);
    }
    else
    {
      mcor_pair_reach(MCOR_PLACE_ARGS, brick.w + 1, (4 * to.x + (beyond & 3)) >> 1,
        (4 * to.y + (beyond >> 2 & 3)) >> 1, (4 * to.z + (beyond >> 4)) >> 1, reached, flags);
    }
  }
}

/* Whether bricks that have nodes of a brick's cells have no slot yet. */
bool mcor_pair_lacks(
  MCOR_BLOCK_PARAMS, __global const int* neighbours, int slot, int own, int4 brick, ulong cells)
{
  bool lacks = false;
  for (int d = 1; d < 8; ++d)
  {
    lacks = lacks ||
      (mcor_cells_reach(cells, d) && neighbours[slot * 14L + d - 1] < 0 &&
        mcor_number_beside(MCOR_BLOCK_ARGS, own, brick, d & 1, d >> 1 & 1, d >> 2) >= 0);
  }
  return lacks;
}

/* One work-item = one brick with cells that are new to this round. Reads its nodes' masks where its cells may be used.
 * Grows the cells reached by now through crossed faces of used cells, within the brick to the end, and one step
 * beyond its sides. domain: where nodes have right values. */
__kernel void mcor_pair_grow(const int brick_count, __global const int* neighbours,
  const int leaf_count, const int plane, __global const uint* finer, __global const int* tables,
  __global const ulong* above, __global const ulong* valid, __global const ulong* plain,
  __global const int* leaf_of, __global const int4* bricks, __global const ulong* allowed,
  MCOR_PLACE_PARAMS, __global const ulong* domain, __global ulong* grown, __global uint* reached,
  __global int* flags)
{
  MCOR_ITEM(i, i < brick_count && (!by_level || allowed[i]));
  const int4 brick = bricks[i];
  const int own = mcor_place_of_slot(MCOR_PLACE_ARGS, i, brick);
  const ulong before = grown[own];
  /* Others add to them meanwhile: what is missed is there in the next round. */
  const ulong first = atomic_or(reached + 2L * own, 0), rest = atomic_or(reached + 2L * own + 1, 0);
  ulong cells = domain[i] & (rest << 32 | first);
  if (cells == before)
  {
    return;
  }
  const ulong hanging = by_level ? ~plain[i] : 0;
  ulong m[8];
  mcor_leaf leaf;
  mcor_brick_masks(above, neighbours, i, 0, m);
  mcor_cell_corners(m);
  if (hanging)
  {
    leaf = mcor_leaf_load(leaf_of[i], plane, finer, tables, above, valid);
  }
  mcor_pair_faces faces =
    mcor_pair_plain_faces(m, mcor_cell_crossed(m, neighbours, valid, i), hanging);
  cells = mcor_pair_grow_within(&leaf, hanging, cells, domain[i], &faces);
  mcor_add_cells(reached, own, cells);
  if (by_level || !mcor_pair_lacks(MCOR_BLOCK_ARGS, neighbours, i, own, brick, cells))
  {
    grown[own] = cells; /* else again, when all its nodes are known */
  }
  const ulong fresh = cells & ~before & faces.used;
  for (int face = 0; face < 6 && fresh; ++face)
  {
    const int axis = face >> 1, side = face & 1;
    const ulong low = mcor_lowest(axis);
    const ulong at = side ? faces.upper[axis] & low << (3 << 2 * axis) : faces.lower[axis] & low;
    if (fresh & at)
    {
      mcor_pair_reach_across(&leaf, brick, fresh & at, axis, side, MCOR_PLACE_ARGS, reached, flags);
    }
  }
}

/* One work-item = one cell, with its level, that another box, or the other end of a period, has reached. Adds it
 * to its brick's. */
__kernel void mcor_pair_take(const int count, __global const int4* heard, MCOR_PLACE_PARAMS,
  __global uint* reached, __global int* flags)
{
  MCOR_ITEM(i, i < count);
  const int4 cell = heard[i];
  mcor_pair_reach(MCOR_PLACE_ARGS, cell.w, cell.x, cell.y, cell.z, reached, flags);
}

/* One work-item = one brick. Writes to its slot those of its cells that are reached, and that pairs marked. */
__kernel void mcor_pair_fill(const int brick_count, __global const int4* bricks, MCOR_PLACE_PARAMS,
  __global const ulong* reached, __global const ulong* marked, __global ulong* cells,
  __global ulong* seeds)
{
  MCOR_ITEM(i, i < brick_count);
  const int own = mcor_place_of_slot(MCOR_PLACE_ARGS, i, bricks[i]);
  cells[i] = reached[own];
  seeds[i] = marked[own];
}
#endif
