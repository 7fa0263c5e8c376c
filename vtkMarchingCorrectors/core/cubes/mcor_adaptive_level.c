/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: launches of kernels that evaluate the field, level by level. In such a launch,
 * lengths are in cells of its level. */

#include "mcor_adaptive.h"

#include <string.h>

/* Launches a heavy kernel with the search grid, the arguments `own`, and the arguments `more`. */
static mcor_status mcor_launch_joined(mcor_context* context, const char* name, size_t items,
  const mcor_arg own[3], const mcor_arg* more, size_t count)
{
  const mcor_arg grid[] = { MCOR_GRID_ARGS(context) };
  const size_t n = sizeof grid / sizeof grid[0];
  mcor_arg args[sizeof grid / sizeof grid[0] + 3 + MCOR_MORE_ARGS];
  const size_t owned = own[2].buffer ? 3 : 2;
  memcpy(args, grid, sizeof grid);
  memcpy(args + n, own, owned * sizeof *own);
  memcpy(args + n + owned, more, count * sizeof *more);
  return mcor_launch(context, name, MCOR_HEAVY, items, args, n + owned + count);
}

mcor_status mcor_launch_by_level(mcor_context* context, const char* name, int items,
  const int* first, const int* end, const mcor_arg* more, size_t count)
{
  for (int l = 0; l < context->lattice.levels; ++l)
  {
    const int rest = end[l] - first[l];
    const mcor_arg own[3] = { MCOR_INT(first[l]), MCOR_INT(rest) };
    context->grid.view = l;
    MCOR_TRY(mcor_launch_joined(context, name, (size_t)rest * (size_t)items, own, more, count));
  }
  context->grid.view = 0;
  return MCOR_OK;
}

mcor_status mcor_launch_at_vertices(
  mcor_context* context, int vertices, const char* name, const mcor_arg* more, size_t count)
{
  const mcor_mesh* mesh = &context->mesh;
  for (int i = 0; i < 2 * context->lattice.levels; ++i)
  {
    const int level = i / 2, boundary = i % 2;
    const int begin = boundary ? mesh->march_count : 0;
    /* Vertices of caps come last, and count as vertices on the boundary. */
    const int end = boundary ? mesh->vertex_count : mesh->march_count;
    const int* of_levels = mesh->level_first[boundary];
    const int first = level > 0 ? of_levels[level] : begin;
    const int last = level + 1 < context->lattice.levels ? of_levels[level + 1] : end;
    int groups;
    if (!(vertices >> boundary & 1))
    {
      continue;
    }
    context->grid.view = level;
    MCOR_TRY(mcor_make_groups(context, &mesh->node, first, last - first, &groups));
    const mcor_arg own[3] = { MCOR_INT(groups), MCOR_BUFFER(&context->points.groups),
      MCOR_BUFFER(&context->mesh.node) };
    MCOR_TRY(mcor_launch_joined(context, name, (size_t)groups, own, more, count));
  }
  context->grid.view = 0;
  return MCOR_OK;
}
