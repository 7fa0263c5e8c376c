/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Growth of the cells between pairs [III-C], from cell to cell through crossed faces. */

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
