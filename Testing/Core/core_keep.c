/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core_keep.h"
#include "core_parts.h"

void core_keep(const char* name, const char* part, const void* data, size_t bytes)
{
  const char* folder = getenv("CORE_KEEP");
  char path[1024];
  if (!data || !folder)
  {
    return;
  }
  const int length = snprintf(path, sizeof path, "%s/%s.%s", folder, name, part);
  FILE* file = length < (int)sizeof path ? fopen(path, "ab") : NULL;
  assert_non_null(file);
  assert_int_equal(fwrite(data, 1, bytes, file), bytes);
  assert_int_equal(fclose(file), 0);
}

void core_keep_size(const char* name, int64_t points, int64_t cells)
{
  char text[64];
  const int length = cells < 0
    ? snprintf(text, sizeof text, "left out")
    : snprintf(text, sizeof text, "%lld,%lld", (long long)points, (long long)cells);
  core_keep(name, "size", text, (size_t)length);
}

/* Collects triangles or pieces of lines: the bytes of their corners, one after the other. */
typedef struct keep_cells
{
  int corners;  /* corners of each cell */
  size_t width; /* bytes of each corner */
  int64_t count;
  unsigned char* bytes;
} keep_cells;

/* Adds a cell. The corner that memcmp() finds least becomes the first; the cyclic order stays. */
static void add_cell(
  keep_cells* cells, const mcor_input* input, mcor_surface* s, const int32_t* points)
{
  unsigned char corner[3][1024];
  int least = 0;
  for (int c = 0; c < cells->corners; ++c)
  {
    cells->width = (size_t)(core_put_point(corner[c], input, s, points[c], false) - corner[c]);
    least = memcmp(corner[c], corner[least], cells->width) < 0 ? c : least;
  }
  const size_t bytes = (size_t)cells->corners * cells->width;
  cells->bytes = realloc(cells->bytes, (size_t)(cells->count + 1) * bytes);
  assert_non_null(cells->bytes);
  unsigned char* to = cells->bytes + (size_t)cells->count++ * bytes;
  for (int c = 0; c < cells->corners; ++c)
  {
    memcpy(to + (size_t)c * cells->width, corner[(least + c) % cells->corners], cells->width);
  }
}

static void keep_sorted(const char* name, keep_cells* cells)
{
  const size_t bytes = (size_t)cells->corners * cells->width;
  core_sort_records(cells->bytes, cells->count, bytes);
  core_keep(name, "canonical", cells->bytes, (size_t)cells->count * bytes);
  free(cells->bytes);
}

void core_keep_surface(const char* name, const mcor_input* input, mcor_surface* s)
{
  if (!getenv("CORE_KEEP"))
  {
    return;
  }
  const size_t n = (size_t)s->point_count, triangles = (size_t)s->triangle_count;
  core_keep(name, "geometry", s->triangles, triangles * 3 * sizeof *s->triangles);
  core_keep(name, "geometry", s->band_value, triangles * sizeof *s->band_value);
  core_keep(name, "geometry", s->line_offsets, (size_t)(s->line_count + 1) * sizeof(int64_t));
  core_keep(name, "geometry", s->line_points, (size_t)s->line_point_count * sizeof(int32_t));
  core_keep(name, "keys", s->triangle_keys, triangles * MCOR_TRIANGLE_KEY * sizeof(uint64_t));
  mcor_surface_array arrays[MCOR_SURFACE_ARRAYS];
  mcor_list_surface_arrays(s, arrays);
  for (int a = 0; a < MCOR_SURFACE_ARRAYS; ++a)
  {
    const bool keys = arrays[a].array == (void**)&s->point_keys;
    core_keep(name,
      a == 0   ? "geometry"
        : keys ? "keys"
               : "arrays",
      *arrays[a].array, n * arrays[a].width);
  }
  for (int a = 0; a < s->attribute_count; ++a)
  {
    core_keep(name, "arrays", s->attributes[a],
      n * (size_t)input->attributes[a].components * sizeof(double));
  }
  const double measures[4] = { s->statistics.is_closed, s->statistics.area, s->statistics.volume,
    s->statistics.length };
  core_keep(name, "arrays", measures, sizeof measures);
  keep_cells faces = { .corners = 3 }, lines = { .corners = 2 };
  for (int64_t t = 0; t < s->triangle_count; ++t)
  {
    add_cell(&faces, input, s, s->triangles + 3 * t);
  }
  for (int64_t l = 0; l < s->line_count; ++l)
  {
    for (int64_t p = s->line_offsets[l] + 1; p < s->line_offsets[l + 1]; ++p)
    {
      add_cell(&lines, input, s, s->line_points + p - 1);
    }
  }
  keep_sorted(name, &faces);
  keep_sorted(name, &lines);
  core_keep_size(name, s->point_count, s->triangle_count > 0 ? s->triangle_count : s->line_count);
}
