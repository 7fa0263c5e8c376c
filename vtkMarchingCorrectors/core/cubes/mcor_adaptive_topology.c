/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: topology by the field, on faces between cells that are as on the uniform lattice. */

#include "mcor_adaptive_topology.h"
#include "mcor_plane.h"

/* The slots' neighbours and plain cells, and the faces to decide on. */
static mcor_status mcor_find_plain_faces(mcor_context* context)
{
  const mcor_adaptive* adaptive = &context->adaptive;
  const int slots = context->bricks.now.count;
  const size_t n = (size_t)slots;
  mcor_topology_data* topology = &context->topology;
  mcor_buffer* neighbours = &context->bricks.neighbours;
  context->bricks.neighbours_valid = false; /* for the uniform lattice */
  MCOR_TRY(mcor_fill(context, neighbours, 0xff, n * 14 * sizeof(cl_int)));
  MCOR_TRY(mcor_fill(context, &topology->plain, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_fill(context, &topology->used, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_plain", MCOR_MEDIUM, adaptive->count,
    MCOR_INT(adaptive->count), MCOR_BUFFER(&adaptive->finer), MCOR_BUFFER(&adaptive->tables),
    MCOR_BUFFER(&context->mesh.used), MCOR_BUFFER(neighbours), MCOR_BUFFER(&topology->plain),
    MCOR_BUFFER(&topology->used)));
  return MCOR_LAUNCH(context, "mcor_topology_faces", MCOR_MEDIUM, slots, MCOR_INT(slots),
    MCOR_BUFFER(neighbours), MCOR_INT(false), MCOR_INT(mcor_is_plane(context)),
    MCOR_BUFFER(&topology->plain), MCOR_BUFFER(&topology->used),
    MCOR_BUFFER(&context->bricks.now.above), MCOR_BUFFER(&topology->decisions),
    MCOR_BUFFER(&topology->sample_base));
}

/* Decides, and counts the triangles of each leaf anew. iso: relative to A0. */
mcor_status mcor_resolve_leaves(mcor_context* context, double iso)
{
  const mcor_adaptive* adaptive = &context->adaptive;
  mcor_topology_data* topology = &context->topology;
  mcor_buffer* counts = &topology->counts;
  int tunnels;
  MCOR_TRY(mcor_begin_topology(context));
  MCOR_TRY(mcor_find_plain_faces(context));
  MCOR_TRY(mcor_decide_topology(context, &topology->used, iso));
  if (mcor_is_plane(context)) /* as many lines as before */
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_reserve(context, counts, ((size_t)adaptive->count + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_recount", MCOR_MEDIUM, adaptive->count,
    MCOR_INT(adaptive->count), MCOR_BUFFER(&adaptive->tables), MCOR_DECISION_ARGS(context),
    MCOR_BUFFER(&context->bricks.now.above), MCOR_BUFFER(&topology->used),
    MCOR_BUFFER(&context->case_table), MCOR_BUFFER(&context->mesh.triangle_base),
    MCOR_BUFFER(counts)));
  MCOR_TRY(mcor_scan(context, counts, adaptive->count, &tunnels));
  context->run.statistics->tunnels += tunnels;
  return MCOR_OK;
}
