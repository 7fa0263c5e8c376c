/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_fixture_h
#define core_fixture_h

/* Helpers that the core's unit tests share. The oracle library lends its double-precision field
 * and its mesh checker. Every array handed to the core is a heap block of exactly its size, so
 * that a sanitizer sees a read beyond it. */

#include "mcor_internal.h"
#include "mcor_program.h"
#include "mesh_check.h"
#include "oracle.h"
#include "particle_sets.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
/* cmocka wants the above first. */
#include <cmocka.h>

#define CORE_CHECK(condition, ...)                                                                 \
  do                                                                                               \
  {                                                                                                \
    if (!(condition))                                                                              \
    {                                                                                              \
      print_error("%s:%d: not true: %s\n", __FILE__, __LINE__, #condition);                        \
      fail_msg(__VA_ARGS__);                                                                       \
    }                                                                                              \
  } while (0)

#define CORE_OK(context, call)                                                                     \
  do                                                                                               \
  {                                                                                                \
    const mcor_status core_status_ = (call);                                                       \
    CORE_CHECK(core_status_ == MCOR_OK, "%s: %s", mcor_status_name(core_status_),                  \
      mcor_last_error(context));                                                                   \
  } while (0)

/* Whether the message, or the context's last failure, has all of these words, with | between them:
 * its code, ISO_OUTSIDE, or what stands in its text. */
bool core_tells(const mcor_message* message, const char* words);
bool core_told(const mcor_context* context, const char* words);

/* The call fails with this status, and with a message that core_told finds. */
#define CORE_FAILS(context, expected, call, words)                                                 \
  do                                                                                               \
  {                                                                                                \
    const mcor_status core_status_ = (call);                                                       \
    CORE_CHECK(core_status_ == (expected) && core_told(context, words), "%s: %s",                  \
      mcor_status_name(core_status_), mcor_last_error(context));                                   \
  } while (0)

/* Before a declaration: what it declares is freed at the end of its block, in reverse order. */
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
#define CORE_CONTEXT CORE_OWNED(core_free_context) mcor_context*
#define CORE_MESSAGE CORE_OWNED(mcor_free_message) mcor_message
#define CORE_FREED CORE_OWNED(core_free_block) /* pointers that free() frees */
void core_free_context(mcor_context** context);
void core_free_block(void* pointer);

/* Group fixtures: *state is a mcor_context*. */
int core_set_up(void** state);
int core_tear_down(void** state);
/* A context with the form of the kernels for "cpu" or "gpu", whatever the device is. */
void core_create_form(mcor_context** context, const char* form);

/* A block of heap memory that holds a copy of exactly these bytes. */
void* core_copy(const void* data, size_t bytes);

/* n^3 particles with spacing 1 around the origin, displaced by up to `jitter`, smoothing
 * length 1.3, volume 1, scalar = value(x). */
particle_set core_make_block(
  int n, double jitter, uint64_t seed, double (*value)(const double x[3]));
/* A shell of particles around a hole whose size goes with the distance from the hole's middle, from 1
 * to `ratio`; scalar: height. A wedge of it is left out. */
particle_set core_make_graded(double ratio, double step);

/* Particles anywhere in a cube of edge `size`; smoothing lengths in [h_min, h_max], log-uniform;
 * scalars in [-1, 1]. */
particle_set core_make_random(
  int64_t count, double size, double h_min, double h_max, uint64_t seed);

double core_ball(const double x[3]);  /* 9 - |x|^2: iso 0 is a sphere of radius 3 */
double core_slope(const double x[3]); /* linear */

/* As core_input, but the particles stay on the device after the extraction. */
mcor_input core_input_to_keep(const particle_set* set);
mcor_options core_options(const double* iso); /* NULL: no iso value */

/* Particle i of the result is particle order[i] of the set. */
particle_set core_permute(const particle_set* set, const int64_t* order);
/* A seemingly random order; free with free(). */
int64_t* core_make_order(int64_t count, uint64_t seed);

/* Calls mcor_widen if the options ask for it, then mcor_extract with its factors. */
mcor_status core_extract_widened(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_surface* surface);
/* Does the same; the test fails if that does. */
mcor_surface core_extract(
  mcor_context* context, const mcor_input* input, const mcor_options* options);

/* Fails unless the surface is an oriented manifold without degenerate triangles. */
mesh_report core_check_mesh(const mcor_surface* surface);
/* As core_check_mesh, but the two vertices of an edge at which only two opposite cells are valid
 * may coincide. */
mesh_report core_check_pinched_mesh(const mcor_surface* surface);
/* As core_check_mesh; points of the mesh's boundary, and no others, must be flagged, too. */
void core_check_flags(const mcor_surface* surface);
/* The hash of nothing, for a start; and with more bytes, if data is not NULL. */
#define CORE_HASH_OF_NOTHING 0xCBF29CE484222325u
uint64_t core_hash_bytes(uint64_t hash, const void* data, size_t bytes);
/* Point count, points, triangles and every optional array. */
uint64_t core_hash(const mcor_surface* surface);

/* Compiles more kernels behind all sources, for mcor_launch. */
void core_extend_program(mcor_context* context, const char* source);
/* Chooses what kernels are compiled for. */
void core_build(
  mcor_context* context, mcor_sph_kernel kernel, mcor_field field, mcor_type precision);

#endif
