/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Cells with finer cells around them: every set of split faces and edges, up to symmetry, with every
 * pattern of nodes above; 216.6 million. Without MCOR_ADAPTIVE_ALL=1 a fixed sample of them. What a
 * cell must do is derived anew here, from positions in space.
 *
 * Why this proves that a whole mesh is sound: the segments on a facet (a whole face or a sub-face)
 * depend on its nodes alone and are reversed on its other side, so each line between two cells has
 * one triangle on each side, or is one of two that a third cell joins without a triangle. All other
 * sides of triangles are diagonals; one within a single facet or cell edge could be a side in another
 * cell too, and there are none, but in loops within a whole face. Of a face with four nodes there are none at
 * all: the cell beyond, where the field decides, may have some. */

#include "core_adaptive.h"

#include <stdlib.h>
#include <string.h>

#define PATTERNS 216636160

typedef struct cell_totals
{
  long long cells, loops, flat, pairs;
  int vertices, longest, cell_loops, triangles;
} cell_totals;

typedef struct cell_loops
{
  int loop_of[MCOR_ADAPTIVE_SLOTS]; /* -1: no vertex, or a loop of two */
  int length[MCOR_ADAPTIVE_SLOTS], in_whole[MCOR_ADAPTIVE_SLOTS];
  int count, triangles;
} cell_loops;

/* Follows the segments; all must close. */
static void trace_loops(const core_shape* cell, uint32_t above,
  const int8_t next[MCOR_ADAPTIVE_SLOTS], cell_loops* loops, cell_totals* totals)
{
  int seen[MCOR_ADAPTIVE_SLOTS] = { 0 }, all = 0;
  loops->count = loops->triangles = 0;
  memset(loops->loop_of, -1, sizeof loops->loop_of);
  for (int slot = 0; slot < MCOR_ADAPTIVE_SLOTS; ++slot)
  {
    int length = 0, in_whole = 63, at = slot;
    if (next[slot] < 0 || seen[slot])
    {
      continue;
    }
    for (; !seen[at]; at = next[at], ++length)
    {
      CORE_CHECK(next[at] >= 0, "split %x, above %x: a loop is open", cell->split, above);
      seen[at] = 1;
      in_whole &= cell->in_whole[at];
      loops->loop_of[at] = loops->count;
    }
    CORE_CHECK(at == slot, "split %x, above %x: loops meet", cell->split, above);
    ++all;
    if (length == 2)
    {
      loops->loop_of[slot] = loops->loop_of[next[slot]] = -1;
      ++totals->pairs;
      continue;
    }
    CORE_CHECK(length > 2 && length <= MCOR_ADAPTIVE_VERTICES, "split %x, above %x: a loop of %d",
      cell->split, above, length);
    totals->longest = length > totals->longest ? length : totals->longest;
    loops->length[loops->count] = length;
    loops->in_whole[loops->count++] = in_whole;
    loops->triangles += length - 2;
  }
  totals->loops += loops->count;
  totals->cell_loops = all > totals->cell_loops ? all : totals->cell_loops;
}

/* ---- what it does look like ---- */

/* Triangle whose side goes from slot a to b, from 1 on. */
typedef uint8_t side_owners[MCOR_ADAPTIVE_SLOTS][MCOR_ADAPTIVE_SLOTS];

static int find_root(const int* parent, int i)
{
  while (parent[i] != i)
  {
    i = parent[i];
  }
  return i;
}

/* Whether one of these faces has its four corners alone as nodes. */
static int is_plain(const core_shape* cell, int faces)
{
  int plain = 0;
  for (int face = 0; face < 6; ++face)
  {
    uint32_t split = 0;
    for (int i = 1; i < 8; i += 2)
    {
      split |= cell->split >> mcor_adaptive_face_node(face, i) & 1;
    }
    plain |= (faces >> face & 1) && !split;
  }
  return plain;
}

/* All sides are segments, each of them once, or diagonals that may be; the triangles of each loop
 * hang together by its n - 3 diagonals, so they are a disc. */
static void check_triangles(const core_shape* cell, uint32_t above,
  const int8_t next[MCOR_ADAPTIVE_SLOTS], const cell_loops* loops, const uint8_t* triangles,
  int count)
{
  static side_owners side;
  int parent[MCOR_ADAPTIVE_TRIANGLES + 1], diagonals[MCOR_ADAPTIVE_SLOTS] = { 0 },
                                           segments[MCOR_ADAPTIVE_SLOTS] = { 0 };
  for (int i = 0; i < 3 * count; ++i)
  {
    const int a = triangles[i], b = triangles[i % 3 == 2 ? i - 2 : i + 1];
    CORE_CHECK(
      a < MCOR_ADAPTIVE_SLOTS && loops->loop_of[a] >= 0 && loops->loop_of[a] == loops->loop_of[b],
      "split %x, above %x: slots %d, %d", cell->split, above, a, b);
    CORE_CHECK(!side[a][b], "split %x, above %x: side %d-%d twice", cell->split, above, a, b);
    side[a][b] = (uint8_t)(1 + i / 3);
    parent[1 + i / 3] = 1 + i / 3;
  }
  /* Nothing lies flat in a face but loops that do so altogether. */
  for (int i = 0; i < count; ++i)
  {
    const uint8_t* t = triangles + 3 * i;
    CORE_CHECK(loops->in_whole[loops->loop_of[t[0]]] ||
        !(cell->in_whole[t[0]] & cell->in_whole[t[1]] & cell->in_whole[t[2]]),
      "split %x, above %x: triangle %d %d %d lies in a face", cell->split, above, t[0], t[1], t[2]);
  }
  for (int i = 0; i < 3 * count; ++i)
  {
    const int a = triangles[i], b = triangles[i % 3 == 2 ? i - 2 : i + 1];
    const int loop = loops->loop_of[a];
    if (!side[b][a])
    {
      CORE_CHECK(next[a] == b, "split %x, above %x: side %d-%d is open", cell->split, above, a, b);
      ++segments[loop];
      continue;
    }
    CORE_CHECK(!cell->forbidden[a][b] || loops->in_whole[loop],
      "split %x, above %x: diagonal %d-%d", cell->split, above, a, b);
    /* A cell without finer nodes may have diagonals in its faces, see mcor_case_table.c. */
    CORE_CHECK(!is_plain(cell, loops->in_whole[loop]), "split %x, above %x: flat in a plain face",
      cell->split, above);
    if (a < b)
    {
      const int one = find_root(parent, side[a][b]), other = find_root(parent, side[b][a]);
      CORE_CHECK(one != other, "split %x, above %x: no disc", cell->split, above);
      parent[one] = other;
      ++diagonals[loop];
    }
  }
  for (int loop = 0; loop < loops->count; ++loop)
  {
    CORE_CHECK(segments[loop] == loops->length[loop] && diagonals[loop] == segments[loop] - 3,
      "split %x, above %x: %d vertices, %d segments, %d diagonals", cell->split, above,
      loops->length[loop], segments[loop], diagonals[loop]);
  }
  for (int i = 0; i < 3 * count; ++i)
  {
    side[triangles[i]][triangles[i % 3 == 2 ? i - 2 : i + 1]] = 0;
  }
}

/* Pattern number `index`: bit i is the cell's i-th node. */
static void check_pattern(const core_shape* cell, uint32_t index, cell_totals* totals)
{
  uint8_t triangles[3 * MCOR_ADAPTIVE_TRIANGLES];
  int8_t next[MCOR_ADAPTIVE_SLOTS];
  cell_loops loops;
  uint32_t above = 0;
  int flat = 0;
  for (int i = 0; i < cell->node_count; ++i)
  {
    above |= (index >> i & 1) << cell->nodes[i];
  }
  const int vertices = core_link_slots(cell, above, next);
  trace_loops(cell, above, next, &loops, totals);
  CORE_CHECK(loops.triangles <= MCOR_ADAPTIVE_TRIANGLES, "split %x, above %x: %d triangles",
    cell->split, above, loops.triangles);
  const int count = mcor_adaptive_triangulate(cell->split, above, triangles);
  CORE_CHECK(count == loops.triangles, "split %x, above %x: %d triangles, not %d", cell->split,
    above, count, loops.triangles);
  if (index % 8 == 0) /* enough: it adds up lengths of the same loops */
  {
    CORE_CHECK(mcor_adaptive_count(cell->split, above, &flat) == count,
      "split %x, above %x: not %d triangles", cell->split, above, count);
  }
  check_triangles(cell, above, next, &loops, triangles, count);
  ++totals->cells;
  totals->flat += flat;
  totals->vertices = vertices > totals->vertices ? vertices : totals->vertices;
  totals->triangles = count > totals->triangles ? count : totals->triangles;
}

/* ---- tests ---- */

static void check_totals(const cell_totals* totals, int all)
{
  print_message("%lld cells: %lld loops, %lld of two vertices, %lld flat (in an eighth); at most "
                "%d vertices, %d in "
                "a loop, %d loops, %d triangles\n",
    totals->cells, totals->loops, totals->pairs, totals->flat, totals->vertices, totals->longest,
    totals->cell_loops, totals->triangles);
  if (all)
  {
    assert_int_equal(totals->cells, PATTERNS);
  }
}

static void test_all_cells(void** state)
{
  static core_shape cell;
  static uint32_t splits[CORE_SPLIT_CLASSES];
  const char* wanted = getenv("MCOR_ADAPTIVE_ALL");
  const int all = wanted && strcmp(wanted, "1") == 0;
  const uint32_t most = 4096; /* patterns of a class in the sample */
  cell_totals totals = { 0 };
  (void)state;
  assert_int_equal(core_list_splits(splits), CORE_SPLIT_CLASSES);
  for (int c = 0; c < CORE_SPLIT_CLASSES; ++c)
  {
    core_make_shape(splits[c], &cell);
    const uint32_t patterns = 1u << cell.node_count;
    const int sampled = !all && patterns > most;
    for (uint32_t i = 0; i < (sampled ? most : patterns); ++i)
    {
      const uint32_t scattered = (i * 2654435761u + 97u * (uint32_t)c) & (patterns - 1);
      check_pattern(&cell, sampled ? scattered : i, &totals);
    }
  }
  check_totals(&totals, all);
}

/* Sets of split faces and edges that symmetry makes of each other, too: the numbering of slots is
 * not symmetric. */
static void test_turned_cells(void** state)
{
  static core_shape cell;
  static uint32_t splits[CORE_SPLIT_CLASSES];
  cell_totals totals = { 0 };
  uint32_t random = 1;
  (void)state;
  assert_int_equal(core_list_splits(splits), CORE_SPLIT_CLASSES);
  for (int c = 0; c < CORE_SPLIT_CLASSES; ++c)
  {
    for (int symmetry = 0; symmetry < 48; ++symmetry)
    {
      core_make_shape(core_turn_split(splits[c], symmetry), &cell);
      for (int i = 0; i < 16; ++i)
      {
        random = random * 1664525u + 1013904223u;
        check_pattern(&cell, random >> 4 & ((1u << cell.node_count) - 1), &totals);
      }
    }
  }
}

/* The case table's slot for axis << 3 | lower corner. */
static int slot_of_edge(int edge)
{
  return edge >> 3 << 5 | (2 * (edge & 1) + 6 * (edge >> 1 & 1) + 18 * (edge >> 2 & 1));
}

static void test_no_split_is_the_case_table(void** state)
{
  static uint8_t table[256][16];
  (void)state;
  mcor_make_case_table(table);
  for (int c = 0; c < 256; ++c)
  {
    uint8_t triangles[3 * MCOR_ADAPTIVE_TRIANGLES];
    uint32_t above = 0;
    for (int corner = 0; corner < 8; ++corner)
    {
      above |= (uint32_t)(c >> corner & 1) << (slot_of_edge(corner) & 31);
    }
    assert_int_equal(mcor_adaptive_triangulate(0, above, triangles), table[c][15]);
    for (int i = 0; i < 3 * table[c][15]; ++i)
    {
      CORE_CHECK(triangles[i] == slot_of_edge(table[c][i]), "case %d, vertex %d", c, i);
    }
  }
}

/* Bits that are not nodes do not matter. */
static void test_other_bits_do_not_matter(void** state)
{
  uint8_t some[3 * MCOR_ADAPTIVE_TRIANGLES], same[3 * MCOR_ADAPTIVE_TRIANGLES];
  uint32_t random = 7;
  (void)state;
  for (int i = 0; i < 4096; ++i)
  {
    uint32_t nodes = 0;
    for (int corner = 0; corner < 8; ++corner)
    {
      nodes |= 1u << (slot_of_edge(corner) & 31);
    }
    random = random * 1664525u + 1013904223u;
    const uint32_t above = random >> 5;
    const int count = mcor_adaptive_triangulate(0, above, some);
    assert_int_equal(count, mcor_adaptive_triangulate(0, above & nodes, same));
    assert_memory_equal(some, same, 3 * (size_t)count);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_no_split_is_the_case_table),
    cmocka_unit_test(test_other_bits_do_not_matter), cmocka_unit_test(test_turned_cells),
    cmocka_unit_test(test_all_cells) };
  return cmocka_run_group_tests_name("adaptive_cell", tests, NULL, NULL);
}
