/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The paper's seed selection [III-C] finds pairs of particles that are closer than the smoothing
 * length and have values on both sides of the iso value, and marks all cells on the straight line
 * between them. Cells without a block are not marked, because they certainly have no surface. */

/* Adds a cell to the reached cells of its brick, if the brick's block exists. `reached` is indexed
 * by the bricks' numbers. Returns whether the cell is new. */
bool mcor_pair_reach(MCOR_BLOCK_PARAMS, int x, int y, int z, __global uint* reached)
{
  const int number = mcor_brick_number(MCOR_BLOCK_ARGS, (int4)(x >> 2, y >> 2, z >> 2, 0));
  return number >= 0 &&
    mcor_add_cells(reached, number, 1UL << ((x & 3) | (y & 3) << 2 | (z & 3) << 4));
}

#if MCOR_OF_LATTICE
/* One work-item = one brick of a block. Requests slots for the bricks that have nodes of this
 * brick's reached cells. Sets flags[0] if a requested brick is new. */
__kernel void mcor_pair_request(
  MCOR_BLOCK_PARAMS, __global const ulong* reached, __global uint* brick_bits, __global int* flags)
{
  MCOR_ITEM(own, own < block_count * MCOR_BLOCK_BRICKS && reached[own] != 0);
  const int4 brick = mcor_brick_of_number(rungs, block_keys, own);
  for (int d = 0; d < 8; ++d)
  {
    const int m = mcor_cells_reach(reached[own], d)
      ? mcor_number_beside(MCOR_BLOCK_ARGS, own, brick, mcor_up(d))
      : -1;
    if (m >= 0 && mcor_request_brick(brick_bits, m))
    {
      atomic_or(flags, 1);
    }
  }
}
#endif

/* ---- Cells between pairs ---- */

#if MCOR_OF_FIELD
/* A kernel's last parameters, for marking cells. */
#define MCOR_MARK_PARAMS MCOR_BLOCK_PARAMS, __global uint* reached
#define MCOR_MARK_ARGS MCOR_BLOCK_ARGS, reached

/* Returns where the line from `from` leaves a cell along an axis, as a share of the line's length;
 * 2 if the line does not leave the cell along this axis (`ends`). low, edge: the cell's lower side
 * and its length; step: the direction, 1 or -1; gap: 1 / the line's extent along the axis.
 * Positions and lengths are in fixed-point units. */
real mcor_pair_crossing(long from, long low, long edge, int step, real gap, bool ends)
{
  const long side = step < 0 ? from - low : low + edge - from;
  return ends ? (real)2 : (real)side * gap;
}

/* Marks the cells on the line between particles j and k. If the line passes so close to a cell's
 * edge or corner that rounding decides, marks the cells on both sides. */
void mcor_pair_seed_pair(const mcor_grid* grid, MCOR_MARK_PARAMS, int j, int k)
{
  const fix from[3] = { grid->px[j], grid->py[j], grid->pz[j] };
  const fix to[3] = { grid->px[k], grid->py[k], grid->pz[k] };
  real next[3], gap[3];
  int c[3], end[3], step[3], steps = 0;
  long edge[3];
  for (int a = 0; a < 3; ++a)
  {
    edge[a] = grid->step[a];
    c[a] = (int)(from[a] / grid->step[a]);
    end[a] = (int)(to[a] / grid->step[a]);
    step[a] = to[a] < from[a] ? -1 : 1;
    gap[a] = to[a] == from[a] ? 0 : 1 / fabs((real)(to[a] - from[a]));
    next[a] = mcor_pair_crossing(from[a], c[a] * edge[a], edge[a], step[a], gap[a], c[a] == end[a]);
    steps += abs(end[a] - c[a]);
  }
  mcor_pair_reach(MCOR_BLOCK_ARGS, c[0], c[1], c[2], reached);
  for (; steps > 0; --steps)
  {
    int axis = next[1] < next[0] ? 1 : 0;
    axis = next[2] < next[axis] ? 2 : axis;
    for (int a = 0; a < 3; ++a)
    {
      if (a != axis && c[a] != end[a] && next[a] - next[axis] < (real)1e-5f)
      {
        mcor_pair_reach(MCOR_BLOCK_ARGS, c[0] + (a == 0 ? step[0] : 0),
          c[1] + (a == 1 ? step[1] : 0), c[2] + (a == 2 ? step[2] : 0), reached);
      }
    }
    c[axis] += step[axis];
    next[axis] = mcor_pair_crossing(
      from[axis], c[axis] * edge[axis], edge[axis], step[axis], gap[axis], c[axis] == end[axis]);
    mcor_pair_reach(MCOR_BLOCK_ARGS, c[0], c[1], c[2], reached);
  }
}

/* Greatest distance of a pair, in unscaled smoothing lengths. It is a little more than 1, so that
 * rounding does not decide for particles one smoothing length apart on a lattice. */
#define MCOR_PAIR_REACH ((real)1.0001)

/* Returns which of the tile's MCOR_LANES particles from i on may be partners of particle j, see
 * mcor_pair_seed_particle. */
fixv mcor_pair_candidates(const mcor_grid* grid, const mcor_query* query, const mcor_tile* tile,
  int i, int j, real iso, real h_scale)
{
  const real x = (real)(grid->px[j] - query->origin[0]) * grid->unit;
  const real y = (real)(grid->py[j] - query->origin[1]) * grid->unit;
  const real z = (real)(grid->pz[j] - query->origin[2]) * grid->unit;
  const real scale = h_scale / MCOR_PAIR_REACH, inv_h = grid->inv_h[j] * scale;
  /* Positions count from the query's origin. slack: the greatest rounding error of r2 for distances
   * up to the smoothing length 1 / inv_h. */
  const real* e = query->box.half_size;
  const real extent = 2 * fmax(e[0], fmax(e[1], e[2])) + query->radius;
  const real off = 16 * MCOR_UNIT_ROUNDOFF * extent, slack = off * (2 / inv_h + 3 * off);
  const fixv above = grid->value[j] >= iso ? (fixv)MCOR_TRUE : (fixv)0;
  const realv dx = MCOR_TILE(tile, x, i) - x, dy = MCOR_TILE(tile, y, i) - y,
              dz = MCOR_TILE(tile, z, i) - z, other = MCOR_TILE(tile, inv_h, i) * scale;
  const realv r2 = mcor_square(dx, dy, dz);
  return (r2 - slack) * inv_h * inv_h < (real)1 && (MCOR_TILE(tile, value, i) >= iso) != above &&
    MCOR_TILE(tile, weight, i) != 0 && (above || (r2 + slack) * other * other >= (real)1);
}

/* Marks the cells between particle j and each of its partners: particles k of the tile that are on
 * the other side of the iso value, and closer to j than j's smoothing length. If the distance is
 * less than k's smoothing length, too, only the particle above the iso value marks the cells.
 * Differences of positions are exact, so the result does not depend on which particles share a
 * tile. */
void mcor_pair_seed_particle(const mcor_grid* grid, const mcor_query* query, const mcor_tile* tile,
  int j, real iso, real h_scale, MCOR_MARK_PARAMS)
{
  const real scale = h_scale / MCOR_PAIR_REACH, own = grid->inv_h[j] * scale;
  for (int i = 0; i < tile->count; i += MCOR_LANES)
  {
    int lanes[MCOR_LANES];
    const fixv candidates = mcor_pair_candidates(grid, query, tile, i, j, iso, h_scale);
    const int count = mcor_list_lanes(candidates, min(MCOR_LANES, tile->count - i), lanes);
    for (int c = 0; c < count; ++c)
    {
      const int k = MCOR_INDEX(tile, i + lanes[c]);
      const real x = (real)(grid->px[k] - grid->px[j]) * grid->unit;
      const real y = (real)(grid->py[k] - grid->py[j]) * grid->unit;
      const real z = (real)(grid->pz[k] - grid->pz[j]) * grid->unit;
      const real r2 = x * x + y * y + z * z, other = grid->inv_h[k] * scale;
      if (r2 * own * own < 1 && (grid->value[j] >= iso || r2 * other * other >= 1))
      {
        mcor_pair_seed_pair(grid, MCOR_MARK_ARGS, j, k);
      }
    }
  }
}

/* Fits the query to the particles from `begin` on, until `end` or until x descends, see
 * mcor_query_particles. The query's radius is the greatest distance at which any of these particles
 * may have a partner. Returns the number of these particles. */
int mcor_pair_query(const mcor_grid* grid, int begin, int end, real h_scale, mcor_query* query)
{
  real coarsest;
  const int count = mcor_query_particles(grid, query, begin, end, &coarsest);
  query->radius = (float)(MCOR_PAIR_REACH / (coarsest * h_scale));
  return count;
}

/* Marks the cells between particles [begin, end), to which the query was fitted, and their
 * partners. */
void mcor_pair_seed_particles(const mcor_grid* grid, mcor_query* query, int begin, int end,
  real iso, real h_scale, MCOR_MARK_PARAMS)
{
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool first = true; mcor_tile_next(grid, query, &tile, first); first = false)
  {
    const int seen = mcor_tile_sides(&tile, 0, iso);
    realv most = 0; /* inv_h */
    real finest = 0;
    for (int i = 0; i < tile.count; i += MCOR_LANES)
    {
      most = fmax(most, MCOR_TILE(&tile, inv_h, i));
    }
    for (int lane = 0; lane < MCOR_LANES; ++lane)
    {
      finest = fmax(finest, MCOR_GET(most, lane));
    }
    for (int j = begin; j < end && (seen == 3 || !tile.complete); ++j)
    {
      /* A particle below the iso value leaves all its pairs to its partners if no particle of the
       * tile has a shorter smoothing length. */
      const bool leaves = grid->value[j] < iso && grid->inv_h[j] >= finest;
      if (!leaves && (!MCOR_SOLIDS || grid->weight[j] != 0))
      {
        mcor_pair_seed_particle(grid, query, &tile, j, iso, h_scale, MCOR_MARK_ARGS);
      }
    }
  }
}

/* One work-item = MCOR_PAIR_VECTORS_OF(MCOR_LANES) groups of MCOR_LANES sorted particles. Marks the
 * cells on the lines between these particles and their partners. Most particles are far from the
 * surface. So the kernel first tests whether values on both sides of the iso value occur around a
 * whole run of particles whose x does not descend, then around each group of the run. The particles
 * around a group are read only if both tests succeed. */
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
