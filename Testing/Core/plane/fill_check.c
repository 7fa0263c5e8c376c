/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fill_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An edge from one point to another: of a triangle of a band, or of a line (of_line) of an iso value. */
typedef struct fill_edge
{
  int32_t from, to;
  int of_line;
  double value;
} fill_edge;

static int fill_compare(const void* x, const void* y)
{
  const fill_edge *a = x, *b = y;
  const int32_t low[2] = { a->from < a->to ? a->from : a->to, b->from < b->to ? b->from : b->to };
  const int32_t high[2] = { a->from < a->to ? a->to : a->from, b->from < b->to ? b->to : b->from };
  const int by_low = (low[0] > low[1]) - (low[0] < low[1]);
  return by_low ? by_low : (high[0] > high[1]) - (high[0] < high[1]);
}

static double fill_cross(
  const plane_field* f, const mcor_surface* s, int32_t a, int32_t b, int32_t c)
{
  const int u = (f->axis + 1) % 3, v = (f->axis + 2) % 3;
  const double *p = s->points + 3 * (int64_t)a, *q = s->points + 3 * (int64_t)b,
               *r = s->points + 3 * (int64_t)c;
  return 0.5 * ((q[u] - p[u]) * (r[v] - p[v]) - (r[u] - p[u]) * (q[v] - p[v]));
}

static fill_edge* fill_list(const mcor_surface* s, int64_t* count)
{
  fill_edge* edges =
    malloc((size_t)(3 * s->triangle_count + s->line_point_count + 1) * sizeof *edges);
  assert_non_null(edges);
  *count = 0;
  for (int64_t i = 0; i < 3 * s->triangle_count; ++i)
  {
    const int64_t t = i / 3;
    edges[(*count)++] =
      (fill_edge){ s->triangles[i], s->triangles[3 * t + (i + 1) % 3], 0, s->band_value[t] };
  }
  for (int64_t l = 0; l < s->line_count; ++l)
  {
    for (int64_t i = s->line_offsets[l]; i + 1 < s->line_offsets[l + 1]; ++i)
    {
      const int32_t from = s->line_points[i];
      edges[(*count)++] = (fill_edge){ from, s->line_points[i + 1], 1, s->iso_value[from] };
    }
  }
  qsort(edges, (size_t)*count, sizeof *edges, fill_compare);
  return edges;
}

/* Edges between the same two points. */
static void fill_check_edge(const plane_field* f, const mcor_surface* s, const fill_edge* edges,
  int64_t count, double least, fill_report* report)
{
  const fill_edge *sides[2] = { NULL }, *line = NULL;
  for (int64_t i = 0; i < count; ++i)
  {
    const fill_edge* e = edges + i;
    const int way = e->from < e->to;
    CORE_CHECK(!(e->of_line ? line != NULL : sides[way] != NULL), "edge %d %d is there twice",
      e->from, e->to);
    line = e->of_line ? e : line;
    sides[way] = e->of_line ? sides[way] : e;
  }
  if (line && !sides[0] && !sides[1])
  {
    /* Only one of equal iso values has bands beside it. */
    int times = 0;
    for (int i = 0; i < f->options->iso_count; ++i)
    {
      times += f->options->iso_values[i] == line->value;
    }
    CORE_CHECK(times > 1, "the line %d %d of %g has no bands", line->from, line->to, line->value);
    return;
  }
  if (line)
  {
    const fill_edge *left = sides[line->from < line->to], *right = sides[line->from > line->to];
    CORE_CHECK(left && left->value == line->value, "the line %d %d of %g has no band on its left",
      line->from, line->to, line->value);
    CORE_CHECK(line->value == least ? right == NULL : right && right->value < line->value,
      "the line %d %d of %g has the wrong band on its right", line->from, line->to, line->value);
    return;
  }
  CORE_CHECK(!sides[0] || !sides[1] || sides[0]->value == sides[1]->value,
    "bands %g and %g meet where there is no line", sides[0]->value, sides[1]->value);
  if (!sides[0] || !sides[1])
  {
    const double *a = s->points + 3 * (int64_t)edges->from, *b = s->points + 3 * (int64_t)edges->to;
    ++report->loose;
    report->loose_length += sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
  }
}

fill_report fill_check(const plane_field* field, const mcor_surface* s)
{
  fill_report report = { 0 };
  int64_t count;
  CORE_CHECK(s->band_value && s->iso_value && s->triangle_count > 0, "nothing is filled");
  double least = INFINITY;
  for (int i = 0; i < field->options->iso_count; ++i)
  {
    least = fmin(least, field->options->iso_values[i]);
  }
  CORE_FREED fill_edge* edges = fill_list(s, &count);
  for (int64_t i = 0, next; i < count; i = next)
  {
    next = i + 1;
    while (next < count && fill_compare(edges + i, edges + next) == 0)
    {
      ++next;
    }
    fill_check_edge(field, s, edges + i, next - i, least, &report);
  }
  for (int64_t t = 0; t < s->triangle_count; ++t)
  {
    const int32_t* c = s->triangles + 3 * t;
    const double area = fill_cross(field, s, c[0], c[1], c[2]);
    report.area += area;
    report.inverted -= area < 0 ? area : 0;
  }
  int closed = 1;
  for (int64_t l = 0; l < s->line_count; ++l)
  {
    const int32_t* p = s->line_points + s->line_offsets[l];
    const int64_t n = s->line_offsets[l + 1] - s->line_offsets[l];
    closed = closed && (p[0] == p[n - 1] || s->iso_value[p[0]] != least);
    for (int64_t i = 0; i + 1 < n && s->iso_value[p[0]] == least; ++i)
    {
      report.enclosed += fill_cross(field, s, 0, p[i], p[i + 1]);
    }
  }
  report.enclosed = closed ? report.enclosed : 0;
  CORE_CHECK(fabs(s->statistics.area - report.area) < 1e-9 * report.area, "area %g, not %g",
    s->statistics.area, report.area);
  return report;
}

void fill_check_points(const plane_field* f, const mcor_surface* s)
{
  const mcor_options* o = f->options;
  int64_t nodes = 0;
  for (int64_t p = 0; p < s->point_count; ++p)
  {
    const double u = s->points[3 * p + (f->axis + 1) % 3], v = s->points[3 * p + (f->axis + 2) % 3];
    const plane_sample at = plane_evaluate(f, u, v);
    const double scale = 1 + fabs(at.value), value = s->iso_value[p] + s->residual[p];
    CORE_CHECK(s->points[3 * p + f->axis] == f->set->position[f->axis],
      "point %lld is off the plane", (long long)p);
    CORE_CHECK(fabs(at.value - value) < 3e-5 * scale, "point %lld: %g, not %g", (long long)p, value,
      at.value);
    CORE_CHECK(
      fabs(at.weight - s->weight_sum[p]) < 1e-4, "weight %g, not %g", s->weight_sum[p], at.weight);
    CORE_CHECK(s->normals[3 * p + f->axis] == 1, "normal of point %lld", (long long)p);
    if (s->boundary_flag[p] == 8)
    {
      ++nodes;
      double next = INFINITY;
      for (int i = 0; i < o->iso_count; ++i)
      {
        next = o->iso_values[i] > s->iso_value[p] ? fmin(next, o->iso_values[i]) : next;
      }
      CORE_CHECK(at.value > s->iso_value[p] - 3e-5 * scale && at.value < next + 3e-5 * scale,
        "%g is not from %g to %g", at.value, s->iso_value[p], next);
      CORE_CHECK(o->field == MCOR_WEIGHT_SUM || o->boundary_detection ||
          at.weight > o->vertex_threshold - 1e-4,
        "a node with weight %g", at.weight);
    }
    CORE_CHECK(s->boundary_flag[p] != 1 || o->wall_share != 0 || o->boundary_detection ||
        fabs(at.weight - o->vertex_threshold) < 1e-4,
      "a cut with weight %g", at.weight);
  }
  CORE_CHECK(nodes > 0, "no nodes");
}

double fill_sample(const plane_field* f, double iso, int n)
{
  double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
  for (int64_t i = 0; i < f->set->count; ++i)
  {
    for (int a = 0; a < 2; ++a)
    {
      const double x = f->set->position[3 * i + (f->axis + 1 + a) % 3];
      low[a] = fmin(low[a], x - 3);
      high[a] = fmax(high[a], x + 3);
    }
  }
  int64_t inside = 0;
  for (int64_t i = 0; i < (int64_t)n * n; ++i)
  {
    const plane_sample at =
      plane_evaluate(f, low[0] + (high[0] - low[0]) * ((double)(i % n) + 0.5) / n,
        low[1] + (high[1] - low[1]) * ((double)(i / n) + 0.5) / n);
    inside += at.value >= iso &&
      (f->options->field == MCOR_WEIGHT_SUM || at.weight >= f->options->vertex_threshold);
  }
  return (double)inside / ((double)n * n) * (high[0] - low[0]) * (high[1] - low[1]);
}
