/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compares the library with the oracle on particle sets from formulas: one set with every kernel,
 * field and cube factor; every set with its fields; ways to give volumes and smoothing lengths;
 * scaled and shifted data; single and double precision. */

#include "oracle_case.h"
#include "particle_sets.h"

#include <stdio.h>
#include <string.h>

static const char* const field_names[3] = { "shepard", "sum", "weight" };

/* Differences of a case from the defaults. Zero means: as in the set, or the library's default. */
typedef struct variant
{
  const char* set;
  const char* suffix; /* of the case's name; NULL: none */
  mcor_sph_kernel kernel;
  mcor_field field;
  double cube_factor, cube_size, h_scale;
  int in_double;
  double iso; /* used only if has_iso */
  int has_iso, rough, at_iso, skip_pairs;
  int has_euler, euler;
  mcor_topology topology;
  double eigenvalue; /* above 0: trimmed where the boundary eigenvalue is lower */
  int ignore_solids, no_volume;
  double wall_share, threshold; /* threshold: vertex_threshold */
  double shift;                 /* added to the scalar and iso */
  double scale, offset[3];      /* applied to positions and lengths */
} variant;

static void fill_case(oracle_case* at, const variant* v, const particle_set* set, const double* iso)
{
  memset(at, 0, sizeof(*at));
  at->input = core_input(set);
  at->input.ignore_solids = v->ignore_solids;
  at->input.volume = v->no_volume ? (mcor_array){ 0 } : at->input.volume;
  at->options = oracle_case_options(iso);
  at->options.sph_kernel = v->kernel;
  at->options.field = v->field;
  at->options.cube_size_factor = v->cube_factor > 0.0 ? v->cube_factor : 0.5;
  at->options.cube_size = v->cube_size;
  at->options.h_scale = v->h_scale > 0.0 ? v->h_scale : 1.0;
  at->options.precision = v->in_double ? MCOR_FLOAT64 : MCOR_FLOAT32;
  at->options.topology = v->topology;
  at->options.wall_share = v->wall_share;
  at->options.vertex_threshold = v->threshold > 0.0 ? v->threshold : at->options.vertex_threshold;
  if (v->eigenvalue > 0.0)
  {
    at->options.boundary_detection = MCOR_BOUNDARY_EIGENVALUE;
    at->options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE;
    at->options.vertex_threshold = v->eigenvalue;
  }
  at->rough = v->rough;
  at->at_iso = v->at_iso;
  at->has_euler = v->has_euler;
  at->euler = v->euler;
  at->skip_pairs = v->skip_pairs || v->field == MCOR_WEIGHT_SUM; /* a weight has no pairs */
  snprintf(at->name, sizeof(at->name), "%s/%s/%s/c%g/h%g%s%s%s", v->set,
    mcor_sph_kernel_name(v->kernel), field_names[v->field],
    v->cube_size > 0.0 ? v->cube_size : at->options.cube_size_factor, at->options.h_scale,
    v->suffix ? v->suffix : "", v->topology == MCOR_TOPOLOGY_FIELD ? "/by_field" : "",
    v->in_double ? "/double" : "");
}

/* Loads the variant's set, lets `change` (if not NULL) alter the case, and runs it. */
static void run_variant(
  oracle_suite* suite, const variant* v, void (*change)(particle_set* set, oracle_case* at))
{
  const particle_set_entry* entry = particle_set_find(v->set);
  particle_set set;
  oracle_case at;
  if (!entry)
  {
    printf("  FAILED: no set %s\n", v->set);
    ++suite->failures;
    return;
  }
  set = particle_set_of(entry);
  double iso = v->has_iso ? v->iso : v->field == MCOR_WEIGHT_SUM ? 0.5 : entry->iso;
  fill_case(&at, v, &set, &iso);
  if (oracle_wants_case(suite, at.name))
  {
    const double scale = v->scale > 0.0 ? v->scale : 1.0;
    for (int64_t j = 0; j < set.count; ++j)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        set.position[3 * j + axis] = scale * set.position[3 * j + axis] + v->offset[axis];
      }
      set.smoothing_length[j] *= scale;
      set.volume[j] *= scale * scale * scale;
      set.scalar[j] += v->shift;
    }
    iso += v->shift;
    if (change)
    {
      change(&set, &at);
    }
    oracle_run_case(suite, &at);
  }
  particle_set_free(&set);
}

/* ---- every combination of kernel, field and cube factor: the first kernel with all scales of h, the other kernels
 * each time with the next scale ---- */

static void run_matrix(oracle_suite* suite)
{
  const double cube_factors[2] = { 0.5, 1.0 };
  const double h_scales[3] = { 1.0, 0.75, 0.5 };
  for (int n = 0; n < MCOR_SPH_KERNEL_COUNT * 18; ++n)
  {
    variant v;
    memset(&v, 0, sizeof(v));
    v.set = "gyroid";
    v.kernel = (mcor_sph_kernel)(n / 18);
    v.field = (mcor_field)(n % 18 / 6);
    v.cube_factor = cube_factors[n % 6 / 3];
    v.h_scale = h_scales[n % 3];
    if (v.kernel != MCOR_CUBIC_SPLINE && n % 3 != (n / 3 + n / 18) % 3)
    {
      continue;
    }
    /* supports are so small that there are gaps between the particles */
    v.rough = v.kernel == MCOR_M_PRIME_4 && v.h_scale < 1.0;
    run_variant(suite, &v, NULL);
  }
}

/* ---- every set ---- */

static const variant set_variants[] = {
  { .set = "sphere", .has_euler = 1, .euler = 2 },
  { .set = "sphere", .field = MCOR_SUM },
  { .set = "sphere", .in_double = 1 },
  { .set = "torus", .has_euler = 1, .euler = 0 },
  { .set = "torus", .cube_factor = 1.0 },
  { .set = "gyroid", .in_double = 1 },
  { .set = "gyroid", .field = MCOR_SUM, .in_double = 1 },
  { .set = "gyroid", .field = MCOR_WEIGHT_SUM, .in_double = 1 },
  { .set = "gyroid", .kernel = MCOR_M_PRIME_4, .in_double = 1 },
  { .set = "gyroid", .kernel = MCOR_QUADRATIC, .in_double = 1 },
  { .set = "saddle" },
  { .set = "saddle", .cube_factor = 1.0 },
  { .set = "saddle", .field = MCOR_SUM },
  { .set = "saddle", .kernel = MCOR_M_PRIME_4, .cube_factor = 1.0 },
  { .set = "noise" },
  { .set = "noise", .cube_factor = 1.0 },
  { .set = "noise", .h_scale = 0.5 },
  { .set = "noise", .field = MCOR_SUM },
  { .set = "noise", .kernel = MCOR_QUADRATIC, .cube_factor = 1.0 },
  { .set = "noise", .kernel = MCOR_M_PRIME_4, .cube_factor = 1.0 },
  { .set = "noise", .in_double = 1 },
  { .set = "noise", .topology = MCOR_TOPOLOGY_FIELD },
  { .set = "noise", .cube_factor = 1.0, .topology = MCOR_TOPOLOGY_FIELD },
  { .set = "noise", .field = MCOR_SUM, .cube_factor = 1.0, .topology = MCOR_TOPOLOGY_FIELD },
  { .set = "noise", .cube_factor = 1.0, .in_double = 1, .topology = MCOR_TOPOLOGY_FIELD },
  { .set = "sheets" },
  { .set = "sheets", .field = MCOR_SUM },
  { .set = "sheets", .field = MCOR_WEIGHT_SUM },
  { .set = "sheets", .cube_factor = 1.0 },
  { .set = "blobs" },
  { .set = "blobs", .field = MCOR_SUM },
  { .set = "blobs", .field = MCOR_SUM, .cube_factor = 0.3 },
  { .set = "blobs", .field = MCOR_WEIGHT_SUM },
  { .set = "drops", .field = MCOR_WEIGHT_SUM },
  { .set = "drops", .field = MCOR_WEIGHT_SUM, .cube_factor = 1.0 },
  { .set = "drops", .field = MCOR_WEIGHT_SUM, .h_scale = 0.5 },
  { .set = "drops", .field = MCOR_SUM, .has_iso = 1, .iso = 0.7 },
  { .set = "drops", .field = MCOR_WEIGHT_SUM, .cube_factor = 1.0, .topology = MCOR_TOPOLOGY_FIELD },
  { .set = "puddle" },
  { .set = "puddle", .field = MCOR_SUM },
  { .set = "puddle", .field = MCOR_WEIGHT_SUM },
  { .set = "puddle", .in_double = 1 },
  { .set = "variable_4" },
  { .set = "variable_4", .field = MCOR_SUM },
  { .set = "variable_4", .field = MCOR_WEIGHT_SUM },
  { .set = "variable_4", .kernel = MCOR_QUINTIC_SPLINE, .cube_factor = 1.0 },
  { .set = "variable_4", .kernel = MCOR_M_PRIME_4, .cube_factor = 1.0 },
  { .set = "variable_16", .cube_factor = 1.0 },
  { .set = "variable_16", .field = MCOR_WEIGHT_SUM, .cube_factor = 1.0 },
  { .set = "variable_128", .cube_size = 0.03 },
  { .set = "variable_128", .field = MCOR_WEIGHT_SUM, .cube_size = 0.03 },
  { .set = "single", .field = MCOR_WEIGHT_SUM, .has_euler = 1, .euler = 2 },
  { .set = "single", .field = MCOR_SUM, .has_iso = 1, .iso = 0.7 },
  /* For a single particle, the sum f equals the weight w, so the surfaces of iso value and vertex threshold
   * coincide. */
  { .set = "single", .field = MCOR_SUM, .rough = 1, .at_iso = 1, .suffix = "/tangent" },
  { .set = "coincident" },
  { .set = "coincident", .field = MCOR_SUM },
  /* At nodes the values equal iso to within rounding, so any edge there may be crossed. The mesh
   * must still be whole, and every vertex on the surface. */
  { .set = "on_nodes", .rough = 1, .at_iso = 1 },
  { .set = "on_nodes", .field = MCOR_SUM, .rough = 1, .at_iso = 1 },
  { .set = "on_nodes", .rough = 1, .at_iso = 1, .in_double = 1 },
  { .set = "plateau", .rough = 1, .at_iso = 1, .skip_pairs = 1 },
};

/* ---- trimmed by the boundary eigenvalue ---- */

static const variant eigenvalue_variants[] = {
  { .set = "puddle" },
  { .set = "puddle", .eigenvalue = 0.75 },
  { .set = "puddle", .in_double = 1 },
  { .set = "gyroid" },
  { .set = "gyroid", .kernel = MCOR_QUADRATIC },
  { .set = "gyroid", .kernel = MCOR_M_PRIME_4 },
  { .set = "gyroid", .kernel = MCOR_QUINTIC_SPLINE },
  { .set = "gyroid", .kernel = MCOR_WENDLAND_C2 },
  { .set = "gyroid", .field = MCOR_SUM, .eigenvalue = 0.5 },
  { .set = "noise", .eigenvalue = 0.5 },
};

static void run_eigenvalues(oracle_suite* suite)
{
  for (size_t n = 0; n < sizeof(eigenvalue_variants) / sizeof(eigenvalue_variants[0]); ++n)
  {
    char suffix[32];
    variant v = eigenvalue_variants[n];
    v.eigenvalue = v.eigenvalue > 0.0 ? v.eigenvalue : 0.3;
    v.skip_pairs = 1;
    snprintf(suffix, sizeof(suffix), "/eigenvalue%g", v.eigenvalue);
    v.suffix = suffix;
    run_variant(suite, &v, NULL);
  }
}

/* ---- how data are given ---- */

/* Gives the volumes as masses, so that each particle has its own mass. */
static void mass_alone(particle_set* set, oracle_case* at)
{
  at->input.volume = (mcor_array){ 0 };
  at->input.mass = core_array(set->volume, 1);
}

static void mass_and_density(particle_set* set, oracle_case* at)
{
  mass_alone(set, at);
  at->input.density = (mcor_array){ .constant = 0.9 };
}

static void support_radius(particle_set* set, oracle_case* at)
{
  for (int64_t j = 0; j < set->count; ++j)
  {
    set->smoothing_length[j] *= mcor_support_factor(at->options.sph_kernel);
  }
  at->input.smoothing_length_is_support_radius = 1;
}

static void constant_length(particle_set* set, oracle_case* at)
{
  (void)set;
  at->input.smoothing_length = (mcor_array){ .constant = 0.13 };
}

static void vector_magnitude(particle_set* set, oracle_case* at)
{
  at->input.scalar = core_array(set->position, 3);
  at->input.scalar_component = MCOR_MAGNITUDE;
}

static void vector_component(particle_set* set, oracle_case* at)
{
  vector_magnitude(set, at);
  at->input.scalar_component = 1;
}

static void vector_dot(particle_set* set, oracle_case* at)
{
  vector_magnitude(set, at);
  at->input.scalar_dot = at->input.scalar;
}

/* Stores all arrays in single precision, in place: afterwards the first half of each array holds
 * the floats. */
static void single_arrays(particle_set* set, oracle_case* at)
{
  double* const arrays[4] = { set->position, set->smoothing_length, set->volume, set->scalar };
  for (int a = 0; a < 4; ++a)
  {
    for (int64_t n = 0; n < (a == 0 ? 3 : 1) * set->count; ++n)
    {
      const float value = (float)arrays[a][n];
      memcpy((char*)arrays[a] + sizeof(float) * (size_t)n, &value, sizeof(value));
    }
  }
  at->input.positions.type = at->input.smoothing_length.type = MCOR_FLOAT32;
  at->input.volume.type = at->input.scalar.type = MCOR_FLOAT32;
}

static void run_inputs(oracle_suite* suite)
{
  static const struct
  {
    variant v;
    void (*change)(particle_set* set, oracle_case* at);
  } inputs[] = {
    { { .set = "puddle", .suffix = "/ignore_solids", .ignore_solids = 1 }, NULL },
    { { .set = "puddle", .suffix = "/wall", .wall_share = 0.5 }, NULL },
    { { .set = "puddle", .suffix = "/wall", .in_double = 1, .wall_share = 0.5 }, NULL },
    { { .set = "puddle", .suffix = "/wall", .field = MCOR_SUM, .wall_share = 0.5 }, NULL },
    { { .set = "puddle", .suffix = "/wall", .field = MCOR_WEIGHT_SUM, .wall_share = 0.5 }, NULL },
    { { .set = "puddle",
        .suffix = "/wall_eigenvalue",
        .eigenvalue = 0.3,
        .skip_pairs = 1,
        .wall_share = 0.5 },
      NULL },
    /* A larger wall share lets the surface reach farther into the wall, and with a low threshold
     * only the wall ends it. */
    { { .set = "puddle", .suffix = "/in_wall", .wall_share = 0.85, .threshold = 0.2 }, NULL },
    { { .set = "puddle", .suffix = "/no_volume", .no_volume = 1 }, NULL },
    { { .set = "puddle", .suffix = "/no_volume", .field = MCOR_WEIGHT_SUM, .no_volume = 1 }, NULL },
    { { .set = "variable_4", .suffix = "/no_volume", .no_volume = 1 }, NULL },
    { { .set = "variable_4", .suffix = "/mass_alone" }, mass_alone },
    { { .set = "variable_4", .suffix = "/mass_density" }, mass_and_density },
    { { .set = "gyroid", .suffix = "/support_radius" }, support_radius },
    { { .set = "gyroid", .suffix = "/support_radius", .kernel = MCOR_QUINTIC_SPLINE },
      support_radius },
    { { .set = "gyroid", .suffix = "/constant_length" }, constant_length },
    { { .set = "sphere", .suffix = "/magnitude" }, vector_magnitude },
    { { .set = "sphere", .suffix = "/component", .has_iso = 1, .iso = 0.123 }, vector_component },
    { { .set = "sphere", .suffix = "/dot", .has_iso = 1, .iso = 0.25 }, vector_dot },
    { { .set = "gyroid", .suffix = "/float32" }, single_arrays },
    /* The scalar is like a pressure around an ambient 101325, of which only variations of size 1
     * matter. */
    { { .set = "gyroid", .suffix = "/large_scalar", .shift = 101325.0 }, NULL },
    { { .set = "gyroid", .suffix = "/large_scalar", .in_double = 1, .shift = 101325.0 }, NULL },
    { { .set = "gyroid", .suffix = "/far_away", .offset = { 2e6, -1e6, 3e5 } }, NULL },
    { { .set = "gyroid", .suffix = "/far_away", .field = MCOR_SUM, .offset = { 2e6, -1e6, 3e5 } },
      NULL },
    { { .set = "gyroid", .suffix = "/tiny", .scale = 1e-9 }, NULL },
    { { .set = "gyroid", .suffix = "/tiny", .field = MCOR_WEIGHT_SUM, .scale = 1e-9 }, NULL },
    { { .set = "gyroid", .suffix = "/huge", .scale = 1e9 }, NULL },
    { { .set = "gyroid", .suffix = "/huge", .field = MCOR_SUM, .scale = 1e9 }, NULL },
  };
  for (size_t n = 0; n < sizeof(inputs) / sizeof(inputs[0]); ++n)
  {
    run_variant(suite, &inputs[n].v, inputs[n].change);
  }
}

int main(int argc, char** argv)
{
  oracle_suite suite;
  if (!oracle_begin_suite(&suite, argc, argv))
  {
    return 1;
  }
  for (size_t n = 0; n < sizeof(set_variants) / sizeof(set_variants[0]); ++n)
  {
    run_variant(&suite, &set_variants[n], NULL);
  }
  run_eigenvalues(&suite);
  run_inputs(&suite);
  run_matrix(&suite);
  return oracle_end_suite(&suite);
}
