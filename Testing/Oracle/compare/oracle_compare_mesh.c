/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COMPARE_PI 3.14159265358979323846

/* ---- vertices ---- */

/* Returns the distance of vertex v from the surface f = iso, in cubes. It is the smaller of |f - iso| / |gradient f|
 * and the shortest step s such that f crosses iso between -s and s from the vertex along the edge. */
static double compare_distance(
  const compare_state* state, int64_t v, int axis, const oracle_sample* sample)
{
  const oracle_reference* reference = state->reference;
  const double* point = &state->surface->points[3 * v];
  const double cube = state->vertex_cube[v];
  const double* g = sample->gradient;
  const double slope = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  double distance = fabs(sample->value - reference->limits.iso) / (slope * cube);
  for (double step = 1e-6; distance > 1e-5 && step < distance; step *= 2.0)
  {
    double p[3] = { point[0], point[1], point[2] };
    oracle_sample low;
    oracle_sample high;
    p[axis] = point[axis] - step * cube;
    oracle_evaluate(&reference->field, NULL, p, &low);
    p[axis] = point[axis] + step * cube;
    oracle_evaluate(&reference->field, NULL, p, &high);
    if ((low.value >= reference->limits.iso) != (high.value >= reference->limits.iso))
    {
      distance = step;
    }
  }
  return isnan(distance) ? 0.0 : distance; /* 0 / 0: the point is exactly on a flat place */
}

static void compare_normal(compare_state* state, int64_t v, const oracle_sample* sample)
{
  oracle_comparison* result = state->result;
  const double* g = sample->gradient;
  const double slope = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  const double least = state->reference->unit > 1e-10 ? 1e-3 : 1e-10;
  if (!(slope > least * sample->gradient_scale))
  {
    ++result->flat_vertices;
    return;
  }
  const float* n = &state->surface->normals[3 * v];
  double cross[3];
  double dot = 0.0;
  for (int a = 0; a < 3; ++a)
  {
    const int b = (a + 1) % 3;
    const int c = (a + 2) % 3;
    cross[a] = (double)n[b] * g[c] - (double)n[c] * g[b];
    dot -= (double)n[a] * g[a];
  }
  const double sine = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
  const double degrees = atan2(sine, dot) * 180.0 / COMPARE_PI;
  if (!(degrees <= result->normal_degrees))
  {
    result->normal_degrees = degrees;
    if (!(degrees < 1.0))
    {
      const double* p = &state->surface->points[3 * v];
      compare_note(state,
        "normal of vertex %lld at (%.9g, %.9g, %.9g) is off by %.3g degrees,"
        " weight %.3g, fluid %.3g, slope %.3g of %.3g, residual %.3g",
        (long long)v, p[0], p[1], p[2], degrees, sample->trim_weight, sample->weight, slope,
        sample->gradient_scale,
        (sample->value - state->reference->limits.iso) / state->reference->range);
    }
  }
}

static void compare_optional_arrays(compare_state* state, int64_t v, const oracle_sample* sample)
{
  oracle_comparison* result = state->result;
  if (state->surface->weight_sum)
  {
    result->weight_error = fmax(result->weight_error,
      fabs((double)state->surface->weight_sum[v] - sample->trim_weight) /
        state->reference->greatest_weight);
  }
  if (state->surface->boundary_eigenvalue)
  {
    double eigenvalues[3];
    oracle_boundary_eigenvalues(
      &state->reference->field, &state->surface->points[3 * v], eigenvalues);
    result->eigenvalue_error = fmax(result->eigenvalue_error,
      fabs((double)state->surface->boundary_eigenvalue[v] - eigenvalues[0]) /
        fmax(eigenvalues[2], 1.0));
  }
  if (state->surface->gradients && sample->gradient_scale > 0.0)
  {
    double* worst =
      sample->weight < COMPARE_RIM ? &result->rim_gradient_error : &result->gradient_error;
    for (int axis = 0; axis < 3; ++axis)
    {
      *worst = fmax(*worst,
        fabs(state->surface->gradients[3 * v + axis] - sample->gradient[axis]) /
          sample->gradient_scale);
    }
  }
}

/* Returns the least of the trimming margins, and writes its gradient. The eigenvalue's gradient is found by
 * differences. */
static double compare_trim_gradient(const compare_state* state, const double point[3],
  const oracle_sample* sample, double gradient[3])
{
  const double wall = compare_wall_margin(state, sample);
  const double margin = compare_threshold_margin(state, point, sample);
  const double fluid = compare_fluid_margin(state, sample);
  if (fluid < fmin(wall, margin))
  {
    memcpy(gradient, sample->weight_gradient, sizeof(sample->weight_gradient));
    return fluid;
  }
  if (wall < margin)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      gradient[axis] = sample->weight_gradient[axis] -
        (1.0 - state->options->wall_share) * sample->trim_gradient[axis];
    }
    return wall;
  }
  if (state->options->boundary_detection != MCOR_BOUNDARY_EIGENVALUE)
  {
    memcpy(gradient, sample->trim_gradient, sizeof(sample->trim_gradient));
    return margin;
  }
  const double step = 1e-5 * state->reference->lattice.cube;
  for (int axis = 0; axis < 3; ++axis)
  {
    double p[3] = { point[0], point[1], point[2] };
    p[axis] = point[axis] + step;
    const double high = compare_threshold_margin(state, p, sample);
    p[axis] = point[axis] - step;
    gradient[axis] = (high - compare_threshold_margin(state, p, sample)) / (2.0 * step);
  }
  return margin;
}

/* Returns 1 if damped least-norm Newton steps lead from the point, within one cube, to a place where f = iso and the
 * least trimming margin is 0. */
static int compare_exact_cut_near(const compare_state* state, const double start[3])
{
  const oracle_reference* reference = state->reference;
  double p[3] = { start[0], start[1], start[2] };
  for (int step = 0; step < 100; ++step)
  {
    oracle_sample s;
    oracle_evaluate(&reference->field, NULL, p, &s);
    const double f = s.value - reference->limits.iso;
    double gradient[3];
    const double w = compare_trim_gradient(state, p, &s, gradient);
    if (fabs(f) <= 1e-7 * reference->range && fabs(w) <= 1e-7)
    {
      return 1;
    }
    double ff = 0.0;
    double ww = 0.0;
    double fw = 0.0;
    for (int a = 0; a < 3; ++a)
    {
      ff += s.gradient[a] * s.gradient[a];
      ww += gradient[a] * gradient[a];
      fw += s.gradient[a] * gradient[a];
    }
    const double determinant = ff * ww - fw * fw;
    double distance = 0.0;
    double length = 0.0;
    double d[3];
    for (int a = 0; a < 3; ++a)
    {
      d[a] = -((ww * f - fw * w) * s.gradient[a] + (ff * w - fw * f) * gradient[a]) / determinant;
      length += d[a] * d[a];
    }
    const double most = 0.1 * reference->lattice.cube;
    const double damping = length > most * most ? most / sqrt(length) : 1.0;
    for (int a = 0; a < 3; ++a)
    {
      p[a] += damping * d[a];
      distance += (p[a] - start[a]) * (p[a] - start[a]);
    }
    if (!(determinant > 1e-6 * ff * ww && sqrt(distance) <= reference->lattice.cube))
    {
      return 0;
    }
  }
  return 0;
}

static void compare_trim_vertex(
  compare_state* state, int64_t v, const oracle_sample* sample, double residual)
{
  oracle_comparison* result = state->result;
  ++result->trim_vertices;
  if (state->surface->boundary_flag[v] == 2)
  {
    ++result->trim_linear;
    result->trim_avoidable += compare_exact_cut_near(state, &state->surface->points[3 * v]);
    return;
  }
  result->trim_residual = fmax(result->trim_residual, residual);
  const double off = fabs(compare_trim_margin(state, &state->surface->points[3 * v], sample));
  result->trim_weight_error = fmax(result->trim_weight_error, off);
  if (!(off < 1e-3))
  {
    const double* p = &state->surface->points[3 * v];
    compare_note(state,
      "cut vertex %lld at (%.9g, %.9g, %.9g) is %.6g off its threshold, weight %.6g, fluid %.6g,"
      " residual %.3g",
      (long long)v, p[0], p[1], p[2], off, sample->trim_weight, sample->weight, residual);
  }
}

/* Checks a vertex on a lattice edge. */
static void compare_edge_vertex(
  compare_state* state, int64_t v, const oracle_sample* sample, double residual)
{
  oracle_comparison* result = state->result;
  const double* point = &state->surface->points[3 * v];
  const int axis = (int)(state->vertex_edge[v] % 3);
  result->below_threshold += state->trimmed && compare_trim_margin(state, point, sample) < -1e-5;
  if (residual > 4e-6 &&
    residual * state->reference->range <=
      oracle_rounding(&state->reference->field, point, state->reference->unit))
  {
    ++result->noisy;
  }
  else if (!(residual <= result->residual))
  {
    result->residual = residual;
    if (!(residual < 5e-6))
    {
      compare_note(state,
        "vertex %lld at (%.9g, %.9g, %.9g) has residual %.3g; weight %.3g,"
        " fluid %.3g",
        (long long)v, point[0], point[1], point[2], residual, sample->trim_weight, sample->weight);
    }
  }
  result->distance = fmax(result->distance, compare_distance(state, v, axis, sample));
}

void compare_vertices(compare_state* state)
{
  const oracle_reference* reference = state->reference;
  for (int64_t v = 0; v < state->surface->point_count; ++v)
  {
    oracle_sample sample;
    int on_surface = 1;
    oracle_evaluate(&reference->field, NULL, &state->surface->points[3 * v], &sample);
    memcpy(&state->gradient[3 * v], sample.gradient, sizeof(sample.gradient));
    compare_optional_arrays(state, v, &sample);
    const double residual = fabs(sample.value - reference->limits.iso) / reference->range;
    if (state->vertex_edge[v] == COMPARE_TRIM_VERTEX)
    {
      compare_trim_vertex(state, v, &sample, residual);
      /* A vertex that trimming placed linearly (2) lies beside the surface, so its normal need not be the surface's. */
      on_surface = state->surface->boundary_flag[v] != 2;
    }
    else if (state->vertex_edge[v] >= 0)
    {
      compare_edge_vertex(state, v, &sample, residual);
    }
    if (state->surface->normals && on_surface)
    {
      compare_normal(state, v, &sample);
    }
  }
}

/* ---- triangles ---- */

void compare_orientation(compare_state* state)
{
  const mcor_surface* surface = state->surface;
  const int64_t components = state->mesh->components;
  double* balance = oracle_allocate(components, sizeof(double));
  for (int64_t t = 0; t < surface->triangle_count; ++t)
  {
    const int32_t* c = &surface->triangles[3 * t];
    double u[3];
    double v[3];
    double g[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      u[axis] = surface->points[3 * c[1] + axis] - surface->points[3 * c[0] + axis];
      v[axis] = surface->points[3 * c[2] + axis] - surface->points[3 * c[0] + axis];
      g[axis] = state->gradient[3 * c[0] + axis] + state->gradient[3 * c[1] + axis] +
        state->gradient[3 * c[2] + axis];
    }
    balance[state->mesh->component[t]] -= (u[1] * v[2] - u[2] * v[1]) * g[0] +
      (u[2] * v[0] - u[0] * v[2]) * g[1] + (u[0] * v[1] - u[1] * v[0]) * g[2];
  }
  for (int64_t c = 0; c < components; ++c)
  {
    state->result->inverted_components += balance[c] < 0.0;
  }
  free(balance);
}
