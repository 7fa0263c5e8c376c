/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sums over each particle's neighbours for particles that lack what the method begins with: smoothing lengths by
 * neighbours, and densities from masses. On the host, in double precision, with neighbours from a tree of boxes
 * over particles along a Morton curve, as smoothing lengths are not known, or vary by any factor. The order of
 * every sum is that along the curve, so that it depends neither on the order of the input nor on threads. */

#define MCOR_W_ON_HOST
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_plane.h"
#include "mcor_sph_kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_LEAF 16       /* particles */
#define MCOR_CURVE_BITS 21 /* of a key along each axis */
#define MCOR_LENGTH_STEPS 60

typedef struct mcor_neighbour
{
  uint64_t key;
  double x[3], mass;
  int64_t source;
} mcor_neighbour;

typedef struct mcor_neighbour_job
{
  const mcor_input* input;
  mcor_sph_kernel kernel;
  int dimension, leaves; /* leaves: a power of 2 */
  double period[3];      /* 0: open */
  double extent;         /* the greatest, of a period, too */
  double norm, eta;      /* eta: to the power of the dimension */
  int64_t count,
    wanted; /* particles that are present; as many of the input, the first ones, are asked for */
  mcor_neighbour* sorted; /* [count] */
  double (
    *box)[6];  /* [2 * leaves]: low and high of x, y, z; of node n the children are 2 n, 2 n + 1 */
  double* out; /* [wanted], in input order */
  bool failed[MCOR_SLICES];
} mcor_neighbour_job;

double mcor_w_of(mcor_sph_kernel kernel, double q)
{
#define MCOR_ENTRY(enumerator, name, support, norm, is_tensor, variance, plane)                    \
  case enumerator:                                                                                 \
    return mcor_w_##name(q);
  switch (kernel)
  {
    MCOR_SPH_KERNEL_TABLE(MCOR_ENTRY)
    default:
      return 0;
  }
#undef MCOR_ENTRY
}

/* ---- the tree ---- */

static uint64_t mcor_spread_bits(uint64_t x)
{
  x = (x | x << 32) & 0x1f00000000ffffu;
  x = (x | x << 16) & 0x1f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  return (x | x << 2) & 0x1249249249249249u;
}

/* Particles at one place are interchangeable but for their masses. */
static int mcor_compare_neighbours(const void* a, const void* b)
{
  const mcor_neighbour *p = a, *q = b;
  if (p->key != q->key)
  {
    return p->key < q->key ? -1 : 1;
  }
  for (int i = 0; i < 3; ++i)
  {
    if (p->x[i] != q->x[i])
    {
      return p->x[i] < q->x[i] ? -1 : 1;
    }
  }
  return (p->mass > q->mass) - (p->mass < q->mass);
}

static void mcor_sort_neighbours(mcor_neighbour_job* job)
{
  double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
  for (int64_t i = 0; i < job->count; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      low[a] = fmin(low[a], job->sorted[i].x[a]);
      high[a] = fmax(high[a], job->sorted[i].x[a]);
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    job->extent = fmax(job->extent, fmax(high[a] - low[a], job->period[a]));
  }
  const double scale = job->extent > 0 ? ((1 << MCOR_CURVE_BITS) - 1) / job->extent : 0;
  for (int64_t i = 0; i < job->count; ++i)
  {
    mcor_neighbour* p = &job->sorted[i];
    p->key = 0;
    for (int a = 0; a < 3; ++a)
    {
      p->key |= mcor_spread_bits((uint64_t)((p->x[a] - low[a]) * scale)) << a;
    }
  }
  qsort(job->sorted, (size_t)job->count, sizeof *job->sorted, mcor_compare_neighbours);
}

static void mcor_make_boxes(mcor_neighbour_job* job)
{
  for (int n = 2 * job->leaves - 1; n > 0; --n)
  {
    double* box = job->box[n];
    for (int a = 0; a < 6; ++a)
    {
      box[a] = a < 3 ? INFINITY : -INFINITY;
    }
    const int64_t first = (int64_t)(n - job->leaves) * MCOR_LEAF;
    for (int64_t i = first; n >= job->leaves && i < first + MCOR_LEAF && i < job->count; ++i)
    {
      for (int a = 0; a < 3; ++a)
      {
        box[a] = fmin(box[a], job->sorted[i].x[a]);
        box[a + 3] = fmax(box[a + 3], job->sorted[i].x[a]);
      }
    }
    for (int child = 2 * n; n < job->leaves && child <= 2 * n + 1; ++child)
    {
      for (int a = 0; a < 3; ++a)
      {
        box[a] = fmin(box[a], job->box[child][a]);
        box[a + 3] = fmax(box[a + 3], job->box[child][a + 3]);
      }
    }
  }
}

/* ---- neighbours of one particle ---- */

/* Distances and masses; it grows. */
typedef struct mcor_neighbour_list
{
  int64_t count, room;
  double (*at)[2];
} mcor_neighbour_list;

static bool mcor_add_neighbour(mcor_neighbour_list* list, double distance, double mass)
{
  if (list->count == list->room)
  {
    const int64_t room = list->room > 0 ? 2 * list->room : 1024;
    void* more = realloc(list->at, (size_t)room * sizeof *list->at);
    if (!more)
    {
      return false;
    }
    list->at = more;
    list->room = room;
  }
  list->at[list->count][0] = distance;
  list->at[list->count++][1] = mass;
  return true;
}

/* Lists the particles within `radius` of a place. */
static bool mcor_list_around(
  const mcor_neighbour_job* job, const double x[3], double radius, mcor_neighbour_list* list)
{
  int stack[128], top = 0;
  bool enough = true;
  for (stack[top++] = 1; top > 0 && enough;)
  {
    const int n = stack[--top];
    double apart = 0;
    for (int a = 0; a < 3; ++a)
    {
      const double d = fmax(fmax(job->box[n][a] - x[a], x[a] - job->box[n][a + 3]), 0);
      apart += d * d;
    }
    if (!(apart <= radius * radius))
    {
      continue;
    }
    if (n < job->leaves)
    {
      stack[top++] = 2 * n + 1;
      stack[top++] = 2 * n;
      continue;
    }
    const int64_t first = (int64_t)(n - job->leaves) * MCOR_LEAF;
    for (int64_t i = first; i < first + MCOR_LEAF && i < job->count && enough; ++i)
    {
      const double* y = job->sorted[i].x;
      const double d[3] = { x[0] - y[0], x[1] - y[1], x[2] - y[2] };
      const double r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      enough = !(r2 < radius * radius) || mcor_add_neighbour(list, sqrt(r2), job->sorted[i].mass);
    }
  }
  return enough;
}

/* And of its images whole periods away. */
static bool mcor_list_neighbours(
  const mcor_neighbour_job* job, const double x[3], double radius, mcor_neighbour_list* list)
{
  int most[3];
  bool enough = true;
  list->count = 0;
  for (int a = 0; a < 3; ++a)
  {
    /* Positions may be anywhere: as far apart as all are. */
    most[a] = job->period[a] > 0 ? (int)((radius + job->extent) / job->period[a]) + 1 : 0;
  }
  for (int i = -most[0]; i <= most[0]; ++i)
  {
    for (int j = -most[1]; j <= most[1]; ++j)
    {
      for (int k = -most[2]; k <= most[2] && enough; ++k)
      {
        const double at[3] = { x[0] + i * job->period[0], x[1] + j * job->period[1],
          x[2] + k * job->period[2] };
        enough = mcor_list_around(job, at, radius, list);
      }
    }
  }
  return enough;
}

/* sum_j W h^d, or with masses. */
static double mcor_sum_list(
  const mcor_neighbour_job* job, const mcor_neighbour_list* list, double h, bool masses)
{
  double sum = 0;
  for (int64_t i = 0; i < list->count; ++i)
  {
    sum += (masses ? list->at[i][1] : 1) * mcor_w_of(job->kernel, list->at[i][0] / h);
  }
  return job->norm * sum;
}

/* ---- smoothing lengths ---- */

/* Lengths that every search begins with, whatever it begins from: quarter powers of 2. */
static double mcor_length_rung(int rung)
{
  static const double quarters[4] = { 1, 1.189207115002721, 1.4142135623730951, 1.681792830507429 };
  const int quarter = (rung % 4 + 4) % 4;
  return ldexp(quarters[quarter], (rung - quarter) / 4);
}

/* The smoothing length at a place: between two rungs, then by false position, halved where that does not
 * help. -1: memory ran out. */
static double mcor_solve_length(
  const mcor_neighbour_job* job, const double x[3], double guess, mcor_neighbour_list* list)
{
  const double support = mcor_support_factor(job->kernel), limit = job->extent;
  int rung = 4 * ilogb(guess) + 2;
  double high = fmin(mcor_length_rung(rung), limit);
  while (true)
  {
    if (!mcor_list_neighbours(job, x, support * high, list))
    {
      return -1;
    }
    if (high >= limit || mcor_sum_list(job, list, high, false) >= job->eta)
    {
      break;
    }
    high = fmin(mcor_length_rung(++rung), limit);
  }
  double low = mcor_length_rung(rung - 1), above = mcor_sum_list(job, list, high, false) - job->eta;
  double below = mcor_sum_list(job, list, low, false) - job->eta;
  while (below >= 0 && low > 1e-7 * limit)
  {
    high = low;
    above = below;
    low = mcor_length_rung(--rung - 1);
    below = mcor_sum_list(job, list, low, false) - job->eta;
  }
  if (above <= 0 || below >= 0) /* all that there is does not suffice; so many are at one place */
  {
    return above <= 0 ? high : low;
  }
  for (int step = 1, last = 0; step < MCOR_LENGTH_STEPS && high - low > 1e-7 * low; ++step)
  {
    const double share = step % 4 == 0 ? 0.5 : below / (below - above);
    const double h = low + (high - low) * share,
                 sum = mcor_sum_list(job, list, h, false) - job->eta;
    if (fabs(sum) < 1e-9 * job->eta)
    {
      return h;
    }
    if (sum < 0)
    {
      low = h;
      below = sum;
      above *= last < 0 ? 0.5 : 1;
      last = -1;
    }
    else
    {
      high = h;
      above = sum;
      below *= last > 0 ? 0.5 : 1;
      last = 1;
    }
  }
  return 0.5 * (low + high);
}

static void mcor_solve_lengths(void* data, int slice, int64_t first, int64_t last)
{
  mcor_neighbour_job* job = data;
  mcor_neighbour_list list = { 0 };
  for (int64_t i = first; i < last && !job->failed[slice]; ++i)
  {
    if (job->sorted[i].source >= job->wanted)
    {
      continue;
    }
    const double* box = job->box[job->leaves + i / MCOR_LEAF];
    const double size = fmax(fmax(box[3] - box[0], box[4] - box[1]), box[5] - box[2]);
    const double guess = size > 1e-6 * job->extent ? 0.5 * size : 1e-3 * job->extent;
    const double h = mcor_solve_length(job, job->sorted[i].x, guess, &list);
    job->failed[slice] = h < 0;
    job->out[job->sorted[i].source] = h;
  }
  free(list.at);
}

/* ---- densities ---- */

static void mcor_sum_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_neighbour_job* job = data;
  mcor_neighbour_list list = { 0 };
  const mcor_input* input = job->input;
  const double support = mcor_support_factor(job->kernel);
  const double scale = input->smoothing_length_is_support_radius ? 1 / support : 1;
  for (int64_t i = first; i < last && !job->failed[slice]; ++i)
  {
    const int64_t source = job->sorted[i].source;
    if (source >= job->wanted)
    {
      continue;
    }
    const double h = mcor_array_at(&input->smoothing_length, source, 0) * scale;
    job->failed[slice] = !mcor_list_neighbours(job, job->sorted[i].x, support * h, &list);
    job->out[source] =
      mcor_sum_list(job, &list, h, true) / (job->dimension == 2 ? h * h : h * h * h);
  }
  free(list.at);
}

/* ---- both ---- */

static mcor_status mcor_load_neighbours(
  mcor_context* context, const mcor_options* options, mcor_neighbour_job* job)
{
  const mcor_input* input = job->input;
  const bool plane = mcor_find_dimension(input, NULL, options->dimension) == 2;
  job->dimension = plane ? 2 : 3;
  job->norm = mcor_kernel_norm(job->kernel) * (plane ? mcor_plane_factor(job->kernel) : 1);
  for (int a = 0; a < 3; ++a)
  {
    const double length = options->periodic[2 * a + 1] - options->periodic[2 * a];
    job->period[a] = length > 0 ? length : 0;
  }
  for (job->leaves = 1; job->leaves < (input->count + MCOR_LEAF - 1) / MCOR_LEAF; job->leaves *= 2)
  {
  }
  job->sorted = malloc((size_t)input->count * sizeof *job->sorted);
  job->box = malloc(2 * (size_t)job->leaves * sizeof *job->box);
  MCOR_TRY(mcor_allocated(context, job->sorted && job->box));
  for (int64_t i = 0; i < input->count; ++i)
  {
    if (!mcor_is_present(input, i))
    {
      if (i < job->wanted)
      {
        job->out[i] = 0;
      }
      continue;
    }
    mcor_neighbour* p = &job->sorted[job->count++];
    *p = (mcor_neighbour){ .source = i,
      .mass = mcor_is_given(&input->mass) ? mcor_array_at(&input->mass, i, 0) : 1 };
    for (int a = 0; a < 3; ++a)
    {
      mcor_array positions = input->positions;
      positions.components = 3;
      p->x[a] = mcor_array_at(&positions, i, a);
    }
  }
  mcor_sort_neighbours(job);
  mcor_make_boxes(job);
  return MCOR_OK;
}

static mcor_status mcor_run_neighbours(
  mcor_context* context, const mcor_options* options, mcor_neighbour_job* job, mcor_slice_body body)
{
  mcor_status status = mcor_load_neighbours(context, options, job);
  if (status == MCOR_OK && job->count > 0 && body == mcor_solve_lengths && !(job->extent > 0))
  {
    status = mcor_fail(context, MCOR_INVALID_DATA,
      "All particles are at one place, so that neighbours tell no smoothing length. Give one "
      "value.");
  }
  int slices = 0;
  status =
    status == MCOR_OK ? mcor_parallel_run(NULL, job->count, 256, body, job, &slices) : status;
  for (int s = 0; s < slices && status == MCOR_OK; ++s)
  {
    status = mcor_allocated(context, !job->failed[s]);
  }
  free(job->sorted);
  free(job->box);
  return status;
}

static mcor_skip mcor_skip_of(const mcor_input* input)
{
  return input->ignore_solids ? MCOR_SKIP_SOLIDS : MCOR_SKIP_ABSENT;
}

/* Positions, and whatever else must be above 0. */
static mcor_status mcor_check_neighbours(
  mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  MCOR_RETURN_IF(
    (unsigned)options->sph_kernel >= MCOR_SPH_KERNEL_COUNT || options->sph_kernel == MCOR_M_PRIME_4,
    context, MCOR_INVALID_ARGUMENT,
    "Neighbours are not counted with kernel %s. Choose another kernel.",
    mcor_sph_kernel_name(options->sph_kernel) ? mcor_sph_kernel_name(options->sph_kernel) : "?");
  MCOR_RETURN_IF(input->count < 0 || (input->count > 0 && !input->positions.data), context,
    MCOR_INVALID_ARGUMENT, "There are no particle positions.");
  mcor_array positions = input->positions;
  positions.components = 3;
  int c = 0;
  const int64_t i =
    mcor_find_illegal(NULL, &positions, input->solid, mcor_skip_of(input), input->count, false, &c);
  MCOR_RETURN_IF(i >= 0, context, MCOR_INVALID_DATA,
    "The position of particle %lld is not finite. Remove such particles.", (long long)i);
  return MCOR_OK;
}

static mcor_status mcor_begin_lengths(mcor_context* context, const mcor_input* input,
  const mcor_options* options, double eta, int64_t count, double* lengths)
{
  MCOR_TRY(mcor_check_neighbours(context, input, options));
  mcor_neighbour_job job = {
    .input = input, .kernel = options->sph_kernel, .wanted = count, .out = lengths
  };
  const bool plane = mcor_find_dimension(input, NULL, options->dimension) == 2;
  job.eta = plane ? eta * eta : eta * eta * eta;
  const double own = mcor_kernel_norm(job.kernel) * mcor_w_of(job.kernel, 0) *
    (plane ? mcor_plane_factor(job.kernel) : 1);
  MCOR_RETURN_IF(!(isfinite(job.eta) && eta > 0 && job.eta > own), context, MCOR_INVALID_ARGUMENT,
    "ETA is %g; it must be above %.3g, which a particle without neighbours has. Usual is %g.", eta,
    pow(own, plane ? 0.5 : 1.0 / 3), MCOR_USUAL_ETA);
  return input->count > 0 ? mcor_run_neighbours(context, options, &job, mcor_solve_lengths)
                          : MCOR_OK;
}

static mcor_status mcor_begin_densities(mcor_context* context, const mcor_input* input,
  const mcor_options* options, int64_t count, double* densities)
{
  MCOR_TRY(mcor_check_neighbours(context, input, options));
  const mcor_array* arrays[] = { &input->mass, &input->smoothing_length };
  const char* const names[] = { "mass", "smoothing length" };
  for (int k = 0; k < 2; ++k)
  {
    int c = 0;
    MCOR_RETURN_IF(!mcor_is_given(arrays[k]), context, MCOR_INVALID_ARGUMENT,
      "There is no %s, from which densities are summed. Name its array, or give one value.",
      names[k]);
    const int64_t i = mcor_find_illegal(
      NULL, arrays[k], input->solid, mcor_skip_of(input), k == 0 ? input->count : count, true, &c);
    MCOR_RETURN_IF(i >= 0, context, MCOR_INVALID_DATA,
      "The %s of particle %lld is not a number above 0. Remove such particles.", names[k],
      (long long)i);
  }
  mcor_neighbour_job job = {
    .input = input, .kernel = options->sph_kernel, .wanted = count, .out = densities
  };
  return input->count > 0 ? mcor_run_neighbours(context, options, &job, mcor_sum_slice) : MCOR_OK;
}

/* A context that opens no device: it has the sentence. */
static mcor_status mcor_tell_why(mcor_context* context, mcor_status status, char** why)
{
  *why = status == MCOR_OK ? NULL : malloc(sizeof context->error);
  if (*why)
  {
    memcpy(*why, context->error, sizeof context->error);
  }
  free(context);
  return status;
}

mcor_status mcor_find_smoothing_lengths(const mcor_input* input, const mcor_options* options,
  double eta, int64_t count, double* lengths, char** why)
{
  mcor_context* context = calloc(1, sizeof *context);
  *why = NULL;
  return context
    ? mcor_tell_why(context, mcor_begin_lengths(context, input, options, eta, count, lengths), why)
    : MCOR_OUT_OF_CAPACITY;
}

mcor_status mcor_sum_densities(const mcor_input* input, const mcor_options* options, int64_t count,
  double* densities, char** why)
{
  mcor_context* context = calloc(1, sizeof *context);
  *why = NULL;
  return context
    ? mcor_tell_why(context, mcor_begin_densities(context, input, options, count, densities), why)
    : MCOR_OUT_OF_CAPACITY;
}
