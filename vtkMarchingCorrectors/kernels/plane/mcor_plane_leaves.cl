/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Marching squares of several sizes: the lowest layer of the leaves' cells, as in mcor_plane.cl. A square's
 * sides are halved where a finer one touches them, so that it is a polygon of 4 to 8 nodes. Each crossed piece
 * of a side has one vertex, which the squares on both sides of it share; one line in the square begins, or
 * ends, there. */

/* The nodes around a square, run through with it on the left: bits of mcor_adaptive_cell.h. */
typedef struct
{
  int node[8], count;
} mcor_plane_ring;

mcor_plane_ring mcor_plane_ring_of(uint split)
{
  const int around[8] = { 0, 1, 2, 5, 8, 7, 6, 3 };
  mcor_plane_ring ring;
  ring.count = 0;
  for (int i = 0; i < 8; ++i)
  {
    if (!(i & 1) || (split >> around[i] & 1))
    {
      ring.node[ring.count++] = around[i];
    }
  }
  return ring;
}

/* Whether side i goes from above to below, and whether its ends are unlike. */
bool mcor_plane_falls(const mcor_plane_ring* ring, uint above, int i)
{
  return (above >> ring->node[i] & 1) && !(above >> ring->node[(i + 1) % ring->count] & 1);
}
bool mcor_plane_crosses(const mcor_plane_ring* ring, uint above, int i)
{
  return ((above >> ring->node[i] ^ above >> ring->node[(i + 1) % ring->count]) & 1) != 0;
}

/* Nodes of a square, above those of its finer ones too. */
mcor_adaptive_nodes_of mcor_plane_leaf_square(const mcor_leaf* leaf, ulong hanging, int cell)
{
  if (hanging >> cell & 1)
  {
    return mcor_leaf_cell(leaf, cell);
  }
  mcor_adaptive_nodes_of nodes = { 0, 0, true };
  for (int c = 0; c < 4; ++c)
  {
    nodes.above |= (uint)(leaf->corners_above[c] >> cell & 1) << (2 * (c & 1) + 6 * (c >> 1));
  }
  return nodes;
}

/* Axis and lower node of side i, as a slot of mcor_adaptive_cell.h. */
int mcor_plane_side(const mcor_plane_ring* ring, int i)
{
  return mcor_adaptive_slot(ring->node[i], ring->node[(i + 1) % ring->count]);
}

/* One work-item = one leaf. Reads its nodes' masks where it is mixed. Leaves the used ones of its squares in
 * `used`, and writes which sides they use, all around in space where squares are on both sides; counts lines. */
__kernel void mcor_adaptive_plane_count(MCOR_LEAF_PARAMS, __global const uchar* mixed,
  __global uint* quadrants, __global ulong* used, __global int* line_count, __global int* flat)
{
  const int i = get_global_id(0);
  if (i >= count)
  {
    return;
  }
  flat[i] = line_count[i] = 0;
  if (!mixed[i])
  {
    used[i] = 0;
    return;
  }
  const mcor_leaf leaf = mcor_leaf_load(i, plane, finer, tables, above, valid);
  const ulong hanging = mcor_leaf_hanging_cells(leaf.hanging);
  ulong cells = (mcor_leaf_crossed(&leaf, hanging) | hanging) & used[i];
  int lines = 0;
  for (ulong rest = cells; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    const mcor_adaptive_nodes_of nodes = mcor_plane_leaf_square(&leaf, hanging, cell);
    const mcor_plane_ring ring = mcor_plane_ring_of(nodes.split);
    cells &= nodes.used ? ~0UL : ~(1UL << cell);
    for (int s = 0; s < ring.count && nodes.used; ++s)
    {
      if (!mcor_plane_crosses(&ring, nodes.above, s))
      {
        continue;
      }
      lines += mcor_plane_falls(&ring, nodes.above, s);
      const int side = mcor_plane_side(&ring, s), axis = side >> 5, lower = side & 31;
      const mcor_leaf_edge edge = mcor_leaf_edge_of(&leaf, cell, nodes.split, axis, lower);
      __global uint* words = quadrants + edge.slot * (long)MCOR_QUADRANT_WORDS + 8 * axis;
      const int across = axis == 0 ? lower / 3 : lower % 3;
      for (int q = across > 0; q < 4; q += 2) /* on the side where the square is */
      {
        atomic_or(words + 2 * q + (edge.node >> 5), 1u << (edge.node & 31));
      }
    }
  }
  used[i] = cells;
  line_count[i] = lines;
}

/* One work-item = one leaf. Reads used squares, masks, decisions and edge numbering. Writes lines, as triangles
 * whose last corner is given twice, and, if wanted, the keys of their cells; see mcor_plane_lines. */
__kernel void mcor_adaptive_plane_lines(MCOR_LEAF_PARAMS, __global const int4* cells,
  MCOR_SIDES_PARAMS, MCOR_DECISION_PARAMS, const int follows, __global const mcor_rung* rungs,
  __global ulong* line_cells, __global const ulong* used, __global const ulong* edges,
  __global const int* vertex_base, __global const int* line_base, __global int* lines)
{
  const int i = get_global_id(0);
  if (i >= count || used[i] == 0)
  {
    return;
  }
  const mcor_leaf leaf = mcor_leaf_load(i, plane, finer, tables, above, valid);
  const ulong hanging = mcor_leaf_hanging_cells(leaf.hanging);
  const ulong key = mcor_adaptive_key(rungs, cells[i].w, cells[i].x, cells[i].y, cells[i].z) << 6;
  const ulong owned = mcor_cells_within(MCOR_SIDES_ARGS, cells[i]);
  const ulong joined =
    resolved ? decisions[leaf.slots[0] * (long)MCOR_DECISION_MASKS + 2] & ~hanging : 0;
  long to = line_base[i];
  for (ulong rest = used[i]; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    const mcor_adaptive_nodes_of nodes = mcor_plane_leaf_square(&leaf, hanging, cell);
    const mcor_plane_ring ring = mcor_plane_ring_of(nodes.split);
    for (int s = 0; s < ring.count; ++s)
    {
      if (!mcor_plane_falls(&ring, nodes.above, s))
      {
        continue;
      }
      const int step = joined >> cell & 1 ? 1 : ring.count - 1;
      int end = (s + step) % ring.count;
      while (!mcor_plane_crosses(&ring, nodes.above, end))
      {
        end = (end + step) % ring.count;
      }
      for (int k = 0; k < 2; ++k)
      {
        const int side = mcor_plane_side(&ring, k ? end : s);
        lines[3 * to + k] =
          mcor_leaf_vertex(&leaf, cell, nodes.split, side >> 5, side & 31, edges, vertex_base);
      }
      lines[3 * to + 2] = lines[3 * to + 1];
      if (follows)
      {
        line_cells[to] = key | (ulong)cell | (~owned >> cell & 1) * MCOR_RING_CELL;
      }
      ++to;
    }
  }
}
