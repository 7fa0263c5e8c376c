/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Attributes at points; the functions for them are in mcor_attribute.cl. */

/* One work-item = one group of points. Writes the means of the attributes at these points. */
__kernel void mcor_attribute_means(
  MCOR_GROUP_PARAMS, __global const real4* offset, MCOR_ATTRIBUTE_PARAMS)
{
  MCOR_GROUP_ITEM(0);
  mcor_attribute_group(&grid, &query, &points, 0, &reach, false, MCOR_ATTRIBUTE_ARGS);
}

/* Updates each point's nearest fluid particle: *index is its place in the sorted arrays, *least its
 * squared distance. If the query's radius is below 0, only particles that reach the point count.
 * Else all particles within the radius count, and maybe a few beyond the radius. A particle that
 * does not reach the point may be so far from the query's origin that its position in a tile is not
 * exact, so differences are taken between fixed-point numbers. */
MCOR_ONE_COPY void mcor_attribute_nearer(
  const mcor_grid* grid, mcor_query* query, const mcor_points* points, realv* least, fixv* index)
{
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool first = true; mcor_tile_next(grid, query, &tile, first); first = false)
  {
    for (int i = 0; i < tile.count; ++i)
    {
      if (MCOR_SOLIDS && MCOR_EACH(&tile, weight, i) == 0)
      {
        continue;
      }
      const int k = MCOR_INDEX(&tile, i);
      const realv x = MCOR_CONVERT_REALV(points->x - grid->px[k]) * grid->unit + points->ox;
      const realv y = MCOR_CONVERT_REALV(points->y - grid->py[k]) * grid->unit + points->oy;
      const realv z = MCOR_CONVERT_REALV(points->z - grid->pz[k]) * grid->unit + points->oz;
      const realv r2 = mcor_square(x, y, z);
      const real own = query->radius < 0 ? MCOR_SUPPORT / MCOR_EACH(&tile, inv_h, i) : (real)0;
      const fixv nearer = r2 < *least && (query->radius >= 0 || r2 < own * own);
      *index = nearer ? (fixv)k : *index;
      *least = nearer ? r2 : *least;
    }
  }
}

/* One work-item = one group of points. Writes the number of the fluid particle nearest to each
 * point; -1 if none is found. First looks among the particles that reach the point. Looks farther
 * if smoothing lengths differ, because a particle that does not reach the point may be nearer. Also
 * looks farther if no particle reaches the point: if the iso value of the weight sum is very low, a
 * particle may reach only an end of the point's lattice edge. */
__kernel void mcor_attribute_nearest(MCOR_GROUP_PARAMS, __global const real4* offset,
  const int uniform, __global const int* order, __global int* nearest)
{
  MCOR_GROUP_ITEM(0);
  realv least = MAXFLOAT;
  fixv index = -1;
  mcor_attribute_nearer(&grid, &query, &points, &least, &index);
  const bool none = MCOR_ANY(index < 0);
  if (none || !uniform)
  {
    real farthest = 0;
    for (int lane = 0; lane < MCOR_LANES; ++lane)
    {
      farthest = fmax(farthest, MCOR_GET_FIX(index, lane) >= 0 ? MCOR_GET(least, lane) : (real)0);
    }
    query.radius = (float)sqrt(farthest) * 1.0001f;
    query.radius = none ? fmax(query.radius, levels[0].support / (float)view_edge + 2) : query.radius;
    mcor_attribute_nearer(&grid, &query, &points, &least, &index);
  }
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int v = points.index[lane], j = (int)MCOR_GET_FIX(index, lane);
    if (v >= 0)
    {
      nearest[v] = j < 0 ? -1 : order[j];
    }
  }
}
