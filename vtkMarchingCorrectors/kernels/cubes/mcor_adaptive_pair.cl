/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the paper's seed selection [III-C]. Of each level's lattice the cells on the line between a
 * pair are found; those that are cells of leaves are marked. From them the surface grows from cell to
 * cell through crossed faces, also to larger and smaller ones. Pairs are those of uniform cubes, see
 * mcor_pair.cl. Of leaves where there is certainly no surface nothing is known: they have no used
 * cells. */

/* Bricks by their sorted keys: leaves where there may be surface, and those that such leaves are parts of. */
#define MCOR_PLACE_PARAMS                                                                          \
  const int place_count, __global const mcor_rung *rungs, __global const ulong *place_keys,        \
    __global const int *place_leaves
#define MCOR_PLACE_ARGS place_count, rungs, place_keys, place_leaves

/* What such a brick is, if it is no leaf. */
#define MCOR_PLACE_SPLIT (-1)
#define MCOR_PLACE_NONE (-2)

int mcor_find_place(MCOR_PLACE_PARAMS, int level, int x, int y, int z)
{
  __global const mcor_rung* rung = rungs + level;
  if (x < 0 || y < 0 || z < 0 || x >= rung->n[0] || y >= rung->n[1] || z >= rung->n[2])
  {
    return MCOR_PLACE_NONE;
  }
  const ulong key = mcor_adaptive_key(rungs, level, x, y, z);
  const int at = mcor_find_key(place_keys, 0, place_count, key);
  return at < place_count && place_keys[at] == key ? place_leaves[at] : MCOR_PLACE_NONE;
}

/* Adds a cell of a level to those of its leaf, if that is one. flags: 1 where it is new. */
void mcor_leaf_reach(
  MCOR_PLACE_PARAMS, int level, int x, int y, int z, __global uint* reached, __global int* flags)
{
  const int leaf = mcor_find_place(MCOR_PLACE_ARGS, level, x >> 2, y >> 2, z >> 2);
  const ulong cell = 1UL << ((x & 3) | (y & 3) << 2 | (z & 3) << 4);
  if (leaf >= 0 && mcor_add_cells(reached, leaf, cell))
  {
    atomic_or(flags, 1);
  }
}

#if MCOR_OF_LATTICE
/* One work-item = one leaf. Writes its key, and those of the bricks that it is part of: of each level one, of the
 * levels up to its own that of itself. */
__kernel void mcor_adaptive_pair_keys(const int count, const int top,
  __global const mcor_rung* rungs, __global const int4* leaves, __global ulong* keys)
{
  const int i = get_global_id(0);
  for (int l = 0; l <= top && i < count; ++l)
  {
    const int4 leaf = leaves[i];
    const int up = max(l - leaf.w, 0);
    keys[i * (top + 1L) + l] =
      mcor_adaptive_key(rungs, leaf.w + up, leaf.x >> up, leaf.y >> up, leaf.z >> up);
  }
}

/* One work-item = one leaf. Enters it at its key, of which `index` has the place. */
__kernel void mcor_adaptive_pair_places(
  const int count, const int top, __global const int* index, __global int* place_leaves)
{
  MCOR_ITEM(i, i < count);
  place_leaves[index[i * (top + 1L)]] = i;
}
#endif

/* ---- Cells between pairs ---- */

#if MCOR_OF_ADAPTIVE
/* What marking takes, last among a kernel's parameters. top: the highest level. */
#define MCOR_MARK_PARAMS MCOR_PLACE_PARAMS, const int top, __global uint *reached
#define MCOR_MARK_ARGS MCOR_PLACE_ARGS, top, reached

/* Marks a cell of a level if it is a leaf's; whether smaller ones may be there. */
bool mcor_leaf_seed_cell(MCOR_MARK_PARAMS, int level, int x, int y, int z)
{
  const int leaf = mcor_find_place(MCOR_PLACE_ARGS, level, x >> 2, y >> 2, z >> 2);
  if (leaf >= 0)
  {
    mcor_add_cells(reached, leaf, 1UL << ((x & 3) | (y & 3) << 2 | (z & 3) << 4));
  }
  return leaf == MCOR_PLACE_SPLIT;
}

/* Where a line, of which 1 / gap is the extent along an axis, crosses the side by which it leaves the cell
 * from `low` on: as a share of the line; beyond it where it ends in the cell. Of all levels that have
 * this side the same. */
real mcor_leaf_crossing(long from, long low, long edge, int step, real gap, bool ends)
{
  const long side = step < 0 ? from - low : low + edge - from;
  return ends ? (real)2 : (real)side * gap;
}

/* Marks cells of a level on the line between two places, fixed-point numbers. Where the line passes an edge
 * or a corner of a cell to within rounding, the cells on both sides are found. Whether smaller ones may
 * be there: those found on a finer lattice are all within these. */
bool mcor_leaf_seed_line(
  MCOR_MARK_PARAMS, const long* from, const long* to, int level, const fix step_of[3])
{
  real next[3], gap[3];
  int c[3], end[3], step[3], steps = 0;
  long edge[3];
  for (int a = 0; a < 3; ++a)
  {
    edge[a] = (long)step_of[a] << level;
    c[a] = (int)(from[a] / edge[a]);
    end[a] = (int)(to[a] / edge[a]);
    step[a] = to[a] < from[a] ? -1 : 1;
    gap[a] = to[a] == from[a] ? 0 : 1 / (real)abs(to[a] - from[a]);
    next[a] = mcor_leaf_crossing(from[a], c[a] * edge[a], edge[a], step[a], gap[a], c[a] == end[a]);
    steps += abs(end[a] - c[a]);
  }
  bool split = mcor_leaf_seed_cell(MCOR_MARK_ARGS, level, c[0], c[1], c[2]);
  for (; steps > 0; --steps)
  {
    int axis = next[1] < next[0] ? 1 : 0;
    axis = next[2] < next[axis] ? 2 : axis;
    for (int a = 0; a < 3; ++a)
    {
      if (a != axis && c[a] != end[a] && next[a] - next[axis] < (real)1e-5f)
      {
        split |= mcor_leaf_seed_cell(MCOR_MARK_ARGS, level, c[0] + (a == 0 ? step[0] : 0),
          c[1] + (a == 1 ? step[1] : 0), c[2] + (a == 2 ? step[2] : 0));
      }
    }
    c[axis] += step[axis];
    next[axis] = mcor_leaf_crossing(
      from[axis], c[axis] * edge[axis], edge[axis], step[axis], gap[axis], c[axis] == end[axis]);
    split |= mcor_leaf_seed_cell(MCOR_MARK_ARGS, level, c[0], c[1], c[2]);
  }
  return split;
}

/* Marks the cells between particles j and k: of large leaves first. */
void mcor_pair_seed_pair(const mcor_grid* grid, MCOR_MARK_PARAMS, int j, int k)
{
  const long from[3] = { grid->px[j], grid->py[j], grid->pz[j] };
  const long to[3] = { grid->px[k], grid->py[k], grid->pz[k] };
  bool split = true;
  for (int level = top; level >= 0 && split; --level)
  {
    split = mcor_leaf_seed_line(MCOR_MARK_ARGS, from, to, level, grid->step);
  }
}

#endif

/* ---- Growth ---- */

#if MCOR_OF_LATTICE
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

/* Used cells of a leaf, and those whose lower and upper faces across each axis are crossed. */
typedef struct
{
  ulong used, lower[3], upper[3];
} mcor_leaf_faces;

/* Of all cells that have no finer nodes. */
mcor_leaf_faces mcor_leaf_plain_faces(const mcor_leaf* leaf, ulong hanging)
{
  const ulong* above = leaf->corners_above;
  mcor_leaf_faces faces;
  faces.used = mcor_leaf_crossed(leaf, hanging);
  for (int a = 0; a < 3; ++a)
  {
    faces.lower[a] = mcor_cell_faces(above, a, 0) & ~hanging;
    faces.upper[a] = mcor_cell_faces(above, a, 1) & ~hanging;
  }
  return faces;
}

/* Adds a cell that has finer nodes. */
void mcor_leaf_add_faces(const mcor_leaf* leaf, int cell, mcor_leaf_faces* faces)
{
  const mcor_adaptive_nodes_of nodes = mcor_leaf_cell(leaf, cell);
  faces->used |= (ulong)nodes.used << cell;
  for (int a = 0; a < 3; ++a)
  {
    faces->lower[a] |= (ulong)mcor_leaf_is_crossed(nodes, mcor_leaf_plane(a, 0)) << cell;
    faces->upper[a] |= (ulong)mcor_leaf_is_crossed(nodes, mcor_leaf_plane(a, 2)) << cell;
  }
}

/* Grows cells within their leaf to the end. */
ulong mcor_leaf_grow(
  const mcor_leaf* leaf, ulong hanging, ulong cells, ulong domain, mcor_leaf_faces* faces)
{
  ulong looked_at = 0;
  for (ulong last = 0; cells != last;)
  {
    last = cells;
    for (ulong rest = cells & hanging & ~looked_at; rest; rest &= rest - 1)
    {
      mcor_leaf_add_faces(leaf, mcor_ctz(rest), faces);
    }
    looked_at = cells;
    const ulong used = cells & faces->used;
    cells |= domain & mcor_cells_beside(used, faces->lower, faces->upper);
  }
  return cells;
}

/* Reaches across a side of a leaf from one of its cells to smaller ones, through the quarters that are
 * crossed. */
void mcor_leaf_reach_finer(const mcor_leaf* leaf, int4 brick, int cell, int axis, int side,
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
      mcor_leaf_reach(MCOR_PLACE_ARGS, brick.w - 1, to[0], to[1], to[2], reached, flags);
    }
  }
}

/* Reaches across a side of a leaf from `cells` that lie at it, through their faces there. */
void mcor_leaf_reach_across(const mcor_leaf* leaf, int4 brick, ulong cells, int axis, int side,
  MCOR_PLACE_PARAMS, __global uint* reached, __global int* flags)
{
  const int by = side ? 1 : -1, shift = 3 << 2 * axis;
  const int4 to = brick + (int4)(axis == 0 ? by : 0, axis == 1 ? by : 0, axis == 2 ? by : 0, 0);
  const int other = mcor_find_place(MCOR_PLACE_ARGS, brick.w, to.x, to.y, to.z);
  if (other >= 0)
  {
    if (mcor_add_cells(reached, other, side ? cells >> shift : cells << shift))
    {
      atomic_or(flags, 1);
    }
    return;
  }
  for (ulong rest = cells; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest), beyond = side ? cell - shift : cell + shift;
    if (other == MCOR_PLACE_SPLIT)
    {
      mcor_leaf_reach_finer(leaf, brick, cell, axis, side, MCOR_PLACE_ARGS, reached, flags);
    }
    else
    {
      mcor_leaf_reach(MCOR_PLACE_ARGS, brick.w + 1, (4 * to.x + (beyond & 3)) >> 1,
        (4 * to.y + (beyond >> 2 & 3)) >> 1, (4 * to.z + (beyond >> 4)) >> 1, reached, flags);
    }
  }
}

/* One work-item = one leaf with cells that are new to this round. Reads its nodes' masks where it is mixed. Grows
 * the cells reached by now through crossed faces of used cells, within the leaf to the end, and one step
 * beyond its sides. domain: where nodes have right values. */
__kernel void mcor_adaptive_pair_grow(const int count, const int plane, __global const uint* finer,
  __global const int* tables, __global const ulong* above, __global const ulong* valid,
  __global const uchar* mixed, __global const int4* bricks, MCOR_PLACE_PARAMS,
  __global const ulong* domain, __global ulong* grown, __global uint* reached, __global int* flags)
{
  MCOR_ITEM(i, i < count && mixed[i]);
  const ulong before = grown[i];
  /* Others add to them meanwhile: what is missed is there in the next round. */
  const ulong first = atomic_or(reached + 2L * i, 0), rest = atomic_or(reached + 2L * i + 1, 0);
  ulong cells = domain[i] & (rest << 32 | first);
  if (cells == before)
  {
    return;
  }
  const mcor_leaf leaf = mcor_leaf_load(i, plane, finer, tables, above, valid);
  const ulong hanging = mcor_leaf_hanging_cells(leaf.hanging);
  mcor_leaf_faces faces = mcor_leaf_plain_faces(&leaf, hanging);
  cells = mcor_leaf_grow(&leaf, hanging, cells, domain[i], &faces);
  grown[i] = cells;
  mcor_add_cells(reached, i, cells);
  const ulong fresh = cells & ~before & faces.used;
  for (int face = 0; face < 6 && fresh; ++face)
  {
    const int axis = face >> 1, side = face & 1;
    const ulong low = mcor_lowest(axis);
    const ulong at = side ? faces.upper[axis] & low << (3 << 2 * axis) : faces.lower[axis] & low;
    if (fresh & at)
    {
      mcor_leaf_reach_across(
        &leaf, bricks[i], fresh & at, axis, side, MCOR_PLACE_ARGS, reached, flags);
    }
  }
}

/* One work-item = one cell, with its level, that another box, or the other end of a period, has reached. Adds it
 * to its leaf's. */
__kernel void mcor_adaptive_pair_take(const int count, __global const int4* heard,
  MCOR_PLACE_PARAMS, __global uint* reached, __global int* flags)
{
  MCOR_ITEM(i, i < count);
  const int4 cell = heard[i];
  mcor_leaf_reach(MCOR_PLACE_ARGS, cell.w, cell.x, cell.y, cell.z, reached, flags);
}

/* One work-item = one leaf. Leaves those of its cells that are reached. */
__kernel void mcor_adaptive_pair_keep(
  const int count, __global const ulong* reached, __global ulong* cells)
{
  MCOR_ITEM(i, i < count);
  cells[i] &= reached[i];
}
#endif
