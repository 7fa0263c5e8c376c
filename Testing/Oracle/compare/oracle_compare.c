/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare_internal.h"

#include <stdlib.h>
#include <string.h>

void oracle_compare(const oracle_reference* reference, const mcor_options* options,
  const mcor_surface* surface, const mesh_report* mesh, int trimmed, oracle_comparison* comparison)
{
  const int64_t points = surface->point_count, edges = reference->lattice.edge_count;
  const int64_t components = reference->lattice.component_count;
  compare_state state = { reference, options, surface, mesh, trimmed, comparison,
    oracle_allocate(points, sizeof(int64_t)), oracle_allocate(edges, sizeof(int64_t)),
    oracle_allocate(edges, sizeof(int64_t)), oracle_allocate(points, 3 * sizeof(double)),
    oracle_allocate(points, sizeof(double)) };
  int64_t* count = oracle_allocate(2 * components, sizeof(int64_t));
  memset(comparison, 0, sizeof(*comparison));
  compare_edges(&state, count, count + components);
  compare_vertices(&state);
  compare_orientation(&state);
  free(state.vertex_edge);
  free(state.edge_vertex);
  free(state.second_vertex);
  free(state.gradient);
  free(state.vertex_cube);
  free(count);
}
