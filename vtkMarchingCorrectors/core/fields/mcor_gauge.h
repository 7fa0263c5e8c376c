/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_gauge_h
#define mcor_gauge_h

/* Lines on which the level's crossings are sought. Places on a line are numbers from 0 to 1. */

#include "mcor_internal.h"

/* Weight sums at places of lines; `places` and `line` have `count` elements. */
typedef struct mcor_gauge_job mcor_gauge_job;
typedef mcor_status (*mcor_gauge_evaluate)(
  mcor_gauge_job* job, int64_t count, const int64_t* line, const double* place, double* weight);

/* A part of a line between two places where the weight sum is known. */
typedef struct mcor_gauge_part
{
  int64_t line;
  double low, high;
  double low_weight, high_weight;
} mcor_gauge_part;

typedef struct mcor_gauge_parts
{
  mcor_gauge_part* parts; /* [capacity] */
  int64_t count, capacity;
} mcor_gauge_parts;

/* How a line is sampled: at i / steps, for first <= i <= last; no particle reaches the rest. */
typedef struct mcor_gauge_samples
{
  int64_t steps, first, last;
} mcor_gauge_samples;

struct mcor_gauge_job
{
  mcor_context* context;
  mcor_gauge_evaluate evaluate;
  void* data; /* of evaluate */
  double level;
  const mcor_gauge_line* lines;
  mcor_gauge_samples* samples; /* [line count] */
  mcor_gauges* gauges;
  double* ends;              /* [line count]: weight sums at the lines' ends */
  mcor_gauge_parts changed;  /* on unlike sides of the level at their ends */
  mcor_gauge_parts suspects; /* with an extremum inside that may be beyond the level */
};

/* mcor_gauge_solve.c. Samples lines [first, last), and appends their crossings to the results. */
mcor_status mcor_gauge_lines(mcor_gauge_job* job, int64_t first, int64_t last);
void mcor_free_gauge_parts(mcor_gauge_job* job);

#endif
