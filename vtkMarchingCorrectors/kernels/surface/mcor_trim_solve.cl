/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Trimming [III-D.3]: the number that decides whether a vertex is trimmed, and the places of cut
 * vertices. Cut vertices move from linear cuts to where the field equals the iso value and this
 * number equals its limit. */

/* A vertex has a Shepard mean only if the weight of the fluid alone is above this. */
#define MCOR_LEAST_FLUID ((real)MCOR_LEAST_VERTEX_WEIGHT(MCOR_TENSOR))

/* Returns the fluid's own weight at vertex v. */
real mcor_trim_fluid(__global const real* weight, __global const real4* gradient, int v)
{
  return MCOR_SOLIDS ? gradient[v].w : weight[v];
}

/* One work-item = one vertex. Writes the number that decides whether the vertex is trimmed: the
 * vertex is inside if this number is above a limit. If fluid_share <= 0, the number is `quantity`
 * and the limit is `threshold`. Else the limit is 0, and the number depends on the field: for the
 * weight sum, it is `share`, the fluid's own weight minus fluid_share * weight; for other fields,
 * the smaller of `share` and quantity - threshold. A vertex without a mean gets at most the limit,
 * and so is outside. */
__kernel void mcor_trim_margin(const int count, __global const real* quantity, const real threshold,
  __global const real* weight, __global const real4* gradient, const real fluid_share,
  __global real* margin)
{
  MCOR_ITEM(i, i < count);
  const real share = gradient[i].w - fluid_share * weight[i];
  real m = fluid_share <= 0 ? quantity[i]
    : MCOR_FIELD == MCOR_WEIGHT_SUM       ? share
                            : fmin(quantity[i] - threshold, share);
  if (MCOR_FIELD == MCOR_SHEPARD && !(mcor_trim_fluid(weight, gradient, i) > MCOR_LEAST_FLUID))
  {
    m = fmin(m, fluid_share > 0 ? (real)0 : threshold);
  }
  margin[i] = m;
}

/* A quantity is linear along an edge: wa at one end, wb at the other. Returns where the quantity
 * equals w, as a share of the edge, at least MCOR_EDGE_MARGIN away from both ends. */
real mcor_trim_fraction(real wa, real wb, real w)
{
  return clamp((w - wa) / (wb - wa), MCOR_EDGE_MARGIN, 1 - MCOR_EDGE_MARGIN);
}

/* One work-item = one cut vertex. Writes the vertex's position, as the nearer end's node and an
 * offset. trimmed_by: the number that decides whether a vertex is trimmed. It and the fluid's own
 * weight are taken as linear along the mesh edge, from its inner end (the one that is not trimmed)
 * to its other end. The position is the first place where trimmed_by sinks to the threshold or, for
 * a Shepard mean, the fluid's own weight sinks to MCOR_LEAST_FLUID. The position stays away from
 * the ends, because cut vertices of several edges would meet at an end. The position's bits do not
 * depend on the order of vertices. In place of the gradient, writes the vector from the vertex to
 * the inner end, and as fourth number whether the fluid's own weight decided the position. */
__kernel void mcor_trim_linear(const int cut_count, __global const ulong* keys,
  const int vertex_count, const real threshold, __global int4* node, __global real4* offset,
  __global const real* trimmed_by, __global const real* weight, __global real4* gradient)
{
  MCOR_ITEM(i, i < cut_count);
  const int low = (int)(keys[i] >> 32), high = (int)(keys[i] & 0xffffffffUL);
  const bool is_inside = trimmed_by[low] > threshold;
  const int a = is_inside ? low : high, b = is_inside ? high : low;
  real s = mcor_trim_fraction(trimmed_by[a], trimmed_by[b], threshold);
  bool lacks = false;
#if MCOR_FIELD == MCOR_SHEPARD
  const real fa = mcor_trim_fluid(weight, gradient, a), fb = mcor_trim_fluid(weight, gradient, b);
  if (!(fmin(fa, fb) > MCOR_LEAST_FLUID))
  {
    const real t = mcor_trim_fraction(fa, fb, MCOR_LEAST_FLUID);
    lacks = t < s;
    s = lacks ? t : s;
  }
#endif
  /* Lengths are in cells of the lower of the ends' levels, which is the level of vertex `low`. */
  const int level = node[low].w >> MCOR_LEVEL_SHIFT;
  const int up = (node[a].w >> MCOR_LEVEL_SHIFT) - level;
  const int up_b = (node[b].w >> MCOR_LEVEL_SHIFT) - level;
  const int4 n = node[a] << up, m = node[b] << up_b, d = m - n;
  const real4 from = offset[a] * (real)(1 << up), to = offset[b] * (real)(1 << up_b);
  const real4 along = to + (real4)(d.x, d.y, d.z, 0) - from;
  const bool is_near = s <= (real)0.5f; /* from the nearer end, so cuts near it stay apart */
  const int4 begin = is_near ? n : m;
  node[vertex_count + i] = (int4)(begin.x, begin.y, begin.z, level << MCOR_LEVEL_SHIFT);
  offset[vertex_count + i] = is_near ? from + s * along : to - ((real)1 - s) * along;
  gradient[vertex_count + i] = (real4)(-s * along.x, -s * along.y, -s * along.z, lacks);
}

/* How far a cut vertex may move, in cubes. REACH: from its linear cut along each axis. STEP: in one
 * iteration. */
#define MCOR_TRIM_REACH ((real)0.75)
#define MCOR_TRIM_STEP ((real)0.25)

/* A vertex takes at most this many steps back to where the Shepard mean exists. Each step goes half
 * of the remaining way to the edge's end, or to MCOR_TRIM_REACH if the end is farther. No step goes
 * to the end itself, where cuts of several edges would meet. */
#define MCOR_TRIM_RETREATS 12

/* Greatest |weight - threshold| of a cut vertex. */
#define MCOR_TRIM_TOLERANCE ((real)1e-5f)

/* Limits of trimming. threshold: the least weight, or the least boundary eigenvalue. fluid_share:
 * the fluid's least share of the weight; 0: no such limit. lacking: lanes in which the fluid's own
 * weight may be too low for a mean. steps: a cut vertex moves at most this often. tolerance: the
 * greatest |field - iso| of a cut vertex. */
typedef struct
{
  real iso, tolerance, threshold, fluid_share;
  int steps;
  bool by_eigenvalue, plane;
  fixv lacking;
  realv inside[3]; /* from the linear cut to the edge's end that is inside */
} mcor_trim_limits;

/* Replaces a quantity by another one in some lanes. */
void mcor_quantity_choose(fixv lanes, const mcor_quantity* other, mcor_quantity* q)
{
  q->value = lanes ? other->value : q->value;
  for (int a = 0; a < 3; ++a)
  {
    q->gradient[a] = lanes ? other->gradient[a] : q->gradient[a];
  }
}

/* A point exceeds each limit of trimming by some excess, which may be negative. Finds the least
 * excess of each point, and the gradient of this excess. at: what mcor_evaluate has found at these
 * points. The fluid's own weight is a limit only in the lanes `lacking`. For a weight sum with a
 * fluid_share above 0, the fluid's share is the only limit. */
void mcor_trim_bound(const mcor_grid* grid, mcor_query* query, mcor_reach* reach,
  const mcor_points* points, const mcor_field_at* at, const mcor_trim_limits* limits,
  mcor_quantity* bound)
{
  *bound = at->weight;
  if (limits->by_eigenvalue)
  {
    mcor_evaluate_boundary(grid, query, &reach->tile, points, limits->plane, true, bound);
  }
  bound->value -= limits->threshold;
  mcor_quantity fluid = at->fluid, share = fluid;
  if (MCOR_SOLIDS && limits->fluid_share > 0)
  {
    share.value -= limits->fluid_share * at->weight.value;
    for (int a = 0; a < 3; ++a)
    {
      share.gradient[a] -= limits->fluid_share * at->weight.gradient[a];
    }
    mcor_quantity_choose(
      MCOR_FIELD == MCOR_WEIGHT_SUM ? (fixv)MCOR_TRUE : share.value < bound->value, &share, bound);
  }
  fluid.value -= MCOR_LEAST_FLUID;
  if (MCOR_FIELD == MCOR_SHEPARD)
  {
    mcor_quantity_choose(limits->lacking && fluid.value < bound->value, &fluid, bound);
  }
}

/* Divides a quantity and its gradient by the gradient's length. Returns the lanes without a
 * gradient. */
fixv mcor_trim_normalize(mcor_quantity* q)
{
  realv* gradient = q->gradient;
  const realv most = fmax(fabs(gradient[0]), fmax(fabs(gradient[1]), fabs(gradient[2])));
  const fixv none = most < (MCOR_DOUBLE ? (real)1e-300 : (real)1e-36f);
  const realv inv_most = (real)1 / (none ? (realv)1 : most);
  realv length2 = 0;
  for (int a = 0; a < 3; ++a)
  {
    gradient[a] *= inv_most;
    length2 += gradient[a] * gradient[a];
  }
  const realv inv = none ? (realv)0 : mcor_rsqrt(fmax(length2, (realv)1));
  for (int a = 0; a < 3; ++a)
  {
    gradient[a] *= inv;
  }
  q->value *= inv_most * inv;
  return none;
}

/* Finds Newton's step of least norm towards the place where field = iso and weight = threshold. It
 * is -J^T (J J^T)^-1 (f, w), shortened to MCOR_TRIM_STEP if it is longer; the rows of J are the
 * gradients of f and w. Returns the lanes that have no step, because a gradient is 0, or the two
 * gradients are parallel. */
fixv mcor_trim_step(mcor_quantity f, mcor_quantity w, realv d[3])
{
  const fixv flat = mcor_trim_normalize(&f) || mcor_trim_normalize(&w);
  const realv *gf = f.gradient, *gw = w.gradient;
  const realv fw = gf[0] * gw[0] + gf[1] * gw[1] + gf[2] * gw[2];
  const realv det = (real)1 - fw * fw;
  const fixv tangent = flat || det <= (real)1e-6f;
  const realv inv_det = (real)1 / (tangent ? (realv)1 : det);
  const realv lf = (fw * w.value - f.value) * inv_det, lw = (fw * f.value - w.value) * inv_det;
  for (int a = 0; a < 3; ++a)
  {
    d[a] = lf * gf[a] + lw * gw[a];
  }
  const realv length2 = fmax(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], (realv)1e-30f);
  const realv damp = fmin(MCOR_TRIM_STEP * mcor_rsqrt(length2), (realv)1);
  for (int a = 0; a < 3; ++a)
  {
    d[a] *= damp;
  }
  return tangent;
}

/* Some points have no Shepard mean at their linear cut. Moves these points towards the inner end of
 * their edge (the end that is not trimmed), until they have a mean. linear: the points that may
 * move. Returns which points were moved. */
fixv mcor_trim_retreat(const mcor_grid* grid, mcor_query* query, const mcor_trim_limits* limits,
  fixv linear, mcor_points* points, mcor_reach* reach, mcor_field_at* at)
{
  const realv* inside = limits->inside;
  const realv x0 = points->ox, y0 = points->oy, z0 = points->oz;
  const realv most = fmax(fabs(inside[0]), fmax(fabs(inside[1]), fabs(inside[2])));
  const realv scale = MCOR_TRIM_REACH / fmax(most, (realv)MCOR_TRIM_REACH);
  real share = 1;
  fixv moved = 0;
  for (int i = 0; i < MCOR_TRIM_RETREATS; ++i)
  {
    const fixv move = linear && at->fluid.value <= MCOR_LEAST_FLUID;
    if (!MCOR_ANY(move))
    {
      break;
    }
    share *= (real)0.5;
    points->ox = move ? x0 + (1 - share) * scale * inside[0] : points->ox;
    points->oy = move ? y0 + (1 - share) * scale * inside[1] : points->oy;
    points->oz = move ? z0 + (1 - share) * scale * inside[2] : points->oz;
    moved = moved || move;
    mcor_evaluate(grid, query, reach, points, limits->iso, at);
  }
  return moved;
}

/* Moves points of a group (those in `sought`) to where field = iso and weight = threshold. Returns
 * the points for which this fails near `start`; their positions are then arbitrary. */
fixv mcor_trim_seek(const mcor_grid* grid, mcor_query* query, mcor_trim_limits* limits,
  const realv start[3], fixv sought, mcor_points* points, mcor_reach* reach, mcor_field_at* at)
{
  mcor_quantity bound;
  fixv done = !sought, failed = 0;
  for (int i = 0;; ++i)
  {
    mcor_evaluate(grid, query, reach, points, limits->iso, at);
    mcor_trim_bound(grid, query, reach, points, at, limits, &bound);
    const fixv met =
      fabs(at->field.value) <= limits->tolerance && fabs(bound.value) <= MCOR_TRIM_TOLERANCE;
    /* The fluid's own weight may be too low for a mean, though the weight equals the threshold. */
    const fixv lacks =
      MCOR_FIELD == MCOR_SHEPARD && met && at->fluid.value < MCOR_LEAST_FLUID - MCOR_TRIM_TOLERANCE;
    limits->lacking = limits->lacking || lacks;
    done = done || (met && !lacks);
    if (i == limits->steps || !MCOR_ANY(!(done || failed)))
    {
      return !done;
    }
    realv d[3];
    const fixv tangent = mcor_trim_step(at->field, bound, d);
    const fixv far = fabs(points->ox + d[0] - start[0]) > MCOR_TRIM_REACH ||
      fabs(points->oy + d[1] - start[1]) > MCOR_TRIM_REACH ||
      fabs(points->oz + d[2] - start[2]) > MCOR_TRIM_REACH;
    failed = failed || (!done && (far || tangent));
    const fixv move = !(done || failed);
    points->ox += move ? d[0] : (realv)0;
    points->oy += move ? d[1] : (realv)0;
    points->oz += move ? d[2] : (realv)0;
  }
}

/* Moves the points of `back` to `start`, and evaluates the group again. */
void mcor_trim_return(const mcor_grid* grid, mcor_query* query, real iso, const realv start[3],
  fixv back, mcor_points* points, mcor_reach* reach, mcor_field_at* at)
{
  points->ox = back ? start[0] : points->ox;
  points->oy = back ? start[1] : points->oy;
  points->oz = back ? start[2] : points->oz;
  mcor_evaluate(grid, query, reach, points, iso, at);
}

/* Moves a group of points to where field = iso and weight = threshold. If this fails near a point's
 * start, the point goes back to the start. If the start has no Shepard mean, the weight is nearly
 * 0, and the field has no slope to follow: then the point moves to where the mean exists, and the
 * search begins once more from there. Returns the points that failed in the end. */
fixv mcor_trim_group(const mcor_grid* grid, mcor_query* query, mcor_trim_limits* limits,
  mcor_points* points, mcor_reach* reach, mcor_field_at* at)
{
  const realv start[3] = { points->ox, points->oy, points->oz };
  fixv linear = mcor_trim_seek(grid, query, limits, start, (fixv)MCOR_TRUE, points, reach, at);
  if (!MCOR_ANY(linear))
  {
    return linear;
  }
  mcor_trim_return(grid, query, limits->iso, start, linear, points, reach, at);
  if (MCOR_FIELD != MCOR_SHEPARD || limits->steps == 0) /* 0: in a preview */
  {
    return linear;
  }
  const fixv moved = mcor_trim_retreat(grid, query, limits, linear, points, reach, at);
  if (MCOR_ANY(moved))
  {
    const realv mean[3] = { points->ox, points->oy, points->oz };
    const fixv lost = mcor_trim_seek(grid, query, limits, start, moved, points, reach, at);
    mcor_trim_return(grid, query, limits->iso, mean, lost, points, reach, at);
    linear = lost || (linear && !moved);
  }
  return linear;
}

/* One work-item = one group of cut vertices at their linear cuts. Moves them to where field = iso
 * and weight = threshold. Writes position, value, gradient, weight and attributes. Writes the flag
 * 1, or 2 if the search fails: the surfaces field = iso and weight = threshold are tangent, too far
 * away or not reached after `steps` steps, or a gradient is 0. */
__kernel void mcor_trim_solve(MCOR_GROUP_PARAMS, const real iso, const real tolerance,
  const real threshold, const real fluid_share, const int by_eigenvalue, const int steps,
  const int plane, __global real4* offset, __global real* value, __global real4* gradient,
  __global real* weight, __global uchar* flag, MCOR_ATTRIBUTE_PARAMS)
{
  MCOR_GROUP_ITEM(MCOR_TRIM_REACH);
  mcor_trim_limits limits = { iso, tolerance, threshold, fluid_share, steps, by_eigenvalue, plane };
  mcor_field_at at;
  realv lacks = 0;
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int v = points.index[lane];
    const real4 along = v >= 0 ? gradient[v] : (real4)(0, 0, 0, 0);
    MCOR_SET(limits.inside[0], lane) = along.x * grid.edge[0];
    MCOR_SET(limits.inside[1], lane) = along.y * grid.edge[1];
    MCOR_SET(limits.inside[2], lane) = along.z * grid.edge[2];
    MCOR_SET(lacks, lane) = along.w;
  }
  limits.lacking = lacks != 0;
  const fixv linear = mcor_trim_group(&grid, &query, &limits, &points, &reach, &at);
  mcor_points_store(&grid, &query, &points, iso, &reach, &at, offset, value, gradient, weight,
    MCOR_ATTRIBUTE_ARGS);
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int v = points.index[lane];
    if (v >= 0)
    {
      flag[v] = MCOR_GET_FIX(linear, lane) ? 2 : 1;
    }
  }
}
