/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Topology by the field. On an ambiguous face, two nodes at opposite corners are above the iso
 * value, and the other two below. The field at the saddle of the face's bilinear interpolant
 * decides which nodes are connected. The brick that owns the face's lowest node evaluates the
 * saddle once, so the cells on both sides of the face read the same answer. Cells whose surface has
 * two loops, i.e. closed polygons, come next: the field at the saddles of the trilinear interpolant
 * decides whether a tunnel joins the loops.
 *
 * A cell is plain if no finer brick touches it. With adaptive cubes, the field decides on faces
 * between two plain cells of one level, and on tunnels in plain cells; all other ambiguous faces
 * follow the case table. Which faces the field decides depends on the leaves alone, so the cells on
 * both sides agree. */

/* Whether the field at a sample, i.e. a point where the field is evaluated, is above the iso value.
 * value: the field minus the iso value; 1e30 if there is no Shepard mean at the sample, see
 * mcor_evaluate. Without a mean, the field is neither above nor below. */
bool mcor_sample_is_above(real value)
{
  return value >= 0 && value != (real)1e30f;
}

/* One work-item = one brick. Reads used cells, node masks and, with leaves of several levels, which
 * cells are plain: these touch no finer brick. Writes the ambiguous faces between two plain cells,
 * at least one of which is used, and the number of these faces. In two dimensions, a cell is a
 * single square: writes the ambiguous squares that are plain and used. */
__kernel void mcor_topology_faces(const int brick_count, __global const int* neighbours,
  const int leaf_count, const int plane, __global const ulong* plain, __global const ulong* used,
  __global const ulong* above, __global ulong* decisions, __global int* counts)
{
  MCOR_ITEM(slot, slot < brick_count);
  ulong m[8], p[8], u[8];
  mcor_brick_masks(used, neighbours, slot, 7, u);
  mcor_corners_of(above, neighbours, slot, m);
  if (leaf_count > 0)
  {
    mcor_brick_masks(plain, neighbours, slot, 7, p);
  }
  int count = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const ulong between = leaf_count == 0 ? ~0UL
      : plane                             ? p[0]
                                          : p[0] & mcor_from_last(axis, p[0], p[1 << axis]);
    const ulong layer = plane ? 0xffffUL : ~0UL; /* in a plane, cells are one layer of squares */
    const ulong reached = layer & between & (u[0] | mcor_from_last(axis, u[0], u[1 << axis]));
    const int du = 1 << (axis + 1) % 3, dv = 1 << (axis + 2) % 3;
    const ulong ambiguous = reached & (m[0] ^ m[du]) & (m[0] ^ m[dv]) & ~(m[0] ^ m[du | dv]);
    decisions[slot * (long)MCOR_DECISION_MASKS + axis] = ambiguous;
    count += (int)popcount(ambiguous);
  }
  counts[slot] = count;
}

/* Returns the value at the node that is `corner` (bits x, y, z) up from node n of a brick. */
real mcor_topology_value(
  __global const real* node_value, __global const int* neighbours, int slot, int n, int corner)
{
  const int x = (n & 3) + (corner & 1), y = (n >> 2 & 3) + (corner >> 1 & 1),
            z = (n >> 4) + (corner >> 2);
  const int d = (x >> 2) | (y >> 2) << 1 | (z >> 2) << 2;
  const int owner = d ? neighbours[slot * 14L + d - 1] : slot;
  return node_value[owner * 64L + ((x & 3) | (y & 3) << 2 | (z & 3) << 4)];
}

/* Returns part / whole, or 0.5 if `whole` is 0. `whole` may be 0 on a device without denormal
 * numbers. */
real mcor_topology_part(real part, real whole)
{
  return whole != 0 ? part / whole : (real)0.5;
}

int4 mcor_topology_node(__global const int4* bricks, int slot, int n)
{
  const int4 node = bricks[slot] * MCOR_BRICK + mcor_place_of(n);
  return (int4)(node.x, node.y, node.z, 0);
}

/* One work-item = one brick. Reads its ambiguous faces and node values. Writes each face's saddle,
 * as the face's lowest node and the offset from it in edges. */
__kernel void mcor_topology_saddles(const int brick_count, __global const int4* bricks,
  __global const int* neighbours, __global const ulong* decisions, __global const real* node_value,
  __global const int* base, const real iso, __global int4* sample_node,
  __global real4* sample_offset)
{
  MCOR_ITEM(slot, slot < brick_count);
  int to = base[slot];
  for (int axis = 0; axis < 3; ++axis)
  {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3, du = 1 << u, dv = 1 << v;
    for (ulong rest = decisions[slot * (long)MCOR_DECISION_MASKS + axis]; rest; rest &= rest - 1)
    {
      const int n = mcor_ctz(rest);
      const real f00 = mcor_topology_value(node_value, neighbours, slot, n, 0) - iso;
      const real f10 = mcor_topology_value(node_value, neighbours, slot, n, du) - iso;
      const real f01 = mcor_topology_value(node_value, neighbours, slot, n, dv) - iso;
      const real f11 = mcor_topology_value(node_value, neighbours, slot, n, du | dv) - iso;
      /* Both differences have the same sign, so their sum does not cancel. */
      const real sum = (f00 - f01) + (f11 - f10);
      const real at[3] = { 0, mcor_topology_part(f00 - f01, sum),
        mcor_topology_part(f00 - f10, sum) };
      sample_node[to] = mcor_topology_node(bricks, slot, n);
      sample_offset[to++] = (real4)(at[(3 - axis) % 3], at[(4 - axis) % 3], at[(5 - axis) % 3], 0);
    }
  }
}

/* One work-item = one brick. Reads the field at the saddles of the brick's ambiguous faces. A face
 * is joined if its saddle is above the iso value. Keeps only the joined faces, and writes the
 * number of these faces. */
__kernel void mcor_topology_join(const int brick_count, __global const int* base,
  __global const real* value, __global ulong* decisions, __global int* joined_count)
{
  MCOR_ITEM(slot, slot < brick_count);
  int from = base[slot], count = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    __global ulong* faces = decisions + slot * (long)MCOR_DECISION_MASKS + axis;
    ulong joined = 0;
    for (ulong rest = *faces; rest; rest &= rest - 1)
    {
      joined |= mcor_sample_is_above(value[from++]) ? rest & -rest : 0;
    }
    *faces = joined;
    count += (int)popcount(joined);
  }
  joined_count[slot] = count;
}

/* One work-item = one brick. Reads used cells and joined faces. Writes the cells that may have a
 * tunnel, and the number of samples (points where the field will be evaluated): two for each such
 * cell. */
__kernel void mcor_topology_cells(const int brick_count, __global const int* neighbours,
  __global const ulong* used, __global const ulong* above, __global const int* cases,
  __global const mcor_cell_row* rows, __global ulong* decisions, __global int* counts)
{
  MCOR_ITEM(slot, slot < brick_count);
  ulong m[8], cells = 0;
  mcor_corners_of(above, neighbours, slot, m);
  for (ulong rest = used[slot]; rest; rest &= rest - 1)
  {
    __global const mcor_cell_row* row =
      rows + mcor_topology_row(m, neighbours, decisions, cases, slot, mcor_ctz(rest));
    cells |= row->tunnel[0] | row->tunnel[1] ? rest & -rest : 0;
  }
  decisions[slot * (long)MCOR_DECISION_MASKS + 3] = cells;
  counts[slot] = 2 * (int)popcount(cells);
}

/* Returns the root t of xyz * t + q = p, or -1 if t is not between -1 and 1. t is one of the two
 * roots of (xyz * t + q)^2 = p^2. Their product is n / (a * xyz), see mcor_topology_product. If p -
 * q would cancel, computes t from the other root and this product. */
real mcor_topology_root(real p, real q, real xyz, real n, real a)
{
  const real above = p * q > 0 ? n : p - q, below = p * q > 0 ? -a * (p + q) : xyz;
  return fabs(above) < fabs(below) ? above / below : (real)-1;
}

/* Returns the parameter n of mcor_topology_root: (product of both roots) * a * xyz, with a and xyz
 * of mcor_topology_find_saddles. */
real mcor_topology_product(real x, real y, real z, real yz, real xz, real xy, real xyz)
{
  return yz * (x * yz - y * xz - z * xy) + y * z * xyz;
}

/* Finds the saddles, within the cell, of the trilinear interpolant of corner values f, and returns
 * their number. x, xy, ..., xyz are the interpolant's coefficients, and X, Y, Z are coordinates in
 * the cell. Let P = xyz X + yz, Q = xyz Y + xz, R = xyz Z + xy, and a, b, c as below. At a saddle
 * all three derivatives are 0; then Q R = -a, P R = -b, P Q = -c. */
int mcor_topology_find_saddles(const real* f, real4 saddle[2])
{
  const real x = f[1] - f[0], y = f[2] - f[0], z = f[4] - f[0];
  const real xy = f[3] - f[2] - x, yz = f[6] - f[4] - y, xz = f[5] - f[4] - x;
  const real xyz = ((f[7] - f[6]) - (f[5] - f[4])) - ((f[3] - f[2]) - (f[1] - f[0]));
  const real a = x * xyz - xy * xz, b = y * xyz - xy * yz, c = z * xyz - yz * xz;
  const bool some = a * b * c < 0;
  const real p = some ? sqrt(-b * c / a) : 0, q = some ? sqrt(-a * c / b) : 0,
             r = some ? sqrt(-a * b / c) : 0;
  const real nx = mcor_topology_product(x, y, z, yz, xz, xy, xyz);
  const real ny = mcor_topology_product(y, z, x, xz, xy, yz, xyz);
  const real nz = mcor_topology_product(z, x, y, xy, yz, xz, xyz);
  int count = 0;
  for (int sign = -1; some && sign <= 1; sign += 2)
  {
    const real u = mcor_topology_root(sign * p, yz, xyz, nx, a);
    const real v = mcor_topology_root(c > 0 ? -sign * q : sign * q, xz, xyz, ny, b);
    const real w = mcor_topology_root(b > 0 ? -sign * r : sign * r, xy, xyz, nz, c);
    if (u > 0 && v > 0 && w > 0)
    {
      saddle[count++] = (real4)(u, v, w, 0);
    }
  }
  return count;
}

/* Returns the mean of the points where linear interpolation along the cell's edges is 0. If the
 * surface in the cell has two loops, this point lies between them. */
real4 mcor_topology_middle(const real* f)
{
  real4 sum = 0;
  for (int c = 0; c < 8; ++c)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const int other = c | 1 << axis;
      if (other != c && (f[c] >= 0) != (f[other] >= 0))
      {
        const real t = mcor_topology_part(f[c], f[c] - f[other]);
        sum += (real4)(axis == 0 ? t : (real)(c & 1), axis == 1 ? t : (real)(c >> 1 & 1),
          axis == 2 ? t : (real)(c >> 2), 1);
      }
    }
  }
  return (real4)(sum.x / sum.w, sum.y / sum.w, sum.z / sum.w, 0);
}

/* One work-item = one brick. Reads the cells that may have a tunnel, and node values. Writes two
 * samples for each cell: its two saddles, or its only saddle twice. For a cell without a saddle,
 * writes the point of mcor_topology_middle twice. */
__kernel void mcor_topology_middles(const int brick_count, __global const int4* bricks,
  __global const int* neighbours, __global const ulong* decisions, __global const real* node_value,
  __global const int* base, const real iso, __global int4* sample_node,
  __global real4* sample_offset)
{
  MCOR_ITEM(slot, slot < brick_count);
  int to = base[slot];
  for (ulong rest = decisions[slot * (long)MCOR_DECISION_MASKS + 3]; rest; rest &= rest - 1)
  {
    const int cell = mcor_ctz(rest);
    real f[8], largest = (real)1e-37f;
    for (int c = 0; c < 8; ++c)
    {
      f[c] = mcor_topology_value(node_value, neighbours, slot, cell, c) - iso;
      largest = fmax(largest, fabs(f[c]));
    }
    for (int c = 0; c < 8; ++c)
    {
      f[c] /= largest;
    }
    real4 saddle[2];
    const int saddles = mcor_topology_find_saddles(f, saddle);
    const real4 middle = mcor_topology_middle(f);
    for (int i = 0; i < 2; ++i)
    {
      sample_node[to] = mcor_topology_node(bricks, slot, cell);
      sample_offset[to++] = saddles > 0 ? saddle[min(i, saddles - 1)] : middle;
    }
  }
}

/* One work-item = one brick. Reads the field at the two samples of each cell that may have a
 * tunnel. Writes the cells whose samples are both below the iso value, and the cells whose samples
 * are both above. */
__kernel void mcor_topology_agree(const int brick_count, __global const int* base,
  __global const real* value, __global ulong* decisions)
{
  MCOR_ITEM(slot, slot < brick_count);
  __global ulong* cells = decisions + slot * (long)MCOR_DECISION_MASKS + 3;
  ulong below = 0, above = 0;
  int from = base[slot];
  for (ulong rest = cells[0]; rest; rest &= rest - 1, from += 2)
  {
    const real a = value[from], b = value[from + 1];
    below |= a < 0 && b < 0 ? rest & -rest : 0;
    above |= mcor_sample_is_above(a) && mcor_sample_is_above(b) ? rest & -rest : 0;
  }
  cells[0] = below;
  cells[1] = above;
}
