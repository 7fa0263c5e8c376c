/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Levels, bricks and nodes. */

#include "oracle_adaptive.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells of the smallest cubes along an edge of a brick. */
static int64_t adaptive_brick_size(int level)
{
  return (int64_t)ADAPTIVE_BRICK << level;
}

/* ---- levels from particles ---- */

/* One descent from a box around everything: with all particles that reach the brick. */
typedef struct adaptive_descent
{
  oracle_adaptive* adaptive;
  const oracle_field* field;
  int* level; /* [particle count], -1: of no account */
  int listing;
  int64_t node_limit;
} adaptive_descent;

static int adaptive_counts(const oracle_particles* p, int64_t j)
{
  return !p->solid[j] || !p->ignore_solids;
}

/* The highest level at which cubes are fine enough for each particle. */
static void adaptive_set_levels(adaptive_descent* descent, int level_limit)
{
  const oracle_particles* p = descent->field->particles;
  const double least = oracle_smallest_h(p);
  oracle_adaptive* adaptive = descent->adaptive;
  for (int64_t j = 0; j < p->count; ++j)
  {
    int level = 0;
    while (level < level_limit && p->smoothing_length[j] >= ldexp(least, level + 1))
    {
      ++level;
    }
    descent->level[j] = adaptive_counts(p, j) ? level : -1;
    adaptive->top = !p->solid[j] && level > adaptive->top ? level : adaptive->top;
  }
}

static int adaptive_reaches(const adaptive_descent* descent, int64_t j, const adaptive_brick* brick)
{
  const oracle_field* field = descent->field;
  const double support =
    oracle_support(field->kernel) * field->h_scale * field->particles->smoothing_length[j];
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double x = field->particles->position[3 * j + axis];
    const double low = (double)brick->at[axis] * descent->adaptive->cube;
    const double high =
      (double)(brick->at[axis] + adaptive_brick_size(brick->level)) * descent->adaptive->cube;
    const double d = fmax(0.0, fmax(low - x, x - high));
    if (d > support)
    {
      return 0;
    }
    square += d * d;
  }
  return field->kernel == ORACLE_M_PRIME_4 || square <= support * support;
}

static int adaptive_is_split(oracle_adaptive* adaptive, const adaptive_brick* brick)
{
  return adaptive_map_find(&adaptive->split, brick->at, brick->level, 0) != NULL;
}

static void adaptive_split(oracle_adaptive* adaptive, const adaptive_brick* brick)
{
  *adaptive_map_find(&adaptive->split, brick->at, brick->level, 1) = 1;
}

/* ---- nodes ---- */

static int64_t adaptive_node(oracle_adaptive* adaptive, const int64_t at[3], int add)
{
  int64_t* index = adaptive_map_find(&adaptive->node_map, at, 0, add);
  if (index && *index < 0)
  {
    int64_t capacity[3] = { adaptive->node_capacity, adaptive->node_capacity,
      adaptive->node_capacity };
    oracle_lattice* nodes = &adaptive->nodes;
    const int64_t count = adaptive->node_count;
    nodes->value = adaptive_grow(nodes->value, count, &capacity[0], sizeof(double));
    nodes->weight = adaptive_grow(nodes->weight, count, &capacity[1], sizeof(double));
    nodes->trim_weight = adaptive_grow(nodes->trim_weight, count, &capacity[2], sizeof(double));
    adaptive->node_at =
      adaptive_grow(adaptive->node_at, count, &adaptive->node_capacity, 3 * sizeof(int64_t));
    memcpy(&adaptive->node_at[3 * adaptive->node_count], at, 3 * sizeof(int64_t));
    *index = adaptive->node_count++;
  }
  return index ? *index : -1;
}

/* Whether bricks of half the size touch the point of the brick's border: sides[axis] says on which
 * side of the brick it lies, 0: on neither. */
static int adaptive_finer(
  oracle_adaptive* adaptive, const adaptive_brick* brick, const int sides[3])
{
  for (int some = 1; some < 8; ++some)
  {
    adaptive_brick beside = *brick;
    int there = 1;
    for (int axis = 0; axis < 3; ++axis)
    {
      const int step = some >> axis & 1 ? sides[axis] : 0;
      there = there && (step != 0 || !(some >> axis & 1));
      beside.at[axis] += step * adaptive_brick_size(brick->level);
    }
    if (there && adaptive_is_split(adaptive, &beside))
    {
      return 1;
    }
  }
  return 0;
}

/* On which sides of the brick a place of one of its cells lies, of 3 x 3 x 3 half a cell apart, and where that is. */
static void adaptive_sides(
  const adaptive_brick* brick, const int64_t at[3], const int place[3], int64_t p[3], int sides[3])
{
  const int64_t size = adaptive_brick_size(brick->level);
  for (int axis = 0; axis < 3; ++axis)
  {
    p[axis] = at[axis] + (((int64_t)place[axis] << brick->level) >> 1);
    sides[axis] = place[axis] == 1 ? 0
      : p[axis] == brick->at[axis] ? -1
                                   : p[axis] == brick->at[axis] + size;
  }
}

int oracle_adaptive_is_plain(oracle_adaptive* adaptive, int level, const int64_t at[3])
{
  const int64_t size = adaptive_brick_size(level);
  adaptive_brick brick = { { at[0] & -size, at[1] & -size, at[2] & -size }, level };
  adaptive_brick larger = { { at[0] & -2 * size, at[1] & -2 * size, at[2] & -2 * size },
    level + 1 };
  int plain = !adaptive_is_split(adaptive, &brick) &&
    (level >= adaptive->top || adaptive_is_split(adaptive, &larger));
  for (int n = 0; n < 27 && plain && level > 0; ++n)
  {
    const int place[3] = { n % 3, n / 3 % 3, n / 9 };
    int64_t p[3];
    int sides[3];
    adaptive_sides(&brick, at, place, p, sides);
    plain = !adaptive_finer(adaptive, &brick, sides);
  }
  return plain;
}

void oracle_adaptive_nodes(oracle_adaptive* adaptive, const adaptive_brick* brick,
  const int64_t at[3], int add, int64_t node[27])
{
  for (int n = 0; n < 27; ++n)
  {
    const int place[3] = { n % 3, n / 3 % 3, n / 9 };
    const int middles = (place[0] == 1) + (place[1] == 1) + (place[2] == 1);
    int64_t p[3];
    int sides[3];
    adaptive_sides(brick, at, place, p, sides);
    const int is_node =
      middles == 0 || (middles < 3 && brick->level > 0 && adaptive_finer(adaptive, brick, sides));
    node[n] = is_node ? adaptive_node(adaptive, p, add) : -1;
  }
}

/* The sums at a new node, over the particles that reach its brick. */
static void adaptive_evaluate(oracle_adaptive* adaptive, const oracle_field* field, int64_t node,
  const int64_t* list, int64_t count)
{
  const oracle_particles* p = field->particles;
  oracle_lattice* nodes = &adaptive->nodes;
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
        (double)adaptive->node_at[3 * node + axis] * adaptive->cube - p->position[3 * j + axis];
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

static void adaptive_add_brick(
  adaptive_descent* descent, const adaptive_brick* brick, const int64_t* list, int64_t count)
{
  oracle_adaptive* adaptive = descent->adaptive;
  const int64_t first = adaptive->node_count;
  adaptive->bricks = adaptive_grow(
    adaptive->bricks, adaptive->brick_count, &adaptive->brick_capacity, sizeof(adaptive_brick));
  adaptive->bricks[adaptive->brick_count++] = *brick;
  for (int cell = 0; cell < 64 && adaptive->node_count <= descent->node_limit; ++cell)
  {
    const int64_t at[3] = { brick->at[0] + ((int64_t)(cell & 3) << brick->level),
      brick->at[1] + ((int64_t)(cell >> 2 & 3) << brick->level),
      brick->at[2] + ((int64_t)(cell >> 4) << brick->level) };
    int64_t node[27];
    oracle_adaptive_nodes(adaptive, brick, at, 1, node);
  }
  for (int64_t node = first; node < adaptive->node_count; ++node)
  {
    adaptive_evaluate(adaptive, descent->field, node, list, count);
  }
}

/* ---- the descent ---- */

static void adaptive_descend(
  adaptive_descent* descent, const adaptive_brick* brick, const int64_t* above, int64_t count)
{
  oracle_adaptive* adaptive = descent->adaptive;
  int64_t reaching = 0;
  int least = ADAPTIVE_LEVELS;
  int64_t* list = malloc(((size_t)count + 1) * sizeof(int64_t));
  for (int64_t n = 0; list && n < count; ++n)
  {
    if (adaptive_reaches(descent, above[n], brick))
    {
      list[reaching++] = above[n];
      least = descent->level[above[n]] < least ? descent->level[above[n]] : least;
    }
  }
  const int split = descent->listing
    ? brick->level > adaptive->top || adaptive_is_split(adaptive, brick)
    : brick->level > adaptive->top || least < brick->level;
  if (reaching > 0 && split)
  {
    if (!descent->listing && brick->level <= adaptive->top)
    {
      adaptive_split(adaptive, brick);
    }
    const int64_t half = adaptive_brick_size(brick->level) / 2;
    for (int part = 0; part < 8; ++part)
    {
      const adaptive_brick lower = { { brick->at[0] + half * (part & 1),
                                       brick->at[1] + half * (part >> 1 & 1),
                                       brick->at[2] + half * (part >> 2) },
        brick->level - 1 };
      adaptive_descend(descent, &lower, list, reaching);
    }
  }
  else if (reaching > 0 && descent->listing)
  {
    adaptive_add_brick(descent, brick, list, reaching);
  }
  free(list);
}

/* From the eight bricks around the origin of a level at which they hold all supports. */
static void adaptive_descend_all(adaptive_descent* descent)
{
  const oracle_particles* p = descent->field->particles;
  int64_t* all = malloc(((size_t)p->count + 1) * sizeof(int64_t));
  int64_t count = 0;
  int level = descent->adaptive->top;
  for (int64_t j = 0; all && j < p->count; ++j)
  {
    const double support =
      oracle_support(descent->field->kernel) * descent->field->h_scale * p->smoothing_length[j];
    for (int axis = 0; axis < 3; ++axis)
    {
      while ((double)adaptive_brick_size(level) * descent->adaptive->cube <=
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
    const int64_t size = adaptive_brick_size(level);
    const adaptive_brick brick = {
      { part & 1 ? -size : 0, part >> 1 & 1 ? -size : 0, part >> 2 ? -size : 0 }, level
    };
    adaptive_descend(descent, &brick, all, count);
  }
  free(all);
}

/* Where a brick is split, its halves have level - 1 at most, so all that touch it must be smaller
 * than twice its size: the bricks twice as large, of which one holds it, are split. */
static void adaptive_balance(oracle_adaptive* adaptive)
{
  for (int level = 1; level < adaptive->top; ++level)
  {
    const int64_t size = adaptive_brick_size(level);
    int64_t count = 0;
    adaptive_brick* split = malloc((size_t)adaptive->split.count * sizeof(adaptive_brick) + 1);
    for (int64_t n = 0; split && n < adaptive->split.capacity; ++n)
    {
      const int64_t* held = &adaptive->split.slots[5 * n];
      if (held[4] >= 0 && held[3] == level)
      {
        memcpy(split[count].at, held, 3 * sizeof(int64_t));
        split[count++].level = level;
      }
    }
    for (int64_t n = 0; n < 27 * count; ++n)
    {
      const int64_t side[3] = { n % 3 - 1, n / 3 % 3 - 1, n / 9 % 3 - 1 };
      adaptive_brick larger = split[n / 27];
      larger.level = level + 1;
      for (int axis = 0; axis < 3; ++axis)
      {
        const int64_t at = larger.at[axis] + side[axis] * size;
        larger.at[axis] = at & ~(2 * size - 1);
      }
      adaptive_split(adaptive, &larger);
    }
    free(split);
  }
}

int oracle_create_adaptive(oracle_adaptive* adaptive, const oracle_field* field, double cube,
  int level_limit, int64_t node_limit)
{
  adaptive_descent descent = { adaptive, field,
    malloc(((size_t)field->particles->count + 1) * sizeof(int)), 0, node_limit };
  memset(adaptive, 0, sizeof(*adaptive));
  if (!descent.level)
  {
    return 0;
  }
  adaptive->cube = cube;
  adaptive_set_levels(&descent, level_limit);
  adaptive_descend_all(&descent);
  adaptive_balance(adaptive);
  descent.listing = 1;
  adaptive_descend_all(&descent);
  free(descent.level);
  adaptive->nodes.cube = cube;
  adaptive->nodes.size[0] = adaptive->node_count;
  adaptive->nodes.size[1] = adaptive->nodes.size[2] = 1;
  adaptive->nodes.flags = calloc((size_t)adaptive->node_count + 1, 1);
  return adaptive->node_count <= node_limit && adaptive->nodes.flags;
}

void oracle_free_adaptive(oracle_adaptive* adaptive)
{
  adaptive_map_free(&adaptive->split);
  adaptive_map_free(&adaptive->node_map);
  adaptive_map_free(&adaptive->edge_map);
  oracle_free_lattice(&adaptive->nodes);
  free(adaptive->node_at);
  free(adaptive->bricks);
  free(adaptive->cells);
  free(adaptive->edges);
  free(adaptive->segments);
  memset(adaptive, 0, sizeof(*adaptive));
}
