/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Boxes. A call with a box owns the cells in it, and makes their part of the surface with the same
 * bits as in the whole surface.
 *
 * Lattice, ranges, shifts and levels are global: they are measured over all particles. The device
 * has only the particles that reach a place where the field is evaluated. A ring of cells around
 * the owned cells is examined, too, because the owned cells' pinched edges (edges with two
 * vertices), the border that the node threshold leaves, and normals from triangles depend on the
 * ring. Its triangles are removed from the surface at the very end, see mcor_triangle_cell.c.
 *
 * Beyond the ring's nodes, sums lack particles and mean nothing. Bounds of the field in a cube that
 * extends beyond the ring hold only at the ring's nodes. Cubes and bricks beyond the ring are made
 * void, so that they are not examined.
 *
 * A probe whose search grid is not kept owns the cells around its points. */

#include "mcor_box.h"
#include "mcor_adaptive.h"
#include "mcor_compact.h"
#include "mcor_tree.h"

#include <math.h>
#include <stdlib.h>

bool mcor_has_sides(const double sides[6])
{
  bool has = false;
  for (int i = 0; i < 6; ++i)
  {
    has = has || sides[i] != 0;
  }
  return has;
}

int mcor_has_box(const mcor_options* options)
{
  return mcor_has_sides(options->box);
}

void mcor_move_period(mcor_options* options)
{
  const double* box = options->ranks ? options->ranks->whole_box : options->box;
  for (int a = 0; a < 3 && mcor_has_sides(box); ++a)
  {
    double* period = options->periodic + 2 * a;
    const double length = period[1] - period[0], side = box[2 * a + 1] - box[2 * a];
    const bool is_beyond = box[2 * a] < period[0] || box[2 * a + 1] > period[1];
    if (length > 0 && side <= length && is_beyond)
    {
      period[0] = box[2 * a] - (length - side) / 2;
      period[1] = period[0] + length;
    }
  }
}

/* The field is evaluated up to this distance, in cubes, from the outermost nodes of the ring of
 * cells around the owned cells, because trimming may move a vertex by 3/4 of a cube. */
#define MCOR_BOX_MARGIN 1.25

/* A box does not need a particle whose support misses the box by more than this, in cubes. */
#define MCOR_GLOBALS_MARGIN(ring) ((ring) + 2)

/* With adaptive cubes, a box does not need a particle whose support misses the box by more than
 * this, in cells of the particle's level. The particle does not reach larger cells. Cells in the
 * ring, and cells whose centres are in the box, have nodes at most two cells away from the box.
 * Trimming may move a vertex 3/4 of a cell further, into a cell half as large. So the vertex lies
 * at most 5.5 of these smaller cells away from the box. For a wider ring see mcor_level_ring. */
#define MCOR_LEVEL_MARGIN(ring) ((ring) == MCOR_BOX_RING ? 6 : 4 * (ring) + 4)

/* For a probe, the field is evaluated up to this distance, in cubes, from the cells around the
 * points. Rounding moves particles by less. */
#define MCOR_POINTS_MARGIN 0.25

/* Greatest distance between the particles of a pair, in smoothing lengths, rounded up. */
#define MCOR_PAIR_REACH 1.001

int mcor_ring_of(const mcor_options* options)
{
  return options->compact ? MCOR_COMPACT_RING : MCOR_BOX_RING;
}

double mcor_box_slack(const mcor_options* options)
{
  return MCOR_LEVEL_MARGIN(mcor_ring_of(options)) + 0.5;
}

/* ---- Cells ---- */

void mcor_place_sides(const mcor_lattice* lattice, int axis, const double* sides, double side[2])
{
  const bool periodic = lattice->period[axis] > 0;
  const double first = periodic ? lattice->period_first[axis] : (double)lattice->first[axis];
  const double last = periodic ? first + lattice->period[axis] : (double)lattice->last[axis];
  side[0] = first;
  side[1] = last;
  for (int s = 0; s < 2 && sides; ++s)
  {
    const double at = ceil(sides[2 * axis + s] / lattice->edge[axis] - 0.5);
    side[s] = fmin(fmax(at - (double)lattice->origin[axis], first), last);
  }
}

/* A side further out than any cell, in halves of a cube. */
#define MCOR_NO_SIDE (1 << 30)

/* Writes the two sides of the box along an axis, `low` and `high`, in halves of a cube. In this
 * unit, the centres of cells of all levels are whole numbers. With several levels, large cells
 * stick out of the lattice, so a side of the box that is also a side of the lattice is put beyond
 * all cells or, with a period, at the period's end. If `sides` is NULL, both are put there. */
static void mcor_place_halves(
  const mcor_lattice* lattice, int axis, const double* sides, int low, int high, int halves[6])
{
  if (!mcor_is_adaptive(lattice))
  {
    halves[axis] = 2 * low;
    halves[3 + axis] = 2 * high;
    return;
  }
  double ends[2];
  mcor_place_sides(lattice, axis, NULL, ends);
  for (int s = 0; s < 2; ++s)
  {
    const int side = s == 0 ? low : high, end = (int)ends[s];
    const double at = sides ? ceil(2 * (sides[2 * axis + s] / lattice->edge[axis])) : 0;
    const double half = at - 2 * (double)lattice->origin[axis];
    const int open = lattice->period[axis] > 0 ? 2 * end : s == 0 ? -MCOR_NO_SIDE : MCOR_NO_SIDE;
    halves[3 * s + axis] =
      !sides || side == end ? open : (int)fmin(fmax(half, -MCOR_NO_SIDE), MCOR_NO_SIDE);
  }
}

/* A cell is owned if its centre is in the box. Therefore rounding of a side that lies on the
 * lattice's nodes does not matter, and boxes that share a side share no cell. */
void mcor_place_box(mcor_context* context, const mcor_options* options)
{
  mcor_box* box = &context->box;
  const mcor_lattice* lattice = &context->lattice;
  box->is_part = box->is_empty = false;
  box->ring = mcor_has_box(options) ? mcor_ring_of(options) : MCOR_BOX_RING;
  const mcor_ranks* ranks = options->ranks;
  const double* sides = mcor_has_box(options) ? options->box : NULL;
  const double* whole = ranks && mcor_has_sides(ranks->whole_box) ? ranks->whole_box : NULL;
  for (int a = 0; a < 3; ++a)
  {
    const bool periodic = lattice->period[a] > 0;
    double ends[2], side[2], all[2];
    mcor_place_sides(lattice, a, NULL, ends);
    mcor_place_sides(lattice, a, sides, side);
    mcor_place_sides(lattice, a, whole, all);
    if (box->of_points)
    {
      /* Takes the cells around a probe's points. If points lie beyond the period, takes the whole
       * period, because such points are moved into the period. */
      const double *points = box->points + 2 * a, edge = lattice->edge[a];
      const double origin = (double)lattice->origin[a], rounding = 0.25 / (double)lattice->step[a];
      const double low = points[0] / edge - origin, high = points[1] / edge - origin;
      if (!periodic || (low >= ends[0] - rounding && high <= ends[1] + rounding))
      {
        side[0] = fmin(fmax(floor(low), ends[0]), ends[1]);
        side[1] = fmin(fmax(floor(high) + 1, ends[0]), ends[1]);
      }
    }
    box->first[a] = (int)side[0];
    box->last[a] = (int)side[1];
    mcor_place_halves(lattice, a, sides, box->first[a], box->last[a], box->halves);
    box->whole_first[a] = (int)all[0];
    box->whole_last[a] = (int)all[1];
    mcor_place_halves(
      lattice, a, whole, box->whole_first[a], box->whole_last[a], box->whole_halves);
    box->is_part = box->is_part || periodic || side[0] > ends[0] || side[1] < ends[1];
    box->is_empty = box->is_empty || side[0] >= side[1];
  }
}

/* Writes to `clipped` those of the cells that are in the box or in the ring around the box. The
 * ring is `ring` cells wide; with adaptive cubes, mcor_level_ring(ring) cells of each level. */
static mcor_status mcor_clip(
  mcor_context* context, int ring, const mcor_buffer* cells, mcor_buffer* clipped)
{
  const bool adaptive = mcor_is_adaptive(&context->lattice);
  const int count = context->bricks.now.count;
  int s[6];
  for (int a = 0; a < 3; ++a)
  {
    s[a] = context->box.halves[a] - (adaptive ? 0 : 2 * ring);
    s[3 + a] = context->box.halves[3 + a] + (adaptive ? 0 : 2 * ring);
  }
  MCOR_TRY(mcor_reserve(context, clipped, (size_t)count * sizeof(cl_ulong)));
  return MCOR_LAUNCH(context, "mcor_box_clip", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(&context->bricks.now.bricks), MCOR_SIDES_ARGS(s),
    MCOR_INT(adaptive ? mcor_level_ring(ring) : 0), MCOR_BUFFER(cells), MCOR_BUFFER(clipped));
}

mcor_status mcor_clip_near(mcor_context* context, mcor_buffer* cells)
{
  return context->box.is_part ? mcor_clip(context, context->box.ring, cells, cells) : MCOR_OK;
}

mcor_status mcor_find_owned(
  mcor_context* context, const mcor_buffer* cells, const mcor_buffer** owned)
{
  mcor_buffer* clipped = &context->box.clipped;
  *owned = context->box.is_part ? clipped : cells;
  return context->box.is_part ? mcor_clip(context, 0, cells, clipped) : MCOR_OK;
}

mcor_status mcor_count_cells(
  mcor_context* context, const mcor_buffer* cells, const mcor_buffer* within, int* count)
{
  const mcor_buffer* owned;
  MCOR_TRY(mcor_find_owned(context, cells, &owned));
  return mcor_count_bits(context, owned, within, context->bricks.now.count, count);
}

/* ---- Particles ---- */

bool mcor_bound_particles(const mcor_context* context, int first[3], int last[3])
{
  const mcor_box* box = &context->box;
  const mcor_lattice* lattice = &context->lattice;
  for (int a = 0; a < 3; ++a)
  {
    first[a] = box->first[a] - (box->of_points ? 1 : 0);
    last[a] = box->last[a] + (box->of_points ? 1 : 0);
    if (lattice->period[a] > 0)
    {
      const int from = lattice->period_first[a], to = from + lattice->period[a];
      const int end = box->of_points && box->first[a] > from ? to + 1 : to;
      first[a] = first[a] > from ? first[a] : from;
      last[a] = last[a] < end ? last[a] : end;
    }
  }
  return box->is_part;
}

int mcor_list_images(
  const mcor_reach_box* box, const double at[3], double support, mcor_images* images)
{
  const double reach = support > box->radius ? support : box->radius;
  int count = !box->is_empty;
  for (int a = 0; a < 3 && count > 0; ++a)
  {
    const double low = box->low[a] - reach - at[a], high = box->high[a] + reach - at[a];
    const double period = box->period[a];
    /* The bounds are finite here, unless another thread changes the particles' arrays. */
    const bool wraps = period > 0 && isfinite(low) && isfinite(high);
    const bool is_near = wraps || (period <= 0 && low <= 0 && high >= 0);
    images->first[a] = wraps ? (int)ceil(low / period) : 0; /* else 0 is the only image */
    images->last[a] = wraps ? (int)floor(high / period) : 0;
    const int along = is_near ? images->last[a] - images->first[a] + 1 : 0;
    count *= along > 0 ? along : 0;
  }
  return count;
}

double mcor_reach_of(const mcor_reach_box* box, double length, int level)
{
  const double support = length * box->support;
  return box->top > 0 ? support + ldexp(MCOR_LEVEL_MARGIN(box->ring), level) : support;
}

double mcor_reach_margin(
  const mcor_options* options, const mcor_globals* globals, double smoothing_length)
{
  const double h_min = globals->measured.h_min, h_max = globals->measured.h_max;
  const int limit = options->level_limit, ring = mcor_ring_of(options);
  const bool adaptive = mcor_tree_level_of(h_max, h_min, limit) > 0;
  return globals->measured.cube *
    (adaptive ? ldexp(MCOR_LEVEL_MARGIN(ring), mcor_tree_level_of(smoothing_length, h_min, limit))
              : MCOR_GLOBALS_MARGIN(ring));
}

double mcor_reach_around(
  const mcor_options* options, int computes_volumes, double widest, double reach, double margin)
{
  /* A volume depends on all particles within the particle's own, unscaled support. */
  const double volumes = computes_volumes ? reach * (1 + 1 / options->h_scale) + margin : 0;
  /* The particle nearest to a vertex may not reach the box, but it is nearer to the vertex than the
   * particles that reach the box. One particle of a pair may not reach the box either, but it is
   * within a smoothing length of the other particle. */
  const bool others = options->outputs & MCOR_OUT_NEAREST_PARTICLE || mcor_wants_pairs(options);
  const double nearest = others ? reach + margin : 0;
  /* A widening factor depends on sums with widened supports, at the particle and at the particles
   * around it. */
  const double factors = widest > 0 ? fmax(volumes, reach) * (1 + widest) + margin : 0;
  return reach > 0 ? fmax(fmax(volumes, nearest), factors) : 0;
}

double mcor_wrap(const mcor_reach_box* box, int axis, double fixed)
{
  const double period = ldexp(box->period[axis], box->fix_bits);
  const double first = ldexp(box->first[axis], box->fix_bits);
  const double rounded = floor(fixed + 0.5);
  return period > 0 ? rounded - floor((rounded - first) / period) * period : fixed;
}

/* Finds the box in which the field is evaluated, in cubes from the lattice's origin. If the call
 * owns all cells, and there is no period, the box is from -1e30 to 1e30, which single precision can
 * hold. */
void mcor_find_evaluated(const mcor_context* context, double low[3], double high[3])
{
  const mcor_box* box = &context->box;
  const double margin = box->of_points ? MCOR_POINTS_MARGIN : box->ring + MCOR_BOX_MARGIN;
  for (int a = 0; a < 3; ++a)
  {
    const double edge = mcor_edge_of(&context->lattice, a);
    low[a] = box->is_part ? (box->first[a] - margin) * edge : -1e30;
    high[a] = box->is_part ? (box->last[a] + margin) * edge : 1e30;
  }
}

bool mcor_find_reach(const mcor_context* context, mcor_reach_box* reach)
{
  const mcor_box* box = &context->box;
  const mcor_lattice* lattice = &context->lattice;
  const mcor_options* options = context->run.options;
  const double support = mcor_support_factor(options->sph_kernel) * options->h_scale;
  const bool pairs = mcor_uses_pairs(context) && !box->of_points;
  if (!box->is_part)
  {
    return false;
  }
  *reach =
    (mcor_reach_box){ .support = (pairs ? fmax(support, MCOR_PAIR_REACH) : support) / lattice->cube,
      .fix_bits = lattice->fix_bits,
      .unit = ldexp(1, -lattice->fix_bits),
      .top = lattice->levels - 1,
      .ring = box->ring,
      .is_empty = box->is_empty };
  mcor_find_evaluated(context, reach->low, reach->high);
  for (int a = 0; a < 3; ++a)
  {
    const double edge = mcor_edge_of(lattice, a);
    reach->period[a] = lattice->period[a] * edge;
    reach->first[a] = lattice->period_first[a] * edge;
  }
  return true;
}

/* Frees the flags that tell which of the surface's triangles this call owns. */
void mcor_end_box(mcor_context* context)
{
  free(context->box.kept);
  context->box.kept = NULL;
}
