/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_input_h
#define mcor_input_h

/* Reading the caller's arrays as double: element by element, or a chunk of one component, which
 * compilers vectorise. */

#include "mcor_internal.h"

static inline int mcor_components(const mcor_array* array)
{
  return array->components > 0 ? array->components : 1;
}

static inline double mcor_array_at(const mcor_array* array, int64_t i, int component)
{
  const int64_t at = i * mcor_components(array) + component;
  return !array->data             ? array->constant
    : array->type == MCOR_FLOAT64 ? ((const double*)array->data)[at]
                                  : (double)((const float*)array->data)[at];
}

/* Solid particles take no part where they are ignored, nor in the free surface. */
static inline bool mcor_is_used(const mcor_context* context, const mcor_input* input, int64_t i)
{
  return !input->solid || !input->solid[i] ||
    (context->kept.uses_solids && input->solid[i] != MCOR_ABSENT);
}

/* Whether a particle counts as a neighbour, and where dimensions are found: solids that are not used, too. */
static inline bool mcor_is_present(const mcor_input* input, int64_t i)
{
  return !input->solid || !input->solid[i] ||
    (!input->ignore_solids && input->solid[i] != MCOR_ABSENT);
}

/* Which particles a look at values leaves out, by their number in mcor_input.solid, and those above. */
typedef enum mcor_skip
{
  MCOR_SKIP_SOLIDS = 1,
  MCOR_SKIP_ABSENT = MCOR_ABSENT
} mcor_skip;

static inline bool mcor_is_skipped(const uint8_t* solid, mcor_skip skip, int64_t i)
{
  return solid && solid[i] && (skip == MCOR_SKIP_SOLIDS || solid[i] == MCOR_ABSENT);
}

#define MCOR_CHUNK 1024

/* Particles of the next chunk where so many are left. */
static inline int mcor_chunk_of(int64_t rest)
{
  return rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK;
}

/* b where it is less, or more; not where it is no number. */
static inline double mcor_least(double a, double b)
{
  return b < a ? b : a;
}

static inline double mcor_most(double a, double b)
{
  return b > a ? b : a;
}

/* Kernels count in int, also a little beyond the last particle. */
#define MCOR_PARTICLE_LIMIT 2000000000

static inline const char* mcor_array_name(const mcor_array* array, const char* role)
{
  return array->name ? array->name : role;
}

void mcor_read_array(const mcor_array* array, int64_t first, int count, int component, double* out);
/* All three coordinates of at most MCOR_CHUNK particles. */
void mcor_read_positions(
  const mcor_input* input, int64_t first, int count, double x[3][MCOR_CHUNK]);
/* Moves to the front the positions of particles that are present, and finite; returns how many. */
int mcor_keep_present(const mcor_input* input, int64_t first, int count, double x[3][MCOR_CHUNK]);
/* At most MCOR_CHUNK of them. Not finite where a derived scalar does not exist as a number. */
void mcor_read_scalar(const mcor_input* input, int64_t first, int count, double* out);

/* Widens [*low, *high] to hold x. */
void mcor_widen_range(const double* x, int count, double* low, double* high);
/* Least and greatest value of one component, without particles that are skipped where `solid` is not NULL; of none
 * DBL_MAX, -DBL_MAX. */
void mcor_find_range(mcor_context* context, const mcor_array* array, const uint8_t* solid, mcor_skip skip, int64_t count,
  int component, double range[2]);
/* The largest absolute value in a range, and of one component; of none 0. */
static inline double mcor_largest_of(double low, double high)
{
  return low > high ? 0 : fmax(-low, high);
}
/* Of the particles that are not absent, and of ignored solids what is finite. */
double mcor_largest(mcor_context* context, const mcor_input* input, const mcor_array* array, int component);

/* mcor_far.c. Of a lattice that does not fit: marks particles as absent, in `far`, so that it does. Ends with the
 * status and sentence of before where too many are in the way. */
typedef struct mcor_far mcor_far;
struct mcor_far
{
  uint8_t* solid; /* [count], freed by the caller; takes the place of the input's */
  bool is_cut;    /* the lattice is that of a region: of a box, or of a probe's points */
  double region[6];
  int64_t count, first; /* absent ones, and the first of them */
  double place[3];
};
mcor_status mcor_leave_out_far(mcor_context* context, const mcor_input* input, mcor_far* far);
/* Of a lattice that is cut, the bounds: `low` and `high` of the positions of all that is used. */
void mcor_cut_bounds(mcor_context* context, const double low[3], const double high[3]);

/* Where what failed is for a lattice that is too large, and one smoothing length is far from the others: adds
 * which one to the sentence. */
void mcor_blame_outlier(mcor_context* context, const mcor_input* input);

/* The first particle, without those skipped where `solid` is not NULL, of which any component is not finite, or
 * not above 0 where it must be; -1 if there is none. */
int64_t mcor_find_illegal(mcor_context* context, const mcor_array* array, const uint8_t* solid, mcor_skip skip,
  int64_t count, bool positive, int* component);
/* For fluid particles alone. */
int64_t mcor_find_not_finite(mcor_context* context, const mcor_array* array, const uint8_t* solid, int64_t count);

/* mcor_attribute.c. Components of all attributes together. */
size_t mcor_count_components(const mcor_input* input);

/* Measures one component; whether its attribute is finite is known before. */
void mcor_measure_component(mcor_context* context, const mcor_input* input, int attribute,
  int component, mcor_global_component* found);

/* About the median of the scalar of fluid particles; measured before. */
mcor_status mcor_find_median(mcor_context* context, const mcor_input* input, double* median);
/* One of a few particles that stand for all. h, volume: of fluid alone; 0 where volumes are computed. */
typedef struct mcor_sample
{
  uint64_t hash;
  double x[3], h, volume;
} mcor_sample;

/* mcor_neighbour_sums.c. w(q), without the norm; of a tensor kernel that of an axis. */
double mcor_w_of(mcor_sph_kernel kernel, double q);

#define MCOR_SAMPLES 256

typedef struct mcor_samples_found
{
  int count, most; /* of these; at most MCOR_SAMPLES */
  mcor_sample sample[MCOR_SAMPLES];
} mcor_samples_found;

typedef enum mcor_sampled
{
  MCOR_ALL_PARTICLES,
  MCOR_FLUID_PARTICLES,
  MCOR_SOLID_PARTICLES
} mcor_sampled;

/* mcor_measure_sample.c. Of all ranks' particles; chosen->most is given. */
mcor_status mcor_choose_samples(
  mcor_context* context, const mcor_input* input, mcor_sampled which, mcor_samples_found* chosen);

/* One for all particles, from their spacing. */
mcor_status mcor_estimate_smoothing_length(
  mcor_context* context, const mcor_input* input, double* estimate);
/* Cube root of a number above 0, with the same bits everywhere, unlike cbrt and pow of C libraries. */
double mcor_cube_root(double value);
/* Median of `count` numbers, which it sorts; 0 if there are none. */
double mcor_median_of(double* values, int count);

/* mcor_measure_neighbours.c. Told of all positions, it ends by filling in the measure's neighbours,
 * spacing, filled and h_median. An estimated smoothing length is to be known before. Free with free(). */
typedef struct mcor_watch mcor_watch;
mcor_status mcor_begin_watch(mcor_context* context, const mcor_input* input, mcor_watch** begun);
void mcor_watch_positions(mcor_watch* watch, int slice, int count, const double x[3][MCOR_CHUNK]);
mcor_status mcor_end_watch(mcor_context* context, mcor_watch* watch, int slices);
/* Smoothing lengths, unscaled, unit L. */
void mcor_read_smoothing_length(
  const mcor_context* context, const mcor_input* input, int64_t first, int count, double* out);

/* Whether volumes are computed from the particles' density on the device. */
static inline bool mcor_needs_density(const mcor_input* input)
{
  return !mcor_is_given(&input->volume) &&
    !(mcor_is_given(&input->mass) && mcor_is_given(&input->density));
}

/* Reads the volumes of at most MCOR_CHUNK particles; where they are computed, the masses, or 1. */
void mcor_read_size(const mcor_input* input, int64_t first, int count, double* out);

#endif
