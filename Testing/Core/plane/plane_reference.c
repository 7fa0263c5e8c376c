/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "plane_reference.h"

#include "mcor_plane.h"

double plane_u(const plane_field* f, int64_t i, int a)
{
  return f->set->position[3 * i + (f->axis + 1 + a) % 3];
}

/* Returns how far the point is inside of the trimmed surface; below 0, it is outside. This is the lesser of two
 * margins. The first, which the free surface does not have, is the weight, or the lower eigenvalue of the symmetric
 * matrix m (uu, uv, vv), minus the threshold. The second, at walls, is wall_share times the weight, minus the solids'
 * weight. */
static double plane_margin(const plane_field* f, const plane_sample* s, const double m[3])
{
  const mcor_options* o = f->options;
  const double least = 0.5 * (m[0] + m[2]) - hypot(0.5 * (m[0] - m[2]), m[1]);
  const double margin =
    (o->boundary_detection == MCOR_BOUNDARY_EIGENVALUE ? least : s->weight) - o->vertex_threshold;
  const double wall = f->set->has_solids && o->wall_share > 0
    ? o->wall_share * s->weight - (s->weight - s->fluid)
    : INFINITY;
  return o->field == MCOR_WEIGHT_SUM ? wall : fmin(margin, wall);
}

/* A particle's volume is its area in the plane. */
plane_sample plane_evaluate(const plane_field* f, double u, double v)
{
  const particle_set* set = f->set;
  const mcor_options* o = f->options;
  const double factor = mcor_kernel_of(o->sph_kernel)->plane_factor;
  plane_sample s = { 0 };
  double sum = 0, slope[2] = { 0, 0 }, moments[3] = { 0, 0, 0 };
  for (int64_t i = 0; i < set->count; ++i)
  {
    const double h = set->smoothing_length[i] * o->h_scale;
    const double d[3] = { u - plane_u(f, i, 0), v - plane_u(f, i, 1), 0 };
    const double reach = h * oracle_support((oracle_kernel)o->sph_kernel);
    if (fabs(d[0]) >= reach || fabs(d[1]) >= reach)
    {
      continue;
    }
    double g[3];
    const double scale = factor * h * set->volume[i];
    const double w = scale * oracle_kernel_value((oracle_kernel)o->sph_kernel, h, d, g);
    const int solid = set->has_solids && set->solid[i];
    s.weight += w;
    s.fluid += solid ? 0 : w;
    sum += solid ? 0 : w * set->scalar[i];
    moments[0] -= scale * d[0] * g[0];
    moments[1] -= 0.5 * scale * (d[0] * g[1] + d[1] * g[0]);
    moments[2] -= scale * d[1] * g[1];
    for (int a = 0; a < 2; ++a)
    {
      s.weight_slope[a] += scale * g[a];
      s.fluid_slope[a] += solid ? 0 : scale * g[a];
      slope[a] += solid ? 0 : scale * g[a] * set->scalar[i];
    }
  }
  s.value = o->field == MCOR_WEIGHT_SUM ? s.fluid
    : o->field == MCOR_SUM              ? sum
    : s.fluid != 0                      ? sum / s.fluid
                                        : 0;
  for (int a = 0; a < 2; ++a)
  {
    s.gradient[a] = o->field == MCOR_WEIGHT_SUM ? s.fluid_slope[a]
      : o->field == MCOR_SUM                    ? slope[a]
      : s.fluid != 0                            ? (slope[a] - s.value * s.fluid_slope[a]) / s.fluid
                                                : 0;
  }
  s.margin = plane_margin(f, &s, moments);
  return s;
}

double plane_range(const plane_field* f)
{
  double low = 1e300, high = -1e300;
  for (int64_t i = 0; i < f->set->count; ++i)
  {
    const int counts = !(f->set->has_solids && f->set->solid[i]);
    low = counts ? fmin(low, f->set->scalar[i]) : low;
    high = counts ? fmax(high, f->set->scalar[i]) : high;
  }
  return f->options->field == MCOR_WEIGHT_SUM ? 1 : high - low;
}

void plane_check_lines(const plane_field* f, const mcor_surface* surface, int closed)
{
  const double cube = surface->statistics.cube_size;
  const double largest = ldexp(cube, surface->statistics.highest_level), range = plane_range(f);
  CORE_CHECK(
    surface->statistics.dimension == 2 && surface->triangle_count == 0 && surface->line_count > 0,
    surface->statistics.dimension);
  CORE_FREED int* used = oracle_allocate(surface->point_count + 1, sizeof *used);
  double wrong = 0, all = 0;
  int open = 0;
  for (int64_t l = 0; l < surface->line_count; ++l)
  {
    const int64_t first = surface->line_offsets[l], last = surface->line_offsets[l + 1] - 1;
    const int is_closed = surface->line_points[first] == surface->line_points[last];
    CORE_CHECK(last > first && (is_closed || !closed), l);
    open += !is_closed;
    for (int64_t i = first; i < last + !is_closed; ++i)
    {
      ++used[surface->line_points[i]];
    }
    for (int64_t i = first; i < last; ++i)
    {
      const double* a = surface->points + 3 * (int64_t)surface->line_points[i];
      const double* b = surface->points + 3 * (int64_t)surface->line_points[i + 1];
      const int u = (f->axis + 1) % 3, v = (f->axis + 2) % 3;
      const double d[2] = { b[u] - a[u], b[v] - a[v] }, length = hypot(d[0], d[1]);
      assert_true(a[f->axis] == f->set->position[f->axis] && length < 2.25 * largest);
      const double step = length > 0 ? 0.2 * fmax(cube, 0.7 * length) / length : 0;
      const double x = 0.5 * (a[u] + b[u]), y = 0.5 * (a[v] + b[v]);
      const double left = plane_evaluate(f, x - step * d[1], y + step * d[0]).value;
      const double right = plane_evaluate(f, x + step * d[1], y - step * d[0]).value;
      all += length;
      wrong += left <= right ? length : 0;
    }
  }
  CORE_CHECK(wrong < 0.03 * all, wrong, all);
  CORE_CHECK(fabs(surface->statistics.length - all) < 1e-9 * all, surface->statistics.length, all);
  assert_int_equal(surface->statistics.is_closed, open == 0);
  for (int64_t p = 0; p < surface->point_count; ++p)
  {
    const float* n = surface->normals + 3 * p;
    const double u = surface->points[3 * p + (f->axis + 1) % 3];
    const double v = surface->points[3 * p + (f->axis + 2) % 3];
    const plane_sample s = plane_evaluate(f, u, v);
    const double length = hypot(s.gradient[0], s.gradient[1]);
    CORE_CHECK(used[p] == 1, p, used[p]);
    CORE_CHECK(n[f->axis] == 0, p);
    CORE_CHECK(length < 1e-2 * range ||
        -(n[(f->axis + 1) % 3] * s.gradient[0] + n[(f->axis + 2) % 3] * s.gradient[1]) >
          (1 - 1e-5) * length,
      p);
  }
}

mcor_options plane_options(const double* iso)
{
  mcor_options options = core_options(iso);
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG;
  options.vertex_threshold = 0;
  return options;
}

particle_set plane_make(int n, double jitter, double spread, int axis, double at, uint64_t seed)
{
  particle_set set = particle_set_make((int64_t)n * n);
  for (int64_t i = 0; i < set.count; ++i)
  {
    double* x = set.position + 3 * i;
    x[axis] = at;
    x[(axis + 1) % 3] = (double)(i % n) - 0.5 * (n - 1) + jitter * (2 * random_unit(&seed) - 1);
    x[(axis + 2) % 3] = (double)(i / n) - 0.5 * (n - 1) + jitter * (2 * random_unit(&seed) - 1);
    set.smoothing_length[i] = 1.3 * pow(spread, random_unit(&seed));
    set.volume[i] = 1;
    set.scalar[i] =
      9 - x[(axis + 1) % 3] * x[(axis + 1) % 3] - x[(axis + 2) % 3] * x[(axis + 2) % 3];
  }
  return set;
}
