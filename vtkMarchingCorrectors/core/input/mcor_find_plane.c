/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds whether the particles lie in a plane. */

#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_plane.h"
#include "mcor_vector.h"

#include <float.h>
#include <math.h>

/* Finds the ranges of the particles along x, y, z: first of the fluid, then of the solids that play
 * a part. */
typedef struct mcor_spread_job
{
  const mcor_input* input;
  mcor_findings slices[MCOR_SLICES];
} mcor_spread_job;

/* Measures each axis only until two values along it differ: the fluid is then not flat along this
 * axis, and its exact extent does not matter. */
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
      const bool same =
        !input->solid && mcor_is_all_within(x, count, spread.least[a], spread.most[a]);
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

/* Whether positions can be read; if not, mcor_check_input says later what is wrong. */
bool mcor_has_positions(const mcor_input* input)
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

/* Chooses the plane. Particles on a line, or at a point, do not tell their plane, so none is chosen
 * unless the caller sets two dimensions. */
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
                           "positions, or choose {dimension 3}";
  const mcor_array* positions = &input->positions;
  if (mcor_find_not_finite(context, positions, input->solid, input->count) >= 0)
  {
    return MCOR_OK; /* mcor_check_input reports it */
  }
  for (int a = 2; a >= 0; --a)
  {
    const double at = spread->least[a], solids = spread->least[3 + a];
    const bool in_plane = at == spread->most[a];
    MCOR_FAIL_IF(in_plane && solids == spread->most[3 + a], context, MCOR_INVALID_DATA,
      MCOR_SAY(SOLIDS_BESIDE_PLANE), "xyz"[a], at, solids, rule);
    int64_t i = 0;
    while (in_plane && i < input->count &&
      (mcor_array_at(positions, i, a) == at || !mcor_is_present(input, i)))
    {
      ++i;
    }
    MCOR_FAIL_IF(in_plane && i < input->count, context, MCOR_INVALID_DATA,
      MCOR_SAY(SOLID_BESIDE_PLANE), "xyz"[a], at, (long long)i, mcor_array_at(positions, i, a),
      rule);
  }
  return mcor_fail(context, MCOR_INVALID_DATA, MCOR_SAY(NOT_IN_PLANE));
}

/* How many particles are tested for a twin, a particle with the same place in the plane. */
#define MCOR_TWIN_SAMPLES 32
/* Rounding may have flattened the particles if a step of single precision is longer than this share
 * of the spacing that they would have if spread evenly over the plane. */
#define MCOR_COARSE_SHARE 0.125

/* Whether rounding made the plane: its coordinate is so large that single precision rounds it by
 * about the particles' spacing, and most of the tested particles have a twin. */
static mcor_status mcor_is_rounding(mcor_context* context, const mcor_input* input,
  const mcor_findings* spread, const mcor_plane* plane, bool* rounding)
{
  const mcor_array* positions = &input->positions;
  int64_t counts[3] = { 0 }; /* particles; sampled ones; sampled ones with a twin */
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

/* Takes the plane of the globals, or looks for one; all ranks find the same plane. */
static mcor_status mcor_look_for_plane(
  mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  MCOR_FAIL_IF(options->dimension != 0 && options->dimension != 2 && options->dimension != 3,
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(DIMENSION_ILLEGAL), options->dimension);
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
  bool apart = false; /* the fluid lies in one plane and the solids in another, so two dimensions
                       * were meant */
  for (int a = 0; a < 3; ++a)
  {
    const bool in_plane = spread.least[a] == spread.most[a];
    planes += in_plane;
    apart = apart || (in_plane && spread.least[3 + a] == spread.most[3 + a]);
  }
  const bool refused = options->dimension == 2 ? some : !rounding && planes == 1 && apart;
  return refused && !mcor_is_plane(context) ? mcor_refuse_plane(context, input, &spread) : MCOR_OK;
}

mcor_status mcor_find_plane(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_flat* flat)
{
  *flat = (mcor_flat){ .input = *input, .options = *options };
  flat->input.positions.components = 3; /* 3 is right, whatever number the caller has set */
  MCOR_TRY(mcor_look_for_plane(context, &flat->input, options));
  flat->options.dimension = context->space.axes;
  return MCOR_OK;
}
