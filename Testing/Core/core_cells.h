/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_cells_h
#define core_cells_h

/* Cells of the virtual grid as the topology table triangulates them: what must be on their
 * faces, derived from the corners alone, and the triangles of a few cells together. Corners have
 * bits x, y, z; an edge is axis << 3 | lower corner, 24 numbers of which 12 are edges; a face is
 * axis * 2 + side. */

#include "mcor_internal.h"

int cells_corner_above(int cube_case, int corner);
int cells_lower_corner(int edge);
int cells_upper_corner(int edge);
int cells_is_crossed(int cube_case, int edge); /* 0 for a number that is no edge */
int cells_in_face(int edge, int face);
/* Crossed edges of a face, 0, 2 or 4. */
int cells_face_crossings(int cube_case, int face, int crossed[4]);
/* The edge that the surface connects with `edge` in a face: the other one that is crossed; of
 * three, the one around the same corner above, or below where those above are joined. */
int cells_partner(int cube_case, int joined, int face, int edge);
/* Loops that the connections in faces make. */
int cells_count_loops(int cube_case, int joined);

/* What was decided on a cell, and the row of the table for it. */
typedef struct cells_choice
{
  int cube_case;
  int joined; /* faces whose corners above are joined */
  int tunnel; /* 0 joins regions below, 1 above, 2 none */
  const mcor_cell_row* row;
} cells_choice;

/* All rows of a case; returns their number. */
int cells_case_rows(const mcor_topology_table* table, int cube_case, cells_choice rows[256]);

/* Edges of a few cells are numbered in a lattice of 3 x 3 x 3 nodes. */
#define CELLS_EDGES 81

typedef struct cells_mesh
{
  int count; /* of triangles */
  int corner[64][3];
  uint8_t directed[CELLS_EDGES]
                  [CELLS_EDGES]; /* triangles with a side from one vertex to the other */
} cells_mesh;

int cells_edge_number(int edge, const int cell[3]);
void cells_add_row(cells_mesh* mesh, const mcor_cell_row* row, const int cell[3]);
/* Takes all triangles out again; much faster than to clear everything. */
void cells_clear(cells_mesh* mesh);
/* Walks the link of a vertex, against the triangles' direction until its begin, then along it.
 * Returns its length if it is one simple path or circle through all triangles of the vertex,
 * else -1. */
int cells_walk_link(const cells_mesh* mesh, int vertex, int link[64]);

#endif
