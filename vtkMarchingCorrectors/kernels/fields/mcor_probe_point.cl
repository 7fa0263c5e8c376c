/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sums at one point, in the form for GPUs; see mcor_probe.cl. */

/* One work-item = one group, which is one point. Writes the weight sum at this point, and for each
 * array the sum of weight times value over the particles. */
__kernel void mcor_probe_sums(
  MCOR_GROUP_PARAMS, __global const real4* offset, __global real* weight_sum, MCOR_ATTRIBUTE_PARAMS)
{
  MCOR_GROUP_ITEM(0);
  mcor_probe_alone(&grid, &query, &points, &reach, weight_sum, MCOR_ATTRIBUTE_ARGS);
}
