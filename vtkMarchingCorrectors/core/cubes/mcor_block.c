/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The blocks that may have surface [III-B], found by dividing larger cubes. */

#include "mcor_box.h"

#include <math.h>

/* The first cubes are the smallest that cover the lattice with at most this number of cubes. */
#define MCOR_FIRST_CUBES 32768

/* Finds the states of the cubes in block_keys, and which cubes are inactive (the surface is neither
 * in them nor beside them). Evaluates `parts` cubes: the first ones, or those made by dividing.
 * `index` has their places, or is empty if the places are 0, 1, 2, .... All other cubes are blocks
 * that were kept from an earlier iso value or call, and that lie in larger cubes that are inactive
 * now. These blocks become void, i.e. count as if they did not exist. */
static mcor_status mcor_test_cubes(
  mcor_context* context, int level, const mcor_buffer* index, int parts)
{
  mcor_bricks* bricks = &context->bricks;
  const mcor_box* box = &context->box;
  const int count = bricks->block_count;
  MCOR_TRY(mcor_index_keys(context, &bricks->block_keys, count,
    context->lattice.rungs[level + 1].base, &bricks->block_buckets, &bricks->block_shift));
  MCOR_TRY(mcor_fill(context, &bricks->block_states, MCOR_VOID, (size_t)count));
  MCOR_TRY(mcor_reserve(context, &bricks->inactive, (size_t)count));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_block_states", MCOR_HEAVY, parts, MCOR_GRID_ARGS(context),
    MCOR_INT(parts), MCOR_BUFFER(index), MCOR_BUFFER(&context->bricks.rungs),
    MCOR_BUFFER(&bricks->block_keys), MCOR_SEED_ARGS(context),
    MCOR_CELL_ARGS(box->first, box->last, box->is_part ? box->ring : MCOR_ENDLESS_RING),
    MCOR_BUFFER(&bricks->block_states)));
  return MCOR_LAUNCH(context, "mcor_block_find_inactive", MCOR_HEAVY, count,
    MCOR_BLOCK_ARGS(context), MCOR_BUFFER(&bricks->block_states), MCOR_BUFFER(&bricks->inactive));
}

/* The largest number of blocks. If a quarter had surface, there would be too many triangles. */
#define MCOR_BLOCK_LIMIT (1 << 20)

/* Replaces the cubes of a level by the parts of the active cubes among them. If the parts are
 * blocks (level is 1), also adds the blocks `kept`. *parts: the number of parts of all active
 * cubes, without `kept`. */
static mcor_status mcor_divide_cubes(mcor_context* context, int level, uint64_t limit,
  const mcor_buffer* kept, int kept_count, int* parts)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_buffer *counts = &bricks->child_counts, *keys = &bricks->child_keys,
              *index_of = &bricks->child_index;
  const mcor_buffer* rungs = &context->bricks.rungs;
  const int count = bricks->block_count, added = level == 1 ? kept_count : 0;
  MCOR_TRY(mcor_reserve(context, counts, ((size_t)count + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_block_count", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(rungs), MCOR_BUFFER(&bricks->block_keys), MCOR_BUFFER(&bricks->inactive),
    MCOR_BUFFER(counts)));
  MCOR_TRY(mcor_scan(context, counts, count, parts));
  /* foreseen: the least number of blocks that these cubes will become. In cubes that are small
   * against the particles' supports, a surface is nearly flat: each division makes three to four
   * times as many cubes. */
  const double edge = ldexp(context->lattice.cube, level - 1) * MCOR_BLOCK_CUBES;
  const bool is_flat = edge < 0.25 * context->measure.h_median;
  const double foreseen = (double)(*parts + added) * (is_flat ? pow(3, level - 1) : 1);
  MCOR_FAIL_IF(foreseen > MCOR_BLOCK_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    MCOR_SAY(BLOCKS_TOO_MANY), context->lattice.cube,
    foreseen > *parts + added ? "more than" : "at least", foreseen, MCOR_BLOCK_CUBES,
    MCOR_BLOCK_LIMIT);
  MCOR_TRY(mcor_reserve(context, keys, ((size_t)*parts + (size_t)added) * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_block_fill", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(rungs), MCOR_BUFFER(&bricks->block_keys), MCOR_BUFFER(counts), MCOR_BUFFER(keys)));
  MCOR_TRY(mcor_copy(
    context, kept, keys, (size_t)*parts * sizeof(cl_ulong), (size_t)added * sizeof(cl_ulong)));
  return mcor_unique(
    context, keys, *parts + added, limit, &bricks->block_keys, index_of, &bricks->block_count);
}

/* Makes the blocks that may have surface, by dividing larger cubes, and finds the blocks' states.
 * If bricks have slots from an earlier iso value or call, also keeps all blocks made then. */
mcor_status mcor_make_blocks(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_rung* rungs = context->lattice.rungs;
  uint64_t total = UINT64_MAX;
  int level = -1;
  /* Numbers the cubes of all levels. Level 0 has the blocks, the highest level the first cubes. A
   * cube is 32 << level nodes long. */
  for (rungs[0].base = 0; total > MCOR_FIRST_CUBES;
       rungs[level + 1].base = rungs[level].base + total)
  {
    total = 1;
    ++level;
    for (int a = 0; a < 3; ++a)
    {
      rungs[level].n[a] = ((context->lattice.blocks[a] - 1) >> level) + 1;
      total *= (uint64_t)rungs[level].n[a];
    }
  }
  MCOR_TRY(
    mcor_write(context, &context->bricks.rungs, rungs, (size_t)(level + 2) * sizeof rungs[0]));
  const mcor_buffer none = { 0 }, *index = &none;
  mcor_buffer kept = { 0 };
  const int kept_count = bricks->now.count > 0 ? bricks->block_count : 0;
  if (kept_count > 0)
  {
    kept = bricks->block_keys;
    bricks->block_keys = (mcor_buffer){ 0 };
  }
  int parts = bricks->block_count = (int)total;
  mcor_status status =
    mcor_reserve(context, &bricks->block_keys, (size_t)bricks->block_count * sizeof(cl_ulong));
  MCOR_THEN(status,
    MCOR_LAUNCH(context, "mcor_block_all", MCOR_MEDIUM, bricks->block_count,
      MCOR_INT(bricks->block_count), MCOR_BUFFER(&context->bricks.rungs), MCOR_INT(level),
      MCOR_BUFFER(&bricks->block_keys)));
  for (; level > 0 && status == MCOR_OK; --level)
  {
    status = mcor_test_cubes(context, level, index, parts);
    MCOR_THEN(
      status, mcor_divide_cubes(context, level, rungs[level].base, &kept, kept_count, &parts));
    index = &bricks->child_index;
  }
  mcor_release(context, &kept);
  MCOR_TRY(status);
  MCOR_TRY(mcor_test_cubes(context, 0, index, parts));
  bricks->first_block[1] = bricks->block_count;
  return MCOR_OK;
}
