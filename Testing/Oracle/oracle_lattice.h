/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_lattice_h
#define oracle_lattice_h

/* Marching Cubes on cubes as fine as the particles are, or on equal ones, by brute force: levels from the
 * particles one by one, all nodes of all bricks that a particle reaches, all cells. Finds which edges are
 * crossed and how they are joined on faces; makes no triangles. */

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

    /* of nodes */
    LATTICE_ABOVE = 1, /* value >= iso */
    LATTICE_VALID = 2, /* may be a corner of a cell that is used */
    LATTICE_CLOSE = 4, /* value within rounding of iso */
    LATTICE_MARGIN = 8 /* weight within rounding of the threshold */
  };

  /* From three whole numbers and a tag to one that is not negative. */
  typedef struct oracle_map
  {
    int64_t* slots; /* [capacity][5]: key, value; value -1: free */
    int64_t capacity, count;
  } oracle_map;

  /* The value's place; new ones hold -1 until the caller sets them, which it must before the next
   * call. NULL: no such key and not `add`. Ends the program if memory runs out. */
  int64_t* oracle_map_find(oracle_map* map, const int64_t at[3], int64_t tag, int add);
  void oracle_map_free(oracle_map* map);

  /* Places (at) are in the smallest cubes, which have their corners at whole multiples of their edges. */
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

  /* A cell with nodes on both sides, of which none is certainly invalid. */
  typedef struct lattice_cell
  {
    int64_t at[3];
    int level;
    int64_t node[27]; /* x + 3 y + 9 z, half a cell apart; -1: none there */
    int valid, certain, loops, triangles;
    int64_t component; /* valid cells: united over the segments they share */
  } lattice_cell;

  /* Between two neighbouring nodes on different sides. */
  typedef struct lattice_edge
  {
    int64_t at[3], length; /* lower end */
    int axis;
    int64_t node[2];
    int quadrants; /* bits: valid cells around it, u >= 0: 1, v >= 0: 2, the axes after its own */
    int used;      /* by a loop of three or more */
    int sure;      /* by one of a certain cell */
    int certain;   /* all cells around it are */
    int64_t component; /* of one of its cells; -1: not used */
  } lattice_edge;

  /* From edge to edge on a face, in the direction of a cell's triangles. */
  typedef struct lattice_segment
  {
    int64_t from, to, cell;
  } lattice_segment;

  typedef struct oracle_lattice
  {
    double edge[3];           /* of the smallest cubes */
    double cube;              /* the shortest of these */
    int64_t first[3], end[3]; /* cells outside of these do not exist */
    int top;                  /* highest level */
    oracle_map split;
    oracle_map node_map, edge_map;
    lattice_node* nodes;
    lattice_brick* bricks; /* all leaves that a particle reaches */
    int64_t* corners;      /* [brick_count][5][5][5], their cells' corners */
    lattice_cell* cells;
    lattice_edge* edges;
    lattice_segment* segments; /* of valid cells, but of loops of two */
    /* Pairs of edges, the lower first, on faces: of cells of which rounding decides whether they are valid; and
     * which rounding may join or part. Values: how many valid cells have the face. */
    oracle_map doubts, either;
    int64_t brick_count, brick_capacity, node_count, node_capacity, cell_count, cell_capacity,
      edge_count, edge_capacity, segment_count, segment_capacity;
    int64_t component_count, triangle_count; /* triangles but for tunnels */
    const struct oracle_decider* decider;    /* during oracle_march */
  } oracle_lattice;

  typedef struct oracle_limits
  {
    double iso;
    double node_threshold;    /* not applied to ORACLE_WEIGHT */
    double least_weight;      /* fluid weight below which a Shepard mean has no meaning, > 0 */
    double least_at_vertices; /* the same of vertices */
    double close;  /* |value - iso| up to which a node is excused, in the scalar's unit */
    double margin; /* |weight - threshold| up to which a node is excused */
  } oracle_limits;

  /* Topology by the field: how an ambiguous face between two plain cells is joined is asked of the field at
   * the saddle of its values. */
  typedef struct oracle_decider
  {
    const oracle_field* field;
    const oracle_limits* limits;
    double unit; /* roundoff of the working precision */
  } oracle_decider;

  /* level_limit: the highest level at most. Lists the leaves that particles reach, and evaluates all their nodes;
   * none after the first leaf with more than node_limit in all, and returns 0 then. */
  int oracle_create_lattice(oracle_lattice* lattice, const oracle_field* field,
    const double edge[3], int level_limit, int64_t node_limit);
  /* Classifies the nodes, finds cells, edges and segments for an iso value. by_field: topology is. */
  void oracle_march(oracle_lattice* lattice, const oracle_field* field, const oracle_limits* limits,
    int by_field, double unit);
  void oracle_free_lattice(oracle_lattice* lattice);

  /* Whether the brick of a level with this lowest corner is split. */
  int oracle_is_split(oracle_lattice* lattice, int level, const int64_t at[3]);
  void oracle_place(const oracle_lattice* lattice, const int64_t at[3], double point[3]);
  /* Cell c of brick b and its nodes. Middles are nodes where finer bricks around the brick make them; these
   * are made if `add`. */
  void oracle_cell_at(oracle_lattice* lattice, int64_t b, int c, int add, lattice_cell* cell);
  /* Whether a cell of the level is there, and no finer brick touches it, not even its corner. */
  int oracle_is_plain(oracle_lattice* lattice, int level, const int64_t at[3]);

#ifdef __cplusplus
}
#endif

#endif
