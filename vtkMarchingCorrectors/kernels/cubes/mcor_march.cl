/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Extraction [III-D.1]: marching cubes on masks of 64 nodes or cells. Vertices are numbered by
 * lattice edge.
 *
 * A cell is used if it is valid at all nodes and has nodes on both sides of the iso value. A cell
 * is plain if no finer brick touches it, not even at a corner: all its nodes are in bricks of its
 * level. With several levels, mcor_march_hanging finds which cells that are not plain are used, and
 * marks their edges. */

/* One work-item = one leaf. Reads the masks of the leaf's nodes. Treats only cells that a finer
 * brick touches (not plain). Removes such a cell from `used` if it is not valid at all nodes, or if
 * all its nodes are on one side of the iso value. Marks the edges of the cells that stay. Writes to
 * the leaf's slot how many triangles (in a plane, lines) these cells have. Adds to flat_loops how
 * many polygons of the surface, in owned cells, lie in a single face of their cell. */
__kernel void mcor_march_hanging(MCOR_LEAF_PARAMS, __global const ulong* plain,
  __global const ulong* owned, __global uint* quadrants, __global ulong* used,
  __global int* triangle_count, __global int* flat_loops)
{
  MCOR_ITEM(i, i < count);
  const int slot = tables[i * (long)MCOR_LEAF_SLOTS];
  const ulong hanging = used[slot] & ~plain[slot], within = owned[slot];
  if (hanging == 0)
  {
    return;
  }
  const mcor_leaf leaf = mcor_leaf_load(i, plane, finer, tables, above, valid);
  int made = 0, flat = 0;
  ulong unused = 0;
  for (ulong rest = hanging; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    const mcor_adaptive_nodes_of nodes = mcor_leaf_cell(&leaf, cell);
    int caps = 0;
    if (!nodes.used)
    {
      unused |= 1UL << cell;
    }
    else if (plane)
    {
      made += mcor_plane_mark(&leaf, cell, nodes, quadrants);
    }
    else
    {
      made += mcor_adaptive_triangulate(nodes.split, nodes.above, 0, &caps);
      mcor_leaf_mark(&leaf, cell, nodes.split, nodes.above, quadrants);
    }
    flat += within >> cell & 1 ? caps : 0;
  }
  used[slot] &= ~unused;
  triangle_count[slot] = made;
  for (; flat > 0; --flat)
  {
    atomic_inc(flat_loops);
  }
}

/* One work-item = one brick. Reads the node masks. Keeps a plain cell (no finer brick touches it)
 * in `used` only if it is valid at all nodes, with nodes on both sides of the iso value. Writes the
 * kept cells to plain_used. */
__kernel void mcor_march_classify(const int brick_count, __global const int* neighbours,
  __global const ulong* plain, __global const ulong* above, __global const ulong* valid,
  __global ulong* used, __global ulong* plain_used)
{
  MCOR_ITEM(slot, slot < brick_count);
  const ulong own = plain[slot], others = used[slot] & ~own;
  ulong m[8], v[8];
  mcor_corners_of(above, neighbours, slot, m);
  mcor_corners_of(valid, neighbours, slot, v);
  const ulong now = used[slot] & own & mcor_cells_crossed(m, v);
  used[slot] = now | others;
  plain_used[slot] = now;
}

/* One work-item = one brick. Reads used cells, node masks and decisions. Writes the brick's edge
 * masks (see mcor_cell.cl), for crossed edges that have their lower node in the brick and a used
 * cell around them. Writes the number of vertices and, if the topology is resolved, of tunnels.
 * Adds the triangles (in a plane, lines) of plain cells to triangle_count. */
__kernel void mcor_march_count(const int brick_count, MCOR_CUT_PARAMS, const int plane,
  const int leaf_count, __global const uint* quadrants, __global const ulong* plain_used,
  __global const ulong* above, __global ulong* edges, __global int* vertex_count,
  __global int* triangle_count, __global int* tunnel_count)
{
  MCOR_ITEM(slot, slot < brick_count);
  ulong m[8], lower[8];
  mcor_brick_masks(plain_used, neighbours, slot, 7, lower);
  mcor_brick_masks(above, neighbours, slot, 0, m);
  __global ulong* to = edges + (long)slot * MCOR_EDGE_MASKS;
  int vertices = 0;
  for (int a = 0; a < 3; ++a)
  {
    ulong q[4];
    mcor_cell_around(lower, a, q);
    if (plane) /* a square counts as a cell on both sides of the plane */
    {
      q[0] = q[2] = a == 2 ? 0 : q[0] & MCOR_PLANE_MASK;
      q[1] = q[3] = a == 2 ? 0 : q[1] & MCOR_PLANE_MASK;
    }
    const ulong changes = m[0] ^ mcor_from_next(a, m[0], m[1 << a]);
    for (int k = 0; k < 4; ++k)
    {
      const long at = slot * (long)MCOR_QUADRANT_WORDS + 8 * a + 2 * k;
      q[k] =
        (q[k] & changes) | (leaf_count > 0 ? (ulong)quadrants[at + 1] << 32 | quadrants[at] : 0);
    }
    const ulong crossed = q[0] | q[1] | q[2] | q[3];
    const ulong pinched = (q[0] & q[3] & ~q[1] & ~q[2]) | (q[1] & q[2] & ~q[0] & ~q[3]);
    to[a] = crossed;
    to[3 + a] = crossed & ~(q[0] & q[1] & q[2] & q[3]);
    to[6 + a] = pinched;
    vertices += (int)(popcount(crossed) + popcount(pinched));
  }
  vertex_count[slot] = vertices;
  int tunnels = 0, made = 0;
  mcor_cell_corners(m);
  for (ulong rest = plain_used[slot]; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    const int square = mcor_march_case(m, cell) & 15;
    made += plane ? 1 + (square == 6 || square == 9)
                  : mcor_cell_cut(m, MCOR_CUT_ARGS, slot, cell, &tunnels)->triangles;
  }
  triangle_count[slot] += made;
  if (resolved)
  {
    tunnel_count[slot] = tunnels;
  }
}

/* Returns the value at the upper end of the edge from node n of a brick along an axis. If this end
 * lies beyond the brick, its value is in the next brick of the same level, or in a finer brick. */
real mcor_march_end(__global const int* neighbours, MCOR_BRICK_PARAMS, int4 brick, int slot, int n,
  int axis, __global const real* node_value)
{
  const int step = 1 << (2 * axis), next = neighbours[slot * 14L + (1 << axis) - 1];
  if ((n >> (2 * axis) & 3) != 3)
  {
    return node_value[slot * 64L + n + step];
  }
  if (next >= 0)
  {
    return node_value[next * 64L + n - 3 * step];
  }
  const int4 along = (int4)(axis == 0, axis == 1, axis == 2, 0);
  const int4 at = 2 * (brick * MCOR_BRICK + mcor_place_of(n) + along);
  const int other =
    mcor_find_brick(MCOR_BRICK_ARGS, (int4)(at.x >> 2, at.y >> 2, at.z >> 2, brick.w - 1));
  return node_value[other * 64L + (at.x & 3) + 4 * (at.y & 3) + 16 * (at.z & 3)];
}

/* One work-item = one brick. Reads the brick's crossed edges and the node values. Writes for each
 * vertex its lattice edge: x, y, z of the edge's lower node; w = axis, plus 4 if a cell around the
 * edge is not used, plus 256 times the level. Also writes the values at both ends, minus iso. */
__kernel void mcor_march_vertices(MCOR_BRICK_PARAMS, const int slot_count,
  __global const int* neighbours, __global const int4* bricks, __global const ulong* edges,
  __global const real* node_value, __global const int* vertex_base, const real iso,
  __global int4* vertex_edge, __global real* vertex_ends)
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
        int4 edge = brick * MCOR_BRICK + mcor_place_of(n);
        edge.w = axis | (int)(e[3 + axis] >> n & 1) << 2 | brick.w << MCOR_LEVEL_SHIFT;
        const real end =
          mcor_march_end(neighbours, MCOR_BRICK_ARGS, brick, slot, n, axis, node_value);
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

/* One work-item = one brick. Reads used cells, node masks, decisions and the numbering of vertices
 * by edge. Writes triangles (in a plane, lines) and, if `follows` is set, the keys of their cells.
 * The key of a cell outside of the box x0 to z1 has the mark MCOR_RING_CELL: this call does not own
 * the cell. If this cell is in the box all_x0 to all_z1, another rank owns it, and its key also has
 * the mark MCOR_OTHERS_CELL. */
__kernel void mcor_march_triangles(const int brick_count, MCOR_LEAF_PARAMS,
  __global const ulong* plain, __global const int* leaf_of, MCOR_CUT_PARAMS, MCOR_SIDES_PARAMS,
  const int all_x0, const int all_y0, const int all_z0, const int all_x1, const int all_y1,
  const int all_z1, const int follows, __global const mcor_rung* rungs, __global const int4* bricks,
  __global const ulong* used, __global const ulong* edges, __global const int* vertex_base,
  __global const int* triangle_base, __global ulong* triangle_cells, __global int* triangles)
{
  MCOR_ITEM(slot, slot < brick_count && used[slot] != 0);
  const ulong own = plain[slot];
  ulong m[8];
  int numbers[3][MCOR_CELL_NODES];
  mcor_leaf leaf;
  mcor_corners_of(above, neighbours, slot, m);
  if (!plane)
  {
    mcor_edge_numbers(neighbours + slot * 14L, edges, vertex_base, slot, numbers);
  }
  if (used[slot] & ~own)
  {
    leaf = mcor_leaf_load(leaf_of[slot], plane, finer, tables, above, valid);
  }
  const ulong owned = mcor_cells_within(MCOR_SIDES_ARGS, bricks[slot]);
  const ulong others =
    ~owned & mcor_cells_within(all_x0, all_y0, all_z0, all_x1, all_y1, all_z1, bricks[slot]);
  const ulong key = mcor_brick_key(rungs, bricks[slot]) << 6;
  const ulong joined =
    plane && resolved ? decisions[slot * (long)MCOR_DECISION_MASKS + 2] & own : 0;
  long to = triangle_base[slot];
  for (ulong rest = used[slot]; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    const bool is_plain = own >> cell & 1;
    __global int* next = triangles + 3 * to;
    int tunnels = 0;
    const int made = plane ? mcor_plane_emit(m, is_plain, &leaf, cell, joined >> cell & 1,
                               neighbours + slot * 14L, edges, vertex_base, slot, next)
      : is_plain
      ? mcor_cell_emit(mcor_cell_cut(m, MCOR_CUT_ARGS, slot, cell, &tunnels), numbers, cell, next)
      : mcor_leaf_emit(&leaf, cell, edges, vertex_base, next);
    /* Intel's compiler (2026.2) crashes on other forms of this loop. */
    for (int i = 0; i < made && follows; ++i)
    {
      triangle_cells[to + i] = key | (ulong)cell | (~owned >> cell & 1) * MCOR_RING_CELL |
        (others >> cell & 1) * MCOR_OTHERS_CELL;
    }
    to += made;
  }
}

/* One work-item = one pair (x, y) of vertices. Replaces the `width` numbers of vertex x by the
 * numbers of vertex y. */
__kernel void mcor_march_replace(
  const int count, __global const int2* pairs, const int width, __global real* numbers)
{
  MCOR_ITEM(i, i < count);
  for (int k = 0; k < width; ++k)
  {
    numbers[pairs[i].x * (long)width + k] = numbers[pairs[i].y * (long)width + k];
  }
}

/* One work-item = one mask i. Writes how many bits masks[i] and within[i] have in common. */
__kernel void mcor_march_bits(
  const int count, __global const ulong* masks, __global const ulong* within, __global int* bits)
{
  MCOR_ITEM(i, i < count);
  bits[i] = (int)popcount(masks[i] & within[i]);
}
