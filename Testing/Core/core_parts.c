/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core_parts.h"

static size_t g_width; /* how many bytes qsort's function compares */

static int compare_bytes(const void* a, const void* b)
{
  return memcmp(a, b, g_width);
}

void core_sort_records(void* records, int64_t count, size_t width)
{
  g_width = width;
  if (count > 0)
  {
    qsort(records, (size_t)count, width, compare_bytes);
  }
}

unsigned char* core_put_point(
  unsigned char* to, const mcor_input* input, mcor_surface* s, int64_t i, bool keys)
{
  mcor_surface_array arrays[MCOR_SURFACE_ARRAYS];
  mcor_list_surface_arrays(s, arrays);
  for (int a = 0; a < MCOR_SURFACE_ARRAYS + s->attribute_count; ++a)
  {
    const int k = a - MCOR_SURFACE_ARRAYS;
    const char* array = k < 0 ? *arrays[a].array : s->attributes[k];
    const size_t width =
      k < 0 ? arrays[a].width : (size_t)input->attributes[k].components * sizeof(double);
    if (array && (keys || array != (const char*)s->point_keys))
    {
      memcpy(to, array + (size_t)i * width, width);
      to += width;
    }
  }
  return to;
}

/* Writes the key of triangle i, and *nth: how many triangles before it have the same key. Sorted by these bytes, the
 * triangles of all boxes have the order of the whole surface. Returns where the next bytes go. */
static unsigned char* put_place(unsigned char* to, const mcor_surface* s, int64_t i, uint64_t* nth)
{
  const uint64_t* key = s->triangle_keys + MCOR_TRIANGLE_KEY * i;
  *nth = i > 0 && memcmp(key, key - MCOR_TRIANGLE_KEY, MCOR_TRIANGLE_KEY * sizeof *key) == 0
    ? *nth + 1
    : 0;
  const uint64_t place[3] = { key[0], key[1], *nth };
  for (int byte = 0; byte < 24; ++byte)
  {
    *to++ = (unsigned char)(place[byte / 8] >> (56 - byte % 8 * 8));
  }
  return to;
}

void core_add_surface(core_triangles* triangles, const mcor_input* input, mcor_surface* s)
{
  unsigned char point[1024];
  if (s->point_count == 0)
  {
    return;
  }
  const size_t place = s->triangle_keys ? 24 : 0;
  triangles->width = 3 * (size_t)(core_put_point(point, input, s, 0, true) - point) + place;
  const size_t count = (size_t)(triangles->count + s->triangle_count + s->line_point_count);
  triangles->bytes = realloc(triangles->bytes, count * triangles->width);
  assert_non_null(triangles->bytes);
  unsigned char* to = triangles->bytes + (size_t)triangles->count * triangles->width;
  uint64_t nth = 0;
  for (int64_t i = 0; i < s->triangle_count; ++i, ++triangles->count)
  {
    to = s->triangle_keys ? put_place(to, s, i, &nth) : to;
    for (int c = 0; c < 3; ++c)
    {
      to = core_put_point(to, input, s, s->triangles[3 * i + c], true);
    }
  }
  for (int64_t l = 0; l < s->line_count; ++l)
  {
    for (int64_t i = s->line_offsets[l]; i + 1 < s->line_offsets[l + 1]; ++i, ++triangles->count)
    {
      memset(to, 0, place);
      to += place;
      for (int c = 0; c < 3; ++c)
      {
        to = core_put_point(to, input, s, s->line_points[i + (c > 0)], true);
      }
    }
  }
}

void core_expect_same(const char* name, core_triangles* all, core_triangles* whole)
{
  core_sort_records(all->bytes, all->count, all->width);
  core_sort_records(whole->bytes, whole->count, whole->width);
  CORE_CHECK(all->count == whole->count, name, all->count, whole->count);
  int64_t other = 0;
  for (int64_t i = 0; i < all->count; ++i)
  {
    const size_t at = (size_t)i * all->width;
    other += memcmp(all->bytes + at, whole->bytes + at, all->width) != 0;
  }
  CORE_CHECK(other == 0, name, other, all->count);
}

/* Fails if a point is used by no triangle, or a triangle names a point that does not exist. */
static void check_points(const mcor_surface* s)
{
  CORE_FREED uint8_t* used = oracle_allocate(s->point_count + 1, 1);
  for (int64_t i = 0; i < 3 * s->triangle_count; ++i)
  {
    assert_in_range(s->triangles[i], 0, s->point_count - 1);
    used[s->triangles[i]] = 1;
  }
  for (int64_t i = 0; i < s->point_count; ++i)
  {
    assert_int_equal(used[i], 1);
  }
}

/* Checks that points' keys ascend and differ, and that triangles' keys never descend. Whether boxes have
 * the keys of the whole surface is checked where their triangles are compared. */
static void check_keys(const mcor_surface* s)
{
  for (int64_t i = 1; s->point_keys && i < s->point_count; ++i)
  {
    const uint64_t *a = s->point_keys + MCOR_POINT_KEY * (i - 1), *b = a + MCOR_POINT_KEY;
    const int at = a[0] != b[0] ? 0 : a[1] != b[1] ? 1 : 2;
    CORE_CHECK(a[at] < b[at], i - 1);
  }
  for (int64_t i = 1; s->triangle_keys && i < s->triangle_count; ++i)
  {
    const uint64_t *a = s->triangle_keys + MCOR_TRIANGLE_KEY * (i - 1), *b = a + MCOR_TRIANGLE_KEY;
    CORE_CHECK(a[0] < b[0] || (a[0] == b[0] && a[1] <= b[1]), i - 1);
  }
}

/* Ways to cut space into boxes, for sets of particles that surround the origin and are about 10 wide. */
const core_cut core_cuts[CORE_CUTS] = {
  { "2 boxes", { 1, 0, 0 }, { { 0.37 } } },
  { "3, one thinner than a support", { 0, 0, 2 }, { { 0 }, { 0 }, { 1.1, 1.9 } } },
  { "3, one thinner than a cube", { 0, 2, 0 }, { { 0 }, { -0.3, -0.25 } } },
  { "8 boxes", { 1, 1, 1 }, { { -1.3 }, { 0.65 * 2 }, { 2.01 } } },
  { "empty ones", { 2, 1, 0 }, { { -1000, 0.1 }, { 500 } } },
};

void core_set_box(mcor_options* options, const core_cut* cut, const int at[3])
{
  for (int a = 0; a < 3; ++a)
  {
    options->box[2 * a] = at[a] == 0 ? -INFINITY : cut->at[a][at[a] - 1];
    options->box[2 * a + 1] = at[a] == cut->count[a] ? INFINITY : cut->at[a][at[a]];
  }
}

/* The surface without boxes, and its statistics. The surfaces and statistics of all boxes must add up to it. */
typedef struct core_whole
{
  core_triangles triangles;
  mcor_statistics statistics;
} core_whole;

static void check_cut(mcor_context* context, const char* name, const mcor_input* input,
  const mcor_options* options, const core_cut* cut, core_whole* whole)
{
  core_triangles all = { 0 };
  int64_t cells = 0, triangles = 0, virtual_cells = 0, caps = 0;
  int64_t cells_of_level[MCOR_CUBE_LEVELS] = { 0 }, triangles_of_level[MCOR_CUBE_LEVELS] = { 0 };
  const int boxes = (cut->count[0] + 1) * (cut->count[1] + 1) * (cut->count[2] + 1);
  for (int i = 0; i < boxes; ++i)
  {
    const int n = cut->count[0] + 1, m = cut->count[1] + 1;
    const int at[3] = { i % n, i / n % m, i / n / m };
    mcor_options own = *options;
    core_set_box(&own, cut, at);
    CORE_SURFACE part = core_extract(context, input, &own);
    check_points(&part);
    check_keys(&part);
    core_add_surface(&all, input, &part);
    cells += part.statistics.cells_used;
    triangles += part.statistics.triangles_before_trimming;
    virtual_cells += part.statistics.virtual_cells;
    caps += part.statistics.flat_loops;
    for (int l = 0; l < MCOR_CUBE_LEVELS; ++l)
    {
      cells_of_level[l] += part.statistics.cells_of_level[l];
      triangles_of_level[l] += part.statistics.triangles_of_level[l];
    }
  }
  char both[100];
  snprintf(both, sizeof both, "%s, %s", name, cut->name);
  core_expect_same(both, &all, &whole->triangles);
  assert_int_equal(cells, whole->statistics.cells_used);
  assert_int_equal(triangles, whole->statistics.triangles_before_trimming);
  assert_int_equal(virtual_cells, whole->statistics.virtual_cells);
  assert_int_equal(caps, whole->statistics.flat_loops);
  assert_memory_equal(cells_of_level, whole->statistics.cells_of_level, sizeof cells_of_level);
  assert_memory_equal(
    triangles_of_level, whole->statistics.triangles_of_level, sizeof triangles_of_level);
  free(all.bytes);
}

void core_check_these_cuts(mcor_context* context, const char* name, const mcor_input* input,
  const mcor_options* options, const core_cut* cuts, int count)
{
  core_whole whole = { 0 };
  CORE_SURFACE surface = core_extract(context, input, options);
  CORE_CHECK(surface.triangle_count > 300, name, surface.triangle_count);
  check_keys(&surface);
  core_add_surface(&whole.triangles, input, &surface);
  whole.statistics = surface.statistics;
  for (int i = 0; i < count; ++i)
  {
    check_cut(context, name, input, options, cuts + i, &whole);
  }
  free(whole.triangles.bytes);
}

void core_check_cuts(
  mcor_context* context, const char* name, const mcor_input* input, const mcor_options* options)
{
  core_check_these_cuts(context, name, input, options, core_cuts, CORE_CUTS);
}

void core_ask_for_all(mcor_options* options)
{
  options->outputs |=
    MCOR_OUT_GRADIENTS | MCOR_OUT_WEIGHT_SUM | MCOR_OUT_CORRECTION_LENGTH | MCOR_OUT_RESIDUAL;
  options->outputs |= MCOR_OUT_BOUNDARY_FLAG | MCOR_OUT_NEAREST_PARTICLE | MCOR_OUT_ISO_VALUE;
  options->outputs |= MCOR_OUT_POINT_KEYS | MCOR_OUT_TRIANGLE_KEYS;
}

void core_add_near(
  particle_set* near, const particle_set* set, int64_t i, const double box[6], double margin)
{
  const double* x = set->position + 3 * i;
  int in = 1;
  for (int a = 0; a < 3; ++a)
  {
    in = in && x[a] > box[2 * a] - margin && x[a] < box[2 * a + 1] + margin;
  }
  if (in)
  {
    particle_set_append(near, set, i);
  }
}

particle_set core_take_near(const particle_set* set, const double box[6], double margin)
{
  particle_set near = particle_set_make(set->count);
  near.has_solids = set->has_solids;
  near.count = 0;
  for (int64_t i = set->count - 1; i >= 0; --i)
  {
    core_add_near(&near, set, i, box, margin);
  }
  return near;
}
