/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COMPARE_PI 3.14159265358979323846

/* ---- vertices -------------------------------------------------------------------------------------- */

/* Distance to the surface f = iso, in cubes: by the gradient, or, where that is small, the smallest
 * step along the edge that brackets a crossing. */
static double compare_distance(
  const compare_state* state, const double point[3], int axis, const oracle_sample* sample)
{
  const oracle_reference* reference = state->reference;
  const double* g = sample->gradient;
  const double slope = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  double distance =
    fabs(sample->value - reference->limits.iso) / (slope * reference->lattice.cube);
  for (double step = 1e-6; distance > 1e-5 && step < distance; step *= 2.0)
  {
    double p[3] = { point[0], point[1], point[2] };
    oracle_sample low;
    oracle_sample high;
    p[axis] = point[axis] - step * reference->lattice.cube;
    oracle_evaluate(&reference->field, NULL, p, &low);
    p[axis] = point[axis] + step * reference->lattice.cube;
    oracle_evaluate(&reference->field, NULL, p, &high);
    if ((low.value >= reference->limits.iso) != (high.value >= reference->limits.iso))
    {
      distance = step;
    }
  }
  return isnan(distance) ? 0.0 : distance; /* 0 / 0: exactly on a flat spot */
}

/* Shepard's field jumps where the fluid weight falls to 0: the last particle in reach leaves with a
 * value of its own. Weight of solids can keep the cells there valid. No point of the edge then has
 * the value iso; the vertex must be where the side changes. */
static int compare_jump(
  const compare_state* state, const double point[3], int axis, const oracle_sample* sample)
{
  const oracle_reference* reference = state->reference;
  const double step = 1e-5 * reference->lattice.cube;
  double p[3] = { point[0], point[1], point[2] };
  oracle_sample low;
  oracle_sample high;
  if (reference->field.kind != ORACLE_SHEPARD || fabs(sample->weight) > 1e-6)
  {
    return 0;
  }
  p[axis] = point[axis] - step;
  oracle_evaluate(&reference->field, NULL, p, &low);
  p[axis] = point[axis] + step;
  oracle_evaluate(&reference->field, NULL, p, &high);
  return (low.value >= reference->limits.iso) != (high.value >= reference->limits.iso);
}

static void compare_normal(compare_state* state, int64_t v, const oracle_sample* sample)
{
  oracle_comparison* result = state->result;
  const double* g = sample->gradient;
  const double slope = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  const double least = state->reference->unit > 1e-10 ? 1e-3 : 1e-10;
  if (!(slope > least * sample->gradient_scale))
  {
    ++result->flat_vertices;
    return;
  }
  const float* n = &state->surface->normals[3 * v];
  double cross[3];
  double dot = 0.0;
  for (int a = 0; a < 3; ++a)
  {
    const int b = (a + 1) % 3;
    const int c = (a + 2) % 3;
    cross[a] = (double)n[b] * g[c] - (double)n[c] * g[b];
    dot -= (double)n[a] * g[a];
  }
  const double sine = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
  const double degrees = atan2(sine, dot) * 180.0 / COMPARE_PI;
  if (!(degrees <= result->normal_degrees))
  {
    result->normal_degrees = degrees;
    if (!(degrees < 1.0))
    {
      compare_note(state, "normal of vertex %lld is off by %.3g degrees", (long long)v, degrees);
    }
  }
}

static void compare_optional_arrays(compare_state* state, int64_t v, const oracle_sample* sample)
{
  oracle_comparison* result = state->result;
  if (state->surface->weight_sum)
  {
    result->weight_error = fmax(result->weight_error,
      fabs((double)state->surface->weight_sum[v] - sample->trim_weight));
  }
  if (state->surface->gradients && sample->gradient_scale > 0.0)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      result->gradient_error = fmax(result->gradient_error,
        fabs(state->surface->gradients[3 * v + axis] - sample->gradient[axis]) /
          sample->gradient_scale);
    }
  }
}

static void compare_trim_vertex(
  compare_state* state, int64_t v, const oracle_sample* sample, double residual)
{
  oracle_comparison* result = state->result;
  ++result->trim_vertices;
  if (state->surface->boundary_flag[v] == 2)
  {
    ++result->trim_linear;
    return;
  }
  result->trim_residual = fmax(result->trim_residual, residual);
  result->trim_weight_error = fmax(result->trim_weight_error,
    fabs(sample->trim_weight - state->options->vertex_threshold));
}

/* A vertex on a lattice edge; 1 if f is iso there, 0 if f only jumps over it. */
static int compare_edge_vertex(
  compare_state* state, int64_t v, const oracle_sample* sample, double residual)
{
  oracle_comparison* result = state->result;
  const double* point = &state->surface->points[3 * v];
  const int axis = (int)(state->vertex_edge[v] % 3);
  const double threshold = state->options->vertex_threshold;
  result->below_threshold += state->trimmed && sample->trim_weight < threshold - 1e-5;
  result->near_threshold += fabs(sample->trim_weight - threshold) <= 1e-5;
  if (residual > 1e-6 && compare_jump(state, point, axis, sample))
  {
    ++result->jumps;
    return 0;
  }
  if (!(residual <= result->residual))
  {
    result->residual = residual;
  }
  result->distance = fmax(result->distance, compare_distance(state, point, axis, sample));
  return 1;
}

void compare_vertices(compare_state* state)
{
  const oracle_reference* reference = state->reference;
  for (int64_t v = 0; v < state->surface->point_count; ++v)
  {
    oracle_sample sample;
    int on_surface = 1;
    oracle_evaluate(&reference->field, NULL, &state->surface->points[3 * v], &sample);
    memcpy(&state->gradient[3 * v], sample.gradient, sizeof(sample.gradient));
    compare_optional_arrays(state, v, &sample);
    const double residual = fabs(sample.value - reference->limits.iso) / reference->range;
    if (state->vertex_edge[v] == COMPARE_TRIM_VERTEX)
    {
      compare_trim_vertex(state, v, &sample, residual);
      /* A linear cut is off the surface: its normal need not be that of the surface. */
      on_surface = state->surface->boundary_flag[v] != 2;
    }
    else if (state->vertex_edge[v] >= 0)
    {
      on_surface = compare_edge_vertex(state, v, &sample, residual);
    }
    if (state->surface->normals && on_surface)
    {
      compare_normal(state, v, &sample);
    }
  }
}

/* ---- triangles -------------------------------------------------------------------------------------- */

int compare_orientation(compare_state* state)
{
  const mcor_surface* surface = state->surface;
  const int64_t components = state->mesh->components;
  double* balance = calloc((size_t)components + 1, sizeof(double));
  if (!balance)
  {
    return 0;
  }
  for (int64_t t = 0; t < surface->triangle_count; ++t)
  {
    const int32_t* c = &surface->triangles[3 * t];
    double u[3];
    double v[3];
    double g[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      u[axis] = surface->points[3 * c[1] + axis] - surface->points[3 * c[0] + axis];
      v[axis] = surface->points[3 * c[2] + axis] - surface->points[3 * c[0] + axis];
      g[axis] = state->gradient[3 * c[0] + axis] + state->gradient[3 * c[1] + axis] +
        state->gradient[3 * c[2] + axis];
    }
    const double along = (u[1] * v[2] - u[2] * v[1]) * g[0] + (u[2] * v[0] - u[0] * v[2]) * g[1] +
      (u[0] * v[1] - u[1] * v[0]) * g[2];
    state->result->inverted_triangles += along > 0.0;
    balance[state->mesh->component[t]] -= along;
  }
  for (int64_t c = 0; c < components; ++c)
  {
    state->result->inverted_components += balance[c] < 0.0;
  }
  free(balance);
  return 1;
}

/* ---- faces ------------------------------------------------------------------------------------------ */

/* The 4 edges of the face of `cell` towards -axis, in cyclic order. */
static void compare_face_edges(
  const oracle_lattice* lattice, int64_t node, int axis, int64_t edges[4])
{
  const int64_t step[3] = { 1, lattice->size[0], lattice->size[0] * lattice->size[1] };
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  edges[0] = 3 * node + u;
  edges[1] = 3 * (node + step[u]) + v;
  edges[2] = 3 * (node + step[v]) + u;
  edges[3] = 3 * node + v;
}

/* The vertices on the crossed edges of a face; -1 if one of them has none. */
static int compare_face_vertices(
  const compare_state* state, const int64_t edges[4], int32_t vertices[4])
{
  int count = 0;
  for (int n = 0; n < 4; ++n)
  {
    const int64_t e = oracle_find_edge(&state->reference->surface, edges[n]);
    if (e >= 0)
    {
      if (state->edge_vertex[e] < 0)
      {
        return -1;
      }
      vertices[count++] = (int32_t)state->edge_vertex[e];
    }
  }
  return count;
}

/* Two crossings: connected, once for each valid cell at the face. Four: in either of two ways. */
static int compare_face_connected(
  const mesh_report* mesh, const int32_t vertices[4], int count, int64_t cells)
{
  if (count == 2)
  {
    return mesh_count_sides(mesh, vertices[0], vertices[1]) == cells;
  }
  for (int way = 0; way < 2; ++way)
  {
    if (mesh_count_sides(mesh, vertices[way], vertices[way + 1]) == cells &&
      mesh_count_sides(mesh, vertices[way + 2], vertices[(way + 3) % 4]) == cells)
    {
      return 1;
    }
  }
  return 0;
}

static void compare_face(compare_state* state, const int64_t ijk[3], int axis)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  const int64_t other[3] = { ijk[0] - (axis == 0), ijk[1] - (axis == 1), ijk[2] - (axis == 2) };
  const int valid = oracle_cell_valid(lattice, ijk[0], ijk[1], ijk[2]) +
    oracle_cell_valid(lattice, other[0], other[1], other[2]);
  const int possible = oracle_cell_possible(lattice, ijk[0], ijk[1], ijk[2]) +
    oracle_cell_possible(lattice, other[0], other[1], other[2]);
  const int certain = oracle_cell_certain(lattice, ijk[0], ijk[1], ijk[2]) +
    oracle_cell_certain(lattice, other[0], other[1], other[2]);
  int64_t edges[4];
  int32_t vertices[4];
  compare_face_edges(lattice, oracle_node_index(lattice, ijk[0], ijk[1], ijk[2]), axis, edges);
  for (int n = 0; n < 4; ++n)
  {
    if (compare_end_flag(lattice, edges[n], ORACLE_NODE_CLOSE))
    {
      return;
    }
  }
  const int count = compare_face_vertices(state, edges, vertices);
  if (valid > 0 && possible == certain && count >= 2 &&
    !compare_face_connected(state->mesh, vertices, count, valid))
  {
    ++state->result->segments_missing;
    compare_note_edge(state, "not connected on the face of", edges[0]);
  }
}

void compare_faces(compare_state* state)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  for (int64_t c = 0; c < state->reference->surface.cell_count; ++c)
  {
    const int64_t node = state->reference->surface.cell[c];
    const int64_t ijk[3] = { node % lattice->size[0], node / lattice->size[0] % lattice->size[1],
      node / lattice->size[0] / lattice->size[1] };
    for (int axis = 0; axis < 3; ++axis)
    {
      int64_t next[3] = { ijk[0], ijk[1], ijk[2] };
      compare_face(state, ijk, axis);
      next[axis] += 1;
      /* The far face is the near face of the next cell; visited here if that cell will not do it. */
      if (next[axis] + 1 < lattice->size[axis] &&
        !oracle_cell_valid(lattice, next[0], next[1], next[2]))
      {
        compare_face(state, next, axis);
      }
    }
  }
}

/* 1 if the two edges (the same one, too) have a cell in common that is not certainly valid. */
static int compare_at_invalid_cell(const oracle_lattice* lattice, int64_t edge, int64_t other)
{
  int64_t a[4][3];
  int64_t b[4][3];
  oracle_edge_cells(lattice, edge, a);
  oracle_edge_cells(lattice, other, b);
  for (int m = 0; m < 4; ++m)
  {
    for (int n = 0; n < 4; ++n)
    {
      if (memcmp(a[m], b[n], sizeof(a[m])) == 0 &&
        !oracle_cell_certain(lattice, a[m][0], a[m][1], a[m][2]))
      {
        return 1;
      }
    }
  }
  return 0;
}

void compare_boundary(compare_state* state)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  const mesh_report* mesh = state->mesh;
  for (int64_t s = 0; s < mesh->side_count; ++s)
  {
    const mesh_edge* side = &mesh->side[s];
    const mesh_edge* before = s > 0 ? side - 1 : NULL;
    const mesh_edge* after = s + 1 < mesh->side_count ? side + 1 : NULL;
    if ((before && before->a == side->a && before->b == side->b) ||
      (after && after->a == side->a && after->b == side->b))
    {
      continue;
    }
    int64_t a = state->vertex_edge[side->a];
    int64_t b = state->vertex_edge[side->b];
    const int cut_a = a == COMPARE_TRIM_VERTEX;
    const int cut_b = b == COMPARE_TRIM_VERTEX;
    a = cut_a ? b : a;
    b = cut_b ? a : b;
    if (!(cut_a && cut_b) && (a < 0 || b < 0 || !compare_at_invalid_cell(lattice, a, b)))
    {
      ++state->result->holes;
      compare_note(state, "open edge between vertices %d and %d", (int)side->a, (int)side->b);
    }
  }
}

void compare_count_unsettled(compare_state* state)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  const int64_t nodes = oracle_node_count(lattice);
  for (int64_t n = 0; n < nodes; ++n)
  {
    state->result->unsettled += (lattice->flags[n] & ORACLE_NODE_CLOSE) &&
      (lattice->flags[n] & (ORACLE_NODE_VALID | ORACLE_NODE_MARGIN));
  }
  for (int64_t c = 0; c < state->reference->surface.cell_count; ++c)
  {
    const int64_t node = state->reference->surface.cell[c];
    state->result->unsettled += !oracle_cell_certain(lattice, node % lattice->size[0],
      node / lattice->size[0] % lattice->size[1], node / lattice->size[0] / lattice->size[1]);
  }
}

void compare_count_pinched(compare_state* state)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  for (int64_t e = 0; e < state->reference->surface.edge_count; ++e)
  {
    int64_t cells[4][3];
    int valid[4];
    oracle_edge_cells(lattice, state->reference->surface.edge[e], cells);
    for (int c = 0; c < 4; ++c)
    {
      valid[c] = oracle_cell_valid(lattice, cells[c][0], cells[c][1], cells[c][2]);
    }
    /* Cells 0 and 3, 1 and 2 are diagonal to each other. */
    state->result->pinched_edges +=
      valid[0] == valid[3] && valid[1] == valid[2] && valid[0] != valid[1];
  }
}
