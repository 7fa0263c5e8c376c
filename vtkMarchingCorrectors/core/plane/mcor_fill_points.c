/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* What is filled as part of the surface: points that lines have not, and triangles. */

#include "mcor_box.h"
#include "mcor_fill.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Evaluations of a cut; it keeps off the ends of its part of an edge; how near to 0 a margin is a root. */
#define MCOR_FILL_STEPS 10
#define MCOR_FILL_CUT_MARGIN 1e-5
#define MCOR_FILL_ROOT 2e-5

/* Reals of the device for some points, and their nodes. */
typedef struct mcor_fill_places
{
  cl_int* node;    /* [count][4] */
  uint8_t* offset; /* [count][4] */
} mcor_fill_places;

static bool mcor_make_places(const mcor_context* context, size_t count, mcor_fill_places* places)
{
  places->node = calloc(count + 1, 4 * sizeof *places->node);
  places->offset = calloc(count + 1, 4 * context->cl.real_size);
  return places->node && places->offset;
}

static void mcor_free_places(mcor_fill_places* places)
{
  free(places->node);
  free(places->offset);
}

/* Point i, `along` of an edge beyond node (u, v). */
static void mcor_set_place(const mcor_context* context, mcor_fill_places* places, int64_t i,
  cl_int u, cl_int v, int axis, double along)
{
  const float single = (float)along;
  const size_t real = context->cl.real_size;
  places->node[4 * i] = u;
  places->node[4 * i + 1] = v;
  memcpy(places->offset + (size_t)(4 * i + axis) * real,
    real == sizeof single ? (const void*)&single : (const void*)&along, real);
}

/* ---- Cuts ---- */

/* Where the margin would be 0 were it linear; where that does not halve what is between, the middle. */
static double mcor_next_place(const mcor_fill_cut* cut, bool halve)
{
  const double s = cut->inside_margin / (cut->inside_margin - cut->outside_margin);
  const double part = halve || !(s >= 0 && s <= 1)
    ? 0.5
    : fmin(fmax(s, MCOR_FILL_CUT_MARGIN), 1 - MCOR_FILL_CUT_MARGIN);
  return cut->inside + part * (cut->outside - cut->inside);
}

/* The margin at `at` narrows the part of the edge that a cut is on; of the end that stays twice it is taken
 * for half of what it is, so that it does not stay for ever. */
static void mcor_narrow_cut(mcor_fill_cut* cut, double at, double margin, int* side)
{
  const bool inside = margin > 0;
  if (fabs(margin) < fabs(cut->margin))
  {
    cut->at = at;
    cut->margin = margin;
  }
  if (inside)
  {
    cut->inside = at;
    cut->inside_margin = margin;
    cut->outside_margin *= *side == 1 ? 0.5 : 1;
  }
  else
  {
    cut->outside = at;
    cut->outside_margin = margin;
    cut->inside_margin *= *side == 0 ? 0.5 : 1;
  }
  *side = inside;
}

static mcor_status mcor_step_cuts(mcor_context* context, mcor_filling* fill, int step,
  mcor_fill_places* places, mcor_cap_points* points, int* sides)
{
  mcor_cap_values v = { NULL };
  for (int64_t i = 0; i < fill->cut_count; ++i)
  {
    const mcor_fill_cut* cut = &fill->cuts[i];
    mcor_set_place(context, places, i, cut->u, cut->v, cut->axis, mcor_next_place(cut, step == 4));
  }
  mcor_status status = mcor_evaluate_cap_points(
    context, places->node, places->offset, (int)fill->cut_count, 0, points, &v);
  for (int64_t i = 0; i < fill->cut_count && status == MCOR_OK; ++i)
  {
    mcor_fill_cut* cut = &fill->cuts[i];
    const double at = mcor_get_real(context, places->offset, 4 * i + cut->axis);
    mcor_narrow_cut(cut, at, mcor_cap_margin(context, &v, i), &sides[i]);
  }
  const mcor_status ended = mcor_unmap_cap_values(context, points, &v);
  status = status == MCOR_OK ? ended : status;
  return status == MCOR_OK ? mcor_report_launch(context) : status;
}

static int mcor_compare_cuts(const void* x, const void* y)
{
  const mcor_fill_cut *a = x, *b = y;
  const int first = (a->key[0] > b->key[0]) - (a->key[0] < b->key[0]);
  return first ? first : (a->key[1] > b->key[1]) - (a->key[1] < b->key[1]);
}

/* Moves cuts to where the margin is 0, and puts them in order; of a preview, to where it would be. */
static mcor_status mcor_place_fill_cuts(mcor_context* context, mcor_filling* fill)
{
  const size_t n = (size_t)fill->cut_count;
  if (n == 0)
  {
    return MCOR_OK;
  }
  qsort(fill->cuts, n, sizeof *fill->cuts, mcor_compare_cuts);
  for (size_t i = 0; i < n; ++i)
  {
    fill->cuts[i].at = mcor_next_place(&fill->cuts[i], false);
    fill->cuts[i].margin = INFINITY;
  }
  mcor_fill_places places = { NULL };
  mcor_cap_points points = { .node = { 0 } };
  int* sides = malloc(n * sizeof *sides);
  mcor_status status = mcor_allocated(context, mcor_make_places(context, n, &places) && sides);
  for (size_t i = 0; i < n && sides; ++i)
  {
    sides[i] = -1;
  }
  for (int step = 0; step < MCOR_FILL_STEPS && !context->run.options->preview && status == MCOR_OK;
       ++step)
  {
    status = mcor_step_cuts(context, fill, step, &places, &points, sides);
  }
  mcor_release_cap_points(context, &points);
  mcor_free_places(&places);
  free(sides);
  return status;
}

/* ---- Numbers ---- */

/* Numbers the nodes that triangles use, by 4 x 4 of them, and returns how many there are. */
static int64_t mcor_number_nodes(mcor_filling* fill)
{
  const mcor_cap_face* face = &fill->face;
  const int *first = face->first, *size = face->count;
  int64_t count = 0;
  for (int64_t t = 0; t < fill->triangle_count; ++t)
  {
    for (int c = 0; c < 3; ++c)
    {
      const int32_t ref = fill->triangles[t].corner[c];
      if (ref >= 0 && ref < fill->node_count)
      {
        fill->number[ref] = 0;
      }
    }
  }
  for (int v = first[1] >> 2; v <= (first[1] + size[1] - 1) >> 2; ++v)
  {
    for (int u = first[0] >> 2; u <= (first[0] + size[0] - 1) >> 2; ++u)
    {
      for (int n = 0; n < 16; ++n)
      {
        const int x = 4 * u + (n & 3) - first[0], y = 4 * v + (n >> 2) - first[1];
        const bool within = x >= 0 && x < size[0] && y >= 0 && y < size[1];
        const int64_t node = within ? mcor_cap_index(face, x, y) : 0;
        if (within && fill->number[node] == 0)
        {
          fill->number[node] = (int32_t)++count; /* from 1 on, as yet */
        }
      }
    }
  }
  return count;
}

static mcor_status mcor_number_fill(mcor_context* context, mcor_filling* fill, int64_t* nodes)
{
  fill->number = malloc((size_t)fill->node_count * sizeof *fill->number);
  fill->cut_number = malloc((size_t)fill->cut_count * sizeof *fill->cut_number + 1);
  MCOR_TRY(mcor_allocated(context, fill->number && fill->cut_number));
  memset(fill->number, 0xff, (size_t)fill->node_count * sizeof *fill->number);
  *nodes = mcor_number_nodes(fill);
  MCOR_RETURN_IF(*nodes + fill->cut_count > MCOR_COUNT_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    "What is filled has %lld points; the limit is %d. Use a larger cube size.",
    (long long)(*nodes + fill->cut_count), MCOR_COUNT_LIMIT);
  for (int64_t i = 0; i < fill->cut_count; ++i)
  {
    fill->cut_number[fill->cuts[i].index] = (int32_t)(*nodes + i + 1);
  }
  return MCOR_OK;
}

/* ---- Points ---- */

/* Of the points: places, flags, bands and keys. */
typedef struct mcor_fill_list
{
  mcor_fill_places places;
  uint8_t* flag;
  int32_t* band;
  uint64_t* keys; /* [count][2]; the mesh's, if they are asked for */
  int64_t count;
} mcor_fill_list;

static void mcor_set_point(
  mcor_fill_list* list, int64_t i, uint8_t flag, int band, uint64_t first_key, uint64_t second_key)
{
  list->flag[i] = flag;
  list->band[i] = band;
  if (list->keys)
  {
    list->keys[2 * i] = first_key;
    list->keys[2 * i + 1] = second_key;
  }
}

static void mcor_list_nodes(
  const mcor_context* context, const mcor_filling* fill, mcor_fill_list* list)
{
  const mcor_cap_face* face = &fill->face;
  for (int32_t t = 1; t <= face->tile_count; ++t)
  {
    for (int n = 0; n < MCOR_CAP_TILE * MCOR_CAP_TILE; ++n)
    {
      const int64_t node = (int64_t)t * MCOR_CAP_TILE * MCOR_CAP_TILE + n,
                    i = fill->number[node] - 1;
      const cl_int u = face->first[0] + face->place[t] % face->tiles[0] * MCOR_CAP_TILE +
        n % MCOR_CAP_TILE,
                   v = face->first[1] + face->place[t] / face->tiles[0] * MCOR_CAP_TILE +
        n / MCOR_CAP_TILE;
      if (i >= 0)
      {
        mcor_set_place(context, &list->places, i, u, v, 0, 0);
        mcor_set_point(list, i, MCOR_CAP_FLAG, fill->band[node], mcor_fill_node_key(u, v), 0);
      }
    }
  }
}

static void mcor_list_cuts(
  const mcor_context* context, const mcor_filling* fill, int64_t nodes, mcor_fill_list* list)
{
  for (int64_t i = 0; i < fill->cut_count; ++i)
  {
    const mcor_fill_cut* cut = &fill->cuts[i];
    mcor_set_place(context, &list->places, nodes + i, cut->u, cut->v, cut->axis, cut->at);
    mcor_set_point(list, nodes + i, fabs(cut->margin) < MCOR_FILL_ROOT ? 1 : 2, cut->band,
      cut->key[0] | UINT64_C(1) << 62, cut->key[1]);
  }
}

static mcor_status mcor_make_list(
  mcor_context* context, const mcor_filling* fill, int64_t nodes, mcor_fill_list* list)
{
  const size_t n = (size_t)(nodes + fill->cut_count);
  list->count = (int64_t)n;
  list->flag = malloc(n + 1);
  list->band = malloc(n * sizeof *list->band + 1);
  bool good = mcor_make_places(context, n, &list->places) && list->flag && list->band;
  if (context->run.options->point_keys)
  {
    mcor_end_caps(context);
    context->mesh.cap_keys = list->keys = malloc(2 * n * sizeof *list->keys + 1);
    good = good && list->keys;
  }
  if (good)
  {
    mcor_list_nodes(context, fill, list);
    mcor_list_cuts(context, fill, nodes, list);
  }
  return mcor_allocated(context, good);
}

/* As a mesh that has these points only, all like those of caps. */
static mcor_status mcor_make_fill_mesh(
  mcor_context* context, const mcor_input* input, const mcor_fill_list* list)
{
  mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)list->count, real = context->cl.real_size;
  int groups;
  mesh->march_count = mesh->cap_first = mesh->triangle_count = 0;
  mesh->vertex_count = (int)n;
  context->run.iso_number = context->run.options->iso_count;
  MCOR_TRY(mcor_load_attributes(context, input, 0));
  MCOR_TRY(mcor_write(context, &mesh->node, list->places.node, n * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve_vertices(context, (int)n));
  MCOR_TRY(mcor_write(context, &mesh->offset, list->places.offset, n * 4 * real));
  MCOR_TRY(mcor_write(context, &mesh->flag, list->flag, n));
  MCOR_TRY(mcor_make_groups(context, &mesh->node, 0, (int)n, &groups));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_cap_points", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_INT(groups), MCOR_BUFFER(&context->points.groups), MCOR_BUFFER(&mesh->node), MCOR_REAL(0),
    MCOR_BUFFER(&mesh->offset), MCOR_BUFFER(&mesh->field_value), MCOR_BUFFER(&mesh->gradient),
    MCOR_BUFFER(&mesh->vertex_weight), MCOR_ATTRIBUTE_ARGS(context, &mesh->means)));
  mcor_release(context, &context->attributes.sorted);
  return MCOR_OK;
}

/* What of points is relative to an iso value: that of their band. */
static void mcor_set_bands(
  const mcor_filling* fill, const mcor_fill_list* list, int64_t base, mcor_surface* surface)
{
  for (int64_t i = 0; i < list->count; ++i)
  {
    const mcor_fill_line* line = &fill->lines[fill->levels[list->band[i] - 1]];
    if (surface->iso_value)
    {
      surface->iso_value[base + i] = line->value;
    }
    if (surface->residual)
    {
      surface->residual[base + i] = (float)(surface->residual[base + i] - line->iso);
    }
  }
}

static mcor_status mcor_append_fill_points(mcor_context* context, const mcor_filling* fill,
  const mcor_input* input, int64_t nodes, mcor_surface* surface)
{
  const int64_t base = surface->point_count;
  mcor_fill_list list = { .count = 0 };
  mcor_status status = mcor_make_list(context, fill, nodes, &list);
  if (list.count > 0)
  {
    status = status == MCOR_OK ? mcor_make_fill_mesh(context, input, &list) : status;
    status = status == MCOR_OK ? mcor_append_points(context, input, surface) : status;
  }
  if (status == MCOR_OK)
  {
    mcor_set_bands(fill, &list, base, surface);
  }
  mcor_free_places(&list.places);
  free(list.flag);
  free(list.band);
  return status;
}

/* ---- Triangles ---- */

static int32_t mcor_point_of(const mcor_filling* fill, int64_t base, int32_t ref)
{
  return ref < 0             ? -1 - ref
    : ref < fill->node_count ? (int32_t)(base + fill->number[ref] - 1)
                             : (int32_t)(base + fill->cut_number[ref - fill->node_count] - 1);
}

static mcor_status mcor_append_fill_triangles(
  mcor_context* context, const mcor_filling* fill, int64_t base, mcor_surface* surface)
{
  const int64_t first = surface->triangle_count, count = fill->triangle_count;
  const size_t all = (size_t)(first + count);
  int32_t* triangles = realloc(surface->triangles, all * 3 * sizeof *triangles + 1);
  surface->triangles = triangles ? triangles : surface->triangles;
  surface->band_value = malloc((size_t)count * sizeof *surface->band_value + 1);
  MCOR_TRY(mcor_allocated(context, triangles && surface->band_value));
  MCOR_TRY(mcor_extend_kept(context, count, surface));
  for (int64_t t = 0; t < count; ++t)
  {
    const mcor_fill_triangle* from = &fill->triangles[t];
    for (int c = 0; c < 3; ++c)
    {
      triangles[3 * (first + t) + c] = mcor_point_of(fill, base, from->corner[c]);
    }
    surface->band_value[t] = fill->lines[fill->levels[from->band - 1]].value;
    if (context->box.kept)
    {
      context->box.kept[first + t] = 1;
    }
    if (surface->triangle_keys)
    {
      uint64_t* key = surface->triangle_keys + MCOR_TRIANGLE_KEY * (first + t);
      key[0] = (uint64_t)fill->line_count;
      key[1] = from->square & ~(UINT64_C(1) << 63);
    }
  }
  surface->triangle_count += count;
  return MCOR_OK;
}

mcor_status mcor_append_fill(
  mcor_context* context, mcor_filling* fill, const mcor_input* input, mcor_surface* surface)
{
  const int64_t base = surface->point_count;
  int64_t nodes = 0;
  MCOR_TRY(mcor_place_fill_cuts(context, fill));
  MCOR_TRY(mcor_number_fill(context, fill, &nodes));
  MCOR_RETURN_IF(base + nodes + fill->cut_count > INT32_MAX, context, MCOR_OUT_OF_CAPACITY,
    "The surface would have %lld points; the limit is 2147483647. Use a larger cube size.",
    (long long)(base + nodes + fill->cut_count));
  MCOR_TRY(mcor_append_fill_points(context, fill, input, nodes, surface));
  return mcor_append_fill_triangles(context, fill, base, surface);
}
