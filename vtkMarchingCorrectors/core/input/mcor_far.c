/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Leaves out particles if the lattice around all particles would be too long. A call then fails
 * where the lattice is measured, and runs once more without some particles. With a box or a probe's
 * points, the second run leaves out all particles that do not reach the box or the points.
 * Otherwise it leaves out the particles that are farthest away, if they are few. The choice depends
 * on the particles of all ranks together, so ranks agree. */

#include "mcor_box.h"
#include "mcor_input.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* Far particles are left out only if they are fewer than half of all particles, and also at most
 * one in MCOR_FAR_SHARE or at most MCOR_FAR_FEW. */
#define MCOR_FAR_SHARE 1000
#define MCOR_FAR_FEW 8

/* A particle is kept if its support ends at most this far from the bounds of a probe's points. The
 * unit is a cube's edge times (the particle's smoothing length / the smallest smoothing length). */
#define MCOR_POINTS_SLACK 0.5
/* Each side of the lattice is at most this many cubes beyond the region and all used particles. */
#define MCOR_REGION_MARGIN 16

/* The sums in the findings of mcor_far_slice: the numbers of particles in use, of particles that
 * become absent, and of fluid particles that stay. `first` is the first particle that becomes
 * absent. most[0] is the greatest sum of reach and slack of the particles in use that stay. */
enum
{
  MCOR_USED,
  MCOR_LEFT_OUT,
  MCOR_STAYING
};

typedef struct mcor_far_job
{
  const mcor_context* context;
  const mcor_input* input;
  mcor_far* far;
  bool open[3]; /* axes without a period */
  /* reach: the support radius. slack: how far beyond its support a particle is still needed. Both
   * are for a particle whose smoothing length is 1. */
  double reach, slack;
  double margin; /* the margin for mcor_reach_around */
  double radius; /* all particles within this distance of the region stay */
  mcor_findings slices[MCOR_SLICES], all; /* all: of all ranks, but `first` is of this rank */
} mcor_far_job;

static void mcor_far_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_far_job* job = data;
  const mcor_input* input = job->input;
  const mcor_far* far = job->far;
  mcor_places p;
  mcor_findings found = mcor_no_findings();
  for (; mcor_read_places(job->context, input, first, last, &p) > 0; first += p.count)
  {
    for (int i = 0; i < p.count; ++i)
    {
      const int64_t particle = first + i;
      const uint8_t was = input->solid ? input->solid[particle] : 0;
      const bool is_used = mcor_is_used(job->context, input, particle);
      const double reach = p.length[i] * (job->reach + job->slack),
                   near = far->is_cut ? fmax(reach, job->radius) : 0;
      bool is_far = false;
      for (int a = 0; a < 3 && is_used; ++a)
      {
        const double x = p.x[a][i], low = far->region[2 * a], high = far->region[2 * a + 1];
        is_far = is_far || (job->open[a] && !(fmax(low - x, x - high) - near <= 0));
      }
      far->solid[particle] = is_far ? MCOR_ABSENT : was;
      found.sums[MCOR_USED] += is_used;
      found.sums[MCOR_LEFT_OUT] += is_far;
      found.sums[MCOR_STAYING] += !is_far && !was;
      found.first = is_far && particle < found.first ? particle : found.first;
      if (is_used && !is_far)
      {
        mcor_add_range(&found, 0, 0, reach);
      }
    }
  }
  job->slices[slice] = found;
}

static mcor_status mcor_mark_far(mcor_context* context, mcor_far_job* job)
{
  int slices;
  MCOR_TRY(
    mcor_parallel_run(context, job->input->count, MCOR_HEAVY_GRAIN, mcor_far_slice, job, &slices));
  job->all = mcor_merge_findings(job->slices, slices);
  job->far->first = job->all.first;
  return mcor_reduce_findings(context, &job->all);
}

/* Marks as absent all particles that do not reach the box or the probe's points. Particles near
 * enough to be needed for volumes, pairs, nearest particles or widening factors stay. If no fluid
 * reaches the box or the points, fluid at the place of the first sampled particle stays. */
static mcor_status mcor_mark_out_of_reach(mcor_context* context, mcor_far_job* job)
{
  const mcor_options* options = context->run.options;
  MCOR_TRY(mcor_mark_far(context, job));
  if (job->all.sums[MCOR_STAYING] > 0)
  {
    job->radius = mcor_reach_around(
      options, mcor_needs_density(job->input), context->run.widest, job->all.most[0], job->margin);
    return mcor_mark_far(context, job);
  }
  /* No fluid reaches the region. A run needs at least one fluid particle, so the fluid at the place
   * of the first sample stays. */
  for (int64_t i = 0; i < job->input->count; ++i)
  {
    bool same = !(job->input->solid && job->input->solid[i]);
    for (int a = 0; a < 3; ++a)
    {
      same = same && mcor_array_at(&job->input->positions, i, a) == context->samples[0].of[0].x[a];
    }
    job->far->solid[i] = same ? 0 : job->far->solid[i];
  }
  return MCOR_OK;
}

/* Leaves out particles beyond a region. The region reaches `half` to either side of the median of
 * sampled fluid, along each axis. Fails if no particle or too many would be left out, or no fluid
 * would stay; the error sentence is set already. */
static mcor_status mcor_mark_farthest(mcor_context* context, mcor_far_job* job, double half)
{
  const mcor_sample_list* samples = &context->samples[0];
  mcor_far* far = job->far;
  double x[MCOR_SAMPLES];
  MCOR_TRY(mcor_choose_samples(context, job->input, MCOR_SAMPLES));
  for (int a = 0; a < 3; ++a)
  {
    for (int s = 0; s < samples->count; ++s)
    {
      x[s] = samples->of[s].x[a];
    }
    const double centre = mcor_median_of(x, samples->count);
    far->region[2 * a] = centre - half;
    far->region[2 * a + 1] = centre + half;
  }
  MCOR_TRY(mcor_mark_far(context, job));
  const int64_t own = far->first, share = job->all.sums[MCOR_USED] / MCOR_FAR_SHARE;
  far->count = job->all.sums[MCOR_LEFT_OUT];
  if (far->count == 0 || far->count > (share > MCOR_FAR_FEW ? share : MCOR_FAR_FEW) ||
    2 * far->count >= job->all.sums[MCOR_USED] || job->all.sums[MCOR_STAYING] == 0)
  {
    return MCOR_OUT_OF_CAPACITY;
  }
  /* far->first: the least index of a far particle on any rank. far->place: its position. */
  MCOR_TRY(mcor_reduce_counts(context, MCOR_LEAST, &far->first, 1));
  bool is_mine = own == far->first;
  for (int a = 0; a < 3; ++a)
  {
    const double at = is_mine ? mcor_array_at(&job->input->positions, own, a) : DBL_MAX;
    far->place[a] = at;
    MCOR_TRY(mcor_reduce_doubles(context, MCOR_LEAST, &far->place[a], 1));
    is_mine = is_mine && at == far->place[a];
  }
  return MCOR_OK;
}

mcor_status mcor_leave_out_far(mcor_context* context, const mcor_input* input, mcor_far* far)
{
  const mcor_options* options = context->run.options;
  const mcor_measure* m = &context->measure;
  const double edge =
    fmax(context->lattice.edge[0], fmax(context->lattice.edge[1], context->lattice.edge[2]));
  const bool has_box = mcor_has_box(options) != 0;
  far->is_cut = has_box || context->box.has_points;
  for (int side = 0; side < 6; ++side)
  {
    far->region[side] = has_box ? options->box[side] : context->box.points[side];
  }
  far->solid = malloc((size_t)input->count + 1);
  MCOR_TRY(mcor_allocated(context, far->solid));
  mcor_far_job job = { .context = context, .input = input, .far = far };
  job.reach = mcor_support_factor(options->sph_kernel) * options->h_scale;
  job.slack = (has_box ? mcor_box_slack(options) : MCOR_POINTS_SLACK) * edge / m->h_min;
  job.margin = 2 * edge;
  const double half = (0.5 * MCOR_LATTICE_LIMIT - 2) * edge - job.reach * m->h_median;
  for (int a = 0; a < 3; ++a)
  {
    job.open[a] = context->lattice.period[a] == 0;
  }
  MCOR_TRY(
    far->is_cut ? mcor_mark_out_of_reach(context, &job) : mcor_mark_farthest(context, &job, half));
  context->error[0] = '\0';
  context->kept.grid = context->kept.value = context->kept.nodes = false;
  return MCOR_OK;
}

mcor_status mcor_leave_out_again(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_far* far)
{
  const mcor_measure* m = &options->globals->measured;
  far->solid = malloc((size_t)input->count + 1);
  MCOR_TRY(mcor_allocated(context, far->solid));
  for (int64_t i = 0; i < input->count; ++i)
  {
    bool is_far = false;
    for (int a = 0; a < 3; ++a)
    {
      const double x = mcor_array_at(&input->positions, i, a);
      const bool is_open = !(options->periodic[2 * a] < options->periodic[2 * a + 1]);
      is_far = is_far || (is_open && (x < m->low[a] || x > m->high[a]));
    }
    far->solid[i] = is_far ? MCOR_ABSENT : input->solid ? input->solid[i] : 0;
  }
  return MCOR_OK;
}

void mcor_cut_bounds(mcor_context* context, const double low[3], const double high[3])
{
  mcor_measure* m = &context->measure;
  const mcor_options* options = context->run.options;
  const mcor_far* far = context->run.far;
  const double cube =
    options->cube_size > 0 ? options->cube_size : options->cube_size_factor * m->h_min;
  m->far_count = far->count;
  m->far_first = far->first;
  m->cut = far->is_cut;
  for (int a = 0; a < 3; ++a)
  {
    m->far_place[a] = far->place[a];
    if (m->cut)
    {
      const double margin = MCOR_REGION_MARGIN * cube;
      m->low[a] = fmax(m->low[a], fmin(low[a], far->region[2 * a]) - margin);
      m->cut_high[a] = fmin(m->high[a], far->region[2 * a + 1] + margin);
      m->high[a] = fmin(m->high[a], fmax(high[a], far->region[2 * a + 1]) + margin);
    }
  }
}
