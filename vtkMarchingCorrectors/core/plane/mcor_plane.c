/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Two dimensions: the plane, and how coordinates are turned. */

#include "mcor_plane.h"
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_ranks.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* n_2 / n_3, see mcor_sph_kernel.h; tested numerically. */
double mcor_plane_factor(mcor_sph_kernel kernel)
{
  static const double factor[] = { 10.0 / 7, 8.0 / 5, 1, 420.0 / 239, 4.0 / 3, 1920.0 / 1199,
    64.0 / 55, 256.0 / 245, 1.0635845764083532547 };
  _Static_assert(sizeof factor / sizeof factor[0] == MCOR_SPH_KERNEL_COUNT, "one for each kernel");
  return factor[kernel];
}

/* ---- The plane ---- */

/* What of a coordinate is the same for all: [low, high], everything where some differ, nothing where there
 * are no particles. */
static void mcor_find_constant(
  const mcor_array* positions, int64_t count, int axis, double* low, double* high)
{
  const double first = count > 0 ? mcor_array_at(positions, 0, axis) : 0;
  const bool constant = count > 0 && isfinite(first) &&
    mcor_array_at(positions, count - 1, axis) == first && mcor_is_constant(positions, count, axis);
  *low = constant ? first : count > 0 ? -DBL_MAX : DBL_MAX;
  *high = constant ? first : -*low;
}

/* Whether positions can be looked at; what is wrong otherwise is for mcor_check_input to say. */
static bool mcor_has_positions(const mcor_input* input)
{
  const mcor_array* positions = &input->positions;
  return input->count == 0 ||
    (input->count > 0 && input->count <= MCOR_PARTICLE_LIMIT && positions->data &&
      (unsigned)positions->type <= MCOR_FLOAT64);
}

int mcor_find_dimension(const mcor_input* input, int dimension)
{
  int constant = 0;
  mcor_array positions = input->positions;
  positions.components = 3;
  for (int a = 0; a < 3 && dimension != 3 && mcor_has_positions(input); ++a)
  {
    double low, high;
    mcor_find_constant(&positions, input->count, a, &low, &high);
    constant += low == high;
  }
  return dimension == 2 || constant == 1 ? 2 : 3;
}

/* Who is not in the plane of the others: a solid, if all fluid is in one. */
static mcor_status mcor_refuse_plane(mcor_context* context, const mcor_input* input)
{
  mcor_array positions = input->positions;
  positions.components = 3;
  if (mcor_find_not_finite(&positions, NULL, input->count) >= 0)
  {
    return MCOR_OK; /* for mcor_check_input to say */
  }
  for (int a = 2; a >= 0 && input->solid; --a)
  {
    int64_t fluid = 0, other = 0, solid = -1;
    while (fluid < input->count && input->solid[fluid])
    {
      ++fluid;
    }
    const double at = fluid < input->count ? mcor_array_at(&positions, fluid, a) : NAN;
    for (int64_t i = 0; i < input->count; ++i)
    {
      const bool off = mcor_array_at(&positions, i, a) != at;
      other += off && !input->solid[i];
      solid = solid < 0 && off && input->solid[i] ? i : solid;
    }
    MCOR_RETURN_IF(other == 0 && solid >= 0, context, MCOR_INVALID_DATA,
      "The fluid particles have %c = %g, but solid particle %lld has %g: in two dimensions all lie "
      "in "
      "one plane. Correct its position, or use three dimensions.",
      "xyz"[a], at, (long long)solid, mcor_array_at(&positions, solid, a));
  }
  return mcor_fail(context, MCOR_INVALID_DATA,
    "The particles do not share one coordinate exactly, as two dimensions need: neither x, y nor z "
    "is the "
    "same for all. Turn or move them into a plane of constant x, y or z, or use three dimensions.");
}

/* In ranks and globals, the same for all. */
static mcor_status mcor_find_plane(
  mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  mcor_plane* plane = &context->plane;
  const mcor_globals* globals = options->globals;
  *plane = (mcor_plane){ 0 };
  if (options->dimension == 3 || globals || !mcor_has_positions(input))
  {
    *plane = globals ? globals->measured.plane : *plane;
    return MCOR_OK;
  }
  mcor_array positions = input->positions;
  positions.components = 3;
  double low[3], high[3];
  for (int a = 0; a < 3; ++a)
  {
    mcor_find_constant(&positions, input->count, a, &low[a], &high[a]);
  }
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_LEAST, low, 3));
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_GREATEST, high, 3));
  int constant = 0;
  for (int a = 0; a < 3; ++a)
  {
    constant += low[a] == high[a];
    plane->axis = low[a] == high[a] ? a + 1 : plane->axis;
    plane->at = low[a] == high[a] ? low[a] : plane->at;
  }
  const bool some = low[0] <= high[0];
  MCOR_TRY(
    options->dimension == 2 && some && constant == 0 ? mcor_refuse_plane(context, input) : MCOR_OK);
  if (options->dimension == 0 &&
    constant != 1) /* a line or a point is not known to be in a plane */
  {
    *plane = (mcor_plane){ 0 };
  }
  return MCOR_OK;
}

/* ---- Turning ---- */

typedef struct mcor_flatten_job
{
  const mcor_plane* plane;
  mcor_array positions;
  void* to;        /* of the positions' type, points as doubles */
  bool are_points; /* which may lie off the plane */
} mcor_flatten_job;

/* Positions in single precision, which they keep. */
static void mcor_flatten_floats(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_flatten_job* job = data;
  const int u = mcor_plane_axis(job->plane, 0), v = mcor_plane_axis(job->plane, 1);
  const float* from = job->positions.data;
  float* to = job->to;
  for (int64_t i = 3 * first; i < 3 * last; i += 3)
  {
    to[i] = from[i + u];
    to[i + 1] = from[i + v];
    to[i + 2] = 0;
  }
  (void)slice;
}

static void mcor_flatten_doubles(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_flatten_job* job = data;
  double x[MCOR_CHUNK], *to = job->to;
  for (int64_t begin = first; begin < last; begin += MCOR_CHUNK)
  {
    const int count = last - begin < MCOR_CHUNK ? (int)(last - begin) : MCOR_CHUNK;
    for (int a = 0; a < 3; ++a)
    {
      mcor_read_array(&job->positions, begin, count, mcor_plane_axis(job->plane, a), x);
      for (int i = 0; i < count; ++i)
      {
        const bool off = a == 2 && job->are_points && x[i] != job->plane->at;
        to[3 * (begin + i) + a] = a < 2 ? x[i] : off ? NAN : 0;
      }
    }
  }
  (void)slice;
}

/* Sides of a box: of a plane inside all, else nothing. */
static void mcor_flatten_sides(const mcor_plane* plane, const double from[6], double to[6])
{
  bool has = false;
  double sides[6];
  for (int i = 0; i < 6; ++i)
  {
    has = has || from[i] != 0;
    sides[i] = from[2 * mcor_plane_axis(plane, i / 2) + i % 2];
  }
  if (has && !isnan(sides[4]) && !isnan(sides[5]) && sides[4] < sides[5])
  {
    const bool inside = sides[4] <= plane->at && plane->at < sides[5];
    sides[4] = inside ? -INFINITY : DBL_MAX;
    sides[5] = INFINITY;
  }
  memcpy(to, sides, sizeof sides);
}

static mcor_status mcor_flatten_positions(mcor_context* context, mcor_flat* flat)
{
  const mcor_input* input = &flat->input;
  const bool floats = input->positions.type == MCOR_FLOAT32;
  flat->positions =
    malloc((size_t)input->count * 3 * (floats ? sizeof(float) : sizeof(double)) + 1);
  MCOR_RETURN_IF(!flat->positions, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for %lld particles could not be allocated.", (long long)input->count);
  mcor_flatten_job job = { &context->plane, input->positions, flat->positions, false };
  job.positions.components = 3;
  MCOR_TRY(mcor_parallel_run(context, input->count, MCOR_LIGHT_GRAIN,
    floats ? mcor_flatten_floats : mcor_flatten_doubles, &job, NULL));
  flat->input.positions.data = flat->positions;
  flat->input.positions.components = 3;
  return MCOR_OK;
}

mcor_status mcor_flatten_points(
  mcor_context* context, const mcor_array* points, int64_t count, mcor_array* turned, double** flat)
{
  *flat = malloc((size_t)count * 3 * sizeof(double) + 1);
  MCOR_RETURN_IF(!*flat, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for %lld points could not be allocated.", (long long)count);
  mcor_flatten_job job = { &context->plane, *points, *flat, true };
  job.positions.components = 3;
  mcor_parallel_for(count, MCOR_LIGHT_GRAIN, mcor_flatten_doubles, &job);
  *turned = (mcor_array){ .data = *flat, .type = MCOR_FLOAT64, .components = 3 };
  return MCOR_OK;
}

mcor_status mcor_flatten(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_flat* flat)
{
  const mcor_plane* plane = &context->plane;
  mcor_options* o = &flat->options;
  *flat = (mcor_flat){ .input = *input, .options = *options };
  MCOR_RETURN_IF(options->dimension != 0 && options->dimension != 2 && options->dimension != 3,
    context, MCOR_INVALID_ARGUMENT, "The dimension is %d; it must be 2, 3, or 0 to be found.",
    options->dimension);
  MCOR_TRY(mcor_find_plane(context, input, options));
  o->dimension = mcor_is_plane(context) ? 2 : 3;
  if (!mcor_is_plane(context))
  {
    return MCOR_OK;
  }
  MCOR_RETURN_IF(options->capping, context, MCOR_INVALID_ARGUMENT,
    "Capping closes surfaces in three dimensions; these particles lie in a plane. Turn it off.");
  if (options->filled) /* pairs may miss lines that a region ends at */
  {
    o->seeds = MCOR_COMPLETE;
    o->level_limit = 0;
    o->iso_value = 1;
  }
  mcor_flatten_sides(plane, options->box, o->box);
  for (int i = 0; i < 6; ++i) /* a period across the plane means nothing */
  {
    o->periodic[i] = i < 4 ? options->periodic[2 * mcor_plane_axis(plane, i / 2) + i % 2] : 0;
  }
  if (options->ranks)
  {
    flat->ranks = *options->ranks;
    flat->ranks.pass = NULL; /* places would be turned */
    mcor_flatten_sides(plane, options->ranks->whole_box, flat->ranks.whole_box);
    o->ranks = &flat->ranks;
  }
  return mcor_has_positions(input) ? mcor_flatten_positions(context, flat) : MCOR_OK;
}

void mcor_unflatten_doubles(
  const mcor_plane* plane, double* numbers, int64_t count, double constant)
{
  for (int64_t i = 0; i < count && numbers; ++i)
  {
    double* x = numbers + 3 * i;
    const double u = x[0], v = x[1];
    x[mcor_plane_axis(plane, 0)] = u;
    x[mcor_plane_axis(plane, 1)] = v;
    x[mcor_plane_axis(plane, 2)] = constant;
  }
}

void mcor_unflatten_floats(const mcor_plane* plane, float* numbers, int64_t count)
{
  for (int64_t i = 0; i < count && numbers; ++i)
  {
    float* x = numbers + 3 * i;
    const float u = x[0], v = x[1];
    x[mcor_plane_axis(plane, 0)] = u;
    x[mcor_plane_axis(plane, 1)] = v;
    x[mcor_plane_axis(plane, 2)] = 0;
  }
}

void mcor_unflatten_statistics(const mcor_plane* plane, mcor_statistics* s)
{
  double extent[3];
  int64_t origin[3], cells[3];
  for (int a = 0; a < 3; ++a)
  {
    const int axis = mcor_plane_axis(plane, a);
    extent[axis] = s->fluid_extent[a];
    origin[axis] = s->lattice_origin[a];
    cells[axis] = s->lattice_cells[a];
  }
  memcpy(s->fluid_extent, extent, sizeof extent);
  memcpy(s->lattice_origin, origin, sizeof origin);
  memcpy(s->lattice_cells, cells, sizeof cells);
}
