/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The paper's seed selection [III-C]: pairs of particles closer than the smoothing length with
 * values on both sides, and all cells on the straight line between them; then the growth from cell
 * to cell through crossed faces. */

#if MCOR_OF_FIELD
/* What marking takes, last among a kernel's parameters; mcor_adaptive_pair.cl has that of adaptive cubes. */
#define MCOR_MARK_PARAMS MCOR_BLOCK_PARAMS, __global uint* cells
#define MCOR_MARK_ARGS MCOR_BLOCK_ARGS, cells

/* Cells are found before their bricks have slots: `cells` has two words, 64 bits, for each brick
 * of each block. */
void mcor_pair_seed_cell(MCOR_BLOCK_PARAMS, int x, int y, int z, __global uint* cells)
{
  const int m = mcor_brick_number(MCOR_BLOCK_ARGS, x >> 2, y >> 2, z >> 2);
  if (m >= 0)
  {
    atomic_or(cells + 2L * m + (z >> 1 & 1), 1u << ((x & 3) | (y & 3) << 2 | (z & 1) << 4));
  }
}

/* All cells on the line from p to q (edges, relative to cell c), beginning in cell c. Where the
 * line passes an edge or a corner of a cell to within rounding, the cells on both sides are
 * found. */
void mcor_pair_seed_line(
  MCOR_BLOCK_PARAMS, const real* p, const real* q, int* c, const int* end, __global uint* cells)
{
  real next[3], gap[3];
  int step[3], steps = 0;
  for (int a = 0; a < 3; ++a)
  {
    const real d = q[a] - p[a];
    step[a] = d < 0 ? -1 : 1;
    gap[a] = fabs(d) > (real)1e-20f ? 1 / fabs(d) : (real)1e20f;
    next[a] = (d < 0 ? p[a] : 1 - p[a]) * gap[a];
    steps += abs(end[a] - c[a]);
  }
  mcor_pair_seed_cell(MCOR_BLOCK_ARGS, c[0], c[1], c[2], cells);
  for (; steps > 0; --steps)
  {
    int axis = next[1] < next[0] ? 1 : 0;
    axis = next[2] < next[axis] ? 2 : axis;
    for (int a = 0; a < 3; ++a)
    {
      if (a != axis && next[a] - next[axis] < (real)1e-5f)
      {
        mcor_pair_seed_cell(MCOR_BLOCK_ARGS, c[0] + (a == 0 ? step[0] : 0),
          c[1] + (a == 1 ? step[1] : 0), c[2] + (a == 2 ? step[2] : 0), cells);
      }
    }
    c[axis] += step[axis];
    next[axis] += gap[axis];
    mcor_pair_seed_cell(MCOR_BLOCK_ARGS, c[0], c[1], c[2], cells);
  }
}

/* Marks the cells between particles j and k. */
void mcor_pair_seed_pair(const mcor_grid* grid, MCOR_MARK_PARAMS, int j, int k)
{
  const fix own[3] = { grid->px[j], grid->py[j], grid->pz[j] };
  const fix other[3] = { grid->px[k], grid->py[k], grid->pz[k] };
  real p[3], q[3];
  int cell[3], end[3];
  for (int c = 0; c < 3; ++c)
  {
    /* Relative to the first cell, so that single precision suffices. */
    cell[c] = (int)(own[c] / grid->step[c]);
    end[c] = (int)(other[c] / grid->step[c]);
    p[c] = (real)(own[c] - (fix)cell[c] * grid->step[c]) / (real)grid->step[c];
    q[c] = p[c] + (real)(other[c] - own[c]) / (real)grid->step[c];
  }
  mcor_pair_seed_line(MCOR_BLOCK_ARGS, p, q, cell, end, cells);
}

#endif

#if !MCOR_OF_LATTICE
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
#if MCOR_OF_ADAPTIVE
#define MCOR_PAIR_SEED mcor_adaptive_pair_seed
#else
#define MCOR_PAIR_SEED mcor_pair_seed
#endif
__kernel void MCOR_PAIR_SEED(MCOR_GRID_PARAMS, __global const uchar* side_flags, const real iso,
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

#if MCOR_OF_LATTICE
/* One work-item = one brick of a block. Reads its cells. Requests the bricks that have their
 * nodes. */
__kernel void mcor_pair_request(
  MCOR_BLOCK_PARAMS, __global const ulong* cells, __global uint* brick_bits)
{
  MCOR_ITEM(own, own < block_count * MCOR_BLOCK_BRICKS && cells[own] != 0);
  const int4 brick = mcor_brick_of_number(block_keys, blocks_x, blocks_y, own);
  for (int d = 0; d < 8; ++d)
  {
    const int m = mcor_cells_reach(cells[own], d)
      ? mcor_number_beside(MCOR_BLOCK_ARGS, own, brick, d & 1, d >> 1 & 1, d >> 2)
      : -1;
    if (m >= 0)
    {
      mcor_request_brick(brick_bits, m);
    }
  }
}

/* One work-item = one brick that has a slot. Writes its cells there. */
__kernel void mcor_pair_fill(MCOR_BLOCK_PARAMS, const int brick_count, __global const int4* bricks,
  __global const ulong* pair_cells, __global ulong* cells)
{
  MCOR_ITEM(slot, slot < brick_count);
  const int4 brick = bricks[slot];
  cells[slot] = pair_cells[mcor_brick_number(MCOR_BLOCK_ARGS, brick.x, brick.y, brick.z)];
}

/* Hands cells to a brick; false where it has no slot yet. flags: 1 a cell is new, 2 a brick must be
 * placed. Where no particle reaches there is no brick, and no node is valid. */
bool mcor_pair_push(MCOR_BLOCK_PARAMS, int4 brick, int slot, ulong pushed, __global uint* requested,
  __global uint* cells, __global int* flags)
{
  if (pushed == 0)
  {
    return true;
  }
  if (slot >= 0)
  {
    pushed = mcor_add_cells(cells, slot, pushed);
    if (pushed == 0)
    {
      return true;
    }
    atomic_or(flags, 1);
  }
  for (int d = 0; d < 8; ++d)
  {
    const int m = mcor_cells_reach(pushed, d)
      ? mcor_brick_number(
          MCOR_BLOCK_ARGS, brick.x + (d & 1), brick.y + (d >> 1 & 1), brick.z + (d >> 2))
      : -1;
    if (m >= 0 && mcor_request_brick(requested, m))
    {
      atomic_or(flags, 2);
    }
  }
  return slot >= 0;
}

/* One work-item = one brick with cells new to this round. Reads node masks. Grows the cells
 * examined by now through crossed faces of used cells, within the brick to the end, and one step
 * into its neighbours. */
__kernel void mcor_pair_grow(MCOR_BLOCK_PARAMS, const int brick_count, __global const int4* bricks,
  __global const int* neighbours, __global ulong* examined, __global const ulong* fresh,
  __global const ulong* above, __global const ulong* valid, __global uint* requested,
  __global uint* cells, __global int* flags)
{
  MCOR_ITEM(slot, slot < brick_count && fresh[slot] != 0);
  const ulong before = examined[slot];
  ulong m[8], faces[3], upper[3];
  mcor_brick_masks(above, neighbours, slot, 0, m);
  mcor_cell_corners(m);
  for (int a = 0; a < 3; ++a)
  {
    faces[a] = mcor_cell_faces(m, a, 0);
    upper[a] = mcor_cell_faces(m, a, 1);
  }
  const ulong crossed = mcor_cell_crossed(m, neighbours, valid, slot);
  ulong now = before;
  for (ulong last = 0; now != last;)
  {
    last = now;
    const ulong used = now & crossed;
    now |= mcor_cells_beside(used, faces, upper);
  }
  const ulong used = now & crossed;
  const int4 brick = bricks[slot];
  __global const int* n = neighbours + slot * 14L;
  bool all = mcor_pair_push(MCOR_BLOCK_ARGS, brick, slot, now & ~before, requested, cells, flags);
  for (int a = 0; a < 3; ++a)
  {
    const int4 by = (int4)(a == 0, a == 1, a == 2, 0);
    const int d = (1 << a) - 1, far = 3 << 2 * a;
    all &= mcor_pair_push(MCOR_BLOCK_ARGS, brick - by, n[d + 7],
      (used & faces[a] & mcor_lowest(a)) << far, requested, cells, flags);
    all &= mcor_pair_push(MCOR_BLOCK_ARGS, brick + by, n[d],
      (used & upper[a]) >> far & mcor_lowest(a), requested, cells, flags);
  }
  if (!all)
  {
    examined[slot] = 0; /* again in the next round, when those bricks exist */
  }
}

/* One work-item = one cell that another box, or the other end of a period, has reached. Requests the
 * bricks of its nodes. */
__kernel void mcor_pair_request_cells(
  MCOR_BLOCK_PARAMS, const int count, __global const int4* reached, __global uint* brick_bits)
{
  MCOR_ITEM(i, i < count);
  const int4 cell = reached[i];
  const ulong bit = 1UL << ((cell.x & 3) | (cell.y & 3) << 2 | (cell.z & 3) << 4);
  for (int d = 0; d < 8; ++d)
  {
    const int m = mcor_cells_reach(bit, d)
      ? mcor_brick_number(MCOR_BLOCK_ARGS, (cell.x >> 2) + (d & 1), (cell.y >> 2) + (d >> 1 & 1),
          (cell.z >> 2) + (d >> 2))
      : -1;
    if (m >= 0)
    {
      mcor_request_brick(brick_bits, m);
    }
  }
}

/* One work-item = one of these cells. Hands it to its brick; flags: 1 where it is new. */
__kernel void mcor_pair_take(MCOR_BLOCK_PARAMS, const int count, __global const int4* reached,
  __global const int* slot_of, __global uint* cells, __global int* flags)
{
  MCOR_ITEM(i, i < count);
  const int4 cell = reached[i];
  const int m = mcor_brick_number(MCOR_BLOCK_ARGS, cell.x >> 2, cell.y >> 2, cell.z >> 2);
  const int slot = m < 0 ? -1 : slot_of[m];
  const ulong bit = 1UL << ((cell.x & 3) | (cell.y & 3) << 2 | (cell.z & 3) << 4);
  if (slot >= 0 && mcor_add_cells(cells, slot, bit))
  {
    atomic_or(flags, 1);
  }
}
#endif
