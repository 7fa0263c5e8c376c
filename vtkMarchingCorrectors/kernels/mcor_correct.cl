/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Correction [III-D.2]: evaluation of field and gradient at MCOR_LANES points at a time, and the
 * safeguarded Newton iteration along a lattice edge. */

/* Points: lattice node plus offset in cubes. */
typedef struct
{
  fixv x, y, z;
  realv ox, oy, oz;
} mcor_points;

/* Field minus iso value, its gradient, and the trimming weight with its gradient; per cube. */
typedef struct
{
  realv value, gx, gy, gz;
  realv weight, wx, wy, wz;
} mcor_field_at;

bool mcor_same_brick(int4 a, int4 b)
{
  return a.x >> 2 == b.x >> 2 && a.y >> 2 == b.y >> 2 && a.z >> 2 == b.z >> 2;
}

/* Points that are evaluated together should lie close together, as then fewer particles reach them:
 * a group is up to MCOR_LANES successive points of one brick. */
#define MCOR_GROUP_CHUNK 64

/* One work-item = MCOR_GROUP_CHUNK points, of `count` from `first`. Writes 1 where a group starts. */
__kernel void mcor_group_count(
  const int first, const int count, __global const int4* all_nodes, __global int* flags)
{
  __global const int4* node = all_nodes + first;
  const int begin = get_global_id(0) * MCOR_GROUP_CHUNK;
  int before = 0; /* points of the same brick just before this one */
  for (int i = begin; i < min(begin + MCOR_GROUP_CHUNK, count); ++i)
  {
    if (i == begin)
    {
      while (before < i && mcor_same_brick(node[i - before - 1], node[i]))
      {
        ++before;
      }
    }
    else
    {
      before = mcor_same_brick(node[i - 1], node[i]) ? before + 1 : 0;
    }
    flags[i] = before % MCOR_LANES == 0;
  }
}

/* One work-item = one point. Reads the scanned flags. Writes where each group starts; the last entry
 * is the end. */
__kernel void mcor_group_fill(
  const int first, const int count, __global const int* scanned, __global int* groups)
{
  const int i = get_global_id(0);
  if (i < count && scanned[i] != scanned[i + 1])
  {
    groups[scanned[i]] = first + i;
  }
  if (i == count)
  {
    groups[scanned[count]] = first + count;
  }
}

/* Loads the nodes of points begin.. (the last one repeated beyond `end`) and fits the query. */
void mcor_points_load(__global const int4* node, int begin, int end, int fix_bits,
  mcor_points* points, mcor_query* query, int* bits)
{
  fix n[3][MCOR_LANES];
  int low[3] = { INT_MAX, INT_MAX, INT_MAX }, high[3] = { INT_MIN, INT_MIN, INT_MIN };
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int4 p = node[min(begin + lane, end - 1)];
    const int c[3] = { p.x, p.y, p.z };
    for (int a = 0; a < 3; ++a)
    {
      n[a][lane] = (fix)c[a] << fix_bits;
      low[a] = min(low[a], c[a]);
      high[a] = max(high[a], c[a]);
    }
    bits[lane] = p.w;
  }
#if MCOR_LANES == 1
  points->x = n[0][0];
  points->y = n[1][0];
  points->z = n[2][0];
#else
  points->x = MCOR_CAT(vload, MCOR_LANES)(0, n[0]);
  points->y = MCOR_CAT(vload, MCOR_LANES)(0, n[1]);
  points->z = MCOR_CAT(vload, MCOR_LANES)(0, n[2]);
#endif
  query->radius = -1;
  for (int a = 0; a < 3; ++a)
  {
    query->low[a] = (fix)low[a] << fix_bits;
    query->high[a] = (fix)high[a] << fix_bits;
  }
}

/* Extends the query from the nodes to all points with offsets in [low, high]. */
void mcor_points_extend(mcor_query* query, int axis, real low, real high, int fix_bits)
{
  query->low[axis] += (fix)floor(ldexp(low, fix_bits)) - 1;
  query->high[axis] += (fix)ceil(ldexp(high, fix_bits)) + 1;
}

/* Loads the offsets of the same points, and extends the query by them and by `margin` more. */
void mcor_points_load_offsets(__global const real4* offset, int begin, int end, real margin,
  int fix_bits, mcor_points* points, mcor_query* query)
{
  real4 low = (real4)INFINITY, high = (real4)-INFINITY;
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const real4 o = offset[min(begin + lane, end - 1)];
    MCOR_SET(points->ox, lane) = o.x;
    MCOR_SET(points->oy, lane) = o.y;
    MCOR_SET(points->oz, lane) = o.z;
    low = fmin(low, o);
    high = fmax(high, o);
  }
  mcor_points_extend(query, 0, low.x - margin, high.x + margin, fix_bits);
  mcor_points_extend(query, 1, low.y - margin, high.y + margin, fix_bits);
  mcor_points_extend(query, 2, low.z - margin, high.z + margin, fix_bits);
}

/* Loads group number `group` of points and their offsets, and fits the query to them, `margin` added.
 * Returns the number of points; they begin at *begin. */
int mcor_group_load(__global const int* groups, int group, __global const int4* node,
  __global const real4* offset, real margin, int fix_bits, int* begin, mcor_points* points,
  mcor_query* query)
{
  int unused[MCOR_LANES];
  const int end = groups[group + 1];
  *begin = groups[group];
  mcor_points_load(node, *begin, end, fix_bits, points, query, unused);
  mcor_points_load_offsets(offset, *begin, end, margin, fix_bits, points, query);
  return end - *begin;
}

/* The points' nodes from the query's low corner, as particles are in a tile. */
void mcor_points_relative(
  const mcor_grid* grid, const mcor_query* query, const mcor_points* points, realv at[3])
{
  at[0] = MCOR_CONVERT_REALV(points->x - query->low[0]) * grid->unit;
  at[1] = MCOR_CONVERT_REALV(points->y - query->low[1]) * grid->unit;
  at[2] = MCOR_CONVERT_REALV(points->z - query->low[2]) * grid->unit;
}

/* Where the points are from particle i of the tile; `at` is of mcor_points_relative. */
void mcor_points_from(
  const realv at[3], const mcor_points* points, const mcor_tile* tile, int i, realv d[3])
{
  d[0] = (at[0] - tile->x[i]) + points->ox;
  d[1] = (at[1] - tile->y[i]) + points->oy;
  d[2] = (at[2] - tile->z[i]) + points->oz;
}

/* Evaluates at all points. iso: relative to A0 for the Shepard mean. */
void mcor_evaluate(const mcor_grid* grid, mcor_query* query, mcor_tile* tile,
  const mcor_points* points, real iso, mcor_field_at* at)
{
  realv s = 0, sx = 0, sy = 0, sz = 0, w = 0, wx = 0, wy = 0, wz = 0;
#if MCOR_SOLIDS
  realv t = 0, tx = 0, ty = 0, tz = 0;
#endif
  realv at_node[3], d[3], gx, gy, gz;
  mcor_points_relative(grid, query, points, at_node);
  for (bool first = true; mcor_tile_next(grid, query, tile, first); first = false)
  {
    for (int i = 0; i < tile->count; ++i)
    {
      mcor_points_from(at_node, points, tile, i, d);
      const realv k = mcor_weight_gradient(d[0], d[1], d[2], tile->inv_h[i], &gx, &gy, &gz);
      const real m = tile->weight[i];
#if MCOR_FIELD == 0
      const real c = m * (tile->value[i] - iso);
#elif MCOR_FIELD == 1
      const real c = m * tile->value[i];
#endif
#if MCOR_FIELD != 2
      s += c * k;
      sx += c * gx;
      sy += c * gy;
      sz += c * gz;
#endif
      w += m * k;
      wx += m * gx;
      wy += m * gy;
      wz += m * gz;
#if MCOR_SOLIDS
      const real mt = tile->trim_weight[i];
      t += mt * k;
      tx += mt * gx;
      ty += mt * gy;
      tz += mt * gz;
#endif
    }
  }
#if MCOR_FIELD == 0
  /* In a void between fluid particles, which solids keep valid, there is no value: a huge one makes
   * the iteration look for the void's border. */
  const fixv none = fabs(w) < (real)1e-12f;
  const realv inv_w = (real)1 / (none ? (realv)1 : w);
  at->value = none ? (realv)1e30f : s * inv_w;
  at->gx = (sx - at->value * wx) * inv_w;
  at->gy = (sy - at->value * wy) * inv_w;
  at->gz = (sz - at->value * wz) * inv_w;
#elif MCOR_FIELD == 1
  at->value = s - iso;
  at->gx = sx;
  at->gy = sy;
  at->gz = sz;
#else
  at->value = w - iso;
  at->gx = wx;
  at->gy = wy;
  at->gz = wz;
#endif
#if MCOR_SOLIDS
  at->weight = t;
  at->wx = tx;
  at->wy = ty;
  at->wz = tz;
#else
  at->weight = w;
  at->wx = wx;
  at->wy = wy;
  at->wz = wz;
#endif
}

/* x / y, or -1 (outside of every bracket) where y is 0. No kernel makes an infinite value or a NaN,
 * as compilers that relax arithmetic need not honour them. */
realv mcor_correct_ratio(realv x, realv y)
{
  return y != 0 ? x / (y != 0 ? y : (realv)1) : (realv)-1;
}

/* Root of the cubic through the values at 0, 1 and t and the slope at t: near t, by Newton steps. */
realv mcor_correct_cubic(realv v0, realv v1, realv t, realv v, realv slope)
{
  const realv a = ((v0 - v) / t + slope) / t;                      /* (p(0) - tangent) / t^2 */
  const realv b = ((v1 - v) / (1 - t) - slope) / ((real)1 - t);    /* the same at 1 */
  const realv c3 = b - a, c2 = a + c3 * t;
  realv d = -mcor_correct_ratio(v, slope);
  for (int i = 0; i < 3; ++i)
  {
    d -= mcor_correct_ratio(v + d * (slope + d * (c2 + d * c3)),
      slope + d * ((real)2 * c2 + d * (real)3 * c3));
  }
  return t + d;
}

/* Writes point v = lane `lane` of a group: position, value, gradient and trimming weight. */
void mcor_points_store(const mcor_points* points, const mcor_field_at* at, int lane, int v,
  __global real4* offset, __global real* value, __global real4* gradient, __global real* weight)
{
  offset[v] = (real4)(
    MCOR_GET(points->ox, lane), MCOR_GET(points->oy, lane), MCOR_GET(points->oz, lane), 0);
  value[v] = MCOR_GET(at->value, lane);
  gradient[v] =
    (real4)(MCOR_GET(at->gx, lane), MCOR_GET(at->gy, lane), MCOR_GET(at->gz, lane), 0);
  weight[v] = MCOR_GET(at->weight, lane);
}

/* A vertex keeps this distance from the ends of its edge, so that vertices of edges which meet in a
 * node at the iso value stay apart and no triangle loses its area. */
#define MCOR_EDGE_MARGIN (MCOR_DOUBLE ? (real)1e-9 : (real)3.8e-6f)

/* Where the gradient is small, a small residual alone may be far from the surface: along the edge, a
 * vertex is also to come this close. */
#define MCOR_EDGE_ERROR ((real)2e-5f)

/* A bracket of this length is not halved any more. */
#define MCOR_EDGE_RESOLUTION (MCOR_DOUBLE ? (real)1e-15 : (real)1.2e-7f)

/* Edges: values at both ends, against iso, and unit vectors along the edges. */
typedef struct
{
  realv v0, v1, ax, ay, az;
} mcor_edges;

/* Loads the ends of a group's edges, and extends the query from their lower nodes to all of them. */
void mcor_edges_load(__global const real* vertex_ends, int begin, int end, const int* axis_of,
  int fix_bits, mcor_edges* edges, mcor_query* query)
{
  int axes = 0;
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int v = min(begin + lane, end - 1), axis = axis_of[lane] & 3;
    MCOR_SET(edges->v0, lane) = vertex_ends[2 * v];
    MCOR_SET(edges->v1, lane) = vertex_ends[2 * v + 1];
    MCOR_SET(edges->ax, lane) = axis == 0;
    MCOR_SET(edges->ay, lane) = axis == 1;
    MCOR_SET(edges->az, lane) = axis == 2;
    axes |= 1 << axis;
  }
  for (int a = 0; a < 3; ++a)
  {
    mcor_points_extend(query, a, 0, (real)(axes >> a & 1), fix_bits);
  }
}

/* Moves all vertices of a group along their edges, from t0, until each is on the surface or `limit`
 * steps were made. `evaluations` counts how many each needed. */
void mcor_correct_group(const mcor_grid* grid, mcor_query* query, const mcor_edges* e, realv t0,
  real iso, real tolerance, int limit, mcor_points* points, mcor_field_at* at, realv* t,
  fixv* evaluations)
{
  realv low = MCOR_EDGE_MARGIN, high = 1 - MCOR_EDGE_MARGIN;
  const fixv rising = e->v0 < 0;
  fixv active = low < high;
  mcor_tile tile;
  mcor_tile_init(&tile);
  *t = t0;
  *evaluations = 0;
  for (int i = 0;; ++i)
  {
    points->ox = *t * e->ax;
    points->oy = *t * e->ay;
    points->oz = *t * e->az;
    mcor_evaluate(grid, query, &tile, points, iso, at);
    *evaluations += active ? (fixv)1 : (fixv)0;
    const realv slope = at->gx * e->ax + at->gy * e->ay + at->gz * e->az;
    const realv error = fabs(at->value);
    active = active && high - low > MCOR_EDGE_RESOLUTION &&
      (error > (real)0.5 * tolerance || error > MCOR_EDGE_ERROR * fabs(slope));
    if (i >= limit || !MCOR_ANY(active))
    {
      return;
    }
    const fixv before = rising ? at->value < 0 : at->value >= 0;
    low = before ? *t : low;
    high = before ? high : *t;
    realv next = i == 0 ? mcor_correct_cubic(e->v0, e->v1, *t, at->value, slope)
                        : *t - mcor_correct_ratio(at->value, slope);
    /* Newton may creep where the field has a kink or no slope: from the 6th step on every other
     * step halves the bracket. */
    const bool newton = i < 5 || (i & 1);
    next = (next > low && next < high && newton) ? next : (real)0.5 * (low + high);
    active = active && next != *t;
    *t = active ? next : *t;
  }
}

/* One work-item = one group of vertices. Reads edges and end values (against iso). Writes position
 * (node, offset), linear less final position along the edge, value, gradient and trimming weight,
 * and how many evaluations were made. limit 0: no correction (preview). */
__kernel void mcor_correct_vertices(MCOR_GRID_PARAMS, const int group_count,
  __global const int* groups, __global const int4* vertex_edge,
  __global const real* vertex_ends, const real iso, const real tolerance, const int limit,
  __global real4* offset, __global real* linear, __global real* value, __global real4* gradient,
  __global real* weight, __global uchar* evaluations)
{
  const int group = get_global_id(0);
  if (group >= group_count)
  {
    return;
  }
  const int begin = groups[group], end = groups[group + 1];
  const mcor_grid grid = MCOR_GRID;
  mcor_points points;
  mcor_query query;
  mcor_edges edges;
  mcor_field_at at;
  int axis_of[MCOR_LANES];
  mcor_points_load(vertex_edge, begin, end, fix_bits, &points, &query, axis_of);
  mcor_edges_load(vertex_ends, begin, end, axis_of, fix_bits, &edges, &query);
  const realv t0 = clamp(
    edges.v0 / (edges.v0 - edges.v1), (realv)MCOR_EDGE_MARGIN, (realv)(1 - MCOR_EDGE_MARGIN));
  realv t;
  fixv count;
  mcor_correct_group(
    &grid, &query, &edges, t0, iso, tolerance, limit, &points, &at, &t, &count);
  for (int lane = 0; begin + lane < end; ++lane)
  {
    const int v = begin + lane;
    mcor_points_store(&points, &at, lane, v, offset, value, gradient, weight);
    linear[v] = MCOR_GET(t0, lane) - MCOR_GET(t, lane);
    evaluations[v] = (uchar)min((int)MCOR_GET_FIX(count, lane), 255);
  }
}
