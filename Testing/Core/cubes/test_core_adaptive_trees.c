/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Random trees of cells, of which neighbours differ by one level at most, with nodes above and below
 * at random or by a smooth field: the surface through all cells must be a closed, oriented manifold.
 * Nodes on the border of the domain are below, so nothing may be open. */

#include "core_fixture.h"
#include "mcor_adaptive_cell.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CELLS 24 /* finest cells along an axis: three cells of the coarsest level */
#define NODES (CELLS + 1)
#define COARSEST 3

typedef struct adaptive_tree
{
  uint8_t level[CELLS][CELLS][CELLS]; /* z, y, x: of the cell that has this finest cell */
  uint8_t above[NODES][NODES][NODES];
  int32_t vertex[3][NODES][NODES][NODES]; /* on the edge that begins there; -1: none */
  double* points;                         /* [point_count][3] */
  int32_t* triangles;
  int64_t point_count, triangle_count, transitional, flat;
} adaptive_tree;

static uint32_t next_random(uint32_t* random)
{
  *random = *random * 1664525u + 1013904223u;
  return *random >> 8;
}

static double next_uniform(uint32_t* random)
{
  return next_random(random) / 16777216.0;
}

/* ---- the tree ---- */

static void set_level(adaptive_tree* tree, const int at[3], int size, int level)
{
  for (int z = at[2]; z < at[2] + size; ++z)
  {
    for (int y = at[1]; y < at[1] + size; ++y)
    {
      memset(&tree->level[z][y][at[0]], level, (size_t)size);
    }
  }
}

/* Halves cells at random, more of them near a random point. */
static void refine(adaptive_tree* tree, const int at[3], int level, const double* centre,
  double likely, uint32_t* random)
{
  const int size = 1 << level;
  double distance = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double d = at[axis] + 0.5 * size - centre[axis];
    distance += d * d;
  }
  const double chance = sqrt(distance) < 1.5 * size ? 0.9 : likely;
  set_level(tree, at, size, level);
  const int parts = level > 0 && next_uniform(random) < chance ? 8 : 0;
  for (int part = 0; part < parts; ++part)
  {
    const int half = size / 2;
    const int lower[3] = { at[0] + half * (part & 1), at[1] + half * (part >> 1 & 1),
      at[2] + half * (part >> 2) };
    refine(tree, lower, level - 1, centre, likely, random);
  }
}

/* The least level of the cells that touch a cell. */
static int least_around(const adaptive_tree* tree, const int at[3], int size)
{
  int least = COARSEST;
  for (int z = at[2] - 1; z <= at[2] + size; ++z)
  {
    for (int y = at[1] - 1; y <= at[1] + size; ++y)
    {
      for (int x = at[0] - 1; x <= at[0] + size; ++x)
      {
        if (x >= 0 && y >= 0 && z >= 0 && x < CELLS && y < CELLS && z < CELLS &&
          tree->level[z][y][x] < least)
        {
          least = tree->level[z][y][x];
        }
      }
    }
  }
  return least;
}

typedef void visit_cell(adaptive_tree* tree, const int at[3], int level);

static void visit_cells(adaptive_tree* tree, visit_cell* visit)
{
  for (int z = 0; z < CELLS; ++z)
  {
    for (int y = 0; y < CELLS; ++y)
    {
      for (int x = 0; x < CELLS; ++x)
      {
        const int level = tree->level[z][y][x], at[3] = { x, y, z };
        if (((x | y | z) & ((1 << level) - 1)) == 0)
        {
          visit(tree, at, level);
        }
      }
    }
  }
}

static void halve_beside_fine(adaptive_tree* tree, const int at[3], int level)
{
  if (least_around(tree, at, 1 << level) < level - 1)
  {
    set_level(tree, at, 1 << level, level - 1);
  }
}

static void make_tree(adaptive_tree* tree, uint32_t* random)
{
  const double centre[3] = { CELLS * next_uniform(random), CELLS * next_uniform(random),
    CELLS * next_uniform(random) };
  const double likely = 0.6 * next_uniform(random);
  for (int z = 0; z < CELLS; z += 1 << COARSEST)
  {
    for (int y = 0; y < CELLS; y += 1 << COARSEST)
    {
      for (int x = 0; x < CELLS; x += 1 << COARSEST)
      {
        const int at[3] = { x, y, z };
        refine(tree, at, COARSEST, centre, likely, random);
      }
    }
  }
  for (int round = 0; round < 8; ++round)
  {
    visit_cells(tree, halve_beside_fine);
  }
}

/* ---- signs ---- */

/* kind 0: noise; 1: noise, mostly below; 2: noise on a coarse lattice of nodes; 3: waves; 4: waves
 * with a little noise. */
static void make_signs(adaptive_tree* tree, int kind, uint32_t* random)
{
  double wave[3][3], phase[3];
  for (int i = 0; i < 9; ++i)
  {
    wave[i / 3][i % 3] = 1.2 * (next_uniform(random) - 0.5);
  }
  for (int i = 0; i < 3; ++i)
  {
    phase[i] = 6.3 * next_uniform(random);
  }
  for (int z = 0; z < NODES; ++z)
  {
    for (int y = 0; y < NODES; ++y)
    {
      for (int x = 0; x < NODES; ++x)
      {
        const double noise = next_uniform(random);
        double value = kind == 1 ? noise - 0.8 : noise - 0.5;
        if (kind == 2)
        {
          uint32_t place = (uint32_t)(x / 2 + 100 * (y / 2) + 10000 * (z / 2)) * 2654435761u;
          value = next_uniform(&place) - 0.5;
        }
        else if (kind > 2)
        {
          value = kind == 3 ? 0 : 0.3 * (noise - 0.5);
          for (int i = 0; i < 3; ++i)
          {
            value += sin(wave[i][0] * x + wave[i][1] * y + wave[i][2] * z + phase[i]);
          }
        }
        const int inside = x % CELLS != 0 && y % CELLS != 0 && z % CELLS != 0;
        tree->above[z][y][x] = inside && value >= 0;
      }
    }
  }
}

/* ---- the surface ---- */

/* Whether a finer cell touches a point. */
static int touches_finer(const adaptive_tree* tree, const int at[3], int level)
{
  for (int part = 0; part < 8; ++part)
  {
    const int x = at[0] - (part & 1), y = at[1] - (part >> 1 & 1), z = at[2] - (part >> 2);
    if (x >= 0 && y >= 0 && z >= 0 && x < CELLS && y < CELLS && z < CELLS &&
      tree->level[z][y][x] < level)
    {
      return 1;
    }
  }
  return 0;
}

static int32_t find_vertex(adaptive_tree* tree, const int at[3], int level, int split, int slot)
{
  const int axis = slot >> 5, node = slot & 31, step = axis == 0 ? 1 : axis == 1 ? 3 : 9;
  const int half = 1 << level >> 1, place[3] = { node % 3, node / 3 % 3, node / 9 };
  const int halved = place[axis] == 1 || (split >> (node + step) & 1);
  int p[3];
  for (int i = 0; i < 3; ++i)
  {
    /* Of a finest cell, half is 0, and place 0 or 2. */
    p[i] = at[i] + (level > 0 ? half * place[i] : place[i] / 2);
  }
  int32_t* vertex = &tree->vertex[axis][p[2]][p[1]][p[0]];
  if (*vertex < 0)
  {
    double* point = tree->points + 3 * tree->point_count;
    for (int i = 0; i < 3; ++i)
    {
      point[i] = p[i];
    }
    point[axis] += 0.5 * (halved ? half : 1 << level);
    *vertex = (int32_t)tree->point_count++;
  }
  return *vertex;
}

static void march_cell(adaptive_tree* tree, const int at[3], int level)
{
  uint8_t slots[3 * MCOR_ADAPTIVE_TRIANGLES];
  uint32_t split = 0, above = 0;
  int flat = 0;
  for (int node = 0; node < 27; ++node)
  {
    const int place[3] = { node % 3, node / 3 % 3, node / 9 };
    const int middles = (place[0] == 1) + (place[1] == 1) + (place[2] == 1);
    int p[3];
    for (int i = 0; i < 3; ++i)
    {
      p[i] = at[i] + (place[i] << level) / 2;
    }
    if (middles == 1 || middles == 2)
    {
      split |= (uint32_t)(level > 0 && touches_finer(tree, p, level)) << node;
    }
    above |= (uint32_t)tree->above[p[2]][p[1]][p[0]] << node;
  }
  tree->transitional += split != 0;
  const int count = mcor_adaptive_triangulate(split, above, slots);
  assert_int_equal(count, mcor_adaptive_count(split, above, &flat));
  tree->flat += flat;
  for (int i = 0; i < 3 * count; ++i)
  {
    tree->triangles[3 * tree->triangle_count + i] =
      find_vertex(tree, at, level, (int)split, slots[i]);
  }
  tree->triangle_count += count;
}

static void check_surface(const adaptive_tree* tree, int number, int kind)
{
  static const mesh_fault none[] = { MESH_BAD_INDEX, MESH_REPEATED_INDEX, MESH_DUPLICATE_TRIANGLE,
    MESH_NON_MANIFOLD_EDGE, MESH_ORIENTATION_CLASH, MESH_NON_MANIFOLD_VERTEX,
    MESH_COINCIDENT_POINT };
  mesh_report mesh;
  assert_true(
    mesh_check(tree->points, tree->point_count, tree->triangles, tree->triangle_count, &mesh));
  for (size_t i = 0; i < sizeof none / sizeof *none; ++i)
  {
    CORE_CHECK(mesh.faults[none[i]] == 0, "tree %d, kind %d: %lld x %s, %s", number, kind,
      (long long)mesh.faults[none[i]], mesh_fault_name(none[i]), mesh.first[none[i]]);
  }
  CORE_CHECK(mesh.boundary_edges == 0, "tree %d, kind %d: %lld open edges", number, kind,
    (long long)mesh.boundary_edges);
  mesh_free_report(&mesh);
}

static void test_surfaces_are_closed(void** state)
{
  const char* wanted = getenv("MCOR_ADAPTIVE_ALL");
  const int trees = wanted && strcmp(wanted, "1") == 0 ? 1000 : 40;
  const size_t cells = (size_t)CELLS * CELLS * CELLS;
  adaptive_tree* tree = calloc(1, sizeof *tree);
  long long triangles = 0, transitional = 0, flat = 0;
  uint32_t random = 1;
  (void)state;
  assert_non_null(tree);
  tree->points = malloc(3 * (size_t)NODES * NODES * NODES * 3 * sizeof(double));
  tree->triangles = malloc(cells * 3 * 8 * sizeof(int32_t));
  for (int number = 0; number < trees; ++number)
  {
    make_tree(tree, &random);
    for (int kind = 0; kind < 5; ++kind)
    {
      tree->point_count = tree->triangle_count = tree->transitional = tree->flat = 0;
      memset(tree->vertex, -1, sizeof tree->vertex);
      make_signs(tree, kind, &random);
      visit_cells(tree, march_cell);
      check_surface(tree, number, kind);
      triangles += tree->triangle_count;
      transitional += tree->transitional;
      flat += tree->flat;
    }
  }
  print_message("%d trees, %lld triangles, %lld cells beside finer ones, %lld flat loops\n", trees,
    triangles, transitional, flat);
  free(tree->points);
  free(tree->triangles);
  free(tree);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_surfaces_are_closed) };
  return cmocka_run_group_tests_name("adaptive_trees", tests, NULL, NULL);
}
