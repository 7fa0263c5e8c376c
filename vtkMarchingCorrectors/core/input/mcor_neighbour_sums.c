/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sums over each particle's neighbours. They give smoothing lengths and densities that the input
 * lacks. The sums are made on the host, in double precision. A tree of boxes over particles along a
 * Morton curve finds neighbours, because smoothing lengths are unknown, or vary by any factor. Each
 * sum adds particles in the order of the curve, so it does not depend on the order of the input or
 * on threads. The curve covers the particles of all ranks. So a rank finds the same bits as one
 * process if it has all particles that its sums reach. */

#define MCOR_W_ON_HOST
#include "mcor_input.h"
#include "mcor_plane.h"
#include "mcor_sph_kernel.h"
#include "mcor_vector.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_LEAF 8 /* particles of a leaf of the tree */
#define MCOR_LENGTH_STEPS 60
#define MCOR_LENGTH_ERROR 1e-7 /* relative error of a length; least length / extent */
/* The curve covers the bounds of the particles, but ends along each axis at most this many widths
 * beyond the middle half of the particles. A width is the length of the middle half along the axis
 * where it is longest. Without this limit, one far particle would leave the others no digits. */
#define MCOR_MOST_WIDTHS 1000.0

typedef struct mcor_neighbour
{
  double x[3], mass;
  uint64_t place[3]; /* place along the curve: 62 bits of the extent, at its end if outside */
  int64_t source;
} mcor_neighbour;

typedef struct mcor_neighbour_job
{
  const mcor_input* input;
  const mcor_options* options;
  double eta; /* eta to the power of the dimension; 0: densities are summed */
  int axes;
  double norm, support;
  double period[3];       /* 0: open */
  double extent;          /* the greatest length of the cut bounds or of a period */
  int64_t count, wanted;  /* particles present; the first `wanted` of the input get results */
  int64_t leaves;         /* leaves of the tree, a power of 2 */
  mcor_neighbour* sorted; /* [count] */
  double (*box)[6]; /* [2 * leaves]: low and high of x, y, z; node n has children 2 n, 2 n + 1 */
  double* out;      /* [wanted], in input order */
  bool failed[MCOR_SLICES];
} mcor_neighbour_job;

double mcor_w_of(mcor_sph_kernel kernel, double q)
{
#define MCOR_ENTRY(enumerator, name, ...)                                                          \
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

/* ---- The tree ---- */

/* Compares two places on the Morton curve, by the coordinate that differs in the highest bit. */
static int mcor_compare_places(const uint64_t p[3], const uint64_t q[3])
{
  uint64_t most = 0;
  int axis = 0;
  for (int i = 0; i < 3; ++i)
  {
    const uint64_t differs = p[i] ^ q[i];
    if (most < differs && most < (most ^ differs))
    {
      most = differs;
      axis = i;
    }
  }
  return most == 0 ? 0 : p[axis] < q[axis] ? -1 : 1;
}

/* Compares particles along the Morton curve. Different particles may have the same place on the
 * curve, such as all particles beyond a corner of the extent. Such particles are compared along a
 * finer Morton curve, of all 64 bits of the coordinates. Particles with the same coordinates are
 * compared by the bytes of their masses, so that the input's order does not matter. */
static int mcor_compare_neighbours(const void* a, const void* b)
{
  const mcor_neighbour *p = a, *q = b;
  uint64_t bits[2][3];
  int order = mcor_compare_places(p->place, q->place);
  for (int i = 0; i < 6 && order == 0; ++i)
  {
    uint64_t* to = &bits[i / 3][i % 3];
    memcpy(to, (i < 3 ? p : q)->x + i % 3, sizeof *to);
    *to = *to >> 63 ? ~*to : *to | UINT64_C(1) << 63;
  }
  order = order == 0 ? mcor_compare_places(bits[0], bits[1]) : order;
  return order == 0 ? memcmp(p, q, offsetof(mcor_neighbour, place)) : order;
}

/* Adds a position to the samples unless they have it: two ranks may have the same particle. */
static void mcor_add_place(mcor_sample_list* samples, const mcor_sample* place)
{
  bool is_new =
    samples->count < samples->most || place->hash < samples->of[samples->most - 1].hash;
  for (int i = 0; i < samples->count && is_new; ++i)
  {
    is_new = samples->of[i].hash != place->hash;
  }
  if (is_new)
  {
    mcor_add_sample(samples, place);
  }
}

/* Measures the bounds of all ranks' particles along x, y, z. The bounds end at most
 * MCOR_MOST_WIDTHS widths beyond the middle half of the sampled particles. A width is the greatest
 * length of the middle half along an axis. Also sets job->extent. */
static mcor_status mcor_measure_extent(
  mcor_context* context, mcor_neighbour_job* job, mcor_findings* bounds)
{
  mcor_sample_list samples = { .most = MCOR_SAMPLES };
  *bounds = mcor_no_findings();
  for (int64_t i = 0; i < job->count; ++i)
  {
    const double* x = job->sorted[i].x;
    const mcor_sample place = { .hash = mcor_hash_position(x), .x = { x[0], x[1], x[2] } };
    mcor_add_place(&samples, &place);
    for (int a = 0; a < 3; ++a)
    {
      mcor_add_range(bounds, a, x[a], x[a]);
    }
  }
  const void* all = NULL;
  int64_t count = 0;
  MCOR_TRY(mcor_reduce_findings(context, bounds));
  MCOR_TRY(
    mcor_gather_records(context, samples.of, samples.count, sizeof *samples.of, &all, &count));
  for (int64_t i = 0; i < count; ++i)
  {
    mcor_add_place(&samples, (const mcor_sample*)all + i);
  }
  const int n = samples.count;
  double width = 0, quarter[3][2], values[MCOR_SAMPLES];
  for (int a = 0; a < 3 && n > 0; ++a)
  {
    for (int s = 0; s < n; ++s)
    {
      values[s] = samples.of[s].x[a];
    }
    qsort(values, (size_t)n, sizeof *values, mcor_compare_doubles);
    quarter[a][0] = values[n / 4];
    quarter[a][1] = values[n - 1 - n / 4];
    width = fmax(width, quarter[a][1] - quarter[a][0]);
  }
  const double most = width > 0 ? MCOR_MOST_WIDTHS * width : INFINITY;
  for (int a = 0; a < 3 && n > 0; ++a)
  {
    double *low = &bounds->least[a], *high = &bounds->most[a];
    *low = fmax(*low, quarter[a][0] - most);
    *high = fmin(*high, quarter[a][1] + most);
    job->extent = fmax(job->extent, fmax(*high - *low, job->period[a]));
  }
  return MCOR_OK;
}

static void mcor_make_boxes(mcor_neighbour_job* job)
{
  for (int64_t n = 2 * job->leaves - 1; n > 0; --n)
  {
    double* box = job->box[n];
    const int64_t first = (n - job->leaves) * MCOR_LEAF;
    for (int a = 0; a < 3; ++a)
    {
      box[a] = INFINITY;
      box[a + 3] = -INFINITY;
      for (int64_t i = first; n >= job->leaves && i < first + MCOR_LEAF && i < job->count; ++i)
      {
        box[a] = fmin(box[a], job->sorted[i].x[a]);
        box[a + 3] = fmax(box[a + 3], job->sorted[i].x[a]);
      }
      for (int64_t child = 2 * n; n < job->leaves && child <= 2 * n + 1; ++child)
      {
        box[a] = fmin(box[a], job->box[child][a]);
        box[a + 3] = fmax(box[a + 3], job->box[child][a + 3]);
      }
    }
  }
}

/* ---- Neighbours of one particle ---- */

typedef struct mcor_near
{
  double square, mass; /* square of the distance */
} mcor_near;

typedef struct mcor_neighbour_list
{
  double h; /* the list holds at least the support of this length; 0: it is empty */
  MCOR_LIST(mcor_near) near;
  bool failed;
} mcor_neighbour_list;

/* Adds to `list` the particles of node n of the tree that are within `radius` of a place. */
static void mcor_list_around(const mcor_neighbour_job* job, int64_t n, const double x[3],
  double radius, mcor_neighbour_list* list)
{
  const double* box = job->box[n];
  double apart = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double d = fmax(fmax(box[a] - x[a], x[a] - box[a + 3]), 0);
    apart += d * d;
  }
  if (!(apart < radius * radius))
  {
    return;
  }
  if (n < job->leaves)
  {
    mcor_list_around(job, 2 * n, x, radius, list);
    mcor_list_around(job, 2 * n + 1, x, radius, list);
    return;
  }
  const int64_t first = (n - job->leaves) * MCOR_LEAF;
  list->failed = list->failed ||
    mcor_make_room(NULL, (void**)&list->near.of, list->near.count + MCOR_LEAF, &list->near.room,
      sizeof *list->near.of) != MCOR_OK;
  for (int64_t i = first; i < first + MCOR_LEAF && i < job->count && !list->failed; ++i)
  {
    double d[3];
    mcor_subtract(x, job->sorted[i].x, d);
    const mcor_near near = { mcor_dot(d, d), job->sorted[i].mass };
    list->near.of[list->near.count] = near;
    list->near.count += near.square < radius * radius;
  }
}

/* Lists the neighbours of x: the particles, and periodic images of particles, that are nearer to x
 * than the support radius for the smoothing length h. */
static void mcor_list_neighbours(
  const mcor_neighbour_job* job, const double x[3], double h, mcor_neighbour_list* list)
{
  int most[3];
  int64_t images = 1;
  list->near.count = 0;
  list->h = h;
  for (int a = 0; a < 3; ++a)
  {
    most[a] = job->period[a] > 0 ? (int)(job->support * h / job->period[a]) + 1 : 0;
    images *= 2 * most[a] + 1;
  }
  for (int64_t image = 0; image < images; ++image)
  {
    double at[3];
    int64_t rest = image;
    for (int a = 2; a >= 0; --a)
    {
      const int along = 2 * most[a] + 1;
      at[a] = x[a] + (double)(rest % along - most[a]) * job->period[a];
      rest /= along;
    }
    mcor_list_around(job, 1, at, job->support * h, list);
  }
}

/* Returns sum_j W h^d or, for densities, sum_j m_j W h^d. d: the dimension. Finds the neighbours
 * anew if `list` was made for a shorter length, or for a much longer one. */
static double mcor_sum_at(
  const mcor_neighbour_job* job, const double x[3], double h, mcor_neighbour_list* list)
{
  double sum = 0;
  if (h > list->h || h < 0.6 * list->h)
  {
    mcor_list_neighbours(job, x, h, list);
  }
  for (int64_t i = 0; i < list->near.count && !list->failed; ++i)
  {
    const mcor_near* near = &list->near.of[i];
    sum +=
      (job->eta > 0 ? 1 : near->mass) * mcor_w_of(job->options->sph_kernel, sqrt(near->square) / h);
  }
  return job->norm * sum;
}

/* The search for smoothing lengths begins with lengths of 4, 5, 6 or 7 times a power of 2. Returns
 * the length that comes `further` places after the greatest one not above h. */
static double mcor_length_step(double h, int further)
{
  int exponent;
  const int eighths = (int)(8 * frexp(h, &exponent)), number = 4 * exponent + eighths + further;
  const int quarter = (number % 4 + 4) % 4;
  return ldexp(4 + quarter, (number - quarter) / 4 - 4);
}

/* Returns the smoothing length h of sorted particle i, for which sum_j W h^d is job->eta. First
 * finds two successive lengths of mcor_length_step with h between them, then uses false position
 * with some bisection. Neither these lengths nor the result depend on the first guess. */
static double mcor_solve_length(const mcor_neighbour_job* job, int64_t i, mcor_neighbour_list* list)
{
  const double* x = job->sorted[i].x;
  const double least = MCOR_LENGTH_ERROR * job->extent;
  /* The first guess is the smaller of the distances to the particles four places before and four
   * places behind this one along the curve. The guess may be too long, because the curve jumps. */
  double guess = job->extent;
  for (int64_t k = i - 4; k <= i + 4; k += 8)
  {
    double d[3];
    mcor_subtract(x, job->sorted[k < 0 || k >= job->count ? i : k].x, d);
    const double r = sqrt(mcor_dot(d, d));
    guess = r > 0 ? fmin(guess, r) : guess;
  }
  double high = mcor_length_step(fmax(guess, least), 0), low = high;
  double above = mcor_sum_at(job, x, high, list) - job->eta, below = above;
  while (above < 0 && high < job->extent)
  {
    low = high;
    below = above;
    high = fmin(mcor_length_step(high, 1), job->extent);
    above = mcor_sum_at(job, x, high, list) - job->eta;
  }
  while (below >= 0 && low > least)
  {
    high = low;
    above = below;
    low = mcor_length_step(low, -1);
    below = mcor_sum_at(job, x, low, list) - job->eta;
  }
  if (above <= 0 || below >= 0)
  {
    /* The longest length does not suffice, or too many particles are at one place. */
    return above <= 0 ? high : low;
  }
  for (int step = 1, last = 0; step < MCOR_LENGTH_STEPS && high - low > MCOR_LENGTH_ERROR * low;
       ++step)
  {
    const double share = step % 4 == 0 ? 0.5 : below / (below - above);
    const double h = low + (high - low) * share, sum = mcor_sum_at(job, x, h, list) - job->eta;
    if (fabs(sum) < 1e-9 * job->eta)
    {
      return h;
    }
    const int side = sum < 0 ? -1 : 1;
    *(sum < 0 ? &low : &high) = h;
    *(sum < 0 ? &below : &above) = sum;
    *(sum < 0 ? &above : &below) *= side == last ? 0.5 : 1;
    last = side;
  }
  return 0.5 * (low + high);
}

/* ---- All particles ---- */

static void mcor_sum_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_neighbour_job* job = data;
  mcor_neighbour_list list = { 0 };
  const double scale = job->input->smoothing_length_is_support_radius ? 1 / job->support : 1;
  for (int64_t i = first; i < last && !list.failed; ++i)
  {
    const int64_t source = job->sorted[i].source;
    list.h = 0;
    if (source < job->wanted && job->eta > 0)
    {
      job->out[source] = mcor_solve_length(job, i, &list);
    }
    else if (source < job->wanted)
    {
      const double h = mcor_array_at(&job->input->smoothing_length, source, 0) * scale;
      job->out[source] = mcor_sum_at(job, job->sorted[i].x, h, &list) / mcor_power(h, job->axes);
    }
  }
  job->failed[slice] = list.failed;
  free(list.near.of);
}

/* Makes the tree of all particles but absent ones and ignored solids, wrapped into the period. */
static mcor_status mcor_load_neighbours(mcor_context* context, mcor_neighbour_job* job)
{
  const mcor_input* input = job->input;
  const mcor_array positions = mcor_positions_of(input);
  for (job->leaves = 1; job->leaves * MCOR_LEAF < input->count; job->leaves *= 2)
  {
  }
  for (int a = 0; a < 3; ++a)
  {
    job->period[a] = fmax(job->options->periodic[2 * a + 1] - job->options->periodic[2 * a], 0);
  }
  job->sorted = malloc((size_t)input->count * sizeof *job->sorted + 1);
  job->box = malloc(2 * (size_t)job->leaves * sizeof *job->box);
  MCOR_TRY(mcor_allocated(context, job->sorted && job->box));
  for (int64_t i = 0; i < job->wanted; ++i)
  {
    job->out[i] = 0;
  }
  for (int64_t i = 0; i < input->count; ++i)
  {
    if (!mcor_is_present(input, i))
    {
      continue;
    }
    mcor_neighbour* p = &job->sorted[job->count++];
    *p = (mcor_neighbour){ .source = i,
      .mass = mcor_is_given(&input->mass) ? mcor_array_at(&input->mass, i, 0) : 1 };
    for (int a = 0; a < 3; ++a)
    {
      const double length = job->period[a], first = job->options->periodic[2 * a];
      p->x[a] = mcor_array_at(&positions, i, a);
      p->x[a] -= length > 0 ? floor((p->x[a] - first) / length) * length : 0;
    }
  }
  mcor_findings bounds;
  MCOR_TRY(mcor_measure_extent(context, job, &bounds));
  const double scale = job->extent > 0 ? ldexp(1, 62) / job->extent : 0;
  for (int64_t i = 0; i < 3 * job->count; ++i)
  {
    mcor_neighbour* p = &job->sorted[i / 3];
    const double low = bounds.least[i % 3], high = bounds.most[i % 3];
    p->place[i % 3] = (uint64_t)((fmin(fmax(p->x[i % 3], low), high) - low) * scale);
  }
  qsort(job->sorted, (size_t)job->count, sizeof *job->sorted, mcor_compare_neighbours);
  mcor_make_boxes(job);
  MCOR_FAIL_IF(job->count > 0 && job->eta > 0 && !(job->extent > 0), context, MCOR_INVALID_DATA,
    MCOR_SAY(NEIGHBOURS_AT_ONE_POINT));
  return MCOR_OK;
}

static mcor_status mcor_check_neighbours(mcor_context* context, double eta, mcor_neighbour_job* job)
{
  const mcor_input* input = job->input;
  const mcor_skip skip = input->ignore_solids ? MCOR_SKIP_SOLIDS : MCOR_SKIP_ABSENT;
  const mcor_sph_kernel kernel = job->options->sph_kernel;
  MCOR_FAIL_IF((unsigned)kernel >= MCOR_SPH_KERNEL_COUNT || kernel == MCOR_M_PRIME_4, context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(NEIGHBOURS_OF_KERNEL),
    mcor_sph_kernel_name(kernel) ? mcor_sph_kernel_name(kernel) : "?");
  MCOR_FAIL_IF(input->count < 0 || (input->count > 0 && !input->positions.data), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(NO_POSITIONS));
  const mcor_array positions = mcor_positions_of(input);
  int64_t i = mcor_find_illegal(NULL, &positions, input->solid, skip, input->count, false);
  MCOR_FAIL_IF(i >= 0, context, MCOR_INVALID_DATA, MCOR_SAY(POSITION_NOT_FINITE), (long long)i);
  const mcor_array* arrays[] = { &input->mass, &input->smoothing_length };
  const char* const names[] = { "mass", "smoothing length" };
  for (int k = 0; k < 2 && job->eta == 0; ++k)
  {
    MCOR_FAIL_IF(!mcor_is_given(arrays[k]), context, MCOR_INVALID_ARGUMENT,
      MCOR_SAY(NOTHING_TO_SUM), names[k]);
    const int64_t count = k == 0 ? input->count : job->wanted;
    i = mcor_find_illegal(NULL, arrays[k], input->solid, skip, count, true);
    MCOR_FAIL_IF(
      i >= 0, context, MCOR_INVALID_DATA, MCOR_SAY(SUMMAND_ILLEGAL), names[k], (long long)i);
  }
  job->axes = mcor_find_dimension(input, job->options->ranks, job->options->dimension);
  job->support = mcor_support_factor(kernel);
  job->norm =
    mcor_kernel_of(kernel)->norm * (job->axes == 2 ? mcor_kernel_of(kernel)->plane_factor : 1);
  if (job->eta > 0)
  {
    job->eta = mcor_power(eta, job->axes);
    const double own = job->norm * mcor_w_of(kernel, 0);
    MCOR_FAIL_IF(!(isfinite(job->eta) && eta > 0 && job->eta > own), context, MCOR_INVALID_ARGUMENT,
      MCOR_SAY(ETA_ILLEGAL), eta, pow(own, 1.0 / job->axes), MCOR_USUAL_ETA);
  }
  return MCOR_OK;
}

/* Runs the job in a context without a device, and writes the error to *why. job->eta is 0 to sum
 * densities, and above 0 to find smoothing lengths. */
static mcor_status mcor_run_neighbours(double eta, mcor_neighbour_job* job, mcor_message* why)
{
  mcor_context* context = mcor_make_bare_context(job->options);
  *why = MCOR_NO_MESSAGE;
  if (!context)
  {
    return MCOR_OUT_OF_CAPACITY;
  }
  mcor_status status = mcor_check_neighbours(context, eta, job);
  int slices = 0;
  if (status == MCOR_OK && (job->input->count > 0 || job->options->ranks))
  {
    status = mcor_load_neighbours(context, job);
    MCOR_THEN(status, mcor_parallel_run(NULL, job->count, 256, mcor_sum_slice, job, &slices));
    free(job->sorted);
    free(job->box);
  }
  for (int s = 0; s < slices && status == MCOR_OK; ++s)
  {
    status = mcor_allocated(context, !job->failed[s]);
  }
  *why = mcor_last_message(context);
  mcor_free_bare_context(context);
  return status;
}

mcor_status mcor_find_smoothing_lengths(const mcor_input* input, const mcor_options* options,
  double eta, int64_t count, double* lengths, mcor_message* why)
{
  mcor_neighbour_job job = {
    .input = input, .options = options, .eta = 1, .wanted = count, .out = lengths
  };
  return mcor_run_neighbours(eta, &job, why);
}

mcor_status mcor_sum_densities(const mcor_input* input, const mcor_options* options, int64_t count,
  double* densities, mcor_message* why)
{
  mcor_neighbour_job job = {
    .input = input, .options = options, .wanted = count, .out = densities
  };
  return mcor_run_neighbours(0, &job, why);
}
