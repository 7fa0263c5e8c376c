/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Checks the oracle's formulas against values worked out by hand, and its mesh checker with planted faults. The
 * oracle's lattice and sums share no code with the library; the other tests compare them with the library's. */

#include "oracle_check.h"
#include "oracle_compare.h"
#include "particle_sets.h"

#include <math.h>
#include <string.h>

static const char* const kernel_names[ORACLE_KERNEL_COUNT] = { "cubic", "quadratic", "M'4",
  "quintic", "Wendland C2", "quartic", "Wendland C4", "Wendland C6", "sinc^6" };

/* ---- kernels ---- */

/* Integrates each kernel by the midpoint rule on a grid; h is not 1, so that the powers of h are
 * tested. */
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
    ORACLE_CHECK(fabs(sum - 1.0) < 2e-4, kernel_names[kernel], sum);
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
        ORACLE_CHECK(fabs(gradient[axis] - difference) < 2e-5, kernel_names[kernel], x[0], x[1],
          x[2], gradient[axis], difference);
      }
    }
  }
}

/* Compares the kernels with values that can be worked out by hand. */
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
    ORACLE_CHECK(fabs(8.0 * w0 - peak[kernel]) < 1e-14, kernel_names[kernel]);
    ORACLE_CHECK(fabs(8.0 * w1 - at_h[kernel]) < 1e-14, kernel_names[kernel]);
  }
}

/* Checks volumes worked out by hand. For the cubic spline pi W h^3 is 1 at q = 0, and 1/4 at q = 1, where its slope is
 * -3/4; its variance is 3/10 in space, 31/98 in the plane. Solids replace fluid that is missing on a side. */
static void test_one_sided_volumes(void)
{
  static const struct
  {
    int dimensions, count;
    double x[3], h[3];
    int solid[3];
    double volume; /* the first particle's volume over pi */
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
    particle_set particles = particle_set_make(cases[c].count);
    for (int i = 0; i < cases[c].count; ++i)
    {
      particles.position[3 * i] = cases[c].x[i];
      particles.smoothing_length[i] = cases[c].h[i];
      particles.solid[i] = (uint8_t)cases[c].solid[i];
    }
    oracle_compute_volumes(&particles, ORACLE_CUBIC_SPLINE, cases[c].dimensions, NULL, NULL);
    const double volume = particles.volume[0] / 3.14159265358979323846;
    ORACLE_CHECK(fabs(volume - cases[c].volume) < 1e-9, c, volume, cases[c].volume);
    particle_set_free(&particles);
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
      kernel, space, plane);
  }
}

/* ---- the mesh checker finds planted faults ---- */

typedef struct planted
{
  double* points;
  int32_t* triangles;
  int64_t point_count, triangle_count;
} planted;

/* Makes an octahedron, with room for more points and triangles. */
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

/* Plants one fault. Returns the kind that must be found, or MESH_FAULT_COUNT for an open boundary. */
static mesh_fault plant_fault(planted* mesh, int fault)
{
  const double apex[3] = { 0.0, 0.0, 3.0 };
  int32_t* last = &mesh->triangles[3 * mesh->triangle_count];
  switch (fault)
  {
    case 0:
      mesh->triangles[0] = 2; /* a flipped triangle: (2, 0, 4) */
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
  mesh_check(points, 6, triangles, 8, &report);
  for (int fault = 0; fault < MESH_FAULT_COUNT; ++fault)
  {
    ORACLE_CHECK(
      report.faults[fault] == 0, mesh_fault_name((mesh_fault)fault), report.first[fault]);
  }
  ORACLE_CHECK(
    report.euler == 2 && report.edges == 12 && report.boundary_edges == 0 && report.components == 1,
    report.euler, report.edges);
  ORACLE_CHECK(fabs(report.volume - 4.0 / 3.0) < 1e-14, report.volume);
  ORACLE_CHECK(fabs(report.area - 4.0 * sqrt(3.0)) < 1e-14, report.area);
  ORACLE_CHECK(report.side[0].sharing == 2, report.side_count);
  mesh_free_report(&report);
  for (int fault = 0; fault <= 10; ++fault)
  {
    plant_octahedron(&mesh, points, triangles);
    const mesh_fault kind = plant_fault(&mesh, fault);
    mesh_check(points, mesh.point_count, triangles, mesh.triangle_count, &report);
    if (kind == MESH_FAULT_COUNT)
    {
      ORACLE_CHECK(report.boundary_edges == 3, report.boundary_edges);
    }
    else
    {
      ORACLE_CHECK(report.faults[kind] > 0 && report.first[kind][0] != '\0', mesh_fault_name(kind));
    }
    mesh_free_report(&report);
  }
}

int main(void)
{
  test_kernel_values();
  test_kernel_integrals();
  test_kernel_gradients();
  test_one_sided_volumes();
  test_mesh_checker();
  printf("%d failures\n", oracle_failures);
  return oracle_failures > 0;
}
