/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The cells of pairs [III-C] grow across the sides of boxes, and of periods, in rounds: when a box has
 * grown to its end, cells near its sides that are new are told to the boxes there, which go on from those in
 * them and in the ring around them, until none is new anywhere. Then each box has, of its cells and its
 * ring, those that one run over all would have examined: a step of growth begins in a used cell, whose
 * box has right values at its nodes, and ends in a cell of that box or of its ring. */

#include "mcor_box.h"
#include "mcor_pair.h"
#include "mcor_ranks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A cell of the world's lattice of a level. */
typedef struct mcor_world_cell
{
  int64_t at[3], level;
} mcor_world_cell;

typedef struct mcor_cell_list
{
  mcor_world_cell* cells;
  int64_t count, room;
} mcor_cell_list;

static mcor_status mcor_add_cell(
  mcor_context* context, mcor_cell_list* list, const mcor_world_cell* cell)
{
  MCOR_TRY(
    mcor_make_room(context, (void**)&list->cells, list->count, &list->room, sizeof *list->cells));
  list->cells[list->count++] = *cell;
  return MCOR_OK;
}

/* Whether other boxes may want to know of a cell: all beside it are not in this one. */
static bool mcor_is_near_side(const mcor_context* context, const int64_t at[3], int level)
{
  const mcor_box* box = &context->box;
  const int64_t edge = INT64_C(2) << level; /* in halves of the smallest cubes */
  bool near = false;
  for (int a = 0; a < 3; ++a)
  {
    near = near || (at[a] - 1) * edge < box->near[a] || (at[a] + 2) * edge > box->near[3 + a];
  }
  return near;
}

/* Where it is in the period, from the lattice's origin. */
static int64_t mcor_wrap_cell(const mcor_lattice* lattice, int axis, int64_t at, int level)
{
  const int64_t period = lattice->period[axis] / (1 << level);
  const int64_t first = lattice->period_first[axis] / (1 << level), from = at - first;
  return period > 0 ? (from % period + period) % period + first : at;
}

/* Lists a brick's cells near the sides of the box. */
static mcor_status mcor_list_brick(
  mcor_context* context, const cl_int brick[4], cl_ulong cells, mcor_cell_list* list)
{
  const mcor_lattice* lattice = &context->lattice;
  const int level = brick[3];
  for (int c = 0; c < MCOR_BRICK_NODES; ++c)
  {
    const int64_t at[3] = { brick[0] * MCOR_BRICK + (c & 3), brick[1] * MCOR_BRICK + (c >> 2 & 3),
      brick[2] * MCOR_BRICK + (c >> 4) };
    if (cells >> c & 1 && mcor_is_near_side(context, at, level))
    {
      mcor_world_cell cell = { .level = level };
      for (int a = 0; a < 3; ++a)
      {
        cell.at[a] = mcor_wrap_cell(lattice, a, at[a], level) + lattice->origin[a] / (1 << level);
      }
      MCOR_TRY(mcor_add_cell(context, list, &cell));
    }
  }
  return MCOR_OK;
}

/* Where a brick is: given by its slot, or by its number among the blocks' bricks. */
static void mcor_locate_place(
  const mcor_context* context, const void* bricks, size_t place, cl_int brick[4])
{
  if (mcor_is_adaptive(context))
  {
    memcpy(brick, (const cl_int*)bricks + 4 * place, 4 * sizeof *brick);
    return;
  }
  uint64_t block = ((const cl_ulong*)bricks)[place / MCOR_BLOCK_BRICKS];
  for (int a = 0; a < 3; ++a)
  {
    const uint64_t n = (uint64_t)context->lattice.blocks[a];
    brick[a] = (int)(block % n) * 8 + (int)(place >> 3 * a & 7);
    block /= n;
  }
  brick[3] = 0;
}

/* The cells that are new since the last round. */
static mcor_status mcor_list_new_cells(mcor_context* context, mcor_cell_list* list)
{
  mcor_box* box = &context->box;
  const bool adaptive = mcor_is_adaptive(context);
  const size_t count = mcor_count_places(context);
  const mcor_buffer *where = adaptive ? &context->bricks.now.bricks : &context->bricks.block_keys,
                    *reached = &context->pairs.reached;
  void *bricks, *cells;
  if (count == 0)
  {
    return MCOR_OK;
  }
  box->told = box->told ? box->told : calloc(count, sizeof *box->told);
  MCOR_TRY(mcor_allocated(context, box->told));
  const size_t bytes =
    adaptive ? count * 4 * sizeof(cl_int) : count / MCOR_BLOCK_BRICKS * sizeof(cl_ulong);
  MCOR_TRY(mcor_map(context, where, bytes, false, &bricks));
  mcor_status status = mcor_map(context, reached, count * sizeof(cl_ulong), false, &cells);
  for (size_t i = 0; i < count && status == MCOR_OK; ++i)
  {
    const cl_ulong mask = ((const cl_ulong*)cells)[i], fresh = mask & ~box->told[i];
    if (fresh)
    {
      cl_int brick[4];
      mcor_locate_place(context, bricks, i, brick);
      status = mcor_list_brick(context, brick, fresh, list);
      box->told[i] = mask;
    }
  }
  const mcor_status unmapped = mcor_unmap(context, reached, &cells);
  const mcor_status last = mcor_unmap(context, where, &bricks);
  return status != MCOR_OK ? status : unmapped != MCOR_OK ? unmapped : last;
}

/* Whether a cell is in the box or its ring, along an axis. */
static bool mcor_is_near(const mcor_context* context, int axis, int64_t at, int level)
{
  const mcor_box* box = &context->box;
  const int64_t edge = INT64_C(2) << level; /* see mcor_box_clip */
  return (at + 2) * edge >= box->near[axis] && (at - 1) * edge <= box->near[3 + axis];
}

/* Of a cell's images at whole periods, those in the box and its ring, as the device wants them: four
 * numbers each, the last one the level. At most 27; returns how many. */
static int mcor_place_cell(const mcor_context* context, const mcor_world_cell* cell, cl_int* to)
{
  const mcor_lattice* lattice = &context->lattice;
  const int level = (int)cell->level;
  int count = 0;
  for (int image = 0; image < 27; ++image)
  {
    const int k[3] = { image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1 };
    bool in = true;
    for (int a = 0; a < 3; ++a)
    {
      const int64_t at =
        cell->at[a] + (k[a] * (int64_t)lattice->period[a] - lattice->origin[a]) / (1 << level);
      in = in && (k[a] == 0 || lattice->period[a] > 0) && mcor_is_near(context, a, at, level);
      to[4 * count + a] = in ? (cl_int)at : 0;
    }
    to[4 * count + 3] = level;
    count += in;
  }
  return count;
}

/* Takes what is in this box of what all boxes tell. */
static mcor_status mcor_hear_cells(
  mcor_context* context, const mcor_world_cell* told, int64_t count, mcor_take take, bool* fresh)
{
  cl_int* places = NULL;
  int64_t found = 0, room = 0;
  *fresh = false;
  for (int64_t i = 0; i < count; ++i)
  {
    if (found + 27 > room)
    {
      room = 2 * room + 1024;
      cl_int* grown = realloc(places, (size_t)room * 4 * sizeof *grown);
      if (!grown || room > MCOR_COUNT_LIMIT)
      {
        free(grown ? grown : places);
        return mcor_allocated(context, false);
      }
      places = grown;
    }
    found += mcor_place_cell(context, told + i, places + 4 * found);
  }
  const mcor_status status = found > 0 ? take(context, places, (int)found, fresh) : MCOR_OK;
  free(places);
  return status;
}

/* Tells other boxes, and hears from them, of new cells. */
static mcor_status mcor_tell_cells(
  mcor_context* context, const mcor_cell_list* list, const void** all, int64_t* count)
{
  const mcor_lattice* lattice = &context->lattice;
  double* places = malloc(((size_t)list->count + 1) * 3 * sizeof *places);
  MCOR_TRY(mcor_allocated(context, places));
  for (int64_t i = 0; i < 3 * list->count; ++i)
  {
    const mcor_world_cell* cell = &list->cells[i / 3];
    places[i] = ((double)cell->at[i % 3] + 0.5) * ldexp(lattice->edge[i % 3], (int)cell->level);
  }
  /* Boxes' sides are rounded to cells. */
  const mcor_status status = mcor_pass(context, list->cells, list->count, sizeof *list->cells,
    places, (MCOR_BOX_RING + 1) * ldexp(lattice->cube, lattice->top), all, count);
  free(places);
  return status;
}

mcor_status mcor_exchange_cells(mcor_context* context, mcor_take take, bool* grown)
{
  mcor_cell_list list = { 0 };
  const void* all;
  int64_t count = 0, fresh = 0;
  *grown = false;
  if (!mcor_is_limited(context) && !context->run.options->ranks)
  {
    return MCOR_OK;
  }
  mcor_status status = mcor_list_new_cells(context, &list);
  status = status == MCOR_OK ? mcor_tell_cells(context, &list, &all, &count) : status;
  if (status == MCOR_OK && context->grid.count > 0 && take)
  {
    bool some;
    status = mcor_hear_cells(context, all, count, take, &some);
    fresh = some;
  }
  free(list.cells);
  MCOR_TRY(status);
  MCOR_TRY(mcor_reduce_count(context, MCOR_GREATEST, &fresh));
  *grown = fresh != 0;
  return MCOR_OK;
}

/* Forgets what others know of: they have been told it for one iso value. */
void mcor_end_rounds(mcor_context* context)
{
  free(context->box.told);
  context->box.told = NULL;
}

/* Of a box without cells, while others grow. */
mcor_status mcor_attend_growth(mcor_context* context)
{
  for (bool grown = true; grown;)
  {
    MCOR_TRY(mcor_exchange_cells(context, NULL, &grown));
  }
  return MCOR_OK;
}

/* Of a rank that has nothing to do, for all iso values from number `first` on. */
mcor_status mcor_attend_rounds(mcor_context* context, int first)
{
  const bool all = context->run.options->ranks && mcor_uses_pairs(context);
  context->bricks.now.count = all ? 0 : context->bricks.now.count;
  context->bricks.block_count = all ? 0 : context->bricks.block_count;
  for (int i = first; i < context->run.options->iso_count && all; ++i)
  {
    MCOR_TRY(mcor_attend_growth(context));
  }
  return MCOR_OK;
}
