/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Whether numbers that a caller hands in are finite, and positive where they must be. */

#include "mcor_input.h"
#include "mcor_parallel.h"

#include <float.h>
#include <math.h>

typedef struct mcor_finite
{
  const mcor_array* array;
  bool positive;
  bool illegal[MCOR_SLICES];
} mcor_finite;

/* Whether elements are finite, and above 0 where they must be; written to be vectorised. */
static void mcor_finite_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_finite* check = data;
  const bool positive = check->positive;
  int illegal = 0;
  if (check->array->type == MCOR_FLOAT64)
  {
    const double *x = check->array->data, least = positive ? 0 : -DBL_MAX;
    for (int64_t i = first; i < last; ++i)
    {
      illegal |= !((x[i] <= DBL_MAX) & (positive ? x[i] > least : x[i] >= least));
    }
  }
  else
  {
    const float *x = check->array->data, least = positive ? 0 : -FLT_MAX;
    for (int64_t i = first; i < last; ++i)
    {
      illegal |= !((x[i] <= FLT_MAX) & (positive ? x[i] > least : x[i] >= least));
    }
  }
  check->illegal[slice] = illegal;
}

bool mcor_is_legal(const mcor_array* array, int64_t elements, bool positive)
{
  mcor_finite check = { .array = array, .positive = positive };
  const int slices = mcor_parallel_for(elements, MCOR_MEMORY_GRAIN, mcor_finite_slice, &check);
  bool illegal = false;
  for (int s = 0; s < slices; ++s)
  {
    illegal = illegal || check.illegal[s];
  }
  return !illegal;
}

int64_t mcor_find_illegal(
  const mcor_array* array, const uint8_t* solid, int64_t count, int component, bool positive)
{
  for (int64_t i = 0; i < count; ++i)
  {
    const double x = mcor_array_at(array, i, component);
    if ((!isfinite(x) || (positive && !(x > 0))) && !(solid && solid[i]))
    {
      return i;
    }
  }
  return -1;
}

int64_t mcor_find_not_finite(const mcor_array* array, const uint8_t* solid, int64_t count)
{
  const int components = mcor_components(array);
  int64_t first = -1;
  if (array->data && mcor_is_legal(array, count * components, false))
  {
    return -1;
  }
  for (int c = 0; c < components; ++c)
  {
    const int64_t rest = first >= 0 ? first : array->data ? count : 1;
    const int64_t i = mcor_find_illegal(array, array->data ? solid : NULL, rest, c, false);
    first = i < 0 ? first : i;
  }
  return first;
}
