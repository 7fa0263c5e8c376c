/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The way a cell is cut: by its case, and by the field's decisions on its faces and on tunnels
 * in it. */

/* Returns the Marching Cubes case of a cell: bit c is set if corner c is above. */
int mcor_march_case(const ulong* corners, int cell)
{
  int result = 0;
  for (int c = 0; c < 8; ++c)
  {
    result |= (int)(corners[c] >> cell & 1) << c;
  }
  return result;
}

/* Returns the first row of a cell's case, plus the number of its decisions on faces. corners:
 * see mcor_cell_corners. */
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

/* Data by which cells are cut: the rows of all cases, and, if the topology is resolved, the
 * decisions on faces and cells. */
#define MCOR_CUT_PARAMS                                                                            \
  const int resolved, __global const int *neighbours, __global const ulong *decisions,             \
    __global const int *cases, __global const mcor_cell_row *rows
#define MCOR_CUT_ARGS resolved, neighbours, decisions, cases, rows

/* Returns how a cell without finer nodes is cut: as the field decided, or else as if it had joined
 * nothing. Adds 1 to *tunnels if the cell has one. */
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
