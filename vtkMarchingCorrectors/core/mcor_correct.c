/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Correction [III-D.2]. */

#include "mcor_internal.h"

#include <stdlib.h>

/* Vertices get room for those that trimming adds, so that nothing is copied then. */
mcor_status mcor_reserve_vertices(mcor_context* context, int count)
{
  mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)count, real = context->cl.real_size;
  MCOR_TRY(mcor_reserve(context, &mesh->offset, n * 4 * real));
  MCOR_TRY(mcor_reserve(context, &mesh->linear, n * real));
  MCOR_TRY(mcor_reserve(context, &mesh->field_value, n * real));
  MCOR_TRY(mcor_reserve(context, &mesh->gradient, n * 4 * real));
  MCOR_TRY(mcor_reserve(context, &mesh->vertex_weight, n * real));
  MCOR_TRY(mcor_reserve(context, &mesh->flag, n));
  return mcor_reserve(context, &mesh->evaluations, n);
}

static mcor_status mcor_count_iterations(mcor_context* context)
{
  mcor_statistics* s = context->statistics;
  const size_t n = (size_t)context->mesh.march_count;
  uint8_t* evaluations = malloc(n + 1);
  MCOR_RETURN_IF(!evaluations, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for %zu vertices could not be allocated.", n);
  const mcor_status status =
    mcor_read(context, &context->mesh.evaluations, 0, evaluations, n);
  for (size_t i = 0; i < n && status == MCOR_OK; ++i)
  {
    s->newton_evaluations += evaluations[i];
    s->iterations_max = evaluations[i] - 1 > s->iterations_max ? evaluations[i] - 1 : s->iterations_max;
  }
  s->vertices_corrected += (int64_t)n;
  free(evaluations);
  return status;
}

/* Moves the vertices onto the surface, or evaluates them where linear interpolation puts them
 * (preview). iso: relative to A0. */
mcor_status mcor_correct(mcor_context* context, double iso)
{
  mcor_mesh* mesh = &context->mesh;
  const mcor_options* options = context->options;
  const int lanes = context->cl.lanes, count = mesh->march_count;
  const double range = context->measure.scalar_max - context->measure.scalar_min;
  MCOR_TRY(mcor_reserve_vertices(context, count));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_correct_vertices", MCOR_HEAVY, (count + lanes - 1) / lanes,
    MCOR_GRID_ARGS(context), MCOR_INT(count), MCOR_BUFFER(&mesh->node), MCOR_BUFFER(&mesh->ends),
    MCOR_REAL(iso), MCOR_REAL(options->tolerance * range),
    MCOR_INT(options->preview ? 0 : options->iteration_limit), MCOR_BUFFER(&mesh->offset),
    MCOR_BUFFER(&mesh->linear), MCOR_BUFFER(&mesh->field_value), MCOR_BUFFER(&mesh->gradient),
    MCOR_BUFFER(&mesh->vertex_weight), MCOR_BUFFER(&mesh->evaluations)));
  return options->preview ? MCOR_OK : mcor_count_iterations(context);
}
