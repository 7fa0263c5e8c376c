/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds bunches of vertices that may be merged, see mcor_compact.c, and chooses which are merged.
 *
 * Merging must leave a manifold with the same pieces. For this, two conditions suffice: each merged
 * bunch can be contracted to a point, and any two vertices of the result are joined by one edge at
 * most. (If triangles between two edges vanish, one edge takes the place of both.) The second
 * condition is tested around each bunch: the outer edges of the triangles around the bunch must
 * form one closed ring of three or more different vertices, both if all other bunches are merged
 * and if no other bunch is. So whether a bunch is merged depends only on the cells near it,
 * whatever part of the surface a call makes; and it may be taken apart at any time. A closed piece
 * that would keep fewer than 8 triangles stays as it is.
 *
 * A bunch that fails this test may still be merged, if it can be merged while the bunches that pass
 * the test are merged. It then leans on the bunches beside it: if one of these is taken apart, the
 * leaning bunch is taken apart, too. */

#include "mcor_cap.h"
#include "mcor_compact.h"

/* A mcor_fan has at most this many edges: one for each triangle around a bunch. A bunch with more
 * triangles around it is not merged. */
#define MCOR_FAN_LIMIT 48

/* Least number of vertices that a closed piece keeps: a surface 6, with 8 triangles; a line 4. */
#define MCOR_LEAST_PIECE(corners) ((corners) == 3 ? 6 : 4)

/* ---- Nodes ---- */

/* A vertex's node is the end of its edge that is nearer by linear interpolation; if both are
 * equally near, the lower end. Gives each vertex the key of its node. The key contains the last bit
 * of the level. As levels of neighbouring cells differ by at most one, nodes of different levels
 * then have different keys. Vertices stay (MCOR_FROZEN) if they lie on a side that caps close, on a
 * side of the period or on an edge with an unused cell, or if they belong to cuts or caps. */
static void mcor_key_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  const mcor_context* context = bunches->context;
  for (int64_t v = first; v < last; ++v)
  {
    const cl_int* node = bunches->points[v].node;
    const int axis = node[3] & 3, level = node[3] >> MCOR_LEVEL_SHIFT;
    bool stays = v >= bunches->march_count || (node[3] >> 2 & 1);
    for (int i = 0; i < 12 && !stays; ++i)
    {
      stays = i / 4 != axis && node[i / 4] << level == bunches->side[i / 4][i % 4];
    }
    uint64_t key = MCOR_FROZEN;
    if (!stays)
    {
      cl_int at[3] = { node[0], node[1], node[2] };
      at[axis] += fabs(mcor_get_real(context, bunches->ends, 2 * v)) >
        fabs(mcor_get_real(context, bunches->ends, 2 * v + 1));
      key = mcor_cap_key(at) ^ (uint64_t)(level & 1) << 63;
    }
    bunches->of[v] = (mcor_bunch_vertex){
      .key = key, .first = (int32_t)v, .next = -1, .star = -1, .now = (int32_t)v
    };
  }
  (void)slice;
}

static mcor_status mcor_key_vertices(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  const mcor_lattice* lattice = &context->lattice;
  const mcor_mesh* mesh = &context->mesh;
  for (int i = 0; i < 12; ++i)
  {
    const int axis = i / 4, upper = i % 2, period = lattice->period[axis];
    bunches->side[axis][i % 4] = i % 4 < 2 ? mcor_cap_plane(context, axis, upper)
      : period > 0                         ? lattice->period_first[axis] + upper * period
                                           : -1;
  }
  const size_t cuts = (size_t)(mesh->cap_first - mesh->march_count);
  void* cut_edges = NULL;
  const mcor_mapping views[] = {
    { &mesh->ends, 2 * (size_t)bunches->march_count * context->cl.real_size, &bunches->ends },
    { &mesh->cut_edges, cuts * sizeof(cl_ulong), &cut_edges }
  };
  mcor_status status = mcor_map_all(context, views, cuts > 0 ? 2 : 1);
  MCOR_THEN(status,
    mcor_parallel_run(
      context, bunches->vertex_count, MCOR_LIGHT_GRAIN, mcor_key_slice, bunches, NULL));
  /* Freezes the corners of caps. Marks both end vertices of each cut edge as `held`: they may be
   * merged, but do not move alone, because the key of the cut vertex refers to them. */
  for (int64_t c = 3 * (int64_t)mesh->cap_triangle_first; c < 3 * (int64_t)mesh->triangle_count;
       ++c)
  {
    bunches->of[bunches->triangles[c]].key = MCOR_FROZEN;
  }
  for (size_t i = 0; i < cuts && status == MCOR_OK; ++i)
  {
    const cl_ulong cut = ((const cl_ulong*)cut_edges)[i];
    bunches->of[cut >> 32].held = bunches->of[cut & UINT32_MAX].held = true;
  }
  return mcor_unmap_all(context, views, 2, status);
}

/* ---- Bunches ---- */

/* Returns the lowest vertex that v is joined to so far. `first` of a vertex is a lower vertex that
 * it is joined to; `first` of the lowest vertex is this vertex itself. */
static int32_t mcor_first_of(const mcor_bunch_vertex* of, int32_t v)
{
  for (int32_t first; (first = of[v].first) != v; v = first)
  {
  }
  return v;
}

/* Joins any two vertices of one node that share an edge. p and q: the lowest vertices that the two
 * are joined to so far. Sets `first` of the higher one of p and q to the lower one. If another
 * thread has changed this `first` in the meantime, tries again from its new value. */
static void mcor_join_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  mcor_bunch_vertex* of = bunches->of;
  for (int64_t i = 3 * first; i < 3 * last; ++i)
  {
    const cl_int v = bunches->triangles[i], w = bunches->triangles[i % 3 < 2 ? i + 1 : i - 2];
    if (of[v].key != of[w].key || of[v].key == MCOR_FROZEN)
    {
      continue;
    }
    int32_t p = mcor_first_of(of, v), q = mcor_first_of(of, w);
    while (p != q)
    {
      int32_t high = p > q ? p : q;
      q = p > q ? q : p;
      p = atomic_compare_exchange_strong(&of[high].first, &high, q) ? q : mcor_first_of(of, high);
    }
  }
  (void)slice;
}

/* Makes a list of vertices for each bunch. The order may differ between runs, without effect. */
static void mcor_list_vertices(void* data, int slice, int64_t first, int64_t last)
{
  mcor_bunch_vertex* of = ((const mcor_bunches*)data)->of;
  for (int32_t v = (int32_t)first; v < last; ++v)
  {
    const int32_t bunch = mcor_first_of(of, v);
    if (bunch != v)
    {
      of[v].first = bunch;
      of[v].next = atomic_exchange(&of[bunch].next, v);
    }
  }
  (void)slice;
}

/* Makes a list of triangles for each bunch. A triangle is listed once for each of its bunches, by
 * its first corner in the bunch. */
static void mcor_list_triangles(mcor_bunches* bunches)
{
  for (int64_t t = 0; t < bunches->triangle_count; ++t)
  {
    int32_t bunch[3];
    for (int c = 0; c < bunches->corners; ++c)
    {
      bunch[c] = bunches->of[bunches->triangles[3 * t + c]].first;
      if ((c < 1 || bunch[c] != bunch[0]) && (c < 2 || bunch[2] != bunch[1]))
      {
        bunches->before[3 * t + c] = bunches->of[bunch[c]].star;
        bunches->of[bunch[c]].star = (int32_t)(3 * t + c);
      }
    }
  }
}

/* ---- Whether bunches can be merged ---- */

/* The edges opposite to a bunch in the triangles around it. For lines: one edge, from the vertex
 * before the bunch to the vertex behind it. */
typedef struct mcor_fan
{
  int count;
  int32_t from[MCOR_FAN_LIMIT], to[MCOR_FAN_LIMIT];
} mcor_fan;

/* Finds the fan around a bunch. Returns false if the bunch cannot be contracted to a point, or if
 * its fan has too many edges. */
static bool mcor_read_fan(const mcor_bunches* bunches, int32_t bunch, mcor_fan* fan)
{
  const mcor_bunch_vertex* of = bunches->of;
  const bool lines = bunches->corners == 2;
  int size = 0, within = 0; /* triangles with two or three corners in the bunch; lines with two */
  int ends[2] = { 0, 0 };   /* lines that begin, and that end, in the bunch */
  for (int32_t v = bunch; v >= 0; v = of[v].next)
  {
    ++size;
  }
  fan->count = 0;
  for (int32_t e = of[bunch].star; e >= 0; e = bunches->before[e])
  {
    const cl_int* corner = bunches->triangles + e / 3 * 3;
    const int c = e % 3;
    const int32_t next = corner[lines ? 1 - c
                      : c < 2         ? c + 1
                                      : 0],
                  last = corner[lines ? 1 - c
                      : c > 0         ? c - 1
                                      : 2];
    if (of[next].first == bunch || of[last].first == bunch)
    {
      ++within;
    }
    else if (lines)
    {
      (c == 0 ? fan->to : fan->from)[0] = next;
      ++ends[c];
    }
    else if (fan->count == MCOR_FAN_LIMIT)
    {
      return false;
    }
    else
    {
      fan->from[fan->count] = next;
      fan->to[fan->count++] = last;
    }
  }
  fan->count += lines;
  return lines ? size - within == 1 && ends[0] == 1 && ends[1] == 1 : 2 * size - within == 2;
}

/* Whether the edges of a fan form one closed ring through different vertices; for lines, whether
 * the fan has one edge, between different vertices. */
static bool mcor_is_ring(const mcor_fan* fan, int corners)
{
  if (corners == 2 || fan->count < 3)
  {
    return corners == 2 && fan->count == 1 && fan->from[0] != fan->to[0];
  }
  int seen = 1;
  for (int32_t at = fan->to[0]; at != fan->from[0]; ++seen)
  {
    int next = 0, choices = 0;
    for (int k = 1; k < fan->count; ++k)
    {
      next = fan->from[k] == at ? k : next;
      choices += fan->from[k] == at;
    }
    if (choices != 1 || seen == fan->count)
    {
      return false;
    }
    at = fan->to[next];
  }
  return seen == fan->count;
}

/* Let the bunch be part of a closed piece, and let all bunches be merged. Returns whether the piece
 * then has at least MCOR_LEAST_PIECE vertices. Counts the bunch, the vertices of the ring around
 * it, and the vertices of all triangles around the ring. Stops when there are enough. */
static bool mcor_is_large(const mcor_bunches* bunches, int32_t bunch, const mcor_fan* ring)
{
  const int least = MCOR_LEAST_PIECE(bunches->corners);
  int32_t seen[MCOR_FAN_LIMIT + 4];
  int count = 0;
  seen[count++] = bunch;
  for (int i = 0; i < ring->count; ++i)
  {
    seen[count++] = ring->from[i];
  }
  if (bunches->corners == 2)
  {
    seen[count++] = ring->to[0];
  }
  for (int i = 1, of_ring = count; i < of_ring && count < least; ++i)
  {
    for (int32_t e = bunches->of[seen[i]].star; e >= 0 && count < least; e = bunches->before[e])
    {
      for (int c = 0; c < bunches->corners && count < least; ++c)
      {
        const int32_t other = bunches->of[bunches->triangles[e / 3 * 3 + c]].first;
        int k = 0;
        while (k < count && seen[k] != other)
        {
          ++k;
        }
        seen[k] = other;
        count += k == count;
      }
    }
  }
  return count >= least;
}

/* Whether a bunch can be merged. If `all` is set, this must hold in two cases: no other bunch is
 * merged, and all other bunches are merged. Else it must hold with the bunches merged so far. */
static bool mcor_can_merge(const mcor_bunches* bunches, int32_t bunch, bool all)
{
  mcor_fan fan, merged = { 0 };
  if (!mcor_read_fan(bunches, bunch, &fan))
  {
    return false;
  }
  for (int i = 0; i < fan.count; ++i)
  {
    const int32_t v = fan.from[i], w = fan.to[i];
    const int32_t from = all || mcor_is_merged(bunches, v) ? bunches->of[v].first : v;
    const int32_t to = all || mcor_is_merged(bunches, w) ? bunches->of[w].first : w;
    merged.from[merged.count] = from;
    merged.to[merged.count] = to;
    merged.count += from != to; /* edges within a bunch vanish */
  }
  return mcor_is_ring(&merged, bunches->corners) &&
    (!all || mcor_is_ring(&fan, bunches->corners)) && mcor_is_large(bunches, bunch, &merged);
}

/* Merges each bunch that can be merged both if all other bunches are merged and if none is. A bunch
 * that fails this test becomes unsure (MCOR_BUNCH_UNSURE). */
static void mcor_merge_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  for (int32_t v = (int32_t)first; v < last; ++v)
  {
    if (bunches->of[v].first == v && bunches->of[v].next >= 0)
    {
      mcor_set_state(
        bunches, v, mcor_can_merge(bunches, v, true) ? MCOR_BUNCH_MERGED : MCOR_BUNCH_UNSURE);
    }
  }
  (void)slice;
}

/* Sets `leans` for the unsure bunches that it chooses: they can be merged beside the bunches merged
 * so far. Of two unsure neighbours, only the one with the lower first vertex may be chosen. */
static void mcor_choose_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  for (int32_t v = (int32_t)first; v < last; ++v)
  {
    bool chosen = bunches->of[v].state == MCOR_BUNCH_UNSURE;
    for (int32_t e = chosen ? bunches->of[v].star : -1; e >= 0; e = bunches->before[e])
    {
      for (int c = 0; c < bunches->corners; ++c)
      {
        const int32_t other = bunches->of[bunches->triangles[e / 3 * 3 + c]].first;
        chosen = chosen && (other >= v || bunches->of[other].state != MCOR_BUNCH_UNSURE);
      }
    }
    bunches->of[v].leans = chosen && mcor_can_merge(bunches, v, false);
  }
  (void)slice;
}

/* Finds where merged vertices start: at the mean of each bunch's vertices. */
static void mcor_mean_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  for (int64_t i = first; i < last; ++i)
  {
    mcor_start* start = &bunches->starts.of[i];
    int64_t count = 0;
    for (int32_t v = start->vertex; v >= 0; v = bunches->of[v].next, ++count)
    {
      for (int a = 0; a < 3; ++a)
      {
        start->at[a] += bunches->points[v].at[a];
      }
    }
    for (int a = 0; a < 3; ++a)
    {
      start->at[a] /= count;
    }
  }
  (void)slice;
}

mcor_status mcor_find_bunches(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  mcor_bunch_vertex* of = bunches->of;
  const int count = bunches->vertex_count;
  MCOR_TRY(mcor_key_vertices(bunches));
  MCOR_TRY(mcor_parallel_run(
    context, bunches->triangle_count, MCOR_HEAVY_GRAIN, mcor_join_slice, bunches, NULL));
  MCOR_TRY(mcor_parallel_run(context, count, MCOR_HEAVY_GRAIN, mcor_list_vertices, bunches, NULL));
  mcor_list_triangles(bunches);
  MCOR_TRY(mcor_report_launch(context));
  MCOR_TRY(mcor_parallel_run(context, count, MCOR_HEAVY_GRAIN, mcor_merge_slice, bunches, NULL));
  MCOR_TRY(mcor_parallel_run(context, count, MCOR_LIGHT_GRAIN, mcor_choose_slice, bunches, NULL));
  for (int32_t v = 0; v < count; ++v)
  {
    if (of[v].first == v && (of[v].leans || mcor_is_merged(bunches, v)))
    {
      mcor_set_state(bunches, v, MCOR_BUNCH_MERGED);
      MCOR_APPEND(context, &bunches->starts, (mcor_start){ .vertex = v });
    }
  }
  return mcor_parallel_run(
    context, bunches->starts.count, MCOR_HEAVY_GRAIN, mcor_mean_slice, bunches, NULL);
}
