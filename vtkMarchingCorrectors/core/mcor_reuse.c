/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Reuse of the last call's results. */

#include "mcor_internal.h"

#include <string.h>

static bool mcor_same_array(const mcor_array* a, const mcor_array* b)
{
  return (a->data == NULL) == (b->data == NULL) && a->type == b->type &&
    (a->data || a->constant == b->constant);
}

bool mcor_same_particles(const mcor_input* input, const mcor_input* last)
{
  return input->particles_version != 0 && input->particles_version == last->particles_version &&
    input->count == last->count &&
    mcor_same_array(&input->smoothing_length, &last->smoothing_length) &&
    input->smoothing_length_is_support_radius == last->smoothing_length_is_support_radius &&
    input->estimate_smoothing_length == last->estimate_smoothing_length &&
    mcor_same_array(&input->widening, &last->widening) &&
    mcor_same_array(&input->mass, &last->mass) &&
    mcor_same_array(&input->density, &last->density) &&
    mcor_same_array(&input->volume, &last->volume) &&
    (input->solid == NULL) == (last->solid == NULL);
}

/* Returns a hash of the keys of the split bricks. */
static uint64_t mcor_hash_splits(const mcor_globals* globals)
{
  uint64_t hash = (uint64_t)globals->split_count;
  for (int64_t i = 0; i < globals->split_count; ++i)
  {
    hash = (hash ^ globals->splits[i]) * UINT64_C(0x9E3779B97F4A7C15);
    hash ^= hash >> 29;
  }
  return hash;
}

static bool mcor_same_bounds(const double a[6], const double b[6])
{
  return memcmp(a, b, 6 * sizeof *a) == 0;
}

/* Whether the options are the same, except for options of scope KEEPS in mcor_options.def: these
 * may change without harm to what the context keeps. */
static bool mcor_same_options(const mcor_options* a, const mcor_options* b)
{
  enum
  {
    SURFACE = 0,
    PROBE = 0,
    GAUGE = 0,
    ALL = 0,
    KEEPS = 1
  };
  bool same = !a->ranks == !b->ranks;
#define OPTION(member, usual, legal, words, scope, property)                                       \
  same = same && ((scope) == KEEPS || a->member == b->member);
#define BOUNDS(member, scope, property) same = same && mcor_same_bounds(a->member, b->member);
#include "mcor_options.def"
  /* With a box or a period, two more options decide which particles and images around the box are
   * needed: the seeds, and whether the nearest particles are output. */
  const bool part = mcor_has_box(a) || mcor_has_sides(a->periodic);
  const unsigned changed = a->outputs ^ b->outputs;
  return same && (!part || (a->seeds == b->seeds && !(changed & MCOR_OUT_NEAREST_PARTICLE)));
}

/* Finds which results of the last call still hold. The caller's version numbers stand for the
 * contents of arrays; everything else on which the search grid, the scalar and the node values
 * depend is compared. */
void mcor_check_reuse(mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  const mcor_input* last = &context->kept.input;
  const bool particles = mcor_same_particles(input, last);
  /* Compares globals without their components: nothing that is kept depends on the components. */
  const mcor_globals none = { 0 };
  const mcor_globals *a = &context->kept.globals, *b = options->globals ? options->globals : &none;
  const mcor_measure *m = &a->measured, *n = &b->measured;
  const bool parameters = mcor_same_options(options, &context->kept.options) &&
    m->fluid_count == n->fluid_count && m->solid_count == n->solid_count && m->h_min == n->h_min &&
    m->support_min == n->support_min && m->support_max == n->support_max &&
    m->h_estimate == n->h_estimate && m->wall_share == n->wall_share &&
    m->scalar_min == n->scalar_min && m->scalar_max == n->scalar_max &&
    a->mass_max == b->mass_max && a->scalar_shift == b->scalar_shift &&
    memcmp(m->low, n->low, sizeof m->low) == 0 && memcmp(m->high, n->high, sizeof m->high) == 0 &&
    context->kept.splits == (options->globals ? mcor_hash_splits(b) : 0);
  context->kept.grid = context->kept.grid && particles && parameters &&
    context->run.uses_solids == context->kept.uses_solids;
  context->kept.value = context->kept.value && context->kept.grid && input->scalar_version != 0 &&
    input->scalar_version == last->scalar_version &&
    input->scalar_component == last->scalar_component &&
    (input->scalar_dot.data == NULL) == (last->scalar_dot.data == NULL);
  context->kept.nodes = context->kept.nodes && context->kept.value;
}

void mcor_keep_call(mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  const mcor_globals* globals = options->globals;
  context->kept.input = *input;
  context->kept.options = *options;
  context->kept.globals = globals ? *globals : (mcor_globals){ 0 };
  context->kept.splits = globals ? mcor_hash_splits(globals) : 0;
}
