/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Curvatures at the surface's vertices, from the derivatives of the sum itself. */

#include "mcor_adaptive.h"

mcor_status mcor_find_curvature(mcor_context* context)
{
  mcor_mesh* mesh = &context->mesh;
  MCOR_TRY(mcor_reserve(
    context, &mesh->curvature, 2 * (size_t)mesh->vertex_count * context->cl.real_size));
  return MCOR_LAUNCH_AT_VERTICES(context, MCOR_ALL_VERTICES, "mcor_curvature_points",
    MCOR_BUFFER(&mesh->offset), MCOR_REAL(context->run.iso.relative), MCOR_INT(context->space.flat),
    MCOR_BUFFER(&mesh->curvature));
}
