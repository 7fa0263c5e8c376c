/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_flux_h
#define mcor_flux_h

/* Flow through sections. A section consists of patches. A patch is the image of parameters (u,
 * v) from 0 to 1; it is divided into cells, and each cell into triangles (in two dimensions a
 * patch is divided into lines). These triangles and lines are called pieces. Pieces are cut
 * where the fluid ends, integrated, and divided until their integrals no longer change. */

#include "mcor_gauge.h"

/* Longest side of a cell, in smallest scaled smoothing lengths. */
#define MCOR_FLUX_CELL 0.75

/* Integrals of a section: of 1, v . n and rho v . n. */
#define MCOR_FLUX_SUMS 3

typedef enum mcor_patch_shape
{
  MCOR_PATCH_RECTANGLE,
  MCOR_PATCH_TRIANGLE, /* u + v <= 1 */
  MCOR_PATCH_QUARTER,  /* a quarter of a disc: at u radii, from `along` to `across` as v grows */
  MCOR_PATCH_LINE      /* uses u alone */
} mcor_patch_shape;

typedef struct mcor_patch
{
  mcor_patch_shape shape;
  int64_t section;
  double corner[3], along[3], across[3]; /* start and edges, in the device's coordinates */
  double normal[3]; /* one entry for each component of the velocity, unit length */
  double measure;   /* area or length for a unit of parameters; of a quarter: at u = 1, v = 0 */
  double counts[2]; /* cells along u and v: whole numbers */
} mcor_patch;

/* Results of a section. Sums are whole numbers of units, so their order does not matter. */
typedef struct mcor_flux_section
{
  double area;           /* of the whole section, with and without fluid */
  int64_t reached;       /* 1: particles reach the section */
  double speed, density; /* the greatest speed and density seen, or the job's floors if these are
                          * greater */
  double unit[MCOR_FLUX_SUMS];
  int64_t sum[MCOR_FLUX_SUMS];
} mcor_flux_section;

/* A triangle or line in the parameters of a patch. */
typedef struct mcor_flux_piece
{
  int64_t patch;
  int64_t whole;       /* for the part of a cut piece that is in fluid: the number of the cut piece */
  int depth;           /* how often the cell's piece was divided to make this one */
  bool unclear;        /* the level may cross it in a way that its corners do not show */
  double corner[3][2]; /* u, v */
  double area;         /* area of the cell's first piece */
  double sum[MCOR_FLUX_SUMS]; /* integrals over the part in fluid */
} mcor_flux_piece;

typedef MCOR_LIST(mcor_flux_piece) mcor_flux_pieces;

typedef struct mcor_flux_cell
{
  int64_t patch, u, v;
} mcor_flux_cell;

/* A piece with corners on both sides of the level. */
typedef struct mcor_flux_cut
{
  int64_t piece;
  int sides; /* bits of the corners in fluid */
  /* In a triangle: crossings on the edges from its lone corner to the next and to the last one. */
  double crossing[2][2];
} mcor_flux_cut;

/* What differs between triangles and lines. Samples of a piece are its corners, the middles of its
 * edges, and the middle. */
#define MCOR_FLUX_POINTS 7
typedef struct mcor_flux_form
{
  int corners, points, parts;     /* how many corners, samples, and parts a piece has */
  double share[MCOR_FLUX_POINTS]; /* weight of each sample in an integral */
  int part[4][3];                 /* the samples that are the corners of each part */
} mcor_flux_form;

/* Samples of a batch. */
typedef struct mcor_flux_field
{
  double (*at)[3]; /* Where each sample is: u, v, patch number. The arrays below use the same index. */
  double *weight, *velocity, *density;
  double* values[2]; /* velocity and density, as the probe takes them */
} mcor_flux_field;

typedef struct mcor_flux_job
{
  mcor_gauge_job edges; /* must be first; finds crossings on edges of pieces, and its run evaluates
                         * the field */
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
  mcor_flux_section* found; /* [section_count] */
  MCOR_LIST(mcor_patch) patches;
  MCOR_LIST(mcor_flux_cell) cells;
  mcor_findings around; /* ranges along x, y, z that hold all patches */
  /* Work space: pieces, their parts, and the parts of cut pieces that lie in fluid; cuts; the lines
   * that the level crosses, in parameters, one for each of the changed parts of `edges`. */
  mcor_flux_field field;
  mcor_flux_pieces pieces, parts, inside;
  MCOR_LIST(mcor_flux_cut) cuts;
  MCOR_LIST(mcor_gauge_line) lines;
} mcor_flux_job;

/* mcor_flux_patch.c. Checks a section and appends its patches. */
mcor_status mcor_add_section(mcor_flux_job* job, int64_t number);
/* Maps parameters (u, v, number of the patch) to a point. */
void mcor_map_patch(const void* job, const double parameters[3], double point[3]);
/* Returns the area for a unit of parameters at (u, v). */
double mcor_patch_measure(const mcor_patch* patch, const double uv[2]);
/* Lists the cells that this call owns and that particles may reach. The lattice must be known. */
mcor_status mcor_list_flux_cells(mcor_flux_job* job);

/* mcor_flux_piece.c */
extern const mcor_flux_form mcor_flux_forms[2]; /* for triangles, for lines */
/* Evaluates the field at samples [0, count). */
mcor_status mcor_sample_flux(mcor_flux_job* job, int count);
double mcor_speed_along(const mcor_flux_job* job, int64_t sample, const double direction[3]);
/* Finds sample k of a piece. */
void mcor_place_point(const mcor_flux_job* job, const mcor_flux_piece* piece, int k, double at[3]);
/* Integrates pieces. */
mcor_status mcor_measure_pieces(mcor_flux_job* job, mcor_flux_pieces* pieces);

#endif
