/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Kernels are compiled once for all users of a machine, see mcor_kept.h. */

#include "mcor_ahead.h"
#include "mcor_internal.h"
#include "mcor_kept.h"

#ifndef _WIN32

#include <stdio.h>

/* One for each list of kernels that are launched with many work-items. */
static const int64_t mcor_kept_particles[] = { 10000, 20000, 50000, 100000 };

static mcor_status mcor_keep_build(mcor_context* context, const mcor_build* build)
{
  mcor_guess_build(context, build);
  for (size_t p = 0; p < sizeof mcor_kept_particles / sizeof mcor_kept_particles[0]; ++p)
  {
    mcor_ahead_kernel kernels[MCOR_AHEAD_LIMIT];
    char request[MCOR_AHEAD_BYTES], ready[1024];
    const int count = mcor_list_ahead(build, mcor_kept_particles[p], kernels);
    for (int k = 0; k < count; ++k)
    {
      if (p == 0 || kernels[k].large)
      {
        MCOR_TRY(mcor_compile_kernel(context, kernels + k));
      }
    }
    mcor_write_request(&context->cl, build, kernels, count, request);
    FILE* file = mcor_ready_file(&context->cl, build, request, ready) ? fopen(ready, "w") : NULL;
    MCOR_RETURN_IF(
      !file || fclose(file) != 0, context, MCOR_DEVICE_ERROR, "%s could not be written.", ready);
  }
  return MCOR_OK;
}

mcor_status mcor_keep(mcor_context* context, unsigned sph_kernels, const char* folder)
{
  static const mcor_field fields[] = { MCOR_WEIGHT_SUM, MCOR_SHEPARD };
  const mcor_build first = { .field = MCOR_WEIGHT_SUM };
  MCOR_RETURN_IF(!mcor_can_compile_ahead(&context->cl, &first), context, MCOR_DEVICE_ERROR,
    "Kernels are kept for PoCL on a CPU of several cores; this device is %s.",
    context->cl.device_name);
  for (int kernel = 0; kernel < MCOR_SPH_KERNEL_COUNT; ++kernel)
  {
    for (int f = 0; f < 2 && (sph_kernels >> kernel & 1); ++f)
    {
      const mcor_build build = { .sph_kernel = (mcor_sph_kernel)kernel, .field = fields[f] };
      MCOR_TRY(mcor_keep_build(context, &build));
    }
  }
  MCOR_RETURN_IF(!mcor_share_kept(folder), context, MCOR_DEVICE_ERROR,
    "%s could not be made readable for all.", folder);
  return MCOR_OK;
}

#endif
