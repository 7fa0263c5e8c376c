/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_level_h
#define mcor_level_h

/* Functions for gauges and fluxes, which find the fluid from weight sums at points: there is fluid
 * where the weight sum is at least a level. */

#include "mcor_probe.h"

/* The most points that are on the device at a time. */
#define MCOR_LEVEL_BATCH (1 << 18)

typedef struct mcor_level_job
{
  mcor_context* context;
  double level;
  mcor_findings around; /* ranges along x, y, z that hold all gauges or sections */
  bool has_box;
  double box[6];       /* the box that this call owns, in the call's coordinates */
  double owned[3][2];  /* the box's cells along x, y, z */
  mcor_probe_run* run; /* evaluates the field */
  double* with_solids; /* [MCOR_LEVEL_BATCH], weight sums of fluid and solids; NULL: no solids */
} mcor_level_job;

/* A gauge or section in messages: its name in quotes, or its number. */
typedef struct mcor_label
{
  char text[80];
} mcor_label;

mcor_label mcor_label_of(const char* name, int64_t number);
/* Sets the level and the box, and runs `body` with `job`. who: the subject of the error sentence
 * about the level. */
mcor_status mcor_call_level(mcor_level_job* job, const mcor_input* input,
  const mcor_options* options, const char* who, mcor_body body, mcor_statistics* statistics);
/* Makes the search grid. If it has particles, prepares the job's run, and calls `work`. The field
 * is evaluated in the job's box and `margin` (unit L) around it or, if there is no box, in the
 * ranges `around`. */
mcor_status mcor_run_level(mcor_level_job* job, const mcor_input* input,
  const mcor_options* options, double margin, mcor_status (*work)(mcor_level_job*));
/* Evaluates the run's first `count` points, and writes the fluid's weight sums to `weight`. Near
 * solids the sums are lowered: where the solids' share of the weight is so large that there is no
 * fluid, the lowered sum is below job->level. */
mcor_status mcor_sample_level(mcor_level_job* job, double* weight, int count);
/* Whether a point is in a cell that this call owns. Without a box, the call owns all points. */
bool mcor_owns_point(const mcor_level_job* job, const double point[3]);

#endif
