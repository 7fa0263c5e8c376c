/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests surfaces of adaptive cubes: surfaces with one level equal surfaces of uniform cubes, and few nodes are
 * evaluated. The oracle's tests check edges and triangles. core_adaptive_parts tests boxes, and core_warning tests
 * particles of very different sizes. */

#include "core_fixture.h"

static mcor_options adaptive_options(const double* iso)
{
  mcor_options options = core_options(iso);
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  return options;
}

static void one_level_is_uniform(void** state)
{
  static const double iso = 0;
  CORE_SET set = core_make_block(9, 0.3, 3, core_ball);
  const mcor_input input = core_input(&set);
  mcor_options options = adaptive_options(&iso);
  CORE_SURFACE adaptive = core_extract(*state, &input, &options);
  options.level_limit = 0;
  CORE_SURFACE uniform = core_extract(*state, &input, &options);
  assert_true(core_hash(&adaptive) == core_hash(&uniform) && uniform.point_count > 100);
}

/* Particles above z = 0.3 have values above iso, all others below. A leaf (an undivided brick) that certainly lies on
 * one side needs only its nodes next to a crossed edge: on average at most 38 of its 64 nodes are evaluated. */
static void few_nodes_are_evaluated(void** state)
{
  static const double iso = 0.1;
  mcor_context* context = *state;
  CORE_SET set = core_make_graded(16, 0.4);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] = set.position[3 * i + 2] > 0.3 ? 1 : -1;
  }
  const mcor_input input = core_input(&set);
  mcor_options options = adaptive_options(&iso);
  CORE_SURFACE surface = core_extract(context, &input, &options);
  const int64_t nodes = surface.statistics.nodes_evaluated;
  assert_in_range(nodes, 64, 38 * (int64_t)context->tree.leaf_count); /* a leaf has 64 nodes */
  assert_true(surface.statistics.cells_used > 100);
}

CORE_MAIN(core_set_up, core_tear_down, one_level_is_uniform, few_nodes_are_evaluated)
