/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The paper's seed selection [III-C]: pairs of particles closer than the smoothing length with
 * values on both sides, and all cells on the straight line between them; then the growth from cell
 * to cell through crossed faces. */

/* Marks the bricks that the segment's bounding box touches. */
void mcor_pair_mark_bricks(MCOR_BLOCK_PARAMS, const int* a, const int* b, __global uchar* marks)
{
  for (int z = min(a[2], b[2]) >> 2; z <= max(a[2], b[2]) >> 2; ++z)
  {
    for (int y = min(a[1], b[1]) >> 2; y <= max(a[1], b[1]) >> 2; ++y)
    {
      for (int x = min(a[0], b[0]) >> 2; x <= max(a[0], b[0]) >> 2; ++x)
      {
        const int m = mcor_find_mark(MCOR_BLOCK_ARGS, x, y, z);
        if (m >= 0)
        {
          marks[m] = 1;
        }
      }
    }
  }
}

void mcor_pair_mark_cell(MCOR_BRICK_PARAMS, int x, int y, int z, __global uint* cells)
{
  const int slot = mcor_find_brick(MCOR_BRICK_ARGS, x >> 2, y >> 2, z >> 2);
  if (slot >= 0)
  {
    atomic_or(cells + 2 * slot + (z >> 1 & 1),
      1u << ((x & 3) | (y & 3) << 2 | (z & 1) << 4));
  }
}

/* All cells on the line from p to q (cubes, relative to cell c), beginning in cell c. Where the line passes an edge or a
 * corner of a cell to within rounding, the cells on both sides are marked. */
void mcor_pair_mark_line(
  MCOR_BRICK_PARAMS, const real* p, const real* q, int* c, const int* end, __global uint* cells)
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
  mcor_pair_mark_cell(MCOR_BRICK_ARGS, c[0], c[1], c[2], cells);
  for (; steps > 0; --steps)
  {
    int axis = next[1] < next[0] ? 1 : 0;
    axis = next[2] < next[axis] ? 2 : axis;
    for (int a = 0; a < 3; ++a)
    {
      if (a != axis && next[a] - next[axis] < (real)1e-5f)
      {
        mcor_pair_mark_cell(MCOR_BRICK_ARGS, c[0] + (a == 0 ? step[0] : 0),
          c[1] + (a == 1 ? step[1] : 0), c[2] + (a == 2 ? step[2] : 0), cells);
      }
    }
    c[axis] += step[axis];
    next[axis] += gap[axis];
    mcor_pair_mark_cell(MCOR_BRICK_ARGS, c[0], c[1], c[2], cells);
  }
}

/* One work-item = MCOR_LANES sorted particles. Reads the particles within the smoothing length of
 * each. mark_cells 0: marks bricks for pairs that straddle the iso value; 1: marks cells. */
__kernel void mcor_pair_mark(MCOR_GRID_PARAMS, MCOR_BRICK_PARAMS, const real iso,
  const int mark_cells, __global uchar* marks, __global uint* cells)
{
  const int begin = get_global_id(0) * MCOR_LANES;
  if (begin >= particle_count)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const int count = min(MCOR_LANES, particle_count - begin);
  mcor_query query;
  const real coarsest = mcor_query_particles(&grid, &query, begin, count);
  query.radius = (float)(1 / coarsest);
  int sides = 0;
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool first = true; mcor_tile_next(&grid, &query, &tile, first); first = false)
  {
    sides |= mcor_seed_sides(&tile, iso);
    if (sides != 3 && tile.complete)
    {
      return;
    }
    for (int lane = 0; lane < count; ++lane)
    {
      const int j = begin + lane;
      for (int i = 0; i < tile.count; ++i)
      {
        const int k = tile.list[i];
        const real x = (real)(px[k] - px[j]), y = (real)(py[k] - py[j]), z = (real)(pz[k] - pz[j]);
        const real scale = grid.unit * p_inv_h[j];
        if ((p_value[j] >= iso) == (p_value[k] >= iso) ||
          (x * x + y * y + z * z) * scale * scale >= 1 ||
          (MCOR_SOLIDS && (p_weight[j] == 0 || p_weight[k] == 0)))
        {
          continue;
        }
        int a[3] = { (int)(px[j] >> fix_bits), (int)(py[j] >> fix_bits), (int)(pz[j] >> fix_bits) };
        const int b[3] = { (int)(px[k] >> fix_bits), (int)(py[k] >> fix_bits),
          (int)(pz[k] >> fix_bits) };
        if (mark_cells)
        {
          /* Relative to cell a, so that single precision suffices. */
          const fix ax = (fix)a[0] << fix_bits, ay = (fix)a[1] << fix_bits,
                    az = (fix)a[2] << fix_bits;
          const real p[3] = { (real)(px[j] - ax) * grid.unit, (real)(py[j] - ay) * grid.unit,
            (real)(pz[j] - az) * grid.unit };
          const real q[3] = { p[0] + x * grid.unit, p[1] + y * grid.unit, p[2] + z * grid.unit };
          mcor_pair_mark_line(MCOR_BRICK_ARGS, p, q, a, b, cells);
        }
        else
        {
          mcor_pair_mark_bricks(MCOR_BLOCK_ARGS, a, b, marks);
        }
      }
    }
  }
}

/* Per cell of a brick: whether its lower face across an axis is crossed, i.e. has nodes on both
 * sides. m: node masks of the brick and its upper neighbours; u, v: bits of the other two axes. */
ulong mcor_pair_faces(const ulong* m, int first, int axis)
{
  const int u = axis == 0 ? 2 : 1, v = axis == 2 ? 2 : 4;
  ulong some[2], all[2];
  for (int i = 0; i < 2; ++i)
  {
    const ulong own = m[first | (i ? v : 0)], next = m[first | u | (i ? v : 0)];
    const ulong shifted =
      axis == 0 ? mcor_from_next_y(own, next) : mcor_from_next_x(own, next);
    some[i] = own | shifted;
    all[i] = own & shifted;
  }
  return axis == 2
    ? (some[0] | mcor_from_next_y(some[0], some[1])) & ~(all[0] & mcor_from_next_y(all[0], all[1]))
    : (some[0] | mcor_from_next_z(some[0], some[1])) & ~(all[0] & mcor_from_next_z(all[0], all[1]));
}

/* Hands cells to a neighbour brick. flags: 1 a cell is new, 2 a brick must be placed. */
void mcor_pair_push(MCOR_BLOCK_PARAMS, int4 brick, int slot, ulong pushed, __global uchar* marks,
  __global uint* cells, __global int* flags)
{
  if (pushed == 0)
  {
    return;
  }
  const int m = mcor_find_mark(MCOR_BLOCK_ARGS, brick.x, brick.y, brick.z);
  if (m < 0)
  {
    return; /* beyond the reach of all particles: no node there is valid */
  }
  if (marks[m] == 0)
  {
    marks[m] = 1;
    atomic_or(flags, 2);
  }
  if (slot >= 0)
  {
    const uint low = (uint)pushed, high = (uint)(pushed >> 32);
    const uint new_low = low & ~atomic_or(cells + 2 * slot, low);
    const uint new_high = high & ~atomic_or(cells + 2 * slot + 1, high);
    if (new_low | new_high)
    {
      atomic_or(flags, 1);
    }
  }
}

/* One work-item = one brick. Reads node masks. Grows the cells to examine through crossed faces of
 * used cells, within the brick to the end, and one step into its neighbours. */
__kernel void mcor_pair_grow(MCOR_BLOCK_PARAMS, const int brick_count,
  __global const int4* bricks, __global const int* neighbours, __global const ulong* above,
  __global const ulong* valid, __global uchar* marks, __global uint* cells, __global int* flags)
{
  const int slot = get_global_id(0);
  if (slot >= brick_count)
  {
    return;
  }
  /* Atomic, as neighbours may add cells in the meantime; what is missed here comes next round. */
  const ulong before =
    atomic_or(cells + 2 * slot, 0) | (ulong)atomic_or(cells + 2 * slot + 1, 0) << 32;
  if (before == 0)
  {
    return;
  }
  ulong m[8], faces[3], upper[3];
  mcor_brick_masks(above, neighbours, slot, 0, m);
  for (int a = 0; a < 3; ++a)
  {
    const ulong next = mcor_pair_faces(m, 1 << a, a);
    faces[a] = mcor_pair_faces(m, 0, a);
    upper[a] = a == 0 ? mcor_from_next_x(faces[a], next)
      : a == 1        ? mcor_from_next_y(faces[a], next)
                      : mcor_from_next_z(faces[a], next);
  }
  const ulong some = mcor_cell_some(m);
  mcor_brick_masks(above, neighbours, slot, 0, m);
  const ulong mixed = some & ~mcor_cell_all(m);
  mcor_brick_masks(valid, neighbours, slot, 0, m);
  const ulong crossed = mixed & mcor_cell_all(m);
  ulong now = before;
  for (ulong last = 0; now != last;)
  {
    last = now;
    const ulong used = now & crossed;
    now |= mcor_from_next_x(used & faces[0], 0) | mcor_from_last_x(used & upper[0], 0) |
      mcor_from_next_y(used & faces[1], 0) | mcor_from_last_y(used & upper[1], 0) |
      mcor_from_next_z(used & faces[2], 0) | mcor_from_last_z(used & upper[2], 0);
  }
  const ulong used = now & crossed;
  const int4 brick = bricks[slot];
  __global const int* n = neighbours + slot * 14;
  mcor_pair_push(MCOR_BLOCK_ARGS, brick, slot, now & ~before, marks, cells, flags);
  mcor_pair_push(MCOR_BLOCK_ARGS, brick + (int4)(-1, 0, 0, 0), n[7],
    (used & faces[0] & MCOR_LOW_X) << 3, marks, cells, flags);
  mcor_pair_push(MCOR_BLOCK_ARGS, brick + (int4)(1, 0, 0, 0), n[0],
    (used & upper[0]) >> 3 & MCOR_LOW_X, marks, cells, flags);
  mcor_pair_push(MCOR_BLOCK_ARGS, brick + (int4)(0, -1, 0, 0), n[8],
    (used & faces[1] & MCOR_LOW_Y) << 12, marks, cells, flags);
  mcor_pair_push(MCOR_BLOCK_ARGS, brick + (int4)(0, 1, 0, 0), n[1],
    (used & upper[1]) >> 12 & MCOR_LOW_Y, marks, cells, flags);
  mcor_pair_push(MCOR_BLOCK_ARGS, brick + (int4)(0, 0, -1, 0), n[10],
    (used & faces[2] & MCOR_LOW_Z) << 48, marks, cells, flags);
  mcor_pair_push(MCOR_BLOCK_ARGS, brick + (int4)(0, 0, 1, 0), n[3], (used & upper[2]) >> 48, marks,
    cells, flags);
}
