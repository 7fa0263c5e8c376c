/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Extraction [III-D.1]. */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_pair_rounds.h"
#include "mcor_plane.h"

/* The used cells, among those examined, of the box and its ring. */
static mcor_status mcor_classify_cells(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_mesh* mesh = &context->mesh;
  const int count = bricks->now.count;
  MCOR_TRY(mcor_reserve(context, &mesh->used, (size_t)count * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_march_classify", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(&bricks->neighbours), MCOR_BUFFER(&bricks->now.cells),
    MCOR_BUFFER(&bricks->now.above), MCOR_BUFFER(&bricks->now.valid), MCOR_BUFFER(&mesh->used)));
  return mcor_clip_used(context);
}

/* From the cells of pairs: one round of growth; *grown is false when no cell was added. */
static mcor_status mcor_grow_cells(mcor_context* context, bool* grown)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_buffer* flags = &bricks->found;
  cl_int flag;
  MCOR_TRY(mcor_fill(context, flags, 0, sizeof flag));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_grow", MCOR_MEDIUM, bricks->now.count,
    MCOR_BLOCK_ARGS(context), MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&bricks->neighbours), MCOR_BUFFER(&bricks->now.examined),
    MCOR_BUFFER(&bricks->fresh), MCOR_BUFFER(&bricks->now.above), MCOR_BUFFER(&bricks->now.valid),
    MCOR_BUFFER(&bricks->bits), MCOR_BUFFER(&bricks->now.cells), MCOR_BUFFER(flags)));
  MCOR_TRY(mcor_read(context, flags, 0, &flag, sizeof flag));
  *grown = flag != 0;
  return flag & 2 ? mcor_append_bricks(context) : MCOR_OK;
}

/* Of the seed cells, which have been counted as not intersected, those that are used. */
static mcor_status mcor_count_hits(mcor_context* context, const mcor_buffer* seeds)
{
  int hits;
  MCOR_TRY(mcor_count_cells(context, &context->mesh.used, seeds, &hits));
  context->run.statistics->seed_cells_not_intersected -= hits;
  return MCOR_OK;
}

/* Evaluates and grows until nothing is new. Ends with the used cells. */
static mcor_status mcor_find_cells(mcor_context* context, double iso)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_mesh* mesh = &context->mesh;
  const bool pairs = mcor_uses_pairs(context);
  int used;
  mcor_end_rounds(context);
  for (bool first = true, grown = true; grown; first = false)
  {
    MCOR_TRY(mcor_find_neighbours(context));
    MCOR_TRY(mcor_evaluate_nodes(context));
    MCOR_TRY(mcor_sign_nodes(context, iso, &bricks->need));
    MCOR_TRY(pairs ? mcor_void_nodes(context) : MCOR_OK);
    if (first && pairs) /* before other cells join them */
    {
      MCOR_TRY(mcor_classify_cells(context));
      MCOR_TRY(mcor_count_hits(context, &bricks->now.cells));
    }
    ++context->run.statistics->march_rounds;
    MCOR_TRY(pairs ? mcor_grow_cells(context, &grown) : mcor_grow_bricks(context, &grown));
    MCOR_TRY(pairs && !grown ? mcor_exchange_cells(context, NULL, &grown) : MCOR_OK);
  }
  if (bricks->slot_of.mem) /* some were appended */
  {
    MCOR_TRY(mcor_place_bricks(context));
    MCOR_TRY(mcor_find_neighbours(context));
  }
  MCOR_TRY(mcor_classify_cells(context));
  MCOR_TRY(pairs ? MCOR_OK : mcor_count_hits(context, &bricks->seeds));
  MCOR_TRY(mcor_count_cells(context, &mesh->used, &mesh->used, &used));
  context->run.statistics->cells_used += used;
  return MCOR_OK;
}

/* Edges with vertices; numbers of vertices and of triangles. */
static mcor_status mcor_count_edges(mcor_context* context)
{
  mcor_mesh* mesh = &context->mesh;
  mcor_buffer* tunnels = &context->topology.counts;
  const int count = context->bricks.now.count;
  const size_t n = (size_t)count, of_tunnels = mcor_is_resolved(context) ? n + 1 : 1;
  int tunnel_count = 0;
  MCOR_TRY(mcor_reserve(context, &mesh->edges, n * MCOR_EDGE_MASKS * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &mesh->vertex_base, (n + 1) * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &mesh->triangle_base, (n + 1) * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, tunnels, of_tunnels * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, mcor_is_plane(context) ? "mcor_plane_count" : "mcor_march_count",
    MCOR_MEDIUM, count, MCOR_INT(count), MCOR_DECISION_ARGS(context), MCOR_BUFFER(&mesh->used),
    MCOR_BUFFER(&context->bricks.now.above), MCOR_BUFFER(&context->case_table),
    MCOR_BUFFER(&mesh->edges), MCOR_BUFFER(&mesh->vertex_base), MCOR_BUFFER(&mesh->triangle_base),
    MCOR_BUFFER(tunnels)));
  const bool has_tunnels = mcor_is_resolved(context) && !mcor_is_plane(context);
  MCOR_TRY(has_tunnels ? mcor_scan(context, tunnels, count, &tunnel_count) : MCOR_OK);
  context->run.statistics->tunnels += tunnel_count;
  MCOR_TRY(mcor_scan(context, &mesh->vertex_base, count, &mesh->march_count));
  MCOR_TRY(mcor_scan(context, &mesh->triangle_base, count, &mesh->triangle_count));
  mesh->vertex_count = mesh->march_count;
  return MCOR_OK;
}

/* Of uniform cubes, and of leaves. */
mcor_status mcor_emit_vertices(mcor_context* context, double iso)
{
  const mcor_brick_data* now = &context->bricks.now;
  mcor_mesh* mesh = &context->mesh;
  const size_t vertices = (size_t)mesh->march_count, triangles = (size_t)mesh->triangle_count;
  MCOR_TRY(mcor_reserve(context, &mesh->node, vertices * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &mesh->ends, vertices * 2 * context->cl.real_size));
  MCOR_TRY(mcor_reserve(context, &mesh->triangles, triangles * 3 * sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_march_vertices", MCOR_MEDIUM, now->count,
    MCOR_SLOT_ARGS(context), MCOR_INT(mcor_is_adaptive(context)),
    MCOR_BUFFER(&context->bricks.neighbours), MCOR_BUFFER(&context->adaptive.rungs),
    MCOR_BUFFER(&now->bricks), MCOR_BUFFER(&mesh->edges), MCOR_BUFFER(&now->value),
    MCOR_BUFFER(&mesh->vertex_base), MCOR_REAL(iso), MCOR_BUFFER(&mesh->node),
    MCOR_BUFFER(&mesh->ends));
}

/* Triangles, and their cells, of which those between the sides are owned. */
static mcor_status mcor_emit_triangles(
  mcor_context* context, const int sides[6], mcor_buffer* cells)
{
  const mcor_brick_data* now = &context->bricks.now;
  const mcor_mesh* mesh = &context->mesh;
  const bool follows = mcor_follows_cells(context);
  const size_t keys = follows ? (size_t)mesh->triangle_count : 1;
  const char* emit = mcor_is_plane(context) ? "mcor_plane_lines" : "mcor_march_triangles";
  MCOR_TRY(mcor_reserve(context, cells, keys * sizeof(cl_ulong)));
  return MCOR_LAUNCH(context, emit, MCOR_MEDIUM, now->count, MCOR_INT(now->count),
    MCOR_DECISION_ARGS(context), MCOR_SIDES_ARGS(sides), MCOR_INT(follows),
    MCOR_INT(context->lattice.blocks[0]), MCOR_INT(context->lattice.blocks[1]),
    MCOR_BUFFER(&now->bricks), MCOR_BUFFER(&mesh->used), MCOR_BUFFER(&now->above),
    MCOR_BUFFER(&mesh->edges), MCOR_BUFFER(&context->case_table), MCOR_BUFFER(&mesh->vertex_base),
    MCOR_BUFFER(&mesh->triangle_base), MCOR_BUFFER(cells), MCOR_BUFFER(&mesh->triangles));
}

/* Vertices and triangles. iso: relative to A0. */
mcor_status mcor_march(mcor_context* context, double iso)
{
  mcor_mesh* mesh = &context->mesh;
  int owned;
  MCOR_TRY(mcor_find_cells(context, iso));
  MCOR_TRY(mcor_is_resolved(context) ? mcor_resolve_topology(context, iso) : MCOR_OK);
  MCOR_TRY(mcor_count_edges(context));
  MCOR_TRY(mcor_emit_vertices(context, iso));
  MCOR_TRY(mcor_emit_in_box(context, mcor_emit_triangles));
  MCOR_TRY(mcor_count_owned_triangles(context, 0, mesh->triangle_count, &owned));
  context->run.statistics->triangles_before_trimming += owned;
  return MCOR_OK;
}

void mcor_release_mesh(mcor_context* context)
{
  mcor_mesh* m = &context->mesh;
  MCOR_RELEASE(context, &m->used, &m->edges, &m->vertex_base, &m->triangle_base, &m->node, &m->ends,
    &m->offset, &m->linear, &m->field_value, &m->gradient, &m->vertex_weight, &m->flag,
    &m->evaluations, &m->means, &m->cut_edges, &m->triangles, &m->scanned);
}
