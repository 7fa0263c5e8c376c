/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds whether the particles lie in a plane. */

#include "mcor_input.h"
#include "mcor_plane.h"
#include "mcor_vector.h"

#include <float.h>
#include <math.h>

bool mcor_has_positions(const mcor_input* input)
{
  return input->count > 0 && input->count <= MCOR_PARTICLE_LIMIT && input->positions.data &&
    (unsigned)input->positions.type <= MCOR_FLOAT64;
}

/* Finds the ranges of the particles along x, y, z: ranges 0 to 2 are the fluid's, 3 to 5 those of
 * solids that are not ignored. An axis is measured only until two values of the fluid differ: the
 * fluid is then not flat along this axis, and its exact extent does not matter. If positions cannot
 * be read, mcor_check_input says later what is wrong. */
static mcor_findings mcor_find_spread(const mcor_input* input)
{
  mcor_findings spread = mcor_no_findings();
  const int64_t count = mcor_has_positions(input) ? input->count : 0;
  double x[MCOR_CHUNK];
  for (int a = 0; a < 3; ++a)
  {
    for (int64_t begin = 0; begin < count && !(spread.least[a] < spread.most[a]);
         begin += MCOR_CHUNK)
    {
      const int read = mcor_chunk_of(count - begin);
      mcor_read_array(&input->positions, begin, read, a, x);
      const bool same =
        !input->solid && mcor_is_all_within(x, read, spread.least[a], spread.most[a]);
      for (int i = 0; i < read && !same; ++i)
      {
        const bool solid = input->solid && input->solid[begin + i], finite = isfinite(x[i]);
        if (mcor_is_present(input, begin + i) && (finite || !solid))
        {
          mcor_add_range(
            &spread, solid ? 3 + a : a, finite ? x[i] : -DBL_MAX, finite ? x[i] : DBL_MAX);
        }
      }
    }
  }
  return spread;
}

/* If the fluid's positions are finite, fails because not all particles lie in one plane. If all
 * fluid lies in a plane, the message names the plane of the solids or, if the solids do not lie in
 * one plane, the first solid off the fluid's plane. */
static mcor_status mcor_refuse_plane(
  mcor_context* context, const mcor_input* input, const mcor_findings* spread)
{
  const char* const rule = "in two dimensions all particles must lie in one plane. Correct these "
                           "positions, or choose {dimension 3}";
  const mcor_array* positions = &input->positions;
  if (mcor_find_illegal(context, positions, input->solid, MCOR_SKIP_SOLIDS, input->count, false) >=
    0)
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

/* Drops a plane that seems to come from rounding to floats: floats near the plane's coordinate are
 * far apart, compared with the particles, and most tested particles coincide with another one. */
static mcor_status mcor_drop_rounded_plane(
  mcor_context* context, const mcor_input* input, mcor_plane* plane)
{
  const mcor_array* x = &input->positions;
  const int axes[2] = { mcor_plane_axis(plane, 0), mcor_plane_axis(plane, 1) };
  /* Ranges: the extents along both axes of the plane. Sums: the numbers of particles, of tested
   * particles, and of tested particles with a twin. */
  mcor_findings found = mcor_no_findings();
  int64_t* counts = found.sums;
  if (plane->at == 0 || (double)(float)plane->at != plane->at)
  {
    return MCOR_OK;
  }
  for (int64_t i = 0; i < input->count; ++i)
  {
    counts[0] += mcor_is_present(input, i);
  }
  for (int a = 0; a < 2; ++a)
  {
    const mcor_findings range = mcor_find_range(context, x, input->solid,
      input->ignore_solids ? MCOR_SKIP_SOLIDS : MCOR_SKIP_ABSENT, input->count, axes[a]);
    mcor_add_range(&found, a, range.least[0], range.most[0]);
  }
  MCOR_TRY(mcor_reduce_findings(context, &found));
  const double area = (found.most[0] - found.least[0]) * (found.most[1] - found.least[1]);
  if (ldexp(1, ilogb(plane->at) - 23) <= MCOR_COARSE_SHARE * sqrt(area / (double)counts[0]))
  {
    return MCOR_OK;
  }
  for (int64_t i = 0; i < input->count && counts[1] < MCOR_TWIN_SAMPLES; ++i)
  {
    bool has_twin = false;
    for (int64_t k = 0; k < input->count && !has_twin; ++k)
    {
      has_twin = k != i && mcor_array_at(x, i, axes[0]) == mcor_array_at(x, k, axes[0]) &&
        mcor_array_at(x, i, axes[1]) == mcor_array_at(x, k, axes[1]);
    }
    counts[1] += mcor_is_present(input, i);
    counts[2] += mcor_is_present(input, i) && has_twin;
  }
  MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, counts + 1, 2));
  *plane = 2 * counts[2] > counts[1] ? (mcor_plane){ 0 } : *plane;
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

/* Sets context->plane and `space`: takes the plane of the globals or, without globals, looks for
 * the plane in which all particles lie. All ranks find the same plane. */
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
  mcor_findings spread = mcor_find_spread(input);
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_LEAST, spread.least, 6));
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_GREATEST, spread.most, 6));
  mcor_plane plane = { 0 };
  int constant = 0, fluid_planes = 0;
  bool apart = false; /* fluid lies in one plane, solids in another: two dimensions were meant */
  for (int a = 0; a < 3; ++a)
  {
    const double low = fmin(spread.least[a], spread.least[3 + a]),
                 high = fmax(spread.most[a], spread.most[3 + a]);
    const bool in_plane = spread.least[a] == spread.most[a];
    constant += low == high;
    plane = low == high ? (mcor_plane){ a + 1, low + 0.0 } : plane; /* never -0 */
    fluid_planes += in_plane;
    apart = apart || (in_plane && spread.least[3 + a] == spread.most[3 + a]);
  }
  if (options->dimension == 0 && constant != 1)
  {
    plane = (mcor_plane){ 0 }; /* particles on a line, or at a point, do not tell their plane */
  }
  if (options->dimension == 0 && plane.axis > 0)
  {
    MCOR_TRY(mcor_drop_rounded_plane(context, input, &plane));
  }
  mcor_set_plane(context, plane);
  const bool some = spread.least[0] <= spread.most[0] || spread.least[3] <= spread.most[3];
  const bool refuses = options->dimension == 2 ? some : constant == 0 && fluid_planes == 1 && apart;
  return refuses && plane.axis == 0 ? mcor_refuse_plane(context, input, &spread) : MCOR_OK;
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

int mcor_find_dimension(const mcor_input* input, const mcor_ranks* ranks, int dimension)
{
  const mcor_options options = { .dimension = dimension, .ranks = ranks };
  mcor_context* context = dimension == 0 ? mcor_make_bare_context(&options) : NULL;
  int axes = dimension == 2 ? 2 : 3;
  if (context)
  {
    mcor_flat flat;
    mcor_find_plane(context, input, &options, &flat); /* if it fails, there is no plane */
    axes = context->space.axes;
  }
  mcor_free_bare_context(context);
  return axes;
}
