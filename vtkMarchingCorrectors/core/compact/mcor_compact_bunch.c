/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Bunches of a marched mesh, and which of them may be merged.
 *
 * Merging must leave a manifold with the same pieces. It does if each merged bunch can be
 * contracted to a point, and if any two vertices of the result are joined by one edge at most. This
 * edge replaces edges beside each other and the triangles between them. The second condition is
 * tested for pairs of two bunches, or of a bunch and a vertex. A bunch is
 *   - sure, if its triangles are one closed fan of three or more different vertices, both if all
 *     other bunches are merged and if none is;
 *   - leaning, if this holds if only sure bunches are merged. If a sure bunch beside it is taken
 *     apart, so is the leaning bunch.
 * Of two bunches that must not both be merged, the first is merged. A bunch therefore depends only
 * on the cells near it, whatever part of the surface a call makes, and may be taken apart at any
 * time. A closed piece that would keep fewer than 8 triangles stays as it is. */

#include "mcor_cap.h"
#include "mcor_compact.h"
#include "mcor_parallel.h"

#include <stdlib.h>
#include <string.h>

/* Most edges of a fan; a bunch with more stays apart. */
#define MCOR_FAN_LIMIT 48

/* A closed piece keeps at least this number of triangles, or lines. */
#define MCOR_LEAST_PIECE(corners) ((corners) == 3 ? 8 : 4)

/* ---- Nodes ---- */

/* Vertices on these sides, of periods or caps, stay. node: the side's coordinate along its axis. */
typedef struct mcor_frozen
{
  const mcor_bunches* bunches;
  int count, axis[12], node[12];
} mcor_frozen;

/* Gives vertices the keys of their nodes. A vertex belongs to the end of its edge that is nearer by
 * linear interpolation; if both are equally near, to the lower end. Neighbouring levels differ by
 * one, so the level's last bit distinguishes them. Vertices on a side, or on the border that the
 * node threshold leaves, stay. */
static void mcor_key_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_frozen* frozen = data;
  const mcor_bunches* bunches = frozen->bunches;
  const mcor_context* context = bunches->context;
  for (int64_t v = first; v < last; ++v)
  {
    const cl_int* node = mcor_marched_node(bunches, (int32_t)v);
    const int axis = node[3] & 3, level = node[3] >> MCOR_LEVEL_SHIFT;
    const bool is_upper = fabs(mcor_get_real(context, bunches->ends, 2 * v)) >
      fabs(mcor_get_real(context, bunches->ends, 2 * v + 1));
    bool stays = node[3] >> 2 & 1;
    for (int i = 0; i < frozen->count; ++i)
    {
      const int a = frozen->axis[i];
      stays = stays || (a != axis && node[a] << level == frozen->node[i]);
    }
    cl_int at[3] = { node[0], node[1], node[2] };
    at[axis] += is_upper;
    bunches->key[v] = stays ? MCOR_FROZEN : mcor_cap_key(at) ^ (uint64_t)(level & 1) << 63;
  }
  (void)slice;
}

static mcor_status mcor_key_vertices(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  const mcor_mesh* mesh = &context->mesh;
  const mcor_lattice* lattice = &context->lattice;
  mcor_frozen frozen = { .bunches = bunches };
  for (int i = 0; i < 12; ++i)
  {
    const int axis = i % 6 / 2, upper = i % 2, period = lattice->period[axis];
    const int node = i < 6 ? mcor_cap_plane(context, axis, upper)
      : period > 0         ? lattice->period_first[axis] + upper * period
                           : -1;
    if (node >= 0)
    {
      frozen.axis[frozen.count] = axis;
      frozen.node[frozen.count++] = node;
    }
  }
  MCOR_TRY(mcor_parallel_run(
    context, bunches->march_count, MCOR_LIGHT_GRAIN, mcor_key_slice, &frozen, NULL));
  /* Freezes vertices of cuts and caps, and vertices beside caps; holds vertices beside cuts. */
  for (int v = mesh->march_count; v < mesh->vertex_count; ++v)
  {
    bunches->key[v] = MCOR_FROZEN;
  }
  for (int64_t c = 3 * (int64_t)mesh->cap_triangle_first; c < 3 * (int64_t)mesh->triangle_count;
       ++c)
  {
    bunches->key[bunches->triangles[c]] = MCOR_FROZEN;
  }
  for (int i = 0; i < bunches->cut_count; ++i)
  {
    bunches->held[bunches->cut[i] >> 32] = bunches->held[bunches->cut[i] & UINT32_MAX] = 1;
  }
  return MCOR_OK;
}

/* ---- Bunches ---- */

/* Finds the corners of a triangle, as the first vertices of their bunches. */
static void mcor_bunches_of(const mcor_bunches* bunches, int64_t t, int32_t of[3])
{
  const cl_int* corner = bunches->triangles + 3 * t;
  for (int c = 0; c < 3; ++c)
  {
    of[c] = bunches->first[corner[c]];
  }
}

/* Returns the first vertex to which v is joined so far. */
static int32_t mcor_first_of(int32_t* first, int32_t v)
{
  while (first[v] != v)
  {
    first[v] = first[first[v]];
    v = first[v];
  }
  return v;
}

static void mcor_join_vertices(mcor_bunches* bunches)
{
  const cl_int* corner = bunches->triangles;
  int32_t* first = bunches->first;
  for (int64_t t = 0; t < bunches->triangle_count; ++t, corner += 3)
  {
    const int32_t v[3] = { corner[0], corner[1], corner[2] };
    const uint64_t key[3] = { bunches->key[v[0]], bunches->key[v[1]], bunches->key[v[2]] };
    for (int c = 0; c < 3; ++c)
    {
      const int d = c < 2 ? c + 1 : 0;
      if (key[c] == key[d] && key[c] != MCOR_FROZEN)
      {
        const int32_t p = mcor_first_of(first, v[c]), q = mcor_first_of(first, v[d]);
        first[p > q ? p : q] = p > q ? q : p;
      }
    }
  }
  for (int32_t v = 0; v < bunches->vertex_count; ++v)
  {
    first[v] = first[first[v]]; /* first[v] already has its bunch's first vertex */
  }
  for (int32_t v = bunches->vertex_count - 1; v >= 0; --v)
  {
    if (first[v] != v)
    {
      bunches->next[v] = bunches->next[first[v]];
      bunches->next[first[v]] = v;
    }
  }
}

/* ---- Whether they can be merged ---- */

/* The edges opposite to a bunch in its triangles, in their order around it. For lines: one edge
 * from the vertex before the bunch to the vertex behind it. */
typedef struct mcor_fan
{
  int count;
  int32_t from[MCOR_FAN_LIMIT], to[MCOR_FAN_LIMIT];
} mcor_fan;

static int mcor_size_of(const mcor_bunches* bunches, int32_t bunch)
{
  int size = 1;
  for (int32_t v = bunch; bunches->next[v] >= 0; v = bunches->next[v])
  {
    ++size;
  }
  return size;
}

/* Finds the fan around a bunch. Returns false if the bunch cannot be contracted to a point, or has
 * no fan. */
static bool mcor_read_fan(const mcor_bunches* bunches, int32_t bunch, mcor_fan* fan)
{
  int within = 0; /* triangles with two or three corners in the bunch; lines with two */
  if (bunches->corners == 2)
  {
    int before = 0, behind = 0;
    for (int32_t e = bunches->star[bunch]; e >= 0; e = bunches->before[e])
    {
      const cl_int* corner = bunches->triangles + e / 3 * 3;
      const int c = e % 3;
      const bool joins = bunches->first[corner[0]] == bunches->first[corner[1]];
      within += joins && c == 0;
      before += !joins && c == 1;
      behind += !joins && c == 0;
      fan->from[0] = !joins && c == 1 ? corner[0] : fan->from[0];
      fan->to[0] = !joins && c == 0 ? corner[1] : fan->to[0];
    }
    fan->count = 1;
    return mcor_size_of(bunches, bunch) - within == 1 && before == 1 && behind == 1;
  }
  fan->count = 0;
  for (int32_t e = bunches->star[bunch]; e >= 0; e = bunches->before[e])
  {
    const cl_int* corner = bunches->triangles + e / 3 * 3;
    const int c = e % 3;
    const int32_t next = corner[c < 2 ? c + 1 : 0], last = corner[c > 0 ? c - 1 : 2];
    if (bunches->first[next] == bunch || bunches->first[last] == bunch)
    {
      ++within;
      continue;
    }
    if (fan->count == MCOR_FAN_LIMIT)
    {
      return false;
    }
    fan->from[fan->count] = next;
    fan->to[fan->count++] = last;
  }
  return 2 * mcor_size_of(bunches, bunch) - within == 2;
}

/* Replaces vertices around a bunch by their bunches: by all bunches, or only by sure ones. Edges
 * within a bunch vanish. */
static void mcor_merge_fan(
  const mcor_bunches* bunches, bool all, const mcor_fan* from, mcor_fan* to)
{
  to->count = 0;
  for (int i = 0; i < from->count; ++i)
  {
    const int32_t v = from->from[i], w = from->to[i], p = bunches->first[v], q = bunches->first[w];
    const int32_t begin = all || mcor_state_of(bunches, p) == MCOR_BUNCH_MERGED ? p : v;
    const int32_t end = all || mcor_state_of(bunches, q) == MCOR_BUNCH_MERGED ? q : w;
    if (begin != end)
    {
      to->from[to->count] = begin;
      to->to[to->count++] = end;
    }
  }
}

/* Whether the edges form one closed ring through different vertices; for lines, whether the two
 * ends differ. Sorts the edges along the ring. */
static bool mcor_is_ring(mcor_fan* fan, int corners)
{
  const int count = fan->count;
  if (corners == 2)
  {
    return count == 1 && fan->from[0] != fan->to[0];
  }
  for (int i = 0; i + 1 < count; ++i)
  {
    const int32_t at = fan->to[i];
    int next = 0, choices = 0;
    for (int k = i + 1; k < count; ++k)
    {
      next = fan->from[k] == at ? k : next;
      choices += fan->from[k] == at;
    }
    if (choices != 1 || at == fan->from[0])
    {
      return false;
    }
    const int32_t to = fan->to[next];
    fan->from[next] = fan->from[i + 1];
    fan->to[next] = fan->to[i + 1];
    fan->from[i + 1] = at;
    fan->to[i + 1] = to;
  }
  return count >= 3 && fan->to[count - 1] == fan->from[0];
}

/* Whether a closed piece would keep enough triangles: counts the triangles of a bunch and of the
 * bunches around it, as if all were merged. */
static bool mcor_is_large(const mcor_bunches* bunches, int32_t bunch, const mcor_fan* fan)
{
  const bool lines = bunches->corners == 2;
  const int least = MCOR_LEAST_PIECE(bunches->corners);
  int32_t near[MCOR_LEAST_PIECE(3) + 2];
  int count = 1, triangles = lines ? 2 : fan->count;
  if (triangles >= least)
  {
    return true;
  }
  near[0] = bunch;
  for (int i = 0; i < fan->count; ++i)
  {
    near[count++] = fan->from[i];
  }
  if (lines && fan->count == 1)
  {
    near[count++] = fan->to[0];
  }
  for (int i = 1; i < count; ++i)
  {
    for (int32_t e = bunches->star[near[i]]; e >= 0 && triangles < least; e = bunches->before[e])
    {
      int32_t of[3];
      mcor_bunches_of(bunches, e / 3, of);
      bool counts = mcor_is_left(of, bunches->corners);
      for (int j = 0; j < i; ++j)
      {
        counts = counts && of[0] != near[j] && of[1] != near[j] && of[2] != near[j];
      }
      triangles += counts;
    }
  }
  return triangles >= least;
}

/* Finds which bunches are sure, and which of the others may be leaning, or clash with a bunch
 * beside them. */
static void mcor_test_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  for (int32_t v = (int32_t)first; v < last; ++v)
  {
    mcor_fan fan, merged;
    if (bunches->first[v] != v || bunches->next[v] < 0 || !mcor_read_fan(bunches, v, &fan))
    {
      continue; /* this bunch stays apart */
    }
    mcor_merge_fan(bunches, true, &fan, &merged);
    mcor_set_state(bunches, v,
      !mcor_is_large(bunches, v, &merged)          ? MCOR_BUNCH_APART
        : !mcor_is_ring(&merged, bunches->corners) ? MCOR_BUNCH_CLASHES
        : mcor_is_ring(&fan, bunches->corners)     ? MCOR_BUNCH_MERGED
                                                   : MCOR_BUNCH_LEANING);
  }
  (void)slice;
}

/* Finds which bunches that are not sure can be merged. */
static void mcor_lean_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  for (int32_t v = (int32_t)first; v < last; ++v)
  {
    const int state = bunches->first[v] == v ? mcor_state_of(bunches, v) : MCOR_BUNCH_APART;
    if (state != MCOR_BUNCH_CLASHES && state != MCOR_BUNCH_LEANING)
    {
      continue;
    }
    mcor_fan fan, merged;
    bool merges = mcor_read_fan(bunches, v, &fan);
    for (int i = 0; i < fan.count && state == MCOR_BUNCH_CLASHES; ++i)
    {
      const int32_t p = bunches->first[fan.from[i]], q = bunches->first[fan.to[i]];
      merges = merges && (p > v || mcor_state_of(bunches, p) != MCOR_BUNCH_CLASHES) &&
        (q > v || mcor_state_of(bunches, q) != MCOR_BUNCH_CLASHES);
    }
    mcor_merge_fan(bunches, false, &fan, &merged);
    bunches->leans[v] = merges && mcor_is_ring(&merged, bunches->corners);
  }
  (void)slice;
}

mcor_status mcor_find_bunches(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  const size_t n = (size_t)bunches->vertex_count;
  MCOR_TRY(mcor_key_vertices(bunches));
  for (int32_t v = 0; v < bunches->vertex_count; ++v)
  {
    bunches->first[v] = v;
  }
  memset(bunches->next, 0xff, n * sizeof *bunches->next);
  memset(bunches->star, 0xff, n * sizeof *bunches->star);
  mcor_join_vertices(bunches);
  MCOR_TRY(mcor_report_launch(context));
  /* Lists the triangles of each bunch, each once, by its first corner in the bunch. */
  for (int64_t t = 0; t < bunches->triangle_count; ++t)
  {
    int32_t of[3];
    mcor_bunches_of(bunches, t, of);
    for (int c = 0; c < bunches->corners; ++c)
    {
      if ((c < 1 || of[c] != of[0]) && (c < 2 || of[2] != of[1]))
      {
        bunches->before[3 * t + c] = bunches->star[of[c]];
        bunches->star[of[c]] = (int32_t)(3 * t + c);
      }
    }
  }
  MCOR_TRY(mcor_report_launch(context));
  MCOR_TRY(mcor_parallel_run(
    context, bunches->vertex_count, MCOR_HEAVY_GRAIN, mcor_test_slice, bunches, NULL));
  MCOR_TRY(mcor_parallel_run(
    context, bunches->vertex_count, MCOR_LIGHT_GRAIN, mcor_lean_slice, bunches, NULL));
  for (int32_t v = 0; v < bunches->vertex_count; ++v)
  {
    const int state = mcor_state_of(bunches, v);
    if (state == MCOR_BUNCH_CLASHES || state == MCOR_BUNCH_LEANING)
    {
      mcor_set_state(bunches, v, bunches->leans[v] ? MCOR_BUNCH_LEANING : MCOR_BUNCH_APART);
    }
  }
  return MCOR_OK;
}
