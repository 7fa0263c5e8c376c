/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Levels, bricks and nodes. */

#include "oracle_graded.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells of the smallest cubes along an edge of a brick. */
static int64_t graded_brick_size(int level)
{
  return (int64_t)GRADED_BRICK << level;
}

/* ---- levels from particles ------------------------------------------------------------------- */

/* One descent from a box around everything: with all particles that reach the brick. */
typedef struct graded_descent
{
  oracle_graded* graded;
  const oracle_field* field;
  int* level; /* [particle count], -1: of no account */
  int listing;
  int64_t node_limit;
} graded_descent;

static int graded_counts(const oracle_particles* p, int64_t j)
{
  return !p->solid[j] || !p->ignore_solids;
}

/* The highest level at which cubes are fine enough for each particle. */
static void graded_set_levels(graded_descent* descent, int level_limit)
{
  const oracle_particles* p = descent->field->particles;
  const double least = oracle_smallest_h(p);
  oracle_graded* graded = descent->graded;
  for (int64_t j = 0; j < p->count; ++j)
  {
    int level = 0;
    while (level < level_limit && p->smoothing_length[j] >= ldexp(least, level + 1))
    {
      ++level;
    }
    descent->level[j] = graded_counts(p, j) ? level : -1;
    graded->top = !p->solid[j] && level > graded->top ? level : graded->top;
  }
}

static int graded_reaches(const graded_descent* descent, int64_t j, const graded_brick* brick)
{
  const oracle_field* field = descent->field;
  const double support =
    oracle_support(field->kernel) * field->h_scale * field->particles->smoothing_length[j];
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double x = field->particles->position[3 * j + axis];
    const double low = (double)brick->at[axis] * descent->graded->cube;
    const double high =
      (double)(brick->at[axis] + graded_brick_size(brick->level)) * descent->graded->cube;
    const double d = fmax(0.0, fmax(low - x, x - high));
    if (d > support)
    {
      return 0;
    }
    square += d * d;
  }
  return field->kernel == ORACLE_M_PRIME_4 || square <= support * support;
}

static int graded_is_split(oracle_graded* graded, const graded_brick* brick)
{
  return graded_map_find(&graded->split, brick->at, brick->level, 0) != NULL;
}

static void graded_split(oracle_graded* graded, const graded_brick* brick)
{
  *graded_map_find(&graded->split, brick->at, brick->level, 1) = 1;
}

/* ---- nodes ------------------------------------------------------------------------------------ */

static int64_t graded_node(oracle_graded* graded, const int64_t at[3], int add)
{
  int64_t* index = graded_map_find(&graded->node_map, at, 0, add);
  if (index && *index < 0)
  {
    int64_t capacity[3] = { graded->node_capacity, graded->node_capacity, graded->node_capacity };
    oracle_lattice* nodes = &graded->nodes;
    const int64_t count = graded->node_count;
    nodes->value = graded_grow(nodes->value, count, &capacity[0], sizeof(double));
    nodes->weight = graded_grow(nodes->weight, count, &capacity[1], sizeof(double));
    nodes->trim_weight = graded_grow(nodes->trim_weight, count, &capacity[2], sizeof(double));
    graded->node_at =
      graded_grow(graded->node_at, count, &graded->node_capacity, 3 * sizeof(int64_t));
    memcpy(&graded->node_at[3 * graded->node_count], at, 3 * sizeof(int64_t));
    *index = graded->node_count++;
  }
  return index ? *index : -1;
}

/* Whether bricks of half the size touch the point of the brick's border: sides[axis] says on which
 * side of the brick it lies, 0: on neither. */
static int graded_finer(oracle_graded* graded, const graded_brick* brick, const int sides[3])
{
  for (int some = 1; some < 8; ++some)
  {
    graded_brick beside = *brick;
    int there = 1;
    for (int axis = 0; axis < 3; ++axis)
    {
      const int step = some >> axis & 1 ? sides[axis] : 0;
      there = there && (step != 0 || !(some >> axis & 1));
      beside.at[axis] += step * graded_brick_size(brick->level);
    }
    if (there && graded_is_split(graded, &beside))
    {
      return 1;
    }
  }
  return 0;
}

void oracle_graded_nodes(
  oracle_graded* graded, const graded_brick* brick, const int64_t at[3], int add, int64_t node[27])
{
  const int64_t size = graded_brick_size(brick->level);
  for (int n = 0; n < 27; ++n)
  {
    const int place[3] = { n % 3, n / 3 % 3, n / 9 };
    const int middles = (place[0] == 1) + (place[1] == 1) + (place[2] == 1);
    int64_t p[3];
    int sides[3] = { 0, 0, 0 };
    for (int axis = 0; axis < 3; ++axis)
    {
      p[axis] = at[axis] + (((int64_t)place[axis] << brick->level) >> 1);
      if (place[axis] != 1)
      {
        sides[axis] = p[axis] == brick->at[axis] ? -1 : p[axis] == brick->at[axis] + size;
      }
    }
    const int is_node =
      middles == 0 || (middles < 3 && brick->level > 0 && graded_finer(graded, brick, sides));
    node[n] = is_node ? graded_node(graded, p, add) : -1;
  }
}

/* The sums at a new node, over the particles that reach its brick. */
static void graded_evaluate(oracle_graded* graded, const oracle_field* field, int64_t node,
  const int64_t* list, int64_t count)
{
  const oracle_particles* p = field->particles;
  oracle_lattice* nodes = &graded->nodes;
  double fluid = 0.0;
  double solid = 0.0;
  double value = 0.0;
  for (int64_t n = 0; n < count; ++n)
  {
    const int64_t j = list[n];
    double offset[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      offset[axis] =
        (double)graded->node_at[3 * node + axis] * graded->cube - p->position[3 * j + axis];
    }
    const double w = p->volume[j] *
      oracle_kernel_value(field->kernel, field->h_scale * p->smoothing_length[j], offset, NULL);
    *(p->solid[j] ? &solid : &fluid) += w;
    value += p->solid[j] ? 0.0 : p->scalar[j] * w;
  }
  nodes->weight[node] = fluid;
  nodes->trim_weight[node] = fluid + solid;
  nodes->value[node] = field->kind == ORACLE_WEIGHT ? fluid
    : field->kind == ORACLE_SUM                     ? value
    : fluid > 0.0                                   ? value / fluid
                                                    : 0.0;
}

static void graded_add_brick(
  graded_descent* descent, const graded_brick* brick, const int64_t* list, int64_t count)
{
  oracle_graded* graded = descent->graded;
  const int64_t first = graded->node_count;
  graded->bricks =
    graded_grow(graded->bricks, graded->brick_count, &graded->brick_capacity, sizeof(graded_brick));
  graded->bricks[graded->brick_count++] = *brick;
  for (int cell = 0; cell < 64 && graded->node_count <= descent->node_limit; ++cell)
  {
    const int64_t at[3] = { brick->at[0] + ((int64_t)(cell & 3) << brick->level),
      brick->at[1] + ((int64_t)(cell >> 2 & 3) << brick->level),
      brick->at[2] + ((int64_t)(cell >> 4) << brick->level) };
    int64_t node[27];
    oracle_graded_nodes(graded, brick, at, 1, node);
  }
  for (int64_t node = first; node < graded->node_count; ++node)
  {
    graded_evaluate(graded, descent->field, node, list, count);
  }
}

/* ---- the descent ------------------------------------------------------------------------------ */

static void graded_descend(
  graded_descent* descent, const graded_brick* brick, const int64_t* above, int64_t count)
{
  oracle_graded* graded = descent->graded;
  int64_t reaching = 0;
  int least = GRADED_LEVELS;
  int64_t* list = malloc(((size_t)count + 1) * sizeof(int64_t));
  for (int64_t n = 0; list && n < count; ++n)
  {
    if (graded_reaches(descent, above[n], brick))
    {
      list[reaching++] = above[n];
      least = descent->level[above[n]] < least ? descent->level[above[n]] : least;
    }
  }
  const int split = descent->listing ? brick->level > graded->top || graded_is_split(graded, brick)
                                     : brick->level > graded->top || least < brick->level;
  if (reaching > 0 && split)
  {
    if (!descent->listing && brick->level <= graded->top)
    {
      graded_split(graded, brick);
    }
    const int64_t half = graded_brick_size(brick->level) / 2;
    for (int part = 0; part < 8; ++part)
    {
      const graded_brick lower = { { brick->at[0] + half * (part & 1),
                                     brick->at[1] + half * (part >> 1 & 1),
                                     brick->at[2] + half * (part >> 2) },
        brick->level - 1 };
      graded_descend(descent, &lower, list, reaching);
    }
  }
  else if (reaching > 0 && descent->listing)
  {
    graded_add_brick(descent, brick, list, reaching);
  }
  free(list);
}

/* From the eight bricks around the origin of a level at which they hold all supports. */
static void graded_descend_all(graded_descent* descent)
{
  const oracle_particles* p = descent->field->particles;
  int64_t* all = malloc(((size_t)p->count + 1) * sizeof(int64_t));
  int64_t count = 0;
  int level = descent->graded->top;
  for (int64_t j = 0; all && j < p->count; ++j)
  {
    const double support =
      oracle_support(descent->field->kernel) * descent->field->h_scale * p->smoothing_length[j];
    for (int axis = 0; axis < 3; ++axis)
    {
      while ((double)graded_brick_size(level) * descent->graded->cube <=
        fabs(p->position[3 * j + axis]) + support)
      {
        ++level;
      }
    }
    all[count] = j;
    count += descent->level[j] >= 0;
  }
  for (int part = 0; part < 8; ++part)
  {
    const int64_t size = graded_brick_size(level);
    const graded_brick brick = {
      { part & 1 ? -size : 0, part >> 1 & 1 ? -size : 0, part >> 2 ? -size : 0 }, level
    };
    graded_descend(descent, &brick, all, count);
  }
  free(all);
}

/* Where a brick is split, its halves have level - 1 at most, so all that touch it must be smaller
 * than twice its size: the bricks twice as large, of which one holds it, are split. */
static void graded_balance(oracle_graded* graded)
{
  for (int level = 1; level < graded->top; ++level)
  {
    const int64_t size = graded_brick_size(level);
    int64_t count = 0;
    graded_brick* split = malloc((size_t)graded->split.count * sizeof(graded_brick) + 1);
    for (int64_t n = 0; split && n < graded->split.capacity; ++n)
    {
      const int64_t* held = &graded->split.slots[5 * n];
      if (held[4] >= 0 && held[3] == level)
      {
        memcpy(split[count].at, held, 3 * sizeof(int64_t));
        split[count++].level = level;
      }
    }
    for (int64_t n = 0; n < 27 * count; ++n)
    {
      const int64_t side[3] = { n % 3 - 1, n / 3 % 3 - 1, n / 9 % 3 - 1 };
      graded_brick larger = split[n / 27];
      larger.level = level + 1;
      for (int axis = 0; axis < 3; ++axis)
      {
        const int64_t at = larger.at[axis] + side[axis] * size;
        larger.at[axis] = at & ~(2 * size - 1);
      }
      graded_split(graded, &larger);
    }
    free(split);
  }
}

int oracle_create_graded(oracle_graded* graded, const oracle_field* field, double cube,
  int level_limit, int64_t node_limit)
{
  graded_descent descent = { graded, field,
    malloc(((size_t)field->particles->count + 1) * sizeof(int)), 0, node_limit };
  memset(graded, 0, sizeof(*graded));
  if (!descent.level)
  {
    return 0;
  }
  graded->cube = cube;
  graded_set_levels(&descent, level_limit);
  graded_descend_all(&descent);
  graded_balance(graded);
  descent.listing = 1;
  graded_descend_all(&descent);
  free(descent.level);
  graded->nodes.cube = cube;
  graded->nodes.size[0] = graded->node_count;
  graded->nodes.size[1] = graded->nodes.size[2] = 1;
  graded->nodes.flags = calloc((size_t)graded->node_count + 1, 1);
  return graded->node_count <= node_limit && graded->nodes.flags;
}

void oracle_free_graded(oracle_graded* graded)
{
  graded_map_free(&graded->split);
  graded_map_free(&graded->node_map);
  graded_map_free(&graded->edge_map);
  oracle_free_lattice(&graded->nodes);
  free(graded->node_at);
  free(graded->bricks);
  free(graded->cells);
  free(graded->edges);
  free(graded->segments);
  memset(graded, 0, sizeof(*graded));
}
