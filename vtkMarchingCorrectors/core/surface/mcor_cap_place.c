/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Where cuts of lattice edges are, by caps at walls and in two dimensions: where the margin by which trimming leaves
 * the fluid is 0. Linear cuts at first, they are moved by the margins found there, all of them at a time, each within
 * what encloses its root (the Illinois method). */

#include "mcor_cap_job.h"

#include <math.h>
#include <stdlib.h>

#define MCOR_PLACE_STEPS 6
#define MCOR_PLACE_BATCH (1 << 18)

/* The margin at the cut is known: moves it. */
static void mcor_move_cut(mcor_cap_vertex* vertex, double margin)
{
  mcor_cap_line* line = &vertex->line;
  const int moved = (margin > 0) == (line->margin[0] > 0) ? 0 : 1, other = 1 - moved;
  line->left = margin;
  line->side[moved] = line->at;
  line->margin[moved] = margin;
  line->margin[other] *= line->last == moved ? 0.5 : 1;
  line->last = moved;
  const double s = line->side[0] +
    (line->side[1] - line->side[0]) * line->margin[0] / (line->margin[0] - line->margin[1]);
  line->at = fmin(fmax(s, MCOR_CAP_CUT_MARGIN), 1 - MCOR_CAP_CUT_MARGIN);
  double at[3];
  for (int a = 0; a < 3; ++a)
  {
    at[a] = line->from[a] + line->at * (line->to[a] - line->from[a]);
  }
  mcor_put_cap_vertex(vertex, at);
}

/* One step of these vertices. */
static mcor_status mcor_move_cuts(mcor_cap_job* job, const int64_t* vertices, int count,
  cl_int* nodes, void* offsets, double iso, mcor_cap_points* points)
{
  mcor_context* context = job->context;
  for (int i = 0; i < count; ++i)
  {
    const mcor_cap_vertex* vertex = &job->vertices[vertices[i]];
    for (int a = 0; a < 3; ++a)
    {
      nodes[4 * (size_t)i + (size_t)a] = vertex->node[a];
      mcor_put_real(context, offsets, 4 * (int64_t)i + a, vertex->offset[a]);
    }
  }
  mcor_cap_values v = { NULL, NULL, NULL, NULL };
  mcor_status status = mcor_evaluate_cap_points(context, nodes, offsets, count, iso, points, &v);
  for (int i = 0; i < count && status == MCOR_OK; ++i)
  {
    mcor_move_cut(&job->vertices[vertices[i]], mcor_cap_margin(context, &v, i));
  }
  const mcor_status unmapped = mcor_unmap_cap_values(context, points, &v);
  status = status == MCOR_OK ? unmapped : status;
  return status == MCOR_OK ? mcor_report_launch(context) : status;
}

mcor_status mcor_place_cap_cuts(mcor_cap_job* job, double iso, mcor_cap_points* points)
{
  const size_t all = (size_t)job->vertex_count,
               room = all < MCOR_PLACE_BATCH ? all : MCOR_PLACE_BATCH;
  int64_t *vertices = malloc((all + 1) * sizeof *vertices), count = 0;
  cl_int* nodes = calloc(4 * room + 1, sizeof *nodes);
  void* offsets = calloc(4 * room + 1, job->context->cl.real_size);
  mcor_status status = mcor_allocated(job->context, vertices && nodes && offsets);
  for (int64_t i = 0; i < job->vertex_count && status == MCOR_OK; ++i)
  {
    vertices[count] = i;
    count += job->vertices[i].is_placed;
  }
  for (int64_t i = 0; i < count && status == MCOR_OK; i += MCOR_PLACE_BATCH)
  {
    const int batch = (int)(count - i < MCOR_PLACE_BATCH ? count - i : MCOR_PLACE_BATCH);
    for (int step = 0; step < MCOR_PLACE_STEPS && status == MCOR_OK; ++step)
    {
      status = mcor_move_cuts(job, vertices + i, batch, nodes, offsets, iso, points);
    }
  }
  free(vertices);
  free(nodes);
  free(offsets);
  return status;
}
