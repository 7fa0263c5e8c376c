/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compilers take their time, so a program holds little that a run does not need, and what does not
 * depend on the SPH kernel, the field or solids is compiled once for all of them. */

#include "mcor_program.h"
#include "mcor_internal.h"
#include "mcor_sph_kernel.h"

#include <stdio.h>
#include <string.h>

/* Programs that a source is part of. Of sources of several, `#if MCOR_PROGRAM` says which kernels
 * are whose. */
enum
{
  LATTICE = 1 << MCOR_PROGRAM_LATTICE,
  FIELD = 1 << MCOR_PROGRAM_FIELD,
  OPTIONS = 1 << MCOR_PROGRAM_OPTIONS,
  PROBE = 1 << MCOR_PROGRAM_PROBE,
  GRADED = 1 << MCOR_PROGRAM_GRADED
};

int mcor_program_sources(
  const mcor_cl* cl, mcor_program program, const char* sources[MCOR_SOURCE_LIMIT])
{
  /* The free surface is not trimmed. */
  const int trim = cl->build.field == MCOR_WEIGHT_SUM ? OPTIONS : FIELD;
  const bool vectors = cl->lanes > 1;
  const struct
  {
    const char* text;
    int programs;
  } all[] = { { mcor_source_mcor_shared_h, LATTICE | FIELD | OPTIONS | PROBE | GRADED },
    { mcor_source_mcor_builtin_cl, LATTICE | FIELD | OPTIONS | PROBE | GRADED },
    { mcor_source_mcor_prelude_cl, LATTICE | FIELD | OPTIONS | PROBE | GRADED },
    { mcor_source_mcor_intrinsic_cl, LATTICE | FIELD | OPTIONS | PROBE | GRADED },
    { mcor_source_mcor_sph_kernel_h, FIELD | OPTIONS | PROBE | GRADED },
    { mcor_source_mcor_field_cl, FIELD | OPTIONS | PROBE | GRADED },
    { mcor_source_mcor_query_cl, FIELD | OPTIONS | PROBE | GRADED },
    { mcor_source_mcor_points_cl, FIELD | OPTIONS | PROBE | GRADED },
    { vectors ? mcor_source_mcor_gather_lanes_cl : mcor_source_mcor_gather_point_cl,
      FIELD | OPTIONS | PROBE | GRADED },
    { mcor_source_mcor_scan_cl, LATTICE }, { mcor_source_mcor_grid_cl, LATTICE | FIELD },
    { mcor_source_mcor_brick_cl, LATTICE | FIELD | OPTIONS | GRADED },
    { mcor_source_mcor_node_cl, FIELD | OPTIONS | GRADED },
    { vectors ? mcor_source_mcor_node_lanes_cl : mcor_source_mcor_node_point_cl,
      FIELD | OPTIONS | GRADED },
    { mcor_source_mcor_bound_cl, FIELD | OPTIONS | GRADED },
    { mcor_source_mcor_seed_cl, LATTICE | FIELD | OPTIONS | GRADED },
    { mcor_source_mcor_block_cl, LATTICE | FIELD },
    { mcor_source_mcor_topology_row_cl, LATTICE | FIELD | OPTIONS | GRADED },
    { mcor_source_mcor_march_cl, LATTICE | FIELD | OPTIONS | GRADED },
    { mcor_source_mcor_attribute_cl, FIELD | OPTIONS | PROBE },
    { mcor_source_mcor_evaluate_cl, FIELD | OPTIONS },
    { mcor_source_mcor_correct_cl, FIELD | OPTIONS }, { mcor_source_mcor_topology_cl, OPTIONS },
    { mcor_source_mcor_boundary_cl, trim | OPTIONS }, { mcor_source_mcor_trim_cl, LATTICE | trim },
    { mcor_source_mcor_box_cl, LATTICE | FIELD }, { mcor_source_mcor_cap_cl, OPTIONS },
    { mcor_source_mcor_probe_cl, PROBE },
    { vectors ? mcor_source_mcor_probe_lanes_cl : mcor_source_mcor_probe_point_cl, PROBE },
    { mcor_source_mcor_derive_cl, PROBE }, { mcor_source_mcor_graded_cell_h, GRADED },
    { mcor_source_mcor_graded_seed_cl, GRADED }, { mcor_source_mcor_graded_cl, GRADED },
    { mcor_source_mcor_graded_march_cl, GRADED }, { mcor_source_mcor_graded_topology_cl, GRADED },
    { mcor_source_mcor_graded_pair_cl, GRADED }, { mcor_source_mcor_pair_cl, OPTIONS | GRADED },
    { mcor_source_mcor_end_cl, LATTICE } };
  int count = 0;
  for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
  {
    if (all[i].programs >> program & 1)
    {
      sources[count++] = all[i].text;
    }
  }
  return count;
}

bool mcor_program_may_have(mcor_program program, const char* kernel)
{
  const bool is_probe =
    strncmp(kernel, "mcor_probe_", 11) == 0 || strncmp(kernel, "mcor_derive_", 12) == 0;
  const bool is_graded = strncmp(kernel, "mcor_graded_", 12) == 0;
  return is_probe == (program == MCOR_PROGRAM_PROBE) &&
    is_graded == (program == MCOR_PROGRAM_GRADED);
}

void mcor_program_options(const mcor_cl* cl, mcor_program program, char* text, size_t size)
{
#define MCOR_ENTRY(id, name, support, norm, tensor) { #name, #norm, support, tensor },
  static const struct
  {
    const char *name, *norm;
    int support, tensor;
  } kernels[] = { MCOR_SPH_KERNEL_TABLE(MCOR_ENTRY) };
#undef MCOR_ENTRY
  const mcor_build* build = &cl->build;
  const int k = (int)build->sph_kernel;
  const bool is_double = build->precision == MCOR_FLOAT64;
  const char* f = is_double ? "" : "f";
  int length = snprintf(text, size, "-w -cl-std=CL1.2 -cl-kernel-arg-info%s%s -DMCOR_PROGRAM=%d",
    cl->rounds_division ? " -cl-fp32-correctly-rounded-divide-sqrt" : "",
    cl->declares_builtins ? " -D_OPENCL_H_ -DMCOR_DECLARES_BUILTINS=1" : "", (int)program);
  if (program == MCOR_PROGRAM_LATTICE)
  {
    /* It knows no vectors, only whether to work for a CPU. */
    snprintf(text + length, size - (size_t)length, " -DMCOR_LANES=%d -DMCOR_DOUBLE=%d",
      cl->lanes == 1 ? 1 : 8, is_double);
    return;
  }
  snprintf(text + length, size - (size_t)length,
    " -DMCOR_LANES=%d -DMCOR_DOUBLE=%d -DMCOR_W=mcor_w_%s -DMCOR_DW=mcor_dw_%s "
    "-DMCOR_DDW=mcor_ddw_%s -DMCOR_NORM=%s%s -DMCOR_SUPPORT=%d.0%s -DMCOR_TENSOR=%d "
    "-DMCOR_FIELD=%d -DMCOR_SOLIDS=%d",
    cl->lanes, is_double, kernels[k].name, kernels[k].name, kernels[k].name, kernels[k].norm, f,
    kernels[k].support, f, kernels[k].tensor, (int)build->field, build->solids);
}
