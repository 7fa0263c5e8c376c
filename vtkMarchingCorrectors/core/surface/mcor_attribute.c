/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Other particle arrays at the surface's points [III-D.4]. Of the components that vary, the first
 * MCOR_ATTRIBUTE_LIMIT are evaluated along with the correction, where each vertex's particles are
 * at hand; the rest, as many at a time, at the finished mesh's vertices. A mean of equal values,
 * often masses or smoothing lengths, is that value. */

#include "mcor_adaptive.h"
#include "mcor_input.h"
#include "mcor_parallel.h"

#include <math.h>
#include <stdlib.h>

/* The power of 2 that brings the largest value of a component to 1 or a little less, so that no sum
 * overflows whatever the device's precision. */
static double mcor_component_scale(double largest)
{
  int exponent = 0;
  frexp(largest, &exponent);
  return ldexp(1, exponent > -1000 ? -exponent : 1000);
}

/* Lists the components of an attribute that vary; *next of the globals' components is its first. */
static void mcor_list_varying(
  mcor_context* context, const mcor_input* input, int a, int* next, int64_t* not_finite)
{
  mcor_attributes* attributes = &context->attributes;
  const mcor_globals* globals = context->run.options->globals;
  const mcor_array* array = &input->attributes[a];
  *not_finite = globals ? globals->components[*next].not_finite
                        : mcor_find_not_finite(array, input->solid, input->count);
  for (int c = 0; c < mcor_components(array); ++c, ++*next)
  {
    mcor_global_component found = { 0 };
    if (globals)
    {
      found = globals->components[*next];
    }
    else if (*not_finite < 0)
    {
      mcor_measure_component(input, a, c, &found);
    }
    if (*not_finite < 0 && found.varies)
    {
      attributes->varying[attributes->varying_count++] = (mcor_component){
        .attribute = a, .component = c, .scale = mcor_component_scale(found.largest)
      };
    }
  }
}

size_t mcor_count_components(const mcor_input* input)
{
  size_t count = 0;
  for (int a = 0; a < input->attribute_count; ++a)
  {
    count += (size_t)mcor_components(&input->attributes[a]);
  }
  return count;
}

/* Room to list components in; none is listed. */
static mcor_status mcor_clear_components(mcor_context* context, const mcor_input* input)
{
  mcor_attributes* attributes = &context->attributes;
  const size_t most = mcor_count_components(input) + 1;
  free(attributes->varying);
  attributes->kept = 0;
  attributes->varying_count = attributes->count = 0;
  attributes->varying = malloc(most * sizeof *attributes->varying);
  MCOR_TRY(mcor_allocated(context, attributes->varying));
  return MCOR_OK;
}

static mcor_status mcor_check_components(mcor_context* context, const mcor_input* input)
{
  const mcor_globals* globals = context->run.options->globals;
  const int components = (int)mcor_count_components(input);
  MCOR_RETURN_IF(globals && globals->component_count != components, context, MCOR_INVALID_ARGUMENT,
    "options.globals was measured for %d components of attributes, but the input has %d.",
    globals->component_count, components);
  return MCOR_OK;
}

/* Prepares the surface's attributes: finds those to leave out, and of the others the components that vary. */
mcor_status mcor_list_attributes(
  mcor_context* context, const mcor_input* input, mcor_surface* surface)
{
  const size_t count = (size_t)input->attribute_count;
  surface->attribute_count = input->attribute_count;
  surface->attributes = calloc(count + 1, sizeof(double*));
  surface->attribute_not_finite = calloc(count + 1, sizeof(int64_t));
  MCOR_TRY(mcor_allocated(context, surface->attributes && surface->attribute_not_finite));
  MCOR_TRY(mcor_clear_components(context, input));
  MCOR_TRY(mcor_check_components(context, input));
  int next = 0;
  for (int a = 0; a < input->attribute_count; ++a)
  {
    mcor_list_varying(context, input, a, &next, &surface->attribute_not_finite[a]);
  }
  return MCOR_OK;
}

static mcor_component mcor_scale_component(
  int attribute, int component, const mcor_global_component* found)
{
  const double low = found->low, high = found->high, half = 0.5 * high - 0.5 * low;
  int exponent = 0;
  frexp(half, &exponent);
  return (mcor_component){ .attribute = attribute,
    .component = component,
    .shift = 0.5 * high + 0.5 * low,
    .scale = half > 0 ? ldexp(1, exponent > -1000 ? -exponent : 1000) : 1,
    .low = low,
    .high = high };
}

/* Finds the attributes to leave out, and of the others all components, with the shift and scale that
 * bring them to [-1, 1]. not_finite: [attribute_count], as in mcor_samples. */
mcor_status mcor_list_components(
  mcor_context* context, const mcor_input* input, int64_t* not_finite)
{
  mcor_attributes* attributes = &context->attributes;
  MCOR_TRY(mcor_clear_components(context, input));
  MCOR_TRY(mcor_check_components(context, input));
  const mcor_globals* globals = context->run.options->globals;
  int next = 0;
  for (int a = 0; a < input->attribute_count; ++a)
  {
    const mcor_array* array = &input->attributes[a];
    not_finite[a] = globals ? globals->components[next].not_finite
                            : mcor_find_not_finite(array, input->solid, input->count);
    for (int c = 0; c < mcor_components(array); ++c, ++next)
    {
      if (not_finite[a] < 0)
      {
        mcor_global_component found;
        if (globals)
        {
          found = globals->components[next];
        }
        else
        {
          mcor_measure_component(input, a, c, &found);
        }
        attributes->varying[attributes->varying_count++] = mcor_scale_component(a, c, &found);
      }
    }
  }
  return MCOR_OK;
}

/* Whether something is left to be evaluated at the finished mesh's vertices. */
bool mcor_attributes_remain(const mcor_context* context)
{
  return context->run.options->nearest_particle ||
    context->attributes.varying_count > MCOR_ATTRIBUTE_LIMIT;
}

/* Takes up to MCOR_ATTRIBUTE_LIMIT of the components that vary to the device, from number `first`
 * on. */
mcor_status mcor_load_attributes(mcor_context* context, const mcor_input* input, int first)
{
  mcor_attributes* attributes = &context->attributes;
  const int rest = attributes->varying_count - first;
  attributes->first = first;
  attributes->count = rest < MCOR_ATTRIBUTE_LIMIT ? rest : MCOR_ATTRIBUTE_LIMIT;
  const int stride = context->grid.count;
  MCOR_TRY(mcor_reserve(context, &attributes->sorted,
    (size_t)attributes->count * (size_t)stride * context->cl.real_size));
  for (int i = 0; i < attributes->count; ++i)
  {
    const mcor_component* c = &attributes->varying[first + i];
    MCOR_TRY(mcor_sort_values(context, input, &input->attributes[c->attribute], c->component,
      c->shift, c->scale, false, &attributes->sorted, i));
  }
  mcor_release(context, &context->stage.values);
  return MCOR_OK;
}

/* Component c of those on the device, from the vertices put out to every `width`-th
 * element. */
typedef struct mcor_means
{
  const mcor_context* context;
  const cl_int* scanned;
  const void* values;
  int c, width;
  double scale;
  double* to;
} mcor_means;

static void mcor_store_means(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_means* m = data;
  const int count = m->context->attributes.count;
  for (int64_t v = first; v < last; ++v)
  {
    if (mcor_is_output(m->scanned, v))
    {
      m->to[m->scanned[v] * (int64_t)m->width] =
        mcor_get_real(m->context, m->values, v * count + m->c) / m->scale;
    }
  }
  (void)slice;
}

/* Hands over the means of the components on the device. */
static mcor_status mcor_store_attributes(
  mcor_context* context, const mcor_input* input, const cl_int* scanned, mcor_surface* surface)
{
  const mcor_attributes* attributes = &context->attributes;
  const mcor_buffer* means = &context->mesh.means;
  const int vertices = context->mesh.vertex_count;
  void* view;
  MCOR_TRY(mcor_map(context, means,
    (size_t)vertices * (size_t)attributes->count * context->cl.real_size, false, &view));
  mcor_status status = MCOR_OK;
  for (int c = 0; c < attributes->count && status == MCOR_OK; ++c)
  {
    const mcor_component* component = &attributes->varying[attributes->first + c];
    const int width = mcor_components(&input->attributes[component->attribute]);
    double* to = surface->attributes[component->attribute] + surface->point_count * width +
      component->component;
    mcor_means job = { context, scanned, view, c, width, component->scale, to };
    status = mcor_parallel_run(context, vertices, MCOR_LIGHT_GRAIN, mcor_store_means, &job, NULL);
  }
  MCOR_TRY(mcor_unmap(context, means, &view));
  return status;
}

/* Hands over the components that do not vary: all that are not in the list, which has them in the
 * order of the arrays. */
static void mcor_store_constants(
  const mcor_context* context, const mcor_input* input, int64_t points, mcor_surface* surface)
{
  const mcor_attributes* attributes = &context->attributes;
  int next = 0;
  for (int a = 0; a < input->attribute_count; ++a)
  {
    const mcor_array* array = &input->attributes[a];
    const int width = mcor_components(array);
    for (int c = 0; c < width && surface->attributes[a]; ++c)
    {
      if (next < attributes->varying_count && attributes->varying[next].attribute == a &&
        attributes->varying[next].component == c)
      {
        ++next;
        continue;
      }
      const double value = mcor_array_at(array, 0, c);
      double* to = surface->attributes[a] + surface->point_count * width + c;
      for (int64_t i = 0; i < points; ++i)
      {
        to[i * width] = value;
      }
    }
  }
}

/* Launches something for all groups of vertices. */
typedef mcor_status (*mcor_group_body)(mcor_context* context, int groups);

static mcor_status mcor_launch_groups(mcor_context* context, mcor_group_body launch)
{
  for (int l = 0; l <= context->lattice.top; ++l)
  {
    MCOR_TRY(mcor_view_level(context, l));
    for (int boundary = 0; boundary < 2; ++boundary)
    {
      int first, count, groups;
      mcor_level_vertices(context, boundary, l, &first, &count);
      MCOR_TRY(mcor_make_groups(context, &context->mesh.node, first, count, &groups));
      MCOR_TRY(launch(context, groups));
    }
  }
  return mcor_view_level(context, 0);
}

/* Evaluates the components on the device at vertices. */
static mcor_status mcor_launch_means(mcor_context* context, int groups)
{
  const mcor_mesh* mesh = &context->mesh;
  return MCOR_LAUNCH(context, "mcor_attribute_means", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_INT(groups), MCOR_BUFFER(&context->points.groups), MCOR_BUFFER(&mesh->node),
    MCOR_BUFFER(&mesh->offset), MCOR_ATTRIBUTE_ARGS(context, &mesh->means));
}

static mcor_status mcor_launch_nearest(mcor_context* context, int groups)
{
  const mcor_mesh* mesh = &context->mesh;
  return MCOR_LAUNCH(context, "mcor_attribute_nearest", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_INT(groups), MCOR_BUFFER(&context->points.groups), MCOR_BUFFER(&mesh->node),
    MCOR_BUFFER(&mesh->offset),
    MCOR_INT(context->measure.support_min == context->measure.support_max),
    MCOR_BUFFER(&context->grid.order), MCOR_BUFFER(&context->attributes.nearest));
}

typedef struct mcor_nearest
{
  const mcor_context* context;
  const cl_int *scanned, *index;
  int64_t* to;
} mcor_nearest;

static void mcor_store_nearest(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_nearest* job = data;
  for (int64_t v = first; v < last; ++v)
  {
    if (mcor_is_output(job->scanned, v))
    {
      job->to[job->scanned[v]] =
        job->index[v] < 0 ? -1 : mcor_source_of(job->context, job->index[v]);
    }
  }
  (void)slice;
}

static mcor_status mcor_add_nearest(
  mcor_context* context, const cl_int* scanned, mcor_surface* surface)
{
  const mcor_mesh* mesh = &context->mesh;
  mcor_buffer* indices = &context->attributes.nearest;
  const size_t bytes = (size_t)mesh->vertex_count * sizeof(cl_int);
  MCOR_TRY(mcor_reserve(context, indices, bytes));
  MCOR_TRY(mcor_launch_groups(context, mcor_launch_nearest));
  void* view;
  MCOR_TRY(mcor_map(context, indices, bytes, false, &view));
  mcor_nearest job = { context, scanned, view, surface->nearest_particle + surface->point_count };
  const mcor_status status = mcor_parallel_run(
    context, mesh->vertex_count, MCOR_LIGHT_GRAIN, mcor_store_nearest, &job, NULL);
  MCOR_TRY(mcor_unmap(context, indices, &view));
  return status;
}

/* Of the vertices that are put out, see mcor_is_output. */
mcor_status mcor_add_attributes(
  mcor_context* context, const mcor_input* input, const cl_int* scanned, mcor_surface* surface)
{
  const mcor_mesh* mesh = &context->mesh;
  mcor_buffer* means = &context->mesh.means;
  const int varying = context->attributes.varying_count;
  mcor_store_constants(context, input, scanned[mesh->vertex_count], surface);
  if (varying > 0)
  {
    MCOR_TRY(mcor_store_attributes(context, input, scanned, surface));
  }
  if (context->run.options->nearest_particle)
  {
    MCOR_TRY(mcor_add_nearest(context, scanned, surface));
  }
  for (int first = MCOR_ATTRIBUTE_LIMIT; first < varying; first += MCOR_ATTRIBUTE_LIMIT)
  {
    MCOR_TRY(mcor_load_attributes(context, input, first));
    MCOR_TRY(mcor_reserve(context, means,
      (size_t)mesh->vertex_count * (size_t)context->attributes.count * context->cl.real_size));
    MCOR_TRY(mcor_launch_groups(context, mcor_launch_means));
    MCOR_TRY(mcor_store_attributes(context, input, scanned, surface));
  }
  return MCOR_OK;
}

void mcor_release_attributes(mcor_context* context)
{
  mcor_attributes* attributes = &context->attributes;
  MCOR_RELEASE(context, &attributes->sorted, &attributes->nearest);
  attributes->kept = 0;
}
