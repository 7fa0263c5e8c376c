/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Reads the particles for one point per work-item, in the form for GPUs: in place, a row of search
 * cells at a time, without copies. The end of mcor_query.cl describes the interface. */

/* Particles of a row that may reach the query's box. */
typedef struct
{
  mcor_grid grid;
  fix origin[3];
  int begin, count;
  bool complete; /* always false: no particles are kept */
} mcor_tile;

real mcor_tile_position(const mcor_tile* tile, __global const fix* position, int axis, int i)
{
  return (real)(position[tile->begin + i] - tile->origin[axis]) * tile->grid.unit;
}

#define mcor_tile_x(tile, i) mcor_tile_position(tile, (tile)->grid.px, 0, i)
#define mcor_tile_y(tile, i) mcor_tile_position(tile, (tile)->grid.py, 1, i)
#define mcor_tile_z(tile, i) mcor_tile_position(tile, (tile)->grid.pz, 2, i)
#define mcor_tile_inv_h(tile, i)                                                                   \
  ((tile)->grid.inv_h[(tile)->begin + (i)] * (tile)->grid.view_edge)
#define mcor_tile_weight(tile, i) ((tile)->grid.weight[(tile)->begin + (i)])
#define mcor_tile_trim_weight(tile, i) ((tile)->grid.trim_weight[(tile)->begin + (i)])
#define mcor_tile_value(tile, i) ((tile)->grid.value[(tile)->begin + (i)])
#define MCOR_TILE(tile, name, i) MCOR_CAT(mcor_tile_, name)(tile, i)
#define MCOR_EACH MCOR_TILE
#define MCOR_INDEX(tile, i) ((tile)->begin + (i))

int mcor_list_lanes(fixv chosen, int count, int lanes[MCOR_LANES])
{
  lanes[0] = 0;
  return chosen && count > 0;
}

void mcor_tile_init(mcor_tile* tile)
{
  tile->complete = false;
}

bool mcor_tile_next(const mcor_grid* grid, mcor_query* query, mcor_tile* tile, bool first)
{
  if (first)
  {
    mcor_query_next_level(grid, query, 0);
    tile->grid = *grid;
    for (int a = 0; a < 3; ++a)
    {
      tile->origin[a] = query->origin[a];
    }
  }
  const bool some = mcor_query_next_row(grid, query);
  tile->begin = query->begin;
  tile->count = some ? query->end - query->begin : 0;
  return some || first;
}

/* This function is never called, because no tile is complete. */
void mcor_tile_narrow(const mcor_tile* wide, const mcor_query* query, mcor_tile* tile)
{
  mcor_tile_init(tile);
}

typedef struct
{
  mcor_tile tile;
} mcor_reach;

#define MCOR_REACH_COUNT(reach) ((reach)->tile.count)
#define MCOR_REACH(reach, name, i) MCOR_EACH(&(reach)->tile, name, i)
#define MCOR_REACH_TERM(reach, i, iso)                                                             \
  (MCOR_REACH(reach, weight, i) * MCOR_FIELD_TERM(MCOR_REACH(reach, value, i), iso))
#define MCOR_REACH_KEEP(reach, i, weight)

bool mcor_reach_next(const mcor_grid* grid, mcor_query* query, const mcor_points* points, real iso,
  mcor_reach* reach, bool first)
{
  return mcor_tile_next(grid, query, &reach->tile, first);
}

typedef struct
{
  __global const real* of[MCOR_ARRAY_STEP];
} mcor_values;

void mcor_values_load(const mcor_reach* reach, __global const real* const arrays[MCOR_ARRAY_STEP],
  mcor_values* values)
{
  for (int c = 0; c < MCOR_ARRAY_STEP; ++c)
  {
    values->of[c] = arrays[c];
  }
}

#define MCOR_VALUE_OF(values, reach, c, i) ((values)->of[c][MCOR_INDEX(&(reach)->tile, i)])

void mcor_attribute_sums(const mcor_grid* grid, mcor_query* query, const mcor_points* points,
  real iso, mcor_reach* reach, bool evaluated, int count, const int stride,
  __global const real* attributes, real sums[MCOR_ATTRIBUTE_LIMIT], real* weight_sum)
{
  const mcor_tile* tile = &reach->tile;
  real at[3], d[3], along[3], slope, w = 0;
  mcor_points_relative(grid, query, points, at);
  for (bool first = true; mcor_reach_next(grid, query, points, iso, reach, first); first = false)
  {
    for (int i = 0; i < tile->count; ++i)
    {
      mcor_points_from(
        at, points, MCOR_EACH(tile, x, i), MCOR_EACH(tile, y, i), MCOR_EACH(tile, z, i), d);
      const mcor_length length = mcor_length_of(d);
      const real weight = MCOR_EACH(tile, weight, i) *
        mcor_weight_gradient(d, &length, MCOR_EACH(tile, inv_h, i), &slope, along);
      w += weight;
      for (int c = 0; c < MCOR_ATTRIBUTE_LIMIT; ++c) /* constant limit: sums stay in registers */
      {
        if (c < count)
        {
          sums[c] = MCOR_FMA(weight, attributes[c * (long)stride + MCOR_INDEX(tile, i)], sums[c]);
        }
      }
    }
  }
  *weight_sum = w;
}
