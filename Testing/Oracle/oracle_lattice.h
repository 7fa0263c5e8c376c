/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_lattice_h
#define oracle_lattice_h

/* Marching Cubes by brute force, on cubes as fine as the particles or on cubes of one size. Takes all nodes and cells
 * of all bricks that a particle reaches. Finds which edges are crossed and how faces join the crossings. Makes no
 * triangles. */

#include "oracle.h"

#ifdef __cplusplus
extern "C"
{
#endif

  enum
  {
    LATTICE_LEVELS = 32,
    LATTICE_BRICK = 4, /* cells of a brick along an axis */
    LATTICE_CORNERS = 125,

    /* Flags of nodes. */
    LATTICE_ABOVE = 1, /* value >= iso */
    LATTICE_VALID = 2, /* may be a corner of a cell that is used */
    LATTICE_CLOSE = 4, /* value within rounding of iso */
    LATTICE_MARGIN = 8 /* weight within rounding of the threshold */
  };

  /* A map from three whole numbers and a tag to a number that is not negative. */
  typedef struct oracle_map
  {
    int64_t* slots; /* [capacity][5]: key, value; value -1: free */
    int64_t capacity, count;
  } oracle_map;

  /* Returns where the value of a key is stored. A new entry holds -1 until the caller sets it, which must happen before
   * the next call. Returns NULL if there is no such key and `add` is 0. Ends the program if memory runs out. */
  int64_t* oracle_map_find(oracle_map* map, const int64_t at[3], int64_t tag, int add);
  void oracle_map_free(oracle_map* map);

  /* Places (at) are in units of the smallest cubes, whose corners lie at whole numbers. */
  typedef struct lattice_node
  {
    int64_t at[3];
    double value, weight, trim_weight;
    int flags;
  } lattice_node;

  typedef struct lattice_brick
  {
    int64_t at[3]; /* lowest corner */
    int level;
  } lattice_brick;

  /* A cell with nodes on both sides of iso. None of its nodes is certainly invalid. */
  typedef struct lattice_cell
  {
    int64_t at[3];
    int level;
    int64_t node[27]; /* x + 3 y + 9 z, half a cell apart; -1: none there */
    int valid, certain, loops, triangles;
    int64_t component; /* valid cells: the component that shared segments unite */
  } lattice_cell;

  /* An edge between two neighbouring nodes on different sides of iso. */
  typedef struct lattice_edge
  {
    int64_t at[3], length; /* lower end */
    int axis;
    int64_t node[2];
    int quadrants; /* bits of the valid cells around it; u >= 0: 1, v >= 0: 2, where u and v are the axes after its own */
    int used;      /* a loop of three or more uses it */
    int sure;      /* a loop of a certain cell uses it */
    int certain;   /* all cells around it are certain */
    int64_t component; /* the component of one of its cells; -1: not used */
  } lattice_edge;

  /* A segment on a cell's face from one crossed edge to another, in the direction of the triangles
   * of this cell. */
  typedef struct lattice_segment
  {
    int64_t from, to, cell;
  } lattice_segment;

  typedef struct oracle_lattice
  {
    double edge[3];           /* edges of the smallest cubes */
    double cube;              /* the shortest of the three */
    int64_t first[3], end[3]; /* cells outside of these bounds do not exist */
    int top;                  /* highest level */
    oracle_map split;
    oracle_map node_map, edge_map;
    lattice_node* nodes;
    lattice_brick* bricks; /* all leaves that a particle reaches */
    int64_t* corners;      /* [brick_count][5][5][5]: nodes at the corners of the bricks' cells */
    lattice_cell* cells;
    lattice_edge* edges;
    lattice_segment* segments; /* of valid cells, without loops of two */
    /* Each maps a pair of crossed edges of a face (lower number first) to the number of valid cells at the face.
     * doubts: pairs in cells that rounding may make valid or not. either: pairs that rounding may join or not. */
    oracle_map doubts, either;
    int64_t brick_count, brick_capacity, node_count, node_capacity, cell_count, cell_capacity,
      edge_count, edge_capacity, segment_count, segment_capacity;
    int64_t component_count, triangle_count; /* triangle_count: without tunnels */
    const struct oracle_decider* decider;    /* during oracle_march */
  } oracle_lattice;

  typedef struct oracle_limits
  {
    double iso;
    double node_threshold;    /* not applied to ORACLE_WEIGHT */
    double least_weight;      /* fluid weight below which a Shepard mean has no meaning, > 0 */
    double least_at_vertices; /* the same limit for vertices */
    double close;  /* |value - iso| up to which a node is excused, in the scalar's unit */
    double margin; /* |weight - threshold| up to which a node is excused */
  } oracle_limits;

  /* Decides topology by the field: how an ambiguous face between two plain cells (oracle_is_plain) is joined depends on
   * the field at the saddle point of the face. */
  typedef struct oracle_decider
  {
    const oracle_field* field;
    const oracle_limits* limits;
    double unit; /* roundoff of the working precision */
  } oracle_decider;

  /* Lists the leaf bricks that particles reach and, if with_nodes, evaluates all their nodes. level_limit: the highest
   * level that is allowed. */
  void oracle_create_lattice(oracle_lattice* lattice, const oracle_field* field,
    const double edge[3], int level_limit, int with_nodes);
  /* Classifies the nodes, and finds cells, edges and segments for an iso value. by_field: the field decides the
   * topology of faces. */
  void oracle_march(oracle_lattice* lattice, const oracle_field* field, const oracle_limits* limits,
    int by_field, double unit);
  void oracle_free_lattice(oracle_lattice* lattice);

  /* Returns whether the brick that has this level and lowest corner is split. */
  int oracle_is_split(oracle_lattice* lattice, int level, const int64_t at[3]);
  void oracle_place(const oracle_lattice* lattice, const int64_t at[3], double point[3]);
  /* Writes cell c of brick b and its nodes. Middles of edges and faces are nodes if finer bricks lie beside them. add:
   * creates missing nodes. */
  void oracle_cell_at(oracle_lattice* lattice, int64_t b, int c, int add, lattice_cell* cell);
  /* Returns whether a cell of this level exists and no finer brick touches it, not even at a corner. */
  int oracle_is_plain(oracle_lattice* lattice, int level, const int64_t at[3]);

#ifdef __cplusplus
}
#endif

#endif
