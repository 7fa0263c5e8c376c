/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Reads the arrays that a caller hands in, and answers questions about all their elements. */

#include "mcor_input.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int mcor_is_given(const mcor_array* array)
{
  return array->data || array->memory || array->constant != 0;
}

/* Compilers vectorise this loop where the stride is known. */
static inline void mcor_read_floats(const float* data, int64_t stride, int count, double* out)
{
  for (int i = 0; i < count; ++i)
  {
    out[i] = (double)data[i * stride];
  }
}

MCOR_VECTOR_LOOPS void mcor_read_array(
  const mcor_array* array, int64_t first, int count, int component, double* out)
{
  const int64_t stride = mcor_components(array), begin = first * stride + component;
  const float* floats = array->data;
  const double* doubles = array->data;
  if (array->data && array->type != MCOR_FLOAT64)
  {
    stride == 1     ? mcor_read_floats(floats + begin, 1, count, out)
      : stride == 3 ? mcor_read_floats(floats + begin, 3, count, out)
                    : mcor_read_floats(floats + begin, stride, count, out);
    return;
  }
  for (int i = 0; i < count; ++i)
  {
    out[i] = doubles ? doubles[begin + i * stride] : array->constant;
  }
}

void mcor_read_positions(
  const mcor_input* input, int64_t first, int count, double x[3][MCOR_CHUNK])
{
  for (int a = 0; a < 3; ++a)
  {
    mcor_read_array(&input->positions, first, count, a, x[a]);
  }
}

int mcor_read_places(const mcor_context* context, const mcor_input* input, int64_t first,
  int64_t last, mcor_places* places)
{
  places->count = mcor_chunk_of(last - first);
  mcor_read_positions(input, first, places->count, places->x);
  mcor_read_smoothing_length(context, input, first, places->count, places->h);
  mcor_widen_lengths(input, first, places->count, places->h, places->length);
  return places->count;
}

/* How many elements are tested together; if they were tested one by one, each test would wait for
 * the one before. */
#define MCOR_ELEMENTS 4

MCOR_VECTOR_LOOPS void mcor_widen_range(const double* x, int count, double* low, double* high)
{
  double least[MCOR_ELEMENTS], most[MCOR_ELEMENTS];
  int i = 0;
  for (int l = 0; l < MCOR_ELEMENTS; ++l)
  {
    least[l] = *low;
    most[l] = *high;
  }
  for (; i + MCOR_ELEMENTS <= count; i += MCOR_ELEMENTS)
  {
    for (int l = 0; l < MCOR_ELEMENTS; ++l)
    {
      least[l] = mcor_least(least[l], x[i + l]);
      most[l] = mcor_most(most[l], x[i + l]);
    }
  }
  for (; i < count; ++i)
  {
    least[0] = mcor_least(least[0], x[i]);
    most[0] = mcor_most(most[0], x[i]);
  }
  for (int l = 0; l < MCOR_ELEMENTS; ++l)
  {
    *low = mcor_least(*low, least[l]);
    *high = mcor_most(*high, most[l]);
  }
}

MCOR_VECTOR_LOOPS bool mcor_is_all_within(const double* x, int count, double least, double most)
{
  int64_t beyond = 0; /* as wide as the numbers, so that compilers vectorise the loop */
  for (int i = 0; i < count; ++i)
  {
    beyond |= (x[i] >= least) & (x[i] <= most) ? 0 : 1;
  }
  return !beyond;
}

mcor_findings mcor_no_findings(void)
{
  mcor_findings found = { .first = INT64_MAX };
  for (int k = 0; k < MCOR_RANGES; ++k)
  {
    found.least[k] = DBL_MAX;
    found.most[k] = -DBL_MAX;
  }
  return found;
}

mcor_findings mcor_merge_findings(const mcor_findings* slices, int count)
{
  mcor_findings all = mcor_no_findings();
  for (int s = 0; s < count; ++s)
  {
    for (int k = 0; k < MCOR_RANGES; ++k)
    {
      mcor_add_range(&all, k, slices[s].least[k], slices[s].most[k]);
    }
    for (int k = 0; k < MCOR_SUMS; ++k)
    {
      all.sums[k] += slices[s].sums[k];
    }
    all.first = slices[s].first < all.first ? slices[s].first : all.first;
  }
  return all;
}

mcor_context* mcor_make_bare_context(const mcor_options* options)
{
  mcor_context* context = calloc(1, sizeof *context);
  if (context)
  {
    context->run.options = options;
  }
  return context;
}

void mcor_free_bare_context(mcor_context* context)
{
  if (context)
  {
    mcor_end_pool(&context->pool);
    free(context);
  }
}

mcor_status mcor_reduce_findings(mcor_context* context, mcor_findings* found)
{
  MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, found->sums, MCOR_SUMS));
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_LEAST, found->least, MCOR_RANGES));
  return mcor_reduce_doubles(context, MCOR_GREATEST, found->most, MCOR_RANGES);
}

typedef struct mcor_range_job
{
  const mcor_array* array;
  const uint8_t* solid;
  mcor_skip skip;
  int component;
  mcor_findings slices[MCOR_SLICES];
} mcor_range_job;

static void mcor_component_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_range_job* job = data;
  mcor_findings found = mcor_no_findings();
  double x[MCOR_CHUNK];
  for (int64_t begin = first; begin < last; begin += MCOR_CHUNK)
  {
    const int count = mcor_chunk_of(last - begin);
    int kept = job->solid ? 0 : count;
    mcor_read_array(job->array, begin, count, job->component, x);
    for (int i = 0; i < count && job->solid; ++i)
    {
      x[kept] = x[i];
      kept += !mcor_is_skipped(job->solid, job->skip, begin + i) && isfinite(x[i]);
    }
    mcor_widen_range(x, kept, &found.least[0], &found.most[0]);
  }
  job->slices[slice] = found;
}

mcor_findings mcor_find_range(mcor_context* context, const mcor_array* array, const uint8_t* solid,
  mcor_skip skip, int64_t count, int component)
{
  mcor_range_job job = { .array = array, .solid = solid, .skip = skip, .component = component };
  const int slices =
    mcor_parallel_for(context, count, MCOR_MEMORY_GRAIN, mcor_component_slice, &job);
  return mcor_merge_findings(job.slices, slices);
}

double mcor_largest(
  mcor_context* context, const mcor_input* input, const mcor_array* array, int component)
{
  const mcor_findings found =
    mcor_find_range(context, array, input->solid, MCOR_SKIP_ABSENT, input->count, component);
  return mcor_largest_of(found.least[0], found.most[0]);
}

typedef struct mcor_legal_job
{
  mcor_array elements; /* the array, as if it had one component */
  int components;
  const uint8_t* solid;
  mcor_skip skip;
  double least; /* the least legal value */
  mcor_findings slices[MCOR_SLICES]; /* `first`: the first particle with an illegal value */
} mcor_legal_job;

static void mcor_legal_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_legal_job* job = data;
  mcor_findings found = mcor_no_findings();
  double x[MCOR_CHUNK];
  for (int count; (count = mcor_chunk_of(last - first)) > 0 && found.first == INT64_MAX;
       first += count)
  {
    mcor_read_array(&job->elements, first, count, 0, x);
    const bool are_legal = mcor_is_all_within(x, count, job->least, DBL_MAX);
    for (int i = are_legal ? count : 0; i < count && found.first == INT64_MAX; ++i)
    {
      const int64_t particle = (first + i) / job->components;
      const bool is_legal = x[i] >= job->least && x[i] <= DBL_MAX;
      found.first =
        is_legal || mcor_is_skipped(job->solid, job->skip, particle) ? INT64_MAX : particle;
    }
  }
  job->slices[slice] = found;
}

int64_t mcor_find_illegal(mcor_context* context, const mcor_array* array, const uint8_t* solid,
  mcor_skip skip, int64_t count, bool positive)
{
  mcor_legal_job job = { .elements = *array,
    .components = array->data ? mcor_components(array) : 1,
    .solid = array->data ? solid : NULL, /* a constant holds for all particles */
    .skip = skip,
    .least = positive ? DBL_TRUE_MIN : -DBL_MAX };
  job.elements.components = 1;
  const int slices = mcor_parallel_for(
    context, array->data ? count * job.components : 1, MCOR_MEMORY_GRAIN, mcor_legal_slice, &job);
  const int64_t first = mcor_merge_findings(job.slices, slices).first;
  return first < INT64_MAX ? first : -1;
}

/* Returns the exponent of the least power of 2 above the absolute values of all components of
 * particle i; 0 if all components are 0, or one is infinite. */
static int mcor_exponent_of(const mcor_array* array, int64_t i)
{
  double largest = 0;
  int exponent = 0;
  for (int c = 0; c < mcor_components(array); ++c)
  {
    largest = fmax(largest, fabs(mcor_array_at(array, i, c)));
  }
  if (isfinite(largest))
  {
    frexp(largest, &exponent);
  }
  return exponent;
}

/* If a sum of squares lies between these limits, no square overflowed, and only squares too small
 * to matter became 0. */
#define MCOR_SQUARE_MIN 1e-280
#define MCOR_SQUARE_MAX 1e280

void mcor_read_scalar(const mcor_input* input, int64_t first, int count, double* out)
{
  const bool is_dot = input->scalar_dot.data, has_many = mcor_components(&input->scalar) > 1;
  const int component = has_many ? input->scalar_component : 0;
  const mcor_array *a = &input->scalar, *b = is_dot ? &input->scalar_dot : a;
  double x[MCOR_CHUNK], y[MCOR_CHUNK], *other = is_dot ? y : x;
  if (!is_dot && !(has_many && component == MCOR_MAGNITUDE))
  {
    mcor_read_array(a, first, count, component, out);
    return;
  }
  for (int c = 0; c < mcor_components(a); ++c)
  {
    mcor_read_array(b, first, count, c, other);
    mcor_read_array(a, first, is_dot ? count : 0, c, x);
    for (int i = 0; i < count; ++i)
    {
      out[i] = x[i] * other[i] + (c > 0 ? out[i] : 0);
    }
  }
  for (int i = 0; i < count; ++i)
  {
    if (is_dot ? isfinite(out[i]) : out[i] > MCOR_SQUARE_MIN && out[i] < MCOR_SQUARE_MAX)
    {
      out[i] = is_dot ? out[i] : sqrt(out[i]);
    }
    else if (is_dot || out[i] != 0 || mcor_exponent_of(a, first + i) != 0)
    {
      /* Scales by powers of 2, so that no product overflows or vanishes on the way. */
      const int ea = mcor_exponent_of(a, first + i), eb = mcor_exponent_of(b, first + i);
      double sum = 0;
      for (int c = 0; c < mcor_components(a); ++c)
      {
        sum +=
          ldexp(mcor_array_at(a, first + i, c), -ea) * ldexp(mcor_array_at(b, first + i, c), -eb);
      }
      out[i] = is_dot ? ldexp(sum, ea + eb) : ldexp(sqrt(sum), ea);
    }
  }
}

void mcor_read_size(const mcor_input* input, int64_t first, int count, double* out)
{
  static const mcor_array one = { .constant = 1 };
  mcor_read_array(mcor_is_given(&input->volume) ? &input->volume
      : mcor_is_given(&input->mass)             ? &input->mass
                                                : &one,
    first, count, 0, out);
  if (!mcor_is_given(&input->volume) && !mcor_needs_density(input))
  {
    double density[MCOR_CHUNK];
    mcor_read_array(&input->density, first, count, 0, density);
    for (int i = 0; i < count; ++i)
    {
      out[i] /= density[i];
    }
  }
}

void mcor_read_smoothing_length(
  const mcor_context* context, const mcor_input* input, int64_t first, int count, double* out)
{
  const mcor_array estimate = { .constant = context->measure.h_estimate };
  const double scale =
    input->smoothing_length_is_support_radius && !input->estimate_smoothing_length
    ? 1 / mcor_support_factor(context->run.options->sph_kernel)
    : 1;
  mcor_read_array(
    input->estimate_smoothing_length ? &estimate : &input->smoothing_length, first, count, 0, out);
  for (int i = 0; i < count; ++i)
  {
    out[i] *= scale;
  }
}

void mcor_widen_lengths(
  const mcor_input* input, int64_t first, int count, const double* h, double* out)
{
  if (!mcor_is_given(&input->widening))
  {
    memcpy(out, h, (size_t)count * sizeof *out);
    return;
  }
  mcor_read_array(&input->widening, first, count, 0, out);
  for (int i = 0; i < count; ++i)
  {
    out[i] *= h[i];
  }
}
