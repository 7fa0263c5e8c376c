/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Seed cells [III-C]: which cells are to be examined. A brick's mark is not 0 where it has some; with
 * complete seeds it has one bit per box of 2 x 2 x 1 cells: bit x + 2 y + 4 z. */

#define MCOR_BOXES 16
#define MCOR_BOX_GROUPS (MCOR_BOXES / MCOR_LANES)

#if MCOR_TENSOR
/* Interval of the one-dimensional w over distances [near, far]. */
void mcor_seed_interval(realv near, realv far, realv* low, realv* high)
{
  const realv a = MCOR_W(near), b = MCOR_W(far);
  *high = fmax(a, b);
  *low = (near < mcor_turning_mprime4 && far > mcor_turning_mprime4) ? (realv)mcor_lowest_mprime4
                                                                     : fmin(a, b);
}

/* Greatest (side -1) or least (side 1) w over boxes of half sizes e, e, ez around (dx, dy, dz). */
realv mcor_seed_weight(realv dx, realv dy, realv dz, real e, real ez, realv side, realv inv_h)
{
  realv xl, xh, yl, yh, zl, zh;
  mcor_seed_interval(fmax(fabs(dx) - e, (realv)0) * inv_h,
    (fabs(dx) + e) * inv_h, &xl, &xh);
  mcor_seed_interval(fmax(fabs(dy) - e, (realv)0) * inv_h,
    (fabs(dy) + e) * inv_h, &yl, &yh);
  mcor_seed_interval(
    fmax(fabs(dz) - ez, (realv)0) * inv_h, (fabs(dz) + ez) * inv_h, &zl, &zh);
  const realv al = fmin(fmin(xl * yl, xl * yh), fmin(xh * yl, xh * yh));
  const realv ah = fmax(fmax(xl * yl, xl * yh), fmax(xh * yl, xh * yh));
  return side > 0 ? fmin(fmin(al * zl, al * zh), fmin(ah * zl, ah * zh))
                  : fmax(fmax(al * zl, al * zh), fmax(ah * zl, ah * zh));
}
#else
/* Greatest (side -1) or least (side 1) w over boxes of half sizes e, e, ez around (dx, dy, dz): w
 * falls with the distance, so that of the nearest or farthest point. */
realv mcor_seed_weight(realv dx, realv dy, realv dz, real e, real ez, realv side, realv inv_h)
{
  const realv x = fmax(fabs(dx) + side * e, (realv)0);
  const realv y = fmax(fabs(dy) + side * e, (realv)0);
  const realv z = fmax(fabs(dz) + side * ez, (realv)0);
  const realv r2 = x * x + y * y + z * z;
  return MCOR_W(r2 * mcor_rsqrt(r2) * inv_h);
}
#endif

/* Whether the range of raw values decides: a Shepard mean with weights >= 0 lies between the least
 * and the greatest of its values. */
#define MCOR_RANGE_DECIDES (MCOR_FIELD == 0 && !MCOR_TENSOR)

/* Whether mcor_seed_inside has been run. */
#define MCOR_INSIDE_DECIDES (MCOR_FIELD == 2 && !MCOR_TENSOR)

void mcor_seed_box(mcor_query* query, int x, int y, int z, int size, int fix_bits)
{
  query->radius = -1;
  query->low[0] = (fix)x << fix_bits;
  query->low[1] = (fix)y << fix_bits;
  query->low[2] = (fix)z << fix_bits;
  for (int a = 0; a < 3; ++a)
  {
    query->high[a] = query->low[a] + ((fix)size << fix_bits);
  }
}

/* One work-item = one block of the whole lattice. Writes 1 where a particle may reach it or, as cells
 * need nodes there, the brick before it. */
__kernel void mcor_seed_reached(MCOR_GRID_PARAMS, const int lattice_blocks, const int blocks_x,
  const int blocks_y, __global int* flags)
{
  const int i = get_global_id(0);
  if (i >= lattice_blocks)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  mcor_query query;
  mcor_seed_box(&query, i % blocks_x * MCOR_BLOCK_CUBES - MCOR_BRICK,
    i / blocks_x % blocks_y * MCOR_BLOCK_CUBES - MCOR_BRICK,
    i / blocks_x / blocks_y * MCOR_BLOCK_CUBES - MCOR_BRICK, MCOR_BLOCK_CUBES + MCOR_BRICK,
    fix_bits);
  bool reached = false;
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool first = true; !reached && mcor_tile_next(&grid, &query, &tile, first); first = false)
  {
    reached = tile.count > 0;
  }
  flags[i] = reached;
}

/* One work-item = one block of the whole lattice. Reads the scanned flags. Writes the keys. */
__kernel void mcor_seed_reached_fill(
  const int lattice_blocks, __global const int* scanned, __global ulong* keys)
{
  const int i = get_global_id(0);
  if (i < lattice_blocks && scanned[i] != scanned[i + 1])
  {
    keys[scanned[i]] = (ulong)i;
  }
}

/* The bound. With c_j = V_j norm / h_j^3 times A_j - iso (Shepard), A_j (sum) or 1 (weight sum), the
 * field's sign against iso in a box is that of F = sum c_j w_j - level, level = 0 (Shepard) or iso, and
 *
 *   F >= sum of c_j * (least w_j in the box where c_j > 0, greatest where c_j < 0) - level,
 *
 * as each w_j lies in its interval wherever in the box the point is, whatever the sign of w_j;
 * likewise from above. Only one of the two is computed: from below where F is positive in the middle,
 * else from above. A box with F of one sign has no crossing. The margin is 1e-5 of the
 * sum of the absolute terms, above the rounding of this sum and of the node values. */
typedef struct
{
  realv x, y, z; /* centres of the boxes */
  realv sum, size;
} mcor_bound;

void mcor_seed_bound_init(mcor_bound* bounds)
{
  for (int g = 0; g < MCOR_BOX_GROUPS; ++g)
  {
    mcor_bound* b = bounds + g;
    b->sum = b->size = 0;
    for (int lane = 0; lane < MCOR_LANES; ++lane)
    {
      const int box = g * MCOR_LANES + lane;
      MCOR_SET(b->x, lane) = 1 + 2 * (box & 1);
      MCOR_SET(b->y, lane) = 1 + (box & 2);
      MCOR_SET(b->z, lane) = (real)0.5 + (box >> 2);
    }
  }
}

/* The boxes of a group that remain, as bits of a mark. below: the bound is one from below. */
uint mcor_seed_bound_mark(const mcor_bound* b, int group, bool below, real level)
{
  const realv margin = (real)1e-5f * (b->size + fabs(level));
  const fixv keep = below ? b->sum <= level + margin : b->sum >= level - margin;
  uint mark = 0;
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    mark |= (uint)(MCOR_GET_FIX(keep, lane) != 0) << (group * MCOR_LANES + lane);
  }
  return mark;
}

/* c_j of the bound. */
real mcor_seed_coefficient(const mcor_grid* grid, int j, real iso)
{
#if MCOR_FIELD == 0
  return grid->weight[j] * (grid->value[j] - iso);
#elif MCOR_FIELD == 1
  return grid->weight[j] * grid->value[j];
#else
  return grid->weight[j];
#endif
}

/* Roughly F + level in the middle of a box, with (1 - (r / support)^2)^3 for every kernel: it only
 * chooses the bound's side. */
real mcor_seed_middle(const mcor_grid* grid, const mcor_query* query, const mcor_tile* tile,
  real half_size, real iso)
{
  real sum = 0;
  for (int i = 0; i < tile->count; ++i)
  {
    const int j = tile->list[i];
    const real scale = grid->inv_h[j] / MCOR_SUPPORT;
    const real x = ((real)(grid->px[j] - query->low[0]) * grid->unit - half_size) * scale;
    const real y = ((real)(grid->py[j] - query->low[1]) * grid->unit - half_size) * scale;
    const real z = ((real)(grid->pz[j] - query->low[2]) * grid->unit - half_size) * scale;
    const real near = fmax(1 - x * x - y * y - z * z, (real)0);
    sum += mcor_seed_coefficient(grid, j, iso) * near * near * near;
  }
  return sum / ((real)0.6383 * MCOR_NORM * MCOR_SUPPORT * MCOR_SUPPORT * MCOR_SUPPORT);
}

/* Whether the particles of the tile have values on both sides; updates above and below. */
bool mcor_seed_straddles(
  const mcor_grid* grid, const mcor_tile* tile, real iso, bool* above, bool* below)
{
  for (int i = 0; i < tile->count && !(*above && *below); ++i)
  {
    const int j = tile->list[i];
    const bool fluid = !MCOR_SOLIDS || grid->weight[j] != 0;
    *above = *above || (fluid && grid->value[j] >= iso);
    *below = *below || (fluid && grid->value[j] < iso);
  }
  return *above && *below;
}

/* The bound for one box, of `size` cubes, with MCOR_LANES particles at a time: whether F may be 0, and
 * some node's weight reach the threshold. */
bool mcor_seed_region_may_cross(const mcor_grid* grid, mcor_query* query, mcor_tile* tile,
  real size, real iso, real node_threshold)
{
  const real level = MCOR_FIELD == 0 ? (real)0 : iso;
  const real e = (real)0.5 * size;
  bool above = false, under = false, below = false;
  realv sum = 0, total = 0, most_weight = 0;
  for (bool first = true; mcor_tile_next(grid, query, tile, first); first = false)
  {
    mcor_seed_straddles(grid, tile, iso, &above, &under);
    if (first)
    {
      below = mcor_seed_middle(grid, query, tile, e, iso) > level;
    }
    for (int i = 0; i < tile->count; i += MCOR_LANES)
    {
      realv x, y, z, inv_h, c, trim;
      for (int lane = 0; lane < MCOR_LANES; ++lane)
      {
        const int j = tile->list[min(i + lane, tile->count - 1)];
        MCOR_SET(x, lane) = (real)(grid->px[j] - query->low[0]) * grid->unit - e;
        MCOR_SET(y, lane) = (real)(grid->py[j] - query->low[1]) * grid->unit - e;
        MCOR_SET(z, lane) = (real)(grid->pz[j] - query->low[2]) * grid->unit - e;
        MCOR_SET(inv_h, lane) = grid->inv_h[j];
        MCOR_SET(c, lane) =
          i + lane < tile->count ? mcor_seed_coefficient(grid, j, iso) : (real)0;
        MCOR_SET(trim, lane) = i + lane < tile->count ? grid->trim_weight[j] : (real)0;
      }
      const realv side = (c > 0) == (fixv)(below ? MCOR_TRUE : 0) ? (realv)1 : (realv)-1;
      const realv w = mcor_seed_weight(x, y, z, e, e, side, inv_h);
      sum += c * w;
      total += fabs(c) * fabs(w);
      if (MCOR_FIELD != 2)
      {
        most_weight += trim * mcor_seed_weight(x, y, z, e, e, (realv)-1, inv_h);
      }
    }
  }
  real s = 0, t = 0, m = 0;
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    s += MCOR_GET(sum, lane);
    t += MCOR_GET(total, lane);
    m += MCOR_GET(most_weight, lane);
  }
  const real margin = (real)1e-5f * (t + fabs(level));
  const bool may = below ? s <= level + margin : s >= level - margin;
  const bool valid = MCOR_FIELD == 2 || m >= node_threshold * (real)0.9999;
  return may && valid && (!MCOR_RANGE_DECIDES || (above && under));
}

/* Blocks, and regions of 8^3 cubes in them, come before bricks: where smoothing lengths are many
 * cubes, a bound on a large box is tight already. */
#define MCOR_REGION_CUBES 8
#define MCOR_BLOCK_REGIONS 64

/* Region of the brick with mark m. */
int mcor_seed_region_of(int m)
{
  const int region = (m >> 1 & 3) | (m >> 4 & 3) << 2 | (m >> 7 & 3) << 4;
  return m / MCOR_BLOCK_BRICKS * MCOR_BLOCK_REGIONS + region;
}

/* One work-item = one region of `size` cubes: a block (32), or one of its 64 regions (8), x fastest.
 * Reads the particles that reach it, and what is known of the blocks. Writes whether the iso value
 * may occur in it. */
__kernel void mcor_seed_region(MCOR_GRID_PARAMS, const int block_count, const int blocks_x,
  const int blocks_y, __global const ulong* block_keys, const int size,
  __global const uchar* block_keep, const real iso, const real node_threshold,
  __global uchar* keep)
{
  const int i = get_global_id(0);
  const int regions = size == MCOR_BLOCK_CUBES ? 1 : MCOR_BLOCK_REGIONS;
  const int block = i / regions, r = i % regions;
  if (block >= block_count)
  {
    return;
  }
  if (regions > 1 && !block_keep[block])
  {
    keep[i] = 0;
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const int4 brick =
    mcor_brick_of_mark(block_keys, blocks_x, blocks_y, block * MCOR_BLOCK_BRICKS);
  mcor_query query;
  mcor_seed_box(&query, brick.x * MCOR_BRICK + (r & 3) * size,
    brick.y * MCOR_BRICK + (r >> 2 & 3) * size, brick.z * MCOR_BRICK + (r >> 4) * size, size,
    fix_bits);
  mcor_tile tile;
  mcor_tile_init(&tile);
  keep[i] = mcor_seed_region_may_cross(&grid, &query, &tile, (real)size, iso, node_threshold);
}

/* One work-item = one brick (of all in blocks), for the weight sum of a kernel w >= 0. Reads the
 * particles within half the support of its nodes, an eighth of all, which make up most of the sum
 * there. Writes whether they alone lift all 64 nodes to the iso value: the rest can only add. The
 * margin is above rounding. Far inside the fluid, this is all that is ever evaluated. */
__kernel void mcor_seed_inside(MCOR_GRID_PARAMS, const int block_count, const int blocks_x,
  const int blocks_y, __global const ulong* block_keys, __global const uchar* keep, const real iso,
  __global uchar* inside)
{
  const int m = get_global_id(0);
  if (m >= block_count * MCOR_BLOCK_BRICKS)
  {
    return;
  }
  /* A region without the iso value is not examined, whatever is said of it here. */
  inside[m] = 1;
  if (!keep[mcor_seed_region_of(m)])
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const int4 brick = mcor_brick_of_mark(block_keys, blocks_x, blocks_y, m);
  mcor_query query;
  mcor_seed_box(
    &query, brick.x * MCOR_BRICK, brick.y * MCOR_BRICK, brick.z * MCOR_BRICK, 3, fix_bits);
  query.radius = -0.5f;
  mcor_node_sums sums;
  mcor_node_sum(&grid, &query, query.low[2], ~0UL, &sums);
  fixv lowest_is_above = sums.w[0] > iso * (real)1.0001f;
  for (int g = 1; g < MCOR_NODE_GROUPS; ++g)
  {
    lowest_is_above = lowest_is_above && sums.w[g] > iso * (real)1.0001f;
  }
  inside[m] = MCOR_ALL(lowest_is_above) ? 1 : 0;
}

/* Whether a brick's cells have all their nodes inside: its own, and those of its upper neighbours. */
bool mcor_seed_is_inside(MCOR_BLOCK_PARAMS, int4 brick, __global const uchar* inside)
{
  for (int d = 0; d < 8; ++d)
  {
    const int m = mcor_find_mark(
      MCOR_BLOCK_ARGS, brick.x + (d & 1), brick.y + (d >> 1 & 1), brick.z + (d >> 2));
    if (m < 0 || !inside[m])
    {
      return false;
    }
  }
  return true;
}

/* One work-item = one brick (of all in blocks). Reads the particles that reach its cells. Writes its
 * mark: the boxes in which the bound admits a crossing. */
__kernel void mcor_seed_brick(MCOR_GRID_PARAMS, MCOR_BLOCK_PARAMS, __global const uchar* keep,
  __global const uchar* inside, const real iso, __global ushort* marks)
{
  const int m = get_global_id(0);
  if (m >= block_count * MCOR_BLOCK_BRICKS || !keep[mcor_seed_region_of(m)])
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const real level = MCOR_FIELD == 0 ? (real)0 : iso;
  const int4 brick = mcor_brick_of_mark(block_keys, blocks_x, blocks_y, m);
  if (MCOR_INSIDE_DECIDES && mcor_seed_is_inside(MCOR_BLOCK_ARGS, brick, inside))
  {
    return;
  }
  mcor_query query;
  mcor_seed_box(&query, brick.x * MCOR_BRICK, brick.y * MCOR_BRICK, brick.z * MCOR_BRICK,
    MCOR_BRICK, fix_bits);
  mcor_bound bounds[MCOR_BOX_GROUPS];
  mcor_seed_bound_init(bounds);
  bool above = false, under = false, below = false;
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool first = true; mcor_tile_next(&grid, &query, &tile, first); first = false)
  {
    const bool straddles = mcor_seed_straddles(&grid, &tile, iso, &above, &under);
    if (tile.complete && (tile.count == 0 || (MCOR_RANGE_DECIDES && !straddles)))
    {
      return;
    }
    if (MCOR_TENSOR)
    {
      /* With negative lobes the bound excludes next to nothing at this size, and costs more than the
       * nodes. */
      marks[m] = 0xffff;
      return;
    }
    if (first)
    {
      below = mcor_seed_middle(&grid, &query, &tile, (real)0.5 * MCOR_BRICK, iso) > level;
    }
    for (int i = 0; i < tile.count; ++i)
    {
      const int j = tile.list[i];
      const real x = (real)(px[j] - query.low[0]) * grid.unit;
      const real y = (real)(py[j] - query.low[1]) * grid.unit;
      const real z = (real)(pz[j] - query.low[2]) * grid.unit;
      const real c = mcor_seed_coefficient(&grid, j, iso);
      const real side = (c > 0) == below ? 1 : -1;
      for (int g = 0; g < MCOR_BOX_GROUPS; ++g)
      {
        mcor_bound* b = bounds + g;
        const realv w = mcor_seed_weight(
          x - b->x, y - b->y, z - b->z, 1, (real)0.5, (realv)side, (realv)p_inv_h[j]);
        b->sum += c * w;
        b->size += fabs(c) * fabs(w);
      }
    }
  }
  uint mark = 0;
  for (int g = 0; g < MCOR_BOX_GROUPS; ++g)
  {
    mark |= mcor_seed_bound_mark(bounds + g, g, below, level);
  }
  marks[m] = (MCOR_RANGE_DECIDES && !(above && under)) ? 0 : (ushort)mark;
}

/* One work-item = one brick slot. Reads its mark. Writes the cells to examine. */
__kernel void mcor_seed_cells(MCOR_BLOCK_PARAMS, const int brick_count,
  __global const int4* bricks, __global const ushort* marks, __global ulong* cells)
{
  const int slot = get_global_id(0);
  if (slot >= brick_count)
  {
    return;
  }
  const int m = mcor_find_mark(MCOR_BLOCK_ARGS, bricks[slot].x, bricks[slot].y, bricks[slot].z);
  ulong mask = 0;
  for (int box = 0; box < MCOR_BOXES; ++box)
  {
    if (marks[m] >> box & 1)
    {
      mask |= 0x33UL << (2 * (box & 1) + 4 * (box & 2) + 16 * (box >> 2));
    }
  }
  cells[slot] = mask;
}
