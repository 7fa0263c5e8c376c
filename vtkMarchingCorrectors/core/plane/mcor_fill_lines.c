/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* What filling keeps of each iso value's lines. */

#include "mcor_box.h"
#include "mcor_fill.h"

#include <stdlib.h>
#include <string.h>

/* All nodes of the box's squares. */
static void mcor_set_fill_extent(const mcor_context* context, mcor_cap_face* face)
{
  const mcor_box* box = &context->box;
  *face = (mcor_cap_face){ .axis = 2, .across = { 0, 1 } };
  for (int a = 0; a < 2; ++a)
  {
    face->first[a] = box->first[a];
    face->count[a] = box->last[a] - box->first[a] + 1;
    face->tiles[a] = (face->count[a] - 1) / MCOR_CAP_TILE + 1;
  }
}

mcor_status mcor_begin_fill(mcor_context* context)
{
  const int count = context->run.options->iso_count;
  if (!context->run.options->filled || context->box.is_empty)
  {
    return MCOR_OK;
  }
  context->run.fill = calloc(1, sizeof *context->run.fill);
  if (context->run.fill)
  {
    context->run.fill->lines = calloc((size_t)count, sizeof *context->run.fill->lines);
    context->run.fill->levels = malloc((size_t)count * sizeof *context->run.fill->levels);
    context->run.fill->line_count = context->run.fill->lines ? count : 0;
  }
  MCOR_TRY(mcor_allocated(
    context, context->run.fill && context->run.fill->lines && context->run.fill->levels));
  mcor_set_fill_extent(context, &context->run.fill->face);
  return mcor_note_cap_tiles(context, 1, &context->run.fill->face);
}

/* Views of vertices. */
enum
{
  MCOR_FILL_NODE,
  MCOR_FILL_OFFSET,
  MCOR_FILL_QUANTITY
};

static mcor_status mcor_take_fill_vertices(
  mcor_context* context, void* const views[], mcor_fill_line* line)
{
  const double threshold = mcor_real_of(context, mcor_trim_threshold(context));
  for (int v = 0; v < line->vertex_count; ++v)
  {
    const cl_int* node = (const cl_int*)views[MCOR_FILL_NODE] + 4 * (size_t)v;
    const int axis = node[3] & 3;
    line->offset[v] = mcor_get_real(context, views[MCOR_FILL_OFFSET], 4 * (int64_t)v + axis);
    line->margin[v] = mcor_is_trimmed(context)
      ? mcor_get_real(context, views[MCOR_FILL_QUANTITY], v) - threshold
      : INFINITY;
    MCOR_TRY(mcor_allocated(
      context, mcor_table_number(&line->edges, mcor_fill_key(node[0], node[1], axis), v) >= 0));
  }
  return MCOR_OK;
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
  MCOR_TRY(cuts > 0
      ? mcor_read(context, &context->trim.distinct, 0, line->cuts, cuts * sizeof *line->cuts)
      : MCOR_OK);
  void* views[3] = { NULL };
  const mcor_mapping mappings[] = { [MCOR_FILL_NODE] = { &mesh->node, n * 4 * sizeof(cl_int),
                                      &views[MCOR_FILL_NODE] },
    [MCOR_FILL_OFFSET] = { &mesh->offset, n * 4 * real, &views[MCOR_FILL_OFFSET] },
    [MCOR_FILL_QUANTITY] = { mcor_trim_quantity(context), n * real, &views[MCOR_FILL_QUANTITY] } };
  const int count = mcor_is_trimmed(context) ? 3 : 2;
  mcor_status status = mcor_map_all(context, mappings, count);
  status = status == MCOR_OK ? mcor_take_fill_vertices(context, views, line) : status;
  return mcor_unmap_all(context, mappings, count, status);
}

/* Of the lowest layer of bricks. */
static mcor_status mcor_take_fill_bricks(
  mcor_context* context, void* const views[MCOR_BRICK_VIEWS], void* data)
{
  mcor_fill_line* line = data;
  const cl_ulong *known = views[MCOR_VIEW_KNOWN], *above = views[MCOR_VIEW_ABOVE],
                 *valid = views[MCOR_VIEW_VALID], *decisions = views[MCOR_VIEW_DECISIONS];
  line->bricks = malloc((size_t)context->bricks.now.count * sizeof *line->bricks);
  MCOR_TRY(mcor_allocated(context, line->bricks));
  for (int slot = 0; slot < context->bricks.now.count; ++slot)
  {
    const cl_int* at = (const cl_int*)views[MCOR_VIEW_BRICKS] + 4 * (size_t)slot;
    const cl_ulong joined =
      decisions ? decisions[(size_t)slot * MCOR_DECISION_MASKS + 2] & 0xffff : 0;
    if (at[2] != 0)
    {
      continue;
    }
    line->bricks[line->brick_count++] = (mcor_fill_brick){ .x = at[0],
      .y = at[1],
      .known = (uint16_t)known[slot],
      .above = (uint16_t)above[slot],
      .valid = (uint16_t)valid[slot] };
    for (int n = 0; n < 16; ++n)
    {
      const uint64_t key =
        mcor_fill_key(at[0] * MCOR_BRICK + (n & 3), at[1] * MCOR_BRICK + (n >> 2), 0);
      MCOR_TRY(mcor_allocated(
        context, !(joined >> n & 1) || mcor_table_number(&line->joined, key, 0) >= 0));
    }
  }
  return MCOR_OK;
}

mcor_status mcor_take_lines(mcor_context* context, double iso)
{
  if (!context->run.fill)
  {
    return MCOR_OK;
  }
  mcor_fill_line* line = &context->run.fill->lines[context->run.iso_number];
  line->iso = mcor_real_of(context, iso);
  line->value = context->run.options->iso_values[context->run.iso_number];
  MCOR_TRY(context->mesh.march_count > 0 ? mcor_take_vertices(context, line) : MCOR_OK);
  return mcor_see_bricks(context, mcor_take_fill_bricks, line);
}

void mcor_number_lines(mcor_context* context, const cl_int* scanned, int64_t base)
{
  mcor_fill_line* line =
    context->run.fill ? &context->run.fill->lines[context->run.iso_number] : NULL;
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
    free(line->bricks);
    free(line->offset);
    free(line->margin);
    free(line->cuts);
    free(line->number);
  }
  if (fill)
  {
    mcor_free_cap_face(&fill->face);
    mcor_table_free(&fill->cut_of);
    free(fill->lines);
    free(fill->levels);
    free(fill->band);
    free(fill->number);
    free(fill->cuts);
    free(fill->cut_number);
    free(fill->triangles);
  }
  free(fill);
  context->run.fill = NULL;
}
