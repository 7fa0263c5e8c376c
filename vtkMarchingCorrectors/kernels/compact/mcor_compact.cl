/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Correction of a compact contour. Ordinary vertices move along their edges, as in
 * mcor_correct.cl. Merged vertices, which have axis 3, move along the gradient at their start. */

/* Most that a merged vertex may move in one step, in cubes; in all it may move one cube. */
#define MCOR_COMPACT_STEP ((real)0.5)

/* Most merged vertices move less, in cubes. */
#define MCOR_COMPACT_SLACK ((real)0.3f)

/* Starts of vertices, and the lines along which they move: edges, or, once the gradient is
 * known, a cube along it. */
typedef struct
{
  fixv merged;
  mcor_edges edge;
  realv x, y, z;
} mcor_compact_lines;

MCOR_ONE_COPY void mcor_compact_load(const mcor_grid* grid, __global const int* groups, int group,
  __global const int4* node, __global const real* ends, __global const real4* offset,
  mcor_compact_lines* lines, mcor_points* points)
{
  int from[MCOR_LANES];
  realv axis;
  mcor_edges_load(grid, groups, group, node, ends, &lines->edge, points);
  mcor_points_place(node, groups[group], groups[group + 1], points, from);
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int v = from[lane];
    const bool merged = (node[v].w & 3) == 3;
    const real4 o = merged ? offset[v] : (real4)(0, 0, 0, 0);
    MCOR_SET(axis, lane) = (real)(node[v].w & 3);
    MCOR_SET(lines->x, lane) = mcor_offset_of(grid, 0, o.x);
    MCOR_SET(lines->y, lane) = mcor_offset_of(grid, 1, o.y);
    MCOR_SET(lines->z, lane) = mcor_offset_of(grid, 2, o.z);
  }
  lines->merged = axis == 3;
}

/* Fits the query to edges from t = low to high, and to a box of `margin` around merged vertices. */
void mcor_compact_bound(const mcor_grid* grid, const mcor_compact_lines* lines, realv low,
  realv high, real margin, mcor_points* points, mcor_query* query)
{
  const realv x = lines->merged ? (realv)0 : lines->edge.ax,
              y = lines->merged ? (realv)0 : lines->edge.ay,
              z = lines->merged ? (realv)0 : lines->edge.az,
              around = lines->merged ? (realv)margin : (realv)0;
  const realv from[3] = { lines->x + low * x - around, lines->y + low * y - around,
    lines->z + low * z - around };
  const realv to[3] = { lines->x + high * x + around, lines->y + high * y + around,
    lines->z + high * z + around };
  mcor_points_bound(grid, from, to, points, query);
}

/* Makes merged vertices move along the gradient, towards the iso value. */
void mcor_compact_aim(const mcor_field_at* at, mcor_compact_lines* lines)
{
  const realv most = fmax(fmax(fabs(at->gx), fabs(at->gy)), fabs(at->gz));
  const realv inv = (realv)1 / (most > 0 ? most : (realv)1);
  const realv x = at->gx * inv, y = at->gy * inv, z = at->gz * inv;
  const realv length = mcor_rsqrt(mcor_square(x, y, z));
  const realv scale = at->value < 0 ? length : -length;
  mcor_edges* e = &lines->edge;
  e->ax = lines->merged ? x * scale : e->ax;
  e->ay = lines->merged ? y * scale : e->ay;
  e->az = lines->merged ? z * scale : e->az;
  e->v0 = lines->merged ? at->value : e->v0;
}

/* Does what mcor_correct_group does. missed: merged vertices that did not reach the surface. */
void mcor_compact_group(const mcor_grid* grid, mcor_compact_lines* lines, realv t0, real iso,
  real tolerance, int limit, mcor_points* points, mcor_query* query, mcor_reach* reach,
  mcor_field_at* at, realv* t, fixv* evaluations, fixv* missed)
{
  mcor_edges* e = &lines->edge;
  const fixv merged = lines->merged;
  realv low = merged ? (realv)0 : (realv)MCOR_EDGE_MARGIN;
  realv high = merged ? (realv)1 : (realv)(1 - MCOR_EDGE_MARGIN);
  fixv active = low < high;
  realv last_t = t0, last_value = 0, last_slope = 0;
  realv reached_low = merged ? (realv)0 : fmax(t0 - MCOR_EDGE_SLACK, (realv)0);
  realv reached_high = merged ? (realv)MCOR_COMPACT_SLACK : fmin(t0 + MCOR_EDGE_SLACK, (realv)1);
  mcor_tile_init(&reach->tile);
  mcor_compact_bound(grid, lines, reached_low, reached_high, MCOR_COMPACT_SLACK, points, query);
  *t = t0;
  *evaluations = 0;
  for (int i = 0;; ++i)
  {
    points->ox = lines->x + (merged && i == 0 ? (realv)0 : *t * e->ax);
    points->oy = lines->y + (merged && i == 0 ? (realv)0 : *t * e->ay);
    points->oz = lines->z + (merged && i == 0 ? (realv)0 : *t * e->az);
    mcor_evaluate(grid, query, reach, points, iso, at);
    *evaluations += active ? (fixv)1 : (fixv)0;
    if (i == 0)
    {
      mcor_compact_aim(at, lines);
    }
    const realv slope = at->gx * e->ax + at->gy * e->ay + at->gz * e->az;
    const realv error = fabs(at->value);
    const realv near = fmax(MCOR_EDGE_ERROR * fabs(slope), (realv)(MCOR_SUM_ROUNDING * fabs(iso)));
    active = active && high - low > MCOR_EDGE_RESOLUTION &&
      (error > (real)0.5 * tolerance || error > near);
    if (i >= limit || !MCOR_ANY(active))
    {
      *missed = merged && error > fmax(near, (realv)tolerance);
      return;
    }
    const realv side = mcor_correct_side(at);
    const fixv before = e->v0 < 0 ? side < 0 : side >= 0;
    low = before ? *t : low;
    high = before ? high : *t;
    realv next = i == 0
      ? mcor_correct_first(e->v0, e->v1, merged ? (realv)0.5 : *t, at->value, slope)
      : mcor_correct_next(*t, at->value, slope, last_t - *t, last_value, last_slope);
    const realv newton = i == 0 ? -mcor_correct_ratio(at->value, slope) : next;
    next = merged ? fmin(fmax(newton, *t - MCOR_COMPACT_STEP), *t + MCOR_COMPACT_STEP) : next;
    last_t = *t;
    last_value = at->value;
    last_slope = slope;
    const bool whole = i < 5 || (i & 1);
    next = (next > low && next < high && whole) ? next : (real)0.5 * (low + high);
    active = active && next != *t;
    *t = active ? next : *t;
    if (MCOR_ANY(*t < reached_low || *t > reached_high))
    {
      reached_low = 0;
      reached_high = 1;
      mcor_compact_bound(grid, lines, reached_low, reached_high, 1, points, query);
      mcor_tile_init(&reach->tile);
    }
  }
}

/* One work-item = one group of vertices. Reads and writes what mcor_correct_vertices does, and
 * reads the starts of merged vertices from `offset`. Writes to `linear` of merged vertices how
 * far they have moved, in cubes, as a number below 0, or 1 if they did not reach the surface. */
__kernel void mcor_compact_vertices(MCOR_GRID_PARAMS, const int group_count,
  __global const int* groups, __global const int4* vertex_edge, __global const real* vertex_ends,
  const real iso, const real tolerance, const int limit, __global real4* offset,
  __global real* linear, __global real* value, __global real4* gradient, __global real* weight,
  __global uchar* evaluations, MCOR_ATTRIBUTE_PARAMS)
{
  MCOR_ITEM(group, group < group_count);
  const mcor_grid grid = MCOR_GRID;
  mcor_points points;
  mcor_query query;
  mcor_reach reach;
  mcor_compact_lines lines;
  mcor_field_at at;
  mcor_compact_load(&grid, groups, group, vertex_edge, vertex_ends, offset, &lines, &points);
  const realv between = clamp(lines.edge.v0 / (lines.edge.v0 - lines.edge.v1),
    (realv)MCOR_EDGE_MARGIN, (realv)(1 - MCOR_EDGE_MARGIN));
  const realv t0 = lines.merged ? (realv)0 : between;
  realv t;
  fixv count, missed;
  mcor_compact_group(
    &grid, &lines, t0, iso, tolerance, limit, &points, &query, &reach, &at, &t, &count, &missed);
  if (attribute_count > 0)
  {
    mcor_attribute_group(&grid, &query, &points, iso, &reach, true, MCOR_ATTRIBUTE_ARGS);
  }
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int v = points.index[lane];
    if (v >= 0)
    {
      mcor_points_store(&grid, &points, &at, lane, v, offset, value, gradient, weight);
      linear[v] =
        MCOR_GET_FIX(missed, lane) && limit > 0 ? (real)1 : MCOR_GET(t0, lane) - MCOR_GET(t, lane);
      evaluations[v] = (uchar)min((int)MCOR_GET_FIX(count, lane), 255);
    }
  }
}
