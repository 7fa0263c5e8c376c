/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adds the filled region to the surface: its triangles, and the points that no line has. */

#include "mcor_box.h"
#include "mcor_fill.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_FILL_STEPS 10 /* evaluations of a cut */

/* ---- Cuts ---- */

/* Chooses the next place of a cut: where a linear margin would be 0; the middle where that would
 * not halve the bracket. */
static double mcor_next_place(const mcor_fill_cut* cut, bool halve)
{
  const double s = cut->inside_margin / (cut->inside_margin - cut->outside_margin);
  const double part = halve || !(s >= 0 && s <= 1)
    ? 0.5
    : fmin(fmax(s, MCOR_CAP_CUT_MARGIN), 1 - MCOR_CAP_CUT_MARGIN);
  return cut->inside + part * (cut->outside - cut->inside);
}

/* Narrows the bracket of a cut by the margin found. The margin of an end that stays twice is
 * halved, so that it does not stay for ever (the Illinois method). */
static void mcor_narrow_cut(
  const mcor_context* context, const mcor_cap_points* points, int64_t i, void* data)
{
  mcor_fill_cut* cut = &((mcor_filling*)data)->cuts[points->to[i]];
  const double at = mcor_get_real(context, points->offset, 4 * i + cut->axis);
  const double margin = mcor_cap_margin(context, points, i);
  const bool inside = margin > 0;
  if (fabs(margin) < fabs(cut->margin))
  {
    cut->at = at;
    cut->margin = margin;
  }
  *(inside ? &cut->inside : &cut->outside) = at;
  *(inside ? &cut->inside_margin : &cut->outside_margin) = margin;
  *(inside ? &cut->outside_margin : &cut->inside_margin) *= cut->last == inside ? 0.5 : 1;
  cut->last = inside;
}

static int mcor_compare_cuts(const void* x, const void* y)
{
  const mcor_fill_cut *a = x, *b = y;
  const int first = (a->key[0] > b->key[0]) - (a->key[0] < b->key[0]);
  return first ? first : (a->key[1] > b->key[1]) - (a->key[1] < b->key[1]);
}

/* Sorts the cuts, and moves them to where the margin is 0; in a preview, to the linear estimate. */
static mcor_status mcor_place_fill_cuts(mcor_context* context, mcor_filling* fill)
{
  mcor_cap_points points = { .take = mcor_narrow_cut, .data = fill };
  mcor_status status = MCOR_OK;
  if (fill->cut_count > 0)
  {
    qsort(fill->cuts, (size_t)fill->cut_count, sizeof *fill->cuts, mcor_compare_cuts);
  }
  for (int64_t i = 0; i < fill->cut_count; ++i)
  {
    fill->cuts[i].at = mcor_next_place(&fill->cuts[i], false);
  }
  const int steps = context->run.options->preview ? 0 : MCOR_FILL_STEPS;
  for (int step = 0; step < steps && status == MCOR_OK; ++step)
  {
    for (int64_t i = 0; i < fill->cut_count && status == MCOR_OK; ++i)
    {
      const mcor_fill_cut* cut = &fill->cuts[i];
      double offset[3] = { 0, 0, 0 };
      offset[cut->axis] = mcor_next_place(cut, step == 4);
      status = mcor_add_cap_point(context, &points, cut->node, offset, i);
    }
    status = status == MCOR_OK ? mcor_take_cap_points(context, &points) : status;
  }
  mcor_free_cap_points(context, &points);
  return status;
}

/* ---- Points ---- */

/* Marks the nodes that triangles use with 0, and returns their number. */
static int64_t mcor_mark_nodes(const mcor_filling* fill)
{
  int32_t* number = fill->number;
  int64_t count = 0;
  for (int64_t i = 0; i < 3 * fill->triangle_count; ++i)
  {
    const int32_t ref = fill->triangles[i / 3].corner[i % 3];
    if (ref >= 0 && ref < fill->face.node_count && number[ref] < 0)
    {
      number[ref] = 0;
      ++count;
    }
  }
  return count;
}

/* Lists the marked nodes, by squares of 4 x 4, and numbers them. */
static void mcor_list_nodes(const mcor_filling* fill, int64_t base, mcor_cap_vertex* vertex)
{
  int32_t* number = fill->number;
  const mcor_cap_face* face = &fill->face;
  const int *first = face->first, *size = face->count;
  for (int v = first[1] >> 2; v <= (first[1] + size[1] - 1) >> 2; ++v)
  {
    for (int u = first[0] >> 2; u <= (first[0] + size[0] - 1) >> 2; ++u)
    {
      for (int n = 0; n < 16; ++n)
      {
        const int x = 4 * u + (n & 3) - first[0], y = 4 * v + (n >> 2) - first[1];
        const bool within = x >= 0 && x < size[0] && y >= 0 && y < size[1];
        const int64_t node = within ? mcor_cap_index(face, x, y) : 0;
        if (number[node] == 0)
        {
          number[node] = (int32_t)base++;
          *vertex = (mcor_cap_vertex){ .node = { first[0] + x, first[1] + y, 0 },
            .band = fill->band[node],
            .flag = MCOR_CAP_FLAG };
          vertex->key[0] = mcor_fill_node_key(vertex->node);
          ++vertex;
        }
      }
    }
  }
}

/* Lists the cuts and numbers them. */
static void mcor_list_cuts(const mcor_filling* fill, int64_t base, mcor_cap_vertex* vertices)
{
  for (int64_t i = 0; i < fill->cut_count; ++i)
  {
    const mcor_fill_cut* cut = &fill->cuts[i];
    vertices[i] = (mcor_cap_vertex){ .node = { cut->node[0], cut->node[1], 0 },
      .band = cut->band,
      .key = { cut->key[0], cut->key[1] },
      .flag = fabs(cut->margin) < MCOR_CAP_ROOT ? 1 : 2 };
    vertices[i].offset[cut->axis] = cut->at;
    fill->number[fill->face.node_count + cut->index] = (int32_t)(base + i);
  }
}

/* Appends vertices to the surface, as a mesh that consists of them alone, all like those of
 * caps. */
static mcor_status mcor_append_fill_points(mcor_context* context, const mcor_input* input,
  const mcor_cap_vertex* vertices, int64_t count, mcor_surface* surface)
{
  mcor_mesh* mesh = &context->mesh;
  mesh->march_count = mesh->vertex_count = mesh->cap_first = mesh->triangle_count = 0;
  context->run.iso = (mcor_iso){ .number = context->run.options->iso_count };
  MCOR_TRY(mcor_load_attributes(context, input, 0));
  MCOR_TRY(mcor_reserve_vertices(context, (int)count));
  MCOR_TRY(mcor_append_cap_vertices(context, vertices, count));
  mcor_release(context, &context->attributes.sorted);
  return mcor_append_output(context, input, true, surface);
}

/* Sets the iso values and residuals of the points to those of their bands. */
static void mcor_set_bands(
  const mcor_filling* fill, const mcor_cap_vertex* vertices, int64_t base, mcor_surface* surface)
{
  for (int64_t i = base; i < surface->point_count; ++i)
  {
    const mcor_fill_line* line = &fill->lines[vertices[i - base].band - 1];
    if (surface->iso_value)
    {
      surface->iso_value[i] = line->value;
    }
    if (surface->residual)
    {
      surface->residual[i] = (float)(surface->residual[i] - line->iso);
    }
  }
}

/* Makes the points that lines lack, and numbers them in the surface. */
static mcor_status mcor_make_fill_points(
  mcor_context* context, mcor_filling* fill, const mcor_input* input, mcor_surface* surface)
{
  const size_t refs = (size_t)(fill->face.node_count + fill->cut_count);
  fill->number = malloc(refs * sizeof *fill->number);
  MCOR_TRY(mcor_allocated(context, fill->number));
  memset(fill->number, 0xff, refs * sizeof *fill->number);
  const int64_t base = surface->point_count, nodes = mcor_mark_nodes(fill),
                count = nodes + fill->cut_count;
  MCOR_RETURN_IF(count > MCOR_COUNT_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    "The filled region would have %lld points; the limit is %d. Use a larger cube size.",
    (long long)count, MCOR_COUNT_LIMIT);
  MCOR_RETURN_IF(base + count > INT32_MAX, context, MCOR_OUT_OF_CAPACITY,
    "The surface would have %lld points; the limit is %d. Use a larger cube size.",
    (long long)(base + count), INT32_MAX);
  if (count == 0)
  {
    return MCOR_OK;
  }
  mcor_cap_vertex* vertices = malloc((size_t)count * sizeof *vertices);
  MCOR_TRY(mcor_allocated(context, vertices));
  mcor_list_nodes(fill, base, vertices);
  mcor_list_cuts(fill, base + nodes, vertices + nodes);
  const mcor_status status = mcor_append_fill_points(context, input, vertices, count, surface);
  if (status == MCOR_OK)
  {
    mcor_set_bands(fill, vertices, base, surface);
  }
  free(vertices);
  return status;
}

/* ---- Triangles ---- */

static mcor_status mcor_append_fill_triangles(
  mcor_context* context, const mcor_filling* fill, mcor_surface* surface)
{
  const int64_t first = surface->triangle_count, count = fill->triangle_count;
  MCOR_TRY(mcor_grow(context, (void**)&surface->triangles, first, count, 3 * sizeof(int32_t)));
  MCOR_TRY(mcor_grow(context, (void**)&surface->band_value, 0, count, sizeof(double)));
  MCOR_TRY(mcor_extend_kept(context, count, surface));
  for (int64_t t = 0; t < count; ++t)
  {
    const mcor_fill_triangle* from = &fill->triangles[t];
    for (int c = 0; c < 3; ++c)
    {
      const int32_t ref = from->corner[c];
      surface->triangles[3 * (first + t) + c] = ref < 0 ? -1 - ref : fill->number[ref];
    }
    surface->band_value[t] = fill->lines[from->band - 1].value;
    if (context->box.kept)
    {
      context->box.kept[first + t] = 1;
    }
    if (surface->triangle_keys)
    {
      uint64_t* key = surface->triangle_keys + MCOR_TRIANGLE_KEY * (first + t);
      key[0] = (uint64_t)context->run.options->iso_count;
      key[1] = from->square;
    }
  }
  surface->triangle_count += count;
  return MCOR_OK;
}

mcor_status mcor_fill_lines(mcor_context* context, const mcor_input* input, mcor_surface* surface)
{
  mcor_filling* fill = context->run.fill;
  if (!fill)
  {
    return MCOR_OK;
  }
  free(fill->value); /* the bands are known */
  fill->value = NULL;
  MCOR_TRY(mcor_fill_squares(context, fill));
  MCOR_TRY(mcor_place_fill_cuts(context, fill));
  MCOR_TRY(mcor_make_fill_points(context, fill, input, surface));
  return mcor_append_fill_triangles(context, fill, surface);
}
