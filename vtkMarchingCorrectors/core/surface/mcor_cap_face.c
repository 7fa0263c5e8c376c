/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Nodes of one side of a period: on which side of the iso value they are, and whether they are valid.
 * Where marching has evaluated them its answer is taken, so that a cap fits the surface; elsewhere
 * no surface is near. */

#include "mcor_box.h"
#include "mcor_cap.h"
#include "mcor_plane.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* Points evaluated at a time. */
#define MCOR_CAP_BATCH (1 << 18)

/* ---- what marching knows ---- */

/* Sets `to` at those nodes of a brick that lie in a plane of the face, where their bits in a mask are
 * set. */
static void mcor_mark_plane(
  const mcor_cap_face* face, const cl_int* brick, int plane, cl_ulong mask, int flag, uint8_t* to)
{
  const int at = plane - brick[face->axis] * MCOR_BRICK;
  if (at < 0 || at >= MCOR_BRICK)
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
      to[index] |= (uint8_t)(index >= MCOR_CAP_TILE * MCOR_CAP_TILE ? flag : 0);
    }
  }
}

static mcor_status mcor_take_masks(
  mcor_context* context, void* const views[MCOR_BRICK_VIEWS], void* data)
{
  mcor_cap_face* face = data;
  const cl_ulong *known = views[MCOR_VIEW_KNOWN], *above = views[MCOR_VIEW_ABOVE],
                 *valid = views[MCOR_VIEW_VALID], *used = views[MCOR_VIEW_USED],
                 *decisions = views[MCOR_VIEW_DECISIONS];
  for (int slot = 0; slot < context->bricks.now.count; ++slot)
  {
    const cl_int* brick = (const cl_int*)views[MCOR_VIEW_BRICKS] + 4 * (size_t)slot;
    const cl_ulong k = known[slot];
    mcor_mark_plane(face, brick, face->plane, k, MCOR_CAP_KNOWN, face->state);
    mcor_mark_plane(face, brick, face->plane, k & above[slot], MCOR_CAP_ABOVE, face->state);
    mcor_mark_plane(face, brick, face->plane, k & valid[slot], MCOR_CAP_VALID, face->state);
    mcor_mark_plane(face, brick, face->inner, k, MCOR_CAP_KNOWN, face->within);
    mcor_mark_plane(face, brick, face->inner, k & valid[slot], MCOR_CAP_VALID, face->within);
    mcor_mark_plane(face, brick, face->cell, used[slot], MCOR_CAP_USED, face->state);
    if (decisions)
    {
      mcor_mark_plane(face, brick, face->plane,
        decisions[(size_t)slot * MCOR_DECISION_MASKS + (size_t)face->axis], MCOR_CAP_JOINED,
        face->state);
    }
  }
  return MCOR_OK;
}

mcor_status mcor_see_bricks(mcor_context* context, mcor_look look, void* data)
{
  const mcor_brick_data* now = &context->bricks.now;
  const size_t n = (size_t)now->count, mask = n * sizeof(cl_ulong);
  const int count = n == 0 ? 0 : mcor_is_resolved(context) ? MCOR_BRICK_VIEWS : MCOR_VIEW_DECISIONS;
  void* views[MCOR_BRICK_VIEWS] = { NULL };
  const mcor_mapping mappings[MCOR_BRICK_VIEWS] = {
    [MCOR_VIEW_BRICKS] = { &now->bricks, 4 * n * sizeof(cl_int), &views[MCOR_VIEW_BRICKS] },
    [MCOR_VIEW_KNOWN] = { &now->known, mask, &views[MCOR_VIEW_KNOWN] },
    [MCOR_VIEW_ABOVE] = { &now->above, mask, &views[MCOR_VIEW_ABOVE] },
    [MCOR_VIEW_VALID] = { &now->valid, mask, &views[MCOR_VIEW_VALID] },
    [MCOR_VIEW_USED] = { &context->mesh.used, mask, &views[MCOR_VIEW_USED] },
    [MCOR_VIEW_DECISIONS] = { &context->topology.decisions, MCOR_DECISION_MASKS * mask,
      &views[MCOR_VIEW_DECISIONS] }
  };
  mcor_status status = mcor_map_all(context, mappings, count);
  status = status == MCOR_OK && count > 0 ? look(context, views, data) : status;
  return mcor_unmap_all(context, mappings, count, status);
}

/* ---- what it does not know ---- */

void mcor_release_cap_points(mcor_context* context, mcor_cap_points* p)
{
  MCOR_RELEASE(context, &p->node, &p->offset, &p->value, &p->gradient, &p->weight, &p->eigenvalue);
}

/* Evaluates at nodes, or off them. */
static mcor_status mcor_evaluate_cap_nodes(mcor_context* context, const cl_int* nodes,
  const void* offsets, int count, double iso, mcor_cap_points* p)
{
  const size_t n = (size_t)count, real = context->cl.real_size;
  int groups;
  MCOR_TRY(mcor_write(context, &p->node, nodes, n * 4 * sizeof(cl_int)));
  MCOR_TRY(offsets ? mcor_write(context, &p->offset, offsets, n * 4 * real)
                   : mcor_fill(context, &p->offset, 0, n * 4 * real));
  MCOR_TRY(mcor_reserve(context, &p->value, n * real));
  MCOR_TRY(mcor_reserve(context, &p->gradient, n * 4 * real));
  MCOR_TRY(mcor_reserve(context, &p->weight, n * real));
  MCOR_TRY(mcor_make_groups(context, &p->node, 0, count, &groups));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_cap_points", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_INT(groups), MCOR_BUFFER(&context->points.groups), MCOR_BUFFER(&p->node), MCOR_REAL(iso),
    MCOR_BUFFER(&p->offset), MCOR_BUFFER(&p->value), MCOR_BUFFER(&p->gradient),
    MCOR_BUFFER(&p->weight), MCOR_INT(0), MCOR_INT(0), MCOR_BUFFER(&p->value),
    MCOR_BUFFER(&p->weight)));
  if (!mcor_trims_by_eigenvalue(context))
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_reserve(context, &p->eigenvalue, n * real));
  return MCOR_LAUNCH(context, "mcor_boundary_points", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_INT(groups), MCOR_BUFFER(&context->points.groups), MCOR_BUFFER(&p->node),
    MCOR_BUFFER(&p->offset), MCOR_INT(mcor_is_plane(context)), MCOR_BUFFER(&p->eigenvalue));
}

mcor_status mcor_evaluate_cap_points(mcor_context* context, const cl_int* nodes,
  const void* offsets, int count, double iso, mcor_cap_points* p, mcor_cap_values* v)
{
  const size_t n = (size_t)count * context->cl.real_size;
  MCOR_TRY(mcor_evaluate_cap_nodes(context, nodes, offsets, count, iso, p));
  MCOR_TRY(mcor_map(context, &p->value, n, false, &v->value));
  MCOR_TRY(mcor_map(context, &p->gradient, 4 * n, false, &v->gradient));
  MCOR_TRY(mcor_map(context, &p->weight, n, false, &v->weight));
  return mcor_trims_by_eigenvalue(context)
    ? mcor_map(context, &p->eigenvalue, n, false, &v->eigenvalue)
    : MCOR_OK;
}

mcor_status mcor_unmap_cap_values(
  mcor_context* context, const mcor_cap_points* p, mcor_cap_values* v)
{
  const mcor_mapping mappings[] = { { &p->value, 0, &v->value }, { &p->gradient, 0, &v->gradient },
    { &p->weight, 0, &v->weight }, { &p->eigenvalue, 0, &v->eigenvalue } };
  return mcor_unmap_all(context, mappings, 4, MCOR_OK);
}

double mcor_cap_margin(const mcor_context* context, const mcor_cap_values* v, int64_t i)
{
  const double weight = mcor_get_real(context, v->weight, i), share = mcor_fluid_share(context);
  const double fluid =
    context->cl.build.solids ? mcor_get_real(context, v->gradient, 4 * i + 3) : weight;
  const double quantity = v->eigenvalue ? mcor_get_real(context, v->eigenvalue, i) : weight;
  const double threshold = context->run.options->field == MCOR_WEIGHT_SUM
    ? DBL_MAX
    : quantity - mcor_real_of(context, mcor_vertex_threshold(context));
  const double ends = share > 0 ? fluid - share * weight : DBL_MAX;
  const double margin = threshold < ends ? threshold : ends;
  return fluid > mcor_real_of(context, mcor_least_fluid(context)) ||
      context->run.options->field != MCOR_SHEPARD
    ? margin
    : fmin(margin, 0);
}

bool mcor_cap_is_valid(const mcor_context* context, const mcor_cap_values* v, int64_t i)
{
  const mcor_options* options = context->run.options;
  const double weight = mcor_get_real(context, v->weight, i);
  const double fluid =
    context->cl.build.solids ? mcor_get_real(context, v->gradient, 4 * i + 3) : weight;
  return options->field == MCOR_WEIGHT_SUM ||
    (weight >= mcor_real_of(context, options->node_threshold) &&
      (options->field == MCOR_SUM || fluid >= mcor_real_of(context, MCOR_LEAST_NODE_WEIGHT)));
}

/* Takes point i, which is node number `to`: of the side itself, or of those within. */
static void mcor_take_cap_node(const mcor_context* context, const mcor_cap_values* v, int64_t i,
  bool within, int64_t to, mcor_cap_face* face)
{
  uint8_t* state = within ? &face->within[to] : &face->state[to];
  if (!(*state & MCOR_CAP_KNOWN))
  {
    *state |= mcor_cap_is_valid(context, v, i) ? MCOR_CAP_VALID : 0;
    *state |= mcor_get_real(context, v->value, i) >= 0 ? MCOR_CAP_ABOVE : 0;
  }
  if (!within)
  {
    face->margin[to] = mcor_cap_margin(context, v, i);
  }
}

/* Evaluates a list of nodes, and takes them. */
static mcor_status mcor_take_cap_nodes(mcor_context* context, const cl_int* nodes,
  const int64_t* to, int count, bool within, double iso, mcor_cap_points* p, mcor_cap_face* face)
{
  if (count == 0)
  {
    return MCOR_OK;
  }
  mcor_cap_values v = { NULL, NULL, NULL, NULL };
  mcor_status status = mcor_evaluate_cap_points(context, nodes, NULL, count, iso, p, &v);
  for (int i = 0; i < count && status == MCOR_OK; ++i)
  {
    mcor_take_cap_node(context, &v, i, within, to[i], face);
  }
  const mcor_status unmapped = mcor_unmap_cap_values(context, p, &v);
  status = status == MCOR_OK ? unmapped : status;
  return status == MCOR_OK ? mcor_report_launch(context) : status;
}

/* Whether a node of the side is to be evaluated: below it is of no use, but whether it is must be
 * known. Of those within, the validity, where a cell has no vertex on the side. */
static bool mcor_needs_cap_node(const mcor_cap_face* face, bool within, int u, int v)
{
  const int64_t at = mcor_cap_index(face, u, v);
  if (!within)
  {
    return !(face->state[at] & MCOR_CAP_KNOWN) || (face->state[at] & MCOR_CAP_ABOVE);
  }
  return !(face->within[at] & MCOR_CAP_KNOWN) && (face->state[at] & MCOR_CAP_ABOVE) &&
    (face->state[at] & MCOR_CAP_VALID);
}

/* Lists the nodes of tile t that are to be evaluated, by squares of 4 x 4 nodes, which are near each other.
 * Returns the new count. */
static int mcor_list_cap_nodes(const mcor_context* context, const mcor_cap_face* face, int t,
  bool within, cl_int* nodes, int64_t* to, int count)
{
  const int u0 = face->place[t] % face->tiles[0] * MCOR_CAP_TILE,
            v0 = face->place[t] / face->tiles[0] * MCOR_CAP_TILE;
  for (int n = 0; n < MCOR_CAP_TILE * MCOR_CAP_TILE; ++n)
  {
    const int u = u0 + (n & 3) + (n >> 4 & 3) * 4, v = v0 + (n >> 2 & 3) + (n >> 6) * 4;
    if (u < face->count[0] && v < face->count[1] && mcor_needs_cap_node(face, within, u, v))
    {
      cl_int* node = nodes + 4 * (size_t)count;
      mcor_cap_node(context, face, u, v, node);
      node[face->axis] = within ? face->inner : face->plane;
      node[3] = 0;
      to[count++] = mcor_cap_index(face, u, v);
    }
  }
  return count;
}

/* Evaluates what is needed. */
static mcor_status mcor_fill_cap_nodes(
  mcor_context* context, bool within, double iso, mcor_cap_points* p, mcor_cap_face* face)
{
  const size_t room = MCOR_CAP_BATCH + MCOR_CAP_TILE * MCOR_CAP_TILE;
  cl_int* nodes = malloc(room * 4 * sizeof *nodes);
  int64_t* to = malloc(room * sizeof *to);
  mcor_status status = mcor_allocated(context, nodes && to);
  int count = 0;
  for (int t = 1; t <= face->tile_count && status == MCOR_OK; ++t)
  {
    count = mcor_list_cap_nodes(context, face, t, within, nodes, to, count);
    if (count >= MCOR_CAP_BATCH || t == face->tile_count)
    {
      status = mcor_take_cap_nodes(context, nodes, to, count, within, iso, p, face);
      count = 0;
    }
  }
  free(nodes);
  free(to);
  return status;
}

/* A period apart the sums have the same bits: takes from the side opposite what marching does not know of
 * this one's nodes, and how far they are inside. A tile that it has not is one that no particle reaches. */
static void mcor_take_opposite(const mcor_cap_face* opposite, mcor_cap_face* face)
{
  const int64_t nodes = MCOR_CAP_TILE * MCOR_CAP_TILE;
  for (int t = 1; t <= face->tile_count; ++t)
  {
    const int64_t from = opposite->tile[face->place[t]] * nodes, to = t * nodes;
    for (int64_t i = 0; i < nodes; ++i)
    {
      const int signs = opposite->state[from + i] & (MCOR_CAP_ABOVE | MCOR_CAP_VALID);
      face->state[to + i] |= (uint8_t)(face->state[to + i] & MCOR_CAP_KNOWN ? 0 : signs);
      face->margin[to + i] = opposite->margin[from + i];
    }
  }
}

mcor_status mcor_load_cap_face(mcor_context* context, int axis, int upper,
  const mcor_cap_face* opposite, double iso, mcor_cap_points* points, mcor_cap_face* face)
{
  MCOR_TRY(mcor_make_cap_face(context, axis, upper, iso + context->value_shift, face));
  MCOR_TRY(mcor_see_bricks(context, mcor_take_masks, face));
  if (opposite)
  {
    mcor_take_opposite(opposite, face);
  }
  else
  {
    MCOR_TRY(mcor_fill_cap_nodes(context, false, iso, points, face));
  }
  return mcor_fill_cap_nodes(context, true, iso, points, face);
}
