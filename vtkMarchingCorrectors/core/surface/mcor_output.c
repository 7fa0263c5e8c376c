/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Output [III-D.4]: copies the triangles, and the vertices that they use, to the caller's surface,
 * and makes statistics of the correction. */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_cap.h"
#include "mcor_input.h"
#include "mcor_parallel.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Statistics of a slice of the vertices. */
typedef struct mcor_tally
{
  int64_t trim_vertices, linear, above_tolerance, normals_lacking;
  double count, sum, squares, correction_max, residual_max;
} mcor_tally;

/* The vertices of one iso value while they are copied to the surface. */
typedef struct mcor_download
{
  mcor_context* context;
  double sum_rounding;
  mcor_surface* surface; /* point_count: index of the first new point */
  /* Views of the mesh's buffers. scanned: see mcor_is_output. */
  void *scanned, *node, *offset, *linear, *value, *gradient, *weight, *flag;
  void *eigenvalue, *nearest, *curvature, *cuts; /* if the caller wants them */
  void *triangles, *cells;                       /* cells: if mcor_follows_cells */
  uint8_t* owned;                                /* see mcor_find_counted */
  mcor_mapping views[12]; /* the views above without triangles and cells; `scanned` is first */
  int view_count;
  mcor_tally tallies[MCOR_SLICES];
} mcor_download;

/* Numbers the vertices that triangles use or, if `all` is set, all vertices. scanned[v] becomes the
 * number of such vertices before v, *count the number of all of them. */
static mcor_status mcor_number_vertices(mcor_context* context, bool all, int* count)
{
  mcor_mesh* mesh = &context->mesh;
  const int vertices = mesh->vertex_count;
  const size_t bytes = ((size_t)vertices + 1) * sizeof(cl_int);
  if (!all)
  {
    MCOR_TRY(mcor_fill(context, &mesh->scanned, 0, bytes));
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_trim_used", MCOR_LIGHT, 3 * (size_t)mesh->triangle_count,
      MCOR_INT(mesh->triangle_count), MCOR_BUFFER(&mesh->triangles), MCOR_BUFFER(&mesh->scanned)));
    return mcor_scan(context, &mesh->scanned, vertices, count);
  }
  void* scanned;
  MCOR_TRY(mcor_reserve(context, &mesh->scanned, bytes));
  MCOR_TRY(mcor_map(context, &mesh->scanned, bytes, true, &scanned));
  for (cl_int v = 0; v <= vertices; ++v)
  {
    ((cl_int*)scanned)[v] = v;
  }
  *count = vertices;
  return mcor_unmap(context, &mesh->scanned, &scanned);
}

static const cl_int* mcor_node_of(const mcor_download* d, int64_t v)
{
  return (const cl_int*)d->node + 4 * v;
}

/* Returns the boundary flag of vertex v. For a vertex on a lattice edge, the flag is 4 if the node
 * threshold discarded a cell around the edge, else 0. */
static int mcor_flag_of(const mcor_download* d, int64_t v)
{
  return v < d->context->mesh.march_count ? (mcor_node_of(d, v)[3] >> 2 & 1) * 4
                                          : ((const uint8_t*)d->flag)[v];
}

/* Scales a length of the smallest cells, such as their edge, to the cells of vertex v's level:
 * multiplies it by 2^level, see mcor_adaptive.h. */
static double mcor_length_of(const mcor_download* d, int64_t v, double length)
{
  const int level = mcor_node_of(d, v)[3] >> MCOR_LEVEL_SHIFT;
  return level > 0 ? ldexp(length, level) : length;
}

/* Returns how far the correction moved vertex v, unit L; 0 if v is not on a lattice edge. */
static double mcor_correction_of(const mcor_download* d, int64_t v)
{
  const mcor_lattice* lattice = &d->context->lattice;
  const int axis = mcor_node_of(d, v)[3] & 3;
  return v < d->context->mesh.march_count
    ? fabs(mcor_get_real(d->context, d->linear, v)) * mcor_length_of(d, v, lattice->edge[axis])
    : 0;
}

/* Estimates what the device's rounding of sums may add to a residual: twice the rounding of the
 * greatest term. In a Shepard mean, terms are relative to the iso value. For MCOR_SUM, whose
 * weights may have any size, weights count as 1, as inside the fluid. */
static double mcor_sum_rounding(const mcor_context* context)
{
  const double iso = context->run.iso.value;
  const double unit = context->cl.real_size == sizeof(float) ? FLT_EPSILON : DBL_EPSILON;
  const double low = context->measure.scalar_min, high = context->measure.scalar_max;
  const mcor_field field = context->run.options->field;
  const double most = field == MCOR_WEIGHT_SUM ? iso
    : field == MCOR_SUM                        ? fmax(fabs(low), fabs(high))
                                               : fmax(fabs(iso - low), fabs(high - iso));
  return 2 * unit * most;
}

static void mcor_count_correction(const mcor_download* d, int64_t v, mcor_tally* tally)
{
  const mcor_context* context = d->context;
  const double tolerance =
    context->run.options->tolerance * (context->measure.scalar_max - context->measure.scalar_min);
  const int flag = mcor_flag_of(d, v);
  tally->linear += flag == 2;
  if (flag != 2)
  {
    const double residual = fabs(mcor_get_real(context, d->value, v));
    double gradient = 0; /* each coordinate is rounded, which changes the value */
    for (int a = 0; a < 3; ++a)
    {
      gradient += fabs(mcor_get_real(context, d->gradient, 4 * v + a));
    }
    const double rounding =
      mcor_rounding(context) / mcor_length_of(d, v, context->lattice.cube) * gradient +
      d->sum_rounding;
    tally->residual_max = fmax(tally->residual_max, residual + rounding);
    tally->above_tolerance += residual > tolerance;
  }
  if (flag == 1 || flag == 2)
  {
    ++tally->trim_vertices;
    return;
  }
  const double length = mcor_correction_of(d, v);
  tally->count += 1;
  tally->sum += length;
  tally->squares += length * length;
  tally->correction_max = length > tally->correction_max ? length : tally->correction_max;
}

/* Computes the normal. It is opposite to the gradient; at a vertex that only caps have, it points
 * out of the sides that the vertex is on. The normal is zero if the gradient vanishes. Divides by
 * the greatest component first, because squares of components may underflow or overflow. */
static void mcor_store_normal(
  const mcor_download* d, int64_t v, const double gradient[3], float normal[3])
{
  const cl_int* node = mcor_node_of(d, v);
  const bool is_cap = mcor_is_cap(d->context, v);
  double n[3], most = 0, square = 0;
  for (int a = 0; a < 3; ++a)
  {
    n[a] = !is_cap                                  ? -gradient[a]
      : node[a] == mcor_cap_plane(d->context, a, 0) ? -1
                                                    : node[a] == mcor_cap_plane(d->context, a, 1);
    most = fabs(n[a]) > most ? fabs(n[a]) : most;
  }
  for (int a = 0; a < 3 && most > 0; ++a)
  {
    square += n[a] / most * (n[a] / most);
  }
  for (int a = 0; a < 3; ++a)
  {
    normal[a] = most > 0 ? (float)(n[a] / most / sqrt(square)) : 0;
  }
}

/* Returns the key of a vertex on a lattice edge. Keys are in the order of nodes, then axes. The two
 * vertices of a pinched edge have successive keys. */
static uint64_t mcor_march_key(const mcor_download* d, int64_t v)
{
  const cl_int* node = mcor_node_of(d, v);
  const bool copy = v > 0 && memcmp(node, node - 4, 4 * sizeof *node) == 0;
  return mcor_node_key(&d->context->lattice, node) << 3 | (uint64_t)(node[3] & 3) << 1 |
    (uint64_t)copy;
}

/* Stores the key of vertex v. The key depends on the vertex alone, not on which part of the surface
 * a call makes. Keys ascend in the order of the whole surface's points. */
static void mcor_store_point_key(const mcor_download* d, int64_t v, uint64_t key[MCOR_POINT_KEY])
{
  const mcor_context* context = d->context;
  const cl_ulong* cuts = d->cuts;
  const int64_t cut = v - context->mesh.march_count;
  const bool of_cap = mcor_is_cap(context, v);
  key[0] = 3 * (uint64_t)context->run.iso.number + (of_cap ? 2 : cut >= 0);
  if (of_cap)
  {
    memcpy(key + 1, context->mesh.cap_keys + 2 * (v - context->mesh.cap_first), 2 * sizeof *key);
    return;
  }
  key[1] = mcor_march_key(d, cut < 0 ? v : (int64_t)(cuts[cut] >> 32));
  key[2] = cut < 0 ? 0 : mcor_march_key(d, (int64_t)(cuts[cut] & UINT32_MAX));
}

/* Writes to an array if the caller wants it. */
#define MCOR_STORE(array, number)                                                                  \
  if (array)                                                                                       \
  {                                                                                                \
    (array)[to] = (number);                                                                        \
  }

/* Writes vertex v as point `to` of the surface. */
static void mcor_store_point(const mcor_download* d, int64_t v, int64_t to)
{
  const mcor_context* context = d->context;
  mcor_surface* s = d->surface;
  const double cube = mcor_length_of(d, v, context->lattice.cube);
  const cl_int* at = mcor_node_of(d, v);
  const int level = at[3] >> MCOR_LEVEL_SHIFT, flag = mcor_flag_of(d, v);
  const cl_int nearest = s->nearest_particle ? ((const cl_int*)d->nearest)[v] : -1;
  double gradient[3];
  for (int a = 0; a < 3; ++a)
  {
    /* The origin is a whole number of cells of every level. */
    const double node = (double)((context->lattice.origin[a] >> level) + at[a]);
    s->points[3 * to + a] = (node + mcor_get_real(context, d->offset, 4 * v + a)) *
      mcor_length_of(d, v, context->lattice.edge[a]);
    gradient[a] = mcor_get_real(context, d->gradient, 4 * v + a);
    if (s->gradients)
    {
      s->gradients[3 * to + a] = gradient[a] / cube;
    }
  }
  if (s->normals)
  {
    mcor_store_normal(d, v, gradient, s->normals + 3 * to);
  }
  MCOR_STORE(s->weight_sum, (float)mcor_get_real(context, d->weight, v))
  MCOR_STORE(s->boundary_eigenvalue, (float)mcor_get_real(context, d->eigenvalue, v))
  MCOR_STORE(s->nearest_particle, nearest < 0 ? -1 : mcor_source_of(context, nearest))
  MCOR_STORE(s->mean_curvature, mcor_get_real(context, d->curvature, 2 * v) / cube)
  MCOR_STORE(s->gauss_curvature, mcor_get_real(context, d->curvature, 2 * v + 1) / cube / cube)
  MCOR_STORE(s->correction_length, (float)mcor_correction_of(d, v))
  MCOR_STORE(s->residual, (float)mcor_get_real(context, d->value, v))
  MCOR_STORE(s->boundary_flag, (uint8_t)flag)
  MCOR_STORE(s->iso_value, context->run.iso.value)
  if (s->point_keys)
  {
    mcor_store_point_key(d, v, s->point_keys + MCOR_POINT_KEY * to);
  }
}

static void mcor_deliver_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_download* d = data;
  const cl_int* scanned = d->scanned;
  mcor_tally tally = { 0 };
  for (int64_t v = first; v < last; ++v)
  {
    if (mcor_is_output(scanned, v))
    {
      const int64_t to = d->surface->point_count + scanned[v];
      const float* normals = d->surface->normals;
      mcor_store_point(d, v, to);
      tally.normals_lacking += normals && mcor_lacks_normal(normals + 3 * to);
      const bool counts = !d->owned || d->owned[v] == MCOR_OWN;
      if (counts && !mcor_is_cap(d->context, v))
      {
        mcor_count_correction(d, v, &tally);
      }
    }
  }
  d->tallies[slice] = tally;
}

static mcor_status mcor_deliver_vertices(mcor_context* context, mcor_download* d)
{
  int slices;
  MCOR_TRY(mcor_parallel_run(
    context, context->mesh.vertex_count, MCOR_HEAVY_GRAIN, mcor_deliver_slice, d, &slices));
  mcor_statistics* s = context->run.statistics;
  for (int i = 0; i < slices; ++i)
  {
    const mcor_tally* tally = &d->tallies[i];
    s->trim_vertices += tally->trim_vertices;
    s->trim_vertices_linear += tally->linear;
    s->vertices_above_tolerance += tally->above_tolerance;
    s->correction_max = fmax(s->correction_max, tally->correction_max);
    s->residual_max = fmax(s->residual_max, tally->residual_max);
    context->run.normals_lacking += tally->normals_lacking;
    context->run.correction_count += tally->count;
    context->run.correction_sum += tally->sum;
    context->run.correction_squares += tally->squares;
  }
  return MCOR_OK;
}

static void mcor_deliver_triangles_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_download* d = data;
  mcor_surface* s = d->surface;
  const cl_int *corners = d->triangles, *scanned = d->scanned;
  const cl_ulong* cells = d->cells;
  for (int64_t i = first; i < last; ++i)
  {
    const int64_t to = s->triangle_count + i;
    for (int c = 0; c < 3; ++c)
    {
      s->triangles[3 * to + c] = (int32_t)s->point_count + scanned[corners[3 * i + c]];
    }
    if (cells)
    {
      mcor_keep_cell(d->context, s, to, d->context->run.iso.number, cells[i]);
    }
  }
  (void)slice;
}

/* Evaluates at the vertices what the caller wants: eigenvalue, curvatures, nearest particle. */
static mcor_status mcor_evaluate_outputs(mcor_context* context)
{
  mcor_mesh* mesh = &context->mesh;
  mcor_buffer *nearest = &context->attributes.nearest, *eigenvalue = &context->trim.eigenvalue;
  const size_t vertices = (size_t)mesh->vertex_count, real = context->cl.real_size;
  const bool uniform = context->measure.support_min == context->measure.support_max;
  if (mcor_wants(context, MCOR_OUT_BOUNDARY_EIGENVALUE)) /* trimming had it at other vertices */
  {
    MCOR_TRY(mcor_reserve(context, eigenvalue, vertices * real));
    MCOR_TRY(mcor_evaluate_boundary(context, MCOR_ALL_VERTICES, eigenvalue));
  }
  if (mcor_wants(context, MCOR_OUT_MEAN_CURVATURE | MCOR_OUT_GAUSS_CURVATURE))
  {
    MCOR_TRY(mcor_reserve(context, &mesh->curvature, 2 * vertices * real));
    MCOR_TRY(MCOR_LAUNCH_AT_VERTICES(context, MCOR_ALL_VERTICES, "mcor_curvature_points",
      MCOR_BUFFER(&mesh->offset), MCOR_REAL(context->run.iso.relative),
      MCOR_INT(context->space.flat), MCOR_BUFFER(&mesh->curvature)));
  }
  if (mcor_wants(context, MCOR_OUT_NEAREST_PARTICLE))
  {
    MCOR_TRY(mcor_reserve(context, nearest, vertices * sizeof(cl_int)));
    MCOR_TRY(MCOR_LAUNCH_AT_VERTICES(context, MCOR_ALL_VERTICES, "mcor_attribute_nearest",
      MCOR_BUFFER(&mesh->offset), MCOR_INT(uniform), MCOR_BUFFER(&context->grid.order),
      MCOR_BUFFER(nearest)));
  }
  return MCOR_OK;
}

/* Makes the device evaluate the outputs that the caller wants at vertices, and begins to read the
 * vertices. Meanwhile the host delivers triangles. */
static mcor_status mcor_begin_vertices(mcor_download* d)
{
  if (d->view_count > 0)
  {
    MCOR_TRY(mcor_evaluate_outputs(d->context));
  }
  return mcor_begin_mapping(d->context, d->views + 1, d->view_count - 1);
}

static mcor_status mcor_deliver_triangles(mcor_download* d)
{
  mcor_context* context = d->context;
  mcor_surface* s = d->surface;
  mcor_buffer *triangles = &context->mesh.triangles, *cells = &context->box.cells;
  const int64_t count = context->mesh.triangle_count;
  const mcor_mapping views[] = { { triangles, 3 * (size_t)count * sizeof(cl_int), &d->triangles },
    { cells, (size_t)count * sizeof(cl_ulong), &d->cells } };
  const int mapped = count == 0 ? 0 : mcor_follows_cells(context) ? 2 : 1;
  MCOR_TRY(
    mcor_grow(context, (void**)&s->triangles, s->triangle_count, count, 3 * sizeof(int32_t)));
  MCOR_TRY(mcor_extend_kept(context, count, s));
  mcor_status status = mcor_map_all(context, views, mapped);
  MCOR_THEN(status, mcor_begin_vertices(d));
  MCOR_THEN(status,
    mcor_parallel_run(context, count, MCOR_LIGHT_GRAIN, mcor_deliver_triangles_slice, d, NULL));
  MCOR_TRY(mcor_unmap_all(context, views, mapped, status));
  mcor_release(context, triangles);
  return MCOR_OK;
}

/* Appends to the surface the mesh's triangles, and the `count` vertices of the mesh that go to the
 * output, with their attributes. */
static mcor_status mcor_deliver(mcor_download* d, const mcor_input* input, int count)
{
  mcor_context* context = d->context;
  mcor_surface* surface = d->surface;
  const int64_t base = surface->point_count;
  MCOR_FAIL_IF(base + count > INT32_MAX, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(POINTS_TOO_MANY),
    (long long)(base + count), INT32_MAX);
  MCOR_TRY(mcor_find_counted(context, &d->owned));
  MCOR_TRY(mcor_deliver_triangles(d));
  MCOR_TRY(mcor_grow_surface(context, input, surface, count));
  if (count > 0)
  {
    MCOR_TRY(mcor_finish(context));
    mcor_number_lines(context, d->scanned, base);
    MCOR_TRY(mcor_deliver_vertices(context, d));
    MCOR_TRY(mcor_add_attributes(context, input, d->scanned, surface));
  }
  surface->point_count += count;
  surface->triangle_count += context->mesh.triangle_count;
  return MCOR_OK;
}

/* Whether the output still needs particles on the device, e.g. for attribute components beyond
 * MCOR_ATTRIBUTE_LIMIT, which are evaluated at the vertices of the finished mesh. */
bool mcor_output_evaluates(const mcor_context* context)
{
  return context->attributes.varying_count > MCOR_ATTRIBUTE_LIMIT ||
    mcor_wants(context,
      MCOR_OUT_BOUNDARY_EIGENVALUE | MCOR_OUT_MEAN_CURVATURE | MCOR_OUT_GAUSS_CURVATURE |
        MCOR_OUT_NEAREST_PARTICLE);
}

/* Appends the mesh of one iso value to the surface. */
mcor_status mcor_append_output(
  mcor_context* context, const mcor_input* input, bool all, mcor_surface* surface)
{
  mcor_mesh* m = &context->mesh;
  mcor_buffer *eigenvalue = &context->trim.eigenvalue, *nearest = &context->attributes.nearest;
  mcor_download d = {
    .context = context, .sum_rounding = mcor_sum_rounding(context), .surface = surface
  };
  const size_t real = context->cl.real_size, n = (size_t)m->vertex_count,
               cuts = (size_t)(m->cap_first - m->march_count);
  const bool curved = mcor_wants(context, MCOR_OUT_MEAN_CURVATURE | MCOR_OUT_GAUSS_CURVATURE),
             has_eigenvalue = mcor_wants(context, MCOR_OUT_BOUNDARY_EIGENVALUE),
             has_nearest = mcor_wants(context, MCOR_OUT_NEAREST_PARTICLE),
             has_keys = mcor_wants(context, MCOR_OUT_POINT_KEYS);
  const mcor_mapping views[12] = { { &m->scanned, (n + 1) * sizeof(cl_int), &d.scanned },
    { &m->node, n * 4 * sizeof(cl_int), &d.node }, { &m->offset, n * 4 * real, &d.offset },
    { &m->linear, (size_t)m->march_count * real, &d.linear },
    { &m->field_value, n * real, &d.value }, { &m->gradient, n * 4 * real, &d.gradient },
    { &m->vertex_weight, n * real, &d.weight }, { &m->flag, n, &d.flag },
    { eigenvalue, has_eigenvalue ? n * real : 0, &d.eigenvalue },
    { nearest, has_nearest ? n * sizeof(cl_int) : 0, &d.nearest },
    { &m->curvature, curved ? 2 * n * real : 0, &d.curvature },
    { &m->cut_edges, has_keys ? cuts * sizeof(cl_ulong) : 0, &d.cuts } };
  int count = 0;
  /* Frees buffers that only the mesh needed, to make room for the output. When the output is done,
   * frees the buffers that only the output needed. */
  MCOR_RELEASE_EACH(context, &context->trim);
  MCOR_RELEASE(context, &m->edges, &m->ends, &m->evaluations, &context->bricks.need);
  mcor_status status = mcor_number_vertices(context, all, &count);
  memcpy(d.views, views, sizeof views);
  d.view_count = count > 0 ? (int)(sizeof views / sizeof *views) : 0;
  MCOR_THEN(status, mcor_map_all(context, views, count > 0));
  MCOR_THEN(status, mcor_deliver(&d, input, count));
  status = mcor_unmap_all(context, views, d.view_count, status);
  mcor_release_attributes(context);
  MCOR_RELEASE(context, &m->node, &m->offset, &m->linear, &m->field_value, &m->gradient,
    &m->vertex_weight, &m->means, &m->curvature, &m->flag, &m->cut_edges, &m->scanned, eigenvalue);
  free(d.owned);
  return status;
}
