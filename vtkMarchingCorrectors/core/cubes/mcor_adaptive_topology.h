/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_adaptive_topology_h
#define mcor_adaptive_topology_h

/* What the marching of leaves asks of topology by the field; see mcor_adaptive_topology.c. */

#include "mcor_internal.h"

mcor_status mcor_resolve_leaves(mcor_context* context, double iso);

#endif
