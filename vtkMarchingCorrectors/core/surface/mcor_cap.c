/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Caps close the surface at the sides of a period, and of a box, where that is asked for, around what is above the iso value. Each square of
 * a side is cut as marching cuts it: along the lines between the surface's own vertices there, which
 * the cap shares. The other vertices are nodes. Where the surface is trimmed the cap is, too: at the
 * surface's own cut vertices, and linearly within the side. A square is capped where the cell beside
 * it is valid.
 *
 * Vertices of caps come after all others of the mesh, and take part in what is evaluated there. They are
 * numbered as squares meet them: by axis, lower and upper side, then square by square. A box caps the
 * squares of its cells, and of the ring around it: so its own squares' vertices have the keys, and the order,
 * that they have in the whole. */

#include "mcor_box.h"
#include "mcor_cap_job.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A cut keeps off the ends of its line, as those of the surface do. */
#define MCOR_CAP_CUT_MARGIN 1e-5

/* Corner of a polygon: a vertex of the mesh; where it is, in cubes from the lattice's origin; how far
 * inside of what trimming leaves. */
typedef struct mcor_cap_corner
{
  int32_t vertex;
  double at[3], margin;
} mcor_cap_corner;

/* Of a node; the virtual grid has not more than 2^20 + 64 along an axis. */
static uint64_t mcor_cap_key(const cl_int node[3])
{
  return (uint64_t)node[0] | (uint64_t)node[1] << 21 | (uint64_t)node[2] << 42 | UINT64_C(1) << 63;
}

/* ---- vertices ---------------------------------------------------------------------------------- */

/* Room for one more element of an array. */
static bool mcor_cap_room(void** array, int64_t count, int64_t* room, size_t width)
{
  if (count < *room)
  {
    return true;
  }
  const int64_t more = 2 * *room + 1024;
  void* grown = realloc(*array, (size_t)more * width);
  *array = grown ? grown : *array;
  *room = grown ? more : *room;
  return grown != NULL;
}

static mcor_status mcor_add_cap_vertex(mcor_cap_job* job, const double at[3], bool is_cut)
{
  mcor_context* context = job->context;
  MCOR_RETURN_IF(job->old_count + job->vertex_count >= MCOR_COUNT_LIMIT, context,
    MCOR_OUT_OF_CAPACITY, "The caps have too many vertices. Use a larger cube size.");
  if (!mcor_cap_room(
        (void**)&job->vertices, job->vertex_count, &job->vertex_room, sizeof *job->vertices))
  {
    return mcor_no_cap_memory(context);
  }
  mcor_cap_vertex* vertex = &job->vertices[job->vertex_count++];
  *vertex = (mcor_cap_vertex){ .is_cut = is_cut, .key = { job->square, job->lookups } };
  for (int a = 0; a < 3; ++a)
  {
    vertex->node[a] = (cl_int)floor(at[a]);
    vertex->offset[a] = at[a] - vertex->node[a];
  }
  return MCOR_OK;
}

/* Of a map's key, a vertex that is made where there is none. */
static mcor_status mcor_find_cap_vertex(
  mcor_cap_job* job, mcor_cap_map* map, uint64_t key, const double at[3], bool is_cut, int32_t* v)
{
  const int32_t next = (int32_t)(job->old_count + job->vertex_count);
  ++job->lookups;
  *v = mcor_cap_number(map, key, next);
  if (*v < 0)
  {
    return mcor_no_cap_memory(job->context);
  }
  return *v == next ? mcor_add_cap_vertex(job, at, is_cut) : MCOR_OK;
}

/* Node (u, v) of the side. */
static mcor_status mcor_cap_node_corner(
  mcor_cap_job* job, const mcor_cap_face* face, int u, int v, mcor_cap_corner* corner)
{
  cl_int node[3];
  node[face->axis] = face->plane;
  node[face->across[0]] = face->first[0] + u;
  node[face->across[1]] = face->first[1] + v;
  for (int a = 0; a < 3; ++a)
  {
    corner->at[a] = node[a];
  }
  corner->margin = face->margin[mcor_cap_index(face, u, v)];
  return mcor_find_cap_vertex(
    job, &job->nodes, mcor_cap_key(node), corner->at, false, &corner->vertex);
}

/* The surface's vertex on the edge from node (u, v) of the side along across[along], for square
 * (u0, v0): see mcor_march_emit for pinched ones. */
static mcor_status mcor_cap_edge_corner(mcor_cap_job* job, const mcor_cap_face* face, int u, int v,
  int along, int u0, int v0, mcor_cap_corner* corner)
{
  mcor_context* context = job->context;
  const int axis = face->across[along], other = axis == 0 ? 1 : 0;
  cl_int node[3], cell[3];
  node[face->axis] = face->plane;
  node[face->across[0]] = face->first[0] + u;
  node[face->across[1]] = face->first[1] + v;
  cell[face->axis] = face->cell;
  cell[face->across[0]] = face->first[0] + u0;
  cell[face->across[1]] = face->first[1] + v0;
  int32_t vertex = mcor_find_cap_number(&job->edges[axis], mcor_cap_key(node));
  MCOR_RETURN_IF(vertex < 0, context, MCOR_DEVICE_ERROR,
    "A cap does not fit the surface at node %d %d %d. Please report it.", node[0], node[1],
    node[2]);
  const cl_int* nodes = job->node;
  const bool pinched = vertex + 1 < context->mesh.march_count &&
    memcmp(nodes + 4 * (size_t)vertex, nodes + 4 * ((size_t)vertex + 1), 4 * sizeof *nodes) == 0;
  vertex += pinched && node[other] > cell[other];
  corner->vertex = vertex;
  corner->margin =
    job->quantity ? mcor_get_real(context, job->quantity, vertex) - job->threshold : INFINITY;
  for (int a = 0; a < 3; ++a)
  {
    corner->at[a] = node[a] + mcor_get_real(context, job->offset, 4 * (int64_t)vertex + a);
  }
  return MCOR_OK;
}

static int mcor_compare_cap_keys(const void* x, const void* y)
{
  const cl_ulong *a = x, *b = y;
  return (*a > *b) - (*a < *b);
}

/* Where trimming cuts the line between two corners. */
static mcor_status mcor_cap_cut(
  mcor_cap_job* job, const mcor_cap_corner* p, const mcor_cap_corner* q, mcor_cap_corner* cut)
{
  const mcor_mesh* mesh = &job->context->mesh;
  const mcor_cap_corner *low = p->vertex < q->vertex ? p : q, *high = low == p ? q : p;
  const cl_ulong key = (cl_ulong)low->vertex << 32 | (cl_ulong)high->vertex;
  const size_t cuts = (size_t)(job->old_count - mesh->march_count);
  const cl_ulong* own = cuts > 0 && high->vertex < mesh->march_count
    ? bsearch(&key, job->distinct, cuts, sizeof key, mcor_compare_cap_keys)
    : NULL;
  *cut = (mcor_cap_corner){ .margin = 0 };
  if (own)
  {
    cut->vertex = mesh->march_count + (int32_t)(own - (const cl_ulong*)job->distinct);
    return MCOR_OK;
  }
  const double s = fmin(
    fmax(low->margin / (low->margin - high->margin), MCOR_CAP_CUT_MARGIN), 1 - MCOR_CAP_CUT_MARGIN);
  for (int a = 0; a < 3; ++a)
  {
    cut->at[a] = low->at[a] + s * (high->at[a] - low->at[a]);
  }
  return mcor_find_cap_vertex(job, &job->cuts, key, cut->at, true, &cut->vertex);
}

/* ---- polygons ---------------------------------------------------------------------------------- */

/* A fan. Corners go round as seen from above the axis. */
static mcor_status mcor_add_cap_fan(
  mcor_cap_job* job, const mcor_cap_face* face, const mcor_cap_corner* corners, int count)
{
  for (int i = 1; i + 1 < count; ++i)
  {
    const int64_t next = job->triangle_count + 1;
    if (!mcor_cap_room(
          (void**)&job->triangles, next, &job->triangle_room, 3 * sizeof *job->triangles) ||
      !mcor_cap_room((void**)&job->cells, next, &job->cell_room, sizeof *job->cells))
    {
      return mcor_no_cap_memory(job->context);
    }
    job->cells[job->triangle_count] = job->square;
    job->owned_count += !(job->square & MCOR_RING_CELL);
    cl_int* t = job->triangles + 3 * job->triangle_count++;
    t[0] = corners[0].vertex;
    t[1] = corners[face->upper ? i : i + 1].vertex;
    t[2] = corners[face->upper ? i + 1 : i].vertex;
  }
  return MCOR_OK;
}

/* What trimming leaves of a polygon of up to 6 corners: each run of corners inside, with the cuts
 * before and behind it. */
static mcor_status mcor_add_cap_polygon(
  mcor_cap_job* job, const mcor_cap_face* face, const mcor_cap_corner* corners, int count)
{
  int start = 0;
  while (start < count && corners[start].margin > 0)
  {
    ++start;
  }
  if (start == count)
  {
    return mcor_add_cap_fan(job, face, corners, count);
  }
  mcor_cap_corner run[8];
  int length = 0;
  for (int i = 1; i <= count; ++i)
  {
    const mcor_cap_corner *before = &corners[(start + i - 1) % count],
                          *corner = &corners[(start + i) % count];
    const bool inside = corner->margin > 0;
    if (inside != (before->margin > 0))
    {
      MCOR_TRY(mcor_cap_cut(job, before, corner, &run[length++]));
    }
    if (inside)
    {
      run[length++] = *corner;
    }
    else if (length > 0)
    {
      MCOR_TRY(mcor_add_cap_fan(job, face, run, length));
      length = 0;
    }
  }
  return MCOR_OK;
}

/* Whether the cell beside square (u, v), which the surface does not meet, is valid. */
static bool mcor_is_capped(const mcor_cap_face* face, int u, int v)
{
  bool valid = true;
  for (int c = 0; c < 4; ++c)
  {
    const int64_t at = mcor_cap_index(face, u + (c & 1), v + (c >> 1));
    valid = valid && (face->state[at] & MCOR_CAP_VALID) && (face->within[at] & MCOR_CAP_VALID);
  }
  return valid;
}

/* Square (u, v): corners in the order (0, 0), (1, 0), (1, 1), (0, 1); side k follows corner k. */
static mcor_status mcor_cap_square(mcor_cap_job* job, const mcor_cap_face* face, int u, int v)
{
  static const int corner_u[4] = { 0, 1, 1, 0 }, corner_v[4] = { 0, 0, 1, 1 };
  static const int side_u[4] = { 0, 1, 0, 0 }, side_v[4] = { 0, 0, 1, 0 };
  const int state = face->state[mcor_cap_index(face, u, v)];
  int above[4], total = 0;
  for (int k = 0; k < 4; ++k)
  {
    above[k] =
      (face->state[mcor_cap_index(face, u + corner_u[k], v + corner_v[k])] & MCOR_CAP_ABOVE) != 0;
    total += above[k];
  }
  if (total == 0 || (total == 4 ? !mcor_is_capped(face, u, v) : !(state & MCOR_CAP_USED)))
  {
    return MCOR_OK;
  }
  const bool apart =
    total == 2 && above[0] == above[2] && !(state & MCOR_CAP_JOINED); /* two corners above */
  mcor_cap_corner corners[6];
  int count = 0;
  for (int k = 0; k < 4; ++k)
  {
    const int before = (k + 3) % 4, next = (k + 1) % 4;
    if (apart && above[k])
    {
      MCOR_TRY(mcor_cap_edge_corner(
        job, face, u + side_u[before], v + side_v[before], before & 1, u, v, &corners[count++]));
    }
    if (above[k])
    {
      MCOR_TRY(
        mcor_cap_node_corner(job, face, u + corner_u[k], v + corner_v[k], &corners[count++]));
    }
    if (apart ? above[k] : above[k] != above[next])
    {
      MCOR_TRY(mcor_cap_edge_corner(
        job, face, u + side_u[k], v + side_v[k], k & 1, u, v, &corners[count++]));
    }
    if (apart && above[k])
    {
      MCOR_TRY(mcor_add_cap_polygon(job, face, corners, count));
      count = 0;
    }
  }
  return apart ? MCOR_OK : mcor_add_cap_polygon(job, face, corners, count);
}

/* ---- the mesh -------------------------------------------------------------------------------- */

/* The surface's vertices on the sides. */
static mcor_status mcor_index_cap_edges(mcor_cap_job* job)
{
  const mcor_context* context = job->context;
  const cl_int* nodes = job->node;
  int plane[6];
  for (int i = 0; i < 6; ++i)
  {
    plane[i] = mcor_cap_plane(context, i / 2, i % 2);
  }
  for (int32_t v = 0; v < context->mesh.march_count; ++v)
  {
    const cl_int* node = nodes + 4 * (size_t)v;
    const int axis = node[3] & 3;
    bool on_side = false;
    for (int a = 0; a < 3; ++a)
    {
      on_side = on_side || (a != axis && (node[a] == plane[2 * a] || node[a] == plane[2 * a + 1]));
    }
    if (on_side && mcor_cap_number(&job->edges[axis], mcor_cap_key(node), v) < 0)
    {
      return mcor_no_cap_memory(job->context);
    }
  }
  return MCOR_OK;
}

/* Numbers of squares ascend, and are above the keys of all cells. */
static void mcor_begin_cap_square(mcor_cap_job* job, const mcor_cap_face* face, int u, int v)
{
  const cl_ulong side = (cl_ulong)(2 * face->axis + face->upper);
  const bool owned =
    u >= face->owned[0] && u < face->end[0] && v >= face->owned[1] && v < face->end[1];
  job->square = MCOR_CAP_SQUARE | side << 42 | (cl_ulong)(face->first[1] + v) << 21 |
    (cl_ulong)(face->first[0] + u) | (owned ? 0 : MCOR_RING_CELL);
  job->lookups = 0;
}

static mcor_status mcor_cap_squares(mcor_cap_job* job, const mcor_cap_face* face)
{
  for (int v = 0; v + 1 < face->count[1]; ++v)
  {
    const int32_t* tile = face->tile + (int64_t)(v / MCOR_CAP_TILE) * face->tiles[0];
    MCOR_TRY(mcor_report_launch(job->context));
    for (int u = 0; u + 1 < face->count[0]; ++u)
    {
      if (tile[u / MCOR_CAP_TILE] == 0)
      {
        u = u / MCOR_CAP_TILE * MCOR_CAP_TILE + MCOR_CAP_TILE - 1;
        continue;
      }
      mcor_begin_cap_square(job, face, u, v);
      MCOR_TRY(mcor_cap_square(job, face, u, v));
    }
  }
  return MCOR_OK;
}

/* The lower and the upper side of an axis, where the box has them. */
static mcor_status mcor_cap_sides(mcor_cap_job* job, int axis, double iso, mcor_cap_points* points)
{
  mcor_context* context = job->context;
  const int first = mcor_cap_plane(context, axis, 0), last = mcor_cap_plane(context, axis, 1);
  const bool has_lower = first >= 0 && context->box.first[axis] == first,
             has_upper = last >= 0 && context->box.last[axis] == last,
             are_one = has_lower && last - first == context->lattice.period[axis];
  mcor_cap_face lower = { 0 }, upper = { 0 };
  mcor_status status = MCOR_OK;
  if (has_lower)
  {
    status = mcor_load_cap_face(context, axis, 0, NULL, iso, points, &lower);
    status = status == MCOR_OK ? mcor_cap_squares(job, &lower) : status;
  }
  if (has_upper && status == MCOR_OK)
  {
    status = mcor_load_cap_face(context, axis, 1, are_one ? &lower : NULL, iso, points, &upper);
    status = status == MCOR_OK ? mcor_cap_squares(job, &upper) : status;
  }
  mcor_free_cap_face(&lower);
  mcor_free_cap_face(&upper);
  return status;
}

/* Views of the surface's vertices while caps are made. */
static mcor_status mcor_make_caps(mcor_cap_job* job, double iso, mcor_cap_points* points)
{
  mcor_context* context = job->context;
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)mesh->march_count, real = context->cl.real_size;
  const size_t cuts = (size_t)(mesh->vertex_count - mesh->march_count);
  if (n > 0)
  {
    MCOR_TRY(mcor_map(context, &mesh->node, n * 4 * sizeof(cl_int), false, &job->node));
    MCOR_TRY(mcor_map(context, &mesh->offset, n * 4 * real, false, &job->offset));
    if (mcor_is_trimmed(context))
    {
      MCOR_TRY(mcor_map(context, mcor_trim_quantity(context), n * real, false, &job->quantity));
    }
    MCOR_TRY(mcor_index_cap_edges(job));
  }
  if (cuts > 0)
  {
    MCOR_TRY(
      mcor_map(context, &context->trim.distinct, cuts * sizeof(cl_ulong), false, &job->distinct));
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    MCOR_TRY(mcor_cap_sides(job, axis, iso, points));
  }
  return MCOR_OK;
}

static mcor_status mcor_end_cap_views(mcor_cap_job* job)
{
  mcor_context* context = job->context;
  const mcor_status unmapped[] = { mcor_unmap(context, &context->mesh.node, &job->node),
    mcor_unmap(context, &context->mesh.offset, &job->offset),
    mcor_unmap(context, mcor_trim_quantity(context), &job->quantity),
    mcor_unmap(context, &context->trim.distinct, &job->distinct) };
  mcor_status status = MCOR_OK;
  for (int i = 0; i < 4; ++i)
  {
    status = status == MCOR_OK ? unmapped[i] : status;
  }
  return status;
}

mcor_status mcor_cap(mcor_context* context, double iso)
{
  mcor_end_caps(context);
  context->mesh.cap_first = context->mesh.vertex_count;
  if (!mcor_makes_caps(context))
  {
    return MCOR_OK;
  }
  mcor_cap_job job = { .context = context,
    .old_count = context->mesh.vertex_count,
    .threshold = mcor_real_of(context, mcor_trim_threshold(context)) };
  mcor_cap_points points = { .node = { 0 } };
  mcor_status status = mcor_make_caps(&job, iso, &points);
  const mcor_status unmapped = mcor_end_cap_views(&job);
  mcor_release_cap_points(context, &points);
  status = status == MCOR_OK ? unmapped : status;
  if (status == MCOR_OK && job.triangle_count > 0)
  {
    status = mcor_append_caps(&job, iso);
    context->run.statistics->cap_triangles += job.owned_count;
  }
  mcor_cap_map* const maps[] = { &job.edges[0], &job.edges[1], &job.edges[2], &job.nodes,
    &job.cuts };
  for (int i = 0; i < 5; ++i)
  {
    mcor_free_cap_map(maps[i]);
  }
  free(job.vertices);
  free(job.triangles);
  free(job.cells);
  return status;
}
