/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Prints a hash of each of a few surfaces. same_bits.cmake compares the hashes between settings of the environment. The
 * argument chooses the cases; without an argument, all cases run. "small": all cases with few particles, for slow
 * devices. "fewer": as "small", without cases that have many nodes or run the same kernels as another case, for tools
 * that slow everything down. "devices": a few small cases on all devices, each compared with the first device. "usual":
 * the cases that every device can do. "kernels": all other cases, and one for each SPH kernel and precision. */

#include "core_fixture.h"
#include "core_keep.h"
#include "mcor_internal.h"

typedef struct bits_case
{
  const char* name;
  mcor_sph_kernel kernel;
  mcor_field field;
  mcor_type precision;
  mcor_seed_mode seeds;
  mcor_boundary_detection boundary;
  int solids, volumes;
  double iso;
  mcor_topology topology;
  double wall_share;
  int mixed;  /* smoothing lengths 1 : 64 */
  int smooth; /* 1: compact, 2: widened, 3: both */
} bits_case;

static const bits_case cases[] = {
  { "shepard", .solids = 1, .iso = 0.5 },
  { "pairs", .seeds = MCOR_PAIRS, .solids = 1, .volumes = 1, .iso = 0.5 },
  { "eigenvalue", .boundary = MCOR_BOUNDARY_EIGENVALUE, .solids = 1, .iso = -14 },
  { "sum", .kernel = MCOR_M_PRIME_4, .field = MCOR_SUM, .volumes = 1, .iso = 1.5 },
  { "tensor_eigenvalue", .kernel = MCOR_M_PRIME_4, .field = MCOR_SUM,
    .boundary = MCOR_BOUNDARY_EIGENVALUE, .volumes = 1, .iso = -14 },
  { "weight", .kernel = MCOR_QUINTIC_SPLINE, .field = MCOR_WEIGHT_SUM, .precision = MCOR_FLOAT64,
    .iso = 0.5 },
  { "double_eigenvalue", .kernel = MCOR_QUINTIC_SPLINE, .precision = MCOR_FLOAT64,
    .boundary = MCOR_BOUNDARY_EIGENVALUE, .iso = -14 },
  { "sinc6_eigenvalue", .kernel = MCOR_SINC_6, .boundary = MCOR_BOUNDARY_EIGENVALUE, .solids = 1,
    .iso = -14 },
  { "double_sinc6", .kernel = MCOR_SINC_6, .precision = MCOR_FLOAT64, .iso = 0.5 },
  { "quartic", .kernel = MCOR_QUARTIC_SPLINE, .field = MCOR_WEIGHT_SUM, .iso = 0.5 },
  { "wendland_c6_eigenvalue", .kernel = MCOR_WENDLAND_C6, .boundary = MCOR_BOUNDARY_EIGENVALUE,
    .iso = -14 },
  { "topology", .solids = 1, .iso = 0.1, .topology = MCOR_TOPOLOGY_FIELD },
  { "wall", .field = MCOR_WEIGHT_SUM, .solids = 1, .iso = 0.5, .wall_share = 0.2 },
  { "mixed", .boundary = MCOR_BOUNDARY_EIGENVALUE, .solids = 1, .iso = -14, .mixed = 1 },
  { "compact", .field = MCOR_WEIGHT_SUM, .iso = 0.5, .smooth = 1 },
  { "compact_trimmed", .boundary = MCOR_BOUNDARY_EIGENVALUE, .solids = 1, .iso = -14, .smooth = 1 },
  { "widened", .field = MCOR_WEIGHT_SUM, .solids = 1, .iso = 0.5, .smooth = 2 },
  { "smooth", .field = MCOR_WEIGHT_SUM, .iso = 0.5, .smooth = 3 },
};

/* Multiplies the support of every third particle by up to 64, and its volume by the cube of this factor. */
static void widen(particle_set* set, uint64_t* seed)
{
  for (int64_t i = 0; i < set->count; i += 3)
  {
    /* pow() is avoided, because its bits differ between systems. */
    const int doublings = (int)(random_bits(seed) % 6);
    const double factor = ldexp(1 + random_unit(seed), doublings);
    set->smoothing_length[i] *= factor;
    set->volume[i] *= factor * factor * factor;
  }
}

static int run_case(mcor_context* context, const bits_case* at, int small, uint64_t* hash)
{
  const int noise = at->topology == MCOR_TOPOLOGY_FIELD; /* noise makes ambiguous faces */
  const int eigenvalue = at->boundary == MCOR_BOUNDARY_EIGENVALUE;
  const double small_iso = eigenvalue && !at->mixed ? 5 : 6;
  const double iso = small && at->field != MCOR_WEIGHT_SUM && !noise ? small_iso : at->iso;
  CORE_SET set = core_make_block(small ? (noise ? 5 : 4) : 10, 0.3, 8, core_ball);
  uint64_t seed = 4;
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.smoothing_length[i] *= 1 + random_unit(&seed);
    set.solid[i] = random_bits(&seed) % 8 == 0;
    set.scalar[i] = noise ? 2 * random_unit(&seed) - 1 : set.scalar[i];
  }
  if (at->mixed)
  {
    widen(&set, &seed);
  }
  set.has_solids = at->solids;
  const mcor_array attributes[2] = { core_array(set.position, 3), core_array(set.scalar, 1) };
  mcor_input input = core_input_with(&set, attributes, 2);
  input.volume = at->volumes ? input.volume : (mcor_array){ 0 };
  mcor_options options = core_options(&iso);
  options.sph_kernel = at->kernel;
  options.field = at->field;
  options.precision = at->precision;
  options.seeds = at->seeds;
  options.topology = at->topology;
  const double small_cubes = noise ? 1 : 0.325 * mcor_support_factor(at->kernel);
  options.cube_size_factor = small ? small_cubes : noise ? 0.7 : options.cube_size_factor;
  options.h_scale = noise ? 0.5 : options.h_scale;
  options.outputs |=
    MCOR_OUT_GRADIENTS | MCOR_OUT_WEIGHT_SUM | MCOR_OUT_CORRECTION_LENGTH | MCOR_OUT_RESIDUAL;
  options.boundary_detection = at->boundary;
  options.vertex_threshold = small && eigenvalue ? 0.3 : 0.5;
  options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE;
  options.wall_share = at->wall_share;
  options.compact = at->smooth & 1;
  options.widen = at->smooth & 2 ? 2 : 1;
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG | MCOR_OUT_NEAREST_PARTICLE;
  CORE_SURFACE surface = { 0 };
  const mcor_status status = core_extract_widened(context, &input, &options, &surface);
  const mcor_statistics* statistics = &surface.statistics;
  const int trimmed = statistics->trim_vertices > statistics->trim_vertices_linear;
  const int resolved = statistics->joined_faces > 0 && statistics->ambiguous_cells > 0;
  /* Without a driver there is only the built-in device, which may lack double precision and some SPH kernels. */
  const int left_out =
    status == MCOR_DEVICE_ERROR && (at->precision == MCOR_FLOAT64 || at->kernel > MCOR_WENDLAND_C2);
  const int good = left_out ||
    (status == MCOR_OK && surface.triangle_count > 0 &&
      (trimmed || !(eigenvalue || at->wall_share > 0)) && (resolved || !noise));
  if (!good)
  {
    fprintf(stderr, "%s: %lld triangles, %lld cut. %s\n", at->name,
      (long long)surface.triangle_count, (long long)statistics->trim_vertices,
      mcor_last_error(context));
  }
  *hash = core_hash(&surface);
  printf("form %d lanes, %s\n", context->cl.lanes, context->cl.is_cpu ? "CPU" : "GPU");
  printf("%s: %lld points, %lld triangles, %lld cut, %016llx\n", at->name,
    (long long)surface.point_count, (long long)surface.triangle_count,
    (long long)statistics->trim_vertices, (unsigned long long)*hash);
  fflush(stdout);
  if (left_out)
  {
    core_keep_size(at->name, 0, -1);
  }
  else
  {
    core_keep_surface(at->name, &input, &surface);
  }
  return good;
}

/* Returns whether every device can do the case: it needs only single precision and the cubic spline. */
static int is_usual(const bits_case* at)
{
  return at->precision == MCOR_FLOAT32 && at->kernel == MCOR_CUBIC_SPLINE;
}

static int run_kernels(mcor_context* context)
{
  int good = 1;
  for (int k = 0; k < 2 * MCOR_SPH_KERNEL_COUNT; ++k)
  {
    char name[64];
    uint64_t hash;
    const mcor_sph_kernel kernel = (mcor_sph_kernel)(k / 2);
    const bits_case at = {
      .name = name, .kernel = kernel, .precision = k % 2 ? MCOR_FLOAT64 : MCOR_FLOAT32, .iso = 0.5
    };
    snprintf(name, sizeof name, "%s_%s", mcor_sph_kernel_name(kernel), k % 2 ? "double" : "single");
    good = run_case(context, &at, 0, &hash) && good;
  }
  return good;
}

/* Runs the small cases that share one device program (to build another may take half a minute). Device 0 sets
 * `expected`. Returns whether all cases succeed and, on other devices, have the expected hashes. */
static int run_device(int device, uint64_t expected[])
{
  char number[16];
  CORE_CONTEXT context = NULL;
  snprintf(number, sizeof number, "%d", device);
  int good = mcor_create_context(number, &context) == MCOR_OK;
  if (!good)
  {
    fprintf(stderr, "%s\n", mcor_last_error(context));
  }
  for (size_t i = 0; good && i < sizeof cases / sizeof cases[0]; ++i)
  {
    uint64_t hash = 0;
    if (is_usual(cases + i) && cases[i].field == MCOR_SHEPARD)
    {
      good = run_case(context, cases + i, 1, &hash) && (device == 0 || hash == expected[i]);
      expected[i] = device == 0 ? hash : expected[i];
    }
  }
  return good;
}

/* Runs the cases of run_device on all devices, the built-in one first. Each device uses its default form of the OpenCL
 * kernels, the one for CPUs or for GPUs. */
static int run_devices(void)
{
  uint64_t expected[sizeof cases / sizeof cases[0]];
  char* text = NULL;
  int good = mcor_list_devices(&text) == MCOR_OK;
  const char* line = text;
  for (int device = 0; good && *line; ++device, line = strchr(line, '\n') + 1)
  {
    const int length = (int)strcspn(line, "\n");
    printf("%.*s\n", length, line);
    fflush(stdout);
    const int same = run_device(device, expected);
    printf("%.*s: %s\n", length, line, same ? "the same bits" : "FAILED, or other bits");
    good = same && good;
  }
  free(text);
  return good && line != text;
}

int main(int argc, char** argv)
{
  if (argc > 1 && strcmp(argv[1], "devices") == 0)
  {
    return run_devices() ? 0 : 1;
  }
  void* made;
  if (core_set_up(&made) != 0)
  {
    return 1;
  }
  CORE_CONTEXT context = made;
  const char* word = argc > 1 ? argv[1] : "";
  const int fewer = strcmp(word, "fewer") == 0, usual = strcmp(word, "usual") == 0;
  const int kernels = strcmp(word, "kernels") == 0;
  const int small = argc > 1 && !usual && !kernels;
  int good = !kernels || run_kernels(context);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
  {
    uint64_t hash;
    const int repeats = cases[i].mixed ||
      (cases[i].boundary == MCOR_BOUNDARY_EIGENVALUE && cases[i].kernel != MCOR_M_PRIME_4);
    const int skipped =
      (fewer && repeats) || (usual && !is_usual(cases + i)) || (kernels && is_usual(cases + i));
    good = (skipped || run_case(context, cases + i, small, &hash)) && good;
  }
  return good ? 0 : 1;
}
