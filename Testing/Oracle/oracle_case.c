/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_case.h"
#include "oracle_period.h"
#include "print_values.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

int oracle_begin_suite(oracle_suite* suite, int argc, char** argv)
{
  memset(suite, 0, sizeof(*suite));
  if (argc == 3 && strcmp(argv[1], "--case") == 0)
  {
    suite->filter = argv[2];
  }
  else if (argc > 1)
  {
    fprintf(stderr, "unknown argument %s\n", argv[1]);
    return 0;
  }
  if (mcor_create_context(NULL, &suite->context) != MCOR_OK)
  {
    fprintf(stderr, "no device: %s\n", mcor_last_error(suite->context));
    mcor_free_context(suite->context);
    return 0;
  }
  return 1;
}

int oracle_end_suite(oracle_suite* suite)
{
  printf("%d cases, %d failed\n", suite->cases, suite->failures);
  const int failed = suite->failures > 0 || suite->cases == 0;
  mcor_free_context(suite->context);
  return failed;
}

int oracle_wants_case(const oracle_suite* suite, const char* name)
{
  return !suite->filter || strstr(name, suite->filter) != NULL;
}

mcor_options oracle_case_options(const double* iso)
{
  mcor_options options;
  mcor_set_default_options(&options);
  options.wall_share = 0;  /* surfaces do not end at solids, unless a case asks for it */
  options.level_limit = 0; /* cubes have one size, unless a case asks for levels */
  options.iso_values = iso;
  options.iso_count = 1;
  options.dimension = 3; /* a few particles may share a coordinate and still be in space */
  options.outputs |=
    MCOR_OUT_NORMALS | MCOR_OUT_GRADIENTS | MCOR_OUT_WEIGHT_SUM | MCOR_OUT_BOUNDARY_FLAG;
  options.outputs |= MCOR_OUT_RESIDUAL | MCOR_OUT_CORRECTION_LENGTH;
  return options;
}

/* ---- one extraction ---- */

typedef struct case_run
{
  const oracle_case* at;
  const oracle_reference* reference;
  const char* mode; /* "complete", "trimmed" or "pairs" */
  mcor_options options;
  mcor_surface surface;
  mesh_report mesh;
  oracle_comparison comparison;
  int good;
} case_run;

#define CASE_EXPECT(run, condition, ...)                                                           \
  do                                                                                               \
  {                                                                                                \
    if (!(condition))                                                                              \
    {                                                                                              \
      printf("  FAILED: %s %s: %s\n", run->at->name, run->mode, #condition);                       \
      PRINT_VALUES(__VA_ARGS__)                                                                    \
      run->good = 0;                                                                               \
    }                                                                                              \
  } while (0)

static void case_print(const case_run* run)
{
  const oracle_comparison* c = &run->comparison;
  printf("%-44s %-8s edges %lld excused %lld+%lld trimmed %lld components %lld triangles %lld "
         "residual %.2g distance %.2g normal %.3g cuts %lld linear %lld\n",
    run->at->name, run->mode, (long long)c->edges, (long long)c->excused, (long long)c->rounding,
    (long long)c->trimmed, (long long)c->components, (long long)run->surface.triangle_count,
    c->residual, c->distance, c->normal_degrees, (long long)c->trim_vertices,
    (long long)c->trim_linear);
}

static void case_check_mesh(case_run* run)
{
  const oracle_comparison* c = &run->comparison;
  /* In double precision, triangles at nodes may be only 1e-9 edges wide. If trimming cuts such slivers near their tips,
   * narrower triangles remain, which are still wider than rounding errors. */
  const int slivers =
    run->options.precision == MCOR_FLOAT64 && c->trim_vertices > 0 && run->mesh.slimmest > 1e-14;
  for (int fault = 0; fault < MESH_FAULT_COUNT; ++fault)
  {
    /* If two valid cells touch only in an edge, each has a vertex of its own there, in the same place. */
    const int64_t allowed = fault == MESH_COINCIDENT_POINT ? c->split
      : fault == MESH_ZERO_AREA && slivers                 ? run->mesh.faults[fault]
                                                           : 0;
    CASE_EXPECT(run, run->mesh.faults[fault] <= allowed, run->mesh.faults[fault],
      mesh_fault_name((mesh_fault)fault), run->mesh.first[fault]);
  }
  CASE_EXPECT(run, c->holes == 0, c->holes, c->first);
}

/* Checks that a periodic surface continues from each side of the period at the opposite side, with equal points. It may
 * end at a side only if its boundary flags say so. */
static void case_check_seam(case_run* run)
{
  if (!oracle_is_periodic(&run->options))
  {
    return;
  }
  const oracle_seam seam =
    oracle_check_seam(&run->options, run->reference->lattice.edge, &run->surface, &run->mesh);
  CASE_EXPECT(run, seam.open == 0, seam.open);
  CASE_EXPECT(run, seam.torn == 0, seam.torn);
  CASE_EXPECT(run, seam.different == 0, seam.different);
  CASE_EXPECT(run, seam.joined > 0, seam.joined);
  printf("  %lld edges join opposite faces\n", (long long)seam.joined);
}

static void case_check_edges(case_run* run, int pairs)
{
  const oracle_comparison* c = &run->comparison;
  CASE_EXPECT(run, run->at->random || c->edges > 0, c->edges);
  CASE_EXPECT(run, c->off_lattice == 0, c->off_lattice, c->first);
  CASE_EXPECT(run, c->doubled == 0, c->doubled);
  CASE_EXPECT(run, c->extra == 0, c->extra, c->first);
  CASE_EXPECT(run, c->segments_missing == 0, c->segments_missing, c->first);
  /* Only rounding excuses a missing or extra vertex, so excuses must be rare: a few in ten thousand edges. */
  CASE_EXPECT(run, run->at->at_iso || pairs || c->excused + c->rounding <= 2 + c->edges / 2000,
    c->excused + c->rounding);
  CASE_EXPECT(run, run->at->rough || c->noisy == 0, c->noisy);
  if (pairs)
  {
    /* MCOR_PAIRS, the paper's way, may miss whole components of the surface, but not parts of one. */
    CASE_EXPECT(run, c->components_partial == 0, c->components_partial, c->first);
  }
  else
  {
    CASE_EXPECT(run, c->missing == 0, c->missing, c->components_missing, c->first);
  }
}

static void case_check_accuracy(case_run* run, int trimmed)
{
  const oracle_comparison* c = &run->comparison;
  const int single = run->options.precision == MCOR_FLOAT32;
  const double residual = single ? 5e-6 : 1e-6;
  const mcor_statistics* told = &run->surface.statistics;
  const double range = told->scalar_max - told->scalar_min;
  CASE_EXPECT(run, c->residual * range <= told->residual_max + 1e-6 * range, c->residual,
    told->residual_max / range);
  CASE_EXPECT(run, c->residual <= residual, c->residual, c->first);
  CASE_EXPECT(run, c->weight_error <= (single ? 1e-5 : 1e-6), c->weight_error);
  CASE_EXPECT(run, c->eigenvalue_error <= (single ? 1e-5 : 1e-6), c->eigenvalue_error);
  CASE_EXPECT(run, c->trim_weight_error <= 1e-4, c->trim_weight_error, c->first);
  /* Kernels with negative lobes leave gaps, so trimming may cut steep parts of the surface at low weight. */
  CASE_EXPECT(run, c->trim_residual <= (run->at->rough ? 4.0 : 1.0) * residual, c->trim_residual);
  /* If the gradient of the eigenvalue were wrong, trimming would place no vertex exactly. */
  CASE_EXPECT(run,
    run->at->rough || run->options.boundary_detection != MCOR_BOUNDARY_EIGENVALUE ||
      c->trim_linear <= 2 + c->trim_vertices / 25,
    c->trim_linear, c->trim_vertices);
  /* Trimming may place a few vertices linearly, though an exact place lies within a cube. With negative lobes there are
   * more such vertices, because the weight has many extrema. */
  CASE_EXPECT(run,
    c->trim_avoidable <=
      4 + c->trim_vertices / (run->options.sph_kernel == MCOR_M_PRIME_4 ? 12 : 50),
    c->trim_avoidable, c->trim_vertices);
  CASE_EXPECT(run, c->below_threshold == 0, c->below_threshold);
  if (!run->at->at_iso)
  {
    CASE_EXPECT(run, c->distance <= 1e-4, c->distance);
    CASE_EXPECT(run, c->normal_degrees <= (single ? 0.5 : 0.1), c->normal_degrees, c->first);
  }
  if (!run->at->rough)
  {
    /* Pieces of the surface that trimming leaves may be too small to judge their orientation by the gradient. */
    CASE_EXPECT(run, trimmed || c->inverted_components == 0, c->inverted_components);
    CASE_EXPECT(run, c->gradient_error <= (single ? 1e-4 : 1e-9), c->gradient_error);
    /* Near the support radius, W has few correct digits in single precision. */
    CASE_EXPECT(run, c->rim_gradient_error <= (single ? 2e-4 : 1e-9), c->rim_gradient_error);
  }
}

/* Extracts, checks and prints. The surface and its report stay in *run. Returns nonzero if all is
 * right. */
static int case_extract(oracle_suite* suite, case_run* run, int trimmed, int pairs)
{
  /* Without trimming, the threshold is 0. It still cuts a Shepard mean where the fluid's weight is nearly 0. A sum with
   * negative lobes of the kernel gets 0.05, because the weight at a vertex may be 0 or less if h is far too small. */
  const int lobes =
    run->at->options.sph_kernel == MCOR_M_PRIME_4 && run->at->options.field == MCOR_SUM;
  const int cut = trimmed || lobes || run->at->options.field == MCOR_SHEPARD;
  run->good = 1;
  run->options = run->at->options;
  run->options.seeds = pairs ? MCOR_PAIRS : MCOR_COMPLETE;
  run->options.vertex_threshold = trimmed ? run->at->options.vertex_threshold : lobes ? 0.05 : 0.0;
  if (!trimmed)
  {
    /* The eigenvalue must not trim here: rounding may put the eigenvalue of a singular matrix below the threshold 0. */
    run->options.boundary_detection = MCOR_BOUNDARY_WEIGHT_SUM;
    /* With this wall share the surface ends at no solid, but solids still count in the free
     * surface's weight. */
    run->options.wall_share =
      run->options.wall_share > 0.0 && run->options.field == MCOR_WEIGHT_SUM ? 1.0 - 1e-9 : 0.0;
  }
  memset(&run->surface, 0, sizeof(run->surface));
  memset(&run->mesh, 0, sizeof(run->mesh));
  memset(&run->comparison, 0, sizeof(run->comparison));
  const mcor_status status =
    mcor_extract(suite->context, &run->at->input, &run->options, &run->surface);
  CASE_EXPECT(run, status == MCOR_OK, mcor_status_name(status), mcor_last_error(suite->context));
  if (status != MCOR_OK)
  {
    return 0;
  }
  mesh_check(run->surface.points, run->surface.point_count, run->surface.triangles,
    run->surface.triangle_count, &run->mesh);
  if (run->mesh.faults[MESH_BAD_INDEX] + run->mesh.faults[MESH_BAD_COORDINATE] == 0)
  {
    oracle_compare(run->reference, &run->options, &run->surface, &run->mesh, cut, &run->comparison);
  }
  case_print(run);
  const double cube = run->surface.statistics.cube_size;
  CASE_EXPECT(run, fabs(cube / run->reference->lattice.cube - 1.0) < 1e-12, cube);
  case_check_mesh(run);
  case_check_seam(run);
  case_check_edges(run, pairs);
  case_check_accuracy(run, trimmed);
  if (!trimmed && !pairs)
  {
    CASE_EXPECT(run, !run->at->has_euler || run->mesh.euler == run->at->euler, run->mesh.euler,
      run->at->euler);
  }
  return run->good;
}

static int case_run_mode(
  oracle_suite* suite, case_run* run, const char* mode, int trimmed, int pairs)
{
  run->mode = mode;
  const int good = case_extract(suite, run, trimmed, pairs);
  mesh_free_report(&run->mesh);
  mcor_free_surface(&run->surface);
  return good;
}

void oracle_run_case(oracle_suite* suite, const oracle_case* at)
{
  oracle_reference reference;
  case_run run = { .at = at, .reference = &reference };
  if (!oracle_wants_case(suite, at->name))
  {
    return;
  }
  oracle_create_reference(&reference, &at->input, &at->options);
  int good = case_run_mode(suite, &run, "complete", 0, 0);
  if (at->options.field != MCOR_WEIGHT_SUM || at->options.wall_share > 0.0)
  {
    good = case_run_mode(suite, &run, "trimmed", 1, 0) && good;
  }
  if (!at->skip_pairs && at->options.level_limit == 0) /* pairs need cubes of one size */
  {
    good = case_run_mode(suite, &run, "pairs", 0, 1) && good;
  }
  oracle_free_reference(&reference);
  ++suite->cases;
  suite->failures += !good;
  fflush(stdout);
}
