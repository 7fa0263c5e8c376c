/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_adaptive_h
#define core_adaptive_h

/* Derives anew, from positions in space, how a cell with finer cells around it must look. */

#include "core_fixture.h"
#include "mcor_adaptive_cell.h"

#define CORE_SPLIT_CLASSES 227 /* of sets of split faces and edges, up to symmetry */

typedef struct core_facet
{
  int nodes[8], slots[8]; /* slots[i] between nodes i and i + 1; counter-clockwise from outside */
  int count, whole;
} core_facet;

/* A cell with one set of split faces and edges. */
typedef struct core_shape
{
  uint32_t split;
  int nodes[26], node_count;
  core_facet facets[24];
  int facet_count;
  /* 1: both in one facet, or on one edge of the cell. */
  uint8_t forbidden[MCOR_ADAPTIVE_SLOTS][MCOR_ADAPTIVE_SLOTS];
  uint8_t in_whole[MCOR_ADAPTIVE_SLOTS]; /* bits: the whole faces that the slot's vertex lies in */
} core_shape;

/* One of each class, as a mask of the middles that are nodes; returns how many. */
int core_list_splits(uint32_t splits[CORE_SPLIT_CLASSES]);
/* Under one of the 48 symmetries of the cube. */
uint32_t core_turn_split(uint32_t split, int symmetry);
void core_make_shape(uint32_t split, core_shape* shape);
/* next[slot] by the rule: on each facet, each run of nodes above is cut off; -1: no vertex. Returns
 * the number of vertices. */
int core_link_slots(const core_shape* shape, uint32_t above, int8_t next[MCOR_ADAPTIVE_SLOTS]);

#endif
