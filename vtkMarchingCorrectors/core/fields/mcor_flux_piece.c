/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Integrals over pieces. A piece whose corners are all in fluid is integrated by a quadrature
 * that is exact for cubic functions; its points are the corners, the middles of edges, and the
 * middle. A piece with corners on both sides is cut along the chord between the crossings of its
 * edges with the level. */

#include "mcor_flux.h"
#include "mcor_vector.h"

#include <stdlib.h>
#include <string.h>

/* A parabola through the ends and the middle of an edge goes beyond them by at most an eighth of
 * its bend. If the level is nearer than four times this, the level may cross the edge twice. */
#define MCOR_FLUX_NEAR 0.5
/* Weights bend by about 4 / h^2. Between two samples they differ from a line by an eighth of the
 * bend times the square of the distance. */
#define MCOR_FLUX_BEND 0.125
/* Rounds of mcor_solve_crossings, after which a crossing is known to 1e-5 of its edge. */
#define MCOR_FLUX_SOLVE_ROUNDS 2

const mcor_flux_form mcor_flux_forms[2] = {
  { 3, 7, 4, { 1 / 20.0, 1 / 20.0, 1 / 20.0, 2 / 15.0, 2 / 15.0, 2 / 15.0, 9 / 20.0 },
    { { 0, 3, 5 }, { 3, 1, 4 }, { 5, 4, 2 }, { 3, 4, 5 } } },
  { 2, 3, 2, { 1 / 6.0, 1 / 6.0, 2 / 3.0 }, { { 0, 2, 2 }, { 2, 1, 1 } } },
};

mcor_status mcor_sample_flux(mcor_flux_job* job, int count)
{
  mcor_flux_field* field = &job->field;
  mcor_probe_run* run = job->edges.run;
  double* points = (double*)run->points->data;
  for (int i = 0; i < count; ++i)
  {
    mcor_map_patch(job, field->at[i], points + 3 * i);
  }
  memset(field->velocity, 0, (size_t)count * (size_t)job->velocity_components * sizeof(double));
  memset(field->density, 0, (size_t)count * sizeof(double));
  run->samples->values = field->values;
  return mcor_sample_level(&job->edges, field->weight, count);
}

double mcor_speed_along(const mcor_flux_job* job, int64_t sample, const double direction[3])
{
  double sum = 0;
  for (int c = 0; c < job->velocity_components; ++c)
  {
    sum += job->field.velocity[sample * job->velocity_components + c] * direction[c];
  }
  return sum;
}

void mcor_place_point(const mcor_flux_job* job, const mcor_flux_piece* piece, int k, double at[3])
{
  const int corners = job->form->corners;
  const double(*c)[2] = piece->corner;
  for (int p = 0; p < 2; ++p)
  {
    at[p] = k < corners ? c[k][p]
      : k == 6          ? (c[0][p] + c[1][p] + c[2][p]) / 3
                        : 0.5 * (c[k - corners][p] + c[(k - corners + 1) % corners][p]);
  }
  at[2] = (double)piece->patch;
}

/* Adds the integrals of a piece. first: number of its first sample. */
static void mcor_integrate_piece(
  const mcor_flux_job* job, const mcor_flux_piece* piece, int64_t first, double sum[MCOR_FLUX_SUMS])
{
  const mcor_patch* patch = &job->patches.of[piece->patch];
  const double(*c)[2] = piece->corner;
  const double du = c[1][0] - c[0][0],
               twice = du * (c[2][1] - c[0][1]) - (c[2][0] - c[0][0]) * (c[1][1] - c[0][1]);
  const double size = job->is_plane ? fabs(du) : 0.5 * fabs(twice);
  for (int k = 0; k < job->form->points; ++k)
  {
    const double area =
      job->form->share[k] * size * mcor_patch_measure(patch, job->field.at[first + k]);
    const double flux = area * mcor_speed_along(job, first + k, patch->normal);
    sum[0] += area;
    sum[1] += flux;
    sum[2] += job->field.density[first + k] * flux;
  }
}

/* ---- cuts ---- */

/* Appends a line, in parameters, that the level crosses. */
static mcor_status mcor_append_crossed(mcor_flux_job* job, const double from[3], const double to[3],
  double from_weight, double to_weight)
{
  mcor_gauge_line line = { .name = NULL };
  memcpy(line.from, from, sizeof line.from);
  memcpy(line.to, to, sizeof line.to);
  MCOR_APPEND(job->edges.context, &job->edges.changed,
    (mcor_gauge_part){ job->lines.count, 0, 1, from_weight, to_weight });
  MCOR_APPEND(job->edges.context, &job->lines, line);
  return MCOR_OK;
}

/* Finds where the level crosses the lines appended so far. The changed parts are kept for
 * mcor_crossing_at. */
static mcor_status mcor_solve_lines(mcor_flux_job* job)
{
  mcor_context* context = job->edges.context;
  const int arrays = context->attributes.count;
  job->edges.lines = job->lines.of;
  context->attributes.count = 0; /* crossings depend only on the weight sums */
  const mcor_status status = mcor_solve_crossings(&job->edges, MCOR_FLUX_SOLVE_ROUNDS, true);
  context->attributes.count = arrays;
  return status;
}

/* Sets `at` to the parameters at which line i is crossed. */
static void mcor_crossing_at(const mcor_flux_job* job, int64_t i, double at[2])
{
  const mcor_gauge_line* line = &job->lines.of[i];
  const double place = mcor_crossing_of(&job->edges, &job->edges.changed.of[i]);
  double point[3];
  mcor_point_between(line->from, line->to, place, point);
  memcpy(at, point, 2 * sizeof *at);
}

/* Returns the corner of a triangle that is alone on its side. */
static int mcor_lone_corner(int sides)
{
  static const int lone[8] = { 0, 0, 1, 2, 2, 1, 0, 0 };
  return lone[sides];
}

/* Whether the level may cross an edge whose ends are on one side of it. */
static bool mcor_may_cross(const mcor_flux_job* job, const mcor_flux_piece* piece, int from, int to,
  const double* weight, double middle)
{
  const double level = job->edges.level;
  const double ends[2] = { weight[from] - level, weight[to] - level };
  const double nearest = fmin(fabs(middle - level), fmin(fabs(ends[0]), fabs(ends[1])));
  double at[3], points[2][3], way[3];
  mcor_place_point(job, piece, from, at);
  mcor_map_patch(job, at, points[0]);
  mcor_place_point(job, piece, to, at);
  mcor_map_patch(job, at, points[1]);
  for (int a = 0; a < 3; ++a)
  {
    way[a] = (points[1][a] - points[0][a]) / job->smoothing_length;
  }
  return (middle >= level) != (ends[0] >= 0) || nearest < MCOR_FLUX_BEND * mcor_dot(way, way) ||
    nearest < MCOR_FLUX_NEAR * fabs(ends[0] + ends[1] - 2 * (middle - level));
}

/* Sorts a piece by its samples: integrates it if it lies in fluid, appends a cut if the level
 * crosses it. */
static mcor_status mcor_take_piece(
  mcor_flux_job* job, mcor_flux_piece* piece, int64_t number, int64_t first)
{
  const double* weight = job->field.weight + first;
  const int corners = job->form->corners, count = job->form->points, all = (1 << corners) - 1;
  bool in[MCOR_FLUX_POINTS];
  int sides = 0;
  for (int k = 0; k < count; ++k)
  {
    in[k] = weight[k] >= job->edges.level;
    sides |= k < corners && in[k] ? 1 << k : 0;
  }
  piece->unclear = !job->is_plane && (sides == 0 || sides == all) && in[6] != in[0];
  for (int e = 0; e < count - corners && e < corners; ++e)
  {
    const int next = (e + 1) % corners;
    piece->unclear = piece->unclear ||
      (in[e] == in[next] && mcor_may_cross(job, piece, e, next, weight, weight[corners + e]));
  }
  memset(piece->sum, 0, sizeof piece->sum);
  if (sides == all)
  {
    mcor_integrate_piece(job, piece, first, piece->sum);
  }
  if (sides == 0 || sides == all)
  {
    return MCOR_OK;
  }
  MCOR_APPEND(job->edges.context, &job->cuts, ((mcor_flux_cut){ .piece = number, .sides = sides }));
  const int lone = job->is_plane ? 0 : mcor_lone_corner(sides);
  for (int other = 1; other < corners; ++other)
  {
    const int to = (lone + other) % corners;
    double from_at[3], to_at[3];
    mcor_place_point(job, piece, lone, from_at);
    mcor_place_point(job, piece, to, to_at);
    MCOR_TRY(mcor_append_crossed(job, from_at, to_at, weight[lone], weight[to]));
  }
  return MCOR_OK;
}

/* Samples all pieces. If `wholes` is given, the pieces are their parts in fluid, and are added to
 * their sums. */
static mcor_status mcor_sample_pieces(
  mcor_flux_job* job, mcor_flux_pieces* pieces, mcor_flux_pieces* wholes)
{
  const int points = job->form->points, most = MCOR_GAUGE_BATCH / points;
  for (int64_t first = 0; first < pieces->count; first += most)
  {
    const int64_t rest = pieces->count - first;
    const int count = rest < most ? (int)rest : most;
    for (int i = 0; i < count * points; ++i)
    {
      mcor_place_point(job, &pieces->of[first + i / points], i % points, job->field.at[i]);
    }
    MCOR_TRY(mcor_sample_flux(job, count * points));
    for (int i = 0; i < count; ++i)
    {
      mcor_flux_piece* piece = &pieces->of[first + i];
      const int64_t sample = (int64_t)i * points;
      if (wholes)
      {
        mcor_integrate_piece(job, piece, sample, wholes->of[piece->whole].sum);
        continue;
      }
      MCOR_TRY(mcor_take_piece(job, piece, first + i, sample));
    }
  }
  return MCOR_OK;
}

/* Appends a part of a cut piece that lies in fluid. */
static mcor_status mcor_append_inside(mcor_flux_job* job, const mcor_flux_piece* piece,
  int64_t number, const double* a, const double* b, const double* c)
{
  mcor_flux_piece part = { .patch = piece->patch, .whole = number };
  memcpy(part.corner[0], a, sizeof part.corner[0]);
  memcpy(part.corner[1], b, sizeof part.corner[1]);
  memcpy(part.corner[2], c, sizeof part.corner[2]);
  MCOR_APPEND(job->edges.context, &job->inside, part);
  return MCOR_OK;
}

mcor_status mcor_measure_pieces(mcor_flux_job* job, mcor_flux_pieces* pieces)
{
  const int crossings = job->form->corners - 1;
  job->cuts.count = job->inside.count = job->lines.count = job->edges.changed.count = 0;
  MCOR_TRY(mcor_sample_pieces(job, pieces, NULL));
  if (job->cuts.count == 0)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_solve_lines(job));
  for (int64_t i = 0; i < crossings * job->cuts.count; ++i)
  {
    mcor_flux_cut* cut = &job->cuts.of[i / crossings];
    mcor_crossing_at(job, i, cut->crossing[i % crossings]);
  }
  /* Appends the part of a triangle up to the chord between its crossings, or of a line up to its
   * crossing. */
  for (int64_t c = 0; c < job->cuts.count; ++c)
  {
    const mcor_flux_cut* cut = &job->cuts.of[c];
    const mcor_flux_piece* piece = &pieces->of[cut->piece];
    const int64_t n = cut->piece;
    const int lone = mcor_lone_corner(cut->sides);
    const double *p = cut->crossing[0], *q = cut->crossing[1];
    const double *here = piece->corner[lone], *next = piece->corner[(lone + 1) % 3],
                 *last = piece->corner[(lone + 2) % 3];
    if (job->is_plane)
    {
      MCOR_TRY(mcor_append_inside(job, piece, n, piece->corner[cut->sides == 1 ? 0 : 1], p, p));
      continue;
    }
    const bool lone_in = cut->sides >> lone & 1;
    MCOR_TRY(mcor_append_inside(
      job, piece, n, lone_in ? here : p, lone_in ? p : next, lone_in ? q : last));
    MCOR_TRY(lone_in ? MCOR_OK : mcor_append_inside(job, piece, n, p, last, q));
  }
  return mcor_sample_pieces(job, &job->inside, pieces);
}
