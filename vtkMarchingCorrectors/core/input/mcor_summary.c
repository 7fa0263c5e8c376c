/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sentences for panels: how long a run may take, and which values it found and used. */

#include "mcor_input.h"

#include <math.h>
#include <stdlib.h>

/* From this number of cells in the fluid on, a run is called huge. */
#define MCOR_HUGE_CELLS 1e9

/* Returns the smoothing lengths, which count as 1 if they are to be estimated. */
static mcor_array mcor_lengths_of(const mcor_input* input)
{
  return input->estimate_smoothing_length ? (mcor_array){ .constant = 1 } : input->smoothing_length;
}

double mcor_least_smoothing_length(const mcor_input* input)
{
  const mcor_array lengths = mcor_lengths_of(input);
  const mcor_findings found =
    mcor_find_range(NULL, &lengths, input->solid, MCOR_SKIP_SOLIDS, input->count, 0);
  return found.least[0] <= found.most[0] ? found.least[0] : INFINITY;
}

double mcor_estimate_cells(const mcor_input* input, const mcor_options* options, double least)
{
  const bool is_known = !input->estimate_smoothing_length || options->cube_size <= 0.0;
  if (!isfinite(least) || !is_known)
  {
    return 0.0;
  }
  const bool is_plane = mcor_find_dimension(input, NULL, options->dimension) == 2;
  /* Sums h^3 (in a plane h^2) over the fluid in the box. h: a particle's smoothing length or
   * support radius, halved once for each level of the particle's cubes. */
  const bool has_box = mcor_has_box(options) != 0;
  const mcor_array positions = mcor_positions_of(input), lengths = mcor_lengths_of(input);
  const int levels = options->filled || options->capping ? 0 : options->level_limit;
  const bool are_alike = !lengths.data && !input->solid && !has_box;
  double cubes = 0.0;
  for (int64_t i = 0; i < (are_alike ? 1 : input->count); ++i)
  {
    bool counts = !input->solid || !input->solid[i];
    for (int a = 0; a < 3 && counts && has_box; ++a)
    {
      const double x = mcor_array_at(&positions, i, a), *side = options->box + 2 * a;
      /* a flat box holds particles in its plane */
      counts = x >= side[0] && (x < side[1] || x == side[0]);
    }
    double h = mcor_array_at(&lengths, i, 0);
    for (int level = 0; level < levels && h >= 2.0 * least; ++level)
    {
      h *= 0.5;
    }
    cubes += counts ? mcor_power(h, is_plane ? 2 : 3) : 0;
  }
  cubes *= are_alike ? (double)input->count : 1;
  const bool is_radius =
    input->smoothing_length_is_support_radius && !input->estimate_smoothing_length;
  const double per_length = is_radius ? 1.0 / mcor_support_factor(options->sph_kernel) : 1.0;
  const double size =
    options->cube_size > 0.0 ? options->cube_size : options->cube_size_factor * least * per_length;
  const double spacing = per_length / 1.3;
  const double area = cubes * spacing * spacing, per_area = size * size;
  return size <= 0.0 ? 0.0 : is_plane ? area / per_area : area * spacing / (per_area * size);
}

mcor_message mcor_describe_estimate(double cells)
{
  return cells >= MCOR_HUGE_CELLS ? mcor_say(MCOR_SAY(RUN_HUGE), cells) : MCOR_NO_MESSAGE;
}

char* mcor_describe_smoothing_length(const mcor_input* input, const mcor_statistics* statistics)
{
  const double low = statistics->smoothing_length_min, high = statistics->smoothing_length_max;
  const mcor_array* array = &input->smoothing_length;
  char* text = low < high ? mcor_text("%g to %g", low, high) : mcor_text("%g", low);
  return input->estimate_smoothing_length
    ? mcor_append(text, " (estimated)")
    : mcor_append(text, " (%s%s%s)", array->data ? "array " : "given",
        array->data && array->name ? array->name : "",
        input->smoothing_length_is_support_radius ? ", support radius" : "");
}

static char* mcor_describe_array(const mcor_array* array)
{
  return array->data ? mcor_text("array %s", array->name ? array->name : "")
                     : mcor_text("%g", array->constant);
}

char* mcor_describe_volume(const mcor_input* input)
{
  if (mcor_is_given(&input->volume))
  {
    return mcor_describe_array(&input->volume);
  }
  if (!mcor_is_given(&input->mass))
  {
    return mcor_text("computed from the positions");
  }
  char* text = mcor_describe_array(&input->mass);
  if (!mcor_is_given(&input->density))
  {
    return mcor_append(text, " / density summed from it");
  }
  char* density = mcor_describe_array(&input->density);
  text = mcor_append(text, " / %s", density ? density : "");
  free(density);
  return text;
}

char* mcor_describe_measures(const mcor_statistics* statistics)
{
  const double length = statistics->length, area = statistics->area;
  if (statistics->dimension == 2 && length > 0.0)
  {
    return area > 0.0
      ? mcor_text("two dimensions: length %g, area %g", length, area)
      : mcor_text("two dimensions: length %g; open, so that it has no area", length);
  }
  return area <= 0.0        ? mcor_text("%s", "")
    : statistics->is_closed ? mcor_text("area %g, volume %g", area, statistics->volume)
                            : mcor_text("area %g; open, so that it has no volume", area);
}
