/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_finder_h
#define mcor_finder_h

#include "mcor_find.h"
#include "mcor_input.h"

/* An array with more different values than this does not tell types of particles. */
#define MCOR_PARTICLE_TYPES 8

/* The most usual names that a quantity has. */
#define MCOR_NAMES 14

/* mcor_name.c. Whether a name is the name `usual`, which consists of small letters and digits. In
 * `name`, "_", "-", blanks and case do not matter. */
bool mcor_is_usual_name(const char* name, const char* usual);

/* The state of mcor_find_input. */
typedef struct mcor_finder
{
  const mcor_request* request;
  const mcor_named *positions, *arrays;
  int count; /* number of the given arrays; indices from this number on mean found->made */
  const mcor_ranks* ranks;
  mcor_found* found;
  mcor_array* views; /* [count + 2]: the arrays that were viewed already */
  unsigned uses;     /* bits 1 << role: the quantities that the input has */
  bool lacks_memory;
} mcor_finder;

/* Adds `memory` to the memory that is freed with f->found. Returns `memory`; if the list of such
 * memory cannot grow, frees `memory` and returns NULL. */
void* mcor_own(mcor_finder* f, void* memory);
/* Allocates memory that belongs to the result. */
void* mcor_find_memory(mcor_finder* f, size_t bytes);

/* Copies a name into f->found, because the array's owner may change it later; NULL stays NULL. */
const char* mcor_keep_name(mcor_finder* f, const char* name);

static inline bool mcor_has_error(const mcor_finder* f)
{
  return f->found->error.code != MCOR_SAYS_NOTHING;
}

/* Returns the name that the caller gives for a role; NULL if it is "", or "(automatic)" or
 * "(none)", which panels use. */
const char* mcor_given_name(const mcor_finder* f, mcor_role role);

/* Returns the index of the array of this name, without checking the array; -1: there is none. */
int mcor_find_by_name(const mcor_finder* f, const char* name);
/* Returns the index of the array of this name; -1 and an error if it is missing or does not suit.
 * components: 1: the array must have one number for each particle; 0: any number of components.
 * words: what the array is for. */
int mcor_find_given(mcor_finder* f, const char* words, const char* name, int components);

/* Returns a list of the arrays, for messages: "Point arrays: A, B."; "" if memory runs out. */
const char* mcor_names_of(mcor_finder* f);
/* Reads any element as a double. */
double mcor_element_at(const mcor_named* named, int64_t tuple, int component);

/* mcor_find_fluid.c. Finds the array and the value that mark fluid, or an array that seems to mark
 * fluid but is not used. All ranks call this function together. */
void mcor_find_fluid(mcor_finder* f);
/* Marks solid and absent particles in found->input.solid, and counts the fluid. */
void mcor_mark_particles(mcor_finder* f);

#endif
