/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Search grid [III-A]: particles sorted by cell; volumes. */

#if MCOR_OF_LATTICE
/* One work-item = one particle. Reads position and level. Writes the key of its search cell. */
__kernel void mcor_grid_key(const int count, __global const mcor_level* levels,
  __global const uchar* level_of, __global const fix* xyz, __global ulong* keys)
{
  const int i = get_global_id(0);
  if (i >= count)
  {
    return;
  }
  __global const mcor_level* level = levels + level_of[i];
  ulong cell[3];
  for (int a = 0; a < 3; ++a)
  {
    cell[a] = mcor_cell_of_particle(level, a, xyz[3L * i + a]);
  }
  keys[i] = level->base + (cell[2] * level->cells[1] + cell[1]) * level->cells[0] + cell[0];
}

/* Order of two particles of one search cell: by position, then by size and kind. Particles equal in
 * all of this are interchangeable but for their scalar, see mcor_grid_order_value. */
bool mcor_grid_before(__global const fix* xyz, __global const real* inv_h,
  __global const real* volume, __global const uchar* solid, int i, int j)
{
  for (int a = 0; a < 3; ++a)
  {
    if (xyz[3L * i + a] != xyz[3L * j + a])
    {
      return xyz[3L * i + a] < xyz[3L * j + a];
    }
  }
  if (inv_h[i] != inv_h[j])
  {
    return inv_h[i] < inv_h[j];
  }
  return volume[i] != volume[j] ? volume[i] < volume[j] : solid[i] < solid[j];
}

/* Insertion sort in each of some cells; its limit. Particles lie far apart in the input arrays: all
 * are asked for before the first is needed. Returns the most particles of a cell. */
#define MCOR_INSERTION_LIMIT MCOR_INSERTION_OF(MCOR_LANES)
int mcor_grid_insert(__global const ulong* keys, __global const fix* xyz,
  __global const real* inv_h, __global const real* volume, __global const uchar* solid,
  __global int* order, int count)
{
  fix x[MCOR_INSERTION_LIMIT];
  int sorted[MCOR_INSERTION_LIMIT];
  int most = 0;
  for (int i = 0; i < count; ++i)
  {
    sorted[i] = order[i];
    x[i] = xyz[3L * sorted[i]];
    MCOR_PREFETCH(inv_h + sorted[i]);
    MCOR_PREFETCH(volume + sorted[i]);
  }
  for (int i = 0, cell = 0; i < count; ++i)
  {
    const int item = sorted[i];
    const fix item_x = x[i];
    cell = i > 0 && keys[i] == keys[i - 1] ? cell : i;
    most = max(most, i - cell + 1);
    int to = i;
    for (; to > cell &&
         (item_x < x[to - 1] ||
           (item_x == x[to - 1] &&
             mcor_grid_before(xyz, inv_h, volume, solid, item, sorted[to - 1])));
         --to)
    {
      x[to] = x[to - 1];
      sorted[to] = sorted[to - 1];
    }
    x[to] = item_x;
    sorted[to] = item;
  }
  for (int i = 0; i < count; ++i)
  {
    order[i] = sorted[i];
  }
  return most;
}

/* The particles' arrays, of the input and in sorted order. `volume` is the mass, or 1, where it is
 * still to be computed; norm: of the SPH kernel. */
#define MCOR_GRID_INPUT                                                                            \
  __global const fix *xyz, __global const real *inv_h_in, __global const real *volume,             \
    __global const uchar *solid
#define MCOR_GRID_OUTPUT                                                                           \
  __global fix *px, __global fix *py, __global fix *pz, __global real *inv_h_out,                  \
    __global real *weight, __global real *trim_weight

/* Moves particle j of the input to place i. */
void mcor_grid_move_particle(int i, int j, real norm, MCOR_GRID_INPUT, MCOR_GRID_OUTPUT)
{
  px[i] = xyz[3L * j];
  py[i] = xyz[3L * j + 1];
  pz[i] = xyz[3L * j + 2];
  const real inv_h = inv_h_in[j];
  inv_h_out[i] = inv_h;
  const real w = volume[j] * norm * inv_h * inv_h * inv_h;
  trim_weight[i] = w;
  weight[i] = solid[j] ? (real)0 : w; /* the same array where there are no solids */
}

/* End of the whole cells from `first` on that begin before `end`, as many as have room for insertion
 * sort: `first` itself where the first of them has not. */
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

/* One work-item = the cells that begin in a batch of particles. Reads the input arrays. Writes the
 * order of the particles in these cells, so that it no longer depends on that of the input, and the
 * arrays in that order. Raises `most` to the particles of a cell; one with more than
 * MCOR_INSERTION_LIMIT is left to mcor_grid_sort_runs. */
__kernel void mcor_grid_order(const int count, const real norm, __global const ulong* keys,
  MCOR_GRID_INPUT, __global int* order, MCOR_GRID_OUTPUT, __global int* most)
{
  int first = get_global_id(0) * MCOR_BATCH;
  const int end = min(first + MCOR_BATCH, count);
  while (first > 0 && first < end && keys[first] == keys[first - 1])
  {
    ++first;
  }
  while (first < end)
  {
    const int last = mcor_grid_cells_end(keys, first, end, count);
    const int size = last == first
      ? mcor_find_key(keys, first, count, keys[first] + 1) - first
      : mcor_grid_insert(keys + first, xyz, inv_h_in, volume, solid, order + first, last - first);
    for (int i = first; i < last; ++i)
    {
      mcor_grid_move_particle(i, order[i], norm, xyz, inv_h_in, volume, solid, px, py, pz,
        inv_h_out, weight, trim_weight);
    }
    if (size > MCOR_USUAL_IN_CELL)
    {
      atomic_max(most, size);
    }
    first = last == first ? first + size : last;
  }
}

/* Groups of any number of particles with the same key are sorted by all work-items together: runs of
 * MCOR_INSERTION_LIMIT, then pairs of runs are merged into runs twice as long. The groups are cells,
 * or (by_value) coincident particles, which are sorted by their scalar, so that not even they make a
 * result depend on the order of the input; then by that order, so that no earlier scalar's shows. */
#define MCOR_SORT_PARAMS                                                                           \
  const int count, __global const ulong *keys, MCOR_GRID_INPUT, const int by_value,                \
    __global const real *value
#define MCOR_SORT_ARGS count, keys, xyz, inv_h_in, volume, solid, by_value, value

bool mcor_grid_value_before(real v, int source, real w, int other)
{
  return v != w ? v < w : source < other;
}

bool mcor_sort_before(MCOR_SORT_PARAMS, int i, int j)
{
  return by_value ? mcor_grid_value_before(value[i], i, value[j], j)
                  : mcor_grid_before(xyz, inv_h_in, volume, solid, i, j);
}

/* Whether place i may be one of more than MCOR_INSERTION_LIMIT with one key. */
bool mcor_sort_is_large(__global const ulong* keys, int i, int count)
{
  const int step = MCOR_INSERTION_LIMIT / 2;
  return (i >= step && keys[i - step] == keys[i]) ||
    (i + step < count && keys[i + step] == keys[i]);
}

/* One work-item = one batch of sorted particles. Sorts the runs that begin there. */
__kernel void mcor_grid_sort_runs(MCOR_SORT_PARAMS, __global int* order)
{
  const int begin = get_global_id(0) * MCOR_BATCH;
  for (int i = begin, group = count; i < min(begin + MCOR_BATCH, count); ++i)
  {
    if (!mcor_sort_is_large(keys, i, count))
    {
      continue;
    }
    group = group < i && keys[group] == keys[i] ? group : mcor_find_key(keys, 0, i, keys[i]);
    if ((i - group) % MCOR_INSERTION_LIMIT != 0)
    {
      continue;
    }
    const int end = min(i + MCOR_INSERTION_LIMIT, count);
    for (int next = i + 1; next < end && keys[next] == keys[i]; ++next)
    {
      const int item = order[next];
      int to = next;
      for (; to > i && mcor_sort_before(MCOR_SORT_ARGS, item, order[to - 1]); --to)
      {
        order[to] = order[to - 1];
      }
      order[to] = item;
    }
  }
}

/* One work-item = one batch of sorted particles. Reads an order with sorted runs of a width. Writes
 * where each particle is in the order with runs of twice that width: as many places behind its own
 * among both runs as the other run has before it. */
__kernel void mcor_grid_merge(
  MCOR_SORT_PARAMS, const int width, __global const int* order, __global int* merged)
{
  const int begin = get_global_id(0) * MCOR_BATCH;
  for (int i = begin, group = 0, end = 0; i < min(begin + MCOR_BATCH, count); ++i)
  {
    if (!mcor_sort_is_large(keys, i, count))
    {
      merged[i] = order[i];
      continue;
    }
    if (i >= end)
    {
      group = mcor_find_key(keys, 0, i, keys[i]);
      end = mcor_find_key(keys, i, count, keys[i] + 1);
    }
    const int own = (i - group) / width, run = group + own * width;
    const bool is_first = own % 2 == 0;
    const int other = is_first ? (int)min((long)run + width, (long)end) : run - width;
    int low = other, high = is_first ? (int)min((long)other + width, (long)end) : run;
    while (low < high)
    {
      const int middle = low + (high - low) / 2;
      /* Of equal ones, the first run's come first. */
      const bool before = is_first ? mcor_sort_before(MCOR_SORT_ARGS, order[middle], order[i])
                                   : !mcor_sort_before(MCOR_SORT_ARGS, order[i], order[middle]);
      low = before ? middle + 1 : low;
      high = before ? high : middle;
    }
    merged[(is_first ? i : i - width) + (low - other)] = order[i];
  }
}

/* One work-item = one sorted particle. Reads the input arrays. Writes them in sorted order where
 * mcor_grid_order left a cell to mcor_grid_sort_runs. */
__kernel void mcor_grid_move(const int count, const real norm, __global const ulong* keys,
  MCOR_GRID_INPUT, __global const int* order, MCOR_GRID_OUTPUT)
{
  const int i = get_global_id(0);
  if (i < count && mcor_sort_is_large(keys, i, count))
  {
    mcor_grid_move_particle(
      i, order[i], norm, xyz, inv_h_in, volume, solid, px, py, pz, inv_h_out, weight, trim_weight);
  }
}

/* One work-item = one sorted particle. Reads an array in input order. Writes it in sorted order,
 * to a row that is `count` long. */
__kernel void mcor_grid_gather_value(const int count, __global const int* order,
  __global const real* in, __global real* out, const int out_row)
{
  const int i = get_global_id(0);
  if (i < count)
  {
    out[(long)out_row * count + i] = in[order[i]];
  }
}

/* Whether sorted particles i and j differ in their scalar only. */
#define MCOR_COINCIDENT_PARAMS                                                                     \
  __global const fix *px, __global const fix *py, __global const fix *pz,                          \
    __global const real *inv_h, __global const real *weight, __global const real *trim_weight
bool mcor_grid_is_same(MCOR_COINCIDENT_PARAMS, int i, int j)
{
  return px[i] == px[j] && py[i] == py[j] && pz[i] == pz[j] && inv_h[i] == inv_h[j] &&
    weight[i] == weight[j] && trim_weight[i] == trim_weight[j];
}
#define MCOR_SAME(i, j) mcor_grid_is_same(px, py, pz, inv_h, weight, trim_weight, i, j)

/* One work-item = one sorted particle, the first of coincident ones. Sorts these; where they are more
 * than MCOR_INSERTION_LIMIT, says so. */
__kernel void mcor_grid_order_value(const int count, MCOR_COINCIDENT_PARAMS, __global real* value,
  __global int* order, __global int* many)
{
  const int begin = get_global_id(0);
  if (begin + 1 >= count || !MCOR_SAME(begin, begin + 1) ||
    (begin > 0 && MCOR_SAME(begin, begin - 1)))
  {
    return;
  }
  const int limit = min(begin + MCOR_INSERTION_LIMIT, count - 1);
  for (int i = begin + 1; i <= limit && MCOR_SAME(begin, i); ++i)
  {
    if (i == begin + MCOR_INSERTION_LIMIT)
    {
      atomic_or(many, 1);
      break;
    }
    const real v = value[i];
    const int source = order[i];
    int to = i;
    for (; to > begin && mcor_grid_value_before(v, source, value[to - 1], order[to - 1]); --to)
    {
      value[to] = value[to - 1];
      order[to] = order[to - 1];
    }
    value[to] = v;
    order[to] = source;
  }
}

/* One work-item = one sorted particle. Writes 1 where it differs from the one before it in more than
 * the scalar. */
__kernel void mcor_grid_count_places(const int count, MCOR_COINCIDENT_PARAMS, __global int* flags)
{
  const int i = get_global_id(0);
  if (i < count)
  {
    flags[i] = i == 0 || !MCOR_SAME(i, i - 1);
  }
}

/* One work-item = one sorted particle. Reads the scanned flags. Writes a key that it shares with those
 * coincident with it. */
__kernel void mcor_grid_fill_places(
  const int count, __global const int* scanned, __global ulong* keys)
{
  const int i = get_global_id(0);
  if (i < count)
  {
    keys[i] = (ulong)scanned[i + 1];
  }
}

#endif

#if MCOR_OF_FIELD
/* One work-item = MCOR_LANES sorted particles. Reads the grid and masses (1 each: number density).
 * Writes sum_k m_k W(x_j - x_k, h_j) h_j^3 / norm with each particle's own, unscaled h_j. */
__kernel void mcor_grid_density(
  MCOR_GRID_PARAMS, const real h_scale, __global const real* mass, __global real* density)
{
  const mcor_grid grid = MCOR_GRID;
  const int begin = get_global_id(0) * MCOR_LANES;
  if (begin >= particle_count)
  {
    return;
  }
  const int end = min(begin + MCOR_LANES, particle_count);
  const fixv x = MCOR_LOAD_FIX(begin, px), y = MCOR_LOAD_FIX(begin, py),
             z = MCOR_LOAD_FIX(begin, pz);
  const realv scale = grid.unit * h_scale * MCOR_LOAD(begin, p_inv_h);
  realv sum = 0;
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
        const int k = MCOR_INDEX(&tile, i);
        const realv qx = MCOR_CONVERT_REALV(px[k] - x) * scale;
        const realv qy = MCOR_CONVERT_REALV(py[k] - y) * scale;
        const realv qz = MCOR_CONVERT_REALV(pz[k] - z) * scale;
        const realv m = inside ? (realv)mass[k] : (realv)0;
        sum = MCOR_FMA(m, mcor_weight(mcor_distance(qx, qy, qz, (real)1), (real)1), sum);
      }
    }
  }
#if MCOR_LANES == 1
  density[begin] = sum;
#else
  MCOR_CAT(vstore, MCOR_LANES)(sum, 0, density + begin);
#endif
}

/* Density, as a factor of what a particle itself adds to it, at least: below, a computed volume would
 * be huge, or negative, as a kernel with negative lobes can make it. */
#define MCOR_LEAST_DENSITY ((real)0.01f)

/* Where the field is evaluated, in cubes. */
#define MCOR_EVALUATED_PARAMS                                                                      \
  const real low_x, const real low_y, const real low_z, const real high_x, const real high_y,      \
    const real high_z

/* Whether a particle, `support` around x, reaches what is evaluated, or nearly so. */
bool mcor_grid_reaches(const real* x, real support, MCOR_EVALUATED_PARAMS)
{
  const real far = support * (real)1.001f + (real)0.01f;
  return x[0] + far > low_x && x[0] - far < high_x && x[1] + far > low_y && x[1] - far < high_y &&
    x[2] + far > low_z && x[2] - far < high_z;
}

/* One work-item = one sorted particle. Turns density into the weight V norm / (scaled h)^3: as
 * V = m / (sum m W), the norm and the unscaled h^3 cancel. Writes the first particle, if any, of
 * which the density is too low to `without`; not where it lacks neighbours, as it reaches nothing. */
__kernel void mcor_grid_weight(const int count, const real h_scale, __global const int* order,
  __global const uchar* solid, __global const real* mass, __global const real* density,
  const int fix_bits, __global const fix* px, __global const fix* py, __global const fix* pz,
  __global const real* inv_h, MCOR_EVALUATED_PARAMS, __global real* weight,
  __global real* trim_weight, __global int* without)
{
  const int i = get_global_id(0);
  if (i >= count)
  {
    return;
  }
  real sum = density[i];
  if (!(sum > mass[i] * MCOR_LEAST_DENSITY))
  {
    const real unit = ldexp((real)1, -fix_bits);
    const real x[3] = { (real)px[i] * unit, (real)py[i] * unit, (real)pz[i] * unit };
    if (mcor_grid_reaches(x, MCOR_SUPPORT / inv_h[i], low_x, low_y, low_z, high_x, high_y, high_z))
    {
      atomic_min(without, order[i]);
    }
    sum = mass[i];
  }
  const real w = mass[i] / (sum * h_scale * h_scale * h_scale);
  trim_weight[i] = w;
#if MCOR_SOLIDS
  weight[i] = solid[order[i]] ? (real)0 : w;
#endif
}
#endif
