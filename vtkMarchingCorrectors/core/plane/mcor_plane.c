/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Two dimensions: finding the plane, turning coordinates into it and back, and launches that
 * differ there. */

#include "mcor_plane.h"
#include "mcor_adaptive.h"
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_vector.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- The plane ---- */

/* Finds the ranges of the particles along x, y, z: first the fluid's, then those of the solids that
 * play a part. */
typedef struct mcor_spread_job
{
  const mcor_input* input;
  mcor_findings slices[MCOR_SLICES];
} mcor_spread_job;

/* Whether all particles are where the fluid has been so far; written to be vectorised. */
static bool mcor_is_all_at(const double* x, int count, double low, double high)
{
  int off = low != high;
  for (int i = 0; i < count; ++i)
  {
    off |= x[i] != low;
  }
  return !off;
}

/* Stops along an axis once the fluid is not flat there: how far it goes then does not matter. */
static void mcor_extent_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_spread_job* job = data;
  const mcor_input* input = job->input;
  mcor_findings spread = mcor_no_findings();
  bool everywhere = false;
  for (int64_t begin = first; begin < last && !everywhere; begin += MCOR_CHUNK)
  {
    const int count = mcor_chunk_of(last - begin);
    double x[MCOR_CHUNK];
    everywhere = true;
    for (int a = 0; a < 3; ++a)
    {
      if (spread.least[a] < spread.most[a])
      {
        continue;
      }
      mcor_read_array(&input->positions, begin, count, a, x);
      const bool same = !input->solid && mcor_is_all_at(x, count, spread.least[a], spread.most[a]);
      for (int i = 0; i < count && !same; ++i)
      {
        const bool solid = input->solid && input->solid[begin + i], finite = isfinite(x[i]);
        if (mcor_is_present(input, begin + i) && (finite || !solid))
        {
          mcor_add_range(
            &spread, solid ? 3 + a : a, finite ? x[i] : -DBL_MAX, finite ? x[i] : DBL_MAX);
        }
      }
      everywhere = everywhere && spread.least[a] < spread.most[a];
    }
  }
  job->slices[slice] = spread;
}

/* Whether positions can be read; mcor_check_input reports what is wrong otherwise. */
static bool mcor_has_positions(const mcor_input* input)
{
  return input->count > 0 && input->count <= MCOR_PARTICLE_LIMIT && input->positions.data &&
    (unsigned)input->positions.type <= MCOR_FLOAT64;
}

static mcor_findings mcor_spread_of(mcor_context* context, const mcor_input* input)
{
  mcor_input given = *input;
  mcor_spread_job job = { .input = &given };
  given.positions.components = 3;
  const int slices = mcor_has_positions(input)
    ? mcor_parallel_for(context, input->count, MCOR_LIGHT_GRAIN, mcor_extent_slice, &job)
    : 0;
  return mcor_merge_findings(job.slices, slices);
}

/* Chooses the plane. Particles on a line, or at a point, lie in no known plane, unless the
 * caller says so. */
static mcor_plane mcor_plane_of(const mcor_findings* spread, int dimension)
{
  mcor_plane plane = { 0 };
  int constant = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double low = fmin(spread->least[a], spread->least[3 + a]),
                 high = fmax(spread->most[a], spread->most[3 + a]);
    constant += low == high;
    plane = low == high ? (mcor_plane){ a + 1, low + 0.0 } : plane; /* never -0 */
  }
  return dimension == 2 || constant == 1 ? plane : (mcor_plane){ 0 };
}

int mcor_find_dimension(const mcor_input* input, const mcor_ranks* ranks, int dimension)
{
  mcor_findings spread = mcor_spread_of(NULL, input);
  if (ranks &&
    (ranks->reduce_doubles(ranks->user, MCOR_LEAST, spread.least, 6) ||
      ranks->reduce_doubles(ranks->user, MCOR_GREATEST, spread.most, 6)))
  {
    return 3; /* another rank failed */
  }
  return dimension == 2 || (dimension == 0 && mcor_plane_of(&spread, 0).axis > 0) ? 2 : 3;
}

/* Names the first particle off the plane (a solid one if all fluid shares a plane). */
static mcor_status mcor_refuse_plane(
  mcor_context* context, const mcor_input* input, const mcor_findings* spread)
{
  const char* const rule = "in two dimensions all particles must lie in one plane. Correct these "
                           "positions, or use three dimensions";
  const mcor_array* positions = &input->positions;
  if (mcor_find_not_finite(context, positions, input->solid, input->count) >= 0)
  {
    return MCOR_OK; /* mcor_check_input reports it */
  }
  for (int a = 2; a >= 0; --a)
  {
    const double at = spread->least[a], solids = spread->least[3 + a];
    const bool in_plane = at == spread->most[a];
    MCOR_RETURN_IF(in_plane && solids == spread->most[3 + a], context, MCOR_INVALID_DATA,
      "The fluid particles have %c = %.10g, but the solid ones have %.10g: %s.", "xyz"[a], at,
      solids, rule);
    int64_t i = 0;
    while (in_plane && i < input->count &&
      (mcor_array_at(positions, i, a) == at || !mcor_is_present(input, i)))
    {
      ++i;
    }
    MCOR_RETURN_IF(in_plane && i < input->count, context, MCOR_INVALID_DATA,
      "The fluid particles have %c = %.10g, but solid particle %lld has %.10g: %s.", "xyz"[a], at,
      (long long)i, mcor_array_at(positions, i, a), rule);
  }
  return mcor_fail(context, MCOR_INVALID_DATA,
    "The particles do not share one coordinate exactly, but two dimensions need that. Turn or move "
    "the particles into a plane of constant x, y or z, or use three dimensions.");
}

/* Particles sampled in the search for twins. */
#define MCOR_TWIN_SAMPLES 32
/* The share of the spacing, of particles strewn evenly over the plane, that a step of single
 * precision must have to have flattened them. */
#define MCOR_COARSE_SHARE 0.125

/* Whether rounding made the plane: its coordinate is so large that single precision rounds it by
 * about the particles' spacing, and most particles lie on others. */
static mcor_status mcor_is_rounding(mcor_context* context, const mcor_input* input,
  const mcor_findings* spread, const mcor_plane* plane, bool* rounding)
{
  const mcor_array* positions = &input->positions;
  int64_t counts[3] = { 0 }; /* particles; samples, and those with a twin */
  for (int64_t i = 0; i < input->count; ++i)
  {
    counts[0] += mcor_is_present(input, i);
  }
  MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, counts, 1));
  double area = 1;
  for (int a = 0; a < 2; ++a)
  {
    const int axis = mcor_plane_axis(plane, a);
    area *= fmax(spread->most[axis], spread->most[3 + axis]) -
      fmin(spread->least[axis], spread->least[3 + axis]);
  }
  const double spacing = sqrt(area / (double)(counts[0] > 0 ? counts[0] : 1));
  *rounding = plane->at != 0 && (double)(float)plane->at == plane->at &&
    ldexp(1, ilogb(plane->at) - 23) > MCOR_COARSE_SHARE * spacing;
  if (!*rounding)
  {
    return MCOR_OK;
  }
  for (int64_t i = 0; i < input->count && counts[1] < MCOR_TWIN_SAMPLES; ++i)
  {
    bool has_twin = false;
    for (int64_t k = 0; k < input->count && !has_twin; ++k)
    {
      has_twin = k != i;
      for (int a = 0; a < 2 && has_twin; ++a)
      {
        const int axis = mcor_plane_axis(plane, a);
        has_twin = mcor_array_at(positions, i, axis) == mcor_array_at(positions, k, axis);
      }
    }
    counts[1] += mcor_is_present(input, i);
    counts[2] += mcor_is_present(input, i) && has_twin;
  }
  MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, counts + 1, 2));
  *rounding = 2 * counts[2] > counts[1];
  return MCOR_OK;
}

static void mcor_set_plane(mcor_context* context, mcor_plane plane)
{
  static const mcor_space spaces[] = { { 3, 0, MCOR_BRICK_NODES, MCOR_REGION_BRICKS * MCOR_BRICK,
                                         4.0 / 3 * MCOR_PI, "mcor_node_values" },
    { 2, 1, MCOR_BRICK * MCOR_BRICK, 0, MCOR_PI, "mcor_plane_nodes" } };
  context->plane = plane;
  context->space = spaces[plane.axis > 0];
}

/* With ranks and globals, all ranks find the same. */
static mcor_status mcor_find_plane(
  mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  mcor_set_plane(context, options->globals ? options->globals->measured.plane : (mcor_plane){ 0 });
  if (options->dimension == 3 || options->globals)
  {
    return MCOR_OK;
  }
  mcor_findings spread = mcor_spread_of(context, input);
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_LEAST, spread.least, 6));
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_GREATEST, spread.most, 6));
  const mcor_plane plane = mcor_plane_of(&spread, options->dimension);
  bool rounding = false;
  if (plane.axis > 0 && options->dimension == 0)
  {
    MCOR_TRY(mcor_is_rounding(context, input, &spread, &plane, &rounding));
  }
  mcor_set_plane(context, rounding ? (mcor_plane){ 0 } : plane);
  const bool some = spread.least[0] <= spread.most[0] || spread.least[3] <= spread.most[3];
  int planes = 0;
  bool apart = false; /* fluid in one plane and solids in another: meant as two dimensions */
  for (int a = 0; a < 3; ++a)
  {
    const bool in_plane = spread.least[a] == spread.most[a];
    planes += in_plane;
    apart = apart || (in_plane && spread.least[3 + a] == spread.most[3 + a]);
  }
  const bool refused = options->dimension == 2 ? some : !rounding && planes == 1 && apart;
  return refused && !mcor_is_plane(context) ? mcor_refuse_plane(context, input, &spread) : MCOR_OK;
}

/* ---- Turning ---- */

typedef struct mcor_flatten_job
{
  const mcor_plane* plane;
  mcor_array positions;
  float* floats;   /* where they go if they are in single precision, else NULL */
  double* doubles; /* where they go otherwise; points always do */
  bool are_points; /* which may lie off the plane */
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
        const int64_t to = 3 * (begin + i) + a;
        const bool off = a == 2 && job->are_points && x[i] != job->plane->at;
        if (job->floats)
        {
          job->floats[to] = a < 2 ? (float)x[i] : 0;
          continue;
        }
        job->doubles[to] = a < 2 ? x[i] : off ? NAN : 0;
      }
    }
  }
  (void)slice;
}

void mcor_flatten_sides(const mcor_plane* plane, const double from[6], double to[6])
{
  bool has = false;
  double sides[6];
  for (int i = 0; i < 6; ++i)
  {
    has = has || from[i] != 0;
    sides[i] = from[2 * mcor_plane_axis(plane, i / 2) + i % 2];
  }
  if (has && !isnan(sides[4]) && !isnan(sides[5]) && sides[4] <= sides[5])
  {
    /* A flat box holds the plane it lies in. */
    const bool inside = sides[4] <= plane->at && (plane->at < sides[5] || plane->at == sides[4]);
    sides[4] = inside ? -INFINITY : DBL_MAX;
    sides[5] = INFINITY;
  }
  memcpy(to, sides, sizeof sides);
}

mcor_status mcor_flatten_points(
  mcor_context* context, const mcor_array* points, int64_t count, mcor_array* turned, double** flat)
{
  *flat = malloc((size_t)count * 3 * sizeof(double) + 1);
  MCOR_RETURN_IF(!*flat, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for %lld points could not be allocated.", (long long)count);
  mcor_flatten_job job = { &context->plane, *points, NULL, *flat, true };
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
  *flat = (mcor_flat){ .input = *input, .options = *options };
  flat->input.positions.components = 3; /* whatever the caller says */
  MCOR_RETURN_IF(options->dimension != 0 && options->dimension != 2 && options->dimension != 3,
    context, MCOR_INVALID_ARGUMENT, "The dimension is %d; it must be 2, 3, or 0 (automatic).",
    options->dimension);
  MCOR_TRY(mcor_find_plane(context, &flat->input, options));
  o->dimension = context->space.axes;
  if (plane->axis == 0)
  {
    return MCOR_OK;
  }
  MCOR_RETURN_IF(options->capping && options->filled, context, MCOR_INVALID_ARGUMENT,
    "Capping cannot be combined with filling, which ends at the sides of a period or a box. Turn "
    "one of them off.");
  if (options->filled) /* pairs may miss lines that a region ends at */
  {
    o->seeds = MCOR_COMPLETE;
    o->level_limit = 0;
    o->outputs |= MCOR_OUT_ISO_VALUE;
  }
  mcor_flatten_sides(plane, options->box, o->box);
  for (int i = 0; i < 6; ++i) /* a period across the plane means nothing */
  {
    o->periodic[i] = i < 4 ? options->periodic[2 * mcor_plane_axis(plane, i / 2) + i % 2] : 0;
  }
  o->outputs &= ~(unsigned)MCOR_OUT_GAUSS_CURVATURE; /* lines have none */
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
  if (!mcor_has_positions(input) || (plane->axis == 3 && plane->at == 0)) /* flat as it is */
  {
    return MCOR_OK;
  }
  const bool floats = input->positions.type == MCOR_FLOAT32;
  const size_t width = 3 * (floats ? sizeof(float) : sizeof(double));
  flat->positions = malloc((size_t)input->count * width + 1);
  MCOR_RETURN_IF(!flat->positions, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for %lld particles could not be allocated.", (long long)input->count);
  mcor_flatten_job job = { plane, flat->input.positions, floats ? flat->positions : NULL,
    flat->positions, false };
  flat->input.positions.data = flat->positions;
  return mcor_parallel_run(context, input->count, MCOR_LIGHT_GRAIN, mcor_flatten_slice, &job, NULL);
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

/* Across the plane, reach is the largest support everywhere. */
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
