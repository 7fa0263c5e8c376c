/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_graded_topology_h
#define mcor_graded_topology_h

/* What the marching of leaves asks of topology by the field; see mcor_graded_topology.c. */

#include "mcor_internal.h"

static inline bool mcor_is_resolved(const mcor_context* context)
{
  return context->options->topology == MCOR_TOPOLOGY_FIELD;
}

/* Kernel arguments of MCOR_LEAF_DECISION_PARAMS. */
#define MCOR_LEAF_DECISION_ARGS(c)                                                                 \
  MCOR_INT(mcor_is_resolved(c)), MCOR_BUFFER(&(c)->bricks.neighbours),                             \
    MCOR_BUFFER(&(c)->topology.decisions), MCOR_BUFFER(&(c)->topology.cases),                      \
    MCOR_BUFFER(&(c)->topology.rows)

mcor_status mcor_resolve_leaves(mcor_context* context, double iso);

#endif
