/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Leaves of adaptive cubes, against their definition: the largest bricks that only particles with
 * h >= 2^L times the smallest h reach, and the smallest refinement of these in which leaves that touch
 * differ by one level at most. */

#include "core_fixture.h"

#include "mcor_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The place and level of the first leaf from bit *i of the tree's blocks on; false: there is none. */
static bool next_leaf(const mcor_tree* tree, int64_t* i, int leaf[4])
{
  for (; *i < (int64_t)tree->block_count * MCOR_BLOCK_BRICKS; ++*i)
  {
    const int64_t block = *i / MCOR_BLOCK_BRICKS;
    if (tree->leaves[*i / 32] >> (*i % 32) & 1)
    {
      for (leaf[3] = 0; block >= tree->first_block[leaf[3] + 1];)
      {
        ++leaf[3];
      }
      const uint64_t key =
        tree->block_keys[block] * MCOR_BLOCK_BRICKS + (uint64_t)(*i % MCOR_BLOCK_BRICKS);
      mcor_brick_of_key(&tree->lattice->rungs[leaf[3]], key, leaf);
      ++*i;
      return true;
    }
  }
  return false;
}

/* The level of every finest brick of a lattice of n^3 top bricks, by definition. */
typedef struct plain_levels
{
  int n; /* finest bricks along an axis */
  signed char* level;
} plain_levels;

static size_t at(const plain_levels* plain, int x, int y, int z)
{
  return ((size_t)z * (size_t)plain->n + (size_t)y) * (size_t)plain->n + (size_t)x;
}

/* Whether the kernel's support is a cube. */
static bool is_cube;

/* Whether all particles that reach the brick have 2^level times the smallest h. */
static bool is_coarse(const mcor_context* context, const core_set* set, int level, const int b[3])
{
  const mcor_lattice* lattice = &context->lattice;
  const double edge = ldexp(MCOR_BRICK, level);
  for (int64_t i = 0; i < set->count; ++i)
  {
    double square = 0;
    for (int a = 0; a < 3; ++a)
    {
      const double x = set->position[3 * i + a] / lattice->cube - (double)lattice->origin[a];
      const double d = fmax(fmax(b[a] * edge - x, x - (b[a] + 1) * edge), 0);
      square = is_cube ? fmax(square, d * d) : square + d * d;
    }
    const double reach = 2 * set->smoothing_length[i] / lattice->cube;
    if (square <= reach * reach && set->smoothing_length[i] < ldexp(context->measure.h_min, level))
    {
      return false;
    }
  }
  return true;
}

/* Sets all finest bricks of a brick. */
static void fill(plain_levels* plain, int level, const int b[3], int value)
{
  const int w = 1 << level;
  for (int z = b[2] * w; z < (b[2] + 1) * w; ++z)
  {
    for (int y = b[1] * w; y < (b[1] + 1) * w; ++y)
    {
      memset(plain->level + at(plain, b[0] * w, y, z), value, (size_t)w);
    }
  }
}

/* The largest bricks, from the top down. */
static void divide(
  const mcor_context* context, const core_set* set, plain_levels* plain, int level, const int b[3])
{
  if (level == 0 || is_coarse(context, set, level, b))
  {
    fill(plain, level, b, level);
    return;
  }
  for (int d = 0; d < 8; ++d)
  {
    const int child[3] = { 2 * b[0] + (d & 1), 2 * b[1] + (d >> 1 & 1), 2 * b[2] + (d >> 2) };
    divide(context, set, plain, level - 1, child);
  }
}

/* The lowest level of finest bricks around a leaf. */
static int lowest_beside(const plain_levels* plain, int level, const int b[3])
{
  const int w = 1 << level, n = plain->n;
  int lowest = level;
  for (int z = b[2] * w - 1; z <= (b[2] + 1) * w; ++z)
  {
    for (int y = b[1] * w - 1; y <= (b[1] + 1) * w; ++y)
    {
      for (int x = b[0] * w - 1; x <= (b[0] + 1) * w; ++x)
      {
        if (x >= 0 && y >= 0 && z >= 0 && x < n && y < n && z < n)
        {
          const int other = plain->level[at(plain, x, y, z)];
          lowest = other < lowest ? other : lowest;
        }
      }
    }
  }
  return lowest;
}

/* Divides leaves that touch others two or more levels below, until there is none. */
static void balance(plain_levels* plain)
{
  for (bool changed = true; changed;)
  {
    changed = false;
    for (int i = 0; i < plain->n * plain->n * plain->n; ++i)
    {
      const int x = i % plain->n, y = i / plain->n % plain->n, z = i / plain->n / plain->n;
      const int level = plain->level[i], w = 1 << level;
      const int b[3] = { x / w, y / w, z / w };
      if (level > 1 && x % w == 0 && y % w == 0 && z % w == 0 &&
        lowest_beside(plain, level, b) < level - 1)
      {
        fill(plain, level, b, level - 1);
        changed = true;
      }
    }
  }
}

static void measure(
  mcor_context* context, const core_set* set, int limit, mcor_options* options, mcor_input* input)
{
  static const double iso = 0.5;
  *input = core_input(set);
  *options = core_options(&iso);
  options->field = MCOR_WEIGHT_SUM;
  options->level_limit = limit;
  options->sph_kernel = is_cube ? MCOR_M_PRIME_4 : MCOR_CUBIC_SPLINE;
  context->run.options = options;
  context->kept.uses_solids = false;
  context->space.axes = 3;
  CORE_OK(context, mcor_measure_input(context, input, options));
}

static void make_tree(
  mcor_context* context, const core_set* set, int limit, mcor_options* options, mcor_input* input)
{
  measure(context, set, limit, options, input);
  CORE_OK(context, mcor_make_tree(context, input));
  context->run.options = NULL;
}

static void leaves_are_those_of_the_definition(void** state)
{
  mcor_context* context = *state;
  for (int run = 0; run < 8; ++run)
  {
    const uint64_t seed = 1 + (uint64_t)run % 4;
    core_set set = core_make_random(seed < 3 ? 12 : 3, 12, 0.3, 4, seed);
    is_cube = run > 3;
    mcor_options options;
    mcor_input input;
    make_tree(context, &set, 24, &options, &input);
    const mcor_tree* tree = &context->tree;
    const int top = tree->top;
    assert_in_range(top, 1, 5);
    const int above = MCOR_BRICK << (top + 1);
    const int n = (int)(context->lattice.last[0] / above) + 2,
              m = (int)(context->lattice.last[1] / above) + 2,
              k = (int)(context->lattice.last[2] / above) + 2;
    const int most = n > m ? (n > k ? n : k) : m > k ? m : k;
    plain_levels plain = { .n = most << (top + 1) };
    const size_t count = (size_t)plain.n * (size_t)plain.n * (size_t)plain.n;
    plain.level = malloc(count);
    assert_non_null(plain.level);
    for (int i = 0; i < most * most * most; ++i)
    {
      const int b[3] = { i % most, i / most % most, i / most / most };
      divide(context, &set, &plain, top + 1, b);
    }
    balance(&plain);
    int leaf[4], count_of_leaves = 0;
    for (int64_t i = 0; next_leaf(tree, &i, leaf); ++count_of_leaves)
    {
      const int level = leaf[3], w = 1 << level;
      CORE_CHECK(plain.level[at(&plain, leaf[0] * w, leaf[1] * w, leaf[2] * w)] == level,
        "seed %d, leaf %d %d %d of level %d", (int)seed, leaf[0], leaf[1], leaf[2], level);
      fill(&plain, level, leaf, -1);
    }
    assert_int_equal(count_of_leaves, tree->leaf_count);
    /* No particle reaches the rest, or not with this level's cubes. */
    for (size_t i = 0; i < count; ++i)
    {
      CORE_CHECK(plain.level[i] < 0 || plain.level[i] > top, "seed %d: no leaf of level %d",
        (int)seed, plain.level[i]);
    }
    free(plain.level);
    core_free_set(&set);
  }
  is_cube = false;
}

static uint64_t hash_leaves(const mcor_tree* tree)
{
  uint64_t hash = (uint64_t)tree->leaf_count;
  int leaf[4];
  for (int64_t i = 0; next_leaf(tree, &i, leaf);)
  {
    uint64_t key = hash ^ mcor_brick_key(&tree->lattice->rungs[leaf[3]], leaf);
    hash = random_bits(&key);
  }
  return hash;
}

static void order_and_limit(void** state)
{
  mcor_context* context = *state;
  mcor_options options;
  mcor_input input;
  core_set set = core_make_random(20000, 200, 0.5, 20, 7);
  int64_t* order = core_make_order(set.count, 3);
  core_set other = core_permute(&set, order);
  make_tree(context, &set, 24, &options, &input);
  const uint64_t hash = hash_leaves(&context->tree);
  assert_in_range(context->tree.top, 4, 5);
  make_tree(context, &other, 24, &options, &input);
  assert_true(hash_leaves(&context->tree) == hash);
  make_tree(context, &set, 2, &options, &input);
  assert_int_equal(context->tree.top, 2);
  assert_int_equal(context->tree.first_block[3], context->tree.block_count);
  free(order);
  core_free_set(&set);
  core_free_set(&other);
}

static bool has_block(const mcor_tree* tree, int level, const int brick[3])
{
  const uint64_t key = mcor_brick_key(&tree->lattice->rungs[level], brick) / MCOR_BLOCK_BRICKS;
  int low = 0, high = tree->block_count;
  while (low < high)
  {
    const int middle = (low + high) / 2;
    low = tree->block_keys[middle] < key ? middle + 1 : low;
    high = tree->block_keys[middle] < key ? high : middle;
  }
  return low < tree->block_count && tree->block_keys[low] == key;
}

/* All bricks whose nodes a leaf may need are in blocks: those up from it, and, beside finer ones, those of the next
 * level in it and up from it. */
static void blocks(void** state)
{
  mcor_context* context = *state;
  mcor_options options;
  mcor_input input;
  core_set set = core_make_random(2000, 60, 0.5, 9, 8);
  make_tree(context, &set, 24, &options, &input);
  const mcor_tree* tree = &context->tree;
  int leaf[4], beside_finer = 0;
  for (int64_t i = 0; next_leaf(tree, &i, leaf);)
  {
    bool finer = false;
    for (int d = 0; d < 27; ++d)
    {
      const int beside[3] = { leaf[0] + d % 3 - 1, leaf[1] + d / 3 % 3 - 1, leaf[2] + d / 9 - 1 };
      finer = finer || mcor_tree_is_split(tree, leaf[3], beside);
    }
    beside_finer += finer;
    for (int d = 0; d < 27; ++d)
    {
      const int by[3] = { d % 3, d / 3 % 3, d / 9 };
      const int up[3] = { leaf[0] + by[0] / 2, leaf[1] + by[1] / 2, leaf[2] + by[2] / 2 };
      const int below[3] = { 2 * leaf[0] + by[0], 2 * leaf[1] + by[1], 2 * leaf[2] + by[2] };
      CORE_CHECK(has_block(tree, leaf[3], up) && (!finer || has_block(tree, leaf[3] - 1, below)),
        "brick %d of leaf %d %d %d of level %d", d, leaf[0], leaf[1], leaf[2], leaf[3]);
    }
  }
  assert_in_range(beside_finer, 100, tree->leaf_count);
  core_free_set(&set);
}

/* A level begins at exactly 2^L times the smallest h. */
static void levels_of_particles(void** state)
{
  (void)state;
  assert_int_equal(mcor_tree_level_of(1, 1, 24), 0);
  assert_int_equal(mcor_tree_level_of(nextafter(2, 0), 1, 24), 0);
  assert_int_equal(mcor_tree_level_of(2, 1, 24), 1);
  assert_int_equal(mcor_tree_level_of(0.3 * 1024, 0.3, 24), 10);
  assert_int_equal(mcor_tree_level_of(nextafter(0.3 * 1024, 0), 0.3, 24), 9);
  assert_int_equal(mcor_tree_level_of(1e30, 1, 24), 24);
  assert_int_equal(mcor_tree_level_of(0.5, 1, 24), 0); /* of a solid */
}

/* So many levels that bricks of the lowest could not be numbered. */
static void more_bricks_than_numbers(void** state)
{
  mcor_context* context = *state;
  mcor_options options;
  mcor_input input;
  core_set set = core_make_block(4, 0, 1, core_slope);
  measure(context, &set, 24, &options, &input);
  context->lattice.levels = 24; /* as with h 1:10^7 and a cube size that lets the lattice be */
  assert_int_equal(mcor_make_tree(context, &input), MCOR_OUT_OF_CAPACITY);
  CORE_CHECK(strstr(mcor_last_error(context), "24 levels"), "%s", mcor_last_error(context));
  context->run.options = NULL;
  core_free_set(&set);
}

/* Particles that reach far beyond their volume: that there are too many leaves is known before the sets
 * of bricks grow large. */
static void more_leaves_than_the_limit(void** state)
{
  mcor_context* context = *state;
  mcor_options options;
  mcor_input input;
  core_set set = core_make_random(3, 40, 1, 1, 3);
  set.smoothing_length[0] = 8;
  measure(context, &set, 24, &options, &input);
  options.h_scale = 220;
  CORE_OK(context, mcor_measure_input(context, &input, &options));
  assert_int_equal(mcor_make_tree(context, &input), MCOR_OUT_OF_CAPACITY);
  CORE_CHECK(strstr(mcor_last_error(context), "leaves"), "%s", mcor_last_error(context));
  size_t room = 0;
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    room += context->tree.split[l].clusters.capacity * sizeof(mcor_entry);
  }
  CORE_CHECK(room < 50000000, "%lld bytes", (long long)room);
  mcor_release_tree(&context->tree);
  context->run.options = NULL;
  core_free_set(&set);
}

/* Each level alone is within the limit. Where they are sparse, bricks that have to be divided because of
 * others are many more than those that particles divide. */
static void more_leaves_of_all_levels(void** state)
{
  mcor_context* context = *state;
  mcor_options options;
  mcor_input input;
  core_set set = core_make_random(90000, 1, 3e-6, 0.03, 3);
  measure(context, &set, 24, &options, &input);
  assert_int_equal(mcor_make_tree(context, &input), MCOR_OUT_OF_CAPACITY);
  CORE_CHECK(strstr(mcor_last_error(context), "leaves"), "%s", mcor_last_error(context));
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    assert_in_range(context->tree.split[l].count, 0, 4000000);
  }
  assert_null(context->tree.leaves);
  mcor_release_tree(&context->tree);
  context->run.options = NULL;
  core_free_set(&set);
}

static int stop_at(void* user, double fraction, const char* phase)
{
  int* left = user;
  (void)fraction;
  (void)phase;
  return (*left)-- == 0;
}

/* Whoever waits is asked whether to go on all along: while particles split bricks, few at a time where
 * they reach far, while bricks are joined and split, and while leaves are listed. */
static void making_leaves_can_be_cancelled(void** state)
{
  enum
  {
    often = 1 << 20
  };
  mcor_context* context = *state;
  const double interval = context->report_interval;
  mcor_options options;
  mcor_input input;
  core_set set = core_make_random(6000, 20, 0.2, 4, 5);
  int left = often;
  measure(context, &set, 24, &options, &input);
  options.h_scale = 20;
  CORE_OK(context, mcor_measure_input(context, &input, &options));
  options.progress = stop_at;
  options.progress_user = &left;
  context->report_interval = 0;
  context->run.fraction_end = 1;
  CORE_OK(context, mcor_make_tree(context, &input));
  const int calls = often - left, splits = (int)context->tree.split[1].count;
  CORE_CHECK(calls > 50, "%d calls, %d bricks of level 1", calls, splits);
  for (int stop = 0; stop < calls; stop += 1 + stop / 3)
  {
    left = stop;
    assert_int_equal(mcor_make_tree(context, &input), MCOR_CANCELLED);
    assert_int_equal(left, -1); /* and no more */
  }
  left = often;
  CORE_OK(context, mcor_make_tree(context, &input));
  assert_int_equal(often - left, calls);
  context->report_interval = interval;
  context->run.options = NULL;
  core_free_set(&set);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(more_bricks_than_numbers),
    cmocka_unit_test(making_leaves_can_be_cancelled), cmocka_unit_test(more_leaves_than_the_limit),
    cmocka_unit_test(more_leaves_of_all_levels),
    cmocka_unit_test(leaves_are_those_of_the_definition), cmocka_unit_test(order_and_limit),
    cmocka_unit_test(blocks), cmocka_unit_test(levels_of_particles) };
  return cmocka_run_group_tests(tests, core_set_up, core_tear_down);
}
