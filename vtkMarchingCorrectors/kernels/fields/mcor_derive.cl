/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* SPH gradients of particle arrays at the particles themselves.
 *
 * Arrays are fixed-point numbers, like positions, so a difference of two values is exact. The
 * gradient of a linear array is then exact up to the rounding of the sums. */

/* One work-item = one of `count` sorted particles from `first` on. Writes the particle's position
 * as node and offset (in edges), and whether the particle is in the box. Without a box, every
 * particle counts as inside. Particles outside get node -1. */
__kernel void mcor_derive_place(const int first, const int count, const real units,
  const real edge_x, const real edge_y, const real edge_z, __global const fix* px,
  __global const fix* py, __global const fix* pz, const int has_box, const int first_x,
  const int first_y, const int first_z, const int last_x, const int last_y, const int last_z,
  __global int4* node, __global real4* offset, __global int* flags)
{
  MCOR_ITEM(i, i < count);
  const fix x = px[first + i], y = py[first + i], z = pz[first + i];
  const fix step_x = (fix)(edge_x * units), step_y = (fix)(edge_y * units),
            step_z = (fix)(edge_z * units);
  const int4 at = (int4)((int)(x / step_x), (int)(y / step_y), (int)(z / step_z), 0);
  const bool is_in = !has_box ||
    (at.x >= first_x && at.x < last_x && at.y >= first_y && at.y < last_y && at.z >= first_z &&
      at.z < last_z);
  flags[i] = is_in;
  node[i] = is_in ? at : -1;
  offset[i] = (real4)((real)(x % step_x) / (real)step_x, (real)(y % step_y) / (real)step_y,
    (real)(z % step_z) / (real)step_z, 0);
}

/* Sums over the neighbours j of the particles i in the lanes; the unit of length is a cube. */
typedef struct
{
  realv moments[3][3];              /* sum V_j grad_a W_ij (x_j - x_i)_b */
  realv slopes[MCOR_ARRAY_STEP][3]; /* sum V_j (A_j - A_i) grad_a W_ij of each array A */
} mcor_derive_sums;

/* Adds the particles j that `reach` holds to the sums. values: A_j; own: A_i; both fixed-point. */
void mcor_derive_add(const mcor_reach* reach, const mcor_points* points, const realv at[3],
  const mcor_values* values, const fixv own[MCOR_ARRAY_STEP], mcor_derive_sums* sums)
{
  realv d[3], along[3], slope;
  for (int i = 0; i < MCOR_REACH_COUNT(reach); ++i)
  {
    MCOR_REACH_FROM(at, points, reach, i, d);
    const mcor_length length = mcor_length_of(d);
    mcor_weight_gradient(d, &length, MCOR_REACH(reach, inv_h, i), &slope, along);
    const realv m = MCOR_REACH(reach, weight, i) * slope;
    const realv g[3] = { m * along[0], m * along[1], m * along[2] };
    for (int a = 0; a < 3; ++a)
    {
      for (int b = 0; b < 3; ++b)
      {
        sums->moments[a][b] = MCOR_FMA(-g[a], d[b], sums->moments[a][b]);
      }
    }
    for (int c = 0; c < MCOR_ARRAY_STEP; ++c)
    {
      const realv value = MCOR_VALUE_OF(values, reach, c, i);
      const realv change = MCOR_CONVERT_REALV(MCOR_AS_FIXV(value) - own[c]);
      for (int a = 0; a < 3; ++a)
      {
        sums->slopes[c][a] = MCOR_FMA(g[a], change, sums->slopes[c][a]);
      }
    }
  }
}

/* Returns an array's values at the particles of the lanes, in fixed-point units; 0 in a lane that
 * repeats another one. */
fixv mcor_derive_own(
  const mcor_points* points, __global const int* order, __global const real* array)
{
  fix own[MCOR_LANES];
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    own[lane] =
      points->index[lane] < 0 ? 0 : MCOR_CAT(as_, MCOR_FIX_NAME)(array[order[points->index[lane]]]);
  }
  return MCOR_LOAD(0, own);
}

/* One work-item = one group of particles. Reads arrays of fixed-point numbers, `stride` long each.
 * Writes the moments, and the slopes of at most MCOR_ARRAY_STEP arrays from `first_array` on, see
 * mcor_derive_sums. Point i is sorted particle first + order[i]. */
__kernel void mcor_derive_gradients(MCOR_GROUP_PARAMS, __global const real4* offset,
  const int first, __global const int* order, const int first_array, const int array_count,
  const int stride, __global const real* arrays, __global real* moments, __global real* slopes)
{
  MCOR_GROUP_ITEM(0);
  const int count = min(array_count - first_array, MCOR_ARRAY_STEP);
  mcor_derive_sums sums;
  mcor_values values;
  realv at[3];
  fixv own[MCOR_ARRAY_STEP];
  __global const real* array[MCOR_ARRAY_STEP];
  mcor_points_relative(&grid, &query, &points, at);
  for (int c = 0; c < MCOR_ARRAY_STEP; ++c)
  {
    /* If fewer than MCOR_ARRAY_STEP arrays are left, array first_array is read more than once. */
    array[c] = arrays + (first_array + (c < count ? c : 0)) * (long)stride;
    own[c] = mcor_derive_own(&points, order, array[c] + first);
    for (int a = 0; a < 3; ++a)
    {
      sums.slopes[c][a] = 0;
      sums.moments[a][0] = sums.moments[a][1] = sums.moments[a][2] = 0;
    }
  }
  for (bool begin = true; mcor_reach_next(&grid, &query, &points, 0, &reach, begin); begin = false)
  {
    mcor_values_load(&reach, array, &values);
    mcor_derive_add(&reach, &points, at, &values, own, &sums);
  }
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const long v = points.index[lane];
    for (int a = 0; a < 3 && v >= 0; ++a)
    {
      for (int b = 0; b < 3; ++b)
      {
        moments[9 * v + 3 * a + b] = MCOR_GET(sums.moments[a][b], lane);
      }
      for (int c = 0; c < count; ++c)
      {
        slopes[(v * array_count + first_array + c) * 3 + a] = MCOR_GET(sums.slopes[c][a], lane);
      }
    }
  }
}
