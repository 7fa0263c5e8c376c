/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The points of a probe: the box around them, and their upload. */

#include "mcor_box.h"
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_probe.h"

#include <math.h>
#include <string.h>

bool mcor_bound_by_box(mcor_context* context, const mcor_options* options)
{
  if (!mcor_has_box(options))
  {
    return false;
  }
  memcpy(context->box.points, options->box, sizeof options->box);
  return context->box.of_points = true;
}

/* Points of a batch during upload, and the results of each slice of them. */
typedef struct mcor_point_job
{
  const mcor_probe_run* run;
  void *node, *offset;               /* views */
  mcor_findings slices[MCOR_SLICES]; /* nodes of points that particles may reach, and how many */
} mcor_point_job;

/* Reads positions of points [first, first + count) of the batch, from the lattice's origin, in
 * edges. */
static void mcor_read_points(
  const mcor_probe_run* run, int64_t first, int count, double at[3][MCOR_CHUNK])
{
  const mcor_lattice* lattice = &run->context->lattice;
  const mcor_box* box = &run->context->box;
  mcor_array points = *run->points;
  points.components = 3;
  for (int a = 0; a < 3; ++a)
  {
    const double origin = (double)lattice->origin[a], step = (double)lattice->step[a];
    mcor_read_array(&points, run->first + first, count, a, at[a]);
    for (int i = 0; i < count; ++i)
    {
      at[a][i] = at[a][i] / lattice->edge[a] - origin;
    }
    /* MCOR_QUADRATIC's gradient is 0 exactly at a particle, but not nearby, so points are rounded
     * as particles are. */
    for (int i = 0; i < count && run->context->run.options->sph_kernel == MCOR_QUADRATIC; ++i)
    {
      at[a][i] = floor(at[a][i] * step + 0.5) / step;
    }
    /* A period includes both of its sides. Along a period, points are rounded, too, so that points
     * a period apart have the same position. A point on a side that is not in the box is moved to
     * the other side. */
    const double begin = lattice->period_first[a] * step, period = lattice->period[a] * step;
    for (int i = 0; i < count && period > 0; ++i)
    {
      const double fixed = floor(at[a][i] * step + 0.5);
      const bool beyond = !(fixed >= begin && fixed <= begin + period);
      const double within = beyond ? fixed - floor((fixed - begin) / period) * period : fixed;
      const bool off_lower = within == begin && box->first[a] > lattice->period_first[a];
      const bool off_upper =
        within == begin + period && box->last[a] < lattice->period_first[a] + lattice->period[a];
      at[a][i] = (within + (off_lower ? period : off_upper ? -period : 0)) / step;
    }
  }
}

/* Writes nodes and offsets of points; the node is -1 if no particle may reach the point. */
static void mcor_put_points(void* data, int slice, int64_t first, int64_t last)
{
  mcor_point_job* job = data;
  const mcor_context* context = job->run->context;
  const mcor_lattice* lattice = &context->lattice;
  mcor_findings found = mcor_no_findings();
  double at[3][MCOR_CHUNK];
  for (int64_t begin = first; begin < last; begin += MCOR_CHUNK)
  {
    const int count = mcor_chunk_of(last - begin);
    mcor_read_points(job->run, begin, count, at);
    for (int i = 0; i < count; ++i)
    {
      bool located = true;
      for (int a = 0; a < 3; ++a)
      {
        const double x = at[a][i];
        located = located && x >= (double)lattice->first[a] && x <= (double)lattice->last[a];
      }
      found.sums[0] += located;
      for (int a = 0; a < 3; ++a)
      {
        const double x = located ? at[a][i] : -1;
        const cl_int node = (cl_int)x;
        ((cl_int*)job->node)[4 * (begin + i) + a] = node;
        mcor_put_real(context, job->offset, 4 * (begin + i) + a, x - node);
        found.least[a] = located ? fmin(found.least[a], node) : found.least[a];
        found.most[a] = fmax(found.most[a], node);
      }
    }
  }
  job->slices[slice] = found;
}

mcor_status mcor_place_particles(mcor_context* context, mcor_point_batch* batch, int first,
  int count, bool has_box, const int cells[3], const int end[3])
{
  const mcor_grid* grid = &context->grid;
  const size_t n = (size_t)count;
  MCOR_TRY(mcor_reserve(context, &batch->in_node, n * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &batch->in_offset, n * 4 * context->cl.real_size));
  MCOR_TRY(mcor_reserve(context, &context->points.flags, (n + 1) * sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_derive_place", MCOR_LIGHT, count, MCOR_INT(first),
    MCOR_INT(count), MCOR_REAL(ldexp(1, context->lattice.fix_bits)), MCOR_EDGE_ARGS(context),
    MCOR_BUFFER(&grid->px), MCOR_BUFFER(&grid->py), MCOR_BUFFER(&grid->pz), MCOR_INT(has_box),
    MCOR_CELL_ARGS(cells, end, 0, 0), MCOR_BUFFER(&batch->in_node), MCOR_BUFFER(&batch->in_offset),
    MCOR_BUFFER(&context->points.flags));
}

mcor_status mcor_upload_points(mcor_probe_run* run, int64_t first, int64_t last)
{
  mcor_context* context = run->context;
  const size_t n = (size_t)(last - first), real = context->cl.real_size;
  mcor_point_job job = { .run = run };
  const mcor_mapping views[] = { { &run->batch.in_node, n * 4 * sizeof(cl_int), &job.node },
    { &run->batch.in_offset, n * 4 * real, &job.offset } };
  MCOR_TRY(mcor_reserve(context, &run->batch.in_node, views[0].bytes));
  MCOR_TRY(mcor_reserve(context, &run->batch.in_offset, views[1].bytes));
  int slices = 0;
  run->first = first;
  run->count = (int)n;
  mcor_status status = mcor_map(context, views[0].buffer, views[0].bytes, true, &job.node);
  MCOR_THEN(status, mcor_map(context, views[1].buffer, views[1].bytes, true, &job.offset));
  MCOR_THEN(status,
    mcor_parallel_run(context, run->count, MCOR_HEAVY_GRAIN, mcor_put_points, &job, &slices));
  const mcor_findings found = mcor_merge_findings(job.slices, slices);
  run->inside = (int)found.sums[0];
  for (int a = 0; a < 3 && run->inside > 0; ++a) /* the box of the points' bricks */
  {
    run->batch.first[a] = (cl_int)found.least[a] >> 2;
    run->batch.bricks[a] = ((cl_int)found.most[a] >> 2) - run->batch.first[a] + 1;
  }
  return mcor_unmap_all(context, views, 2, status);
}
