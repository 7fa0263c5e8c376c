/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Reading the arrays that a caller hands in. */

#include "mcor_input.h"
#include "mcor_parallel.h"

#include <math.h>
#include <string.h>

int mcor_is_given(const mcor_array* array)
{
  return array->data || array->constant != 0;
}

/* Compilers vectorise these where they know the stride. */
static inline void mcor_read_floats(const float* data, int64_t stride, int count, double* out)
{
  for (int i = 0; i < count; ++i)
  {
    out[i] = (double)data[i * stride];
  }
}

static inline void mcor_read_doubles(const double* data, int64_t stride, int count, double* out)
{
  for (int i = 0; i < count; ++i)
  {
    out[i] = data[i * stride];
  }
}

void mcor_read_array(const mcor_array* array, int64_t first, int count, int component, double* out)
{
  const int64_t stride = mcor_components(array), begin = first * stride + component;
  const float* floats = array->data;
  const double* doubles = array->data;
  if (!array->data)
  {
    for (int i = 0; i < count; ++i)
    {
      out[i] = array->constant;
    }
  }
  else if (array->type == MCOR_FLOAT64)
  {
    mcor_read_doubles(doubles + begin, stride, count, out);
  }
  else if (stride == 1)
  {
    mcor_read_floats(floats + begin, 1, count, out);
  }
  else if (stride == 3)
  {
    mcor_read_floats(floats + begin, 3, count, out);
  }
  else
  {
    mcor_read_floats(floats + begin, stride, count, out);
  }
}

void mcor_read_positions(const mcor_input* input, int64_t first, int count, double x[3][MCOR_CHUNK])
{
  if (input->positions.type == MCOR_FLOAT64)
  {
    const double* from = (const double*)input->positions.data + 3 * first;
    for (int i = 0; i < count; ++i)
    {
      x[0][i] = from[3 * i];
      x[1][i] = from[3 * i + 1];
      x[2][i] = from[3 * i + 2];
    }
  }
  else
  {
    const float* from = (const float*)input->positions.data + 3 * first;
    for (int i = 0; i < count; ++i)
    {
      x[0][i] = (double)from[3 * i];
      x[1][i] = (double)from[3 * i + 1];
      x[2][i] = (double)from[3 * i + 2];
    }
  }
}

/* The bits of absolute values are in the order of the values; compilers vectorise their maximum
 * where they know the stride. */
static inline double mcor_largest_float(
  const float* data, const uint8_t* solid, int64_t count, int64_t stride)
{
  int32_t most = 0;
  for (int64_t i = 0; i < count; ++i)
  {
    int32_t bits;
    memcpy(&bits, data + i * stride, sizeof bits);
    bits = solid && solid[i] ? 0 : bits & INT32_MAX;
    most = bits > most ? bits : most;
  }
  float value;
  memcpy(&value, &most, sizeof value);
  return (double)value;
}

static inline double mcor_largest_double(
  const double* data, const uint8_t* solid, int64_t count, int64_t stride)
{
  int64_t most = 0;
  for (int64_t i = 0; i < count; ++i)
  {
    int64_t bits;
    memcpy(&bits, data + i * stride, sizeof bits);
    bits = solid && solid[i] ? 0 : bits & INT64_MAX;
    most = bits > most ? bits : most;
  }
  double value;
  memcpy(&value, &most, sizeof value);
  return value;
}

typedef struct mcor_survey
{
  const mcor_array* array;
  const uint8_t* solid;
  int component;
  double largest[MCOR_SLICES];
  bool varies[MCOR_SLICES];
} mcor_survey;

static void mcor_find_largest(void* data, int slice, int64_t first, int64_t last)
{
  mcor_survey* survey = data;
  const mcor_array* array = survey->array;
  const int64_t stride = mcor_components(array), at = first * stride + survey->component;
  const int64_t count = last - first;
  const uint8_t* solid = survey->solid ? survey->solid + first : NULL;
  const float* floats = array->data;
  const double* doubles = array->data;
  survey->largest[slice] = array->type == MCOR_FLOAT64
    ? mcor_largest_double(doubles + at, solid, count, stride)
    : stride == 1 && !solid ? mcor_largest_float(floats + at, NULL, count, 1)
                            : mcor_largest_float(floats + at, solid, count, stride);
}

double mcor_largest(const mcor_array* array, const uint8_t* solid, int64_t count, int component)
{
  mcor_survey survey = { .array = array, .solid = solid, .component = component };
  if (!array->data)
  {
    return fabs(array->constant);
  }
  const int slices = mcor_parallel_for(count, MCOR_MEMORY_GRAIN, mcor_find_largest, &survey);
  double largest = 0;
  for (int s = 0; s < slices; ++s)
  {
    largest = survey.largest[s] > largest ? survey.largest[s] : largest;
  }
  return largest;
}

static void mcor_find_other(void* data, int slice, int64_t first, int64_t last)
{
  mcor_survey* survey = data;
  const int64_t stride = mcor_components(survey->array);
  int64_t i = first;
  if (survey->array->type == MCOR_FLOAT64)
  {
    const double* x = (const double*)survey->array->data + survey->component;
    for (; i < last && x[i * stride] == x[0]; ++i)
    {
    }
  }
  else
  {
    const float* x = (const float*)survey->array->data + survey->component;
    for (; i < last && x[i * stride] == x[0]; ++i)
    {
    }
  }
  survey->varies[slice] = i < last;
}

bool mcor_is_constant(const mcor_array* array, int64_t count, int component)
{
  mcor_survey survey = { .array = array, .component = component };
  if (!array->data)
  {
    return true;
  }
  const int slices = mcor_parallel_for(count, MCOR_MEMORY_GRAIN, mcor_find_other, &survey);
  bool varies = false;
  for (int s = 0; s < slices; ++s)
  {
    varies = varies || survey.varies[s];
  }
  return !varies;
}

/* The power of 2 just above all components of particle i; 0 if they are 0 or not finite. */
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

static bool mcor_is_zero(const mcor_array* array, int64_t i)
{
  bool zero = true;
  for (int c = 0; c < mcor_components(array); ++c)
  {
    zero = zero && mcor_array_at(array, i, c) == 0;
  }
  return zero;
}

/* Of particle i, a^T b or its root, by powers of 2 that keep what exists from overflowing, or
 * vanishing, on the way. */
static double mcor_scaled_product(
  const mcor_array* a, const mcor_array* b, int64_t i, bool magnitude)
{
  const int ea = mcor_exponent_of(a, i), eb = mcor_exponent_of(b, i);
  double sum = 0;
  for (int c = 0; c < mcor_components(a); ++c)
  {
    sum += ldexp(mcor_array_at(a, i, c), -ea) * ldexp(mcor_array_at(b, i, c), -eb);
  }
  return magnitude ? ldexp(sqrt(sum), ea) : ldexp(sum, ea + eb);
}

/* Sums of squares between these lost nothing. */
#define MCOR_SQUARE_MIN 1e-280
#define MCOR_SQUARE_MAX 1e280

/* Compilers vectorise these where they know the stride. */
static inline void mcor_square_floats(const float* x, int components, int count, double* out)
{
  for (int i = 0; i < count; ++i)
  {
    double sum = 0;
    for (int c = 0; c < components; ++c)
    {
      const double v = (double)x[(int64_t)i * components + c];
      sum += v * v;
    }
    out[i] = sum;
  }
}

static inline void mcor_square_doubles(const double* x, int components, int count, double* out)
{
  for (int i = 0; i < count; ++i)
  {
    double sum = 0;
    for (int c = 0; c < components; ++c)
    {
      const double v = x[(int64_t)i * components + c];
      sum += v * v;
    }
    out[i] = sum;
  }
}

static void mcor_read_magnitude(const mcor_array* a, int64_t first, int count, double* out)
{
  const int components = mcor_components(a);
  if (a->type == MCOR_FLOAT64)
  {
    const double* x = (const double*)a->data + first * components;
    components == 3 ? mcor_square_doubles(x, 3, count, out)
                    : mcor_square_doubles(x, components, count, out);
  }
  else
  {
    const float* x = (const float*)a->data + first * components;
    components == 3 ? mcor_square_floats(x, 3, count, out)
                    : mcor_square_floats(x, components, count, out);
  }
  for (int i = 0; i < count; ++i)
  {
    const bool good = out[i] > MCOR_SQUARE_MIN && out[i] < MCOR_SQUARE_MAX;
    if (good)
    {
      out[i] = sqrt(out[i]);
    }
    else if (out[i] != 0 || !mcor_is_zero(a, first + i))
    {
      out[i] = mcor_scaled_product(a, a, first + i, true);
    }
  }
}

static void mcor_read_dot(
  const mcor_array* a, const mcor_array* b, int64_t first, int count, double* out)
{
  double x[MCOR_CHUNK], y[MCOR_CHUNK];
  memset(out, 0, (size_t)count * sizeof *out);
  for (int c = 0; c < mcor_components(a); ++c)
  {
    mcor_read_array(a, first, count, c, x);
    mcor_read_array(b, first, count, c, y);
    for (int i = 0; i < count; ++i)
    {
      out[i] += x[i] * y[i];
    }
  }
  for (int i = 0; i < count; ++i)
  {
    out[i] = isfinite(out[i]) ? out[i] : mcor_scaled_product(a, b, first + i, false);
  }
}

void mcor_read_scalar(const mcor_input* input, int64_t first, int count, double* out)
{
  const mcor_array *a = &input->scalar, *b = &input->scalar_dot;
  if (!mcor_scalar_is_derived(input))
  {
    mcor_read_array(a, first, count, mcor_components(a) > 1 ? input->scalar_component : 0, out);
  }
  else if (b->data)
  {
    mcor_read_dot(a, b, first, count, out);
  }
  else
  {
    mcor_read_magnitude(a, first, count, out);
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
