/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_fixture_h
#define core_fixture_h

/* Helpers of the core's unit tests. The oracle library provides a field in double precision and a mesh checker. Arrays
 * of particles are heap blocks, mostly of exactly the size needed, so that a sanitizer sees reads beyond the end. This
 * header includes the C headers that most tests need. */

#include "mcor_internal.h"
#include "mcor_program.h"
#include "mesh_check.h"
#include "oracle.h"
#include "particle_sets.h"
#include "print_values.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
/* cmocka needs the headers above to be included first. */
#include <cmocka.h>

/* Unless the condition holds, prints the further arguments and fails the test. */
#define CORE_CHECK(condition, ...)                                                                 \
  do                                                                                               \
  {                                                                                                \
    if (!(condition))                                                                              \
    {                                                                                              \
      print_error("%s:%d: not true: %s\n", __FILE__, __LINE__, #condition);                        \
      PRINT_VALUES(__VA_ARGS__)                                                                    \
      fail();                                                                                      \
    }                                                                                              \
  } while (0)

/* Defines main, which runs the given tests. */
#define CORE_MAIN(set_up, tear_down, ...)                                                          \
  int main(void)                                                                                   \
  {                                                                                                \
    const struct CMUnitTest tests[] = { PRINT_EACH(CORE_TEST, __VA_ARGS__) };                      \
    return cmocka_run_group_tests(tests, set_up, tear_down);                                       \
  }
#define CORE_TEST(test) cmocka_unit_test(test),

#define CORE_OK(context, call)                                                                     \
  do                                                                                               \
  {                                                                                                \
    const mcor_status core_status_ = (call);                                                       \
    CORE_CHECK(                                                                                    \
      core_status_ == MCOR_OK, #call, mcor_status_name(core_status_), mcor_last_error(context));   \
  } while (0)

/* Each returns whether all words, separated by |, are in the message, or in the message of the context's last failure.
 * A word is the message's code (ISO_OUTSIDE) or a part of its text. */
bool core_tells(const mcor_message* message, const char* words);
bool core_told(const mcor_context* context, const char* words);

/* Fails the test unless the call returns this status, and a message in which core_told finds the
 * words. */
#define CORE_FAILS(context, expected, call, words)                                                 \
  do                                                                                               \
  {                                                                                                \
    const mcor_status core_status_ = (call);                                                       \
    CORE_CHECK(core_status_ == (expected) && core_told(context, words), #call,                     \
      mcor_status_name(core_status_), mcor_last_error(context));                                   \
  } while (0)

/* Before a declaration: the object is freed at the end of its block. Objects declared later are freed first. */
#define CORE_OWNED(free_it) __attribute__((cleanup(free_it)))
#define CORE_SET CORE_OWNED(particle_set_free) particle_set
#define CORE_SURFACE CORE_OWNED(mcor_free_surface) mcor_surface
#define CORE_REPORT CORE_OWNED(mesh_free_report) mesh_report
#define CORE_FIELD CORE_OWNED(oracle_free_field) oracle_field
#define CORE_SAMPLES CORE_OWNED(mcor_free_samples) mcor_samples
#define CORE_GAUGES CORE_OWNED(mcor_free_gauges) mcor_gauges
#define CORE_FLUXES CORE_OWNED(mcor_free_fluxes) mcor_fluxes
#define CORE_PROJECTION CORE_OWNED(mcor_free_projection) mcor_projection
#define CORE_WIDENING CORE_OWNED(mcor_free_widening) mcor_widening
#define CORE_DERIVATIVES CORE_OWNED(mcor_free_derivatives) mcor_derivatives
#define CORE_CONTEXT CORE_OWNED(core_free_context) mcor_context*
#define CORE_MESSAGE CORE_OWNED(mcor_free_message) mcor_message
#define CORE_FREED CORE_OWNED(core_free_block) /* The pointer came from malloc; free() frees it. */
void core_free_context(mcor_context** context);
void core_free_block(void* pointer);

/* Set up and tear down a group of tests whose *state is a mcor_context*. */
int core_set_up(void** state);
int core_tear_down(void** state);
/* Creates a context while the environment variable has this value. */
void core_create_with(mcor_context** context, const char* variable, const char* value);

/* Returns a heap block that holds a copy of exactly these bytes. */
void* core_copy(const void* data, size_t bytes);

/* Makes n^3 particles with spacing 1 around the origin, displaced by up to `jitter` along each axis. The smoothing
 * length is 1.3, the volume 1 and the scalar value(x). */
particle_set core_make_block(
  int n, double jitter, uint64_t seed, double (*value)(const double x[3]));
/* Makes n^3 particles in a block of spacing 1, a sheet above it, a thread and four lone particles, displaced by up to
 * half of `jitter` along each axis. The volume is 1, the smoothing length 0; the scalar has noise. */
particle_set core_make_splash(int n, double jitter, uint64_t seed);
/* Makes shells of particles with radii r from 1 to `ratio`, without a cone around the positive x axis. The spacing of a
 * shell's particles is about r times `step`. The scalar is (z + 0.2 y) / r. */
particle_set core_make_graded(double ratio, double step);

/* Makes particles at random in a cube of edge `size`, with smoothing lengths in [h_min, h_max] (log-uniform) and
 * scalars in [-1, 1]. */
particle_set core_make_random(
  int64_t count, double size, double h_min, double h_max, uint64_t seed);

double core_ball(const double x[3]);  /* 9 - |x|^2: iso 0 is a sphere of radius 3 */
double core_slope(const double x[3]); /* linear */

/* Does what core_input does, and adds these attributes, [count]; the input keeps the pointer. */
mcor_input core_input_with(const particle_set* set, const mcor_array* attributes, int count);
/* Like core_input, but the particles stay on the device after the extraction. */
mcor_input core_input_to_keep(const particle_set* set);
mcor_options core_options(const double* iso); /* NULL: no iso value */

/* Returns the set in another order: particle i of the result is particle order[i]. */
particle_set core_permute(const particle_set* set, const int64_t* order);
/* Returns a random order of 0 .. count - 1; free it with free(). */
int64_t* core_make_order(int64_t count, uint64_t seed);

/* Calls mcor_widen if the options ask for it, then mcor_extract with the factors and volumes of mcor_widen. */
mcor_status core_extract_widened(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_surface* surface);
/* Returns the surface of core_extract_widened. Fails the test unless this call succeeds. */
mcor_surface core_extract(
  mcor_context* context, const mcor_input* input, const mcor_options* options);

/* Returns the hash of the surface that core_extract makes, which must have triangles. */
uint64_t core_hash_of(mcor_context* context, const mcor_input* input, const mcor_options* options);

/* Fails unless the surface is an oriented manifold without degenerate triangles and without coincident points. */
mesh_report core_check_mesh(const mcor_surface* surface);
/* Like core_check_mesh, but an edge may have two coincident points if only two opposite cells around it are valid. */
mesh_report core_check_pinched_mesh(const mcor_surface* surface);
/* Does what core_check_mesh does, and fails unless exactly the points of the mesh's boundary are flagged. */
void core_check_flags(const mcor_surface* surface);
/* CORE_HASH_OF_NOTHING: the hash of no bytes. core_hash_bytes adds bytes to a hash, unless data is NULL. */
#define CORE_HASH_OF_NOTHING 0xCBF29CE484222325u
uint64_t core_hash_bytes(uint64_t hash, const void* data, size_t bytes);
/* Hashes points, triangles, lines, optional arrays and, of each attribute, the first point_count numbers. */
uint64_t core_hash(const mcor_surface* surface);

/* Compiles the kernels in `source` together with the library's sources, so that mcor_launch can
 * start them. */
void core_extend_program(mcor_context* context, const char* source);
/* Builds the kernels for this SPH kernel, field and precision. */
void core_build(
  mcor_context* context, mcor_sph_kernel kernel, mcor_field field, mcor_type precision);

#endif
