/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The search grid [III-A]: rows of particles that may reach a box.
 *
 * The search grid has a level for each power of 2 of the support radii, so a particle costs work
 * only where its own support reaches. Particles are sorted by (level, z, y, x) of their cells, and
 * within a cell by position, x first, so a row of cells is sorted by x. The order of every sum
 * depends on the particles alone. */

#define MCOR_GRID_PARAMS                                                                           \
  const int particle_count, const int level_count, const int bucket_shift, const real unit,        \
    const real units, const real view_edge, const real edge_x, const real edge_y,                  \
    const real edge_z, __global const mcor_level *levels, __global const int *buckets,             \
    __global const ulong *cell_keys, __global const int *cell_begins, __global const fix *px,      \
    __global const fix *py, __global const fix *pz, __global const real *p_inv_h,                  \
    __global const real *p_weight, __global const real *p_trim_weight,                             \
    __global const real *p_value

/* Arrays are padded by MCOR_PADDING elements, so that a vector load may run over the end. */
typedef struct
{
  int particle_count, level_count, bucket_shift;
  /* Queries, tiles and points measure lengths in cubes (then view_edge is 1), or in cells of a
   * level of adaptive cubes (then view_edge is a cell's length in cubes). unit: a fixed-point unit,
   * in the same measure; units: 1 / unit. unit, units and view_edge are powers of two. */
  real unit, units, view_edge;
  real edge[3]; /* length of an edge, at most 1 */
  fix step[3];  /* length of an edge, from node to node, in fixed-point units */
  __global const mcor_level* levels;
  /* If bucket_shift is 0: the first particle of each cell. Else: for each bucket, the index in
   * cell_keys of the first key that is at least bucket << bucket_shift. */
  __global const int* buckets;
  __global const ulong* cell_keys; /* keys of the cells that have particles, sorted */
  __global const int* cell_begins; /* each such cell's first particle; then particle_count */
  __global const fix *px, *py, *pz;
  __global const real* inv_h;       /* 1 / (h scale * smoothing length), in cubes */
  __global const real* weight;      /* V norm / (scaled h)^3; 0 for solids */
  __global const real* trim_weight; /* V norm / (scaled h)^3, solids included */
  __global const real* value;       /* A - A0: the scalar, less a shift of all values */
} mcor_grid;

#define MCOR_GRID                                                                                  \
  {                                                                                                \
    particle_count, level_count, bucket_shift, unit, units, view_edge,                             \
      { edge_x, edge_y, edge_z },                                                                  \
      { (fix)(edge_x * units), (fix)(edge_y * units), (fix)(edge_z * units) }, levels, buckets,    \
      cell_keys, cell_begins, px, py, pz, p_inv_h, p_weight, p_trim_weight, p_value                \
  }

/* Returns the index of the first particle whose cell key is >= key. */
int mcor_first_particle(const mcor_grid* grid, ulong key)
{
  const ulong bucket = key >> grid->bucket_shift;
  const int low = grid->buckets[bucket];
  if (grid->bucket_shift == 0)
  {
    return low;
  }
  return grid->cell_begins[mcor_find_key(grid->cell_keys, low, grid->buckets[bucket + 1], key)];
}

/* A box, in cubes relative to a query's origin. */
typedef struct
{
  real center[3], half_size[3];
} mcor_span;

/* A walk over the particles that may reach the box [low, high], row by row of search cells. */
typedef struct
{
  fix low[3], high[3];
  fix origin[3]; /* positions in a tile count from here */
  mcor_span box; /* the same box */
  float radius;  /* in cubes; if below 0, -radius times each particle's own support */
  /* Lengths for the current level, in fixed-point units. cell_size: edges of a cell; first_cell:
   * where cell 0 begins; slack: how far rounding may move a particle across a cell's face; reach2:
   * squared reach; z2: squared distance between the box and the rows at z. */
  float cell_size[3], first_cell[3], slack[3], reach2, z2;
  int level, first[3], last[3], y, z;
  bool has_many_rows; /* more rows are in reach than MCOR_MANY_ROWS */
  int begin, end;     /* remaining particles of the current row */
} mcor_query;

/* Returns a distance in fixed-point units, at most the lattice's extent, so that a position minus
 * the distance cannot overflow. */
fix mcor_query_reach(float distance)
{
  const fix most = (fix)1 << (MCOR_DOUBLE ? 62 : 30);
  return distance < (float)most ? (fix)distance : most;
}

/* With more rows than this, a query skips runs of empty rows. If smoothing lengths differ much,
 * nearly all rows are empty, because most levels have their particles elsewhere. */
#define MCOR_MANY_ROWS(grid) ((grid)->level_count > 1 ? 3 : 64)

/* Returns x + reach, or the greatest number if the sum overflows. */
fix mcor_query_beyond(fix x, fix reach)
{
  const fix most = (((fix)1 << (MCOR_DOUBLE ? 62 : 30)) - 1) * 2 + 1;
  return min(x, most - reach) + reach;
}

/* Moves to the first level from number `next` on that has cells in reach. Returns false if there is
 * no such level. */
bool mcor_query_next_level(const mcor_grid* grid, mcor_query* query, int next)
{
  query->begin = query->end = 0;
  for (query->level = next; query->level < grid->level_count; ++query->level)
  {
    __global const mcor_level* level = grid->levels + query->level;
    const float support = query->radius >= 0
      ? query->radius
      : -query->radius * (level->support / (float)grid->view_edge);
    const float far = ceil(support * (float)grid->units) + 1;
    const fix reach = mcor_query_reach(far);
    bool some = true;
    query->reach2 = far * far;
    for (int a = 0; a < 3; ++a)
    {
      query->cell_size[a] = 1 / level->inv_cell[a];
      query->first_cell[a] = (float)level->side[a] - (float)level->period[a];
      query->slack[a] = 1 + 1e-6f * (float)level->period[a];
      query->first[a] = max(mcor_cell_of(level, a, query->low[a] - reach), 0);
      query->last[a] =
        min(mcor_cell_of(level, a, mcor_query_beyond(query->high[a], reach)), level->cells[a] - 1);
      some = some && query->first[a] <= query->last[a];
    }
    query->y = query->last[1]; /* as if a row before the first had ended */
    query->z = query->first[2] - 1;
    query->has_many_rows =
      (long)(query->last[1] - query->first[1] + 1) * (query->last[2] - query->first[2] + 1) >
      MCOR_MANY_ROWS(grid);
    if (some)
    {
      return true;
    }
  }
  return false;
}

/* Sets the origin of a query, and makes `box` from the query's `low` and `high`, which are set
 * already. */
void mcor_query_place(const mcor_grid* grid, mcor_query* query, const fix origin[3])
{
  for (int a = 0; a < 3; ++a)
  {
    query->origin[a] = origin[a];
    query->box.half_size[a] = (real)(query->high[a] - query->low[a]) * grid->unit * (real)0.5;
    query->box.center[a] = (real)(query->low[a] - origin[a]) * grid->unit + query->box.half_size[a];
  }
}

/* Returns the squared distance between the box and a cell along an axis. The distance is shortened
 * by how far rounding may have moved a particle across the cell's face. */
float mcor_query_distance2(const mcor_query* query, int axis, int cell)
{
  const float low = (float)query->low[axis], high = (float)query->high[axis];
  const float begin = query->first_cell[axis] + (float)cell * query->cell_size[axis];
  const float end = begin + query->cell_size[axis];
  const float d =
    fmax(low - end, begin - high) - 1e-6f * (fabs(low) + fabs(high)) - query->slack[axis];
  return d > 0 ? d * d : 0;
}

/* Finds particles [begin, end) of the current row that may be in reach. A row is sorted by x. */
void mcor_query_row(const mcor_grid* grid, mcor_query* query)
{
  __global const mcor_level* level = grid->levels + query->level;
  const ulong row = level->base + ((ulong)query->z * level->cells[1] + query->y) * level->cells[0];
#if MCOR_TENSOR
  const float rest = query->reach2;
#else
  const float rest = query->reach2 - query->z2 - mcor_query_distance2(query, 1, query->y);
#endif
  query->begin = query->end = 0;
  if (rest < 0)
  {
    return;
  }
  int begin = mcor_first_particle(grid, row + query->first[0]);
  int end = mcor_first_particle(grid, row + query->last[0] + 1);
  const fix reach = mcor_query_reach(sqrt(rest) * 1.000001f + 2);
  const fix low = query->low[0] - reach, high = mcor_query_beyond(query->high[0], reach);
  while (end - begin >= MCOR_LANES && grid->px[begin + MCOR_LANES - 1] < low)
  {
    begin += MCOR_LANES;
  }
  while (end - begin >= MCOR_LANES && grid->px[end - MCOR_LANES] > high)
  {
    end -= MCOR_LANES;
  }
  query->begin = begin;
  query->end = end;
}

/* Skips empty rows, so that mcor_query_next_row goes on with the level's next row that has
 * particles or, if that row has a larger z, with the query's first row at the larger z. */
void mcor_query_skip_rows(const mcor_grid* grid, mcor_query* query)
{
  __global const mcor_level* level = grid->levels + query->level;
  const ulong nx = level->cells[0], ny = level->cells[1], nz = level->cells[2];
  const int next = mcor_first_particle(grid, level->base + (query->z * ny + query->y + 1) * nx);
  const int end = mcor_first_particle(grid, level->base + nz * ny * nx);
  const int z = next < end ? mcor_cell_of_particle(level, 2, grid->pz[next]) : level->cells[2];
  if (z == query->z)
  {
    query->y = min(mcor_cell_of_particle(level, 1, grid->py[next]) - 1, query->last[1]);
  }
  else
  {
    query->y = query->last[1]; /* the end of the rows at z */
    query->z = min(z - 1, query->last[2]);
  }
}

/* Moves to the next row with particles. Returns false at the end. */
bool mcor_query_next_row(const mcor_grid* grid, mcor_query* query)
{
  while (query->level < grid->level_count)
  {
    if (++query->y > query->last[1])
    {
      query->y = query->first[1];
      if (++query->z > query->last[2])
      {
        mcor_query_next_level(grid, query, query->level + 1);
        continue;
      }
      query->z2 = MCOR_TENSOR ? 0 : mcor_query_distance2(query, 2, query->z);
    }
    mcor_query_row(grid, query);
    if (query->begin < query->end)
    {
      return true;
    }
    if (query->has_many_rows)
    {
      mcor_query_skip_rows(grid, query);
    }
  }
  return false;
}

/* Fits the query's box to sorted particles from `begin` on, until `end`, or until x descends, which
 * happens only at the end of a row. Returns the number of these particles, and in *coarsest the
 * least of their inv_h. */
int mcor_query_particles(
  const mcor_grid* grid, mcor_query* query, int begin, int end, real* coarsest)
{
  __global const fix* const position[3] = { grid->px, grid->py, grid->pz };
  fixv low[3], high[3];
  realv least = grid->inv_h[begin];
  int count = end - begin;
  for (int a = 0; a < 3; ++a)
  {
    low[a] = high[a] = position[a][begin];
  }
  for (int i = 0; i < count; i += MCOR_LANES)
  {
    const fixv ends = MCOR_LOAD_FIX(begin + i + 1, grid->px) < MCOR_LOAD_FIX(begin + i, grid->px);
    for (int lane = 0; MCOR_ANY(ends) && i + lane < count && lane < MCOR_LANES; ++lane)
    {
      count = MCOR_GET_FIX(ends, lane) ? i + lane + 1 : count;
    }
    const fixv inside = mcor_lane_index() < (fixv)(count - i);
    for (int a = 0; a < 3; ++a)
    {
      const fixv p = MCOR_LOAD_FIX(begin + i, position[a]);
      low[a] = inside ? min(low[a], p) : low[a];
      high[a] = inside ? max(high[a], p) : high[a];
    }
    least = inside ? fmin(least, MCOR_LOAD(begin + i, grid->inv_h)) : least;
  }
  *coarsest = MCOR_GET(least, 0);
  for (int a = 0; a < 3; ++a)
  {
    query->low[a] = MCOR_GET_FIX(low[a], 0);
    query->high[a] = MCOR_GET_FIX(high[a], 0);
    for (int lane = 1; lane < MCOR_LANES; ++lane)
    {
      query->low[a] = min(query->low[a], MCOR_GET_FIX(low[a], lane));
      query->high[a] = max(query->high[a], MCOR_GET_FIX(high[a], lane));
      *coarsest = fmin(*coarsest, MCOR_GET(least, lane));
    }
  }
  mcor_query_place(grid, query, query->low);
  return count;
}

/* A query's particles are read tile by tile. The host embeds one of two files that define tiles:
 * mcor_gather_lanes.cl (packed copies of particles, for MCOR_LANES points at once) or
 * mcor_gather_point.cl (the particles themselves, for one point). Both define
 *
 *   mcor_tile tile;                  particles that may reach the query's box; a particle
 *   mcor_tile_init(&tile);           that does not reach it adds exactly 0
 *   for (bool first = true; mcor_tile_next(grid, &query, &tile, first); first = false)
 *     for (int i = 0; i < tile.count; ++i)
 *       ... MCOR_EACH(&tile, x, i), MCOR_INDEX(&tile, i) ...
 *
 * MCOR_EACH is an element of particle i, for all lanes; MCOR_TILE has the elements of particles i,
 * i + 1, ..., one for each lane; MCOR_INDEX is the place in the sorted arrays. The elements are x,
 * y, z (from the query's origin, in cubes; exact for particles that reach points of a group or
 * nodes of a brick, see MCOR_POINT_EXTENT), inv_h, weight, trim_weight (to be read as
 * MCOR_TRIM_WEIGHT) and value.
 *
 * The loop may be repeated. A `complete` tile holds all particles of its query and is not gathered
 * again. mcor_tile_narrow(&wide, &query, &tile) fills a tile, but not its MCOR_INDEX, from a
 * complete tile of a query that has the same origin and a box that encloses the box of `query`.
 *
 * mcor_list_lanes(chosen, count, lanes) lists which of the first `count` lanes are chosen, and
 * returns their number.
 *
 * For points (mcor_points.cl), lanes may read different particles at the same time:
 *
 *   mcor_reach reach;
 *   mcor_tile_init(&reach.tile);
 *   for (bool first = true; mcor_reach_next(grid, &query, &points, iso, &reach, first); ...)
 *     for (int i = 0; i < MCOR_REACH_COUNT(&reach); ++i)
 *       ... MCOR_REACH(&reach, x, i), MCOR_REACH_TERM(&reach, i, iso) ...
 *       MCOR_REACH_KEEP(&reach, i, w);    the kernel's value, for mcor_attribute_sums
 *
 * mcor_attribute_sums(grid, &query, &points, iso, &reach, evaluated, ...) adds weights, and weights
 * times attributes, of the particles; evaluated: the weights that were kept last may be used.
 *
 * mcor_values_load(&reach, arrays, &values) makes sorted arrays readable at the particles of a
 * reach: MCOR_VALUE_OF(&values, &reach, c, i) is the value of arrays[c] at particle i. */
#if MCOR_SOLIDS
#define MCOR_TRIM_WEIGHT trim_weight
#else
#define MCOR_TRIM_WEIGHT weight
#endif

/* A particle's term of the field is its weight times MCOR_FIELD_TERM. */
#if MCOR_FIELD == MCOR_SHEPARD
#define MCOR_FIELD_TERM(value, iso) ((value) - (iso)) /* both relative to A0 */
#else
#define MCOR_FIELD_TERM(value, iso) (value)
#endif
