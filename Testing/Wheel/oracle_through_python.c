/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The oracle's random cases with extractions made by somebody else: the linker replaces the core's
 * functions by these (--wrap), which call what test_oracle.py gives. */

#include "mcor.h"

int oracle_random_main(int argc, char** argv); /* main of test_oracle_random.c */

typedef int (*oracle_extract)(const mcor_input*, const mcor_options*, mcor_surface*);
static oracle_extract oracle_extract_by;

__attribute__((visibility("default"))) int oracle_run(oracle_extract by, int argc, char** argv)
{
  oracle_extract_by = by;
  return oracle_random_main(argc, argv);
}

mcor_status __wrap_mcor_create_context(const char* device, mcor_context** context);
mcor_status __wrap_mcor_extract(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_surface* surface);

mcor_status __wrap_mcor_create_context(const char* device, mcor_context** context)
{
  (void)device;
  *context = NULL;
  return MCOR_OK;
}

mcor_status __wrap_mcor_extract(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_surface* surface)
{
  (void)context;
  return oracle_extract_by(input, options, surface) == 0 ? MCOR_OK : MCOR_DEVICE_ERROR;
}
