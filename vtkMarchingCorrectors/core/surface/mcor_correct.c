/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Correction [III-D.2]. */

#include "mcor_adaptive.h"
#include "mcor_box.h"

#include <stdlib.h>

mcor_status mcor_launch_correction(mcor_context* context, int vertices, bool lines)
{
  mcor_mesh* mesh = &context->mesh;
  const mcor_options* options = context->run.options;
  const double range = context->measure.scalar_max - context->measure.scalar_min;
  return MCOR_LAUNCH_AT_VERTICES(context, vertices, "mcor_correct_vertices",
    MCOR_BUFFER(&mesh->ends), MCOR_INT(lines), MCOR_REAL(context->run.iso.relative),
    MCOR_REAL(options->tolerance * range),
    MCOR_INT(options->preview ? 0 : options->iteration_limit), MCOR_BUFFER(&mesh->offset),
    MCOR_BUFFER(&mesh->linear), MCOR_BUFFER(&mesh->field_value), MCOR_BUFFER(&mesh->gradient),
    MCOR_BUFFER(&mesh->vertex_weight), MCOR_BUFFER(&mesh->evaluations),
    MCOR_ATTRIBUTE_ARGS(context, &mesh->means));
}

/* Moves the vertices onto the surface. In a preview they stay at their linear interpolation, and
 * are evaluated there. */
mcor_status mcor_correct(mcor_context* context)
{
  const mcor_options* options = context->run.options;
  mcor_buffer* buffer = &context->mesh.evaluations;
  const size_t n = (size_t)context->mesh.march_count;
  MCOR_TRY(mcor_extend_vertices(context, 0, (int)n));
  MCOR_TRY(mcor_reserve(context, buffer, n));
  MCOR_TRY(mcor_launch_correction(context, MCOR_ON_EDGES, false));
  if (options->preview)
  {
    return MCOR_OK;
  }
  mcor_statistics* s = context->run.statistics;
  uint8_t* owners = NULL; /* see mcor_find_counted */
  void* view = NULL;
  mcor_status status = mcor_find_counted(context, &owners);
  MCOR_THEN(status, mcor_map(context, buffer, n, false, &view));
  const uint8_t* evaluations = view;
  int most = 0;
  for (size_t i = 0; i < n && status == MCOR_OK; ++i)
  {
    s->newton_evaluations += evaluations[i];
    if (!owners || owners[i] == MCOR_OWN)
    {
      ++s->vertices_corrected;
      context->run.evaluations_counted += evaluations[i];
      most = evaluations[i] > most ? evaluations[i] : most;
    }
  }
  s->iterations_max = most - 1 > s->iterations_max ? most - 1 : s->iterations_max;
  free(owners);
  return status == MCOR_OK ? mcor_unmap(context, buffer, &view) : status;
}
