/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Correction [III-D.2]: the safeguarded Newton iteration along a lattice edge, for MCOR_LANES edges
 * at a time. A vertex that is not on an edge, such as a merged vertex of a compact contour, moves
 * along a line instead: one cube long, in the gradient's direction at the vertex's start. */

/* Returns x / y, or -1 if y is 0. A step of length 1 leaves every bracket (interval that has the
 * root). No kernel makes an infinite value or a NaN, because compilers that relax arithmetic may
 * treat them wrongly. */
realv mcor_correct_ratio(realv x, realv y)
{
  return y != 0 ? x / (y != 0 ? y : (realv)1) : (realv)-1;
}

/* Returns the root d of v + slope d + c2 d^2 + c3 d^3 near 0, by Newton steps. */
realv mcor_correct_root(realv v, realv slope, realv c2, realv c3)
{
  realv d = -mcor_correct_ratio(v, slope);
  for (int i = 0; i < 3; ++i)
  {
    d -= mcor_correct_ratio(
      v + d * (slope + d * (c2 + d * c3)), slope + d * ((real)2 * c2 + d * (real)3 * c3));
  }
  return d;
}

/* Returns the root near t of the cubic that has the given values at 0, 1 and t, and the slope at
 * t. */
realv mcor_correct_first(realv v0, realv v1, realv t, realv v, realv slope)
{
  const realv a = ((v0 - v) / t + slope) / t;                   /* (p(0) - tangent(0)) / t^2 */
  /* (p(1) - tangent(1)) / (1 - t)^2 */
  const realv b = ((v1 - v) / (1 - t) - slope) / ((real)1 - t);
  const realv c3 = b - a, c2 = a + c3 * t;
  return t + mcor_correct_root(v, slope, c2, c3);
}

/* Returns the root near t of the cubic that has the given values and slopes at t and at t + last,
 * the start of the last step. After a short step, or a step from a point where the field has no
 * value, uses only the value and slope at t. */
realv mcor_correct_next(realv t, realv v, realv slope, realv last, realv last_v, realv last_slope)
{
  const fixv two = fabs(last) > (real)1e-3f && fabs(last_v) < (real)1e20f;
  const realv inv = two ? (real)1 / (two ? last : (realv)1) : (realv)0;
  const realv a = ((last_v - v) * inv - slope) * inv; /* c2 + c3 last */
  const realv b = (last_slope - slope) * inv;         /* 2 c2 + 3 c3 last */
  return t + mcor_correct_root(v, slope, (real)3 * a - b, (b - (real)2 * a) * inv);
}

/* Greatest error of a vertex's position along its edge, as a share of the edge. A small difference
 * from the iso value alone is not enough: where the gradient is small, the vertex may still be far
 * from the surface. */
#define MCOR_EDGE_ERROR ((real)2e-5f)

/* The rounding error of a sum, relative to the iso value. MCOR_EDGE_ERROR never demands that a
 * value comes closer to the iso value than this. The rounding error is 0 for a Shepard mean,
 * because the sum of its terms, relative to the iso value, is 0 at the surface. */
#define MCOR_SUM_ROUNDING (MCOR_FIELD == MCOR_SHEPARD ? (real)0 : MCOR_DOUBLE ? (real)1e-15 : (real)5e-7f)

/* A bracket of this length, as a share of the edge, is not halved further. */
#define MCOR_EDGE_RESOLUTION (MCOR_DOUBLE ? (real)1e-15 : (real)1.2e-7f)

/* The edges or lines along which vertices move, one in each lane. (ax, ay, az): the vector from end
 * to end, in cubes. v0, v1: the values at the ends, less the iso value; a line has no v1. Only a
 * line has a start (x, y, z), relative to its node, and `slope`, the field's slope at the start. */
typedef struct
{
  bool lines;
  realv v0, v1, ax, ay, az;
  realv x, y, z, slope;
} mcor_edges;

/* Most vertices are this close to their linear interpolation, as a share of the edge. */
#define MCOR_EDGE_SLACK ((real)0.15f)

/* Most vertices move no further than this on a line, in cubes. */
#define MCOR_LINE_SLACK ((real)0.3f)

/* Loads group number `group` of edges: the lower nodes, and the values at both ends. */
MCOR_ONE_COPY void mcor_edges_load(const mcor_grid* grid, __global const int* groups, int group,
  __global const int4* vertex_edge, __global const real* vertex_ends, mcor_edges* edges,
  mcor_points* points)
{
  int from[MCOR_LANES];
  mcor_points_load(grid, vertex_edge, groups[group], groups[group + 1], points, from);
  edges->lines = false;
  edges->x = edges->y = edges->z = edges->slope = 0;
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int v = from[lane], axis = vertex_edge[v].w & 3;
    MCOR_SET(edges->v0, lane) = vertex_ends[2L * v];
    MCOR_SET(edges->v1, lane) = vertex_ends[2L * v + 1];
    MCOR_SET(edges->ax, lane) = axis == 0 ? grid->edge[0] : (real)0;
    MCOR_SET(edges->ay, lane) = axis == 1 ? grid->edge[1] : (real)0;
    MCOR_SET(edges->az, lane) = axis == 2 ? grid->edge[2] : (real)0;
  }
}

/* Fits the query to the parts of the edges from t = low to t = high. */
void mcor_edges_bound(const mcor_grid* grid, const mcor_edges* e, realv low, realv high,
  mcor_points* points, mcor_query* query)
{
  const realv x0 = low * e->ax, y0 = low * e->ay, z0 = low * e->az;
  const realv x1 = high * e->ax, y1 = high * e->ay, z1 = high * e->az;
  const realv from[3] = { e->x + fmin(x0, x1), e->y + fmin(y0, y1), e->z + fmin(z0, z1) };
  const realv to[3] = { e->x + fmax(x0, x1), e->y + fmax(y0, y1), e->z + fmax(z0, z1) };
  mcor_points_bound(grid, from, to, points, query);
}

realv mcor_edges_slope(const mcor_edges* e, const mcor_field_at* at)
{
  const realv* g = at->field.gradient;
  return g[0] * e->ax + g[1] * e->ay + g[2] * e->az;
}

/* Evaluates the field at the starts of lines, and makes the lines: along the gradient, towards the
 * iso value. */
void mcor_lines_load(const mcor_grid* grid, __global const int* groups, int group,
  __global const int4* node, __global const real4* offset, real iso, mcor_edges* lines,
  mcor_points* points, mcor_query* query, mcor_reach* reach, mcor_field_at* at)
{
  mcor_group_load(
    grid, groups[group], groups[group + 1], node, offset, MCOR_LINE_SLACK, points, query);
  mcor_tile_init(&reach->tile);
  mcor_evaluate(grid, query, reach, points, iso, at);
  const realv* g = at->field.gradient;
  const realv most = fmax(fmax(fabs(g[0]), fabs(g[1])), fabs(g[2]));
  const realv inv = (realv)1 / (most > 0 ? most : (realv)1);
  const realv x = g[0] * inv, y = g[1] * inv, z = g[2] * inv;
  const realv length = mcor_rsqrt(mcor_square(x, y, z));
  const realv scale = at->field.value < 0 ? length : -length;
  lines->lines = true;
  lines->v0 = at->field.value;
  lines->v1 = 0;
  lines->ax = x * scale;
  lines->ay = y * scale;
  lines->az = z * scale;
  lines->x = points->ox;
  lines->y = points->oy;
  lines->z = points->oz;
  lines->slope = mcor_edges_slope(lines, at);
}

/* Returns how far the value at a vertex may be from the iso value. The limit is lower where the
 * slope is small, because there a small difference may mean a long way to the surface. */
realv mcor_correct_near(realv slope, real iso)
{
  return fmax(MCOR_EDGE_ERROR * fabs(slope), (realv)(MCOR_SUM_ROUNDING * fabs(iso)));
}

/* Moves all vertices of a group along their edges, from t0. A vertex stops on the surface, when its
 * bracket is too short to be halved, or after `limit` steps. t0, t: where a vertex starts and where
 * it ends, as shares of the edge. evaluations: the number of evaluations of each vertex. */
void mcor_correct_group(const mcor_grid* grid, const mcor_edges* e, realv t0, real iso,
  real tolerance, int limit, mcor_points* points, mcor_query* query, mcor_reach* reach,
  mcor_field_at* at, realv* t, fixv* evaluations)
{
  realv low = e->lines ? (realv)0 : (realv)MCOR_EDGE_MARGIN, high = 1 - MCOR_EDGE_MARGIN;
  const fixv rising = e->v0 < 0;
  fixv active = low < high;
  realv last_t = 0, last_value = e->v0, last_slope = e->slope;
  realv reached_low = 0, reached_high = MCOR_LINE_SLACK;
  if (!e->lines) /* for lines, mcor_lines_load has gathered already */
  {
    reached_low = fmax(t0 - MCOR_EDGE_SLACK, (realv)0);
    reached_high = fmin(t0 + MCOR_EDGE_SLACK, (realv)1);
    mcor_tile_init(&reach->tile);
    mcor_edges_bound(grid, e, reached_low, reached_high, points, query);
  }
  *t = t0;
  *evaluations = 0;
  for (int i = 0;; ++i)
  {
    points->ox = e->x + *t * e->ax;
    points->oy = e->y + *t * e->ay;
    points->oz = e->z + *t * e->az;
    mcor_evaluate(grid, query, reach, points, iso, at);
    *evaluations += active ? (fixv)1 : (fixv)0;
    const realv slope = mcor_edges_slope(e, at), value = at->field.value, error = fabs(value);
    active = active && high - low > MCOR_EDGE_RESOLUTION &&
      (error > (real)0.5 * tolerance || error > mcor_correct_near(slope, iso));
    if (i >= limit || !MCOR_ANY(active))
    {
      return;
    }
    /* `side` has the sign of S - iso * w, where S / w is the mean and w the weight sum. S - iso * w
     * passes 0 between two nodes of positive weight on different sides of the iso value. Its sign
     * differs from the sign of `value` only beyond a pole of the mean, where a kernel with negative
     * lobes makes the weight negative. */
    const realv side =
      MCOR_FIELD == MCOR_SHEPARD && MCOR_TENSOR ? (at->fluid.value < 0 ? -value : value) : value;
    const fixv before = rising ? side < 0 : side >= 0;
    low = before ? *t : low;
    high = before ? high : *t;
    realv next = i == 0 && !e->lines
      ? mcor_correct_first(e->v0, e->v1, *t, value, slope)
      : mcor_correct_next(*t, value, slope, last_t - *t, last_value, last_slope);
    last_t = *t;
    last_value = value;
    last_slope = slope;
    /* Newton's steps may be tiny if the field has a kink or no slope. So the 7th, 9th, ... step
     * halves the bracket. */
    const bool newton = i < 5 || (i & 1);
    next = (next > low && next < high && newton) ? next : (real)0.5 * (low + high);
    active = active && next != *t;
    *t = active ? next : *t;
    if (MCOR_ANY(*t < reached_low || *t > reached_high))
    {
      reached_low = 0;
      reached_high = 1;
      mcor_edges_bound(grid, e, reached_low, reached_high, points, query);
      mcor_tile_init(&reach->tile);
    }
  }
}

/* One work-item = one group of vertices. Reads lattice edges, and the values at the ends of each
 * edge, less the iso value. With `lines`, reads the starts of lines from `offset` instead. Writes
 * each vertex's offset, value, gradient, trimming weight, number of evaluations and attributes. For
 * a vertex on an edge, `linear` gets (linear position - final position), as a share of the edge.
 * For a vertex on a line, `linear` gets -(final position), in cubes from the start; 1 if the vertex
 * does not reach the surface. limit: most steps of a vertex; with 0, vertices stay at their linear
 * positions or starts, and `linear` is 0. */
__kernel void mcor_correct_vertices(MCOR_GRID_PARAMS, const int group_count,
  __global const int* groups, __global const int4* vertex_edge, __global const real* vertex_ends,
  const int lines, const real iso, const real tolerance, const int limit, __global real4* offset,
  __global real* linear, __global real* value, __global real4* gradient, __global real* weight,
  __global uchar* evaluations, MCOR_ATTRIBUTE_PARAMS)
{
  MCOR_ITEM(group, group < group_count);
  const mcor_grid grid = MCOR_GRID;
  mcor_points points;
  mcor_query query;
  mcor_reach reach;
  mcor_edges edges;
  mcor_field_at at;
  realv linear_t = 0, t;
  fixv count, missed = 0;
  if (lines)
  {
    mcor_lines_load(
      &grid, groups, group, vertex_edge, offset, iso, &edges, &points, &query, &reach, &at);
    t = clamp(-mcor_correct_ratio(edges.v0, edges.slope), (realv)0, (realv)MCOR_LINE_SLACK);
    t = limit > 0 ? t : (realv)0;
  }
  else
  {
    mcor_edges_load(&grid, groups, group, vertex_edge, vertex_ends, &edges, &points);
    t = linear_t = clamp(
      edges.v0 / (edges.v0 - edges.v1), (realv)MCOR_EDGE_MARGIN, (realv)(1 - MCOR_EDGE_MARGIN));
  }
  mcor_correct_group(
    &grid, &edges, t, iso, tolerance, limit, &points, &query, &reach, &at, &t, &count);
  if (lines)
  {
    const realv near = mcor_correct_near(mcor_edges_slope(&edges, &at), iso);
    missed = fabs(at.field.value) > fmax(near, (realv)tolerance);
    missed = limit > 0 ? missed : (fixv)0;
    count += 1;
  }
  mcor_points_store(&grid, &query, &points, iso, &reach, &at, offset, value, gradient, weight,
    MCOR_ATTRIBUTE_ARGS);
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int v = points.index[lane];
    if (v >= 0)
    {
      linear[v] =
        MCOR_GET_FIX(missed, lane) ? (real)1 : MCOR_GET(linear_t, lane) - MCOR_GET(t, lane);
      evaluations[v] = (uchar)min((int)MCOR_GET_FIX(count, lane), 255);
    }
  }
}
