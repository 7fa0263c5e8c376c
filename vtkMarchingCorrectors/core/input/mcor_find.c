/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds, among named arrays, what a run needs, and makes an mcor_input of it. Ranks first find
 * together what they must agree on, so that later no rank waits for one that has failed. */

#include "mcor_finder.h"

#include <stdlib.h>
#include <string.h>

void* mcor_own(mcor_finder* f, void* memory)
{
  mcor_found* found = f->found;
  void** more = realloc(found->own, ((size_t)found->own_count + 1) * sizeof *more);
  found->own = more ? more : found->own;
  if (!memory || !more)
  {
    f->lacks_memory = true;
    free(memory);
    return NULL;
  }
  return found->own[found->own_count++] = memory;
}

void* mcor_find_memory(mcor_finder* f, size_t bytes)
{
  return mcor_own(f, malloc(bytes ? bytes : 1));
}

/* Keeps the first message that says what is wrong; frees later ones. Returns -1: no index. */
static int mcor_refuse(mcor_finder* f, mcor_message message)
{
  if (mcor_has_error(f))
  {
    mcor_free_message(&message);
  }
  else
  {
    f->found->error = message;
  }
  return -1;
}

const char* mcor_names_of(mcor_finder* f)
{
  char* list = mcor_text("%s", f->count > 0 ? "Point arrays: " : "The input has no point arrays.");
  for (int i = 0; i < f->count; ++i)
  {
    const char* name = f->arrays[i].name;
    list = mcor_append(list, "%s%s", name ? name : "", i + 1 < f->count ? ", " : ".");
  }
  const char* names = mcor_own(f, list);
  return names ? names : "";
}

static const mcor_named* mcor_named_of(const mcor_finder* f, int index)
{
  return index < f->count ? f->arrays + index : f->found->made + (index - f->count);
}

const char* mcor_keep_name(mcor_finder* f, const char* name)
{
  return name ? mcor_own(f, mcor_text("%s", name)) : NULL;
}

/* Writes element i of an array of floats or doubles. */
static void mcor_put_element(void* array, mcor_element type, int64_t i, double value)
{
  if (type == MCOR_ELEMENT_FLOAT32)
  {
    ((float*)array)[i] = (float)value;
  }
  else
  {
    ((double*)array)[i] = value;
  }
}

/* Returns an array as the core reads it: the array itself if it has aligned floats or doubles
 * without gaps, else a copy. */
static mcor_array mcor_view_named(mcor_finder* f, const mcor_named* named)
{
  static const double none[3];
  const bool is_float = named->type == MCOR_ELEMENT_FLOAT32;
  const int64_t values = named->tuples * named->components,
                width = is_float ? sizeof(float) : sizeof(double);
  const bool is_plain = (is_float || named->type == MCOR_ELEMENT_FLOAT64) &&
    (named->stride[1] == 0 || named->components == 1 || named->stride[1] == width) &&
    (named->stride[0] == 0 || named->stride[0] == width * named->components) &&
    (uintptr_t)named->data % (size_t)width == 0;
  void* copy = values == 0 || is_plain ? NULL : mcor_find_memory(f, (size_t)(values * width));
  for (int64_t i = 0; copy && i < values; ++i)
  {
    mcor_put_element(copy, named->type, i,
      mcor_element_at(named, i / named->components, (int)(i % named->components)));
  }
  const void* data = copy ? copy : is_plain && values > 0 ? named->data : none;
  return (mcor_array){ .type = is_float ? MCOR_FLOAT32 : MCOR_FLOAT64,
    .components = named->components,
    .data = data,
    .name = mcor_keep_name(f, named->name) };
}

/* Returns the view of an array by its index. An array that serves for several roles has one view,
 * because mcor_project compares pointers to data to find whether the weights are the masses. */
static mcor_array mcor_view_of(mcor_finder* f, int index)
{
  mcor_array* view = f->views + index;
  if (!view->data)
  {
    *view = mcor_view_named(f, mcor_named_of(f, index));
  }
  return *view;
}

double mcor_element_at(const mcor_named* a, int64_t tuple, int component)
{
#define MCOR_READ(element, kind)                                                                   \
  case element:                                                                                    \
  {                                                                                                \
    kind value;                                                                                    \
    const int64_t width = sizeof value, step = a->stride[1] ? a->stride[1] : width,                \
                  row = a->stride[0] ? a->stride[0] : width * a->components;                       \
    memcpy(&value, (const char*)a->data + tuple * row + component * step, sizeof value);           \
    return (double)value;                                                                          \
  }
  switch (a->type)
  {
    MCOR_READ(MCOR_ELEMENT_FLOAT32, float)
    MCOR_READ(MCOR_ELEMENT_FLOAT64, double)
    MCOR_READ(MCOR_ELEMENT_INT8, int8_t)
    MCOR_READ(MCOR_ELEMENT_UINT8, uint8_t)
    MCOR_READ(MCOR_ELEMENT_INT16, int16_t)
    MCOR_READ(MCOR_ELEMENT_UINT16, uint16_t)
    MCOR_READ(MCOR_ELEMENT_INT32, int32_t)
    MCOR_READ(MCOR_ELEMENT_UINT32, uint32_t)
    MCOR_READ(MCOR_ELEMENT_INT64, int64_t)
    MCOR_READ(MCOR_ELEMENT_UINT64, uint64_t)
    default:
      return NAN;
  }
#undef MCOR_READ
}

const char* mcor_given_name(const mcor_finder* f, mcor_role role)
{
  const char* name = f->request->names[role];
  const bool none =
    !name || !*name || strcmp(name, "(automatic)") == 0 || strcmp(name, "(none)") == 0;
  return none ? NULL : name;
}

int mcor_find_by_name(const mcor_finder* f, const char* name)
{
  int i = 0;
  while (i < f->count && !(f->arrays[i].name && strcmp(f->arrays[i].name, name) == 0))
  {
    ++i;
  }
  return i < f->count ? i : -1;
}

int mcor_find_named(
  const mcor_named* arrays, int count, mcor_quantity quantity, int components, int64_t tuples)
{
  int found = -1, best = -1;
  for (int i = 0; i < count; ++i)
  {
    const mcor_named* a = arrays + i;
    const int rank = mcor_name_priority(quantity, a->name);
    if (rank >= 0 && (found < 0 || rank < best) && a->components == components &&
      a->tuples == tuples && a->type < MCOR_ELEMENT_OTHER)
    {
      found = i;
      best = rank;
    }
  }
  return found;
}

/* Joins vx, vy and vz to one vector, unless there is an array "Velocity". The vector is float only
 * if all three are. Returns the vector's index, f->count; -1: there is none. */
static int mcor_join_velocity(mcor_finder* f)
{
  mcor_named* made = f->found->made;
  if (made->name)
  {
    return f->count;
  }
  const int parts[3] = { mcor_find_by_name(f, "vx"), mcor_find_by_name(f, "vy"),
    mcor_find_by_name(f, "vz") };
  mcor_element type = MCOR_ELEMENT_FLOAT32;
  for (int c = 0; c < 3; ++c)
  {
    const mcor_named* part = f->arrays + parts[c];
    if (parts[c] < 0 || part->components != 1 || part->tuples != f->positions->tuples ||
      part->type > MCOR_ELEMENT_FLOAT64)
    {
      return -1;
    }
    type = part->type > type ? part->type : type;
  }
  const int64_t count = f->positions->tuples;
  void* data = mcor_find_by_name(f, "Velocity") >= 0
    ? NULL
    : mcor_find_memory(
        f, (size_t)count * 3 * (type == MCOR_ELEMENT_FLOAT32 ? sizeof(float) : sizeof(double)));
  for (int64_t i = 0; data && i < 3 * count; ++i)
  {
    mcor_put_element(data, type, i, mcor_element_at(f->arrays + parts[i % 3], i / 3, 0));
  }
  if (!data)
  {
    return -1;
  }
  *made = (mcor_named){ "Velocity", type, 3, count, data, { 0, 0 } };
  return f->count;
}

/* Returns "mass array 'M'", or "mass" if the values have no name of their own. */
static const char* mcor_called(mcor_finder* f, const char* words, const char* name)
{
  const char* called =
    strcmp(words, name) == 0 ? words : mcor_own(f, mcor_text("%s array '%s'", words, name));
  return called ? called : words;
}

/* Returns the index if the array exists and has numbers for all particles. Otherwise sets the error
 * and returns -1. */
static int mcor_check_named(mcor_finder* f, const char* words, const char* name, int index)
{
  if (index < 0)
  {
    const bool is_plane = strcmp(name, "Lambda2") == 0 && mcor_find_by_name(f, "Q-criterion") >= 0;
    return mcor_refuse(f,
      mcor_say(MCOR_SAY(NO_SUCH_ARRAY), name, words,
        is_plane ? " There is no Lambda2 in two dimensions, because it is the middle one of three "
                   "eigenvalues; use Q-criterion."
          : strcmp(words, "fluid") == 0 ? " If all particles are fluid, leave out {fluid}."
                                        : "",
        mcor_names_of(f)));
  }
  const mcor_named* named = mcor_named_of(f, index);
  name = named->name ? named->name : "";
  if (named->type == MCOR_ELEMENT_OTHER)
  {
    return mcor_refuse(f, mcor_say(MCOR_SAY(ARRAY_WITHOUT_NUMBERS), mcor_called(f, words, name)));
  }
  if (named->tuples != f->positions->tuples || named->components < 1)
  {
    return mcor_refuse(f,
      mcor_say(MCOR_SAY(ARRAY_TOO_SHORT), mcor_called(f, words, name), (long long)named->tuples,
        (long long)f->positions->tuples));
  }
  return index;
}

int mcor_find_given(mcor_finder* f, const char* words, const char* name, int components)
{
  int index = mcor_find_by_name(f, name);
  index =
    index < 0 && components != 1 && strcmp(name, "Velocity") == 0 ? mcor_join_velocity(f) : index;
  index = mcor_check_named(f, words, name, index);
  const int has = index < 0 ? 0 : mcor_named_of(f, index)->components;
  return index < 0 || components != 1 || has == 1
    ? index
    : mcor_refuse(f, mcor_say(MCOR_SAY(ARRAY_OF_VECTORS), mcor_called(f, words, name), has));
}

/* Takes the array that the caller names for a role or, without a name, the array that was found for
 * the role before. Writes its index and view to f->found. words: what the array is for, in an error
 * sentence. Returns whether there is an array. */
static bool mcor_take_role(mcor_finder* f, mcor_role role, const char* words, int components)
{
  const char* name = mcor_given_name(f, role);
  int* which = &f->found->which[role];
  *which = name ? mcor_find_given(f, words, name, components) : *which;
  if (*which >= 0)
  {
    f->found->views[role] = mcor_view_of(f, *which);
  }
  return *which >= 0;
}

/* Returns the message that there is no smoothing length. The message may suggest a length. */
static mcor_message mcor_no_length(mcor_finder* f)
{
  const int64_t count = f->positions->tuples;
  const int spacing = mcor_find_named(f->arrays, f->count, MCOR_SPACING, 1, count);
  bool has_rhop = false, has_idp = false;
  mcor_findings range = mcor_no_findings();
  for (int i = 0; i < f->count; ++i)
  {
    has_rhop = has_rhop || mcor_is_usual_name(f->arrays[i].name, "rhop");
    has_idp = has_idp || mcor_is_usual_name(f->arrays[i].name, "idp");
  }
  if (spacing >= 0)
  {
    const mcor_array distances = mcor_view_of(f, spacing);
    range = mcor_find_range(NULL, &distances, NULL, MCOR_SKIP_ABSENT, count, 0);
  }
  const double apart = range.least[0];
  const char* usual = apart > 0 && apart == range.most[0]
    ? mcor_own(f,
        mcor_text(" By '%s', particles are %g apart: %g is usual.", f->arrays[spacing].name, apart,
          1.3 * apart))
    : NULL;
  return mcor_say(MCOR_SAY(NO_SMOOTHING_LENGTH),
    has_rhop && has_idp
      ? " DualSPHysics does not store it: it is coefh x sqrt(3) x dp (in the program --coefh "
        "and --dp)."
      : "",
    usual ? usual : "", mcor_names_of(f));
}

/* Sets the view of a quantity to the value or the array that the caller gives, else, if
 * request->find is set, to an array with a usual name. A missing smoothing length is an error,
 * except in a call that only lists arrays. */
static void mcor_find_quantity(mcor_finder* f, mcor_role role)
{
  static const char* const words[MCOR_ROLE_VALUES] = { "smoothing length", "volume", "mass",
    "density" };
  const mcor_request* r = f->request;
  mcor_array* view = &f->found->views[role];
  view->constant = r->values[role];
  if (view->constant == 0)
  {
    f->found->which[role] = r->find
      ? mcor_find_named(f->arrays, f->count, (mcor_quantity)role, 1, f->positions->tuples)
      : -1;
    mcor_take_role(f, role, words[role], 1);
  }
  if (role == MCOR_ROLE_SMOOTHING_LENGTH && !(r->wants & MCOR_WANT_LIST) && !mcor_is_given(view))
  {
    mcor_refuse(f, mcor_no_length(f));
  }
}

/* Bits of quantities, which tell what is given, known or used. */
enum
{
  MCOR_THE_LENGTH = 1 << MCOR_ROLE_SMOOTHING_LENGTH,
  MCOR_THE_VOLUME = 1 << MCOR_ROLE_VOLUME,
  MCOR_THE_MASS = 1 << MCOR_ROLE_MASS,
  MCOR_THE_DENSITY = 1 << MCOR_ROLE_DENSITY,
  MCOR_MASS_AND_DENSITY = MCOR_THE_MASS | MCOR_THE_DENSITY
};

/* Returns from which quantities (bits MCOR_THE_VOLUME and others) volumes come: from volumes, from
 * mass and density, or from masses alone, with computed densities. Returns 0 if volumes are
 * request->particle_volume or, without masses, computed. given: what the caller names or sets;
 * known: what is given or found. Volumes that are found stay in use, unless the caller gives both
 * mass and density, or wants computed volumes. */
static unsigned mcor_choose_volumes(const mcor_request* request, unsigned given, unsigned known)
{
  const bool has_both = (known & MCOR_MASS_AND_DENSITY) == MCOR_MASS_AND_DENSITY,
             gives_both = (given & MCOR_MASS_AND_DENSITY) == MCOR_MASS_AND_DENSITY;
  return request->compute_volumes                                           ? known & MCOR_THE_MASS
    : (known & MCOR_THE_VOLUME) && (given & MCOR_THE_VOLUME || !gives_both) ? MCOR_THE_VOLUME
    : has_both                                                              ? MCOR_MASS_AND_DENSITY
    : request->particle_volume > 0                                          ? 0
                                                                            : known & MCOR_THE_MASS;
}

/* Returns a message about quantities that the caller gives, but that are not used. volumes: the
 * name of the array of volumes that is used, or NULL. */
static mcor_message mcor_describe_unused(
  const mcor_request* request, unsigned given, unsigned used, const char* volumes)
{
  const unsigned idle = given & ~used & (MCOR_THE_VOLUME | MCOR_MASS_AND_DENSITY);
  const char* words = idle & MCOR_THE_VOLUME ? "volume is"
    : idle == MCOR_MASS_AND_DENSITY          ? "mass and density are"
    : idle == MCOR_THE_MASS                  ? "mass is"
                                             : "density is";
  return request->estimate_smoothing_length && (given & MCOR_THE_LENGTH)
    ? mcor_say(MCOR_SAY(LENGTH_IN_VAIN))
    : idle == 0 ? MCOR_NO_MESSAGE
    : used == MCOR_THE_MASS && !request->compute_volumes
    ? mcor_say(MCOR_SAY(SIZE_BESIDE_MASS), words)
    : request->compute_volumes       ? mcor_say(MCOR_SAY(SIZE_BESIDE_COMPUTED), words)
    : used & given & MCOR_THE_VOLUME ? mcor_say(MCOR_SAY(SIZE_BESIDE_VOLUME), words)
    : used & MCOR_THE_VOLUME ? mcor_say(MCOR_SAY(SIZE_BESIDE_ARRAY), words, volumes ? volumes : "")
    : request->particle_volume > 0 ? mcor_say(MCOR_SAY(SIZE_BESIDE_ONE_VOLUME), words)
                                   : mcor_say(MCOR_SAY(DENSITY_WITHOUT_MASS), words);
}

/* A scalar of this name is summed from masses if no array has this name. */
#define MCOR_SUMMED "Density"

static bool mcor_is_summed(const mcor_finder* f)
{
  const char* name = mcor_given_name(f, MCOR_ROLE_SCALAR);
  return name && strcmp(name, MCOR_SUMMED) == 0 && mcor_find_by_name(f, name) < 0;
}

static void mcor_find_sizes(mcor_finder* f)
{
  const mcor_request* r = f->request;
  mcor_input* input = &f->found->input;
  const mcor_array* views = f->found->views;
  unsigned given = 0, known = 0;
  for (int role = 0; role < MCOR_ROLE_VALUES; ++role)
  {
    if (role != MCOR_ROLE_SMOOTHING_LENGTH || !r->estimate_smoothing_length)
    {
      mcor_find_quantity(f, (mcor_role)role);
    }
    given |= r->values[role] != 0 || mcor_given_name(f, (mcor_role)role) ? 1u << role : 0;
    known |= mcor_is_given(&views[role]) ? 1u << role : 0;
  }
  const unsigned used = mcor_choose_volumes(r, given, known);
  f->uses |= used | MCOR_THE_LENGTH;
  input->smoothing_length_is_support_radius = r->smoothing_length_is_support_radius != 0;
  input->estimate_smoothing_length = r->estimate_smoothing_length != 0;
  f->found->needs_lengths = r->estimate_smoothing_length && r->lengths_by_neighbours;
  input->smoothing_length = views[MCOR_ROLE_SMOOTHING_LENGTH];
  input->volume = used & MCOR_THE_VOLUME ? views[MCOR_ROLE_VOLUME] : (mcor_array){ 0 };
  input->mass = used & MCOR_THE_MASS ? views[MCOR_ROLE_MASS] : (mcor_array){ 0 };
  input->density = used & MCOR_THE_DENSITY ? views[MCOR_ROLE_DENSITY] : (mcor_array){ 0 };
  input->volume.constant =
    used == 0 && !r->compute_volumes ? r->particle_volume : input->volume.constant;
  const bool is_density =
    (r->wants & MCOR_WANT_COLUMN) != 0 && !mcor_given_name(f, MCOR_ROLE_SCALAR);
  /* Quantities that give no volumes may have another use. A flux uses densities or, without these,
   * masses. A projection without a scalar sums masses, and needs volumes only for a mean with
   * weights; without masses it integrates densities. Masses may be these weights, too. */
  const char *weight = mcor_given_name(f, MCOR_ROLE_WEIGHT),
             *mass = mcor_given_name(f, MCOR_ROLE_MASS);
  const bool is_flow = (r->wants & MCOR_WANT_FLOW) != 0;
  const bool is_sum = f->found->needs_densities || (weight && mass && strcmp(weight, mass) == 0);
  const bool is_mass = is_density && (known & MCOR_THE_MASS) != 0;
  const unsigned density = known & MCOR_THE_DENSITY ? MCOR_THE_DENSITY : MCOR_THE_MASS;
  const unsigned also = is_sum || is_mass ? MCOR_THE_MASS : is_flow || is_density ? density : 0;
  if (!(r->wants & MCOR_WANT_LIST))
  {
    f->found->unused = mcor_describe_unused(
      r, given, is_mass && !weight ? also : used | also, views[MCOR_ROLE_VOLUME].name);
  }
}

/* Returns the index of the array to contour if the caller names none; -1: there is none. All ranks
 * call this function together. */
static int mcor_choose_scalar(mcor_finder* f)
{
  const int active = f->request->active;
  const int best = mcor_choose_view(f->arrays, f->count, active, f->ranks);
  if (best >= 0 && best == active)
  {
    return best;
  }
  const int joined = mcor_join_velocity(f);
  return joined >= 0 ? joined : best >= 0 ? best : active < f->count ? active : -1;
}

static void mcor_add_attribute(mcor_finder* f, int index, mcor_array view)
{
  mcor_found* found = f->found;
  const int at = found->input.attribute_count++;
  ((mcor_array*)found->input.attributes)[at] = view;
  found->attributes[at] = index;
}

/* Sets the scalar, its component and, if is_dot, the second vector of a dot product. Sets the error
 * if the component does not exist, or if the vectors have different numbers of components. */
static void mcor_keep_scalar(mcor_finder* f, mcor_array view, bool is_column, bool is_dot)
{
  mcor_found* found = f->found;
  mcor_input* input = &found->input;
  const char* name = view.name ? view.name : "";
  const int component = f->request->scalar_component;
  found->views[MCOR_ROLE_SCALAR] = input->scalar = view;
  input->scalar_component = view.components <= 1 ? 0
    : is_column && component < MCOR_MAGNITUDE    ? MCOR_MAGNITUDE
                                                 : component;
  if (is_dot && mcor_take_role(f, MCOR_ROLE_SCALAR_DOT, "second vector of the dot product", 0))
  {
    input->scalar_dot = found->views[MCOR_ROLE_SCALAR_DOT];
    if (view.components != input->scalar_dot.components)
    {
      mcor_refuse(f,
        mcor_say(MCOR_SAY(DOT_OF_DIFFERENT_VECTORS), name, view.components,
          mcor_given_name(f, MCOR_ROLE_SCALAR_DOT), input->scalar_dot.components));
    }
  }
  else if (view.components > 1 &&
    (input->scalar_component < MCOR_MAGNITUDE || component >= view.components))
  {
    mcor_refuse(f,
      mcor_say(MCOR_SAY(NO_SUCH_COMPONENT), mcor_called(f, "scalar", name), component,
        view.components - 1));
  }
}

/* Finds the array that the call is about: the scalar to contour, the scalar of a projection (which
 * may have none), or the attribute whose derivatives are wanted. */
static void mcor_find_scalar(mcor_finder* f, bool contours)
{
  const char *name = mcor_given_name(f, MCOR_ROLE_SCALAR),
             *dot = contours ? mcor_given_name(f, MCOR_ROLE_SCALAR_DOT) : NULL;
  const int is_off = f->request->not_on_points & 1 << MCOR_ROLE_SCALAR,
            dot_is_off = contours ? f->request->not_on_points & 1 << MCOR_ROLE_SCALAR_DOT : 0;
  const bool is_column = (f->request->wants & MCOR_WANT_COLUMN) != 0;
  int* const which = &f->found->which[MCOR_ROLE_SCALAR];
  if (!name && is_column)
  {
    return;
  }
  if (!name && *which < 0)
  {
    mcor_refuse(f,
      contours ? mcor_say(MCOR_SAY(NO_SCALAR), mcor_names_of(f))
               : mcor_say(MCOR_SAY(NO_ARRAY), mcor_names_of(f)));
    return;
  }
  if (is_off || dot_is_off)
  {
    const char* array = is_off ? name : dot;
    array = array ? array : "";
    mcor_refuse(f,
      contours ? mcor_say(MCOR_SAY(SCALAR_NOT_ON_POINTS), array, mcor_names_of(f))
               : mcor_say(MCOR_SAY(ARRAY_NOT_ON_POINTS), array, mcor_names_of(f)));
    return;
  }
  if ((contours || is_column) && mcor_is_summed(f))
  {
    f->found->needs_densities = 1;
    return;
  }
  const char* words = contours ? "scalar" : is_column ? "projection" : "derivatives";
  *which = name ? mcor_find_given(f, words, name, 0) : mcor_check_named(f, words, "", *which);
  if (*which >= 0 && (contours || is_column))
  {
    mcor_keep_scalar(f, mcor_view_of(f, *which), is_column, dot != NULL);
  }
  else if (*which >= 0)
  {
    mcor_add_attribute(f, *which, mcor_view_of(f, *which));
  }
}

/* Finds the masses of a projection or, without masses, the densities; and the weight of a mean. */
static void mcor_find_column(mcor_finder* f)
{
  const mcor_array* views = f->found->views;
  if (mcor_is_given(&views[MCOR_ROLE_MASS]))
  {
    f->found->input.mass = views[MCOR_ROLE_MASS];
    f->uses |= MCOR_THE_MASS;
  }
  else if (mcor_is_given(&views[MCOR_ROLE_DENSITY]))
  {
    f->found->input.density = views[MCOR_ROLE_DENSITY];
    f->uses |= MCOR_THE_DENSITY;
  }
  mcor_take_role(f, MCOR_ROLE_WEIGHT, "weight", 1);
}

/* Returns the index of the velocities, which are found by their usual names: an array of three
 * components, else vx, vy and vz, else an array of two components; -1: there are none. */
static int mcor_find_velocity(mcor_finder* f)
{
  const int64_t count = f->positions->tuples;
  int index = mcor_find_named(f->arrays, f->count, MCOR_VELOCITY, 3, count);
  index = index < 0 ? mcor_join_velocity(f) : index;
  return index < 0 ? mcor_find_named(f->arrays, f->count, MCOR_VELOCITY, 2, count) : index;
}

/* Adds the velocity and, if it is known, the density to the attributes. The density is an array or
 * one value, else mass / volume. */
static void mcor_find_flow(mcor_finder* f)
{
  mcor_found* found = f->found;
  const mcor_array *views = found->views, *mass = &views[MCOR_ROLE_MASS],
                   *volume = &found->input.volume;
  if (!mcor_take_role(f, MCOR_ROLE_VELOCITY, "velocity", 0))
  {
    mcor_refuse(f, mcor_say(MCOR_SAY(NO_VELOCITY), mcor_names_of(f)));
    return;
  }
  mcor_add_attribute(f, found->which[MCOR_ROLE_VELOCITY], views[MCOR_ROLE_VELOCITY]);
  if (mcor_is_given(&views[MCOR_ROLE_DENSITY]))
  {
    f->uses |= MCOR_THE_DENSITY;
    mcor_add_attribute(f, found->which[MCOR_ROLE_DENSITY], views[MCOR_ROLE_DENSITY]);
  }
  else if (mcor_is_given(mass) && mcor_is_given(volume))
  {
    const int64_t count = f->positions->tuples;
    double* divided = mcor_find_memory(f, (size_t)count * sizeof *divided);
    for (int64_t i = 0; divided && i < count; ++i)
    {
      divided[i] = mcor_array_at(mass, i, 0) / mcor_array_at(volume, i, 0);
    }
    f->uses |= MCOR_THE_MASS;
    found->made[1] = (mcor_named){ "Density", MCOR_ELEMENT_FLOAT64, 1, count, divided, { 0, 0 } };
    mcor_add_attribute(f, f->count + 1, mcor_view_of(f, f->count + 1));
  }
}

/* Whether a list, which has one name on each line, has this name. */
static bool mcor_is_listed(const char* list, const char* name)
{
  const size_t length = strlen(name);
  for (const char* at = list; at; at = strchr(at, '\n'))
  {
    at += *at == '\n';
    if (strncmp(at, name, length) == 0 && (at[length] == '\n' || at[length] == '\0'))
    {
      return true;
    }
  }
  return false;
}

/* Sets the name of what is contoured, and of the array of iso values. */
static void mcor_name_scalar(mcor_finder* f)
{
  mcor_found* found = f->found;
  const mcor_array *scalar = &found->views[MCOR_ROLE_SCALAR],
                   *dot = &found->views[MCOR_ROLE_SCALAR_DOT];
  const int component = found->input.scalar_component;
  const char *label = f->request->label, *name = scalar->name ? scalar->name : "";
  const char* full = found->scalar_name = mcor_own(f,
    found->needs_densities      ? mcor_text(MCOR_SUMMED)
      : dot->data               ? mcor_text("%s_Dot_%s", name, dot->name ? dot->name : "")
      : scalar->components <= 1 ? mcor_text("%s", name)
      : component < 0           ? mcor_text("%s_Magnitude", name)
      : label                   ? mcor_text("%s_%s", name, label)
      : scalar->components <= 3 ? mcor_text("%s_%c", name, "XYZ"[component])
                                : mcor_text("%s_%d", name, component));
  found->iso_value_name =
    full && *full && !f->request->filled && !mcor_is_listed(f->request->taken, full) ? full
                                                                                     : "IsoValue";
}

/* Returns whether the surface gets an array of the particles. Ghost marks are left out, because
 * they would hide triangles. Also left out are marks of wall blocks, names that the request has
 * taken or excluded, and the name of the array of iso values. */
static bool mcor_is_carried(const mcor_finder* f, const mcor_named* a)
{
  return a->name && *a->name && strcmp(a->name, "vtkGhostType") != 0 &&
    strcmp(a->name, MCOR_WALL_BLOCK) != 0 && a->tuples == f->positions->tuples &&
    !mcor_is_listed(f->request->taken, a->name) && !mcor_is_listed(f->request->excluded, a->name) &&
    !(f->request->has_iso_values && strcmp(a->name, f->found->iso_value_name) == 0);
}

/* Floats and doubles that the surface gets become attributes. Arrays of other types cannot be
 * interpolated: they are listed in found->nearest, and each point gets the nearest particle's
 * value. */
static void mcor_find_attributes(mcor_finder* f)
{
  for (int i = 0; i <= (mcor_join_velocity(f) < 0 ? f->count - 1 : f->count); ++i)
  {
    const mcor_named* a = mcor_named_of(f, i);
    if (mcor_is_carried(f, a) && a->type <= MCOR_ELEMENT_FLOAT64)
    {
      mcor_add_attribute(f, i, mcor_view_of(f, i));
    }
    else if (mcor_is_carried(f, a))
    {
      f->found->nearest[f->found->nearest_count++] = i;
    }
  }
}

mcor_status mcor_find_input(const mcor_request* request, const mcor_named* positions,
  const mcor_named* arrays, int count, const mcor_ranks* ranks, mcor_found* found)
{
  mcor_finder f = { .request = request,
    .positions = positions,
    .arrays = arrays,
    .count = count,
    .ranks = ranks,
    .found = found };
  const unsigned wants = request->wants;
  *found = (mcor_found){ .input.count = positions->tuples, .fluid_count = positions->tuples };
  memset(found->which, -1, sizeof found->which);
  const size_t most = (size_t)count + 2;
  f.views = mcor_find_memory(&f, most * sizeof *f.views);
  mcor_array* attributes = mcor_find_memory(&f, most * sizeof *attributes);
  found->attributes = mcor_find_memory(&f, most * sizeof(int));
  found->nearest = mcor_find_memory(&f, most * sizeof(int));
  if (f.lacks_memory)
  {
    return MCOR_OUT_OF_CAPACITY;
  }
  memset(f.views, 0, most * sizeof *f.views);
  found->input.attributes = attributes;
  found->input.positions = mcor_view_named(&f, positions);
  found->input.positions.name = NULL;
  mcor_find_fluid(&f);
  const bool contours = (wants & MCOR_WANT_SCALAR) && !request->free_surface;
  if ((contours || (wants & MCOR_WANT_ARRAY)) && !mcor_given_name(&f, MCOR_ROLE_SCALAR))
  {
    found->which[MCOR_ROLE_SCALAR] = mcor_choose_scalar(&f);
  }
  if (wants & (MCOR_WANT_FLOW | MCOR_WANT_LIST))
  {
    found->which[MCOR_ROLE_VELOCITY] = mcor_find_velocity(&f);
    found->which[MCOR_ROLE_ID] =
      mcor_find_named(arrays, count, MCOR_PARTICLE_ID, 1, positions->tuples);
  }
  /* From here on, ranks do not exchange anything. */
  if (contours || (wants & (MCOR_WANT_ARRAY | MCOR_WANT_COLUMN)))
  {
    mcor_find_scalar(&f, contours);
  }
  if (wants & MCOR_WANT_SIZES)
  {
    mcor_find_sizes(&f);
  }
  mcor_mark_particles(&f);
  if (wants & MCOR_WANT_FLOW)
  {
    mcor_find_flow(&f);
  }
  if (wants & MCOR_WANT_COLUMN)
  {
    mcor_find_column(&f);
  }
  if (!mcor_has_error(&f))
  {
    mcor_name_scalar(&f);
  }
  if (wants & MCOR_WANT_ATTRIBUTES && !mcor_has_error(&f))
  {
    mcor_find_attributes(&f);
  }
  for (int role = 0; role < MCOR_ROLE_VALUES; ++role)
  {
    found->which[role] = f.uses & 1u << role ? found->which[role] : -1;
  }
  return f.lacks_memory  ? MCOR_OUT_OF_CAPACITY
    : mcor_has_error(&f) ? MCOR_INVALID_ARGUMENT
                         : MCOR_OK;
}

void mcor_free_found(mcor_found* found)
{
  for (int i = 0; found && i < found->own_count; ++i)
  {
    free(found->own[i]);
  }
  if (found)
  {
    free(found->own);
    mcor_free_message(&found->error);
    mcor_free_message(&found->unused_type);
    mcor_free_message(&found->unused);
    *found = (mcor_found){ 0 };
  }
}

void mcor_take_lengths(mcor_found* found, const double* lengths)
{
  mcor_input* input = &found->input;
  input->smoothing_length = (mcor_array){
    .data = lengths, .type = MCOR_FLOAT64, .components = 1, .name = "SmoothingLength"
  };
  input->estimate_smoothing_length = input->smoothing_length_is_support_radius = 0;
}

void mcor_take_densities(mcor_found* found, const double* densities)
{
  mcor_input* input = &found->input;
  const mcor_array *mass = &found->views[MCOR_ROLE_MASS],
                   view = {
                     .data = densities, .type = MCOR_FLOAT64, .components = 1, .name = MCOR_SUMMED
                   };
  input->scalar = found->views[MCOR_ROLE_SCALAR] = view;
  input->scalar_component = 0;
  if (mcor_is_given(mass) && !mcor_is_given(&found->views[MCOR_ROLE_DENSITY]) &&
    !mcor_is_given(&found->views[MCOR_ROLE_VOLUME]))
  {
    input->volume = (mcor_array){ 0 };
    input->mass = *mass;
    input->density = view;
  }
}
