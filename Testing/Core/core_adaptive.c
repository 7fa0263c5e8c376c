/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#include "core_adaptive.h"

#include <string.h>

#define MIDDLE 13

typedef struct node_place
{
  int at[3]; /* 0..2 */
} node_place;

static node_place place_of(int node)
{
  return (node_place){ { node % 3, node / 3 % 3, node / 9 } };
}

static int node_of(node_place p)
{
  return p.at[0] + 3 * p.at[1] + 9 * p.at[2];
}

/* How many coordinates are in the middle: 0 corner, 1 edge, 2 face. */
static int node_kind(int node)
{
  const node_place p = place_of(node);
  return (p.at[0] == 1) + (p.at[1] == 1) + (p.at[2] == 1);
}

/* ---- sets of split faces and edges ---- */

/* Node under one of the 48 symmetries of the cube. */
static int turned(int node, int symmetry)
{
  static const int order[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 },
    { 2, 1, 0 } };
  const node_place p = place_of(node);
  node_place q;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int at = p.at[order[symmetry / 8][axis]];
    q.at[axis] = symmetry >> axis & 1 ? 2 - at : at;
  }
  return node_of(q);
}

uint32_t core_turn_split(uint32_t mask, int symmetry)
{
  uint32_t result = 0;
  for (int node = 0; node < 27; ++node)
  {
    result |= (mask >> node & 1) << turned(node, symmetry);
  }
  return result;
}

/* Least of the masks that symmetry makes of this one. */
static int is_representative(uint32_t mask)
{
  for (int symmetry = 1; symmetry < 48; ++symmetry)
  {
    if (core_turn_split(mask, symmetry) < mask)
    {
      return 0;
    }
  }
  return 1;
}

/* The edges of a face, as nodes. */
static uint32_t edges_of_face(int face)
{
  const node_place middle = place_of(face);
  uint32_t edges = 0;
  for (int node = 0; node < 27; ++node)
  {
    const node_place p = place_of(node);
    for (int axis = 0; axis < 3; ++axis)
    {
      if (middle.at[axis] != 1 && p.at[axis] == middle.at[axis] && node_kind(node) == 1)
      {
        edges |= 1u << node;
      }
    }
  }
  return edges;
}

/* All sets in which a split face has split edges; one of each class. */
int core_list_splits(uint32_t splits[CORE_SPLIT_CLASSES])
{
  int edges[12], faces[6], edge_count = 0, face_count = 0, count = 0;
  for (int node = 0; node < 27; ++node)
  {
    if (node_kind(node) == 1)
    {
      edges[edge_count++] = node;
    }
    else if (node_kind(node) == 2)
    {
      faces[face_count++] = node;
    }
  }
  for (int some = 0; some < 1 << 18; ++some)
  {
    uint32_t mask = 0, needed = 0;
    for (int i = 0; i < 12; ++i)
    {
      mask |= (uint32_t)(some >> i & 1) << edges[i];
    }
    for (int i = 0; i < 6; ++i)
    {
      mask |= (uint32_t)(some >> (12 + i) & 1) << faces[i];
      needed |= some >> (12 + i) & 1 ? edges_of_face(faces[i]) : 0;
    }
    if ((mask & needed) == needed && is_representative(mask))
    {
      CORE_CHECK(count < CORE_SPLIT_CLASSES, "more than %d classes", CORE_SPLIT_CLASSES);
      splits[count++] = mask;
    }
  }
  return count;
}

/* ---- what a cell's surface must look like ---- */

static int is_node(uint32_t split, int node)
{
  return node_kind(node) == 0 || (split >> node & 1);
}

static int slot_between(int a, int b)
{
  const node_place p = place_of(a), q = place_of(b);
  int axis = 0;
  while (p.at[axis] == q.at[axis])
  {
    ++axis;
  }
  return axis << 5 | (a < b ? a : b);
}

/* A square of the face, size 1 or 2, with its least corner at (u, v). */
static void add_facet(core_shape* cell, int face, int u, int v, int size)
{
  static const int around[8][2] = { { 0, 0 }, { 1, 0 }, { 2, 0 }, { 2, 1 }, { 2, 2 }, { 1, 2 },
    { 0, 2 }, { 0, 1 } };
  core_facet* facet = cell->facets + cell->facet_count++;
  const int axis = face / 2, upper = face % 2;
  facet->count = 0;
  facet->whole = size == 2;
  for (int i = 0; i < 8; ++i)
  {
    /* Against the clock from the face's lower side, so turned around there. */
    const int* step = around[upper ? i : (8 - i) % 8];
    node_place p;
    p.at[axis] = 2 * upper;
    p.at[(axis + 1) % 3] = u + step[0] * size / 2;
    p.at[(axis + 2) % 3] = v + step[1] * size / 2;
    if (size == 2 ? is_node(cell->split, node_of(p)) : i % 2 == 0)
    {
      facet->nodes[facet->count++] = node_of(p);
    }
  }
  for (int i = 0; i < facet->count; ++i)
  {
    facet->slots[i] = slot_between(facet->nodes[i], facet->nodes[(i + 1) % facet->count]);
  }
}

static void forbid(core_shape* cell, const int* slots, int count)
{
  for (int i = 0; i < count; ++i)
  {
    for (int j = 0; j < count; ++j)
    {
      cell->forbidden[slots[i]][slots[j]] = 1;
    }
  }
}

void core_make_shape(uint32_t split, core_shape* cell)
{
  memset(cell, 0, sizeof *cell);
  cell->split = split;
  for (int node = 0; node < 27; ++node)
  {
    if (node != MIDDLE && is_node(split, node))
    {
      cell->nodes[cell->node_count++] = node;
    }
    if (node_kind(node) == 1 && is_node(split, node)) /* a split edge's halves */
    {
      node_place low = place_of(node), high = low;
      const int axis = low.at[0] == 1 ? 0 : low.at[1] == 1 ? 1 : 2;
      low.at[axis] = 0;
      high.at[axis] = 2;
      const int halves[2] = { slot_between(node_of(low), node), slot_between(node, node_of(high)) };
      forbid(cell, halves, 2);
    }
  }
  for (int face = 0; face < 6; ++face)
  {
    node_place middle = { { 1, 1, 1 } };
    middle.at[face / 2] = 2 * (face % 2);
    const int quarters = is_node(split, node_of(middle)) ? 4 : 1;
    for (int i = 0; i < quarters; ++i)
    {
      core_facet* facet = cell->facets + cell->facet_count;
      add_facet(cell, face, i % 2, i / 2, quarters == 4 ? 1 : 2);
      forbid(cell, facet->slots, facet->count);
      for (int k = 0; k < facet->count && facet->whole; ++k)
      {
        cell->in_whole[facet->slots[k]] |= (uint8_t)(1 << face);
      }
    }
  }
}

/* next[slot] by the rule: on each facet, each run of nodes above is cut off. Returns the number of
 * vertices. */
int core_link_slots(const core_shape* cell, uint32_t above, int8_t next[MCOR_ADAPTIVE_SLOTS])
{
  int vertices = 0, segments = 0;
  memset(next, -1, MCOR_ADAPTIVE_SLOTS);
  for (int f = 0; f < cell->facet_count; ++f)
  {
    const core_facet* facet = cell->facets + f;
    int entered = -1, left = -1, first_left = -1;
    for (int i = 0; i < facet->count; ++i)
    {
      const int here = above >> facet->nodes[i] & 1;
      const int there = above >> facet->nodes[(i + 1) % facet->count] & 1;
      if (!here && there)
      {
        entered = facet->slots[i];
      }
      else if (here && !there)
      {
        left = facet->slots[i];
        if (entered < 0)
        {
          first_left = left; /* of the run that begins at the end of the ring */
          continue;
        }
        next[entered] = (int8_t)left;
        entered = -1;
        ++segments;
      }
    }
    if (entered >= 0)
    {
      next[entered] = (int8_t)first_left;
      ++segments;
    }
  }
  for (int slot = 0; slot < MCOR_ADAPTIVE_SLOTS; ++slot)
  {
    vertices += next[slot] >= 0;
  }
  CORE_CHECK(vertices == segments, "split %x, above %x: two segments begin at one vertex",
    cell->split, above);
  return vertices;
}
