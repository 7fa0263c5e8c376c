/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Types, constants and bit tricks that all kernels share. The host sets at build time:
 *
 *   MCOR_PROGRAM  which program this is, see MCOR_OF_LATTICE below and mcor_program.c
 *   MCOR_LANES    evaluation points that one work-item treats at once: 8 or 16 on a CPU, for
 *                 which OpenCL compilers do not vectorise these kernels themselves; 1 on a GPU
 *   MCOR_DOUBLE   real is double instead of float
 *   MCOR_W, MCOR_DW, MCOR_DDW, MCOR_TENSOR, MCOR_SUPPORT    the SPH kernel, see mcor_sph_kernel.h
 *   MCOR_FIELD    the field, see below
 *   MCOR_SOLIDS   1: some particles are solid and count in the trimming weight only
 *
 * All lengths are in cubes of the virtual grid. A position is a fixed-point number, in units of
 * 2^-fix_bits cubes from the lattice origin, so that a difference of two positions is exact: a
 * node's value depends neither on the brick that evaluates it nor on its distance from the origin.
 * If no cube fits into all periods of a periodic box a whole number of times, the edges along x, y,
 * z differ. Then the length "cube" is a little longer than the longest edge, and each edge is a
 * whole number of fixed-point units. Nodes, and offsets from them, are counted in edges. */

/* Programs, see mcor_program.c. The lattice's program is compiled once for all SPH kernels and
 * fields, with and without solids: its only settings are MCOR_LANES and MCOR_DOUBLE. */
#define MCOR_OF_LATTICE (MCOR_PROGRAM == 0)
#define MCOR_OF_FIELD (MCOR_PROGRAM == 1)

/* Values of MCOR_FIELD, the same as in mcor_field in mcor.h. */
#define MCOR_SHEPARD 0
#define MCOR_SUM 1
#define MCOR_WEIGHT_SUM 2

/* Every device must give the same bits. Additions, multiplications and fma are rounded alike
 * everywhere. A compiler must not turn a multiplication and an addition into an fma, which rounds
 * once instead of twice. */
#pragma OPENCL FP_CONTRACT OFF

/* MCOR_ONE_COPY marks functions that have several callers, and are mostly called for many particles
 * at once. Without the mark, a compiler for CPUs would copy such a function into each caller.
 * Compiling would take longer, and the first surface would come later. */
#if MCOR_LANES == 1
#define MCOR_INLINE
#define MCOR_ONE_COPY
#else
#define MCOR_ONE_COPY __attribute__((noinline))
#define MCOR_INLINE __attribute__((always_inline))
#ifdef POCL_DEVICE_ADDRESS_BITS
/* PoCL makes three functions of a kernel, and would inline the whole kernel into each. */
#define __kernel __kernel MCOR_ONE_COPY
#endif
#endif

/* Defines `item`, the number of this work-item. Surplus work-items, for which `condition` does not
 * hold, return at once. */
#define MCOR_ITEM(item, condition)                                                                 \
  const int item = get_global_id(0);                                                               \
  if (!(condition))                                                                                \
  return

#define MCOR_CAT_(a, b) a##b
#define MCOR_CAT(a, b) MCOR_CAT_(a, b)

#if MCOR_DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double real;
typedef double2 real2;
typedef double4 real4;
typedef double8 mcor_real8;
typedef long fix;
#define MCOR_REAL_NAME double
#define MCOR_FIX_NAME long
#else
typedef float real;
typedef float2 real2;
typedef float4 real4;
typedef float8 mcor_real8;
typedef int fix;
#define MCOR_REAL_NAME float
#define MCOR_FIX_NAME int
#endif

#if MCOR_LANES == 1
typedef real realv;
typedef fix fixv; /* also the result of comparing two realv */
#define MCOR_CONVERT_REALV MCOR_CAT(convert_, MCOR_REAL_NAME)
#define MCOR_AS_REALV MCOR_CAT(as_, MCOR_REAL_NAME)
#define MCOR_AS_FIXV MCOR_CAT(as_, MCOR_FIX_NAME)
#define MCOR_ANY(mask) ((mask) != 0)
#define MCOR_ALL(mask) ((mask) != 0)
#define MCOR_TRUE 1
#define MCOR_GET(v, lane) (v)
#define MCOR_SET(v, lane) (v)
#define MCOR_GET_FIX(v, lane) (v)
#else
typedef MCOR_CAT(MCOR_REAL_NAME, MCOR_LANES) realv;
typedef MCOR_CAT(MCOR_FIX_NAME, MCOR_LANES) fixv;
#define MCOR_CONVERT_REALV MCOR_CAT(convert_, MCOR_CAT(MCOR_REAL_NAME, MCOR_LANES))
#define MCOR_AS_REALV MCOR_CAT(as_, MCOR_CAT(MCOR_REAL_NAME, MCOR_LANES))
#define MCOR_AS_FIXV MCOR_CAT(as_, MCOR_CAT(MCOR_FIX_NAME, MCOR_LANES))
#define MCOR_ANY(mask) any(mask)
#define MCOR_ALL(mask) all(mask)
#define MCOR_TRUE (-1)
#define MCOR_GET(v, lane) (((const real*)&(v))[lane])
#define MCOR_SET(v, lane) (((real*)&(v))[lane])
#define MCOR_GET_FIX(v, lane) (((const fix*)&(v))[lane])
#endif

/* a * b + c, rounded once, in each lane. */
#define MCOR_FMA(a, b, c) fma((realv)(a), (realv)(b), (realv)(c))

/* Returns 0, 1, ... MCOR_LANES - 1. */
fixv mcor_lane_index(void)
{
#if MCOR_LANES == 1
  return 0;
#elif MCOR_LANES == 8
  return (fixv)(0, 1, 2, 3, 4, 5, 6, 7);
#else
  return (fixv)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
}

real mcor_lane_sum(realv v)
{
  real sum = 0;
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    sum += MCOR_GET(v, lane);
  }
  return sum;
}

#define MCOR_BATCH MCOR_BATCH_OF(MCOR_LANES)
#define MCOR_CLUSTER MCOR_CLUSTER_OF(MCOR_LANES)
#define MCOR_GROUPED_POINTS MCOR_GROUPED_POINTS_OF(MCOR_LANES)

/* Least distance of a vertex from the ends of its edge, as a share of the edge. If edges meet in a
 * node whose value is the iso value, this distance keeps their vertices apart, so that no triangle
 * loses its area. */
#define MCOR_EDGE_MARGIN (MCOR_DOUBLE ? (real)1e-9 : (real)3.8e-6f)

/* Masks of the nodes or cells in the lowest layer of a brick along x, y, z. */
#define MCOR_LOW_X 0x1111111111111111UL
#define MCOR_LOW_Y 0x000F000F000F000FUL
#define MCOR_LOW_Z 0x000000000000FFFFUL

/* Returns the mask of the lowest nodes along an axis. */
ulong mcor_lowest(int axis)
{
  return axis == 0 ? MCOR_LOW_X : axis == 1 ? MCOR_LOW_Y : MCOR_LOW_Z;
}

/* Returns the mask in which each node has the bit of the next node along an axis. next: the mask of
 * the next brick. */
ulong mcor_from_next(int axis, ulong m, ulong next)
{
  const ulong low = mcor_lowest(axis);
  const int step = 1 << 2 * axis;
  return (m >> step & ~(low << 3 * step)) | (next & low) << 3 * step;
}

/* Returns the mask in which each node has the bit of the previous node along an axis. last: the
 * mask of the previous brick. */
ulong mcor_from_last(int axis, ulong m, ulong last)
{
  const ulong low = mcor_lowest(axis);
  const int step = 1 << 2 * axis;
  return (m & ~(low << 3 * step)) << step | (last >> 3 * step & low);
}

/* Returns where node or cell n is in its brick. */
int4 mcor_place_of(int n)
{
  return (int4)(n & 3, n >> 2 & 3, n >> 4, 0);
}

/* mcor_up returns the step from a cell or brick to its neighbour d at higher coordinates: bit 0 of
 * d is one step along x, bit 1 along y, bit 2 along z. mcor_around returns the step to number d of
 * 27: a cell or brick itself (d = 13), and all 26 neighbours. */
int4 mcor_up(int d)
{
  return (int4)(d & 1, d >> 1 & 1, d >> 2, 0);
}
int4 mcor_around(int d)
{
  return (int4)(d % 3 - 1, d / 3 % 3 - 1, d / 9 - 1, 0);
}

/* Returns the index of the lowest bit set. */
int mcor_ctz(ulong m)
{
  return 63 - (int)clz(m & -m);
}

/* Returns the index of the first of sorted keys [low, high) that is at least `key`, or `high`. */
MCOR_ONE_COPY int mcor_find_key(__global const ulong* keys, int low, int high, ulong key)
{
  while (low < high)
  {
    const int middle = low + (high - low) / 2;
    if (keys[middle] < key)
    {
      low = middle + 1;
    }
    else
    {
      high = middle;
    }
  }
  return low;
}

/* Returns the search cell of position x along an axis; it may lie outside of the level's cells. The
 * cell is monotone in x, so the cells of two positions enclose the cells of all positions between.
 * All periods are divided into cells alike. Sums follow the order of the cells, so a sum is the
 * same at a place one period away. */
MCOR_ONE_COPY int mcor_cell_of(__global const mcor_level* level, int axis, fix x)
{
  const fix period = (fix)level->period[axis];
  if (period == 0)
  {
    return (int)floor((float)x * level->inv_cell[axis]);
  }
  /* Removes most periods at once, the rest one by one, so rounding does not matter. */
  fix rest = x - (fix)level->side[axis];
  const int most = (int)((float)rest / (float)period) - 1, periods = max(most, -1);
  const int cells = level->period_cells[axis];
  int cell = (periods + 1) * cells;
  for (rest -= periods * period; rest >= period; rest -= period)
  {
    cell += cells;
  }
  return rest < 0 ? -1 : cell + min((int)((float)rest * level->inv_cell[axis]), cells - 1);
}

/* Returns a particle's cell along an axis, in the particle's level. */
MCOR_INLINE int mcor_cell_of_particle(__global const mcor_level* level, int axis, fix x)
{
  /* the cell before clamping */
  const int cell = level->period[axis] == 0 ? (int)((float)x * level->inv_cell[axis])
                                            : mcor_cell_of(level, axis, x);
  return clamp(cell, 0, level->cells[axis] - 1);
}
