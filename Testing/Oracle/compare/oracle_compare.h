/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_compare_h
#define oracle_compare_h

/* Compares a surface that mcor_extract made with what the oracle found on the same particles. */

#include "mcor.h"
#include "mesh_check.h"
#include "oracle.h"
#include "oracle_lattice.h"

#ifdef __cplusplus
extern "C"
{
#endif

/* With less fluid weight a point is at the rim of a kernel. */
#define COMPARE_RIM 1e-6

  /* A field on its lattice, classified for one iso value. */
  typedef struct oracle_reference
  {
    particle_set particles;
    oracle_field field;
    oracle_lattice lattice;
    int by_field; /* topology is */
    oracle_limits limits;
    /* Range of the scalar over fluid particles, or its largest magnitude if all are equal; for
     * the weight, its largest value, at least 1. */
    double range;
    double greatest_weight; /* of the nodes, at least 1 */
    double unit;            /* roundoff of the working precision */
  } oracle_reference;

  /* Reads input and options in the way mcor.h describes, evaluates the whole lattice. 0 if it has more
   * than node_limit nodes. */
  int oracle_create_reference(oracle_reference* reference, const mcor_input* input,
    const mcor_options* options, int64_t node_limit);
  void oracle_free_reference(oracle_reference* reference);

  typedef struct oracle_comparison
  {
    int64_t edges;       /* of the oracle */
    int64_t matched;     /* vertices that lie on one of them */
    int64_t missing;     /* edges without a vertex, not excused */
    int64_t extra;       /* vertices on an edge that is not crossed, not excused */
    int64_t excused;     /* missing or extra, but a value or weight is within rounding */
    int64_t rounding;    /* missing or extra, excused by the bound on rounding alone */
    int64_t trimmed;     /* edges whose vertex is rightly cut away */
    int64_t off_lattice; /* unflagged vertices that lie on no lattice edge */
    int64_t doubled;     /* two vertices on one edge that is not pinched */
    int64_t split;       /* pinched edges with two vertices, as it should be */
    int64_t components;  /* of the oracle */
    int64_t components_missing, components_partial; /* unexcused edges missing: all, some */
    double residual; /* max |f - iso| / range over vertices on edges */
    int64_t noisy;   /* vertices whose residual is above 4e-6, but within the bound on rounding */
    double distance; /* max distance to the surface f = iso, in cubes */
    double normal_degrees; /* max angle between normal and -gradient */
    int64_t flat_vertices; /* gradient too small for a meaningful normal; not in normal_degrees */
    int64_t inverted_components; /* of the mesh, judged by the nodes and area */

    int64_t segments_missing; /* faces whose crossings the mesh does not connect as it must */
    int64_t holes; /* boundary edges that neither trimming nor an invalid cell explains */

    int64_t trim_vertices, trim_linear;
    int64_t
      trim_avoidable; /* linear cuts with an exact one (f = iso, w = threshold) within a cube */
    /* Errors of exact trim vertices; here and below, weight is the eigenvalue where that is
     * trimmed by. */
    double trim_weight_error, trim_residual;
    int64_t below_threshold; /* vertices kept although their weight is too low */
    int64_t unsettled;       /* nodes and cells at the surface whose state depends on rounding */
    double weight_error, eigenvalue_error, gradient_error; /* of the optional arrays, relative */
    double rim_gradient_error; /* where the fluid's weight is below COMPARE_RIM */
    char first[240];           /* the first fault of a vertex or edge, in words */
  } oracle_comparison;

  /* trimmed: the surface was trimmed at options->vertex_threshold; otherwise every edge must be
   * there. mesh: the report on the same surface. */
  void oracle_compare(const oracle_reference* reference, const mcor_options* options,
    const mcor_surface* surface, const mesh_report* mesh, int trimmed,
    oracle_comparison* comparison);

#ifdef __cplusplus
}
#endif

#endif
