/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The field at points that no edge has: of caps, and where it decides on the topology. */

/* One work-item = one group of points. Writes value, gradient, weight and attributes there. */
__kernel void mcor_field_points(MCOR_GROUP_PARAMS, const real iso, __global real4* offset,
  __global real* value, __global real4* gradient, __global real* weight, MCOR_ATTRIBUTE_PARAMS)
{
  MCOR_GROUP_ITEM(0);
  mcor_field_at at;
  mcor_evaluate(&grid, &query, &reach, &points, iso, &at);
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
    }
  }
}
