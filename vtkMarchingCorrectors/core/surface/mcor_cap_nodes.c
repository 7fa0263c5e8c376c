/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds the nodes where caps may be. They lie on one side of a period or box, or in a plane that is
 * filled. They are kept in bricks that particles reach: elsewhere is nothing to close. Memory and
 * time therefore depend on the particles at the side, not on the side's area. If empty space is
 * above the iso value, as with a sum and an iso value of 0, all bricks of the side are kept. If
 * marching has evaluated a brick, the brick's nodes are taken from marching, so that the cap fits
 * the surface. */

#include "mcor_box.h"
#include "mcor_cap.h"
#include "mcor_tree.h"

#include <stdlib.h>
#include <string.h>

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
  return makes;
}

void mcor_free_cap_nodes(mcor_cap_nodes* nodes)
{
  mcor_table_free(&nodes->index);
  free(nodes->bricks.of);
  free(nodes->margin);
  free(nodes->value);
}

/* ---- Bricks ---- */

/* Fails if there are too many clusters (4^3 bricks) at a side. The more particles there are, the
 * higher is the limit; it corresponds to 4 to 64 million nodes on the side. If few particles reach
 * more nodes, a smoothing length or the cube size is wrong. */
static mcor_status mcor_limit_side(
  mcor_context* context, const mcor_cap_nodes* nodes, size_t clusters)
{
  const int particles = context->grid.count / 2, least = 1 << 14, most = 1 << 18;
  const int limit = particles < least ? least : particles < most ? particles : most;
  const int edge = MCOR_CLUSTER * MCOR_BRICK,
            layers = nodes->plane / edge == nodes->inner / edge ? 1 : 2;
  const bool is_much = clusters > (size_t)layers * (size_t)limit;
  MCOR_FAIL_IF(is_much && context->run.options->filled, context, MCOR_OUT_OF_CAPACITY,
    MCOR_SAY(FILL_NODES), limit * edge * edge, context->lattice.cube);
  MCOR_FAIL_IF(is_much, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(CAP_NODES), limit * edge * edge,
    mcor_axis_letter(context, nodes->axis), context->lattice.cube);
  return MCOR_OK;
}

static mcor_status mcor_add_cap_brick(
  mcor_context* context, mcor_cap_nodes* nodes, const int cluster[3], int bit)
{
  mcor_cap_brick brick = { .at = { cluster[0] + (bit & 3), cluster[1] + (bit >> 2 & 3),
                             cluster[2] + (bit >> 4) } };
  const bool on_side = brick.at[nodes->axis] == nodes->plane / MCOR_BRICK;
  nodes->side_count += on_side;
  brick.key = (uint64_t)!on_side << 63 | (uint64_t)brick.at[nodes->across[1]] << 32 |
    (uint64_t)brick.at[nodes->across[0]];
  MCOR_APPEND(context, &nodes->bricks, brick);
  return MCOR_OK;
}

/* Adds the bricks from position `low` to `high`, in nodes, unless `clusters` marks them, and marks
 * them there. clusters: masks of bricks, by the key of each cluster's first brick. ends: the first
 * and last brick of the last call; if they are the same now, nothing is added. */
static mcor_status mcor_add_cap_bricks(mcor_context* context, mcor_cap_nodes* nodes,
  const double low[3], const double high[3], mcor_table* clusters, int ends[2][3])
{
  int *from = ends[0], *to = ends[1], c[3];
  bool is_new = false;
  for (int a = 0; a < 3; ++a)
  {
    const int first = (int)fmax(low[a], nodes->range[a][0]) / MCOR_BRICK;
    const int last = (int)fmin(high[a], nodes->range[a][1]) / MCOR_BRICK;
    is_new = is_new || first != from[a] || last != to[a];
    from[a] = first;
    to[a] = last;
  }
  if (!is_new)
  {
    return MCOR_OK;
  }
  for (c[2] = from[2] & ~3; c[2] <= to[2]; c[2] += MCOR_CLUSTER)
  {
    for (c[1] = from[1] & ~3; c[1] <= to[1]; c[1] += MCOR_CLUSTER)
    {
      for (c[0] = from[0] & ~3; c[0] <= to[0]; c[0] += MCOR_CLUSTER)
      {
        uint64_t* bricks = mcor_table_add(clusters, mcor_cap_key(c));
        MCOR_TRY(mcor_allocated(context, bricks));
        const uint64_t added = mcor_bricks_between(from, to, c) & ~*bricks;
        *bricks |= added;
        for (int bit = 0; bit < 64 && added >> bit; ++bit)
        {
          if (added >> bit & 1)
          {
            MCOR_TRY(mcor_add_cap_brick(context, nodes, c, bit));
          }
        }
        MCOR_TRY(mcor_limit_side(context, nodes, clusters->count));
      }
    }
  }
  return MCOR_OK;
}

/* Adds the bricks that particles may reach: for each particle, the bricks in a box around the
 * support, which is enlarged by 0.1 %. The box extends two nodes further: one node because a square
 * is found by its lowest node, the other for rounding. Tests the side's axis first, because most
 * particles are far from the side. */
static mcor_status mcor_add_reached(
  mcor_context* context, mcor_cap_nodes* nodes, mcor_table* clusters)
{
  const mcor_grid* g = &context->grid;
  const mcor_lattice* lattice = &context->lattice;
  const size_t bytes = (size_t)g->count *
    context->cl.real_size; /* positions are fixed-point numbers of the same size */
  void* views[4] = { NULL };
  const mcor_mapping mappings[4] = { { &g->px, bytes, &views[0] }, { &g->py, bytes, &views[1] },
    { &g->pz, bytes, &views[2] }, { &g->inv_h, bytes, &views[3] } };
  const bool is_long = context->cl.real_size == sizeof(cl_double);
  double reach_of[3], per_step[3]; /* in nodes */
  int ends[2][3] = { { -1 } };
  for (int a = 0; a < 3; ++a)
  {
    reach_of[a] =
      1.001 * mcor_support_factor(context->run.options->sph_kernel) / mcor_edge_of(lattice, a);
    per_step[a] = 1 / (double)lattice->step[a];
  }
  mcor_status status = mcor_map_all(context, mappings, 4);
  for (int64_t i = 0; i < g->count && status == MCOR_OK; ++i)
  {
    const double h = 1 / mcor_get_real(context, views[3], i);
    double low[3], high[3];
    bool is_near = true;
    for (int k = 0; k < 3 && is_near; ++k)
    {
      const int a = (nodes->axis + k) % 3, *range = nodes->range[a];
      const double x = per_step[a] *
        (is_long ? (double)((const cl_long*)views[a])[i] : (double)((const cl_int*)views[a])[i]);
      low[a] = x - h * reach_of[a] - 2;
      high[a] = x + h * reach_of[a] + 2;
      is_near = low[a] <= range[1] && high[a] >= range[0];
    }
    if (is_near)
    {
      status = mcor_add_cap_bricks(context, nodes, low, high, clusters, ends);
    }
  }
  return mcor_unmap_all(context, mappings, 4, status);
}

/* Returns the number of a brick, or 0 if no particle reaches it. */
static int32_t mcor_cap_brick_at(const mcor_cap_nodes* nodes, const cl_int at[3])
{
  const int32_t number = mcor_find_number(&nodes->index, mcor_cap_key(at));
  return number < 0 ? 0 : number;
}

/* Sorts and numbers the bricks, and finds the bricks beside each brick. */
static mcor_status mcor_number_cap_bricks(mcor_context* context, mcor_cap_nodes* nodes)
{
  mcor_cap_brick* of = nodes->bricks.of;
  const int32_t count = (int32_t)nodes->bricks.count;
  nodes->node_count = (1 + nodes->side_count) * MCOR_SIDE_NODES;
  nodes->margin = calloc((size_t)nodes->node_count, sizeof *nodes->margin);
  MCOR_TRY(mcor_allocated(context, nodes->margin));
  qsort(of + 1, (size_t)count - 1, sizeof *of, mcor_compare_keys);
  for (int32_t i = 1; i < count; ++i)
  {
    MCOR_TRY(
      mcor_allocated(context, mcor_table_number(&nodes->index, mcor_cap_key(of[i].at), i) >= 0));
  }
  for (int32_t i = 1; i < count; ++i)
  {
    const cl_int* at = of[i].at;
    for (int d = 0; d < 4; ++d)
    {
      cl_int up[3] = { at[0], at[1], at[2] };
      up[nodes->across[0]] += d & 1;
      up[nodes->across[1]] += d >> 1;
      of[i].up[d] = mcor_cap_brick_at(nodes, up);
    }
    cl_int inner[3] = { at[0], at[1], at[2] };
    inner[nodes->axis] = nodes->inner / MCOR_BRICK;
    of[i].inner = mcor_cap_brick_at(nodes, inner);
  }
  return MCOR_OK;
}

mcor_status mcor_find_cap_bricks(mcor_context* context, double iso_value, mcor_cap_nodes* nodes)
{
  const bool empty_is_above = context->run.options->field != MCOR_SHEPARD && iso_value <= 0;
  const double low[3] = { -INFINITY, -INFINITY, -INFINITY },
               high[3] = { INFINITY, INFINITY, INFINITY };
  mcor_table clusters = { 0 };
  int ends[2][3] = { { -1 } };
  MCOR_APPEND(context, &nodes->bricks, (mcor_cap_brick){ .key = 0 });
  mcor_status status = empty_is_above
    ? mcor_add_cap_bricks(context, nodes, low, high, &clusters, ends)
    : mcor_add_reached(context, nodes, &clusters);
  MCOR_THEN(status, mcor_number_cap_bricks(context, nodes));
  mcor_table_free(&clusters);
  return status;
}

/* ---- Nodes ---- */

mcor_status mcor_take_cap_masks(mcor_context* context, mcor_cap_nodes* nodes)
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
  const mcor_status status = mcor_map_all(context, mappings, count);
  for (size_t slot = 0; slot < n && status == MCOR_OK; ++slot)
  {
    const int32_t number = mcor_cap_brick_at(nodes, (const cl_int*)bricks + 4 * slot);
    mcor_cap_brick* brick = &nodes->bricks.of[number];
    if (number == 0)
    {
      continue;
    }
    brick->used = ((const cl_ulong*)used)[slot];
    brick->is_known = ((const cl_ulong*)known)[slot] != 0;
    brick->above = brick->is_known ? ((const cl_ulong*)above)[slot] : brick->above;
    brick->valid = brick->is_known ? ((const cl_ulong*)valid)[slot] : brick->valid;
    brick->joined =
      resolved ? ((const cl_ulong*)joined)[slot * MCOR_DECISION_MASKS + (size_t)nodes->axis] : 0;
  }
  return mcor_unmap_all(context, mappings, count, status);
}

/* Stores the field at point i, which is node points->to[i] of a side or the node one further in. */
static void mcor_take_cap_node(
  const mcor_context* context, const mcor_cap_points* points, int64_t i, void* data)
{
  mcor_cap_nodes* nodes = data;
  const int64_t to = points->to[i];
  const bool is_inner = points->node[4 * i + nodes->axis] != nodes->plane;
  mcor_cap_brick* brick = &nodes->bricks.of[to / MCOR_SIDE_NODES];
  brick = is_inner ? &nodes->bricks.of[brick->inner] : brick;
  const int bit = mcor_side_bit(nodes, is_inner ? nodes->inner : nodes->plane, to);
  if (!brick->is_known)
  {
    brick->above |= (cl_ulong)(mcor_get_real(context, points->value, i) >= 0) << bit;
    brick->valid |= (cl_ulong)mcor_cap_is_valid(context, points, i) << bit;
  }
  if (!is_inner)
  {
    nodes->margin[to] = mcor_cap_margin(context, points, i);
  }
  if (nodes->value)
  {
    nodes->value[to] = mcor_get_real(context, points->value, i);
  }
}

/* Goes brick by brick, so that successive points are near each other. Without is_inner, evaluates
 * nodes on the side: the nodes above the iso value, because their margins are needed, and all nodes
 * of bricks that marching has not evaluated. With is_inner, evaluates nodes one node further in, if
 * marching has not evaluated their brick, and if the node beside them on the side is valid and
 * above the iso value. A square without vertices is capped only if these inner nodes are valid. */
mcor_status mcor_ask_cap_nodes(mcor_context* context, mcor_cap_nodes* nodes, bool is_inner)
{
  mcor_cap_points points = { .take = mcor_take_cap_node, .data = nodes };
  mcor_status status = MCOR_OK;
  for (int64_t at = MCOR_SIDE_NODES; at < nodes->node_count && status == MCOR_OK; ++at)
  {
    const mcor_cap_brick* brick = &nodes->bricks.of[at / MCOR_SIDE_NODES];
    const int bit = mcor_side_bit(nodes, nodes->plane, at);
    const bool above = brick->above >> bit & 1, valid = brick->valid >> bit & 1;
    cl_int node[3];
    mcor_cap_node(nodes, at, node);
    bool wanted = is_inner ? above && valid && !nodes->bricks.of[brick->inner].is_known
                           : above || !brick->is_known;
    for (int i = 0; i < 2; ++i)
    {
      const int a = nodes->across[i];
      wanted = wanted && node[a] >= nodes->range[a][0] && node[a] <= nodes->range[a][1];
    }
    if (wanted)
    {
      node[nodes->axis] = is_inner ? nodes->inner : nodes->plane;
      node[2] = context->space.flat ? 0 : node[2];
      status = mcor_add_cap_point(context, &points, node, NULL, at);
    }
  }
  return mcor_end_cap_points(context, &points, status);
}

mcor_status mcor_visit_cap_squares(mcor_context* context, const mcor_cap_nodes* nodes,
  mcor_status (*visit)(void* data, const mcor_cap_nodes* nodes, int64_t at, const cl_int node[3]),
  void* data)
{
  const int u = nodes->across[0], v = nodes->across[1];
  const mcor_cap_brick* of = nodes->bricks.of;
  for (int64_t first = 1, end; first <= nodes->side_count; first = end)
  {
    for (end = first; end <= nodes->side_count && of[end].at[v] == of[first].at[v];)
    {
      ++end;
    }
    MCOR_TRY(mcor_report_launch(context));
    for (int64_t row = 0; row < MCOR_BRICK; ++row)
    {
      for (int64_t i = MCOR_BRICK * first; i < MCOR_BRICK * end; ++i)
      {
        const int64_t at = i / MCOR_BRICK * MCOR_SIDE_NODES + MCOR_BRICK * row + i % MCOR_BRICK;
        cl_int node[3];
        mcor_cap_node(nodes, at, node);
        if (node[u] >= nodes->range[u][0] && node[u] < nodes->range[u][1] &&
          node[v] >= nodes->range[v][0] && node[v] < nodes->range[v][1])
        {
          MCOR_TRY(visit(data, nodes, at, node));
        }
      }
    }
  }
  return MCOR_OK;
}

mcor_status mcor_load_cap_side(mcor_context* context, int axis, int upper, mcor_cap_nodes* nodes)
{
  const mcor_lattice* lattice = &context->lattice;
  const mcor_box* box = &context->box;
  *nodes = (mcor_cap_nodes){ .axis = axis,
    .upper = upper,
    .plane = mcor_cap_plane(context, axis, upper),
    .across = { (axis + 1) % 3, (axis + 2) % 3 } };
  nodes->inner = nodes->plane + (upper ? -1 : 1);
  for (int a = 0; a < 3; ++a)
  {
    const int lower = mcor_cap_plane(context, a, 0), higher = mcor_cap_plane(context, a, 1);
    const int first = lower >= 0 ? lower : (int)lattice->first[a];
    const int last = higher >= 0 ? higher : (int)lattice->last[a];
    const int low = box->first[a] - box->ring, high = box->last[a] + box->ring;
    int* range = nodes->range[a];
    range[0] = a == axis ? nodes->plane - upper : low > first ? low : first;
    range[1] = a == axis ? range[0] + 1 : high < last ? high : last;
    if (a >= context->space.axes) /* in two dimensions, a side is one row of squares */
    {
      range[0] = 0;
      range[1] = 1;
    }
  }
  MCOR_TRY(mcor_find_cap_bricks(context, context->run.iso.value, nodes));
  MCOR_TRY(mcor_take_cap_masks(context, nodes));
  MCOR_TRY(mcor_ask_cap_nodes(context, nodes, false));
  return mcor_ask_cap_nodes(context, nodes, true);
}
