/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Each triangle keeps the key of its cell through trimming. The key says whether this call owns the
 * triangle, see mcor_box.c. Triangles of the ring (the cells around the owned cells) are removed
 * from the surface at the very end, with the points that only they use. Keys ascend in the order of
 * the whole surface's triangles, whatever part of the surface a call makes. */

#include "mcor_box.h"
#include "mcor_cap.h"
#include "mcor_input.h"

#include <stdlib.h>
#include <string.h>

bool mcor_follows_cells(const mcor_context* context)
{
  return context->box.is_part || mcor_wants(context, MCOR_OUT_TRIANGLE_KEYS);
}

/* ---- Mesh ---- */

mcor_status mcor_count_owned_triangles(mcor_context* context, int first, int last, int* count)
{
  void* view = NULL;
  *count = last - first;
  if (!context->box.is_part || last == first)
  {
    return MCOR_OK;
  }
  mcor_buffer* buffer = &context->box.cells;
  MCOR_TRY(mcor_map(context, buffer, (size_t)last * sizeof(cl_ulong), false, &view));
  const cl_ulong* cells = view;
  for (int i = first; i < last; ++i)
  {
    *count -= (cells[i] & MCOR_RING_CELL) != 0;
  }
  return mcor_unmap(context, buffer, &view);
}

/* Finds which vertices this call counts. A vertex on a seam between boxes belongs to several ranks:
 * the rank that owns the vertex's first triangle counts it. The triangles of a box and its ring
 * have the same order on all ranks. Triangles in the ring beyond all ranks' boxes, where the whole
 * surface ends, have no owner, and are skipped. In the ring, MCOR_OTHERS_CELL marks cells of other
 * ranks. It is the same bit as MCOR_CAP_SQUARE, because other ranks own all squares of caps there.
 * *owners must be NULL before the call. It becomes an array [vertex_count], MCOR_OWN for vertices
 * that this call counts, or stays NULL if box.is_part is false. The caller always frees *owners. */
mcor_status mcor_find_counted(mcor_context* context, uint8_t** owners)
{
  const mcor_mesh* mesh = &context->mesh;
  const size_t triangles = (size_t)mesh->triangle_count;
  if (!context->box.is_part)
  {
    return MCOR_OK;
  }
  *owners = calloc((size_t)mesh->vertex_count + 1, 1);
  MCOR_TRY(mcor_allocated(context, *owners));
  void *corners = NULL, *cells = NULL;
  if (triangles == 0)
  {
    return MCOR_OK;
  }
  const mcor_mapping views[] = { { &mesh->triangles, 3 * triangles * sizeof(cl_int), &corners },
    { &context->box.cells, triangles * sizeof(cl_ulong), &cells } };
  const mcor_status status = mcor_map_all(context, views, 2);
  for (size_t i = 0; i < 3 * triangles && status == MCOR_OK; ++i)
  {
    const cl_ulong cell = ((const cl_ulong*)cells)[i / 3];
    uint8_t* of = *owners + ((const cl_int*)corners)[i]; /* set by its first triangle */
    *of = *of                    ? *of
      : !(cell & MCOR_RING_CELL) ? MCOR_OWN
      : cell & MCOR_OTHERS_CELL  ? MCOR_ANOTHERS
                                 : 0;
  }
  return mcor_unmap_all(context, views, 2, status);
}

/* ---- Surface ---- */

mcor_status mcor_extend_kept(mcor_context* context, int64_t more, mcor_surface* surface)
{
  const int64_t old = surface->triangle_count;
  void **kept = (void**)&context->box.kept, **keys = (void**)&surface->triangle_keys;
  if (context->box.is_part)
  {
    MCOR_TRY(mcor_grow(context, kept, old, more, 1));
  }
  return mcor_wants(context, MCOR_OUT_TRIANGLE_KEYS)
    ? mcor_grow(context, keys, old, more, MCOR_TRIANGLE_KEY * sizeof(uint64_t))
    : MCOR_OK;
}

void mcor_keep_cell(
  mcor_context* context, mcor_surface* surface, int64_t triangle, int number, uint64_t cell)
{
  if (context->box.kept)
  {
    context->box.kept[triangle] = !(cell & MCOR_RING_CELL);
  }
  if (surface->triangle_keys)
  {
    surface->triangle_keys[MCOR_TRIANGLE_KEY * triangle] = (uint64_t)number;
    surface->triangle_keys[MCOR_TRIANGLE_KEY * triangle + 1] = cell;
  }
}

/* Moves each element i of an array to index number[i] <= i. Drops elements whose number is -1. */
static void mcor_pack(void* array, size_t width, const int32_t* number, int64_t count)
{
  char* bytes = array;
  for (int64_t i = 0; i < count && array; ++i)
  {
    if (number[i] >= 0 && number[i] != i)
    {
      memcpy(bytes + (size_t)number[i] * width, bytes + (size_t)i * width, width);
    }
  }
}

/* Keeps only the owned triangles and the points that they use, in order. */
mcor_status mcor_crop_surface(mcor_context* context, const mcor_input* input, mcor_surface* surface)
{
  const uint8_t* kept = context->box.kept;
  if (!kept)
  {
    return MCOR_OK;
  }
  int32_t* number = malloc(((size_t)surface->point_count + 1) * sizeof *number);
  MCOR_TRY(mcor_allocated(context, number));
  int64_t triangles = 0, points = 0;
  memset(number, 0xff, (size_t)surface->point_count * sizeof *number);
  for (int64_t i = 0; i < surface->triangle_count; ++i)
  {
    for (int c = 0; c < 3 && kept[i]; ++c)
    {
      number[surface->triangles[3 * i + c]] = 0;
    }
    if (kept[i])
    {
      mcor_move_triangle(surface, i, triangles++);
    }
  }
  for (int64_t i = 0; i < surface->point_count; ++i)
  {
    number[i] = number[i] < 0 ? -1 : (int32_t)points++;
  }
  for (int64_t i = 0; i < 3 * triangles; ++i)
  {
    surface->triangles[i] = number[surface->triangles[i]];
  }
  surface->triangle_count = triangles;
  mcor_surface_array arrays[MCOR_SURFACE_ARRAYS];
  mcor_list_surface_arrays(surface, arrays);
  for (int i = 0; i < MCOR_SURFACE_ARRAYS; ++i)
  {
    mcor_pack(*arrays[i].array, arrays[i].width, number, surface->point_count);
  }
  for (int a = 0; a < surface->attribute_count; ++a)
  {
    mcor_pack(surface->attributes[a],
      (size_t)mcor_components(&input->attributes[a]) * sizeof(double), number,
      surface->point_count);
  }
  surface->point_count = points;
  free(number);
  return MCOR_OK;
}
