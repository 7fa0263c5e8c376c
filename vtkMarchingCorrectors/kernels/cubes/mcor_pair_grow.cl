/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Grows the set of cells between pairs of particles [III-C], see mcor_pair.cl, from cell to cell
 * through crossed faces. */

/* Whether any node of these cells is in a brick beside theirs that has a block, but no slot. */
bool mcor_pair_lacks(
  MCOR_BLOCK_PARAMS, __global const int* neighbours, int slot, int own, int4 brick, ulong cells)
{
  bool lacks = false;
  for (int d = 1; d < 8; ++d)
  {
    lacks = lacks ||
      (mcor_cells_reach(cells, d) && neighbours[slot * 14L + d - 1] < 0 &&
        mcor_number_beside(MCOR_BLOCK_ARGS, own, brick, mcor_up(d)) >= 0);
  }
  return lacks;
}

/* One work-item = one brick. If the brick has reached cells that are new since the last round,
 * reads the masks of the brick's nodes. Grows the brick's set of reached cells through crossed
 * faces of used cells: within the brick until nothing changes, and one step into the neighbouring
 * bricks. domain: cells whose nodes all have correct values. Sets flags[0] if a cell of a
 * neighbouring brick is newly reached. */
__kernel void mcor_pair_grow(const int brick_count, __global const int* neighbours,
  __global const ulong* above, __global const ulong* valid, __global const int4* bricks,
  MCOR_BLOCK_PARAMS, __global const ulong* domain, __global ulong* grown, __global uint* reached,
  __global int* flags)
{
  MCOR_ITEM(i, i < brick_count);
  const int4 brick = bricks[i];
  const int own = mcor_brick_number(MCOR_BLOCK_ARGS, brick);
  const ulong before = grown[own];
  /* Other work-items add cells meanwhile; cells that are missed here are read in the next round. */
  const ulong first = atomic_or(reached + 2L * own, 0), rest = atomic_or(reached + 2L * own + 1, 0);
  ulong cells = domain[i] & (rest << 32 | first);
  if (cells == before)
  {
    return;
  }
  ulong m[8], v[8], lower[3], upper[3];
  mcor_corners_of(above, neighbours, i, m);
  mcor_corners_of(valid, neighbours, i, v);
  const ulong used = mcor_cells_crossed(m, v);
  for (int a = 0; a < 3; ++a)
  {
    lower[a] = mcor_cell_faces(m, a, 0);
    upper[a] = mcor_cell_faces(m, a, 1);
  }
  for (ulong last = 0; cells != last;)
  {
    last = cells;
    for (int a = 0; a < 3; ++a)
    {
      cells |= domain[i] &
        (mcor_from_next(a, last & used & lower[a], 0) |
          mcor_from_last(a, last & used & upper[a], 0));
    }
  }
  mcor_add_cells(reached, own, cells);
  if (!mcor_pair_lacks(MCOR_BLOCK_ARGS, neighbours, i, own, brick, cells))
  {
    grown[own] = cells; /* else the brick is treated again when the missing slots exist */
  }
  const ulong fresh = cells & ~before & used;
  for (int face = 0; face < 6 && fresh; ++face)
  {
    const int axis = face >> 1, side = face & 1, shift = 3 << 2 * axis;
    const int4 step = (int4)(axis == 0, axis == 1, axis == 2, 0) * (side ? 1 : -1);
    const ulong low = mcor_lowest(axis);
    const ulong at = fresh & (side ? upper[axis] & low << shift : lower[axis] & low);
    const int other = at ? mcor_number_beside(MCOR_BLOCK_ARGS, own, brick, step) : -1;
    if (other >= 0 && mcor_add_cells(reached, other, side ? at >> shift : at << shift))
    {
      atomic_or(flags, 1);
    }
  }
}

/* One work-item = one brick of a block. Adds periodic images of the brick's reached cells, shifted
 * by at most one period along each axis. Only images in the first period, or at most `ring` cells
 * outside of it, are added. first, period: where the first period begins, and its length, in cells;
 * a length of 0: not periodic along this axis. Sets flags[0] if an added cell is new. */
__kernel void mcor_pair_wrap(MCOR_BLOCK_PARAMS, const int ring, const int first_x,
  const int first_y, const int first_z, const int period_x, const int period_y, const int period_z,
  __global uint* reached, __global int* flags)
{
  MCOR_ITEM(own, own < block_count * MCOR_BLOCK_BRICKS);
  const int4 brick = mcor_brick_of_number(rungs, block_keys, own);
  const int first[3] = { first_x, first_y, first_z };
  const int period[3] = { period_x, period_y, period_z };
  const ulong low = atomic_or(reached + 2L * own, 0), high = atomic_or(reached + 2L * own + 1, 0);
  for (ulong rest = high << 32 | low; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    const int at[3] = { 4 * brick.x + (cell & 3), 4 * brick.y + (cell >> 2 & 3),
      4 * brick.z + (cell >> 4) };
    for (int image = 0; image < 27; ++image)
    {
      const int by[3] = { image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1 };
      int to[3];
      bool in = true;
      for (int a = 0; a < 3; ++a)
      {
        to[a] = at[a] + by[a] * period[a];
        in = in &&
          (by[a] == 0 ||
            (period[a] > 0 && to[a] >= first[a] - ring && to[a] < first[a] + period[a] + ring));
      }
      if (in && mcor_pair_reach(MCOR_BLOCK_ARGS, to[0], to[1], to[2], reached))
      {
        atomic_or(flags, 1);
      }
    }
  }
}

/* One work-item = one brick. Writes to the brick's slot the reached cells and the seeds, i.e. the
 * cells that pairs marked. */
__kernel void mcor_pair_fill(const int brick_count, __global const int4* bricks, MCOR_BLOCK_PARAMS,
  __global const ulong* reached, __global const ulong* marked, __global ulong* cells,
  __global ulong* seeds)
{
  MCOR_ITEM(i, i < brick_count);
  const int own = mcor_brick_number(MCOR_BLOCK_ARGS, bricks[i]);
  cells[i] = reached[own];
  seeds[i] = marked[own];
}
