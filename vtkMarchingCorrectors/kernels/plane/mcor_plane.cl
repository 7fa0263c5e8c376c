/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Marching squares, on the lowest layer of the lattice's cells: a square is the lower face of one. Its
 * nodes above are as those in the plane, so that all that finds cells and nodes holds for squares. */

#if MCOR_OF_LATTICE
/* Nodes and cells of a brick that are in the plane, bits x + 4 y. */
#define MCOR_PLANE_MASK 0xffffUL

/* One work-item = one brick. Gives the signs of nodes in the plane to those above; of these, the next layer
 * alone is valid, which leaves one layer of cells. */
__kernel void mcor_plane_spread(const int brick_count, __global ulong* above, __global ulong* valid)
{
  const int slot = get_global_id(0);
  if (slot < brick_count)
  {
    above[slot] = (above[slot] & MCOR_PLANE_MASK) * 0x0001000100010001UL;
    valid[slot] = (valid[slot] & MCOR_PLANE_MASK) * 0x0000000000010001UL;
  }
}

/* One work-item = one leaf. Of its cells, leaves those that are squares. */
__kernel void mcor_plane_squares(const int count, __global ulong* cells)
{
  const int i = get_global_id(0);
  if (i < count)
  {
    cells[i] &= MCOR_PLANE_MASK;
  }
}

/* Corners of a square that are above: bits 0..3 (0, 0), (1, 0), (0, 1), (1, 1). m: of its cells. */
int mcor_plane_case(const ulong* corners, int cell)
{
  int above = 0;
  for (int c = 0; c < 4; ++c)
  {
    above |= (int)(corners[c] >> cell & 1) << c;
  }
  return above;
}

/* One work-item = one brick. Reads used squares and node masks. Writes the edge masks (see mcor_march_count)
 * for edges in the plane that have their lower node in the brick and a used square beside them; counts
 * vertices and lines. It takes what mcor_march_count takes. */
__kernel void mcor_plane_count(const int brick_count, MCOR_DECISION_PARAMS,
  __global const ulong* used, __global const ulong* above, __global const uchar* case_table,
  __global ulong* edges, __global int* vertex_count, __global int* line_count,
  __global int* tunnel_count)
{
  const int slot = get_global_id(0);
  if (slot >= brick_count)
  {
    return;
  }
  ulong m[8], lower[8];
  mcor_brick_masks(used, neighbours, slot, 7, lower);
  mcor_brick_masks(above, neighbours, slot, 0, m);
  const ulong changes[2] = { m[0] ^ mcor_from_next(0, m[0], m[1]),
    m[0] ^ mcor_from_next(1, m[0], m[2]) };
  const ulong beside[2] = { mcor_from_last(1, lower[0], lower[2]),
    mcor_from_last(0, lower[0], lower[1]) };
  __global ulong* to = edges + (long)slot * MCOR_EDGE_MASKS;
  int vertices = 0, lines = 0;
  for (int a = 0; a < MCOR_EDGE_MASKS; ++a)
  {
    to[a] = 0;
  }
  for (int a = 0; a < 2; ++a)
  {
    to[a] = changes[a] & (lower[0] | beside[a]) & MCOR_PLANE_MASK;
    to[3 + a] = to[a] & ~(lower[0] & beside[a]);
    vertices += (int)popcount(to[a]);
  }
  vertex_count[slot] = vertices;
  mcor_cell_corners(m);
  for (ulong rest = used[slot] & MCOR_PLANE_MASK; rest; rest &= rest - 1)
  {
    const int corners = mcor_plane_case(m, mcor_ctz(rest));
    lines += corners == 6 || corners == 9 ? 2 : 1;
  }
  line_count[slot] = lines;
}

/* Vertex of the edge along an axis from node (x, y) of a brick, or of one beyond it. upper: slots of its
 * upper neighbours. */
int mcor_plane_vertex(__global const int* upper, __global const ulong* edges,
  __global const int* vertex_base, int slot, int x, int y, int axis)
{
  const int d = (x >> 2) | (y >> 2) << 1, n = (x & 3) | (y & 3) << 2;
  const int owner = d ? upper[d - 1] : slot;
  __global const ulong* e = edges + (long)owner * MCOR_EDGE_MASKS;
  return vertex_base[owner] + mcor_march_rank(e, n) + (axis == 1 && (e[0] >> n & 1) ? 1 : 0);
}

/* One work-item = one brick. Reads used squares, node masks, decisions and edge numbering. Writes lines, with
 * what is above on their left, as triangles whose last corner is given twice; and, if wanted, the keys of their
 * cells. A line begins where the border of the square, run through with the square on the left, goes from above
 * to below. On an ambiguous square it ends at the crossing before that, or the one after it where what is
 * above is joined. It takes what mcor_march_triangles takes. */
__kernel void mcor_plane_lines(const int brick_count, MCOR_DECISION_PARAMS, MCOR_SIDES_PARAMS,
  const int follows, const int blocks_x, const int blocks_y, __global const int4* bricks,
  __global const ulong* used, __global const ulong* above, __global const ulong* edges,
  __global const uchar* case_table, __global const int* vertex_base, __global const int* line_base,
  __global ulong* line_cells, __global int* lines)
{
  const int slot = get_global_id(0);
  if (slot >= brick_count || used[slot] == 0)
  {
    return;
  }
  const int around[4] = { 0, 1, 3, 2 }; /* corners */
  ulong m[8];
  mcor_brick_masks(above, neighbours, slot, 0, m);
  mcor_cell_corners(m);
  const ulong owned = mcor_cells_within(MCOR_SIDES_ARGS, bricks[slot]);
  const ulong key = mcor_brick_place(blocks_x, blocks_y, bricks[slot]) << 6;
  const ulong joined = resolved ? decisions[slot * (long)MCOR_DECISION_MASKS + 2] : 0;
  long to = line_base[slot];
  for (ulong rest = used[slot] & MCOR_PLANE_MASK; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest), x = cell & 3, y = cell >> 2;
    const int corners = mcor_plane_case(m, cell);
    const bool back = (corners == 6 || corners == 9) && !(joined >> cell & 1);
    for (int s = 0; s < 4; ++s)
    {
      if (!(corners >> around[s] & 1) || (corners >> around[(s + 1) & 3] & 1))
      {
        continue;
      }
      int end = back ? (s + 3) & 3 : (s + 1) & 3; /* crossed sides are between unlike corners */
      while ((corners >> around[end] & 1) == (corners >> around[(end + 1) & 3] & 1))
      {
        end = back ? (end + 3) & 3 : (end + 1) & 3;
      }
      const int sides[2] = { s, end };
      int v[2];
      for (int i = 0; i < 2; ++i)
      {
        v[i] = mcor_plane_vertex(neighbours + slot * 14L, edges, vertex_base, slot,
          x + (sides[i] == 1), y + (sides[i] == 2), sides[i] & 1);
      }
      lines[3 * to] = v[0];
      lines[3 * to + 1] = lines[3 * to + 2] = v[1];
      if (follows)
      {
        line_cells[to] = key | (ulong)cell | (~owned >> cell & 1) * MCOR_RING_CELL;
      }
      ++to;
    }
  }
}
#endif
