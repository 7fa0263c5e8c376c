/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The field at points; the functions for it are in mcor_evaluate.cl. */

/* One work-item = one group of points that are not on lattice edges: points of caps, and points
 * where the field decides the topology. Writes value, gradient, weight and attributes. */
__kernel void mcor_field_points(MCOR_GROUP_PARAMS, const real iso, __global real4* offset,
  __global real* value, __global real4* gradient, __global real* weight, MCOR_ATTRIBUTE_PARAMS)
{
  MCOR_GROUP_ITEM(0);
  mcor_field_at at;
  mcor_evaluate(&grid, &query, &reach, &points, iso, &at);
  mcor_points_store(&grid, &query, &points, iso, &reach, &at, offset, value, gradient, weight,
    MCOR_ATTRIBUTE_ARGS);
}
