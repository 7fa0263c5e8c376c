/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_adaptive_h
#define oracle_adaptive_h

/* Marching Cubes on cubes as fine as the particles are, by brute force: levels from the particles
 * one by one, all nodes of all bricks that a particle reaches, all cells. Finds which edges are
 * crossed and how they are joined on faces; makes no triangles. */

#include "oracle.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C"
{
#endif

  enum
  {
    ADAPTIVE_LEVELS = 32,
    ADAPTIVE_BRICK = 4 /* cells of a brick along an axis */
  };

  /* From three whole numbers and a tag to one that is not negative. */
  typedef struct adaptive_map
  {
    int64_t* slots; /* [capacity][5]: key, value; value -1: free */
    int64_t capacity, count;
  } adaptive_map;

  /* The value's place; new ones hold -1 until the caller sets them, which it must before the next
   * call. NULL: no such key and not `add`. Ends the program if memory runs out. */
  int64_t* adaptive_map_find(adaptive_map* map, const int64_t at[3], int64_t tag, int add);
  void adaptive_map_free(adaptive_map* map);

  /* Grown as needed; ends the program if memory runs out. */
  void* adaptive_grow(void* array, int64_t count, int64_t* capacity, size_t size);

  typedef struct adaptive_brick
  {
    int64_t at[3]; /* lowest corner, in the smallest cubes */
    int level;
  } adaptive_brick;

  /* A cell with nodes on both sides, of which none is certainly invalid. */
  typedef struct adaptive_cell
  {
    int64_t at[3];
    int level;
    int64_t node[27]; /* x + 3 y + 9 z, half a cell apart; -1: none there */
    int valid, certain, loops, triangles;
  } adaptive_cell;

  /* Between two neighbouring nodes on different sides. */
  typedef struct adaptive_edge
  {
    int64_t at[3], length; /* lower end; in the smallest cubes */
    int axis;
    int64_t node[2];
    int quadrants; /* bits: valid cells around it, u >= 0: 1, v >= 0: 2, the axes after its own */
    int used;      /* by a loop of three or more */
    int certain;   /* all cells around it are */
    int doubtful;  /* rounding may join it on a face in another way */
    int64_t component;
  } adaptive_edge;

  /* From edge to edge on a face, in the direction of a cell's triangles. */
  typedef struct adaptive_segment
  {
    int64_t from, to;
    int certain; /* of its cell */
  } adaptive_segment;

  typedef struct oracle_adaptive
  {
    double cube; /* the smallest */
    int top;     /* highest level */
    adaptive_map split;
    adaptive_map node_map, edge_map;
    oracle_lattice nodes;   /* a list of nodes, as a lattice of one row, for oracle_classify */
    int64_t* node_at;       /* [node_count][3] */
    adaptive_brick* bricks; /* all leaves that a particle reaches */
    adaptive_cell* cells;
    adaptive_edge* edges;
    adaptive_segment* segments; /* of valid cells, but of loops of two */
    int64_t brick_count, brick_capacity, node_count, node_capacity, cell_count, cell_capacity,
      edge_count, edge_capacity, segment_count, segment_capacity;
    int64_t component_count, triangle_count; /* triangles but for tunnels */
    const struct oracle_decider* decider;    /* during oracle_march_adaptive */
  } oracle_adaptive;

  /* Topology by the field: how an ambiguous face between two plain cells is joined is asked of the field at
   * the saddle of its values. */
  typedef struct oracle_decider
  {
    const oracle_field* field;
    const oracle_limits* limits;
    double unit; /* roundoff of the working precision */
  } oracle_decider;

  /* Whether the nodes above iso are joined on a face: 0 or 1, or -1 where that is within rounding. value: at
   * the corners (0, 0), (1, 0), (0, 1), (1, 1) of u and v; corner: where the first one is. */
  int oracle_decide_face(const oracle_decider* decider, const double value[4],
    const double corner[3], const double edge[3], int u, int v);

  /* level_limit: the highest level at most. Evaluates all nodes; 0 if there are more than
   * node_limit. */
  int oracle_create_adaptive(oracle_adaptive* adaptive, const oracle_field* field, double cube,
    int level_limit, int64_t node_limit);
  /* Classifies the nodes, finds cells, edges and segments for an iso value. by_field: topology is. */
  void oracle_march_adaptive(oracle_adaptive* adaptive, const oracle_field* field,
    const oracle_limits* limits, int by_field, double unit);
  void oracle_free_adaptive(oracle_adaptive* adaptive);

  /* The nodes of the cell, made if `add`, else -1 where there are none; which middles are nodes
   * follows from finer bricks around the cell's. */
  void oracle_adaptive_nodes(oracle_adaptive* adaptive, const adaptive_brick* brick,
    const int64_t at[3], int add, int64_t node[27]);
  /* Whether a cell of the level is there, and no finer brick touches it, not even its corner. */
  int oracle_adaptive_is_plain(oracle_adaptive* adaptive, int level, const int64_t at[3]);

#ifdef __cplusplus
}
#endif

#endif
