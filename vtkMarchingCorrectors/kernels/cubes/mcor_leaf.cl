/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the cells that touch finer leaves. A leaf is a brick that is not split into finer
 * bricks. A cell that touches a finer leaf also has nodes in the middle of edges or faces;
 * mcor_adaptive_cell.h makes the cell's triangles. A node's coordinates, from 0 to 8, count cells
 * of the finer level from the leaf's first node. Finer nodes, and the edges between them, are in
 * slots of the finer level; other edges are in slots of the leaf's level. */

/* The nodes of a leaf. */
typedef struct
{
  __global const int* slots; /* made by mcor_leaf_tables */
  __global const ulong *above, *valid;
  uint hanging; /* parts of the leaf with finer nodes, bits MCOR_DIRECTION */
  int plane;    /* 1: cells are squares; mcor_leaf_node takes the node at z = 0 */
  ulong corners_above[8], corners_valid[8]; /* masks of cells, see mcor_cell_corners */
} mcor_leaf;

/* Returns the slot of node (x, y, z), and the node's number in the slot. finer: the slot is of the
 * finer level, else of the leaf's own level. */
int2 mcor_leaf_place(const mcor_leaf* leaf, int x, int y, int z, bool finer)
{
  return finer ? (int2)(leaf->slots[8 + MCOR_DIRECTION(x >> 2, y >> 2, z >> 2)],
                   (x & 3) + 4 * (y & 3) + 16 * (z & 3))
               : (int2)(leaf->slots[(x >> 3) | (y >> 3) << 1 | (z >> 3) << 2],
                   (x >> 1 & 3) + 4 * (y >> 1 & 3) + 16 * (z >> 1 & 3));
}

/* Returns the slot of node (x, y, z), and the node's number in it. If the leaf's own level has a
 * slot with this node, returns that slot, else the finer level's. */
int2 mcor_leaf_node(const mcor_leaf* leaf, int x, int y, int z)
{
  z = leaf->plane ? 0 : z;
  const int2 own = mcor_leaf_place(leaf, x, y, z, false);
  return ((x | y | z) & 1) == 0 && own.x >= 0 ? own : mcor_leaf_place(leaf, x, y, z, true);
}

/* A leaf has 27 parts: its inside, 6 faces, 12 edges and 8 corners. Returns the parts that a finer
 * leaf touches, as bits MCOR_DIRECTION. Edges or faces of cells in such a part have a node in their
 * middle. finer: the split bricks around the leaf, as bits MCOR_DIRECTION. */
uint mcor_leaf_hanging(uint finer)
{
  uint hanging = 0;
  for (int at = 0; at < 27 && finer; ++at)
  {
    const int x = at % 3, y = at / 3 % 3, z = at / 9;
    for (int d = 0; d < 27; ++d)
    {
      const int dx = d % 3, dy = d / 3 % 3, dz = d / 9;
      const bool touches = (dx == 1 || dx == x) && (dy == 1 || dy == y) && (dz == 1 || dz == z);
      hanging |= (touches && (finer >> d & 1)) ? 1u << at : 0;
    }
  }
  return hanging;
}

/* Makes masks of the corners of the leaf's cells, from the masks of the leaf and of its 7
 * neighbours at higher coordinates. A neighbour without a slot of the leaf's level is split into
 * finer bricks, so the nodes that it shares with the leaf are looked up one by one. */
void mcor_leaf_masks(const mcor_leaf* leaf, __global const ulong* masks, ulong m[8])
{
  for (int d = 0; d < 8; ++d)
  {
    const int slot = leaf->slots[d];
    const bool above = leaf->plane && d > 3; /* no square needs these nodes */
    m[d] = slot < 0 ? 0 : masks[slot];
    for (int n = 0; n < 64 && slot < 0 && !above; ++n)
    {
      const int x = n & 3, y = n >> 2 & 3, z = n >> 4;
      if ((d & 1 && x) || (d & 2 && y) || (d & 4 && z))
      {
        continue;
      }
      const int2 at =
        mcor_leaf_node(leaf, 2 * x + 8 * (d & 1), 2 * y + 8 * (d >> 1 & 1), 2 * z + 8 * (d >> 2));
      m[d] |= (masks[at.x] >> at.y & 1) << n;
    }
  }
  mcor_cell_corners(m);
}

mcor_leaf mcor_leaf_load(int i, int plane, __global const uint* finer, __global const int* tables,
  __global const ulong* above, __global const ulong* valid)
{
  mcor_leaf leaf;
  leaf.plane = plane;
  leaf.slots = tables + i * (long)MCOR_LEAF_SLOTS;
  leaf.above = above;
  leaf.valid = valid;
  leaf.hanging = mcor_leaf_hanging(finer[i]);
  mcor_leaf_masks(&leaf, above, leaf.corners_above);
  mcor_leaf_masks(&leaf, valid, leaf.corners_valid);
  return leaf;
}

/* Returns 0 if coordinate u (0 to 8) is on the leaf's first side, 1 within it, 2 on the last. */
int mcor_leaf_zone(int u)
{
  return u == 0 ? 0 : u == 8 ? 2 : 1;
}

/* Nodes of a cell as bits, numbered as in mcor_adaptive_cell.h. split: nodes in the middle of edges
 * and faces; above: nodes above the iso value; used: the cell is valid at all nodes, and has nodes
 * on both sides of the iso value. */
typedef struct
{
  uint split, above;
  bool used;
} mcor_adaptive_nodes_of;

mcor_adaptive_nodes_of mcor_leaf_cell(const mcor_leaf* leaf, int cell)
{
  mcor_adaptive_nodes_of nodes = { 0, 0, false };
  const int cx = 2 * (cell & 3), cy = 2 * (cell >> 2 & 3), cz = 2 * (cell >> 4);
  bool valid = true, below = false;
  for (int n = 0; n < 27; ++n)
  {
    const int px = n % 3, py = n / 3 % 3, pz = n / 9, x = cx + px, y = cy + py, z = cz + pz;
    const int middles = (px == 1) + (py == 1) + (pz == 1);
    const uint zone = MCOR_DIRECTION(mcor_leaf_zone(x), mcor_leaf_zone(y), mcor_leaf_zone(z));
    const bool hangs = (middles == 1 || middles == 2) && (leaf->hanging >> zone & 1);
    if (middles > 0 && !hangs)
    {
      continue;
    }
    const int2 at = mcor_leaf_node(leaf, x, y, z);
    const bool above = leaf->above[at.x] >> at.y & 1;
    nodes.split |= hangs ? 1u << n : 0;
    nodes.above |= above ? 1u << n : 0;
    below |= !above;
    valid = valid && (leaf->valid[at.x] >> at.y & 1);
  }
  nodes.used = valid && below && nodes.above;
  return nodes;
}

/* An edge of a cell. slot, node: the slot of the edge's lower node, and the node's number in the
 * slot. quadrants: which of the four quarters around the edge the cell fills, as bits q of
 * mcor_cell_around. */
typedef struct
{
  int slot, node, axis;
  uint quadrants;
} mcor_leaf_edge;

/* Returns a cell's edge, or half of a split edge, along an axis from node `lower`. Nodes are
 * numbered as in mcor_adaptive_cell.h. */
mcor_leaf_edge mcor_leaf_edge_of(const mcor_leaf* leaf, int cell, uint split, int axis, int lower)
{
  const int p[3] = { lower % 3, lower / 3 % 3, lower / 9 };
  const int u[3] = { 2 * (cell & 3) + p[0], 2 * (cell >> 2 & 3) + p[1], 2 * (cell >> 4) + p[2] };
  const bool is_half = p[axis] > 0 || (split >> (lower + mcor_adaptive_step(axis)) & 1);
  const int2 at = mcor_leaf_place(leaf, u[0], u[1], u[2], is_half);
  mcor_leaf_edge edge = { at.x, at.y, axis, 0 };
  const int b = axis == 0 ? p[1] : p[0], c = axis == 2 ? p[1] : p[2];
  const uint along_b = b == 0 ? 5 : b == 2 ? 10 : 15, along_c = c == 0 ? 3 : c == 2 ? 12 : 15;
  edge.quadrants = along_b & along_c;
  return edge;
}

/* Marks an edge as an edge of used cells. around: the quadrants of the edge in which these cells
 * are, as bits q of mcor_cell_around. */
void mcor_leaf_mark_edge(const mcor_leaf_edge* edge, uint around, __global uint* quadrants)
{
  __global uint* words = quadrants + edge->slot * (long)MCOR_QUADRANT_WORDS + 8 * edge->axis;
  for (; around; around &= around - 1)
  {
    atomic_or(words + 2 * mcor_ctz(around) + (edge->node >> 5), 1u << (edge->node & 31));
  }
}

/* Marks the edges on which a cell beside finer leaves has vertices. */
void mcor_leaf_mark(
  const mcor_leaf* leaf, int cell, uint split, uint above, __global uint* quadrants)
{
  mcor_adaptive_links links;
  mcor_adaptive_link(split, above, &links);
  for (int slot = 0; slot < MCOR_ADAPTIVE_SLOTS; ++slot)
  {
    if (links.next[slot] != 0xff)
    {
      const mcor_leaf_edge edge = mcor_leaf_edge_of(leaf, cell, split, slot >> 5, slot & 31);
      mcor_leaf_mark_edge(&edge, edge.quadrants, quadrants);
    }
  }
}

/* Parameters for leaves and the nodes of all bricks. plane: 1 if cells are squares in a plane. */
#define MCOR_LEAF_PARAMS                                                                           \
  const int count, const int plane, __global const uint *finer, __global const int *tables,        \
    __global const ulong *above, __global const ulong *valid

/* One work-item = one leaf. Writes to the leaf's slot which cells are plain (no finer brick touches
 * them), and the leaf's number. If the leaf is mixed (see mcor_leaf_need), also reads the masks of
 * its nodes and writes `cells`: all cells of the leaf if any of them is valid at all nodes and has
 * nodes on both sides of the iso value, else none. */
__kernel void mcor_leaf_cells(MCOR_LEAF_PARAMS, __global const uchar* mixed, __global ulong* cells,
  __global ulong* plain, __global int* leaf_of)
{
  MCOR_ITEM(i, i < count);
  const int slot = tables[i * (long)MCOR_LEAF_SLOTS];
  const uint nodes = mcor_leaf_hanging(finer[i]);
  ulong hanging = 0; /* cells that may have finer nodes */
  for (int at = 0; at < 27 && nodes; ++at)
  {
    hanging |= nodes >> at & 1 ? mcor_on_sides(at % 3, at / 3 % 3, at / 9) : 0;
  }
  plain[slot] = ~hanging;
  leaf_of[slot] = i;
  if (!mixed[i])
  {
    return;
  }
  const mcor_leaf leaf = mcor_leaf_load(i, plane, finer, tables, above, valid);
  bool some = (mcor_cells_crossed(leaf.corners_above, leaf.corners_valid) & ~hanging) != 0;
  for (ulong rest = hanging; rest && !some; rest &= rest - 1)
  {
    some = mcor_leaf_cell(&leaf, mcor_ctz(rest)).used;
  }
  cells[slot] = some ? ~0UL : 0;
}

/* Returns the number of the vertex on a cell's edge, or on half of a split edge. axis, lower: as in
 * mcor_leaf_edge_of. */
int mcor_leaf_vertex(const mcor_leaf* leaf, int cell, uint split, int axis, int lower,
  __global const ulong* edges, __global const int* vertex_base)
{
  const mcor_leaf_edge edge = mcor_leaf_edge_of(leaf, cell, split, axis, lower);
  __global const ulong* e = edges + edge.slot * (long)MCOR_EDGE_MASKS;
  int number = vertex_base[edge.slot] + mcor_edge_rank(e, edge.node);
  for (int a = 0; a < axis; ++a)
  {
    number += (int)((e[a] >> edge.node & 1) + (e[6 + a] >> edge.node & 1));
  }
  /* A pinched edge has two vertices, one for each used cell. The second vertex is for the cell that
   * is lower along the first of the two axes across the edge, see mcor_cell.cl. */
  const bool below = (edge.quadrants & 5) == 0;
  return number + (int)(below && (e[6 + axis] >> edge.node & 1));
}

/* Writes the triangles of a cell that touches finer leaves. Returns their number. */
int mcor_leaf_emit(const mcor_leaf* leaf, int cell, __global const ulong* edges,
  __global const int* vertex_base, __global int* to)
{
  const mcor_adaptive_nodes_of nodes = mcor_leaf_cell(leaf, cell);
  uchar slots[3 * MCOR_ADAPTIVE_TRIANGLES];
  int flat = 0;
  const int made = mcor_adaptive_triangulate(nodes.split, nodes.above, slots, &flat);
  for (int k = 0; k < 3 * made; ++k)
  {
    to[k] =
      mcor_leaf_vertex(leaf, cell, nodes.split, slots[k] >> 5, slots[k] & 31, edges, vertex_base);
  }
  return made;
}
