/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Warnings of inputs that are legal, but hardly ever meant: one sentence each, with figures. */

#include "mcor_input.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* With fewer particles no number of neighbours is unusual. */
#define MCOR_FEW_PARTICLES 100

typedef struct mcor_suspicion
{
  const mcor_input* input;
  const mcor_options* options;
  const mcor_surface* surface;
} mcor_suspicion;

/* Bounds of the ratio smoothing length / distance of the nearest particle. Free surfaces and walls
 * hardly change the ratio. The ratio is up to 1.7 for most solvers, and up to 2.2 for DualSPHysics.
 * Wendland kernels allow more. */
#define MCOR_LEAST_RATIO 0.9
#define MCOR_MOST_RATIO 2.2
#define MCOR_MOST_RATIO_WENDLAND 2.6
#define MCOR_LEAST_RATIO_QUINTIC 0.7

/* A nearest particle may be very near by chance. So smoothing lengths are called too long only if
 * there are also many neighbours in all: more than is usual for the kernel, and more than this
 * number times (support / smoothing length)^3. If the ratio is above MCOR_SHEET_RATIO, this number
 * is MCOR_SHEET_NEIGHBOURS, because sheets and drops have few neighbours. */
#define MCOR_MANY_NEIGHBOURS 10.0
#define MCOR_SHEET_RATIO 2.6
#define MCOR_SHEET_NEIGHBOURS 5.0
/* In two dimensions, these numbers replace MCOR_MANY_NEIGHBOURS and MCOR_SHEET_NEIGHBOURS, and are
 * multiplied by (support / smoothing length)^2. */
#define MCOR_MANY_IN_PLANE 5.6
#define MCOR_ROW_NEIGHBOURS 3.5

static bool mcor_is_wendland(mcor_sph_kernel kernel)
{
  return kernel == MCOR_WENDLAND_C2 || kernel == MCOR_WENDLAND_C4 || kernel == MCOR_WENDLAND_C6;
}

/* Volumes that fill the supports this many times over are not in the unit of the positions. */
#define MCOR_MOST_FILLED 10.0

static mcor_message mcor_warn_neighbours(const mcor_suspicion* s)
{
  const mcor_statistics* n = &s->surface->statistics;
  const mcor_sph_kernel kernel = s->options->sph_kernel;
  const bool plane = n->dimension == 2;
  const double h = n->smoothing_length_median, spacing = n->spacing_median;
  const double cube = pow(mcor_support_factor(kernel), plane ? 2 : 3);
  const bool wendland = mcor_is_wendland(kernel);
  const bool few = h < MCOR_LEAST_RATIO * spacing || spacing == 0;
  const double near = h / (spacing > 0 ? spacing : h), found = n->neighbours_median / cube;
  const char* usual = mcor_kernel_of(kernel)->neighbours[plane];
  const bool many = n->neighbours_median > atof(strrchr(usual, ' ')) &&
    (near > MCOR_SHEET_RATIO
        ? found > (plane ? MCOR_ROW_NEIGHBOURS : MCOR_SHEET_NEIGHBOURS)
        : near > (wendland ? MCOR_MOST_RATIO_WENDLAND : MCOR_MOST_RATIO) &&
          found > (plane ? MCOR_MANY_IN_PLANE : MCOR_MANY_NEIGHBOURS));
  const bool unusual = !s->input->estimate_smoothing_length && (few || many);
  if (n->fluid_particles < MCOR_FEW_PARTICLES || !(unusual || n->filled_median > MCOR_MOST_FILLED))
  {
    return MCOR_NO_MESSAGE;
  }
  if (!unusual)
  {
    return mcor_say(MCOR_SAY(VOLUMES_TOO_LARGE), n->filled_median);
  }
  if (n->fluid_extent[0] == 0 && n->fluid_extent[1] == 0 && n->fluid_extent[2] == 0)
  {
    return mcor_say(MCOR_SAY(ALL_AT_ONE_POINT), (long long)n->fluid_particles);
  }
  const bool is_radius = s->input->smoothing_length_is_support_radius;
  const char* why = few && is_radius ? "Perhaps the array holds the smoothing length, not the "
                                       "support radius, or is not in the unit of the positions."
    : few || is_radius ? "Perhaps the smoothing length is not in the unit of the positions; "
                         "{estimate_smoothing_length} and {volume computed} take both from these."
                       : "Perhaps the array holds the support radius (then use "
                         "{smoothing_length_is_support_radius}), or is not in the unit of the "
                         "positions.";
  /* The kernel for which this ratio of smoothing length to spacing would be usual. With few
   * neighbours, this is the quintic spline, which reaches farther; with many, a Wendland kernel. */
  const char* likely = spacing == 0 ? ""
    : few && kernel != MCOR_QUINTIC_SPLINE && near >= MCOR_LEAST_RATIO_QUINTIC ? "quintic"
    : !few && !wendland && near <= MCOR_MOST_RATIO_WENDLAND                    ? "wendland"
                                                                               : "";
  char times[100] = "no other particle is within that";
  if (spacing > 0)
  {
    snprintf(times, sizeof times, "%.3g times the distance %.4g of the nearest particle",
      h / spacing, spacing);
  }
  return mcor_say(MCOR_SAY(NEIGHBOURS_UNUSUAL), n->neighbours_median,
    n->neighbours_median < 1.5 ? "neighbour" : "neighbours", h, times,
    mcor_sph_kernel_name(kernel), usual, wendland ? 2.2 : 1.7,
    why, *likely ? " Or the kernel is " : "", likely, *likely ? "." : "");
}

/* A warning comes if nearest particles are closer than this many steps of single precision. */
#define MCOR_COARSE_STEPS 8

/* Returns the step between neighbouring numbers of single precision at `largest`. */
static double mcor_single_step(double largest)
{
  return largest > 0 && isfinite(largest) ? ldexp(1, ilogb(largest) - 23) : 0;
}

/* Whether all of the fluid's coordinates are numbers of single precision, and the step from the
 * largest coordinate to the next such number is long for the particles' spacing. *axis, *step: the
 * axis of the largest coordinate, and this step. */
static bool mcor_is_coarse(const mcor_suspicion* s, int* axis, double* step)
{
  const mcor_statistics* n = &s->surface->statistics;
  const mcor_input* input = s->input;
  mcor_array coordinates = mcor_positions_of(input);
  const bool known = n->spacing_median > 0 && n->fluid_particles >= MCOR_FEW_PARTICLES;
  const int64_t count = known && input->positions.data ? input->count : 0;
  double largest = 0;
  *axis = 0;
  for (int a = 0; a < 3; ++a)
  {
    const mcor_findings found =
      mcor_find_range(NULL, &coordinates, input->solid, MCOR_SKIP_SOLIDS, count, a);
    const double along = mcor_largest_of(found.least[0], found.most[0]);
    *axis = along > largest ? a : *axis;
    largest = fmax(along, largest);
  }
  coordinates.components = 1;
  *step = mcor_single_step(largest);
  bool coarse = *step * MCOR_COARSE_STEPS > n->spacing_median;
  for (int64_t i = 0; i < 3 * count && coarse; ++i)
  {
    const double x = mcor_array_at(&coordinates, i, 0);
    coarse = (input->solid && input->solid[i / 3]) || (double)(float)x == x;
  }
  return coarse;
}

static mcor_message mcor_warn_coarse(const mcor_suspicion* s)
{
  int axis;
  double step;
  return mcor_is_coarse(s, &axis, &step)
    ? mcor_say(
        MCOR_SAY(POSITIONS_COARSE), "xyz"[axis], step, s->surface->statistics.spacing_median)
    : MCOR_NO_MESSAGE;
}

/* Warns if the fluid's extent is longer than a period by more than this many smoothing lengths. */
#define MCOR_BEYOND_PERIOD 1

static mcor_message mcor_warn_period(const mcor_suspicion* s)
{
  const mcor_statistics* n = &s->surface->statistics;
  for (int a = 0; a < 3; ++a)
  {
    const double* p = s->options->periodic + 2 * a;
    if (p[1] > p[0] &&
      n->fluid_extent[a] > p[1] - p[0] + MCOR_BEYOND_PERIOD * n->smoothing_length_median)
    {
      return mcor_say(MCOR_SAY(PERIOD_EXCEEDED), n->fluid_extent[a], "xyz"[a], p[1] - p[0]);
    }
  }
  return MCOR_NO_MESSAGE;
}

/* Warns if particles in three dimensions lie in a plane, unless rounding made the plane. */
static mcor_message mcor_warn_plane(const mcor_suspicion* s)
{
  const mcor_statistics* n = &s->surface->statistics;
  const double h = n->smoothing_length_median, *e = n->fluid_extent;
  double normal[3], step;
  int flat = -1, axis;
  bool tilted = false;
  for (int a = 2; a >= 0; --a)
  {
    const double other = fmin(e[(a + 1) % 3], e[(a + 2) % 3]);
    flat = n->dimension != 2 && e[a] < 0.1 * h && other > 8 * h ? a : flat;
    normal[a] = floor(n->plane_normal[a] * 1e4 + 0.5) / 1e4;
    tilted = tilted || (normal[a] != 0 && s->options->dimension == 0);
  }
  if (n->fluid_particles < MCOR_FEW_PARTICLES || !(flat >= 0 || tilted) ||
    mcor_is_coarse(s, &axis, &step))
  {
    return MCOR_NO_MESSAGE;
  }
  return flat >= 0
    ? mcor_say(MCOR_SAY(PLANE_IN_SPACE), "xyz"[flat], e[flat], e[flat] / h, "xyz"[flat])
    : mcor_say(MCOR_SAY(PLANE_TILTED), normal[0], normal[1], normal[2], n->plane_extent,
        n->plane_extent / h);
}

/* Warns of iso values beyond the field's bounds. A Shepard mean with a positive kernel lies between
 * the particles' values. A sum may also be 0. Other means and sums may lie somewhat beyond the
 * bounds, so for these fields the warning comes only if the surface is empty. */
static mcor_message mcor_warn_iso_value(const mcor_suspicion* s)
{
  const mcor_statistics* n = &s->surface->statistics;
  const mcor_options* o = s->options;
  const bool empty = n->triangles_before_trimming == 0;
  const bool strict = o->field == MCOR_SHEPARD && o->sph_kernel != MCOR_M_PRIME_4;
  const double low = o->field == MCOR_SUM && n->scalar_min > 0 ? 0 : n->scalar_min;
  const double high = o->field == MCOR_SUM && n->scalar_max < 0 ? 0 : n->scalar_max;
  int outside = 0, first = 0;
  for (int i = 0; i < o->iso_count; ++i)
  {
    /* a filled region may begin below all values */
    const bool is_outside = (o->iso_values[i] < low && !o->filled) || o->iso_values[i] > high;
    first = is_outside && outside == 0 ? i : first;
    outside += is_outside;
  }
  if (o->field == MCOR_WEIGHT_SUM || mcor_has_box(o) || outside == 0 || !(empty || strict))
  {
    return MCOR_NO_MESSAGE;
  }
  const char* name = s->input->scalar.name ? s->input->scalar.name : "the scalar";
  char others[40] = "";
  if (outside > 1)
  {
    snprintf(others, sizeof others, " (and %d more)", outside - 1);
  }
  return mcor_say(MCOR_SAY(ISO_OUTSIDE), o->iso_values[first], others, name, low, high);
}

/* Warns of a node threshold that may discard all cells. Where particles fill a small share of
 * space, each cell has a node of weight below the threshold. */
static mcor_message mcor_warn_discarded(const mcor_suspicion* s)
{
  const mcor_statistics* n = &s->surface->statistics;
  const mcor_options* o = s->options;
  if (o->field == MCOR_WEIGHT_SUM || mcor_has_box(o))
  {
    return MCOR_NO_MESSAGE;
  }
  if (n->filled_median > 0 && n->filled_median <= o->node_threshold)
  {
    return mcor_say(MCOR_SAY(NODES_DISCARD_ALL), o->node_threshold, n->filled_median);
  }
  const double* extent = n->fluid_extent; /* 0: all particles are at one point */
  bool is_between = false;
  for (int i = 0; i < o->iso_count; ++i)
  {
    is_between =
      is_between || (n->scalar_min < o->iso_values[i] && o->iso_values[i] < n->scalar_max);
  }
  return is_between && extent[0] + extent[1] + extent[2] > 0 && o->node_threshold > 0
    ? mcor_say(MCOR_SAY(ISO_NOT_REACHED), o->node_threshold)
    : MCOR_NO_MESSAGE;
}

/* If the surface is empty, says which threshold may have removed all of it. */
static mcor_message mcor_warn_trimmed(const mcor_suspicion* s)
{
  const mcor_statistics* n = &s->surface->statistics;
  const mcor_options* o = s->options;
  const bool eigenvalue = o->boundary_detection == MCOR_BOUNDARY_EIGENVALUE;
  const bool plane = n->dimension == 2;
  const bool wall = n->wall_share > 0 && n->solid_particles > 0 && !s->input->ignore_solids;
  char share[100] = "";
  if (n->triangles_before_trimming == 0 && o->iso_count > 0)
  {
    return mcor_warn_discarded(s);
  }
  if (s->surface->triangle_count > 0 || s->surface->line_count > 0 ||
    n->triangles_before_trimming == 0 || mcor_has_box(o))
  {
    return MCOR_NO_MESSAGE;
  }
  const long long count = (long long)n->triangles_before_trimming;
  const char *things = plane ? "lines" : "triangles", *where = plane ? "them" : "the surface";
  if (o->field == MCOR_WEIGHT_SUM)
  {
    return mcor_say(MCOR_SAY(ALL_TRIMMED_BY_WALLS), count, things, where, n->wall_share);
  }
  if (wall)
  {
    snprintf(
      share, sizeof share, ", or the solids' share is above the wall share %g", n->wall_share);
  }
  return mcor_say(MCOR_SAY(ALL_TRIMMED), count, things, where,
    eigenvalue ? "boundary eigenvalue" : "weight sum", o->vertex_threshold, share,
    eigenvalue ? "Try {vertex_threshold 0.3}."
               : "In the fluid, weights are about 1 if volumes, masses and densities are right. If "
                 "the fluid ends in a vacuum, as gas and planets do, use {field sum}, "
                 "{node_threshold 0} and {vertex_threshold 0}.");
}

/* Errors of positions below this share of the smallest smoothing length need no warning, because
 * nobody sees them. If they move the field by more than its tolerance, another warning says so. */
#define MCOR_MOST_POSITION_ERROR 1e-4

/* Errors of positions below this share of the cube size need no warning either, because even a grid
 * of few cubes has such errors. */
#define MCOR_LONG_GRID_ERROR 1e-6

static mcor_message mcor_warn_precision(const mcor_suspicion* s)
{
  const mcor_statistics* n = &s->surface->statistics;
  const double share = n->position_error / n->smoothing_length_min;
  if (s->options->precision != MCOR_FLOAT32 || n->smoothing_length_min == 0 ||
    share <= MCOR_MOST_POSITION_ERROR || n->position_error < MCOR_LONG_GRID_ERROR * n->cube_size)
  {
    return MCOR_NO_MESSAGE;
  }
  return mcor_say(MCOR_SAY(GRID_TOO_LONG_FOR_SINGLE), n->cube_size, n->position_error, share);
}

/* Bounds the rounding error of the field in single precision, as a share of the scalar's range. */
#define MCOR_ROUNDED 1e-5

/* Warns of vertices that the correction could not bring to the iso value (a preview does not try).
 * If all their errors may be rounding, warns only if the tolerance is at most 5 % of
 * MCOR_ROUNDED. */
static mcor_message mcor_warn_tolerance(const mcor_suspicion* s)
{
  const mcor_statistics* n = &s->surface->statistics;
  const mcor_options* o = s->options;
  const double range = n->scalar_max - n->scalar_min;
  const bool is_rounding = o->precision == MCOR_FLOAT32 && o->tolerance > 0.05 * MCOR_ROUNDED &&
    n->residual_max <= MCOR_ROUNDED * range;
  if (o->preview || n->vertices_above_tolerance == 0 || is_rounding)
  {
    return MCOR_NO_MESSAGE;
  }
  return mcor_say(MCOR_SAY(OFF_ISO_VALUE), (long long)n->vertices_above_tolerance,
    (long long)n->correction_count, o->tolerance * range, n->residual_max, range,
    n->iterations_max >= o->iteration_limit ? "a higher {iteration_limit}"
      : o->precision == MCOR_FLOAT32        ? "{precision double}"
                                            : "a larger {tolerance}");
}

static mcor_message mcor_warn_far(const mcor_suspicion* s)
{
  const mcor_statistics* n = &s->surface->statistics;
  const long long first = (long long)n->far_first;
  const double* x = n->far_place;
  return n->far_particles == 0 ? MCOR_NO_MESSAGE
    : n->far_particles == 1
    ? mcor_say(MCOR_SAY(PARTICLE_FAR), first, x[0], x[1], x[2])
    : mcor_say(MCOR_SAY(PARTICLES_FAR), (long long)n->far_particles, first, x[0], x[1], x[2]);
}

/* Returns whether another warning already names the cause of `warning`. */
static bool mcor_is_explained(mcor_warning warning, const mcor_suspicion* s)
{
  const bool follows = warning == MCOR_WARN_TRIMMED || warning == MCOR_WARN_PRECISION ||
    warning == MCOR_WARN_TOLERANCE || warning == MCOR_WARN_FAR;
  mcor_message cause = follows ? mcor_warn_neighbours(s) : MCOR_NO_MESSAGE;
  cause = warning == MCOR_WARN_TOLERANCE && !cause.text ? mcor_warn_precision(s) : cause;
  const bool is_explained = cause.text != NULL;
  mcor_free_message(&cause);
  return is_explained;
}

mcor_message mcor_describe_warning(mcor_warning warning, const mcor_input* input,
  const mcor_options* options, const mcor_surface* surface)
{
  mcor_message (*const checks[MCOR_WARNING_COUNT])(const mcor_suspicion*) = { mcor_warn_neighbours,
    mcor_warn_plane, mcor_warn_iso_value, mcor_warn_trimmed, mcor_warn_precision,
    mcor_warn_tolerance, mcor_warn_far, mcor_warn_period, mcor_warn_coarse };
  /* With globals, the input is only a part of the particles. */
  if ((unsigned)warning >= MCOR_WARNING_COUNT || !input || !options || !surface ||
    input->count == 0 || options->globals)
  {
    return MCOR_NO_MESSAGE;
  }
  const mcor_suspicion suspicion = { input, options, surface };
  return mcor_is_explained(warning, &suspicion) ? MCOR_NO_MESSAGE : checks[warning](&suspicion);
}

/* A warning comes if the step of single precision at the largest coordinate is more than this share
 * of the cube size. The share is small, because some triangles are far smaller than cubes. */
#define MCOR_MOST_STEP 0.01

mcor_message mcor_describe_single_points(double largest, double cube_size)
{
  const double step = mcor_single_step(largest);
  return step > MCOR_MOST_STEP * cube_size
    ? mcor_say(MCOR_SAY(POINTS_SINGLE), largest, step, cube_size)
    : MCOR_NO_MESSAGE;
}
