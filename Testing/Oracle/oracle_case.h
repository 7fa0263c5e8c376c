/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_case_h
#define oracle_case_h

/* Runs the library and the oracle on the same particles, compares the surfaces, and prints a line for each extraction.
 * All test programs of the oracle use this file, except test_oracle_self. */

#include "mcor.h"
#include "oracle_compare.h"

#ifdef __cplusplus
extern "C"
{
#endif

  typedef struct oracle_suite
  {
    mcor_context* context;
    const char* filter; /* run only cases whose name contains it; NULL: all */
    int cases, failures;
  } oracle_suite;

  /* Reads the command line: [--case SUBSTRING]. Returns 0, after a message, if the suite cannot run. */
  int oracle_begin_suite(oracle_suite* suite, int argc, char** argv);
  /* Prints the summary; returns the exit status of the program. */
  int oracle_end_suite(oracle_suite* suite);
  int oracle_wants_case(const oracle_suite* suite, const char* name);

  /* Returns the default options of mcor.h, but with one iso value, uniform cubes, no walls, three dimensions and the
   * arrays that the oracle checks. The options keep the pointer to the iso value. */
  mcor_options oracle_case_options(const double* iso);

  typedef struct oracle_case
  {
    char name[96];
    mcor_input input;
    mcor_options options; /* one iso value; seeds and vertex_threshold are set by the run */
    int skip_pairs;       /* do not run with MCOR_PAIRS */
    int
      rough; /* values without any smoothness: gradients, and what they lead to, have few digits */
    int
      at_iso; /* values equal to iso in places: which edges are crossed is up to rounding there, and
                 * the surface has no distance or normal */
    int random;           /* may lack a surface */
    int has_euler, euler; /* what the Euler number of the untrimmed surface must be */
  } oracle_case;

  /* Runs the case up to three times: untrimmed with complete seeds; trimmed with complete seeds, unless the weight sum
   * is contoured without walls; untrimmed with pairs, unless skip_pairs is set or cubes have levels. The case fails
   * unless all is right. */
  void oracle_run_case(oracle_suite* suite, const oracle_case* at);

#ifdef __cplusplus
}
#endif

#endif
