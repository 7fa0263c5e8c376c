/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Output [III-D.4]: compaction, transfer, and what a surface carries besides its geometry. */

#include "mcor_input.h"
#include "mcor_parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Views of what the device hands over for the vertices of one iso value. */
typedef struct mcor_download
{
  int count;
  void* views[5]; /* node, offset, normal, gradient, numbers: see mcor_output_vertices */
  const cl_int* node;
  const cl_float* normal;
  const void *offset, *gradient, *numbers;
} mcor_download;

/* Keeps the vertices that a triangle uses, in order; renumbers the triangles. */
static mcor_status mcor_compact(mcor_context* context, int* count)
{
  mcor_mesh* mesh = &context->mesh;
  mcor_buffer* out = context->out;
  const int vertices = mesh->vertex_count, corners = 3 * mesh->triangle_count;
  MCOR_TRY(mcor_fill(context, &mesh->scanned, 0, ((size_t)vertices + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_trim_used", MCOR_LIGHT, corners,
    MCOR_INT(mesh->triangle_count), MCOR_BUFFER(&mesh->triangles), MCOR_BUFFER(&mesh->scanned)));
  MCOR_TRY(mcor_scan(context, &mesh->scanned, vertices, count));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_trim_renumber", MCOR_LIGHT, corners,
    MCOR_INT(mesh->triangle_count), MCOR_BUFFER(&mesh->scanned), MCOR_BUFFER(&mesh->triangles)));
  const size_t n = (size_t)*count, real = context->cl.real_size;
  MCOR_TRY(mcor_reserve(context, &out[0], n * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &out[1], n * 4 * real));
  MCOR_TRY(mcor_reserve(context, &out[2], n * 4 * sizeof(cl_float)));
  MCOR_TRY(mcor_reserve(context, &out[3], n * 4 * real));
  MCOR_TRY(mcor_reserve(context, &out[4], n * 4 * real));
  MCOR_TRY(mcor_reserve(context, &out[5], n * (size_t)context->attributes.count * real));
  return MCOR_LAUNCH(context, "mcor_output_vertices", MCOR_LIGHT, vertices, MCOR_INT(vertices),
    MCOR_INT(mesh->march_count), MCOR_BUFFER(&mesh->scanned), MCOR_BUFFER(&mesh->node),
    MCOR_BUFFER(&mesh->offset), MCOR_BUFFER(&mesh->linear), MCOR_BUFFER(&mesh->field_value),
    MCOR_BUFFER(&mesh->gradient), MCOR_BUFFER(&mesh->vertex_weight), MCOR_BUFFER(&mesh->flag),
    MCOR_BUFFER(&out[0]), MCOR_BUFFER(&out[1]),
    MCOR_BUFFER(&out[2]), MCOR_BUFFER(&out[3]), MCOR_BUFFER(&out[4]),
    MCOR_INT(context->attributes.count), MCOR_BUFFER(&mesh->means), MCOR_BUFFER(&out[5]));
}

static mcor_status mcor_map_vertices(mcor_context* context, mcor_download* d)
{
  const size_t n = (size_t)d->count, reals = n * 4 * context->cl.real_size;
  const size_t bytes[5] = { n * 4 * sizeof(cl_int), reals, n * 4 * sizeof(cl_float), reals, reals };
  for (int i = 0; i < 5; ++i)
  {
    MCOR_TRY(mcor_map(context, &context->out[i], bytes[i], false, &d->views[i]));
  }
  d->node = d->views[0];
  d->offset = d->views[1];
  d->normal = d->views[2];
  d->gradient = d->views[3];
  d->numbers = d->views[4];
  return MCOR_OK;
}

static mcor_status mcor_unmap_vertices(mcor_context* context, mcor_download* d)
{
  mcor_status status = MCOR_OK;
  for (int i = 0; i < 5; ++i)
  {
    const mcor_status unmapped = mcor_unmap(context, &context->out[i], &d->views[i]);
    status = status == MCOR_OK ? unmapped : status;
  }
  return status;
}

/* Room for `count` more elements of `width` bytes; *array may be NULL. */
static mcor_status mcor_grow(
  mcor_context* context, void** array, int64_t old, int64_t count, size_t width)
{
  void* grown = realloc(*array, (size_t)(old + count) * width + 1);
  MCOR_RETURN_IF(!grown, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for a surface of %lld points could not be allocated.", (long long)(old + count));
  *array = grown;
  return MCOR_OK;
}

static mcor_status mcor_grow_surface(mcor_context* context, const mcor_input* input,
  mcor_surface* s, int64_t points, int64_t triangles)
{
  const mcor_options* o = context->options;
  const int64_t n = s->point_count;
  const bool normals = o->normals;
  struct
  {
    bool wanted;
    void** array;
    size_t width;
  } const arrays[] = { { true, (void**)&s->points, 3 * sizeof(double) },
    { normals, (void**)&s->normals, 3 * sizeof(float) },
    { o->gradients, (void**)&s->gradients, 3 * sizeof(double) },
    { o->weight_sum, (void**)&s->weight_sum, sizeof(float) },
    { o->boundary_eigenvalue, (void**)&s->boundary_eigenvalue, sizeof(float) },
    { o->correction_length, (void**)&s->correction_length, sizeof(float) },
    { o->residual, (void**)&s->residual, sizeof(float) },
    { o->boundary_flag, (void**)&s->boundary_flag, 1 },
    { o->iso_value, (void**)&s->iso_value, sizeof(double) },
    { o->nearest_particle, (void**)&s->nearest_particle, sizeof(int64_t) } };
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; ++i)
  {
    if (arrays[i].wanted)
    {
      MCOR_TRY(mcor_grow(context, arrays[i].array, n, points, arrays[i].width));
    }
  }
  for (int a = 0; a < input->attribute_count; ++a)
  {
    const int components =
      input->attributes[a].components > 0 ? input->attributes[a].components : 1;
    MCOR_TRY(mcor_grow(
      context, (void**)&s->attributes[a], n, points, (size_t)components * sizeof(double)));
  }
  return mcor_grow(
    context, (void**)&s->triangles, s->triangle_count, triangles, 3 * sizeof(int32_t));
}

/* Statistics of some vertices. */
typedef struct mcor_tally
{
  int64_t trim_vertices, linear, above_tolerance;
  double count, sum, squares, correction_max, residual_max;
} mcor_tally;

/* One iso value's vertices on their way to the surface. */
typedef struct mcor_delivery
{
  const mcor_context* context;
  const mcor_download* download;
  double iso;
  mcor_surface* surface; /* the first of them becomes its point point_count */
  mcor_tally tallies[MCOR_SLICES];
} mcor_delivery;

static void mcor_count_correction(
  const mcor_context* context, const mcor_download* d, int i, mcor_tally* tally)
{
  const double tolerance =
    context->options->tolerance * (context->measure.scalar_max - context->measure.scalar_min);
  const int flag = d->node[4 * i + 3];
  if (flag == 1 || flag == 2)
  {
    ++tally->trim_vertices;
    tally->linear += flag == 2;
    return;
  }
  const double length = fabs(mcor_get_real(context, d->numbers, 4 * i)) * context->lattice.cube;
  const double residual = fabs(mcor_get_real(context, d->numbers, 4 * i + 1));
  tally->count += 1;
  tally->sum += length;
  tally->squares += length * length;
  tally->correction_max = length > tally->correction_max ? length : tally->correction_max;
  tally->residual_max = residual > tally->residual_max ? residual : tally->residual_max;
  tally->above_tolerance += residual > tolerance;
}

static void mcor_add_tally(mcor_context* context, const mcor_tally* tally)
{
  mcor_statistics* s = context->statistics;
  s->trim_vertices += tally->trim_vertices;
  s->trim_vertices_linear += tally->linear;
  s->vertices_above_tolerance += tally->above_tolerance;
  context->correction_count += tally->count;
  context->correction_sum += tally->sum;
  context->correction_squares += tally->squares;
  s->correction_max = fmax(s->correction_max, tally->correction_max);
  s->residual_max = fmax(s->residual_max, tally->residual_max);
}

/* Vertex i of the download becomes point `to` of the surface. */
static void mcor_put_point(const mcor_context* context, const mcor_download* d, int i, double iso,
  mcor_surface* s, int64_t to)
{
  const double cube = context->lattice.cube;
  for (int a = 0; a < 3; ++a)
  {
    const double node = (double)(context->lattice.origin[a] + d->node[4 * i + a]);
    s->points[3 * to + a] = (node + mcor_get_real(context, d->offset, 4 * i + a)) * cube;
    if (s->normals)
    {
      s->normals[3 * to + a] = d->normal[4 * i + a];
    }
    if (s->gradients)
    {
      s->gradients[3 * to + a] = mcor_get_real(context, d->gradient, 4 * i + a) / cube;
    }
  }
  if (s->weight_sum)
  {
    s->weight_sum[to] = (float)mcor_get_real(context, d->numbers, 4 * i + 2);
  }
  if (s->correction_length)
  {
    s->correction_length[to] = (float)(fabs(mcor_get_real(context, d->numbers, 4 * i)) * cube);
  }
  if (s->residual)
  {
    s->residual[to] = (float)mcor_get_real(context, d->numbers, 4 * i + 1);
  }
  if (s->boundary_flag)
  {
    s->boundary_flag[to] = (uint8_t)d->node[4 * i + 3];
  }
  if (s->iso_value)
  {
    s->iso_value[to] = iso;
  }
}

static void mcor_deliver_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_delivery* delivery = data;
  mcor_surface* surface = delivery->surface;
  mcor_tally tally = { 0 };
  for (int64_t i = first; i < last; ++i)
  {
    mcor_put_point(delivery->context, delivery->download, (int)i, delivery->iso, surface,
      surface->point_count + i);
    mcor_count_correction(delivery->context, delivery->download, (int)i, &tally);
  }
  delivery->tallies[slice] = tally;
}

static void mcor_deliver_vertices(
  mcor_context* context, const mcor_download* download, double iso, mcor_surface* surface)
{
  mcor_delivery delivery = {
    .context = context, .download = download, .iso = iso, .surface = surface
  };
  const int slices =
    mcor_parallel_for(download->count, MCOR_HEAVY_GRAIN, mcor_deliver_slice, &delivery);
  for (int s = 0; s < slices; ++s)
  {
    mcor_add_tally(context, &delivery.tallies[s]);
  }
}

typedef struct mcor_corners
{
  const cl_int* from;
  int32_t* to;
  int32_t base;
} mcor_corners;

static void mcor_copy_corners(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_corners* corners = data;
  for (int64_t i = first; i < last; ++i)
  {
    corners->to[i] = corners->from[i] + corners->base;
  }
  (void)slice;
}

static mcor_status mcor_deliver_triangles(
  mcor_context* context, int64_t triangles, mcor_surface* surface)
{
  const mcor_buffer* buffer = &context->mesh.triangles;
  void* view;
  if (triangles == 0)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_map(context, buffer, (size_t)triangles * 3 * sizeof(cl_int), false, &view));
  mcor_corners corners = { view, surface->triangles + 3 * surface->triangle_count,
    (int32_t)surface->point_count };
  mcor_parallel_for(3 * triangles, MCOR_LIGHT_GRAIN, mcor_copy_corners, &corners);
  return mcor_unmap(context, buffer, &view);
}

/* Evaluated for the array alone, as only trimming needs it, and there at other vertices. */
static mcor_status mcor_add_boundary_eigenvalue(
  mcor_context* context, int points, mcor_surface* surface)
{
  if (points == 0 || !context->options->boundary_eigenvalue)
  {
    return MCOR_OK;
  }
  mcor_buffer* values = &context->out[5];
  MCOR_TRY(mcor_evaluate_boundary(context, &context->out[0], &context->out[1], points, values));
  void* view;
  MCOR_TRY(mcor_map(context, values, (size_t)points * context->cl.real_size, false, &view));
  for (int64_t i = 0; i < points; ++i)
  {
    surface->boundary_eigenvalue[surface->point_count + i] = (float)mcor_get_real(context, view, i);
  }
  return mcor_unmap(context, values, &view);
}

static mcor_status mcor_append_mesh(mcor_context* context, const mcor_input* input, double iso,
  mcor_download* download, mcor_surface* surface)
{
  const int64_t triangles = context->mesh.triangle_count, base = surface->point_count;
  MCOR_TRY(mcor_compact(context, &download->count));
  MCOR_RETURN_IF(base + download->count > INT32_MAX, context, MCOR_OUT_OF_CAPACITY,
    "The surface would have %lld points; 2147483647 is the limit.",
    (long long)(base + download->count));
  MCOR_TRY(mcor_grow_surface(context, input, surface, download->count, triangles));
  MCOR_TRY(mcor_add_attributes(context, input, download->count, surface));
  MCOR_TRY(mcor_add_boundary_eigenvalue(context, download->count, surface));
  MCOR_TRY(mcor_deliver_triangles(context, triangles, surface));
  MCOR_TRY(mcor_map_vertices(context, download));
  mcor_deliver_vertices(context, download, iso, surface);
  surface->point_count += download->count;
  surface->triangle_count += triangles;
  return MCOR_OK;
}

/* Gives back what only making the mesh needed, so that the output finds room. */
static void mcor_release_construction(mcor_context* context)
{
  mcor_mesh* m = &context->mesh;
  mcor_buffer* const buffers[] = { &m->edges, &m->ends, &m->evaluations, &m->remaining, &m->cuts,
    &m->cut_keys, &m->cut_distinct, &m->cut_index, &context->bricks.need };
  for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; ++i)
  {
    mcor_release(context, buffers[i]);
  }
}

/* Appends the mesh of one iso value to the surface. */
mcor_status mcor_append_output(
  mcor_context* context, const mcor_input* input, double iso, mcor_surface* surface)
{
  mcor_download download = { 0 };
  mcor_release_construction(context);
  const mcor_status status = mcor_append_mesh(context, input, iso, &download, surface);
  const mcor_status unmapped = mcor_unmap_vertices(context, &download);
  for (size_t i = 0; i < sizeof context->out / sizeof context->out[0]; ++i)
  {
    mcor_release(context, &context->out[i]);
  }
  return status != MCOR_OK ? status : unmapped;
}
