/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The sparse virtual grid [III-B]: gives slots (places for node values) to the needed bricks. */

#include "mcor_adaptive.h"

void mcor_release_brick_data(mcor_context* context, mcor_brick_data* data)
{
  MCOR_RELEASE_BEFORE(context, data, count);
  data->count = 0;
}

/* Fills bricks.now, the new set of bricks with slots. Bricks that are also in the set `last` get
 * their data from it. */
static mcor_status mcor_fill_bricks(
  mcor_context* context, const mcor_brick_data* last, int count, int words)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_brick_data* now = &bricks->now;
  const size_t n = (size_t)count, values = n * 64 * context->cl.real_size;
  now->count = count;
  MCOR_TRY(mcor_reserve(context, &now->bricks, n * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_fill(context, &now->known, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_fill(context, &now->above, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_fill(context, &now->valid, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &now->value, values));
  MCOR_TRY(mcor_reserve(context, &now->weight, values));
  MCOR_TRY(mcor_reserve(context, &bricks->seeds, n * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_brick_fill", MCOR_MEDIUM, words, MCOR_BRICK_ARGS(context),
    MCOR_BUFFER(&bricks->seed_bits), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&bricks->seeds)));
  if (last->count > 0)
  {
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_brick_move", MCOR_MEDIUM, last->count,
      MCOR_BRICK_ARGS(context), MCOR_INT(last->count), MCOR_BUFFER(&last->bricks),
      MCOR_BUFFER(&last->known), MCOR_BUFFER(&last->above), MCOR_BUFFER(&last->valid),
      MCOR_INT((int)(64 * context->cl.real_size / sizeof(cl_uint))), MCOR_BUFFER(&last->value),
      MCOR_BUFFER(&last->weight), MCOR_BUFFER(&bricks->now.known), MCOR_BUFFER(&bricks->now.above),
      MCOR_BUFFER(&bricks->now.valid), MCOR_BUFFER(&bricks->now.value),
      MCOR_BUFFER(&bricks->now.weight)));
  }
  return MCOR_OK;
}

/* Gives slots to all requested bricks, and keeps the data of bricks that had a slot before. */
mcor_status mcor_place_bricks(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  const int words = bricks->block_count * MCOR_BLOCK_WORDS;
  int count;
  MCOR_TRY(mcor_reserve(context, &bricks->base, ((size_t)words + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_brick_count", MCOR_MEDIUM, words, MCOR_INT(words),
    MCOR_BUFFER(&bricks->bits), MCOR_BUFFER(&bricks->base)));
  MCOR_TRY(mcor_scan(context, &bricks->base, words, &count));
  mcor_brick_data last = bricks->now;
  bricks->now = (mcor_brick_data){ 0 };
  mcor_status status = mcor_fill_bricks(context, &last, count, words);
  mcor_release_brick_data(context, &last);
  for (int l = 1; l < context->lattice.levels && status == MCOR_OK; ++l)
  {
    status = mcor_read(context, &bricks->base,
      (size_t)bricks->first_block[l] * MCOR_BLOCK_WORDS * sizeof(cl_int), &bricks->first_slot[l],
      sizeof(cl_int));
  }
  bricks->first_slot[0] = 0;
  bricks->first_slot[context->lattice.levels] = count;
  return status;
}

/* Finds the slots of the bricks of the same level beside each brick. */
mcor_status mcor_find_neighbours(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  const int count = bricks->now.count;
  MCOR_TRY(mcor_fill(
    context, &bricks->neighbours, 0xff, (size_t)count * MCOR_NEIGHBOURS * sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_brick_neighbours", MCOR_MEDIUM, count, MCOR_BRICK_ARGS(context),
    MCOR_INT(count), MCOR_BUFFER(&bricks->now.bricks), MCOR_BUFFER(&bricks->neighbours));
}
