/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Derives the cases of Marching Cubes. On each face, one segment cuts off each run of corners above
 * the iso value; this depends on the face's corners alone, so two cells agree on their common face.
 * Segments form loops, and loops are cut into triangles. No diagonal lies within a face, because
 * the neighbour cell might have the same one, and four triangles would then meet there.
 *
 * The corners of an ambiguous face are above and below in turn: either those above are cut off, or
 * they are joined, and those below are cut off. Each of the 256 cases has a row for each
 * combination of these decisions. Two loops around the same region may become a tunnel. Some rows
 * need diagonals within a face; see mcor_allow_side. */

#include "mcor_internal.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_CELL_EDGES 24 /* axis << 3 | lower corner; not all numbers are edges */

static int mcor_corner_above(int cube_case, int corner)
{
  return cube_case >> corner & 1;
}

/* Returns the edge between two neighbouring corners. */
static int mcor_edge_between(int a, int b)
{
  const int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
  return axis << 3 | (a & b);
}

/* Lists the corners of a face, counter-clockwise seen from outside. */
static void mcor_face_corners(int axis, int side, int corners[4])
{
  const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
  corners[0] = base;
  corners[1] = base | (side ? u : v);
  corners[2] = base | u | v;
  corners[3] = base | (side ? v : u);
}

static int mcor_face_ambiguous(int cube_case, int face)
{
  int corner[4];
  mcor_face_corners(face >> 1, face & 1, corner);
  const int first = mcor_corner_above(cube_case, corner[0]);
  return mcor_corner_above(cube_case, corner[1]) != first &&
    mcor_corner_above(cube_case, corner[2]) == first &&
    mcor_corner_above(cube_case, corner[3]) != first;
}

/* Sets next[edge] to the edge that follows on the loop, or to -1 if the edge is not crossed. The
 * direction makes triangles face the corners below. joined: bits axis * 2 + side of the
 * ambiguous faces whose corners above are joined. */
static void mcor_link_edges(int cube_case, int joined, int next[MCOR_CELL_EDGES])
{
  for (int e = 0; e < MCOR_CELL_EDGES; ++e)
  {
    next[e] = -1;
  }
  for (int face = 0; face < 6; ++face)
  {
    int corner[4];
    mcor_face_corners(face >> 1, face & 1, corner);
    for (int i = 0; i < 4; ++i)
    {
      const int from = corner[i], to = corner[(i + 1) % 4];
      if (mcor_corner_above(cube_case, from) || !mcor_corner_above(cube_case, to))
      {
        continue;
      }
      if (joined >> face & 1)
      {
        next[mcor_edge_between(from, to)] = mcor_edge_between(corner[(i + 3) % 4], from);
        continue;
      }
      int last = i + 1; /* end of the run of corners above that begins at `to` */
      while (mcor_corner_above(cube_case, corner[(last + 1) % 4]))
      {
        ++last;
      }
      next[mcor_edge_between(from, to)] =
        mcor_edge_between(corner[last % 4], corner[(last + 1) % 4]);
    }
  }
}

/* Returns the face that both edges lie in, axis * 2 + side, or -1. */
static int mcor_common_face(int edge_a, int edge_b)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (axis != edge_a >> 3 && axis != edge_b >> 3 && ((edge_a ^ edge_b) >> axis & 1) == 0)
    {
      return axis * 2 + (edge_a >> axis & 1);
    }
  }
  return -1;
}

#define MCOR_NO_DIAGONALS (-1)

/* Whether triangles of a cell may have a side between the vertices of two edges that do not follow
 * each other on a loop. Without a case, only if the edges have no common face. With a case,
 * opposite edges of an ambiguous face are allowed, too. Such a face has two such sides; the cell
 * below may use one, and the cell above the other. The face's lowest corner decides which one. This
 * makes the three faces around a corner alike; otherwise few tunnels could be made. */
static int mcor_allow_side(int edge_a, int edge_b, int cube_case)
{
  const int face = mcor_common_face(edge_a, edge_b), axis = edge_a >> 3, side = face & 1;
  if (face < 0 || cube_case == MCOR_NO_DIAGONALS || axis != edge_b >> 3)
  {
    return face < 0;
  }
  const int first = side ^ mcor_corner_above(cube_case, side << face / 2);
  return axis == (face / 2 + (first ? 1 : 2)) % 3;
}

static void mcor_add_triangle(mcor_cell_row* row, int a, int b, int c)
{
  uint8_t* triangle = row->edges + 3 * row->triangles++;
  triangle[0] = (uint8_t)a;
  triangle[1] = (uint8_t)b;
  triangle[2] = (uint8_t)c;
}

/* Cuts loop[first..last] into triangles, see mcor_allow_side. Returns 0 if this is impossible. */
static int mcor_cut_loop(const int* loop, int first, int last, int cube_case, mcor_cell_row* row)
{
  if (last - first < 2)
  {
    return 1;
  }
  const uint8_t triangles = row->triangles;
  for (int apex = first + 1; apex < last; ++apex)
  {
    if ((apex > first + 1 && !mcor_allow_side(loop[first], loop[apex], cube_case)) ||
      (apex < last - 1 && !mcor_allow_side(loop[apex], loop[last], cube_case)))
    {
      continue;
    }
    mcor_add_triangle(row, loop[first], loop[apex], loop[last]);
    if (mcor_cut_loop(loop, first, apex, cube_case, row) &&
      mcor_cut_loop(loop, apex, last, cube_case, row))
    {
      return 1;
    }
    row->triangles = triangles;
  }
  return 0;
}

typedef struct mcor_loops
{
  int cube_case, count;
  int length[4], edge[4][12];
} mcor_loops;

static void mcor_trace_loops(int cube_case, int joined, mcor_loops* loops)
{
  int next[MCOR_CELL_EDGES];
  mcor_link_edges(cube_case, joined, next);
  loops->cube_case = cube_case;
  loops->count = 0;
  for (int e = 0; e < MCOR_CELL_EDGES; ++e)
  {
    if (next[e] < 0)
    {
      continue;
    }
    int length = 0;
    for (int at = e; next[at] >= 0; ++length)
    {
      loops->edge[loops->count][length] = at;
      const int following = next[at];
      next[at] = -1;
      at = following;
    }
    loops->length[loops->count++] = length;
  }
}

static void mcor_fill_loop(const mcor_loops* loops, int i, mcor_cell_row* row)
{
  const int last = loops->length[i] - 1;
  const int cut = mcor_cut_loop(loops->edge[i], 0, last, MCOR_NO_DIAGONALS, row) ||
    mcor_cut_loop(loops->edge[i], 0, last, loops->cube_case, row);
  assert(cut);
  (void)cut;
}

/* ---- tunnels ---- */

/* Gives corners the same number in `region` if the cell's surface connects them on their side. */
static void mcor_find_regions(int cube_case, int joined, int region[8])
{
  for (int c = 0; c < 8; ++c)
  {
    region[c] = c;
  }
  for (int round = 0; round < 8; ++round)
  {
    for (int face = 0; face < 6; ++face)
    {
      int corner[4];
      mcor_face_corners(face >> 1, face & 1, corner);
      const int ambiguous = mcor_face_ambiguous(cube_case, face);
      for (int i = 0; i < 4; ++i)
      {
        const int a = corner[i], b = corner[(i + 1 + ambiguous) % 4];
        const int above = mcor_corner_above(cube_case, a);
        const int connected =
          ambiguous ? above == (joined >> face & 1) : above == mcor_corner_above(cube_case, b);
        if (connected)
        {
          region[a] = region[b] = region[a] < region[b] ? region[a] : region[b];
        }
      }
    }
  }
}

/* A strip of triangles between two loops. A step from side (a, b), either along the first loop or
 * back along the second, adds a triangle. */
typedef struct mcor_strip
{
  int cube_case;
  const int *first, *second;
  int first_length, second_length, start; /* the first side: first[0], second[start] */
  uint8_t used[12][12];
  int step[24]; /* 0: along the first loop */
  int best_cost, best_start, best_step[24];
} mcor_strip;

/* Returns the squared distance between the middles of two edges, in half cubes; much more if both
 * are in one face. */
static int mcor_side_cost(int edge_a, int edge_b)
{
  int cost = mcor_allow_side(edge_a, edge_b, MCOR_NO_DIAGONALS) ? 0 : 1000;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int a = 2 * (edge_a >> axis & 1) + (edge_a >> 3 == axis);
    const int b = 2 * (edge_b >> axis & 1) + (edge_b >> 3 == axis);
    cost += (a - b) * (a - b);
  }
  return cost;
}

/* Tries all strips that continue after a steps along the first loop and b steps along the
 * second. */
static void mcor_search_strip(mcor_strip* strip, int a, int b, int cost)
{
  if (cost >= strip->best_cost || a > strip->first_length || b > strip->second_length)
  {
    return;
  }
  const int steps = a + b;
  if (a == strip->first_length && b == strip->second_length)
  {
    strip->best_cost = cost;
    strip->best_start = strip->start;
    memcpy(strip->best_step, strip->step, sizeof strip->step);
    return;
  }
  const int i = a % strip->first_length;
  const int j =
    (strip->start + strip->second_length - b % strip->second_length) % strip->second_length;
  if (strip->used[i][j] || !mcor_allow_side(strip->first[i], strip->second[j], strip->cube_case))
  {
    return;
  }
  cost += mcor_side_cost(strip->first[i], strip->second[j]);
  strip->used[i][j] = 1;
  strip->step[steps] = 0;
  mcor_search_strip(strip, a + 1, b, cost);
  strip->step[steps] = 1;
  mcor_search_strip(strip, a, b + 1, cost);
  strip->used[i][j] = 0;
}

/* Adds the shortest tunnel between two loops. Returns 0 if there is none. */
static int mcor_fill_tunnel(const mcor_loops* loops, int first, int second, mcor_cell_row* row)
{
  const int limit = 1 << 20;
  mcor_strip strip = { .cube_case = loops->cube_case,
    .first = loops->edge[first],
    .second = loops->edge[second],
    .first_length = loops->length[first],
    .second_length = loops->length[second],
    .best_cost = limit };
  for (strip.start = 0; strip.start < strip.second_length; ++strip.start)
  {
    mcor_search_strip(&strip, 0, 0, 0);
  }
  if (strip.best_cost == limit)
  {
    return 0;
  }
  int i = 0, j = strip.best_start;
  for (int n = 0; n < strip.first_length + strip.second_length; ++n)
  {
    const int next = (i + 1) % strip.first_length;
    const int last = (j + strip.second_length - 1) % strip.second_length;
    if (strip.best_step[n])
    {
      mcor_add_triangle(row, strip.second[last], strip.second[j], strip.first[i]);
      j = last;
    }
    else
    {
      mcor_add_triangle(row, strip.first[i], strip.first[next], strip.second[j]);
      i = next;
    }
  }
  return 1;
}

/* Finds the pair of loops that a tunnel may connect. The tunnel must join two regions on `side` (1:
 * above), and the region between the loops must be on the other side. Returns 0 unless there is
 * exactly one pair. */
static int mcor_find_pair(const mcor_loops* loops, int joined, int side, int* first, int* second)
{
  int region[8], around[4], pairs = 0;
  mcor_find_regions(loops->cube_case, joined, region);
  for (int i = 0; i < loops->count; ++i)
  {
    const int edge = loops->edge[i][0], lower = edge & 7, upper = lower | 1 << (edge >> 3);
    around[i] = region[mcor_corner_above(loops->cube_case, lower) == side ? upper : lower];
    for (int j = 0; j < i; ++j)
    {
      if (around[i] == around[j])
      {
        *first = j;
        *second = i;
        ++pairs;
      }
    }
  }
  return pairs == 1;
}

/* Makes the rows of a case for one set of decisions: `row` fills each loop with a disc; rows with a
 * tunnel go to `to` and following. Returns the number of rows with a tunnel. */
static int mcor_fill_rows(
  int cube_case, int joined, mcor_cell_row* first_row, mcor_cell_row* row, mcor_cell_row* to)
{
  mcor_loops loops;
  mcor_trace_loops(cube_case, joined, &loops);
  for (int i = 0; i < loops.count; ++i)
  {
    mcor_fill_loop(&loops, i, row);
  }
  int count = 0, first = 0, second = 0;
  for (int side = 0; side < 2; ++side)
  {
    if (!mcor_find_pair(&loops, joined, side, &first, &second) ||
      !mcor_fill_tunnel(&loops, first, second, to + count))
    {
      continue;
    }
    for (int i = 0; i < loops.count; ++i)
    {
      if (i != first && i != second)
      {
        mcor_fill_loop(&loops, i, to + count);
      }
    }
    row->tunnel[side] = (uint8_t)(to + count - first_row);
    ++count;
  }
  return count;
}

void mcor_make_case_table(mcor_case_table* table)
{
  memset(table, 0, sizeof *table);
  for (int cube_case = 0; cube_case < 256; ++cube_case)
  {
    mcor_cell_row* const first = table->rows + table->row_count;
    int faces[6], face_count = 0, ambiguous = 0;
    for (int face = 0; face < 6; ++face)
    {
      if (mcor_face_ambiguous(cube_case, face))
      {
        faces[face_count++] = face;
        ambiguous |= 1 << face;
      }
    }
    table->cases[cube_case] = table->row_count << 6 | ambiguous;
    int rows = 1 << face_count;
    for (int decisions = 0; decisions < 1 << face_count; ++decisions)
    {
      int joined = 0;
      for (int i = 0; i < face_count; ++i)
      {
        joined |= (decisions >> i & 1) << faces[i];
      }
      rows += mcor_fill_rows(cube_case, joined, first, first + decisions, first + rows);
    }
    assert(rows < 256);
    table->row_count += rows;
    assert(table->row_count <= MCOR_CASE_ROWS);
  }
}

mcor_status mcor_upload_case_table(mcor_context* context)
{
  if (context->case_rows.mem)
  {
    return MCOR_OK;
  }
  mcor_case_table* table = malloc(sizeof *table);
  MCOR_TRY(mcor_allocated(context, table));
  mcor_make_case_table(table);
  const size_t bytes = (size_t)table->row_count * sizeof table->rows[0];
  mcor_status status = mcor_write(context, &context->cases, table->cases, sizeof table->cases);
  MCOR_THEN(status, mcor_write(context, &context->case_rows, table->rows, bytes));
  free(table);
  return status;
}
