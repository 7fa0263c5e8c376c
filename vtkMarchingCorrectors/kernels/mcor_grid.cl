/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Search grid [III-A]: particles sorted by cell; volumes. */

/* One work-item = one particle. Reads position and level. Writes the key of its search cell. */
__kernel void mcor_grid_key(const int count, __global const mcor_level* levels,
  __global const uchar* level_of, __global const fix* xyz, __global ulong* keys)
{
  const int i = get_global_id(0);
  if (i >= count)
  {
    return;
  }
  const mcor_level level = levels[level_of[i]];
  ulong cell[3];
  for (int a = 0; a < 3; ++a)
  {
    cell[a] = mcor_cell_of_particle(level, a, xyz[3L * i + a]);
  }
  keys[i] = level.base + (cell[2] * level.cells[1] + cell[1]) * level.cells[0] + cell[0];
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

/* Heap sort's sift: the child `root` sinks in order[0..count). */
void mcor_grid_sift(__global const fix* xyz, __global const real* inv_h,
  __global const real* volume, __global const uchar* solid, __global int* order, int root,
  int count)
{
  const int item = order[root];
  for (int child = 2 * root + 1; child < count; child = 2 * root + 1)
  {
    if (child + 1 < count &&
      mcor_grid_before(xyz, inv_h, volume, solid, order[child], order[child + 1]))
    {
      ++child;
    }
    if (!mcor_grid_before(xyz, inv_h, volume, solid, item, order[child]))
    {
      break;
    }
    order[root] = order[child];
    root = child;
  }
  order[root] = item;
}

void mcor_grid_heap_sort(__global const fix* xyz, __global const real* inv_h,
  __global const real* volume, __global const uchar* solid, __global int* order, int count)
{
  for (int i = count / 2 - 1; i >= 0; --i)
  {
    mcor_grid_sift(xyz, inv_h, volume, solid, order, i, count);
  }
  for (int last = count - 1; last > 0; --last)
  {
    const int item = order[last];
    order[last] = order[0];
    order[0] = item;
    mcor_grid_sift(xyz, inv_h, volume, solid, order, 0, last);
  }
}

/* Insertion sort in each of some cells; its limit. Particles lie far apart in the input arrays: all
 * are asked for before the first is needed. */
#define MCOR_INSERTION_LIMIT (MCOR_LANES == 1 ? 64 : 128)
void mcor_grid_insert(__global const ulong* keys, __global const fix* xyz,
  __global const real* inv_h, __global const real* volume, __global const uchar* solid,
  __global int* order, int count)
{
  fix x[MCOR_INSERTION_LIMIT];
  int sorted[MCOR_INSERTION_LIMIT];
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
}

/* One work-item = the cells that begin in a batch of particles. Reads the input arrays. Writes the
 * order of the particles in these cells, so that it no longer depends on that of the input, and the
 * arrays in that order. `volume` is the mass, or 1, where it is still to be computed. */
__kernel void mcor_grid_order(const int count, __global const ulong* keys, __global const fix* xyz,
  __global const real* inv_h_in, __global const real* volume, __global const uchar* solid,
  __global int* order, __global fix* px, __global fix* py, __global fix* pz,
  __global real* inv_h_out, __global real* weight, __global real* trim_weight)
{
  int begin = get_global_id(0) * MCOR_BATCH;
  int end = min(begin + MCOR_BATCH, count);
  while (begin > 0 && begin < end && keys[begin] == keys[begin - 1])
  {
    ++begin;
  }
  while (begin < end && end < count && keys[end] == keys[end - 1])
  {
    ++end;
  }
  const bool few = end - begin <= MCOR_INSERTION_LIMIT;
  if (few)
  {
    mcor_grid_insert(keys + begin, xyz, inv_h_in, volume, solid, order + begin, end - begin);
  }
  /* A cell with many particles is among them. */
  for (int first = begin, last = begin + 1; !few && last <= end; ++last)
  {
    if (last == end || keys[last] != keys[first])
    {
      mcor_grid_heap_sort(xyz, inv_h_in, volume, solid, order + first, last - first);
      first = last;
    }
  }
  for (int i = begin; i < end; ++i)
  {
    const int j = order[i];
    px[i] = xyz[3L * j];
    py[i] = xyz[3L * j + 1];
    pz[i] = xyz[3L * j + 2];
    const real inv_h = inv_h_in[j];
    inv_h_out[i] = inv_h;
    const real w = volume[j] * (real)MCOR_NORM * inv_h * inv_h * inv_h;
    trim_weight[i] = w;
#if MCOR_SOLIDS
    weight[i] = solid[j] ? (real)0 : w;
#endif
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

/* Order of coincident particles: by scalar, so that not even they make a result depend on the order
 * of the input; then by that order, so that no earlier scalar's shows. */
bool mcor_grid_value_before(real v, int source, real w, int other)
{
  return v != w ? v < w : source < other;
}

/* The child `root` of a heap sinks in value[0..count). */
void mcor_grid_value_sift(__global real* value, __global int* order, int root, int count)
{
  const real v = value[root];
  const int source = order[root];
  for (int child = 2 * root + 1; child < count; child = 2 * root + 1)
  {
    child += child + 1 < count &&
      mcor_grid_value_before(value[child], order[child], value[child + 1], order[child + 1]);
    if (!mcor_grid_value_before(v, source, value[child], order[child]))
    {
      break;
    }
    value[root] = value[child];
    order[root] = order[child];
    root = child;
  }
  value[root] = v;
  order[root] = source;
}

/* One work-item = one sorted particle, the first of a run that differs in the scalar only. Sorts
 * the run, by a heap, as there may be any number of them. */
__kernel void mcor_grid_order_value(const int count, __global const fix* px, __global const fix* py,
  __global const fix* pz, __global const real* inv_h, __global const real* weight,
  __global const real* trim_weight, __global real* value, __global int* order)
{
  const int begin = get_global_id(0);
#define MCOR_SAME(i, j)                                                                            \
  (px[i] == px[j] && py[i] == py[j] && pz[i] == pz[j] && inv_h[i] == inv_h[j] &&                   \
    weight[i] == weight[j] && trim_weight[i] == trim_weight[j])
  if (begin + 1 >= count || !MCOR_SAME(begin, begin + 1) ||
    (begin > 0 && MCOR_SAME(begin, begin - 1)))
  {
    return;
  }
  int run = 2;
  while (begin + run < count && MCOR_SAME(begin, begin + run))
  {
    ++run;
  }
#undef MCOR_SAME
  value += begin;
  order += begin;
  for (int i = run / 2 - 1; i >= 0; --i)
  {
    mcor_grid_value_sift(value, order, i, run);
  }
  for (int last = run - 1; last > 0; --last)
  {
    const real v = value[last];
    const int source = order[last];
    value[last] = value[0];
    order[last] = order[0];
    value[0] = v;
    order[0] = source;
    mcor_grid_value_sift(value, order, 0, last);
  }
}

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

/* One work-item = one sorted particle. Turns density into the weight V norm / (scaled h)^3: as
 * V = m / (sum m W), the norm and the unscaled h^3 cancel. Writes the first particle, if any, of
 * which the density is too low to `without`. */
__kernel void mcor_grid_weight(const int count, const real h_scale, __global const int* order,
  __global const uchar* solid, __global const real* mass, __global const real* density,
  __global real* weight, __global real* trim_weight, __global int* without)
{
  const int i = get_global_id(0);
  if (i >= count)
  {
    return;
  }
  if (!(density[i] > mass[i] * MCOR_LEAST_DENSITY))
  {
    atomic_min(without, order[i]);
  }
  const real w = mass[i] / (density[i] * h_scale * h_scale * h_scale);
  trim_weight[i] = w;
#if MCOR_SOLIDS
  weight[i] = solid[order[i]] ? (real)0 : w;
#endif
}
