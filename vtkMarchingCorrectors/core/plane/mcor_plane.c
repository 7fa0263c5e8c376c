/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Two dimensions: turns coordinates into the plane and back, and launches a kernel for squares. */

#include "mcor_plane.h"
#include "mcor_adaptive.h"
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_vector.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Turning ---- */

typedef struct mcor_flatten_job
{
  const mcor_plane* plane;
  mcor_array positions;
  bool are_points; /* `positions` are points, which may lie off the plane */
  double* flat;
} mcor_flatten_job;

static void mcor_flatten_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_flatten_job* job = data;
  double x[MCOR_CHUNK];
  for (int64_t begin = first; begin < last; begin += MCOR_CHUNK)
  {
    const int count = mcor_chunk_of(last - begin);
    for (int a = 0; a < 3; ++a)
    {
      mcor_read_array(&job->positions, begin, count, mcor_plane_axis(job->plane, a), x);
      for (int i = 0; i < count; ++i)
      {
        const bool off = job->are_points && x[i] != job->plane->at;
        job->flat[3 * (begin + i) + a] = a < 2 ? x[i] : off ? NAN : 0;
      }
    }
  }
  (void)slice;
}

void mcor_flatten_sides(const mcor_plane* plane, const double from[6], double to[6])
{
  double sides[6];
  for (int i = 0; i < 6; ++i)
  {
    sides[i] = from[2 * mcor_plane_axis(plane, i / 2) + i % 2];
  }
  if (mcor_has_sides(from) && !isnan(sides[4]) && !isnan(sides[5]) && sides[4] <= sides[5])
  {
    /* A flat box contains the plane in which it lies. */
    const bool inside = sides[4] <= plane->at && (plane->at < sides[5] || plane->at == sides[4]);
    sides[4] = inside ? -INFINITY : DBL_MAX;
    sides[5] = INFINITY;
  }
  memcpy(to, sides, sizeof sides);
}

mcor_status mcor_flatten_positions(mcor_context* context, const mcor_array* positions,
  int64_t count, bool are_points, mcor_array* turned, double** flat)
{
  *flat = malloc((size_t)count * 3 * sizeof(double) + 1);
  MCOR_FAIL_IF(!*flat, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(HOST_MEMORY_FOR), (long long)count,
    are_points ? "points" : "particles");
  mcor_flatten_job job = { &context->plane, *positions, are_points, *flat };
  job.positions.components = 3;
  mcor_parallel_for(context, count, MCOR_LIGHT_GRAIN, mcor_flatten_slice, &job);
  *turned = (mcor_array){ .data = *flat, .type = MCOR_FLOAT64, .components = 3 };
  return MCOR_OK;
}

mcor_status mcor_flatten(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_flat* flat)
{
  const mcor_plane* plane = &context->plane;
  mcor_options* o = &flat->options;
  MCOR_FAIL_IF(options->capping && options->filled, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(CAPPING_WITH_FILLED));
  if (options->filled) /* pairs may miss lines that bound a filled region */
  {
    o->seeds = MCOR_COMPLETE;
    o->level_limit = 0;
    o->outputs |= MCOR_OUT_ISO_VALUE;
  }
  mcor_flatten_sides(plane, options->box, o->box);
  for (int i = 0; i < 6; ++i) /* a period across the plane has no meaning */
  {
    o->periodic[i] = i < 4 ? options->periodic[2 * mcor_plane_axis(plane, i / 2) + i % 2] : 0;
  }
  o->outputs &= ~(unsigned)MCOR_OUT_GAUSS_CURVATURE; /* lines have no Gaussian curvature */
  if (options->globals)
  {
    flat->globals = *options->globals;
    mcor_turn_measure(&flat->globals.measured, false);
    o->globals = &flat->globals;
  }
  if (options->ranks)
  {
    flat->ranks = *options->ranks;
    mcor_flatten_sides(plane, options->ranks->whole_box, flat->ranks.whole_box);
    o->ranks = &flat->ranks;
  }
  const bool is_flat = plane->axis == 3 && plane->at == 0;
  return is_flat || !mcor_has_positions(input)
    ? MCOR_OK
    : mcor_flatten_positions(
        context, &input->positions, input->count, false, &flat->input.positions, &flat->positions);
}

void mcor_turn_back(const mcor_plane* plane, void* numbers, size_t width)
{
  char from[3 * sizeof(double)], *to = numbers;
  memcpy(from, numbers, 3 * width);
  for (int a = 0; a < 3; ++a)
  {
    memcpy(to + (size_t)mcor_plane_axis(plane, a) * width, from + (size_t)a * width, width);
  }
}

void mcor_unflatten_doubles(
  const mcor_plane* plane, double* numbers, int64_t count, double constant)
{
  for (int64_t i = 0; i < count && numbers && plane->axis > 0; ++i)
  {
    numbers[3 * i + 2] = constant;
    mcor_turn_back(plane, numbers + 3 * i, sizeof *numbers);
  }
}

/* Across the plane, bounds are the plane less and plus the largest support. */
void mcor_turn_measure(mcor_measure* measure, bool back)
{
  const mcor_measure from = *measure;
  const double at = back ? from.plane.at : 0;
  for (int a = 0; a < 3 && from.plane.axis > 0; ++a)
  {
    const int axis = mcor_plane_axis(&from.plane, a), f = back ? a : axis, t = back ? axis : a;
    measure->low[t] = a < 2 ? from.low[f] : at - from.support_max;
    measure->high[t] = a < 2 ? from.high[f] : at + from.support_max;
    measure->x_low[t] = a < 2 ? from.x_low[f] : at;
    measure->x_high[t] = a < 2 ? from.x_high[f] : at;
    measure->edge[t] = from.edge[f];
    measure->cut_high[t] = a < 2 ? from.cut_high[f] : at + from.support_max;
  }
}

void mcor_unflatten_statistics(const mcor_plane* plane, mcor_statistics* s)
{
  if (plane->axis == 0)
  {
    return;
  }
  mcor_turn_back(plane, s->fluid_extent, sizeof *s->fluid_extent);
  mcor_turn_back(plane, s->far_place, sizeof *s->far_place);
  s->far_place[plane->axis - 1] = plane->at;
  mcor_turn_back(plane, s->lattice_origin, sizeof *s->lattice_origin);
  mcor_turn_back(plane, s->lattice_cells, sizeof *s->lattice_cells);
}

/* ---- Marching squares, see mcor_plane.cl ---- */

mcor_status mcor_keep_squares(mcor_context* context, mcor_buffer* cells)
{
  const int count = context->bricks.now.count;
  return !mcor_is_plane(context) ? MCOR_OK
                                 : MCOR_LAUNCH(context, "mcor_plane_squares", MCOR_LIGHT, count,
                                     MCOR_INT(count), MCOR_BUFFER(cells));
}
