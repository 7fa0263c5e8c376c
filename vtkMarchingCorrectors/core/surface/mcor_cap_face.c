/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The nodes of one side of a period or box: whether each is above the iso value, and whether it
 * is valid. Where marching has evaluated a node its answer is taken, so that the cap fits the
 * surface. Nodes are kept in tiles, squares of nodes that some particle reaches. Where no
 * particle reaches there is nothing to close, so memory and time go with what is at the side,
 * not with its area. */

#include "mcor_box.h"
#include "mcor_cap.h"

#include <math.h>
#include <stdlib.h>

/* ---- Extent and tiles ---- */

/* Entries of a side's directory of tiles, at most. */
#define MCOR_CAP_PLACE_LIMIT (1 << 24)

bool mcor_has_cap_side(const mcor_context* context, int axis, int upper)
{
  const int plane = mcor_cap_plane(context, axis, upper);
  return plane >= 0 && plane == (upper ? context->box.last : context->box.first)[axis];
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

void mcor_cap_range(const mcor_context* context, int axis, int range[2])
{
  const mcor_lattice* lattice = &context->lattice;
  const mcor_box* box = &context->box;
  const int lower = mcor_cap_plane(context, axis, 0), higher = mcor_cap_plane(context, axis, 1);
  const int first = lower >= 0 ? lower : (int)lattice->first[axis];
  const int last = higher >= 0 ? higher : (int)lattice->last[axis];
  const int low = box->first[axis] - box->ring, high = box->last[axis] + box->ring;
  range[0] = low > first ? low : first;
  range[1] = high < last ? high : last;
}

static void mcor_set_cap_extent(
  const mcor_context* context, int axis, int upper, mcor_cap_face* face)
{
  *face = (mcor_cap_face){ .axis = axis,
    .upper = upper,
    .plane = mcor_cap_plane(context, axis, upper),
    .across = { (axis + 1) % 3, (axis + 2) % 3 } };
  for (int i = 0; i < 2; ++i)
  {
    const int a = face->across[i];
    int range[2];
    mcor_cap_range(context, a, range);
    face->first[i] = range[0];
    face->count[i] = range[1] - range[0] + 1;
    if (a >= context->space.axes) /* the edges of a plane's side: one row of squares */
    {
      face->first[i] = 0;
      face->count[i] = 2;
    }
  }
}

/* Marks the tiles that hold nodes from low to high. */
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
  /* 4 to 64 million nodes. Where few particles reach more than that, a smoothing length or the cube
   * size is a mistake. */
  const int particles = context->grid.count / 2, least = 1 << 14, most = 1 << 18;
  const int limit = particles < least ? least : particles < most ? particles : most;
  const int nodes = limit * MCOR_CAP_TILE_NODES;
  const bool is_much = face->tile_count > limit;
  MCOR_RETURN_IF(is_much && context->run.options->filled, context, MCOR_OUT_OF_CAPACITY,
    "More than %d nodes are within reach of particles, with cube size %g: too many to be filled. "
    "Use a larger cube size, or turn filling off.",
    nodes, context->lattice.cube);
  MCOR_RETURN_IF(is_much, context, MCOR_OUT_OF_CAPACITY,
    "More than %d nodes of a side along %c are within reach of particles, with cube size "
    "%g: too many for a cap. Use a larger cube size, or turn capping off.",
    nodes, mcor_axis_letter(context, face->axis), context->lattice.cube);
  return MCOR_OK;
}

/* Marks the tiles that a particle at x (in nodes) may reach; its support lies within a cube of
 * half edge `reach`. The range is widened by one node, because a square is looked up by its
 * lowest node. */
static mcor_status mcor_note_particle(
  mcor_context* context, const double x[3], double reach, bool is_solid, void* data)
{
  mcor_cap_face* face = data;
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
  (void)is_solid;
  return mcor_note_tiles(context, face, low, high);
}

mcor_status mcor_visit_particles(mcor_context* context, mcor_visit_particle visit, void* data)
{
  const mcor_grid* g = &context->grid;
  const mcor_lattice* lattice = &context->lattice;
  const size_t bytes = (size_t)g->count *
    context->cl.real_size; /* positions are fixed-point numbers of the same size */
  void* views[5] = { NULL };
  const mcor_mapping mappings[5] = { { &g->px, bytes, &views[0] }, { &g->py, bytes, &views[1] },
    { &g->pz, bytes, &views[2] }, { &g->inv_h, bytes, &views[3] },
    { &g->fluid_weight, bytes, &views[4] } };
  const int count = g->has_solids ? 5 : 4;
  const bool is_long = context->cl.real_size == sizeof(cl_double);
  const double support = mcor_support_factor(context->run.options->sph_kernel);
  mcor_status status = mcor_map_all(context, mappings, count);
  for (int64_t i = 0; i < g->count && status == MCOR_OK; ++i)
  {
    double x[3];
    for (int a = 0; a < 3; ++a)
    {
      x[a] =
        (is_long ? (double)((const cl_long*)views[a])[i] : (double)((const cl_int*)views[a])[i]) /
        (double)lattice->step[a];
    }
    const double reach = support / mcor_get_real(context, views[3], i) * 1.001;
    const bool is_solid = g->has_solids && mcor_get_real(context, views[4], i) == 0;
    status = visit(context, x, reach, is_solid, data);
  }
  return mcor_unmap_all(context, mappings, count, status);
}

/* Marks the tiles that particles reach; all tiles where empty space is above the iso value. */
mcor_status mcor_note_cap_tiles(mcor_context* context, double iso_value, mcor_cap_face* face)
{
  const bool empty_is_above = context->run.options->field != MCOR_SHEPARD && iso_value <= 0;
  const double low[2] = { 0, 0 }, high[2] = { face->count[0], face->count[1] };
  for (int i = 0; i < 2; ++i)
  {
    face->tiles[i] = (face->count[i] - 1) / MCOR_CAP_TILE + 1;
  }
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
  return empty_is_above ? mcor_note_tiles(context, face, low, high)
                        : mcor_visit_particles(context, mcor_note_particle, face);
}

mcor_status mcor_make_cap_nodes(mcor_context* context, mcor_cap_face* face)
{
  /* Tile 0 stands for all nodes that no particle reaches. */
  const size_t nodes = ((size_t)face->tile_count + 1) * MCOR_CAP_TILE_NODES;
  face->node_count = (int64_t)nodes;
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

mcor_status mcor_check_caps(mcor_context* context)
{
  const mcor_options* options = context->run.options;
  double least = INFINITY;
  for (int i = 0; i < options->iso_count; ++i)
  {
    least = fmin(least, options->iso_values[i]);
  }
  mcor_status status = MCOR_OK;
  for (int a = 0; mcor_makes_caps(context) && a < 3 && status == MCOR_OK; ++a)
  {
    const bool has_lower = mcor_has_cap_side(context, a, 0);
    if (!context->box.is_empty && (has_lower || mcor_has_cap_side(context, a, 1)))
    {
      mcor_cap_face face;
      mcor_set_cap_extent(context, a, !has_lower, &face);
      status = mcor_note_cap_tiles(context, least, &face);
      mcor_free_cap_face(&face);
    }
  }
  return status;
}

/* ---- Nodes that marching has evaluated ---- */

/* Sets `flag` in `to` at the nodes of a brick that lie in the plane and have a bit in the mask. */
static void mcor_mark_plane(
  const mcor_cap_face* face, const cl_int* brick, int plane, cl_ulong mask, int flag, uint8_t* to)
{
  const int at = plane - brick[face->axis] * MCOR_BRICK;
  if (mask == 0 || at < 0 || at >= MCOR_BRICK)
  {
    return;
  }
  const int step = 2 * face->axis, step_u = 2 * face->across[0], step_v = 2 * face->across[1];
  for (int n = 0; n < MCOR_BRICK * MCOR_BRICK; ++n)
  {
    const int u = brick[face->across[0]] * MCOR_BRICK + (n & 3) - face->first[0];
    const int v = brick[face->across[1]] * MCOR_BRICK + (n >> 2) - face->first[1];
    const int bit = at << step | (n & 3) << step_u | n >> 2 << step_v;
    if (u >= 0 && u < face->count[0] && v >= 0 && v < face->count[1] && mask >> bit & 1)
    {
      const int64_t index = mcor_cap_index(face, u, v);
      to[index] |= (uint8_t)(index >= MCOR_CAP_TILE_NODES ? flag : 0);
    }
  }
}

static void mcor_take_brick(const mcor_seen_brick* brick, void* data)
{
  mcor_cap_face* face = data;
  const int plane = face->plane, inner = plane + (face->upper ? -1 : 1), cell = plane - face->upper;
  mcor_mark_plane(face, brick->at, plane, brick->known, MCOR_CAP_KNOWN, face->state);
  mcor_mark_plane(face, brick->at, plane, brick->above, MCOR_CAP_ABOVE, face->state);
  mcor_mark_plane(face, brick->at, plane, brick->valid, MCOR_CAP_VALID, face->state);
  mcor_mark_plane(face, brick->at, inner, brick->known, MCOR_CAP_KNOWN, face->within);
  mcor_mark_plane(face, brick->at, inner, brick->valid, MCOR_CAP_VALID, face->within);
  mcor_mark_plane(face, brick->at, cell, brick->used, MCOR_CAP_USED, face->state);
  mcor_mark_plane(face, brick->at, plane, brick->joined[face->axis], MCOR_CAP_JOINED, face->state);
}

mcor_status mcor_see_bricks(mcor_context* context, mcor_see_brick see, void* data)
{
  const mcor_brick_data* now = &context->bricks.now;
  const size_t n = (size_t)now->count, mask = n * sizeof(cl_ulong);
  const bool resolved = mcor_is_resolved(context);
  void *bricks = NULL, *known = NULL, *above = NULL, *valid = NULL, *used = NULL, *joined = NULL;
  const mcor_mapping mappings[] = { { &now->bricks, 4 * n * sizeof(cl_int), &bricks },
    { &now->known, mask, &known }, { &now->above, mask, &above }, { &now->valid, mask, &valid },
    { &context->mesh.used, mask, &used },
    { &context->topology.decisions, MCOR_DECISION_MASKS * mask, &joined } };
  const int count = n == 0 ? 0 : resolved ? 6 : 5;
  mcor_status status = mcor_map_all(context, mappings, count);
  for (size_t slot = 0; slot < n && status == MCOR_OK; ++slot)
  {
    const cl_ulong k = ((const cl_ulong*)known)[slot];
    mcor_seen_brick brick = { .at = (const cl_int*)bricks + 4 * slot,
      .known = k,
      .above = k & ((const cl_ulong*)above)[slot],
      .valid = k & ((const cl_ulong*)valid)[slot],
      .used = ((const cl_ulong*)used)[slot] };
    for (size_t a = 0; a < 3 && resolved; ++a)
    {
      brick.joined[a] = ((const cl_ulong*)joined)[slot * MCOR_DECISION_MASKS + a];
    }
    see(&brick, data);
  }
  return mcor_unmap_all(context, mappings, count, status);
}

mcor_status mcor_take_cap_masks(mcor_context* context, mcor_cap_face* face)
{
  return mcor_see_bricks(context, mcor_take_brick, face);
}

/* ---- The other nodes ---- */

/* Takes the field at node number points->to[i] of the side, or of the nodes one further in. */
static void mcor_take_cap_node(
  const mcor_context* context, const mcor_cap_points* points, int64_t i, void* data)
{
  mcor_cap_face* face = data;
  const int64_t to = points->to[i];
  const bool within = points->node[4 * i + face->axis] != face->plane;
  uint8_t* state = within ? &face->within[to] : &face->state[to];
  if (!(*state & MCOR_CAP_KNOWN))
  {
    *state |= mcor_cap_is_valid(context, points, i) ? MCOR_CAP_VALID : 0;
    *state |= mcor_get_real(context, points->value, i) >= 0 ? MCOR_CAP_ABOVE : 0;
  }
  if (!within)
  {
    face->margin[to] = mcor_cap_margin(context, points, i);
  }
}

/* Goes tile by tile, and there by squares of 4 x 4 nodes, so that successive points are near
 * each other. On the side, nodes above need their margin, unknown ones their side, too. Nodes
 * further in need their validity, where a cell has no vertex on the side. */
mcor_status mcor_ask_cap_nodes(
  mcor_context* context, const mcor_cap_face* face, bool within, mcor_cap_points* points)
{
  for (int t = 1; t <= face->tile_count; ++t)
  {
    const int u0 = face->place[t] % face->tiles[0] * MCOR_CAP_TILE,
              v0 = face->place[t] / face->tiles[0] * MCOR_CAP_TILE;
    for (int n = 0; n < MCOR_CAP_TILE_NODES; ++n)
    {
      const int u = u0 + (n & 3) + (n >> 4 & 3) * 4, v = v0 + (n >> 2 & 3) + (n >> 6) * 4;
      if (u >= face->count[0] || v >= face->count[1])
      {
        continue;
      }
      const int64_t at = mcor_cap_index(face, u, v);
      const int state = face->state[at], corner = MCOR_CAP_ABOVE | MCOR_CAP_VALID;
      if (within ? !(face->within[at] & MCOR_CAP_KNOWN) && (state & corner) == corner
                 : !(state & MCOR_CAP_KNOWN) || (state & MCOR_CAP_ABOVE))
      {
        cl_int node[3];
        mcor_cap_node(context, face, u, v, node);
        node[face->axis] += within ? (face->upper ? -1 : 1) : 0;
        MCOR_TRY(mcor_add_cap_point(context, points, node, NULL, at));
      }
    }
  }
  return mcor_take_cap_points(context, points);
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

mcor_status mcor_load_cap_face(mcor_context* context, int axis, int upper,
  const mcor_cap_face* opposite, mcor_cap_points* points, mcor_cap_face* face)
{
  points->take = mcor_take_cap_node;
  points->data = face;
  mcor_set_cap_extent(context, axis, upper, face);
  MCOR_TRY(mcor_note_cap_tiles(context, context->run.iso.value, face));
  MCOR_TRY(mcor_make_cap_nodes(context, face));
  MCOR_TRY(mcor_take_cap_masks(context, face));
  MCOR_TRY(opposite ? MCOR_OK : mcor_ask_cap_nodes(context, face, false, points));
  /* Copies what the opposite side of a period knows: a period apart, sums have the same bits. A
   * tile that the opposite side lacks is one that no particle reaches. */
  const int64_t nodes = MCOR_CAP_TILE_NODES;
  for (int64_t to = nodes; opposite && to < face->node_count; ++to)
  {
    const int64_t from = opposite->tile[face->place[to / nodes]] * nodes + to % nodes;
    const int signs = opposite->state[from] & (MCOR_CAP_ABOVE | MCOR_CAP_VALID);
    face->state[to] |= (uint8_t)(face->state[to] & MCOR_CAP_KNOWN ? 0 : signs);
    face->margin[to] = opposite->margin[from];
  }
  return mcor_ask_cap_nodes(context, face, true, points);
}
