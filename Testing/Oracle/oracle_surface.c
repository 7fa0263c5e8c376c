/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle.h"

#include <stdlib.h>
#include <string.h>

static int oracle_above(const oracle_lattice* lattice, int64_t i, int64_t j, int64_t k)
{
  return lattice->flags[oracle_node_index(lattice, i, j, k)] & ORACLE_NODE_ABOVE;
}

static int oracle_edge_used(const oracle_lattice* lattice, int64_t edge)
{
  int64_t nodes[2];
  oracle_edge_ends(lattice, edge, nodes);
  if ((lattice->flags[nodes[0]] ^ lattice->flags[nodes[1]]) & ORACLE_NODE_ABOVE)
  {
    int64_t cells[4][3];
    oracle_edge_cells(lattice, edge, cells);
    for (int c = 0; c < 4; ++c)
    {
      if (oracle_cell_valid(lattice, cells[c][0], cells[c][1], cells[c][2]))
      {
        return 1;
      }
    }
  }
  return 0;
}

static int oracle_cell_used(const oracle_lattice* lattice, int64_t i, int64_t j, int64_t k)
{
  if (i + 1 >= lattice->size[0] || j + 1 >= lattice->size[1] || k + 1 >= lattice->size[2])
  {
    return 0;
  }
  int above = 0;
  for (int c = 0; c < 8; ++c)
  {
    above += oracle_above(lattice, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
  }
  return above > 0 && above < 8 && oracle_cell_valid(lattice, i, j, k);
}

/* Counts (fill = 0) or writes the crossed edges and cells, in ascending order. */
static void oracle_list(oracle_surface* surface, const oracle_lattice* lattice, int fill)
{
  int64_t edges = 0;
  int64_t cells = 0;
  for (int64_t k = 0; k < lattice->size[2]; ++k)
  {
    for (int64_t j = 0; j < lattice->size[1]; ++j)
    {
      for (int64_t i = 0; i < lattice->size[0]; ++i)
      {
        const int64_t node = oracle_node_index(lattice, i, j, k);
        const int64_t ijk[3] = { i, j, k };
        for (int axis = 0; axis < 3; ++axis)
        {
          if (ijk[axis] + 1 < lattice->size[axis] && oracle_edge_used(lattice, 3 * node + axis))
          {
            if (fill)
            {
              surface->edge[edges] = 3 * node + axis;
            }
            ++edges;
          }
        }
        if (oracle_cell_used(lattice, i, j, k))
        {
          if (fill)
          {
            surface->cell[cells] = node;
          }
          ++cells;
        }
      }
    }
  }
  surface->edge_count = edges;
  surface->cell_count = cells;
}

static int oracle_compare_keys(const void* a, const void* b)
{
  const int64_t x = *(const int64_t*)a;
  const int64_t y = *(const int64_t*)b;
  return (x > y) - (x < y);
}

static int64_t oracle_find(const int64_t* keys, int64_t count, int64_t key)
{
  const int64_t* at =
    count > 0 ? bsearch(&key, keys, (size_t)count, sizeof(*keys), oracle_compare_keys) : NULL;
  return at ? at - keys : -1;
}

int64_t oracle_find_edge(const oracle_surface* surface, int64_t edge)
{
  return oracle_find(surface->edge, surface->edge_count, edge);
}

static int64_t oracle_root(int64_t* parent, int64_t n)
{
  while (parent[n] != n)
  {
    parent[n] = parent[parent[n]];
    n = parent[n];
  }
  return n;
}

/* 1 if the face between a cell and its neighbour in +axis has nodes on both sides. */
static int oracle_face_mixed(const oracle_lattice* lattice, int64_t cell, int axis)
{
  const int64_t step[3] = { 1, lattice->size[0], lattice->size[0] * lattice->size[1] };
  const int64_t first = cell + step[axis];
  const int64_t u = step[(axis + 1) % 3];
  const int64_t v = step[(axis + 2) % 3];
  const int above = (lattice->flags[first] & ORACLE_NODE_ABOVE) +
    (lattice->flags[first + u] & ORACLE_NODE_ABOVE) +
    (lattice->flags[first + v] & ORACLE_NODE_ABOVE) +
    (lattice->flags[first + u + v] & ORACLE_NODE_ABOVE);
  return above > 0 && above < 4;
}

/* Unites cells over mixed faces; parent[c] is then the number of the component of cell c. */
static int64_t oracle_unite_cells(
  const oracle_surface* surface, const oracle_lattice* lattice, int64_t* parent)
{
  const int64_t step[3] = { 1, lattice->size[0], lattice->size[0] * lattice->size[1] };
  for (int64_t c = 0; c < surface->cell_count; ++c)
  {
    parent[c] = c;
  }
  for (int64_t c = 0; c < surface->cell_count; ++c)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      if (oracle_face_mixed(lattice, surface->cell[c], axis))
      {
        const int64_t other =
          oracle_find(surface->cell, surface->cell_count, surface->cell[c] + step[axis]);
        if (other >= 0)
        {
          const int64_t a = oracle_root(parent, c);
          const int64_t b = oracle_root(parent, other);
          parent[a > b ? a : b] = a > b ? b : a;
        }
      }
    }
  }
  /* Roots are the lowest cell of their component, so one ascending pass can number them. */
  int64_t components = 0;
  for (int64_t c = 0; c < surface->cell_count; ++c)
  {
    const int64_t root = parent[c];
    parent[c] = root == c ? components++ : parent[root];
  }
  return components;
}

int oracle_create_surface(oracle_surface* surface, const oracle_lattice* lattice)
{
  memset(surface, 0, sizeof(*surface));
  oracle_list(surface, lattice, 0);
  surface->edge = malloc(((size_t)surface->edge_count + 1) * sizeof(int64_t));
  surface->edge_component = malloc(((size_t)surface->edge_count + 1) * sizeof(int64_t));
  surface->cell = malloc(((size_t)surface->cell_count + 1) * sizeof(int64_t));
  int64_t* parent = malloc(((size_t)surface->cell_count + 1) * sizeof(int64_t));
  if (!surface->edge || !surface->edge_component || !surface->cell || !parent)
  {
    free(parent);
    oracle_free_surface(surface);
    return 0;
  }
  oracle_list(surface, lattice, 1);
  surface->component_count = oracle_unite_cells(surface, lattice, parent);
  for (int64_t e = 0; e < surface->edge_count; ++e)
  {
    int64_t cells[4][3];
    surface->edge_component[e] = -1;
    oracle_edge_cells(lattice, surface->edge[e], cells);
    /* All valid cells of a crossed edge lie in one component unless invalid ones separate them; the
     * first then names it. */
    for (int c = 0; c < 4 && surface->edge_component[e] < 0; ++c)
    {
      if (oracle_cell_valid(lattice, cells[c][0], cells[c][1], cells[c][2]))
      {
        const int64_t node = oracle_node_index(lattice, cells[c][0], cells[c][1], cells[c][2]);
        surface->edge_component[e] = parent[oracle_find(surface->cell, surface->cell_count, node)];
      }
    }
  }
  free(parent);
  return 1;
}

void oracle_free_surface(oracle_surface* surface)
{
  free(surface->edge);
  free(surface->edge_component);
  free(surface->cell);
  memset(surface, 0, sizeof(*surface));
}
