/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Makes the oracle's lattice: the levels of particles, the bricks (4 x 4 x 4 cells), and the nodes. */

#include "oracle_lattice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Returns how many cells of the smallest size lie along an edge of a brick. */
static int64_t lattice_brick_size(int level)
{
  return (int64_t)LATTICE_BRICK << level;
}

/* ---- levels from particles ---- */

/* State of the descent: from eight large bricks to their parts, with a list of the particles that reach each brick. */
typedef struct lattice_descent
{
  oracle_lattice* lattice;
  const oracle_field* field;
  int* level; /* [particle count]; -1: the particle does not count */
  int listing;
  int with_nodes;
} lattice_descent;

static int lattice_counts(const particle_set* p, int64_t j)
{
  return !p->solid[j] || !p->ignore_solids;
}

/* Sets each particle's level: the highest one whose cubes are still fine enough for the particle. */
static void lattice_set_levels(lattice_descent* descent, int level_limit)
{
  const particle_set* p = descent->field->particles;
  const double least = oracle_smallest_h(p);
  oracle_lattice* lattice = descent->lattice;
  for (int64_t j = 0; j < p->count; ++j)
  {
    int level = 0;
    while (level < level_limit && p->smoothing_length[j] >= ldexp(least, level + 1))
    {
      ++level;
    }
    descent->level[j] = lattice_counts(p, j) ? level : -1;
    lattice->top = !p->solid[j] && level > lattice->top ? level : lattice->top;
  }
}

static int lattice_reaches(const lattice_descent* descent, int64_t j, const lattice_brick* brick)
{
  const oracle_field* field = descent->field;
  const double support =
    oracle_support(field->kernel) * field->h_scale * field->particles->smoothing_length[j];
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double x = field->particles->position[3 * j + axis];
    const double edge = descent->lattice->edge[axis];
    const double low = (double)brick->at[axis] * edge;
    const double high = (double)(brick->at[axis] + lattice_brick_size(brick->level)) * edge;
    const double d = fmax(0.0, fmax(low - x, x - high));
    if (d > support)
    {
      return 0;
    }
    square += d * d;
  }
  return field->kernel == ORACLE_M_PRIME_4 || square <= support * support;
}

int oracle_is_split(oracle_lattice* lattice, int level, const int64_t at[3])
{
  return oracle_map_find(&lattice->split, at, level, 0) != NULL;
}

static void lattice_split(oracle_lattice* lattice, const lattice_brick* brick)
{
  *oracle_map_find(&lattice->split, brick->at, brick->level, 1) = 1;
}

/* ---- nodes ---- */

static int64_t lattice_node_at(oracle_lattice* lattice, const int64_t at[3], int add)
{
  int64_t* index = oracle_map_find(&lattice->node_map, at, 0, add);
  if (index && *index < 0)
  {
    lattice->nodes = oracle_grow(
      lattice->nodes, lattice->node_count, &lattice->node_capacity, sizeof(lattice_node));
    memcpy(lattice->nodes[lattice->node_count].at, at, 3 * sizeof(int64_t));
    *index = lattice->node_count++;
  }
  return index ? *index : -1;
}

/* Returns whether bricks of half the size touch a point of the brick. sides[axis]: on which side of the brick the point
 * lies (-1, 1); 0: between the sides. */
static int lattice_touches_finer(
  oracle_lattice* lattice, const lattice_brick* brick, const int sides[3])
{
  for (int some = 1; some < 8; ++some)
  {
    lattice_brick beside = *brick;
    int there = 1;
    for (int axis = 0; axis < 3; ++axis)
    {
      const int step = some >> axis & 1 ? sides[axis] : 0;
      there = there && (step != 0 || !(some >> axis & 1));
      beside.at[axis] += step * lattice_brick_size(brick->level);
    }
    if (there && oracle_is_split(lattice, beside.level, beside.at))
    {
      return 1;
    }
  }
  return 0;
}

/* A cell has 3 x 3 x 3 places, half a cell apart. Writes p, one of these places, and on which sides of the brick it
 * is. */
static void lattice_place_in_brick(
  const lattice_brick* brick, const int64_t at[3], const int place[3], int64_t p[3], int sides[3])
{
  const int64_t size = lattice_brick_size(brick->level);
  for (int axis = 0; axis < 3; ++axis)
  {
    p[axis] = at[axis] + (((int64_t)place[axis] << brick->level) >> 1);
    sides[axis] = place[axis] == 1 ? 0
      : p[axis] == brick->at[axis] ? -1
                                   : p[axis] == brick->at[axis] + size;
  }
}

int oracle_is_plain(oracle_lattice* lattice, int level, const int64_t at[3])
{
  const int64_t size = lattice_brick_size(level);
  lattice_brick brick = { { at[0] & -size, at[1] & -size, at[2] & -size }, level };
  lattice_brick larger = { { at[0] & -2 * size, at[1] & -2 * size, at[2] & -2 * size }, level + 1 };
  int plain = !oracle_is_split(lattice, level, brick.at) &&
    (level >= lattice->top || oracle_is_split(lattice, level + 1, larger.at));
  for (int n = 0; n < 27 && plain && level > 0; ++n)
  {
    const int place[3] = { n % 3, n / 3 % 3, n / 9 };
    int64_t p[3];
    int sides[3];
    lattice_place_in_brick(&brick, at, place, p, sides);
    plain = !lattice_touches_finer(lattice, &brick, sides);
  }
  return plain;
}

void oracle_cell_at(oracle_lattice* lattice, int64_t b, int c, int add, lattice_cell* cell)
{
  const lattice_brick* brick = &lattice->bricks[b];
  const int xyz[3] = { c & 3, c >> 2 & 3, c >> 4 };
  memset(cell, 0, sizeof(*cell));
  cell->level = brick->level;
  for (int axis = 0; axis < 3; ++axis)
  {
    cell->at[axis] = brick->at[axis] + ((int64_t)xyz[axis] << brick->level);
  }
  for (int n = 0; n < 27; ++n)
  {
    const int place[3] = { n % 3, n / 3 % 3, n / 9 };
    const int middles = (place[0] == 1) + (place[1] == 1) + (place[2] == 1);
    int64_t p[3];
    int sides[3];
    cell->node[n] = -1;
    if (middles == 0)
    {
      cell->node[n] = lattice->corners[LATTICE_CORNERS * b + xyz[0] + place[0] / 2 +
        5 * (xyz[1] + place[1] / 2) + 25 * (xyz[2] + place[2] / 2)];
    }
    else if (middles < 3 && brick->level > 0)
    {
      lattice_place_in_brick(brick, cell->at, place, p, sides);
      cell->node[n] =
        lattice_touches_finer(lattice, brick, sides) ? lattice_node_at(lattice, p, add) : -1;
    }
  }
}

void oracle_place(const oracle_lattice* lattice, const int64_t at[3], double point[3])
{
  for (int axis = 0; axis < 3; ++axis)
  {
    point[axis] = (double)at[axis] * lattice->edge[axis];
  }
}

/* Sums at a new node over the particles that reach its brick. */
static void lattice_evaluate(oracle_lattice* lattice, const oracle_field* field, lattice_node* node,
  const int64_t* list, int64_t count)
{
  const particle_set* p = field->particles;
  const double support = oracle_support(field->kernel) * (1.0 + 1e-12);
  double point[3];
  double fluid = 0.0;
  double solid = 0.0;
  double value = 0.0;
  oracle_place(lattice, node->at, point);
  for (int64_t n = 0; n < count; ++n)
  {
    const int64_t j = list[n];
    const double* x = &p->position[3 * j];
    const double offset[3] = { point[0] - x[0], point[1] - x[1], point[2] - x[2] };
    const double h = field->h_scale * p->smoothing_length[j];
    if (fmax(fabs(offset[0]), fmax(fabs(offset[1]), fabs(offset[2]))) > support * h)
    {
      continue; /* most particles that reach a brick do not reach this node */
    }
    const double w = p->volume[j] * oracle_kernel_value(field->kernel, h, offset, NULL);
    *(p->solid[j] ? &solid : &fluid) += w;
    value += p->solid[j] ? 0.0 : p->scalar[j] * w;
  }
  node->weight = fluid;
  node->trim_weight = fluid + solid;
  node->value = field->kind == ORACLE_WEIGHT ? fluid
    : field->kind == ORACLE_SUM              ? value
    : fluid > 0.0                            ? value / fluid
                                             : 0.0;
}

static void lattice_add_brick(
  lattice_descent* descent, const lattice_brick* brick, const int64_t* list, int64_t count)
{
  oracle_lattice* lattice = descent->lattice;
  const int64_t first = lattice->node_count;
  int64_t capacity = lattice->brick_capacity;
  lattice->corners = oracle_grow(
    lattice->corners, lattice->brick_count, &capacity, LATTICE_CORNERS * sizeof(int64_t));
  lattice->bricks = oracle_grow(
    lattice->bricks, lattice->brick_count, &lattice->brick_capacity, sizeof(lattice_brick));
  lattice->bricks[lattice->brick_count++] = *brick;
  if (!descent->with_nodes)
  {
    return;
  }
  for (int n = 0; n < LATTICE_CORNERS; ++n)
  {
    const int64_t at[3] = { brick->at[0] + ((int64_t)(n % 5) << brick->level),
      brick->at[1] + ((int64_t)(n / 5 % 5) << brick->level),
      brick->at[2] + ((int64_t)(n / 25) << brick->level) };
    lattice->corners[LATTICE_CORNERS * (lattice->brick_count - 1) + n] =
      lattice_node_at(lattice, at, 1);
  }
  for (int c = 0; c < 64 && brick->level > 0; ++c)
  {
    lattice_cell cell;
    oracle_cell_at(lattice, lattice->brick_count - 1, c, 1, &cell);
  }
  for (int64_t node = first; node < lattice->node_count; ++node)
  {
    lattice_evaluate(lattice, descent->field, &lattice->nodes[node], list, count);
  }
}

/* ---- the descent ---- */

static void lattice_descend(
  lattice_descent* descent, const lattice_brick* brick, const int64_t* above, int64_t count)
{
  oracle_lattice* lattice = descent->lattice;
  int64_t reaching = 0;
  int least = LATTICE_LEVELS;
  int64_t* list = oracle_allocate(count, sizeof(int64_t));
  for (int64_t n = 0; n < count; ++n)
  {
    if (lattice_reaches(descent, above[n], brick))
    {
      list[reaching++] = above[n];
      least = descent->level[above[n]] < least ? descent->level[above[n]] : least;
    }
  }
  const int split = descent->listing
    ? brick->level > lattice->top || oracle_is_split(lattice, brick->level, brick->at)
    : brick->level > lattice->top || least < brick->level;
  if (reaching > 0 && split)
  {
    if (!descent->listing && brick->level <= lattice->top)
    {
      lattice_split(lattice, brick);
    }
    const int64_t half = lattice_brick_size(brick->level) / 2;
    for (int part = 0; part < 8; ++part)
    {
      const lattice_brick lower = { { brick->at[0] + half * (part & 1),
                                      brick->at[1] + half * (part >> 1 & 1),
                                      brick->at[2] + half * (part >> 2) },
        brick->level - 1 };
      lattice_descend(descent, &lower, list, reaching);
    }
  }
  else if (reaching > 0 && descent->listing)
  {
    lattice_add_brick(descent, brick, list, reaching);
  }
  free(list);
}

/* Begins the descent with the eight bricks around the origin. Their level is so high that they hold all supports. */
static void lattice_descend_all(lattice_descent* descent)
{
  const particle_set* p = descent->field->particles;
  int64_t* all = oracle_allocate(p->count, sizeof(int64_t));
  int64_t count = 0;
  int level = descent->lattice->top;
  for (int64_t j = 0; j < p->count; ++j)
  {
    const double support =
      oracle_support(descent->field->kernel) * descent->field->h_scale * p->smoothing_length[j];
    for (int axis = 0; axis < 3; ++axis)
    {
      while ((double)lattice_brick_size(level) * descent->lattice->edge[axis] <=
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
    const int64_t size = lattice_brick_size(level);
    const lattice_brick brick = {
      { part & 1 ? -size : 0, part >> 1 & 1 ? -size : 0, part >> 2 ? -size : 0 }, level
    };
    lattice_descend(descent, &brick, all, count);
  }
  free(all);
}

/* Bricks that touch may differ by one level only. A split brick has parts of the next lower level, so larger bricks
 * that touch it are split, too. */
static void lattice_balance(oracle_lattice* lattice)
{
  for (int level = 1; level < lattice->top; ++level)
  {
    const int64_t size = lattice_brick_size(level);
    int64_t count = 0;
    lattice_brick* split = oracle_allocate(lattice->split.count, sizeof(lattice_brick));
    for (int64_t n = 0; n < lattice->split.capacity; ++n)
    {
      const int64_t* held = &lattice->split.slots[5 * n];
      if (held[4] >= 0 && held[3] == level)
      {
        memcpy(split[count].at, held, 3 * sizeof(int64_t));
        split[count++].level = level;
      }
    }
    for (int64_t n = 0; n < 27 * count; ++n)
    {
      const int64_t side[3] = { n % 3 - 1, n / 3 % 3 - 1, n / 9 % 3 - 1 };
      lattice_brick larger = split[n / 27];
      larger.level = level + 1;
      for (int axis = 0; axis < 3; ++axis)
      {
        const int64_t at = larger.at[axis] + side[axis] * size;
        larger.at[axis] = at & ~(2 * size - 1);
      }
      lattice_split(lattice, &larger);
    }
    free(split);
  }
}

void oracle_create_lattice(oracle_lattice* lattice, const oracle_field* field, const double edge[3],
  int level_limit, int with_nodes)
{
  lattice_descent descent = { lattice, field, oracle_allocate(field->particles->count, sizeof(int)),
    0, with_nodes };
  memset(lattice, 0, sizeof(*lattice));
  for (int axis = 0; axis < 3; ++axis)
  {
    lattice->edge[axis] = edge[axis];
    lattice->first[axis] = INT64_MIN;
    lattice->end[axis] = INT64_MAX;
  }
  lattice->cube = fmin(edge[0], fmin(edge[1], edge[2]));
  lattice_set_levels(&descent, level_limit);
  lattice_descend_all(&descent);
  lattice_balance(lattice);
  descent.listing = 1;
  lattice_descend_all(&descent);
  free(descent.level);
}

void oracle_free_lattice(oracle_lattice* lattice)
{
  oracle_map_free(&lattice->split);
  oracle_map_free(&lattice->node_map);
  oracle_map_free(&lattice->edge_map);
  oracle_map_free(&lattice->doubts);
  oracle_map_free(&lattice->either);
  free(lattice->nodes);
  free(lattice->bricks);
  free(lattice->corners);
  free(lattice->cells);
  free(lattice->edges);
  free(lattice->segments);
  memset(lattice, 0, sizeof(*lattice));
}
