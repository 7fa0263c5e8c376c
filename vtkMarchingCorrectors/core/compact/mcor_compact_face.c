/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compact contours: undoes merges that turn triangles over, and moves vertices of slivers. */

#include "mcor_compact.h"
#include "mcor_vector.h"

/* The badness of a triangle or line that is turned over. It is turned over if the angle between its
 * normal and the sum of its corners' unit gradients is at most 90 degrees. */
#define MCOR_TURNED 8.0
/* A triangle of larger badness is a sliver (least angle below 20 degrees), or is turned over. */
#define MCOR_SLIVER (4 * 0.93969262 * 0.93969262)

/* Returns the badness of a triangle or line: MCOR_TURNED if it is turned over or has no extent;
 * else 0 for a line, and for a triangle four times the squared cosine of its least angle, which is
 * opposite to the shortest side. widest: the corner opposite to the longest side. */
static double mcor_badness(const mcor_bunches* bunches, const int32_t place[3], int* widest)
{
  double side[3][3], square[3], normal[3], uphill[3] = { 0 };
  for (int c = 0; c < 3; ++c)
  {
    const mcor_point *p = &bunches->points[place[(c + 1) % 3]],
                     *q = &bunches->points[place[(c + 2) % 3]];
    for (int a = 0; a < 3; ++a)
    {
      side[c][a] = (double)(q->at[a] - p->at[a]) * bunches->edge[a];
      uphill[a] += c == 0 && bunches->corners == 2 ? 0 : p->uphill[a];
    }
    square[c] = mcor_dot(side[c], side[c]);
  }
  mcor_cross(side[0], side[1], normal);
  if (bunches->corners == 2) /* from corner 0 to corners 1 and 2, which are the same */
  {
    normal[0] = -side[1][1];
    normal[1] = side[1][0];
  }
  *widest = square[2] > fmax(square[0], square[1]) ? 2 : square[1] > square[0];
  if (!(mcor_dot(normal, uphill) < 0))
  {
    return MCOR_TURNED;
  }
  const double low = fmin(square[0], square[1]), high = fmax(square[0], square[1]),
               least = fmin(low, square[2]), rest = fmax(low, square[2]),
               along = high + rest - least;
  return bunches->corners == 2 ? 0 : high * rest > 0 ? along * along / (high * rest) : 4;
}

/* ---- Bunches that are taken apart ---- */

/* Judges each triangle. A merged bunch at its corners becomes bad if it did not reach the surface.
 * If all bunches reached the surface, but the triangle is turned over, all merged bunches at its
 * corners become bad. Sets `wide` for the widest corner of a sliver, if this vertex may move. */
static void mcor_judge_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bunches* bunches = data;
  for (int64_t t = first; t < last; ++t)
  {
    const cl_int* corner = bunches->triangles + 3 * t;
    int32_t place[3];
    int widest;
    bool missed = false;
    if (!mcor_places_of(bunches, t, place))
    {
      continue;
    }
    for (int c = 0; c < bunches->corners; ++c)
    {
      missed = missed || (bunches->points[place[c]].missed && mcor_is_merged(bunches, corner[c]));
    }
    const double badness = missed ? 0 : mcor_badness(bunches, place, &widest);
    for (int c = 0; c < bunches->corners && (missed || badness == MCOR_TURNED); ++c)
    {
      if (mcor_is_merged(bunches, corner[c]) && (!missed || bunches->points[place[c]].missed))
      {
        mcor_set_state(bunches, corner[c], MCOR_BUNCH_BAD);
      }
    }
    if (bunches->corners == 3 && badness > MCOR_SLIVER)
    {
      const int32_t v = mcor_stand_in(bunches, corner[widest]);
      const bool moves =
        bunches->of[v].key != MCOR_FROZEN && (!bunches->of[v].held || mcor_is_merged(bunches, v));
      atomic_store_explicit(&bunches->of[v].wide, moves, memory_order_relaxed);
    }
  }
  (void)slice;
}

/* Takes a bunch apart. Also takes apart the bunches beside it that lean on it (`leans`), because
 * they stay merged only as long as it does. */
static void mcor_split_bunch(const mcor_bunches* bunches, int32_t first)
{
  const mcor_bunch_vertex* of = bunches->of;
  mcor_set_state(bunches, first, MCOR_BUNCH_APART);
  for (int32_t v = first; v >= 0; v = of[v].next)
  {
    mcor_set_place(bunches, v, v);
  }
  for (int32_t e = of[first].leans ? -1 : of[first].star; e >= 0; e = bunches->before[e])
  {
    for (int c = 0; c < bunches->corners; ++c)
    {
      const int32_t other = of[bunches->triangles[e / 3 * 3 + c]].first;
      if (of[other].leans && mcor_is_merged(bunches, other))
      {
        mcor_split_bunch(bunches, other);
      }
    }
  }
}

/* Takes bad bunches apart. Taking a bunch apart can turn over only triangles around the bunch, so
 * each round judges only these triangles again. */
mcor_status mcor_take_apart(mcor_bunches* bunches)
{
  const mcor_bunch_vertex* of = bunches->of;
  MCOR_TRY(mcor_parallel_run(
    bunches->context, bunches->triangle_count, MCOR_LIGHT_GRAIN, mcor_judge_slice, bunches, NULL));
  for (int round = 0; round < MCOR_COMPACT_ROUNDS; ++round)
  {
    for (int64_t i = 0; i < bunches->starts.count; ++i)
    {
      const int32_t v = bunches->starts.of[i].vertex;
      if (of[v].state == MCOR_BUNCH_BAD)
      {
        mcor_split_bunch(bunches, v);
      }
    }
    for (int64_t i = 0; i < bunches->starts.count; ++i)
    {
      const int32_t v = bunches->starts.of[i].vertex;
      for (int32_t e = mcor_is_merged(bunches, v) ? -1 : of[v].star; e >= 0; e = bunches->before[e])
      {
        mcor_judge_slice(bunches, 0, e / 3, e / 3 + 1);
      }
    }
  }
  return MCOR_OK;
}

/* ---- Slivers ---- */

/* A line on which a vertex is corrected begins at most this far from the vertex's node along each
 * axis, in lattice edges. So the line ends within MCOR_POINT_EXTENT of the node. */
#define MCOR_FARTHEST_START 2.5

/* Sets start->at to the mean of the vertices around a vertex, and start->worst to the greatest
 * badness of the triangles around it. Returns whether the vertex may move to this mean: the mean
 * must be near the vertex's node (MCOR_FARTHEST_START), and no neighbour with a lower number may be
 * the widest corner of a sliver. */
static bool mcor_look_around(const mcor_bunches* bunches, mcor_start* start)
{
  const mcor_bunch_vertex* of = bunches->of;
  const int32_t own = of[start->vertex].now;
  const mcor_point* point = &bunches->points[own];
  const int fix = MCOR_POINT_FIX + (point->node[3] >> MCOR_LEVEL_SHIFT);
  int64_t count = 0;
  bool moves = true;
  *start = (mcor_start){ .vertex = start->vertex, .last = start->last };
  for (int32_t e = of[of[start->vertex].first].star; e >= 0; e = bunches->before[e])
  {
    int32_t place[3];
    int widest;
    if (!mcor_places_of(bunches, e / 3, place) ||
      (place[0] != own && place[1] != own && place[2] != own))
    {
      continue;
    }
    start->worst = fmax(start->worst, mcor_badness(bunches, place, &widest));
    for (int c = 0; c < 3; ++c)
    {
      const int32_t other = mcor_stand_in(bunches, bunches->triangles[e / 3 * 3 + c]);
      moves = moves && (other >= start->vertex || !of[other].wide);
      count += place[c] != own;
      for (int a = 0; a < 3 && place[c] != own; ++a)
      {
        start->at[a] += bunches->points[place[c]].at[a];
      }
    }
  }
  for (int a = 0; a < 3 && count > 0; ++a)
  {
    start->at[a] /= count;
    moves = moves &&
      fabs((double)start->at[a] - ldexp(point->node[a], fix)) <= ldexp(MCOR_FARTHEST_START, fix);
  }
  return moves && count > 0;
}

/* Moves each vertex at the widest angle of a sliver to the mean of the vertices around it, and
 * corrects the vertex from there. Puts the vertex back if it does not reach the surface, or if the
 * worst triangle around it is no better than before. */
mcor_status mcor_move_slivers(mcor_bunches* bunches)
{
  bunches->starts.count = 0;
  for (int32_t v = 0; v < bunches->vertex_count; ++v)
  {
    mcor_start start = { .vertex = v };
    if (bunches->of[v].wide && mcor_look_around(bunches, &start))
    {
      MCOR_APPEND(bunches->context, &bunches->starts, start);
    }
  }
  MCOR_TRY(mcor_add_vertices(bunches));
  for (int64_t i = 0; i < bunches->starts.count; ++i)
  {
    mcor_start* start = &bunches->starts.of[i];
    const double worst = start->worst;
    mcor_look_around(bunches, start);
    if (bunches->points[bunches->of[start->vertex].now].missed || start->worst >= worst)
    {
      mcor_set_place(bunches, start->vertex, start->last);
    }
  }
  return MCOR_OK;
}
