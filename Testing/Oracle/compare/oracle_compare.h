/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_compare_h
#define oracle_compare_h

/* Compares a surface from mcor_extract with what the oracle found for the same particles. */

#include "mcor.h"
#include "mesh_check.h"
#include "oracle.h"
#include "oracle_lattice.h"

#ifdef __cplusplus
extern "C"
{
#endif

/* If a point has less fluid weight than this, it counts as at the rim of a kernel. */
#define COMPARE_RIM 1e-6

  /* What the oracle finds for one input and one iso value: the field, the lattice's nodes, cells and crossed edges. */
  typedef struct oracle_reference
  {
    particle_set particles;
    oracle_field field;
    oracle_lattice lattice;
    oracle_limits limits;
    /* The range is the largest minus the smallest scalar of fluid particles. If all scalars are equal, the range is
     * their magnitude; if all are 0, 1. For the free surface, it is greatest_weight. */
    double range;
    double greatest_weight; /* of the nodes, at least 1 */
    double unit;            /* roundoff of the working precision */
  } oracle_reference;

  /* Reads input and options as mcor.h describes them, and evaluates the whole lattice. */
  void oracle_create_reference(
    oracle_reference* reference, const mcor_input* input, const mcor_options* options);
  void oracle_free_reference(oracle_reference* reference);

  typedef struct oracle_comparison
  {
    int64_t edges;       /* crossed edges that the oracle found */
    int64_t matched;     /* vertices that lie on a crossed edge */
    int64_t missing;     /* crossed edges without a vertex and without an excuse */
    int64_t extra;       /* vertices on an edge that is not crossed, without an excuse */
    int64_t excused;     /* missing or extra, but with a value or weight within rounding of its limit */
    int64_t rounding;    /* missing or extra, excused only by the bound on rounding */
    int64_t trimmed;     /* crossed edges whose vertex is rightly cut away */
    int64_t off_lattice; /* unflagged vertices that lie on no lattice edge */
    int64_t doubled;     /* edges that are not pinched but have two vertices */
    int64_t split;       /* pinched edges with two vertices, which is right */
    int64_t components;  /* components that the oracle found */
    int64_t components_missing, components_partial; /* components of which all edges, or some, are missing without an
                                                     * excuse */
    double residual; /* max |f - iso| / range over vertices on edges */
    int64_t noisy;   /* vertices whose residual is above 4e-6, but within the bound on rounding */
    double distance; /* max distance to the surface f = iso, in cubes */
    double normal_degrees; /* max angle between normal and -gradient */
    int64_t flat_vertices; /* gradient too small for a meaningful normal; not in normal_degrees */
    int64_t inverted_components; /* components of the mesh that are inside out, judged by nodes and area */

    int64_t segments_missing; /* faces on which the mesh does not join crossings as it must */
    int64_t holes; /* boundary edges that neither trimming nor an invalid cell explains */

    int64_t trim_vertices, trim_linear;
    int64_t
      trim_avoidable; /* linear cuts for which an exact one (f = iso, w = threshold) exists within a cube */
    /* At vertices that trimming placed exactly: the greatest trimming margin, which should be 0, and greatest residual.
     * If the eigenvalue trims, "weight" here and below means the eigenvalue. */
    double trim_weight_error, trim_residual;
    int64_t below_threshold; /* vertices kept although their weight is too low */
    int64_t unsettled;       /* nodes and cells at the surface whose state rounding decides */
    double weight_error, eigenvalue_error, gradient_error; /* relative errors of the optional arrays */
    double rim_gradient_error; /* relative error of gradients where the fluid's weight is below COMPARE_RIM */
    char first[240];           /* the first fault of a vertex or edge, in words */
  } oracle_comparison;

  /* Fills in the comparison. trimmed: the surface was trimmed at options->vertex_threshold; otherwise every crossed
   * edge must have a vertex. mesh: the report on the surface. */
  void oracle_compare(const oracle_reference* reference, const mcor_options* options,
    const mcor_surface* surface, const mesh_report* mesh, int trimmed,
    oracle_comparison* comparison);

#ifdef __cplusplus
}
#endif

#endif
