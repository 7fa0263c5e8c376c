/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests projections. They are compared with the oracle's kernels, integrated numerically along the line of sight and
 * over each pixel. */

#include "core_ranks.h"
#include "mcor_plane.h"
#include "mcor_vector.h"

#define ALLOWED 1e-6 /* relative to the most that a particle adds to a pixel */
#define PROFILE 8192
#define MOST_RANKS 3

static const double gauss_at[5] = { -0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
  0.9061798459386640 };
static const double gauss_weight[5] = { 0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
  0.2393143352496832, 0.1184634425280945 };

/* The column density of a kernel with h = 1, tabulated over the distance from the line of sight. */
typedef struct column
{
  oracle_kernel kernel;
  int is_plane;
  double axes[3][3], reach;
  double profile[PROFILE + 3];
} column;

static double line_integral(const column* c, double x, double y, double reach, int panels)
{
  double sum = 0;
  for (int i = 0; i < panels; ++i)
  {
    for (int g = 0; g < 5; ++g)
    {
      /* Except for M'4, points of integration are denser near the particle, where w may have a cusp. */
      const double at_end = (i + 0.5 + 0.5 * gauss_at[g]) / panels;
      const double t = c->kernel == ORACLE_M_PRIME_4 ? cbrt(at_end) : at_end, z = reach * t * t * t;
      for (int sign = -1; sign <= 1; sign += 2)
      {
        double at[3];
        for (int a = 0; a < 3; ++a)
        {
          at[a] = x * c->axes[0][a] + y * c->axes[1][a] + sign * z * c->axes[2][a];
        }
        sum += gauss_weight[g] / panels * (c->kernel == ORACLE_M_PRIME_4 ? 1 : 3 * t * t) * reach *
          oracle_kernel_value(c->kernel, 1, at, NULL);
      }
    }
  }
  return sum;
}

static double density_at(const column* c, double x, double y)
{
  if (c->is_plane)
  {
    const double at[3] = { x, y, 0 };
    return oracle_kernel_value(c->kernel, 1, at, NULL) *
      mcor_kernel_of((mcor_sph_kernel)c->kernel)->plane_factor;
  }
  if (c->kernel == ORACLE_M_PRIME_4)
  {
    const double u[3] = { x, 0, 0 }, v[3] = { 0, y, 0 };
    return c->axes[2][2] == 1
      ? oracle_kernel_value(c->kernel, 1, u, NULL) * oracle_kernel_value(c->kernel, 1, v, NULL)
      : line_integral(c, x, y, c->reach, 150);
  }
  const double at = hypot(x, y) * PROFILE / c->reach;
  if (at >= PROFILE)
  {
    return 0;
  }
  const int i = (int)at;
  const double t = at - i, *p = c->profile + i;
  return p[0] + t * (p[1] - p[0]) + 0.5 * t * (t - 1) * (p[2] - 2 * p[1] + p[0]);
}

static column make_column(mcor_sph_kernel kernel, int is_plane, const mcor_projection* view)
{
  static column c = { .kernel = ORACLE_KERNEL_COUNT }; /* keeps the profile of the last call */
  const double support = oracle_support((oracle_kernel)kernel);
  const int is_known = c.kernel == (oracle_kernel)kernel;
  c.kernel = (oracle_kernel)kernel;
  c.is_plane = is_plane;
  memcpy(c.axes, view->axes, sizeof c.axes);
  c.reach = kernel == MCOR_M_PRIME_4 ? 2 * sqrt(3.0) : support;
  for (int i = 0; i < PROFILE && kernel != MCOR_M_PRIME_4 && !is_known; ++i)
  {
    const double r = i * support / PROFILE;
    c.profile[i] = line_integral(&c, r, 0, sqrt(support * support - r * r), 60);
  }
  return c;
}

/* Adds what a particle contributes to every `step`-th pixel. Returns the largest contribution. */
static double add_particle(const column* c, const mcor_projection* view, const double x[3],
  double h, double amount, double cells_per_h, int step, double* image)
{
  double at[2], most = 0;
  for (int k = 0; k < 2; ++k)
  {
    at[k] = mcor_dot(view->axes + 3 * k, x) - view->low[k];
  }
  for (int p = 0; p < view->size[0] * view->size[1]; p += step)
  {
    const int place[2] = { p % view->size[0], p / view->size[0] };
    double from[2], cell[2];
    int cells[2];
    for (int k = 0; k < 2; ++k)
    {
      const double low = place[k] * view->pixel[k] - at[k], high = low + view->pixel[k];
      from[k] = fmax(low / h, -c->reach);
      const double length = fmin(high / h, c->reach) - from[k];
      cells[k] = length > 0 ? 1 + (int)(length * cells_per_h) : 0;
      cell[k] = length / cells[k];
    }
    double sum = 0;
    for (int i = 0; i < 25 * cells[0] * cells[1]; ++i)
    {
      const int u = i % 5, v = i / 5 % 5, m = i / 25 % cells[0], n = i / 25 / cells[0];
      sum += gauss_weight[u] * gauss_weight[v] *
        density_at(c, from[0] + (m + 0.5 + 0.5 * gauss_at[u]) * cell[0],
          from[1] + (n + 0.5 + 0.5 * gauss_at[v]) * cell[1]);
    }
    const double mean = sum * cell[0] * cell[1] * amount / (view->pixel[0] * view->pixel[1]);
    image[p] += cells[0] * cells[1] > 0 ? mean : 0;
    most = fmax(most, cells[0] * cells[1] > 0 ? fabs(mean) : 0);
  }
  return most;
}

static double total_of(const mcor_projection* view)
{
  double sum = 0;
  for (int p = 0; p < view->size[0] * view->size[1]; ++p)
  {
    sum += view->values[p];
  }
  return sum * view->pixel[0] * view->pixel[1];
}

static double error_of(const mcor_projection* view, const double* image, int step)
{
  double most = 0;
  for (int p = 0; p < view->size[0] * view->size[1]; p += step)
  {
    most = fmax(most, fabs(view->values[p] - image[p]));
  }
  return most;
}

/* Returns an input that has masses in the place of volumes, and no scalar. */
static mcor_input input_of(const particle_set* set)
{
  mcor_input input = core_input(set);
  input.mass = input.volume;
  input.volume = input.scalar = (mcor_array){ 0 };
  return input;
}

static mcor_options project_options(mcor_sph_kernel kernel)
{
  mcor_options options = core_options(NULL);
  options.sph_kernel = kernel;
  return options;
}

/* ---- single particles ---- */

static void check_single(mcor_context* context, mcor_sph_kernel kernel, const double direction[3],
  double pixels_per_h, int is_plane, double cells_per_h)
{
  const double amount = 2.5, h = 0.7,
               reach = (kernel == MCOR_M_PRIME_4 ? 3.5 : oracle_support((oracle_kernel)kernel)) * h;
  CORE_SET set = particle_set_make(is_plane ? 3 : 1);
  const double x[3] = { 3.1, -2.3, 1.7 };
  /* If is_plane, two more particles define the plane. They lie beyond the image. */
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.position[3 * i] = x[0] + (i == 1) * 1e4;
    set.position[3 * i + 1] = x[1] + (i == 2) * 1e4;
    set.position[3 * i + 2] = x[2];
    set.smoothing_length[i] = h;
    set.volume[i] = amount;
  }
  const mcor_input input = input_of(&set);
  mcor_options options = project_options(kernel);
  options.precision = pixels_per_h > 1 ? MCOR_FLOAT64 : MCOR_FLOAT32;
  /* The particle lies within the image, neither at a pixel's centre nor on its border. */
  mcor_view view = { .resolution = (int)ceil(2 * reach * pixels_per_h / h) + 2 };
  memcpy(view.direction, direction, sizeof view.direction);
  const double side = view.resolution * h / pixels_per_h;
  for (int a = 0; a < 3; ++a)
  {
    view.box[2 * a] = x[a] - 0.5 * side + 0.37 * h / pixels_per_h * (a == 0 ? 1 : -0.6);
    view.box[2 * a + 1] = view.box[2 * a] + side;
  }
  CORE_PROJECTION found;
  CORE_OK(context, mcor_project(context, &input, &options, &view, &found));
  const column c = make_column(kernel, is_plane, &found);
  const int pixels = found.size[0] * found.size[1],
            step = cells_per_h == 8 ? 9
    : pixels > 3000                 ? pixels / 1500
                                    : 1;
  CORE_FREED double* image = oracle_allocate(pixels, sizeof *image);
  const double most = fmax(add_particle(&c, &found, x, h, amount, cells_per_h, step, image),
    step > 1 ? amount * density_at(&c, 0, 0) / (h * h) : 0);
  const double error = error_of(&found, image, step), mass = total_of(&found);
  CORE_CHECK(
    error <= ALLOWED * most, mcor_sph_kernel_name(kernel), pixels_per_h, error / most, most);
  CORE_CHECK(
    fabs(mass - amount) <= ALLOWED * amount, mcor_sph_kernel_name(kernel), pixels_per_h, mass);
}

static void test_single(void** state)
{
  static const double sizes[] = { 0.05, 0.3, 1, 2.9, 3.1, 11, 50 };
  const double z[3] = { 0, 0, 1 }, x[3] = { -2, 0, 0 }, oblique[3] = { 1, -2, 1.5 };
  for (int k = 0; k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i)
    {
      /* In a plane the quadratic kernel has a pointed tip, so the integral over pixels needs more
       * cells. */
      const double fine = k != MCOR_QUADRATIC ? 16 : sizes[i] > 10 ? 256 : 32;
      check_single(*state, k, z, sizes[i], 0, k == MCOR_QUADRATIC ? 32 : 16);
      check_single(*state, k, z, sizes[i], 1, fine);
      if (k != MCOR_M_PRIME_4)
      {
        check_single(*state, k, i % 2 ? x : oblique, sizes[i], 0, k == MCOR_QUADRATIC ? 32 : 16);
      }
    }
  }
  check_single(*state, MCOR_M_PRIME_4, oblique, 2.9, 0, 8);
}

/* ---- many particles ---- */

/* Makes Evrard's sphere in random order: density falls as 1 / r, and h follows the density. */
static particle_set make_evrard(int64_t count)
{
  particle_set set = particle_set_make(count);
  uint64_t seed = 3;
  for (int64_t i = 0; i < count; ++i)
  {
    const double r = sqrt((double)((i * 7919) % count) + 0.5) / sqrt((double)count);
    const double z = 2 * random_unit(&seed) - 1, w = 2 * M_PI * random_unit(&seed),
                 s = sqrt(1 - z * z);
    set.position[3 * i] = r * s * cos(w);
    set.position[3 * i + 1] = r * s * sin(w);
    set.position[3 * i + 2] = r * z;
    set.volume[i] = 1.0 / (double)count;
    set.smoothing_length[i] = 1.3 * cbrt(2 * M_PI * r / (double)count);
    set.scalar[i] = random_unit(&seed) - 0.3;
  }
  return set;
}

static void test_brute_force(void** state)
{
  CORE_SET set = make_evrard(400);
  const double directions[3][3] = { { 0, 0, 0 }, { 0, 1, 0 }, { 3, 1, 0.5 } };
  for (int d = 0; d < 6; ++d)
  {
    const int is_periodic = d >= 3;
    const mcor_input input = input_of(&set);
    mcor_options options = project_options(MCOR_CUBIC_SPLINE);
    options.h_scale = 0.9;
    for (int i = 0; i < 6 && is_periodic; ++i) /* the sphere reaches beyond the period */
    {
      options.periodic[i] = i % 2 ? 0.9 : -0.7;
    }
    mcor_view view = { .resolution = 40 };
    memcpy(view.direction, directions[d % 3], sizeof view.direction);
    CORE_PROJECTION found;
    CORE_OK(*state, mcor_project(*state, &input, &options, &view, &found));
    const column c = make_column(MCOR_CUBIC_SPLINE, 0, &found);
    CORE_FREED double* image = oracle_allocate(40 * 40, sizeof *image);
    double most = 0, mass = 0;
    for (int64_t i = 0; i < set.count; ++i)
    {
      double x[3];
      for (int a = 0; a < 3; ++a)
      {
        x[a] = set.position[3 * i + a];
        x[a] -= is_periodic ? 1.6 * floor((x[a] + 0.7) / 1.6) : 0;
      }
      const double h = 0.9 * set.smoothing_length[i];
      /* In a view along an axis, the period's images lie on all sides of the line of sight. */
      const int images = is_periodic && d % 3 < 2 ? 1 : 0;
      for (int u = -images; u <= images; ++u)
      {
        for (int v = -images; v <= images; ++v)
        {
          double at[3];
          for (int a = 0; a < 3; ++a)
          {
            at[a] = x[a] + 1.6 * (u * found.axes[a] + v * found.axes[3 + a]);
          }
          most = fmax(most, add_particle(&c, &found, at, h, set.volume[i], 8, 1, image));
        }
      }
      mass += set.volume[i];
    }
    const double error = error_of(&found, image, 1);
    CORE_CHECK(error <= ALLOWED * most, d, error / most, most);
    CORE_CHECK(
      d == 5 || fabs(total_of(&found) - mass) <= ALLOWED * mass, d, total_of(&found), mass);
  }
}

/* Checks that a box sets the image's frame and chooses particles along the line of sight, and that a period gives the
 * same image as copies of the particles. */
static void test_box(void** state)
{
  CORE_SET set = core_make_random(60, 1, 0.05, 0.2, 8), copies = particle_set_make(60 * 45);
  for (int64_t i = 0; i < copies.count; ++i)
  {
    const int64_t from = i % 60, n = i / 60, image[3] = { n % 3 - 1, n / 3 % 5 - 2, n / 15 - 1 };
    for (int a = 0; a < 3; ++a)
    {
      copies.position[3 * i + a] = set.position[3 * from + a] + (double)image[a];
    }
    copies.smoothing_length[i] = set.smoothing_length[from];
    copies.volume[i] = set.volume[from];
  }
  const mcor_view view = {
    .direction = { 1, 0, 0 }, .box = { -0.5, 0.25, -1.25, 1.25, -INFINITY, 0.3 }, .resolution = 50
  };
  mcor_options options = project_options(MCOR_WENDLAND_C4);
  const mcor_input with_copies = input_of(&copies);
  mcor_input input = input_of(&set);
  CORE_PROJECTION expected, found;
  mcor_view whole = view;
  whole.box[4] = -0.5; /* the infinite side becomes the period's */
  CORE_OK(*state, mcor_project(*state, &with_copies, &options, &whole, &expected));
  for (int i = 0; i < 6; ++i)
  {
    options.periodic[i] = i % 2 ? 0.5 : -0.5;
  }
  CORE_OK(*state, mcor_project(*state, &input, &options, &view, &found));
  assert_int_equal(found.size[0], 50);
  assert_int_equal(found.size[1], 16);
  assert_true(found.low[0] == -1.25 && found.low[1] == -0.5 && found.low[2] == -0.5 &&
    found.pixel[0] == 0.05);
  double most = 0;
  for (int p = 0; p < 50 * 16; ++p)
  {
    most = fmax(most, expected.values[p]);
  }
  CORE_CHECK(most > 0 && error_of(&found, expected.values, 1) < 1e-12 * most,
    error_of(&found, expected.values, 1) / most);
}

/* Checks sums and means of a scalar, weighted by volumes, by an array, by masses, and by computed volumes. */
static void test_weights(void** state)
{
  CORE_SET set = make_evrard(300);
  CORE_FREED double* weight = oracle_allocate(300, sizeof *weight);
  CORE_FREED double* product = oracle_allocate(300, sizeof *product);
  for (int i = 0; i < 300; ++i)
  {
    weight[i] = 1 + i % 3;
    set.volume[i] *= 1 + i % 5;
    product[i] = weight[i] * set.scalar[i];
  }
  mcor_options options = project_options(MCOR_CUBIC_SPLINE);
  mcor_view view = { .resolution = 32 };
  mcor_input input = core_input(&set);
  CORE_PROJECTION product_sum, weight_sum, mean, by_mass, computed, given;
  input.scalar = core_array(product, 1);
  CORE_OK(*state, mcor_project(*state, &input, &options, &view, &product_sum));
  input.scalar = core_array(weight, 1);
  CORE_OK(*state, mcor_project(*state, &input, &options, &view, &weight_sum));
  input.scalar = core_array(set.scalar, 1);
  view.weight = core_array(weight, 1);
  CORE_OK(*state, mcor_project(*state, &input, &options, &view, &mean));
  view.weight = (mcor_array){ .memory = weight }; /* a buffer would be read as no weight */
  CORE_FAILS(*state, MCOR_INVALID_ARGUMENT, mcor_project(*state, &input, &options, &view, &by_mass),
    "WEIGHT_IN_BUFFER");
  view.weight = core_array(weight, 1);
  input.mass = core_array(weight, 1); /* The weights are the masses, so m replaces V B. */
  CORE_OK(*state, mcor_project(*state, &input, &options, &view, &by_mass));
  int seen = 0, empty = 0;
  for (int p = 0; p < mean.size[0] * mean.size[1]; ++p)
  {
    const double expected = product_sum.values[p] / weight_sum.values[p];
    empty += isnan(mean.values[p]) != 0;
    seen += fabs(mean.values[p] - expected) < 1e-9 * (1 + fabs(expected));
    CORE_CHECK(
      isnan(mean.values[p]) || (mean.values[p] >= -0.3 - 1e-9 && mean.values[p] <= 0.7 + 1e-9),
      mean.values[p]);
  }
  CORE_CHECK(
    seen + empty >= mean.size[0] * mean.size[1] - 3 && empty > 0 && seen > 500, seen, empty);
  assert_true(error_of(&by_mass, mean.values, 1) > 1e-3);
  CORE_WIDENING widening;
  options.widen = 2;
  input.volume = input.mass = view.weight = (mcor_array){ 0 };
  CORE_OK(*state, mcor_widen(*state, &input, &options, &widening));
  options.widen = 1;
  CORE_OK(*state, mcor_project(*state, &input, &options, &view, &computed));
  input.volume = core_array(widening.volume, 1);
  CORE_OK(*state, mcor_project(*state, &input, &options, &view, &given));
  const double error = error_of(&computed, given.values, 1);
  CORE_CHECK(error < 1e-5 * fabs(given.values[given.size[0] * 16 + 16]), error);
}

/* ---- the same bits ---- */

typedef struct rank_job
{
  const particle_set* set;
  mcor_projection found[MOST_RANKS];
} rank_job;

static mcor_view view_of_bits(void)
{
  return (mcor_view){ .direction = { 1, 2, 3 }, .resolution = 100 };
}

/* Projects the particles of one rank: every count-th particle. */
static mcor_status project_part(core_rank* rank, void* data)
{
  rank_job* job = data;
  const int r = rank->number, count = rank->world->count;
  CORE_SET part = particle_set_make(job->set->count);
  part.count = 0;
  for (int64_t i = r; i < job->set->count; i += count)
  {
    particle_set_append(&part, job->set, i);
  }
  const mcor_input input = input_of(&part);
  mcor_options options = project_options(MCOR_QUINTIC_SPLINE);
  options.ranks = &rank->ranks;
  const mcor_view view = view_of_bits();
  return mcor_project(rank->context, &input, &options, &view, &job->found[r]);
}

static int same_bits(const mcor_projection* a, const mcor_projection* b)
{
  return a->size[0] == b->size[0] && a->size[1] == b->size[1] && a->size[0] > 0 &&
    memcmp(a->low, b->low, sizeof a->low) == 0 &&
    memcmp(a->values, b->values, (size_t)(a->size[0] * a->size[1]) * sizeof(double)) == 0;
}

static void test_same_bits(void** state)
{
  CORE_SET set = make_evrard(9001);
  CORE_FREED int64_t* order = core_make_order(set.count, 4);
  CORE_SET shuffled = core_permute(&set, order);
  const mcor_options options = project_options(MCOR_QUINTIC_SPLINE);
  const mcor_view view = view_of_bits();
  mcor_input input = input_of(&set);
  mcor_projection alone, other;
  CORE_OK(*state, mcor_project(*state, &input, &options, &view, &alone));
  input = input_of(&shuffled);
  for (int several = 0; several < 2; ++several)
  {
    CORE_CONTEXT context = NULL;
    core_create_with(&context, "MCOR_THREADS", several ? "5" : "1");
    CORE_OK(context, mcor_project(context, &input, &options, &view, &other));
    assert_true(same_bits(&alone, &other));
    mcor_free_projection(&other);
  }
  for (int count = 1; count <= MOST_RANKS; ++count)
  {
    rank_job job = { .set = &set };
    core_world world;
    core_run_ranks(count, project_part, &job, &world);
    core_expect_ranks(&world, "projections");
    for (int r = 0; r < count; ++r)
    {
      CORE_CHECK(same_bits(&alone, &job.found[r]), r, count);
      mcor_free_projection(&job.found[r]);
    }
  }
  mcor_free_projection(&alone);
}

/* ---- calls that are refused, or give an empty image ---- */

static void test_bad_input(void** state)
{
  double vectors[27 * 3] = { 0 };
  const double nan = NAN;
  const struct
  {
    mcor_view view;
    int change; /* what is wrong with the input */
    mcor_status status;
  } cases[] = { { { .direction = { 1, nan, 0 }, .resolution = 8 }, 0, MCOR_INVALID_ARGUMENT },
    { { .direction = { INFINITY, 0, 0 }, .resolution = 8 }, 0, MCOR_INVALID_ARGUMENT },
    { { .resolution = 0 }, 0, MCOR_INVALID_ARGUMENT },
    { { .resolution = 32769 }, 0, MCOR_INVALID_ARGUMENT },
    { { .box = { 1, 0, 0, 1, 0, 1 }, .resolution = 8 }, 0, MCOR_INVALID_ARGUMENT },
    { { .box = { 0, 1, 0, 1, 0, nan }, .resolution = 8 }, 0, MCOR_INVALID_ARGUMENT },
    { { .box = { 0, 1, 1, 1, 0, 1 }, .resolution = 8 }, 0, MCOR_INVALID_ARGUMENT },
    { { .resolution = 8, .weight = { .data = vectors, .type = MCOR_FLOAT64, .components = 3 } }, 0,
      MCOR_INVALID_ARGUMENT },
    { { .resolution = 8 }, 1, MCOR_INVALID_ARGUMENT }, /* there is no mass */
    { { .resolution = 8 }, 2, MCOR_INVALID_DATA },     /* the scalar is not a number */
    { { .resolution = 8 }, 3, MCOR_INVALID_DATA },     /* the values are too large to be added */
    { { .resolution = 8 }, 4, MCOR_INVALID_ARGUMENT }, /* the period is much shorter than h */
    { { .direction = { 0, 0, 1 }, .resolution = 8 }, 5,
      MCOR_INVALID_ARGUMENT }, /* the plane is seen from its side */
    { { .box = { 0, 1, 0, 20, 0, 1 }, .resolution = 8 }, 6, MCOR_INVALID_ARGUMENT },
    { { .resolution = 8 }, 7, MCOR_INVALID_DATA } }; /* one particle is far away */
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
  {
    CORE_SET set = core_make_block(3, 0.1, 2, core_slope);
    for (int k = 0; k < 27 && cases[i].change == 5; ++k)
    {
      set.position[3 * k + 1] = 2;
    }
    mcor_input input = input_of(&set);
    mcor_options options = project_options(MCOR_CUBIC_SPLINE);
    if (cases[i].change == 1 || cases[i].change == 2)
    {
      input.volume = input.mass;
      input.mass = (mcor_array){ 0 };
      input.scalar = cases[i].change == 2 ? core_array(set.scalar, 1) : input.scalar;
    }
    set.scalar[5] = cases[i].change == 2 ? NAN : 0;
    set.volume[2] = set.volume[4] = cases[i].change == 3 ? 1e308 : 1;
    options.periodic[3] = cases[i].change == 4 ? 0.1 : cases[i].change == 6 ? 1.2 : 0;
    set.position[0] = cases[i].change == 7 ? 1e9 : set.position[0];
    mcor_projection found;
    const mcor_status status = mcor_project(*state, &input, &options, &cases[i].view, &found);
    CORE_CHECK(status == cases[i].status && *mcor_last_error(*state), i, mcor_status_name(status));
    assert_true(!found.values && found.size[0] == 0);
  }
  /* Solids alone give no image, with a period or without. A box without particles gives zeros. A particle that is not
   * counted adds nothing. */
  CORE_SET set = core_make_block(3, 0.1, 2, core_slope);
  mcor_input input = input_of(&set);
  mcor_options options = project_options(MCOR_CUBIC_SPLINE);
  mcor_view view = { .resolution = 8 };
  mcor_projection found;
  memset(set.solid, 1, 27);
  input.solid = set.solid;
  for (int side = 1; side < 8; side += 2) /* periods along x, y and z, then none */
  {
    memset(options.periodic, 0, sizeof options.periodic);
    options.periodic[side % 7] = side < 7 ? 4 : 0;
    CORE_OK(*state, mcor_project(*state, &input, &options, &view, &found));
    assert_true(!found.values && found.size[0] == 0);
  }
  input.count = 0;
  view.box[1] = view.box[3] = view.box[5] = 4;
  CORE_OK(*state, mcor_project(*state, &input, &options, &view, &found));
  assert_true(found.size[1] == 8 && total_of(&found) == 0);
  mcor_free_projection(&found);
  uint8_t counted[27] = { 1, 0, 1 };
  input.count = 27;
  set.solid[0] = set.solid[1] = 0;
  memset(view.box, 0, sizeof view.box);
  view.counted = counted;
  CORE_OK(*state, mcor_project(*state, &input, &options, &view, &found));
  assert_true(fabs(total_of(&found) - set.volume[0]) < ALLOWED);
  mcor_free_projection(&found);
  view.box[0] = NAN;
  CORE_FAILS(*state, MCOR_INVALID_ARGUMENT, mcor_project(*state, &input, &options, &view, &found),
    "BOX_ILLEGAL|numbers");
}

CORE_MAIN(core_set_up, core_tear_down, test_single, test_brute_force, test_box, test_weights,
  test_same_bits, test_bad_input)
