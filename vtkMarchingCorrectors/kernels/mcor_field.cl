/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The SPH field: which particles reach a box (search grid), and what they add at a point.
 *
 * The search grid has one level for each factor of 2 of support radius that occurs, so that a
 * particle costs work only where its own support reaches. Particles are sorted by (level, z, y, x)
 * cell and, in a cell, by position: the order of every sum is fixed by the particles alone. */

typedef struct
{
  ulong base;       /* key of the level's cell (0, 0, 0) */
  int cells[3];     /* extent of the level, in its cells */
  float inv_cell;   /* 1 / cell size, in fixed-point units */
  float support;    /* largest support radius of the level's particles, cubes, rounded up */
  int unused;
} mcor_level;

#define MCOR_GRID_PARAMS                                                                           \
  const int particle_count, const int level_count, const int bucket_shift, const int fix_bits,     \
    __global const mcor_level *levels, __global const int *buckets,                                \
    __global const ulong *cell_keys, __global const fix *px, __global const fix *py,               \
    __global const fix *pz, __global const real *p_inv_h, __global const real *p_weight,           \
    __global const real *p_trim_weight, __global const real *p_value

/* Arrays are padded by 16 elements, so that a vector load may run over the end. */
typedef struct
{
  int particle_count, level_count, bucket_shift, fix_bits;
  real unit;
  __global const mcor_level* levels;
  __global const int* buckets;     /* first particle with cell key >= bucket << bucket_shift */
  __global const ulong* cell_keys; /* sorted */
  __global const fix *px, *py, *pz;
  __global const real* inv_h;       /* 1 / (h scale * smoothing length), per cube */
  __global const real* weight;      /* V norm / (scaled h)^3; 0 for solids */
  __global const real* trim_weight; /* the same, solids included */
  __global const real* value;       /* A - A0 */
} mcor_grid;

#define MCOR_GRID                                                                                  \
  {                                                                                                \
    particle_count, level_count, bucket_shift, fix_bits, ldexp((real)1, -fix_bits), levels,        \
      buckets, cell_keys, px, py, pz, p_inv_h, p_weight, p_trim_weight, p_value                    \
  }

/* Monotone in x, so that the cells of lo and hi enclose those of everything in between. */
int mcor_cell_of(fix x, float inv_cell)
{
  return (int)floor((float)x * inv_cell);
}

/* Index of the first particle whose cell key is >= key. */
int mcor_first_particle(const mcor_grid* grid, ulong key)
{
  const ulong bucket = key >> grid->bucket_shift;
  int low = grid->buckets[bucket];
  if (grid->bucket_shift == 0)
  {
    return low;
  }
  int high = grid->buckets[bucket + 1];
  while (low < high)
  {
    const int middle = low + (high - low) / 2;
    if (grid->cell_keys[middle] < key)
    {
      low = middle + 1;
    }
    else
    {
      high = middle;
    }
  }
  return low;
}

/* All particles that may reach the box [low, high], row by row of search cells. */
typedef struct
{
  fix low[3], high[3];
  real center[3], half_size[3]; /* cubes, relative to low */
  float radius; /* cubes; below 0: -1 times the share of each particle's own support, e.g. -1 */
  float cell_size, reach2, z2;  /* of this level, in fixed-point units; squared distance of row z */
  int level, first[3], last[3], y, z;
  int begin, end; /* particles left of the current row */
} mcor_query;

/* A level whose rows in reach outnumber its particles is taken as one run, so that a coarse particle
 * does not walk through the empty rows of fine levels. */
void mcor_query_sparse_level(const mcor_grid* grid, mcor_query* query, const mcor_level* level)
{
  const long rows = (long)(query->last[1] - query->first[1] + 1) * (query->last[2] - query->first[2] + 1);
  if (rows <= 64)
  {
    return;
  }
  const ulong cells = (ulong)level->cells[0] * level->cells[1] * level->cells[2];
  const int begin = mcor_first_particle(grid, level->base);
  const int end = mcor_first_particle(grid, level->base + cells);
  if (end - begin < rows)
  {
    query->begin = begin;
    query->end = end;
    query->z = query->last[2];
  }
}

/* The part of a query that depends on the level; false where the level has no cell in reach. */
bool mcor_query_level(const mcor_grid* grid, mcor_query* query)
{
  const mcor_level level = grid->levels[query->level];
  const float support = query->radius >= 0 ? query->radius : -query->radius * level.support;
  const float far = ceil(ldexp(support, grid->fix_bits)) + 1;
  const fix reach = (fix)far;
  query->cell_size = 1 / level.inv_cell;
  query->reach2 = far * far;
  bool some = true;
  for (int a = 0; a < 3; ++a)
  {
    query->first[a] = max(mcor_cell_of(query->low[a] - reach, level.inv_cell), 0);
    query->last[a] = min(mcor_cell_of(query->high[a] + reach, level.inv_cell), level.cells[a] - 1);
    some = some && query->first[a] <= query->last[a];
  }
  query->y = query->last[1]; /* as if the row before the first one had just ended */
  query->z = query->first[2] - 1;
  query->begin = query->end = 0;
  if (some)
  {
    mcor_query_sparse_level(grid, query, &level);
  }
  return some;
}

/* Moves to the first level from `level` on that has cells in reach. */
bool mcor_query_next_level(const mcor_grid* grid, mcor_query* query, int level)
{
  query->begin = query->end = 0;
  for (query->level = level; query->level < grid->level_count; ++query->level)
  {
    if (mcor_query_level(grid, query))
    {
      return true;
    }
  }
  return false;
}

void mcor_query_begin(const mcor_grid* grid, mcor_query* query)
{
  for (int a = 0; a < 3; ++a)
  {
    query->half_size[a] = (real)(query->high[a] - query->low[a]) * grid->unit * (real)0.5;
    query->center[a] = query->half_size[a];
  }
  mcor_query_next_level(grid, query, 0);
}

/* Square of the distance between the box and a cell along an axis, less what rounding may have moved
 * a particle across the cell's face. */
float mcor_query_distance2(const mcor_query* query, int axis, int cell)
{
  const float low = (float)query->low[axis], high = (float)query->high[axis];
  const float begin = (float)cell * query->cell_size, end = begin + query->cell_size;
  const float d = fmax(low - end, begin - high) - 1e-6f * (fabs(low) + fabs(high)) - 1;
  return d > 0 ? d * d : 0;
}

/* Particles [begin, end) of the current row that may be in reach. */
void mcor_query_row(const mcor_grid* grid, mcor_query* query)
{
  __global const mcor_level* level = grid->levels + query->level;
  const ulong row = level->base + ((ulong)query->z * level->cells[1] + query->y) * level->cells[0];
  int first = query->first[0], last = query->last[0];
#if !MCOR_TENSOR
  const float rest = query->reach2 - query->z2 - mcor_query_distance2(query, 1, query->y);
  if (rest < 0)
  {
    query->begin = query->end = 0;
    return;
  }
#endif
  query->begin = mcor_first_particle(grid, row + first);
  query->end = mcor_first_particle(grid, row + last + 1);
}

/* Moves to the next row with particles; false at the end. */
bool mcor_query_next_row(const mcor_grid* grid, mcor_query* query)
{
  while (query->level < grid->level_count)
  {
    if (++query->y > query->last[1])
    {
      query->y = query->first[1];
      if (++query->z > query->last[2])
      {
        if (mcor_query_next_level(grid, query, query->level + 1) && query->begin < query->end)
        {
          return true;
        }
        continue;
      }
      query->z2 = MCOR_TENSOR ? 0 : mcor_query_distance2(query, 2, query->z);
    }
    mcor_query_row(grid, query);
    if (query->begin < query->end)
    {
      return true;
    }
  }
  return false;
}

/* Fits the query's box to sorted particles [begin, begin + count); returns the least of their inv_h. */
real mcor_query_particles(const mcor_grid* grid, mcor_query* query, int begin, int count)
{
  real coarsest = grid->inv_h[begin];
  for (int a = 0; a < 3; ++a)
  {
    __global const fix* p = a == 0 ? grid->px : a == 1 ? grid->py : grid->pz;
    query->low[a] = query->high[a] = p[begin];
    for (int i = begin + 1; i < begin + count; ++i)
    {
      query->low[a] = min(query->low[a], p[i]);
      query->high[a] = max(query->high[a], p[i]);
      coarsest = min(coarsest, grid->inv_h[i]);
    }
  }
  return coarsest;
}

/* MCOR_LANES elements from p[i] on. Compilers may make several accesses of vloadn and vstoren. */
#if MCOR_LANES == 1
#define MCOR_LOAD(i, p) ((p)[i])
#define MCOR_LOAD_FIX(i, p) ((p)[i])
#else
typedef fixv __attribute__((aligned(4))) mcor_loose_fixv;
typedef realv __attribute__((aligned(4))) mcor_loose_realv;
#define MCOR_LOAD(i, p) MCOR_CAT(vload, MCOR_LANES)(0, (p) + (i))
#define MCOR_LOAD_FIX(i, p) (*(__global const mcor_loose_fixv*)((p) + (i)))
#endif

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
  int list[MCOR_TILE + 16];
  /* Position from the query's low corner, in cubes: exact in single precision while the support is
   * below 16 cubes, so that results do not depend on the box. */
  real x[MCOR_TILE + 16], y[MCOR_TILE + 16], z[MCOR_TILE + 16];
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

/* The lanes of a group of particles that are kept, as a mask, and their packing into an array's
 * next elements. The array needs room for MCOR_LANES elements. */
#if MCOR_LANES == 1
typedef int mcor_mask;
#define MCOR_MASK(keep, lanes) ((keep) != 0)
#define MCOR_PACK_REAL(mask, v, to) (*(to) = (v))
#define MCOR_PACK_INDEX(mask, first, to) (*(to) = (first))
#define MCOR_MASK_COUNT(mask) (mask)
#elif MCOR_LANES == 16 && !MCOR_DOUBLE && defined(__AVX512F__) &&                                  \
  __has_builtin(__builtin_ia32_compresssf512_mask) &&                                             \
  __has_builtin(__builtin_ia32_compresssi512_mask) && __has_builtin(__builtin_ia32_cmpd512_mask)
/* A vector unit that packs by itself: a third of a gather's time. */
typedef ushort mcor_mask;
#define MCOR_MASK(keep, lanes)                                                                     \
  ((mcor_mask)__builtin_ia32_cmpd512_mask(                                                         \
    (keep), (int16)0, 4, (mcor_mask)((1u << (lanes)) - 1))) /* 4: not equal */
#define MCOR_PACK_REAL(mask, v, to)                                                                \
  (*(mcor_loose_realv*)(to) = __builtin_ia32_compresssf512_mask((v), (float16)0, (mask)))
#define MCOR_PACK_INDEX(mask, first, to)                                                           \
  (*(mcor_loose_fixv*)(to) = __builtin_ia32_compresssi512_mask(                                    \
     (first) + mcor_lane_index(), (int16)0, (mask)))
#define MCOR_MASK_COUNT(mask) ((int)popcount(mask))
#else
typedef struct
{
  int lanes;
  fix keep[MCOR_LANES];
} mcor_mask;

mcor_mask mcor_mask_of(fixv keep, int lanes)
{
  mcor_mask mask;
  mask.lanes = lanes;
  MCOR_CAT(vstore, MCOR_LANES)(keep & 1, 0, mask.keep);
  return mask;
}

void mcor_pack_real(const mcor_mask* mask, realv v, real* to)
{
  for (int lane = 0; lane < mask->lanes; ++lane)
  {
    *to = MCOR_GET(v, lane);
    to += mask->keep[lane];
  }
}

void mcor_pack_index(const mcor_mask* mask, int first, int* to)
{
  for (int lane = 0; lane < mask->lanes; ++lane)
  {
    *to = first + lane;
    to += mask->keep[lane];
  }
}

int mcor_mask_count(const mcor_mask* mask)
{
  int count = 0;
  for (int lane = 0; lane < mask->lanes; ++lane)
  {
    count += (int)mask->keep[lane];
  }
  return count;
}
#define MCOR_MASK mcor_mask_of
#define MCOR_PACK_REAL(mask, v, to) mcor_pack_real(&(mask), v, to)
#define MCOR_PACK_INDEX(mask, first, to) mcor_pack_index(&(mask), first, to)
#define MCOR_MASK_COUNT(mask) mcor_mask_count(&(mask))
#endif

/* Tests MCOR_LANES particles from j on, of which `lanes` are meant, and puts those that reach the
 * query's box behind the tile's first `count`. Returns the new count. */
int mcor_tile_append(const mcor_grid* grid, const mcor_query* query, int j, int lanes, int count,
  mcor_tile* tile)
{
  const realv x = MCOR_CONVERT_REALV(MCOR_LOAD_FIX(j, grid->px) - query->low[0]) * grid->unit;
  const realv y = MCOR_CONVERT_REALV(MCOR_LOAD_FIX(j, grid->py) - query->low[1]) * grid->unit;
  const realv z = MCOR_CONVERT_REALV(MCOR_LOAD_FIX(j, grid->pz) - query->low[2]) * grid->unit;
  const realv inv_h = MCOR_LOAD(j, grid->inv_h);
  /* Distance to the box, per axis. */
  const realv dx = fmax(fabs(x - query->center[0]) - query->half_size[0], (realv)0);
  const realv dy = fmax(fabs(y - query->center[1]) - query->half_size[1], (realv)0);
  const realv dz = fmax(fabs(z - query->center[2]) - query->half_size[2], (realv)0);
  const bool own = query->radius < 0;
  const realv scale = own ? inv_h : (realv)(MCOR_SUPPORT / query->radius);
  const real reach = own ? -query->radius * MCOR_SUPPORT : MCOR_SUPPORT;
  /* The margin covers rounding: a particle kept in vain adds exactly 0. */
#if MCOR_TENSOR
  const fixv reaches = fmax(dx, fmax(dy, dz)) * scale < reach * (real)1.0001;
#else
  const fixv reaches = (dx * dx + dy * dy + dz * dz) * scale * scale < reach * reach * (real)1.0001;
#endif
  const mcor_mask mask = MCOR_MASK(reaches, lanes);
  MCOR_PACK_INDEX(mask, j, tile->list + count);
  MCOR_PACK_REAL(mask, x, tile->x + count);
  MCOR_PACK_REAL(mask, y, tile->y + count);
  MCOR_PACK_REAL(mask, z, tile->z + count);
  MCOR_PACK_REAL(mask, inv_h, tile->inv_h + count);
  MCOR_PACK_REAL(mask, MCOR_LOAD(j, grid->weight), tile->weight + count);
  MCOR_PACK_REAL(mask, MCOR_LOAD(j, grid->value), tile->value + count);
#if MCOR_SOLIDS
  MCOR_PACK_REAL(mask, MCOR_LOAD(j, grid->trim_weight), tile->trim_weight + count);
#endif
  return count + MCOR_MASK_COUNT(mask);
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
    const int lanes = min(MCOR_LANES, query->end - query->begin);
    count = mcor_tile_append(grid, query, query->begin, lanes, count, tile);
    query->begin += lanes;
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
    mcor_query_begin(grid, query);
  }
  mcor_tile_fill(grid, query, tile);
  tile->complete = first && tile->delivered;
  return true;
}

/* Roots. CPU vector units take longer for a square root and a division than for all the rest of a
 * kernel sum: a third-order and a second-order step from an integer guess (relative error below 0.035,
 * then 1.1e-4, then 2e-8) give the same result on every CPU, to 1 ulp or so. */
#if MCOR_CPU && !MCOR_DOUBLE
realv mcor_rsqrt_guess(realv x)
{
  const realv y = MCOR_AS_REALV((fixv)0x5f375a86 - (MCOR_AS_FIXV(x) >> 1)), h = x * y * y;
  return y * ((real)1.875 - h * ((real)1.25 - (real)0.375 * h));
}

/* 1 / sqrt(x), finite at 0. */
realv mcor_rsqrt(realv x)
{
  const realv y = mcor_rsqrt_guess(x);
  return y * ((real)1.5 - (real)0.5 * (x * y) * y);
}

realv mcor_sqrt(realv x)
{
  const realv y = mcor_rsqrt_guess(x), r = x * y;
  return r * ((real)1.5 - (real)0.5 * r * y);
}
#else
realv mcor_rsqrt(realv x)
{
  return rsqrt(fmax(x, (realv)1e-30f));
}

realv mcor_sqrt(realv x)
{
  return sqrt(x);
}
#endif

/* W / norm * h^3 at offset (dx, dy, dz), from what (dx, dy) give, which serves a column of points,
 * and what dz gives, which serves a plane. */
realv mcor_planar(realv dx, realv dy, real inv_h)
{
#if MCOR_TENSOR
  return MCOR_W(fabs(dx) * inv_h) * MCOR_W(fabs(dy) * inv_h);
#else
  return dx * dx + dy * dy;
#endif
}

realv mcor_height(realv dz, realv inv_h)
{
#if MCOR_TENSOR
  return MCOR_W(fabs(dz) * inv_h);
#else
  return dz * dz;
#endif
}

realv mcor_weight(realv planar, realv height, real inv_h)
{
#if MCOR_TENSOR
  return planar * height;
#else
  return MCOR_W(mcor_sqrt(planar + height) * inv_h);
#endif
}

/* The same, and the gradient with respect to (dx, dy, dz). */
realv mcor_weight_gradient(
  realv dx, realv dy, realv dz, real inv_h, realv* gx, realv* gy, realv* gz)
{
#if MCOR_TENSOR
  const realv qx = fabs(dx) * inv_h, qy = fabs(dy) * inv_h, qz = fabs(dz) * inv_h;
  const realv wx = MCOR_W(qx), wy = MCOR_W(qy), wz = MCOR_W(qz);
  *gx = sign(dx) * MCOR_DW(qx) * wy * wz * inv_h;
  *gy = sign(dy) * MCOR_DW(qy) * wx * wz * inv_h;
  *gz = sign(dz) * MCOR_DW(qz) * wx * wy * inv_h;
  return wx * wy * wz;
#else
  /* 1 / r being finite at r = 0, the gradient is 0 there: for the quadratic kernel, whose slope is
   * not, by definition. */
  const realv r2 = dx * dx + dy * dy + dz * dz;
  const realv inv_r = mcor_rsqrt(r2);
  const realv q = r2 * inv_r * inv_h;
  const realv slope = MCOR_DW(q) * inv_r * inv_h;
  *gx = slope * dx;
  *gy = slope * dy;
  *gz = slope * dz;
  return MCOR_W(q);
#endif
}
