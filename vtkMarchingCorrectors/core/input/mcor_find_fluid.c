/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds which particles are fluid, by an array that is given or that clearly tells it; and which particles count at
 * all. */

#include "mcor_finder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Words of names of blocks and bodies with walls. SPlisHSPlasH calls rigid bodies rb_particle_data. */
static const char* const mcor_wall_words[] = { "wall", "bound", "solid", "obstacle", "rigid",
  "rb_particle", "container", "tank" };

int mcor_tells_of_walls(const char* name)
{
  for (size_t w = 0; name && w < sizeof mcor_wall_words / sizeof *mcor_wall_words; ++w)
  {
    const char* word = mcor_wall_words[w];
    for (const char* at = name; *at; ++at)
    {
      size_t i = 0;
      while (word[i] && (at[i] >= 'A' && at[i] <= 'Z' ? at[i] - 'A' + 'a' : at[i]) == word[i])
      {
        ++i;
      }
      if (!word[i])
      {
        return 1;
      }
    }
  }
  return 0;
}

/* A value, and how often it occurs. count -1: there are more values than kinds of particles. */
typedef struct mcor_kind
{
  double value;
  int64_t count;
} mcor_kind;

/* Compares by value, with NaN last. */
static int mcor_compare_kinds(const void* a, const void* b)
{
  const double x = ((const mcor_kind*)a)->value, y = ((const mcor_kind*)b)->value;
  return isnan(x) || isnan(y) ? !!isnan(x) - !!isnan(y) : (x > y) - (x < y);
}

/* Adds a kind, in order. Returns the number of kinds, or one more than can be. */
static int mcor_add_kind(mcor_kind* kinds, int count, mcor_kind kind)
{
  int at = 0;
  while (at < count && mcor_compare_kinds(kinds + at, &kind) < 0)
  {
    ++at;
  }
  if (at < count && mcor_compare_kinds(kinds + at, &kind) == 0)
  {
    kinds[at].count += kind.count;
    return count;
  }
  if (kind.count < 0 || count >= MCOR_PARTICLE_TYPES)
  {
    return MCOR_PARTICLE_TYPES + 1;
  }
  memmove(kinds + at + 1, kinds + at, (size_t)(count - at) * sizeof *kinds);
  kinds[at] = kind;
  return count + 1;
}

/* Counts how often each value of an array occurs on all ranks. Returns 0 if there are more values than kinds
 * of particles. */
static int mcor_count_kinds(const mcor_finder* f, const mcor_named* array, mcor_kind* kinds)
{
  mcor_kind own[MCOR_PARTICLE_TYPES];
  int own_count = 0;
  for (int64_t i = 0; i < array->tuples && own_count <= MCOR_PARTICLE_TYPES; ++i)
  {
    const double value = mcor_element_at(array, i, 0);
    own_count = mcor_add_kind(own, own_count, (mcor_kind){ isnan(value) ? NAN : value, 1 });
  }
  if (own_count > MCOR_PARTICLE_TYPES)
  {
    own[0] = (mcor_kind){ NAN, -1 };
    own_count = 1;
  }
  const void* all = own;
  int64_t all_count = own_count;
  if (f->ranks &&
    f->ranks->gather(f->ranks->user, own, own_count, sizeof *own, &all, &all_count) != 0)
  {
    return 0;
  }
  int count = 0;
  for (int64_t i = 0; i < all_count && count <= MCOR_PARTICLE_TYPES; ++i)
  {
    mcor_kind kind;
    memcpy(&kind, (const char*)all + (size_t)i * sizeof kind, sizeof kind);
    count = kind.count < 0 ? MCOR_PARTICLE_TYPES + 1 : mcor_add_kind(kinds, count, kind);
  }
  return count > MCOR_PARTICLE_TYPES ? 0 : count;
}

static mcor_message mcor_describe_kinds(const char* name, const mcor_kind* kinds, int count)
{
  double values[MCOR_PARTICLE_TYPES];
  int64_t counts[MCOR_PARTICLE_TYPES];
  for (int k = 0; k < count; ++k)
  {
    values[k] = kinds[k].value;
    counts[k] = kinds[k].count;
  }
  return mcor_describe_unused_type(name, values, counts, count);
}

/* Whether the request has ranges of this array, so the array is used. */
static bool mcor_chooses_particles(const mcor_finder* f, const char* name)
{
  bool chooses = false;
  for (int i = 0; i < f->request->only_count; ++i)
  {
    chooses = chooses || strcmp(f->request->only[i].name, name) == 0;
  }
  return chooses;
}

/* Finds the array with the most usual name that clearly tells which particles are fluid; without
 * one, names an array that seems to tell it but is not used. */
static void mcor_look_for_fluid(mcor_finder* f)
{
  mcor_found* found = f->found;
  for (int priority = 0; priority < MCOR_NAMES; ++priority)
  {
    for (int i = 0; i < f->count; ++i)
    {
      const mcor_named* a = f->arrays + i;
      mcor_kind kinds[MCOR_PARTICLE_TYPES];
      if (mcor_name_priority(MCOR_PARTICLE_TYPE, a->name) != priority || a->components != 1 ||
        a->tuples != f->positions->tuples || a->type == MCOR_ELEMENT_OTHER)
      {
        continue;
      }
      const int count = mcor_count_kinds(f, a, kinds);
      bool whole = count > 0;
      for (int k = 0; k < count; ++k)
      {
        whole = whole && kinds[k].value == floor(kinds[k].value);
      }
      if (f->request->find_fluid && whole &&
        mcor_find_fluid_value(a->name, kinds[0].value, kinds[count - 1].value, &found->fluid_value))
      {
        found->which[MCOR_ROLE_FLUID] = i;
        mcor_free_message(&found->unused_type);
        return;
      }
      if (found->unused_type.code == MCOR_SAYS_NOTHING && !mcor_chooses_particles(f, a->name))
      {
        found->unused_type = mcor_describe_kinds(a->name, kinds, count);
      }
    }
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

static bool mcor_has_within(const mcor_request* request)
{
  bool has = false;
  for (int side = 0; side < 6; ++side)
  {
    has = has || request->within[side] != 0;
  }
  return has;
}

/* Whether a particle is in one of the ranges that are given for an array. first: the first of these
 * ranges. */
static bool mcor_is_in_a_range(const mcor_finder* f, int first, const mcor_named* array, int64_t i)
{
  const double value = mcor_element_at(array, i, 0);
  for (int r = first; r < f->request->only_count; ++r)
  {
    const mcor_only* only = f->request->only + r;
    if (strcmp(only->name, f->request->only[first].name) == 0 && value >= only->low &&
      value <= only->high)
    {
      return true;
    }
  }
  return false;
}

/* Marks particles that Within and Only leave out. Returns whether any are left. */
static bool mcor_mark_absent(mcor_finder* f, uint8_t* solid)
{
  const mcor_request* request = f->request;
  const double* b = request->within;
  const int64_t count = f->positions->tuples;
  for (int64_t i = 0; i < count && mcor_has_within(request); ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      const double x = mcor_element_at(f->positions, i, a);
      solid[i] = x >= b[2 * a] && x <= b[2 * a + 1] ? solid[i] : MCOR_ABSENT;
    }
  }
  for (int r = 0; r < request->only_count; ++r)
  {
    bool is_first = true;
    for (int before = 0; before < r; ++before)
    {
      is_first = is_first && strcmp(request->only[before].name, request->only[r].name) != 0;
    }
    const int index = is_first && count > 0
      ? mcor_find_given(f, "choice of particles", request->only[r].name, 1)
      : -1;
    for (int64_t i = 0; index >= 0 && i < count; ++i)
    {
      solid[i] = mcor_is_in_a_range(f, r, f->arrays + index, i) ? solid[i] : MCOR_ABSENT;
    }
  }
  bool some = false;
  for (int64_t i = 0; i < count; ++i)
  {
    some = some || solid[i] != MCOR_ABSENT;
  }
  return some;
}

/* Writes why particles are left out: "within 0,1,0,1,0,1 and left by Type=1:2". */
static char* mcor_describe_choice(const mcor_finder* f)
{
  const mcor_request* request = f->request;
  const bool has = mcor_has_within(request);
  double b[6];
  for (int side = 0; side < 6;
       ++side) /* a tiny side stands for 0, because six zeros would choose no box */
  {
    b[side] = fpclassify(request->within[side]) == FP_SUBNORMAL ? 0 : request->within[side];
  }
  char* text = has
    ? mcor_text("No particle is within %g,%g,%g,%g,%g,%g", b[0], b[1], b[2], b[3], b[4], b[5])
    : mcor_text("No particle is");
  for (int i = 0; i < request->only_count && text; ++i)
  {
    const mcor_only* only = request->only + i;
    char high[40] = "", *before = text;
    if (only->high != only->low)
    {
      snprintf(high, sizeof high, ":%g", only->high);
    }
    text = mcor_text("%s%s%s%s=%g%s", before, i > 0 || has ? " and " : " ",
      i == 0 ? "left by " : "", only->name, only->low, high);
    free(before);
  }
  return text;
}

void mcor_mark_particles(mcor_finder* f)
{
  const mcor_request* request = f->request;
  mcor_found* found = f->found;
  const int64_t count = f->positions->tuples;
  const char* name = mcor_given_name(f, MCOR_ROLE_FLUID);
  int fluid = found->which[MCOR_ROLE_FLUID];
  found->input.ignore_solids = request->ignore_solids != 0;
  if (name && fluid < 0)
  {
    fluid = found->which[MCOR_ROLE_FLUID] = mcor_find_given(f, "fluid", name, 1);
  }
  const bool is_chosen = mcor_has_within(request) || request->only_count > 0;
  if (fluid < 0 && (name || !is_chosen))
  {
    return;
  }
  found->views[MCOR_ROLE_FLUID].name = fluid < 0 ? NULL : mcor_keep_name(f, f->arrays[fluid].name);
  uint8_t* solid = mcor_find_memory(f, (size_t)count);
  if (!solid)
  {
    return;
  }
  for (int64_t i = 0; i < count; ++i)
  {
    solid[i] = fluid >= 0 && mcor_element_at(f->arrays + fluid, i, 0) != found->fluid_value;
  }
  const bool some = !is_chosen || mcor_mark_absent(f, solid);
  found->input.solid = solid;
  found->fluid_count = 0;
  for (int64_t i = 0; i < count; ++i)
  {
    found->fluid_count += solid[i] == 0;
  }
  if (found->fluid_count == 0)
  {
    const char* array = fluid >= 0 && f->arrays[fluid].name ? f->arrays[fluid].name : "";
    found->no_fluid = some && fluid >= 0
      ? mcor_text("No particle has %s = %g", array, found->fluid_value)
      : mcor_describe_choice(f);
  }
}

/* Finds the first number among a component's values, and whether another value differs from it. */
static void mcor_find_variation(const mcor_named* a, int component, double* first, double* varies)
{
  for (int64_t i = 0; i < a->tuples && !*varies; ++i)
  {
    const double x = mcor_element_at(a, i, component);
    *first = isnan(*first) ? x : *first;
    *varies = !isnan(x) && x != *first;
  }
}

/* The ranks first agree which components of which arrays vary. */
int mcor_choose_view(const mcor_named* arrays, int count, int active, const mcor_ranks* ranks)
{
  int components = 0, best = -1, best_rank = -1;
  for (int i = 0; i < count; ++i)
  {
    components += arrays[i].type < MCOR_ELEMENT_OTHER && arrays[i].name ? arrays[i].components : 0;
  }
  double* low = malloc(((size_t)components * 3 + 1) * sizeof *low);
  double *high = low + components, *varies = high + components;
  for (int i = 0, c = 0; low && i < count; ++i)
  {
    const int of_array =
      arrays[i].type < MCOR_ELEMENT_OTHER && arrays[i].name ? arrays[i].components : 0;
    for (int k = 0; k < of_array; ++k, ++c)
    {
      double first = NAN;
      varies[c] = 0;
      mcor_find_variation(arrays + i, k, &first, varies + c);
      low[c] = isnan(first) ? INFINITY : first;
      high[c] = isnan(first) ? -INFINITY : first;
    }
  }
  if (low && ranks && components > 0 &&
    (ranks->reduce_doubles(ranks->user, MCOR_LEAST, low, components) != 0 ||
      ranks->reduce_doubles(ranks->user, MCOR_GREATEST, high, 2 * components) != 0))
  {
    free(low);
    return -1;
  }
  for (int i = 0, c = 0; low && i < count; ++i)
  {
    const int of_array =
      arrays[i].type < MCOR_ELEMENT_OTHER && arrays[i].name ? arrays[i].components : 0;
    bool differs = false;
    for (int k = 0; k < of_array; ++k, ++c)
    {
      differs = differs || varies[c] != 0 || low[c] < high[c];
    }
    const int rank = of_array == 0 ? -1
                                   : mcor_view_priority(arrays[i].name, of_array,
                                       arrays[i].type <= MCOR_ELEMENT_FLOAT64, differs);
    if (rank >= 0 && (i == active || best < 0 || (rank < best_rank && best != active)))
    {
      best = i;
      best_rank = rank;
    }
  }
  free(low);
  return best;
}
