/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Between which iso values nodes are, whether they are valid, and how far inside of what trimming leaves.
 * Where marching has evaluated them its answer is taken, as lines are made of it. */

#include "mcor_fill.h"

#include <stdlib.h>
#include <string.h>

/* Points evaluated at a time. */
#define MCOR_FILL_BATCH (1 << 18)

/* ---- Values ---- */

/* Nodes to be evaluated at once, and where they go. */
typedef struct mcor_fill_batch
{
  cl_int* nodes; /* [room][4] */
  int64_t* to;   /* [room] */
  int count;
  mcor_cap_points points;
} mcor_fill_batch;

/* Adds those of tile t, by 4 x 4 of them, which are near each other. */
static void mcor_add_tile(const mcor_cap_face* face, int t, mcor_fill_batch* batch)
{
  const int u0 = face->place[t] % face->tiles[0] * MCOR_CAP_TILE,
            v0 = face->place[t] / face->tiles[0] * MCOR_CAP_TILE;
  for (int n = 0; n < MCOR_CAP_TILE * MCOR_CAP_TILE; ++n)
  {
    const int u = u0 + (n & 3) + (n >> 4 & 3) * 4, v = v0 + (n >> 2 & 3) + (n >> 6) * 4;
    if (u < face->count[0] && v < face->count[1])
    {
      const cl_int node[4] = { face->first[0] + u, face->first[1] + v, 0, 0 };
      memcpy(batch->nodes + 4 * (size_t)batch->count, node, sizeof node);
      batch->to[batch->count++] = mcor_cap_index(face, u, v);
    }
  }
}

static mcor_status mcor_evaluate_batch(
  mcor_context* context, mcor_fill_batch* batch, double* values, mcor_cap_face* face)
{
  mcor_cap_values v = { NULL };
  if (batch->count == 0)
  {
    return MCOR_OK;
  }
  mcor_status status =
    mcor_evaluate_cap_points(context, batch->nodes, NULL, batch->count, 0, &batch->points, &v);
  for (int i = 0; i < batch->count && status == MCOR_OK; ++i)
  {
    const int64_t to = batch->to[i];
    values[to] = mcor_get_real(context, v.value, i);
    face->margin[to] = mcor_cap_margin(context, &v, i);
    face->state[to] = mcor_cap_is_valid(context, &v, i) ? MCOR_CAP_VALID : 0;
  }
  const mcor_status ended = mcor_unmap_cap_values(context, &batch->points, &v);
  batch->count = 0;
  status = status == MCOR_OK ? ended : status;
  return status == MCOR_OK ? mcor_report_launch(context) : status;
}

static mcor_status mcor_evaluate_tiles(mcor_context* context, double* values, mcor_cap_face* face)
{
  const size_t most = (size_t)face->tile_count * MCOR_CAP_TILE * MCOR_CAP_TILE;
  const size_t room =
    (most < MCOR_FILL_BATCH ? most : MCOR_FILL_BATCH) + MCOR_CAP_TILE * MCOR_CAP_TILE;
  mcor_fill_batch batch = { .nodes = malloc(room * 4 * sizeof(cl_int)),
    .to = malloc(room * sizeof(int64_t)) };
  mcor_status status = mcor_allocated(context, batch.nodes && batch.to);
  for (int t = 1; t <= face->tile_count && status == MCOR_OK; ++t)
  {
    mcor_add_tile(face, t, &batch);
    if (batch.count >= MCOR_FILL_BATCH || t == face->tile_count)
    {
      status = mcor_evaluate_batch(context, &batch, values, face);
    }
  }
  mcor_release_cap_points(context, &batch.points);
  free(batch.nodes);
  free(batch.to);
  return status;
}

/* ---- Bands ---- */

static void mcor_count_levels(mcor_filling* fill, const double* values)
{
  for (int64_t n = MCOR_CAP_TILE * MCOR_CAP_TILE; n < fill->node_count; ++n)
  {
    for (int k = 0; k < fill->level_count && values[n] >= fill->lines[fill->levels[k]].iso; ++k)
    {
      ++fill->band[n];
    }
  }
}

/* What marching has found of one iso value. */
static void mcor_take_signs(const mcor_fill_line* line, const double* values, mcor_filling* fill)
{
  const mcor_cap_face* face = &fill->face;
  for (int b = 0; b < line->brick_count; ++b)
  {
    const mcor_fill_brick* brick = &line->bricks[b];
    for (int n = 0; n < 16; ++n)
    {
      const int u = brick->x * MCOR_BRICK + (n & 3) - face->first[0],
                v = brick->y * MCOR_BRICK + (n >> 2) - face->first[1];
      if (!(brick->known >> n & 1) || u < 0 || u >= face->count[0] || v < 0 || v >= face->count[1])
      {
        continue;
      }
      const int64_t node = mcor_cap_index(face, u, v);
      if (node >= MCOR_CAP_TILE * MCOR_CAP_TILE)
      {
        fill->band[node] += (brick->above >> n & 1) - (values[node] >= line->iso);
        face->state[node] = brick->valid >> n & 1 ? MCOR_CAP_VALID : 0;
      }
    }
  }
}

mcor_status mcor_find_bands(mcor_context* context, mcor_filling* fill)
{
  mcor_cap_face* face = &fill->face;
  MCOR_TRY(mcor_make_cap_nodes(context, face));
  const size_t nodes = ((size_t)face->tile_count + 1) * MCOR_CAP_TILE * MCOR_CAP_TILE;
  fill->node_count = (int64_t)nodes;
  fill->band = calloc(nodes, sizeof *fill->band);
  double* values = malloc(nodes * sizeof *values);
  mcor_status status = mcor_allocated(context, fill->band && values);
  status = status == MCOR_OK ? mcor_evaluate_tiles(context, values, face) : status;
  if (status == MCOR_OK)
  {
    mcor_count_levels(fill, values);
    for (int k = 0; k < fill->level_count; ++k)
    {
      mcor_take_signs(&fill->lines[fill->levels[k]], values, fill);
    }
  }
  free(values);
  return status;
}
