/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Derives the cases of Marching Cubes by mcor_adaptive_cell.h: its functions trace loops of
 * segments around a cell without finer cells beside it, and cut the loops into triangles. The
 * triangles have no diagonals within a face, because the neighbour cell might have the same
 * diagonal, and four triangles would then meet in it. Some rows need such diagonals; see
 * mcor_allow_diagonals.
 *
 * The corners of an ambiguous face are above and below the iso value in turn. Either the corners
 * above are cut off, or they are joined and the corners below are cut off. Each of the 256 cases
 * has a row for each combination of these decisions. Two loops around the same region may become a
 * tunnel. */

#include "mcor_internal.h"

#include "mcor_adaptive_cell.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* Returns the corner (bits 1 x, 2 y, 4 z) at one of the 27 positions in a cell. */
static int mcor_corner_at(int position)
{
  return position % 3 / 2 | position / 3 % 3 / 2 << 1 | position / 18 << 2;
}

/* Returns corner i of a face, counter-clockwise seen from outside. */
static int mcor_face_corner(int face, int i)
{
  return mcor_corner_at(mcor_adaptive_face_node(face, 2 * (i & 3)));
}

static int mcor_face_ambiguous(int cube_case, int face)
{
  int changes = 0;
  for (int i = 0; i < 4; ++i)
  {
    changes +=
      (cube_case >> mcor_face_corner(face, i) ^ cube_case >> mcor_face_corner(face, i + 1)) & 1;
  }
  return changes == 4;
}

/* ---- Loops ---- */

typedef struct mcor_loops
{
  int cube_case, count;
  mcor_adaptive_loop of[4];
} mcor_loops;

/* Finds the loops of a case. joined: bit axis * 2 + side is set for an ambiguous face whose corners
 * above are joined. */
static void mcor_trace_loops(int cube_case, int joined, mcor_loops* loops)
{
  cl_uint above = 0;
  for (int position = 0; position < 27; ++position)
  {
    above |= (cl_uint)(cube_case >> mcor_corner_at(position) & 1) << position;
  }
  mcor_adaptive_links links;
  mcor_adaptive_link(0, above, &links);
  for (int face = 0; face < 6; ++face)
  {
    int ring[4]; /* clockwise, so that segments cut off the corners below */
    for (int i = 0; i < 4; ++i)
    {
      ring[i] = mcor_adaptive_face_node(face, 6 - 2 * i);
    }
    if (joined >> face & 1)
    {
      mcor_adaptive_link_ring(ring, 4, ~above, &links);
    }
  }
  loops->cube_case = cube_case;
  loops->count = 0;
  for (int slot = 0; slot < MCOR_ADAPTIVE_SLOTS && loops->count < 4; ++slot)
  {
    mcor_adaptive_trace(0, slot, &links, &loops->of[loops->count]);
    loops->count += loops->of[loops->count].length > 0;
  }
}

/* Allows diagonals in each ambiguous face, between two opposite edges of the face. A face has two
 * such pairs of edges: one cell at the face uses one pair, the other cell the other pair. The sign
 * of the face's lowest corner decides which cell uses which pair. By this rule, a cell makes the
 * same choice in all three faces around a corner; otherwise few tunnels could be made. */
static void mcor_allow_diagonals(int cube_case, mcor_adaptive_loop* loop)
{
  for (int i = 0; i < loop->length; ++i)
  {
    for (int face = 0; face < 6; ++face)
    {
      const int normal = face >> 1, side = face & 1, axis = loop->slot[i] >> 5;
      const int first = side ^ (cube_case >> (side << normal) & 1);
      const bool is_end = axis == (normal + (first ? 1 : 2)) % 3;
      if (is_end &&
        (loop->facets[i] >> (24 + face) & 1)) /* puts the two edges into different facets */
      {
        const cl_uint facet = loop->place[i][3 - normal - axis] > 0 ? 2 : 1;
        loop->facets[i] &= ~((cl_uint)15 << 4 * face) | facet << 4 * face;
      }
    }
  }
}

static void mcor_add_triangles(mcor_cell_row* row, const uint8_t* slots, int triangles)
{
  for (int i = 0; i < 3 * triangles; ++i)
  {
    row->edges[3 * row->triangles + i] =
      (uint8_t)((slots[i] >> 5) << 3 | mcor_corner_at(slots[i] & 31));
  }
  row->triangles = (uint8_t)(row->triangles + triangles);
}

/* Adds to a row the triangles of a disc that fills a loop. */
static void mcor_fill_loop(const mcor_loops* loops, int i, mcor_cell_row* row)
{
  mcor_adaptive_loop loop = loops->of[i];
  uint8_t slots[3 * MCOR_ADAPTIVE_TRIANGLES];
  int cost = mcor_adaptive_cut_loop(0, &loop, slots);
  if (cost >= MCOR_ADAPTIVE_FORBIDDEN)
  {
    mcor_allow_diagonals(loops->cube_case, &loop);
    cost = mcor_adaptive_cut_loop(0, &loop, slots);
  }
  assert(cost < MCOR_ADAPTIVE_FORBIDDEN);
  (void)cost;
  mcor_add_triangles(row, slots, loop.length - 2);
}

/* ---- Tunnels ---- */

/* Gives corners the same number in `region` if they are on the same side of the iso value, and are
 * connected by edges of the cell or across ambiguous faces: a joined face connects its corners
 * above the iso value, any other ambiguous face its corners below. */
static void mcor_find_regions(int cube_case, int joined, int region[8])
{
  int pairs[24][2], count = 0;
  for (int i = 0; i < 24; ++i)
  {
    const int face = i / 4, ambiguous = mcor_face_ambiguous(cube_case, face);
    const int a = mcor_face_corner(face, i), b = mcor_face_corner(face, i + 1 + ambiguous);
    const int above = cube_case >> a & 1;
    if (ambiguous ? above == (joined >> face & 1) : above == (cube_case >> b & 1))
    {
      pairs[count][0] = a;
      pairs[count++][1] = b;
    }
  }
  for (int c = 0; c < 8; ++c)
  {
    region[c] = c;
  }
  for (int i = 0; i < 8 * count; ++i)
  {
    int *a = &region[pairs[i % count][0]], *b = &region[pairs[i % count][1]];
    *a = *b = *a < *b ? *a : *b;
  }
}

/* A strip of triangles between two loops. A side (a, b) goes from vertex a of the first loop to
 * vertex b of the second loop. A triangle lies between two successive sides: a step from one side
 * to the next goes along the first loop or back along the second, and adds a triangle. */
typedef struct mcor_strip
{
  mcor_adaptive_loop first, second;
  int start; /* the first side leads from vertex 0 of the first loop to this one of the second */
  uint8_t used[12][12];
  int best_cost;
  uint8_t path[3 * 24], best[3 * 24]; /* slots of triangles */
} mcor_strip;

/* Returns the cost of side (i, j): its squared length in half cell edges, plus 1000 in a face. */
static int mcor_side_cost(const mcor_strip* strip, int i, int j)
{
  int cost = (strip->first.facets[i] & strip->second.facets[j]) >> 24 ? 1000 : 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int d = (strip->first.place[i][axis] - strip->second.place[j][axis]) / 2;
    cost += d * d;
  }
  return cost;
}

/* Tries all ways to continue a strip of triangles that has gone `a` steps along the first loop and
 * `b` steps along the second. Keeps the cheapest strip. */
static void mcor_search_strip(mcor_strip* strip, int a, int b, int cost)
{
  const mcor_adaptive_loop *first = &strip->first, *second = &strip->second;
  const int n = first->length, m = second->length;
  if (cost >= strip->best_cost || a > n || b > m)
  {
    return;
  }
  if (a == n && b == m)
  {
    strip->best_cost = cost;
    memcpy(strip->best, strip->path, sizeof strip->path);
    return;
  }
  const int i = a % n, j = (strip->start + m - b % m) % m;
  if (strip->used[i][j] || (first->facets[i] & second->facets[j] & 0xffffff))
  {
    return;
  }
  const uint8_t triangles[2][3] = { { first->slot[i], first->slot[(i + 1) % n], second->slot[j] },
    { second->slot[(j + m - 1) % m], second->slot[j], first->slot[i] } };
  strip->used[i][j] = 1;
  for (int back = 0; back < 2; ++back)
  {
    memcpy(strip->path + 3 * (a + b), triangles[back], sizeof triangles[back]);
    mcor_search_strip(strip, a + !back, b + back, cost + mcor_side_cost(strip, i, j));
  }
  strip->used[i][j] = 0;
}

/* Adds the cheapest tunnel between two loops to a row. Returns 0 if there is none. */
static int mcor_fill_tunnel(const mcor_loops* loops, int first, int second, mcor_cell_row* row)
{
  const int limit = 1 << 20;
  mcor_strip strip = { .first = loops->of[first], .second = loops->of[second], .best_cost = limit };
  mcor_allow_diagonals(loops->cube_case, &strip.first);
  mcor_allow_diagonals(loops->cube_case, &strip.second);
  for (strip.start = 0; strip.start < strip.second.length; ++strip.start)
  {
    mcor_search_strip(&strip, 0, 0, 0);
  }
  if (strip.best_cost < limit)
  {
    mcor_add_triangles(row, strip.best, strip.first.length + strip.second.length);
  }
  return strip.best_cost < limit;
}

/* Finds the pair of loops that a tunnel may connect. The tunnel joins two regions on `side` (1:
 * above the iso value), so the region between the loops must be on the other side. Returns 0 unless
 * there is exactly one pair. */
static int mcor_find_pair(const mcor_loops* loops, int joined, int side, int* first, int* second)
{
  int region[8], around[4], pairs = 0;
  mcor_find_regions(loops->cube_case, joined, region);
  for (int i = 0; i < loops->count; ++i)
  {
    const int slot = loops->of[i].slot[0], lower = mcor_corner_at(slot & 31),
              upper = lower | 1 << (slot >> 5);
    around[i] = region[(loops->cube_case >> lower & 1) == side ? upper : lower];
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

/* Makes the rows of a case for one set of decisions. In `row`, each loop is filled by a disc. Rows
 * with a tunnel are written to to[0], to[1], ...; row->tunnel gets their numbers, counted from
 * first_row. Returns the number of rows with a tunnel. */
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
