/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Where most values of the scalar are. */

#include "mcor_input.h"

#define MCOR_MEDIAN_BINS 1024
#define MCOR_MEDIAN_PASSES 8

typedef struct mcor_bin
{
  int64_t count;
  double low, high; /* of the values in it */
} mcor_bin;

/* Sorts the values of fluid particles in [low, high] into bins. */
static void mcor_fill_bins(
  const mcor_input* input, double low, double high, mcor_bin bins[MCOR_MEDIAN_BINS])
{
  const double width = high / MCOR_MEDIAN_BINS - low / MCOR_MEDIAN_BINS;
  for (int b = 0; b < MCOR_MEDIAN_BINS; ++b)
  {
    bins[b] = (mcor_bin){ 0, high, low };
  }
  double chunk[MCOR_CHUNK];
  for (int64_t i = 0; i < input->count; ++i)
  {
    if (i % MCOR_CHUNK == 0)
    {
      const int64_t rest = input->count - i;
      mcor_read_scalar(input, i, rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK, chunk);
    }
    const double v = chunk[i % MCOR_CHUNK];
    if ((!input->solid || !input->solid[i]) && v >= low && v <= high)
    {
      /* Halved, as the difference may be too large for a number. */
      const int b = (int)((0.5 * v - 0.5 * low) / width * 2);
      mcor_bin* bin = bins + (b < MCOR_MEDIAN_BINS ? b : MCOR_MEDIAN_BINS - 1);
      ++bin->count;
      bin->low = v < bin->low ? v : bin->low;
      bin->high = v > bin->high ? v : bin->high;
    }
  }
}

/* About the median of the scalar of fluid particles: of the bin that holds it, while many are in
 * that bin. A bin ends where its values do, so that a huge outlier does not move the median away
 * from them. Counts, and least and greatest values, do not depend on the order of the particles. */
double mcor_scalar_median(const mcor_context* context, const mcor_input* input)
{
  double low = context->measure.scalar_min, high = context->measure.scalar_max;
  int64_t below = 0;
  for (int pass = 0; pass < MCOR_MEDIAN_PASSES; ++pass)
  {
    if (!(high / MCOR_MEDIAN_BINS - low / MCOR_MEDIAN_BINS > 0))
    {
      break;
    }
    mcor_bin bins[MCOR_MEDIAN_BINS];
    mcor_fill_bins(input, low, high, bins);
    int b = 0;
    while (b < MCOR_MEDIAN_BINS - 1 && 2 * (below + bins[b].count) < context->measure.fluid_count)
    {
      below += bins[b++].count;
    }
    if (bins[b].count == 0)
    {
      break;
    }
    low = bins[b].low;
    high = bins[b].high;
    if (bins[b].count < context->measure.fluid_count / 16)
    {
      break;
    }
  }
  return 0.5 * low + 0.5 * high;
}
