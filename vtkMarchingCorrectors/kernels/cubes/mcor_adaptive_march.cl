/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: marching the cells of leaves. A cell beside a finer leaf has nodes in the middle of
 * edges, or of faces, too; mcor_adaptive_cell.h makes its triangles. Such nodes and the edges between them
 * are at whole numbers 0 to 8 of the finer cells from the leaf's first node, and are in the slots of
 * the level below; other edges in those of the leaf's level. */

/* What is known of a leaf's nodes. */
typedef struct
{
  __global const int* slots; /* of mcor_adaptive_tables */
  __global const ulong *above, *valid;
  uint hanging; /* where finer nodes are, by where they lie in the leaf: bits as of directions */
  int plane;    /* nodes above the plane are as those in it */
  ulong corners_above[8], corners_valid[8]; /* of cells, see mcor_cell_corners */
} mcor_leaf;

/* Slot and number of the node at u, by the leaf's level where that has a slot for it. */
int2 mcor_leaf_node(const mcor_leaf* leaf, int x, int y, int z)
{
  z = leaf->plane ? 0 : z;
  if (((x | y | z) & 1) == 0)
  {
    const int slot = leaf->slots[(x >> 3) | (y >> 3) << 1 | (z >> 3) << 2];
    if (slot >= 0)
    {
      return (int2)(slot, (x >> 1 & 3) + 4 * (y >> 1 & 3) + 16 * (z >> 1 & 3));
    }
  }
  const int slot = leaf->slots[8 + MCOR_DIRECTION(x >> 2, y >> 2, z >> 2)];
  return (int2)(slot, (x & 3) + 4 * (y & 3) + 16 * (z & 3));
}

/* Fills in where finer nodes are: an edge, or a face, has one in its middle where any leaf that touches
 * it there is finer. */
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

/* Masks of the leaf's own nodes and those of the 7 bricks up from it. A brick that the leaf's level has
 * no slot for is finer: its nodes on the leaf's side are looked up one by one. */
void mcor_leaf_masks(const mcor_leaf* leaf, __global const ulong* masks, ulong m[8])
{
  for (int d = 0; d < 8; ++d)
  {
    const int slot = leaf->slots[d];
    const bool above = leaf->plane && d > 3; /* which no cell needs */
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

/* Cells that may have finer nodes. */
ulong mcor_leaf_hanging_cells(uint hanging)
{
  ulong cells = 0;
  for (int at = 0; at < 27 && hanging; ++at)
  {
    const int x = at % 3, y = at / 3 % 3, z = at / 9;
    const ulong beside = (x == 1 ? ~0UL : MCOR_LOW_X << (x == 0 ? 0 : 3)) &
      (y == 1 ? ~0UL : MCOR_LOW_Y << (y == 0 ? 0 : 12)) &
      (z == 1 ? ~0UL : MCOR_LOW_Z << (z == 0 ? 0 : 48));
    cells |= hanging >> at & 1 ? beside : 0;
  }
  return cells;
}

/* Where a coordinate of 0 to 8 lies in the leaf: on its first side, within, on its last. */
int mcor_leaf_zone(int u)
{
  return u == 0 ? 0 : u == 8 ? 2 : 1;
}

/* A cell's nodes, bits x + 3 y + 9 z of mcor_adaptive_cell.h. */
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

/* An edge of a cell: where it is kept, and which quadrants around it the cell takes up, as bits, see
 * mcor_march_around. */
typedef struct
{
  int slot, node, axis;
  uint quadrants;
} mcor_leaf_edge;

/* The edge from middle-node `lower` of a cell along an axis. */
mcor_leaf_edge mcor_leaf_edge_of(const mcor_leaf* leaf, int cell, uint split, int axis, int lower)
{
  const int p[3] = { lower % 3, lower / 3 % 3, lower / 9 };
  const int u[3] = { 2 * (cell & 3) + p[0], 2 * (cell >> 2 & 3) + p[1], 2 * (cell >> 4) + p[2] };
  const int step = axis == 0 ? 1 : axis == 1 ? 3 : 9;
  mcor_leaf_edge edge;
  edge.axis = axis;
  if (p[axis] == 0 && !(split >> (lower + step) & 1))
  {
    edge.slot = leaf->slots[(u[0] >> 3) | (u[1] >> 3) << 1 | (u[2] >> 3) << 2];
    edge.node = (u[0] >> 1 & 3) + 4 * (u[1] >> 1 & 3) + 16 * (u[2] >> 1 & 3);
  }
  else
  {
    edge.slot = leaf->slots[8 + MCOR_DIRECTION(u[0] >> 2, u[1] >> 2, u[2] >> 2)];
    edge.node = (u[0] & 3) + 4 * (u[1] & 3) + 16 * (u[2] & 3);
  }
  const int b = axis == 0 ? p[1] : p[0], c = axis == 2 ? p[1] : p[2];
  const uint along_b = b == 0 ? 5 : b == 2 ? 10 : 15, along_c = c == 0 ? 3 : c == 2 ? 12 : 15;
  edge.quadrants = along_b & along_c;
  return edge;
}

/* The corners of a cell, bits as of mcor_march_case, among its nodes. */
uint mcor_leaf_corner_nodes(int corners)
{
  uint above = 0;
  for (int c = 0; c < 8; ++c)
  {
    above |= (uint)(corners >> c & 1) << (2 * (c & 1) + 6 * (c >> 1 & 1) + 18 * (c >> 2));
  }
  return above;
}

/* Notes that these cells, which have no finer nodes, use their crossed edges. */
void mcor_leaf_mark_plain(const mcor_leaf* leaf, ulong cells, __global uint* quadrants)
{
  for (int k = 0; k < 12; ++k)
  {
    /* In quadrant q around an edge are the cells whose lower corner of it is this one. */
    const int axis = k >> 2, q = k & 3, b = axis == 0 ? 2 : 1, c = axis == 2 ? 2 : 4;
    const int corner = (q & 1) * b | (q >> 1) * c;
    const ulong crossed =
      cells & (leaf->corners_above[corner] ^ leaf->corners_above[corner | 1 << axis]);
    for (int d = 0; d < 8 && crossed; ++d)
    {
      ulong part = (d & ~corner) == 0 ? crossed : 0; /* by lower node, in the brick up by d */
      for (int a = 0; a < 3; ++a)
      {
        part = !(corner >> a & 1) ? part
          : d >> a & 1            ? mcor_from_last(a, 0, part)
                                  : mcor_from_last(a, part, 0);
      }
      for (int w = 0; w < 2 && part; ++w)
      {
        const uint bits = (uint)(part >> 32 * w);
        if (bits)
        {
          atomic_or(quadrants + leaf->slots[d] * (long)MCOR_QUADRANT_WORDS + 2 * k + w, bits);
        }
      }
    }
  }
}

/* The same of a cell that has. */
void mcor_leaf_mark(
  const mcor_leaf* leaf, int cell, uint split, uint above, __global uint* quadrants)
{
  const uint corners = mcor_leaf_corner_nodes(0xff), nodes = split | corners;
  for (int lower = 0; lower < 26; ++lower)
  {
    const int p[3] = { lower % 3, lower / 3 % 3, lower / 9 };
    for (int axis = 0; axis < 3 && (nodes >> lower & 1); ++axis)
    {
      const int step = axis == 0 ? 1 : axis == 1 ? 3 : 9;
      if (p[axis] == 2)
      {
        continue;
      }
      const int middle = lower + step;
      const bool whole = !(nodes >> middle & 1);
      const int upper = whole ? middle + step : middle;
      if ((whole && !(corners >> lower & 1)) || !((above >> lower ^ above >> upper) & 1))
      {
        continue;
      }
      const mcor_leaf_edge edge = mcor_leaf_edge_of(leaf, cell, split, axis, lower);
      __global uint* words = quadrants + edge.slot * (long)MCOR_QUADRANT_WORDS + 8 * axis;
      for (uint rest = edge.quadrants; rest; rest &= rest - 1)
      {
        const int q = mcor_ctz(rest);
        atomic_or(words + 2 * q + (edge.node >> 5), 1u << (edge.node & 31));
      }
    }
  }
}

#define MCOR_LEAF_PARAMS                                                                           \
  const int count, const int plane, __global const uint *finer, __global const int *tables,        \
    __global const ulong *above, __global const ulong *valid, __global const uchar *case_table

/* Cells without finer nodes that are valid at all nodes and have nodes on both sides. */
ulong mcor_leaf_crossed(const mcor_leaf* leaf, ulong hanging)
{
  return mcor_cell_some(leaf->corners_above) & ~mcor_cell_all(leaf->corners_above) &
    mcor_cell_all(leaf->corners_valid) & ~hanging;
}

/* One work-item = one leaf. Reads its nodes' masks where it may be mixed. Writes whether it is: whether any of
 * its cells is valid at all nodes and has nodes on both sides. */
__kernel void mcor_adaptive_mixed(MCOR_LEAF_PARAMS, __global uchar* mixed)
{
  MCOR_ITEM(i, i < count && mixed[i]);
  const mcor_leaf leaf = mcor_leaf_load(i, plane, finer, tables, above, valid);
  const ulong hanging = mcor_leaf_hanging_cells(leaf.hanging);
  bool some = mcor_leaf_crossed(&leaf, hanging) != 0;
  for (ulong rest = hanging; rest && !some; rest &= rest - 1)
  {
    some = mcor_leaf_cell(&leaf, mcor_ctz(rest)).used;
  }
  mixed[i] = some;
}

/* One work-item = one leaf. Writes which of these cells are of mixed leaves. */
__kernel void mcor_adaptive_seeds(
  const int count, __global const uchar* mixed, __global const ulong* cells, __global ulong* seeds)
{
  MCOR_ITEM(i, i < count);
  seeds[i] = mixed[i] ? cells[i] : 0;
}

/* One work-item = one leaf. Reads its nodes' masks where it is mixed. Leaves the used ones of its cells in
 * `used`, and writes which edges they use; counts triangles, and of owned cells loops that lie in one
 * face between leaves. */
__kernel void mcor_adaptive_classify(MCOR_LEAF_PARAMS, __global const uchar* mixed,
  __global const ulong* owned, __global uint* quadrants, __global ulong* used,
  __global int* triangle_count, __global int* flat)
{
  MCOR_ITEM(i, i < count);
  if (!mixed[i])
  {
    used[i] = 0;
    triangle_count[i] = flat[i] = 0;
    return;
  }
  const mcor_leaf leaf = mcor_leaf_load(i, plane, finer, tables, above, valid);
  const ulong hanging = mcor_leaf_hanging_cells(leaf.hanging);
  ulong cells = (mcor_leaf_crossed(&leaf, hanging) | hanging) & used[i];
  const ulong within = owned[i]; /* which may be `used` */
  int triangles = 0, flat_loops = 0;
  for (ulong rest = cells & hanging; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    const mcor_adaptive_nodes_of nodes = mcor_leaf_cell(&leaf, cell);
    int caps = 0;
    if (!nodes.used)
    {
      cells &= ~(1UL << cell);
      continue;
    }
    triangles += mcor_adaptive_count(nodes.split, nodes.above, &caps);
    flat_loops += within >> cell & 1 ? caps : 0;
    mcor_leaf_mark(&leaf, cell, nodes.split, nodes.above, quadrants);
  }
  int tunnels = 0; /* which the field decides on later */
  triangles += mcor_cells_count(
    leaf.corners_above, case_table, 0, 0, 0, 0, 0, leaf.slots[0], cells & ~hanging, &tunnels);
  mcor_leaf_mark_plain(&leaf, cells & ~hanging, quadrants);
  used[i] = cells;
  triangle_count[i] = triangles;
  flat[i] = flat_loops;
}

/* One work-item = one slot. Reads which quadrants around its edges are used. Writes its edge masks, see
 * MCOR_EDGE_MASKS; counts vertices. */
__kernel void mcor_adaptive_edges(const int slot_count, __global const uint* quadrants,
  __global ulong* edges, __global int* vertex_count)
{
  MCOR_ITEM(slot, slot < slot_count);
  __global const uint* words = quadrants + slot * (long)MCOR_QUADRANT_WORDS;
  __global ulong* to = edges + (long)slot * MCOR_EDGE_MASKS;
  int vertices = 0;
  for (int a = 0; a < 3; ++a)
  {
    ulong q[4];
    for (int k = 0; k < 4; ++k)
    {
      q[k] = (ulong)words[8 * a + 2 * k + 1] << 32 | words[8 * a + 2 * k];
    }
    vertices += mcor_march_edges(~0UL, q, a, to);
  }
  vertex_count[slot] = vertices;
}

/* Vertex of a cell's edge, given as in mcor_adaptive_cell.h. */
int mcor_leaf_vertex(const mcor_leaf* leaf, int cell, uint split, int axis, int lower,
  __global const ulong* edges, __global const int* vertex_base)
{
  const mcor_leaf_edge edge = mcor_leaf_edge_of(leaf, cell, split, axis, lower);
  __global const ulong* e = edges + edge.slot * (long)MCOR_EDGE_MASKS;
  int number = vertex_base[edge.slot] + mcor_march_rank(e, edge.node);
  for (int a = 0; a < axis; ++a)
  {
    number += (int)((e[a] >> edge.node & 1) + (e[6 + a] >> edge.node & 1));
  }
  /* Of a pinched edge the second one is that of the cell below in the first other axis. */
  const bool below = (edge.quadrants & 5) == 0;
  return number + (int)(below && (e[6 + axis] >> edge.node & 1));
}

/* One work-item = one leaf. Reads used cells, masks and edge numbering. Writes triangles and, if
 * wanted, the keys of their cells. */
__kernel void mcor_adaptive_triangles(MCOR_LEAF_PARAMS, __global const int4* cells,
  MCOR_SIDES_PARAMS, MCOR_DECISION_PARAMS, const int follows, __global const mcor_rung* rungs,
  __global ulong* triangle_cells, __global const ulong* used, __global const ulong* edges,
  __global const int* vertex_base, __global const int* triangle_base, __global int* triangles)
{
  MCOR_ITEM(i, i < count && used[i] != 0);
  const mcor_leaf leaf = mcor_leaf_load(i, plane, finer, tables, above, valid);
  const ulong hanging = mcor_leaf_hanging_cells(leaf.hanging);
  const ulong key = mcor_adaptive_key(rungs, cells[i].w, cells[i].x, cells[i].y, cells[i].z);
  const ulong owned = mcor_cells_within(MCOR_SIDES_ARGS, cells[i]);
  int numbers[3][MCOR_CELL_NODES];
  if (used[i] & ~hanging)
  {
    mcor_march_numbers(leaf.slots + 1, edges, vertex_base, leaf.slots[0], numbers);
  }
  __global int* to = triangles + triangle_base[i] * 3L;
  for (ulong rest = used[i]; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    const long begin = (to - triangles) / 3;
    if (hanging >> cell & 1)
    {
      const mcor_adaptive_nodes_of nodes = mcor_leaf_cell(&leaf, cell);
      uchar slots[3 * MCOR_ADAPTIVE_TRIANGLES];
      const int made = mcor_adaptive_triangulate(nodes.split, nodes.above, slots);
      for (int k = 0; k < 3 * made; ++k)
      {
        *to++ = mcor_leaf_vertex(
          &leaf, cell, nodes.split, slots[k] >> 5, slots[k] & 31, edges, vertex_base);
      }
    }
    else
    {
      const mcor_cell_cut cut =
        mcor_cell_cut_of(leaf.corners_above, case_table, MCOR_DECISION_ARGS, leaf.slots[0], cell);
      to = mcor_march_emit(cut.edges, cut.triangles, numbers, cell, to);
    }
    const ulong ring = owned >> cell & 1 ? 0 : MCOR_RING_CELL;
    for (long t = begin; follows && t < (to - triangles) / 3; ++t)
    {
      triangle_cells[t] = key << 6 | (ulong)cell | ring;
    }
  }
}
