/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_shared_h
#define mcor_shared_h

/* Constants and structs that the host and its kernels must see alike. The first of the OpenCL
 * sources; lanes: see mcor_prelude.cl. */

#ifdef __OPENCL_VERSION__
#define MCOR_TYPE(type) type
#else
#define MCOR_TYPE(type) cl_##type
#endif

/* Search grid. Arrays of particles are padded by as many elements as the widest vector load has. */
#define MCOR_PADDING 16

typedef struct mcor_level
{
  MCOR_TYPE(ulong) base; /* key of the level's cell (0, 0, 0) */
  /* In fixed-point units: a period, 0 if there is none, and its first side above 0. */
  MCOR_TYPE(long) period[3], side[3];
  MCOR_TYPE(int) cells[3];        /* extent of the level, in its cells */
  MCOR_TYPE(int) period_cells[3]; /* cells of a period */
  MCOR_TYPE(float) inv_cell[3];   /* 1 / cell size, in fixed-point units */
  MCOR_TYPE(float) support; /* largest support radius of the level's particles, cubes, rounded up */
} mcor_level;

/* A brick is 4 x 4 x 4 nodes, and the 4 x 4 x 4 cells whose lowest node they are. Node or cell
 * (x, y, z) of a brick is bit x + 4 y + 16 z of a ulong. */
#define MCOR_BRICK 4
#define MCOR_BRICK_NODES 64
/* Bricks beside a brick that share cells with it, see mcor_brick_neighbours. */
#define MCOR_NEIGHBOURS 14

/* A region is 2 x 2 x 2 bricks, a block 4 x 4 x 4 regions. */
#define MCOR_REGION_BRICKS 2
#define MCOR_BLOCK_REGIONS 64
#define MCOR_BLOCK_BRICKS 512
#define MCOR_BLOCK_WORDS 16 /* bits of bricks: x 0..7, y 0..3 or 4..7, one z */
#define MCOR_BLOCK_CUBES 32 /* along an edge */

/* Bit beside the key of a triangle's cell: the cell is in the ring around the box. */
#define MCOR_RING_CELL ((MCOR_TYPE(ulong))1 << 63)
/* Set beside that bit where another rank owns the cell. */
#define MCOR_OTHERS_CELL ((MCOR_TYPE(ulong))1 << 62)
/* Bit of the key of a cap's square, above all keys of cells. */
#define MCOR_CAP_SQUARE ((MCOR_TYPE(ulong))1 << 62)

/* Particles or triangles that one work-item treats in turn, where that saves work: a CPU does
 * not hide the waiting of single ones. */
#define MCOR_BATCH_OF(lanes) ((lanes) == 1 ? 1 : 64)

/* Most particles with one key (of a cell, or in one place) that one work-item sorts alone; and
 * the least value of most_in_cell in mcor_grid. */
#define MCOR_INSERTION_OF(lanes) ((lanes) == 1 ? 64 : 256)
#define MCOR_USUAL_IN_CELL 32
/* Length of runs in larger groups: they are sorted by insertion, then merged. */
#define MCOR_SORTED_RUN 32

/* Buckets that one work-item fills. */
#define MCOR_ITEM_BUCKETS_OF(lanes) ((lanes) == 1 ? 1 : 1024)

/* Most bits that one round of the radix sort treats. */
#define MCOR_DIGIT_BITS_OF(lanes) ((lanes) == 1 ? 8 : 12)

/* Arrays whose values one launch reads together, see mcor_values_load. */
#define MCOR_ARRAY_STEP 4

/* Seeds: successive particles that share one flag of their sides; vectors of particles whose
 * pairs one work-item finds, as each may have many lines. */
#define MCOR_SIDE_PARTICLES 16
#define MCOR_PAIR_VECTORS_OF(lanes) ((lanes) == 1 ? 1 : 8)

/* States: the sides of the iso value on which the nodes of a brick, a region or a larger cube
 * may be. */
#define MCOR_VOID 0 /* below the node threshold: no cell there is valid */
#define MCOR_ABOVE 1
#define MCOR_BELOW 2
#define MCOR_EXAMINE 3 /* both sides, as far as is known: evaluate */
#define MCOR_UNTRIED 7 /* both sides, and nothing was tried */
/* Bit beside the state of a leaf: the state does not cover the nodes that cells of other levels
 * have on its sides. */
#define MCOR_OPEN_SIDES 4

/* Masks of a brick: its lattice edges with a vertex, see mcor_march_count, and its decisions
 * about the topology. Decisions are on ambiguous faces with their lowest node in the brick, by
 * axis of their normal; only those whose nodes above are joined stay. Others are on cells whose
 * samples are all below, or all above. */
#define MCOR_EDGE_MASKS 9
#define MCOR_DECISION_MASKS 5

/* A way to triangulate a cell. An edge is axis << 3 | its lower corner, a corner bits 1 x, 2 y,
 * 4 z. tunnel: the row of the same case, counted from its first, in which a tunnel joins two
 * regions below or above; 0: there is none. */
typedef struct mcor_cell_row
{
  MCOR_TYPE(uchar) edges[36]; /* 3 a triangle */
  MCOR_TYPE(uchar) triangles;
  MCOR_TYPE(uchar) tunnel[2];
  MCOR_TYPE(uchar) unused;
} mcor_cell_row;

/* Keys of one level's blocks: where they begin, and how many blocks there are along x, y, z. The
 * rung after the highest begins behind all keys. The key of a brick is its block's key x
 * MCOR_BLOCK_BRICKS + its number there. */
typedef struct mcor_rung
{
  MCOR_TYPE(ulong) base;
  MCOR_TYPE(int) n[3];
  MCOR_TYPE(int) unused;
} mcor_rung;

/* Bits of an edge's last number below the vertex's level. */
#define MCOR_LEVEL_SHIFT 8

/* Slots that hold the nodes of a leaf: 2^3 of its level, 3^3 of the next finer one. */
#define MCOR_LEAF_SLOTS (8 + 27)

/* Used cells around the edges of a brick: [axis][quadrant] masks, as pairs of uints. */
#define MCOR_QUADRANT_WORDS 24

/* Points that one work-item cuts into groups. */
#define MCOR_GROUPED_POINTS_OF(lanes) ((lanes) == 1 ? 1 : 512)

/* Greatest distance between nodes of a group of points along an axis, in cubes. */
#define MCOR_GROUP_EDGE 7

/* Greatest distance of a group's points from the node that their positions, and those of
 * particles, count from: half a group, an offset from the node, and 1. The larger the support of
 * particles, the fewer digits their positions have (mcor_stage.c): as reals, they are exact this
 * much beyond the support. */
#define MCOR_POINT_EXTENT (0.5 * MCOR_GROUP_EDGE + 2.5 + 1)

/* Groups of points near each other that one work-item evaluates together. */
#define MCOR_CLUSTER_OF(lanes) ((lanes) == 1 ? 1 : 16)

/* Least weight of the fluid itself for a Shepard mean. At nodes: if solids made up the rest,
 * cells would reach over voids without any fluid, and rounding noise of a kernel's rim would
 * count as a value. At vertices, which lie between nodes: a kernel with negative lobes may let
 * the weight pass 0, where the mean has a pole. With this weight, the mean is no further from
 * the particles' values than linear extrapolation takes it. */
#define MCOR_LEAST_NODE_WEIGHT 1e-3
#define MCOR_LEAST_VERTEX_WEIGHT(has_lobes) ((has_lobes) ? 0.05 : 1e-3)

/* Components of attributes that are evaluated together. */
#define MCOR_ATTRIBUTE_LIMIT 12

#endif
