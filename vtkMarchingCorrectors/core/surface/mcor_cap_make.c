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

#include <stdlib.h>

/* ---- the mesh ---- */

/* The surface's vertices on the sides. */
static mcor_status mcor_index_cap_edges(mcor_cap_job* job)
{
  const mcor_context* context = job->context;
  const cl_int* nodes = job->node;
  const bool all = mcor_caps_walls(context);
  int plane[6];
  for (int i = 0; i < 6; ++i)
  {
    plane[i] = mcor_cap_plane(context, i / 2, i % 2);
  }
  for (int32_t v = 0; v < context->mesh.march_count; ++v)
  {
    const cl_int* node = nodes + 4 * (size_t)v;
    const int axis = node[3] & 3;
    bool on_side = all;
    for (int a = 0; a < 3; ++a)
    {
      on_side = on_side || (a != axis && (node[a] == plane[2 * a] || node[a] == plane[2 * a + 1]));
    }
    MCOR_TRY(mcor_allocated(
      job->context, !on_side || mcor_table_number(&job->edges[axis], mcor_cap_key(node), v) >= 0));
  }
  return MCOR_OK;
}

/* Numbers of squares ascend, and are above the keys of all cells. */
static mcor_status mcor_cap_numbered_square(void* data, const mcor_cap_face* face, int u, int v)
{
  mcor_cap_job* job = data;
  const cl_ulong side = (cl_ulong)(2 * face->axis + face->upper);
  const bool owned =
    u >= face->owned[0] && u < face->end[0] && v >= face->owned[1] && v < face->end[1];
  job->square = MCOR_CAP_SQUARE | side << 42 | (cl_ulong)(face->first[1] + v) << 21 |
    (cl_ulong)(face->first[0] + u) | (owned ? 0 : MCOR_RING_CELL);
  job->lookups = 0;
  return mcor_cap_square(job, face, u, v);
}

static mcor_status mcor_cap_squares(mcor_cap_job* job, const mcor_cap_face* face)
{
  return mcor_visit_cap_squares(job->context, face, mcor_cap_numbered_square, job);
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
  const size_t all = (size_t)mesh->vertex_count;
  const size_t cuts = (size_t)(mesh->vertex_count - mesh->march_count);
  if (n > 0)
  {
    MCOR_TRY(mcor_map(context, &mesh->node, all * 4 * sizeof(cl_int), false, &job->node));
    MCOR_TRY(mcor_map(context, &mesh->offset, all * 4 * real, false, &job->offset));
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
  MCOR_TRY(mcor_is_plane(context) && !context->run.options->preview
      ? mcor_place_cap_cuts(job, iso, points)
      : MCOR_OK);
  return mcor_caps_walls(context) ? mcor_cap_walls(job, iso, points) : MCOR_OK;
}

static mcor_status mcor_end_cap_views(mcor_cap_job* job)
{
  mcor_context* context = job->context;
  const mcor_mapping mappings[] = { { &context->mesh.node, 0, &job->node },
    { &context->mesh.offset, 0, &job->offset }, { mcor_trim_quantity(context), 0, &job->quantity },
    { &context->trim.distinct, 0, &job->distinct } };
  return mcor_unmap_all(context, mappings, 4, MCOR_OK);
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
  mcor_table* const maps[] = { &job.edges[0], &job.edges[1], &job.edges[2], &job.nodes, &job.cuts };
  for (int i = 0; i < 5; ++i)
  {
    mcor_table_free(maps[i]);
  }
  free(job.vertices);
  free(job.triangles);
  free(job.cells);
  return status;
}
