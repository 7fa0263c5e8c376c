/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes with the paper's seeds: marked cells are those of leaves on the lines between pairs, by another
 * way to find them; what is grown to is whole; and nothing depends on order, form, boxes or reuse. */

#include "core_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Windings of all sizes. Only in some places have particles another one within the smoothing length. */
static core_set make_windings(double ratio)
{
  core_set set = core_make_graded(ratio, 0.4);
  for (int64_t i = 0; i < set.count; ++i)
  {
    const double* x = set.position + 3 * i;
    const double r = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    set.smoothing_length[i] *= x[2] > 0.8 * r ? 1 : 0.5;
    set.scalar[i] = sin(5 * log(r)) + 0.3 * sin(6 * x[1] / r) + 0.2 * x[2] / r;
  }
  return set;
}

static mcor_options pair_options(const double* iso)
{
  mcor_options options = core_options(iso);
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  options.seeds = MCOR_PAIRS;
  options.h_scale = 2;
  return options;
}

/* ---- marked cells ---- */

/* Leaves with surface, after a call: bricks and levels, ascending as below, and masks. */
typedef struct leaf_cells
{
  int count;
  cl_int (*leaf)[4];
  uint64_t *marked, *used;
} leaf_cells;

static int compare_leaves(const void* a, const void* b)
{
  const cl_int *x = a, *y = b;
  for (int i = 3; i >= 0; --i)
  {
    if (x[i] != y[i])
    {
      return x[i] < y[i] ? -1 : 1;
    }
  }
  return 0;
}

static leaf_cells read_leaves(mcor_context* context)
{
  leaf_cells l = { .count = 0 };
  const mcor_bricks* bricks = &context->bricks;
  const size_t n = (size_t)bricks->now.count;
  l.leaf = malloc((n + 1) * sizeof *l.leaf);
  l.marked = malloc((n + 1) * sizeof *l.marked);
  l.used = malloc((n + 1) * sizeof *l.used);
  uint64_t* cells = malloc((n + 1) * sizeof *cells);
  assert_true(l.leaf && l.marked && l.used && cells);
  CORE_OK(context, mcor_read(context, &bricks->now.bricks, 0, l.leaf, n * sizeof *l.leaf));
  CORE_OK(context, mcor_read(context, &context->mesh.used, 0, l.used, n * sizeof *l.used));
  CORE_OK(context, mcor_read(context, &bricks->cells, 0, cells, n * sizeof *cells));
  if (context->pairs.seeds.mem)
  {
    CORE_OK(context, mcor_read(context, &context->pairs.seeds, 0, l.marked, n * sizeof *l.marked));
  }
  for (size_t i = 0; i < n; ++i)
  {
    if (cells[i])
    {
      memcpy(l.leaf[l.count], l.leaf[i], sizeof l.leaf[i]);
      l.marked[l.count] = l.marked[i];
      l.used[l.count++] = l.used[i];
    }
    else
    {
      assert_true(l.used[i] == 0);
    }
  }
  free(cells);
  for (int i = 1; i < l.count; ++i)
  {
    assert_true(compare_leaves(l.leaf[i - 1], l.leaf[i]) < 0);
  }
  return l;
}

static void free_leaves(leaf_cells* l)
{
  free(l->leaf);
  free(l->marked);
  free(l->used);
}

static int count_cells(const uint64_t* masks, int count)
{
  int cells = 0;
  for (int i = 0; i < count; ++i)
  {
    for (uint64_t rest = masks[i]; rest; rest &= rest - 1)
    {
      ++cells;
    }
  }
  return cells;
}

/* The leaf that a place is in, cubes from the lattice's origin; -1: surface is certainly not there. Where in the
 * leaf, in its cells, goes to `at`. */
static int find_leaf(const leaf_cells* l, int top, const double x[3], double at[3])
{
  for (int level = 0; level <= top; ++level)
  {
    cl_int key[4] = { 0, 0, 0, level };
    for (int a = 0; a < 3; ++a)
    {
      at[a] = ldexp(x[a], -level);
      key[a] = (cl_int)floor(at[a] / 4);
      at[a] -= 4 * key[a];
    }
    const cl_int(*found)[4] =
      bsearch(key, l->leaf, (size_t)l->count, sizeof *l->leaf, compare_leaves);
    if (found)
    {
      return (int)(found - (const cl_int(*)[4])l->leaf);
    }
  }
  return -1;
}

/* Whether a line passes a box, larger by `more`. */
static int passes(
  const double p[3], const double q[3], const double low[3], double edge, double more)
{
  double from = 0, to = 1;
  for (int a = 0; a < 3; ++a)
  {
    const double d = q[a] - p[a], below = low[a] - more - p[a], above = low[a] + edge + more - p[a];
    if (fabs(d) < 1e-12)
    {
      to = below > 0 || above < 0 ? -1 : to;
      continue;
    }
    from = fmax(from, fmin(below / d, above / d));
    to = fmin(to, fmax(below / d, above / d));
  }
  return from <= to;
}

typedef struct pair_line
{
  double p[3], q[3]; /* cubes from the lattice's origin */
  int certain;       /* 0: as far apart as the smoothing length, to within rounding */
} pair_line;

static pair_line* list_lines(
  const core_set* set, const mcor_context* context, double iso, int* count)
{
  const mcor_lattice* lattice = &context->lattice;
  pair_line* lines = malloc(400000 * sizeof *lines);
  assert_non_null(lines);
  *count = 0;
  for (int64_t j = 0; j < set->count; ++j)
  {
    for (int64_t k = 0; k < j; ++k)
    {
      const double *x = set->position + 3 * j, *y = set->position + 3 * k;
      const double h = fmax(set->smoothing_length[j], set->smoothing_length[k]);
      const double d = sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
        (x[2] - y[2]) * (x[2] - y[2]));
      if ((set->scalar[j] >= iso) != (set->scalar[k] >= iso) && d < 1.001 * h)
      {
        assert_true(*count < 400000);
        pair_line* line = lines + (*count)++;
        line->certain = d < 0.9999 * h;
        for (int a = 0; a < 3; ++a)
        {
          line->p[a] = x[a] / lattice->cube - (double)lattice->origin[a];
          line->q[a] = y[a] / lattice->cube - (double)lattice->origin[a];
        }
      }
    }
  }
  return lines;
}

/* Every cell on a line, off its sides, must be marked. Returns how many places were in leaves of each level. */
static void check_line(const leaf_cells* l, const pair_line* line, int top, int64_t* places)
{
  enum
  {
    STEPS = 200
  };
  for (int i = 0; i <= STEPS; ++i)
  {
    double x[3], at[3];
    int cell = 0, inside = 1;
    for (int a = 0; a < 3; ++a)
    {
      x[a] = line->p[a] + (line->q[a] - line->p[a]) * i / STEPS;
    }
    const int leaf = find_leaf(l, top, x, at);
    if (leaf < 0)
    {
      continue;
    }
    for (int a = 0; a < 3; ++a)
    {
      const double f = at[a] - floor(at[a]);
      inside = inside && f > 1e-3 && f < 1 - 1e-3;
      cell |= (int)floor(at[a]) << 2 * a;
    }
    places[l->leaf[leaf][3]] += inside;
    CORE_CHECK(!inside || (l->marked[leaf] >> cell & 1),
      "cell %d of leaf %d of level %d at %d / %d", cell, leaf, (int)l->leaf[leaf][3], i, STEPS);
  }
}

static void lines_are_marked(void** state)
{
  static const double iso = 0.1;
  mcor_context* context = *state;
  core_set set = core_make_graded(100, 0.4);
  uint64_t seed = 3;
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] = 2 * random_unit(&seed) - 1;
  }
  const mcor_input input = core_input(&set);
  mcor_options options = pair_options(&iso);
  options.h_scale = 1;
  options.node_threshold = 0;
  mcor_surface surface = core_extract(context, &input, &options);
  const int top = context->tree.top;
  assert_in_range(top, 3, 7);
  leaf_cells l = read_leaves(context);
  const int seeds = count_cells(l.marked, l.count);
  assert_true(seeds > 1000);
  assert_int_equal(surface.statistics.seed_cells, seeds);
  int count;
  int64_t places[MCOR_CUBE_LEVELS] = { 0 };
  pair_line* lines = list_lines(&set, context, iso, &count);
  for (int i = 0; i < count; ++i)
  {
    if (lines[i].certain)
    {
      check_line(&l, lines + i, top, places);
    }
  }
  assert_true(places[0] > 1000 && places[1] > 1000 && places[2] > 1000);
  for (int i = 0; i < l.count; ++i)
  {
    const double edge = ldexp(1, l.leaf[i][3]);
    for (int c = 0; c < 64; ++c)
    {
      const double low[3] = { edge * (4 * l.leaf[i][0] + (c & 3)),
        edge * (4 * l.leaf[i][1] + (c >> 2 & 3)), edge * (4 * l.leaf[i][2] + (c >> 4)) };
      int found = !(l.marked[i] >> c & 1);
      for (int k = 0; k < count && !found; ++k)
      {
        found = passes(lines[k].p, lines[k].q, low, edge, 1e-3);
      }
      CORE_CHECK(found, "cell %d of leaf %d is on no line", c, i);
    }
  }
  free(lines);
  free_leaves(&l);
  mcor_free_surface(&surface);
  core_free_set(&set);
}

/* ---- growth ---- */

static int compare_places(const void* a, const void* b)
{
  return memcmp(a, b, 9 * sizeof(double));
}

/* The corners of the triangles, and their numbers behind; sorted. */
typedef struct placed_triangle
{
  double corner[9];
  int64_t number;
} placed_triangle;

static placed_triangle* place_triangles(const mcor_surface* s)
{
  placed_triangle* t = calloc((size_t)s->triangle_count + 1, sizeof *t);
  assert_non_null(t);
  for (int64_t i = 0; i < s->triangle_count; ++i)
  {
    for (int c = 0; c < 3; ++c)
    {
      memcpy(
        t[i].corner + 3 * c, s->points + 3 * (int64_t)s->triangles[3 * i + c], 3 * sizeof(double));
    }
    t[i].number = i;
  }
  qsort(t, (size_t)s->triangle_count, sizeof *t, compare_places);
  return t;
}

/* Which triangles of the whole surface are in the other, all of whose must be. */
static uint8_t* find_kept(const mcor_surface* whole, const mcor_surface* part)
{
  placed_triangle *all = place_triangles(whole), *some = place_triangles(part);
  uint8_t* kept = calloc((size_t)whole->triangle_count + 1, 1);
  assert_non_null(kept);
  int64_t found = 0;
  for (int64_t i = 0; i < whole->triangle_count; ++i)
  {
    const int same = found < part->triangle_count && compare_places(all + i, some + found) == 0;
    kept[all[i].number] = (uint8_t)same;
    found += same;
  }
  CORE_CHECK(found == part->triangle_count, "%lld of %lld triangles are in the whole surface",
    (long long)found, (long long)part->triangle_count);
  free(all);
  free(some);
  return kept;
}

/* Pairs find whole components, and each that a marked cell touches; not all there are. */
static void components_are_whole(void** state)
{
  static const double isos[2] = { 0.3, 0.1 };
  mcor_context* context = *state;
  for (int i = 0; i < 4; ++i)
  {
    core_set set = i < 2 ? make_windings(60) : core_make_random(2500, 14, 0.25, 3, 3);
    const mcor_input input = core_input(&set);
    mcor_options options = pair_options(isos + i % 2);
    options.h_scale = i < 2 ? 2 : 0.7;
    options.vertex_threshold = 0;
    options.field = i == 1 ? MCOR_SUM : MCOR_SHEPARD;
    mcor_surface part = core_extract(context, &input, &options);
    leaf_cells marked = read_leaves(context);
    options.seeds = MCOR_COMPLETE;
    mcor_surface whole = core_extract(context, &input, &options);
    leaf_cells all = read_leaves(context);
    assert_int_equal(marked.count, all.count);
    int levels = 0, hits = 0;
    for (int l = 0; l < MCOR_CUBE_LEVELS; ++l)
    {
      levels += part.statistics.cells_of_level[l] > 0;
    }
    assert_in_range(levels, i < 2 ? 3 : 2, 9);
    for (int k = 0; k < all.count; ++k)
    {
      const uint64_t hit = marked.marked[k] & all.used[k];
      assert_true((marked.used[k] & ~all.used[k]) == 0 && (hit & ~marked.used[k]) == 0);
      hits += count_cells(&hit, 1);
    }
    assert_int_equal(part.statistics.seed_cells - part.statistics.seed_cells_not_intersected, hits);
    assert_true(hits > 20 && hits < part.statistics.cells_used / (i < 2 ? 2 : 1));
    assert_true(part.triangle_count > 1000 && part.triangle_count < whole.triangle_count);
    uint8_t* kept = find_kept(&whole, &part);
    mesh_report report = core_check_mesh(&whole);
    for (int64_t s = 1; s < report.side_count; ++s)
    {
      const mesh_edge *a = report.side + s - 1, *b = report.side + s;
      CORE_CHECK(a->a != b->a || a->b != b->b || kept[a->triangle] == kept[b->triangle],
        "the side of points %d, %d is torn", (int)a->a, (int)a->b);
    }
    mesh_free_report(&report);
    report = core_check_mesh(&part);
    mesh_free_report(&report);
    free(kept);
    free_leaves(&marked);
    free_leaves(&all);
    mcor_free_surface(&part);
    mcor_free_surface(&whole);
    core_free_set(&set);
  }
}

/* ---- what must not matter ---- */

static void order_form_and_reuse(void** state)
{
  static const double isos[2] = { 0.3, -0.5 };
  core_set set = make_windings(30);
  int64_t* order = core_make_order(set.count, 9);
  core_set shuffled = core_permute(&set, order);
  mcor_input input = core_input_to_keep(&set);
  const mcor_input other = core_input(&shuffled);
  mcor_options options = pair_options(isos);
  options.iso_count = 2;
  core_ask_for_all(&options);
  options.outputs &= ~(unsigned)MCOR_OUT_NEAREST_PARTICLE; /* numbers of particles */
  mcor_surface surface = core_extract(*state, &other, &options);
  const uint64_t hash = core_hash(&surface);
  assert_true(surface.triangle_count > 2000);
  mcor_free_surface(&surface);
  const char* forms[] = { "cpu", "gpu" };
  for (int f = 0; f < 2; ++f)
  {
    mcor_context* context;
    core_create_form(&context, forms[f]);
    surface = core_extract(context, &input, &options);
    assert_true(core_hash(&surface) == hash);
    mcor_free_surface(&surface);
    options.seeds = MCOR_COMPLETE; /* what is kept is of use to both */
    surface = core_extract(context, &input, &options);
    assert_true(core_hash(&surface) != hash);
    mcor_free_surface(&surface);
    options.seeds = MCOR_PAIRS;
    surface = core_extract(context, &input, &options);
    assert_true(core_hash(&surface) == hash);
    mcor_free_surface(&surface);
    mcor_free_context(context);
  }
  free(order);
  core_free_set(&set);
  core_free_set(&shuffled);
}

static void one_level_is_uniform(void** state)
{
  static const double iso = 0;
  core_set set = core_make_block(9, 0.3, 3, core_ball);
  const mcor_input input = core_input(&set);
  uint64_t hash[2];
  for (int i = 0; i < 2; ++i)
  {
    mcor_options options = pair_options(&iso);
    options.h_scale = 1;
    options.level_limit = i ? 0 : MCOR_CUBE_LEVELS - 1;
    mcor_surface surface = core_extract(*state, &input, &options);
    hash[i] = core_hash(&surface);
    assert_true(surface.point_count > 100);
    mcor_free_surface(&surface);
  }
  assert_true(hash[0] == hash[1]);
  core_free_set(&set);
}

static void boxes_make_the_whole(void** state)
{
  static const double isos[2] = { 0.3, -0.5 }, noise = 0.1;
  core_set set = make_windings(12);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.solid[i] = set.position[3 * i] < -0.6 * set.smoothing_length[i] && i % 3 == 0;
  }
  set.has_solids = 1;
  mcor_input input = core_input(&set);
  input.scalar = core_array(set.position, 3);
  input.scalar_dot = core_array(set.position, 3);
  mcor_options options = pair_options(isos);
  core_ask_for_all(&options);
  static const double squares[2] = { 3, 40 };
  options.iso_values = squares;
  options.iso_count = 2;
  options.wall_share = 0.3;
  options.precision = MCOR_FLOAT64;
  core_check_cuts(*state, "dot product, solids, double", &input, &options);
  core_free_set(&set);
  set = core_make_random(3000, 14, 0.3, 3, 7);
  input = core_input(&set);
  input.volume = (mcor_array){ 0 };
  options = pair_options(&noise);
  core_ask_for_all(&options);
  options.cube_size_factor = 1;
  options.h_scale = 0.7;
  options.node_threshold = 0.9;
  options.vertex_threshold = 0.92;
  options.preview = 1;
  core_check_cuts(*state, "noise, computed volumes, preview", &input, &options);
  core_free_set(&set);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(lines_are_marked),
    cmocka_unit_test(components_are_whole), cmocka_unit_test(order_form_and_reuse),
    cmocka_unit_test(one_level_is_uniform), cmocka_unit_test(boxes_make_the_whole) };
  return cmocka_run_group_tests(tests, core_set_up, core_tear_down);
}
