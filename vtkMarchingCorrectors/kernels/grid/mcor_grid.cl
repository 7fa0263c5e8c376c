/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The search grid [III-A]: sorts particles by cell. Also finds their volumes and weights. */

#if MCOR_OF_LATTICE
/* One work-item = a batch of particles. Reads positions and levels. Writes the keys of their search
 * cells. is_simple: there is one level, and no period. */
__kernel void mcor_grid_key(const int count, const int is_simple, __global const mcor_level* levels,
  __global const uchar* level_of, __global const fix* x, __global const fix* y,
  __global const fix* z, __global ulong* keys)
{
  const int begin = get_global_id(0) * MCOR_BATCH, end = min(begin + MCOR_BATCH, count);
  if (is_simple) /* constants are read before the loop, so that compilers vectorise it */
  {
    const mcor_level level = levels[0];
    const uint row = level.cells[0], layer = level.cells[1];
    for (int i = begin; i < end; ++i)
    {
      const uint cell_x = clamp((int)((float)x[i] * level.inv_cell[0]), 0, level.cells[0] - 1);
      const uint cell_y = clamp((int)((float)y[i] * level.inv_cell[1]), 0, level.cells[1] - 1);
      const uint cell_z = clamp((int)((float)z[i] * level.inv_cell[2]), 0, level.cells[2] - 1);
      keys[i] = level.base + ((ulong)cell_z * layer + cell_y) * row + cell_x;
    }
    return;
  }
  for (int i = begin; i < end; ++i)
  {
    __global const mcor_level* level = levels + level_of[i];
    const ulong cell_x = mcor_cell_of_particle(level, 0, x[i]);
    const ulong cell_y = mcor_cell_of_particle(level, 1, y[i]);
    const ulong cell_z = mcor_cell_of_particle(level, 2, z[i]);
    keys[i] = level->base + (cell_z * level->cells[1] + cell_y) * level->cells[0] + cell_x;
  }
}

/* Arrays of particles, in any order. size: volume or mass, or 1; below 0 for solids. */
#define MCOR_PARTICLES                                                                             \
  __global const fix *x, __global const fix *y, __global const fix *z, __global const real *inv_h, \
    __global const real *size

/* Whether particle i of a search cell goes before particle j: by position, smoothing length, size
 * and kind. Particles for which all these are equal differ at most in their scalar, and are ordered
 * by number, see mcor_grid_order_value. */
bool mcor_grid_before(MCOR_PARTICLES, int i, int j)
{
  return x[i] != x[j]                ? x[i] < x[j]
    : y[i] != y[j]                   ? y[i] < y[j]
    : z[i] != z[j]                   ? z[i] < z[j]
    : inv_h[i] != inv_h[j]           ? inv_h[i] < inv_h[j]
    : fabs(size[i]) != fabs(size[j]) ? fabs(size[i]) < fabs(size[j])
    : size[i] != size[j]             ? size[i] > size[j]
                                     : i < j;
}

/* Whether particle i goes before particle j: by value, then by number; if `value` is NULL, as in
 * mcor_grid_before. */
bool mcor_grid_value_before(MCOR_PARTICLES, __global const real* value, int i, int j)
{
  return !value            ? mcor_grid_before(x, y, z, inv_h, size, i, j)
    : value[i] != value[j] ? value[i] < value[j]
                           : i < j;
}

/* Sorts the particles in `order` by a heap, which needs no further memory. */
void mcor_grid_heap_sort(
  MCOR_PARTICLES, __global const real* value, __global int* order, int count)
{
  int left = count, root = count / 2; /* where the heap ends; where it begins while it grows */
  while (left > 1)
  {
    const bool grows = root > 0;
    root -= grows;
    left -= !grows;
    const int item = order[grows ? root : left];
    if (!grows)
    {
      order[left] = order[0];
    }
    int to = root, child = 2 * root + 1;
    for (; child < left; to = child, child = 2 * child + 1)
    {
      const bool second = child + 1 < left &&
        mcor_grid_value_before(x, y, z, inv_h, size, value, order[child], order[child + 1]);
      child += second;
      if (!mcor_grid_value_before(x, y, z, inv_h, size, value, item, order[child]))
      {
        break;
      }
      order[to] = order[child];
    }
    order[to] = item;
  }
}

/* The largest number of particles that are sorted by insertion. */
#define MCOR_INSERTION_LIMIT MCOR_INSERTION_OF(MCOR_LANES)

#if MCOR_LANES > 1
/* Sorts a cell's particles by x, into `order` and px. Returns false if two particles have the same
 * x; then the result is not complete. A particle's place is the number of particles before it,
 * counted for MCOR_LANES particles at once. */
bool mcor_grid_rank(
  const fix* own, const int* item, int cell, int end, __global int* order, __global fix* px)
{
  fixv most = 1;
  for (int begin = cell; begin < end; begin += MCOR_LANES)
  {
    const fixv at = MCOR_LOAD(begin, own);
    fixv before = 0, same = 0;
    for (int k = cell; k < end; ++k)
    {
      before -= (fixv)own[k] < at;
      same -= (fixv)own[k] == at;
    }
    for (int lane = 0; lane < MCOR_LANES && begin + lane < end; ++lane)
    {
      const int to = cell + (int)MCOR_GET_FIX(before, lane);
      px[to] = own[begin + lane];
      order[to] = item[begin + lane];
    }
    most = max(most, mcor_lane_index() < (fixv)(end - begin) ? same : (fixv)1);
  }
  return !MCOR_ANY(most > (fixv)1);
}
#endif

/* Sorts the particles within each of several whole cells. One call for several cells takes less
 * time than a call for each cell. keys, order and px point to the first particle of the
 * first cell. Returns the largest number of particles in a cell. */
int mcor_grid_insert(
  __global const ulong* keys, MCOR_PARTICLES, __global int* order, __global fix* px, int count)
{
  fix own[MCOR_INSERTION_LIMIT + MCOR_LANES];
  int item[MCOR_INSERTION_LIMIT], most = 0;
  for (int i = 0; i < count; ++i)
  {
    item[i] = order[i];
    own[i] = x[item[i]];
  }
  MCOR_STORE((fixv)0, count, own); /* fills the last vector; nobody uses these lanes */
  for (int cell = 0, end; cell < count; cell = end)
  {
    for (end = cell + 1; end < count && keys[end] == keys[cell];)
    {
      ++end;
    }
    most = max(most, end - cell);
#if MCOR_LANES > 1
    if (mcor_grid_rank(own, item, cell, end, order, px))
    {
      continue;
    }
#endif
    for (int i = cell; i < end; ++i)
    {
      int to = i;
      for (; to > cell &&
           (own[i] < px[to - 1] ||
             (own[i] == px[to - 1] &&
               mcor_grid_before(x, y, z, inv_h, size, item[i], order[to - 1])));
           --to)
      {
        px[to] = px[to - 1];
        order[to] = order[to - 1];
      }
      px[to] = own[i];
      order[to] = item[i];
    }
  }
  return most;
}

/* Finds the cells from particle `first` on that begin before `end`, as many as fit into one
 * insertion sort. Returns the index behind the last particle of these cells; `first` if the first
 * cell is too large. */
int mcor_grid_cells_end(__global const ulong* keys, int first, int end, int count)
{
  const int limit = min(first + MCOR_INSERTION_LIMIT, count);
  int last = min(end, limit);
  while (last < limit && keys[last] == keys[last - 1])
  {
    ++last;
  }
  if (last < count && keys[last] == keys[last - 1])
  {
    while (last > first && keys[last - 1] == keys[limit])
    {
      --last;
    }
  }
  return last;
}

/* One work-item = the cells that begin in a batch of sorted keys. Reads particles in input order.
 * Sorts the particles within these cells, so that their order no longer depends on the input;
 * writes `order`, and px in this order. Raises `most` to the largest number of particles in a cell,
 * if this is above MCOR_USUAL_IN_CELL. */
__kernel void mcor_grid_order(const int count, __global const ulong* keys, MCOR_PARTICLES,
  __global int* order, __global fix* px, __global int* most)
{
  int first = get_global_id(0) * MCOR_BATCH;
  const int end = min(first + MCOR_BATCH, count);
  while (first > 0 && first < end && keys[first] == keys[first - 1])
  {
    ++first;
  }
  while (first < end)
  {
    int last = mcor_grid_cells_end(keys, first, end, count);
    int in_cell =
      mcor_grid_insert(keys + first, x, y, z, inv_h, size, order + first, px + first, last - first);
    if (last == first)
    {
      last = mcor_find_key(keys, first, count, keys[first] + 1);
      in_cell = last - first;
      mcor_grid_heap_sort(x, y, z, inv_h, size, 0, order + first, in_cell);
      for (int i = first; i < last; ++i)
      {
        px[i] = x[order[i]];
      }
    }
    if (in_cell > MCOR_USUAL_IN_CELL)
    {
      atomic_max(most, in_cell);
    }
    first = last;
  }
}

/* One work-item = one particle. Reads from trim_weight the particle's volume V or, for a solid, -V.
 * Writes in its place the trimming weight V norm / (scaled h)^3. Writes to `weight` the trimming
 * weight of fluid, and 0 for solids. norm: the SPH kernel's norm. */
__kernel void mcor_grid_weigh(const int count, const real norm, __global const real* inv_h,
  __global real* weight, __global real* trim_weight)
{
  MCOR_ITEM(i, i < count);
  const real size = trim_weight[i];
  const real w = fabs(size) * norm * inv_h[i] * inv_h[i] * inv_h[i];
  trim_weight[i] = w;
  weight[i] = size < 0 ? (real)0 : w; /* without solids, weight and trim_weight are one array */
}

/* One work-item = one sorted particle. Reads an array, of fix or real, in input order. Writes it in
 * sorted order, to row out_row of `out`, whose rows are `count` long. */
__kernel void mcor_grid_gather_value(const int count, __global const int* order,
  __global const fix* in, __global fix* out, const int out_row)
{
  MCOR_ITEM(i, i < count);
  out[(long)out_row * count + i] = in[order[i]];
}

/* MCOR_SAME: whether sorted particles i and j differ at most in their scalar. Compares x first. */
#define MCOR_COINCIDENT_PARAMS                                                                     \
  __global const fix *px, __global const fix *py, __global const fix *pz,                          \
    __global const real *inv_h, __global const real *weight, __global const real *trim_weight
bool mcor_grid_is_same(MCOR_COINCIDENT_PARAMS, int i, int j)
{
  return py[i] == py[j] && pz[i] == pz[j] && inv_h[i] == inv_h[j] && weight[i] == weight[j] &&
    trim_weight[i] == trim_weight[j];
}
#define MCOR_SAME(i, j)                                                                            \
  (px[i] == px[j] && mcor_grid_is_same(px, py, pz, inv_h, weight, trim_weight, i, j))

/* One work-item = one sorted particle. If it is the first of several that are alike in all but
 * their scalar, sorts these particles by their scalar, so that results never depend on the order of
 * the input. raw: the scalar in input order. */
__kernel void mcor_grid_order_value(const int count, MCOR_COINCIDENT_PARAMS,
  __global const real* raw, __global real* value, __global int* order)
{
  const int begin = get_global_id(0);
  if (begin + 1 >= count || !MCOR_SAME(begin, begin + 1) ||
    (begin > 0 && MCOR_SAME(begin, begin - 1)))
  {
    return;
  }
  int end = begin + 2;
  while (end < count && MCOR_SAME(begin, end))
  {
    ++end;
  }
  mcor_grid_heap_sort(0, 0, 0, 0, 0, raw, order + begin, end - begin);
  for (int i = begin; i < end; ++i)
  {
    value[i] = raw[order[i]];
  }
}

#endif

#if MCOR_OF_FIELD
/* Sums over the neighbours k of a particle j, with q = (x_k - x_j) / h_j. */
typedef struct
{
  realv mass;                /* m_k w(q) */
  realv size;                /* (h_k / h_j)^d w(q), d: dimensions */
  realv fluid[3], solids[3]; /* (h_k / h_j)^d grad w(q) over fluid, over solids */
} mcor_density_sums;

/* Greatest ratio of smoothing lengths that is used. Beyond it one neighbour outweighs all others,
 * and the ratio's cube is near the limit of single precision. */
#define MCOR_LARGEST_RATIO ((real)1e10f)

#define MCOR_DENSITY_PULL(side)                                                                    \
  side[0] = MCOR_FMA(pull, along[0], side[0]);                                                     \
  side[1] = MCOR_FMA(pull, along[1], side[1]);                                                     \
  side[2] = MCOR_FMA(pull, along[2], side[2]);

/* Adds particle k to the sums of the particles j, one in each lane, at positions x. scale: 1 / h_j,
 * with h_j in fixed-point units. inside: the lanes for whose particles the tile was gathered; other
 * lanes stay unchanged. */
void mcor_density_add(const mcor_grid* grid, __global const real* mass, int k, const fixv x[3],
  realv scale, realv inv_h, fixv inside, int plane, mcor_density_sums* sums)
{
  const realv q[3] = { MCOR_CONVERT_REALV(grid->px[k] - x[0]) * scale,
    MCOR_CONVERT_REALV(grid->py[k] - x[1]) * scale,
    MCOR_CONVERT_REALV(grid->pz[k] - x[2]) * scale };
  const mcor_length length = mcor_length_of(q);
  realv slope, along[3];
  const realv w = mcor_weight_gradient(q, &length, (realv)1, &slope, along);
  sums->mass = MCOR_FMA(inside ? (realv)fabs(mass[k]) : (realv)0, w, sums->mass);
#if !MCOR_TENSOR
  const realv ratio = fmin(((real)1 / grid->inv_h[k]) * inv_h, (realv)MCOR_LARGEST_RATIO);
  const realv size = inside ? ratio * ratio * (plane ? (realv)1 : ratio) : (realv)0;
  const realv pull = size * slope;
  sums->size = MCOR_FMA(size, w, sums->size);
  if (MCOR_SOLIDS && mass[k] < 0)
  {
    MCOR_DENSITY_PULL(sums->solids)
  }
  else
  {
    MCOR_DENSITY_PULL(sums->fluid)
  }
#endif
}

/* A side without neighbours lowers a particle's density. Returns the factor that corrects this: 1 +
 * 5/3 D^2 with D^2 = variance |g|^2 / n^2. g: the sum `fluid`; n: the sum `size`; variance: that of
 * the SPH kernel; one_sided: 5/3 variance. Solids may fill the empty side, but not overfill it. So
 * g becomes g + share * solids, with the share from 0 to 1 that makes |g| least. */
realv mcor_density_factor(const mcor_density_sums* sums, real one_sided)
{
  const realv unit = (real)1 / sums->size;
  realv g[3], s[3];
  for (int a = 0; a < 3; ++a)
  {
    g[a] = sums->fluid[a] * unit;
    s[a] = sums->solids[a] * unit;
  }
#if MCOR_SOLIDS
  const realv dot = MCOR_FMA(g[2], s[2], MCOR_FMA(g[1], s[1], g[0] * s[0]));
  const realv square = mcor_square(s[0], s[1], s[2]);
  const realv share = square > (realv)0 ? clamp(-dot / square, (realv)0, (realv)1) : (realv)0;
  for (int a = 0; a < 3; ++a)
  {
    g[a] = MCOR_FMA(share, s[a], g[a]);
  }
#endif
  return MCOR_FMA((realv)one_sided, mcor_square(g[0], g[1], g[2]), (realv)1);
}

/* One work-item = MCOR_LANES sorted particles j. Reads the grid and masses m (1 for a number
 * density), which are negative for solids. Writes sum_k |m_k| W(x_j - x_k, h_j) h_j^3 / norm, where
 * h_j is the unscaled smoothing length. Unless the kernel is a tensor kernel, the sum of a fluid
 * particle is also multiplied by mcor_density_factor. */
__kernel void mcor_grid_density(MCOR_GRID_PARAMS, const real h_scale, const int plane,
  const real one_sided, __global const real* mass, __global real* density)
{
  MCOR_ITEM(item, (long)item * MCOR_LANES < particle_count);
  const mcor_grid grid = MCOR_GRID;
  const int begin = item * MCOR_LANES;
  const int end = min(begin + MCOR_LANES, particle_count);
  const fixv x[3] = { MCOR_LOAD_FIX(begin, px), MCOR_LOAD_FIX(begin, py),
    MCOR_LOAD_FIX(begin, pz) };
  const realv inv_h = MCOR_LOAD(begin, p_inv_h), scale = grid.unit * h_scale * inv_h;
  mcor_density_sums sums = { 0, 0, { 0, 0, 0 }, { 0, 0, 0 } };
  mcor_query query;
  mcor_tile tile;
  for (int row = begin, next; row < end; row = next)
  {
    real coarsest;
    next = row + mcor_query_particles(&grid, &query, row, end, &coarsest);
    query.radius = (float)(MCOR_SUPPORT / (coarsest * h_scale)) * 1.0001f;
    const fixv lane = mcor_lane_index();
    const fixv inside = lane >= (fixv)(row - begin) && lane < (fixv)(next - begin);
    mcor_tile_init(&tile);
    for (bool first = true; mcor_tile_next(&grid, &query, &tile, first); first = false)
    {
      for (int i = 0; i < tile.count; ++i)
      {
        mcor_density_add(
          &grid, mass, MCOR_INDEX(&tile, i), x, scale, inv_h, inside, plane, &sums);
      }
    }
  }
#if MCOR_TENSOR
  const realv result = sums.mass;
#elif MCOR_SOLIDS
  const realv result = sums.mass *
    (MCOR_LOAD(begin, mass) < (realv)0 ? (realv)1 : mcor_density_factor(&sums, one_sided));
#else
  const realv result = sums.mass * mcor_density_factor(&sums, one_sided);
#endif
  MCOR_STORE(result, begin, density);
}

/* Least density, as a share of what the particle itself adds to it. A lower density, which kernels
 * with negative lobes can cause, would make the volume huge or negative. */
#define MCOR_LEAST_DENSITY ((real)0.01f)

/* One work-item = one sorted particle. Computes the weight V norm / (h_scale h)^3 from the mass m
 * and the density. V = m / (sum m W), so norm and h^3 cancel. Writes to `without` the lowest input
 * number of a particle whose density is too low. Does not report particles whose support stays
 * clear of the box in which the field is evaluated (low, high; in cubes), because they may lack
 * neighbours. */
__kernel void mcor_grid_weight(const int count, const real h_scale, __global const int* order,
  __global const real* density, const real unit, __global const fix* px, __global const fix* py,
  __global const fix* pz, __global const real* inv_h, const real low_x, const real low_y,
  const real low_z, const real high_x, const real high_y, const real high_z, __global real* weight,
  __global real* trim_weight, __global int* without)
{
  MCOR_ITEM(i, i < count);
  const real mass = fabs(trim_weight[i]);
  real sum = density[i];
  if (!(sum > mass * MCOR_LEAST_DENSITY))
  {
    const real x = (real)px[i] * unit, y = (real)py[i] * unit, z = (real)pz[i] * unit;
    const real far = MCOR_SUPPORT / inv_h[i] * (real)1.001f + (real)0.01f;
    if (x + far > low_x && x - far < high_x && y + far > low_y && y - far < high_y &&
      z + far > low_z && z - far < high_z)
    {
      atomic_min(without, order[i]);
    }
    sum = mass;
  }
  const real w = mass / (sum * h_scale * h_scale * h_scale);
#if MCOR_SOLIDS
  weight[i] = trim_weight[i] < 0 ? (real)0 : w;
#endif
  trim_weight[i] = w;
}
#endif
