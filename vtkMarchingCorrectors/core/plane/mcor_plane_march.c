/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Marching squares: see mcor_plane.cl. */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_plane.h"

mcor_status mcor_spread_signs(mcor_context* context)
{
  const mcor_brick_data* now = &context->bricks.now;
  return !mcor_is_plane(context)
    ? MCOR_OK
    : MCOR_LAUNCH(context, "mcor_plane_spread", MCOR_LIGHT, now->count, MCOR_INT(now->count),
        MCOR_BUFFER(&now->above), MCOR_BUFFER(&now->valid));
}

/* Requests the bricks that are not certain. */
mcor_status mcor_find_seeds_in_plane(mcor_context* context, double iso)
{
  const mcor_bricks* bricks = &context->bricks;
  return MCOR_LAUNCH(context, "mcor_plane_seeds", MCOR_HEAVY,
    (size_t)bricks->block_count * MCOR_BLOCK_REGIONS, MCOR_GRID_ARGS(context),
    MCOR_INT(bricks->block_count), MCOR_INT(context->lattice.blocks[0]),
    MCOR_INT(context->lattice.blocks[1]), MCOR_BUFFER(&bricks->block_keys),
    MCOR_BUFFER(&bricks->block_states), MCOR_SEED_ARGS(context, iso), MCOR_BUFFER(&bricks->states),
    MCOR_BUFFER(&bricks->seed_bits));
}

mcor_status mcor_keep_squares(mcor_context* context, int leaves)
{
  return !mcor_is_plane(context) ? MCOR_OK
                                 : MCOR_LAUNCH(context, "mcor_plane_squares", MCOR_LIGHT, leaves,
                                     MCOR_INT(leaves), MCOR_BUFFER(&context->mesh.used));
}

void mcor_count_squares(const mcor_context* context, mcor_statistics* s)
{
  const bool counted =
    mcor_uses_pairs(context) || mcor_is_adaptive(context) || context->box.is_part;
  const int64_t squares = counted ? s->seed_cells : s->seed_cells / MCOR_BRICK;
  s->seed_cells_not_intersected -= s->seed_cells - squares;
  s->seed_cells = squares;
  s->nodes_evaluated /= MCOR_BRICK;
}
