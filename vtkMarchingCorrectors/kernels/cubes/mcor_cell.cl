/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Keeps a brick's cells and edges as masks of 64 bits. Finds how a cell is cut: by its case, and by
 * the field's decisions on its faces and on tunnels in it. The bit of a cell, or of an edge along
 * an axis, is the bit of its lowest node, x + 4 y + 16 z. */

/* Turns m, the node masks of a brick and its upper neighbours, into masks of corners: bit n of mask
 * c then belongs to corner c (bits x, y, z) of cell n. */
MCOR_ONE_COPY void mcor_cell_corners(ulong* m)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int i = 0; i < 8; ++i)
    {
      m[i] = i >> axis & 1 ? mcor_from_next(axis, m[i ^ 1 << axis], m[i]) : m[i];
    }
  }
}

/* Returns the cells whose lower (side 0) or upper (side 1) face across an axis is crossed, i.e. has
 * nodes on both sides of the iso value. */
ulong mcor_cell_faces(const ulong* corners, int axis, int side)
{
  ulong some = 0, all = ~0UL;
  for (int c = 0; c < 8; ++c)
  {
    some |= (c >> axis & 1) == side ? corners[c] : 0;
    all &= (c >> axis & 1) == side ? corners[c] : ~0UL;
  }
  return some & ~all;
}

/* Returns the cells whose corners are all valid, but not all on the same side of the iso value. */
ulong mcor_cells_crossed(const ulong* above, const ulong* valid)
{
  ulong some = 0, all = ~0UL, usable = ~0UL;
  for (int c = 0; c < 8; ++c)
  {
    some |= above[c];
    all &= above[c];
    usable &= valid[c];
  }
  return some & ~all & usable;
}

/* Makes masks of a brick's cell corners from all bricks' node masks, see mcor_cell_corners. */
void mcor_corners_of(
  __global const ulong* masks, __global const int* neighbours, int slot, ulong* corners)
{
  mcor_brick_masks(masks, neighbours, slot, 0, corners);
  mcor_cell_corners(corners);
}

/* Finds, for the edges of a brick along an axis, the bits of the four cells (quadrants) around each
 * edge. b and c are the other two axes. q[0]: the cell at higher b and higher c than the edge;
 * q[1]: at lower b, higher c; q[2]: at higher b, lower c; q[3]: at lower b, lower c. m: cell masks
 * of the brick and its lower neighbours. */
MCOR_ONE_COPY void mcor_cell_around(const ulong* m, int axis, ulong* q)
{
  const int b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
  q[0] = m[0];
  q[1] = mcor_from_last(b, m[0], m[1 << b]);
  q[2] = mcor_from_last(c, m[0], m[1 << c]);
  q[3] = mcor_from_last(c, q[1], mcor_from_last(b, m[1 << c], m[1 << b | 1 << c]));
}

/* A brick has MCOR_EDGE_MASKS masks of edges. Mask `axis` has the crossed edges along the axis.
 * Mask 3 + axis has the edges of mask `axis` next to a cell that is not used (see mcor_march.cl).
 * Mask 6 + axis has the pinched edges: only two of the four cells around such an edge are used, and
 * these two are opposite to each other. Each of the two has a vertex of its own on the edge. The
 * second vertex is for the cell that is lower along the first of the other two axes. */

/* Number of nodes of a brick's cells. */
#define MCOR_CELL_NODES 125

/* Returns how many vertices of a brick lie on edges whose lower node has a number below n. e: the
 * brick's edge masks. */
int mcor_edge_rank(__global const ulong* e, int n)
{
  const ulong below = (1UL << n) - 1;
  int rank = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    rank += (int)(popcount(e[axis] & below) + popcount(e[6 + axis] & below));
  }
  return rank;
}

/* Writes the number of the vertex on each crossed edge of a brick's cells to numbers[axis][x + 5 y
 * + 25 z], where (x, y, z) is the edge's lower node in the brick. A pinched edge gets -1 - v, where
 * v is the first of its two vertices. upper: slots of the brick's upper neighbours, or -1. */
void mcor_edge_numbers(__global const int* upper, __global const ulong* edges,
  __global const int* vertex_base, int slot, int numbers[3][MCOR_CELL_NODES])
{
  for (int d = 0; d < 8; ++d)
  {
    const int owner = d ? upper[d - 1] : slot;
    if (owner < 0)
    {
      continue;
    }
    __global const ulong* e = edges + (long)owner * MCOR_EDGE_MASKS;
    const ulong border = mcor_on_sides(~d & 1, ~d >> 1 & 1, ~d >> 2 & 1);
    for (ulong rest = (e[0] | e[1] | e[2]) & border; rest; rest &= rest - 1)
    {
      const int n = mcor_ctz(rest);
      const int at = (n & 3) + 5 * (n >> 2 & 3) + 25 * (n >> 4) + 4 * (d & 1) + 20 * (d >> 1 & 1) +
        100 * (d >> 2);
      int number = vertex_base[owner] + mcor_edge_rank(e, n);
      for (int axis = 0; axis < 3; ++axis)
      {
        if (e[axis] >> n & 1)
        {
          const bool pinched = e[6 + axis] >> n & 1;
          numbers[axis][at] = pinched ? -1 - number : number;
          number += 1 + pinched;
        }
      }
    }
  }
}

/* Returns the Marching Cubes case of a cell: bit c is set if corner c is above the iso value. */
int mcor_march_case(const ulong* corners, int cell)
{
  int result = 0;
  for (int c = 0; c < 8; ++c)
  {
    result |= (int)(corners[c] >> cell & 1) << c;
  }
  return result;
}

/* Returns the index of the row (a way to triangulate) for a cell. The ambiguous faces of the cell's
 * case have the numbers k = 0, 1, ... The result is the index of the case's first row, plus 2^k for
 * each face k on which the nodes above the iso value are joined. corners: see mcor_cell_corners. */
int mcor_topology_row(const ulong* corners, __global const int* neighbours,
  __global const ulong* decisions, __global const int* cases, int slot, int cell)
{
  const int entry = cases[mcor_march_case(corners, cell)];
  int row = entry >> 6, bit = 1;
  for (int face = 0; face < 6; ++face)
  {
    if (entry >> face & 1)
    {
      const int axis = face >> 1, shift = 2 * axis;
      const int outside = face & 1 & ((cell >> shift & 3) == 3);
      const int owner = outside ? neighbours[slot * 14L + (1 << axis) - 1] : slot;
      const int n = outside ? cell - (3 << shift) : cell + ((face & 1) << shift);
      row += decisions[owner * (long)MCOR_DECISION_MASKS + axis] >> n & 1 ? bit : 0;
      bit <<= 1;
    }
  }
  return row;
}

/* Parameters that say how cells are cut: the rows (ways to triangulate a cell) of all cases, and,
 * if the topology is resolved, the field's decisions on faces and cells. */
#define MCOR_CUT_PARAMS                                                                            \
  const int resolved, __global const int *neighbours, __global const ulong *decisions,             \
    __global const int *cases, __global const mcor_cell_row *rows
#define MCOR_CUT_ARGS resolved, neighbours, decisions, cases, rows

/* Returns the row by which a cell without finer nodes is triangulated. If the topology is resolved,
 * the field's decisions choose the row. Else the cell gets the first row of its case, which joins
 * no nodes above the iso value on ambiguous faces. Adds 1 to *tunnels if the cell has a tunnel. */
__global const mcor_cell_row* mcor_cell_cut(
  const ulong* corners, MCOR_CUT_PARAMS, int slot, int cell, int* tunnels)
{
  const int first = cases[mcor_march_case(corners, cell)] >> 6;
  if (!resolved)
  {
    return rows + first;
  }
  __global const ulong* cells = decisions + slot * (long)MCOR_DECISION_MASKS + 3;
  const int row = mcor_topology_row(corners, neighbours, decisions, cases, slot, cell);
  __global const uchar* choice = rows[row].tunnel;
  const int other = cells[0] >> cell & 1 ? choice[0] : cells[1] >> cell & 1 ? choice[1] : 0;
  *tunnels += other != 0;
  return rows + (other ? first + other : row);
}

/* Writes the triangles of a cell that is cut as `row` says. Returns their number. */
int mcor_cell_emit(__global const mcor_cell_row* row, const int numbers[3][MCOR_CELL_NODES],
  int cell, __global int* to)
{
  const int first = (cell & 3) + 5 * (cell >> 2 & 3) + 25 * (cell >> 4);
  for (int i = 0; i < 3 * row->triangles; ++i)
  {
    const int edge = row->edges[i], axis = edge >> 3, x = edge & 1, y = edge >> 1 & 1;
    const int number = numbers[axis][first + x + 5 * y + 25 * (edge >> 2 & 1)];
    /* A negative number marks a pinched edge, which has two vertices. The cell at lower coordinates
     * along the first of the other two axes takes the second vertex. */
    to[i] = number >= 0 ? number : -1 - number + (axis == 0 ? y : x);
  }
  return row->triangles;
}
