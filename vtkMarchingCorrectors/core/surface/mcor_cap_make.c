/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Caps close the surface at the sides of a period or box, around the region above the iso value.
 * Each square of a side is cut as marching cuts it, along lines between the surface's own vertices
 * there, which the cap shares; its other vertices are nodes. A trimmed surface has a trimmed cap:
 * cut at the surface's own cut vertices, and linearly within the side. A square is capped where the
 * cell beside it is valid.
 *
 * The vertices of caps follow all others of the mesh. They are numbered in the order in which
 * squares meet them: by axis, by lower and upper side, then square by square. A box caps the
 * squares of its own cells and of the ring around it, so that its vertices have the keys, and
 * the order, that they have in the whole surface. */

#include "mcor_cap_job.h"

#include <stdlib.h>

/* Enters the surface's vertices on the sides into tables by lattice edge; with caps at walls,
 * all vertices. */
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

/* Whether the cell beside square (u, v) is valid, where the surface does not meet it. */
static bool mcor_is_valid_beside(const mcor_cap_face* face, int u, int v)
{
  bool valid = true;
  for (int c = 0; c < 4; ++c)
  {
    const int64_t at = mcor_cap_index(face, u + (c & 1), v + (c >> 1));
    valid = valid && (face->state[at] & MCOR_CAP_VALID) && (face->within[at] & MCOR_CAP_VALID);
  }
  return valid;
}

/* Caps one square. Its number is above the keys of all cells; numbers ascend. */
static mcor_status mcor_visit_cap_square(void* data, const mcor_cap_face* face, int u, int v)
{
  mcor_cap_job* job = data;
  const int corner_u[4] = { 0, 1, 1, 0 }, corner_v[4] = { 0, 0, 1, 1 };
  const int state = face->state[mcor_cap_index(face, u, v)];
  mcor_cap_square square = {
    .axis = face->axis, .upper = face->upper, .is_joined = state & MCOR_CAP_JOINED
  };
  int64_t at[4];
  int total = 0;
  for (int k = 0; k < 4; ++k)
  {
    at[k] = mcor_cap_index(face, u + corner_u[k], v + corner_v[k]);
    square.above[k] = face->state[at[k]] & MCOR_CAP_ABOVE;
    total += square.above[k];
  }
  if (total == 0 || (total == 4 ? !mcor_is_valid_beside(face, u, v) : !(state & MCOR_CAP_USED)))
  {
    return MCOR_OK;
  }
  for (int k = 0; k < 4; ++k)
  {
    square.margin[k] = face->margin[at[k]];
  }
  mcor_cap_node(job->context, face, u, v, square.node);
  const cl_ulong side = (cl_ulong)(2 * face->axis + face->upper);
  mcor_begin_cap_square(job,
    side << 42 | (cl_ulong)(face->first[1] + v) << 21 | (cl_ulong)(face->first[0] + u), square.node,
    face->axis);
  return mcor_add_cap_square(job, &square);
}

static mcor_status mcor_cap_side(
  mcor_cap_job* job, int axis, int upper, const mcor_cap_face* opposite, mcor_cap_face* face)
{
  MCOR_TRY(mcor_load_cap_face(job->context, axis, upper, opposite, &job->points, face));
  return mcor_visit_cap_squares(job->context, face, mcor_visit_cap_square, job);
}

/* Caps the lower and the upper side of an axis, as far as this call's box has them. */
static mcor_status mcor_cap_sides(mcor_cap_job* job, int axis)
{
  const mcor_context* context = job->context;
  const bool has_lower = mcor_has_cap_side(context, axis, 0),
             has_upper = mcor_has_cap_side(context, axis, 1);
  const int apart = mcor_cap_plane(context, axis, 1) - mcor_cap_plane(context, axis, 0);
  const bool are_one = has_lower && apart == context->lattice.period[axis];
  mcor_cap_face lower = { 0 }, upper = { 0 };
  mcor_status status = has_lower ? mcor_cap_side(job, axis, 0, NULL, &lower) : MCOR_OK;
  if (has_upper && status == MCOR_OK)
  {
    status = mcor_cap_side(job, axis, 1, are_one ? &lower : NULL, &upper);
  }
  mcor_free_cap_face(&lower);
  mcor_free_cap_face(&upper);
  return status;
}

static mcor_status mcor_make_caps(mcor_cap_job* job)
{
  const mcor_context* context = job->context;
  MCOR_TRY(mcor_index_cap_edges(job));
  for (int axis = 0; axis < 3; ++axis)
  {
    MCOR_TRY(mcor_cap_sides(job, axis));
  }
  const bool places = context->space.flat && !context->run.options->preview;
  MCOR_TRY(places ? mcor_place_cap_cuts(job) : MCOR_OK);
  return mcor_caps_walls(context) ? mcor_cap_walls(job) : MCOR_OK;
}

/* Lists the views of the mesh that caps read. Returns their number: a mesh that is not trimmed
 * has no cuts. */
static int mcor_list_cap_views(mcor_cap_job* job, mcor_mapping views[4])
{
  const mcor_context* context = job->context;
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)mesh->march_count, all = (size_t)mesh->vertex_count,
               real = context->cl.real_size;
  views[0] = (mcor_mapping){ &mesh->node, all * 4 * sizeof(cl_int), &job->node };
  views[1] = (mcor_mapping){ &mesh->offset, all * 4 * real, &job->offset };
  views[2] = (mcor_mapping){ mcor_trim_quantity(context), n * real, &job->quantity };
  views[3] = (mcor_mapping){ &mesh->cut_edges, (all - n) * sizeof(cl_ulong), &job->cut_edges };
  return n == 0 ? 0 : all > n ? 4 : mcor_is_trimmed(context) ? 3 : 2;
}

/* Appends the caps' vertices and triangles to the mesh. */
static mcor_status mcor_append_caps(mcor_cap_job* job)
{
  mcor_context* context = job->context;
  mcor_mesh* mesh = &context->mesh;
  const size_t old = (size_t)mesh->triangle_count, more = (size_t)job->triangle_count;
  const size_t width = 3 * sizeof(cl_int), cell = sizeof(cl_ulong);
  if (more == 0)
  {
    return MCOR_OK;
  }
  MCOR_RETURN_IF(old + more > MCOR_COUNT_LIMIT / 3, context, MCOR_OUT_OF_CAPACITY,
    "The surface with its caps would have %zu triangles; the limit is %d. Use a larger cube size.",
    old + more, MCOR_COUNT_LIMIT / 3);
  MCOR_TRY(mcor_append_bytes(context, &mesh->triangles, old * width, job->triangles, more * width));
  MCOR_TRY(mcor_append_bytes(context, &context->box.cells, old * cell, job->cells, more * cell));
  mesh->triangle_count += (int)more;
  context->run.statistics->cap_triangles += job->owned_count;
  return mcor_append_cap_vertices(context, job->vertices, job->vertex_count);
}

mcor_status mcor_cap(mcor_context* context)
{
  mcor_end_caps(context);
  context->mesh.cap_first = context->mesh.vertex_count;
  context->mesh.cap_triangle_first = context->mesh.triangle_count;
  if (!mcor_makes_caps(context))
  {
    return MCOR_OK;
  }
  mcor_cap_job job = { .context = context,
    .threshold = mcor_real_of(context, mcor_trim_threshold(context)) };
  mcor_mapping views[4];
  const int mapped = mcor_list_cap_views(&job, views);
  mcor_status status = mcor_map_all(context, views, mapped);
  status = status == MCOR_OK ? mcor_make_caps(&job) : status;
  status = mcor_unmap_all(context, views, mapped, status);
  mcor_free_cap_points(context, &job.points);
  status = status == MCOR_OK ? mcor_append_caps(&job) : status;
  mcor_table* const maps[] = { &job.edges[0], &job.edges[1], &job.edges[2], &job.nodes, &job.cuts };
  for (int i = 0; i < 5; ++i)
  {
    mcor_table_free(maps[i]);
  }
  free(job.vertices);
  free(job.lines);
  free(job.triangles);
  free(job.cells);
  return status;
}
