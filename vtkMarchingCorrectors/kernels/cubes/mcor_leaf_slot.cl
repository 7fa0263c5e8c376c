/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the nodes of leaves that may have surface. Values and masks of a leaf's nodes are
 * in slots of several bricks: the leaf itself, the bricks that own the nodes on the leaf's far
 * sides (towards larger x, y or z), and finer bricks around the leaf. */

#define MCOR_WANTED_IN_PLANE (0xfUL | 0x1ffUL << 8)

/* Returns the bricks whose nodes a leaf needs, as bits. Bit d = 0 to 7 is the brick of the leaf's
 * level that is one brick up along x (if bit 0 of d is set), y (bit 1) and z (bit 2). Bit 8 + x + 3
 * y + 9 z, with x, y and z from 0 to 2, is a brick of the finer level: the brick that is x, y, z
 * finer bricks up from the leaf's lowest corner. If a brick beyond a far side of the leaf is split,
 * its finer bricks own the leaf's nodes on that side. In a plane, only bricks of the plane's layer
 * are needed. */
ulong mcor_leaf_wanted(uint finer, int plane)
{
  ulong wanted = 0;
  for (int d = 0; d < 8; ++d)
  {
    const uint at = MCOR_DIRECTION(1 + (d & 1), 1 + (d >> 1 & 1), 1 + (d >> 2));
    wanted |= (finer >> at & 1) ? 0 : 1UL << d;
  }
  wanted |= (ulong)mcor_leaf_hanging(finer) << 8;
  return plane ? wanted & MCOR_WANTED_IN_PLANE : wanted;
}

/* Returns the brick of bit b of mcor_leaf_wanted. */
int4 mcor_leaf_wanted_brick(int4 leaf, int b)
{
  const int f = b - 8;
  return b < 8 ? leaf + mcor_up(b)
               : (int4)(2 * leaf.x + f % 3, 2 * leaf.y + f / 3 % 3, 2 * leaf.z + f / 9, leaf.w - 1);
}

/* One work-item = one leaf. Requests the bricks that the leaf needs. */
__kernel void mcor_leaf_request(MCOR_BLOCK_PARAMS, const int count, const int plane,
  __global const int4* cells, __global const uint* finer, __global uint* brick_bits)
{
  MCOR_ITEM(i, i < count);
  for (ulong rest = mcor_leaf_wanted(finer[i], plane); rest; rest &= rest - 1)
  {
    const int4 brick = mcor_leaf_wanted_brick(cells[i], mcor_ctz(rest));
    mcor_request_brick(brick_bits, mcor_brick_number(MCOR_BLOCK_ARGS, brick));
  }
}

/* One work-item = one leaf. Writes the slots of the bricks that the leaf needs, and -1 for other
 * bricks. */
__kernel void mcor_leaf_tables(MCOR_BRICK_PARAMS, const int count, const int plane,
  __global const int4* cells, __global const uint* finer, __global int* tables)
{
  MCOR_ITEM(i, i < count);
  const ulong wanted = mcor_leaf_wanted(finer[i], plane);
  for (int b = 0; b < MCOR_LEAF_SLOTS; ++b)
  {
    tables[i * (long)MCOR_LEAF_SLOTS + b] =
      wanted >> b & 1 ? mcor_find_brick(MCOR_BRICK_ARGS, mcor_leaf_wanted_brick(cells[i], b)) : -1;
  }
}

/* One work-item = one slot. Writes to `proofs` the state of the slot's brick, or MCOR_EXAMINE if
 * the brick is no leaf. If the state is certain and the nodes' values are not known, the state
 * decides which nodes are above and valid. */
__kernel void mcor_leaf_take(MCOR_BLOCK_PARAMS, const int slot_count, __global const int4* bricks,
  __global const uint* leaves, __global const uchar* states, __global const ulong* known,
  __global uchar* proofs, __global ulong* above, __global ulong* valid)
{
  MCOR_ITEM(slot, slot < slot_count);
  const int m = mcor_brick_number(MCOR_BLOCK_ARGS, bricks[slot]);
  const int state = mcor_has_brick(leaves, m) ? states[m] & MCOR_EXAMINE : MCOR_EXAMINE;
  proofs[slot] = (uchar)state;
  if (MCOR_IS_CERTAIN(state) && !known[slot])
  {
    above[slot] = state == MCOR_ABOVE ? ~0UL : 0;
    valid[slot] = state == MCOR_VOID ? 0 : ~0UL;
  }
}

/* Marks the slots whose node values a leaf's crossed cells need. A crossed cell is valid at all
 * corners, and has corners on both sides of the iso value. Returns whether the leaf has crossed
 * cells. Must not be called for a leaf beside finer leaves. */
bool mcor_leaf_need_plain(__global const int* slots, __global const ulong* above,
  __global const ulong* valid, __global ulong* need)
{
  ulong a[8], v[8];
  for (int d = 0; d < 8; ++d)
  {
    a[d] = above[slots[d]];
    v[d] = valid[slots[d]];
  }
  mcor_cell_corners(a);
  mcor_cell_corners(v);
  const ulong crossed = mcor_cells_crossed(a, v);
  for (int d = 0; d < 8 && crossed; ++d)
  {
    if (mcor_cells_reach(crossed, d))
    {
      need[slots[d]] = ~0UL;
    }
  }
  return crossed != 0;
}

/* One work-item = one leaf. Writes to `mixed` whether the leaf may have surface. In space, a leaf
 * without finer leaves around it may have surface if it has crossed cells. Any other leaf may have
 * surface if the bricks that it needs have valid nodes on both sides of the iso value. Marks the
 * slots whose values the cells of a mixed leaf need, even slots whose sides are certain. Several
 * leaves may mark one slot. */
__kernel void mcor_leaf_need(const int count, const int plane, __global const uint* finer,
  __global const int* tables, __global const ulong* above, __global const ulong* valid,
  __global uchar* mixed, __global ulong* need)
{
  MCOR_ITEM(i, i < count);
  __global const int* slots = tables + i * (long)MCOR_LEAF_SLOTS;
  if (finer[i] == 0 && !plane)
  {
    mixed[i] = mcor_leaf_need_plain(slots, above, valid, need);
    return;
  }
  int sides = 0;
  for (int b = 0; b < MCOR_LEAF_SLOTS && sides != MCOR_EXAMINE; ++b)
  {
    const ulong a = slots[b] < 0 ? 0 : above[slots[b]], v = slots[b] < 0 ? 0 : valid[slots[b]];
    sides |= (a & v ? MCOR_ABOVE : 0) | (~a & v ? MCOR_BELOW : 0);
  }
  mixed[i] = sides == MCOR_EXAMINE;
  for (int b = 0; b < MCOR_LEAF_SLOTS && sides == MCOR_EXAMINE; ++b)
  {
    if (slots[b] >= 0)
    {
      need[slots[b]] = ~0UL;
    }
  }
}
