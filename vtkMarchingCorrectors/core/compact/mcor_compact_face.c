/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compact contours: finds merged bunches that turn triangles over, and moves vertices of slivers. */

#include "mcor_compact.h"
#include "mcor_parallel.h"
#include "mcor_vector.h"

#include <stdlib.h>

/* ---- Points ---- */

/* A vertex of the mesh. */
struct mcor_point
{
  double at[3], uphill[3]; /* uphill: unit gradient, or 0 without a gradient */
  double linear;           /* above 0: the vertex did not reach the surface */
};

typedef struct mcor_placing
{
  mcor_bunches* bunches;
  void *node, *offset, *linear, *gradient;
} mcor_placing;

static void mcor_place_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_placing* from = data;
  const mcor_bunches* bunches = from->bunches;
  const mcor_context* context = bunches->context;
  for (int64_t i = bunches->point_count + first; i < bunches->point_count + last; ++i)
  {
    mcor_point* point = &bunches->points[i];
    const cl_int* node = (const cl_int*)from->node + 4 * i;
    const double size = 1u << (node[3] >> MCOR_LEVEL_SHIFT);
    for (int a = 0; a < 3; ++a)
    {
      point->at[a] = (node[a] + mcor_get_real(context, from->offset, 4 * i + a)) * size *
        mcor_edge_of(&context->lattice, a);
      point->uphill[a] = mcor_get_real(context, from->gradient, 4 * i + a);
    }
    mcor_normalise(point->uphill);
    point->linear = mcor_get_real(context, from->linear, i);
  }
  (void)slice;
}

static void mcor_now_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  for (int64_t v = first; v < last; ++v)
  {
    bunches->now[v] = mcor_place_of(bunches, (int32_t)v);
  }
  (void)slice;
}

mcor_status mcor_find_places(mcor_bunches* bunches)
{
  return mcor_parallel_run(
    bunches->context, bunches->vertex_count, MCOR_LIGHT_GRAIN, mcor_now_slice, bunches, NULL);
}

/* Reads the vertices that were added to the mesh since the last call. */
static mcor_status mcor_update_points(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)mesh->vertex_count, real = context->cl.real_size;
  if (bunches->point_count == mesh->vertex_count)
  {
    return MCOR_OK;
  }
  if (mesh->vertex_count > bunches->point_room)
  {
    const size_t room = n + n / 4;
    mcor_point* points = realloc(bunches->points, room * sizeof *points);
    MCOR_TRY(mcor_allocated(context, points));
    mcor_use_large_pages(
      points + bunches->point_count, (room - (size_t)bunches->point_count) * sizeof *points);
    bunches->points = points;
    bunches->point_room = (int64_t)room;
  }
  mcor_placing from = { .bunches = bunches };
  const mcor_mapping views[] = { { &mesh->node, 4 * n * sizeof(cl_int), &from.node },
    { &mesh->offset, 4 * n * real, &from.offset }, { &mesh->linear, n * real, &from.linear },
    { &mesh->gradient, 4 * n * real, &from.gradient } };
  mcor_status status = mcor_map_all(context, views, 4);
  MCOR_THEN(status,
    mcor_parallel_run(context, mesh->vertex_count - bunches->point_count, MCOR_LIGHT_GRAIN,
      mcor_place_slice, &from, NULL));
  bunches->point_count = mesh->vertex_count;
  return mcor_unmap_all(context, views, 4, status);
}

/* ---- Bunches to be taken apart ---- */

static void mcor_make_bad(mcor_bunches* bunches, int32_t first)
{
  if (mcor_is_merged(bunches, first))
  {
    mcor_set_state(bunches, first, MCOR_BUNCH_BAD);
    atomic_store_explicit(&bunches->bad, 1, memory_order_relaxed);
  }
}

/* Whether a triangle, or line, is turned over: its normal and the sum of its corners' unit
 * gradients point to the same side, or are at a right angle. */
static bool mcor_is_turned(const mcor_bunches* bunches, const int32_t place[3])
{
  const mcor_point *p = &bunches->points[place[0]], *q = &bunches->points[place[1]];
  double u[3], v[3], against[3];
  mcor_subtract(q->at, p->at, u);
  double normal[3] = { u[1], -u[0], 0 };
  for (int a = 0; a < 3; ++a)
  {
    against[a] = -p->uphill[a] - q->uphill[a];
  }
  if (bunches->corners == 3)
  {
    const mcor_point* r = &bunches->points[place[2]];
    mcor_subtract(r->at, p->at, v);
    mcor_cross(u, v, normal);
    mcor_subtract(against, r->uphill, against);
  }
  return !(mcor_dot(normal, against) > 0);
}

static void mcor_face_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_bunches* bunches = data;
  const int corners = bunches->corners;
  for (int64_t t = first; t < last; ++t)
  {
    int32_t place[3], of[3];
    bool merged = false, fresh = bunches->round == 0, missed = false;
    if (!mcor_places_of(bunches, t, place))
    {
      continue;
    }
    for (int c = 0; c < corners; ++c)
    {
      of[c] = bunches->first[bunches->triangles[3 * t + c]];
      const int state = mcor_state_of(bunches, of[c]);
      merged = merged || state >= MCOR_BUNCH_MERGED;
      fresh = fresh || state == MCOR_BUNCH_FRESH;
    }
    if (!merged || !fresh)
    {
      continue;
    }
    for (int c = 0; c < corners; ++c)
    {
      if (bunches->points[place[c]].linear > 0 && mcor_is_merged(bunches, of[c]))
      {
        mcor_make_bad(bunches, of[c]);
        missed = true;
      }
    }
    if (!missed && mcor_is_turned(bunches, place))
    {
      for (int c = 0; c < corners; ++c)
      {
        mcor_make_bad(bunches, of[c]);
      }
    }
  }
  (void)slice;
}

mcor_status mcor_find_bad(mcor_bunches* bunches)
{
  atomic_store(&bunches->bad, 0);
  MCOR_TRY(mcor_update_points(bunches));
  MCOR_TRY(mcor_find_places(bunches));
  return mcor_parallel_run(
    bunches->context, bunches->triangle_count, MCOR_LIGHT_GRAIN, mcor_face_slice, bunches, NULL);
}

/* ---- Slivers ---- */

/* A triangle with a larger mcor_sharpness is a sliver: its least angle is below 20 degrees. */
#define MCOR_SLIVER (4 * 0.93969262 * 0.93969262)

/* Farthest start from a vertex's node, in edges; a line from this start ends within
 * MCOR_POINT_EXTENT. */
#define MCOR_FARTHEST_START 1.5

/* Returns vertex v, or the first vertex of the merged bunch that replaced it. */
static int32_t mcor_stand_in(const mcor_bunches* bunches, int32_t v)
{
  return mcor_is_merged(bunches, bunches->first[v]) ? bunches->first[v] : v;
}

/* Finds the corners of a triangle, see mcor_stand_in. Returns whether the triangle is left and has
 * the corner v. */
static bool mcor_is_around(const mcor_bunches* bunches, int64_t t, int32_t v, int32_t of[3])
{
  const cl_int* corner = bunches->triangles + 3 * t;
  for (int c = 0; c < 3; ++c)
  {
    of[c] = mcor_stand_in(bunches, corner[c]);
  }
  return mcor_is_left(of, 3) && (of[0] == v || of[1] == v || of[2] == v);
}

/* Returns four times the squared cosine of a triangle's least angle, which is opposite to the
 * shortest side; 4 if it has no area. side: squared lengths, by the opposite corner. */
static double mcor_sharpness(const mcor_bunches* bunches, const int32_t place[3], double side[3])
{
  for (int c = 0; c < 3; ++c)
  {
    const double *q = bunches->points[place[c < 2 ? c + 1 : 0]].at,
                 *r = bunches->points[place[c > 0 ? c - 1 : 2]].at;
    double d[3];
    mcor_subtract(r, q, d);
    side[c] = mcor_dot(d, d);
  }
  const double low = side[0] < side[1] ? side[0] : side[1],
               high = side[0] < side[1] ? side[1] : side[0], least = low < side[2] ? low : side[2],
               rest = low < side[2] ? side[2] : low, along = high + rest - least;
  return high * rest > 0 ? along * along / (high * rest) : 4;
}

static void mcor_sliver_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  for (int64_t t = first; t < last; ++t)
  {
    int32_t place[3];
    double side[3];
    if (mcor_places_of(bunches, t, place) && mcor_sharpness(bunches, place, side) > MCOR_SLIVER)
    {
      const int widest = side[2] > fmax(side[0], side[1]) ? 2 : side[1] > side[0];
      const int32_t v = mcor_stand_in(bunches, bunches->triangles[3 * t + widest]);
      const bool moves =
        bunches->key[v] != MCOR_FROZEN && (!bunches->held[v] || mcor_is_merged(bunches, v));
      atomic_store_explicit(&bunches->wide[v], moves, memory_order_relaxed);
    }
  }
  (void)slice;
}

/* Finds the middle of the vertices around v, in edges from v's node. Adds whole numbers, so that
 * the order does not matter. Returns whether the vertex may start there. */
static bool mcor_find_middle(const mcor_bunches* bunches, int32_t v, double start[3])
{
  cl_int node[4];
  int64_t sum[3] = { 0 }, count = 0;
  for (int32_t e = bunches->star[bunches->first[v]]; e >= 0; e = bunches->before[e])
  {
    int32_t of[3];
    const bool is_around = mcor_is_around(bunches, e / 3, v, of);
    for (int c = 0; c < 3 && is_around; ++c)
    {
      const int32_t w = of[c];
      if (w == v)
      {
        continue;
      }
      ++count;
      if (w < v && atomic_load_explicit(&bunches->wide[w], memory_order_relaxed))
      {
        return false; /* of two vertices beside each other, only the first moves */
      }
      for (int a = 0; a < 3; ++a)
      {
        const double at = bunches->points[bunches->now[w]].at[a];
        sum[a] += llround(ldexp(at / mcor_edge_of(&bunches->context->lattice, a), 20));
      }
    }
  }
  mcor_entry_node(bunches, mcor_is_merged(bunches, bunches->first[v]) ? -1 - v : v, node);
  bool is_near = count > 0;
  for (int a = 0; a < 3 && is_near; ++a)
  {
    start[a] = ldexp((double)sum[a] / (double)count, -20 - (node[3] >> MCOR_LEVEL_SHIFT)) - node[a];
    is_near = fabs(start[a]) <= MCOR_FARTHEST_START;
  }
  return is_near;
}

/* Returns the greatest mcor_sharpness of triangles around a vertex; 8 if one is turned over. */
static double mcor_worst_around(const mcor_bunches* bunches, int32_t v)
{
  double worst = -1;
  for (int32_t e = bunches->star[bunches->first[v]]; e >= 0; e = bunches->before[e])
  {
    int32_t of[3], place[3];
    double side[3];
    if (mcor_is_around(bunches, e / 3, v, of))
    {
      for (int c = 0; c < 3; ++c)
      {
        place[c] = mcor_place_of(bunches, of[c]);
      }
      worst =
        fmax(worst, mcor_is_turned(bunches, place) ? 8 : mcor_sharpness(bunches, place, side));
    }
  }
  return worst;
}

/* Moves each vertex at the widest angle of a sliver to the middle of the vertices around it, and
 * corrects it from there. Puts it back if it does not reach the surface, or if the worst triangle
 * around it gets no better. */
mcor_status mcor_move_slivers(mcor_bunches* bunches)
{
  if (bunches->corners == 2)
  {
    return MCOR_OK;
  }
  double(*starts)[3] = malloc((size_t)bunches->vertex_count * sizeof *starts);
  int32_t* before = bunches->order + bunches->vertex_count; /* uses the second half of `order` */
  int count = 0;
  mcor_status status = mcor_allocated(bunches->context, starts);
  MCOR_THEN(status, mcor_update_points(bunches));
  MCOR_THEN(status, mcor_find_places(bunches));
  MCOR_THEN(status,
    mcor_parallel_run(bunches->context, bunches->triangle_count, MCOR_LIGHT_GRAIN,
      mcor_sliver_slice, bunches, NULL));
  for (int32_t v = 0; v < bunches->vertex_count && status == MCOR_OK; ++v)
  {
    if (bunches->wide[v] && mcor_find_middle(bunches, v, starts[count]))
    {
      bunches->order[count] = mcor_is_merged(bunches, bunches->first[v]) ? -1 - v : v;
      before[count] = *mcor_place_in(bunches, bunches->order[count]);
      ++count;
    }
  }
  if (count > 0)
  {
    MCOR_THEN(status, mcor_add_vertices(bunches, starts, count));
    MCOR_THEN(status, mcor_update_points(bunches));
  }
  free(starts);
  for (int i = 0; i < count && status == MCOR_OK; ++i)
  {
    const int32_t v = mcor_vertex_of(bunches->order[i]);
    int32_t* place = mcor_place_in(bunches, bunches->order[i]);
    const int32_t now = *place;
    const double worst = mcor_worst_around(bunches, v);
    *place = before[i];
    if (bunches->points[now].linear <= 0 && worst < mcor_worst_around(bunches, v))
    {
      *place = now;
    }
  }
  return status;
}
