/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int64_t oracle_node_count(const oracle_lattice* lattice)
{
  return lattice->size[0] * lattice->size[1] * lattice->size[2];
}

int64_t oracle_node_index(const oracle_lattice* lattice, int64_t i, int64_t j, int64_t k)
{
  return (k * lattice->size[1] + j) * lattice->size[0] + i;
}

static void oracle_node_ijk(const oracle_lattice* lattice, int64_t node, int64_t ijk[3])
{
  ijk[0] = node % lattice->size[0];
  ijk[1] = node / lattice->size[0] % lattice->size[1];
  ijk[2] = node / lattice->size[0] / lattice->size[1];
}

void oracle_node_position(const oracle_lattice* lattice, int64_t node, double position[3])
{
  int64_t ijk[3];
  oracle_node_ijk(lattice, node, ijk);
  for (int axis = 0; axis < 3; ++axis)
  {
    position[axis] = (double)(lattice->origin[axis] + ijk[axis]) * lattice->edge[axis];
  }
}

void oracle_free_lattice(oracle_lattice* lattice)
{
  if (lattice->trim_weight != lattice->weight)
  {
    free(lattice->trim_weight);
  }
  free(lattice->value);
  free(lattice->weight);
  free(lattice->flags);
  memset(lattice, 0, sizeof(*lattice));
}

/* Bounds of all supports, one node further out on every side. */
static int oracle_set_extent(oracle_lattice* lattice, const oracle_field* field, int64_t node_limit)
{
  double nodes = 1.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    double low = INFINITY;
    double high = -INFINITY;
    for (int64_t j = 0; j < field->particles->count; ++j)
    {
      const double reach =
        oracle_support(field->kernel) * field->h_scale * field->particles->smoothing_length[j];
      low = fmin(low, field->particles->position[3 * j + axis] - reach);
      high = fmax(high, field->particles->position[3 * j + axis] + reach);
    }
    if (!(high >= low))
    {
      return 0;
    }
    lattice->origin[axis] = (int64_t)floor(low / lattice->edge[axis]) - 1;
    lattice->size[axis] = (int64_t)ceil(high / lattice->edge[axis]) + 2 - lattice->origin[axis];
    lattice->end[axis] = lattice->size[axis] - 1;
    nodes *= (double)lattice->size[axis];
  }
  return nodes <= (double)node_limit;
}

static void oracle_scatter(oracle_lattice* lattice, const oracle_field* field, int64_t j)
{
  const oracle_particles* p = field->particles;
  const double h = field->h_scale * p->smoothing_length[j];
  const double reach = oracle_support(field->kernel) * h;
  const double volume = p->volume[j];
  int64_t low[3];
  int64_t high[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    const double x = p->position[3 * j + axis];
    low[axis] = (int64_t)floor((x - reach) / lattice->edge[axis]) - lattice->origin[axis];
    high[axis] = (int64_t)ceil((x + reach) / lattice->edge[axis]) - lattice->origin[axis];
  }
  for (int64_t k = low[2]; k <= high[2]; ++k)
  {
    for (int64_t i_j = low[1]; i_j <= high[1]; ++i_j)
    {
      for (int64_t i = low[0]; i <= high[0]; ++i)
      {
        const int64_t node = oracle_node_index(lattice, i, i_j, k);
        const double offset[3] = { (double)(lattice->origin[0] + i) * lattice->edge[0] -
            p->position[3 * j],
          (double)(lattice->origin[1] + i_j) * lattice->edge[1] - p->position[3 * j + 1],
          (double)(lattice->origin[2] + k) * lattice->edge[2] - p->position[3 * j + 2] };
        const double w = volume * oracle_kernel_value(field->kernel, h, offset, NULL);
        if (p->solid[j])
        {
          lattice->trim_weight[node] += w;
        }
        else
        {
          lattice->weight[node] += w;
          lattice->value[node] += p->scalar[j] * w;
        }
      }
    }
  }
}

static int oracle_counts_solids(const oracle_particles* particles)
{
  for (int64_t j = 0; !particles->ignore_solids && j < particles->count; ++j)
  {
    if (particles->solid[j])
    {
      return 1;
    }
  }
  return 0;
}

/* Turns the sums at the nodes into the field and the trimming weight. */
static void oracle_finish_nodes(oracle_lattice* lattice, oracle_kind kind)
{
  const int64_t nodes = oracle_node_count(lattice);
  for (int64_t n = 0; n < nodes; ++n)
  {
    if (lattice->trim_weight != lattice->weight)
    {
      lattice->trim_weight[n] += lattice->weight[n];
    }
    if (kind == ORACLE_WEIGHT)
    {
      lattice->value[n] = lattice->weight[n];
    }
    else if (kind == ORACLE_SHEPARD)
    {
      lattice->value[n] = lattice->weight[n] > 0.0 ? lattice->value[n] / lattice->weight[n] : 0.0;
    }
  }
}

int oracle_create_lattice(
  oracle_lattice* lattice, const oracle_field* field, const double edge[3], int64_t node_limit)
{
  memset(lattice, 0, sizeof(*lattice));
  memcpy(lattice->edge, edge, sizeof(lattice->edge));
  lattice->cube = fmin(edge[0], fmin(edge[1], edge[2]));
  if (!oracle_set_extent(lattice, field, node_limit))
  {
    return 0;
  }
  const int solids = oracle_counts_solids(field->particles);
  const size_t nodes = (size_t)oracle_node_count(lattice);
  lattice->value = calloc(nodes, sizeof(double));
  lattice->weight = calloc(nodes, sizeof(double));
  lattice->trim_weight = solids ? calloc(nodes, sizeof(double)) : lattice->weight;
  lattice->flags = calloc(nodes, 1);
  if (!lattice->value || !lattice->weight || !lattice->trim_weight || !lattice->flags)
  {
    oracle_free_lattice(lattice);
    return 0;
  }
  for (int64_t j = 0; j < field->particles->count; ++j)
  {
    if (solids || !field->particles->solid[j])
    {
      oracle_scatter(lattice, field, j);
    }
  }
  oracle_finish_nodes(lattice, field->kind);
  return 1;
}

void oracle_classify(oracle_lattice* lattice, oracle_kind kind, const oracle_limits* limits)
{
  const int64_t nodes = oracle_node_count(lattice);
  for (int64_t n = 0; n < nodes; ++n)
  {
    const double difference = lattice->value[n] - limits->iso;
    int flags = difference >= 0.0 ? ORACLE_NODE_ABOVE : 0;
    if (fabs(difference) <= limits->close)
    {
      flags |= ORACLE_NODE_CLOSE;
    }
    if (kind == ORACLE_WEIGHT)
    {
      flags |= ORACLE_NODE_VALID;
    }
    else
    {
      const double weight = lattice->trim_weight[n];
      const double fluid = lattice->weight[n];
      if (weight >= limits->node_threshold && (kind == ORACLE_SUM || fluid >= limits->least_weight))
      {
        flags |= ORACLE_NODE_VALID;
      }
      if (fabs(weight - limits->node_threshold) <= limits->margin ||
        (kind == ORACLE_SHEPARD && fabs(fluid - limits->least_weight) <= limits->margin))
      {
        flags |= ORACLE_NODE_MARGIN;
      }
    }
    lattice->flags[n] = (uint8_t)flags;
  }
}

/* The flags of the 8 nodes combined: all of them and any of them; 0 if outside the lattice. */
static int oracle_cell_flags(
  const oracle_lattice* lattice, int64_t i, int64_t j, int64_t k, int corners[8])
{
  if (i < lattice->first[0] || j < lattice->first[1] || k < lattice->first[2] ||
    i >= lattice->end[0] || j >= lattice->end[1] || k >= lattice->end[2])
  {
    return 0;
  }
  for (int c = 0; c < 8; ++c)
  {
    corners[c] =
      lattice->flags[oracle_node_index(lattice, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))];
  }
  return 1;
}

int oracle_cell_valid(const oracle_lattice* lattice, int64_t i, int64_t j, int64_t k)
{
  int corners[8];
  int valid = oracle_cell_flags(lattice, i, j, k, corners);
  for (int c = 0; valid && c < 8; ++c)
  {
    valid = (corners[c] & ORACLE_NODE_VALID) != 0;
  }
  return valid;
}

int oracle_cell_possible(const oracle_lattice* lattice, int64_t i, int64_t j, int64_t k)
{
  int corners[8];
  int possible = oracle_cell_flags(lattice, i, j, k, corners);
  for (int c = 0; possible && c < 8; ++c)
  {
    possible = (corners[c] & (ORACLE_NODE_VALID | ORACLE_NODE_MARGIN)) != 0;
  }
  return possible;
}

int oracle_cell_certain(const oracle_lattice* lattice, int64_t i, int64_t j, int64_t k)
{
  int corners[8];
  int certain = oracle_cell_flags(lattice, i, j, k, corners);
  for (int c = 0; certain && c < 8; ++c)
  {
    certain = (corners[c] & ORACLE_NODE_VALID) && !(corners[c] & ORACLE_NODE_MARGIN);
  }
  return certain;
}

void oracle_edge_ends(const oracle_lattice* lattice, int64_t edge, int64_t nodes[2])
{
  const int64_t step[3] = { 1, lattice->size[0], lattice->size[0] * lattice->size[1] };
  nodes[0] = edge / 3;
  nodes[1] = nodes[0] + step[edge % 3];
}

void oracle_edge_cells(const oracle_lattice* lattice, int64_t edge, int64_t cells[4][3])
{
  const int axis = (int)(edge % 3);
  for (int c = 0; c < 4; ++c)
  {
    oracle_node_ijk(lattice, edge / 3, cells[c]);
    cells[c][(axis + 1) % 3] -= c & 1;
    cells[c][(axis + 2) % 3] -= c >> 1;
  }
}
