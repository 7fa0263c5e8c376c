/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Other particle arrays at the surface's points [III-D.4]. */

/* A mean needs a sum of weights above this; a lower sum has no exact digits. */
#define MCOR_LEAST_SUM ((real)1e-30f)

/* At most MCOR_ATTRIBUTE_LIMIT arrays in the order of the sorted particles, each `stride` elements
 * long, one after the other. The means of all arrays at a point are stored one after the other,
 * too. */
#define MCOR_ATTRIBUTE_PARAMS                                                                      \
  const int attribute_count, const int stride, __global const real *attributes, __global real *means

#define MCOR_ATTRIBUTE_ARGS attribute_count, stride, attributes, means

/* Writes the Shepard means of the attributes at a group of points; 0 where the sum of weights is
 * too low. iso: as for mcor_evaluate. evaluated: the last call of mcor_evaluate was for these
 * points. */
MCOR_ONE_COPY void mcor_attribute_group(const mcor_grid* grid, mcor_query* query,
  const mcor_points* points, real iso, mcor_reach* reach, bool evaluated, MCOR_ATTRIBUTE_PARAMS)
{
  realv sums[MCOR_ATTRIBUTE_LIMIT], w;
  for (int c = 0; c < MCOR_ATTRIBUTE_LIMIT; ++c)
  {
    sums[c] = 0;
  }
  mcor_attribute_sums(
    grid, query, points, iso, reach, evaluated, attribute_count, stride, attributes, sums, &w);
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const real weight = MCOR_GET(w, lane);
    const long v = points->index[lane];
    for (int c = 0; c < MCOR_ATTRIBUTE_LIMIT; ++c)
    {
      if (c < attribute_count && v >= 0)
      {
        means[v * attribute_count + c] =
          fabs(weight) > MCOR_LEAST_SUM ? MCOR_GET(sums[c], lane) / weight : (real)0;
      }
    }
  }
}
