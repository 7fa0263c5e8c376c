/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_flux_h
#define mcor_flux_h

/* Flow through sections. A section is made of patches, each the image of parameters (u, v) from 0 to 1; a patch is
 * divided into cells, cells into triangles (in two dimensions, a patch into lines), which are pieces. Pieces are
 * integrated, cut where the fluid ends, and divided until their integrals no longer change. */

#include "mcor_gauge.h"

/* The longest side of a cell, in smallest scaled smoothing lengths. */
#define MCOR_FLUX_CELL 0.75

/* What is integrated: 1, v . n, rho v . n. */
#define MCOR_FLUX_SUMS 3

typedef enum mcor_patch_shape
{
  MCOR_PATCH_RECTANGLE,
  MCOR_PATCH_TRIANGLE, /* u + v <= 1 */
  MCOR_PATCH_QUARTER,  /* of a disc: at u times its radius; `along` turns to `across` as v grows */
  MCOR_PATCH_LINE      /* of u alone */
} mcor_patch_shape;

typedef struct mcor_patch
{
  mcor_patch_shape shape;
  int64_t section;
  double corner[3], along[3],
    across[3];      /* where it begins, and its edges; as the device has coordinates */
  double normal[3]; /* by component of the velocity, unit length */
  double measure;   /* area or length for a unit of parameters; of a quarter at u = 1, v = 0 */
  double counts[2]; /* cells along u and v: whole numbers */
} mcor_patch;

/* What a section has been found to have. Sums are whole numbers of units, so that their order does not matter. */
typedef struct mcor_flux_section
{
  double area;           /* of all of it */
  int64_t reached;       /* 1: particles reach it */
  double speed, density; /* greatest ones seen in it, with the least that matter */
  double unit[MCOR_FLUX_SUMS];
  int64_t sum[MCOR_FLUX_SUMS];
} mcor_flux_section;

/* A triangle or line in the parameters of a patch. */
typedef struct mcor_flux_piece
{
  int64_t patch;
  int depth;           /* how often its cell's was divided */
  bool unclear;        /* the field between its corners is not on the sides that these tell */
  double corner[3][2]; /* u, v */
  double area;         /* of the piece of the cell */
  double factor;       /* by which it counts; 1 but for bulges, see mcor_append_bulge */
  double bulge;        /* area between the level and its chord */
  double sum[MCOR_FLUX_SUMS]; /* of its part in fluid */
} mcor_flux_piece;

typedef struct mcor_flux_pieces
{
  mcor_flux_piece* pieces; /* [room] */
  int64_t count, room;
} mcor_flux_pieces;

typedef struct mcor_flux_cell
{
  int64_t patch, u, v;
} mcor_flux_cell;

typedef struct mcor_flux_job
{
  mcor_gauge_job edges; /* first; crossings on the edges of pieces, and the run that evaluates */
  const mcor_section* sections;
  int64_t section_count;
  bool is_plane;
  int velocity_components; /* of the input's first attribute */
  bool has_density;
  double smoothing_length; /* the smallest scaled one */
  double speed_floor, density_floor;
  mcor_flux_section* found; /* [section_count] */
  mcor_patch* patches;      /* [patch_room] */
  int64_t patch_count, patch_room;
  mcor_flux_cell* cells; /* [cell_room] */
  int64_t cell_count, cell_room;
  double low[3], high[3]; /* around all patches */
} mcor_flux_job;

/* mcor_flux_patch.c. Checks a section, and appends its patches. */
mcor_status mcor_add_section(mcor_flux_job* job, int64_t number);
/* mcor_flux_closed.c. -1 if the triangles are a closed surface with normals inwards; else 1. */
mcor_status mcor_orient_triangles(
  mcor_context* context, const double* points, int64_t point_count, double* sign);
/* The point that parameters are of; its patch is the third of them. */
void mcor_map_patch(const void* job, const double parameters[3], double point[3]);
/* Area for a unit of parameters there. */
double mcor_patch_measure(const mcor_patch* patch, const double uv[2]);
/* Lists the cells that particles may reach, of those that this call owns; the lattice is known. */
mcor_status mcor_list_flux_cells(mcor_flux_job* job);

#define MCOR_FLUX_POINTS 7 /* of a triangle; of a line 3 */

/* Samples of one batch. */
typedef struct mcor_flux_field
{
  double (*at)[3]; /* [MCOR_GAUGE_BATCH], parameters and patch */
  double *weight, *velocity, *density;
  double* values[2]; /* of the attributes: the last two */
} mcor_flux_field;

/* Points of a piece at which it is sampled; the first of them are its corners. */
static inline int mcor_piece_points(const mcor_flux_job* job)
{
  return job->is_plane ? 3 : MCOR_FLUX_POINTS;
}

static inline int mcor_piece_corners(const mcor_flux_job* job)
{
  return job->is_plane ? 2 : 3;
}

/* mcor_flux_piece.c. Evaluates samples at places [0, count) of the field. */
mcor_status mcor_sample_flux(mcor_flux_job* job, mcor_flux_field* field, int count);
double mcor_speed_along(const mcor_flux_job* job, const mcor_flux_field* field, int64_t sample,
  const double direction[3]);
/* Point k of a piece: its corners, the middles of its edges, its middle. */
void mcor_place_point(const mcor_flux_job* job, const mcor_flux_piece* piece, int k, double at[3]);
/* Finds the integrals of pieces. */
mcor_status mcor_measure_pieces(
  mcor_flux_job* job, mcor_flux_field* field, mcor_flux_pieces* pieces);

/* mcor_flux_divide.c. Adds up all cells; a rank without any scales the sections alone, as all do. */
mcor_status mcor_add_fluxes(mcor_gauge_job* job);
mcor_status mcor_scale_sections(mcor_flux_job* job);

#endif
