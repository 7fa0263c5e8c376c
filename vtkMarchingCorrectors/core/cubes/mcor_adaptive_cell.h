/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_adaptive_cell_h
#define mcor_adaptive_cell_h

/* Marching Cubes in a cell with finer cells around it. This file is both included by the C core and
 * compiled as OpenCL C, after mcor_shared.h.
 *
 * A cell has 3 x 3 x 3 positions, half a cell edge apart; their numbers are x + 3 y + 9 z. Its
 * corners are nodes. If a finer cell touches an edge, the edge is split into two halves, and its
 * middle is a node, too. If the cells across a face are finer, the face is split: its middle is a
 * node, and its four edges are split as well. Bits of `split` say which middles are nodes, bits of
 * `above` which nodes are above the iso value. A slot is half of an edge, axis << 5 | its lower
 * node; the vertex of an edge that is not split has the slot of the lower half.
 *
 * A split face consists of four quarters, the sub-faces. On a sub-face, and on the ring of 4 to 8
 * nodes around a face that is not split, one segment cuts off each run of nodes above the iso
 * value, as in the case table; both cells at the face find the same segments. Segments form loops.
 * A loop is cut into triangles such that no diagonal has both ends in one sub-face, in one whole
 * face or on one edge of the cell, because another cell could have the same diagonal. A trial of
 * all cases showed that this is always possible, except for loops that lie in one whole face; no
 * other cell has the diagonals of such a loop. test_core_cell.c tests cells side by side. Triangles
 * with the shortest diagonals are chosen, with vertices taken in the middle of their edges; a
 * diagonal that lies in a face counts as long.
 *
 * A loop of two vertices has no triangles: its two segments are the same line. */

#define MCOR_ADAPTIVE_SLOTS 96     /* number of codes of slots; 48 occur */
#define MCOR_ADAPTIVE_VERTICES 32  /* most vertices of a loop */
#define MCOR_ADAPTIVE_TRIANGLES 30 /* most triangles of a cell */

#ifdef __OPENCL_VERSION__
#define MCOR_ADAPTIVE_FUNCTION
#else
#define MCOR_ADAPTIVE_FUNCTION static inline
#endif

/* Costs of a loop's diagonals. One forbidden diagonal costs more than all allowed ones together. */
#define MCOR_ADAPTIVE_FLAT 64 /* of a diagonal in a face; squared lengths are up to 48 */
#define MCOR_ADAPTIVE_FORBIDDEN 8192

/* For each slot, the next slot of its loop; 0xff: no vertex. */
typedef struct mcor_adaptive_links
{
  MCOR_TYPE(uchar) next[MCOR_ADAPTIVE_SLOTS];
} mcor_adaptive_links;

/* A loop. facets: the parts of the cell's surface that each vertex lies in. Bits 4 f to 4 f + 3 are
 * the four sub-faces of face f (if the face is not split, all four bits are set); bit 24 + f is the
 * face. */
typedef struct mcor_adaptive_loop
{
  int length;
  MCOR_TYPE(uchar) slot[MCOR_ADAPTIVE_VERTICES];
  MCOR_TYPE(uchar) place[MCOR_ADAPTIVE_VERTICES][3]; /* 0..4, in quarters of the cell's edge */
  MCOR_TYPE(uint) facets[MCOR_ADAPTIVE_VERTICES];
} mcor_adaptive_loop;

/* Positions are numbered x + 3 y + 9 z. Returns by how much the number grows from one position to
 * the next one along an axis. */
MCOR_ADAPTIVE_FUNCTION int mcor_adaptive_step(int axis)
{
  return axis == 0 ? 1 : axis == 1 ? 3 : 9;
}

/* Returns the slot (half of an edge) between two nodes, which are half an edge or an edge apart. */
MCOR_ADAPTIVE_FUNCTION int mcor_adaptive_slot(int a, int b)
{
  const int lower = a < b ? a : b, step = a + b - 2 * lower;
  return (step < 3 ? 0 : step < 9 ? 1 : 2) << 5 | lower;
}

/* Links slots in a ring of nodes around a face. For each run of nodes above the iso value, one
 * segment leads from the slot before the run to the slot behind it. The ring is counter-clockwise,
 * seen from outside, so that triangles face the nodes below the iso value. */
MCOR_ADAPTIVE_FUNCTION void mcor_adaptive_link_ring(
  const int* ring, int count, MCOR_TYPE(uint) above, mcor_adaptive_links* links)
{
  for (int i = 0; i < count; ++i)
  {
    int last = (i + 1) % count;
    if ((above >> ring[i] & 1) || !(above >> ring[last] & 1))
    {
      continue;
    }
    const int from = mcor_adaptive_slot(ring[i], ring[last]);
    int next = (last + 1) % count;
    while (above >> ring[next] & 1)
    {
      last = next;
      next = (last + 1) % count;
    }
    links->next[from] = (MCOR_TYPE(uchar))mcor_adaptive_slot(ring[last], ring[next]);
  }
}

/* Returns node i of the eight around a face, counter-clockwise from its lowest corner. face: axis *
 * 2 + side. */
MCOR_ADAPTIVE_FUNCTION int mcor_adaptive_face_node(int face, int i)
{
  const int axis = face >> 1, side = face & 1;
  const int step = mcor_adaptive_step(axis), step_u = mcor_adaptive_step((axis + 1) % 3),
            step_v = mcor_adaptive_step((axis + 2) % 3);
  const int u = 0x06a4 >> 2 * (i & 7) & 3, v = 0x06a4 >> 2 * ((i + 6) & 7) & 3;
  return 2 * side * step + (side ? u : v) * step_u + (side ? v : u) * step_v;
}

MCOR_ADAPTIVE_FUNCTION int mcor_adaptive_face_middle(int face)
{
  const int step = mcor_adaptive_step(face >> 1);
  return face & 1 ? 13 + step : 13 - step;
}

MCOR_ADAPTIVE_FUNCTION void mcor_adaptive_link(
  MCOR_TYPE(uint) split, MCOR_TYPE(uint) above, mcor_adaptive_links* links)
{
  int ring[8];
  for (int i = 0; i < MCOR_ADAPTIVE_SLOTS; ++i)
  {
    links->next[i] = 0xff;
  }
  for (int face = 0; face < 6; ++face)
  {
    const int middle = mcor_adaptive_face_middle(face);
    int count = 0;
    for (int i = 0; i < 8; ++i)
    {
      ring[count] = mcor_adaptive_face_node(face, i);
      count += !(i & 1) || (split >> ring[count] & 1);
    }
    if (!(split >> middle & 1))
    {
      mcor_adaptive_link_ring(ring, count, above, links);
      continue;
    }
    for (int corner = 0; corner < 8; corner += 2)
    {
      ring[0] = mcor_adaptive_face_node(face, corner);
      ring[1] = mcor_adaptive_face_node(face, corner + 1);
      ring[2] = middle;
      ring[3] = mcor_adaptive_face_node(face, corner + 7);
      mcor_adaptive_link_ring(ring, 4, above, links);
    }
  }
}

/* Finds a vertex's place, in quarters of the cell's edge: the middle of its half or whole edge. */
MCOR_ADAPTIVE_FUNCTION void mcor_adaptive_place(
  MCOR_TYPE(uint) split, int slot, MCOR_TYPE(uchar) place[3])
{
  const int axis = slot >> 5, node = slot & 31, step = mcor_adaptive_step(axis);
  place[0] = (MCOR_TYPE(uchar))(2 * (node % 3));
  place[1] = (MCOR_TYPE(uchar))(2 * (node / 3 % 3));
  place[2] = (MCOR_TYPE(uchar))(2 * (node / 9));
  /* If the next position is no node, the edge is not split. */
  place[axis] =
    (MCOR_TYPE(uchar))(place[axis] + (place[axis] > 0 || (split >> (node + step) & 1) ? 1 : 2));
}

MCOR_ADAPTIVE_FUNCTION MCOR_TYPE(uint)
  mcor_adaptive_facets(MCOR_TYPE(uint) split, const MCOR_TYPE(uchar) place[3])
{
  MCOR_TYPE(uint) facets = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    if (place[axis] & 3)
    {
      continue;
    }
    const int face = 2 * axis + (place[axis] >> 2);
    const int u = place[(axis + 1) % 3], v = place[(axis + 2) % 3];
    MCOR_TYPE(uint) part = 15;
    if (split >> mcor_adaptive_face_middle(face) & 1)
    {
      part = (u <= 2 ? 5 : 0) | (u >= 2 ? 10 : 0);
      part &= (v <= 2 ? 3 : 0) | (v >= 2 ? 12 : 0);
    }
    facets |= part << 4 * face | (MCOR_TYPE(uint))1 << (24 + face);
  }
  return facets;
}

/* Returns the cost of a diagonal. Without finer cells around the cell, all allowed diagonals cost
 * the same: the first triangulation found is used, as in the case table. */
MCOR_ADAPTIVE_FUNCTION int mcor_adaptive_cost(
  MCOR_TYPE(uint) split, const mcor_adaptive_loop* loop, int a, int b)
{
  const MCOR_TYPE(uint) common = loop->facets[a] & loop->facets[b], faces = common >> 24;
  /* A diagonal is forbidden if both ends are in one part of a split face, in one face that is not
   * split, or on one edge, i.e. in two faces. */
  int cost = (common & 0xffffff) || (faces & (faces - 1)) ? MCOR_ADAPTIVE_FORBIDDEN : 0;
  if (split)
  {
    cost += faces ? MCOR_ADAPTIVE_FLAT : 0;
    for (int axis = 0; axis < 3; ++axis)
    {
      const int d = loop->place[a][axis] - loop->place[b][axis];
      cost += d * d;
    }
  }
  return cost;
}

/* Returns the index in `costs` of the loop's part from vertex a to vertex b > a. */
MCOR_ADAPTIVE_FUNCTION int mcor_adaptive_part(int a, int b)
{
  return b * (b - 1) / 2 + a;
}

/* A side from a to b closes the loop's part between these vertices. Returns the third vertex of the
 * triangle at this side, if the part is cut into triangles as cheaply as possible. *least: the cost
 * of this cut without the side from a to b. */
MCOR_ADAPTIVE_FUNCTION int mcor_adaptive_apex(
  const MCOR_TYPE(ushort) * costs, int a, int b, int* least)
{
  int best = a + 1;
  *least = 1 << 30;
  for (int apex = a + 1; apex < b; ++apex)
  {
    const int cost = costs[mcor_adaptive_part(a, apex)] + costs[mcor_adaptive_part(apex, b)];
    if (cost < *least)
    {
      *least = cost;
      best = apex;
    }
  }
  return best;
}

/* Writes a loop's triangles. Each triangle is followed by all triangles beyond its first side, then
 * by all beyond its second side. Returns the cost of the diagonals. */
MCOR_ADAPTIVE_FUNCTION int mcor_adaptive_cut_loop(
  MCOR_TYPE(uint) split, const mcor_adaptive_loop* loop, MCOR_TYPE(uchar) * triangles)
{
  MCOR_TYPE(ushort) costs[MCOR_ADAPTIVE_VERTICES * (MCOR_ADAPTIVE_VERTICES - 1) / 2];
  MCOR_TYPE(uchar) from[MCOR_ADAPTIVE_VERTICES], to[MCOR_ADAPTIVE_VERTICES];
  int waiting = 1, count = 0, total;
  for (int b = 1; b < loop->length; ++b)
  {
    costs[mcor_adaptive_part(b - 1, b)] = 0;
    for (int a = b - 2; a >= 0; --a)
    {
      int cost;
      mcor_adaptive_apex(costs, a, b, &cost);
      cost += mcor_adaptive_cost(split, loop, a, b);
      costs[mcor_adaptive_part(a, b)] = (MCOR_TYPE(ushort))(cost < 0xffff ? cost : 0xffff);
    }
  }
  mcor_adaptive_apex(costs, 0, loop->length - 1, &total);
  from[0] = 0;
  to[0] = (MCOR_TYPE(uchar))(loop->length - 1);
  while (waiting)
  {
    const int a = from[--waiting], b = to[waiting];
    if (b - a < 2)
    {
      continue;
    }
    int least;
    const int apex = mcor_adaptive_apex(costs, a, b, &least);
    triangles[3 * count] = loop->slot[a];
    triangles[3 * count + 1] = loop->slot[apex];
    triangles[3 * count + 2] = loop->slot[b];
    ++count;
    from[waiting] = (MCOR_TYPE(uchar))apex;
    to[waiting++] = (MCOR_TYPE(uchar))b;
    from[waiting] = (MCOR_TYPE(uchar))a;
    to[waiting++] = (MCOR_TYPE(uchar))apex;
  }
  return total;
}

/* Follows the links from a slot around its loop, writes the loop, and removes the links. The loop
 * is empty if the slot has no link. */
MCOR_ADAPTIVE_FUNCTION void mcor_adaptive_trace(
  MCOR_TYPE(uint) split, int slot, mcor_adaptive_links* links, mcor_adaptive_loop* loop)
{
  loop->length = 0;
  for (int at = slot, next; links->next[at] != 0xff; at = next)
  {
    const int i = loop->length++;
    next = links->next[at];
    links->next[at] = 0xff;
    loop->slot[i] = (MCOR_TYPE(uchar))at;
    mcor_adaptive_place(split, at, loop->place[i]);
    loop->facets[i] = mcor_adaptive_facets(split, loop->place[i]);
  }
}

/* Writes a cell's triangles, three slots each, unless `triangles` is NULL, and returns their
 * number. Adds to *flat_loops the number of loops that lie in one face. Without split edges, the
 * triangles are those of the case table. */
MCOR_ADAPTIVE_FUNCTION int mcor_adaptive_triangulate(
  MCOR_TYPE(uint) split, MCOR_TYPE(uint) above, MCOR_TYPE(uchar) * triangles, int* flat_loops)
{
  mcor_adaptive_links links;
  mcor_adaptive_loop loop;
  int count = 0;
  mcor_adaptive_link(split, above, &links);
  for (int slot = 0; slot < MCOR_ADAPTIVE_SLOTS; ++slot)
  {
    MCOR_TYPE(uint) common = ~(MCOR_TYPE(uint))0; /* facets */
    mcor_adaptive_trace(split, slot, &links, &loop);
    for (int i = 0; i < loop.length; ++i)
    {
      common &= loop.facets[i];
    }
    if (loop.length > 2)
    {
      *flat_loops += common >> 24 != 0;
      if (triangles)
      {
        mcor_adaptive_cut_loop(split, &loop, triangles + 3 * count);
      }
      count += loop.length - 2;
    }
  }
  return count;
}

#endif
