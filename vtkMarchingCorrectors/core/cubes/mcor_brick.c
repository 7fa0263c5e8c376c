/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The sparse virtual grid [III-B]: gives slots to the bricks that are needed. */

#include "mcor_internal.h"

static mcor_status mcor_reserve_bricks(mcor_context* context, mcor_brick_data* data, int count)
{
  const size_t n = (size_t)count;
  const size_t values = n * 64 * context->cl.real_size;
  data->count = count;
  MCOR_TRY(mcor_reserve(context, &data->bricks, n * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_fill(context, &data->known, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(
    mcor_fill(context, &data->cells, mcor_uses_pairs(context) ? 0 : 0xff, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_fill(context, &data->examined, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_fill(context, &data->above, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_fill(context, &data->valid, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &data->value, values));
  return mcor_reserve(context, &data->weight, values);
}

void mcor_release_brick_data(mcor_context* context, mcor_brick_data* data)
{
  MCOR_RELEASE(context, &data->bricks, &data->known, &data->cells, &data->examined, &data->value,
    &data->weight, &data->above, &data->valid);
  data->count = 0;
}

void mcor_release_bricks(mcor_context* context)
{
  mcor_bricks* b = &context->bricks;
  MCOR_RELEASE(context, &b->block_keys, &b->block_buckets, &b->block_states, &b->inactive,
    &b->states, &b->bits, &b->base, &b->seed_bits, &b->seeds, &b->neighbours, &b->placed,
    &b->slot_of, &b->need, &b->fresh, &b->bit_counts, &b->child_counts, &b->child_keys,
    &b->child_index, &b->regions, &b->pair_cells, &b->found);
  mcor_release_brick_data(context, &b->now);
}

/* Fills the new set, and moves what is known of the last one there. */
static mcor_status mcor_fill_bricks(
  mcor_context* context, const mcor_brick_data* last, int count, int words)
{
  mcor_bricks* bricks = &context->bricks;
  MCOR_TRY(mcor_reserve_bricks(context, &bricks->now, count));
  MCOR_TRY(mcor_reserve(context, &bricks->seeds, (size_t)count * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_brick_fill", MCOR_MEDIUM, words, MCOR_BRICK_ARGS(context),
    MCOR_BUFFER(&bricks->seed_bits), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&bricks->seeds)));
  if (last->count > 0)
  {
    MCOR_TRY(
      MCOR_LAUNCH(context, "mcor_brick_move", MCOR_MEDIUM, last->count, MCOR_BRICK_ARGS(context),
        MCOR_INT(last->count), MCOR_BUFFER(&last->bricks), MCOR_BUFFER(&last->known),
        MCOR_BUFFER(&last->cells), MCOR_BUFFER(&last->examined), MCOR_BUFFER(&last->above),
        MCOR_BUFFER(&last->valid), MCOR_INT((int)(64 * context->cl.real_size / sizeof(cl_uint))),
        MCOR_BUFFER(&last->value), MCOR_BUFFER(&last->weight), MCOR_BUFFER(&bricks->now.known),
        MCOR_BUFFER(&bricks->now.cells), MCOR_BUFFER(&bricks->now.examined),
        MCOR_BUFFER(&bricks->now.above), MCOR_BUFFER(&bricks->now.valid),
        MCOR_BUFFER(&bricks->now.value), MCOR_BUFFER(&bricks->now.weight)));
  }
  bricks->neighbours_valid = false;
  mcor_release(context, &bricks->placed);
  mcor_release(context, &bricks->slot_of);
  return MCOR_OK;
}

/* Slots of the bricks beside each. */
mcor_status mcor_find_neighbours(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  const int count = bricks->now.count;
  if (bricks->neighbours_valid)
  {
    return MCOR_OK;
  }
  bricks->neighbours_valid = true;
  MCOR_TRY(mcor_fill(
    context, &bricks->neighbours, 0xff, (size_t)count * MCOR_NEIGHBOURS * sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_brick_neighbours", MCOR_MEDIUM, count, MCOR_BRICK_ARGS(context),
    MCOR_INT(count), MCOR_BUFFER(&bricks->now.bricks), MCOR_BUFFER(&bricks->neighbours));
}

/* Gives slots to all bricks that were asked for, and keeps what is known of those that had one. */
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
  const mcor_status status = mcor_fill_bricks(context, &last, count, words);
  mcor_release_brick_data(context, &last);
  return status;
}

static mcor_status mcor_index_bricks(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  const size_t words = (size_t)bricks->block_count * MCOR_BLOCK_WORDS;
  MCOR_TRY(mcor_fill(context, &bricks->placed, 0, words * sizeof(cl_uint)));
  MCOR_TRY(mcor_fill(context, &bricks->slot_of, 0xff, words * 32 * sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_brick_index", MCOR_MEDIUM, bricks->now.count,
    MCOR_BLOCK_ARGS(context), MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&bricks->placed), MCOR_BUFFER(&bricks->slot_of));
}

/* Room for `count` bricks, and for half as many more where that takes larger buffers. */
static mcor_status mcor_extend_bricks(mcor_context* context, size_t count)
{
  mcor_brick_data* data = &context->bricks.now;
  const size_t old = (size_t)data->count, mask = sizeof(cl_ulong);
  const size_t values = 64 * context->cl.real_size;
  const struct
  {
    mcor_buffer* buffer;
    size_t size;
  } parts[] = { { &data->bricks, 4 * sizeof(cl_int) }, { &data->known, mask },
    { &data->cells, mask }, { &data->examined, mask }, { &data->above, mask },
    { &data->valid, mask }, { &data->value, values }, { &data->weight, values },
    { &context->bricks.neighbours, MCOR_NEIGHBOURS * sizeof(cl_int) } };
  for (size_t i = 0; i < sizeof parts / sizeof parts[0]; ++i)
  {
    const size_t bytes = count * parts[i].size;
    if (parts[i].buffer->size < bytes)
    {
      MCOR_TRY(mcor_extend(context, parts[i].buffer, old * parts[i].size, bytes + bytes / 2));
    }
  }
  return MCOR_OK;
}

/* Gives slots behind the others to bricks that were asked for; mcor_place_bricks puts all in
 * order. */
mcor_status mcor_append_bricks(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_brick_data* now = &bricks->now;
  const int words = bricks->block_count * MCOR_BLOCK_WORDS, first = now->count;
  int added;
  if (!bricks->slot_of.mem)
  {
    MCOR_TRY(mcor_index_bricks(context));
  }
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_brick_count_new", MCOR_MEDIUM, words, MCOR_INT(words),
    MCOR_BUFFER(&bricks->bits), MCOR_BUFFER(&bricks->placed), MCOR_BUFFER(&bricks->base)));
  MCOR_TRY(mcor_scan(context, &bricks->base, words, &added));
  MCOR_TRY(mcor_extend_bricks(context, (size_t)first + (size_t)added));
  now->count += added;
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_brick_append", MCOR_MEDIUM, words, MCOR_BLOCK_ARGS(context),
    MCOR_INT(first), MCOR_BUFFER(&bricks->bits), MCOR_BUFFER(&bricks->base),
    MCOR_BUFFER(&bricks->placed), MCOR_BUFFER(&bricks->slot_of), MCOR_BUFFER(&now->bricks),
    MCOR_BUFFER(&bricks->neighbours), MCOR_BUFFER(&now->known), MCOR_BUFFER(&now->cells),
    MCOR_BUFFER(&now->examined), MCOR_BUFFER(&now->above), MCOR_BUFFER(&now->valid)));
  return MCOR_LAUNCH(context, "mcor_brick_join", MCOR_MEDIUM, added, MCOR_BLOCK_ARGS(context),
    MCOR_INT(first), MCOR_INT(now->count), MCOR_BUFFER(&now->bricks), MCOR_BUFFER(&bricks->slot_of),
    MCOR_BUFFER(&bricks->neighbours));
}
