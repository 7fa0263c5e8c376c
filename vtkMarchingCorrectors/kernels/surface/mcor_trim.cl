/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Trimming [III-D.3]: a triangle is kept, discarded, or cut where the weight passes the vertex
 * threshold. "Weight" here also means the boundary eigenvalue or the number that mcor_trim_margin
 * makes. A cut vertex belongs to a mesh edge, whose key is (lower vertex << 32 | higher vertex);
 * the two triangles at this edge share the vertex. */

/* Returns which corners are above the threshold, bits 0 to 2. A corner at the threshold is outside
 * for every triangle around it, so that the trimmed surface is a manifold there, too, and nothing
 * remains of a triangle that merely touches the threshold [Fig. 3 b]. */
int mcor_trim_case(__global const int* t, __global const real* weight, const real threshold)
{
  int inside = 0;
  for (int c = 0; c < 3; ++c)
  {
    inside |= (weight[t[c]] > threshold) << c;
  }
  return inside;
}

/* One work-item = one batch of triangles. Writes how many triangles remain of the batch, and how
 * many cut edges the batch's triangles have: two for each cut triangle. */
__kernel void mcor_trim_count(const int triangle_count, __global const int* triangles,
  __global const real* weight, const real threshold, __global int* remaining, __global int* cuts)
{
  MCOR_ITEM(batch, (long)batch * MCOR_BATCH < triangle_count);
  const long begin = (long)batch * MCOR_BATCH;
  const long end = min(begin + MCOR_BATCH, (long)triangle_count);
  int left = 0, cut = 0;
  for (long i = begin; i < end; ++i)
  {
    const int corners = (int)popcount(mcor_trim_case(triangles + 3 * i, weight, threshold));
    left += corners == 0 ? 0 : corners == 2 ? 2 : 1;
    cut += corners == 1 || corners == 2 ? 2 : 0;
  }
  remaining[batch] = left;
  cuts[batch] = cut;
}

/* Returns the lone corner of a cut triangle: the only one inside, or the only one outside. */
int mcor_trim_lone(int inside)
{
  return inside == 1 || inside == 6 ? 0 : inside == 2 || inside == 5 ? 1 : 2;
}

ulong mcor_trim_key(int a, int b)
{
  return (ulong)min(a, b) << 32 | (uint)max(a, b);
}

/* One work-item = one batch of triangles. Writes the keys of the triangles' cut edges. A cut
 * triangle has two cut edges, which begin at the corner that is alone on its side of the threshold:
 * first the edge to the next corner, then the edge to the corner after that. */
__kernel void mcor_trim_edges(const int triangle_count, __global const int* triangles,
  __global const real* weight, const real threshold, __global const int* cuts, __global ulong* keys)
{
  MCOR_ITEM(batch, (long)batch * MCOR_BATCH < triangle_count);
  const long begin = (long)batch * MCOR_BATCH;
  int cut = cuts[batch];
  for (long i = begin; cut < cuts[batch + 1]; ++i)
  {
    __global const int* t = triangles + 3 * i;
    const int inside = mcor_trim_case(t, weight, threshold);
    if (inside != 0 && inside != 7)
    {
      const int lone = mcor_trim_lone(inside);
      keys[cut++] = mcor_trim_key(t[lone], t[(lone + 1) % 3]);
      keys[cut++] = mcor_trim_key(t[lone], t[(lone + 2) % 3]);
    }
  }
}

/* Writes what remains of a cut triangle [Fig. 3 c, d, e]: one triangle, or a quad that is split
 * into two. cut_next, cut_last: the vertices on the triangle's two cut edges, in the order of
 * mcor_trim_edges. Returns where the next triangle goes. */
__global int* mcor_trim_cut(
  __global const int* t, int inside, int cut_next, int cut_last, __global int* to)
{
  const int lone = mcor_trim_lone(inside);
  *to++ = cut_next;
  if (inside >> lone & 1)
  {
    *to++ = cut_last;
    *to++ = t[lone];
    return to;
  }
  const int next = t[(lone + 1) % 3], last = t[(lone + 2) % 3];
  *to++ = next;
  *to++ = last;
  *to++ = cut_next;
  *to++ = last;
  *to++ = cut_last;
  return to;
}

/* One work-item = one batch of triangles. Writes what remains of these triangles [Fig. 3], and, if
 * `follows` is set, the cell of each remaining triangle. */
__kernel void mcor_trim_fill(const int triangle_count, __global const int* triangles,
  __global const real* weight, const real threshold, const int vertex_count,
  __global const int* remaining, __global const int* cuts, __global const int* cut_vertex,
  const int follows, __global const ulong* cells, __global ulong* out_cells, __global int* out)
{
  MCOR_ITEM(batch, (long)batch * MCOR_BATCH < triangle_count);
  const long begin = (long)batch * MCOR_BATCH;
  __global int *to = out + 3L * remaining[batch], *end = out + 3L * remaining[batch + 1];
  int cut = cuts[batch];
  for (long i = begin; to < end; ++i)
  {
    __global const int *t = triangles + 3 * i, *first = to;
    const int inside = mcor_trim_case(t, weight, threshold);
    if (inside == 7)
    {
      *to++ = t[0];
      *to++ = t[1];
      *to++ = t[2];
    }
    else if (inside != 0)
    {
      to = mcor_trim_cut(
        t, inside, vertex_count + cut_vertex[cut], vertex_count + cut_vertex[cut + 1], to);
      cut += 2;
    }
    for (; follows && first < to; first += 3)
    {
      out_cells[(first - out) / 3] = cells[i];
    }
  }
}

/* One work-item = one triangle corner. Marks its vertex as used. */
__kernel void mcor_trim_used(
  const int triangle_count, __global const int* triangles, __global int* used)
{
  const long i = get_global_id(0);
  if (i < 3L * triangle_count)
  {
    used[triangles[i]] = 1;
  }
}
