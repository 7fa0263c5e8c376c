/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* What filling keeps of each iso value's lines. */

#include "mcor_fill.h"

#include <stdlib.h>
#include <string.h>

static mcor_status mcor_begin_fill(mcor_context* context)
{
  const int count = context->run.options->iso_count;
  if (context->run.fill)
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
  return context->run.fill && context->run.fill->lines && context->run.fill->levels
    ? MCOR_OK
    : mcor_no_fill_memory(context);
}

/* Views of vertices, and of bricks. */
enum
{
  MCOR_FILL_NODE,
  MCOR_FILL_OFFSET,
  MCOR_FILL_QUANTITY,
  MCOR_FILL_BRICKS = 0,
  MCOR_FILL_KNOWN,
  MCOR_FILL_ABOVE,
  MCOR_FILL_VALID,
  MCOR_FILL_DECISIONS,
  MCOR_FILL_VIEWS
};

typedef struct mcor_fill_view
{
  const mcor_buffer* buffer;
  size_t bytes;
  void* data;
} mcor_fill_view;

static mcor_status mcor_take_views(mcor_context* context, mcor_fill_view* views, int count,
  mcor_fill_line* line,
  mcor_status (*take)(mcor_context* context, const mcor_fill_view* views, mcor_fill_line* line))
{
  mcor_status status = MCOR_OK;
  for (int i = 0; i < count && status == MCOR_OK; ++i)
  {
    status = mcor_map(context, views[i].buffer, views[i].bytes, false, &views[i].data);
  }
  status = status == MCOR_OK ? take(context, views, line) : status;
  for (int i = 0; i < count; ++i)
  {
    const mcor_status unmapped = mcor_unmap(context, views[i].buffer, &views[i].data);
    status = status == MCOR_OK ? unmapped : status;
  }
  return status;
}

static mcor_status mcor_take_fill_vertices(
  mcor_context* context, const mcor_fill_view* views, mcor_fill_line* line)
{
  const double threshold = mcor_real_of(context, mcor_trim_threshold(context));
  for (int v = 0; v < line->vertex_count; ++v)
  {
    const cl_int* node = (const cl_int*)views[MCOR_FILL_NODE].data + 4 * (size_t)v;
    const int axis = node[3] & 3;
    line->offset[v] = mcor_get_real(context, views[MCOR_FILL_OFFSET].data, 4 * (int64_t)v + axis);
    line->margin[v] = mcor_is_trimmed(context)
      ? mcor_get_real(context, views[MCOR_FILL_QUANTITY].data, v) - threshold
      : INFINITY;
    if (mcor_cap_number(&line->edges, mcor_fill_key(node[0], node[1], axis), v) < 0)
    {
      return mcor_no_fill_memory(context);
    }
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
  if (!line->offset || !line->margin || !line->cuts || !line->number)
  {
    return mcor_no_fill_memory(context);
  }
  memset(line->number, 0xff, (n + cuts) * sizeof *line->number);
  line->vertex_count = (int)n;
  line->cut_count = (int)cuts;
  MCOR_TRY(cuts > 0
      ? mcor_read(context, &context->trim.distinct, 0, line->cuts, cuts * sizeof *line->cuts)
      : MCOR_OK);
  mcor_fill_view views[] = { { .buffer = &mesh->node, .bytes = n * 4 * sizeof(cl_int) },
    { .buffer = &mesh->offset, .bytes = n * 4 * real },
    { .buffer = mcor_trim_quantity(context), .bytes = n * real } };
  return mcor_take_views(
    context, views, mcor_is_trimmed(context) ? 3 : 2, line, mcor_take_fill_vertices);
}

/* Of the lowest layer of bricks. */
static mcor_status mcor_take_fill_bricks(
  mcor_context* context, const mcor_fill_view* views, mcor_fill_line* line)
{
  for (int slot = 0; slot < context->bricks.now.count; ++slot)
  {
    const cl_int* at = (const cl_int*)views[MCOR_FILL_BRICKS].data + 4 * (size_t)slot;
    const cl_ulong* decisions = views[MCOR_FILL_DECISIONS].data;
    const cl_ulong joined =
      decisions ? decisions[(size_t)slot * MCOR_DECISION_MASKS + 2] & 0xffff : 0;
    if (at[2] != 0)
    {
      continue;
    }
    line->bricks[line->brick_count++] = (mcor_fill_brick){ .x = at[0],
      .y = at[1],
      .known = (uint16_t)((const cl_ulong*)views[MCOR_FILL_KNOWN].data)[slot],
      .above = (uint16_t)((const cl_ulong*)views[MCOR_FILL_ABOVE].data)[slot],
      .valid = (uint16_t)((const cl_ulong*)views[MCOR_FILL_VALID].data)[slot] };
    for (int n = 0; n < 16; ++n)
    {
      const uint64_t key =
        mcor_fill_key(at[0] * MCOR_BRICK + (n & 3), at[1] * MCOR_BRICK + (n >> 2), 0);
      if (joined >> n & 1 && mcor_cap_number(&line->joined, key, 0) < 0)
      {
        return mcor_no_fill_memory(context);
      }
    }
  }
  return MCOR_OK;
}

static mcor_status mcor_take_bricks(mcor_context* context, mcor_fill_line* line)
{
  const mcor_brick_data* now = &context->bricks.now;
  const size_t n = (size_t)now->count;
  line->bricks = malloc(n * sizeof *line->bricks);
  mcor_fill_view views[MCOR_FILL_VIEWS] = {
    { .buffer = &now->bricks, .bytes = 4 * n * sizeof(cl_int) },
    { .buffer = &now->known, .bytes = n * sizeof(cl_ulong) },
    { .buffer = &now->above, .bytes = n * sizeof(cl_ulong) },
    { .buffer = &now->valid, .bytes = n * sizeof(cl_ulong) },
    { .buffer = &context->topology.decisions, .bytes = n * MCOR_DECISION_MASKS * sizeof(cl_ulong) }
  };
  return line->bricks ? mcor_take_views(context, views,
                          mcor_is_resolved(context) ? MCOR_FILL_VIEWS : MCOR_FILL_DECISIONS, line,
                          mcor_take_fill_bricks)
                      : mcor_no_fill_memory(context);
}

mcor_status mcor_take_lines(mcor_context* context, double iso)
{
  if (!context->run.options->filled)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_begin_fill(context));
  mcor_fill_line* line = &context->run.fill->lines[context->run.iso_number];
  line->iso = mcor_real_of(context, iso);
  line->value = context->run.options->iso_values[context->run.iso_number];
  MCOR_TRY(context->mesh.march_count > 0 ? mcor_take_vertices(context, line) : MCOR_OK);
  return context->bricks.now.count > 0 ? mcor_take_bricks(context, line) : MCOR_OK;
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
    mcor_free_cap_map(&line->edges);
    mcor_free_cap_map(&line->joined);
    free(line->bricks);
    free(line->offset);
    free(line->margin);
    free(line->cuts);
    free(line->number);
  }
  if (fill)
  {
    mcor_free_cap_face(&fill->face);
    mcor_free_cap_map(&fill->cut_of);
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
