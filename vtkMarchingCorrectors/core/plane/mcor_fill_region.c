/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Filling. As soon as an iso value's lines are trimmed, what is to be known of them is kept: vertices by
 * lattice edges, cuts, what marching knows of nodes. When all lines are made, the field is evaluated at all
 * nodes that particles reach; each is in a band, between two iso values that follow each other. The border
 * of each square, run through node by node and vertex by vertex, falls into parts of one band; parts that
 * lines join are the border of a polygon of that band. What trimming leaves of it becomes triangles. So
 * triangles share the points of lines, the nodes, and the points where trimming cuts lattice edges, with all
 * that is beside them. A square is filled where its nodes are valid, as those of a line are. */

#include "mcor_fill.h"
#include "mcor_plane.h"

#include <stdlib.h>
#include <string.h>

/* Lists lines by their iso values; of equal ones the first. */
static void mcor_sort_lines(mcor_filling* fill)
{
  for (int i = 0; i < fill->line_count; ++i)
  {
    int at = fill->level_count;
    while (at > 0 && fill->lines[fill->levels[at - 1]].iso > fill->lines[i].iso)
    {
      --at;
    }
    if (at > 0 && fill->lines[fill->levels[at - 1]].iso == fill->lines[i].iso)
    {
      continue;
    }
    memmove(fill->levels + at + 1, fill->levels + at,
      (size_t)(fill->level_count - at) * sizeof *fill->levels);
    fill->levels[at] = i;
    ++fill->level_count;
  }
}

mcor_status mcor_fill_lines(mcor_context* context, const mcor_input* input, mcor_surface* surface)
{
  const mcor_options* options = context->run.options;
  mcor_filling* fill = context->run.fill;
  if (!fill)
  {
    return MCOR_OK;
  }
  mcor_sort_lines(fill);
  const double least = fill->lines[fill->levels[0]].value;
  MCOR_RETURN_IF(options->field == MCOR_SUM && options->node_threshold == 0 && least <= 0, context,
    MCOR_INVALID_ARGUMENT,
    "The region above %g has no end: without a node threshold the sum is 0 in all empty space. "
    "Use a node threshold, or iso values above 0, to fill it.",
    least);
  MCOR_TRY(mcor_find_bands(context, fill));
  MCOR_TRY(mcor_fill_squares(context, fill));
  return mcor_append_fill(context, fill, input, surface);
}
