/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The tile: particles that reach a box, packed for evaluation. */

/* Of arrays that are read MCOR_LANES elements at a time: no such access then touches two cache
 * lines. */
#define MCOR_ALIGNED __attribute__((aligned(sizeof(real) * MCOR_LANES)))

/* Copies of the particles that reach a query's box, MCOR_TILE at a time:
 *
 *   mcor_tile_init(&tile);
 *   for (bool first = true; mcor_tile_next(grid, &query, &tile, first); first = false)
 *     for (int i = 0; i < tile.count; ++i)
 *       ... tile.x[i], ..., particle tile.list[i] ...
 *
 * The loop may be repeated; what fits one tile is then not gathered again. */
typedef struct
{
  int count;
  bool complete;  /* the tile holds everything */
  bool delivered; /* nothing is left for this loop */
  MCOR_ALIGNED int list[MCOR_TILE + 16];
  /* Position from the query's origin, in cubes: exact in single precision while it is below 16
   * cubes. */
  MCOR_ALIGNED real x[MCOR_TILE + 16], y[MCOR_TILE + 16], z[MCOR_TILE + 16];
  real inv_h[MCOR_TILE + 16], weight[MCOR_TILE + 16], value[MCOR_TILE + 16];
#if MCOR_SOLIDS
  real trim_weight[MCOR_TILE + 16];
#endif
} mcor_tile;

/* The trimming weights of a tile. */
#if MCOR_SOLIDS
#define MCOR_TILE_TRIM(tile) ((tile)->trim_weight)
#else
#define MCOR_TILE_TRIM(tile) ((tile)->weight)
#endif

void mcor_tile_init(mcor_tile* tile)
{
  tile->complete = false;
}

/* Whether particles at (x, y, z) are within `share` of their support from a box of half size
 * (hx, hy, hz) around (cx, cy, cz). The margin covers rounding: a particle kept in vain adds
 * exactly 0. */
fixv mcor_tile_near(realv x, realv y, realv z, realv inv_h, real cx, real cy, real cz, real hx,
  real hy, real hz, realv share)
{
  const realv dx = fmax(fabs(x - cx) - hx, (realv)0);
  const realv dy = fmax(fabs(y - cy) - hy, (realv)0);
  const realv dz = fmax(fabs(z - cz) - hz, (realv)0);
#if MCOR_TENSOR
  return fmax(dx, fmax(dy, dz)) * inv_h < share * (MCOR_SUPPORT * (real)1.0001);
#else
  return (dx * dx + dy * dy + dz * dz) * inv_h * inv_h <
    share * share * (MCOR_SUPPORT * MCOR_SUPPORT * (real)1.0001);
#endif
}

/* Puts the particles of a mask behind the tile's first `count`, but for the list. */
void mcor_tile_pack(const mcor_mask* mask, realv x, realv y, realv z, realv inv_h, realv weight,
  realv value, realv trim_weight, int count, mcor_tile* tile)
{
  MCOR_PACK_REAL(*mask, x, tile->x + count);
  MCOR_PACK_REAL(*mask, y, tile->y + count);
  MCOR_PACK_REAL(*mask, z, tile->z + count);
  MCOR_PACK_REAL(*mask, inv_h, tile->inv_h + count);
  MCOR_PACK_REAL(*mask, weight, tile->weight + count);
#if MCOR_FIELD != 2
  MCOR_PACK_REAL(*mask, value, tile->value + count);
#endif
#if MCOR_SOLIDS
  MCOR_PACK_REAL(*mask, trim_weight, tile->trim_weight + count);
#endif
}

/* Tests the particles that are left of the query's row, and puts those that reach its box behind
 * the tile's first `count`, while there is room. Returns the new count. */
int mcor_tile_append(const mcor_grid* grid, mcor_query* query, int count, mcor_tile* tile)
{
  const real unit = grid->unit;
  const fix ox = query->origin[0], oy = query->origin[1], oz = query->origin[2];
  const real cx = query->center[0], cy = query->center[1], cz = query->center[2];
  const real hx = query->half_size[0], hy = query->half_size[1], hz = query->half_size[2];
  /* Within their own support, or within the query's radius. */
  const bool own = query->radius < 0;
  const realv reach = own ? -query->radius : (real)1;
  const realv inv_radius = own ? (real)1 : (real)MCOR_SUPPORT / query->radius;
  int j = query->begin;
  for (; j < query->end && count <= MCOR_TILE - MCOR_LANES; j += MCOR_LANES)
  {
    const realv x = MCOR_CONVERT_REALV(MCOR_LOAD_FIX(j, grid->px) - ox) * unit;
    const realv y = MCOR_CONVERT_REALV(MCOR_LOAD_FIX(j, grid->py) - oy) * unit;
    const realv z = MCOR_CONVERT_REALV(MCOR_LOAD_FIX(j, grid->pz) - oz) * unit;
    const realv inv_h = MCOR_LOAD(j, grid->inv_h);
    const fixv near =
      mcor_tile_near(x, y, z, own ? inv_h : inv_radius, cx, cy, cz, hx, hy, hz, reach);
    const mcor_mask mask = MCOR_MASK(near, min(MCOR_LANES, query->end - j));
    MCOR_PACK_INDEX(mask, j, tile->list + count);
    mcor_tile_pack(&mask, x, y, z, inv_h, MCOR_LOAD(j, grid->weight), MCOR_LOAD(j, grid->value),
      MCOR_LOAD(j, grid->trim_weight), count, tile);
    count += MCOR_MASK_COUNT(mask);
  }
  query->begin = min(j, query->end);
  return count;
}

/* Sets the lanes beyond the end, which loads of MCOR_LANES particles see, to particles without
 * weight. */
void mcor_tile_pad(mcor_tile* tile)
{
#if MCOR_LANES > 1
  real* const arrays[] = { tile->x, tile->y, tile->z, tile->inv_h, tile->weight, tile->value,
    MCOR_TILE_TRIM(tile) };
  for (int a = 0; a < 7; ++a)
  {
    MCOR_CAT(vstore, MCOR_LANES)((realv)0, 0, arrays[a] + tile->count);
  }
#endif
}

void mcor_tile_fill(const mcor_grid* grid, mcor_query* query, mcor_tile* tile)
{
  int count = 0;
  tile->delivered = false;
  while (count <= MCOR_TILE - MCOR_LANES)
  {
    if (query->begin >= query->end && !mcor_query_next_row(grid, query))
    {
      tile->delivered = true;
      break;
    }
    count = mcor_tile_append(grid, query, count, tile);
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

/* Fills a tile, but for its list, from a complete one of a query with the same origin and a box
 * that holds this one's. */
void mcor_tile_narrow(const mcor_tile* wide, const mcor_query* query, mcor_tile* tile)
{
  const real cx = query->center[0], cy = query->center[1], cz = query->center[2];
  const real hx = query->half_size[0], hy = query->half_size[1], hz = query->half_size[2];
  int count = 0;
  for (int i = 0; i < wide->count; i += MCOR_LANES)
  {
    const realv x = MCOR_LOAD(i, wide->x), y = MCOR_LOAD(i, wide->y), z = MCOR_LOAD(i, wide->z),
                inv_h = MCOR_LOAD(i, wide->inv_h);
    const fixv near = mcor_tile_near(x, y, z, inv_h, cx, cy, cz, hx, hy, hz, -query->radius);
    const mcor_mask mask = MCOR_MASK(near, min(MCOR_LANES, wide->count - i));
    mcor_tile_pack(&mask, x, y, z, inv_h, MCOR_LOAD(i, wide->weight), MCOR_LOAD(i, wide->value),
      MCOR_LOAD(i, MCOR_TILE_TRIM(wide)), count, tile);
    count += MCOR_MASK_COUNT(mask);
  }
  tile->count = count;
  tile->complete = true;
  mcor_tile_pad(tile);
}
