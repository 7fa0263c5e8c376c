/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_project_h
#define mcor_project_h

/* The image of a projection, and the particles that are spread over it. */

#include "mcor_column.h"
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_vector.h"

/* A particle, or a periodic image of it, in the pixels of the call. */
typedef struct mcor_splat
{
  double at[2];          /* from the corner, in pixels */
  double pixel[2];       /* side of a pixel, in h */
  double amount[2];      /* V A, or V B A and V B */
  int first[2], last[2]; /* pixels that it reaches */
} mcor_splat;

/* Work space of one thread that spreads particles. */
typedef struct mcor_brush
{
  mcor_column_side* sides;
  double* corners[2]; /* at the row's lower and upper side */
} mcor_brush;

typedef struct mcor_project_job
{
  mcor_context* context;
  const mcor_input* input;
  const mcor_view* view;
  mcor_projection* out;
  double axes[3][3]; /* out->axes, turned as the particles are */
  bool is_aligned;   /* the axes are along those of the particles */
  bool places_only;  /* no values are wanted */
  double box[6];     /* turned; sides that are not given are infinite */
  double period[3];  /* 0: open */
  double* volumes;   /* computed volumes; else NULL */
  double h_scale;
  mcor_column column;
  int channels; /* 2: a mean */
  /* [channel]: 3/2 of a power of 2, which rounds what is added to it; coarse, fine. */
  double unit[2][2];
  double* sums; /* [channels][2][pixels]: multiples of the coarse and of the fine unit */
  int64_t* splats_before; /* [blocks + 1] */
  int64_t first_block;    /* first of the blocks spread together */
  mcor_splat* splats;
  int bands, first_row[MCOR_SLICES + 1], *band_of_row;
  int64_t* listed; /* indices of the splats that reach each band */
  int64_t first_listed[MCOR_SLICES + 1];
  mcor_brush brushes[MCOR_SLICES];
  mcor_findings slices[MCOR_SLICES];
} mcor_project_job;

/* The particles of a chunk that count. */
typedef struct mcor_project_chunk
{
  int count;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK], amount[2][MCOR_CHUNK];
  int64_t source[MCOR_CHUNK];
} mcor_project_chunk;

/* Whether the column density is wanted: of the mass, or of V times density. */
static inline bool mcor_projects_density(const mcor_input* input)
{
  return !input->scalar.data;
}

/* mcor_project_spread.c. Reads at most MCOR_CHUNK particles, with or without amounts. */
void mcor_read_project_chunk(
  const mcor_project_job* job, int64_t first, int count, bool amounts, mcor_project_chunk* chunk);
/* Spreads all particles over the image, whose sides are known, in steps of a call. */
mcor_status mcor_spread_particles(mcor_project_job* job);
void mcor_release_spread(mcor_project_job* job);

#endif
