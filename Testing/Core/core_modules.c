/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Runs small cases that reach all kernels of adaptive cubes, boxes, periods, planes, probes, derivatives, gauges,
 * fluxes and projections, and a tank with many options. Prints a hash of each result for same_bits.cmake; writes the
 * results for bits.cmake. Other tests check the results. The command line may name groups of cases, see `runs`. */

#include "core_keep.h"
#include "core_parts.h"

static const double modules_weight = 0.4, modules_isos[2] = { 0.6, 1.1 };

/* Makes particles of spacing 1, and some of spacing 4 beside them. */
static particle_set modules_set(void)
{
  particle_set set = particle_set_make(27 + 27);
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

/* Hashes a result that is not a surface, one part after the other. */
typedef struct modules_hash
{
  const char* name;
  uint64_t hash;
} modules_hash;

static void modules_add(modules_hash* hash, const void* data, size_t bytes)
{
  hash->hash = core_hash_bytes(hash->hash, data, bytes);
  core_keep(hash->name, "arrays", data, bytes);
}

static void modules_end(
  const mcor_context* context, const modules_hash* hash, int64_t points, int64_t cells)
{
  modules_print(context, hash->name, points, hash->hash);
  core_keep_size(hash->name, points, cells);
}

static int modules_surface(
  mcor_context* context, const char* name, const mcor_input* input, const mcor_options* options)
{
  CORE_SURFACE surface;
  const mcor_status status = mcor_extract(context, input, options, &surface);
  int levels = 0;
  for (int l = 0; l < MCOR_CUBE_LEVELS; ++l)
  {
    levels += surface.statistics.cells_of_level[l] > 0;
  }
  modules_print(context, name, surface.triangle_count + surface.line_count, core_hash(&surface));
  core_keep_surface(name, input, &surface);
  const int good = status == MCOR_OK && surface.triangle_count > 0 &&
    (levels > 1 || options->level_limit == 0) &&
    (surface.statistics.cap_triangles > 0 || !options->capping);
  return good;
}

static mcor_options modules_options(mcor_field field)
{
  mcor_options options = core_options(field == MCOR_WEIGHT_SUM ? &modules_weight : modules_isos);
  options.field = field;
  options.cube_size_factor = 1;
  core_ask_for_all(&options);
  return options;
}

static int modules_adaptive(mcor_context* context, const mcor_input* input)
{
  mcor_options options = modules_options(MCOR_WEIGHT_SUM);
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  int good = modules_surface(context, "adaptive_free_surface", input, &options);
  options.iso_values = modules_isos;
  options.field = MCOR_SHEPARD;
  options.iso_count = 2;
  options.wall_share = 0.5;
  options.vertex_threshold = 0.3;
  good = modules_surface(context, "adaptive_scalar", input, &options) && good;
  for (int s = 0; s < 6; ++s)
  {
    options.box[s] = s % 2 == 0 ? -10 : (s == 1 ? 14 : 20);
  }
  return modules_surface(context, "adaptive_box", input, &options) && good;
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
  const int good = modules_surface(context, "uniform_box", &fine, &options);
  memset(options.box, 0, sizeof options.box);
  options.outputs &= ~(unsigned)(MCOR_OUT_POINT_KEYS | MCOR_OUT_TRIANGLE_KEYS);
  options.field = MCOR_WEIGHT_SUM;
  options.iso_values = &modules_weight;
  options.capping = 1;
  for (int s = 0; s < 4; ++s)
  {
    options.periodic[s] = s % 2 == 0 ? 1 : 9;
  }
  return modules_surface(context, "uniform_period_caps", &fine, &options) && good;
}

/* Extracts isolines from particles in a plane: first from the lowest layer of fine particles alone, then from this
 * layer and the lowest layer of coarse particles. */
static int modules_plane(mcor_context* context, const mcor_input* input)
{
  int good = 1;
  CORE_SET set = modules_set();
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
    options.topology = MCOR_TOPOLOGY_FIELD;
    options.boundary_detection = MCOR_BOUNDARY_EIGENVALUE;
    options.vertex_threshold = 0.2;
    options.cube_size_factor = 0.5;
    options.node_threshold = 0.05;
    CORE_SURFACE surface;
    const mcor_status status = mcor_extract(context, &flat, &options, &surface);
    char name[32];
    snprintf(name, sizeof name, "plane_%d_%d", levels, field);
    modules_print(context, name, surface.line_count, core_hash(&surface));
    core_keep_surface(name, &flat, &surface);
    good = status == MCOR_OK && surface.line_count > 0 &&
      (surface.statistics.cells_of_level[1] > 0) == (levels > 0) && good;
  }
  return good;
}

static int modules_probe(mcor_context* context, const mcor_input* input)
{
  const double at[15] = { 0, 0, 0, 1.2, 0.3, 0.7, 10.5, 2, 3, 60, 0, 0, 2, 2, 2 };
  CORE_FREED double* points = core_copy(at, sizeof at);
  const mcor_array array = core_array(points, 3);
  int good = 1;
  for (int field = MCOR_SHEPARD; field <= MCOR_SUM; ++field)
  {
    mcor_options options = modules_options((mcor_field)field);
    CORE_SAMPLES samples;
    const mcor_status status = mcor_probe(context, input, &options, &array, 5, &samples);
    good = status == MCOR_OK && samples.valid[0] && !samples.valid[3] && good;
    char name[32];
    snprintf(name, sizeof name, "probe_%d", field);
    modules_hash hash = { name, CORE_HASH_OF_NOTHING };
    modules_add(&hash, samples.weight_sum, 5 * sizeof(double));
    modules_add(&hash, samples.weight_gradient, 15 * sizeof(double));
    for (int a = 0; a < samples.attribute_count; ++a)
    {
      const size_t bytes = (a == 0 ? 15 : 5) * sizeof(double);
      modules_add(&hash, samples.values[a], bytes);
      modules_add(&hash, samples.gradients[a], 3 * bytes);
    }
    modules_end(context, &hash, samples.count, 0);
  }
  return good;
}

static int modules_derive(mcor_context* context, const mcor_input* input)
{
  int good = 1;
  for (int form = MCOR_GRADIENT_CORRECTED; form <= MCOR_GRADIENT_STANDARD; ++form)
  {
    const mcor_options options = modules_options(MCOR_SHEPARD);
    CORE_DERIVATIVES d;
    const mcor_status status = mcor_derive(context, input, &options, (mcor_gradient)form, &d);
    good = status == MCOR_OK && d.gradients[0] && d.gradients[1] && good;
    const size_t n = (size_t)d.count;
    modules_hash hash = { form == MCOR_GRADIENT_CORRECTED ? "derive_corrected" : "derive_standard",
      CORE_HASH_OF_NOTHING };
    modules_add(&hash, d.corrected, n);
    for (int a = 0; a < d.attribute_count; ++a)
    {
      modules_add(&hash, d.gradients[a], n * (a == 0 ? 9 : 3) * sizeof(double));
    }
    modules_end(context, &hash, d.count, 0);
  }
  return good;
}

static int modules_gauge(mcor_context* context, const mcor_input* input)
{
  static const mcor_gauge_line lines[3] = { { .from = { 1, 1.1, -4 }, .to = { 1, 1.1, 6 } },
    { .from = { -3, 0.2, 0.3 }, .to = { 30, 7, 9 } },
    { .from = { 99, 0, 0 }, .to = { 99, 0, 1 } } };
  const mcor_options options = modules_options(MCOR_WEIGHT_SUM);
  CORE_GAUGES found;
  const mcor_status status = mcor_gauge(context, input, &options, lines, 3, &found);
  modules_hash hash = { "gauge", CORE_HASH_OF_NOTHING };
  modules_add(&hash, found.crossings, (size_t)found.crossing_count * sizeof(double));
  modules_end(context, &hash, found.count, found.crossing_count);
  const int good = status == MCOR_OK && found.crossing_count > 3;
  return good;
}

static int modules_flux(mcor_context* context, const mcor_input* input)
{
  static const double wall[9] = { -1, -3, 0.7, 30, -3, 0.9, -1, 20, 0.7 };
  static const double disc[6] = { 1, 1, 1, 1, 2, 3 };
  const mcor_section sections[2] = {
    { .shape = MCOR_SECTION_RECTANGLE, .points = wall, .point_count = 3 },
    { .shape = MCOR_SECTION_DISC, .points = disc, .point_count = 2, .radius = 3 }
  };
  const mcor_options options = modules_options(MCOR_WEIGHT_SUM);
  CORE_FLUXES found;
  const mcor_status status = mcor_flux(context, input, &options, sections, 2, &found);
  modules_hash hash = { "flux", CORE_HASH_OF_NOTHING };
  int good = status == MCOR_OK;
  for (int64_t i = 0; i < found.count; ++i)
  {
    const mcor_flux_reading* reading = &found.readings[i];
    const double numbers[3] = { reading->area, reading->volume_flux, reading->mass_flux };
    modules_add(&hash, numbers, sizeof numbers);
    good = good && reading->area > 1;
  }
  modules_end(context, &hash, found.count, 0);
  return good;
}

/* Makes a tank along x: three blocks of spacing 1, 2 and 4, whose lowest layers are solids. The fluid's top slopes and
 * is rough. The tank is 32 wide along y; if `flat`, all y are 2. No libm is used, so bits are the same everywhere. */
static particle_set tank_set(bool flat)
{
  particle_set set = particle_set_make(5000);
  uint64_t seed = 11;
  int64_t n = 0;
  double x0 = 0;
  for (int level = 0; level < 3; ++level)
  {
    const int spacing = 1 << level, across = flat ? 1 : 32 / spacing;
    const int along = level == 0 ? 8 : level == 1 ? 6 : 14;
    for (int i = 0; i < along * across * (16 / spacing); ++i)
    {
      const double cell[3] = { i % along, i / along % across, i / along / across };
      const double top = 9 - 0.0625 * x0 + 3 * random_unit(&seed);
      double* x = set.position + 3 * n;
      for (int a = 0; a < 3; ++a)
      {
        const double jitter = 0.25 * (random_unit(&seed) - 0.5);
        x[a] = (a == 0 ? x0 : 0) + spacing * (cell[a] + 0.5 + jitter);
      }
      x[1] = flat ? 2 : x[1];
      set.smoothing_length[n] = 1.3 * spacing * (1 + 0.2 * random_unit(&seed));
      set.volume[n] = flat ? spacing * spacing : spacing * spacing * spacing;
      set.scalar[n] = x[2] + 0.0625 * x[0] * (x[1] - 16) + random_unit(&seed);
      set.solid[n] = cell[2] == 0;
      n += x[2] < top;
    }
    x0 += along * spacing;
  }
  set.count = n;
  set.has_solids = 1;
  return set;
}

/* Flags of a run in the tank. */
enum
{
  TANK_LEVELS = 1,
  TANK_FLAT = 2,
  TANK_FILLED = 4 | TANK_FLAT,
  TANK_CAPS = 8,    /* caps at all sides that the run has */
  TANK_PERIOD = 16, /* along y; in a plane along x */
  TANK_BOX = 32,
  TANK_TOPOLOGY = 64, /* topology by the field; the scalar has noise */
  TANK_PAIRS = 128,
  TANK_WALL = 256, /* the surface ends at solids */
  TANK_EIGENVALUE = 512,
  TANK_PREVIEW = 1024,   /* a preview, with normals by triangles */
  TANK_COMPUTED = 2048,  /* volumes */
  TANK_MASS = 4096,      /* volumes come from masses alone */
  TANK_ESTIMATED = 8192, /* smoothing lengths are estimated */
  TANK_AGAIN = 16384     /* a second call with the same particles and another iso value */
};

typedef struct tank_case
{
  const char* name;
  mcor_field field;
  int has;
} tank_case;

static int tank_run(mcor_context* context, const tank_case* at)
{
  static const double levels[3] = { 5.3, 0.5, 8 };
  const int has = at->has;
  CORE_SET set = tank_set(has & TANK_FLAT);
  uint64_t seed = 3;
  for (int64_t i = 0; i < set.count && has & TANK_TOPOLOGY; ++i)
  {
    set.scalar[i] = 9 * random_unit(&seed);
  }
  const mcor_array attributes[2] = { core_array(set.position, 3), core_array(set.scalar, 1) };
  mcor_input input = core_input_with(&set, attributes, 2);
  input.mass = has & TANK_MASS ? input.volume : input.mass;
  input.volume = has & (TANK_COMPUTED | TANK_MASS) ? (mcor_array){ 0 } : input.volume;
  input.estimate_smoothing_length = (has & TANK_ESTIMATED) != 0;
  mcor_options options = modules_options(at->field);
  options.iso_values = at->field == MCOR_WEIGHT_SUM ? levels + 1 : levels;
  options.iso_count = has & TANK_FILLED & ~TANK_FLAT && at->field == MCOR_SHEPARD ? 3 : 1;
  options.level_limit = has & TANK_LEVELS ? MCOR_CUBE_LEVELS - 1 : 0;
  options.filled = (has & TANK_FILLED) == TANK_FILLED;
  options.cube_size_factor = has & TANK_TOPOLOGY ? 0.5 : 0.78;
  options.h_scale = has & TANK_TOPOLOGY ? 0.6 : 1;
  options.topology = has & TANK_TOPOLOGY ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
  options.seeds = has & TANK_PAIRS ? MCOR_PAIRS : MCOR_COMPLETE;
  options.wall_share = has & TANK_WALL ? 0.5 : 0;
  options.boundary_detection =
    has & TANK_EIGENVALUE ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
  options.vertex_threshold = has & TANK_EIGENVALUE ? 0.3 : 0.5;
  options.outputs |= has & TANK_EIGENVALUE ? MCOR_OUT_BOUNDARY_EIGENVALUE : 0;
  options.preview = options.triangle_normals = (has & TANK_PREVIEW) != 0;
  options.capping = has & TANK_CAPS ? (has & TANK_BOX ? MCOR_CAP_BOX : MCOR_CAP_PERIOD) : 0;
  if (has & TANK_PERIOD)
  {
    const int axis = has & TANK_FLAT ? 0 : 1;
    options.periodic[2 * axis + 1] = has & TANK_FLAT ? 76 : 32;
  }
  for (int side = 0; side < 6 && has & TANK_BOX; ++side)
  {
    options.box[side] = side % 2 == 0 ? 3 - side : side == 1 ? 60 : 34 - 5 * side;
  }
  if (has & TANK_AGAIN)
  {
    CORE_SURFACE first;
    input.particles_version = input.scalar_version = 1;
    (void)mcor_extract(context, &input, &options, &first);
    options.iso_values = levels + 2;
  }
  CORE_SURFACE surface;
  const mcor_status status = mcor_extract(context, &input, &options, &surface);
  const mcor_statistics* s = &surface.statistics;
  const int64_t cells = surface.triangle_count + surface.line_count;
  modules_print(context, at->name, cells, core_hash(&surface));
  core_keep_surface(at->name, &input, &surface);
  const int good = status == MCOR_OK && cells > 0 &&
    (s->cells_of_level[1] > 0) == ((has & TANK_LEVELS) != 0) &&
    (s->cap_triangles > 0 || !(has & TANK_CAPS)) &&
    (s->joined_faces > 0 || !(has & TANK_TOPOLOGY)) &&
    (s->trim_vertices > 0 || !(has & TANK_WALL) || has & TANK_FLAT);
  if (!good)
  {
    fprintf(stderr, "%s: %lld cells, %lld of level 1, %lld caps, %lld faces joined, %lld cut\n",
      at->name, (long long)cells, (long long)s->cells_of_level[1], (long long)s->cap_triangles,
      (long long)s->joined_faces, (long long)s->trim_vertices);
  }
  return good;
}

static int modules_tank(mcor_context* context, const mcor_input* input)
{
  static const tank_case cases[] = {
    { "tank_scalar", MCOR_SHEPARD, 0 },
    { "tank_free_surface", MCOR_WEIGHT_SUM, 0 },
    { "tank_sum", MCOR_SUM, TANK_LEVELS },
    { "tank_computed", MCOR_SHEPARD, TANK_COMPUTED | TANK_LEVELS },
    { "tank_mass", MCOR_WEIGHT_SUM, TANK_MASS },
    { "tank_estimated", MCOR_SHEPARD, TANK_ESTIMATED },
    { "tank_preview", MCOR_WEIGHT_SUM, TANK_PREVIEW | TANK_LEVELS },
    { "tank_again", MCOR_SHEPARD, TANK_AGAIN },
    { "tank_wall", MCOR_SHEPARD, TANK_WALL },
    { "tank_wall_free_surface", MCOR_WEIGHT_SUM, TANK_WALL },
    { "tank_box_caps", MCOR_SHEPARD, TANK_BOX | TANK_CAPS },
    { "tank_period", MCOR_SHEPARD, TANK_PERIOD | TANK_BOX },
    { "tank_period_caps", MCOR_WEIGHT_SUM, TANK_PERIOD | TANK_CAPS },
    { "tank_topology", MCOR_SHEPARD, TANK_TOPOLOGY },
    { "tank_pairs", MCOR_SHEPARD, TANK_PAIRS | TANK_TOPOLOGY },
    { "tank_pairs_period", MCOR_SHEPARD, TANK_PAIRS | TANK_PERIOD },
    { "tank_levels", MCOR_SHEPARD, TANK_LEVELS },
    { "tank_levels_free_surface", MCOR_WEIGHT_SUM, TANK_LEVELS },
    { "tank_levels_eigenvalue", MCOR_SHEPARD, TANK_LEVELS | TANK_EIGENVALUE },
    { "tank_levels_again", MCOR_SHEPARD, TANK_LEVELS | TANK_AGAIN },
    { "tank_levels_wall", MCOR_SHEPARD, TANK_LEVELS | TANK_WALL },
    { "tank_levels_box", MCOR_SHEPARD, TANK_LEVELS | TANK_BOX },
    { "tank_levels_period", MCOR_WEIGHT_SUM, TANK_LEVELS | TANK_PERIOD },
    { "tank_levels_topology", MCOR_SHEPARD, TANK_LEVELS | TANK_TOPOLOGY },
    { "tank_plane", MCOR_SHEPARD, TANK_FLAT },
    { "tank_plane_wall", MCOR_WEIGHT_SUM, TANK_FLAT | TANK_WALL },
    { "tank_plane_caps", MCOR_SHEPARD, TANK_FLAT | TANK_BOX | TANK_CAPS },
    { "tank_plane_period", MCOR_WEIGHT_SUM, TANK_FLAT | TANK_PERIOD | TANK_CAPS },
    { "tank_plane_levels", MCOR_WEIGHT_SUM, TANK_FLAT | TANK_LEVELS },
    { "tank_plane_levels_topology", MCOR_SHEPARD, TANK_FLAT | TANK_LEVELS | TANK_TOPOLOGY },
    { "tank_filled", MCOR_SHEPARD, TANK_FILLED },
    { "tank_filled_box", MCOR_SHEPARD, TANK_FILLED | TANK_BOX },
    { "tank_filled_free_surface", MCOR_WEIGHT_SUM, TANK_FILLED | TANK_WALL },
  };
  (void)input;
  int good = 1;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
  {
    good = tank_run(context, cases + i) && good;
  }
  return good;
}

static int modules_project(mcor_context* context, const mcor_input* input)
{
  const mcor_view view = { .direction = { 1, -2, 0.5 },
    .resolution = 40,
    .weight = input->smoothing_length };
  const mcor_options options = modules_options(MCOR_WEIGHT_SUM);
  CORE_PROJECTION found;
  const mcor_status status = mcor_project(context, input, &options, &view, &found);
  modules_hash hash = { "project", CORE_HASH_OF_NOTHING };
  const int64_t pixels = (int64_t)found.size[0] * found.size[1];
  double sum = 0;
  for (int64_t i = 0; i < pixels; ++i) /* the bits of NaN differ between machines */
  {
    found.values[i] = isnan(found.values[i]) ? -1 : found.values[i];
    sum += fabs(found.values[i]);
  }
  modules_add(&hash, found.values, (size_t)pixels * sizeof(double));
  modules_end(context, &hash, found.size[0], found.size[1]);
  return status == MCOR_OK && sum > 1;
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
    { "derive", modules_derive }, { "gauge", modules_gauge }, { "flux", modules_flux },
    { "project", modules_project }, { "tank", modules_tank } };
  void* made;
  if (core_set_up(&made) != 0)
  {
    return 1;
  }
  CORE_CONTEXT context = made;
  CORE_SET set = modules_set();
  set.has_solids = 1;
  const mcor_array attributes[2] = { core_array(set.position, 3), core_array(set.scalar, 1) };
  const mcor_input input = core_input_with(&set, attributes, 2);
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
  return good ? 0 : 1;
}
