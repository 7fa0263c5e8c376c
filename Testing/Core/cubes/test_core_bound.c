/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compares bounds of the field in a box, by which MCOR_COMPLETE excludes boxes, with samples of the field. Checks all
 * nodes of the bricks that are proved to be inside. */

#include "core_fixture.h"

/* A box is given by its first brick (4 x 4 x 4 cubes) and its edge in cubes. For each box test_bound writes seven
 * numbers: the field's lower and upper bound and their rounding error, the weight's upper bound and its rounding error,
 * the number of particles, and the state. test_inside writes whether each brick is proved to be inside (above iso). */
static const char source[] =
  "__kernel void test_bound(MCOR_GRID_PARAMS, const int box_count, const real iso,\n"
  "  const real node_threshold, __global const int4* boxes, __global real* out)\n"
  "{\n"
  "  const int b = get_global_id(0);\n"
  "  if (b >= box_count)\n"
  "    return;\n"
  "  const mcor_grid grid = MCOR_GRID;\n"
  "  mcor_query query = mcor_node_query(&grid, boxes[b], 0, boxes[b].w, 1);\n"
  "  mcor_bound bound = { 0, 0, 0, 0, 0, 0 };\n"
  "  mcor_tile tile;\n"
  "  mcor_tile_init(&tile);\n"
  "  for (bool first = true; mcor_tile_next(&grid, &query, &tile, first); first = false)\n"
  "    mcor_bound_add(&query, &tile, iso, &bound);\n"
  "  const real k = (2 * (real)bound.count + MCOR_BOUND_ROUNDINGS) * MCOR_UNIT_ROUNDOFF;\n"
  "  __global real* to = out + 7 * b;\n"
  "  to[0] = mcor_lane_sum(bound.low);\n"
  "  to[1] = mcor_lane_sum(bound.high);\n"
  "  to[2] = mcor_lane_sum(bound.size) * k / (1 - k);\n"
  "  to[3] = mcor_lane_sum(bound.weight);\n"
  "  to[4] = mcor_lane_sum(MCOR_TENSOR ? bound.weight_size : bound.weight) * k / (1 - k);\n"
  "  to[5] = bound.count;\n"
  "  to[6] = bound.count ? mcor_bound_state(&bound, iso, node_threshold) : MCOR_EXAMINE;\n"
  "}\n"
  "__kernel void test_inside(MCOR_GRID_PARAMS, const int box_count, const real iso,\n"
  "  __global const int4* boxes, __global int* inside)\n"
  "{\n"
  "  const int b = get_global_id(0);\n"
  "  if (b >= box_count)\n"
  "    return;\n"
  "  const mcor_grid grid = MCOR_GRID;\n"
  "  mcor_tile wide;\n"
  "  mcor_tile_init(&wide);\n"
  "  inside[b] = mcor_seed_proof(&grid, boxes[b], false, &wide, iso) == MCOR_ABOVE;\n"
  "}\n";

/* The particles as the device has them. The unit of length is a cube's edge. */
typedef struct particles
{
  int count;
  double* x; /* [count][3] */
  float *inv_h, *weight, *trim_weight, *value;
} particles;

static float* read_reals(mcor_context* context, const mcor_buffer* buffer, int count)
{
  float* data = oracle_allocate(count, sizeof *data);
  CORE_OK(context, mcor_read(context, buffer, 0, data, (size_t)count * sizeof *data));
  return data;
}

static particles read_particles(mcor_context* context)
{
  const mcor_grid* grid = &context->grid;
  const int n = grid->count;
  particles p = { .count = n, .x = malloc((size_t)n * 3 * sizeof(double)) };
  int32_t* fix = malloc((size_t)n * sizeof *fix);
  assert_true(p.x && fix);
  const mcor_buffer* axes[3] = { &grid->px, &grid->py, &grid->pz };
  for (int a = 0; a < 3; ++a)
  {
    CORE_OK(context, mcor_read(context, axes[a], 0, fix, (size_t)n * sizeof *fix));
    for (int i = 0; i < n; ++i)
    {
      p.x[3 * i + a] = ldexp(fix[i], -context->lattice.fix_bits);
    }
  }
  free(fix);
  p.inv_h = read_reals(context, &grid->inv_h, n);
  p.trim_weight = read_reals(context, &grid->trim_weight, n);
  p.weight = read_reals(context, grid->has_solids ? &grid->fluid_weight : &grid->trim_weight, n);
  p.value = read_reals(context, &grid->value, n);
  return p;
}

static void free_particles(particles* p)
{
  free(p->x);
  free(p->inv_h);
  free(p->weight);
  free(p->trim_weight);
  free(p->value);
}

/* Writes the trimming weight and *field at a point, in double precision. For a mean, *field is sum V (A - iso) W; for a
 * sum, sum V A W; for the weight sum, sum V W. */
static void evaluate(const particles* p, const mcor_options* options, double iso,
  const double at[3], double* field, double* weight)
{
  const double norm = mcor_kernel_of(options->sph_kernel)->norm;
  *field = *weight = 0;
  for (int i = 0; i < p->count; ++i)
  {
    double d[3];
    for (int a = 0; a < 3; ++a)
    {
      d[a] = (at[a] - p->x[3 * i + a]) * (double)p->inv_h[i];
    }
    const double w = oracle_kernel_value((oracle_kernel)options->sph_kernel, 1, d, NULL) / norm;
    const double term = options->field == MCOR_SHEPARD ? (double)p->value[i] - iso
      : options->field == MCOR_SUM                     ? (double)p->value[i]
                                                       : 1;
    *field += (double)p->weight[i] * term * w;
    *weight += (double)p->trim_weight[i] * w;
  }
}

/* Writes where sample s of a box lies, in cubes: at a corner, on an edge or a face, or inside. */
static void place_sample(const cl_int4* box, int s, uint64_t* seed, double at[3])
{
  for (int a = 0; a < 3; ++a)
  {
    const double u = s < 8 ? (s >> a & 1) : random_unit(seed);
    const double t = s % 3 == 0 && s >= 8 ? floor(u * 3) / 2 : u; /* 0, 1/2 or 1 */
    at[a] = 4 * box->s[a] + t * box->s[3];
  }
}

static void check_box(const particles* p, const mcor_options* options, double iso,
  const cl_int4* box, const float out[7], int samples, uint64_t* seed)
{
  const double level = options->field == MCOR_SHEPARD ? 0 : iso;
  for (int s = 0; s < samples; ++s)
  {
    double at[3], field, weight;
    place_sample(box, s, seed, at);
    evaluate(p, options, iso, at, &field, &weight);
    CORE_CHECK(field >= (double)out[0] - (double)out[2] && field <= (double)out[1] + (double)out[2],
      mcor_sph_kernel_name(options->sph_kernel), options->field, field, at[0], at[1], at[2], out[0],
      out[1], out[2], box->s[0], box->s[1], box->s[2], box->s[3]);
    CORE_CHECK(options->field == MCOR_WEIGHT_SUM || weight <= (double)out[3] + (double)out[4],
      mcor_sph_kernel_name(options->sph_kernel), options->field, weight, out[3], out[4]);
    const int state = (int)out[6]; /* mcor_bound.cl defines the states */
    CORE_CHECK(state == 0 ? weight < options->node_threshold
        : state == 1      ? field > level
        : state == 2      ? field < level
                          : 1,
      state, field - level, weight);
  }
}

/* Returns box b. Boxes have several sizes and lie all over the lattice. The first 32 boxes hold a particle, or a place
 * 4/3 h away from a particle along x or along each axis, where M'4 is negative. */
static cl_int4 make_box(const particles* p, const mcor_lattice* lattice, int b, uint64_t* seed)
{
  static const int sizes[] = { 3, 7, 3, 31 };
  cl_int4 box;
  for (int a = 0; a < 3; ++a)
  {
    const int i = b / 4 % p->count;
    const double offset = b % 4 == 1 || (b % 4 == 2 && a == 0) ? 4.0 / 3 / (double)p->inv_h[i] : 0;
    box.s[a] = b < 32 ? (int)((p->x[3 * i + a] + offset) / 4)
                      : (int)(random_unit(seed) * 8 * lattice->blocks[a]);
    box.s[a] = box.s[a] < 8 * lattice->blocks[a] ? box.s[a] : 8 * lattice->blocks[a] - 1;
  }
  box.s[3] = sizes[b % 4];
  for (int a = 0; a < 3; ++a) /* boxes begin at whole multiples of their size */
  {
    box.s[a] -= box.s[a] % ((box.s[3] + 1) / 4);
  }
  return box;
}

/* Extracts an empty surface, which leaves the grid on the device, and adds the kernels in `source` to the program. */
static void make_grid(mcor_context* context, const particle_set* set, const mcor_options* options)
{
  const mcor_input input = core_input_to_keep(set);
  CORE_SURFACE surface = core_extract(context, &input, options);
  core_extend_program(context, source);
}

static void check_bound(mcor_context* context, const particle_set* set, mcor_options* options,
  int boxes, int samples, int decided_at_least)
{
  uint64_t seed = 11;
  const double far = 1e6;
  const double iso = options->iso_values[0];
  options->iso_values = &far; /* no surface is wanted, only the grid */
  make_grid(context, set, options);
  options->iso_values = &iso;
  particles p = read_particles(context);
  CORE_FREED cl_int4* box = oracle_allocate(boxes, sizeof *box);
  CORE_FREED float* out = oracle_allocate(boxes * 7, sizeof *out);
  for (int b = 0; b < boxes; ++b)
  {
    box[b] = make_box(&p, &context->lattice, b, &seed);
  }
  const double relative = iso - context->value_shift;
  mcor_buffer box_buffer = { 0 }, results = { 0 };
  CORE_OK(context, mcor_write(context, &box_buffer, box, (size_t)boxes * sizeof *box));
  CORE_OK(context, mcor_reserve(context, &results, (size_t)boxes * 7 * sizeof *out));
  CORE_OK(context,
    MCOR_LAUNCH(context, "test_bound", MCOR_HEAVY, boxes, MCOR_GRID_ARGS(context), MCOR_INT(boxes),
      MCOR_REAL(relative), MCOR_REAL(options->node_threshold), MCOR_BUFFER(&box_buffer),
      MCOR_BUFFER(&results)));
  CORE_OK(context, mcor_read(context, &results, 0, out, (size_t)boxes * 7 * sizeof *out));
  int decided = 0, most = 0;
  for (int b = 0; b < boxes; ++b)
  {
    check_box(&p, options, (double)(float)relative, box + b, out + 7 * b, samples, &seed);
    decided += out[7 * b + 5] > 0 && out[7 * b + 6] < 3;
    most = out[7 * b + 5] > (float)most ? (int)out[7 * b + 5] : most;
  }
  CORE_CHECK(decided >= decided_at_least, mcor_sph_kernel_name(options->sph_kernel), options->field,
    decided, boxes);
  CORE_CHECK(set->count < 10000 || most > 1000 * context->cl.lanes, most, context->cl.lanes);
  mcor_release(context, &box_buffer);
  mcor_release(context, &results);
  free_particles(&p);
}

static void test_bound(void** state)
{
  static const struct
  {
    mcor_sph_kernel kernel;
    mcor_field field;
    int solids;
  } cases[] = { { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0 }, { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1 },
    { MCOR_CUBIC_SPLINE, MCOR_SUM, 0 }, { MCOR_CUBIC_SPLINE, MCOR_WEIGHT_SUM, 0 },
    { MCOR_QUADRATIC, MCOR_SHEPARD, 0 }, { MCOR_M_PRIME_4, MCOR_SHEPARD, 0 },
    { MCOR_M_PRIME_4, MCOR_SHEPARD, 1 }, { MCOR_M_PRIME_4, MCOR_SUM, 0 },
    { MCOR_M_PRIME_4, MCOR_WEIGHT_SUM, 0 }, { MCOR_QUINTIC_SPLINE, MCOR_SHEPARD, 0 },
    { MCOR_WENDLAND_C2, MCOR_SHEPARD, 0 }, { MCOR_QUARTIC_SPLINE, MCOR_SHEPARD, 0 },
    { MCOR_WENDLAND_C4, MCOR_SUM, 0 }, { MCOR_WENDLAND_C6, MCOR_WEIGHT_SUM, 0 },
    { MCOR_SINC_6, MCOR_SHEPARD, 0 }, { MCOR_SINC_6, MCOR_WEIGHT_SUM, 0 } };
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; ++c)
  {
    /* Few particles show a fault in the bound of a single particle. The second set has many
     * particles of mixed sizes, the last set one particle. */
    static const int counts[] = { 6, 150, 1 };
    for (int s = 0; s < 3; ++s)
    {
      CORE_SET set = core_make_random(counts[s], 5, s == 0 ? 1 : 0.3, 1, 40 + (uint64_t)s);
      for (int i = 0; i < counts[s]; ++i)
      {
        set.solid[i] = i % 3 == 1;
        set.scalar[i] += i % 5 == 0 ? 3 : 0;
      }
      set.has_solids = cases[c].solids;
      const double iso = cases[c].field == MCOR_WEIGHT_SUM ? 0.05 : 0.2;
      mcor_options options = core_options(&iso);
      options.sph_kernel = cases[c].kernel;
      options.field = cases[c].field;
      options.seeds = MCOR_PAIRS;
      options.cube_size = 0.13;
      check_bound(*state, &set, &options, 160, 60, s == 2 ? 0 : 10);
    }
  }
}

/* Many equal particles lie in one place. Each step of a sum rounds in the same direction, so errors add up. */
static void test_many_particles(void** state)
{
  static const struct
  {
    mcor_sph_kernel kernel;
    mcor_field field;
    double volume;
  } cases[] = { { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0.7 }, { MCOR_CUBIC_SPLINE, MCOR_SUM, 0.9 },
    { MCOR_M_PRIME_4, MCOR_SHEPARD, 1.1 } };
  CORE_SET set = core_make_random(24000, 0, 1, 1, 50);
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; ++c)
  {
    for (int i = 0; i < set.count; ++i)
    {
      set.volume[i] = cases[c].volume / 24000;
      set.scalar[i] = i == 0 ? 0.7 : 3.3;
    }
    const double iso = 1;
    mcor_options options = core_options(&iso);
    options.sph_kernel = cases[c].kernel;
    options.field = cases[c].field;
    options.seeds = MCOR_PAIRS;
    options.cube_size = 0.1;
    check_bound(*state, &set, &options, 24, 12, 0);
  }
}

/* Counts the nodes of a brick where the weight sum is at least iso. */
static int count_above(
  const particles* p, const mcor_options* options, const cl_int4* brick, double iso)
{
  int above = 0;
  for (int node = 0; node < 64; ++node)
  {
    const double at[3] = { 4 * brick->s[0] + node % 4, 4 * brick->s[1] + node / 4 % 4,
      4 * brick->s[2] + node / 16 };
    double field, weight;
    evaluate(p, options, iso, at, &field, &weight);
    above += field >= iso;
  }
  return above;
}

/* Checks that the weight sum is at least iso at all nodes of the bricks that are proved to be inside. The proof uses
 * only particles that have a node of the brick within half their support. At some iso values that the test uses, these
 * particles suffice for some nodes of a brick, but not for all. */
static void check_inside(mcor_context* context, const particles* p, const mcor_options* options,
  const cl_int4* bricks, int count, double iso)
{
  mcor_buffer box_buffer = { 0 }, results = { 0 };
  CORE_FREED int* inside = oracle_allocate(count, sizeof *inside);
  CORE_OK(context, mcor_write(context, &box_buffer, bricks, (size_t)count * sizeof *bricks));
  CORE_OK(context, mcor_reserve(context, &results, (size_t)count * sizeof *inside));
  CORE_OK(context,
    MCOR_LAUNCH(context, "test_inside", MCOR_HEAVY, count, MCOR_GRID_ARGS(context), MCOR_INT(count),
      MCOR_REAL(iso), MCOR_BUFFER(&box_buffer), MCOR_BUFFER(&results)));
  CORE_OK(context, mcor_read(context, &results, 0, inside, (size_t)count * sizeof *inside));
  int found = 0;
  for (int b = 0; b < count; ++b)
  {
    const int above = inside[b] ? count_above(p, options, bricks + b, iso) : 64;
    CORE_CHECK(above == 64, iso, bricks[b].s[0], bricks[b].s[1], bricks[b].s[2], above);
    found += inside[b];
  }
  CORE_CHECK(iso > 0.5 || found > 20, iso, found, count);
  mcor_release(context, &box_buffer);
  mcor_release(context, &results);
}

static void test_inside(void** state)
{
  mcor_context* context = *state;
  const double far = 1e6;
  CORE_SET set = core_make_block(9, 0.4, 5, core_slope);
  mcor_options options = core_options(&far);
  options.field = MCOR_WEIGHT_SUM;
  options.cube_size = 0.3;
  make_grid(context, &set, &options);
  particles p = read_particles(context);
  cl_int4 bricks[512];
  for (int b = 0; b < 512; ++b)
  {
    for (int a = 0; a < 3; ++a)
    {
      /* The block of particles surrounds the origin, which is a corner of a brick. */
      bricks[b].s[a] = (b >> 3 * a & 7) - 4 - (int)(context->lattice.origin[a] / 4);
    }
    bricks[b].s[3] = 0;
  }
  for (double iso = 0.3; iso < 1.2; iso += 0.05)
  {
    check_inside(context, &p, &options, bricks, 512, iso);
  }
  free_particles(&p);
}

CORE_MAIN(core_set_up, core_tear_down, test_bound, test_many_particles, test_inside)
