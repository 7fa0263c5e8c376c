/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Seed cells [III-C]. */

#include "mcor_internal.h"

/* Up to this many blocks, the lattice's blocks are asked for particles; above, the search cells name
 * their blocks, which costs nothing for empty space but repeats blocks under coarse particles. */
#define MCOR_BLOCKS_ASKED (1 << 22)

#define MCOR_CHUNK_PARTICLES 16 /* MCOR_CHUNK of mcor_seed.cl */

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
  return mcor_fill(context, &bricks->bits, 0, words * sizeof(cl_uint));
}

/* States of the blocks (per_block 1), their regions (64) or bricks (512); see mcor_seed.cl. */
static mcor_status mcor_find_states(mcor_context* context, double iso, int per_block,
  const mcor_buffer* before, mcor_buffer* states)
{
  mcor_bricks* bricks = &context->bricks;
  const int count = bricks->block_count * per_block;
  MCOR_TRY(mcor_reserve(context, states, (size_t)count));
  return MCOR_LAUNCH(context, "mcor_seed_states", per_block == 1 ? MCOR_HEAVY : MCOR_LIGHT, count,
    MCOR_GRID_ARGS(context),
    MCOR_INT(bricks->block_count), MCOR_INT(context->lattice.blocks[0]),
    MCOR_INT(context->lattice.blocks[1]), MCOR_BUFFER(&bricks->block_keys), MCOR_INT(per_block),
    MCOR_BUFFER(before), MCOR_BUFFER(&context->grid.sides), MCOR_REAL(iso), MCOR_REAL(context->options->node_threshold),
    MCOR_BUFFER(states));
}

/* Asks for every brick whose nodes must be evaluated. */
static mcor_status mcor_ask_complete(mcor_context* context, double iso)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_buffer *of_blocks = &context->scratch[0], *of_regions = &context->scratch[1],
              *quiet = &context->scratch[2];
  MCOR_TRY(mcor_reserve(context, of_blocks, 1));
  MCOR_TRY(mcor_find_states(context, iso, 1, of_blocks, of_blocks));
  MCOR_TRY(mcor_find_states(context, iso, 64, of_blocks, of_regions));
  MCOR_TRY(
    mcor_find_states(context, iso, MCOR_BLOCK_BRICKS, of_regions, &bricks->states));
  MCOR_TRY(mcor_reserve(context, quiet, (size_t)bricks->block_count));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_seed_quiet", MCOR_LIGHT, bricks->block_count,
    MCOR_BLOCK_ARGS(context), MCOR_BUFFER(of_blocks), MCOR_BUFFER(quiet)));
  return MCOR_LAUNCH(context, "mcor_seed_ask", MCOR_LIGHT,
    bricks->block_count * MCOR_BLOCK_BRICKS, MCOR_BLOCK_ARGS(context), MCOR_BUFFER(quiet),
    MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&bricks->bits));
}

/* Evaluated bricks may show that a brick left out must be evaluated too; see mcor_seed.cl. */
mcor_status mcor_grow_bricks(mcor_context* context, bool* grown)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_mesh* mesh = &context->mesh;
  mcor_buffer* flag = &context->scratch[1];
  cl_int value;
  MCOR_TRY(mcor_fill(context, flag, 0, sizeof value));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_seed_grow", MCOR_LIGHT, bricks->now.count,
    MCOR_BLOCK_ARGS(context), MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&mesh->above), MCOR_BUFFER(&mesh->valid), MCOR_BUFFER(&bricks->states),
    MCOR_BUFFER(&bricks->bits), MCOR_BUFFER(flag)));
  MCOR_TRY(mcor_read(context, flag, 0, &value, sizeof value));
  *grown = value != 0;
  return *grown ? mcor_place_bricks(context) : MCOR_OK;
}

/* The sides of the iso value on which particles are, where the field has values at particles. */
static mcor_status mcor_find_sides(mcor_context* context, double iso)
{
  mcor_grid* grid = &context->grid;
  const int chunks = grid->count / MCOR_CHUNK_PARTICLES + 1;
  MCOR_TRY(mcor_reserve(context, &grid->sides, (size_t)chunks));
  return context->options->field == MCOR_WEIGHT_SUM
    ? MCOR_OK
    : MCOR_LAUNCH(context, "mcor_seed_sides", MCOR_LIGHT, chunks, MCOR_INT(grid->count),
        MCOR_BUFFER(grid->has_solids ? &grid->fluid_weight : &grid->trim_weight),
        MCOR_BUFFER(&grid->value), MCOR_REAL(iso), MCOR_BUFFER(&grid->sides));
}

/* Ends with the bricks in place and their cells to examine set. iso: relative to A0. */
mcor_status mcor_select_seeds(mcor_context* context, double iso)
{
  mcor_bricks* bricks = &context->bricks;
  MCOR_RETURN_IF(bricks->block_count > INT32_MAX / MCOR_BLOCK_BRICKS, context, MCOR_OUT_OF_CAPACITY,
    "The virtual grid is too large: %d blocks of 32^3 cells hold particles. Use a larger cube size.",
    bricks->block_count);
  MCOR_TRY(mcor_find_sides(context, iso));
  const bool pairs = mcor_uses_pairs(context);
  MCOR_TRY(pairs ? mcor_mark_pairs(context, iso) : mcor_ask_complete(context, iso));
  MCOR_TRY(mcor_place_bricks(context));
  return pairs ? mcor_mark_pair_cells(context, iso)
               : mcor_fill(context, &bricks->now.cells, 0xff,
                   (size_t)bricks->now.count * sizeof(cl_ulong));
}
