/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Caps close the surface at the sides of a period or box, around the region above the iso value.
 * Marching Cubes cuts each square of a side along lines between vertices of the surface. The cap
 * has the same lines and vertices; its other vertices are nodes. The cap of a trimmed surface is
 * trimmed, too: at the surface's cut vertices, and linearly within the side. A square is capped if
 * the cell beside it is valid.
 *
 * The vertices of caps follow all other vertices of the mesh. They are numbered in the order in
 * which squares use them: by axis, by lower and upper side, then square by square. A call with a
 * box caps the squares of its own cells and of the ring around them, so that vertices have the same
 * keys and order as in the whole surface. */

#include "mcor_cap_job.h"

#include <stdlib.h>

/* Enters the surface's vertices on the sides into tables by lattice edge. */
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
    MCOR_TRY(mcor_allocated(
      job->context, !on_side || mcor_table_number(&job->edges[axis], mcor_cap_key(node), v) >= 0));
  }
  return MCOR_OK;
}

/* Caps one square. Its number, greater than the key of any owned cell, is the key of its triangles.
 * Squares come in the order of their numbers. */
static mcor_status mcor_visit_cap_square(
  void* data, const mcor_cap_nodes* nodes, int64_t lowest, const cl_int node[3])
{
  mcor_cap_job* job = data;
  const mcor_cap_brick *of = nodes->bricks.of, *own = &of[lowest / MCOR_SIDE_NODES];
  const int face = mcor_side_bit(nodes, nodes->plane, lowest);
  mcor_cap_square square = { .axis = nodes->axis,
    .upper = nodes->upper,
    .node = { node[0], node[1], node[2] },
    .is_joined = own->joined[nodes->axis] >> face & 1 };
  const int cell = mcor_side_bit(nodes, nodes->plane - nodes->upper, lowest);
  const bool used = of[nodes->upper ? own->inner : lowest / MCOR_SIDE_NODES].used >> cell & 1;
  int total = 0;
  bool valid = true; /* without surface in the square, this says whether the cell beside it is
                      * valid */
  for (int k = 0; k < 4; ++k)
  {
    const int64_t at = mcor_corner_index(nodes, lowest, k);
    const mcor_cap_brick* brick = &of[at / MCOR_SIDE_NODES];
    const int bit = mcor_side_bit(nodes, nodes->plane, at);
    square.above[k] = brick->above >> bit & 1;
    square.margin[k] = nodes->margin[at];
    total += square.above[k];
    valid = valid && (brick->valid >> bit & 1) &&
      (of[brick->inner].valid >> mcor_side_bit(nodes, nodes->inner, at) & 1);
  }
  if (total == 0 || (total == 4 ? !valid : !used))
  {
    return MCOR_OK;
  }
  const cl_ulong side = (cl_ulong)(2 * nodes->axis + nodes->upper);
  mcor_begin_cap_square(job,
    side << 42 | (cl_ulong)node[nodes->across[1]] << 21 | (cl_ulong)node[nodes->across[0]],
    square.node, nodes->axis);
  return mcor_add_cap_square(job, &square);
}

/* Appends the caps' vertices and triangles to the mesh. */
static mcor_status mcor_append_caps(mcor_cap_job* job)
{
  mcor_context* context = job->context;
  mcor_mesh* mesh = &context->mesh;
  const size_t old = (size_t)mesh->triangle_count, more = (size_t)job->triangles.count;
  const size_t width = 3 * sizeof(cl_int), cell = sizeof(cl_ulong);
  if (more == 0)
  {
    return MCOR_OK;
  }
  MCOR_FAIL_IF(old + more > MCOR_COUNT_LIMIT / 3, context, MCOR_OUT_OF_CAPACITY,
    MCOR_SAY(CAPS_TOO_LARGE), old + more, MCOR_COUNT_LIMIT / 3);
  MCOR_TRY(
    mcor_append_bytes(context, &mesh->triangles, old * width, job->triangles.of, more * width));
  MCOR_TRY(mcor_append_bytes(context, &context->box.cells, old * cell, job->cells.of, more * cell));
  mesh->triangle_count += (int)more;
  context->run.statistics->cap_triangles += job->owned_count;
  return mcor_append_cap_vertices(context, job->vertices.of, job->vertices.count);
}

void mcor_free_cap_job(mcor_cap_job* job)
{
  mcor_free_cap_points(job->context, &job->points);
  for (int a = 0; a < 3; ++a)
  {
    mcor_table_free(&job->edges[a]);
  }
  mcor_table_free(&job->nodes);
  mcor_table_free(&job->cuts);
  free(job->vertices.of);
  free(job->lines.of);
  free(job->triangles.of);
  free(job->cells.of);
}

mcor_status mcor_cap(mcor_context* context)
{
  mcor_end_caps(context); /* drops the keys of the last iso value */
  mcor_cap_job job = { .context = context,
    .threshold = mcor_real_of(context, mcor_trim_threshold(context)) };
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)mesh->march_count, all = (size_t)mesh->vertex_count,
               real = context->cl.real_size;
  const mcor_mapping views[] = { { &mesh->node, all * 4 * sizeof(cl_int), &job.node },
    { &mesh->offset, all * 4 * real, &job.offset },
    { mcor_trim_quantity(context), n * real, &job.quantity },
    { &mesh->cut_edges, (all - n) * sizeof(cl_ulong), &job.cut_edges } };
  /* A mesh that is not trimmed has no cuts. */
  const int mapped = n == 0 ? 0 : all > n ? 4 : mcor_is_trimmed(context) ? 3 : 2;
  mcor_status status = mcor_map_all(context, views, mapped);
  MCOR_THEN(status, mcor_index_cap_edges(&job));
  /* Caps the lower and the upper side of each axis, if this call's box has them. */
  for (int axis = 0; axis < 3; ++axis)
  {
    const int apart = mcor_cap_plane(context, axis, 1) - mcor_cap_plane(context, axis, 0);
    const bool has[2] = { mcor_has_cap_side(context, axis, 0),
      mcor_has_cap_side(context, axis, 1) };
    const bool are_one = has[0] && apart == context->lattice.period[axis];
    mcor_cap_nodes sides[2] = { { 0 }, { 0 } };
    for (int upper = 0; upper < 2; ++upper)
    {
      if (status == MCOR_OK && has[upper])
      {
        mcor_cap_nodes* nodes = &sides[upper];
        status = mcor_load_cap_side(
          context, axis, upper, upper && are_one ? &sides[0] : NULL, &job.points, nodes);
        MCOR_THEN(status, mcor_visit_cap_squares(context, nodes, mcor_visit_cap_square, &job));
      }
    }
    mcor_free_cap_nodes(&sides[0]);
    mcor_free_cap_nodes(&sides[1]);
  }
  const bool places = context->space.axes == 2 && !context->run.options->preview;
  status = status == MCOR_OK && places ? mcor_place_cap_cuts(&job) : status;
  status = mcor_unmap_all(context, views, mapped, status);
  MCOR_THEN(status, mcor_append_caps(&job));
  mcor_free_cap_job(&job);
  return status;
}
