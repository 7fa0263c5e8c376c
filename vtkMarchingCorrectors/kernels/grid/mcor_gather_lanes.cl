/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Gathers particles for MCOR_LANES points at once, in the form for CPUs; the end of mcor_query.cl
 * describes the interface. */

/* Most particles that one gather collects before they are evaluated. */
#define MCOR_TILE_SIZE 1024

/* Alignment of arrays that are read MCOR_LANES elements at a time, so that no access touches two
 * cache lines. */
#define MCOR_ALIGNED __attribute__((aligned(sizeof(real) * MCOR_LANES)))

/* Copies of the particles that reach a query's box, MCOR_TILE_SIZE at a time. */
typedef struct
{
  int count;
  bool complete;  /* the tile holds all particles of the query */
  bool delivered; /* no particles are left to gather */
  MCOR_ALIGNED int list[MCOR_TILE_SIZE + 16];
  /* positions, in cubes from the query's origin */
  MCOR_ALIGNED real x[MCOR_TILE_SIZE + 16], y[MCOR_TILE_SIZE + 16], z[MCOR_TILE_SIZE + 16];
  real inv_h[MCOR_TILE_SIZE + 16], weight[MCOR_TILE_SIZE + 16], value[MCOR_TILE_SIZE + 16];
#if MCOR_SOLIDS
  real trim_weight[MCOR_TILE_SIZE + 16];
#endif
} mcor_tile;

/* MCOR_TILE reads particles i, i + 1, ... of a tile, one in each lane. MCOR_EACH reads particle i
 * for all lanes. MCOR_INDEX is the index of particle i in the sorted arrays. */
#define MCOR_TILE(tile, name, i) MCOR_LOAD(i, (tile)->name)
#define MCOR_EACH(tile, name, i) ((tile)->name[i])
#define MCOR_INDEX(tile, i) ((tile)->list[i])

int mcor_list_lanes(fixv chosen, int count, int lanes[MCOR_LANES])
{
  const mcor_mask mask = MCOR_MASK(chosen, count);
  MCOR_PACK_INDEX(mask, 0, lanes);
  return MCOR_MASK_COUNT(mask);
}

void mcor_tile_init(mcor_tile* tile)
{
  tile->complete = false;
}

/* Whether particles at (x, y, z) are nearer to a box than `share` times their support. The margin
 * of 1.0001 covers rounding; a particle that does not reach the box adds exactly 0. */
fixv mcor_near_box(realv x, realv y, realv z, realv inv_h, const mcor_span* box, realv share)
{
  const realv dx = fmax(fabs(x - box->center[0]) - box->half_size[0], (realv)0);
  const realv dy = fmax(fabs(y - box->center[1]) - box->half_size[1], (realv)0);
  const realv dz = fmax(fabs(z - box->center[2]) - box->half_size[2], (realv)0);
#if MCOR_TENSOR
  return fmax(dx, fmax(dy, dz)) * inv_h < share * (MCOR_SUPPORT * (real)1.0001);
#else
  return mcor_square(dx, dy, dz) * inv_h * inv_h <
    share * share * (MCOR_SUPPORT * MCOR_SUPPORT * (real)1.0001);
#endif
}

/* Returns which of a tile's particles i, i + 1, ... are nearer to a box than `share` times their
 * support. */
fixv mcor_tile_near(const mcor_tile* tile, int i, const mcor_span* box, realv share)
{
  return mcor_near_box(MCOR_TILE(tile, x, i), MCOR_TILE(tile, y, i), MCOR_TILE(tile, z, i),
    MCOR_TILE(tile, inv_h, i), box, share);
}

/* Lists which of a tile's particles are nearer to a box than `share` times their support, by their
 * places in the tile. Returns the number of these particles. */
int mcor_tile_list(const mcor_tile* tile, const mcor_span* box, realv share, int* list)
{
  int count = 0;
  for (int i = 0; i < tile->count; i += MCOR_LANES)
  {
    const mcor_mask mask =
      MCOR_MASK(mcor_tile_near(tile, i, box, share), min(MCOR_LANES, tile->count - i));
    MCOR_PACK_INDEX(mask, i, list + count);
    count += MCOR_MASK_COUNT(mask);
  }
  return count;
}

/* Stores the particles of a mask in the tile from place `count` on. Leaves the tile's `list` and
 * `count` unchanged. */
void mcor_tile_pack(const mcor_mask* mask, realv x, realv y, realv z, realv inv_h, realv weight,
  realv value, realv trim_weight, int count, mcor_tile* tile)
{
  MCOR_PACK_REAL(*mask, x, tile->x + count);
  MCOR_PACK_REAL(*mask, y, tile->y + count);
  MCOR_PACK_REAL(*mask, z, tile->z + count);
  MCOR_PACK_REAL(*mask, inv_h, tile->inv_h + count);
  MCOR_PACK_REAL(*mask, weight, tile->weight + count);
#if MCOR_FIELD != MCOR_WEIGHT_SUM
  MCOR_PACK_REAL(*mask, value, tile->value + count);
#endif
#if MCOR_SOLIDS
  MCOR_PACK_REAL(*mask, trim_weight, tile->trim_weight + count);
#endif
}

/* Appends particles without weight, because loads of MCOR_LANES particles read beyond the end. */
void mcor_tile_pad(mcor_tile* tile)
{
  real* const arrays[] = { tile->x, tile->y, tile->z, tile->inv_h, tile->weight, tile->value,
    tile->MCOR_TRIM_WEIGHT };
  for (int a = 0; a < 7; ++a)
  {
    MCOR_STORE((realv)0, tile->count, arrays[a]);
  }
}

/* Fills a tile, while there is room, with the next particles that reach the query's box. */
void mcor_tile_fill(const mcor_grid* grid, mcor_query* query, mcor_tile* tile)
{
  const real unit = grid->unit;
  const fix ox = query->origin[0], oy = query->origin[1], oz = query->origin[2];
  const mcor_span box = query->box;
  /* own: a particle counts if its distance to the box is less than a share of its own support; if
   * not `own`, less than the query's radius. */
  const bool own = query->radius < 0;
  const realv reach = own ? -query->radius : (real)1;
  const realv inv_radius = own ? (real)1 : (real)MCOR_SUPPORT / query->radius;
  int count = 0;
  tile->delivered = false;
  while (count <= MCOR_TILE_SIZE - MCOR_LANES)
  {
    if (query->begin >= query->end && !mcor_query_next_row(grid, query))
    {
      tile->delivered = true;
      break;
    }
    int j = query->begin;
    for (; j < query->end && count <= MCOR_TILE_SIZE - MCOR_LANES; j += MCOR_LANES)
    {
      const realv x = MCOR_CONVERT_REALV(MCOR_LOAD_FIX(j, grid->px) - ox) * unit;
      const realv y = MCOR_CONVERT_REALV(MCOR_LOAD_FIX(j, grid->py) - oy) * unit;
      const realv z = MCOR_CONVERT_REALV(MCOR_LOAD_FIX(j, grid->pz) - oz) * unit;
      const realv inv_h = MCOR_LOAD(j, grid->inv_h) * grid->view_edge;
      const fixv near = mcor_near_box(x, y, z, own ? inv_h : inv_radius, &box, reach);
      const mcor_mask mask = MCOR_MASK(near, min(MCOR_LANES, query->end - j));
      MCOR_PACK_INDEX(mask, j, tile->list + count);
      mcor_tile_pack(&mask, x, y, z, inv_h, MCOR_LOAD(j, grid->weight), MCOR_LOAD(j, grid->value),
        MCOR_LOAD(j, grid->trim_weight), count, tile);
      count += MCOR_MASK_COUNT(mask);
    }
    query->begin = min(j, query->end);
  }
  tile->count = count;
  mcor_tile_pad(tile);
}

bool mcor_tile_next(const mcor_grid* grid, mcor_query* query, mcor_tile* tile, bool first)
{
  if (!first && tile->delivered)
  {
    return false;
  }
  if (first && tile->complete)
  {
    tile->delivered = true;
    return true;
  }
  if (first)
  {
    mcor_query_next_level(grid, query, 0);
  }
  mcor_tile_fill(grid, query, tile);
  tile->complete = first && tile->delivered;
  return true;
}

/* Fills `tile`, but not its list, with the particles of `wide` that `query` would find. wide: a
 * complete tile of another query that has the same origin and a box around the box of `query`. */
void mcor_tile_narrow(const mcor_tile* wide, const mcor_query* query, mcor_tile* tile)
{
  const mcor_span box = query->box;
  const real share = -query->radius;
  int count = 0;
  for (int i = 0; i < wide->count; i += MCOR_LANES)
  {
    const mcor_mask mask =
      MCOR_MASK(mcor_tile_near(wide, i, &box, share), min(MCOR_LANES, wide->count - i));
    mcor_tile_pack(&mask, MCOR_TILE(wide, x, i), MCOR_TILE(wide, y, i), MCOR_TILE(wide, z, i),
      MCOR_TILE(wide, inv_h, i), MCOR_TILE(wide, weight, i), MCOR_TILE(wide, value, i),
      MCOR_TILE(wide, MCOR_TRIM_WEIGHT, i), count, tile);
    count += MCOR_MASK_COUNT(mask);
  }
  tile->count = count;
  tile->complete = true;
  mcor_tile_pad(tile);
}

/* A reach: the particles of a tile, stored such that each lane reads the particles for its own
 * point. */
#if MCOR_PARTS == 1
typedef struct
{
  mcor_tile tile;
  realv w[MCOR_TILE_SIZE]; /* w of each particle in each lane, from the last evaluation */
} mcor_reach;

#define MCOR_REACH_COUNT(reach) ((reach)->tile.count)
#define MCOR_REACH(reach, name, i) ((realv)((reach)->tile.name[i]))
#define MCOR_REACH_TERM(reach, i, iso)                                                             \
  ((realv)((reach)->tile.weight[i] * MCOR_FIELD_TERM((reach)->tile.value[i], iso)))

bool mcor_reach_next(const mcor_grid* grid, mcor_query* query, const mcor_points* points, real iso,
  mcor_reach* reach, bool first)
{
  return mcor_tile_next(grid, query, &reach->tile, first);
}
#else
#define MCOR_REACH_SIZE (MCOR_PARTS * (MCOR_TILE_SIZE + 16))

/* Which particles of a tile reach each part of a group. Each mask covers MCOR_LANES particles. */
typedef struct
{
  mcor_mask mask[MCOR_PARTS][MCOR_TILE_SIZE / MCOR_LANES + 1];
  int chunks, longest; /* number of masks of a part; most particles that reach a part */
} mcor_reach_masks;

typedef struct
{
  mcor_tile tile;
  realv w[MCOR_TILE_SIZE]; /* w of each particle in each lane, from the last evaluation */
  mcor_reach_masks masks;
  MCOR_ALIGNED real x[MCOR_REACH_SIZE], y[MCOR_REACH_SIZE], z[MCOR_REACH_SIZE];
  real inv_h[MCOR_REACH_SIZE], weight[MCOR_REACH_SIZE];
  real term[MCOR_REACH_SIZE]; /* weight * MCOR_FIELD_TERM */
#if MCOR_SOLIDS
  real trim_weight[MCOR_REACH_SIZE];
#endif
} mcor_reach;

realv mcor_each_lane(float4 parts)
{
  return (realv)(parts, parts, parts, parts);
}

#define MCOR_REACH_COUNT(reach) ((reach)->masks.longest)
#define MCOR_REACH(reach, name, i) mcor_each_lane(vload4(i, (reach)->name))
#define MCOR_REACH_TERM(reach, i, iso) MCOR_REACH(reach, term, i)

void mcor_reach_test(const mcor_tile* tile, const mcor_points* points, mcor_reach_masks* masks)
{
  masks->chunks = (tile->count + MCOR_LANES - 1) / MCOR_LANES;
  masks->longest = 0;
  for (int part = 0; part < MCOR_PARTS; ++part)
  {
    const mcor_span box = points->part[part];
    int count = 0;
    for (int j = 0; j < masks->chunks; ++j)
    {
      const int i = j * MCOR_LANES;
      const mcor_mask mask =
        MCOR_MASK(mcor_tile_near(tile, i, &box, 1), min(MCOR_LANES, tile->count - i));
      masks->mask[part][j] = mask;
      count += MCOR_MASK_COUNT(mask);
    }
    masks->longest = max(masks->longest, count);
  }
}

/* Packs those elements of a tile's array that the mask of each part selects. Element i of part p
 * goes to to[i * MCOR_PARTS + p]. Shorter parts are filled up with 0, i.e. no weight. */
void mcor_reach_pack(const mcor_reach_masks* masks, const real* array, real* to)
{
  MCOR_ALIGNED real packed[MCOR_PARTS][MCOR_TILE_SIZE + 2 * MCOR_LANES];
  for (int part = 0; part < MCOR_PARTS; ++part)
  {
    real* next = packed[part];
    for (int j = 0; j < masks->chunks; ++j)
    {
      const mcor_mask mask = masks->mask[part][j];
      MCOR_PACK_REAL(mask, MCOR_LOAD(j * MCOR_LANES, array), next);
      next += MCOR_MASK_COUNT(mask);
    }
    for (const real* end = packed[part] + masks->longest; next < end; next += MCOR_LANES)
    {
      MCOR_STORE((realv)0, 0, next);
    }
  }
  for (int i = 0; i < masks->longest; i += MCOR_LANES, to += MCOR_PARTS * MCOR_LANES)
  {
    mcor_interleave4(MCOR_LOAD(i, packed[0]), MCOR_LOAD(i, packed[1]), MCOR_LOAD(i, packed[2]),
      MCOR_LOAD(i, packed[3]), to);
  }
}

bool mcor_reach_next(const mcor_grid* grid, mcor_query* query, const mcor_points* points, real iso,
  mcor_reach* reach, bool first)
{
  const bool kept = first && reach->tile.complete;
  mcor_tile* tile = &reach->tile;
  if (!mcor_tile_next(grid, query, tile, first))
  {
    return false;
  }
  if (kept)
  {
    return true;
  }
  mcor_reach_test(tile, points, &reach->masks);
  mcor_reach_pack(&reach->masks, tile->x, reach->x);
  mcor_reach_pack(&reach->masks, tile->y, reach->y);
  mcor_reach_pack(&reach->masks, tile->z, reach->z);
  mcor_reach_pack(&reach->masks, tile->inv_h, reach->inv_h);
  mcor_reach_pack(&reach->masks, tile->weight, reach->weight);
#if MCOR_FIELD != MCOR_WEIGHT_SUM
  MCOR_ALIGNED real term[MCOR_TILE_SIZE + MCOR_LANES];
  for (int i = 0; i < tile->count; i += MCOR_LANES)
  {
    MCOR_STORE(
      MCOR_LOAD(i, tile->weight) * MCOR_FIELD_TERM(MCOR_LOAD(i, tile->value), iso), i, term);
  }
  mcor_reach_pack(&reach->masks, term, reach->term);
#endif
#if MCOR_SOLIDS
  mcor_reach_pack(&reach->masks, tile->trim_weight, reach->trim_weight);
#endif
  return true;
}
#endif

#define MCOR_REACH_KEEP(reach, i, weight) ((reach)->w[i] = (weight))

/* Reads an attribute's values at the particles of a tile. */
void mcor_tile_values(const mcor_tile* tile, __global const real* attribute, real* values)
{
  for (int i = 0; i < tile->count; ++i)
  {
    values[i] = attribute[tile->list[i]];
  }
}

/* Loads an attribute's values at the particles of an mcor_reach. MCOR_VALUE reads these values. */
#if MCOR_PARTS == 1
#define MCOR_VALUE(values, i) (values)[i]
void mcor_attribute_load(const mcor_reach* reach, __global const real* attribute, real* values)
{
  mcor_tile_values(&reach->tile, attribute, values);
}
#else
#define MCOR_VALUE(values, i) mcor_each_lane(vload4(i, values))
void mcor_attribute_load(const mcor_reach* reach, __global const real* attribute, real* values)
{
  MCOR_ALIGNED real of_tile[MCOR_TILE_SIZE + 16];
  mcor_tile_values(&reach->tile, attribute, of_tile);
  mcor_reach_pack(&reach->masks, of_tile, values);
}
#endif

/* Values of up to MCOR_ARRAY_STEP arrays at the particles of a reach. */
typedef struct
{
  real of[MCOR_ARRAY_STEP][MCOR_PARTS * (MCOR_TILE_SIZE + 16)];
} mcor_values;

void mcor_values_load(
  const mcor_reach* reach, __global const real* const arrays[MCOR_ARRAY_STEP], mcor_values* values)
{
  for (int c = 0; c < MCOR_ARRAY_STEP; ++c)
  {
    mcor_attribute_load(reach, arrays[c], values->of[c]);
  }
}

#define MCOR_VALUE_OF(values, reach, c, i) MCOR_VALUE((values)->of[c], i)

/* Adds w_i A_i, for the particles i in `reach`, to `step` sums, one for each attribute A. Only the
 * first `count` sums have an attribute. One loop adds to all sums: while one sum waits for its last
 * addition, the loop adds to other sums. weight[i]: w_i; if `make` is set, computes w_i, and adds
 * it to *weight_sum. Each call passes constants as `step` and `make`. */
#define MCOR_ATTRIBUTE_STEP 4
__attribute__((always_inline)) void mcor_attribute_add(const mcor_grid* grid,
  const mcor_query* query, const mcor_points* points, const mcor_reach* reach, const int step,
  const bool make, int count, const int stride, __global const real* attributes, realv* weight,
  realv* weight_sum, realv* sums)
{
  real values[MCOR_ATTRIBUTE_STEP][MCOR_PARTS * (MCOR_TILE_SIZE + 16)];
  const real* from[MCOR_ATTRIBUTE_STEP];
  realv s[MCOR_ATTRIBUTE_STEP], w = *weight_sum, at[3], d[3], along[3], slope;
  for (int c = 0; c < step; ++c)
  {
    from[c] = values[c < count ? c : 0];
    s[c] = sums[c];
    if (c < count)
    {
      mcor_attribute_load(reach, attributes + c * (long)stride, values[c]);
    }
  }
  mcor_points_relative(grid, query, points, at);
  for (int i = 0; i < MCOR_REACH_COUNT(reach); ++i)
  {
    if (make)
    {
      MCOR_REACH_FROM(at, points, reach, i, d);
      const mcor_length length = mcor_length_of(d);
      const realv k = mcor_weight_gradient(d, &length, MCOR_REACH(reach, inv_h, i), &slope, along);
      weight[i] = MCOR_REACH(reach, weight, i) * k;
      w += weight[i];
    }
    for (int c = 0; c < step; ++c)
    {
      s[c] = MCOR_FMA(weight[i], MCOR_VALUE(from[c], i), s[c]);
    }
  }
  *weight_sum = w;
  for (int c = 0; c < step; ++c)
  {
    sums[c] = s[c];
  }
}

#define MCOR_ATTRIBUTE_ADD(step, make, c)                                                          \
  mcor_attribute_add(grid, query, points, reach, step, make, min(count - c, MCOR_ATTRIBUTE_STEP),  \
    stride, attributes + c * (long)stride, weight, &w, sums + c)

void mcor_attribute_sums(const mcor_grid* grid, mcor_query* query, const mcor_points* points,
  real iso, mcor_reach* reach, bool evaluated, int count, const int stride,
  __global const real* attributes, realv sums[MCOR_ATTRIBUTE_LIMIT], realv* weight_sum)
{
  const bool known = evaluated && reach->tile.complete;
  realv w = 0;
  for (bool first = true; mcor_reach_next(grid, query, points, iso, reach, first); first = false)
  {
    realv weight[MCOR_TILE_SIZE];
    for (int i = 0; known && i < MCOR_REACH_COUNT(reach); ++i)
    {
      weight[i] = MCOR_REACH(reach, weight, i) * reach->w[i];
      w += weight[i];
    }
    if (!known)
    {
      count == 0     ? MCOR_ATTRIBUTE_ADD(0, true, 0)
        : count == 1 ? MCOR_ATTRIBUTE_ADD(1, true, 0)
                     : MCOR_ATTRIBUTE_ADD(MCOR_ATTRIBUTE_STEP, true, 0);
    }
    for (int c = known ? 0 : MCOR_ATTRIBUTE_STEP; c < count; c += MCOR_ATTRIBUTE_STEP)
    {
      MCOR_ATTRIBUTE_ADD(MCOR_ATTRIBUTE_STEP, false, c);
    }
  }
  *weight_sum = w;
}
