/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* What a surface carries [III-D.4]: compaction, normals, attributes. */

/* One work-item = one vertex. Reads the vertex and the scanned uses. Writes it to its final place:
 * node with flag, offset, normal (zero where the gradient vanishes), gradient, and the three numbers
 * correction (cubes), value against iso, weight. */
__kernel void mcor_output_vertices(const int vertex_count, const int march_count,
  __global const int* scanned, __global const int4* node, __global const real4* offset,
  __global const real* linear, __global const real* value, __global const real4* gradient,
  __global const real* weight, __global const uchar* flag, __global int4* out_node, __global real4* out_offset, __global float4* out_normal,
  __global real4* out_gradient, __global real4* out_numbers)
{
  const int v = get_global_id(0);
  if (v >= vertex_count || scanned[v] == scanned[v + 1])
  {
    return;
  }
  const int to = scanned[v];
  const bool march = v < march_count;
  /* An edge with an unused cell around it lies on the border that the node threshold leaves. */
  const int border = march ? (node[v].w >> 2 & 1) * 4 : flag[v];
  out_node[to] = (int4)(node[v].x, node[v].y, node[v].z, border);
  out_offset[to] = offset[v];
  const real4 g = gradient[v];
  /* Scaled first, as the square of a small gradient may vanish. */
  const real most = fmax(fabs(g.x), fmax(fabs(g.y), fabs(g.z)));
  const real4 s = most > 0 ? g / most : (real4)0;
  const real scale = most > 0 ? -1 / sqrt(s.x * s.x + s.y * s.y + s.z * s.z) : (real)0;
  out_normal[to] = (float4)((float)(s.x * scale), (float)(s.y * scale), (float)(s.z * scale), 0);
  out_gradient[to] = g;
  out_numbers[to] = (real4)(march ? linear[v] : (real)0, value[v], weight[v], 0);
}

#define MCOR_ATTRIBUTE_LIMIT 8

/* Looks for particles that are nearer than the ones found but do not reach the points themselves. */
void mcor_output_nearest(const mcor_grid* grid, const mcor_points* points, mcor_query* query,
  realv* least, fixv* index)
{
  real farthest = 0;
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    farthest = MCOR_GET_FIX(*index, lane) >= 0 ? fmax(farthest, MCOR_GET(*least, lane)) : farthest;
  }
  query->radius = (float)sqrt(farthest) * 1.0001f;
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool first = true; mcor_tile_next(grid, query, &tile, first); first = false)
  {
    for (int i = 0; i < tile.count; ++i)
    {
      const int j = tile.list[i];
      const realv dx = MCOR_CONVERT_REALV(grid->px[j] - points->x) * grid->unit - points->ox;
      const realv dy = MCOR_CONVERT_REALV(grid->py[j] - points->y) * grid->unit - points->oy;
      const realv dz = MCOR_CONVERT_REALV(grid->pz[j] - points->z) * grid->unit - points->oz;
      const realv r2 = dx * dx + dy * dy + dz * dz;
      const fixv nearer = r2 < *least && (!MCOR_SOLIDS || grid->weight[j] != 0 ? (fixv)MCOR_TRUE : (fixv)0);
      *index = nearer ? (fixv)j : *index;
      *least = nearer ? r2 : *least;
    }
  }
}

/* One work-item = one group of points. Reads `attribute_count` sorted arrays, one after the other.
 * Writes their Shepard means (at most 8) and, if asked for, the nearest fluid particle. */
__kernel void mcor_output_attributes(MCOR_GRID_PARAMS, const int group_count,
  __global const int* groups, __global const int4* node, __global const real4* offset, const int attribute_count,
  const int stride, __global const real* attributes, __global real* out, const int want_nearest, const int uniform,
  __global const int* order, __global int* nearest)
{
  const int group = get_global_id(0);
  if (group >= group_count)
  {
    return;
  }
  const int begin = groups[group], end = groups[group + 1];
  const mcor_grid grid = MCOR_GRID;
  mcor_points points;
  mcor_query query;
  int unused[MCOR_LANES];
  mcor_points_load(node, begin, end, fix_bits, &points, &query, unused);
  mcor_points_load_offsets(offset, begin, end, 0, fix_bits, &points, &query);
  realv sums[MCOR_ATTRIBUTE_LIMIT], w = 0, least = MAXFLOAT;
  fixv index = -1;
  for (int c = 0; c < attribute_count; ++c)
  {
    sums[c] = 0;
  }
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool first = true; mcor_tile_next(&grid, &query, &tile, first); first = false)
  {
    for (int i = 0; i < tile.count; ++i)
    {
      const int j = tile.list[i];
      if (MCOR_SOLIDS && tile.weight[i] == 0)
      {
        continue;
      }
      const realv dx = MCOR_CONVERT_REALV(px[j] - points.x) * grid.unit - points.ox;
      const realv dy = MCOR_CONVERT_REALV(py[j] - points.y) * grid.unit - points.oy;
      const realv dz = MCOR_CONVERT_REALV(pz[j] - points.z) * grid.unit - points.oz;
      const real inv_h = tile.inv_h[i];
      const realv k = tile.weight[i] *
        mcor_weight(mcor_planar(dx, dy, inv_h), mcor_height(dz, (realv)inv_h), inv_h);
      w += k;
      for (int c = 0; c < attribute_count; ++c)
      {
        sums[c] += k * attributes[c * stride + j];
      }
      const realv r2 = dx * dx + dy * dy + dz * dz;
      index = r2 < least ? (fixv)j : index;
      least = fmin(least, r2);
    }
  }
  if (want_nearest && !uniform)
  {
    mcor_output_nearest(&grid, &points, &query, &least, &index);
  }
  for (int lane = 0; begin + lane < end; ++lane)
  {
    const int v = begin + lane, j = (int)MCOR_GET_FIX(index, lane);
    for (int c = 0; c < attribute_count; ++c)
    {
      const real weight = MCOR_GET(w, lane);
      out[(long)v * attribute_count + c] = weight != 0 ? MCOR_GET(sums[c], lane) / weight : (real)0;
    }
    if (want_nearest)
    {
      nearest[v] = j < 0 ? -1 : order[j];
    }
  }
}
