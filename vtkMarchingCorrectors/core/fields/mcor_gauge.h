/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_gauge_h
#define mcor_gauge_h

/* Lines whose crossings with the level are sought. Places on a line are numbers from 0 to 1.
 * Fluxes (mcor_flux.h) use lines along the edges of a section's triangles. */

#include "mcor_input.h"
#include "mcor_probe.h"

/* A part of a line between two places at which the weight sum is known. */
typedef struct mcor_gauge_part
{
  int64_t line;
  double low, high;
  double low_weight, high_weight;
} mcor_gauge_part;

typedef MCOR_LIST(mcor_gauge_part) mcor_gauge_parts;

/* Samples of a line, or of a part of one: at i / steps for first <= i <= last; no particle
 * reaches the rest. This call owns samples own_first to own_last: the extrema at them, and the
 * crossings between each and the next sample. */
typedef struct mcor_gauge_samples
{
  int64_t line, steps, first, last, own_first, own_last;
  int64_t begin; /* first sample of the whole line */
} mcor_gauge_samples;

/* A place on a line. A record's place is a crossing or, below 0, one of these facts. */
#define MCOR_GAUGE_REACHED (-1.0) /* a particle reaches the line */
#define MCOR_GAUGE_ENDS_IN (-2.0) /* the line ends in fluid */
typedef struct mcor_gauge_place
{
  int64_t line;
  double place;
} mcor_gauge_place;

typedef MCOR_LIST(mcor_gauge_place) mcor_gauge_places;

/* A call under way: its arguments, then its results. */
typedef struct mcor_gauge_job
{
  mcor_context* context;
  const mcor_gauge_line* lines; /* [line_count] */
  int64_t line_count;
  double level;
  const double* box; /* [6], box of the samples that this call owns; NULL: all */
  mcor_gauges* gauges;
  mcor_probe_run* run; /* evaluates the field */
  double* with_solids; /* [MCOR_GAUGE_BATCH], weight sums of fluid and solids; NULL: no solids */
  /* Turns parameters into points if lines are given in parameters; NULL: lines are given in
   * points. */
  void (*map)(const void* data, const double parameters[3], double point[3]);
  const void* map_data;
  MCOR_LIST(mcor_gauge_samples) samples;
  mcor_gauge_places records;
  mcor_gauge_parts changed;  /* parts whose ends are on different sides of the level */
  mcor_gauge_parts suspects; /* parts with an extremum that may be beyond the level */
  /* Work space: parts that are divided; where the field is evaluated; the weight sums there. */
  mcor_gauge_parts divided;
  mcor_gauge_places inner;
  double* weights;
} mcor_gauge_job;

/* Points that are on the device at a time. */
#define MCOR_GAUGE_BATCH (1 << 18)

/* A gauge or section in messages: its name in quotes, or its number. */
typedef struct mcor_gauge_label
{
  char text[80];
} mcor_gauge_label;

/* mcor_gauge.c. Shared by gauges and fluxes. Derives the options of the call in `own`, and the
 * level, which it checks; moves the box, if there is one, out of `own` to *box. who: subject of the
 * error sentence. */
mcor_status mcor_begin_level(mcor_context* context, const mcor_options* options, const char* who,
  mcor_input* input, mcor_options* own, double* level, const double** box);
/* Sets the box in which the field is evaluated: the ranges `around`, or, if ranks share the work,
 * the caller's box and `margin` around it. */
mcor_status mcor_bound_level(mcor_context* context, const mcor_input* input,
  const mcor_options* options, const double* box, double margin, const mcor_findings* around);
/* Loads the attributes, prepares the job's run for MCOR_GAUGE_BATCH points at a time, and calls
 * `work`. */
mcor_status mcor_run_points(
  mcor_gauge_job* job, const mcor_input* input, mcor_status (*work)(mcor_gauge_job*));
/* Evaluates the run's first `count` points. weight: takes the weight sums of the fluid, lowered
 * near solids so that they fall below the level where the fluid ends at them. */
mcor_status mcor_sample_level(mcor_gauge_job* job, double* weight, int count);
mcor_gauge_label mcor_label_gauge(const char* name, int64_t number);
/* mcor_own_cells finds the cells of a box along x, y, z; mcor_owns_point tells whether a point is
 * in one of them. */
void mcor_own_cells(const mcor_context* context, const double* box, double cells[3][2]);
bool mcor_owns_point(const mcor_context* context, const double point[3], double cells[3][2]);

/* mcor_gauge_solve.c. Evaluates entries [first, last) of the job's samples, and appends the
 * results to its records. */
mcor_status mcor_gauge_samples_of(mcor_gauge_job* job, int64_t first, int64_t last);
/* Shortens the job's changed parts until their crossings are known. one: each part keeps only its
 * first crossing; otherwise it keeps all crossings that the first round finds. */
mcor_status mcor_solve_crossings(mcor_gauge_job* job, int rounds, bool one);
/* Returns the place on a changed part where the weight sum equals the level. */
double mcor_crossing_of(const mcor_gauge_job* job, const mcor_gauge_part* part);
void mcor_free_gauge_parts(mcor_gauge_job* job);

#endif
