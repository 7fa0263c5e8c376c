/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_h
#define oracle_h

/* An independent, brute-force reference in double precision.
 *
 * It answers one question: which lattice edges does the isosurface of an SPH field cross? Every
 * node of the bounding box is evaluated, nothing is excluded, no code is shared with the library
 * under test. Written for being obviously right, not for speed: particles are scattered to the
 * lattice one after the other, points are evaluated through a kd-tree.
 *
 * Field (V: volume, A: scalar, W: kernel with h_scale * own smoothing length, fluid particles
 * only): Shepard  sum V A W / sum V W        sum  sum V A W        weight  sum V W The trimming
 * weight is sum V W over fluid particles and, unless ignored, solid ones.
 */

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

  /* Where W is 0, in smoothing lengths; for M'4 along each axis. */
  double oracle_support(oracle_kernel kernel);

  /* W(offset, h); gradient with respect to offset if gradient is not NULL. */
  double oracle_kernel_value(
    oracle_kernel kernel, double h, const double offset[3], double gradient[3]);

  /* The integral of x^2 W over that of W, in h^2, in 2 or 3 dimensions. */
  double oracle_kernel_variance(oracle_kernel kernel, int dimensions);

  /* All arrays are owned by the struct; oracle_free_particles frees them. */
  typedef struct oracle_particles
  {
    int64_t count;
    double* position;         /* [count][3] */
    double* smoothing_length; /* [count], unscaled */
    double* volume;           /* [count] */
    double* scalar;           /* [count]; all 0 for ORACLE_WEIGHT */
    uint8_t* solid;           /* [count], nonzero: wall */
    int ignore_solids;
  } oracle_particles;

  /* Allocates count particles, all zero; 0 if memory ran out. */
  int oracle_create_particles(oracle_particles* particles, int64_t count);
  void oracle_free_particles(oracle_particles* particles);
  double oracle_scalar_range(const oracle_particles* particles); /* over fluid particles */
  double oracle_smallest_h(const oracle_particles* particles);   /* over fluid particles */

  typedef struct oracle_tree oracle_tree;

  typedef struct oracle_field
  {
    const oracle_particles* particles;
    oracle_kernel kernel;
    oracle_kind kind;
    double h_scale;
    double center; /* of scalar values, for oracle_sample.gradient_scale; Shepard only */
    oracle_tree* tree;
  } oracle_field;

  int oracle_create_field(oracle_field* field, const oracle_particles* particles,
    oracle_kernel kernel, oracle_kind kind, double h_scale);
  void oracle_free_field(oracle_field* field);

  /* Fills particles->volume: mass / density; with mass alone m_j / (sum_k m_k W(x_j - x_k, h_j) F_j); with neither
   * 1 / (sum_k W(x_j - x_k, h_j) F_j), W that of three dimensions. F_j = 1 for solids, else
   * 1 + 5/3 variance h_j^2 |g|^2 / n^2, n = sum_k h_k^d W(x_j - x_k, h_j), g = the sum of the fluid's
   * h_k^d grad W + t that of the solids', with t from 0 to 1 such that |g| is least. The sums leave out solids that
   * are ignored. Returns 0 if memory ran out. */
  int oracle_compute_volumes(oracle_particles* particles, oracle_kernel kernel, int dimensions,
    const double* mass, const double* density);

  typedef struct oracle_sample
  {
    double value;       /* of the field; 0 for Shepard where the fluid weight is 0 */
    double gradient[3]; /* of the field */
    double weight;      /* fluid */
    double weight_gradient[3];
    double trim_weight; /* fluid and solid */
    double trim_gradient[3];
    /* Sum of the magnitudes of the terms of the gradient, A taken relative to field->center: how
     * much cancels. The direction of a gradient much smaller than this is rounding noise. */
    double gradient_scale;
  } oracle_sample;

  /* scalar: [count], contoured in place of particles->scalar; NULL: particles->scalar. */
  void oracle_evaluate(
    const oracle_field* field, const double* scalar, const double point[3], oracle_sample* sample);
  /* Value less iso; where a mean's weight is below 0, negative: the sum of the terms against iso has this
   * sign, and passes 0 where the value is iso, not at the mean's poles. */
  double oracle_side(const oracle_field* field, const oracle_sample* sample, double iso);

  /* The eigenvalues, ascending, of the symmetric part of sum V (x_j - x) (outer product) grad W,
   * over the particles of trim_weight. The lowest one is the boundary eigenvalue of Marrone et
   * al. */
  void oracle_boundary_eigenvalues(
    const oracle_field* field, const double point[3], double eigenvalues[3]);

  /* A bound on what evaluation in floating point with unit roundoff `unit` may do to the value at a
   * point: relative errors of a few units in W and in the offset to each particle. */
  double oracle_rounding(const oracle_field* field, const double point[3], double unit);

  /* ---- the lattice ---- */

  enum
  {
    ORACLE_NODE_ABOVE = 1, /* value >= iso */
    ORACLE_NODE_VALID = 2, /* may be a corner of a cell that is used */
    ORACLE_NODE_CLOSE = 4, /* value within rounding of iso */
    ORACLE_NODE_MARGIN = 8 /* weight within rounding of the threshold */
  };

  /* Nodes at integer multiples of `edge`, along each axis, covering every point where a particle has
   * influence. Node (i,j,k), 0 <= i < size[0], lies at (origin + (i,j,k)) * edge; index (k * size[1] + j) *
   * size[0] + i. */
  typedef struct oracle_lattice
  {
    double cube, edge[3]; /* the shortest of the edges */
    int64_t origin[3], size[3];
    int64_t first[3], end[3]; /* cells whose lowest node is not in between do not exist */
    double* value;
    double* weight;
    double* trim_weight; /* the same pointer as weight where no solids count */
    uint8_t* flags;      /* ORACLE_NODE_*; set by oracle_classify */
  } oracle_lattice;

  /* Evaluates all nodes. 0 if memory ran out or there would be more than node_limit nodes. */
  int oracle_create_lattice(
    oracle_lattice* lattice, const oracle_field* field, const double edge[3], int64_t node_limit);
  void oracle_free_lattice(oracle_lattice* lattice);
  int64_t oracle_node_count(const oracle_lattice* lattice);
  int64_t oracle_node_index(const oracle_lattice* lattice, int64_t i, int64_t j, int64_t k);
  void oracle_node_position(const oracle_lattice* lattice, int64_t node, double position[3]);

  typedef struct oracle_limits
  {
    double iso;
    double node_threshold;    /* not applied to ORACLE_WEIGHT */
    double least_weight;      /* fluid weight below which a Shepard mean has no meaning, > 0 */
    double least_at_vertices; /* the same of vertices */
    double close;  /* |value - iso| up to which a node is excused, in the scalar's unit */
    double margin; /* |weight - threshold| up to which a node is excused */
  } oracle_limits;

  void oracle_classify(oracle_lattice* lattice, oracle_kind kind, const oracle_limits* limits);

  /* 1 if the cell whose lowest node is (i,j,k) exists and all its nodes are valid. possible: valid,
   * or all its invalid nodes are within the margin. certain: valid without any within the margin.
   */
  int oracle_cell_valid(const oracle_lattice* lattice, int64_t i, int64_t j, int64_t k);
  int oracle_cell_possible(const oracle_lattice* lattice, int64_t i, int64_t j, int64_t k);
  int oracle_cell_certain(const oracle_lattice* lattice, int64_t i, int64_t j, int64_t k);

  /* An edge is named by 3 * index of its lower node + axis. */
  typedef struct oracle_surface
  {
    int64_t edge_count, cell_count, component_count;
    int64_t* edge;           /* [edge_count], ascending */
    int64_t* edge_component; /* [edge_count], 0 .. component_count - 1 */
    int64_t* cell;           /* [cell_count], index of the lowest node, ascending */
  } oracle_surface;

  /* Edges with ends on different sides and at least one valid cell; components by union of valid
   * crossed cells over faces that have both sides. 0 if memory ran out. */
  int oracle_create_surface(oracle_surface* surface, const oracle_lattice* lattice);
  void oracle_free_surface(oracle_surface* surface);
  int64_t oracle_find_edge(const oracle_surface* surface, int64_t edge); /* its number or -1 */
  /* The four cells of an edge as lowest nodes (i,j,k), some possibly outside the lattice. */
  void oracle_edge_cells(const oracle_lattice* lattice, int64_t edge, int64_t cells[4][3]);
  void oracle_edge_ends(const oracle_lattice* lattice, int64_t edge, int64_t nodes[2]);
#ifdef __cplusplus
}
#endif

#endif
