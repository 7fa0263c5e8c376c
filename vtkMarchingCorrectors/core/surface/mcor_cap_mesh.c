/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Caps as part of the mesh: their vertices and triangles behind all others, and what the output asks of
 * them. */

#include "mcor_cap_job.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool mcor_is_cap(const mcor_context* context, int64_t v)
{
  return v >= context->mesh.cap_first;
}

void mcor_cap_normal(const mcor_context* context, const cl_int node[4], float normal[3])
{
  double n[3], square = 0;
  for (int a = 0; a < 3; ++a)
  {
    n[a] = node[a] == mcor_cap_plane(context, a, 0) ? -1
      : node[a] == mcor_cap_plane(context, a, 1)    ? 1
                                                    : 0;
    square += n[a] * n[a];
  }
  for (int a = 0; a < 3; ++a)
  {
    normal[a] = square > 0 ? (float)(n[a] / sqrt(square)) : 0; /* at walls: from triangles */
  }
}

/* Appends elements to a buffer of `old` bytes. */
static mcor_status mcor_append_bytes(
  mcor_context* context, mcor_buffer* to, size_t old, const void* data, size_t bytes)
{
  mcor_buffer more = { 0 };
  MCOR_TRY(mcor_extend(context, to, old, old + bytes));
  mcor_status status = mcor_write(context, &more, data, bytes);
  status = status == MCOR_OK ? mcor_copy(context, &more, to, old, bytes) : status;
  mcor_release(context, &more);
  return status;
}

/* Places and flags of the caps' vertices: 8, of cuts 2, or 1 where they are exact. */
static mcor_status mcor_append_cap_vertices(mcor_cap_job* job)
{
  mcor_context* context = job->context;
  mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)job->vertex_count, old = (size_t)job->old_count,
               real = context->cl.real_size;
  cl_int* node = malloc(n * 4 * sizeof *node);
  void* offset = calloc(n * 4, real);
  uint8_t* flag = malloc(n);
  mcor_status status = mcor_allocated(context, node && offset && flag);
  for (size_t i = 0; i < n && status == MCOR_OK; ++i)
  {
    const mcor_cap_vertex* vertex = &job->vertices[i];
    memcpy(node + 4 * i, vertex->node, sizeof vertex->node);
    const bool exact = vertex->is_placed && fabs(vertex->line.left) < MCOR_CAP_ROOT;
    flag[i] = vertex->is_cut ? (exact ? 1 : 2) : MCOR_CAP_FLAG;
    for (size_t a = 0; a < 3; ++a)
    {
      mcor_put_real(context, offset, (int64_t)(4 * i + a), vertex->offset[a]);
    }
  }
  status = status == MCOR_OK ? mcor_extend_vertices(context, (int)old, (int)(old + n)) : status;
  status =
    status == MCOR_OK ? mcor_append_bytes(context, &mesh->node, old * 16, node, n * 16) : status;
  status = status == MCOR_OK
    ? mcor_append_bytes(context, &mesh->offset, old * 4 * real, offset, n * 4 * real)
    : status;
  status = status == MCOR_OK ? mcor_append_bytes(context, &mesh->flag, old, flag, n) : status;
  free(node);
  free(offset);
  free(flag);
  return status;
}

static mcor_status mcor_keep_cap_keys(mcor_cap_job* job)
{
  mcor_mesh* mesh = &job->context->mesh;
  if (!job->context->run.options->point_keys)
  {
    return MCOR_OK;
  }
  mesh->cap_keys = malloc(((size_t)job->vertex_count + 1) * sizeof job->vertices->key);
  for (int64_t i = 0; i < job->vertex_count && mesh->cap_keys; ++i)
  {
    memcpy(mesh->cap_keys + 2 * i, job->vertices[i].key, sizeof job->vertices[i].key);
    mesh->cap_keys[2 * i] &= ~MCOR_RING_CELL;
  }
  return mcor_allocated(job->context, mesh->cap_keys);
}

void mcor_store_cap_key(const mcor_context* context, int64_t v, uint64_t key[2])
{
  memcpy(key, context->mesh.cap_keys + 2 * (v - context->mesh.cap_first), 2 * sizeof *key);
}

void mcor_end_caps(mcor_context* context)
{
  free(context->mesh.cap_keys);
  context->mesh.cap_keys = NULL;
}

mcor_status mcor_append_caps(mcor_cap_job* job, double iso)
{
  mcor_context* context = job->context;
  mcor_mesh* mesh = &context->mesh;
  const size_t old = (size_t)mesh->triangle_count, more = (size_t)job->triangle_count;
  const size_t width = 3 * sizeof(cl_int), cell = sizeof(cl_ulong);
  int groups;
  MCOR_RETURN_IF(old + more > MCOR_COUNT_LIMIT / 3, context, MCOR_OUT_OF_CAPACITY,
    "With its caps the surface would have %zu triangles; the limit is %d. Use a larger cube size.",
    old + more, MCOR_COUNT_LIMIT / 3);
  MCOR_TRY(mcor_keep_cap_keys(job));
  MCOR_TRY(mcor_append_cap_vertices(job));
  MCOR_TRY(mcor_append_bytes(context, &mesh->triangles, old * width, job->triangles, more * width));
  MCOR_TRY(mcor_append_bytes(context, &context->box.cells, old * cell, job->cells, more * cell));
  mesh->triangle_count += (int)more;
  mesh->vertex_count += (int)job->vertex_count;
  MCOR_TRY(mcor_make_groups(context, &mesh->node, job->old_count, (int)job->vertex_count, &groups));
  return MCOR_LAUNCH(context, "mcor_cap_points", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_INT(groups), MCOR_BUFFER(&context->points.groups), MCOR_BUFFER(&mesh->node),
    MCOR_REAL(iso), MCOR_BUFFER(&mesh->offset), MCOR_BUFFER(&mesh->field_value),
    MCOR_BUFFER(&mesh->gradient), MCOR_BUFFER(&mesh->vertex_weight),
    MCOR_ATTRIBUTE_ARGS(context, &mesh->means));
}
