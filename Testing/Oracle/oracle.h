/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_h
#define oracle_h

/* An independent, brute-force reference in double precision.
 *
 * It answers two questions: which lattice edges does the isosurface of an SPH field cross, and how are
 * the crossings joined? Every node that a particle reaches is evaluated. Nothing is excluded, and no code is
 * shared with the library under test. The code is meant to be obviously right, not fast: nodes sum
 * over all particles of their brick (oracle_lattice.h), and points are evaluated through a kd-tree.
 *
 * V: volume, A: scalar, W: kernel with h_scale * own smoothing length. The field sums over fluid
 * particles. Shepard: (sum V A W) / (sum V W); sum: sum V A W; weight: sum V W. The trimming weight
 * is sum V W over fluid particles and, unless solids are ignored, over solid particles.
 */

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

  typedef enum oracle_kernel
  {
    ORACLE_CUBIC_SPLINE = 0,
    ORACLE_QUADRATIC,
    ORACLE_M_PRIME_4,
    ORACLE_QUINTIC_SPLINE,
    ORACLE_WENDLAND_C2,
    ORACLE_QUARTIC_SPLINE,
    ORACLE_WENDLAND_C4,
    ORACLE_WENDLAND_C6,
    ORACLE_SINC_6,
    ORACLE_KERNEL_COUNT
  } oracle_kernel;

  typedef enum oracle_kind
  {
    ORACLE_SHEPARD = 0,
    ORACLE_SUM,
    ORACLE_WEIGHT
  } oracle_kind;

  /* Returns the support radius in smoothing lengths; for M'4 it holds along each axis. */
  double oracle_support(oracle_kernel kernel);

  /* Returns W(offset, h). Writes its gradient with respect to the offset to `gradient` unless this is NULL. */
  double oracle_kernel_value(
    oracle_kernel kernel, double h, const double offset[3], double gradient[3]);

  /* Returns the integral of x^2 W divided by the integral of W, in h^2, in 2 or 3 dimensions. */
  double oracle_kernel_variance(oracle_kernel kernel, int dimensions);

  /* Returns zeroed memory; ends the program if there is none. */
  void* oracle_allocate(int64_t count, size_t size);
  /* Returns the array, enlarged if needed to hold count + 1 elements. *capacity: its room, in elements. */
  void* oracle_grow(void* array, int64_t count, int64_t* capacity, size_t size);

  /* The particles of all tests. The struct owns its arrays; particle_set_free frees them. */
  typedef struct particle_set
  {
    int64_t count, capacity;
    double* position;         /* [count][3] */
    double* smoothing_length; /* [count], unscaled */
    double* volume;           /* [count] */
    double* scalar;           /* [count]: what the oracle contours; not used for ORACLE_WEIGHT */
    uint8_t* solid;           /* [count], nonzero: wall */
    int has_solids;           /* 0: the core is given no array of solids */
    int ignore_solids;        /* whether the oracle ignores solids */
  } particle_set;

  /* Returns arrays of exactly `count` elements, all 0. */
  particle_set particle_set_make(int64_t count);
  void particle_set_free(particle_set* set);
  /* Adds a particle; the arrays grow where they lack room. */
  void particle_set_add(
    particle_set* set, const double x[3], double h, double volume, double scalar);
  /* Adds particle i of `from`, which may be the set itself. */
  void particle_set_append(particle_set* set, const particle_set* from, int64_t i);

  double oracle_scalar_range(const particle_set* particles); /* over fluid particles */
  double oracle_smallest_h(const particle_set* particles);   /* over fluid particles */

  typedef struct oracle_tree oracle_tree;

  typedef struct oracle_field
  {
    const particle_set* particles;
    oracle_kernel kernel;
    oracle_kind kind;
    double h_scale;
    double center; /* a value of the scalar relative to which oracle_sample.gradient_scale is taken; Shepard only */
    oracle_tree* tree;
  } oracle_field;

  /* scale: the factor of all smoothing lengths. The set is borrowed. */
  oracle_field oracle_make_field(
    const particle_set* particles, oracle_kernel kernel, oracle_kind kind, double scale);
  void oracle_free_field(oracle_field* field);

  /* Fills particles->volume. With mass and density: mass / density. With mass alone: m_j / (F_j sum_k m_k W(x_j - x_k,
   * h_j)). With neither: 1 / (F_j sum_k W(x_j - x_k, h_j)). W is three-dimensional. F_j corrects these sums if
   * neighbours are on one side only. F_j = 1 for solids, else 1 + 5/3 variance h_j^2 |g|^2 / n^2. variance: the
   * kernel's; n = sum_k h_k^d W(x_j - x_k, h_j); g: the sum of h_k^d grad W over the fluid, plus t times this sum over
   * the solids; t, from 0 to 1, makes |g| least. Ignored solids are left out of all sums. */
  void oracle_compute_volumes(particle_set* particles, oracle_kernel kernel, int dimensions,
    const double* mass, const double* density);

  typedef struct oracle_sample
  {
    double value;       /* the field; 0 for Shepard where the fluid weight is 0 */
    double gradient[3]; /* the field's gradient */
    double weight;      /* fluid */
    double weight_gradient[3];
    double trim_weight; /* the weight of fluid and solids */
    double trim_gradient[3];
    /* The sum of the magnitudes of the gradient's terms, with A relative to field->center. It shows how much the terms
     * cancel: if the gradient is much smaller, its direction is rounding noise. */
    double gradient_scale;
  } oracle_sample;

  /* Evaluates the field at a point. scalar: [count], used in place of particles->scalar; may be NULL. */
  void oracle_evaluate(
    const oracle_field* field, const double* scalar, const double point[3], oracle_sample* sample);
  /* Returns value - iso or, if a mean's weight is below 0, iso - value. So the result has the sign of sum V (A - iso)
   * W, which changes where the value is iso, not at the mean's poles. */
  double oracle_side(const oracle_field* field, const oracle_sample* sample, double iso);

  /* Sums V (x_j - x) (outer product) grad W over the particles that count in trim_weight. Writes the eigenvalues of
   * this matrix's symmetric part in ascending order. The lowest one is the boundary eigenvalue of Marrone et al. */
  void oracle_boundary_eigenvalues(
    const oracle_field* field, const double point[3], double eigenvalues[3]);

  /* Returns a bound on the error of the value at a point if it is computed in floating point with unit roundoff `unit`:
   * W and the offset to each particle have relative errors of a few units. */
  double oracle_rounding(const oracle_field* field, const double point[3], double unit);
#ifdef __cplusplus
}
#endif

#endif
