/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_parts_h
#define mcor_parts_h

/* A surface in parts, each of which lies in a box and is made from the particles near the box
 * alone. One process makes the parts in turn, or several processes work together. See
 * mcor_options.box, .globals and .ranks. */

#include "mcor.h"

#ifdef __cplusplus
extern "C"
{
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

  /* Facts about one component of an attribute, from all fluid particles. */
  typedef struct mcor_global_component
  {
    double largest;     /* greatest absolute value; 0 if it does not vary */
    double low, high;   /* range; low > high without fluid particles */
    int varies;         /* 0: all values, also at solids, are the same */
    int64_t not_finite; /* the first particle at which the attribute is not finite, as
                         * attribute_not_finite in mcor_surface */
  } mcor_global_component;

  /* The plane in which all particles lie, in two dimensions. */
  typedef struct mcor_plane
  {
    int axis;  /* the axis of the constant coordinate, 1 for x to 3 for z; 0: three dimensions */
    double at; /* the constant coordinate */
  } mcor_plane;

  /* What is measured over all particles. Lengths have unit L; h: the unscaled smoothing length. */
  typedef struct mcor_measure
  {
    int64_t fluid_count, solid_count;
    /* The range that the particles' scaled supports cover; along a periodic axis, the range that
     * the periodic images in use may reach. */
    double low[3], high[3];
    double x_low[3], x_high[3];      /* range of the positions of fluid particles */
    double h_min, h_max;             /* range of the smoothing lengths of fluid particles */
    double support_min, support_max; /* range of scaled support radii of particles that take part */
    double h_estimate;               /* 0: not asked for */
    int64_t lone_count;                /* lone_particles of mcor_statistics */
    double widening_min, widening_max; /* range of the factors of fluid particles; 0: there are none */
    int64_t widening_sum;            /* sum of these factors, times 2^23 */
    double h_median, neighbours, spacing, filled; /* medians, as in mcor_statistics */
    double scalar_min, scalar_max;                /* as in mcor_statistics */
    int64_t not_finite; /* the first fluid particle whose scalar is not finite; INT64_MAX: none */
    double cube;        /* cube size, or longest edge of a cube; ignored if a cube size is given */
    double edge[3];     /* edges of the cubes along x, y, z; ignored if a cube size is given */
    double wall_share;  /* the wall share, if the options ask for it; 0: not measured */
    mcor_plane plane;
    double plane_normal[3], plane_extent; /* as in mcor_statistics */
    int64_t far_count, far_first;         /* far_particles and far_first of mcor_statistics */
    double far_place[3];
    int
      cut; /* nonzero: a lattice around all particles would be too large, so it surrounds only the
            * box or the points */
    double cut_high[3]; /* if cut, where the box or points end; `high` lies beyond */
  } mcor_measure;

  /* Facts about all particles. A call that has only some of the particles needs these facts to make
   * the part of the surface in its box. */
  struct mcor_globals
  {
    mcor_measure measured;
    double mass_max; /* 0: there are no masses */
    double
      scalar_shift; /* about the median of the scalar; values on the device are relative to it */
    int component_count;
    mcor_global_component* components; /* [component_count], of all attributes in their order */
    /* Adaptive cubes: keys of the bricks that are divided, ascending; NULL: one level only. */
    int64_t split_count;
    uint64_t* splits; /* [split_count] */
  };

  typedef enum mcor_reduction
  {
    MCOR_LEAST = 0,
    MCOR_GREATEST = 1,
    MCOR_SUM_OF = 2 /* whole numbers, or others whose sum is exact in any order */
  } mcor_reduction;

  /* Ranks: processes, or threads with a context each, that share an input. All of them call the
   * same function of this library with the same options, except for the box, and with input of
   * the same form. All get the same sequence of callbacks. A callback that does not return 0,
   * because another rank failed, ends the call with MCOR_CANCELLED. A rank whose own call fails
   * makes no further callbacks; the callbacks of the other ranks must then return nonzero. */
  struct mcor_ranks
  {
    /* values: [count]; each is replaced by its reduction over all ranks. */
    int (*reduce_doubles)(void* user, mcor_reduction reduction, double* values, int count);
    int (*reduce_counts)(void* user, mcor_reduction reduction, int64_t* values, int count);
    /* Collects the records of all ranks, this one included, in any order; the result is valid
     * until the next callback. count: this rank's records, 0 or more; width: bytes of a record. */
    int (*gather)(void* user, const void* records, int64_t count, size_t width, const void** all,
      int64_t* all_count);
    void* user;
    /* The box of the whole surface, as mcor_options.box; each rank's box is a part of it. All 0:
     * only periods bound the surface. If several ranks have a vertex, one rank's statistics count
     * it. */
    double whole_box[6];
  };

  /* Does what mcor_create_context does, for one of `count` processes or threads that run side by
   * side on a machine. place: its number, from 0. Unless a number names the device, the processes
   * take turns among all devices that have the platform and kind of mcor_create_context's device.
   * If processes use the same CPU device, each has some of the processors. Results do not depend on
   * which device or processors a process gets. */
  mcor_status mcor_create_shared_context(
    const char* device, int place, int count, mcor_context** context);

  /* Moves the bounds of each period that does not hold the box (with ranks, whole_box), so that the
   * box lies in the middle. A period shorter than the box stays. mcor_extract does this by itself
   * unless globals are given; globals must be measured with the moved period. */
  void mcor_move_period(mcor_options* options);

  /* Measures an input. Later calls, in this or another context, get the result as options.globals;
   * their other options must be the same as here. Overwrites *globals; free it with
   * mcor_free_globals. Fails with MCOR_INVALID_DATA if no rank has any particles. */
  mcor_status mcor_measure_globals(mcor_context* context, const mcor_input* input,
    const mcor_options* options, mcor_globals* globals);
  void mcor_free_globals(mcor_globals* globals);
  /* Returns a distance, unit L. A box needs the particles whose supports miss the box by no more
   * than this distance; see mcor_options.globals. smoothing_length: of the particle, unscaled. */
  double mcor_reach_margin(
    const mcor_options* options, const mcor_globals* globals, double smoothing_length);
  /* Particles whose supports meet a box may depend on neighbours whose supports do not. Returns a
   * distance: all particles up to this far from the box are needed, however short their supports
   * are; 0: no such neighbours are needed. All lengths have the same unit. computes_volumes: if the
   * call computes volumes; widest: options.widen for mcor_widen, 0 for other calls; reach: the
   * greatest distance from the box of a particle whose support meets the box, 0 if there is none;
   * margin: at least two cubes, because particles and the box are rounded. */
  double mcor_reach_around(const mcor_options* options, int computes_volumes, double widest,
    double reach, double margin);

  /* Area and volume of a surface in parts, with the same bits as in the whole surface's statistics.
   * The marks 1 and 2 tell when a member is reduced over all parts, see mcor_measure_terms. */
  typedef struct mcor_measures
  {
    double origin[3];       /* any point; for the same bits, the first one of the whole surface */
    int64_t triangle_count; /* 1: reduce by the sum */
    double area_most, volume_most; /* 1: reduce by the greatest */
    double area, volume;           /* 2: reduce by the sum, which is exact in any order */
    int64_t open;                  /* 2: reduce by the sum, which may wrap around; 0: closed */
  } mcor_measures;

  /* Call mcor_measure_terms for each part, reduce the measures marked 1 over all parts, call
   * mcor_measure_sums for each part, reduce the measures marked 2, and call mcor_keep_measures.
   * numbers: [point_count], the points' numbers in the whole surface; NULL: their indices. */
  void mcor_measure_terms(const mcor_surface* surface, mcor_measures* measures);
  void mcor_measure_sums(
    const mcor_surface* surface, const int64_t* numbers, mcor_measures* measures);
  void mcor_keep_measures(const mcor_measures* measures, mcor_statistics* statistics);

  /* Does what mcor_measure_globals does, for mcor_probe, mcor_derive and mcor_project. */
  mcor_status mcor_measure_probe_globals(mcor_context* context, const mcor_input* input,
    const mcor_options* options, mcor_globals* globals);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif

#endif
