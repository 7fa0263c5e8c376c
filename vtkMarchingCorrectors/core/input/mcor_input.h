/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_input_h
#define mcor_input_h

/* Functions for the files that read the input. The caller's arrays are read as double: one element,
 * or a chunk of one component in a loop that compilers vectorise. */

#include "mcor_internal.h"
#include "mcor_parallel.h"

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

/* Whether a particle is used. Fluid always is, absent particles never are; solids are used if the
 * call uses solids, see context->kept.uses_solids. */
static inline bool mcor_is_used(const mcor_context* context, const mcor_input* input, int64_t i)
{
  return !input->solid || !input->solid[i] ||
    (context->kept.uses_solids && input->solid[i] != MCOR_ABSENT);
}

/* Whether a particle counts as a neighbour, and in the search for a plane. Absent particles and
 * ignored solids do not count. */
static inline bool mcor_is_present(const mcor_input* input, int64_t i)
{
  return !input->solid || !input->solid[i] ||
    (!input->ignore_solids && input->solid[i] != MCOR_ABSENT);
}

/* The particles that a search of values skips: all that mcor_input.solid marks, or only absent
 * ones. */
typedef enum mcor_skip
{
  MCOR_SKIP_SOLIDS = 1,
  MCOR_SKIP_ABSENT = MCOR_ABSENT
} mcor_skip;

static inline bool mcor_is_skipped(const uint8_t* solid, mcor_skip skip, int64_t i)
{
  return solid && solid[i] && (skip == MCOR_SKIP_SOLIDS || solid[i] == MCOR_ABSENT);
}

/* Returns the positions with 3 components, even if the caller has set another number. */
static inline mcor_array mcor_positions_of(const mcor_input* input)
{
  mcor_array positions = input->positions;
  positions.components = 3;
  return positions;
}

#define MCOR_CHUNK 1024

/* Returns how many of the `rest` particles that are left go into the next chunk. */
static inline int mcor_chunk_of(int64_t rest)
{
  return rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK;
}

/* Return the smaller or the greater of two numbers; a if b is NaN. */
static inline double mcor_least(double a, double b)
{
  return b < a ? b : a;
}

static inline double mcor_most(double a, double b)
{
  return b > a ? b : a;
}

/* Whether all numbers are from `least` to `most`. */
bool mcor_is_all_within(const double* x, int count, double least, double most);

/* mcor_check.c. Fails and says that two sides of a box are not an interval. */
mcor_status mcor_refuse_sides(mcor_context* context, int axis, double from, double to);

/* The largest number of particles. Kernels count them in int, and go a little beyond the last. */
#define MCOR_PARTICLE_LIMIT 2000000000

static inline const char* mcor_array_name(const mcor_array* array, const char* role)
{
  return array->name ? array->name : role;
}

void mcor_read_array(const mcor_array* array, int64_t first, int count, int component, double* out);
/* Reads the coordinates of `count` particles, at most MCOR_CHUNK. */
void mcor_read_positions(
  const mcor_input* input, int64_t first, int count, double x[3][MCOR_CHUNK]);
/* A chunk of particles. h: smoothing lengths; length: smoothing lengths times the factors of
 * widening. Neither is multiplied by h_scale. */
typedef struct mcor_places
{
  int count;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK], length[MCOR_CHUNK];
} mcor_places;
/* Reads the next chunk of [first, last); returns its count, 0 at the end. */
int mcor_read_places(const mcor_context* context, const mcor_input* input, int64_t first,
  int64_t last, mcor_places* places);
/* Reads at most MCOR_CHUNK values of the scalar. A magnitude or dot product that is too large
 * becomes infinite. */
void mcor_read_scalar(const mcor_input* input, int64_t first, int count, double* out);

/* What a loop, or a slice of it, has found. An empty range is DBL_MAX, -DBL_MAX. Sums are of whole
 * numbers. first: the least index of the elements that are looked for. */
#define MCOR_RANGES 14
#define MCOR_SUMS 4
typedef struct mcor_findings
{
  double least[MCOR_RANGES], most[MCOR_RANGES];
  int64_t sums[MCOR_SUMS];
  int64_t first; /* INT64_MAX: none */
} mcor_findings;

mcor_findings mcor_no_findings(void);
static inline void mcor_add_range(mcor_findings* found, int k, double low, double high)
{
  found->least[k] = mcor_least(found->least[k], low);
  found->most[k] = mcor_most(found->most[k], high);
}
mcor_findings mcor_merge_findings(const mcor_findings* slices, int count);
/* Makes a context without a device, for functions of mcor.h that take no context: it has threads
 * and ranks, and keeps an error. NULL: memory ran out. */
mcor_context* mcor_make_bare_context(const mcor_options* options);
void mcor_free_bare_context(mcor_context* context);
/* Merges ranges and sums of all ranks, but not `first`. */
mcor_status mcor_reduce_findings(mcor_context* context, mcor_findings* found);

/* Widens [*low, *high] to hold the `count` numbers x. */
void mcor_widen_range(const double* x, int count, double* low, double* high);
/* Returns the range of one component, as range 0 of the result. skip: which of the particles that
 * `solid` marks are left out. With `solid`, values that are not finite are left out, too. If
 * `solid` is NULL, no value is left out. */
mcor_findings mcor_find_range(mcor_context* context, const mcor_array* array, const uint8_t* solid,
  mcor_skip skip, int64_t count, int component);
/* Returns the largest absolute value in a range; 0 if the range is empty. */
static inline double mcor_largest_of(double low, double high)
{
  return low > high ? 0 : fmax(-low, high);
}
/* Returns the largest magnitude of a component over all particles except absent ones. Ignored
 * solids count, too, if their values are finite. */
double mcor_largest(
  mcor_context* context, const mcor_input* input, const mcor_array* array, int component);

/* mcor_far.c. Serves a call whose lattice is too long: marks far particles as absent, in
 * far->solid, so that a shorter lattice holds the rest. Fails if too many would be absent. */
typedef struct mcor_far mcor_far;
struct mcor_far
{
  uint8_t* solid; /* [count], freed by the caller; replaces the input's array */
  bool is_cut;    /* the lattice surrounds only a region: a box, or a probe's points */
  double region[6];
  int64_t count, first; /* number of absent particles, 0 if is_cut; and the first of them */
  double place[3];      /* position of the first absent particle of all ranks; not if is_cut */
};
mcor_status mcor_leave_out_far(mcor_context* context, const mcor_input* input, mcor_far* far);
/* In a call with globals, marks as absent, in far->solid, the particles that the measuring call
 * left out: all particles beyond the measured bounds. */
mcor_status mcor_leave_out_again(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_far* far);
/* Copies the absent particles' number, first index and place from run.far to context->measure, for
 * the statistics. If far->is_cut, also narrows the measured bounds, so that the lattice surrounds
 * only the region. low, high: the bounds of the positions of all particles in use. */
void mcor_cut_bounds(mcor_context* context, const double low[3], const double high[3]);

/* Called when capacity does not suffice. If the least or the greatest smoothing length differs much
 * from the median, appends to the error sentence which particle has this length. */
void mcor_blame_outlier(mcor_context* context, const mcor_input* input);

/* Returns the first particle with a number in `array` that is not finite or, if `positive` is set,
 * not above 0; -1: there is none. skip: which particles marked in `solid` are not checked. */
int64_t mcor_find_illegal(mcor_context* context, const mcor_array* array, const uint8_t* solid,
  mcor_skip skip, int64_t count, bool positive);

/* mcor_attribute.c. Returns the number of components of all attributes together. */
size_t mcor_count_components(const mcor_input* input);

/* mcor_globals.c. Measures the components of all attributes. */
mcor_status mcor_measure_components(
  mcor_context* context, const mcor_input* input, mcor_globals* globals);

/* Finds a value near the median of the fluid's scalar. The scalar's range must be known. */
mcor_status mcor_find_median(mcor_context* context, const mcor_input* input, double* median);
/* mcor_neighbour_sums.c. Returns the SPH kernel at distance q (in h), without the norm; for a
 * tensor kernel, the factor of one axis. */
double mcor_w_of(mcor_sph_kernel kernel, double q);

/* mcor_measure_sample.c. Samples the particles of all ranks, into context->samples. most_fluid: the
 * most samples of fluid; fewer take less time. */
mcor_status mcor_choose_samples(mcor_context* context, const mcor_input* input, int most_fluid);
/* The most fluid particles whose neighbours are counted while all particles are measured. */
#define MCOR_WATCHED 32

/* mcor_hash_position returns the hash of a position. The particles with the least hashes are
 * samples, which stand for all particles. mcor_add_sample adds a sample to a list if the list is
 * not full, or if the sample's hash is among the least. */
uint64_t mcor_hash_position(const double x[3]);
void mcor_add_sample(mcor_sample_list* found, const mcor_sample* sample);

/* Estimates one smoothing length for all particles from the spacing of the samples, and sets it as
 * the samples' h. */
mcor_status mcor_estimate_smoothing_length(
  mcor_context* context, const mcor_input* input, double* estimate);
/* Computes the cube root of a number above 0, with the same bits on every machine, unlike cbrt
 * and pow of C libraries. */
double mcor_cube_root(double value);
/* Sorts `count` numbers and returns their median; 0 if count is 0. */
double mcor_median_of(double* values, int count);

/* Reads smoothing lengths, unscaled, unit L. */
void mcor_read_smoothing_length(
  const mcor_context* context, const mcor_input* input, int64_t first, int count, double* out);
/* Writes the lengths of the kernels: smoothing lengths h times the factors of widening. */
void mcor_widen_lengths(
  const mcor_input* input, int64_t first, int count, const double* h, double* out);

/* Whether the device computes the particles' volumes, because neither volumes nor masses with
 * densities are given. */
static inline bool mcor_needs_density(const mcor_input* input)
{
  return !mcor_is_given(&input->volume) &&
    !(mcor_is_given(&input->mass) && mcor_is_given(&input->density));
}

/* Reads the volumes of at most MCOR_CHUNK particles. If volumes are to be computed, reads the
 * masses instead or, without masses, writes 1. */
void mcor_read_size(const mcor_input* input, int64_t first, int count, double* out);

/* mcor_find_plane.c. Whether there are positions that can be read. */
bool mcor_has_positions(const mcor_input* input);

/* mcor_measure_median.c. Compares two doubles, for qsort. */
int mcor_compare_doubles(const void* a, const void* b);

#endif
