/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compact contours. Where the surface passes close to a node, Marching Cubes makes slivers. Each
 * vertex belongs to the nearer end of its lattice edge, which is a node. Vertices of one node that
 * are joined by edges of triangles are merged into one vertex at their mean [Moore and Warren]. The
 * merged vertex then moves along the gradient onto the surface. Triangles with two equal corners
 * vanish.
 *
 * The vertices that become one merged vertex are a bunch. If the merged vertex does not reach the
 * surface, or turns a triangle over, its bunch is taken apart again, which is always possible. This
 * may turn over triangles around the bunch, so there are two rounds. After these rounds, the
 * vertices of the remaining slivers move (mcor_compact_face.c).
 *
 * Merged vertices, and vertices that moved, are appended to the mesh. At the end each appended
 * vertex takes the place, and so the key, of the vertex that it replaces; a merged vertex replaces
 * the first vertex of its bunch. The other vertices of the bunch stay in the mesh, but no triangle
 * uses them. */

#include "mcor_compact.h"
#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_vector.h"

#include <stdlib.h>
#include <string.h>

/* ---- Vertices ---- */

static void mcor_read_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  const mcor_context* context = bunches->context;
  for (int64_t i = bunches->point_count + first; i < bunches->point_count + last; ++i)
  {
    const cl_int* node = (const cl_int*)bunches->node + 4 * i;
    const int fix = MCOR_POINT_FIX + (node[3] >> MCOR_LEVEL_SHIFT);
    const double unit = (double)(INT64_C(1) << fix);
    mcor_point* point = &bunches->points[i];
    double gradient[3];
    *point = (mcor_point){ .node = { node[0], node[1], node[2], node[3] },
      .missed = mcor_get_real(context, bunches->linear, i) > 0 };
    for (int a = 0; a < 3; ++a)
    {
      point->at[a] = ((int64_t)node[a] << fix) +
        (int64_t)(mcor_get_real(context, bunches->offset, 4 * i + a) * unit);
      gradient[a] = mcor_get_real(context, bunches->gradient, 4 * i + a);
    }
    mcor_normalise(gradient);
    for (int a = 0; a < 3; ++a)
    {
      point->uphill[a] = (float)gradient[a];
    }
  }
  (void)slice;
}

/* Reads from the device the vertices that were added to the mesh since the last call. */
static mcor_status mcor_read_points(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)mesh->vertex_count, real = context->cl.real_size;
  if (n > bunches->point_room)
  {
    /* Makes room for the merged vertices, too: at most half as many as the vertices. So appending
     * them needs no larger array. */
    bunches->point_room = n + n / 2;
    const size_t bytes = bunches->point_room * sizeof *bunches->points;
    mcor_point* points = realloc(bunches->points, bytes);
    MCOR_TRY(mcor_allocated(context, points));
    bunches->points = points;
    mcor_use_large_pages(points, bytes);
  }
  const mcor_mapping views[] = { { &mesh->node, 4 * n * sizeof(cl_int), &bunches->node },
    { &mesh->offset, 4 * n * real, &bunches->offset },
    { &mesh->linear, n * real, &bunches->linear },
    { &mesh->gradient, 4 * n * real, &bunches->gradient } };
  mcor_status status = mcor_map_all(context, views, 4);
  MCOR_THEN(status,
    mcor_parallel_run(context, mesh->vertex_count - bunches->point_count, MCOR_LIGHT_GRAIN,
      mcor_read_slice, bunches, NULL));
  bunches->point_count = mesh->vertex_count;
  return mcor_unmap_all(context, views, 4, status);
}

/* Fills the arrays `node` and `offset` for the vertices in `starts`. A vertex has the node of the
 * vertex that it replaces. The offset leads from this node to the point where the correction
 * begins, in cells of the vertex's level. Also sets start->last. */
static void mcor_add_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  for (int64_t i = first; i < last; ++i)
  {
    mcor_start* start = &bunches->starts.of[i];
    start->last = bunches->of[start->vertex].now;
    const cl_int* node = bunches->points[start->last].node;
    const int fix = MCOR_POINT_FIX + (node[3] >> MCOR_LEVEL_SHIFT);
    memcpy((cl_int*)bunches->node + 4 * i, node, 4 * sizeof *node);
    for (int a = 0; a < 3; ++a)
    {
      mcor_put_real(bunches->context, bunches->offset, 4 * i + a,
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
  bunches->node = malloc(16 * n);
  bunches->offset = calloc(n, width);
  mcor_status status = mcor_allocated(context, bunches->node && bunches->offset);
  MCOR_THEN(
    status, mcor_parallel_run(context, count, MCOR_HEAVY_GRAIN, mcor_add_slice, bunches, NULL));
  MCOR_THEN(status, mcor_extend_vertices(context, first, first + count));
  MCOR_THEN(status, mcor_reserve(context, &mesh->evaluations, o + n));
  MCOR_THEN(status, mcor_append_bytes(context, &mesh->node, 16 * o, bunches->node, 16 * n));
  MCOR_THEN(
    status, mcor_append_bytes(context, &mesh->offset, width * o, bunches->offset, width * n));
  free(bunches->node);
  free(bunches->offset);
  bunches->node = bunches->offset = NULL; /* as they must be before mcor_map_all */
  MCOR_TRY(status);
  mesh->march_count = first;
  mesh->vertex_count = first + count;
  for (int l = 0, i = 0; l < context->lattice.levels; ++l) /* starts are sorted by level, too */
  {
    while (i < count && bunches->starts.of[i].vertex < mesh->level_first[0][l])
    {
      ++i;
    }
    mesh->level_first[1][l] = first + i;
  }
  MCOR_TRY(mcor_launch_correction(context, MCOR_ON_BOUNDARY, true));
  MCOR_TRY(mcor_read_points(bunches));
  for (int i = 0; i < count; ++i)
  {
    bunches->points[first + i].replaces = bunches->starts.of[i].vertex;
    mcor_set_place(bunches, bunches->starts.of[i].vertex, first + i);
  }
  return MCOR_OK;
}

/* ---- The compact surface ---- */

/* Moves the slice's triangles whose corners still differ to the front of the slice. Each corner
 * becomes the place of its vertex in the mesh. If the vertex is an appended one, the corner becomes
 * the place of the vertex that the appended one replaces, see mcor_end_bunches. */
static void mcor_keep_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_bunches* bunches = data;
  int64_t to = first;
  for (int64_t t = first; t < last; ++t)
  {
    int32_t place[3];
    if (mcor_places_of(bunches, t, place))
    {
      for (int c = 0; c < 3; ++c)
      {
        bunches->triangles[3 * to + c] =
          place[c] < bunches->vertex_count ? place[c] : bunches->points[place[c]].replaces;
      }
      if (bunches->cells)
      {
        bunches->cells[to] = bunches->cells[t];
      }
      ++to;
    }
  }
  bunches->slice_first[slice] = first;
  bunches->slice_left[slice] = to - first;
}

/* mesh.linear tells how far the correction moved a vertex: as a share of the vertex's edge, but
 * in cubes if the vertex is an appended one. Turns these lengths in cubes into shares, too. */
static mcor_status mcor_share_moves(const mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  const size_t count = (size_t)(bunches->point_count - bunches->vertex_count),
               real = context->cl.real_size, first = (size_t)bunches->vertex_count * real;
  if (bunches->edge[0] == 1 && bunches->edge[1] == 1 && bunches->edge[2] == 1)
  {
    return MCOR_OK;
  }
  void* moved = malloc(count * real + 1);
  mcor_status status = mcor_allocated(context, moved);
  MCOR_THEN(status, mcor_read(context, &context->mesh.linear, first, moved, count * real));
  for (size_t i = 0; i < count && status == MCOR_OK; ++i)
  {
    const int axis = bunches->points[(size_t)bunches->vertex_count + i].node[3] & 3;
    mcor_put_real(
      context, moved, (int64_t)i, mcor_get_real(context, moved, (int64_t)i) / bunches->edge[axis]);
  }
  MCOR_THEN(status, mcor_append_bytes(context, &context->mesh.linear, first, moved, count * real));
  free(moved);
  return status;
}

/* Removes triangles that vanished. Copies each appended vertex that is still in use to the place of
 * the vertex that it replaces. */
static mcor_status mcor_end_bunches(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  mcor_mesh* mesh = &context->mesh;
  const size_t width = 3 * sizeof(cl_int),
               appended = (size_t)(bunches->point_count - bunches->vertex_count);
  size_t left = 0, count = 0;
  int slices;
  bunches->pairs = malloc(2 * appended * sizeof *bunches->pairs + 1);
  MCOR_TRY(mcor_allocated(context, bunches->pairs));
  if (mcor_follows_cells(context))
  {
    const size_t bytes = (size_t)bunches->triangle_count * sizeof *bunches->cells;
    bunches->cells = malloc(bytes);
    MCOR_TRY(mcor_allocated(context, bunches->cells));
    MCOR_TRY(mcor_read(context, &context->box.cells, 0, bunches->cells, bytes));
  }
  MCOR_TRY(mcor_parallel_run(
    context, bunches->triangle_count, MCOR_LIGHT_GRAIN, mcor_keep_slice, bunches, &slices));
  for (int i = 0; i < slices; ++i)
  {
    const size_t from = (size_t)bunches->slice_first[i], n = (size_t)bunches->slice_left[i];
    memmove(bunches->triangles + 3 * left, bunches->triangles + 3 * from, n * width);
    if (bunches->cells)
    {
      memmove(bunches->cells + left, bunches->cells + from, n * sizeof *bunches->cells);
    }
    left += n;
  }
  for (int32_t place = bunches->vertex_count; place < bunches->point_count; ++place)
  {
    const int32_t v = bunches->points[place].replaces;
    if (bunches->of[v].now == place)
    {
      bunches->pairs[count++] = v;
      bunches->pairs[count++] = place;
    }
  }
  mesh->triangle_count = (int)left;
  MCOR_TRY(mcor_write(context, &mesh->triangles, bunches->triangles, left * width));
  if (bunches->cells)
  {
    MCOR_TRY(
      mcor_write(context, &context->box.cells, bunches->cells, left * sizeof *bunches->cells));
  }
  const struct
  {
    const mcor_buffer* array;
    int width;
  } arrays[] = { { &mesh->offset, 4 }, { &mesh->linear, 1 }, { &mesh->field_value, 1 },
    { &mesh->gradient, 4 }, { &mesh->vertex_weight, 1 },
    { &mesh->means, context->attributes.count } };
  mcor_buffer replaced = { 0 };
  mcor_status status = mcor_share_moves(bunches);
  MCOR_THEN(status, mcor_write(context, &replaced, bunches->pairs, count * sizeof(cl_int)));
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; ++i)
  {
    MCOR_THEN(status,
      MCOR_LAUNCH(context, "mcor_march_replace", MCOR_LIGHT, count / 2, MCOR_INT((int)(count / 2)),
        MCOR_BUFFER(&replaced), MCOR_INT(arrays[i].width), MCOR_BUFFER(arrays[i].array)));
  }
  mcor_release(context, &replaced);
  return status;
}

mcor_status mcor_compact(mcor_context* context)
{
  mcor_mesh* mesh = &context->mesh;
  const size_t corners = 3 * (size_t)mesh->triangle_count * sizeof(int32_t);
  int cut_first[MCOR_TREE_LEVEL_LIMIT + 2];
  if (mesh->triangle_count == 0 || mesh->march_count == 0)
  {
    return MCOR_OK;
  }
  mcor_bunches bunches = { .context = context,
    .corners = context->space.axes,
    .march_count = mesh->march_count,
    .vertex_count = mesh->vertex_count,
    .triangle_count = mesh->triangle_count,
    .triangles = malloc(corners),
    .of = malloc((size_t)mesh->vertex_count * sizeof *bunches.of),
    .before = malloc(corners) };
  for (int a = 0; a < 3; ++a)
  {
    bunches.edge[a] = mcor_edge_of(&context->lattice, a);
  }
  memcpy(cut_first, mesh->level_first[1], sizeof cut_first);
  mcor_status status = mcor_allocated(context, bunches.triangles && bunches.of && bunches.before);
  mcor_use_large_pages(bunches.triangles, corners);
  mcor_use_large_pages(bunches.of, (size_t)mesh->vertex_count * sizeof *bunches.of);
  mcor_use_large_pages(bunches.before, corners);
  MCOR_THEN(status, mcor_read(context, &mesh->triangles, 0, bunches.triangles, corners));
  MCOR_THEN(status, mcor_read_points(&bunches));
  MCOR_THEN(status, mcor_find_bunches(&bunches));
  MCOR_THEN(status, mcor_add_vertices(&bunches));
  MCOR_THEN(status, mcor_take_apart(&bunches));
  MCOR_THEN(status, mcor_move_slivers(&bunches));
  MCOR_THEN(status, mcor_end_bunches(&bunches));
  memcpy(mesh->level_first[1], cut_first, sizeof cut_first);
  mesh->march_count = bunches.march_count;
  mesh->vertex_count = bunches.vertex_count;
  free(bunches.of);
  free(bunches.triangles);
  free(bunches.before);
  free(bunches.points);
  free(bunches.starts.of);
  free(bunches.cells);
  free(bunches.pairs);
  return status;
}
