/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds which particles are fluid: by the array that the caller names, else by an array whose name
 * and values leave no doubt. Also finds which particles are left out altogether. */

#include "mcor_finder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Words that stand in the names of blocks and bodies with walls. SPlisHSPlasH calls rigid bodies
 * rb_particle_data. */
static const char* const mcor_wall_words[] = { "wall", "bound", "solid", "obstacle", "rigid",
  "rb_particle", "container", "tank" };

int mcor_tells_of_walls(const char* name)
{
  int tells = 0;
  for (size_t w = 0; name && w < sizeof mcor_wall_words / sizeof *mcor_wall_words; ++w)
  {
    tells = tells || mcor_contains(name, mcor_wall_words[w]);
  }
  return tells;
}

/* A value, and how often it occurs. */
typedef struct mcor_kind
{
  double value;
  int64_t count;
} mcor_kind;

/* Room for one value more than allowed: a full list tells that there are too many values. */
#define MCOR_KINDS (MCOR_PARTICLE_TYPES + 1)

/* Whether a is below b. NaN counts as above all numbers. */
static bool mcor_is_below(double a, double b)
{
  return a < b || (isnan(b) && !isnan(a));
}

/* Adds a value and its count to a list in ascending order. Returns the length of the list;
 * MCOR_KINDS: there are too many values. */
static int mcor_add_kind(mcor_kind* kinds, int count, mcor_kind kind)
{
  int at = 0;
  while (at < count && mcor_is_below(kinds[at].value, kind.value))
  {
    ++at;
  }
  if (at < count && !mcor_is_below(kind.value, kinds[at].value))
  {
    kinds[at].count += kind.count;
    return count;
  }
  memmove(kinds + at + 1, kinds + at, (size_t)(count - at) * sizeof *kinds);
  kinds[at] = kind;
  return count + 1;
}

/* Counts how often each value of an array occurs on all ranks. Returns how many values there are;
 * 0: too many, or a rank has failed. */
static int mcor_count_kinds(const mcor_finder* f, const mcor_named* array, mcor_kind* kinds)
{
  mcor_kind own[MCOR_KINDS];
  int own_count = 0, count = 0;
  for (int64_t i = 0; i < array->tuples && own_count < MCOR_KINDS; ++i)
  {
    const double value = mcor_element_at(array, i, 0);
    own_count = mcor_add_kind(own, own_count, (mcor_kind){ isnan(value) ? NAN : value, 1 });
  }
  const void* all = own;
  int64_t all_count = own_count;
  if (f->ranks &&
    f->ranks->gather(f->ranks->user, own, own_count, sizeof *own, &all, &all_count) != 0)
  {
    return 0;
  }
  for (int64_t i = 0; i < all_count && count < MCOR_KINDS; ++i)
  {
    count = mcor_add_kind(kinds, count, ((const mcor_kind*)all)[i]);
  }
  return count < MCOR_KINDS ? count : 0;
}

/* Finds which value of an array of particle types marks fluid. If the values are 0 and 1, fluid is
 * 1 in an array "isfluid", else 0. In an array "type" of DualSPHysics, fluid is 3, because types 0
 * to 2 are fixed, moving and floating bodies. Returns false if name and values leave doubt. */
static bool mcor_finds_fluid(const char* name, const mcor_kind* kinds, int count, double* fluid)
{
  const int last = count - 1;
  const bool is_solver = count > 1 && kinds[0].value >= 0 && kinds[0].value < 3 &&
    kinds[last].value == 3 && mcor_is_usual_name(name, "type");
  bool is_clear = is_solver || (count > 1 && kinds[0].value == 0 && kinds[last].value == 1);
  for (int k = 0; k < count; ++k)
  {
    is_clear = is_clear && kinds[k].value == floor(kinds[k].value);
  }
  *fluid = !is_clear ? *fluid : is_solver ? 3 : mcor_is_usual_name(name, "isfluid");
  return is_clear;
}

/* Returns a message that an array of particle types is not used; no message if the array has fewer
 * than two different values, or too many. */
static mcor_message mcor_describe_unused_type(const char* name, const mcor_kind* kinds, int count)
{
  if (count < 2)
  {
    return MCOR_NO_MESSAGE;
  }
  if (strcmp(name, MCOR_WALL_BLOCK) == 0)
  {
    return mcor_say(MCOR_SAY(WALL_BLOCKS_UNUSED), MCOR_WALL_BLOCK);
  }
  double fluid = 0;
  char *list = mcor_text("%s", ""), seems[50] = "";
  for (int k = 0; k < count; ++k)
  {
    list =
      mcor_append(list, "%s %lld x %g", k ? "," : "", (long long)kinds[k].count, kinds[k].value);
  }
  if (mcor_finds_fluid(name, kinds, count, &fluid))
  {
    snprintf(seems, sizeof seems, ", which seems to be %g", fluid);
  }
  const mcor_message message = mcor_say(MCOR_SAY(TYPE_UNUSED), name, list ? list : "", name, seems);
  free(list);
  return message;
}

/* Unless find_fluid is 0, chooses an array that tells without doubt which particles are fluid;
 * among several, the one with the most usual name. If none is chosen, found->unused_type may name
 * an array of particle types or, if find_fluid is 2, say that there is none. */
static void mcor_look_for_fluid(mcor_finder* f)
{
  mcor_found* found = f->found;
  for (int priority = 0; priority < MCOR_NAMES; ++priority)
  {
    for (int i = 0; i < f->count; ++i)
    {
      const mcor_named* a = f->arrays + i;
      mcor_kind kinds[MCOR_KINDS];
      if (mcor_name_priority(MCOR_PARTICLE_TYPE, a->name) != priority || a->components != 1 ||
        a->tuples != f->positions->tuples || a->type == MCOR_ELEMENT_OTHER)
      {
        continue;
      }
      const int count = mcor_count_kinds(f, a, kinds);
      if (f->request->find_fluid && mcor_finds_fluid(a->name, kinds, count, &found->fluid_value))
      {
        found->which[MCOR_ROLE_FLUID] = i;
        mcor_free_message(&found->unused_type);
        return;
      }
      bool is_used = false; /* whether the request has ranges of this array */
      for (int r = 0; r < f->request->only_count; ++r)
      {
        is_used = is_used || strcmp(f->request->only[r].name, a->name) == 0;
      }
      if (found->unused_type.code == MCOR_SAYS_NOTHING && !is_used)
      {
        found->unused_type = mcor_describe_unused_type(a->name, kinds, count);
      }
    }
  }
  if (f->request->find_fluid > 1 && found->unused_type.code == MCOR_SAYS_NOTHING)
  {
    found->unused_type = mcor_say(MCOR_SAY(NO_TYPE), mcor_names_of(f));
  }
}

void mcor_find_fluid(mcor_finder* f)
{
  mcor_found* found = f->found;
  const char* name = mcor_given_name(f, MCOR_ROLE_FLUID);
  const bool is_block = name && strncmp(name, "Block: ", 7) == 0;
  const int walls = is_block ? mcor_find_by_name(f, MCOR_WALL_BLOCK) : -1;
  found->fluid_value = name && walls < 0 ? f->request->fluid_value : 0;
  found->which[MCOR_ROLE_FLUID] = walls;
  if (!name && (f->request->wants & MCOR_WANT_FLUID))
  {
    mcor_look_for_fluid(f);
  }
}

/* Returns whether a particle lies in the box request->within and passes the ranges request->only.
 * of: the index of the array of each range. */
static bool mcor_counts(const mcor_finder* f, const int* of, int64_t particle)
{
  const mcor_only* only = f->request->only;
  const double* within = f->request->within;
  bool counts = true;
  for (int a = 0; a < 3 && mcor_has_sides(within); ++a)
  {
    const double x = mcor_element_at(f->positions, particle, a);
    counts = counts && x >= within[2 * a] && x <= within[2 * a + 1];
  }
  for (int r = 0; r < f->request->only_count && counts; ++r)
  {
    const double x = mcor_element_at(f->arrays + of[r], particle, 0);
    counts = false; /* a value must lie in one of its array's ranges */
    for (int k = 0; k < f->request->only_count; ++k)
    {
      counts = counts || (of[k] == of[r] && x >= only[k].low && x <= only[k].high);
    }
  }
  return counts;
}

/* Returns the beginning of a sentence: "No particle is within 0,1,0,1,0,1 and left by Type=1:2". */
static char* mcor_describe_choice(const mcor_finder* f)
{
  const mcor_request* request = f->request;
  const bool has = mcor_has_sides(request->within);
  double b[6];
  for (int side = 0; side < 6; ++side)
  {
    /* Six zeros mean "no box", so the request may hold a denormal number where a side of the box is
     * 0. The message shows 0. */
    b[side] = fpclassify(request->within[side]) == FP_SUBNORMAL ? 0 : request->within[side];
  }
  char* text = has
    ? mcor_text("No particle is within %g,%g,%g,%g,%g,%g", b[0], b[1], b[2], b[3], b[4], b[5])
    : mcor_text("No particle is");
  for (int i = 0; i < request->only_count; ++i)
  {
    const mcor_only* only = request->only + i;
    text = mcor_append(text, "%s%s%s=%g", i > 0 || has ? " and " : " ", i == 0 ? "left by " : "",
      only->name, only->low);
    text = only->high == only->low ? text : mcor_append(text, ":%g", only->high);
  }
  return text;
}

void mcor_mark_particles(mcor_finder* f)
{
  const mcor_request* request = f->request;
  mcor_found* found = f->found;
  const int64_t count = f->positions->tuples;
  const char* name = mcor_given_name(f, MCOR_ROLE_FLUID);
  const bool is_chosen = mcor_has_sides(request->within) || request->only_count > 0;
  int* const which = &found->which[MCOR_ROLE_FLUID];
  found->input.ignore_solids = request->ignore_solids != 0;
  *which = name && *which < 0 ? mcor_find_given(f, "fluid", name, 1) : *which;
  if (*which < 0 && (name || !is_chosen))
  {
    return;
  }
  const mcor_named* fluid = *which >= 0 ? f->arrays + *which : NULL;
  found->views[MCOR_ROLE_FLUID].name = fluid ? mcor_keep_name(f, fluid->name) : NULL;
  uint8_t* solid = mcor_find_memory(f, (size_t)count);
  int* of = mcor_find_memory(f, (size_t)request->only_count * sizeof *of);
  for (int r = 0; r < request->only_count && count > 0 && of; ++r)
  {
    of[r] = mcor_find_given(f, "choice of particles", request->only[r].name, 1);
  }
  if (!solid || !of || mcor_has_error(f))
  {
    return;
  }
  bool some = !is_chosen;
  found->input.solid = solid;
  found->fluid_count = 0;
  for (int64_t i = 0; i < count; ++i)
  {
    solid[i] = fluid && mcor_element_at(fluid, i, 0) != found->fluid_value;
    solid[i] = is_chosen && !mcor_counts(f, of, i) ? MCOR_ABSENT : solid[i];
    some = some || solid[i] != MCOR_ABSENT;
    found->fluid_count += solid[i] == 0;
  }
  if (found->fluid_count == 0)
  {
    found->no_fluid = mcor_own(f,
      some && fluid
        ? mcor_text("No particle has %s = %g", fluid->name ? fluid->name : "", found->fluid_value)
        : mcor_describe_choice(f));
  }
}

/* The values of all ranks decide whether an array varies, so all ranks choose the same array. */
int mcor_choose_view(const mcor_named* arrays, int count, int active, const mcor_ranks* ranks)
{
  int best = -1, best_rank = -1;
  for (int i = 0; i < count; ++i)
  {
    const mcor_named* a = arrays + i;
    const int components = a->type < MCOR_ELEMENT_OTHER && a->name ? a->components : 0;
    bool varies = false;
    for (int c = 0; c < components && !varies; ++c)
    {
      /* The least value so far, and minus the greatest value so far, until these values differ. */
      double ends[2] = { INFINITY, INFINITY };
      for (int64_t k = 0; k < a->tuples && !(ends[0] < -ends[1]); ++k)
      {
        const double x = mcor_element_at(a, k, c);
        ends[0] = fmin(ends[0], x);
        ends[1] = fmin(ends[1], -x);
      }
      if (ranks && ranks->reduce_doubles(ranks->user, MCOR_LEAST, ends, 2) != 0)
      {
        return -1;
      }
      varies = ends[0] < -ends[1];
    }
    const int rank =
      mcor_view_priority(a->name, components, a->type <= MCOR_ELEMENT_FLOAT64, varies);
    if (rank >= 0 && (i == active || best < 0 || (rank < best_rank && best != active)))
    {
      best = i;
      best_rank = rank;
    }
  }
  return best;
}
