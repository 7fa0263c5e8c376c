/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Other particle arrays at the surface's points [III-D.4]. Of the components that vary, the first
 * MCOR_ATTRIBUTE_LIMIT are evaluated along with the correction, where each vertex's particles are at
 * hand; the rest, as many at a time, at the finished mesh's vertices. A mean of equal values, often
 * masses or smoothing lengths, is that value. */

#include "mcor_input.h"
#include "mcor_parallel.h"

#include <math.h>

/* The power of 2 that brings the largest value of a component to 1 or a little less, so that no sum
 * overflows whatever the device's precision. */
static double mcor_component_scale(const mcor_array* array, int64_t count, int component)
{
  int exponent = 0;
  frexp(mcor_largest(array, count, component), &exponent);
  return ldexp(1, exponent > -1000 ? -exponent : 1000);
}

static bool mcor_is_constant(const mcor_array* array, int64_t count, int component)
{
  int64_t i = 1;
  while (i < count &&
    mcor_array_at(array, i, component) == mcor_array_at(array, 0, component))
  {
    ++i;
  }
  return i >= count;
}

/* Takes up to MCOR_ATTRIBUTE_LIMIT components to the device, from number `first` of those that vary
 * on. */
mcor_status mcor_load_attributes(mcor_context* context, const mcor_input* input, int first)
{
  mcor_attributes* attributes = &context->attributes;
  int number = 0;
  attributes->count = 0;
  for (int a = 0; a < input->attribute_count; ++a)
  {
    const mcor_array* array = &input->attributes[a];
    for (int c = 0; c < mcor_components(array) && attributes->count < MCOR_ATTRIBUTE_LIMIT; ++c)
    {
      if (!mcor_is_constant(array, input->count, c) && number++ >= first)
      {
        attributes->component[attributes->count++] =
          (mcor_component){ a, c, mcor_component_scale(array, input->count, c) };
      }
    }
  }
  const int stride = context->grid.count;
  MCOR_TRY(mcor_reserve(context, &attributes->sorted,
    (size_t)attributes->count * (size_t)stride * context->cl.real_size));
  for (int i = 0; i < attributes->count; ++i)
  {
    const mcor_component* c = &attributes->component[i];
    MCOR_TRY(mcor_sort_values(context, input, &input->attributes[c->attribute], c->component, 0,
      c->scale, &attributes->sorted, i * stride));
  }
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
  double* to;
} mcor_means;

static void mcor_put_means(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_means* m = data;
  const int count = m->context->attributes.count;
  const double scale = m->context->attributes.component[m->c].scale;
  for (int64_t v = first; v < last; ++v)
  {
    if (mcor_is_put(m->scanned, v))
    {
      m->to[m->scanned[v] * (int64_t)m->width] =
        mcor_get_real(m->context, m->values, v * count + m->c) / scale;
    }
  }
  (void)slice;
}

/* Hands over the means of the components on the device. */
static mcor_status mcor_put_attributes(mcor_context* context, const mcor_input* input,
  const cl_int* scanned, mcor_surface* surface)
{
  const mcor_attributes* attributes = &context->attributes;
  const mcor_buffer* means = &context->mesh.means;
  const int vertices = context->mesh.vertex_count;
  void* view;
  MCOR_TRY(mcor_map(context, means,
    (size_t)vertices * (size_t)attributes->count * context->cl.real_size, false, &view));
  for (int c = 0; c < attributes->count; ++c)
  {
    const mcor_component* component = &attributes->component[c];
    const int width = mcor_components(&input->attributes[component->attribute]);
    double* to = surface->attributes[component->attribute] + surface->point_count * width +
      component->component;
    mcor_means job = { context, scanned, view, c, width, to };
    mcor_parallel_for(vertices, MCOR_LIGHT_GRAIN, mcor_put_means, &job);
  }
  return mcor_unmap(context, means, &view);
}

/* Hands over the components that do not vary; returns how many there are of the others. */
static int mcor_put_constants(
  const mcor_input* input, int64_t points, mcor_surface* surface)
{
  int varying = 0;
  for (int a = 0; a < input->attribute_count; ++a)
  {
    const mcor_array* array = &input->attributes[a];
    const int width = mcor_components(array);
    for (int c = 0; c < width; ++c)
    {
      if (!mcor_is_constant(array, input->count, c))
      {
        ++varying;
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
  return varying;
}

/* Evaluates the components on the device at all vertices. */
static mcor_status mcor_evaluate_attributes(mcor_context* context, int groups)
{
  mcor_mesh* mesh = &context->mesh;
  MCOR_TRY(mcor_reserve(context, &mesh->means,
    (size_t)mesh->vertex_count * (size_t)context->attributes.count * context->cl.real_size));
  return MCOR_LAUNCH(context, "mcor_attribute_means", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_INT(groups), MCOR_BUFFER(&context->groups), MCOR_BUFFER(&mesh->node),
    MCOR_BUFFER(&mesh->offset), MCOR_ATTRIBUTE_ARGS(context, &mesh->means));
}

static mcor_status mcor_add_nearest(
  mcor_context* context, const cl_int* scanned, int groups, mcor_surface* surface)
{
  const mcor_mesh* mesh = &context->mesh;
  mcor_buffer* indices = &context->scratch[1];
  const size_t bytes = (size_t)mesh->vertex_count * sizeof(cl_int);
  MCOR_TRY(mcor_reserve(context, indices, bytes));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_attribute_nearest", MCOR_HEAVY, groups,
    MCOR_GRID_ARGS(context), MCOR_INT(groups), MCOR_BUFFER(&context->groups),
    MCOR_BUFFER(&mesh->node), MCOR_BUFFER(&mesh->offset),
    MCOR_INT(context->measure.support_min == context->measure.support_max),
    MCOR_BUFFER(&context->grid.order), MCOR_BUFFER(indices)));
  void* view;
  MCOR_TRY(mcor_map(context, indices, bytes, false, &view));
  const cl_int* index = view;
  int64_t* to = surface->nearest_particle + surface->point_count;
  for (int v = 0; v < mesh->vertex_count; ++v)
  {
    if (mcor_is_put(scanned, v))
    {
      to[scanned[v]] = index[v] < 0 ? -1 : context->source[index[v]];
    }
  }
  return mcor_unmap(context, indices, &view);
}

/* Of the vertices that are put out, see mcor_is_put. */
mcor_status mcor_add_attributes(
  mcor_context* context, const mcor_input* input, const cl_int* scanned, mcor_surface* surface)
{
  const mcor_mesh* mesh = &context->mesh;
  const int components = mcor_put_constants(input, scanned[mesh->vertex_count], surface);
  int groups;
  if (components > 0)
  {
    MCOR_TRY(mcor_put_attributes(context, input, scanned, surface));
  }
  if (components > MCOR_ATTRIBUTE_LIMIT || context->options->nearest_particle)
  {
    MCOR_TRY(mcor_make_groups(context, &mesh->node, 0, mesh->vertex_count, &groups));
  }
  if (context->options->nearest_particle)
  {
    MCOR_TRY(mcor_add_nearest(context, scanned, groups, surface));
  }
  for (int first = MCOR_ATTRIBUTE_LIMIT; first < components; first += MCOR_ATTRIBUTE_LIMIT)
  {
    MCOR_TRY(mcor_load_attributes(context, input, first));
    MCOR_TRY(mcor_evaluate_attributes(context, groups));
    MCOR_TRY(mcor_put_attributes(context, input, scanned, surface));
  }
  return MCOR_OK;
}
