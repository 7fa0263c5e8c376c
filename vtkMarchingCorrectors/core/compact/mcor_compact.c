/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compact contours. Where the surface passes close to a node, Marching Cubes makes slivers.
 * Therefore the vertices of one node that are joined by edges are merged into their mean [Moore and
 * Warren], which then moves along the gradient onto the surface. Triangles with two equal corners
 * vanish.
 *
 * The vertices of one merged vertex are a bunch. If it does not reach the surface, or turns a
 * triangle over, its bunch is taken apart again, which is always possible. This may turn over
 * triangles beside it, so this is done in two rounds. Then the vertices of the remaining slivers
 * move (mcor_compact_face.c).
 *
 * Merged vertices, and vertices that moved, are appended to the mesh. At the end they take the
 * places, and so the keys, of the vertices that they replace; those of a bunch take the first
 * vertex's place. */

#include "mcor_compact.h"
#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_parallel.h"
#include "mcor_vector.h"

#include <stdlib.h>
#include <string.h>

/* ---- Vertices ---- */

typedef struct mcor_reading
{
  const mcor_bunches* bunches;
  void *node, *offset, *linear, *gradient;
} mcor_reading;

static void mcor_read_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_reading* from = data;
  const mcor_context* context = from->bunches->context;
  for (int64_t i = from->bunches->point_count + first; i < from->bunches->point_count + last; ++i)
  {
    const cl_int* node = (const cl_int*)from->node + 4 * i;
    const int fix = MCOR_POINT_FIX + (node[3] >> MCOR_LEVEL_SHIFT);
    const double unit = (double)(INT64_C(1) << fix);
    mcor_point* point = &from->bunches->points[i];
    double gradient[3];
    *point = (mcor_point){ .node = { node[0], node[1], node[2], node[3] },
      .missed = mcor_get_real(context, from->linear, i) > 0 };
    for (int a = 0; a < 3; ++a)
    {
      point->at[a] = ((int64_t)node[a] << fix) +
        (int64_t)(mcor_get_real(context, from->offset, 4 * i + a) * unit);
      gradient[a] = mcor_get_real(context, from->gradient, 4 * i + a);
    }
    mcor_normalise(gradient);
    for (int a = 0; a < 3; ++a)
    {
      point->uphill[a] = (float)gradient[a];
    }
  }
  (void)slice;
}

/* Reads the vertices that the mesh has got since the last call. */
static mcor_status mcor_read_points(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)mesh->vertex_count, real = context->cl.real_size;
  mcor_point* points = realloc(bunches->points, n * sizeof *points);
  MCOR_TRY(mcor_allocated(context, points));
  bunches->points = points;
  mcor_use_large_pages(
    points + bunches->point_count, (n - (size_t)bunches->point_count) * sizeof *points);
  mcor_reading from = { .bunches = bunches };
  const mcor_mapping views[] = { { &mesh->node, 4 * n * sizeof(cl_int), &from.node },
    { &mesh->offset, 4 * n * real, &from.offset }, { &mesh->linear, n * real, &from.linear },
    { &mesh->gradient, 4 * n * real, &from.gradient } };
  mcor_status status = mcor_map_all(context, views, 4);
  MCOR_THEN(status,
    mcor_parallel_run(context, mesh->vertex_count - bunches->point_count, MCOR_LIGHT_GRAIN,
      mcor_read_slice, &from, NULL));
  bunches->point_count = mesh->vertex_count;
  return mcor_unmap_all(context, views, 4, status);
}

/* Nodes of vertices that are being appended to the mesh, and where their lines begin. */
typedef struct mcor_adding
{
  const mcor_bunches* bunches;
  cl_int* node;
  void* offset; /* real [][4] */
} mcor_adding;

/* The vertices keep the nodes of the vertices that they replace. */
static void mcor_add_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_adding* add = data;
  const mcor_bunches* bunches = add->bunches;
  for (int64_t i = first; i < last; ++i)
  {
    mcor_start* start = &bunches->starts.of[i];
    start->last = bunches->of[start->vertex].now;
    const cl_int* node = bunches->points[start->last].node;
    const int fix = MCOR_POINT_FIX + (node[3] >> MCOR_LEVEL_SHIFT);
    memcpy(add->node + 4 * i, node, 4 * sizeof *node);
    for (int a = 0; a < 3; ++a)
    {
      mcor_put_real(bunches->context, add->offset, 4 * i + a,
        (double)(start->at[a] - ((int64_t)node[a] << fix)) / (double)(INT64_C(1) << fix));
    }
  }
  (void)slice;
}

mcor_status mcor_add_vertices(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  mcor_mesh* mesh = &context->mesh;
  const int first = mesh->vertex_count, count = (int)bunches->starts.count;
  const size_t o = (size_t)first, n = (size_t)count, width = 4 * context->cl.real_size;
  if (count == 0)
  {
    return MCOR_OK;
  }
  mcor_adding add = { bunches, malloc(16 * n), calloc(n, width) };
  mcor_status status = mcor_allocated(context, add.node && add.offset);
  MCOR_THEN(
    status, mcor_parallel_run(context, count, MCOR_HEAVY_GRAIN, mcor_add_slice, &add, NULL));
  MCOR_THEN(status, mcor_extend_vertices(context, first, first + count));
  MCOR_THEN(status, mcor_reserve(context, &mesh->evaluations, o + n));
  MCOR_THEN(status, mcor_append_bytes(context, &mesh->node, 16 * o, add.node, 16 * n));
  MCOR_THEN(status, mcor_append_bytes(context, &mesh->offset, width * o, add.offset, width * n));
  free(add.node);
  free(add.offset);
  MCOR_TRY(status);
  mesh->march_count = first;
  mesh->vertex_count = first + count;
  for (int l = 0, i = 0; l < context->lattice.levels; ++l) /* they are sorted by level, too */
  {
    while (i < count && bunches->starts.of[i].vertex < mesh->level_first[0][l])
    {
      ++i;
    }
    mesh->level_first[1][l] = first + i;
  }
  MCOR_TRY(mcor_launch_correction(context, MCOR_ON_BOUNDARY, true));
  for (int i = 0; i < count; ++i)
  {
    mcor_set_place(bunches, bunches->starts.of[i].vertex, first + i);
  }
  return mcor_read_points(bunches);
}

/* ---- In order again ---- */

typedef struct mcor_gathering
{
  const int32_t* from;
  size_t width;
  void *in, *out;
} mcor_gathering;

static void mcor_gather_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_gathering* g = data;
  for (int64_t i = first; i < last; ++i)
  {
    memcpy((uint8_t*)g->out + (size_t)i * g->width,
      (const uint8_t*)g->in + (size_t)g->from[i] * g->width, g->width);
  }
  (void)slice;
}

/* Gathers an array's elements, `width` bytes each. */
static mcor_status mcor_gather(
  mcor_context* context, mcor_buffer* array, size_t width, const int32_t* from, int old, int count)
{
  mcor_buffer in = *array;
  mcor_gathering g = { .from = from, .width = width };
  *array = (mcor_buffer){ 0 };
  mcor_status status = mcor_reserve(context, array, (size_t)count * width);
  MCOR_THEN(status, mcor_map(context, &in, (size_t)old * width, false, &g.in));
  MCOR_THEN(status, mcor_map(context, array, (size_t)count * width, true, &g.out));
  MCOR_THEN(
    status, mcor_parallel_run(context, count, MCOR_LIGHT_GRAIN, mcor_gather_slice, &g, NULL));
  const mcor_mapping mapped[] = { { &in, 0, &g.in }, { array, 0, &g.out } };
  status = mcor_unmap_all(context, mapped, 2, status);
  mcor_release(context, &in);
  return status;
}

/* Drops the triangles that vanish, and the vertices that are replaced. */
static mcor_status mcor_drop_replaced(mcor_bunches* bunches, const int cut_first[])
{
  mcor_context* context = bunches->context;
  mcor_mesh* mesh = &context->mesh;
  const size_t real = context->cl.real_size, means = (size_t)context->attributes.count * real;
  const int old = mesh->vertex_count;
  const size_t n = (size_t)bunches->vertex_count;
  int count = 0;
  size_t left = 0;
  /* below: how many vertices stay before each vertex; from: the places of those that stay; number:
   * their numbers, by place. */
  int32_t* const below = malloc((2 * n + 1 + (size_t)old) * sizeof *below);
  MCOR_TRY(mcor_allocated(context, below));
  int32_t *const from = below + n + 1, *const number = from + n;
  memset(number, 0xff, (size_t)old * sizeof *number);
  for (int32_t v = 0; v < bunches->vertex_count; ++v)
  {
    const int32_t place = bunches->of[v].now;
    below[v] = count;
    if (number[place] < 0)
    {
      number[place] = count;
      from[count++] = place;
    }
    else if (bunches->of[v].held)
    {
      from[count++] = v;
    }
  }
  below[bunches->vertex_count] = count;
  for (int64_t t = 0; t < bunches->triangle_count; ++t)
  {
    int32_t place[3];
    if (mcor_places_of(bunches, t, place))
    {
      for (size_t c = 0; c < 3; ++c)
      {
        bunches->triangles[3 * left + c] = number[place[c]];
      }
      if (bunches->cells)
      {
        bunches->cells[left] = bunches->cells[t];
      }
      ++left;
    }
  }
  for (size_t i = 0; i < bunches->cut_count; ++i)
  {
    cl_ulong* cut = &bunches->cuts[i];
    *cut = (cl_ulong)below[*cut >> 32] << 32 | (cl_ulong)below[*cut & UINT32_MAX];
  }
  for (int l = 0; l < context->lattice.levels; ++l)
  {
    mesh->level_first[0][l] = below[mesh->level_first[0][l]];
    mesh->level_first[1][l] = below[cut_first[l]];
  }
  mesh->march_count = below[bunches->march_count];
  mesh->cap_first = below[mesh->cap_first];
  mesh->vertex_count = count;
  mesh->triangle_count = (int)left;
  struct
  {
    mcor_buffer* array;
    size_t width;
  } const arrays[] = { { &mesh->node, 16 }, { &mesh->offset, 4 * real }, { &mesh->linear, real },
    { &mesh->field_value, real }, { &mesh->gradient, 4 * real }, { &mesh->vertex_weight, real },
    { &mesh->flag, 1 }, { &mesh->means, means } };
  mcor_status status = MCOR_OK;
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; ++i)
  {
    if (arrays[i].width > 0)
    {
      MCOR_THEN(status, mcor_gather(context, arrays[i].array, arrays[i].width, from, old, count));
    }
  }
  free(below);
  MCOR_THEN(status,
    mcor_write(
      context, &mesh->cut_edges, bunches->cuts, bunches->cut_count * sizeof *bunches->cuts));
  MCOR_THEN(
    status, mcor_write(context, &mesh->triangles, bunches->triangles, 3 * left * sizeof(cl_int)));
  if (bunches->cells)
  {
    MCOR_THEN(status,
      mcor_write(context, &context->box.cells, bunches->cells, left * sizeof *bunches->cells));
  }
  return status;
}

/* ---- All of it ---- */

static mcor_status mcor_merge(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)bunches->vertex_count, triangles = (size_t)bunches->triangle_count,
               corners = 3 * triangles * sizeof(int32_t),
               cuts = bunches->cut_count * sizeof *bunches->cuts,
               cells = mcor_follows_cells(context) ? triangles * sizeof *bunches->cells : 0;
  int cut_first[MCOR_TREE_LEVEL_LIMIT + 2];
  memcpy(cut_first, mesh->level_first[1], sizeof cut_first);
  bunches->of = malloc(n * sizeof *bunches->of);
  bunches->triangles = malloc(corners);
  bunches->before = malloc(corners);
  bunches->cuts = malloc(cuts + 1);
  bunches->cells = cells > 0 ? malloc(cells) : NULL;
  MCOR_TRY(mcor_allocated(context,
    bunches->of && bunches->triangles && bunches->before && bunches->cuts &&
      (bunches->cells || cells == 0)));
  mcor_use_large_pages(bunches->of, n * sizeof *bunches->of);
  mcor_use_large_pages(bunches->triangles, corners);
  mcor_use_large_pages(bunches->before, corners);
  MCOR_TRY(mcor_read(context, &mesh->triangles, 0, bunches->triangles, corners));
  MCOR_TRY(mcor_read(context, &mesh->cut_edges, 0, bunches->cuts, cuts));
  MCOR_TRY(mcor_read(context, &context->box.cells, 0, bunches->cells, cells));
  MCOR_TRY(mcor_read_points(bunches));
  MCOR_TRY(mcor_find_bunches(bunches));
  MCOR_TRY(mcor_add_vertices(bunches));
  MCOR_TRY(mcor_take_apart(bunches));
  MCOR_TRY(mcor_move_slivers(bunches));
  return mcor_drop_replaced(bunches, cut_first);
}

mcor_status mcor_compact(mcor_context* context)
{
  const mcor_mesh* mesh = &context->mesh;
  mcor_bunches bunches = { .context = context,
    .corners = context->space.axes,
    .march_count = mesh->march_count,
    .vertex_count = mesh->vertex_count,
    .triangle_count = mesh->triangle_count,
    .cut_count = (size_t)(mesh->cap_first - mesh->march_count) };
  if (mesh->triangle_count == 0 || mesh->march_count == 0)
  {
    return MCOR_OK;
  }
  for (int a = 0; a < 3; ++a)
  {
    bunches.edge[a] = mcor_edge_of(&context->lattice, a);
  }
  const mcor_status status = mcor_merge(&bunches);
  free(bunches.of);
  free(bunches.triangles);
  free(bunches.before);
  free(bunches.cuts);
  free(bunches.cells);
  free(bunches.points);
  free(bunches.starts.of);
  return status;
}
