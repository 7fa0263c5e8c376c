/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compilers take long. So a program holds little that a run does not need, and what depends
 * neither on the SPH kernel nor on the field or solids is compiled once for all of them. */

#include "mcor_program.h"
#include "mcor_internal.h"
#include "mcor_sph_kernel.h"

#include <stdio.h>
#include <string.h>

int mcor_program_sources(
  const mcor_cl* cl, mcor_program program, const char* sources[MCOR_SOURCE_LIMIT])
{
  int count = 0;
  for (const mcor_kernel_source* s = mcor_kernel_sources; s->text; ++s)
  {
    if ((s->programs >> program & 1) && s->form != (cl->lanes > 1 ? MCOR_GPU_FORM : MCOR_CPU_FORM))
    {
      sources[count++] = s->text;
    }
  }
  return count;
}

bool mcor_program_may_have(mcor_program program, const char* kernel)
{
  const bool is_probe = strncmp(kernel, "mcor_probe_", 11) == 0 ||
    strncmp(kernel, "mcor_derive_", 12) == 0 || strncmp(kernel, "mcor_widen_", 11) == 0;
  return program == MCOR_PROGRAM_LATTICE ? !is_probe
    : program == MCOR_PROGRAM_PROBE      ? is_probe
                                         : !is_probe;
}

void mcor_name_build(const mcor_build* build, char* text, size_t size)
{
  const bool is_double = build->precision == MCOR_FLOAT64;
  const char* kernel = mcor_sph_kernel_name(build->sph_kernel);
  snprintf(text, size, "the SPH kernel %s%s", kernel, is_double ? " in double precision" : "");
}

void mcor_program_options(const mcor_cl* cl, mcor_program program, char* text, size_t size)
{
#define MCOR_ENTRY(id, name, support, norm, tensor, ...)                                           \
  { #name, #norm, #support, tensor },
  static const struct
  {
    const char *name, *norm, *support;
    int tensor;
  } kernels[] = { MCOR_SPH_KERNEL_TABLE(MCOR_ENTRY) };
#undef MCOR_ENTRY
  const mcor_build* build = &cl->build;
  const int k = (int)build->sph_kernel;
  const bool is_double = build->precision == MCOR_FLOAT64;
  /* Probes sum any arrays, not the scalar to contour, so their program is compiled for one
   * field. */
  const mcor_field field = program == MCOR_PROGRAM_PROBE ? MCOR_WEIGHT_SUM : build->field;
  const char* f = is_double ? "" : "f";
  int length = snprintf(text, size, "-w -cl-std=CL1.2 -cl-kernel-arg-info%s%s -DMCOR_PROGRAM=%d",
    cl->rounds_division ? " -cl-fp32-correctly-rounded-divide-sqrt" : "",
    cl->declares_builtins ? " -D_OPENCL_H_ -DMCOR_DECLARES_BUILTINS=1" : "", (int)program);
  if (program == MCOR_PROGRAM_LATTICE)
  {
    snprintf(text + length, size - (size_t)length, " -DMCOR_LANES=%d -DMCOR_DOUBLE=%d", cl->lanes,
      is_double);
    return;
  }
  snprintf(text + length, size - (size_t)length,
    " -DMCOR_LANES=%d -DMCOR_DOUBLE=%d -DMCOR_W=mcor_w_%s -DMCOR_DW=mcor_dw_%s "
    "-DMCOR_DDW=mcor_ddw_%s -DMCOR_NORM=%s%s -DMCOR_SUPPORT=%s%s -DMCOR_TENSOR=%d "
    "-DMCOR_FIELD=%d -DMCOR_SOLIDS=%d",
    cl->lanes, is_double, kernels[k].name, kernels[k].name, kernels[k].name, kernels[k].norm, f,
    kernels[k].support, f, kernels[k].tensor, (int)field, build->solids);
}
