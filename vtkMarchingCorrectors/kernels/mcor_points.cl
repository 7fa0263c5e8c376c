/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Points that are evaluated together, in groups of up to MCOR_LANES, and the particles that reach
 * them.
 *
 * Many more particles reach some point of a group than reach a given one. So where packing is cheap
 * a group consists of MCOR_PARTS parts of points close together, each with its own list of
 * particles; the lists are gone through at the same time, lane l of a vector being of part l %
 * MCOR_PARTS. Every sum goes through its particles in the order of the search grid, whatever the
 * groups are. */

/* How far apart the nodes of a group may be, in cubes: an edge of its box, and the sum of three. */
#define MCOR_GROUP_EDGE 7
#define MCOR_GROUP_EDGES 12

#define MCOR_PART (MCOR_LANES / MCOR_PARTS)

/* Points: lattice node plus offset in cubes. */
typedef struct
{
  int index[MCOR_LANES]; /* of each lane's point; -1 where a lane repeats another one */
  fixv x, y, z;
  realv ox, oy, oz;
  /* The box of each part, in cubes from the query's origin. */
  real center[3][MCOR_PARTS], half_size[3][MCOR_PARTS];
} mcor_points;

bool mcor_same_brick(int4 a, int4 b)
{
  return a.x >> 2 == b.x >> 2 && a.y >> 2 == b.y >> 2 && a.z >> 2 == b.z >> 2;
}

/* Where a walk through successive points is: a part holds up to MCOR_PART points of one brick. */
typedef struct
{
  int part, size; /* of the last point: its part in the group, and how many that has so far */
  int4 low, high; /* of the group's nodes */
} mcor_group_walk;

/* Takes the next point, at `node`; `before` is the one before it. Returns false where it does not
 * fit the group, which the caller then starts anew. The parts of a group share one gather of
 * particles, so it is to stay small. */
bool mcor_group_add(mcor_group_walk* walk, int4 before, int4 node)
{
  const int4 low = min(walk->low, node), high = max(walk->high, node), extent = high - low;
  const bool new_part = walk->size == MCOR_PART || !mcor_same_brick(before, node);
  if (walk->part + new_part >= MCOR_PARTS || extent.x + extent.y + extent.z > MCOR_GROUP_EDGES ||
    max(extent.x, max(extent.y, extent.z)) > MCOR_GROUP_EDGE)
  {
    return false;
  }
  walk->part += new_part;
  walk->size = new_part ? 1 : walk->size + 1;
  walk->low = low;
  walk->high = high;
  return true;
}

mcor_group_walk mcor_group_start(int4 node)
{
  const mcor_group_walk walk = { 0, 1, node, node };
  return walk;
}

/* One work-item = MCOR_GROUP_CHUNK points, of `count` from `first`. Writes 1 where a group
 * starts. */
__kernel void mcor_group_count(
  const int first, const int count, __global const int4* all_nodes, __global int* flags)
{
  __global const int4* node = all_nodes + first;
  const int begin = get_global_id(0) * MCOR_GROUP_CHUNK;
  mcor_group_walk walk;
  for (int i = begin; i < min(begin + MCOR_GROUP_CHUNK, count); ++i)
  {
    const bool fits = i > begin && mcor_group_add(&walk, node[i - 1], node[i]);
    flags[i] = !fits;
    if (!fits)
    {
      walk = mcor_group_start(node[i]);
    }
  }
}

/* One work-item = one point. Reads the scanned flags. Writes where each group starts; the last
 * entry is the end. */
__kernel void mcor_group_fill(
  const int first, const int count, __global const int* scanned, __global int* groups)
{
  const int i = get_global_id(0);
  if (i < count && scanned[i] != scanned[i + 1])
  {
    groups[scanned[i]] = first + i;
  }
  if (i == count)
  {
    groups[scanned[count]] = first + count;
  }
}

/* Gives the points of a group to lanes; `from` is the point to load in each lane. */
void mcor_points_place(
  __global const int4* node, int begin, int end, mcor_points* points, int from[MCOR_LANES])
{
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    points->index[lane] = -1;
  }
  mcor_group_walk walk = mcor_group_start(node[begin]);
  points->index[0] = begin;
  for (int i = begin + 1; i < end; ++i)
  {
    mcor_group_add(&walk, node[i - 1], node[i]);
    points->index[(walk.size - 1) * MCOR_PARTS + walk.part] = i;
  }
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int part_first = points->index[lane % MCOR_PARTS];
    from[lane] = points->index[lane] >= 0 ? points->index[lane]
      : part_first >= 0                   ? part_first
                                          : begin;
  }
}

/* Loads the nodes of a group's points. */
void mcor_points_load(
  __global const int4* node, const int from[MCOR_LANES], int fix_bits, mcor_points* points)
{
  fix n[3][MCOR_LANES];
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int4 p = node[from[lane]];
    n[0][lane] = (fix)p.x << fix_bits;
    n[1][lane] = (fix)p.y << fix_bits;
    n[2][lane] = (fix)p.z << fix_bits;
  }
#if MCOR_LANES == 1
  points->x = n[0][0];
  points->y = n[1][0];
  points->z = n[2][0];
#else
  points->x = MCOR_CAT(vload, MCOR_LANES)(0, n[0]);
  points->y = MCOR_CAT(vload, MCOR_LANES)(0, n[1]);
  points->z = MCOR_CAT(vload, MCOR_LANES)(0, n[2]);
#endif
}

/* Fits the query, and the boxes of the parts, to points with offsets between low and high. */
void mcor_points_bound(const mcor_grid* grid, const realv low[3], const realv high[3],
  mcor_points* points, mcor_query* query)
{
  const fixv* node[3] = { &points->x, &points->y, &points->z };
  query->radius = -1;
  for (int a = 0; a < 3; ++a)
  {
    const fix origin = MCOR_GET_FIX(*node[a], 0);
    const realv at = MCOR_CONVERT_REALV(*node[a] - origin) * grid->unit;
    const realv begin = at + low[a], end = at + high[a];
    real least = MCOR_GET(begin, 0), most = MCOR_GET(end, 0);
    for (int part = 0; part < MCOR_PARTS; ++part)
    {
      real first = MCOR_GET(begin, part), last = MCOR_GET(end, part);
      for (int lane = part; lane < MCOR_LANES; lane += MCOR_PARTS)
      {
        first = fmin(first, MCOR_GET(begin, lane));
        last = fmax(last, MCOR_GET(end, lane));
      }
      points->center[a][part] = (real)0.5 * (first + last);
      points->half_size[a][part] = (real)0.5 * (last - first);
      least = fmin(least, first);
      most = fmax(most, last);
    }
    const fix corner = (fix)floor(ldexp(least, grid->fix_bits)) - 1;
    query->low[a] = origin + corner;
    query->high[a] = origin + (fix)ceil(ldexp(most, grid->fix_bits)) + 1;
    for (int part = 0; part < MCOR_PARTS; ++part)
    {
      points->center[a][part] -= (real)corner * grid->unit;
    }
  }
  mcor_query_place(grid, query, query->low);
}

/* Loads the group of points from begin to before end and their offsets, and fits the query to them,
 * `margin` added. */
void mcor_group_load(const mcor_grid* grid, int begin, int end, __global const int4* node,
  __global const real4* offset, real margin, mcor_points* points, mcor_query* query)
{
  int from[MCOR_LANES];
  mcor_points_place(node, begin, end, points, from);
  mcor_points_load(node, from, grid->fix_bits, points);
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const real4 o = offset[from[lane]];
    MCOR_SET(points->ox, lane) = o.x;
    MCOR_SET(points->oy, lane) = o.y;
    MCOR_SET(points->oz, lane) = o.z;
  }
  const realv low[3] = { points->ox - margin, points->oy - margin, points->oz - margin };
  const realv high[3] = { points->ox + margin, points->oy + margin, points->oz + margin };
  mcor_points_bound(grid, low, high, points, query);
}

/* The points' nodes from the query's origin, as particles are in a tile. */
void mcor_points_relative(
  const mcor_grid* grid, const mcor_query* query, const mcor_points* points, realv at[3])
{
  at[0] = MCOR_CONVERT_REALV(points->x - query->origin[0]) * grid->unit;
  at[1] = MCOR_CONVERT_REALV(points->y - query->origin[1]) * grid->unit;
  at[2] = MCOR_CONVERT_REALV(points->z - query->origin[2]) * grid->unit;
}

/* Where the points are from a particle at (x, y, z); `at` is of mcor_points_relative. */
void mcor_points_from(
  const realv at[3], const mcor_points* points, realv x, realv y, realv z, realv d[3])
{
  d[0] = (at[0] - x) + points->ox;
  d[1] = (at[1] - y) + points->oy;
  d[2] = (at[2] - z) + points->oz;
}

/* What the field is made of at a particle: its weight times this. */
#if MCOR_FIELD == 0
#define MCOR_FIELD_TERM(value, iso) ((value) - (iso)) /* both relative to A0 */
#else
#define MCOR_FIELD_TERM(value, iso) (value)
#endif

/* The particles of a tile as each lane sees them, to be gone through like the tile itself:
 *
 *   mcor_tile_init(&reach.tile);
 *   for (bool first = true; mcor_reach_next(grid, &query, &points, iso, &reach, first); ...)
 *     for (int i = 0; i < MCOR_REACH_COUNT(&reach); ++i)
 *       ... MCOR_REACH(&reach, x, i), ... */
#if MCOR_PARTS == 1
typedef struct
{
  mcor_tile tile;
  realv w[MCOR_TILE]; /* of each particle in each lane, as last evaluated */
} mcor_reach;

#define MCOR_REACH_COUNT(reach) ((reach)->tile.count)
#define MCOR_REACH(reach, name, i) ((realv)((reach)->tile.name[i]))
#define MCOR_REACH_TRIM(reach, i) ((realv)(MCOR_TILE_TRIM(&(reach)->tile)[i]))
#define MCOR_REACH_TERM(reach, i, iso)                                                             \
  ((realv)((reach)->tile.weight[i] * MCOR_FIELD_TERM((reach)->tile.value[i], iso)))

bool mcor_reach_next(const mcor_grid* grid, mcor_query* query, const mcor_points* points, real iso,
  mcor_reach* reach, bool first)
{
  return mcor_tile_next(grid, query, &reach->tile, first);
}
#else
#define MCOR_REACH_SIZE (MCOR_PARTS * (MCOR_TILE + 16))

/* Which particles of a tile reach each part: one mask for MCOR_LANES of them. */
typedef struct
{
  mcor_mask mask[MCOR_PARTS][MCOR_TILE / MCOR_LANES + 1];
  int chunks, longest; /* masks of a part; particles of the part with most */
} mcor_reach_masks;

typedef struct
{
  mcor_tile tile;
  realv w[MCOR_TILE]; /* as above */
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
#if MCOR_SOLIDS
#define MCOR_REACH_TRIM(reach, i) MCOR_REACH(reach, trim_weight, i)
#else
#define MCOR_REACH_TRIM(reach, i) MCOR_REACH(reach, weight, i)
#endif

void mcor_reach_test(const mcor_tile* tile, const mcor_points* points, mcor_reach_masks* masks)
{
  masks->chunks = (tile->count + MCOR_LANES - 1) / MCOR_LANES;
  masks->longest = 0;
  for (int part = 0; part < MCOR_PARTS; ++part)
  {
    const real cx = points->center[0][part], cy = points->center[1][part],
               cz = points->center[2][part];
    const real hx = points->half_size[0][part], hy = points->half_size[1][part],
               hz = points->half_size[2][part];
    int count = 0;
    for (int j = 0; j < masks->chunks; ++j)
    {
      const int i = j * MCOR_LANES;
      const fixv near = mcor_tile_near(MCOR_LOAD(i, tile->x), MCOR_LOAD(i, tile->y),
        MCOR_LOAD(i, tile->z), MCOR_LOAD(i, tile->inv_h), cx, cy, cz, hx, hy, hz, 1);
      const mcor_mask mask = MCOR_MASK(near, min(MCOR_LANES, tile->count - i));
      masks->mask[part][j] = mask;
      count += MCOR_MASK_COUNT(mask);
    }
    masks->longest = max(masks->longest, count);
  }
}

/* Packs one array of a tile for all parts: element i of part p goes to i * MCOR_PARTS + p. Ends of
 * the shorter lists become 0, which is no weight. */
void mcor_reach_pack(const mcor_reach_masks* masks, const real* array, real* to)
{
  MCOR_ALIGNED real packed[MCOR_PARTS][MCOR_TILE + 2 * MCOR_LANES];
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
      MCOR_CAT(vstore, MCOR_LANES)((realv)0, 0, next);
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
#if MCOR_FIELD != 2
  MCOR_ALIGNED real term[MCOR_TILE + MCOR_LANES];
  for (int i = 0; i < tile->count; i += MCOR_LANES)
  {
    MCOR_CAT(vstore, MCOR_LANES)
    (MCOR_LOAD(i, tile->weight) * MCOR_FIELD_TERM(MCOR_LOAD(i, tile->value), iso), 0, term + i);
  }
  mcor_reach_pack(&reach->masks, term, reach->term);
#endif
#if MCOR_SOLIDS
  mcor_reach_pack(&reach->masks, tile->trim_weight, reach->trim_weight);
#endif
  return true;
}
#endif
