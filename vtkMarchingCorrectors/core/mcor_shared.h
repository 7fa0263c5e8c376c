/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_shared_h
#define mcor_shared_h

/* Constants and structs that the host and the kernels share. This is the first of the OpenCL
 * sources; for lanes see mcor_prelude.cl. */

#ifdef __OPENCL_VERSION__
#define MCOR_TYPE(type) type
#else
#define MCOR_TYPE(type) cl_##type
#endif

/* Arrays of the search grid have this number of elements behind the last particle, because vector
 * loads may read beyond it. The number is the width of the widest vector load. */
#define MCOR_PADDING 16

typedef struct mcor_level
{
  MCOR_TYPE(ulong) base; /* key of the level's cell (0, 0, 0) */
  /* In fixed-point units. period: the period's length, or 0 without a period. side: the first place
   * at or above 0 where a period begins. */
  MCOR_TYPE(long) period[3], side[3];
  MCOR_TYPE(int) cells[3];        /* extent of the level, in its cells */
  MCOR_TYPE(int) period_cells[3]; /* cells of a period */
  MCOR_TYPE(float) inv_cell[3];   /* 1 / cell size, in fixed-point units */
  MCOR_TYPE(float) support;       /* the level's largest support radius in cubes, rounded up */
} mcor_level;

/* A brick is 4 x 4 x 4 nodes, and the 4 x 4 x 4 cells whose lowest nodes they are. In a mask (a
 * ulong), node or cell (x, y, z) of a brick has bit x + 4 y + 16 z. */
#define MCOR_BRICK 4
#define MCOR_BRICK_NODES 64
/* A brick's 7 upper and 7 lower neighbours, see mcor_brick_neighbours. */
#define MCOR_NEIGHBOURS 14

/* A region is 2 x 2 x 2 bricks, a block 4 x 4 x 4 regions. */
#define MCOR_REGION_BRICKS 2
#define MCOR_BLOCK_REGIONS 64
#define MCOR_BLOCK_BRICKS 512
#define MCOR_BLOCK_WORDS 16 /* a word has a bit per brick: x 0..7, y 0..3 or 4..7, one z */
#define MCOR_BLOCK_CUBES 32 /* along an edge */

/* Bit that is added to the key of a triangle's cell if the cell is outside the box, in the ring of
 * cells around the box. */
#define MCOR_RING_CELL ((MCOR_TYPE(ulong))1 << 63)
/* Bit that is added to the key, besides MCOR_RING_CELL, if another rank owns the cell. */
#define MCOR_OTHERS_CELL ((MCOR_TYPE(ulong))1 << 62)
/* This bit makes the key of a cap's square greater than the key of any owned cell. */
#define MCOR_CAP_SQUARE ((MCOR_TYPE(ulong))1 << 62)

/* Particles or triangles that one work-item treats in turn. A CPU needs several, because it cannot
 * go on with another work-item while it waits for memory. */
#define MCOR_BATCH_OF(lanes) ((lanes) == 1 ? 1 : 64)

/* MCOR_INSERTION_OF: one call of mcor_grid_insert sorts the particles of successive cells, at most
 * this number of particles. The particles of a cell that has more are sorted by a heap.
 * MCOR_USUAL_IN_CELL: cells with up to this number of particles do not raise most_in_cell of
 * mcor_grid. */
#define MCOR_INSERTION_OF(lanes) ((lanes) == 1 ? 64 : 256)
#define MCOR_USUAL_IN_CELL 32

/* Buckets that one work-item fills. */
#define MCOR_ITEM_BUCKETS_OF(lanes) ((lanes) == 1 ? 1 : 1024)

/* Most bits that one round of the radix sort treats. */
#define MCOR_DIGIT_BITS_OF(lanes) ((lanes) == 1 ? 8 : 12)

/* One launch reads the values of up to this number of arrays, see mcor_values_load. */
#define MCOR_ARRAY_STEP 4

/* MCOR_SIDE_PARTICLES: this many successive particles share a flag, which tells on which sides of
 * the iso value they are, see mcor_seed_side_flags. MCOR_PAIR_VECTORS_OF: one work-item finds the
 * pairs of particles in this many vectors of particles. The number is small, because a particle may
 * have many pairs. */
#define MCOR_SIDE_PARTICLES 16
#define MCOR_PAIR_VECTORS_OF(lanes) ((lanes) == 1 ? 1 : 8)

/* States: the sides of the iso value on which the nodes of a brick, a region or a larger cube
 * may be. */
#define MCOR_VOID 0 /* below the node threshold: no cell there is valid */
#define MCOR_ABOVE 1
#define MCOR_BELOW 2
#define MCOR_EXAMINE 3 /* maybe both sides: evaluate */
/* Bit that is added to the state of a leaf (an undivided brick) if the state does not hold for the
 * nodes that cells of other levels have on the leaf's sides. */
#define MCOR_OPEN_SIDES 4

/* How many masks a brick has. EDGE masks mark those lattice edges of the brick that have a vertex,
 * see mcor_cell.cl. DECISION masks 0 to 2, for normals along x, y, z, mark ambiguous faces whose
 * lowest node is in the brick and whose nodes above the iso value are joined. Mask 3 marks cells
 * whose samples are all below the iso value; mask 4 marks cells whose samples are all above it. */
#define MCOR_EDGE_MASKS 9
#define MCOR_DECISION_MASKS 5

/* A way to triangulate a cell. An edge is axis << 3 | its lower corner; a corner has the bits 1 x,
 * 2 y, 4 z. tunnel[0]: the number of the row that differs from this row by a tunnel between two
 * regions below the iso value. tunnel[1]: as tunnel[0], but between two regions above it. Rows are
 * numbered from the first row of the case; 0: no such row. */
typedef struct mcor_cell_row
{
  MCOR_TYPE(uchar) edges[36]; /* 3 per triangle */
  MCOR_TYPE(uchar) triangles;
  MCOR_TYPE(uchar) tunnel[2];
  MCOR_TYPE(uchar) unused;
} mcor_cell_row;

/* The keys of one level's blocks. base: the first key. n: how many blocks there are along x, y, z.
 * One more rung, after the highest level, begins behind all keys. The key of a brick is the key of
 * its block times MCOR_BLOCK_BRICKS, plus the brick's number in the block. */
typedef struct mcor_rung
{
  MCOR_TYPE(ulong) base;
  MCOR_TYPE(int) n[3];
  MCOR_TYPE(int) unused;
} mcor_rung;

/* A vertex's lattice edge is four ints: x, y, z of the edge's lower node, and level <<
 * MCOR_LEVEL_SHIFT | flag << 2 | axis. flag: 1 if a cell around the edge is unused. */
#define MCOR_LEVEL_SHIFT 8

/* A leaf has a table of the slots (indices in buffers) of all bricks that it may need: 2^3 bricks
 * of its level, 3^3 bricks of the next finer level. */
#define MCOR_LEAF_SLOTS (8 + 27)

/* How many uints the quadrant masks of a brick have: 2 for each axis and each of the 4 quadrants
 * around an edge along it. A mask tells at which edges a used cell is in the quadrant. */
#define MCOR_QUADRANT_WORDS 24

/* Points that one work-item cuts into groups. */
#define MCOR_GROUPED_POINTS_OF(lanes) ((lanes) == 1 ? 1 : 512)

/* Greatest distance along each axis between the nodes of a group's points, in cubes. */
#define MCOR_GROUP_EDGE 7

/* Positions of a group's points, and of particles, are relative to a node in the middle of the
 * group. Along each axis, the points are at most this far from the node, in cubes: half a group, a
 * point's offset (up to 2.5), and a margin of 1. Particles with long supports are rounded more
 * coarsely (mcor_stage.c), so that their positions relative to any node are exact reals if the node
 * is no further than this from their supports. */
#define MCOR_POINT_EXTENT (0.5 * MCOR_GROUP_EDGE + 2.5 + 1)

/* A cluster has at most this many groups of points. One work-item evaluates a cluster. */
#define MCOR_CLUSTER_OF(lanes) ((lanes) == 1 ? 1 : 16)

/* There is no Shepard mean where the fluid's own weight is less than this. If nodes needed no such
 * weight, cells could extend into voids that only solids fill, and rounding noise at a kernel's rim
 * would count as a value. Vertices lie between nodes: if the kernel has negative lobes, the weight
 * may pass 0 there, and the mean has a pole. Where the weight is at least 0.05, the mean is no
 * further from the particles' values than a linear extrapolation. */
#define MCOR_LEAST_NODE_WEIGHT 1e-3
#define MCOR_LEAST_VERTEX_WEIGHT(has_lobes) ((has_lobes) ? 0.05 : 1e-3)

/* At most this many components of attributes are evaluated together. */
#define MCOR_ATTRIBUTE_LIMIT 12

#endif
