/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sums at many points, in the form for CPUs; see mcor_probe.cl. Points of a slice or a volume are
 * so close together that most particles that reach one group also reach the next groups. Such
 * groups form a cluster, which shares one tile of particles. */

typedef struct
{
  int count; /* groups */
  mcor_points points[MCOR_CLUSTER];
  realv weight[MCOR_CLUSTER], sums[MCOR_CLUSTER][MCOR_ATTRIBUTE_LIMIT];
} mcor_cluster;

/* Whether the parts of a group are so close together that packing their lists of particles takes
 * longer than reading the whole tile. The limit was measured at planes of points. */
#define MCOR_TILE_SHARE 0.8f
bool mcor_reach_is_tile(const mcor_grid* grid, const mcor_query* query, const mcor_points* points)
{
  real rest = 0;
  for (int a = 0; a < 3; ++a)
  {
    real most = points->part[0].half_size[a];
    for (int part = 1; part < MCOR_PARTS; ++part)
    {
      most = fmax(most, points->part[part].half_size[a]);
    }
    rest += query->box.half_size[a] - most;
  }
  return rest < MCOR_TILE_SHARE * grid->levels[0].support;
}

/* Returns how many of the groups begin, begin + 1, ..., end - 1 fit into one cluster: at least 1.
 * Fits the query to the box around the points of these groups. The query's origin is a node in the
 * middle of the box. */
int mcor_cluster_bound(const mcor_grid* grid, __global const int* groups, int begin, int end,
  __global const int4* node, __global const real4* offset, mcor_query* query)
{
  const real4 edge = (real4)(grid->edge[0], grid->edge[1], grid->edge[2], 0);
  const int4 base = node[groups[begin]];
  int4 low = base, high = base;
  real4 least = offset[groups[begin]] * edge, most = least; /* in cubes from the first node */
  int g = begin;
  for (; g < end; ++g)
  {
    int4 group_low = low, group_high = high;
    real4 group_least = least, group_most = most;
    for (int i = groups[g]; i < groups[g + 1]; ++i)
    {
      const real4 at =
        (MCOR_CAT(convert_, MCOR_CAT(MCOR_REAL_NAME, 4))(node[i] - base) + offset[i]) * edge;
      group_low = min(group_low, node[i]);
      group_high = max(group_high, node[i]);
      group_least = fmin(group_least, at);
      group_most = fmax(group_most, at);
    }
    if (g > begin && !mcor_group_fits(group_high - group_low))
    {
      break;
    }
    low = group_low;
    high = group_high;
    least = group_least;
    most = group_most;
  }
  const int at[3] = { base.x, base.y, base.z };
  fix origin[3];
  query->radius = -1;
  for (int a = 0; a < 3; ++a)
  {
    const fix first = (fix)at[a] * grid->step[a];
    const real from = MCOR_GET(least, a), to = MCOR_GET(most, a);
    origin[a] = first + (fix)floor((real)0.5 * (from + to) / grid->edge[a]) * grid->step[a];
    query->low[a] = first + (fix)floor(from * grid->units) - 1;
    query->high[a] = first + (fix)ceil(to * grid->units) + 1;
  }
  mcor_query_place(grid, query, origin);
  return g - begin;
}

/* Sets a box's range along an axis to the range of the lanes of v. */
void mcor_lane_range(realv v, int axis, mcor_span* box)
{
#if MCOR_LANES == 16
  const mcor_real8 low8 = fmin(v.lo, v.hi), high8 = fmax(v.lo, v.hi);
#else
  const mcor_real8 low8 = v, high8 = v;
#endif
  const real4 low4 = fmin(low8.lo, low8.hi), high4 = fmax(high8.lo, high8.hi);
  const real2 low2 = fmin(low4.lo, low4.hi), high2 = fmax(high4.lo, high4.hi);
  const real low = fmin(low2.x, low2.y), high = fmax(high2.x, high2.y);
  box->center[axis] = (real)0.5 * (low + high);
  box->half_size[axis] = (real)0.5 * (high - low);
}

/* Values of the arrays at the particles of a tile. */
typedef struct
{
  real of[MCOR_ATTRIBUTE_LIMIT][MCOR_TILE_SIZE + 16];
} mcor_cluster_values;

/* Finds the offsets of a group's points from particle i of a tile. */
void mcor_cluster_from(
  const mcor_tile* tile, int i, const mcor_points* points, const realv at[3], realv d[3])
{
  mcor_points_from(at, points, (realv)(tile->x[i]), (realv)(tile->y[i]), (realv)(tile->z[i]), d);
}

/* Adds the weights of the listed particles at a group's points to *weight_sum, and the values of
 * the first `step` arrays, times the weights, to `sums`. One loop adds to all sums: while one sum
 * waits for its last addition, the loop adds to other sums. Each call passes a constant as `step`.
 * keep: whether to write the weights to `weight`. */
__attribute__((always_inline)) void mcor_cluster_begin(const mcor_tile* tile,
  const mcor_points* points, const realv at[3], const mcor_cluster_values* values, const int* list,
  int count, const int step, bool keep, realv* weight, realv* weight_sum, realv* sums)
{
  realv d[3], along[3], slope, w = *weight_sum, s[MCOR_ATTRIBUTE_STEP];
  for (int c = 0; c < step; ++c)
  {
    s[c] = sums[c];
  }
  for (int begin = 0; begin < count; begin += MCOR_STEP)
  {
    mcor_length length[MCOR_STEP];
    const int end = min(begin + MCOR_STEP, count);
    for (int k = begin; k < end; ++k)
    {
      mcor_cluster_from(tile, list[k], points, at, d);
      length[k - begin] = mcor_length_of(d);
    }
    for (int k = begin; k < end; ++k)
    {
      const int i = list[k];
      mcor_cluster_from(tile, i, points, at, d); /* again, because keeping d takes longer */
      const realv v = tile->weight[i] *
        mcor_weight_gradient(d, length + (k - begin), (realv)(tile->inv_h[i]), &slope, along);
      w += v;
      for (int c = 0; c < step; ++c)
      {
        s[c] = MCOR_FMA(v, values->of[c][i], s[c]);
      }
      if (keep)
      {
        weight[k] = v;
      }
    }
  }
  *weight_sum = w;
  for (int c = 0; c < step; ++c)
  {
    sums[c] = s[c];
  }
}

/* Adds a tile's particles, with `arrays` arrays, to the sums at group g's points. */
void mcor_cluster_add(const mcor_grid* grid, const mcor_query* query, const mcor_tile* tile,
  const mcor_cluster_values* values, int arrays, int g, mcor_cluster* cluster)
{
  const mcor_points* points = cluster->points + g;
  realv at[3], weight[MCOR_TILE_SIZE], *sums = cluster->sums[g], *weight_sum = cluster->weight + g;
  int list[MCOR_TILE_SIZE + 16];
  mcor_span box;
  mcor_points_relative(grid, query, points, at);
  mcor_lane_range(at[0] + points->ox, 0, &box);
  mcor_lane_range(at[1] + points->oy, 1, &box);
  mcor_lane_range(at[2] + points->oz, 2, &box);
  const int count = mcor_tile_list(tile, &box, 1, list);
  const int step = arrays < MCOR_ATTRIBUTE_STEP ? min(arrays, 1) : MCOR_ATTRIBUTE_STEP;
#define MCOR_CLUSTER_BEGIN(step)                                                                   \
  mcor_cluster_begin(                                                                              \
    tile, points, at, values, list, count, step, arrays > step, weight, weight_sum, sums)
  step == 0     ? MCOR_CLUSTER_BEGIN(0)
    : step == 1 ? MCOR_CLUSTER_BEGIN(1)
                : MCOR_CLUSTER_BEGIN(MCOR_ATTRIBUTE_STEP);
  for (int c = step; c < arrays; ++c)
  {
    realv s = sums[c];
    for (int k = 0; k < count; ++k)
    {
      s = MCOR_FMA(weight[k], values->of[c][list[k]], s);
    }
    sums[c] = s;
  }
}

/* Sets weight and sums of a cluster, whose points are loaded already. */
void mcor_cluster_sums(const mcor_grid* grid, mcor_query* query, mcor_tile* tile,
  mcor_cluster* cluster, MCOR_ATTRIBUTE_PARAMS)
{
  mcor_cluster_values values;
  for (int g = 0; g < cluster->count; ++g)
  {
    cluster->weight[g] = 0;
    for (int c = 0; c < attribute_count; ++c)
    {
      cluster->sums[g][c] = 0;
    }
  }
  mcor_tile_init(tile);
  for (bool first = true; mcor_tile_next(grid, query, tile, first); first = false)
  {
    for (int c = 0; c < attribute_count; ++c)
    {
      mcor_tile_values(tile, attributes + c * (long)stride, values.of[c]);
    }
    for (int g = 0; g < cluster->count; ++g)
    {
      mcor_cluster_add(grid, query, tile, &values, attribute_count, g, cluster);
    }
  }
  (void)means;
}

/* One work-item = MCOR_CLUSTER groups of points. Writes for each point the weight sum, and for each
 * array the sum of weight times value over the particles. */
__kernel void mcor_probe_sums(
  MCOR_GROUP_PARAMS, __global const real4* offset, __global real* weight_sum, MCOR_ATTRIBUTE_PARAMS)
{
  const mcor_grid grid = MCOR_GRID;
  const int end = min((int)(get_global_id(0) + 1) * MCOR_CLUSTER, group_count);
  mcor_cluster cluster;
  mcor_query query, wide; /* query: for one group; wide: for the cluster */
  mcor_reach reach;
  for (int begin = get_global_id(0) * MCOR_CLUSTER; begin < end; begin += cluster.count)
  {
    cluster.count = mcor_cluster_bound(&grid, groups, begin, end, node, offset, &wide);
    mcor_group_load(
      &grid, groups[begin], groups[begin + 1], node, offset, 0, cluster.points, &query);
    if (!mcor_reach_is_tile(&grid, &query, cluster.points))
    {
      cluster.count = 1;
      mcor_tile_init(&reach.tile);
      mcor_probe_alone(&grid, &query, cluster.points, &reach, weight_sum, MCOR_ATTRIBUTE_ARGS);
      continue;
    }
    for (int g = 1; g < cluster.count; ++g)
    {
      mcor_group_points(
        &grid, groups[begin + g], groups[begin + g + 1], node, offset, cluster.points + g);
    }
    mcor_cluster_sums(&grid, &wide, &reach.tile, &cluster, MCOR_ATTRIBUTE_ARGS);
    for (int g = 0; g < cluster.count; ++g)
    {
      mcor_probe_put(
        cluster.points + g, cluster.weight[g], cluster.sums[g], weight_sum, MCOR_ATTRIBUTE_ARGS);
    }
  }
}
