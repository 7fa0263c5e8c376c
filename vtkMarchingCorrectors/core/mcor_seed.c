/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Seed cells [III-C]. */

#include "mcor_internal.h"

/* Up to this many blocks, the lattice's blocks are asked for particles; above, the search cells name
 * their blocks, which costs nothing for empty space but repeats blocks under coarse particles. */
#define MCOR_BLOCKS_ASKED (1 << 22)

static mcor_status mcor_ask_blocks(mcor_context* context, int lattice_blocks)
{
  mcor_bricks* bricks = &context->bricks;
  const int* blocks = context->lattice.blocks;
  mcor_buffer* flags = &context->scratch[0];
  MCOR_TRY(mcor_reserve(context, flags, ((size_t)lattice_blocks + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_seed_reached", MCOR_HEAVY, lattice_blocks,
    MCOR_GRID_ARGS(context), MCOR_INT(lattice_blocks), MCOR_INT(blocks[0]), MCOR_INT(blocks[1]),
    MCOR_BUFFER(flags)));
  MCOR_TRY(mcor_scan(context, flags, lattice_blocks, &bricks->block_count));
  MCOR_TRY(mcor_reserve(
    context, &bricks->block_keys, (size_t)bricks->block_count * sizeof(cl_ulong)));
  return MCOR_LAUNCH(context, "mcor_seed_reached_fill", MCOR_LIGHT, lattice_blocks,
    MCOR_INT(lattice_blocks), MCOR_BUFFER(flags), MCOR_BUFFER(&bricks->block_keys));
}

static mcor_status mcor_name_blocks(mcor_context* context, uint64_t key_limit)
{
  mcor_bricks* bricks = &context->bricks;
  const mcor_grid* grid = &context->grid;
  const int* blocks = context->lattice.blocks;
  mcor_buffer *counts = &context->scratch[0], *keys = &context->scratch[1],
              *index_of = &context->scratch[2];
  int key_count;
  MCOR_TRY(mcor_reserve(context, counts, ((size_t)grid->count + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_block_count", MCOR_LIGHT, grid->count,
    MCOR_GRID_ARGS(context), MCOR_INT(blocks[0]), MCOR_INT(blocks[1]), MCOR_INT(blocks[2]),
    MCOR_BUFFER(counts)));
  MCOR_TRY(mcor_scan(context, counts, grid->count, &key_count));
  MCOR_TRY(mcor_reserve(context, keys, (size_t)key_count * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_block_fill", MCOR_LIGHT, grid->count,
    MCOR_GRID_ARGS(context), MCOR_INT(blocks[0]), MCOR_INT(blocks[1]), MCOR_INT(blocks[2]),
    MCOR_BUFFER(counts), MCOR_BUFFER(keys)));
  return mcor_unique(
    context, keys, key_count, key_limit, &bricks->block_keys, index_of, &bricks->block_count);
}

/* The blocks that particles reach. They do not depend on scalar or iso value. */
mcor_status mcor_make_blocks(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  const int* blocks = context->lattice.blocks;
  const uint64_t key_limit = (uint64_t)blocks[0] * (uint64_t)blocks[1] * (uint64_t)blocks[2];
  MCOR_TRY(key_limit <= MCOR_BLOCKS_ASKED ? mcor_ask_blocks(context, (int)key_limit)
                                          : mcor_name_blocks(context, key_limit));
  MCOR_TRY(mcor_index_keys(context, &bricks->block_keys, bricks->block_count, key_limit,
    &bricks->block_buckets, &bricks->block_shift));
  const size_t words = (size_t)bricks->block_count * MCOR_BLOCK_WORDS;
  bricks->now.count = 0;
  return mcor_zero(context, &bricks->bits, words * sizeof(cl_uint));
}

/* Tests blocks (size 32) or the regions of the blocks that remain (size 8). */
static mcor_status mcor_test_regions(mcor_context* context, double iso, int size,
  int regions_per_block, const mcor_buffer* block_keep, mcor_buffer* keep)
{
  mcor_bricks* bricks = &context->bricks;
  const int regions = bricks->block_count * regions_per_block;
  MCOR_TRY(mcor_reserve(context, keep, (size_t)regions));
  return MCOR_LAUNCH(context, "mcor_seed_region", MCOR_HEAVY, regions, MCOR_GRID_ARGS(context),
    MCOR_INT(bricks->block_count), MCOR_INT(context->lattice.blocks[0]),
    MCOR_INT(context->lattice.blocks[1]), MCOR_BUFFER(&bricks->block_keys), MCOR_INT(size),
    MCOR_BUFFER(block_keep), MCOR_REAL(iso), MCOR_REAL(context->options->node_threshold),
    MCOR_BUFFER(keep));
}

/* Marks every brick box that the bound cannot exclude: blocks, regions, bricks. */
static mcor_status mcor_mark_complete(mcor_context* context, double iso)
{
  mcor_bricks* bricks = &context->bricks;
  const int* blocks = context->lattice.blocks;
  mcor_buffer *block_keep = &bricks->block_keep, *region_keep = &bricks->region_keep;
  MCOR_TRY(mcor_reserve(context, block_keep, (size_t)bricks->block_count));
  MCOR_TRY(mcor_test_regions(context, iso, MCOR_BLOCK_CUBES, 1, block_keep, block_keep));
  MCOR_TRY(mcor_test_regions(context, iso, 8, 64, block_keep, region_keep));
  const int count = bricks->block_count * MCOR_BLOCK_BRICKS;
  MCOR_TRY(mcor_reserve(context, &bricks->inside, (size_t)count));
  if (context->options->field == MCOR_WEIGHT_SUM)
  {
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_seed_inside", MCOR_HEAVY, count, MCOR_GRID_ARGS(context),
      MCOR_INT(bricks->block_count), MCOR_INT(blocks[0]), MCOR_INT(blocks[1]),
      MCOR_BUFFER(&bricks->block_keys), MCOR_BUFFER(region_keep), MCOR_REAL(iso),
      MCOR_BUFFER(&bricks->inside)));
  }
  return MCOR_LAUNCH(context, "mcor_seed_brick", MCOR_HEAVY, count, MCOR_GRID_ARGS(context),
    MCOR_BLOCK_ARGS(context), MCOR_BUFFER(region_keep), MCOR_BUFFER(&bricks->inside),
    MCOR_REAL(iso), MCOR_BUFFER(&bricks->marks));
}

/* Ends with the bricks in place and their cells to examine set. iso: relative to A0. */
mcor_status mcor_select_seeds(mcor_context* context, double iso)
{
  mcor_bricks* bricks = &context->bricks;
  const size_t marks = (size_t)bricks->block_count * MCOR_BLOCK_BRICKS;
  MCOR_RETURN_IF(marks > INT32_MAX, context, MCOR_OUT_OF_CAPACITY,
    "The virtual grid is too large: %d blocks of 32^3 cells hold particles. Use a larger cube size.",
    bricks->block_count);
  MCOR_TRY(mcor_zero(context, &bricks->marks, marks * sizeof(cl_ushort)));
  const bool pairs = mcor_uses_pairs(context);
  MCOR_TRY(pairs ? mcor_mark_pairs(context, iso) : mcor_mark_complete(context, iso));
  MCOR_TRY(mcor_place_bricks(context));
  if (pairs)
  {
    return mcor_mark_pair_cells(context, iso);
  }
  return MCOR_LAUNCH(context, "mcor_seed_cells", MCOR_LIGHT, bricks->now.count,
    MCOR_BLOCK_ARGS(context), MCOR_INT(bricks->now.count),
    MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&bricks->marks), MCOR_BUFFER(&bricks->now.cells));
}
