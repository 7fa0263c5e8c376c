/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_flux_h
#define mcor_flux_h

/* Flow through sections. A section is a list of pieces: triangles; in two dimensions, lines. Pieces
 * are halved until no side is longer than MCOR_FLUX_CELL smoothing lengths; such pieces are called
 * cells. Cells are halved until two ways to integrate them agree. */

#include "mcor_level.h"

/* A section has three integrals: of 1, of v . n, and of rho v . n. */
#define MCOR_FLUX_SUMS 3

typedef struct mcor_flux_piece
{
  int64_t section;
  int depth; /* 0: not yet a cell; else 1 + how often a cell was halved to make this piece */
  double corner[3][3]; /* in the device's coordinates; a line uses the first two */
  double normal[3];    /* one entry for each component of the velocity, unit length */
  double size;         /* area of a triangle, or length of a line */
  int side;            /* the longest side goes from this corner to the next one */
  double length;       /* length of the longest side */
} mcor_flux_piece;

/* Results of a section. Sums are whole numbers of units, so the order of adding does not matter. */
typedef struct mcor_flux_section
{
  double area, near; /* area of the whole section; area of its cells near particles */
  double unit[MCOR_FLUX_SUMS];
  int64_t sum[MCOR_FLUX_SUMS + 1]; /* the last one: how many pieces particles reach */
} mcor_flux_section;

/* Data that differ between triangles and lines. The first samples of a piece are its corners; the
 * last sample is its middle. */
#define MCOR_FLUX_POINTS 7
#define MCOR_FLUX_PARTS 4
typedef struct mcor_flux_form
{
  int corners, points;
  double place[MCOR_FLUX_POINTS][3]; /* where samples are: weights of the corners */
  double share[2][MCOR_FLUX_POINTS]; /* each sample's share of an integral, in both rules */
  int part[MCOR_FLUX_PARTS][3];      /* the samples that are the corners of each part */
} mcor_flux_form;

typedef struct mcor_flux_job
{
  mcor_level_job base; /* must be first */
  const mcor_section* sections;
  int64_t section_count;
  mcor_fluxes* fluxes;
  bool is_plane;
  const mcor_plane* plane;
  int across; /* the caller's axis across the plane */
  const mcor_flux_form* form;
  int velocity_components; /* components of the velocity, the input's first attribute */
  bool has_density;
  double smoothing_length; /* the smallest scaled smoothing length */
  double speed_floor, density_floor;
  mcor_flux_section* found;            /* [section_count] */
  MCOR_LIST(mcor_flux_piece) pieces;   /* the pieces of all sections */
  bool is_counting;                    /* the first pass, which only counts and measures cells */
  int64_t next;                        /* index of the next one of `pieces` in this pass */
  MCOR_LIST(mcor_flux_piece) parts;    /* halves of earlier pieces, which are treated first */
  double cells;                        /* how many cells this pass has found so far */
  mcor_flux_piece* batch;              /* pieces under way */
  double *weight, *velocity, *density; /* samples of the pieces in `batch` */
} mcor_flux_job;

/* mcor_flux_section.c. Checks a section, and appends its pieces to job->pieces. */
mcor_status mcor_add_section(mcor_flux_job* job, int64_t number);
mcor_label mcor_label_section(const mcor_flux_job* job, int64_t number);

/* mcor_flux.c. Sets the size of a piece, its longest side, and the length of this side. */
void mcor_measure_piece(const mcor_flux_job* job, mcor_flux_piece* piece);

#endif
