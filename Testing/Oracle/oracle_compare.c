/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare_internal.h"

#include <stdlib.h>
#include <string.h>

int oracle_compare(const oracle_reference* reference, const mcor_options* options,
  const mcor_surface* surface, const mesh_report* mesh, int trimmed, oracle_comparison* comparison)
{
  memset(comparison, 0, sizeof(*comparison));
  const size_t points = (size_t)surface->point_count + 1;
  const size_t components = (size_t)reference->surface.component_count + 1;
  compare_state state = { reference, options, surface, mesh, trimmed, comparison,
    malloc(points * sizeof(int64_t)),
    malloc(((size_t)reference->surface.edge_count + 1) * sizeof(int64_t)),
    malloc(((size_t)reference->surface.edge_count + 1) * sizeof(int64_t)),
    malloc(3 * points * sizeof(double)) };
  int64_t* count = calloc(2 * components, sizeof(int64_t));
  int enough =
    state.vertex_edge && state.edge_vertex && state.second_vertex && state.gradient && count;
  if (enough)
  {
    comparison->edges = reference->surface.edge_count;
    comparison->components = reference->surface.component_count;
    compare_assign(&state);
    compare_missing(&state, count, count + components);
    compare_extra(&state);
    compare_vertices(&state);
    compare_count_pinched(&state);
    compare_count_unsettled(&state);
    compare_boundary(&state);
    compare_faces(&state);
    compare_inverted(&state);
    enough = compare_orientation(&state);
  }
  free(state.vertex_edge);
  free(state.edge_vertex);
  free(state.second_vertex);
  free(state.gradient);
  free(count);
  return enough;
}
