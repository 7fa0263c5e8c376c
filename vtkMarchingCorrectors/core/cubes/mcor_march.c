/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Extraction [III-D.1]: makes vertices and triangles, for uniform and adaptive cubes. Bricks'
 * slots (places for node values) and vertices are sorted by level. */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_plane.h"

#include <string.h>

/* ---- Cells ---- */

static mcor_status mcor_read_int(
  mcor_context* context, const mcor_buffer* buffer, int at, cl_int* element)
{
  return mcor_read(context, buffer, (size_t)at * sizeof *element, element, sizeof *element);
}

/* Finds the used cells, which the surface crosses, in the box and the ring of cells around it. */
static mcor_status mcor_find_used(mcor_context* context)
{
  const mcor_bricks* bricks = &context->bricks;
  mcor_adaptive* adaptive = &context->adaptive;
  mcor_mesh* mesh = &context->mesh;
  mcor_statistics* s = context->run.statistics;
  const size_t n = (size_t)bricks->now.count;
  int used, hits;
  cl_int begin = 0, end;
  MCOR_TRY(mcor_reserve(context, &mesh->used, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_copy(context, &bricks->cells, &mesh->used, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_keep_squares(context, &mesh->used));
  MCOR_TRY(mcor_clip_near(context, &mesh->used));
  MCOR_TRY(mcor_reserve(context, &mesh->plain_used, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_fill(context, &mesh->triangle_base, 0, (n + 1) * sizeof(cl_int)));
  if (adaptive->count > 0) /* finds used cells that touch finer leaves, marks their edges */
  {
    const mcor_buffer* owned;
    cl_int flat = 0;
    MCOR_TRY(mcor_find_owned(context, &mesh->used, &owned));
    MCOR_TRY(
      mcor_fill(context, &adaptive->quadrants, 0, n * MCOR_QUADRANT_WORDS * sizeof(cl_uint)));
    MCOR_TRY(mcor_write(context, &adaptive->flat, &flat, sizeof flat));
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_march_hanging", MCOR_MEDIUM, adaptive->count,
      MCOR_LEAF_ARGS(context), MCOR_BUFFER(&bricks->plain), MCOR_BUFFER(owned),
      MCOR_BUFFER(&adaptive->quadrants), MCOR_BUFFER(&mesh->used),
      MCOR_BUFFER(&mesh->triangle_base), MCOR_BUFFER(&adaptive->flat)));
    MCOR_TRY(mcor_read(context, &adaptive->flat, 0, &flat, sizeof flat));
    s->flat_loops += flat;
  }
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_march_classify", MCOR_MEDIUM, bricks->now.count,
    MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->neighbours), MCOR_BUFFER(&bricks->plain),
    MCOR_BUFFER(&bricks->now.above), MCOR_BUFFER(&bricks->now.valid), MCOR_BUFFER(&mesh->used),
    MCOR_BUFFER(&mesh->plain_used)));
  MCOR_TRY(mcor_count_cells(context, &bricks->seeds, &mesh->used, &hits));
  MCOR_TRY(mcor_count_cells(context, &mesh->used, &mesh->used, &used));
  s->seed_cells_not_intersected -= hits;
  s->cells_used += used;
  for (int l = 0; l < context->lattice.levels; ++l, begin = end)
  {
    MCOR_TRY(mcor_read_int(context, &bricks->bit_counts, bricks->first_slot[l + 1], &end));
    s->cells_of_level[l] += end - begin;
  }
  return MCOR_OK;
}

/* ---- Vertices and triangles ---- */

/* Finds the edges with vertices, and counts vertices and triangles. */
static mcor_status mcor_count_edges(mcor_context* context)
{
  const mcor_bricks* bricks = &context->bricks;
  mcor_mesh* mesh = &context->mesh;
  mcor_buffer* tunnels = &context->topology.counts;
  const int count = bricks->now.count;
  const size_t n = (size_t)count, of_tunnels = mcor_is_resolved(context) ? n + 1 : 1;
  int tunnel_count = 0;
  MCOR_TRY(mcor_reserve(context, &mesh->edges, n * MCOR_EDGE_MASKS * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &mesh->vertex_base, (n + 1) * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, tunnels, of_tunnels * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_march_count", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_CUT_ARGS(context), MCOR_INT(context->space.flat), MCOR_INT(context->adaptive.count),
    MCOR_BUFFER(&context->adaptive.quadrants), MCOR_BUFFER(&mesh->plain_used),
    MCOR_BUFFER(&bricks->now.above), MCOR_BUFFER(&mesh->edges), MCOR_BUFFER(&mesh->vertex_base),
    MCOR_BUFFER(&mesh->triangle_base), MCOR_BUFFER(tunnels)));
  if (mcor_is_resolved(context))
  {
    MCOR_TRY(mcor_scan(context, tunnels, count, &tunnel_count));
  }
  context->run.statistics->tunnels += tunnel_count;
  MCOR_TRY(mcor_scan(context, &mesh->vertex_base, count, &mesh->march_count));
  MCOR_TRY(mcor_scan(context, &mesh->triangle_base, count, &mesh->triangle_count));
  mesh->vertex_count = mesh->march_count;
  for (int l = 0; l < context->lattice.levels; ++l)
  {
    MCOR_TRY(mcor_read_int(
      context, &mesh->vertex_base, bricks->first_slot[l + 1], &mesh->level_first[0][l + 1]));
    mesh->level_first[1][l] = mesh->march_count; /* no vertices are cut yet */
  }
  return MCOR_OK;
}

/* Writes the vertices, the triangles or lines, and, if mcor_follows_cells, the cell of each
 * triangle or line. Counts the triangles of each level; with a box, only triangles of cells in the
 * box. */
static mcor_status mcor_emit(mcor_context* context)
{
  const mcor_bricks* bricks = &context->bricks;
  const mcor_brick_data* now = &bricks->now;
  mcor_box* box = &context->box;
  mcor_mesh* mesh = &context->mesh;
  mcor_statistics* s = context->run.statistics;
  const size_t vertices = (size_t)mesh->march_count, triangles = (size_t)mesh->triangle_count;
  const bool follows = mcor_follows_cells(context);
  cl_int begin = 0, end;
  MCOR_TRY(mcor_reserve(context, &mesh->node, vertices * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &mesh->ends, vertices * 2 * context->cl.real_size));
  MCOR_TRY(mcor_reserve(context, &mesh->triangles, triangles * 3 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &box->cells, (follows ? triangles : 1) * sizeof(cl_ulong)));
  MCOR_TRY(
    MCOR_LAUNCH(context, "mcor_march_vertices", MCOR_MEDIUM, now->count, MCOR_BRICK_ARGS(context),
      MCOR_INT(now->count), MCOR_BUFFER(&bricks->neighbours), MCOR_BUFFER(&now->bricks),
      MCOR_BUFFER(&mesh->edges), MCOR_BUFFER(&now->value), MCOR_BUFFER(&mesh->vertex_base),
      MCOR_REAL(context->run.iso.relative), MCOR_BUFFER(&mesh->node), MCOR_BUFFER(&mesh->ends)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_march_triangles", MCOR_MEDIUM, now->count,
    MCOR_INT(now->count), MCOR_LEAF_ARGS(context), MCOR_BUFFER(&bricks->plain),
    MCOR_BUFFER(&bricks->leaf_of), MCOR_CUT_ARGS(context), MCOR_SIDES_ARGS(box->halves),
    MCOR_SIDES_ARGS(context->run.options->ranks ? box->whole_halves : box->halves),
    MCOR_INT(follows), MCOR_BUFFER(&bricks->rungs), MCOR_BUFFER(&now->bricks),
    MCOR_BUFFER(&mesh->used), MCOR_BUFFER(&mesh->edges), MCOR_BUFFER(&mesh->vertex_base),
    MCOR_BUFFER(&mesh->triangle_base), MCOR_BUFFER(&box->cells), MCOR_BUFFER(&mesh->triangles)));
  for (int l = 0; l < context->lattice.levels; ++l, begin = end)
  {
    int count;
    MCOR_TRY(mcor_read_int(context, &mesh->triangle_base, bricks->first_slot[l + 1], &end));
    MCOR_TRY(mcor_count_owned_triangles(context, begin, end, &count));
    s->triangles_of_level[l] += count;
    s->triangles_before_trimming += count;
  }
  return MCOR_OK;
}

mcor_status mcor_march(mcor_context* context)
{
  mcor_mesh* mesh = &context->mesh;
  mesh->march_count = mesh->vertex_count = mesh->triangle_count = 0;
  memset(mesh->level_first, 0, sizeof mesh->level_first);
  if (context->bricks.now.count == 0)
  {
    return MCOR_OK;
  }
  if (!mcor_uses_pairs(context)) /* growth from pairs has already found the neighbours */
  {
    MCOR_TRY(mcor_find_neighbours(context));
  }
  MCOR_TRY(mcor_find_used(context));
  if (mcor_is_resolved(context))
  {
    MCOR_TRY(mcor_resolve_topology(context));
  }
  MCOR_TRY(mcor_count_edges(context));
  return mesh->triangle_count == 0 ? MCOR_OK : mcor_emit(context);
}
