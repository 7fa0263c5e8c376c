/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Keys of the surface's points. A key depends on its vertex alone, not on the part of the
 * surface that a call makes, and keys ascend in the order of the whole surface's points. */

#include "mcor_adaptive.h"
#include "mcor_cap.h"
#include "mcor_tree.h"

#include <string.h>

uint64_t mcor_node_key(const mcor_lattice* lattice, const cl_int node[4])
{
  uint64_t block = 0, inner = 0;
  for (int a = 2; a >= 0; --a)
  {
    block = block * (uint64_t)lattice->blocks[a] + (uint64_t)(node[a] / MCOR_BLOCK_CUBES);
  }
  for (int bits = 3, shift = 2; shift >= 0; bits = 2, shift -= 2)
  {
    for (int a = 2; a >= 0; --a)
    {
      inner = inner << bits | (uint64_t)(node[a] >> shift & ((1 << bits) - 1));
    }
  }
  return block << 15 | inner;
}

/* Computes a node's key with adaptive cubes: the key of its brick at its level, then the node;
 * see MCOR_TREE_KEY_BITS. */
static uint64_t mcor_adaptive_node_key(const mcor_tree* tree, const cl_int node[4])
{
  const int brick[3] = { node[0] / MCOR_BRICK, node[1] / MCOR_BRICK, node[2] / MCOR_BRICK };
  const uint64_t key = mcor_tree_key(&tree->rungs[node[3] >> MCOR_LEVEL_SHIFT], brick);
  const int inner = node[0] % MCOR_BRICK + MCOR_BRICK * (node[1] % MCOR_BRICK) +
    MCOR_BRICK * MCOR_BRICK * (node[2] % MCOR_BRICK);
  return key << 6 | (uint64_t)inner;
}

/* Stores a vertex's key: by node, then axis. The two vertices of a pinched edge follow each
 * other. */
static uint64_t mcor_march_key(const mcor_context* context, const cl_int* nodes, int64_t v)
{
  const cl_int* node = nodes + 4 * v;
  const bool copy = v > 0 && memcmp(node, node - 4, 4 * sizeof *node) == 0;
  const uint64_t key = mcor_is_adaptive(context) ? mcor_adaptive_node_key(&context->tree, node)
                                                 : mcor_node_key(&context->lattice, node);
  return key << 3 | (uint64_t)(node[3] & 3) << 1 | (uint64_t)copy;
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
