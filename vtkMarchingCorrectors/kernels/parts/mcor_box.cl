/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* A box of cells of the lattice; see mcor_box.c. */

/* Cells from the first to before the last, by axis. */
#define MCOR_BOX_PARAMS                                                                         \
  const int first_x, const int first_y, const int first_z, const int last_x, const int last_y,     \
    const int last_z

/* Those of a brick's cells that are in the box. */
ulong mcor_box_cells(MCOR_BOX_PARAMS, int4 brick)
{
  const int4 cell = brick * MCOR_BRICK;
  ulong cells = ~0UL;
  for (int i = 0; i < MCOR_BRICK; ++i)
  {
    cells &= cell.x + i >= first_x && cell.x + i < last_x ? ~0UL : ~(MCOR_LOW_X << i);
    cells &= cell.y + i >= first_y && cell.y + i < last_y ? ~0UL : ~(MCOR_LOW_Y << 4 * i);
    cells &= cell.z + i >= first_z && cell.z + i < last_z ? ~0UL : ~(MCOR_LOW_Z << 16 * i);
  }
  return cells;
}

#define MCOR_BOX_ARGS first_x, first_y, first_z, last_x, last_y, last_z

/* Whether the box's cells have nodes among those of a cube, `size` nodes long. */
bool mcor_box_reaches(MCOR_BOX_PARAMS, int4 node, int size)
{
  return node.x + size > first_x && node.x <= last_x && node.y + size > first_y &&
    node.y <= last_y && node.z + size > first_z && node.z <= last_z;
}

/* One work-item = one cube, `size` nodes long. Makes void what has no node of the box. */
__kernel void mcor_box_void_cubes(const int count, const int cubes_x, const int cubes_y,
  __global const ulong* keys, const int size, MCOR_BOX_PARAMS, __global uchar* states)
{
  const int i = get_global_id(0);
  if (i < count &&
    !mcor_box_reaches(
      MCOR_BOX_ARGS, mcor_block_of_key(keys[i], cubes_x, cubes_y) * size, size))
  {
    states[i] = MCOR_VOID;
  }
}

/* One work-item = one brick of a block. The same; and what is void gets no slot. */
__kernel void mcor_box_void_bricks(const int block_count, const int blocks_x, const int blocks_y,
  __global const ulong* block_keys, MCOR_BOX_PARAMS, __global uchar* states,
  __global uint* brick_bits)
{
  const int m = get_global_id(0);
  if (m < block_count * MCOR_BLOCK_BRICKS &&
    !mcor_box_reaches(MCOR_BOX_ARGS,
      mcor_brick_of_number(block_keys, blocks_x, blocks_y, m) * MCOR_BRICK, MCOR_BRICK))
  {
    states[m] = MCOR_VOID;
    atomic_and(brick_bits + (m >> 5), ~(1u << (m & 31)));
  }
}

/* One work-item = one brick. Writes those of its cells that are in the box. */
__kernel void mcor_box_clip(const int brick_count, __global const int4* bricks,
  MCOR_BOX_PARAMS, __global const ulong* cells, __global ulong* clipped)
{
  const int slot = get_global_id(0);
  if (slot < brick_count)
  {
    clipped[slot] = cells[slot] & mcor_box_cells(MCOR_BOX_ARGS, bricks[slot]);
  }
}

/* One work-item = one brick. Reads used cells and node masks. Writes the keys of their cells to its
 * triangles. The loops count up since Intel's compiler (2026.2) crashed on others. */
__kernel void mcor_box_mark(const int brick_count, const int blocks_x, const int blocks_y,
  __global const int4* bricks,
  __global const int* neighbours, MCOR_BOX_PARAMS, __global const ulong* used,
  __global const ulong* above, __global const uchar* case_table, __global const int* triangle_base,
  __global ulong* triangle_cells)
{
  const int slot = get_global_id(0);
  if (slot >= brick_count || used[slot] == 0)
  {
    return;
  }
  ulong m[8];
  mcor_brick_masks(above, neighbours, slot, 0, m);
  mcor_cell_corners(m);
  const ulong cells = mcor_box_cells(MCOR_BOX_ARGS, bricks[slot]);
  const ulong key = mcor_brick_place(blocks_x, blocks_y, bricks[slot]) << 6;
  int to = triangle_base[slot];
  for (ulong rest = used[slot]; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    const ulong cell_key = key | (ulong)cell | (~cells >> cell & 1) * MCOR_RING_CELL;
    const int count = case_table[mcor_march_case(m, cell) * 16 + 15];
    for (int i = 0; i < count; ++i)
    {
      triangle_cells[to + i] = cell_key;
    }
    to += count;
  }
}

/* The same, where the field decided on the topology. */
__kernel void mcor_box_mark_resolved(const int brick_count, const int blocks_x,
  const int blocks_y, __global const int4* bricks,
  __global const int* neighbours, MCOR_BOX_PARAMS, __global const ulong* used,
  __global const ulong* above, __global const ulong* decisions, __global const int* cases,
  __global const mcor_cell_row* rows, __global const int* triangle_base, __global ulong* triangle_cells)
{
  const int slot = get_global_id(0);
  if (slot >= brick_count || used[slot] == 0)
  {
    return;
  }
  ulong m[8];
  mcor_brick_masks(above, neighbours, slot, 0, m);
  mcor_cell_corners(m);
  const ulong cells = mcor_box_cells(MCOR_BOX_ARGS, bricks[slot]);
  const ulong key = mcor_brick_place(blocks_x, blocks_y, bricks[slot]) << 6;
  int to = triangle_base[slot], tunnel;
  for (ulong rest = used[slot]; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    const ulong cell_key = key | (ulong)cell | (~cells >> cell & 1) * MCOR_RING_CELL;
    const int count =
      mcor_topology_cell(m, neighbours, decisions, cases, rows, slot, cell, &tunnel)->triangles;
    for (int i = 0; i < count; ++i)
    {
      triangle_cells[to + i] = cell_key;
    }
    to += count;
  }
}

/* One work-item = one batch of triangles. Reads what mcor_trim_count did. Writes to what remains of a
 * triangle the cell it was in. */
__kernel void mcor_box_trim(const int triangle_count, __global const int* triangles,
  __global const real* weight, const real threshold, __global const int* remaining,
  __global const ulong* cells, __global ulong* trimmed)
{
  const int batch = get_global_id(0);
  const long begin = (long)batch * MCOR_BATCH;
  if (begin >= triangle_count)
  {
    return;
  }
  int to = remaining[batch];
  for (long i = begin; to < remaining[batch + 1]; ++i)
  {
    int inside = 0;
    for (int c = 0; c < 3; ++c)
    {
      inside += weight[triangles[3 * i + c]] > threshold;
    }
    const int left = inside == 0 ? 0 : inside == 2 ? 2 : 1;
    for (int k = 0; k < left; ++k)
    {
      trimmed[to++] = cells[i];
    }
  }
}
