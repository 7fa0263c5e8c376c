/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Field and gradient at MCOR_LANES points at a time. */

/* A quantity at points, and its gradient; the unit of length is a cube. */
typedef struct
{
  realv value, gradient[3];
} mcor_quantity;

/* Field minus iso value, the trimming weight, and the fluid's part of this weight. */
typedef struct
{
  mcor_quantity field, weight, fluid;
} mcor_field_at;

/* Adds m times a kernel to a sum. The kernel's value is k, its gradient is slope * along. */
void mcor_quantity_add(realv m, realv k, realv slope, const realv along[3], mcor_quantity* sum)
{
  const realv ms = m * slope;
  sum->value = MCOR_FMA(m, k, sum->value);
  sum->gradient[0] = MCOR_FMA(ms, along[0], sum->gradient[0]);
  sum->gradient[1] = MCOR_FMA(ms, along[1], sum->gradient[1]);
  sum->gradient[2] = MCOR_FMA(ms, along[2], sum->gradient[2]);
}

/* Finds the field minus the iso value, and the weights, at all points. iso: the iso value. For a
 * Shepard mean, the shift A0 is subtracted from it, and from all particles' values. */
void mcor_evaluate(const mcor_grid* grid, mcor_query* query, mcor_reach* reach,
  const mcor_points* points, real iso, mcor_field_at* at)
{
  mcor_quantity s = { 0, { 0, 0, 0 } }, w = s, t = s;
  realv at_node[3], d[3], along[3], slope;
  mcor_points_relative(grid, query, points, at_node);
  for (bool first = true; mcor_reach_next(grid, query, points, iso, reach, first); first = false)
  {
    for (int begin = 0; begin < MCOR_REACH_COUNT(reach); begin += MCOR_STEP)
    {
      mcor_length length[MCOR_STEP];
      const int end = min(begin + MCOR_STEP, MCOR_REACH_COUNT(reach));
      for (int i = begin; i < end; ++i)
      {
        MCOR_REACH_FROM(at_node, points, reach, i, d);
        length[i - begin] = mcor_length_of(d);
      }
      for (int i = begin; i < end; ++i)
      {
        /* d is computed again, because keeping it takes longer. */
        MCOR_REACH_FROM(at_node, points, reach, i, d);
        const realv k =
          mcor_weight_gradient(d, length + (i - begin), MCOR_REACH(reach, inv_h, i), &slope, along);
        MCOR_REACH_KEEP(reach, i, k);
#if MCOR_FIELD != MCOR_WEIGHT_SUM
        mcor_quantity_add(MCOR_REACH_TERM(reach, i, iso), k, slope, along, &s);
#endif
        mcor_quantity_add(MCOR_REACH(reach, weight, i), k, slope, along, &w);
#if MCOR_SOLIDS
        mcor_quantity_add(MCOR_REACH(reach, MCOR_TRIM_WEIGHT, i), k, slope, along, &t);
#endif
      }
    }
  }
#if MCOR_FIELD == MCOR_SHEPARD
  /* In a void between fluid particles, where solids alone make the weight, the field has no value.
   * The huge value makes the iteration search for the void's border. */
  const fixv none = fabs(w.value) < (real)1e-12f;
  const realv inv_w = (real)1 / (none ? (realv)1 : w.value);
  at->field.value = none ? (realv)1e30f : s.value * inv_w;
  for (int a = 0; a < 3; ++a)
  {
    at->field.gradient[a] = (s.gradient[a] - at->field.value * w.gradient[a]) * inv_w;
  }
#else
  at->field = MCOR_FIELD == MCOR_SUM ? s : w;
  at->field.value -= iso;
#endif
  at->weight = MCOR_SOLIDS ? t : w;
  at->fluid = w;
}

/* Writes offset, value, gradient, trimming weight and any attributes of a group's points. With
 * solids, the gradient's fourth number is the fluid's part of the weight. at: the result of the
 * last call of mcor_evaluate, which must have been for these points. */
MCOR_ONE_COPY void mcor_points_store(const mcor_grid* grid, mcor_query* query,
  const mcor_points* points, real iso, mcor_reach* reach, const mcor_field_at* at,
  __global real4* offset, __global real* value, __global real4* gradient, __global real* weight,
  MCOR_ATTRIBUTE_PARAMS)
{
  if (attribute_count > 0)
  {
    mcor_attribute_group(grid, query, points, iso, reach, true, MCOR_ATTRIBUTE_ARGS);
  }
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int v = points->index[lane];
    if (v >= 0)
    {
      offset[v] = (real4)(MCOR_GET(points->ox, lane) / grid->edge[0],
        MCOR_GET(points->oy, lane) / grid->edge[1], MCOR_GET(points->oz, lane) / grid->edge[2], 0);
      value[v] = MCOR_GET(at->field.value, lane);
      gradient[v] =
        (real4)(MCOR_GET(at->field.gradient[0], lane), MCOR_GET(at->field.gradient[1], lane),
          MCOR_GET(at->field.gradient[2], lane), MCOR_SOLIDS ? MCOR_GET(at->fluid.value, lane) : 0);
      weight[v] = MCOR_GET(at->weight.value, lane);
    }
  }
}
