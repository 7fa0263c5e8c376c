/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests modules that not every run uses: box, period, walls, adaptive cubes, global values, ranks, probe, derivatives,
 * gauges, and particles in a plane. */

#include "fuzz.h"

#include <math.h>
#include <stdlib.h>

#define FUZZ_POINTS 24
#define FUZZ_LINES 4

void fuzz_regions(unsigned modules, fuzz_bytes* bytes, fuzz_call* call)
{
  static const double shares[] = { 0.5, 0.1, 0.9, 1e-3, 0.999999, 1, -1, NAN };
  mcor_options* o = &call->options;
  for (int a = 0; a < 3 && modules & 1; ++a)
  {
    o->box[2 * a] = fuzz_side(bytes);
    o->box[2 * a + 1] = o->box[2 * a] + fabs(fuzz_side(bytes));
  }
  for (int a = 0; a < 3 && modules >> 1 & 1; ++a)
  {
    const double from = fuzz_side(bytes), length = fuzz_side(bytes);
    o->periodic[2 * a] = length < 1 ? 0 : from;
    o->periodic[2 * a + 1] = length < 1 ? 0 : from + length;
  }
  o->capping = (modules & 3) == 2;
  o->wall_share = modules >> 2 & 1 ? shares[fuzz_byte(bytes) % 8] : 0;
  if (modules >> 6 & 1)
  {
    const unsigned b = fuzz_byte(bytes);
    o->level_limit = (int)(b % 29) - 2;
    double* h = call->arrays[1];
    for (int64_t i = 0; i < call->input.count; ++i)
    {
      h[i] = h[i] > 100 ? 100 : h[i]; /* small cubes everywhere in a huge reach would take too long */
    }
    o->outputs |= b > 250 ? MCOR_OUT_POINT_KEYS : 0;
    o->outputs |= b > 251 ? MCOR_OUT_TRIANGLE_KEYS : 0;
  }
}

/* Checks that a run with global values measured from its own input is the same as a run without
 * them. */
static void fuzz_globals(const fuzz_call* call)
{
  mcor_context* context = fuzz_context(call, 1);
  mcor_globals globals;
  mcor_options alone = call->options;
  mcor_options given = alone;
  given.globals = &globals;
  const mcor_status measured = mcor_measure_globals(context, &call->input, &alone, &globals);
  if (measured != MCOR_OK)
  {
    fuzz_check_failure(context, measured);
    FUZZ_CHECK(!globals.components && !globals.splits && globals.measured.fluid_count == 0);
    return;
  }
  mcor_surface surfaces[2];
  const mcor_status status = mcor_extract(context, &call->input, &alone, &surfaces[0]);
  FUZZ_CHECK(mcor_extract(context, &call->input, &given, &surfaces[1]) == status);
  fuzz_check_same(&surfaces[0], &surfaces[1]);
  mcor_free_surface(&surfaces[0]);
  mcor_free_surface(&surfaces[1]);
  mcor_free_globals(&globals);
}

/* Checks that the boxes on both sides of a plane have together as many cells and triangles as the
 * whole surface. */
static void fuzz_halves(const fuzz_call* call)
{
  mcor_context* context = fuzz_context(call, 1);
  mcor_options options = call->options;
  int64_t triangles[3] = { 0 }, cells[3] = { 0 };
  options.seeds = MCOR_COMPLETE; /* boxes refuse pairs */
  options.capping = options.capping && options.field == MCOR_SHEPARD; /* a mean has no caps in empty space */
  for (int part = 0; part < 3; ++part)
  {
    mcor_surface surface;
    for (int s = 0; s < 6; ++s)
    {
      options.box[s] = part == 0 ? 0 : s % 2 == 0 ? -INFINITY : INFINITY;
    }
    options.box[part == 1] = part == 0 ? 0 : call->iso[0];
    if (mcor_extract(context, &call->input, &options, &surface) != MCOR_OK)
    {
      return; /* one of the calls may need more memory than the other */
    }
    triangles[part] = surface.triangle_count;
    cells[part] = surface.statistics.cells_used;
    mcor_free_surface(&surface);
  }
  FUZZ_CHECK(cells[1] + cells[2] == cells[0]);
  FUZZ_CHECK(triangles[1] + triangles[2] == triangles[0]);
}

/* A single rank. Its callback number `failing` fails. */
typedef struct fuzz_rank
{
  int calls, failing;
} fuzz_rank;

static int fuzz_exchange(fuzz_rank* rank)
{
  FUZZ_CHECK(rank->calls <= rank->failing); /* no call comes after the call that failed */
  return rank->calls++ == rank->failing;
}

static int fuzz_reduce_doubles(void* user, mcor_reduction reduction, double* values, int count)
{
  FUZZ_CHECK(values && count > 0 && reduction != MCOR_SUM_OF);
  return fuzz_exchange(user);
}

static int fuzz_reduce_counts(void* user, mcor_reduction reduction, int64_t* values, int count)
{
  FUZZ_CHECK(values && count > 0 && (unsigned)reduction <= MCOR_SUM_OF);
  return fuzz_exchange(user);
}

static int fuzz_gather(void* user, const void* records, int64_t count, size_t width,
  const void** all, int64_t* all_count)
{
  FUZZ_CHECK((records || count == 0) && count >= 0 && width > 0);
  *all = records;
  *all_count = count;
  return fuzz_exchange(user);
}

/* Checks that a single rank extracts the same as a run without ranks. The rank fails if there are no particles, and
 * is cancelled if its callback `failing` fails. */
static void fuzz_ranks(unsigned failing, const fuzz_call* call)
{
  mcor_context* context = fuzz_context(call, 1);
  fuzz_rank rank = { .failing = failing < 128 ? (int)failing : INT32_MAX };
  const mcor_ranks ranks = { .reduce_doubles = fuzz_reduce_doubles,
    .reduce_counts = fuzz_reduce_counts,
    .gather = fuzz_gather,
    .user = &rank };
  mcor_options options = call->options;
  mcor_globals globals;
  mcor_surface alone, surface;
  options.seeds = MCOR_COMPLETE;
  mcor_status expected = mcor_extract(context, &call->input, &options, &alone);
  expected = expected == MCOR_OK && call->input.count == 0 ? MCOR_INVALID_DATA : expected;
  options.ranks = &ranks;
  mcor_status status = mcor_measure_globals(context, &call->input, &options, &globals);
  if (status == MCOR_OK)
  {
    options.globals = &globals;
    status = mcor_extract(context, &call->input, &options, &surface);
    if (status == MCOR_OK)
    {
      fuzz_check_same(&surface, &alone);
    }
    mcor_free_surface(&surface);
  }
  const int failed = rank.calls > rank.failing;
  FUZZ_CHECK(status == (failed ? MCOR_CANCELLED : expected));
  FUZZ_CHECK(status == MCOR_OK || mcor_last_error(context)[0] != '\0');
  mcor_free_globals(&globals);
  mcor_free_surface(&alone);
}

static void fuzz_check_samples(const fuzz_call* call, const mcor_samples* s)
{
  FUZZ_CHECK(fuzz_finite(s->weight_sum, s->count, sizeof(double)));
  FUZZ_CHECK(fuzz_finite(s->weight_gradient, 3 * s->count, sizeof(double)));
  FUZZ_CHECK(s->attribute_count == call->input.attribute_count);
  for (int64_t i = 0; i < s->count; ++i)
  {
    FUZZ_CHECK(s->valid[i] <= 1);
    FUZZ_CHECK(!s->valid[i] || s->weight_sum[i] >= call->options.node_threshold);
  }
  for (int a = 0; a < s->attribute_count; ++a)
  {
    const int64_t values = s->count * (a ? 3 : 1);
    FUZZ_CHECK(!s->values[a] == (s->attribute_not_finite[a] >= 0));
    FUZZ_CHECK(fuzz_finite(s->values[a], values, sizeof(double)));
  }
}

/* Probes points, some at particles, some odd. Checks that a point alone has the same bits as among
 * others. */
static void fuzz_probe(fuzz_bytes* bytes, const fuzz_call* call)
{
  mcor_context* context = fuzz_context(call, 1);
  const size_t n = fuzz_byte(bytes) % (FUZZ_POINTS + 1);
  const double* particles = call->input.positions.data;
  double* at = malloc(3 * n * sizeof *at + (n == 0)); /* exactly */
  FUZZ_CHECK(at);
  for (size_t i = 0; i < 3 * n; ++i)
  {
    const unsigned b = fuzz_byte(bytes);
    const size_t from = 3 * (b % (size_t)(call->input.count + 1)) + i % 3;
    at[i] = call->input.count > 0 && b < 200 && b % (size_t)(call->input.count + 1) > 0
      ? particles[from - 3]
      : fuzz_side(bytes);
  }
  mcor_array points = { .data = at, .type = MCOR_FLOAT64, .components = 3 };
  mcor_samples all, one;
  const mcor_status status =
    mcor_probe(context, &call->input, &call->options, &points, (int64_t)n, &all);
  if (status != MCOR_OK)
  {
    fuzz_check_failure(context, status);
    FUZZ_CHECK(!all.weight_sum && all.count == 0);
    free(at);
    return;
  }
  FUZZ_CHECK(all.count == (int64_t)n);
  fuzz_check_samples(call, &all);
  if (n > 0)
  {
    points.data = at + 3 * (n - 1);
    FUZZ_CHECK(mcor_probe(context, &call->input, &call->options, &points, 1, &one) == MCOR_OK);
    fuzz_check_bits(one.weight_sum, all.weight_sum + n - 1, sizeof(double));
    fuzz_check_bits(one.valid, all.valid + n - 1, 1);
    mcor_free_samples(&one);
  }
  mcor_free_samples(&all);
  free(at);
}

static void fuzz_derive(fuzz_bytes* bytes, const fuzz_call* call)
{
  mcor_context* context = fuzz_context(call, 1);
  mcor_derivatives d;
  const mcor_gradient form = (mcor_gradient)(fuzz_byte(bytes) % 3);
  const mcor_status status = mcor_derive(context, &call->input, &call->options, form, &d);
  FUZZ_CHECK(status != MCOR_OK || (unsigned)form <= MCOR_GRADIENT_STANDARD);
  if (status != MCOR_OK)
  {
    fuzz_check_failure(context, status);
    FUZZ_CHECK(!d.gradients && d.count == 0);
    return;
  }
  FUZZ_CHECK(d.count == call->input.count);
  for (int a = 0; a < d.attribute_count; ++a)
  {
    const int64_t values = 3 * d.count * (a ? 3 : 1);
    FUZZ_CHECK(!d.gradients[a] == (d.attribute_not_finite[a] >= 0));
    for (int64_t i = 0; d.gradients[a] && i < values; ++i)
    {
      FUZZ_CHECK(!isnan(d.gradients[a][i]));
    }
  }
  if (d.attribute_count > 1 && d.gradients[1])
  {
    double* q = malloc(((size_t)d.count + 1) * sizeof *q);
    const mcor_flow flow = { .q_criterion = q };
    FUZZ_CHECK(q && mcor_decompose_gradients(d.gradients[1], d.count, &flow) == MCOR_OK);
    free(q);
  }
  mcor_free_derivatives(&d);
}

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

void fuzz_other_calls(unsigned modules, fuzz_bytes* bytes, fuzz_call* call)
{
  call->input.particles_version = call->input.scalar_version = 0;
  if (modules >> 3 & 1)
  {
    fuzz_globals(call);
    fuzz_halves(call);
  }
  if (modules >> 4 & 1)
  {
    fuzz_probe(bytes, call);
  }
  if (modules >> 5 & 1)
  {
    fuzz_derive(bytes, call);
  }
  if (modules >> 7 & 1)
  {
    fuzz_ranks(fuzz_byte(bytes), call);
  }
}
