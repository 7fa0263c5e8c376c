/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The boundary eigenvalue at points; the functions for it are in mcor_boundary.cl. */

/* One work-item = one group of points. Writes the boundary eigenvalue at each point. */
__kernel void mcor_boundary_points(
  MCOR_GROUP_PARAMS, __global const real4* offset, const int plane, __global real* eigenvalue)
{
  MCOR_GROUP_ITEM(0);
  mcor_quantity boundary;
  mcor_evaluate_boundary(&grid, &query, &reach.tile, &points, plane, false, &boundary);
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    if (points.index[lane] >= 0)
    {
      eigenvalue[points.index[lane]] = MCOR_GET(boundary.value, lane);
    }
  }
}
