/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Points that are evaluated together, in groups of up to MCOR_LANES, and the particles that reach
 * them.
 *
 * Many more particles reach some point of a group than reach one given point. So a group consists
 * of MCOR_PARTS parts if packing, i.e. copying the chosen particles next to each other, is cheap.
 * The points of a part are close together, and each part has its own list of particles. All lists
 * are read at the same time: lane l of a vector belongs to part l % MCOR_PARTS. Every sum adds its
 * particles in the order of the search grid, whatever the groups are. */

/* Greatest distance between nodes of a group, in cubes, summed over the three axes; MCOR_GROUP_EDGE
 * is the limit along each axis. */
#define MCOR_GROUP_EDGES 12

#define MCOR_PART (MCOR_LANES / MCOR_PARTS)

#if !MCOR_OF_LATTICE
/* Points. x, y, z: each point's lattice node, in fixed-point units; ox, oy, oz: the offset from the
 * node, in cubes. */
typedef struct
{
  int index[MCOR_LANES]; /* number of each lane's point; -1 if a lane repeats another one */
  fixv x, y, z;
  realv ox, oy, oz;
  mcor_span part[MCOR_PARTS]; /* the box of each part */
} mcor_points;
#endif

/* State of a walk through successive points. A part holds up to MCOR_PART points of one brick. */
typedef struct
{
  int part, size; /* part of the group's last point, and the part's number of points so far */
  int4 low, high; /* box of the group's nodes */
} mcor_grouping;

/* Whether nodes in a box of this extent, in cubes, may be in one group. In a larger box, a group
 * would gather too many particles. */
bool mcor_group_fits(int4 extent)
{
  return extent.x + extent.y + extent.z <= MCOR_GROUP_EDGES &&
    max(extent.x, max(extent.y, extent.z)) <= MCOR_GROUP_EDGE;
}

/* Adds the next point, at `node`, to the group. before: the last point's node. Returns false if the
 * point does not fit; the caller then starts a new group. */
bool mcor_group_add(mcor_grouping* grouping, int4 before, int4 node)
{
  const int4 low = min(grouping->low, node), high = max(grouping->high, node);
  const int4 brick = node >> 2, brick_before = before >> 2;
  const bool new_part = grouping->size == MCOR_PART || brick.x != brick_before.x ||
    brick.y != brick_before.y || brick.z != brick_before.z;
  if (grouping->part + new_part >= MCOR_PARTS || !mcor_group_fits(high - low))
  {
    return false;
  }
  grouping->part += new_part;
  grouping->size = new_part ? 1 : grouping->size + 1;
  grouping->low = low;
  grouping->high = high;
  return true;
}

mcor_grouping mcor_group_start(int4 node)
{
  const mcor_grouping grouping = { 0, 1, node, node };
  return grouping;
}

#if MCOR_OF_LATTICE
/* One work-item = MCOR_GROUPED_POINTS of the `count` points from `first` on. Writes to `flags` 1
 * for a point at which a group starts, else 0. */
__kernel void mcor_group_count(
  const int first, const int count, __global const int4* all_nodes, __global int* flags)
{
  __global const int4* node = all_nodes + first;
  const int begin = get_global_id(0) * MCOR_GROUPED_POINTS;
  mcor_grouping grouping;
  for (int i = begin; i < min(begin + MCOR_GROUPED_POINTS, count); ++i)
  {
    const bool fits = i > begin && mcor_group_add(&grouping, node[i - 1], node[i]);
    flags[i] = !fits;
    if (!fits)
    {
      grouping = mcor_group_start(node[i]);
    }
  }
}

#else
/* Gives the points of a group to lanes, and loads their nodes. from: the number of each lane's
 * point. A lane without a point of its own repeats the point of another lane. */
void mcor_points_load(const mcor_grid* grid, __global const int4* node, int begin, int end,
  mcor_points* points, int from[MCOR_LANES])
{
  fix n[3][MCOR_LANES];
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    points->index[lane] = -1;
  }
  mcor_grouping grouping = mcor_group_start(node[begin]);
  points->index[0] = begin;
  for (int i = begin + 1; i < end; ++i)
  {
    mcor_group_add(&grouping, node[i - 1], node[i]);
    points->index[(grouping.size - 1) * MCOR_PARTS + grouping.part] = i;
  }
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int part_first = points->index[lane % MCOR_PARTS];
    from[lane] = points->index[lane] >= 0 ? points->index[lane]
      : part_first >= 0                   ? part_first
                                          : begin;
    const int4 p = node[from[lane]];
    n[0][lane] = (fix)p.x * grid->step[0];
    n[1][lane] = (fix)p.y * grid->step[1];
    n[2][lane] = (fix)p.z * grid->step[2];
  }
  points->x = MCOR_LOAD(0, n[0]);
  points->y = MCOR_LOAD(0, n[1]);
  points->z = MCOR_LOAD(0, n[2]);
}

/* Fits the query, and the boxes of the parts, to points with offsets between low and high. The
 * query's origin is a node in the middle of these points. */
void mcor_points_bound(const mcor_grid* grid, const realv low[3], const realv high[3],
  mcor_points* points, mcor_query* query)
{
  const fixv* node[3] = { &points->x, &points->y, &points->z };
  fix origin[3];
  query->radius = -1;
  for (int a = 0; a < 3; ++a)
  {
    const fix some = MCOR_GET_FIX(*node[a], 0);
    const realv at = MCOR_CONVERT_REALV(*node[a] - some) * grid->unit;
    const realv begin = at + low[a], end = at + high[a];
    real least = MCOR_GET(begin, 0), most = MCOR_GET(end, 0);
#if MCOR_PARTS == 4
    const float8 low8 = fmin(begin.lo, begin.hi), high8 = fmax(end.lo, end.hi);
    const float4 low4 = fmin(low8.lo, low8.hi), high4 = fmax(high8.lo, high8.hi);
#endif
    for (int part = 0; part < MCOR_PARTS; ++part)
    {
#if MCOR_PARTS == 4
      const real first = low4[part], last = high4[part];
#else
      real first = MCOR_GET(begin, part), last = MCOR_GET(end, part);
      for (int lane = part; lane < MCOR_LANES; lane += MCOR_PARTS)
      {
        first = fmin(first, MCOR_GET(begin, lane));
        last = fmax(last, MCOR_GET(end, lane));
      }
#endif
      points->part[part].center[a] = (real)0.5 * (first + last);
      points->part[part].half_size[a] = (real)0.5 * (last - first);
      least = fmin(least, first);
      most = fmax(most, last);
    }
    const real nodes = floor((real)0.5 * (least + most) / grid->edge[a]);
    const real middle = nodes * grid->edge[a];
    origin[a] = some + (fix)nodes * grid->step[a];
    query->low[a] = some + (fix)floor(least * grid->units) - 1;
    query->high[a] = some + (fix)ceil(most * grid->units) + 1;
    for (int part = 0; part < MCOR_PARTS; ++part)
    {
      points->part[part].center[a] -= middle;
    }
  }
  mcor_query_place(grid, query, origin);
}

/* Converts an offset from edges to cubes. If an edge is shorter than a cube, an offset near a whole
 * number of fixed-point units is rounded, so that a particle's distance from itself is 0. */
real mcor_offset_of(const mcor_grid* grid, int axis, real offset)
{
  const real at = offset * grid->edge[axis], units = at * grid->units,
             whole = floor(units + (real)0.5);
  const bool near = grid->edge[axis] != 1 && fabs(units - whole) < (real)0.07f;
  return near ? whole * grid->unit : at;
}

/* Loads points `begin` to `end` - 1, a group, with their offsets. */
void mcor_group_points(const mcor_grid* grid, int begin, int end, __global const int4* node,
  __global const real4* offset, mcor_points* points)
{
  int from[MCOR_LANES];
  mcor_points_load(grid, node, begin, end, points, from);
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const real4 o = offset[from[lane]];
    MCOR_SET(points->ox, lane) = mcor_offset_of(grid, 0, o.x);
    MCOR_SET(points->oy, lane) = mcor_offset_of(grid, 1, o.y);
    MCOR_SET(points->oz, lane) = mcor_offset_of(grid, 2, o.z);
  }
}

/* Loads a group of points, and fits the query to a box that reaches `margin` cubes beyond them. */
void mcor_group_load(const mcor_grid* grid, int begin, int end, __global const int4* node,
  __global const real4* offset, real margin, mcor_points* points, mcor_query* query)
{
  mcor_group_points(grid, begin, end, node, offset, points);
  const realv low[3] = { points->ox - margin, points->oy - margin, points->oz - margin };
  const realv high[3] = { points->ox + margin, points->oy + margin, points->oz + margin };
  mcor_points_bound(grid, low, high, points, query);
}

/* Parameters and first lines of the kernels whose work-items are groups of points. */
#define MCOR_GROUP_PARAMS                                                                          \
  MCOR_GRID_PARAMS, const int group_count, __global const int *groups, __global const int4 *node
#define MCOR_GROUP_ITEM(margin)                                                                    \
  MCOR_ITEM(group, group < group_count);                                                           \
  const mcor_grid grid = MCOR_GRID;                                                                \
  mcor_points points;                                                                              \
  mcor_query query;                                                                                \
  mcor_reach reach;                                                                                \
  mcor_group_load(&grid, groups[group], groups[group + 1], node, offset, margin, &points, &query); \
  mcor_tile_init(&reach.tile)

/* Finds the points' nodes, in cubes from the query's origin, which is also the origin of a tile's
 * particles. */
void mcor_points_relative(
  const mcor_grid* grid, const mcor_query* query, const mcor_points* points, realv at[3])
{
  at[0] = MCOR_CONVERT_REALV(points->x - query->origin[0]) * grid->unit;
  at[1] = MCOR_CONVERT_REALV(points->y - query->origin[1]) * grid->unit;
  at[2] = MCOR_CONVERT_REALV(points->z - query->origin[2]) * grid->unit;
}

/* Finds the offsets of the points from a particle at (x, y, z). at: made by mcor_points_relative.
 * The terms in parentheses are exact if the particle reaches the point, see MCOR_POINT_EXTENT, so
 * the distance does not depend on the query's origin. */
void mcor_points_from(
  const realv at[3], const mcor_points* points, realv x, realv y, realv z, realv d[3])
{
  d[0] = (at[0] - x) + points->ox;
  d[1] = (at[1] - y) + points->oy;
  d[2] = (at[2] - z) + points->oz;
}

/* Finds the offsets of the points from particle i of a reach. */
#define MCOR_REACH_FROM(at, points, reach, i, d)                                                   \
  mcor_points_from(                                                                                \
    at, points, MCOR_REACH(reach, x, i), MCOR_REACH(reach, y, i), MCOR_REACH(reach, z, i), d)
#endif
