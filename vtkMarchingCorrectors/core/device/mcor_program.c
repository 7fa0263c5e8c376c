/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compilers take long. Therefore a program holds little that a run does not need. Kernels that do
 * not depend on the SPH kernel, the field or solids are compiled once for all of these. */

#include "mcor_program.h"
#include "mcor_internal.h"

#include <stdio.h>
#include <string.h>

/* Beginnings of kernels' names, without "mcor_"; the first that fits counts. */
static const struct
{
  const char* begin;
  mcor_program program;
} mcor_kernel_programs[] = { { "grid_density", MCOR_PROGRAM_DENSITY },
  { "grid_weight", MCOR_PROGRAM_DENSITY },
  { "seed_request", MCOR_PROGRAM_BRICKS }, { "seed_grow", MCOR_PROGRAM_BRICKS },
  { "seed_", MCOR_PROGRAM_NODES }, { "node_", MCOR_PROGRAM_NODES },
  { "block_states", MCOR_PROGRAM_NODES }, { "block_", MCOR_PROGRAM_BRICKS },
  { "brick_", MCOR_PROGRAM_BRICKS }, { "march_", MCOR_PROGRAM_CELLS },
  { "trim_margin", MCOR_PROGRAM_TRIM }, { "trim_linear", MCOR_PROGRAM_TRIM },
  { "trim_solve", MCOR_PROGRAM_TRIM }, { "trim_", MCOR_PROGRAM_CELLS },
  { "correct_", MCOR_PROGRAM_VERTICES }, { "field_", MCOR_PROGRAM_SHAPE },
  { "attribute_", MCOR_PROGRAM_ATTRIBUTES }, { "leaf_", MCOR_PROGRAM_LEAVES },
  { "plane_nodes", MCOR_PROGRAM_RARE }, { "pair_seed", MCOR_PROGRAM_RARE },
  { "boundary_", MCOR_PROGRAM_SHAPE }, { "curvature_", MCOR_PROGRAM_SHAPE },
  { "plane_", MCOR_PROGRAM_CELLS }, { "topology_", MCOR_PROGRAM_CHOICES },
  { "box_", MCOR_PROGRAM_CHOICES }, { "pair_", MCOR_PROGRAM_CHOICES },
  { "probe_", MCOR_PROGRAM_PROBE }, { "derive_", MCOR_PROGRAM_PROBE },
  { "widen_", MCOR_PROGRAM_PROBE }, { "", MCOR_PROGRAM_GRID } };

int mcor_parts_of(const mcor_cl* cl, mcor_program program)
{
  return !cl->builds_sets           ? 1 << program
    : program == MCOR_PROGRAM_GRID  ? MCOR_PARTS_LATTICE
    : program == MCOR_PROGRAM_NODES ? MCOR_PARTS_FIELD
    : program == MCOR_PROGRAM_PROBE ? MCOR_PARTS_PROBE
                                    : 0;
}

mcor_program mcor_program_of(const mcor_cl* cl, const char* kernel)
{
  const char* name = kernel + strlen("mcor_");
  int i = 0, program = 0;
  while (strncmp(name, mcor_kernel_programs[i].begin, strlen(mcor_kernel_programs[i].begin)) != 0)
  {
    ++i;
  }
  while (!(mcor_parts_of(cl, (mcor_program)program) >> mcor_kernel_programs[i].program & 1))
  {
    ++program;
  }
  return (mcor_program)program;
}

int mcor_program_sources(const mcor_cl* cl, int programs, const char* sources[MCOR_SOURCE_LIMIT])
{
  int count = 0;
  for (const mcor_kernel_source* s = mcor_kernel_sources; s->text; ++s)
  {
    if ((s->programs & programs) && s->form != (cl->lanes > 1 ? MCOR_GPU_FORM : MCOR_CPU_FORM))
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
  const int set = 1 << program,
            number = set & MCOR_PARTS_LATTICE ? 0
    : set & MCOR_PARTS_FIELD                  ? 1
                                              : 2;
  /* Programs that do not depend on the field are compiled as for a free surface. In the form for
   * GPUs (one lane), the program for probes does not depend on solids either. */
  const int without_field =
    1 << MCOR_PROGRAM_ATTRIBUTES | 1 << MCOR_PROGRAM_DENSITY | MCOR_PARTS_PROBE;
  const mcor_field field = set & without_field ? MCOR_WEIGHT_SUM : build->field;
  const bool solids = build->solids && !(set & MCOR_PARTS_PROBE && cl->lanes == 1);
  const char* f = is_double ? "" : "f";
  int length = snprintf(text, size, "-w -cl-std=CL1.2 -cl-kernel-arg-info%s -DMCOR_PROGRAM=%d",
    cl->rounds_division ? " -cl-fp32-correctly-rounded-divide-sqrt" : "", number);
  if (number == 0)
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
    kernel->support_text, f, kernel->is_tensor, (int)field, solids);
}
