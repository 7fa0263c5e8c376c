/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_find_h
#define mcor_find_h

/* Makes an mcor_input from named arrays of particles, as files and programs have them, and from
 * what a user says about the arrays. Also finds which array serves for what, and says in sentences
 * what is missing or not used.
 *
 *   mcor_found found;
 *   if (mcor_find_input(&request, &positions, arrays, count, NULL, &found) == MCOR_OK)
 *   {
 *     mcor_extract(context, &found.input, &options, &surface);
 *   }
 *   mcor_free_found(&found);   (found.error says why it failed) */

#include "mcor_parts.h"

#ifdef __cplusplus
extern "C"
{
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

  /* Types of elements. The first two are the types of mcor_type. */
  typedef enum mcor_element
  {
    MCOR_ELEMENT_FLOAT32 = 0,
    MCOR_ELEMENT_FLOAT64,
    MCOR_ELEMENT_INT8,
    MCOR_ELEMENT_UINT8,
    MCOR_ELEMENT_INT16,
    MCOR_ELEMENT_UINT16,
    MCOR_ELEMENT_INT32,
    MCOR_ELEMENT_UINT32,
    MCOR_ELEMENT_INT64,
    MCOR_ELEMENT_UINT64,
    MCOR_ELEMENT_OTHER /* no numbers: text, say; its data are never read */
  } mcor_element;

  /* An array as its owner has it, borrowed until the mcor_found is freed. */
  typedef struct mcor_named
  {
    const char* name; /* NULL: it has none, and is only found as the active array */
    mcor_element type;
    int components; /* 1 or more */
    int64_t tuples;
    const void* data;  /* the first element; may be NULL where there are none */
    int64_t stride[2]; /* bytes from tuple to tuple, and from component to component; 0: no gaps */
  } mcor_named;

  /* What an array is used for. */
  typedef enum mcor_role
  {
    MCOR_ROLE_SMOOTHING_LENGTH = 0, /* the first four may be given as one value */
    MCOR_ROLE_VOLUME,
    MCOR_ROLE_MASS,
    MCOR_ROLE_DENSITY,
    MCOR_ROLE_VELOCITY, /* also made of the arrays vx, vy and vz */
    MCOR_ROLE_ID,
    MCOR_ROLE_FLUID, /* tells which particles are fluid */
    MCOR_ROLE_SCALAR,
    MCOR_ROLE_SCALAR_DOT, /* the second vector of a dot product */
    MCOR_ROLE_WEIGHT,     /* the weight of a projection that shows a mean */
    MCOR_ROLE_COUNT
  } mcor_role;
#define MCOR_ROLE_VALUES 4

  /* What mcor_find_input is to find for a call; bits of mcor_request.wants. */
  typedef enum mcor_want
  {
    MCOR_WANT_SIZES = 1,      /* smoothing lengths, and volumes where they are known */
    MCOR_WANT_SCALAR = 2,     /* the scalar, to be contoured */
    MCOR_WANT_ATTRIBUTES = 4, /* all arrays that can be interpolated, as attributes */
    MCOR_WANT_ARRAY = 8,      /* the scalar as the only attribute, for mcor_derive */
    MCOR_WANT_FLOW = 16,      /* velocity and, where it is known, density as attributes */
    MCOR_WANT_COLUMN = 32, /* for mcor_project: the scalar, if there is one, and mass or density */
    MCOR_WANT_LIST = 64,   /* a list of what is found: a missing smoothing length is no error */
    MCOR_WANT_FLUID = 128  /* if no fluid is given: an array that tells it, see find_fluid */
  } mcor_want;

  /* A range of an array's values; tells which particles count, see mcor_request.only. */
  typedef struct mcor_only
  {
    const char* name;
    double low, high;
  } mcor_only;

  typedef struct mcor_request
  {
    unsigned wants; /* bits of mcor_want */
    /* For each role, the name of the array that the user gives; NULL or "": none. */
    const char* names[MCOR_ROLE_COUNT];
    double values[MCOR_ROLE_VALUES]; /* one value for all particles; 0: none */
    int find; /* nonzero: arrays that are not given are found by their names */
    /* Nonzero: volumes are computed, not taken from arrays. */
    int compute_volumes;
    double particle_volume;        /* of each particle, if nothing else tells volumes; 0: none */
    int estimate_smoothing_length; /* as in mcor_input */
    int lengths_by_neighbours;     /* nonzero: the estimate is mcor_find_smoothing_lengths */
    int smoothing_length_is_support_radius;
    /* fluid_value: the value of fluid particles in the array that is given for MCOR_ROLE_FLUID. If
     * the given name is "Block: NAME" and there is an array MCOR_WALL_BLOCK, this array is used,
     * and fluid particles have the value 0 in it. find_fluid: what MCOR_WANT_FLUID does if no array
     * is given. 0: uses no array, but mcor_found.unused_type names an array that may tell which
     * particles are fluid. 1: uses an array that tells this without doubt; if there is none, does
     * as with 0. 2: does as with 1, but if there is no array to name, unused_type says so. */
    double fluid_value;
    int find_fluid;
    int ignore_solids;
    int free_surface;      /* nonzero: the free surface is contoured, so no scalar is looked for */
    int scalar_component;  /* as in mcor_input */
    int active;            /* the array to contour if it is fit and none is given; -1: none */
    int not_on_points;     /* bit 1 << role: the array that is given is not an array of particles */
    double within[6];      /* bounds of the particles that count, unless all are 0 */
    const mcor_only* only; /* [only_count]; a value must be in one of its array's ranges */
    int only_count;
    /* Names of arrays, one per line, or NULL. taken: the surface's computed arrays; neither an
     * attribute nor the array of iso values gets these names. excluded: other arrays that must not
     * be attributes. */
    const char *taken, *excluded;
    int filled; /* nonzero: a filled region is made; its iso values are not values of the scalar */
    int has_iso_values; /* nonzero: there is an array of iso values; no attribute has its name */
    const char* label;  /* the name of the scalar's component; NULL: X, Y, Z or a number */
  } mcor_request;

  /* The result of mcor_find_input; free it with mcor_free_found. Indices are indices of the given
   * arrays; -1: none. The two indices behind the last given array stand for made[0] and made[1]. */
  typedef struct mcor_found
  {
    mcor_input input; /* valid until mcor_free_found */
    /* The index of the array for each role; -1 if there is none or, for the first four roles, if
     * the input does not use the array. */
    int which[MCOR_ROLE_COUNT];
    /* The array of each role, or its single value, in the form that the core reads; set even if
     * `input` does not use it. For MCOR_ROLE_FLUID, only the name is set. */
    mcor_array views[MCOR_ROLE_COUNT];
    double fluid_value;
    int64_t fluid_count; /* number of fluid particles */
    int* attributes;     /* [input.attribute_count], the array of each attribute of the input */
    int* nearest; /* [nearest_count], arrays that cannot be interpolated: whole numbers, text */
    int nearest_count;
    mcor_named made[2]; /* "Velocity" of vx, vy and vz; "Density" of mass and volume; or no name */
    /* Nonzero: the caller must compute smoothing lengths or densities by sums over neighbours, and
     * pass them to mcor_take_lengths or mcor_take_densities. */
    int needs_lengths, needs_densities;
    mcor_message error;       /* what is missing or not usable */
    mcor_message unused_type; /* names an array that seems to tell fluid from solids, but is not
                               * used; or, with find_fluid 2, says that there is none */
    mcor_message unused;      /* what is given by hand and has no effect */
    char* no_fluid;           /* why no particle is fluid, without a full stop; NULL: some are */
    char*
      scalar_name; /* "Pressure", "Velocity_Magnitude", "Velocity_X", "A_Dot_B"; "": no scalar */
    const char* iso_value_name; /* the scalar's name; "IsoValue" if it is taken, or if `filled` */
    void** own;                 /* [own_count], memory that mcor_free_found frees */
    int own_count;
  } mcor_found;

  /* Finds the arrays that the request wants, and makes found->input of them. positions:
   * [tuples][3]. ranks: NULL, or the ranks that share the particles: all ranks call this function
   * with the same request and arrays of the same form, and agree on the fluid and on the array to
   * contour. MCOR_INVALID_ARGUMENT: see found->error; MCOR_OUT_OF_CAPACITY: memory ran out. *found
   * is overwritten. */
  mcor_status mcor_find_input(const mcor_request* request, const mcor_named* positions,
    const mcor_named* arrays, int count, const mcor_ranks* ranks, mcor_found* found);
  void mcor_free_found(mcor_found* found);

  /* Put into an input what it needs: smoothing lengths [count], made by
   * mcor_find_smoothing_lengths, or densities [count], made by mcor_sum_densities. The arrays are
   * borrowed until mcor_free_found. Densities become the scalar. If there are masses, but no other
   * densities and no volumes, the densities also give the volumes. */
  void mcor_take_lengths(mcor_found* found, const double* lengths);
  void mcor_take_densities(mcor_found* found, const double* densities);

  /* Returns the index of the array to show if the user has chosen none: the active array, unless
   * its mcor_view_priority is -1; else the array with the lowest priority that is not -1. Returns
   * -1 if there is none, or if another rank failed. `ranks` as in mcor_find_input. */
  int mcor_choose_view(const mcor_named* arrays, int count, int active, const mcor_ranks* ranks);

  /* Returns the index of the array that has the most usual name of the quantity, among arrays with
   * `components` components and `tuples` tuples of numbers; -1: none. */
  int mcor_find_named(
    const mcor_named* arrays, int count, mcor_quantity quantity, int components, int64_t tuples);

  /* Whether a block or body of this name holds walls: "walls", "boundary", "tank", ... */
  int mcor_tells_of_walls(const char* name);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif

#endif
