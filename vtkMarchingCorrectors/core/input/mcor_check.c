/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Checks everything that a caller hands in. */

#include "mcor_input.h"
#include "mcor_plane.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

mcor_status mcor_refuse_sides(mcor_context* context, int axis, double from, double to)
{
  return mcor_fail(context, MCOR_INVALID_ARGUMENT, MCOR_SAY(BOX_ILLEGAL),
    mcor_axis_letter(context, axis), from, to,
    isnan(from) || isnan(to) ? "both must be numbers" : "the first must be lower than the second");
}

/* Refuses globals with values that no measurement yields. Checks ranges only if there is fluid. */
static mcor_status mcor_check_globals(mcor_context* context, const mcor_globals* g)
{
  const mcor_measure* m = &g->measured;
  bool good = m->fluid_count >= 0 && m->solid_count >= 0 && g->component_count >= 0 &&
    (g->components || g->component_count == 0) && g->split_count >= 0;
  if (m->fluid_count > 0)
  {
    good = good && m->h_min > 0 && m->h_min <= m->h_max && m->support_min > 0 &&
      m->support_min <= m->support_max && m->h_estimate >= 0 && isfinite(g->scalar_shift) &&
      g->mass_max >= 0 && m->wall_share >= 0 && m->wall_share <= 1 && m->low[0] <= m->high[0] &&
      m->low[1] <= m->high[1] && m->low[2] <= m->high[2];
  }
  MCOR_FAIL_IF(!good, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(GLOBALS_DAMAGED));
  return MCOR_OK;
}

/* The legal values of an option. If is_word is set: the numbers of the option's words, e.g. 0 and 1
 * for "table|field". Else: `low` to `high`, and -1, -2, ... for the words. */
typedef struct mcor_legal
{
  bool is_word, excludes_low, excludes_high;
  double low, high;
} mcor_legal;

// clang-format off
#define WORD { .is_word = true }
#define FLAG FROM(-INFINITY, INFINITY)
#define AT_LEAST_0 FROM(0, INFINITY)
#define ABOVE_0 { .low = 0, .high = INFINITY, .excludes_low = true }
#define SHARE { .low = 0, .high = 1, .excludes_high = true }
#define FROM(least, greatest) { .low = least, .high = greatest }
// clang-format on

/* Whether a list such as "table|field" has a word of this number; the first word is number 0. */
static bool mcor_has_word(const char* words, double number)
{
  for (double i = 0; words && i < number; ++i)
  {
    words = strchr(words, '|');
    words = words ? words + 1 : NULL;
  }
  return words && *words && number >= 0 && number == floor(number);
}

static mcor_status mcor_check_number(
  mcor_context* context, const char* member, double value, mcor_legal legal, const char* words)
{
  const bool within = isfinite(value) &&
    (legal.excludes_low ? value > legal.low : value >= legal.low) &&
    (legal.excludes_high ? value < legal.high : value <= legal.high);
  if (legal.is_word ? mcor_has_word(words, value) : within || mcor_has_word(words, -1 - value))
  {
    return MCOR_OK;
  }
  char most[40] = "";
  if (legal.is_word)
  {
    return mcor_fail(
      context, MCOR_INVALID_ARGUMENT, MCOR_SAY(OPTION_NOT_A_WORD), member, value, words);
  }
  if (isfinite(legal.high))
  {
    snprintf(
      most, sizeof most, " and %s %g", legal.excludes_high ? "below" : "at most", legal.high);
  }
  return mcor_fail(context, MCOR_INVALID_ARGUMENT, MCOR_SAY(OPTION_ILLEGAL), member, value,
    legal.excludes_low ? "above" : "at least", legal.low,
    isfinite(value) || *most ? most : " and finite",
    *words ? ", or the number, from -1 down, of one of these: " : "", words);
}

/* Compilers may make an enumeration unsigned if none of its values is negative. The cast to int
 * turns an illegal number below 0 back into a negative one. */
#define MCOR_NUMBER(value)                                                                         \
  _Generic((value), unsigned : (double)(int)(value), default : (double)(value))

static mcor_status mcor_check_options(mcor_context* context, const mcor_options* options)
{
#define OPTION(member, usual, legal, words, scope, property)                                       \
  MCOR_TRY(                                                                                        \
    mcor_check_number(context, #member, MCOR_NUMBER(options->member), (mcor_legal)legal, words));
#include "mcor_options.def"
#define MCOR_NEED(condition, ...)                                                                  \
  MCOR_FAIL_IF(!(condition), context, MCOR_INVALID_ARGUMENT, __VA_ARGS__)
  MCOR_NEED(options->iso_count >= 0 && (options->iso_count == 0 || options->iso_values),
    MCOR_SAY(ISO_COUNT), options->iso_count);
  for (int i = 0; i < options->iso_count; ++i)
  {
    MCOR_NEED(isfinite(options->iso_values[i]), MCOR_SAY(ISO_NOT_FINITE), i);
    MCOR_NEED(options->field != MCOR_WEIGHT_SUM || options->iso_values[i] > 0,
      MCOR_SAY(ISO_OF_FREE_SURFACE), options->iso_values[i]);
  }
  /* Seeds at pairs of particles do not suffice for caps, which may need other cells. Such seeds do
   * not work with a box or several ranks either, because a pair may lie outside of the box. */
  const char* other = options->capping ? "{capping}"
    : mcor_has_box(options)            ? "{box}"
    : options->ranks                   ? "Several processes"
                                       : NULL;
  MCOR_NEED(!other || !mcor_wants_pairs(options), MCOR_SAY(PAIRS_WITH), other);
  if (options->globals)
  {
    MCOR_TRY(mcor_check_globals(context, options->globals));
  }
  for (int a = 0; a < 3 && mcor_has_box(options); ++a)
  {
    const double from = options->box[2 * a], to = options->box[2 * a + 1];
    if (!(from < to))
    {
      MCOR_TRY(mcor_refuse_sides(context, a, from, to));
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    const double from = options->periodic[2 * a], to = options->periodic[2 * a + 1];
    MCOR_NEED(isfinite(from) && isfinite(to) && from <= to, MCOR_SAY(PERIOD_ILLEGAL),
      mcor_axis_letter(context, a), from, to);
  }
  return MCOR_OK;
#undef MCOR_NEED
}

/* Checks an array's type and number of components. */
static mcor_status mcor_check_form(
  mcor_context* context, const mcor_array* array, const char* role, int components)
{
  const bool same = strcmp(mcor_array_name(array, role), role) == 0;
  const char *space = same ? "" : " ", *its = same ? "" : array->name;
  MCOR_FAIL_IF((unsigned)array->type > MCOR_FLOAT64, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(ARRAY_TYPE), role, space, its);
  MCOR_FAIL_IF(array->components < 0 || mcor_components(array) != components, context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(ARRAY_COMPONENTS), role, space, its, array->components,
    components);
  return MCOR_OK;
}

/* Checks an array's form, and that the values of all particles except skipped ones are finite and,
 * if `positive`, above 0. */
static mcor_status mcor_check_array(mcor_context* context, const mcor_input* input,
  const mcor_array* array, mcor_skip skip, const char* role, int components, bool positive)
{
  const bool same = strcmp(mcor_array_name(array, role), role) == 0;
  MCOR_TRY(mcor_check_form(context, array, role, components));
  const int64_t i = mcor_find_illegal(context, array, input->solid, skip, input->count, positive);
  if (i < 0)
  {
    return MCOR_OK;
  }
  double v = mcor_array_at(array, i, 0);
  for (int c = 1; isfinite(v) && c < components; ++c)
  {
    v = mcor_array_at(array, i, c);
  }
  const char* problem = isnan(v) ? "not a number (NaN)" : isinf(v) ? "infinite" : "not above 0";
  return array->data ? mcor_fail(context, MCOR_INVALID_DATA, MCOR_SAY(ARRAY_VALUE), role,
                         same ? "" : " array ", same ? "" : array->name, (long long)i, problem)
                     : mcor_fail(context, MCOR_INVALID_DATA, MCOR_SAY(CONSTANT_VALUE), role,
                         problem, positive ? " above 0" : "");
}

mcor_status mcor_check_scalar_form(mcor_context* context, const mcor_input* input)
{
  const int components = mcor_components(&input->scalar);
  MCOR_FAIL_IF(!input->scalar.data, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(SCALAR_MISSING));
  MCOR_FAIL_IF(components > 1 && !input->scalar_dot.data &&
      input->scalar_component != MCOR_MAGNITUDE &&
      (input->scalar_component < 0 || input->scalar_component >= components),
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(SCALAR_COMPONENT), input->scalar_component,
    mcor_array_name(&input->scalar, "scalar"), components, components - 1);
  MCOR_FAIL_IF(input->scalar_dot.data && mcor_components(&input->scalar_dot) != components, context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(DOT_COMPONENTS), mcor_array_name(&input->scalar, "the first"),
    components, mcor_array_name(&input->scalar_dot, "the second"),
    mcor_components(&input->scalar_dot));
  MCOR_TRY(mcor_check_form(context, &input->scalar, "scalar", components));
  return input->scalar_dot.data ? mcor_check_form(context, &input->scalar_dot, "scalar", components)
                                : MCOR_OK;
}

/* Checks positions, smoothing lengths, widening factors, and volumes or masses and densities. */
static mcor_status mcor_check_particles(mcor_context* context, const mcor_input* input)
{
  const mcor_skip skip = context->run.uses_solids ? MCOR_SKIP_ABSENT : MCOR_SKIP_SOLIDS;
  const bool has_volume = mcor_is_given(&input->volume),
             has_mass = !has_volume && mcor_is_given(&input->mass);
  const mcor_array* const widening = mcor_is_given(&input->widening) ? &input->widening : NULL;
  const struct
  {
    const mcor_array* array; /* NULL: there is none */
    const char* role;
  } arrays[] = { { input->estimate_smoothing_length ? NULL : &input->smoothing_length,
                   "smoothing length" },
    { widening, "widening" }, { has_volume ? &input->volume : NULL, "volume" },
    { has_mass ? &input->mass : NULL, "mass" },
    { has_mass && mcor_is_given(&input->density) ? &input->density : NULL, "density" } };
  MCOR_TRY(mcor_check_array(context, input, &input->positions, skip, "position", 3, false));
  MCOR_FAIL_IF(arrays[0].array && !mcor_is_given(arrays[0].array), context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(LENGTH_MISSING));
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; ++i)
  {
    if (arrays[i].array)
    {
      MCOR_TRY(mcor_check_array(context, input, arrays[i].array, skip, arrays[i].role, 1, true));
    }
  }
  if (widening)
  {
    const double least =
      mcor_find_range(context, widening, input->solid, skip, input->count, 0).least[0];
    MCOR_FAIL_IF(least < 1, context, MCOR_INVALID_DATA, MCOR_SAY(WIDENING_FACTORS), least);
    MCOR_FAIL_IF(
      mcor_needs_density(input), context, MCOR_INVALID_ARGUMENT, MCOR_SAY(WIDENING_NEEDS_VOLUMES));
  }
  return MCOR_OK;
}

mcor_status mcor_check_input(
  mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  MCOR_TRY(mcor_check_options(context, options));
  MCOR_FAIL_IF(input->attribute_count < 0, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(ATTRIBUTE_COUNT), input->attribute_count);
  MCOR_FAIL_IF(input->attribute_count > 0 && !input->attributes, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(ATTRIBUTES_NULL), input->attribute_count);
  MCOR_FAIL_IF(input->count < 0 || input->count > MCOR_PARTICLE_LIMIT, context,
    MCOR_OUT_OF_CAPACITY, MCOR_SAY(PARTICLES_TOO_MANY), (long long)input->count,
    MCOR_PARTICLE_LIMIT);
  if (input->count == 0)
  {
    return MCOR_OK;
  }
  MCOR_FAIL_IF(!input->positions.data, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NO_POSITIONS));
  /* If the kept search grid is of these particles, they were checked when the grid was made. */
  if (!context->kept.grid || !mcor_same_particles(input, &context->kept.input))
  {
    MCOR_TRY(mcor_check_particles(context, input));
  }
  if (options->field != MCOR_WEIGHT_SUM)
  {
    const mcor_array* const scalars[] = { &input->scalar, &input->scalar_dot };
    MCOR_TRY(mcor_check_scalar_form(context, input));
    for (int i = 0; i < (input->scalar_dot.data ? 2 : 1); ++i)
    {
      MCOR_TRY(mcor_check_array(context, input, scalars[i], MCOR_SKIP_SOLIDS, "scalar",
        mcor_components(scalars[i]), false));
    }
  }
  for (int a = 0; a < input->attribute_count; ++a)
  {
    const mcor_array* attribute = &input->attributes[a];
    MCOR_TRY(mcor_check_form(context, attribute, "attribute", mcor_components(attribute)));
  }
  const mcor_build build = mcor_build_of(options, mcor_uses_solids(input, options) && input->solid);
  MCOR_TRY(mcor_settle_device(context, &build, mcor_release_all_data));
  return mcor_upload_case_table(context);
}
