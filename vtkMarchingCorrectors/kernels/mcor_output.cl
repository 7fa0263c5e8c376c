/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* What a surface carries [III-D.4]: compaction, normals. */

/* One work-item = one vertex. Reads the vertex and the scanned uses. Writes it to its final place:
 * node with flag, offset, normal (zero where the gradient vanishes), gradient, and the three numbers
 * correction (cubes), value against iso, weight; and its attributes. */
__kernel void mcor_output_vertices(const int vertex_count, const int march_count,
  __global const int* scanned, __global const int4* node, __global const real4* offset,
  __global const real* linear, __global const real* value, __global const real4* gradient,
  __global const real* weight, __global const uchar* flag, __global int4* out_node,
  __global real4* out_offset, __global float4* out_normal, __global real4* out_gradient,
  __global real4* out_numbers, const int attribute_count, __global const real* means,
  __global real* out_means)
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
  for (int c = 0; c < attribute_count; ++c)
  {
    out_means[to * (long)attribute_count + c] = means[v * (long)attribute_count + c];
  }
}
