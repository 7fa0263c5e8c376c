/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The smallest runs that reach all kernels of adaptive cubes, probe, gauges, derivatives, box and period. Prints
 * a hash of all bits of their results, for same_bits.cmake; whether these are right is tested elsewhere.
 * With words: those of these runs. */

#include "core_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double modules_weight = 0.4, modules_isos[2] = { 0.6, 1.1 };

/* Particles of spacing 1, and beside them some of spacing 4. */
static core_set modules_set(void)
{
  core_set set = core_make_set(27 + 27);
  for (int i = 0; i < 54; ++i)
  {
    const int coarse = i >= 27, at = i % 27;
    const double spacing = coarse ? 4 : 1;
    const int cell[3] = { at % 3, at / 3 % 3, at / 9 };
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] = spacing * cell[a] + (coarse && a == 0 ? 10 : 0);
    }
    set.smoothing_length[i] = 1.3 * spacing;
    set.volume[i] = spacing * spacing * spacing;
    set.scalar[i] = set.position[3 * i + 1] + 0.1 * (i * 7 % 13);
    set.solid[i] = i % 9 == 4;
  }
  return set;
}

static void modules_print(
  const mcor_context* context, const char* name, int64_t count, uint64_t hash)
{
  printf("form %d lanes, %s\n", context->cl.lanes, context->cl.is_cpu ? "CPU" : "GPU");
  printf("%s: %lld, %016llx %s\n", name, (long long)count, (unsigned long long)hash,
    mcor_last_error(context));
  fflush(stdout);
}

static int modules_surface(
  mcor_context* context, const char* name, const mcor_input* input, const mcor_options* options)
{
  mcor_surface surface;
  const mcor_status status = mcor_extract(context, input, options, &surface);
  int levels = 0;
  for (int l = 0; l < MCOR_CUBE_LEVELS; ++l)
  {
    levels += surface.statistics.cells_of_level[l] > 0;
  }
  modules_print(context, name, surface.triangle_count, core_hash(&surface));
  const int good = status == MCOR_OK && surface.triangle_count > 0 &&
    (levels > 1 || options->level_limit == 0) &&
    (surface.statistics.cap_triangles > 0 || !options->capping);
  mcor_free_surface(&surface);
  return good;
}

static mcor_options modules_options(mcor_field field)
{
  mcor_options options = core_options(field == MCOR_WEIGHT_SUM ? &modules_weight : modules_isos);
  options.field = field;
  options.cube_size_factor = 1;
  options.outputs |=
    MCOR_OUT_GRADIENTS | MCOR_OUT_WEIGHT_SUM | MCOR_OUT_CORRECTION_LENGTH | MCOR_OUT_RESIDUAL;
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG | MCOR_OUT_NEAREST_PARTICLE | MCOR_OUT_ISO_VALUE;
  options.outputs |= MCOR_OUT_POINT_KEYS | MCOR_OUT_TRIANGLE_KEYS;
  return options;
}

static int modules_adaptive(mcor_context* context, const mcor_input* input)
{
  mcor_options options = modules_options(MCOR_WEIGHT_SUM);
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  int good = modules_surface(context, "adaptive, free surface", input, &options);
  options.iso_values = modules_isos;
  options.field = MCOR_SHEPARD;
  options.iso_count = 2;
  options.wall_share = 0.5;
  options.vertex_threshold = 0.3;
  good = modules_surface(context, "adaptive, scalar", input, &options) && good;
  for (int s = 0; s < 6; ++s)
  {
    options.box[s] = s % 2 == 0 ? -10 : (s == 1 ? 14 : 20);
  }
  return modules_surface(context, "adaptive, box", input, &options) && good;
}

static int modules_uniform(mcor_context* context, const mcor_input* input)
{
  mcor_options options = modules_options(MCOR_SHEPARD);
  mcor_input fine = *input;
  fine.count = 27;
  options.cube_size_factor = 0.6;
  options.vertex_threshold = 0.1;
  for (int s = 0; s < 6; ++s)
  {
    options.box[s] = s % 2 == 0 ? -3 : (s == 1 ? 1 : 5);
  }
  const int good = modules_surface(context, "box", &fine, &options);
  memset(options.box, 0, sizeof options.box);
  options.outputs &= ~(unsigned)(MCOR_OUT_POINT_KEYS | MCOR_OUT_TRIANGLE_KEYS);
  options.field = MCOR_WEIGHT_SUM;
  options.iso_values = &modules_weight;
  options.capping = 1;
  for (int s = 0; s < 4; ++s)
  {
    options.periodic[s] = s % 2 == 0 ? 1 : 9;
  }
  return modules_surface(context, "period, caps", &fine, &options) && good;
}

/* The lowest layer of the fine particles; then that of the coarse ones, too. */
static int modules_plane(mcor_context* context, const mcor_input* input)
{
  int good = 1;
  core_set set = modules_set();
  for (int i = 9; i < 18; ++i)
  {
    memcpy(set.position + 3 * i, set.position + 3 * (i + 18), 3 * sizeof(double));
    set.smoothing_length[i] = 1.3 * 4;
    set.volume[i] = 16;
    set.scalar[i] = 0.25 * set.position[3 * i + 1];
    set.solid[i] = i == 13;
  }
  for (int i = 0; i < 6; ++i)
  {
    mcor_input flat = *input;
    const int field = i % 3, levels = i / 3;
    flat.count = levels ? 18 : 9;
    flat.positions = core_array(set.position, 3);
    flat.smoothing_length = core_array(set.smoothing_length, 1);
    flat.volume = core_array(set.volume, 1);
    flat.scalar = core_array(set.scalar, 1);
    flat.solid = set.solid;
    mcor_options options = modules_options((mcor_field)field);
    options.level_limit = levels ? MCOR_CUBE_LEVELS - 1 : 0;
    options.seeds = levels && field == MCOR_SHEPARD ? MCOR_PAIRS : MCOR_COMPLETE;
    options.topology = MCOR_TOPOLOGY_FIELD;
    options.boundary_detection = MCOR_BOUNDARY_EIGENVALUE;
    options.vertex_threshold = 0.2;
    options.cube_size_factor = 0.5;
    options.node_threshold = 0.05;
    mcor_surface surface;
    const mcor_status status = mcor_extract(context, &flat, &options, &surface);
    const uint64_t hash = core_hash_bytes(core_hash(&surface), surface.line_points,
      (size_t)surface.line_point_count * sizeof *surface.line_points);
    modules_print(context, "plane", surface.line_count, hash);
    good = status == MCOR_OK && surface.line_count > 0 &&
      (surface.statistics.cells_of_level[1] > 0) == (levels > 0) && good;
    mcor_free_surface(&surface);
  }
  core_free_set(&set);
  return good;
}

static int modules_probe(mcor_context* context, const mcor_input* input)
{
  const double at[15] = { 0, 0, 0, 1.2, 0.3, 0.7, 10.5, 2, 3, 60, 0, 0, 2, 2, 2 };
  double* points = core_copy(at, sizeof at);
  const mcor_array array = core_array(points, 3);
  int good = 1;
  for (int field = MCOR_SHEPARD; field <= MCOR_SUM; ++field)
  {
    mcor_options options = modules_options((mcor_field)field);
    mcor_samples samples;
    const mcor_status status = mcor_probe(context, input, &options, &array, 5, &samples);
    good = status == MCOR_OK && samples.valid[0] && !samples.valid[3] && good;
    uint64_t hash = core_hash_bytes(CORE_HASH_OF_NOTHING, samples.weight_sum, 5 * sizeof(double));
    hash = core_hash_bytes(hash, samples.weight_gradient, 15 * sizeof(double));
    for (int a = 0; a < samples.attribute_count; ++a)
    {
      const size_t bytes = (a == 0 ? 15 : 5) * sizeof(double);
      hash = core_hash_bytes(hash, samples.values[a], bytes);
      hash = core_hash_bytes(hash, samples.gradients[a], 3 * bytes);
    }
    modules_print(context, "probe", samples.count, hash);
    mcor_free_samples(&samples);
  }
  free(points);
  return good;
}

static int modules_derive(mcor_context* context, const mcor_input* input)
{
  int good = 1;
  for (int form = MCOR_GRADIENT_CORRECTED; form <= MCOR_GRADIENT_STANDARD; ++form)
  {
    const mcor_options options = modules_options(MCOR_SHEPARD);
    mcor_derivatives d;
    const mcor_status status = mcor_derive(context, input, &options, (mcor_gradient)form, &d);
    good = status == MCOR_OK && d.gradients[0] && d.gradients[1] && good;
    const size_t n = (size_t)d.count;
    uint64_t hash = core_hash_bytes(CORE_HASH_OF_NOTHING, d.corrected, n);
    for (int a = 0; a < d.attribute_count; ++a)
    {
      hash = core_hash_bytes(hash, d.gradients[a], n * (a == 0 ? 9 : 3) * sizeof(double));
    }
    modules_print(context, "derive", d.count, hash);
    mcor_free_derivatives(&d);
  }
  return good;
}

static int modules_gauge(mcor_context* context, const mcor_input* input)
{
  static const mcor_gauge_line lines[3] = { { .from = { 1, 1.1, -4 }, .to = { 1, 1.1, 6 } },
    { .from = { -3, 0.2, 0.3 }, .to = { 30, 7, 9 } },
    { .from = { 99, 0, 0 }, .to = { 99, 0, 1 } } };
  const mcor_options options = modules_options(MCOR_WEIGHT_SUM);
  mcor_gauges found;
  const mcor_status status = mcor_gauge(context, input, &options, lines, 3, &found);
  const size_t bytes = (size_t)found.crossing_count * sizeof(double);
  modules_print(context, "gauge", found.crossing_count,
    core_hash_bytes(CORE_HASH_OF_NOTHING, found.crossings, bytes));
  const int good = status == MCOR_OK && found.crossing_count > 3;
  mcor_free_gauges(&found);
  return good;
}

typedef struct modules_run
{
  const char* name;
  int (*run)(mcor_context*, const mcor_input*);
} modules_run;

int main(int argc, char** argv)
{
  static const modules_run runs[] = { { "adaptive", modules_adaptive },
    { "uniform", modules_uniform }, { "plane", modules_plane }, { "probe", modules_probe },
    { "derive", modules_derive }, { "gauge", modules_gauge } };
  mcor_context* context = NULL;
  if (mcor_create_context(NULL, &context) != MCOR_OK)
  {
    fprintf(stderr, "%s\n", mcor_last_error(context));
    mcor_free_context(context);
    return 1;
  }
  core_set set = modules_set();
  set.has_solids = 1;
  const mcor_array attributes[2] = { core_array(set.position, 3), core_array(set.scalar, 1) };
  mcor_input input = core_input(&set);
  input.attributes = attributes;
  input.attribute_count = 2;
  int good = 1;
  for (size_t i = 0; i < sizeof runs / sizeof runs[0]; ++i)
  {
    int wanted = argc == 1;
    for (int a = 1; a < argc; ++a)
    {
      wanted = wanted || strcmp(argv[a], runs[i].name) == 0;
    }
    good = (!wanted || runs[i].run(context, &input)) && good;
  }
  mcor_free_context(context);
  core_free_set(&set);
  return good ? 0 : 1;
}
