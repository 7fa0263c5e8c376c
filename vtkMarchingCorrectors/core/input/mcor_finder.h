/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_finder_h
#define mcor_finder_h

#include "mcor_find.h"
#include "mcor_input.h"

/* The most names that a quantity has. */
#define MCOR_NAMES 14

/* Values that stand in the place of an index. */
#define MCOR_FIND_POSITIONS (-2)

/* The state of mcor_find_input. */
typedef struct mcor_finder
{
  const mcor_request* request;
  const mcor_named *positions, *arrays;
  int count; /* number of the given arrays; greater indices mean found->made */
  const mcor_ranks* ranks;
  mcor_found* found;
  mcor_array* views;        /* [count + 2]: the arrays that were viewed already */
  int at[MCOR_ROLE_VALUES]; /* the arrays of quantities, whether or not the input has them */
  bool lacks_memory;
} mcor_finder;

/* Allocates memory that belongs to the result. */
void* mcor_find_memory(mcor_finder* f, size_t bytes);

/* Copies a name, because the array's owner may change it meanwhile; NULL stays NULL. */
const char* mcor_keep_name(mcor_finder* f, const char* name);

/* Keeps the first message that says what is wrong; frees later ones. Returns -1, no index. */
int mcor_refuse(mcor_finder* f, mcor_message message);
static inline bool mcor_has_error(const mcor_finder* f)
{
  return f->found->error.code != MCOR_SAYS_NOTHING;
}

/* Returns what is given by hand for a role, or NULL; panels show words in place of none. */
const char* mcor_given_name(const mcor_finder* f, mcor_role role);

/* Finds the array of this name without checking it; -1: there is none. */
int mcor_find_by_name(const mcor_finder* f, const char* name);
/* Finds the array of this name, with a number for each particle if components is 1; 0: any vector.
 * words: what it is for. */
int mcor_find_given(mcor_finder* f, const char* words, const char* name, int components);

const mcor_named* mcor_named_of(const mcor_finder* f, int index);
/* Reads any element as a double. */
double mcor_element_at(const mcor_named* named, int64_t tuple, int component);

/* mcor_find_fluid.c. Chooses the array and value of fluid, or finds that one is not used. All ranks
 * call it. */
void mcor_find_fluid(mcor_finder* f);
/* Marks solid and absent particles, and counts the fluid. */
void mcor_mark_particles(mcor_finder* f);

#endif
