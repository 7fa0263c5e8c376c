/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests gauges, and particles of two dimensions. */

#include "fuzz.h"

#include <math.h>

#define FUZZ_LINES 4

static void fuzz_check_gauges(const mcor_gauges* g, const mcor_gauge_line* lines)
{
  int64_t crossings = 0;
  for (int64_t i = 0; i < g->count; ++i)
  {
    const mcor_gauge_reading* r = &g->readings[i];
    const double *a = lines[i].from, *b = lines[i].to;
    const double length = hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]) * (1 + 1e-9);
    FUZZ_CHECK((unsigned)r->state < MCOR_GAUGE_STATE_COUNT && r->depth >= 0 && r->depth <= length);
    FUZZ_CHECK(r->first_crossing == crossings && r->crossing_count >= 0);
    FUZZ_CHECK(r->state == MCOR_GAUGE_DRY
        ? r->depth == 0 && isnan(r->first) && isnan(r->last)
        : r->first >= 0 && r->first <= r->last && r->last <= length);
    for (int64_t c = 0; c < r->crossing_count; ++c)
    {
      const double* at = g->crossings + crossings + c;
      FUZZ_CHECK(*at >= 0 && *at <= length && (c == 0 || at[-1] <= *at));
    }
    crossings += r->crossing_count;
  }
  FUZZ_CHECK(crossings == g->crossing_count);
}

void fuzz_gauge(fuzz_bytes* bytes, const fuzz_call* call)
{
  mcor_context* context = fuzz_context(call, 1);
  mcor_gauge_line lines[FUZZ_LINES] = { { .name = NULL } };
  const int64_t count = fuzz_byte(bytes) % (FUZZ_LINES + 1);
  for (int i = 0; i < 6 * (int)count; ++i)
  {
    (i % 6 < 3 ? lines[i / 6].from : lines[i / 6].to)[i % 3] = fuzz_side(bytes);
  }
  mcor_gauges gauges;
  const mcor_status status =
    mcor_gauge(context, &call->input, &call->options, lines, count, &gauges);
  if (status != MCOR_OK)
  {
    fuzz_check_failure(context, status);
    FUZZ_CHECK(gauges.count == 0 && !gauges.readings && !gauges.crossings);
    return;
  }
  FUZZ_CHECK(gauges.count == count);
  fuzz_check_gauges(&gauges, lines);
  mcor_free_gauges(&gauges);
}

void fuzz_flatten(unsigned how, fuzz_bytes* bytes, fuzz_call* call)
{
  mcor_array* positions = &call->input.positions;
  const size_t n = (size_t)call->input.count, axis = how % 4;
  const double at = fuzz_side(bytes);
  const double* from = positions->data;
  double* to = fuzz_array(call, 7, 3 * n);
  for (size_t i = 0; i < 3 * n; ++i)
  {
    to[i] = i % 3 == axis ? at : from[i];
  }
  positions->data = to;
  if (call->input.scalar.data == from)
  {
    call->input.scalar.data = to;
  }
  call->attributes[1].data = to;
  call->options.dimension = how >> 2 & 3;
  call->options.filled = how >> 4 & 1;
  call->options.capping = (int)(fuzz_byte(bytes) % 4);
}
