/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Spreads particles over an image, on the host, in double precision. The contribution of a particle
 * to a pixel is rounded to a multiple of one number. The rest is rounded to a multiple of a second
 * number. Both numbers are the same for all particles. So the sums are exact: they have the same
 * bits in any order, for any number of threads and ranks. Threads share the image; each locks a
 * band of rows at a time. */

#include "mcor_project.h"

#include <float.h>
#include <stdlib.h>

/* MCOR_SPREAD_TOGETHER: how many particles are spread between two reports of progress.
 * MCOR_SPREAD_GRAIN: the least number of particles that a thread takes. MCOR_BAND_ROWS: how many
 * rows of pixels a lock protects. */
#define MCOR_SPREAD_TOGETHER (1 << 18)
#define MCOR_SPREAD_GRAIN 2048
#define MCOR_BAND_ROWS 8
/* A reduction over ranks takes this many numbers at a time. */
#define MCOR_REDUCED_TOGETHER (1 << 20)

/* Reads mcor_splat.amount of particles, not yet divided by a pixel's area; see mcor_splat for V, A
 * and B. An integral needs V A, a mean needs V B A and V B. If masses are given, the mass replaces
 * V A in an image of the density. If the weights B are the masses, the mass replaces V B. */
static void mcor_read_amounts(
  const mcor_project_job* job, int64_t first, int count, double amount[2][MCOR_CHUNK])
{
  const mcor_input* input = job->input;
  const mcor_array* weight = &job->view->weight;
  const bool has_mass = mcor_is_given(&input->mass);
  const bool by_mass = has_mass && weight->data && weight->data == input->mass.data;
  double size[MCOR_CHUNK], other[MCOR_CHUNK];
  const double* volume = job->volumes ? job->volumes + first : size;
  mcor_read_size(input, first, count, size);
  if (!mcor_projects_density(input))
  {
    mcor_read_scalar(input, first, count, other);
  }
  else
  {
    mcor_read_array(has_mass ? &input->mass : &input->density, first, count, 0, other);
  }
  const bool is_mass = mcor_projects_density(input) && has_mass;
  for (int i = 0; i < count; ++i)
  {
    amount[0][i] = is_mass ? other[i] : volume[i] * other[i];
  }
  if (job->channels == 2)
  {
    mcor_read_array(weight, first, count, 0, other);
    for (int i = 0; i < count; ++i)
    {
      amount[0][i] *= by_mass ? other[i] / volume[i] : other[i];
      amount[1][i] = by_mass ? other[i] : volume[i] * other[i];
    }
  }
}

/* ---- particles in the image ---- */

/* Finds the periodic images of a particle that count for the image: images [first, last] along each
 * axis. A periodic image counts if its position is in the box. But if the line of sight is along x,
 * y or z, then along the other two axes the particle's support need only reach the box. Moves x
 * into the first period of the box. Returns whether any periodic image counts. */
static bool mcor_find_splats(
  const mcor_project_job* job, double x[3], double h, int first[3], int last[3])
{
  const double support = h * mcor_support_factor(job->context->run.options->sph_kernel);
  bool any = true;
  for (int a = 0; a < 3; ++a)
  {
    const double margin = job->is_aligned && job->axes[2][a] == 0 ? support : 0;
    const double low = job->box[2 * a] - margin, high = job->box[2 * a + 1] + margin;
    first[a] = last[a] = 0;
    if (job->period[a] > 0 && isfinite(low) && isfinite(high))
    {
      x[a] -= floor((x[a] - job->box[2 * a]) / job->period[a]) * job->period[a];
      first[a] = (int)ceil((low - x[a]) / job->period[a]);
      last[a] = (int)ceil((high - x[a]) / job->period[a]) - 1;
      any = any && first[a] <= last[a];
    }
    else
    {
      any = any && x[a] >= low && x[a] <= high;
    }
  }
  return any;
}

/* Finds a particle's position in the image, and the pixels that the particle reaches. Returns
 * whether the particle reaches the image. */
static bool mcor_make_splat(
  const mcor_project_job* job, const double x[3], double h, mcor_splat* splat)
{
  bool reaches = true;
  for (int k = 0; k < 2; ++k)
  {
    const double at = (mcor_dot(job->axes[k], x) - job->out->low[k]) / job->out->pixel[k];
    const double reach = job->column.reach[k] * h / job->out->pixel[k];
    const double from = floor(at - reach), to = floor(at + reach), end = job->out->size[k] - 1;
    splat->at[k] = at;
    splat->pixel[k] = job->out->pixel[k] / h;
    splat->first[k] = (int)fmin(fmax(from, 0), end);
    splat->last[k] = (int)fmin(fmax(to, 0), end);
    reaches = reaches && to >= 0 && from <= end;
  }
  return reaches;
}

/* ---- spreading ---- */

/* Adds a particle to a row of pixels. A pixel's share below `lowest` counts as `lowest`. below,
 * above: the kernel's integral E (mcor_project.h) at the lower and the upper corners of the row's
 * pixels. What a pixel gets is rounded and added to coarse; the rest, rounded, is added to fine. */
static void mcor_add_pixels(int count, double amount, double lowest, const double* restrict below,
  const double* restrict above, const double unit[2], double* restrict coarse,
  double* restrict fine)
{
  const double u = unit[0], v = unit[1];
  for (int i = 0; i < count; ++i)
  {
    const double share = (above[i + 1] - above[i]) - (below[i + 1] - below[i]);
    const double value = amount * (share > lowest ? share : lowest);
    const double rounded = (value + u) - u;
    coarse[i] += rounded;
    fine[i] += ((value - rounded) + v) - v;
  }
}

static void mcor_spread_splat(const mcor_project_job* job, const mcor_splat* s, int slice)
{
  const int* size = job->out->size;
  const size_t corners = (size_t)size[0] + 1;
  mcor_column_side* sides = job->sides + (size_t)slice * corners;
  double* rows[2] = { job->corners + 2 * (size_t)slice * corners, NULL };
  rows[1] = rows[0] + corners;
  const int64_t pixels = (int64_t)size[0] * size[1];
  const int first = s->first[0], count = s->last[0] - first + 1;
  /* Rounding must not make a share negative, unless the kernel itself is partly negative. */
  const double lowest =
    mcor_kernel_of(job->context->run.options->sph_kernel)->is_tensor ? -DBL_MAX : 0;
  for (int i = 0; i <= count; ++i)
  {
    sides[i] = mcor_side_of(&job->column, 0, (first + i - s->at[0]) * s->pixel[0]);
  }
  for (int row = s->first[1]; row <= s->last[1] + 1; ++row)
  {
    double *before = rows[~row & 1], *now = rows[row & 1];
    const mcor_column_side side = mcor_side_of(&job->column, 1, (row - s->at[1]) * s->pixel[1]);
    mcor_sum_corners(&job->column, sides, count + 1, &side, now);
    if (row == s->first[1])
    {
      continue;
    }
    const int done = row - 1; /* the row of pixels between the two rows of corners */
    if (done == s->first[1] || done % MCOR_BAND_ROWS == 0)
    {
      pthread_mutex_lock(&job->locks[done / MCOR_BAND_ROWS]);
    }
    for (int c = 0; c < job->channels; ++c)
    {
      double* coarse = job->sums + 2 * c * pixels + (int64_t)done * size[0] + first;
      mcor_add_pixels(
        count, s->amount[c], lowest, before, now, job->unit[c], coarse, coarse + pixels);
    }
    if (done == s->last[1] || row % MCOR_BAND_ROWS == 0)
    {
      pthread_mutex_unlock(&job->locks[done / MCOR_BAND_ROWS]);
    }
  }
}

/* ---- the passes ---- */

/* Spreads particles and their periodic images over the pixels. The first pass, without locks, only
 * counts what reaches a pixel, bounds what a particle adds to a pixel, and finds the first particle
 * whose amount is not finite. */
static void mcor_splat_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_project_job* job = data;
  const double area = job->out->pixel[0] * job->out->pixel[1];
  double amount[2][MCOR_CHUNK];
  mcor_places p;
  mcor_splat splat = { 0 };
  mcor_findings found = mcor_no_findings();
  mcor_add_range(&found, 0, 0, 0);
  mcor_add_range(&found, 1, 0, 0);
  const int64_t end = job->first + last;
  int64_t begin = job->first + first;
  for (; mcor_read_places(job->context, job->input, begin, end, &p) > 0; begin += p.count)
  {
    mcor_read_amounts(job, begin, p.count, amount);
    for (int i = 0; i < p.count; ++i)
    {
      if (!mcor_is_projected(job, begin + i))
      {
        continue;
      }
      double x[3] = { p.x[0][i], p.x[1][i], p.x[2][i] };
      const double h = p.length[i] * job->h_scale;
      int from[3], until[3];
      const int64_t before = found.sums[0];
      for (int c = 0; c < job->channels; ++c)
      {
        splat.amount[c] = amount[c][i] / area;
        if (!isfinite(splat.amount[c]) && begin + i < found.first)
        {
          found.first = begin + i;
        }
      }
      const bool any = mcor_find_splats(job, x, h, from, until);
      const int along = until[0] - from[0] + 1, across = until[1] - from[1] + 1;
      const int images = any ? along * across * (until[2] - from[2] + 1) : 0;
      for (int image = 0; image < images; ++image)
      {
        const int k[3] = { from[0] + image % along, from[1] + image / along % across,
          from[2] + image / along / across };
        const double place[3] = { x[0] + k[0] * job->period[0], x[1] + k[1] * job->period[1],
          x[2] + k[2] * job->period[2] };
        if (mcor_make_splat(job, place, h, &splat))
        {
          ++found.sums[0];
          if (job->locks)
          {
            mcor_spread_splat(job, &splat, slice);
          }
        }
      }
      /* M'4 is partly negative, so a pixel's share of this kernel may exceed 1, but not 2. */
      const double share = fmin(1.01 * job->column.highest * splat.pixel[0] * splat.pixel[1], 2);
      for (int c = 0; c < job->channels && found.sums[0] > before; ++c)
      {
        mcor_add_range(&found, c, 0, fabs(splat.amount[c]) * share);
      }
    }
  }
  job->slices[slice] = found;
}

/* Returns a unit for mcor_project_job: 3/2 of a power of two that exceeds 4 * number. */
static double mcor_rounding_unit(double number)
{
  int exponent;
  frexp(number, &exponent);
  return isfinite(number) ? ldexp(1.5, exponent + 2) : number;
}

/* Counts particles and their periodic images, and sets job->unit so that all sums are exact. */
static mcor_status mcor_count_splats(mcor_project_job* job)
{
  mcor_context* context = job->context;
  int slices;
  MCOR_TRY(mcor_parallel_run(
    context, job->input->count, MCOR_SPREAD_GRAIN, mcor_splat_slice, job, &slices));
  mcor_findings found = mcor_merge_findings(job->slices, slices);
  MCOR_FAIL_IF(found.first < INT64_MAX, context, MCOR_INVALID_DATA, MCOR_SAY(PROJECTION_NOT_FINITE),
    (long long)found.first);
  MCOR_TRY(mcor_reduce_findings(context, &found));
  const double count = (double)found.sums[0];
  for (int c = 0; c < job->channels; ++c)
  {
    job->unit[c][0] = mcor_rounding_unit(found.most[c] * count);
    job->unit[c][1] = mcor_rounding_unit(ldexp(job->unit[c][0], -53) * count);
    MCOR_FAIL_IF(
      !isfinite(job->unit[c][0]), context, MCOR_INVALID_DATA, MCOR_SAY(PROJECTION_TOO_LARGE));
  }
  return MCOR_OK;
}

mcor_status mcor_spread_particles(mcor_project_job* job)
{
  mcor_projection* out = job->out;
  const size_t pixels = (size_t)out->size[0] * (size_t)out->size[1],
               corners = MCOR_SLICES * ((size_t)out->size[0] + 1);
  const int bands = out->size[1] / MCOR_BAND_ROWS + 1;
  const int64_t particles = job->input->count;
  const double least_pixel =
    fmin(out->pixel[0], out->pixel[1]) / (out->statistics.smoothing_length_max * job->h_scale);
  out->values = malloc(pixels * sizeof(double));
  job->sums = calloc(pixels, 2 * (size_t)job->channels * sizeof(double));
  MCOR_TRY(mcor_allocated(job->context, out->values && job->sums));
  MCOR_TRY(mcor_make_column(job, least_pixel, &job->column));
  MCOR_TRY(mcor_count_splats(job));
  /* Makes the work space of the second pass. */
  job->sides = malloc(corners * sizeof *job->sides);
  job->corners = malloc(2 * corners * sizeof *job->corners);
  job->locks = malloc((size_t)bands * sizeof *job->locks);
  for (job->bands = 0; job->bands < bands && job->locks; ++job->bands)
  {
    pthread_mutex_init(&job->locks[job->bands], NULL);
  }
  MCOR_TRY(mcor_allocated(job->context, job->sides && job->corners && job->locks));
  for (int64_t end; job->first < particles; job->first = end)
  {
    const double share = 0.7 / (double)particles;
    end =
      particles - job->first < MCOR_SPREAD_TOGETHER ? particles : job->first + MCOR_SPREAD_TOGETHER;
    MCOR_TRY(mcor_report(
      job->context, "projection", 0.3 + share * (double)job->first, 0.3 + share * (double)end));
    MCOR_TRY(mcor_parallel_run(
      job->context, end - job->first, MCOR_SPREAD_GRAIN, mcor_splat_slice, job, NULL));
  }
  /* Adds the sums of all ranks, and computes the values from them. */
  const int64_t count = 2 * job->channels * (int64_t)pixels;
  const double* sums = job->sums;
  for (int64_t first = 0; first < count; first += MCOR_REDUCED_TOGETHER)
  {
    const int64_t rest = count - first;
    MCOR_TRY(mcor_reduce_doubles(job->context, MCOR_SUM_OF, job->sums + first,
      rest < MCOR_REDUCED_TOGETHER ? (int)rest : MCOR_REDUCED_TOGETHER));
  }
  for (size_t i = 0; i < pixels; ++i)
  {
    out->values[i] = sums[i] + sums[pixels + i];
    if (job->channels == 2)
    {
      const double weight = sums[2 * pixels + i] + sums[3 * pixels + i];
      out->values[i] = weight != 0 ? out->values[i] / weight : NAN;
    }
  }
  return MCOR_OK;
}
