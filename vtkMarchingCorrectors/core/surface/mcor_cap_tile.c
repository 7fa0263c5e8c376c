/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* One side of a period or a box, and its tiles: squares of nodes that some particle reaches. Where none does there is
 * nothing to close, so that a side takes memory and time as far as there is something at it. */

#include "mcor_box.h"
#include "mcor_cap.h"

#include <math.h>
#include <stdlib.h>

/* Of which a side's directory has places, at most. */
#define MCOR_CAP_PLACE_LIMIT (1 << 24)

/* Tiles of a side at most: 4 to 64 million nodes. Where few particles reach more, a smoothing length or the cube
 * size is a mistake. */
static int mcor_tile_limit(const mcor_context* context)
{
  const int particles = context->grid.count / 2;
  return particles < 1 << 14 ? 1 << 14 : particles < 1 << 18 ? particles : 1 << 18;
}

int mcor_cap_plane(const mcor_context* context, int axis, int upper)
{
  const mcor_lattice* lattice = &context->lattice;
  const mcor_box* box = &context->box;
  const mcor_options* options = context->run.options;
  const bool periodic = lattice->period[axis] > 0;
  const int64_t begin = periodic ? lattice->period_first[axis] : lattice->first[axis];
  const int64_t end = periodic ? begin + lattice->period[axis] : lattice->last[axis];
  const int *lower_side = options->ranks ? box->whole_first : box->first,
            *upper_side = options->ranks ? box->whole_last : box->last;
  const int side = upper ? upper_side[axis] : lower_side[axis];
  const int last = (int)(upper ? end : begin);
  if (options->capping == MCOR_CAP_BOX && side != last)
  {
    return side;
  }
  return options->capping && periodic ? last : -1;
}

bool mcor_makes_caps(const mcor_context* context)
{
  bool makes = false;
  for (int i = 0; i < 6; ++i)
  {
    makes = makes || mcor_cap_plane(context, i / 2, i % 2) >= 0;
  }
  return makes || mcor_caps_walls(context);
}

void mcor_free_cap_face(mcor_cap_face* face)
{
  free(face->tile);
  free(face->place);
  free(face->state);
  free(face->within);
  free(face->margin);
}

static void mcor_set_cap_extent(
  const mcor_context* context, int axis, int upper, mcor_cap_face* face)
{
  const mcor_lattice* lattice = &context->lattice;
  const mcor_box* box = &context->box;
  *face = (mcor_cap_face){ .axis = axis,
    .upper = upper,
    .plane = mcor_cap_plane(context, axis, upper),
    .across = { (axis + 1) % 3, (axis + 2) % 3 } };
  face->inner = face->plane + (upper ? -1 : 1);
  face->cell = face->plane - upper;
  for (int i = 0; i < 2; ++i)
  {
    const int a = face->across[i], low = box->first[a] - MCOR_BOX_RING,
              high = box->last[a] + MCOR_BOX_RING;
    const int lower = mcor_cap_plane(context, a, 0), higher = mcor_cap_plane(context, a, 1);
    const int first = lower >= 0 ? lower : (int)lattice->first[a];
    const int last = higher >= 0 ? higher : (int)lattice->last[a];
    face->first[i] = low > first ? low : first;
    face->count[i] = (high < last ? high : last) - face->first[i] + 1;
    face->owned[i] = box->first[a] - face->first[i];
    face->end[i] = box->last[a] - face->first[i];
    if (a == 2 && mcor_is_plane(context)) /* one row of squares stands for the side's edges */
    {
      face->first[i] = face->owned[i] = 0;
      face->count[i] = 2;
      face->end[i] = 1;
    }
    face->tiles[i] = (face->count[i] - 1) / MCOR_CAP_TILE + 1;
  }
}

/* Notes the tiles with nodes from low to high, so far as there are any. */
static mcor_status mcor_note_tiles(
  mcor_context* context, mcor_cap_face* face, const double low[2], const double high[2])
{
  int from[2], to[2];
  for (int i = 0; i < 2; ++i)
  {
    from[i] = (int)(fmin(fmax(low[i], 0), face->count[i]) / MCOR_CAP_TILE);
    to[i] = (int)(fmin(fmax(high[i], -1), face->count[i] - 1) / MCOR_CAP_TILE);
    to[i] = high[i] < 0 ? -1 : to[i];
  }
  for (int64_t v = from[1]; v <= to[1]; ++v)
  {
    for (int64_t u = from[0]; u <= to[0]; ++u)
    {
      int32_t* tile = &face->tile[v * face->tiles[0] + u];
      face->tile_count += *tile == 0;
      *tile = 1;
    }
  }
  const int limit = mcor_tile_limit(context), nodes = limit * MCOR_CAP_TILE * MCOR_CAP_TILE;
  const bool is_much = face->tile_count > limit;
  MCOR_RETURN_IF(is_much && context->run.options->filled, context, MCOR_OUT_OF_CAPACITY,
    "More than %d nodes are within reach of particles, with cube size %g: too many to be filled. "
    "Use a larger cube size, or do not fill.",
    nodes, context->lattice.cube);
  MCOR_RETURN_IF(is_much, context, MCOR_OUT_OF_CAPACITY,
    "More than %d nodes of a side along %c are within reach of particles, with cube size "
    "%g: too many for a cap. Use a larger cube size, or no caps.",
    nodes, mcor_axis_letter(context, face->axis), context->lattice.cube);
  return MCOR_OK;
}

/* Notes the tiles that a particle reaches, whose support is at most a cube around it, where it is in nodes from
 * the lattice's origin. A square is looked at from its lowest node: that is one less. */
static mcor_status mcor_note_particle(
  mcor_context* context, mcor_cap_face* face, const double x[3], double reach)
{
  const mcor_lattice* lattice = &context->lattice;
  const double away = fabs(x[face->axis] - face->plane) * mcor_edge_of(lattice, face->axis);
  if (away > reach)
  {
    return MCOR_OK;
  }
  double low[2], high[2];
  for (int i = 0; i < 2; ++i)
  {
    const double at = x[face->across[i]] - face->first[i];
    const double nodes = reach / mcor_edge_of(lattice, face->across[i]);
    low[i] = at - nodes - 2;
    high[i] = at + nodes + 2;
  }
  return mcor_note_tiles(context, face, low, high);
}

/* Fixed-point numbers are as long as reals. */
static int mcor_list_particles(
  const mcor_context* context, mcor_cap_particles* particles, mcor_mapping mappings[5])
{
  const mcor_grid* g = &context->grid;
  const mcor_buffer* buffers[5] = { &g->px, &g->py, &g->pz, &g->inv_h, &g->fluid_weight };
  for (int i = 0; i < 5; ++i)
  {
    mappings[i] =
      (mcor_mapping){ buffers[i], (size_t)g->count * context->cl.real_size, &particles->views[i] };
  }
  return context->grid.has_solids ? 5 : 4;
}

mcor_status mcor_map_cap_particles(mcor_context* context, mcor_cap_particles* particles)
{
  mcor_mapping mappings[5];
  const int count = mcor_list_particles(context, particles, mappings);
  return mcor_map_all(context, mappings, count);
}

mcor_status mcor_unmap_cap_particles(
  mcor_context* context, mcor_cap_particles* particles, mcor_status status)
{
  mcor_mapping mappings[5];
  const int count = mcor_list_particles(context, particles, mappings);
  return mcor_unmap_all(context, mappings, count, status);
}

double mcor_place_cap_particle(
  const mcor_context* context, const mcor_cap_particles* particles, int64_t i, double x[3])
{
  for (int a = 0; a < 3; ++a)
  {
    const void* view = particles->views[a];
    x[a] = (context->cl.real_size == sizeof(cl_double) ? (double)((const cl_long*)view)[i]
                                                       : (double)((const cl_int*)view)[i]) /
      (double)context->lattice.step[a];
  }
  return mcor_support_factor(context->run.options->sph_kernel) /
    mcor_get_real(context, particles->views[3], i) * 1.001;
}

static mcor_status mcor_note_particles(
  mcor_context* context, const mcor_cap_particles* particles, mcor_cap_face* face)
{
  for (int64_t i = 0; i < context->grid.count; ++i)
  {
    double x[3];
    const double reach = mcor_place_cap_particle(context, particles, i, x);
    MCOR_TRY(mcor_note_particle(context, face, x, reach));
  }
  return MCOR_OK;
}

/* Finds the tiles: those that particles reach, or all where empty space is above the iso value. */
mcor_status mcor_note_cap_tiles(mcor_context* context, double iso_value, mcor_cap_face* face)
{
  const bool empty_is_above = context->run.options->field != MCOR_SHEPARD && iso_value <= 0;
  const double low[2] = { 0, 0 }, high[2] = { face->count[0], face->count[1] };
  const size_t places = (size_t)face->tiles[0] * (size_t)face->tiles[1];
  const bool is_much = places > MCOR_CAP_PLACE_LIMIT;
  MCOR_RETURN_IF(is_much && context->run.options->filled, context, MCOR_OUT_OF_CAPACITY,
    "The plane has %lld x %lld nodes, too many to be filled. Use a larger cube size, or do not "
    "fill.",
    (long long)face->count[0], (long long)face->count[1]);
  MCOR_RETURN_IF(is_much, context, MCOR_OUT_OF_CAPACITY,
    "A side has %lld x %lld nodes, too many for a cap. Use a larger cube size, or no "
    "caps.",
    (long long)face->count[0], (long long)face->count[1]);
  face->tile = calloc(places, sizeof *face->tile);
  MCOR_TRY(mcor_allocated(context, face->tile));
  if (empty_is_above)
  {
    return mcor_note_tiles(context, face, low, high);
  }
  mcor_cap_particles particles = { { NULL } };
  mcor_status status = mcor_map_cap_particles(context, &particles);
  status = status == MCOR_OK ? mcor_note_particles(context, &particles, face) : status;
  return mcor_unmap_cap_particles(context, &particles, status);
}

mcor_status mcor_make_cap_nodes(mcor_context* context, mcor_cap_face* face)
{
  /* The first one is for the nodes in none. */
  const size_t nodes = ((size_t)face->tile_count + 1) * MCOR_CAP_TILE * MCOR_CAP_TILE;
  face->place = malloc(((size_t)face->tile_count + 1) * sizeof *face->place);
  face->state = calloc(nodes, 1);
  face->within = calloc(nodes, 1);
  face->margin = calloc(nodes, sizeof(double));
  MCOR_TRY(mcor_allocated(context, face->place && face->state && face->within && face->margin));
  int count = 0;
  for (int32_t p = 0; p < face->tiles[0] * face->tiles[1]; ++p)
  {
    if (face->tile[p] != 0)
    {
      face->tile[p] = ++count;
      face->place[count] = p;
    }
  }
  return MCOR_OK;
}

mcor_status mcor_make_cap_face(
  mcor_context* context, int axis, int upper, double iso_value, mcor_cap_face* face)
{
  mcor_set_cap_extent(context, axis, upper, face);
  MCOR_TRY(mcor_note_cap_tiles(context, iso_value, face));
  return mcor_make_cap_nodes(context, face);
}

mcor_status mcor_visit_cap_squares(mcor_context* context, const mcor_cap_face* face,
  mcor_status (*visit)(void* data, const mcor_cap_face* face, int u, int v), void* data)
{
  for (int v = 0; v + 1 < face->count[1]; ++v)
  {
    const int32_t* tile = face->tile + (int64_t)(v / MCOR_CAP_TILE) * face->tiles[0];
    MCOR_TRY(mcor_report_launch(context));
    for (int u = 0; u + 1 < face->count[0]; ++u)
    {
      if (tile[u / MCOR_CAP_TILE] == 0)
      {
        u = u / MCOR_CAP_TILE * MCOR_CAP_TILE + MCOR_CAP_TILE - 1;
        continue;
      }
      MCOR_TRY(visit(data, face, u, v));
    }
  }
  return MCOR_OK;
}

mcor_status mcor_check_caps(mcor_context* context)
{
  const mcor_options* options = context->run.options;
  const mcor_box* box = &context->box;
  double least = INFINITY;
  for (int i = 0; i < options->iso_count; ++i)
  {
    least = fmin(least, options->iso_values[i]);
  }
  mcor_status status = MCOR_OK;
  for (int a = 0; mcor_makes_caps(context) && a < 3 && status == MCOR_OK; ++a)
  {
    const int first = mcor_cap_plane(context, a, 0), last = mcor_cap_plane(context, a, 1);
    const bool has_lower = first >= 0 && box->first[a] == first,
               has_upper = last >= 0 && box->last[a] == last;
    if (!box->is_empty && (has_lower || has_upper))
    {
      mcor_cap_face face;
      mcor_set_cap_extent(context, a, !has_lower, &face);
      status = mcor_note_cap_tiles(context, least, &face);
      mcor_free_cap_face(&face);
    }
  }
  return status;
}
