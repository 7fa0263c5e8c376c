/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_gauge_h
#define mcor_gauge_h

/* Lines whose crossings with the level are sought. Places on a line are numbers from 0 to 1. */

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

/* Samples of a line: at i / steps for first <= i <= last; no particle reaches the rest. */
typedef struct mcor_gauge_samples
{
  int64_t line, steps, first, last;
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

/* A call that measures where fluid is, as gauges and fluxes do. */
typedef struct mcor_level_job
{
  mcor_context* context;
  const char* who; /* subject of the error sentence about the level */
  mcor_body body;  /* is called with a pointer to this job */
  double level;
  bool has_box;
  double box[6];       /* the box of what this call owns, in the call's coordinates */
  double owned[3][2];  /* the box's cells along x, y, z */
  mcor_probe_run* run; /* evaluates the field */
  double* with_solids; /* [MCOR_GAUGE_BATCH], weight sums of fluid and solids; NULL: no solids */
} mcor_level_job;

/* A call under way: its arguments, then its results. */
typedef struct mcor_gauge_job
{
  mcor_level_job base;          /* must be first */
  const mcor_gauge_line* given; /* [line_count] */
  mcor_gauge_line* lines;       /* [line_count] `given`, in the device's coordinates */
  int64_t line_count;
  mcor_gauges* gauges;
  mcor_findings around; /* ranges along x, y, z that hold all lines */
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

/* mcor_gauge.c. Shared by gauges and fluxes. Sets the level and the box, and runs the job's body. */
mcor_status mcor_call_level(mcor_level_job* job, const mcor_input* input,
  const mcor_options* options, mcor_statistics* statistics);
/* Turns the job's box into the plane. Sets the box in which the field is evaluated: the job's box
 * and `margin` around it, or, if the job has no box, the ranges `around`. */
mcor_status mcor_bound_level(mcor_level_job* job, const mcor_input* input,
  const mcor_options* options, double margin, const mcor_findings* around);
/* Loads the attributes, prepares the job's run for MCOR_GAUGE_BATCH points at a time, and calls
 * `work`. */
mcor_status mcor_run_points(
  mcor_level_job* job, const mcor_input* input, mcor_status (*work)(mcor_level_job*));
/* Evaluates the run's first `count` points. weight: takes the weight sums of the fluid, lowered
 * near solids so that they fall below the level where the fluid ends at them. */
mcor_status mcor_sample_level(mcor_level_job* job, double* weight, int count);
mcor_gauge_label mcor_label_gauge(const char* name, int64_t number);
/* Whether a point is in a cell that this call owns. */
bool mcor_owns_point(const mcor_level_job* job, const double point[3]);

/* mcor_gauge_solve.c. Evaluates entries [first, last) of the job's samples, and appends the
 * results to its records. */
mcor_status mcor_gauge_samples_of(mcor_gauge_job* job, int64_t first, int64_t last);
void mcor_free_gauge_parts(mcor_gauge_job* job);

#endif
