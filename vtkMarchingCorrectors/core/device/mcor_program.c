/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compilers take long. So a program holds little that a run does not need, and what depends
 * neither on the SPH kernel nor on the field or solids is compiled once for all of them. */

#include "mcor_program.h"
#include "mcor_internal.h"

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

void mcor_name_build(const mcor_build* build, char* text, size_t size)
{
  const bool is_double = build->precision == MCOR_FLOAT64;
  const char* kernel = mcor_kernel_of(build->sph_kernel)->name;
  snprintf(text, size, "the SPH kernel %s%s", kernel, is_double ? " in double precision" : "");
}

void mcor_program_options(const mcor_cl* cl, mcor_program program, char* text, size_t size)
{
  const mcor_build* build = &cl->build;
  const mcor_kernel_row* kernel = mcor_kernel_of(build->sph_kernel);
  const bool is_double = build->precision == MCOR_FLOAT64;
  /* Probes sum any arrays, not the scalar to contour, so their program is compiled for one
   * field. */
  const mcor_field field = program == MCOR_PROGRAM_PROBE ? MCOR_WEIGHT_SUM : build->field;
  const char* f = is_double ? "" : "f";
  int length = snprintf(text, size, "-w -cl-std=CL1.2 -cl-kernel-arg-info%s -DMCOR_PROGRAM=%d",
    cl->rounds_division ? " -cl-fp32-correctly-rounded-divide-sqrt" : "", (int)program);
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
    cl->lanes, is_double, kernel->name, kernel->name, kernel->name, kernel->norm_text, f,
    kernel->support_text, f, kernel->is_tensor, (int)field, build->solids);
}
