/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests of the oracle itself, without the library under test: a reference has to be right, and a
 * comparison that cannot fail proves nothing. */

#include "oracle_check.h"
#include "oracle_compare.h"
#include "particle_sets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char* const kernel_names[ORACLE_KERNEL_COUNT] = { "cubic", "quadratic", "M'4",
  "quintic", "Wendland C2", "quartic", "Wendland C4", "Wendland C6", "sinc^6" };

/* ---- kernels ---- */

/* Midpoint rule on a grid; h other than 1 so that its powers are tested. */
static void test_kernel_integrals(void)
{
  const double h = 0.7;
  const int n = 90;
  for (int kernel = 0; kernel < ORACLE_KERNEL_COUNT; ++kernel)
  {
    const double reach = oracle_support((oracle_kernel)kernel) * h;
    const double step = 2.0 * reach / n;
    double sum = 0.0;
    for (int c = 0; c < n * n * n; ++c)
    {
      const double x[3] = { (c % n + 0.5) * step - reach, (c / n % n + 0.5) * step - reach,
        (c / n / n + 0.5) * step - reach };
      sum += oracle_kernel_value((oracle_kernel)kernel, h, x, NULL) * step * step * step;
    }
    ORACLE_CHECK(fabs(sum - 1.0) < 2e-4, "%s integrates to %.9g", kernel_names[kernel], sum);
  }
}

static void test_kernel_gradients(void)
{
  uint64_t state = 1;
  const double h = 0.6;
  for (int kernel = 0; kernel < ORACLE_KERNEL_COUNT; ++kernel)
  {
    for (int trial = 0; trial < 500; ++trial)
    {
      double x[3];
      double gradient[3];
      for (int axis = 0; axis < 3; ++axis)
      {
        x[axis] = 3.4 * h * (random_unit(&state) - 0.5);
      }
      oracle_kernel_value((oracle_kernel)kernel, h, x, gradient);
      for (int axis = 0; axis < 3; ++axis)
      {
        const double step = 1e-6;
        double low[3] = { x[0], x[1], x[2] };
        double high[3] = { x[0], x[1], x[2] };
        low[axis] -= step;
        high[axis] += step;
        const double difference = (oracle_kernel_value((oracle_kernel)kernel, h, high, NULL) -
                                    oracle_kernel_value((oracle_kernel)kernel, h, low, NULL)) /
          (2.0 * step);
        ORACLE_CHECK(fabs(gradient[axis] - difference) < 2e-5, "%s at (%g, %g, %g): %g and %g",
          kernel_names[kernel], x[0], x[1], x[2], gradient[axis], difference);
      }
    }
  }
}

/* Values that can be worked out by hand. */
static void test_kernel_values(void)
{
  const double pi = 3.14159265358979323846;
  const double zero[3] = { 0.0, 0.0, 0.0 };
  const double one[3] = { 2.0, 0.0, 0.0 };
  const double peak[ORACLE_KERNEL_COUNT] = { 1.0 / pi, 15.0 / (16.0 * pi), 1.0, 66.0 / (120.0 * pi),
    21.0 / (16.0 * pi), 230.0 / (320.0 * pi), 495.0 / (256.0 * pi), 1365.0 / (512.0 * pi),
    0.7904495894323029 };
  const double at_h[ORACLE_KERNEL_COUNT] = { 0.25 / pi, 15.0 / (64.0 * pi), 0.0,
    26.0 / (120.0 * pi), 63.0 / (256.0 * pi), 4.75 / (20.0 * pi),
    495.0 / (256.0 * pi) * 83.0 / 768.0, 1365.0 / (512.0 * pi) * 61.0 / 1024.0,
    0.7904495894323029 * pow(2.0 / pi, 6.0) };
  for (int kernel = 0; kernel < ORACLE_KERNEL_COUNT; ++kernel)
  {
    const double w0 = oracle_kernel_value((oracle_kernel)kernel, 2.0, zero, NULL);
    const double w1 = oracle_kernel_value((oracle_kernel)kernel, 2.0, one, NULL);
    ORACLE_CHECK(fabs(8.0 * w0 - peak[kernel]) < 1e-14, "%s at 0", kernel_names[kernel]);
    ORACLE_CHECK(fabs(8.0 * w1 - at_h[kernel]) < 1e-14, "%s at h", kernel_names[kernel]);
  }
}

/* ---- fields ---- */

static int load_set(const char* name, particle_set* set)
{
  const particle_set_entry* entry = particle_set_find(name);
  memset(set, 0, sizeof(*set));
  return entry && entry->make(set);
}

static void load_options(mcor_options* options, mcor_field field, const double* iso)
{
  memset(options, 0, sizeof(*options));
  options->field = field;
  options->h_scale = 1.0;
  options->cube_size_factor = 0.5;
  options->iso_values = iso;
  options->iso_count = 1;
  options->node_threshold = 0.1;
  options->vertex_threshold = 0.5;
  options->precision = MCOR_FLOAT64;
}

/* Point evaluation by the tree against a plain loop over all particles. */
static void check_point(const oracle_reference* reference, const double point[3])
{
  const oracle_particles* p = &reference->particles;
  double fw = 0.0;
  double w = 0.0;
  double all = 0.0;
  for (int64_t j = 0; j < p->count; ++j)
  {
    const double offset[3] = { point[0] - p->position[3 * j], point[1] - p->position[3 * j + 1],
      point[2] - p->position[3 * j + 2] };
    const double value = p->volume[j] *
      oracle_kernel_value(
        reference->field.kernel, reference->field.h_scale * p->smoothing_length[j], offset, NULL);
    all += p->solid[j] && p->ignore_solids ? 0.0 : value;
    w += p->solid[j] ? 0.0 : value;
    fw += p->solid[j] ? 0.0 : value * p->scalar[j];
  }
  const double expected = reference->field.kind == ORACLE_WEIGHT ? w
    : reference->field.kind == ORACLE_SUM                        ? fw
    : w != 0.0                                                   ? fw / w
                                                                 : 0.0;
  oracle_sample sample;
  oracle_evaluate(&reference->field, NULL, point, &sample);
  ORACLE_CHECK(fabs(sample.value - expected) <= 1e-9 * (1.0 + fabs(expected)), "value %g, not %g",
    sample.value, expected);
  ORACLE_CHECK(fabs(sample.weight - w) <= 1e-12, "weight %g, not %g", sample.weight, w);
  ORACLE_CHECK(
    fabs(sample.trim_weight - all) <= 1e-12, "trimming weight %g, not %g", sample.trim_weight, all);
}

static void check_gradient(const oracle_reference* reference, const double point[3])
{
  oracle_sample sample;
  oracle_evaluate(&reference->field, NULL, point, &sample);
  if (sample.weight < 0.05)
  {
    return; /* Shepard changes too fast for a difference quotient there */
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const double step = 1e-7;
    double p[3] = { point[0], point[1], point[2] };
    oracle_sample low;
    oracle_sample high;
    p[axis] = point[axis] - step;
    oracle_evaluate(&reference->field, NULL, p, &low);
    p[axis] = point[axis] + step;
    oracle_evaluate(&reference->field, NULL, p, &high);
    const double difference = (high.value - low.value) / (2.0 * step);
    ORACLE_CHECK(fabs(difference - sample.gradient[axis]) < 1e-4 * (1.0 + sample.gradient_scale),
      "gradient %g, not %g", sample.gradient[axis], difference);
    const double trim = (high.trim_weight - low.trim_weight) / (2.0 * step);
    ORACLE_CHECK(fabs(trim - sample.trim_gradient[axis]) < 1e-3,
      "gradient of the weight %g, not %g", sample.trim_gradient[axis], trim);
  }
}

/* The boundary eigenvalues l by a plain loop for the matrix m: det(m - l) = 0, and their sum and
 * the sum of their squares are the trace of m and of m m. */
static void check_boundary(const oracle_reference* reference, const double point[3])
{
  const oracle_particles* p = &reference->particles;
  double m[3][3] = { { 0.0 } };
  double l[3];
  double trace = 0.0;
  double square = 0.0;
  for (int64_t j = 0; j < p->count; ++j)
  {
    double gradient[3];
    const double* x = &p->position[3 * j];
    const double u[3] = { point[0] - x[0], point[1] - x[1], point[2] - x[2] };
    oracle_kernel_value(
      reference->field.kernel, reference->field.h_scale * p->smoothing_length[j], u, gradient);
    for (int n = 0; n < 9 && !(p->solid[j] && p->ignore_solids); ++n)
    {
      m[n / 3][n % 3] -=
        0.5 * p->volume[j] * (u[n / 3] * gradient[n % 3] + u[n % 3] * gradient[n / 3]);
    }
  }
  oracle_boundary_eigenvalues(&reference->field, point, l);
  for (int n = 0; n < 9; ++n)
  {
    trace += n % 4 == 0 ? m[n / 3][n % 3] : 0.0;
    square += m[n / 3][n % 3] * m[n / 3][n % 3];
  }
  const double scale = 1.0 + square;
  const double a = m[0][0] - l[0];
  const double b = m[1][1] - l[0];
  const double c = m[2][2] - l[0];
  const double determinant = a * (b * c - m[1][2] * m[1][2]) -
    m[0][1] * (m[0][1] * c - m[1][2] * m[0][2]) + m[0][2] * (m[0][1] * m[1][2] - b * m[0][2]);
  ORACLE_CHECK(l[0] <= l[1] && l[1] <= l[2] && fabs(determinant) <= 1e-9 * scale * sqrt(scale),
    "eigenvalues %g %g %g, determinant %g", l[0], l[1], l[2], determinant);
  ORACLE_CHECK(fabs(l[0] + l[1] + l[2] - trace) <= 1e-9 * scale &&
      fabs(l[0] * l[0] + l[1] * l[1] + l[2] * l[2] - square) <= 1e-9 * scale,
    "eigenvalues %g %g %g, trace %g, square %g", l[0], l[1], l[2], trace, square);
}

static void test_fields(void)
{
  const double iso = 0.1;
  const char* const names[2] = { "puddle", "variable_16" };
  for (int n = 0; n < 2; ++n)
  {
    particle_set set;
    ORACLE_CHECK(load_set(names[n], &set), "no memory");
    const mcor_input input = particle_set_input(&set);
    for (int kernel = 0; kernel < ORACLE_KERNEL_COUNT; ++kernel)
    {
      oracle_reference reference;
      char message[256];
      mcor_options options;
      load_options(&options, (mcor_field)(kernel % 3), &iso);
      options.sph_kernel = (mcor_sph_kernel)kernel;
      options.h_scale = kernel == 1 ? 0.75 : 1.0;
      options.cube_size = 0.1;
      ORACLE_CHECK(
        oracle_create_reference(&reference, &input, &options, 1000000, message), "%s", message);
      uint64_t state = 5;
      for (int trial = 0; trial < 100; ++trial)
      {
        const double point[3] = { 2.4 * random_unit(&state) - 1.2, 2.4 * random_unit(&state) - 1.2,
          1.2 * random_unit(&state) - 0.4 };
        check_point(&reference, point);
        check_gradient(&reference, point);
        check_boundary(&reference, point);
      }
      /* The lattice must agree with point evaluation. */
      for (int trial = 0; trial < 300; ++trial)
      {
        const int64_t node =
          (int64_t)(random_bits(&state) % (uint64_t)oracle_node_count(&reference.lattice));
        double point[3];
        oracle_sample sample;
        oracle_node_position(&reference.lattice, node, point);
        oracle_evaluate(&reference.field, NULL, point, &sample);
        ORACLE_CHECK(fabs(sample.trim_weight - reference.lattice.trim_weight[node]) < 1e-12,
          "weight of node %lld", (long long)node);
        ORACLE_CHECK(fabs(sample.weight) < 1e-9 ||
            fabs(sample.value - reference.lattice.value[node]) < 1e-9 * (1.0 + fabs(sample.value)),
          "value of node %lld", (long long)node);
      }
      oracle_free_reference(&reference);
    }
    particle_set_free(&set);
  }
}

static void test_volumes(void)
{
  particle_set set;
  oracle_particles particles;
  ORACLE_CHECK(load_set("variable_4", &set), "no memory");
  ORACLE_CHECK(oracle_create_particles(&particles, set.count), "no memory");
  memcpy(particles.position, set.position, 3 * (size_t)set.count * sizeof(double));
  memcpy(particles.smoothing_length, set.smoothing_length, (size_t)set.count * sizeof(double));
  double* mass = malloc((size_t)set.count * sizeof(double));
  for (int64_t j = 0; mass && j < set.count; ++j)
  {
    mass[j] = 1.0 + (double)(j % 3);
  }
  ORACLE_CHECK(oracle_compute_volumes(&particles, ORACLE_CUBIC_SPLINE, 3, mass, NULL), "no memory");
  for (int64_t j = 0; j < set.count; j += 37)
  {
    double sum = 0.0, number = 0.0, pull[3] = { 0.0, 0.0, 0.0 };
    const double h = set.smoothing_length[j];
    for (int64_t k = 0; k < set.count; ++k)
    {
      double offset[3], gradient[3];
      for (int axis = 0; axis < 3; ++axis)
      {
        offset[axis] = set.position[3 * j + axis] - set.position[3 * k + axis];
      }
      const double w = oracle_kernel_value(ORACLE_CUBIC_SPLINE, h, offset, gradient);
      const double size =
        set.smoothing_length[k] * set.smoothing_length[k] * set.smoothing_length[k];
      sum += mass[k] * w;
      number += size * w;
      for (int axis = 0; axis < 3; ++axis)
      {
        pull[axis] += size * gradient[axis];
      }
    }
    const double d2 =
      0.3 * h * h * (pull[0] * pull[0] + pull[1] * pull[1] + pull[2] * pull[2]) / (number * number);
    ORACLE_CHECK(fabs(particles.volume[j] * sum * (1.0 + 5.0 / 3.0 * d2) / mass[j] - 1.0) < 1e-12,
      "volume of particle %lld", (long long)j);
  }
  free(mass);
  oracle_free_particles(&particles);
  particle_set_free(&set);
}

/* Worked out by hand: pi W of the cubic spline is 1 at q = 0, 1/4 at 1 with the slope -3/4; its variance is 3/10 in
 * space and 31/98 in the plane. Solids fill the side without fluid, as far as needed. */
static void test_one_sided_volumes(void)
{
  static const struct
  {
    int dimensions, count;
    double x[3], h[3];
    int solid[3];
    double volume; /* of the first, over pi */
  } cases[] = { { 3, 1, { 0 }, { 1 }, { 0 }, 1.0 },
    { 3, 2, { 0, 1 }, { 1, 1 }, { 0, 0 }, 0.8 / (1.0 + 0.5 * 0.6 * 0.6) },
    { 2, 2, { 0, 1 }, { 1, 1 }, { 0, 0 }, 0.8 / (1.0 + 155.0 / 294.0 * 0.6 * 0.6) },
    { 3, 2, { 0, 1 }, { 1, 2 }, { 0, 0 }, 0.8 / (1.0 + 0.5 * 4.0) },
    { 2, 2, { 0, 1 }, { 1, 2 }, { 0, 0 }, 0.8 / (1.0 + 155.0 / 294.0 * 2.25) },
    { 3, 3, { 0, 1, -1 }, { 1, 1, 1 }, { 0, 0, 0 }, 2.0 / 3.0 },
    { 3, 3, { 0, 1, -1 }, { 1, 1, 1 }, { 0, 0, 1 }, 2.0 / 3.0 },
    { 3, 3, { 0, 1, -1 }, { 1, 1, 2 }, { 0, 0, 1 }, 2.0 / 3.0 },
    { 3, 3, { 0, 1, 1 }, { 1, 1, 2 }, { 0, 0, 1 }, 2.0 / 3.0 / (1.0 + 0.5 / 169.0 * 9.0) },
    { 3, 2, { 0, 1 }, { 1, 1 }, { 0, 1 }, 0.8 }, { 3, 2, { 0, 1 }, { 1, 1 }, { 1, 0 }, 0.8 } };
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; ++c)
  {
    oracle_particles particles;
    ORACLE_CHECK(oracle_create_particles(&particles, cases[c].count), "no memory");
    for (int i = 0; i < cases[c].count; ++i)
    {
      particles.position[3 * i] = cases[c].x[i];
      particles.smoothing_length[i] = cases[c].h[i];
      particles.solid[i] = (uint8_t)cases[c].solid[i];
    }
    ORACLE_CHECK(
      oracle_compute_volumes(&particles, ORACLE_CUBIC_SPLINE, cases[c].dimensions, NULL, NULL),
      "no memory");
    const double volume = particles.volume[0] / 3.14159265358979323846;
    ORACLE_CHECK(fabs(volume - cases[c].volume) < 1e-9, "case %d: volume %.12g, not %.12g", (int)c,
      volume, cases[c].volume);
    oracle_free_particles(&particles);
  }
  static const double variances[][3] = { { ORACLE_CUBIC_SPLINE, 0.3, 31.0 / 98 },
    { ORACLE_QUADRATIC, 8.0 / 21, 0.4 }, { ORACLE_WENDLAND_C2, 4.0 / 15, 5.0 / 18 },
    { ORACLE_M_PRIME_4, 0.0, 0.0 } };
  for (int k = 0; k < 4; ++k)
  {
    const oracle_kernel kernel = (oracle_kernel)variances[k][0];
    const double space = oracle_kernel_variance(kernel, 3),
                 plane = oracle_kernel_variance(kernel, 2);
    ORACLE_CHECK(fabs(space - variances[k][1]) < 1e-9 && fabs(plane - variances[k][2]) < 1e-9,
      "kernel %d: variance %.12g and %.12g", (int)kernel, space, plane);
  }
}

/* ---- a known surface ---- */

/* One particle: w = iso on a sphere whose radius can be computed from the kernel alone. */
static void test_known_sphere(void)
{
  const double iso = 0.5;
  particle_set set;
  oracle_reference reference;
  mcor_options options;
  char message[256];
  ORACLE_CHECK(load_set("single", &set), "no memory");
  const mcor_input input = particle_set_input(&set);
  load_options(&options, MCOR_WEIGHT_SUM, &iso);
  options.cube_size = 0.008;
  ORACLE_CHECK(
    oracle_create_reference(&reference, &input, &options, 1000000, message), "%s", message);
  double low = 0.0;
  double high = 0.2;
  for (int step = 0; step < 60; ++step)
  {
    const double offset[3] = { 0.5 * (low + high), 0.0, 0.0 };
    const int above =
      set.volume[0] * oracle_kernel_value(ORACLE_CUBIC_SPLINE, 0.1, offset, NULL) >= iso;
    *(above ? &low : &high) = 0.5 * (low + high);
  }
  int64_t crossed = 0;
  const double cube = options.cube_size;
  for (int64_t c = 0; c < 120 * 120 * 120; ++c)
  {
    const int64_t at[3] = { c % 120 - 40, c / 120 % 120 - 40, c / 14400 - 40 };
    double r[4];
    for (int n = 0; n < 4; ++n)
    {
      r[n] = sqrt(pow((double)(at[0] + (n == 1)) * cube - 0.3, 2.0) +
        pow((double)(at[1] + (n == 2)) * cube - 0.2, 2.0) +
        pow((double)(at[2] + (n == 3)) * cube - 0.1, 2.0));
    }
    for (int n = 1; n < 4; ++n)
    {
      crossed += (r[0] <= low) != (r[n] <= low);
    }
  }
  ORACLE_CHECK(crossed > 100 && crossed == reference.surface.edge_count,
    "%lld crossed edges, not %lld", (long long)reference.surface.edge_count, (long long)crossed);
  ORACLE_CHECK(reference.surface.component_count == 1, "components");
  oracle_free_reference(&reference);
  particle_set_free(&set);
}

/* ---- the mesh checker finds planted faults ---- */

typedef struct planted
{
  double* points;
  int32_t* triangles;
  int64_t point_count, triangle_count;
} planted;

/* An octahedron, with room for more. */
static void plant_octahedron(planted* mesh, double points[36], int32_t triangles[36])
{
  static const double corner[6][3] = { { 1, 0, 0 }, { -1, 0, 0 }, { 0, 1, 0 }, { 0, -1, 0 },
    { 0, 0, 1 }, { 0, 0, -1 } };
  static const int32_t face[8][3] = { { 0, 2, 4 }, { 2, 1, 4 }, { 1, 3, 4 }, { 3, 0, 4 },
    { 2, 0, 5 }, { 1, 2, 5 }, { 3, 1, 5 }, { 0, 3, 5 } };
  memset(points, 0, 36 * sizeof(double));
  memset(triangles, 0, 36 * sizeof(int32_t));
  memcpy(points, corner, sizeof(corner));
  memcpy(triangles, face, sizeof(face));
  mesh->points = points;
  mesh->triangles = triangles;
  mesh->point_count = 6;
  mesh->triangle_count = 8;
}

/* Applies one fault; returns the kind that must be found, MESH_FAULT_COUNT for an open boundary. */
static mesh_fault plant_fault(planted* mesh, int fault)
{
  const double apex[3] = { 0.0, 0.0, 3.0 };
  int32_t* last = &mesh->triangles[3 * mesh->triangle_count];
  switch (fault)
  {
    case 0:
      mesh->triangles[0] = 2; /* flipped: (2, 0, 4) */
      mesh->triangles[1] = 0;
      return MESH_ORIENTATION_CLASH;
    case 1:
      --mesh->triangle_count;
      return MESH_FAULT_COUNT;
    case 2: /* a third triangle on the edge (0, 2) */
      memcpy(&mesh->points[18], apex, sizeof(apex));
      last[0] = 0, last[1] = 2, last[2] = 6;
      ++mesh->point_count, ++mesh->triangle_count;
      return MESH_NON_MANIFOLD_EDGE;
    case 3: /* a triangle that only touches vertex 4 */
      memcpy(&mesh->points[18], apex, sizeof(apex));
      memcpy(&mesh->points[21], apex, sizeof(apex));
      mesh->points[21] = 1.0;
      last[0] = 4, last[1] = 6, last[2] = 7;
      mesh->point_count += 2, ++mesh->triangle_count;
      return MESH_NON_MANIFOLD_VERTEX;
    case 4:
      mesh->triangles[0] = 4;
      return MESH_REPEATED_INDEX;
    case 5: /* vertex 4 moved onto the line between 0 and 2 */
      mesh->points[12] = mesh->points[13] = 0.5;
      mesh->points[14] = 0.0;
      return MESH_ZERO_AREA;
    case 6:
      memcpy(last, mesh->triangles, 3 * sizeof(int32_t));
      ++mesh->triangle_count;
      return MESH_DUPLICATE_TRIANGLE;
    case 7:
      ++mesh->point_count;
      return MESH_ISOLATED_POINT;
    case 8:
      memcpy(&mesh->points[12], &mesh->points[0], 3 * sizeof(double));
      return MESH_COINCIDENT_POINT;
    case 9:
      mesh->triangles[5] = 99;
      return MESH_BAD_INDEX;
    default:
      mesh->points[4] = NAN;
      return MESH_BAD_COORDINATE;
  }
}

static void test_mesh_checker(void)
{
  double points[36];
  int32_t triangles[36];
  planted mesh;
  mesh_report report;
  plant_octahedron(&mesh, points, triangles);
  ORACLE_CHECK(mesh_check(points, 6, triangles, 8, &report), "no memory");
  for (int fault = 0; fault < MESH_FAULT_COUNT; ++fault)
  {
    ORACLE_CHECK(report.faults[fault] == 0, "%s in an octahedron: %s",
      mesh_fault_name((mesh_fault)fault), report.first[fault]);
  }
  ORACLE_CHECK(
    report.euler == 2 && report.edges == 12 && report.boundary_edges == 0 && report.components == 1,
    "topology of an octahedron");
  ORACLE_CHECK(fabs(report.volume - 4.0 / 3.0) < 1e-14, "volume %g", report.volume);
  ORACLE_CHECK(fabs(report.area - 4.0 * sqrt(3.0)) < 1e-14, "area %g", report.area);
  ORACLE_CHECK(
    mesh_count_sides(&report, 4, 2) == 2 && mesh_count_sides(&report, 0, 1) == 0, "sides");
  mesh_free_report(&report);
  for (int fault = 0; fault <= 10; ++fault)
  {
    plant_octahedron(&mesh, points, triangles);
    const mesh_fault kind = plant_fault(&mesh, fault);
    ORACLE_CHECK(
      mesh_check(points, mesh.point_count, triangles, mesh.triangle_count, &report), "no memory");
    if (kind == MESH_FAULT_COUNT)
    {
      ORACLE_CHECK(report.boundary_edges == 3, "a missing triangle was not seen");
    }
    else
    {
      ORACLE_CHECK(report.faults[kind] > 0 && report.first[kind][0] != '\0', "%s was not seen",
        mesh_fault_name(kind));
    }
    mesh_free_report(&report);
  }
}

int main(void)
{
  test_kernel_values();
  test_kernel_integrals();
  test_kernel_gradients();
  test_fields();
  test_volumes();
  test_one_sided_volumes();
  test_known_sphere();
  test_mesh_checker();
  printf("%d failures\n", oracle_failures);
  return oracle_failures > 0;
}
