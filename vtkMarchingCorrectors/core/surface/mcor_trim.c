/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Trimming [III-D.3]: removes triangles on the lower side of a limit, and cuts triangles across it.
 *
 *   limit, at a vertex                   option              default          applies to
 *   least trimming weight                vertex_threshold    0.5              not MCOR_WEIGHT_SUM
 *   or least boundary eigenvalue         boundary_detection  off              not MCOR_WEIGHT_SUM
 *   least weight of the fluid itself     -                   0.001, M'4 0.05  MCOR_SHEPARD
 *   greatest share of solids in weight   wall_share          measured         unless solids ignored
 * With MCOR_WEIGHT_SUM, the default of wall_share is 0, which sets no limit.
 *
 * Kernels: mcor_trim.cl decides and cuts; mcor_trim_solve.cl moves cuts to where both a limit and
 * the iso value are met; mcor_boundary.cl computes the eigenvalue.
 *
 * Cells or triangles are also left out by the node threshold (mcor_node.cl, mcor_seed.cl: cells
 * with a node of lower weight, or, with MCOR_SHEPARD, of fluid weight below 0.001), by the box and
 * its ring (mcor_triangle_cell.c), and by compaction (mcor_compact.c). */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_table.h"

#include <math.h>
#include <stdlib.h>

#define MCOR_TRIM_STEPS 25

mcor_status mcor_evaluate_boundary(mcor_context* context, int vertices, mcor_buffer* eigenvalue)
{
  return MCOR_LAUNCH_AT_VERTICES(context, vertices, "mcor_boundary_points",
    MCOR_BUFFER(&context->mesh.offset), MCOR_INT(context->space.flat), MCOR_BUFFER(eigenvalue));
}

/* Whether the vertex threshold is for the boundary eigenvalue. The free surface has no vertex
 * threshold. */
bool mcor_trims_by_eigenvalue(const mcor_context* context)
{
  return context->run.options->boundary_detection == MCOR_BOUNDARY_EIGENVALUE &&
    context->run.options->field != MCOR_WEIGHT_SUM;
}

/* Returns the quantity that the vertex threshold limits, at the vertices on lattice edges. */
static const mcor_buffer* mcor_threshold_quantity(const mcor_context* context)
{
  return mcor_trims_by_eigenvalue(context) ? &context->trim.eigenvalue
                                           : &context->mesh.vertex_weight;
}

double mcor_least_fluid(const mcor_context* context)
{
  return context->run.options->field == MCOR_SHEPARD
    ? MCOR_LEAST_VERTEX_WEIGHT(context->run.options->sph_kernel == MCOR_M_PRIME_4)
    : 0;
}

/* Whether a vertex above the threshold may lack the fluid that a mean needs. */
static bool mcor_may_lack_fluid(const mcor_context* context)
{
  return mcor_least_fluid(context) > 0 &&
    (context->grid.has_solids || mcor_trims_by_eigenvalue(context));
}

/* Returns the threshold of the weight or of the boundary eigenvalue. Without solids, a threshold of
 * the weight is at least mcor_least_fluid. */
double mcor_vertex_threshold(const mcor_context* context)
{
  const double threshold = context->run.options->vertex_threshold;
  return mcor_may_lack_fluid(context) ? threshold : fmax(threshold, mcor_least_fluid(context));
}

const mcor_buffer* mcor_trim_quantity(const mcor_context* context)
{
  return mcor_ends_at_solids(context) || mcor_may_lack_fluid(context)
    ? &context->trim.margin
    : mcor_threshold_quantity(context);
}

double mcor_trim_threshold(const mcor_context* context)
{
  return mcor_ends_at_solids(context) ? 0 : mcor_vertex_threshold(context);
}

/* The free surface has no vertex threshold; it is trimmed only if it ends at solids. */
bool mcor_is_trimmed(const mcor_context* context)
{
  return context->run.options->field != MCOR_WEIGHT_SUM || mcor_ends_at_solids(context);
}

/* Computes, at the vertices on lattice edges, the quantity that decides about trimming
 * (mcor_trim_quantity). If this quantity is the weight, it is known already. */
static mcor_status mcor_evaluate_margins(mcor_context* context)
{
  const mcor_mesh* mesh = &context->mesh;
  mcor_trim_data* trim = &context->trim;
  const int count = mesh->march_count;
  if (mcor_trims_by_eigenvalue(context))
  {
    MCOR_TRY(mcor_reserve(context, &trim->eigenvalue, (size_t)count * context->cl.real_size));
    MCOR_TRY(mcor_evaluate_boundary(context, MCOR_ON_EDGES, &trim->eigenvalue));
  }
  if (mcor_trim_quantity(context) != &trim->margin)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_reserve(context, &trim->margin, (size_t)count * context->cl.real_size));
  return MCOR_LAUNCH(context, "mcor_trim_margin", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_BUFFER(mcor_threshold_quantity(context)), MCOR_REAL(mcor_vertex_threshold(context)),
    MCOR_BUFFER(&mesh->vertex_weight), MCOR_BUFFER(&mesh->gradient),
    MCOR_REAL(mcor_fluid_share(context)), MCOR_BUFFER(&trim->margin));
}

mcor_status mcor_extend_vertices(mcor_context* context, int old, int count)
{
  mcor_mesh* mesh = &context->mesh;
  const size_t o = (size_t)old, n = (size_t)count, real = context->cl.real_size;
  const size_t reals = o * real, new_reals = n * real;
  MCOR_TRY(mcor_extend(context, &mesh->node, o * 16, n * 16));
  MCOR_TRY(mcor_extend(context, &mesh->offset, 4 * reals, 4 * new_reals));
  MCOR_TRY(mcor_extend(context, &mesh->linear, reals, new_reals));
  MCOR_TRY(mcor_extend(context, &mesh->field_value, reals, new_reals));
  MCOR_TRY(mcor_extend(context, &mesh->gradient, 4 * reals, 4 * new_reals));
  MCOR_TRY(mcor_extend(context, &mesh->vertex_weight, reals, new_reals));
  const size_t attributes = (size_t)context->attributes.count;
  MCOR_TRY(mcor_extend(context, &mesh->means, attributes * reals, attributes * new_reals));
  return mcor_extend(context, &mesh->flag, o, n);
}

int mcor_find_cut(const cl_ulong* cuts, int count, int32_t p, int32_t q)
{
  const cl_ulong key = p < q ? (cl_ulong)p << 32 | (cl_ulong)q : (cl_ulong)q << 32 | (cl_ulong)p;
  const cl_ulong* cut =
    count > 0 ? bsearch(&key, cuts, (size_t)count, sizeof key, mcor_compare_keys) : NULL;
  return cut ? (int)(cut - cuts) : -1;
}

/* Places the cut vertices: first linearly, then where both the limit and the iso value are met. */
static mcor_status mcor_place_cuts(mcor_context* context, int cut_count)
{
  mcor_mesh* mesh = &context->mesh;
  const mcor_options* options = context->run.options;
  const int vertices = mesh->march_count;
  const double range = context->measure.scalar_max - context->measure.scalar_min;
  MCOR_FAIL_IF(cut_count > MCOR_COUNT_LIMIT - vertices, context, MCOR_OUT_OF_CAPACITY,
    MCOR_SAY(VERTICES_TOO_MANY), (long long)vertices + cut_count, MCOR_COUNT_LIMIT);
  MCOR_TRY(mcor_extend_vertices(context, vertices, vertices + cut_count));
  mesh->vertex_count = vertices + cut_count;
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_trim_linear", MCOR_LIGHT, cut_count, MCOR_INT(cut_count),
    MCOR_BUFFER(&mesh->cut_edges), MCOR_INT(vertices), MCOR_REAL(mcor_trim_threshold(context)),
    MCOR_BUFFER(&mesh->node), MCOR_BUFFER(&mesh->offset), MCOR_BUFFER(mcor_trim_quantity(context)),
    MCOR_BUFFER(&mesh->vertex_weight), MCOR_BUFFER(&mesh->gradient)));
  /* Finds where the cut vertices of each level begin. A cut vertex has the level of the first
   * vertex of its edge; cuts are sorted by this vertex. */
  for (int l = 0; l + 1 < context->lattice.levels; ++l)
  {
    int low = 0, high = cut_count;
    while (low < high)
    {
      const int middle = low + (high - low) / 2;
      cl_ulong key;
      MCOR_TRY(mcor_read(context, &mesh->cut_edges, (size_t)middle * sizeof key, &key, sizeof key));
      const bool before = (int64_t)(key >> 32) < mesh->level_first[0][l + 1];
      low = before ? middle + 1 : low;
      high = before ? high : middle;
    }
    mesh->level_first[1][l + 1] = mesh->march_count + low;
  }
  return MCOR_LAUNCH_AT_VERTICES(context, MCOR_ON_BOUNDARY, "mcor_trim_solve",
    MCOR_REAL(context->run.iso.relative), MCOR_REAL(options->tolerance * range),
    MCOR_REAL(mcor_vertex_threshold(context)), MCOR_REAL(mcor_fluid_share(context)),
    MCOR_INT(mcor_trims_by_eigenvalue(context)), MCOR_INT(options->preview ? 0 : MCOR_TRIM_STEPS),
    MCOR_INT(context->space.flat), MCOR_BUFFER(&mesh->offset), MCOR_BUFFER(&mesh->field_value),
    MCOR_BUFFER(&mesh->gradient), MCOR_BUFFER(&mesh->vertex_weight), MCOR_BUFFER(&mesh->flag),
    MCOR_ATTRIBUTE_ARGS(context, &mesh->means));
}

mcor_status mcor_trim(mcor_context* context)
{
  mcor_mesh* mesh = &context->mesh;
  mcor_trim_data* trim = &context->trim;
  int remaining, cuts, cut_count;
  if (mesh->triangle_count == 0 || !mcor_is_trimmed(context))
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_evaluate_margins(context));
  const mcor_buffer* quantity = mcor_trim_quantity(context);
  const double threshold = mcor_trim_threshold(context);
  const int batches = mcor_batches(context, mesh->triangle_count);
  MCOR_TRY(mcor_reserve(context, &trim->remaining, ((size_t)batches + 1) * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &trim->cuts, ((size_t)batches + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_trim_count", MCOR_MEDIUM, batches,
    MCOR_INT(mesh->triangle_count), MCOR_BUFFER(&mesh->triangles), MCOR_BUFFER(quantity),
    MCOR_REAL(threshold), MCOR_BUFFER(&trim->remaining), MCOR_BUFFER(&trim->cuts)));
  MCOR_TRY(mcor_scan(context, &trim->remaining, batches, &remaining));
  MCOR_TRY(mcor_scan(context, &trim->cuts, batches, &cuts));
  MCOR_TRY(mcor_reserve(context, &trim->keys, (size_t)cuts * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_trim_edges", MCOR_MEDIUM, batches,
    MCOR_INT(mesh->triangle_count), MCOR_BUFFER(&mesh->triangles), MCOR_BUFFER(quantity),
    MCOR_REAL(threshold), MCOR_BUFFER(&trim->cuts), MCOR_BUFFER(&trim->keys)));
  MCOR_TRY(mcor_reserve(context, &trim->index, sizeof(cl_int)));
  MCOR_TRY(mcor_unique(context, &trim->keys, cuts, (uint64_t)mesh->march_count << 32,
    &mesh->cut_edges, &trim->index, &cut_count));
  const bool follows = mcor_follows_cells(context);
  MCOR_TRY(mcor_reserve(context, &trim->triangles, (size_t)remaining * 3 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &trim->cells, follows ? (size_t)remaining * sizeof(cl_ulong) : 0));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_trim_fill", MCOR_MEDIUM, batches,
    MCOR_INT(mesh->triangle_count), MCOR_BUFFER(&mesh->triangles), MCOR_BUFFER(quantity),
    MCOR_REAL(threshold), MCOR_INT(mesh->march_count), MCOR_BUFFER(&trim->remaining),
    MCOR_BUFFER(&trim->cuts), MCOR_BUFFER(&trim->index), MCOR_INT(follows),
    MCOR_BUFFER(&context->box.cells), MCOR_BUFFER(&trim->cells), MCOR_BUFFER(&trim->triangles)));
  mcor_take_buffer(context, &trim->triangles, &mesh->triangles);
  mcor_take_buffer(context, &trim->cells, &context->box.cells);
  mesh->triangle_count = remaining;
  return cut_count > 0 ? mcor_place_cuts(context, cut_count) : MCOR_OK;
}
