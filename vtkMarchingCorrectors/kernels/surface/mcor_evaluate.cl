/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Field and gradient at MCOR_LANES points at a time. */

/* Field minus iso value, its gradient, and the trimming weight with its gradient; per cube. */
typedef struct
{
  realv value, gx, gy, gz;
  realv weight, wx, wy, wz;
#if MCOR_SOLIDS
  realv fluid, fx, fy, fz; /* the fluid's part of the weight */
#endif
} mcor_field_at;

/* Evaluates at all points. iso: relative to A0 for the Shepard mean. */
void mcor_evaluate(const mcor_grid* grid, mcor_query* query, mcor_reach* reach,
  const mcor_points* points, real iso, mcor_field_at* at)
{
  realv s = 0, sx = 0, sy = 0, sz = 0, w = 0, wx = 0, wy = 0, wz = 0;
#if MCOR_SOLIDS
  realv t = 0, tx = 0, ty = 0, tz = 0;
#endif
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
        mcor_points_from(at_node, points, MCOR_REACH(reach, x, i), MCOR_REACH(reach, y, i),
          MCOR_REACH(reach, z, i), d);
        length[i - begin] = mcor_length_of(d);
      }
      for (int i = begin; i < end; ++i)
      {
        /* Made again: keeping it takes longer. */
        mcor_points_from(at_node, points, MCOR_REACH(reach, x, i), MCOR_REACH(reach, y, i),
          MCOR_REACH(reach, z, i), d);
        const realv k =
          mcor_weight_gradient(d, length + (i - begin), MCOR_REACH(reach, inv_h, i), &slope, along);
        const realv m = MCOR_REACH(reach, weight, i), ms = m * slope;
        MCOR_REACH_KEEP(reach, i, k);
#if MCOR_FIELD != 2
        const realv c = MCOR_REACH_TERM(reach, i, iso), cs = c * slope;
        s = MCOR_FMA(c, k, s);
        sx = MCOR_FMA(cs, along[0], sx);
        sy = MCOR_FMA(cs, along[1], sy);
        sz = MCOR_FMA(cs, along[2], sz);
#endif
        w = MCOR_FMA(m, k, w);
        wx = MCOR_FMA(ms, along[0], wx);
        wy = MCOR_FMA(ms, along[1], wy);
        wz = MCOR_FMA(ms, along[2], wz);
#if MCOR_SOLIDS
        const realv mt = MCOR_REACH(reach, MCOR_TRIM_WEIGHT, i), ts = mt * slope;
        t = MCOR_FMA(mt, k, t);
        tx = MCOR_FMA(ts, along[0], tx);
        ty = MCOR_FMA(ts, along[1], ty);
        tz = MCOR_FMA(ts, along[2], tz);
#endif
      }
    }
  }
#if MCOR_FIELD == 0
  /* A void between fluid particles, kept valid by solids, has no value. A huge one makes the
   * iteration look for the void's border. */
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
  at->fluid = w;
  at->fx = wx;
  at->fy = wy;
  at->fz = wz;
#else
  at->weight = w;
  at->wx = wx;
  at->wy = wy;
  at->wz = wz;
#endif
}
