/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The names that solvers give to the arrays that a run needs, and to the period. */

#include "mcor_finder.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Usual names, the most usual first, as small letters and digits alone. */
static const char* const mcor_usual_names[MCOR_QUANTITY_COUNT][MCOR_NAMES] = {
  [MCOR_SMOOTHING_LENGTH] = { "smoothinglength", "smoothinglengths", "hsml", "h" },
  [MCOR_VOLUME] = { "volume", "volumes", "particlevolume", "vol", "volumetricmeasure" },
  [MCOR_MASS] = { "mass", "masses", "particlemass", "m" },
  [MCOR_DENSITY] = { "density", "densities", "particledensity", "rho", "rhop" },
  [MCOR_VELOCITY] = { "velocity", "velocities", "vel", "v" },
  [MCOR_PARTICLE_ID] = { "idp", "particleid", "particleids", "partid", "id", "ids", "globalids",
    "globalid", "gid", "pid", "iorig", "originalid", "unsortedparticleid", "index" },
  [MCOR_PARTICLE_TYPE] = { "particletype", "type", "particletypes", "parttype", "ptype", "itype",
    "isboundary", "iswall", "issolid", "isfluid", "wallblock" },
  [MCOR_SPACING] = { "particlespacing", "spacing", "particledistance" },
  [MCOR_POSITION] = { "points", "point", "position", "positions", "pos", "coordinates",
    "coordinate", "coords", "coord", "xyz", "r" },
};

bool mcor_is_usual_name(const char* name, const char* usual)
{
  for (; name && *name; ++name)
  {
    if (*name != '_' && *name != '-' && *name != ' ' && mcor_small_letter(*name) != *usual++)
    {
      return false;
    }
  }
  return name && *usual == '\0';
}

int mcor_name_priority(mcor_quantity quantity, const char* name)
{
  for (int i = 0; name && (unsigned)quantity < MCOR_QUANTITY_COUNT && i < MCOR_NAMES; ++i)
  {
    const char* usual = mcor_usual_names[quantity][i];
    if (usual && mcor_is_usual_name(name, usual))
    {
      return i;
    }
  }
  return -1;
}

int mcor_tells_apart(const char* name)
{
  static const char* const ends[] = { "id", "ids", "idp", "type", "types", "index", "mk", "tag",
    "mol", "iorig" };
  char last[6] = { 0 }; /* the last five letters; digits and blanks do not count */
  for (; name && *name; ++name)
  {
    const char letter = mcor_small_letter(*name);
    if (letter >= 'a' && letter <= 'z')
    {
      memmove(last, last + 1, 4);
      last[4] = letter;
    }
  }
  bool tells = false;
  for (size_t e = 0; e < sizeof ends / sizeof ends[0]; ++e)
  {
    tells = tells || strcmp(last + 5 - strlen(ends[e]), ends[e]) == 0;
  }
  return tells;
}

int mcor_view_priority(const char* name, int components, int is_real, int varies)
{
  if (!name || !varies || mcor_name_priority(MCOR_PARTICLE_ID, name) >= 0 ||
    mcor_name_priority(MCOR_PARTICLE_TYPE, name) >= 0)
  {
    return -1;
  }
  const bool is_vector = components == 2 || components == 3;
  const bool describes = mcor_name_priority(MCOR_SMOOTHING_LENGTH, name) >= 0 ||
    mcor_name_priority(MCOR_VOLUME, name) >= 0 || mcor_name_priority(MCOR_MASS, name) >= 0 ||
    mcor_name_priority(MCOR_SPACING, name) >= 0;
  return !is_real                                               ? 5
    : is_vector && mcor_name_priority(MCOR_VELOCITY, name) >= 0 ? 0
    : is_vector                                                 ? 1
    : components == 1                                           ? 2 + describes
                                                                : 4;
}

/* Returns the index of the first array with this name and number of values; -1: none. */
static int mcor_find_values(
  const mcor_field_data* arrays, int count, const char* usual, int64_t values)
{
  for (int i = 0; i < count; ++i)
  {
    if (arrays[i].values && arrays[i].count == values && mcor_is_usual_name(arrays[i].name, usual))
    {
      return i;
    }
  }
  return -1;
}

/* The first four arrays may give a period, and are tried in this order. The last array tells which
 * axes of `box` are periodic. values: how many values an array has. */
static const struct
{
  const char* name;
  int values;
} mcor_period_arrays[] = { { "periodicbounds", 6 }, { "boxsize", 3 }, { "boxsize", 1 },
  { "box", 6 }, { "boundarytype", 3 } };

int mcor_find_period(const mcor_field_data* arrays, int count, double period[6], int* which)
{
  int unused;
  which = which ? which : &unused;
  /* SPH-EXA's types of the axes of `box`; 0: open, 1: periodic, 2: fixed */
  const int type = mcor_find_values(arrays, count, "boundarytype", 3);
  for (int u = 0; u < 4; ++u)
  {
    const int values = mcor_period_arrays[u].values,
              at = mcor_find_values(arrays, count, mcor_period_arrays[u].name, values);
    bool is_period = at >= 0, some = false; /* some: along at least one axis; others may be open */
    double bounds[6] = { 0 };
    for (int a = 0; a < 3 && is_period; ++a)
    {
      const double* of = arrays[at].values;
      const bool open = u == 3 && !(type >= 0 && arrays[type].values[a] == 1);
      bounds[2 * a] = values == 6 && !open ? of[2 * a] : 0;
      bounds[2 * a + 1] = open ? 0 : values == 6 ? of[2 * a + 1] : of[values == 1 ? 0 : a];
      const double length = bounds[2 * a + 1] - bounds[2 * a];
      is_period = isfinite(length) && length >= 0;
      some = some || length > 0;
    }
    if (is_period && some)
    {
      const double lengths[6] = { bounds[1], bounds[3], bounds[5] };
      memcpy(period, values == 6 ? bounds : lengths, sizeof bounds);
      *which = at;
      return values == 6 ? 6 : 3;
    }
  }
  *which = -1;
  memset(period, 0, 6 * sizeof *period);
  return 0;
}

void mcor_place_period(const double lengths[3], const double extent[6], double bounds[6])
{
  for (int a = 0; a < 3; ++a)
  {
    const double length = lengths[a], rounding = 1e-6 * length;
    const double begins[2] = { 0, -0.5 * length };
    double begin = extent[2 * a];
    for (int i = 1; i >= 0; --i)
    {
      const bool holds =
        extent[2 * a] >= begins[i] - rounding && extent[2 * a + 1] <= begins[i] + length + rounding;
      begin = holds ? begins[i] : begin;
    }
    bounds[2 * a] = length > 0 ? begin : 0;
    bounds[2 * a + 1] = bounds[2 * a] + length;
  }
}

int mcor_tells_of_period(const char* name)
{
  bool tells = false;
  for (size_t i = 0; i < sizeof mcor_period_arrays / sizeof mcor_period_arrays[0]; ++i)
  {
    tells = tells || mcor_is_usual_name(name, mcor_period_arrays[i].name);
  }
  return tells;
}
