/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* SPH gradients of particle arrays at the particles themselves: the standard form
 *
 *   G_i = sum_j V_j (A_j - A_i) grad W_ij,
 *
 * and the first-order corrected one M_i^-1 G_i with M_i = sum_j V_j grad W_ij (x_j - x_i)^T, which
 * is exact for linear A. */

#include "mcor_box.h"
#include "mcor_plane.h"
#include "mcor_probe.h"

#include <math.h>
#include <stdlib.h>

/* The most particles that are treated at a time. */
#define MCOR_DERIVE_BATCH (1 << 20)

/* A matrix M is inverted only if its condition number is below this. The condition number tells how
 * much inversion magnifies rounding. It is the product of the Frobenius norms of M and its inverse,
 * 3 for the identity. */
#define MCOR_WORST_CONDITION 300

typedef struct mcor_derive_run
{
  mcor_context* context;
  const mcor_input* input;
  bool standard;
  mcor_derivatives* derivatives;
  mcor_buffer arrays;     /* fix [varying_count][grid.count], sorted */
  mcor_point_batch batch; /* the points are particles */
  mcor_buffer moments, slopes;
  void *orders, *moment, *slope; /* views of the batch's `order`, and of moments and slopes */
  int first, count;              /* sorted particles in the batch */
  int inside;                    /* particles of the batch whose gradients are wanted */
  cl_int* particles; /* [grid.count] index on the device, in input order, of each sorted particle */
} mcor_derive_run;

/* ---- evaluation ---- */

/* Inverts m. Returns false if the inversion would magnify rounding too much. */
static bool mcor_invert(const double m[3][3], double inverse[3][3])
{
  double det = 0, norm = 0, inverse_norm = 0;
  for (int k = 0; k < 9; ++k)
  {
    const int a = k / 3, b = k % 3;
    const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
    inverse[b][a] = m[a1][b1] * m[a2][b2] - m[a1][b2] * m[a2][b1];
    norm += m[a][b] * m[a][b];
    inverse_norm += inverse[b][a] * inverse[b][a];
    det += a == 0 ? m[0][b] * inverse[b][0] : 0;
  }
  if (!(sqrt(norm) * sqrt(inverse_norm) < MCOR_WORST_CONDITION * fabs(det)))
  {
    return false;
  }
  for (int i = 0; i < 9; ++i)
  {
    inverse[i / 3][i % 3] /= det;
  }
  return true;
}

static void mcor_put_derivatives(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_derive_run* run = data;
  const mcor_context* context = run->context;
  const mcor_attributes* attributes = &context->attributes;
  const mcor_derivatives* derivatives = run->derivatives;
  for (int64_t i = first; i < last; ++i)
  {
    const int64_t to =
      mcor_source_of(context, run->particles[run->first + ((const cl_int*)run->orders)[i]]);
    double m[3][3], inverse[3][3];
    for (int k = 0; k < 9; ++k)
    {
      m[k / 3][k % 3] = mcor_get_real(context, run->moment, 9 * i + k);
    }
    if (context->space.axes == 2)
    {
      /* In two dimensions, the third row and column of M are 0. An entry of the size of the other
       * entries makes M invertible, and hardly changes its condition. */
      m[2][2] =
        sqrt(0.5 * (m[0][0] * m[0][0] + m[0][1] * m[0][1] + m[1][0] * m[1][0] + m[1][1] * m[1][1]));
    }
    const bool corrected = !run->standard && mcor_invert(m, inverse);
    if (run->input->solid && run->input->solid[to])
    {
      continue;
    }
    derivatives->corrected[to] = corrected;
    for (int c = 0; c < attributes->varying_count; ++c)
    {
      const mcor_component* component = &attributes->varying[c];
      const int width = mcor_components(&run->input->attributes[component->attribute]);
      double* gradient =
        derivatives->gradients[component->attribute] + 3 * (to * width + component->component);
      double slope[3];
      for (int a = 0; a < 3; ++a)
      {
        slope[a] = mcor_get_real(context, run->slope, 3 * (i * attributes->varying_count + c) + a);
      }
      for (int a = 0; a < 3; ++a)
      {
        const double g = corrected
          ? inverse[a][0] * slope[0] + inverse[a][1] * slope[1] + inverse[a][2] * slope[2]
          : slope[a];
        /* Adding 0 turns -0 into 0: compilers differ in the sign of fma(-1, 0, 0). */
        gradient[a] = g / component->scale / context->lattice.cube + 0.0;
      }
    }
  }
  (void)slice;
}

static mcor_status mcor_derive_batch(mcor_derive_run* run)
{
  mcor_context* context = run->context;
  const int arrays = context->attributes.varying_count;
  const size_t real = context->cl.real_size;
  int first[3], last[3], groups;
  const bool bounded = mcor_bound_particles(context, first, last);
  MCOR_TRY(
    mcor_place_particles(context, &run->batch, run->first, run->count, bounded, first, last));
  run->inside = run->count;
  if (bounded)
  {
    MCOR_TRY(mcor_scan(context, &context->points.flags, run->count, &run->inside));
  }
  if (run->inside == 0)
  {
    return MCOR_OK;
  }
  /* Sorts the particles by position, and cuts them into groups that are evaluated together. */
  for (int a = 0; a < 3; ++a)
  {
    run->batch.first[a] = 0;
    run->batch.bricks[a] = 8 * context->lattice.blocks[a];
  }
  MCOR_TRY(mcor_group_batch(context, &run->batch, run->count, run->inside, &groups));
  const size_t n = (size_t)run->inside;
  MCOR_TRY(mcor_reserve(context, &run->moments, n * 9 * real));
  MCOR_TRY(mcor_reserve(context, &run->slopes, n * 3 * (size_t)arrays * real));
  for (int array = 0; array < arrays; array += MCOR_ARRAY_STEP)
  {
    MCOR_TRY(
      MCOR_LAUNCH(context, "mcor_derive_gradients", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
        MCOR_INT(groups), MCOR_BUFFER(&context->points.groups), MCOR_BUFFER(&run->batch.node),
        MCOR_BUFFER(&run->batch.offset), MCOR_INT(run->first), MCOR_BUFFER(&run->batch.order),
        MCOR_INT(array), MCOR_INT(arrays), MCOR_INT(context->grid.count), MCOR_BUFFER(&run->arrays),
        MCOR_BUFFER(&run->moments), MCOR_BUFFER(&run->slopes)));
  }
  MCOR_TRY(mcor_finish(context));
  MCOR_TRY(mcor_report_launch(context));
  const mcor_mapping views[] = { { &run->batch.order, n * sizeof(cl_int), &run->orders },
    { &run->moments, n * 9 * real, &run->moment },
    { &run->slopes, n * 3 * (size_t)arrays * real, &run->slope } };
  mcor_status status = mcor_map_all(context, views, 3);
  MCOR_THEN(status,
    mcor_parallel_run(context, run->inside, MCOR_HEAVY_GRAIN, mcor_put_derivatives, run, NULL));
  return mcor_unmap_all(context, views, 3, status);
}

static mcor_status mcor_derive_all(mcor_derive_run* run)
{
  mcor_context* context = run->context;
  const mcor_attributes* attributes = &context->attributes;
  const int particles = context->grid.count;
  const size_t count = (size_t)particles, fix = context->cl.fix_size;
  /* Loads the varying components as fixed-point numbers, and sets their scales to match. */
  MCOR_TRY(mcor_reserve(context, &run->arrays, (size_t)attributes->varying_count * count * fix));
  for (int i = 0; i < attributes->varying_count; ++i)
  {
    mcor_component* c = &attributes->varying[i];
    /* Scaled values are at most 2^29 or 2^61 in magnitude, so differences do not overflow. */
    c->scale = ldexp(c->scale, fix == sizeof(int32_t) ? 29 : 61);
    MCOR_TRY(mcor_sort_values(context, run->input, &run->input->attributes[c->attribute],
      c->component, c->shift, c->scale, true, &run->arrays, i));
  }
  mcor_release(context, &context->stage.values);
  run->particles = malloc(count * sizeof(cl_int) + 1);
  MCOR_TRY(mcor_allocated(context, run->particles));
  MCOR_TRY(mcor_read(context, &context->grid.order, 0, run->particles, count * sizeof(cl_int)));
  for (run->first = 0; run->first < particles; run->first += run->count)
  {
    const int rest = particles - run->first;
    run->count = rest < MCOR_DERIVE_BATCH ? rest : MCOR_DERIVE_BATCH;
    const double begin = 0.2 + 0.8 * run->first / particles;
    MCOR_TRY(mcor_report(context, "derivatives", begin, begin + 0.8 * run->count / particles));
    MCOR_TRY(mcor_derive_batch(run));
  }
  return MCOR_OK;
}

static mcor_status mcor_run_derive(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_derive_run run = *(const mcor_derive_run*)data;
  mcor_derivatives* d = run.derivatives;
  run.input = input;
  mcor_free_derivatives(d); /* results of an earlier attempt */
  d->statistics.dimension = options->dimension;
  MCOR_TRY(mcor_check_input(context, input, options));
  d->count = input->count;
  d->attribute_count = input->attribute_count;
  d->corrected = calloc((size_t)input->count + 1, 1);
  d->attribute_not_finite = calloc((size_t)input->attribute_count + 1, sizeof(int64_t));
  MCOR_TRY(mcor_allocated(context, d->corrected && d->attribute_not_finite));
  MCOR_TRY(mcor_list_components(context, input, false, d->attribute_not_finite));
  MCOR_TRY(
    mcor_make_arrays(context, input, d->attribute_not_finite, input->count, 3, &d->gradients));
  if (context->attributes.varying_count == 0 || input->count == 0)
  {
    return MCOR_OK;
  }
  mcor_bound_by_box(context, options);
  MCOR_TRY(mcor_prepare(context, input, options));
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_CORRECTION, 0.2, 0.2));
  const mcor_status status = context->grid.count > 0 ? mcor_derive_all(&run) : MCOR_OK;
  MCOR_RELEASE_BEFORE(context, &run.batch, first);
  MCOR_RELEASE(context, &run.arrays, &run.moments, &run.slopes);
  free(run.particles);
  MCOR_TRY(status);
  for (int a = 0; a < input->attribute_count; ++a)
  {
    mcor_unflatten_doubles(
      &context->plane, d->gradients[a], input->count * mcor_components(&input->attributes[a]), 0);
  }
  return mcor_finish_field(context);
}

mcor_status mcor_derive(mcor_context* context, const mcor_input* input, const mcor_options* options,
  mcor_gradient form, mcor_derivatives* derivatives)
{
  MCOR_FAIL_IF(!context || !derivatives, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "derivatives");
  *derivatives = (mcor_derivatives){ 0 };
  MCOR_FAIL_IF(!input || !options, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "input and options");
  MCOR_FAIL_IF((unsigned)form > MCOR_GRADIENT_STANDARD, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(GRADIENT_FORM), (int)form);
  mcor_options own = *options;
  const bool uses_solids = mcor_evaluate_without_scalar(input, &own);
  mcor_derive_run run = {
    .context = context, .standard = form == MCOR_GRADIENT_STANDARD, .derivatives = derivatives
  };
  const mcor_status status = mcor_run_call(
    context, input, &own, uses_solids, &derivatives->statistics, mcor_run_derive, &run);
  return MCOR_OR_FREE(status, mcor_free_derivatives, derivatives);
}

void mcor_free_derivatives(mcor_derivatives* derivatives)
{
  if (!derivatives)
  {
    return;
  }
  mcor_free_arrays(derivatives->gradients, derivatives->attribute_count);
  free(derivatives->corrected);
  free(derivatives->attribute_not_finite);
  *derivatives = (mcor_derivatives){ 0 };
}

/* ---- Quantities of the gradient of a velocity, J = S + O: S symmetric, O antisymmetric ---- */

typedef struct mcor_decompose_job
{
  const double* gradients;
  const mcor_flow* flow;
} mcor_decompose_job;

/* Rotates the symmetric matrix so that element (p, q) becomes 0. r is the third index. */
static void mcor_rotate_away(double m[3][3], int p, int q, int r)
{
  if (fabs(m[p][q]) < 1e-18 * (fabs(m[p][p]) + fabs(m[q][q])))
  {
    m[p][q] = m[q][p] = 0;
  }
  if (m[p][q] == 0)
  {
    return;
  }
  const double theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q];
  const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
  const double c = 1 / sqrt(t * t + 1), s = t * c;
  const double change = t * m[p][q], rp = m[r][p], rq = m[r][q];
  m[p][p] -= change;
  m[q][q] += change;
  m[p][q] = m[q][p] = 0;
  m[r][p] = m[p][r] = c * rp - s * rq;
  m[r][q] = m[q][r] = s * rp + c * rq;
}

/* Returns the middle eigenvalue of a symmetric matrix, by Jacobi's rotations. Roots of the
 * characteristic polynomial would lose half of their digits if two roots are equal, as in rigid
 * rotation. */
static double mcor_middle_eigenvalue(double m[3][3])
{
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (!isfinite(trace))
  {
    return trace;
  }
  for (int sweep = 0; sweep < 20 && (m[0][1] != 0 || m[0][2] != 0 || m[1][2] != 0); ++sweep)
  {
    mcor_rotate_away(m, 0, 1, 2);
    mcor_rotate_away(m, 0, 2, 1);
    mcor_rotate_away(m, 1, 2, 0);
  }
  const double low = fmin(m[0][0], m[1][1]), high = fmax(m[0][0], m[1][1]);
  return fmax(low, fmin(high, m[2][2]));
}

static void mcor_decompose_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_decompose_job* job = data;
  const mcor_flow* flow = job->flow;
  for (int64_t i = first; i < last; ++i)
  {
    const double(*j)[3] = (const double(*)[3])(job->gradients + 9 * i);
    double s[3][3], squares[3][3], trace = j[0][0] + j[1][1] + j[2][2], jj = 0;
    for (int k = 0; k < 9; ++k)
    {
      const int a = k / 3, b = k % 3;
      s[a][b] = 0.5 * (j[a][b] + j[b][a]);
      jj += j[a][b] * j[b][a];
    }
    /* A single loop of 27 rounds takes thrice as long, because compilers do not unroll it. */
    for (int k = 0; k < 9; ++k)
    {
      const int a = k / 3, b = k % 3;
      squares[a][b] = 0;
      for (int c = 0; c < 3; ++c)
      {
        const double left = j[a][c] - s[a][c], right = j[c][b] - s[c][b];
        squares[a][b] += s[a][c] * s[c][b] + left * right;
      }
    }
    if (flow->divergence)
    {
      flow->divergence[i] = trace;
    }
    if (flow->q_criterion)
    {
      flow->q_criterion[i] = 0.5 * (trace * trace - jj);
    }
    if (flow->lambda2)
    {
      flow->lambda2[i] = mcor_middle_eigenvalue(squares);
    }
    for (int a = 0; a < 3 && flow->vorticity; ++a)
    {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      flow->vorticity[3 * i + a] = j[c][b] - j[b][c];
    }
    for (int k = 0; k < 9 && flow->strain_rate; ++k)
    {
      flow->strain_rate[9 * i + k] = s[k / 3][k % 3];
    }
  }
  (void)slice;
}

mcor_status mcor_decompose_gradients(const double* gradients, int64_t count, const mcor_flow* flow)
{
  if (!flow || count < 0 || (count > 0 && !gradients))
  {
    return MCOR_INVALID_ARGUMENT;
  }
  mcor_decompose_job job = { gradients, flow };
  mcor_parallel_for(NULL, count, MCOR_HEAVY_GRAIN, mcor_decompose_slice, &job);
  return MCOR_OK;
}
