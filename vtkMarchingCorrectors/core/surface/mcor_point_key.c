/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Keys of the surface's points. A key depends on its vertex alone, not on the part of the
 * surface that a call makes, and keys ascend in the order of the whole surface's points. */

#include "mcor_cap.h"

#include <string.h>

uint64_t mcor_node_key(const mcor_lattice* lattice, const cl_int node[4])
{
  const int brick[3] = { node[0] / MCOR_BRICK, node[1] / MCOR_BRICK, node[2] / MCOR_BRICK };
  const int inner = node[0] % MCOR_BRICK + MCOR_BRICK * (node[1] % MCOR_BRICK) +
    MCOR_BRICK * MCOR_BRICK * (node[2] % MCOR_BRICK);
  const mcor_rung* rung = &lattice->rungs[node[3] >> MCOR_LEVEL_SHIFT];
  return mcor_brick_key(rung, brick) << 6 | (uint64_t)inner;
}

/* Stores a vertex's key: by node, then axis. The two vertices of a pinched edge follow each
 * other. */
static uint64_t mcor_march_key(const mcor_context* context, const cl_int* nodes, int64_t v)
{
  const cl_int* node = nodes + 4 * v;
  const bool copy = v > 0 && memcmp(node, node - 4, 4 * sizeof *node) == 0;
  return mcor_node_key(&context->lattice, node) << 3 | (uint64_t)(node[3] & 3) << 1 |
    (uint64_t)copy;
}

void mcor_store_point_key(const mcor_context* context, const cl_int* nodes, const uint64_t* cuts,
  int64_t v, uint64_t key[MCOR_POINT_KEY])
{
  const int64_t cut = v - context->mesh.march_count;
  const bool of_cap = mcor_is_cap(context, v);
  key[0] = 3 * (uint64_t)context->run.iso.number + (of_cap ? 2 : cut >= 0);
  if (of_cap)
  {
    memcpy(key + 1, context->mesh.cap_keys + 2 * (v - context->mesh.cap_first), 2 * sizeof *key);
    return;
  }
  key[1] = mcor_march_key(context, nodes, cut < 0 ? v : (int64_t)(cuts[cut] >> 32));
  key[2] = cut < 0 ? 0 : mcor_march_key(context, nodes, (int64_t)(cuts[cut] & UINT32_MAX));
}
