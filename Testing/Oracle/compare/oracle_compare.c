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
  const size_t components = (size_t)reference->lattice.component_count + 1;
  const size_t edges = (size_t)reference->lattice.edge_count + 1;
  compare_state state = { reference, options, surface, mesh, trimmed, comparison,
    malloc(points * sizeof(int64_t)), malloc(edges * sizeof(int64_t)),
    malloc(edges * sizeof(int64_t)), malloc(3 * points * sizeof(double)),
    malloc(points * sizeof(double)) };
  int64_t* count = calloc(2 * components, sizeof(int64_t));
  int enough = state.vertex_edge && state.edge_vertex && state.second_vertex && state.gradient &&
    state.vertex_cube && count;
  if (enough)
  {
    compare_edges(&state, count, count + components);
    compare_vertices(&state);
    enough = compare_orientation(&state);
  }
  free(state.vertex_edge);
  free(state.edge_vertex);
  free(state.second_vertex);
  free(state.gradient);
  free(state.vertex_cube);
  free(count);
  return enough;
}
