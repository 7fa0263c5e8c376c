/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests how the leaves of adaptive cubes (bricks that are not split) are made: levels, limits, cancelling. The oracle
 * checks that the leaves are the right ones. */

#include "core_fixture.h"
#include "mcor_tree.h"

/* measure() sets these two variables for each test. The context keeps a pointer to the options. */
static mcor_input input;
static mcor_options options;

static void measure(mcor_context* context, const particle_set* set, int limit)
{
  static const double iso = 0.5;
  input = core_input(set);
  options = core_options(&iso);
  options.field = MCOR_WEIGHT_SUM;
  options.level_limit = limit;
  context->run.options = &options;
  context->kept.uses_solids = false;
  context->space.axes = 3;
  CORE_OK(context, mcor_measure_input(context, &input, &options));
}

static void level_limit(void** state)
{
  mcor_context* context = *state;
  CORE_SET set = core_make_random(20000, 200, 0.5, 20, 7);
  for (int limit = 2; limit <= 24; limit += 22)
  {
    measure(context, &set, limit);
    CORE_OK(context, mcor_make_tree(context, &input));
    const int top = context->tree.top;
    assert_in_range(top, limit == 2 ? 2 : 4, limit == 2 ? 2 : 5);
    assert_int_equal(context->tree.first_block[top + 1], context->tree.block_count);
  }
}

/* Level L of cubes begins at a smoothing length of exactly 2^L times the smallest h. */
static void levels_of_particles(void** state)
{
  assert_int_equal(mcor_tree_level_of(1, 1, 24), 0);
  assert_int_equal(mcor_tree_level_of(nextafter(2, 0), 1, 24), 0);
  assert_int_equal(mcor_tree_level_of(2, 1, 24), 1);
  assert_int_equal(mcor_tree_level_of(0.3 * 1024, 0.3, 24), 10);
  assert_int_equal(mcor_tree_level_of(nextafter(0.3 * 1024, 0), 0.3, 24), 9);
  assert_int_equal(mcor_tree_level_of(1e30, 1, 24), 24);
  /* A solid smaller than all fluid has level 0. */
  assert_int_equal(mcor_tree_level_of(0.5, 1, 24), 0);
}

/* Checks the error of too many levels: the lowest level would have more bricks than an int can count. */
static void more_bricks_than_numbers(void** state)
{
  mcor_context* context = *state;
  CORE_SET set = core_make_block(4, 0, 1, core_slope);
  measure(context, &set, 24);
  /* Smoothing lengths from 1 to 10^7 give this many levels, with a cube size that the lattice
   * allows. */
  context->lattice.levels = 24;
  CORE_FAILS(context, MCOR_OUT_OF_CAPACITY, mcor_make_tree(context, &input), "LEVELS_TOO_MANY|24 ");
}

/* Particles reach far beyond their volume. The run must notice that there are too many leaves before the sets of bricks
 * grow large. */
static void more_leaves_than_the_limit(void** state)
{
  mcor_context* context = *state;
  CORE_SET set = core_make_random(3, 40, 1, 1, 3);
  set.smoothing_length[0] = 8;
  measure(context, &set, 24);
  options.h_scale = 220;
  CORE_OK(context, mcor_measure_input(context, &input, &options));
  CORE_FAILS(context, MCOR_OUT_OF_CAPACITY, mcor_make_tree(context, &input), "LEAVES_TOO_MANY");
  size_t room = 0;
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    room += context->tree.split[l].clusters.capacity * sizeof(mcor_entry);
  }
  CORE_CHECK(room < 50000000, room);
  mcor_release_tree(&context->tree);
}

/* Each level alone has fewer leaves than the limit, all levels together have more. Where leaves are sparse, most bricks
 * are divided because of neighbouring bricks, few because of particles. */
static void more_leaves_of_all_levels(void** state)
{
  mcor_context* context = *state;
  CORE_SET set = core_make_random(90000, 1, 3e-6, 0.03, 3);
  measure(context, &set, 24);
  CORE_FAILS(context, MCOR_OUT_OF_CAPACITY, mcor_make_tree(context, &input), "LEAVES_TOO_MANY");
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    assert_in_range(context->tree.split[l].count, 0, 4000000);
  }
  assert_null(context->tree.leaves);
  mcor_release_tree(&context->tree);
}

static int stop_at(void* user, double fraction, const char* phase)
{
  int* left = user;
  (void)fraction;
  (void)phase;
  return (*left)-- == 0;
}

/* The run asks its progress callback often whether to go on: while particles split bricks (few particles at a time if
 * they reach far), while bricks are joined and split, and while leaves are listed. Each answer can cancel the run. */
static void making_leaves_can_be_cancelled(void** state)
{
  enum
  {
    often = 1 << 20
  };
  mcor_context* context = *state;
  const double interval = context->report_interval;
  CORE_SET set = core_make_random(6000, 20, 0.2, 4, 5);
  int left = often;
  measure(context, &set, 24);
  options.h_scale = 20;
  CORE_OK(context, mcor_measure_input(context, &input, &options));
  options.progress = stop_at;
  options.progress_user = &left;
  context->report_interval = 0;
  context->run.fraction_end = 1;
  CORE_OK(context, mcor_make_tree(context, &input));
  const int calls = often - left, splits = (int)context->tree.split[1].count;
  CORE_CHECK(calls > 50, calls, splits);
  for (int stop = 0; stop < calls; stop += 1 + stop / 3)
  {
    left = stop;
    assert_int_equal(mcor_make_tree(context, &input), MCOR_CANCELLED);
    assert_int_equal(left, -1); /* no report comes after the one that stopped the run */
  }
  left = often;
  CORE_OK(context, mcor_make_tree(context, &input));
  assert_int_equal(often - left, calls);
  context->report_interval = interval;
}

CORE_MAIN(core_set_up, core_tear_down, more_bricks_than_numbers, making_leaves_can_be_cancelled,
  more_leaves_than_the_limit, more_leaves_of_all_levels, level_limit, levels_of_particles)
