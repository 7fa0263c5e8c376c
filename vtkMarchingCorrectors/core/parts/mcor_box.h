/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_box_h
#define mcor_box_h

/* What the phases of a call do because of the call's box, see mcor_box.c. If the call owns the
 * whole lattice, no cell and no particle is left out. */

#include "mcor_internal.h"

/* mcor_lattice.c. Lays the virtual grid over all that the particles' supports reach. */
mcor_status mcor_measure_lattice(mcor_context* context, const mcor_options* options);

/* Finds the cells of the box along an axis, [side[0], side[1]). sides NULL: there is no box; finds
 * all cells of the period or of the lattice. */
void mcor_place_sides(const mcor_lattice* lattice, int axis, const double* sides, double side[2]);

/* Finds the cells that the call owns. The lattice must be known. */
void mcor_place_box(mcor_context* context, const mcor_options* options);

/* The box near which particles, or their images whole periods away, are needed. Lengths are in
 * cubes, positions from the lattice's origin. */
typedef struct mcor_reach_box
{
  double low[3], high[3];     /* where the field is evaluated */
  double support;             /* support radius in cubes / smoothing length in unit L */
  double radius;              /* a smaller support radius counts as this; set later */
  double unit;                /* 2^-fix_bits */
  int top, ring;              /* top: highest level of adaptive cubes */
  double period[3], first[3]; /* period: its length, or 0; first: where a period begins */
  int fix_bits;
  bool is_empty; /* no particle is needed */
} mcor_reach_box;

/* Images of a particle: along each axis, from `first` to `last` periods away from the particle's
 * place in the first period. */
typedef struct mcor_images
{
  int first[3], last[3];
} mcor_images;

/* Returns how far from the box, in cubes, a particle is still needed. length: its smoothing length,
 * unit L; level: its level of adaptive cubes. */
double mcor_reach_of(const mcor_reach_box* box, double length, int level);
/* Finds the cells [first, last) at whose particles mcor_derive and mcor_widen evaluate sums.
 * Returns false if they evaluate sums at all particles. Only one image of each particle counts: the
 * image in the period; on the period's sides, the image on the lower side or, if the box begins
 * above the lower side, the image on the upper side. */
bool mcor_bound_particles(const mcor_context* context, int first[3], int last[3]);

void mcor_find_evaluated(const mcor_context* context, double low[3], double high[3]);
/* Finds where particles are needed. Returns false if they are needed everywhere. */
bool mcor_find_reach(const mcor_context* context, mcor_reach_box* reach);
/* Returns the position `fixed`, in fixed-point units. With a period, the position is rounded as on
 * the device, and moved into the first period. */
double mcor_wrap(const mcor_reach_box* box, int axis, double fixed);
/* Finds the needed images of a particle; returns their number. at, support: in cubes. */
int mcor_list_images(
  const mcor_reach_box* box, const double at[3], double support, mcor_images* images);

/* Kernel arguments of MCOR_SIDES_PARAMS: x0, y0, z0, x1, y1, z1, in halves of a cube. */
#define MCOR_SIDES_ARGS(sides)                                                                     \
  MCOR_INT((sides)[0]), MCOR_INT((sides)[1]), MCOR_INT((sides)[2]), MCOR_INT((sides)[3]),          \
    MCOR_INT((sides)[4]), MCOR_INT((sides)[5])

/* Kernel arguments of MCOR_BOX_PARAMS: the cells [first, last), and `ring` cells around them. An
 * endless ring has all cells of the lattice. */
#define MCOR_ENDLESS_RING (1 << 29)
#define MCOR_CELL_ARGS(first, last, ring)                                                          \
  MCOR_INT((first)[0] - (ring)), MCOR_INT((first)[1] - (ring)), MCOR_INT((first)[2] - (ring)),     \
    MCOR_INT((last)[0] + (ring)), MCOR_INT((last)[1] + (ring)), MCOR_INT((last)[2] + (ring))

/* The usual box.ring: the number of cells around the owned cells that are examined, too. */
#define MCOR_BOX_RING 1
int mcor_ring_of(const mcor_options* options); /* box.ring, if there is a box */
/* Returns a distance, in cells of a particle's level. A particle is needed if its support ends at
 * most this far from the box. */
double mcor_box_slack(const mcor_options* options);
/* Returns how wide the ring is with adaptive cubes, in cells of each level. A ring of more than one
 * cell becomes twice as wide, because larger cells may lie between the ring and the box. */
static inline int mcor_level_ring(int ring)
{
  return ring <= MCOR_BOX_RING ? ring : 2 * ring;
}

/* Removes cells that are neither in the box nor in the ring around it from the masks `cells` of
 * marched bricks. Beyond the ring, particles are missing or, with a period, the surface repeats. */
mcor_status mcor_clip_near(mcor_context* context, mcor_buffer* cells);
/* mcor_find_owned finds the owned cells among `cells`; mcor_count_cells counts the owned cells that
 * are also in `within`. */
mcor_status mcor_find_owned(
  mcor_context* context, const mcor_buffer* cells, const mcor_buffer** owned);
mcor_status mcor_count_cells(
  mcor_context* context, const mcor_buffer* cells, const mcor_buffer* within, int* count);

/* mcor_triangle_cell.c. mcor_follows_cells: whether triangles keep the keys of their cells.
 * mcor_find_counted finds which vertices this call counts (MCOR_OWN). mcor_count_owned_triangles
 * counts the owned triangles among triangles [first, last). */
bool mcor_follows_cells(const mcor_context* context);
mcor_status mcor_find_counted(mcor_context* context, uint8_t** owners);
mcor_status mcor_count_owned_triangles(mcor_context* context, int first, int last, int* count);

/* Output: makes room for the keys and flags of `more` triangles of the surface. */
mcor_status mcor_extend_kept(mcor_context* context, int64_t more, mcor_surface* surface);
/* Stores a triangle's key (the iso value's number, and the key of the triangle's cell or of its
 * cap's square), and whether this call owns the triangle. */
void mcor_keep_cell(
  mcor_context* context, mcor_surface* surface, int64_t triangle, int number, uint64_t cell);
mcor_status mcor_crop_surface(
  mcor_context* context, const mcor_input* input, mcor_surface* surface);

void mcor_end_box(mcor_context* context);

#endif
