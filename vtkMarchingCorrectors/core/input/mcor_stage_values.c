/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Copies values of particles from the caller's arrays to the device, in the order of the search
 * grid. */

#include "mcor_stage.h"

#include <math.h>

typedef struct mcor_value_job
{
  const mcor_context* context;
  const mcor_input* input;
  const mcor_array* array;
  int component;
  double shift, scale;
  bool fixed;
  void* values;
} mcor_value_job;

/* Rounds values to fixed-point numbers. */
static void mcor_store_rounded(
  const mcor_context* context, void* array, int64_t first, const double* values, int count)
{
  const bool single = context->cl.fix_size == sizeof(int32_t);
  for (int i = 0; i < count; ++i)
  {
    if (single)
    {
      ((int32_t*)array)[first + i] = (int32_t)lrint(values[i]);
    }
    else
    {
      ((int64_t*)array)[first + i] = (int64_t)llrint(values[i]);
    }
  }
}

static void mcor_store_value_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_value_job* job = data;
  const mcor_input* input = job->input;
  const double shift = job->shift, scale = job->scale;
  int n = 0;
  for (int64_t begin = first; begin < last; begin += n)
  {
    const int64_t from = mcor_source_of(job->context, begin), rest = input->count - from;
    const int count = rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK;
    double chunk[MCOR_CHUNK], used[MCOR_CHUNK];
    job->array ? mcor_read_array(job->array, from, count, job->component, chunk)
               : mcor_read_scalar(input, from, count, chunk);
    /* The images of a particle stand side by side. */
    for (n = 0; n < MCOR_CHUNK && begin + n < last &&
         mcor_source_of(job->context, begin + n) < from + count;
         ++n)
    {
      used[n] = (chunk[mcor_source_of(job->context, begin + n) - from] - shift) * scale;
    }
    /* Values of solids play no part, whatever they are. */
    for (int i = 0; i < n && input->solid; ++i)
    {
      used[i] = input->solid[mcor_source_of(job->context, begin + i)] ? 0 : used[i];
    }
    job->fixed ? mcor_store_rounded(job->context, job->values, begin, used, n)
               : mcor_store_reals(job->context, job->values, begin, used, n);
  }
  (void)slice;
}

/* Copies one component of an array (or the scalar, if `array` is NULL), less `shift`, times
 * `scale`, as real or fixed-point numbers, into row `to_row`; a row has one value per particle. */
mcor_status mcor_sort_values(mcor_context* context, const mcor_input* input,
  const mcor_array* array, int component, double shift, double scale, bool fixed, mcor_buffer* to,
  int to_row)
{
  const mcor_grid* grid = &context->grid;
  const size_t bytes = (size_t)grid->count * context->cl.real_size;
  mcor_buffer* raw = &context->stage.values;
  mcor_value_job job = { context, input, array, component, shift, scale, fixed, NULL };
  MCOR_TRY(mcor_reserve(context, raw, bytes));
  MCOR_TRY(mcor_map(context, raw, bytes, true, &job.values));
  const mcor_status status =
    mcor_parallel_run(context, grid->count, MCOR_LIGHT_GRAIN, mcor_store_value_slice, &job, NULL);
  MCOR_TRY(mcor_unmap(context, raw, &job.values));
  MCOR_TRY(status);
  return MCOR_LAUNCH(context, "mcor_grid_gather_value", MCOR_LIGHT, grid->count,
    MCOR_INT(grid->count), MCOR_BUFFER(&grid->order), MCOR_BUFFER(raw), MCOR_BUFFER(to),
    MCOR_INT(to_row));
}
