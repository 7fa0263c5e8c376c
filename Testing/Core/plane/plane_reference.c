/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#include "plane_reference.h"

#include <math.h>
#include <stdlib.h>

double plane_norm(mcor_sph_kernel kernel)
{
  /* 10 / (7 pi) over 1 / pi; 2 (2 - q)^2 / ... : so that the integral over the plane is 1, which
   * test_core_plane checks. */
  static const double norm[MCOR_SPH_KERNEL_COUNT] = { 1.4285714285714286, 1.6, 1,
    1.7573221757322175, 1.3333333333333333, 1.6013344453711426, 1.1636363636363636,
    1.0448979591836735, 1.0635845764083533 };
  return norm[kernel];
}

static double plane_u(const plane_field* f, int64_t i, int a)
{
  return f->set->position[3 * i + (f->axis + 1 + a) % 3];
}

/* Volumes of particles are areas. */
plane_sample plane_evaluate(const plane_field* f, double u, double v)
{
  const core_set* set = f->set;
  const mcor_options* o = f->options;
  plane_sample s = { 0 };
  double sum = 0, slope[2] = { 0, 0 };
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
    const double scale = plane_norm(o->sph_kernel) * h * set->volume[i];
    const double w = scale * oracle_kernel_value((oracle_kernel)o->sph_kernel, h, d, g);
    const int solid = set->has_solids && set->solid[i];
    s.weight += w;
    s.fluid += solid ? 0 : w;
    sum += solid ? 0 : w * set->scalar[i];
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
  return s;
}

typedef struct plane_lattice
{
  int64_t low[2], size[2];
  double cube;
  plane_sample* node;
  uint8_t *above, *valid, *close; /* close: rounding may decide */
} plane_lattice;

static int64_t plane_index(const plane_lattice* l, int64_t i, int64_t j)
{
  return j * l->size[0] + i;
}

static double plane_range(const plane_field* f)
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

static plane_lattice plane_create(const plane_field* f, double iso, double cube)
{
  plane_lattice l = { .cube = cube };
  const mcor_options* o = f->options;
  const double close = 4e-6 * plane_range(f);
  for (int a = 0; a < 2; ++a)
  {
    double low = 1e300, high = -1e300;
    for (int64_t i = 0; i < f->set->count; ++i)
    {
      const double reach =
        f->set->smoothing_length[i] * o->h_scale * oracle_support((oracle_kernel)o->sph_kernel);
      low = fmin(low, plane_u(f, i, a) - reach);
      high = fmax(high, plane_u(f, i, a) + reach);
    }
    l.low[a] = (int64_t)floor(low / cube) - 1;
    l.size[a] = (int64_t)ceil(high / cube) + 2 - l.low[a];
  }
  const size_t nodes = (size_t)(l.size[0] * l.size[1]);
  l.node = calloc(nodes, sizeof *l.node);
  l.above = calloc(nodes, 1);
  l.valid = calloc(nodes, 1);
  l.close = calloc(nodes, 1);
  assert_true(l.node && l.above && l.valid && l.close);
  for (int64_t n = 0; n < (int64_t)nodes; ++n)
  {
    const double u = (double)(l.low[0] + n % l.size[0]) * cube;
    const double v = (double)(l.low[1] + n / l.size[0]) * cube;
    plane_sample* s = l.node + n;
    *s = plane_evaluate(f, u, v);
    const int lacks = o->field == MCOR_SHEPARD && s->fluid < 1e-3;
    const double weight = lacks ? -1 : s->weight;
    l.above[n] = (lacks ? 0 : s->value) >= iso;
    l.valid[n] = o->field == MCOR_WEIGHT_SUM || weight >= o->node_threshold;
    l.close[n] = fabs(s->value - iso) < close ||
      (o->field != MCOR_WEIGHT_SUM && fabs(s->weight - o->node_threshold) < 2e-6) ||
      (o->field == MCOR_SHEPARD && fabs(s->fluid - 1e-3) < 1e-6);
  }
  return l;
}

static void plane_destroy(plane_lattice* l)
{
  free(l->node);
  free(l->above);
  free(l->valid);
  free(l->close);
}

static int plane_square_valid(const plane_lattice* l, int64_t i, int64_t j, int* close)
{
  int valid = i >= 0 && j >= 0 && i + 1 < l->size[0] && j + 1 < l->size[1];
  for (int c = 0; c < 4 && valid; ++c)
  {
    const int64_t n = plane_index(l, i + (c & 1), j + (c >> 1));
    valid = l->valid[n];
    *close |= l->close[n];
  }
  return valid;
}

/* Whether the field at the edge's crossing has too little fluid for a mean, so that trimming takes it. */
static int plane_is_trimmed(
  const plane_field* f, const plane_lattice* l, int64_t i, int64_t j, int axis, double iso)
{
  const mcor_options* o = f->options;
  const double least = o->field == MCOR_WEIGHT_SUM ? -1
    : o->field != MCOR_SHEPARD                     ? 0
    : o->sph_kernel == MCOR_M_PRIME_4              ? 0.05
                                                   : 1e-3;
  double low = 0, high = 1;
  const int rising = !l->above[plane_index(l, i, j)];
  plane_sample s = { 0 };
  for (int k = 0; k < 50; ++k)
  {
    const double t = 0.5 * (low + high);
    s = plane_evaluate(f, ((double)(l->low[0] + i) + (axis == 0 ? t : 0)) * l->cube,
      ((double)(l->low[1] + j) + (axis == 1 ? t : 0)) * l->cube);
    const int before = rising ? s.value < iso : s.value >= iso;
    low = before ? t : low;
    high = before ? high : t;
  }
  return o->field != MCOR_WEIGHT_SUM &&
    (s.fluid < least + 1e-5 || s.weight < o->vertex_threshold + 1e-5);
}

/* 1 crossed, 2 crossed or not, as rounding decides, or trimmed; 0 not crossed. */
static uint8_t* plane_edges(
  const plane_field* f, const plane_lattice* l, double iso, int64_t* count)
{
  const size_t most = 2 * (size_t)l->size[0] * (size_t)l->size[1];
  uint8_t* edges = most < SIZE_MAX / 2 ? calloc(most, 1) : NULL;
  assert_non_null(edges);
  *count = 0;
  for (int64_t e = 0; e < 2 * l->size[0] * l->size[1]; ++e)
  {
    const int axis = (int)(e & 1);
    const int64_t i = e / 2 % l->size[0], j = e / 2 / l->size[0];
    if (i + (axis == 0) >= l->size[0] || j + (axis == 1) >= l->size[1])
    {
      continue;
    }
    const int64_t a = plane_index(l, i, j), b = plane_index(l, i + (axis == 0), j + (axis == 1));
    int close = 0;
    const int upper = plane_square_valid(l, i, j, &close);
    const int lower = plane_square_valid(l, i - (axis == 1), j - (axis == 0), &close);
    const int crossed = l->above[a] != l->above[b] && (upper || lower);
    edges[e] = close || (crossed && plane_is_trimmed(f, l, i, j, axis, iso)) ? 2 : crossed ? 1 : 0;
    *count += edges[e] == 1;
  }
  return edges;
}

/* The number of the lattice edge that a point is on. */
static int64_t plane_edge_of(const plane_lattice* l, double u, double v)
{
  const double x[2] = { u / l->cube - (double)l->low[0], v / l->cube - (double)l->low[1] };
  const double off[2] = { fabs(x[0] - floor(x[0] + 0.5)), fabs(x[1] - floor(x[1] + 0.5)) };
  const int axis = off[0] > off[1] ? 0 : 1;
  CORE_CHECK(off[!axis] < 1e-9, "point %g %g is on no lattice edge", u, v);
  const int64_t i = (int64_t)(axis == 0 ? floor(x[0]) : floor(x[0] + 0.5));
  const int64_t j = (int64_t)(axis == 1 ? floor(x[1]) : floor(x[1] + 0.5));
  return 2 * plane_index(l, i, j) + axis;
}

int64_t plane_compare(const plane_field* f, double iso, const mcor_surface* surface)
{
  plane_lattice l = plane_create(f, iso, surface->statistics.cube_size);
  int64_t crossed, found = 0;
  uint8_t* edges = plane_edges(f, &l, iso, &crossed);
  for (int64_t p = 0; p < surface->point_count; ++p)
  {
    const double u = surface->points[3 * p + (f->axis + 1) % 3];
    const double v = surface->points[3 * p + (f->axis + 2) % 3];
    const plane_sample s = plane_evaluate(f, u, v);
    const int cut = surface->boundary_flag[p] & 3;
    CORE_CHECK(cut == 2 || fabs(s.value - iso) < 1e-5 * plane_range(f), "point %lld is off by %g",
      (long long)p, s.value - iso);
    CORE_CHECK(cut != 1 || f->options->wall_share != 0 || s.fluid < 0.06 ||
        fabs(s.weight - f->options->vertex_threshold) < 3e-5,
      "cut %lld has weight %g", (long long)p, s.weight);
    if (cut)
    {
      continue;
    }
    const int64_t e = plane_edge_of(&l, u, v);
    CORE_CHECK(edges[e] != 0, "a vertex on edge %lld, which is not crossed", (long long)e);
    found += edges[e] == 1;
    edges[e] = edges[e] == 1 ? 3 : edges[e];
  }
  CORE_CHECK(found == crossed, "%lld edges are crossed, %lld have vertices", (long long)crossed,
    (long long)found);
  free(edges);
  plane_destroy(&l);
  return crossed;
}

void plane_check_lines(const plane_field* f, double iso, const mcor_surface* surface, int closed)
{
  const double cube = surface->statistics.cube_size, range = plane_range(f);
  CORE_CHECK(
    surface->statistics.dimension == 2 && surface->triangle_count == 0 && surface->line_count > 0,
    "dimension %d", surface->statistics.dimension);
  int* used = calloc((size_t)surface->point_count + 1, sizeof *used);
  assert_non_null(used);
  double wrong = 0, all = 0;
  for (int64_t l = 0; l < surface->line_count; ++l)
  {
    const int64_t first = surface->line_offsets[l], last = surface->line_offsets[l + 1] - 1;
    const int is_closed = surface->line_points[first] == surface->line_points[last];
    CORE_CHECK(last > first && (is_closed || !closed), "line %lld is open", (long long)l);
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
      assert_true(a[f->axis] == f->set->position[f->axis] && length < 1.5 * cube + 0.75 * cube);
      const double step = length > 0 ? 0.2 * cube / length : 0;
      const double x = 0.5 * (a[u] + b[u]), y = 0.5 * (a[v] + b[v]);
      const double left = plane_evaluate(f, x - step * d[1], y + step * d[0]).value;
      const double right = plane_evaluate(f, x + step * d[1], y - step * d[0]).value;
      all += length;
      wrong += left <= right ? length : 0;
    }
  }
  CORE_CHECK(wrong < 0.03 * all, "%g of %g have the greater side on their right", wrong, all);
  for (int64_t p = 0; p < surface->point_count; ++p)
  {
    const float* n = surface->normals + 3 * p;
    const double u = surface->points[3 * p + (f->axis + 1) % 3];
    const double v = surface->points[3 * p + (f->axis + 2) % 3];
    const plane_sample s = plane_evaluate(f, u, v);
    const double length = hypot(s.gradient[0], s.gradient[1]);
    CORE_CHECK(used[p] == 1, "point %lld is used %d times", (long long)p, used[p]);
    CORE_CHECK(n[f->axis] == 0, "normal %lld points out of the plane", (long long)p);
    CORE_CHECK(length < 1e-2 * range ||
        -(n[(f->axis + 1) % 3] * s.gradient[0] + n[(f->axis + 2) % 3] * s.gradient[1]) >
          (1 - 1e-5) * length,
      "normal %lld", (long long)p);
  }
  (void)iso;
  free(used);
}

core_set plane_make(int n, double jitter, double spread, int axis, double at, uint64_t seed)
{
  core_set set = core_make_set((int64_t)n * n);
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
