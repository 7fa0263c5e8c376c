/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Extraction [III-D.1]: node values, marching cubes on masks of 64 nodes or cells, vertices
 * numbered by lattice edge. */

#if MCOR_OF_LATTICE
/* One work-item = one brick. Reads the cells to examine. Writes its nodes if they need any and none
 * is known yet: where a surface grows it mostly needs the others next, and the particles are
 * gathered once. Writes which cells are new since the last time, too; they are then kept in
 * `examined`. */
__kernel void mcor_march_need(const int brick_count, __global const int* neighbours,
  __global const ulong* cells, __global const ulong* known, __global ulong* need,
  __global ulong* examined, __global ulong* fresh)
{
  MCOR_ITEM(slot, slot < brick_count);
  bool some = false;
  if (!known[slot])
  {
    ulong m[8];
    mcor_brick_masks(cells, neighbours, slot, 7, m);
    for (int d = 0; d < 8; ++d)
    {
      some |= mcor_cells_reach(m[d], d);
    }
  }
  need[slot] = some ? ~0UL : 0;
  fresh[slot] = cells[slot] & ~examined[slot];
  examined[slot] = cells[slot];
}
#endif

#if MCOR_OF_FIELD
/* One work-item = MCOR_ITEM_NODES nodes of a brick. Where they are needed, reads the particles that
 * reach them. Writes their values and weights. */
__kernel void mcor_march_nodes(MCOR_GRID_PARAMS, const int brick_count, __global const int4* bricks,
  __global const ulong* need, __global real* node_value, __global real* node_weight)
{
  const long first_node = (long)get_global_id(0) * MCOR_ITEM_NODES;
  const int slot = (int)(first_node / 64);
  if (slot >= brick_count || need[slot] == 0)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  mcor_query query = mcor_node_query(&grid, bricks[slot], (int)(first_node % 64), 1);
  mcor_node_sums sums;
  mcor_tile tile;
  mcor_tile_init(&tile);
  mcor_node_sum(&grid, &query, &tile, &sums);
  mcor_node_store(&sums, node_value + first_node, node_weight + first_node);
}

/* One work-item = one brick. Reads the values of its nodes where these are `evaluated`: they are
 * known from now on. Writes which are above the iso value, and which are valid. */
__kernel void mcor_march_sign(const int brick_count, __global const ulong* evaluated,
  __global ulong* known, __global const real* node_value, __global const real* node_weight,
  const real iso, const real node_threshold, __global ulong* above, __global ulong* valid)
{
  MCOR_ITEM(slot, slot < brick_count && evaluated[slot]);
  known[slot] |= evaluated[slot];
  const ulong2 signs =
    mcor_node_signs(node_value + slot * 64L, node_weight + slot * 64L, iso, node_threshold);
  above[slot] = signs.x;
  valid[slot] = signs.y;
}
#endif

/* From node masks of a brick and its upper neighbours: mask c becomes that of each cell's corner c
 * (bits x, y, z). */
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

/* Cells of which some corner is set, and those of which all are. */
ulong mcor_cell_some(const ulong* corners)
{
  ulong some = 0;
  for (int c = 0; c < 8; ++c)
  {
    some |= corners[c];
  }
  return some;
}

ulong mcor_cell_all(const ulong* corners)
{
  ulong all = ~0UL;
  for (int c = 0; c < 8; ++c)
  {
    all &= corners[c];
  }
  return all;
}

/* Cells whose lower (side 0) or upper face across an axis is crossed, i.e. has nodes on both sides.
 * */
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

/* A brick's cells that are beside these through crossed faces. */
ulong mcor_cells_beside(ulong used, const ulong* lower, const ulong* upper)
{
  ulong cells = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    cells |= mcor_from_next(axis, used & lower[axis], 0);
    cells |= mcor_from_last(axis, used & upper[axis], 0);
  }
  return cells;
}

/* Cells that are valid at all nodes and have nodes on both sides. above: of their corners. */
ulong mcor_cell_crossed(
  const ulong* above, __global const int* neighbours, __global const ulong* valid, int slot)
{
  ulong m[8];
  mcor_brick_masks(valid, neighbours, slot, 0, m);
  mcor_cell_corners(m);
  return mcor_cell_some(above) & ~mcor_cell_all(above) & mcor_cell_all(m);
}

#if MCOR_OF_LATTICE
/* One work-item = one brick. Reads the node masks. Writes the used cells: examined, valid at all
 * nodes, with nodes on both sides. */
__kernel void mcor_march_classify(const int brick_count, __global const int* neighbours,
  __global const ulong* cells, __global const ulong* above, __global const ulong* valid,
  __global ulong* used)
{
  MCOR_ITEM(slot, slot < brick_count);
  ulong m[8];
  mcor_brick_masks(above, neighbours, slot, 0, m);
  mcor_cell_corners(m);
  used[slot] = cells[slot] & mcor_cell_crossed(m, neighbours, valid, slot);
}
#endif

/* Per edge along an axis of a brick, the cells around it: q[0] above in both other axes, q[1] below
 * in the first, q[2] below in the second, q[3] below in both. m: masks of a brick and its lower
 * neighbours. */
MCOR_ONE_COPY void mcor_march_around(const ulong* m, int axis, ulong* q)
{
  const int b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
  q[0] = m[0];
  q[1] = mcor_from_last(b, m[0], m[1 << b]);
  q[2] = mcor_from_last(c, m[0], m[1 << c]);
  q[3] = mcor_from_last(c, q[1], mcor_from_last(b, m[1 << c], m[1 << b | 1 << c]));
}

/* MCOR_EDGE_MASKS, three an axis: crossed edges; of these, those next to a cell that is not used; of
 * these, pinched ones: only two cells are used, opposite to each other. Their triangles form two
 * fans, so that such an edge has two vertices, the second one for the cell below in the first other
 * axis. */

#if MCOR_OF_LATTICE
/* Writes those of a brick's edges along an axis, of which these change sides and have used cells around them;
 * returns their number of vertices. */
int mcor_march_edges(ulong changes, const ulong* q, int axis, __global ulong* to)
{
  const ulong crossed = changes & (q[0] | q[1] | q[2] | q[3]);
  const ulong pinched = crossed & ((q[0] & q[3] & ~q[1] & ~q[2]) | (q[1] & q[2] & ~q[0] & ~q[3]));
  to[axis] = crossed;
  to[3 + axis] = crossed & ~(q[0] & q[1] & q[2] & q[3]);
  to[6 + axis] = pinched;
  return (int)(popcount(crossed) + popcount(pinched));
}

/* One work-item = one brick. Reads used cells, node masks and decisions. Writes the edge masks for edges
 * that have their lower node in the brick and a used cell around them; counts vertices, triangles and
 * tunnels. */
__kernel void mcor_march_count(const int brick_count, MCOR_DECISION_PARAMS,
  __global const ulong* used, __global const ulong* above, __global const uchar* case_table,
  __global ulong* edges, __global int* vertex_count, __global int* triangle_count,
  __global int* tunnel_count)
{
  MCOR_ITEM(slot, slot < brick_count);
  ulong m[8], lower[8];
  mcor_brick_masks(used, neighbours, slot, 7, lower);
  mcor_brick_masks(above, neighbours, slot, 0, m);
  __global ulong* to = edges + (long)slot * MCOR_EDGE_MASKS;
  int vertices = 0;
  for (int a = 0; a < 3; ++a)
  {
    ulong q[4];
    mcor_march_around(lower, a, q);
    vertices += mcor_march_edges(m[0] ^ mcor_from_next(a, m[0], m[1 << a]), q, a, to);
  }
  vertex_count[slot] = vertices;
  int tunnels = 0;
  mcor_cell_corners(m);
  triangle_count[slot] =
    mcor_cells_count(m, case_table, MCOR_DECISION_ARGS, slot, used[slot], &tunnels);
  if (resolved)
  {
    tunnel_count[slot] = tunnels;
  }
}

/* Value at the upper end of the edge from node n of a brick along an axis; beyond it, of the brick there, or of the
 * finer one that has the node. Bricks of several levels are found by their keys. */
real mcor_march_end(const int levels, __global const int* neighbours, MCOR_SLOT_PARAMS,
  __global const mcor_rung* rungs, int4 brick, int slot, int n, int axis,
  __global const real* node_value)
{
  const int step = 1 << (2 * axis);
  if ((n >> (2 * axis) & 3) != 3)
  {
    return node_value[slot * 64L + n + step];
  }
  if (!levels)
  {
    return node_value[neighbours[slot * 14L + (1 << axis) - 1] * 64L + n - 3 * step];
  }
  int4 at = brick * MCOR_BRICK +
    (int4)((n & 3) + (axis == 0), (n >> 2 & 3) + (axis == 1), (n >> 4) + (axis == 2), 0);
  int other = mcor_adaptive_find(
    MCOR_SLOT_ARGS, mcor_adaptive_key(rungs, brick.w, at.x >> 2, at.y >> 2, at.z >> 2));
  if (other < 0)
  {
    at *= 2;
    other = mcor_adaptive_find(
      MCOR_SLOT_ARGS, mcor_adaptive_key(rungs, brick.w - 1, at.x >> 2, at.y >> 2, at.z >> 2));
  }
  return node_value[other * 64L + (at.x & 3) + 4 * (at.y & 3) + 16 * (at.z & 3)];
}

/* One work-item = one brick. Reads its crossed edges and node values. Writes its vertices: lattice
 * edge of its level (lower node; axis, plus 4 where a cell around it is not used, plus 256 times the level),
 * and the two values against the iso value. */
__kernel void mcor_march_vertices(MCOR_SLOT_PARAMS, const int levels,
  __global const int* neighbours, __global const mcor_rung* rungs, __global const int4* bricks,
  __global const ulong* edges, __global const real* node_value, __global const int* vertex_base,
  const real iso, __global int4* vertex_edge, __global real* vertex_ends)
{
  MCOR_ITEM(slot, slot < slot_count);
  const int4 brick = bricks[slot];
  __global const ulong* e = edges + (long)slot * MCOR_EDGE_MASKS;
  int to = vertex_base[slot];
  for (ulong rest = e[0] | e[1] | e[2]; rest; rest &= rest - 1)
  {
    const int n = mcor_ctz(rest);
    for (int axis = 0; axis < 3; ++axis)
    {
      if (e[axis] >> n & 1)
      {
        const int copies = 1 + (int)(e[6 + axis] >> n & 1);
        const int4 edge = (int4)(brick.x * MCOR_BRICK + (n & 3),
          brick.y * MCOR_BRICK + (n >> 2 & 3), brick.z * MCOR_BRICK + (n >> 4),
          axis | (int)(e[3 + axis] >> n & 1) << 2 | brick.w << MCOR_LEVEL_SHIFT);
        const real end = mcor_march_end(
          levels, neighbours, MCOR_SLOT_ARGS, rungs, brick, slot, n, axis, node_value);
        for (int copy = 0; copy < copies; ++copy, ++to)
        {
          vertex_edge[to] = edge;
          vertex_ends[2L * to] = node_value[slot * 64L + n] - iso;
          vertex_ends[2L * to + 1] = end - iso;
        }
      }
    }
  }
}
#endif

/* Nodes of a brick's cells. */
#define MCOR_CELL_NODES 125

/* Number of the first vertex of node n's edges among the vertices of its brick. */
int mcor_march_rank(__global const ulong* e, int n)
{
  const ulong below = (1UL << n) - 1;
  int rank = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    rank += (int)(popcount(e[axis] & below) + popcount(e[6 + axis] & below));
  }
  return rank;
}

/* Vertices of all edges of a brick's cells, by axis and lower node x + 5 y + 25 z; of a pinched
 * edge, -1 less the first of the two. upper: slots of its upper neighbours, or -1. */
void mcor_march_numbers(__global const int* upper, __global const ulong* edges,
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
    const ulong border =
      (d & 1 ? MCOR_LOW_X : ~0UL) & (d & 2 ? MCOR_LOW_Y : ~0UL) & (d & 4 ? MCOR_LOW_Z : ~0UL);
    for (ulong rest = (e[0] | e[1] | e[2]) & border; rest; rest &= rest - 1)
    {
      const int n = mcor_ctz(rest);
      const int at = (n & 3) + 5 * (n >> 2 & 3) + 25 * (n >> 4) + 4 * (d & 1) + 20 * (d >> 1 & 1) +
        100 * (d >> 2);
      int number = vertex_base[owner] + mcor_march_rank(e, n);
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

/* Writes the triangles of a cell, given by a row of the case table; returns where the next ones
 * go. */
__global int* mcor_march_emit(__global const uchar* row, int count,
  const int numbers[3][MCOR_CELL_NODES], int cell, __global int* to)
{
  const int first = (cell & 3) + 5 * (cell >> 2 & 3) + 25 * (cell >> 4);
  for (int i = 0; i < 3 * count; ++i)
  {
    /* An edge is its axis and its lower corner within the cell, bits x, y, z. */
    const int axis = row[i] >> 3, x = row[i] & 1, y = row[i] >> 1 & 1, z = row[i] >> 2 & 1;
    const int number = numbers[axis][first + x + 5 * y + 25 * z];
    /* The second fan is the one of cells below in the first other axis. */
    *to++ = number >= 0 ? number : -1 - number + (axis == 0 ? y : x);
  }
  return to;
}

#if MCOR_OF_LATTICE
/* One work-item = one brick. Reads used cells, node masks, decisions and edge numbering. Writes triangles and, if
 * wanted, the keys of their cells. */
__kernel void mcor_march_triangles(const int brick_count, MCOR_DECISION_PARAMS, MCOR_SIDES_PARAMS,
  const int follows, const int blocks_x, const int blocks_y, __global const int4* bricks,
  __global const ulong* used, __global const ulong* above, __global const ulong* edges,
  __global const uchar* case_table, __global const int* vertex_base,
  __global const int* triangle_base, __global ulong* triangle_cells, __global int* triangles)
{
  MCOR_ITEM(slot, slot < brick_count && used[slot] != 0);
  ulong m[8];
  int numbers[3][MCOR_CELL_NODES];
  mcor_brick_masks(above, neighbours, slot, 0, m);
  mcor_cell_corners(m);
  mcor_march_numbers(neighbours + slot * 14L, edges, vertex_base, slot, numbers);
  const ulong owned = mcor_cells_within(MCOR_SIDES_ARGS, bricks[slot]);
  const ulong key = mcor_brick_place(blocks_x, blocks_y, bricks[slot]) << 6;
  long to = triangle_base[slot];
  for (ulong rest = used[slot]; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    const mcor_cell_cut cut = mcor_cell_cut_of(m, case_table, MCOR_DECISION_ARGS, slot, cell);
    mcor_march_emit(cut.edges, cut.triangles, numbers, cell, triangles + 3 * to);
    for (int i = 0; i < cut.triangles && follows;
         ++i) /* Intel's compiler (2026.2) crashes on another form */
    {
      triangle_cells[to + i] = key | (ulong)cell | (~owned >> cell & 1) * MCOR_RING_CELL;
    }
    to += cut.triangles;
  }
}

/* One work-item = one mask. Writes its number of bits. */
__kernel void mcor_march_bits(
  const int count, __global const ulong* masks, __global const ulong* within, __global int* bits)
{
  MCOR_ITEM(i, i < count);
  bits[i] = (int)popcount(masks[i] & within[i]);
}
#endif
