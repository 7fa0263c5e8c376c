/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Spreads particles over an image, on the host, in double precision, band by band of the image.
 * The contribution of a particle to a pixel is rounded to a multiple of a number that is the
 * same for all, and the rest to a multiple of a second one. Sums are therefore exact: they have
 * the same bits in any order, for any number of threads and ranks. */

#include "mcor_plane.h"
#include "mcor_project.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* Particles that one thread reads at a time, and images of particles that are spread together. */
#define MCOR_BLOCK_PARTICLES (4 * MCOR_CHUNK)
#define MCOR_SPLATS_TOGETHER (1 << 18)
/* Numbers that a reduction over ranks takes at a time. */
#define MCOR_REDUCED_TOGETHER (1 << 20)

/* Reads volume times scalar (for the density: the mass) and, for a mean, both times the weight.
 * If the weight is the masses' array, a particle weighs its mass. */
static void mcor_read_amounts(
  const mcor_project_job* job, int64_t first, int count, double amount[2][MCOR_CHUNK])
{
  const mcor_input* input = job->input;
  const mcor_array* weight = &job->view->weight;
  const bool has_mass = mcor_is_given(&input->mass);
  const bool by_mass = has_mass && weight->data && weight->data == input->mass.data;
  double volume[MCOR_CHUNK], other[MCOR_CHUNK];
  mcor_read_size(input, first, count, volume);
  if (job->volumes)
  {
    memcpy(volume, job->volumes + first, (size_t)count * sizeof *volume);
  }
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

void mcor_read_project_chunk(
  const mcor_project_job* job, int64_t first, int count, bool amounts, mcor_project_chunk* chunk)
{
  const mcor_input* input = job->input;
  const uint8_t *solid = input->solid, *counted = job->view->counted;
  double h[MCOR_CHUNK];
  mcor_read_positions(input, first, count, chunk->x);
  mcor_read_smoothing_length(job->context, input, first, count, h);
  mcor_widen_lengths(input, first, count, h, chunk->h);
  if (amounts)
  {
    mcor_read_amounts(job, first, count, chunk->amount);
  }
  for (int i = 0; i < count; ++i)
  {
    chunk->h[i] *= job->h_scale;
    chunk->counts[i] = !(solid && solid[first + i]) && (!counted || counted[first + i]);
  }
}

/* ---- particles in the image ---- */

/* Finds the images of a particle that count, [first, last] along each axis: images in the box and,
 * across the line of sight, images beside the box that reach into it. Moves the particle into the
 * first period of the box. */
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

/* Finds the position of a particle in the image. Returns whether it reaches the image. */
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

/* Lists the images of the particles of blocks [first, last). If there is no list yet, only counts
 * the images, and finds the most that one adds to a pixel. */
static void mcor_splat_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_project_job* job = data;
  const mcor_input* input = job->input;
  const bool counts = !job->splats;
  const double area = job->out->pixel[0] * job->out->pixel[1];
  mcor_project_chunk chunk;
  mcor_splat splat = { 0 };
  mcor_findings found = mcor_no_findings();
  mcor_add_range(&found, 0, 0, 0);
  mcor_add_range(&found, 1, 0, 0);
  for (int64_t block = job->first_block + first; block < job->first_block + last; ++block)
  {
    int64_t count = 0;
    mcor_splat* to = counts
      ? NULL
      : job->splats + (job->splats_before[block] - job->splats_before[job->first_block]);
    const int64_t end = block * MCOR_BLOCK_PARTICLES + MCOR_BLOCK_PARTICLES;
    const int64_t stop = end < input->count ? end : input->count;
    for (int64_t begin = block * MCOR_BLOCK_PARTICLES; begin < stop; begin += MCOR_CHUNK)
    {
      const int read = mcor_chunk_of(stop - begin);
      mcor_read_project_chunk(job, begin, read, true, &chunk);
      for (int i = 0; i < read; ++i)
      {
        if (!chunk.counts[i])
        {
          continue;
        }
        double x[3] = { chunk.x[0][i], chunk.x[1][i], chunk.x[2][i] };
        int from[3], until[3];
        bool reaches = false;
        for (int c = 0; c < job->channels; ++c)
        {
          splat.amount[c] = chunk.amount[c][i] / area;
          if (!isfinite(splat.amount[c]) && begin + i < found.first)
          {
            found.first = begin + i;
          }
        }
        const bool any = mcor_find_splats(job, x, chunk.h[i], from, until);
        const int along = until[0] - from[0] + 1, across = until[1] - from[1] + 1;
        const int images = any ? along * across * (until[2] - from[2] + 1) : 0;
        for (int image = 0; image < images; ++image)
        {
          const int k[3] = { from[0] + image % along, from[1] + image / along % across,
            from[2] + image / along / across };
          const double place[3] = { x[0] + k[0] * job->period[0], x[1] + k[1] * job->period[1],
            x[2] + k[2] * job->period[2] };
          if (mcor_make_splat(job, place, chunk.h[i], &splat))
          {
            reaches = true;
            if (!counts)
            {
              to[count] = splat;
            }
            ++count;
          }
        }
        /* No pixel has more than twice a whole kernel: M'4 is partly negative. */
        const double share = fmin(1.01 * job->column.highest * splat.pixel[0] * splat.pixel[1], 2);
        for (int c = 0; c < job->channels && reaches; ++c)
        {
          mcor_add_range(&found, c, 0, fabs(splat.amount[c]) * share);
        }
      }
    }
    if (counts)
    {
      job->splats_before[block + 1] = count;
    }
  }
  job->slices[slice] = found;
}

/* Returns 3/2 of a power of 2 that is at least four times the number. */
static double mcor_rounding_unit(double number)
{
  int exponent;
  frexp(number, &exponent);
  return isfinite(number) ? ldexp(1.5, exponent + 2) : number;
}

/* Counts images, and chooses units: a sum of this many multiples of a unit is exact. */
static mcor_status mcor_count_splats(mcor_project_job* job, int64_t blocks)
{
  mcor_context* context = job->context;
  int slices;
  job->splats_before[0] = 0;
  MCOR_TRY(mcor_parallel_run(context, blocks, 1, mcor_splat_slice, job, &slices));
  mcor_findings found = mcor_merge_findings(job->slices, slices);
  MCOR_FAIL_IF(found.first < INT64_MAX, context, MCOR_INVALID_DATA, MCOR_SAY(PROJECTION_NOT_FINITE),
    (long long)found.first);
  for (int64_t b = 0; b < blocks; ++b)
  {
    job->splats_before[b + 1] += job->splats_before[b];
  }
  found.sums[0] = job->splats_before[blocks];
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

/* ---- spreading ---- */

/* Adds a row of pixels. */
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

static void mcor_spread_splat(
  const mcor_project_job* job, const mcor_splat* s, int first_row, int last_row, mcor_brush* brush)
{
  const int* size = job->out->size;
  const int64_t pixels = (int64_t)size[0] * size[1];
  const int first = s->first[0], count = s->last[0] - first + 1;
  /* Rounding must not make a share negative, unless the kernel itself is partly negative. */
  const double lowest =
    mcor_kernel_of(job->context->run.options->sph_kernel)->is_tensor ? -DBL_MAX : 0;
  for (int i = 0; i <= count; ++i)
  {
    brush->sides[i] = mcor_side_of(&job->column, 0, (first + i - s->at[0]) * s->pixel[0]);
  }
  for (int row = first_row; row <= last_row + 1; ++row)
  {
    double *before = brush->corners[~row & 1], *now = brush->corners[row & 1];
    const mcor_column_side side = mcor_side_of(&job->column, 1, (row - s->at[1]) * s->pixel[1]);
    mcor_sum_corners(&job->column, brush->sides, count + 1, &side, now);
    for (int c = 0; c < job->channels && row > first_row; ++c)
    {
      double* coarse = job->sums + 2 * c * pixels + (int64_t)(row - 1) * size[0] + first;
      mcor_add_pixels(
        count, s->amount[c], lowest, before, now, job->unit[c], coarse, coarse + pixels);
    }
  }
}

static void mcor_spread_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_project_job* job = data;
  for (int64_t band = first; band < last; ++band)
  {
    const int from = job->first_row[band], to = job->first_row[band + 1] - 1;
    for (int64_t i = job->first_listed[band]; i < job->first_listed[band + 1]; ++i)
    {
      const mcor_splat* s = &job->splats[job->listed[i]];
      mcor_spread_splat(job, s, s->first[1] > from ? s->first[1] : from,
        s->last[1] < to ? s->last[1] : to, &job->brushes[slice]);
    }
  }
}

/* Divides the image into bands of rows with about the same work, and lists the images that reach
 * each band. */
static mcor_status mcor_make_bands(mcor_project_job* job, int64_t count)
{
  const int rows = job->out->size[1];
  int64_t* work = calloc((size_t)rows + 1, sizeof *work);
  MCOR_TRY(mcor_allocated(job->context, work));
  for (int64_t i = 0; i < count; ++i)
  {
    const mcor_splat* s = &job->splats[i];
    work[s->first[1]] += s->last[0] - s->first[0] + 4;
    work[s->last[1] + 1] -= s->last[0] - s->first[0] + 4;
  }
  int64_t total = 0, done = 0;
  for (int row = 0; row < rows; ++row)
  {
    work[row] += row > 0 ? work[row - 1] : 0;
    total += work[row];
  }
  job->bands = 0;
  for (int row = 0; row < rows; ++row)
  {
    if (row == 0 || (job->bands < MCOR_SLICES && done * MCOR_SLICES >= total * job->bands))
    {
      job->first_row[job->bands++] = row;
    }
    job->band_of_row[row] = job->bands - 1;
    done += work[row];
  }
  job->first_row[job->bands] = rows;
  free(work);
  int64_t next[MCOR_SLICES + 1] = { 0 };
  for (int64_t i = 0; i < count; ++i)
  {
    const mcor_splat* s = &job->splats[i];
    for (int b = job->band_of_row[s->first[1]]; b <= job->band_of_row[s->last[1]]; ++b)
    {
      ++next[b + 1];
    }
  }
  for (int b = 0; b < job->bands; ++b)
  {
    next[b + 1] += next[b];
  }
  memcpy(job->first_listed, next, sizeof next);
  free(job->listed);
  job->listed = malloc((size_t)next[job->bands] * sizeof *job->listed + 1);
  MCOR_TRY(mcor_allocated(job->context, job->listed));
  for (int64_t i = 0; i < count; ++i)
  {
    const mcor_splat* s = &job->splats[i];
    for (int b = job->band_of_row[s->first[1]]; b <= job->band_of_row[s->last[1]]; ++b)
    {
      job->listed[next[b]++] = i;
    }
  }
  return MCOR_OK;
}

/* Spreads as many blocks together as there is room for. */
static mcor_status mcor_spread_all(mcor_project_job* job, int64_t blocks)
{
  mcor_context* context = job->context;
  const int64_t* before = job->splats_before;
  int64_t most = MCOR_SPLATS_TOGETHER;
  for (int64_t b = 0; b < blocks; ++b)
  {
    most = before[b + 1] - before[b] > most ? before[b + 1] - before[b] : most;
  }
  job->splats = malloc((size_t)most * sizeof *job->splats);
  job->band_of_row = malloc((size_t)job->out->size[1] * sizeof(int));
  bool complete = job->splats && job->band_of_row;
  const size_t corners = (size_t)job->out->size[0] + 1;
  for (int i = 0; i < MCOR_SLICES; ++i)
  {
    mcor_brush* brush = &job->brushes[i];
    brush->sides = malloc(corners * (sizeof *brush->sides + 2 * sizeof(double)));
    complete = complete && brush->sides;
    brush->corners[0] = brush->sides ? (double*)(brush->sides + corners) : NULL;
    brush->corners[1] = brush->sides ? brush->corners[0] + corners : NULL;
  }
  MCOR_TRY(mcor_allocated(context, complete));
  for (int64_t end; job->first_block < blocks; job->first_block = end)
  {
    const int64_t first = job->first_block;
    for (end = first + 1; end < blocks && before[end + 1] - before[first] <= most; ++end)
    {
    }
    const double share = 0.7 / (double)blocks;
    MCOR_TRY(
      mcor_report(context, "projection", 0.3 + share * (double)first, 0.3 + share * (double)end));
    MCOR_TRY(mcor_parallel_run(context, end - first, 1, mcor_splat_slice, job, NULL));
    MCOR_TRY(mcor_make_bands(job, before[end] - before[first]));
    MCOR_TRY(mcor_parallel_run(context, job->bands, 1, mcor_spread_slice, job, NULL));
  }
  return MCOR_OK;
}

mcor_status mcor_spread_particles(mcor_project_job* job)
{
  mcor_projection* out = job->out;
  const size_t pixels = (size_t)out->size[0] * (size_t)out->size[1];
  const int64_t blocks = (job->input->count + MCOR_BLOCK_PARTICLES - 1) / MCOR_BLOCK_PARTICLES;
  const double least_pixel =
    fmin(out->pixel[0], out->pixel[1]) / (out->statistics.smoothing_length_max * job->h_scale);
  out->values = malloc(pixels * sizeof(double));
  job->sums = calloc(pixels, 2 * (size_t)job->channels * sizeof(double));
  job->splats_before = malloc(((size_t)blocks + 1) * sizeof(int64_t));
  MCOR_TRY(mcor_allocated(job->context, out->values && job->sums && job->splats_before));
  MCOR_TRY(mcor_make_column(job->context, job->context->run.options->sph_kernel,
    mcor_is_plane(job->context), job->axes, least_pixel, &job->column));
  MCOR_TRY(mcor_count_splats(job, blocks));
  MCOR_TRY(mcor_spread_all(job, blocks));
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
