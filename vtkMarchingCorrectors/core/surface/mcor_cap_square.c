/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Squares of caps: cut along the lines between the surface's own vertices, and by what trims the surface. See
 * mcor_cap_make.c. */

#include "mcor_cap_job.h"

#include <stdlib.h>
#include <string.h>

/* Corner of a polygon: a vertex of the mesh; where it is, in cubes from the lattice's origin; how far
 * inside of what trimming leaves. */
typedef struct mcor_cap_corner
{
  int32_t vertex;
  double at[3], margin;
} mcor_cap_corner;

/* ---- vertices ---- */

static mcor_status mcor_add_cap_vertex(mcor_cap_job* job, const double at[3], bool is_cut)
{
  mcor_context* context = job->context;
  MCOR_RETURN_IF(job->old_count + job->vertex_count >= MCOR_COUNT_LIMIT, context,
    MCOR_OUT_OF_CAPACITY, "The caps have too many vertices. Use a larger cube size.");
  MCOR_TRY(mcor_make_room(
    context, (void**)&job->vertices, job->vertex_count, &job->vertex_room, sizeof *job->vertices));
  mcor_cap_vertex* vertex = &job->vertices[job->vertex_count++];
  *vertex = (mcor_cap_vertex){ .is_cut = is_cut, .key = { job->square, job->lookups } };
  mcor_put_cap_vertex(vertex, at);
  return MCOR_OK;
}

/* Of a map's key, a vertex that is made where there is none. */
static mcor_status mcor_find_cap_vertex(
  mcor_cap_job* job, mcor_table* map, uint64_t key, const double at[3], bool is_cut, int32_t* v)
{
  const int32_t next = (int32_t)(job->old_count + job->vertex_count);
  ++job->lookups;
  *v = mcor_table_number(map, key, next);
  MCOR_TRY(mcor_allocated(job->context, *v >= 0));
  return *v == next ? mcor_add_cap_vertex(job, at, is_cut && !job->border) : MCOR_OK;
}

/* Node (u, v) of the side. */
static mcor_status mcor_cap_node_corner(
  mcor_cap_job* job, const mcor_cap_face* face, int u, int v, mcor_cap_corner* corner)
{
  cl_int node[3];
  mcor_cap_node(job->context, face, u, v, node);
  for (int a = 0; a < 3; ++a)
  {
    corner->at[a] = node[a];
  }
  corner->margin = face->margin[mcor_cap_index(face, u, v)];
  return mcor_find_cap_vertex(
    job, &job->nodes, mcor_cap_key(node), corner->at, false, &corner->vertex);
}

/* The surface's vertex on the edge from node (u, v) of the side along across[along], for square
 * (u0, v0): see mcor_march_emit for pinched ones. */
static mcor_status mcor_cap_edge_corner(mcor_cap_job* job, const mcor_cap_face* face, int u, int v,
  int along, int u0, int v0, mcor_cap_corner* corner)
{
  mcor_context* context = job->context;
  const int axis = face->across[along], other = axis == 0 ? 1 : 0;
  cl_int node[3], cell[3];
  mcor_cap_node(context, face, u, v, node);
  cell[face->axis] = face->cell;
  cell[face->across[0]] = face->first[0] + u0;
  cell[face->across[1]] = face->first[1] + v0;
  int32_t vertex = mcor_find_number(&job->edges[axis], mcor_cap_key(node));
  MCOR_RETURN_IF(vertex < 0, context, MCOR_DEVICE_ERROR,
    "A cap does not fit the surface at node %d %d %d. Please report it.", node[0], node[1],
    node[2]);
  const cl_int* nodes = job->node;
  const bool pinched = vertex + 1 < context->mesh.march_count &&
    memcmp(nodes + 4 * (size_t)vertex, nodes + 4 * ((size_t)vertex + 1), 4 * sizeof *nodes) == 0;
  vertex += pinched && node[other] > cell[other];
  corner->vertex = vertex;
  corner->margin =
    job->quantity ? mcor_get_real(context, job->quantity, vertex) - job->threshold : INFINITY;
  for (int a = 0; a < 3; ++a)
  {
    corner->at[a] = node[a] + mcor_get_real(context, job->offset, 4 * (int64_t)vertex + a);
  }
  return MCOR_OK;
}

static int mcor_compare_cap_keys(const void* x, const void* y)
{
  const cl_ulong *a = x, *b = y;
  return (*a > *b) - (*a < *b);
}

/* Where trimming cuts the line between two corners. */
static mcor_status mcor_cap_cut(
  mcor_cap_job* job, const mcor_cap_corner* p, const mcor_cap_corner* q, mcor_cap_corner* cut)
{
  const mcor_mesh* mesh = &job->context->mesh;
  const mcor_cap_corner *low = p->vertex < q->vertex ? p : q, *high = low == p ? q : p;
  const cl_ulong key = (cl_ulong)low->vertex << 32 | (cl_ulong)high->vertex;
  const size_t cuts = (size_t)(job->old_count - mesh->march_count);
  const cl_ulong* own = cuts > 0 && high->vertex < mesh->march_count
    ? bsearch(&key, job->distinct, cuts, sizeof key, mcor_compare_cap_keys)
    : NULL;
  *cut = (mcor_cap_corner){ .margin = 0 };
  if (own)
  {
    cut->vertex = mesh->march_count + (int32_t)(own - (const cl_ulong*)job->distinct);
    return MCOR_OK;
  }
  const double s = fmin(
    fmax(low->margin / (low->margin - high->margin), MCOR_CAP_CUT_MARGIN), 1 - MCOR_CAP_CUT_MARGIN);
  for (int a = 0; a < 3; ++a)
  {
    cut->at[a] = low->at[a] + s * (high->at[a] - low->at[a]);
  }
  const int64_t before = job->vertex_count;
  MCOR_TRY(mcor_find_cap_vertex(job, &job->cuts, key, cut->at, true, &cut->vertex));
  if ((job->border || mcor_is_plane(job->context)) && job->vertex_count > before)
  {
    mcor_cap_vertex* vertex = &job->vertices[before];
    mcor_cap_line* line = &vertex->line;
    *line = (mcor_cap_line){ .at = s, .side = { 0, 1 }, .left = INFINITY, .last = -1 };
    vertex->is_placed = true;
    line->margin[0] = low->margin;
    line->margin[1] = high->margin;
    memcpy(line->from, low->at, sizeof low->at);
    memcpy(line->to, high->at, sizeof high->at);
  }
  return MCOR_OK;
}

/* ---- polygons ---- */

mcor_status mcor_add_cap_triangle(mcor_cap_job* job, const int32_t corners[3])
{
  const int64_t next = job->triangle_count + 1;
  MCOR_TRY(mcor_make_room(
    job->context, (void**)&job->triangles, next, &job->triangle_room, 3 * sizeof *job->triangles));
  MCOR_TRY(
    mcor_make_room(job->context, (void**)&job->cells, next, &job->cell_room, sizeof *job->cells));
  job->cells[job->triangle_count] = job->square;
  job->owned_count += !(job->square & MCOR_RING_CELL);
  memcpy(job->triangles + 3 * job->triangle_count++, corners, 3 * sizeof *corners);
  return MCOR_OK;
}

mcor_status mcor_add_cap_border(mcor_cap_job* job, int32_t from, int32_t to)
{
  mcor_cap_border* border = job->border;
  MCOR_RETURN_IF(border->count == MCOR_CAP_BORDER, job->context, MCOR_DEVICE_ERROR,
    "A cell of a cap has more than %d edges. Please report it.", MCOR_CAP_BORDER);
  border->ends[border->count][0] = from;
  border->ends[border->count++][1] = to;
  return MCOR_OK;
}

/* In two dimensions, where corners above each other are one, what runs along the side: with what is inside on its
 * left, as a triangle whose last two corners are one. */
static mcor_status mcor_add_cap_line(
  mcor_cap_job* job, const mcor_cap_face* face, const mcor_cap_corner* corners, int count)
{
  const mcor_cap_corner* other = corners + 1;
  while (other < corners + count - 1 && other->vertex == corners->vertex)
  {
    ++other;
  }
  const int along = 1 - face->axis;
  const bool forward = (other->at[along] > corners->at[along]) == (face->upper == along);
  const int32_t from = forward ? corners->vertex : other->vertex,
                to = forward ? other->vertex : corners->vertex;
  const int32_t line[3] = { from, to, to };
  return mcor_add_cap_triangle(job, line);
}

/* A fan. Corners go round as seen from above the axis. Or its last edge, where that is wanted. */
static mcor_status mcor_add_cap_fan(
  mcor_cap_job* job, const mcor_cap_face* face, const mcor_cap_corner* corners, int count, bool cut)
{
  if (job->border)
  {
    const int32_t first = corners[0].vertex, last = corners[count - 1].vertex;
    return cut ? mcor_add_cap_border(job, face->upper ? first : last, face->upper ? last : first)
               : MCOR_OK;
  }
  if (mcor_is_plane(job->context))
  {
    return mcor_add_cap_line(job, face, corners, count);
  }
  for (int i = 1; i + 1 < count; ++i)
  {
    const int32_t triangle[3] = { corners[0].vertex, corners[face->upper ? i : i + 1].vertex,
      corners[face->upper ? i + 1 : i].vertex };
    MCOR_TRY(mcor_add_cap_triangle(job, triangle));
  }
  return MCOR_OK;
}

/* What trimming leaves of a polygon of up to 6 corners: each run of corners inside, with the cuts
 * before and behind it. */
static mcor_status mcor_add_cap_polygon(
  mcor_cap_job* job, const mcor_cap_face* face, const mcor_cap_corner* corners, int count)
{
  int start = 0;
  while (start < count && corners[start].margin > 0)
  {
    ++start;
  }
  if (start == count)
  {
    return mcor_add_cap_fan(job, face, corners, count, false);
  }
  mcor_cap_corner run[8];
  int length = 0;
  for (int i = 1; i <= count; ++i)
  {
    const mcor_cap_corner *before = &corners[(start + i - 1) % count],
                          *corner = &corners[(start + i) % count];
    const bool inside = corner->margin > 0;
    if (inside != (before->margin > 0))
    {
      MCOR_TRY(mcor_cap_cut(job, before, corner, &run[length++]));
    }
    if (inside)
    {
      run[length++] = *corner;
    }
    else if (length > 0)
    {
      MCOR_TRY(mcor_add_cap_fan(job, face, run, length, true));
      length = 0;
    }
  }
  return MCOR_OK;
}

/* Whether the cell beside square (u, v), which the surface does not meet, is valid. */
static bool mcor_is_capped(const mcor_cap_face* face, int u, int v)
{
  bool valid = true;
  for (int c = 0; c < 4; ++c)
  {
    const int64_t at = mcor_cap_index(face, u + (c & 1), v + (c >> 1));
    valid = valid && (face->state[at] & MCOR_CAP_VALID) && (face->within[at] & MCOR_CAP_VALID);
  }
  return valid;
}

/* Square (u, v): corners in the order (0, 0), (1, 0), (1, 1), (0, 1); side k follows corner k. */
mcor_status mcor_cap_square(mcor_cap_job* job, const mcor_cap_face* face, int u, int v)
{
  static const int corner_u[4] = { 0, 1, 1, 0 }, corner_v[4] = { 0, 0, 1, 1 };
  static const int side_u[4] = { 0, 1, 0, 0 }, side_v[4] = { 0, 0, 1, 0 };
  const int state = face->state[mcor_cap_index(face, u, v)];
  int above[4], total = 0;
  for (int k = 0; k < 4; ++k)
  {
    above[k] =
      (face->state[mcor_cap_index(face, u + corner_u[k], v + corner_v[k])] & MCOR_CAP_ABOVE) != 0;
    total += above[k];
  }
  if (total == 0 || (total == 4 ? !mcor_is_capped(face, u, v) : !(state & MCOR_CAP_USED)))
  {
    return MCOR_OK;
  }
  const bool apart =
    total == 2 && above[0] == above[2] && !(state & MCOR_CAP_JOINED); /* two corners above */
  mcor_cap_corner corners[6];
  int count = 0;
  for (int k = 0; k < 4; ++k)
  {
    const int before = (k + 3) % 4, next = (k + 1) % 4;
    if (apart && above[k])
    {
      MCOR_TRY(mcor_cap_edge_corner(
        job, face, u + side_u[before], v + side_v[before], before & 1, u, v, &corners[count++]));
    }
    if (above[k])
    {
      MCOR_TRY(
        mcor_cap_node_corner(job, face, u + corner_u[k], v + corner_v[k], &corners[count++]));
    }
    if (apart ? above[k] : above[k] != above[next])
    {
      MCOR_TRY(mcor_cap_edge_corner(
        job, face, u + side_u[k], v + side_v[k], k & 1, u, v, &corners[count++]));
    }
    if (apart && above[k])
    {
      MCOR_TRY(mcor_add_cap_polygon(job, face, corners, count));
      count = 0;
    }
  }
  return apart ? MCOR_OK : mcor_add_cap_polygon(job, face, corners, count);
}
