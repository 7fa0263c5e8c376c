/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The mesh of one iso value: its vertices on lattice edges, of cubes of one size or several. */

#include "mcor_adaptive.h"

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

void mcor_release_mesh(mcor_context* context)
{
  mcor_mesh* m = &context->mesh;
  MCOR_RELEASE(context, &m->used, &m->edges, &m->vertex_base, &m->triangle_base, &m->node, &m->ends,
    &m->offset, &m->linear, &m->field_value, &m->gradient, &m->vertex_weight, &m->flag,
    &m->evaluations, &m->means, &m->triangles, &m->scanned);
}
