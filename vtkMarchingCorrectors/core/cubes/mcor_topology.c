/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Topology by the field: samples of the field decide the ambiguous cases of Marching Cubes. */

#include "mcor_adaptive.h"

/* sample_base holds how many samples each brick has. Makes room for the samples, and places them by
 * the kernel `locate`. Then evaluates them level by level: bricks' slots, and therefore samples,
 * are sorted by level. *sample_count becomes the number of all samples. */
static mcor_status mcor_evaluate_samples(
  mcor_context* context, const char* locate, int* sample_count)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_topology_data* topology = &context->topology;
  const int count = bricks->now.count;
  int first = 0, end, groups;
  MCOR_TRY(mcor_scan(context, &topology->sample_base, count, sample_count));
  MCOR_TRY(mcor_reserve_points(context, &topology->samples, (size_t)*sample_count));
  MCOR_TRY(MCOR_LAUNCH(context, locate, MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(&bricks->now.bricks), MCOR_BUFFER(&bricks->neighbours),
    MCOR_BUFFER(&topology->decisions), MCOR_BUFFER(&bricks->now.value),
    MCOR_BUFFER(&topology->sample_base), MCOR_REAL(context->run.iso.relative),
    MCOR_BUFFER(&topology->samples.node), MCOR_BUFFER(&topology->samples.offset)));
  for (int l = 0; l < context->lattice.levels; ++l, first = end)
  {
    const size_t slot = (size_t)bricks->first_slot[l + 1];
    MCOR_TRY(mcor_read(context, &topology->sample_base, slot * sizeof end, &end, sizeof end));
    context->grid.view = l;
    MCOR_TRY(mcor_evaluate_points(context, &topology->samples, first, end - first, &groups));
  }
  context->grid.view = 0;
  return MCOR_OK;
}

/* Decides which ambiguous faces between plain cells (no finer brick touches them) are joined, then
 * in which plain cells two loops make a tunnel. */
mcor_status mcor_resolve_topology(mcor_context* context)
{
  mcor_topology_data* topology = &context->topology;
  mcor_buffer *base = &topology->sample_base, *counts = &topology->counts;
  mcor_statistics* s = context->run.statistics;
  const mcor_bricks* bricks = &context->bricks;
  const int count = bricks->now.count;
  const size_t n = (size_t)count;
  int faces, joined, samples;
  MCOR_TRY(mcor_reserve(context, &topology->decisions, n * MCOR_DECISION_MASKS * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, base, (n + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_topology_faces", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(&bricks->neighbours), MCOR_INT(context->adaptive.count),
    MCOR_INT(context->space.flat), MCOR_BUFFER(&bricks->plain),
    MCOR_BUFFER(&context->mesh.plain_used), MCOR_BUFFER(&bricks->now.above),
    MCOR_BUFFER(&topology->decisions), MCOR_BUFFER(base)));
  MCOR_TRY(mcor_evaluate_samples(context, "mcor_topology_saddles", &faces));
  MCOR_TRY(mcor_reserve(context, counts, (n + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_topology_join", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(base), MCOR_BUFFER(&topology->samples.value), MCOR_BUFFER(&topology->decisions),
    MCOR_BUFFER(counts)));
  MCOR_TRY(mcor_scan(context, counts, count, &joined));
  s->ambiguous_faces += faces;
  s->joined_faces += joined;
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_topology_cells", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(&bricks->neighbours), MCOR_BUFFER(&context->mesh.plain_used),
    MCOR_BUFFER(&bricks->now.above), MCOR_BUFFER(&context->cases), MCOR_BUFFER(&context->case_rows),
    MCOR_BUFFER(&topology->decisions), MCOR_BUFFER(base)));
  MCOR_TRY(mcor_evaluate_samples(context, "mcor_topology_middles", &samples));
  s->ambiguous_cells += samples / 2;
  return MCOR_LAUNCH(context, "mcor_topology_agree", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(base), MCOR_BUFFER(&topology->samples.value), MCOR_BUFFER(&topology->decisions));
}
