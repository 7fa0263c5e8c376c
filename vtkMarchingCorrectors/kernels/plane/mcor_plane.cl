/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Marching squares, on the lowest layer of the lattice's cells: a square is the lower face of a
 * cell. The cell's upper nodes are on the same side of the iso value as the nodes below them in the
 * plane, so all code that finds cells and nodes works for squares, too.
 *
 * A square's side is halved if a finer square touches the side, so a square is a polygon of 4 to 8
 * nodes. Each crossed side, or crossed half of a side, has one vertex. The two squares that meet
 * there share the vertex. In each of the two squares, one line begins or ends at the vertex. */

/* Nodes and cells of a brick that are in the plane, bits x + 4 y. */
#define MCOR_PLANE_MASK 0xffffUL

/* One work-item = one brick. Copies the bits of nodes in the plane to higher layers of nodes: in
 * `above` to all, in `valid` only to the first, so that only one layer of cells can be used. */
__kernel void mcor_plane_spread(const int brick_count, __global ulong* above, __global ulong* valid)
{
  MCOR_ITEM(slot, slot < brick_count);
  above[slot] = (above[slot] & MCOR_PLANE_MASK) * 0x0001000100010001UL;
  valid[slot] = (valid[slot] & MCOR_PLANE_MASK) * 0x0000000000010001UL;
}

/* One work-item = one brick. Keeps the lowest layer of cells: their lower faces are squares. */
__kernel void mcor_plane_squares(const int count, __global ulong* cells)
{
  MCOR_ITEM(i, i < count);
  cells[i] &= MCOR_PLANE_MASK;
}

/* The nodes around a square, in the order that keeps the square on the left. Nodes are numbered as
 * in mcor_adaptive_cell.h. */
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

/* mcor_plane_falls returns whether side i goes from a node above the iso value to a node below.
 * mcor_plane_crosses returns whether one node of side i is above, and the other below. */
bool mcor_plane_falls(const mcor_plane_ring* ring, uint above, int i)
{
  return (above >> ring->node[i] & 1) && !(above >> ring->node[(i + 1) % ring->count] & 1);
}
bool mcor_plane_crosses(const mcor_plane_ring* ring, uint above, int i)
{
  return ((above >> ring->node[i] ^ above >> ring->node[(i + 1) % ring->count]) & 1) != 0;
}

/* Returns the number of the cell edge, or half edge, that is side i, see mcor_adaptive_slot. */
int mcor_plane_side(const mcor_plane_ring* ring, int i)
{
  return mcor_adaptive_slot(ring->node[i], ring->node[(i + 1) % ring->count]);
}

/* Marks the sides on which a square beside finer squares has vertices. A square marks two of the
 * four quadrants around a side. The square across the side marks the other two. Returns the number
 * of the square's lines. */
int mcor_plane_mark(
  const mcor_leaf* leaf, int cell, mcor_adaptive_nodes_of nodes, __global uint* quadrants)
{
  const mcor_plane_ring ring = mcor_plane_ring_of(nodes.split);
  int lines = 0;
  for (int s = 0; s < ring.count; ++s)
  {
    if (!mcor_plane_crosses(&ring, nodes.above, s))
    {
      continue;
    }
    lines += mcor_plane_falls(&ring, nodes.above, s);
    const int side = mcor_plane_side(&ring, s), axis = side >> 5, lower = side & 31;
    const mcor_leaf_edge edge = mcor_leaf_edge_of(leaf, cell, nodes.split, axis, lower);
    const int across = axis == 0 ? lower / 3 : lower % 3;
    /* Mask 5 has the two quadrants at higher coordinates than the side, mask 10 the other two. */
    mcor_leaf_mark_edge(&edge, across > 0 ? 10 : 5, quadrants);
  }
  return lines;
}

/* Returns the number of the vertex on the edge along an axis from node (x, y) of a brick. If x or y
 * is 4, the node is in the next brick. upper: slots of the brick's upper neighbours. */
int mcor_plane_vertex(__global const int* upper, __global const ulong* edges,
  __global const int* vertex_base, int slot, int x, int y, int axis)
{
  const int d = (x >> 2) | (y >> 2) << 1, n = (x & 3) | (y & 3) << 2;
  const int owner = d ? upper[d - 1] : slot;
  __global const ulong* e = edges + (long)owner * MCOR_EDGE_MASKS;
  return vertex_base[owner] + mcor_edge_rank(e, n) + (axis == 1 && (e[0] >> n & 1) ? 1 : 0);
}

/* Writes the lines of a square as triangles whose last two corners are the same. Returns the number
 * of lines. Nodes above the iso value are on the left of a line. The square is on the left of its
 * border. A line begins where the border goes from above to below. It ends at the border's previous
 * crossing, or, if the nodes above are joined, at the next crossing. leaf: the square's leaf; not
 * read for a plain square. upper: see mcor_plane_vertex. */
MCOR_ONE_COPY int mcor_plane_emit(const ulong* corners, bool is_plain, const mcor_leaf* leaf,
  int cell, bool joined, __global const int* upper, __global const ulong* edges,
  __global const int* vertex_base, int slot, __global int* to)
{
  mcor_adaptive_nodes_of nodes = { 0, 0, true };
  if (!is_plain)
  {
    nodes = mcor_leaf_cell(leaf, cell);
  }
  for (int c = 0; c < 4 && is_plain; ++c)
  {
    nodes.above |= (uint)(corners[c] >> cell & 1) << (2 * (c & 1) + 6 * (c >> 1));
  }
  const mcor_plane_ring ring = mcor_plane_ring_of(nodes.split);
  int made = 0;
  for (int s = 0; s < ring.count; ++s)
  {
    if (!mcor_plane_falls(&ring, nodes.above, s))
    {
      continue;
    }
    const int step = joined ? 1 : ring.count - 1;
    int end = (s + step) % ring.count;
    while (!mcor_plane_crosses(&ring, nodes.above, end))
    {
      end = (end + step) % ring.count;
    }
    for (int k = 0; k < 2; ++k)
    {
      const int side = mcor_plane_side(&ring, k ? end : s), axis = side >> 5, lower = side & 31;
      to[3 * made + k] = is_plain
        ? mcor_plane_vertex(upper, edges, vertex_base, slot, (cell & 3) + lower % 3 / 2,
            (cell >> 2) + lower / 6, axis)
        : mcor_leaf_vertex(leaf, cell, nodes.split, axis, lower, edges, vertex_base);
    }
    to[3 * made + 2] = to[3 * made + 1];
    ++made;
  }
  return made;
}
