/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Filling. First the field is evaluated at all nodes that particles reach. When an iso value's
 * lines are trimmed, their vertices and cuts, and which nodes are above, are kept. When all lines
 * are made, each node is in a band between two successive iso values. The vertices of lines divide
 * the border of each square into parts of one band each. Parts that lines join enclose a polygon of
 * their band, and trimming leaves triangles of it. Their corners are points of lines, nodes, and
 * points where trimming cuts lattice edges; triangles beside each other share these. A square is
 * filled if its nodes are valid, like squares with lines. */

#include "mcor_box.h"
#include "mcor_fill.h"

#include <stdlib.h>
#include <string.h>

/* ---- Before all lines ---- */

static void mcor_take_fill_node(
  const mcor_context* context, const mcor_cap_points* points, int64_t i, void* data)
{
  mcor_filling* fill = data;
  const int64_t to = points->to[i];
  fill->value[to] = mcor_get_real(context, points->value, i);
  fill->nodes.margin[to] = mcor_cap_margin(context, points, i);
  fill->nodes.bricks.of[to / MCOR_SIDE_NODES].valid |=
    (cl_ulong)mcor_cap_is_valid(context, points, i) << to % MCOR_SIDE_NODES;
}

mcor_status mcor_begin_fill(mcor_context* context)
{
  const mcor_options* options = context->run.options;
  if (!options->filled || options->iso_count == 0 || context->box.is_empty)
  {
    return MCOR_OK;
  }
  mcor_filling* fill = context->run.fill = calloc(1, sizeof *fill);
  context->run.iso = (mcor_iso){ .number = 0 };
  MCOR_TRY(mcor_allocated(context, fill));
  fill->cap.context = context;
  fill->lines = calloc((size_t)options->iso_count, sizeof *fill->lines);
  MCOR_TRY(mcor_allocated(context, fill->lines));
  for (int i = 0; i < options->iso_count; ++i) /* by iso value; equal values become one line */
  {
    const double iso = mcor_real_of(context, options->iso_values[i] - context->value_shift);
    int at = fill->line_count;
    while (at > 0 && fill->lines[at - 1].iso > iso)
    {
      --at;
    }
    if (at == 0 || fill->lines[at - 1].iso != iso)
    {
      mcor_fill_line* line = &fill->lines[at];
      memmove(line + 1, line, (size_t)(fill->line_count - at) * sizeof *line);
      *line = (mcor_fill_line){ .iso = iso, .value = options->iso_values[i], .iso_number = i };
      ++fill->line_count;
    }
  }
  const double least = fill->lines[0].value;
  MCOR_FAIL_IF(options->field == MCOR_SUM && options->node_threshold == 0 && least <= 0, context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(REGION_WITHOUT_END), least);
  const mcor_box* box = &context->box;
  mcor_cap_nodes* nodes = &fill->nodes;
  *nodes = (mcor_cap_nodes){ .axis = 2, .upper = 1, .across = { 0, 1 } };
  for (int a = 0; a < 2; ++a)
  {
    nodes->range[a][0] = box->first[a];
    nodes->range[a][1] = box->last[a];
  }
  MCOR_TRY(mcor_find_cap_bricks(context, 1, nodes));
  fill->value = calloc((size_t)nodes->node_count, sizeof *fill->value);
  fill->band = calloc((size_t)nodes->node_count, sizeof *fill->band);
  MCOR_TRY(mcor_allocated(context, fill->value && fill->band));
  mcor_cap_points points = { .take = mcor_take_fill_node, .data = fill };
  const mcor_status status = mcor_ask_cap_nodes(context, nodes, false, &points);
  mcor_free_cap_points(context, &points);
  return status;
}

/* ---- The lines of one iso value ---- */

/* Returns the lines of the current iso value if they are to be filled, else NULL. */
static mcor_fill_line* mcor_line_under_way(const mcor_context* context)
{
  mcor_filling* fill = context->run.fill;
  for (int i = 0; fill && i < fill->line_count; ++i)
  {
    if (fill->lines[i].iso_number == context->run.iso.number)
    {
      return &fill->lines[i];
    }
  }
  return NULL;
}

static mcor_status mcor_take_vertices(mcor_context* context, mcor_fill_line* line)
{
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)mesh->march_count, cuts = (size_t)(mesh->vertex_count - (int)n),
               real = context->cl.real_size;
  line->offset = malloc(n * sizeof *line->offset);
  line->margin = malloc(n * sizeof *line->margin);
  line->cuts = malloc(cuts * sizeof *line->cuts + 1);
  line->number = malloc((n + cuts) * sizeof *line->number);
  MCOR_TRY(mcor_allocated(context, line->offset && line->margin && line->cuts && line->number));
  memset(line->number, 0xff, (n + cuts) * sizeof *line->number);
  line->vertex_count = (int)n;
  line->cut_count = (int)cuts;
  if (cuts > 0)
  {
    MCOR_TRY(
      mcor_read(context, &context->mesh.cut_edges, 0, line->cuts, cuts * sizeof *line->cuts));
  }
  void *node = NULL, *offset = NULL, *quantity = NULL;
  const mcor_mapping mappings[] = { { &mesh->node, n * 4 * sizeof(cl_int), &node },
    { &mesh->offset, n * 4 * real, &offset },
    { mcor_trim_quantity(context), n * real, &quantity } };
  const int count = mcor_is_trimmed(context) ? 3 : 2;
  mcor_status status = mcor_map_all(context, mappings, count);
  const double threshold = mcor_real_of(context, mcor_trim_threshold(context));
  for (int v = 0; v < line->vertex_count && status == MCOR_OK; ++v)
  {
    const cl_int *at = (const cl_int*)node + 4 * (size_t)v, axis = at[3] & 3;
    const cl_int edge[3] = { at[0], at[1], axis };
    line->offset[v] = mcor_get_real(context, offset, 4 * (int64_t)v + axis);
    line->margin[v] = quantity ? mcor_get_real(context, quantity, v) - threshold : INFINITY;
    status = mcor_allocated(context, mcor_table_number(&line->edges, mcor_cap_key(edge), v) >= 0);
  }
  return mcor_unmap_all(context, mappings, count, status);
}

/* Adds 1 to the band of each node that is above this iso value. If marching has evaluated a node,
 * marching decides, because the lines are made from its results. */
mcor_status mcor_take_lines(mcor_context* context)
{
  mcor_filling* fill = context->run.fill;
  mcor_fill_line* line = mcor_line_under_way(context);
  if (!line)
  {
    return MCOR_OK;
  }
  if (context->mesh.march_count > 0)
  {
    MCOR_TRY(mcor_take_vertices(context, line));
  }
  mcor_cap_nodes* nodes = &fill->nodes;
  for (int64_t b = 0; b < nodes->bricks.count; ++b)
  {
    mcor_cap_brick* brick = &nodes->bricks.of[b];
    brick->is_known = false;
    brick->joined[2] = 0;
  }
  MCOR_TRY(mcor_take_cap_masks(context, nodes));
  for (int64_t n = MCOR_SIDE_NODES; n < nodes->node_count; ++n)
  {
    const mcor_cap_brick* brick = &nodes->bricks.of[n / MCOR_SIDE_NODES];
    const int bit = (int)(n % MCOR_SIDE_NODES);
    const bool above = brick->above >> bit & 1, joined = brick->joined[2] >> bit & 1;
    fill->band[n] += brick->is_known ? above : fill->value[n] >= line->iso;
    MCOR_TRY(
      mcor_allocated(context, !joined || mcor_table_number(&line->joined, (uint64_t)n, 0) >= 0));
  }
  return MCOR_OK;
}

void mcor_number_lines(mcor_context* context, const cl_int* scanned, int64_t base)
{
  mcor_fill_line* line = mcor_line_under_way(context);
  for (int v = 0; line && v < line->vertex_count + line->cut_count; ++v)
  {
    line->number[v] = mcor_is_output(scanned, v) ? (int32_t)(base + scanned[v]) : -1;
  }
}

void mcor_end_fill(mcor_context* context)
{
  mcor_filling* fill = context->run.fill;
  for (int i = 0; fill && i < fill->line_count; ++i)
  {
    mcor_fill_line* line = &fill->lines[i];
    mcor_table_free(&line->edges);
    mcor_table_free(&line->joined);
    free(line->offset);
    free(line->margin);
    free(line->cuts);
    free(line->number);
  }
  if (fill)
  {
    mcor_free_cap_nodes(&fill->nodes);
    mcor_free_cap_job(&fill->cap);
    free(fill->lines);
    free(fill->value);
    free(fill->band);
    free(fill->number);
    free(fill->triangles.of);
  }
  free(fill);
  context->run.fill = NULL;
}
