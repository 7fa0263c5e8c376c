/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_parts_h
#define mcor_parts_h

/* A surface in parts: boxes of it, each made of the particles near it alone, by one process after the
 * other or by several that work together. See mcor_options.box, .globals and .ranks. */

#include "mcor.h"

#ifdef __cplusplus
extern "C"
{
#endif

  /* Of one component of an attribute; of particles that are not solid. */
  typedef struct mcor_global_component
  {
    double largest;     /* absolute value */
    double low, high;   /* least and greatest value; of no fluid low > high */
    int varies;         /* 0: all values are the same, those of solids too */
    int64_t not_finite; /* of its attribute, as attribute_not_finite in mcor_surface */
  } mcor_global_component;

  /* What must be known of all particles to extract a box's surface from some of them. */
  struct mcor_globals
  {
    int64_t fluid_particles, solid_particles;
    double low[3], high[3];                            /* of positions -+ scaled support radii, L */
    double smoothing_length_min, smoothing_length_max; /* of fluid particles, unscaled, L */
    double support_min, support_max; /* scaled support radius of all that take part, L */
    double smoothing_length;         /* estimated; 0: it was not asked for */
    double cube_size;                /* as in mcor_statistics; not read */
    double mass_max;                 /* 0: there are no masses */
    double scalar_min, scalar_max;   /* over fluid particles */
    double scalar_shift;             /* about the median; values on the device are relative to it */
    /* As in mcor_statistics; and the positions of fluid particles, L. */
    double smoothing_length_median, neighbours_median, spacing_median, filled_median;
    double fluid_low[3], fluid_high[3];
    double wall_share; /* where the options ask for it */
    int component_count;
    mcor_global_component* components; /* [component_count], of all attributes in their order */
    /* Adaptive cubes: which bricks of the lattice are divided, ascending numbers; NULL: of one level. */
    int64_t split_count;
    uint64_t* splits; /* [split_count] */
  };

  typedef enum mcor_reduction
  {
    MCOR_LEAST = 0,
    MCOR_GREATEST = 1,
    MCOR_SUM_OF = 2 /* of counts alone: exact in any order */
  } mcor_reduction;

  /* Ranks: processes, or threads with contexts of their own, that hold an input together. All of them
   * call the same function of this library with the same options, but for the box, and the same form of
   * input, and are called back equally often, in the same order. A return that is not 0, as when
   * another rank gave up, ends the call with MCOR_CANCELLED. A rank whose own call fails calls back no
   * more: the others must then be told so by theirs. */
  struct mcor_ranks
  {
    /* values: [count]; each becomes that over all ranks. */
    int (*reduce_doubles)(void* user, mcor_reduction reduction, double* values, int count);
    int (*reduce_counts)(void* user, mcor_reduction reduction, int64_t* values, int count);
    /* The records, of `width` bytes, of all ranks, this one's too, in any order; valid until one of
     * these is called again. count: of this rank's, 0 or more. */
    int (*gather)(void* user, const void* records, int64_t count, size_t width, const void** all,
      int64_t* all_count);
    void* user;
    /* The same of records that matter near their places alone, [count][3] in L: of all ranks' records at
     * least those within `reach` of this rank's box, along each axis, or of images of it; those of this
     * rank, too. May be NULL: gather is called instead. */
    int (*pass)(void* user, const void* records, int64_t count, size_t width, const double* places,
      double reach, const void** all, int64_t* all_count);
    /* The box that the boxes of all ranks are parts of, as mcor_options.box; all 0: it has no end but that
     * of a period. Vertices that several ranks have are counted by one of them. */
    double whole_box[6];
  };

  /* The same for one of `count` processes, or threads, of a machine that run side by side: number
   * `place` of them, from 0. Where no device is asked for they take, in turn, those of the default
   * one's platform and kind; each of those that have a CPU in common takes its share of the processors.
   * The result does not depend on it. */
  mcor_status mcor_create_shared_context(
    const char* device, int place, int count, mcor_context** context);

  /* Measures an input for options.globals of later calls, in this or other contexts, with the same
   * options otherwise. *globals is overwritten; free with mcor_free_globals. Where there are no
   * particles, in all ranks, that is MCOR_INVALID_DATA. */
  mcor_status mcor_measure_globals(mcor_context* context, const mcor_input* input,
    const mcor_options* options, mcor_globals* globals);
  void mcor_free_globals(mcor_globals* globals);
  /* By how much the support of a particle may miss a box, L, and the particle yet be needed there: see
   * mcor_options.globals. */
  double mcor_reach_margin(
    const mcor_options* options, const mcor_globals* globals, double smoothing_length);

  /* The same for calls of mcor_probe and mcor_derive. */
  mcor_status mcor_measure_probe_globals(mcor_context* context, const mcor_input* input,
    const mcor_options* options, mcor_globals* globals);

#ifdef __cplusplus
}
#endif

#endif
