/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compact contours: merged bunches that turn triangles over, and vertices of slivers, which start
 * anew. */

#include "mcor_compact.h"
#include "mcor_parallel.h"

#include <stdlib.h>
#include <string.h>

/* ---- Bunches to be taken apart ---- */

typedef struct mcor_facing
{
  mcor_bunches* bunches;
  int round;
  double edge[3];
  void *node, *offset, *linear, *gradient;
  mcor_mapping views[4]; /* of these */
  atomic_int bad;        /* whether any bunch is bad */
  atomic_uchar* wide;    /* [vertex_count]: whether it has the widest angle of a sliver */
} mcor_facing;

static mcor_status mcor_begin_facing(mcor_bunches* bunches, int round, mcor_facing* facing)
{
  const mcor_mesh* mesh = &bunches->context->mesh;
  const size_t n = (size_t)mesh->vertex_count, real = bunches->context->cl.real_size;
  const mcor_mapping views[] = { { &mesh->node, 4 * n * sizeof(cl_int), &facing->node },
    { &mesh->offset, 4 * n * real, &facing->offset }, { &mesh->linear, n * real, &facing->linear },
    { &mesh->gradient, 4 * n * real, &facing->gradient } };
  *facing = (mcor_facing){ .bunches = bunches, .round = round };
  memcpy(facing->views, views, sizeof views);
  for (int a = 0; a < 3; ++a)
  {
    facing->edge[a] = mcor_edge_of(&bunches->context->lattice, a);
  }
  atomic_init(&facing->bad, 0);
  return mcor_map_all(bunches->context, facing->views, 4);
}

static void mcor_place_corner(const mcor_facing* facing, int64_t i, double at[3])
{
  const cl_int* node = (const cl_int*)facing->node + 4 * i;
  const double size = 1u << (node[3] >> MCOR_LEVEL_SHIFT);
  for (int a = 0; a < 3; ++a)
  {
    at[a] = (node[a] + mcor_get_real(facing->bunches->context, facing->offset, 4 * i + a)) * size *
      facing->edge[a];
  }
}

static void mcor_make_bad(mcor_facing* facing, int32_t first)
{
  if (mcor_is_merged(facing->bunches, first))
  {
    mcor_set_state(facing->bunches, first, MCOR_BUNCH_BAD);
    atomic_store_explicit(&facing->bad, 1, memory_order_relaxed);
  }
}

/* Whether a triangle, or line, is turned over: it does not face against the mean of its corners'
 * unit gradients. */
static bool mcor_is_turned(const mcor_facing* facing, const int32_t* place, int corners)
{
  const mcor_context* context = facing->bunches->context;
  double at[3][3], normal[3], against[3] = { 0, 0, 0 };
  for (int c = 0; c < corners; ++c)
  {
    const int64_t i = place[c];
    double g[3], length = 0;
    mcor_place_corner(facing, i, at[c]);
    for (int a = 0; a < 3; ++a)
    {
      g[a] = mcor_get_real(context, facing->gradient, 4 * i + a);
      length += g[a] * g[a];
    }
    for (int a = 0; a < 3 && length > 0; ++a)
    {
      against[a] -= g[a] / sqrt(length);
    }
  }
  double along = 0;
  for (int a = 0; a < 3; ++a)
  {
    const int b = (a + 1) % 3, d = (a + 2) % 3;
    normal[a] = corners == 3 ? (at[1][b] - at[0][b]) * (at[2][d] - at[0][d]) -
        (at[1][d] - at[0][d]) * (at[2][b] - at[0][b])
      : a == 0 ? at[1][1] - at[0][1]
      : a == 1 ? at[0][0] - at[1][0]
               : 0;
    along += normal[a] * against[a];
  }
  return !(along > 0);
}

static void mcor_face_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_facing* facing = data;
  const mcor_bunches* bunches = facing->bunches;
  const mcor_context* context = bunches->context;
  const int corners = bunches->corners;
  for (int64_t t = first; t < last; ++t)
  {
    const cl_int* corner = (const cl_int*)bunches->triangles + 3 * t;
    int32_t place[3], of[3];
    bool merged = false, fresh = facing->round == 0, missed = false;
    for (int c = 0; c < corners; ++c)
    {
      of[c] = bunches->first[corner[c]];
      place[c] = mcor_place_of(bunches, corner[c]);
      merged = merged || mcor_is_merged(bunches, of[c]);
      fresh = fresh || mcor_state_of(bunches, of[c]) == MCOR_BUNCH_FRESH;
    }
    if (!merged || !fresh || !mcor_is_left(place, corners))
    {
      continue;
    }
    for (int c = 0; c < corners; ++c)
    {
      if (mcor_is_merged(bunches, of[c]) && mcor_get_real(context, facing->linear, place[c]) > 0)
      {
        mcor_make_bad(facing, of[c]);
        missed = true;
      }
    }
    if (!missed && mcor_is_turned(facing, place, corners))
    {
      for (int c = 0; c < corners; ++c)
      {
        mcor_make_bad(facing, of[c]);
      }
    }
  }
  (void)slice;
}

mcor_status mcor_find_bad(mcor_bunches* bunches, int round, bool* found)
{
  mcor_facing facing;
  mcor_status status = mcor_begin_facing(bunches, round, &facing);
  status = status == MCOR_OK ? mcor_parallel_run(bunches->context, bunches->triangle_count,
                                 MCOR_LIGHT_GRAIN, mcor_face_slice, &facing, NULL)
                             : status;
  *found = atomic_load(&facing.bad);
  return mcor_unmap_all(bunches->context, facing.views, 4, status);
}

/* ---- Slivers ---- */

/* Cosine of the least angle of other triangles: of 20 degrees. */
#define MCOR_SLIVER 0.93969262

/* Farthest start from the node, in edges; a line from there ends within MCOR_POINT_EXTENT. */
#define MCOR_FARTHEST_START 1.5

/* Returns the vertex, or the first one of the merged bunch that replaced it. */
static int32_t mcor_stand_in(const mcor_bunches* bunches, int32_t v)
{
  return mcor_is_merged(bunches, bunches->first[v]) ? bunches->first[v] : v;
}

/* Finds the corners of a triangle that is left. Returns whether it is. */
static bool mcor_stand_ins(const mcor_bunches* bunches, int64_t t, int32_t of[3])
{
  const cl_int* corner = (const cl_int*)bunches->triangles + 3 * t;
  for (int c = 0; c < 3; ++c)
  {
    of[c] = mcor_stand_in(bunches, corner[c]);
  }
  return mcor_is_left(of, 3);
}

/* Returns the cosine of the least angle of a triangle, 1 if it has no area, and finds the corner
 * with the widest one. These are opposite to the shortest and to the longest side. */
static double mcor_least_angle(const double at[3][3], int* widest)
{
  double side[3]; /* squared, by the corner opposite to it */
  int least = 0;
  *widest = 0;
  for (int c = 0; c < 3; ++c)
  {
    const double *q = at[(c + 1) % 3], *r = at[(c + 2) % 3];
    const double d[3] = { r[0] - q[0], r[1] - q[1], r[2] - q[2] };
    side[c] = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    *widest = side[c] > side[*widest] ? c : *widest;
    least = side[c] < side[least] ? c : least;
  }
  const double p = side[(least + 1) % 3], q = side[(least + 2) % 3];
  return side[least] > 0 ? (p + q - side[least]) / (2 * sqrt(p * q)) : 1;
}

static void mcor_sliver_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_facing* facing = data;
  const mcor_bunches* bunches = facing->bunches;
  for (int64_t t = first; t < last; ++t)
  {
    const cl_int* corner = (const cl_int*)bunches->triangles + 3 * t;
    int32_t place[3];
    double at[3][3];
    int widest;
    for (int c = 0; c < 3; ++c)
    {
      place[c] = mcor_place_of(bunches, corner[c]);
    }
    if (!mcor_is_left(place, 3))
    {
      continue;
    }
    for (int c = 0; c < 3; ++c)
    {
      mcor_place_corner(facing, place[c], at[c]);
    }
    if (mcor_least_angle(at, &widest) > MCOR_SLIVER)
    {
      const int32_t v = mcor_stand_in(bunches, corner[widest]);
      const bool moves =
        bunches->key[v] != MCOR_FROZEN && (!bunches->held[v] || mcor_is_merged(bunches, v));
      atomic_store_explicit(&facing->wide[v], moves, memory_order_relaxed);
    }
  }
  (void)slice;
}

/* Finds the middle of the vertices around one, from its node, in edges. The sum is one of whole
 * numbers, so that its order does not count. Returns whether the vertex may start there. */
static bool mcor_find_middle(const mcor_facing* facing, int32_t v, double start[3])
{
  const mcor_bunches* bunches = facing->bunches;
  int64_t sum[3] = { 0 }, count = 0;
  for (int32_t e = bunches->star[bunches->first[v]]; e >= 0; e = bunches->before[e])
  {
    int32_t of[3];
    const bool is_around = mcor_stand_ins(bunches, e / 3, of) && of[e % 3] == v;
    for (int c = 1; c < 3 && is_around; ++c, ++count)
    {
      const int32_t w = of[(e + c) % 3];
      double at[3];
      if (w < v && atomic_load_explicit(&facing->wide[w], memory_order_relaxed))
      {
        return false; /* no two vertices beside each other move */
      }
      mcor_place_corner(facing, mcor_place_of(bunches, w), at);
      for (int a = 0; a < 3; ++a)
      {
        sum[a] += llround(ldexp(at[a] / facing->edge[a], 20));
      }
    }
  }
  const cl_int* node = (const cl_int*)facing->node + 4 * (int64_t)mcor_place_of(bunches, v);
  bool is_near = count > 0;
  for (int a = 0; a < 3 && is_near; ++a)
  {
    start[a] = ldexp((double)sum[a] / (double)count, -20 - (node[3] >> MCOR_LEVEL_SHIFT)) - node[a];
    is_near = fabs(start[a]) <= MCOR_FARTHEST_START;
  }
  return is_near;
}

/* Returns the cosine of the least angle around a vertex; 2 if a triangle is turned over. */
static double mcor_worst_around(const mcor_facing* facing, int32_t v)
{
  const mcor_bunches* bunches = facing->bunches;
  double worst = -1;
  for (int32_t e = bunches->star[bunches->first[v]]; e >= 0; e = bunches->before[e])
  {
    int32_t of[3], place[3];
    double at[3][3];
    int widest;
    if (mcor_stand_ins(bunches, e / 3, of) && of[e % 3] == v)
    {
      for (int c = 0; c < 3; ++c)
      {
        place[c] = mcor_place_of(bunches, of[c]);
        mcor_place_corner(facing, place[c], at[c]);
      }
      worst = fmax(worst, mcor_is_turned(facing, place, 3) ? 2 : mcor_least_angle(at, &widest));
    }
  }
  return worst;
}

/* Lists the vertices that move in `order`, and their starts. */
static mcor_status mcor_list_moving(
  mcor_bunches* bunches, atomic_uchar* wide, double (*starts)[3], int* count)
{
  mcor_facing facing;
  mcor_status status = mcor_begin_facing(bunches, 0, &facing);
  facing.wide = wide;
  status = status == MCOR_OK ? mcor_parallel_run(bunches->context, bunches->triangle_count,
                                 MCOR_LIGHT_GRAIN, mcor_sliver_slice, &facing, NULL)
                             : status;
  for (int32_t v = 0; v < bunches->vertex_count && status == MCOR_OK; ++v)
  {
    if (wide[v] && mcor_find_middle(&facing, v, starts[*count]))
    {
      bunches->order[(*count)++] = mcor_is_merged(bunches, bunches->first[v]) ? -1 - v : v;
    }
  }
  return mcor_unmap_all(bunches->context, facing.views, 4, status);
}

/* Puts vertices back that did not reach the surface, or that made no angle around them better. */
static mcor_status mcor_put_back(mcor_bunches* bunches, const int32_t* before, int count)
{
  mcor_facing facing;
  const mcor_status status = mcor_begin_facing(bunches, 0, &facing);
  for (int i = 0; i < count && status == MCOR_OK; ++i)
  {
    const int32_t v = mcor_vertex_of(bunches->order[i]);
    int32_t* place = mcor_place_in(bunches, bunches->order[i]);
    const int32_t now = *place;
    const double worst = mcor_worst_around(&facing, v);
    *place = before[i];
    *place = mcor_get_real(bunches->context, facing.linear, now) <= 0 &&
        worst < mcor_worst_around(&facing, v)
      ? now
      : before[i];
  }
  return mcor_unmap_all(bunches->context, facing.views, 4, status);
}

/* A vertex with the widest angle of a sliver starts anew from the middle of the vertices around
 * it. */
mcor_status mcor_move_slivers(mcor_bunches* bunches)
{
  const size_t n = (size_t)bunches->vertex_count;
  if (bunches->corners == 2)
  {
    return MCOR_OK;
  }
  atomic_uchar* wide = calloc(n, sizeof *wide);
  double(*starts)[3] = malloc(n * sizeof *starts);
  int32_t* before = malloc(n * sizeof *before);
  int count = 0;
  mcor_status status = mcor_allocated(bunches->context, wide && starts && before);
  status = status == MCOR_OK ? mcor_list_moving(bunches, wide, starts, &count) : status;
  for (int i = 0; i < count && status == MCOR_OK; ++i)
  {
    before[i] = *mcor_place_in(bunches, bunches->order[i]);
  }
  if (status == MCOR_OK && count > 0)
  {
    status = mcor_add_vertices(bunches, true, starts, count);
    status = status == MCOR_OK ? mcor_put_back(bunches, before, count) : status;
  }
  free(wide);
  free(starts);
  free(before);
  return status;
}
