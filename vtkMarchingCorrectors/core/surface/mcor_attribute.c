/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Attributes (other particle arrays) at the surface's points [III-D.4]. The first
 * MCOR_ATTRIBUTE_LIMIT components that vary are evaluated during the correction, which has gathered
 * each vertex's particles. Further components that vary follow in groups of the same size, at the
 * vertices of the finished mesh. A component that does not vary keeps its exact value. */

#include "mcor_adaptive.h"
#include "mcor_input.h"
#include "mcor_parallel.h"

#include <math.h>
#include <stdlib.h>

/* Returns the power of 2 that scales the largest value of a component to at most 1, so that no sum
 * overflows in the device's precision. */
static double mcor_component_scale(double largest)
{
  int exponent = 0;
  frexp(largest, &exponent);
  return ldexp(1, exponent > -1000 ? -exponent : 1000);
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

/* Lists the components of attributes that are finite at all fluid particles. If of_surface is set,
 * lists only components that vary; if not, the list is for mcor_samples. not_finite
 * [attribute_count] becomes what mcor_surface.attribute_not_finite tells. */
mcor_status mcor_list_components(
  mcor_context* context, const mcor_input* input, bool of_surface, int64_t* not_finite)
{
  mcor_attributes* attributes = &context->attributes;
  const mcor_globals* globals = context->run.options->globals;
  mcor_globals own = { 0 };
  const size_t count = mcor_count_components(input);
  free(attributes->varying);
  attributes->kept = 0;
  attributes->varying_count = attributes->count = 0;
  attributes->varying = malloc((count + 1) * sizeof *attributes->varying);
  MCOR_TRY(mcor_allocated(context, attributes->varying));
  MCOR_FAIL_IF(globals && globals->component_count != (int)count, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(GLOBALS_OF_OTHER_ATTRIBUTES), globals->component_count, (int)count);
  const mcor_status status = globals ? MCOR_OK : mcor_measure_components(context, input, &own);
  globals = globals ? globals : &own;
  for (int a = 0, next = 0; a < input->attribute_count && status == MCOR_OK; ++a)
  {
    not_finite[a] = globals->components[next].not_finite;
    for (int c = 0; c < mcor_components(&input->attributes[a]); ++c, ++next)
    {
      const mcor_global_component found = globals->components[next];
      if (found.not_finite < 0 && (found.varies || !of_surface))
      {
        mcor_component* scaled = &attributes->varying[attributes->varying_count++];
        *scaled = (mcor_component){ .attribute = a, .component = c };
        if (of_surface)
        {
          scaled->scale = mcor_component_scale(found.largest);
          continue;
        }
        const double half = 0.5 * found.high - 0.5 * found.low; /* scales samples to [-1, 1] */
        scaled->shift = 0.5 * found.high + 0.5 * found.low;
        scaled->scale = half > 0 ? mcor_component_scale(half) : 1;
        scaled->low = found.low;
        scaled->high = found.high;
      }
    }
  }
  free(own.components);
  return status;
}

/* Copies the listed components from number `first` on, at most MCOR_ATTRIBUTE_LIMIT of them, to the
 * device. */
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

/* The arguments of mcor_store_means, which copies the means at output vertices to the surface. */
typedef struct mcor_means
{
  const mcor_context* context;
  const mcor_input* input;
  const cl_int* scanned;
  void* values;
  mcor_surface* surface;
} mcor_means;

static void mcor_store_means(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_means* m = data;
  const mcor_attributes* attributes = &m->context->attributes;
  for (int c = 0; c < attributes->count; ++c)
  {
    const mcor_component* component = &attributes->varying[attributes->first + c];
    const int width = mcor_components(&m->input->attributes[component->attribute]);
    double* to = m->surface->attributes[component->attribute] + m->surface->point_count * width +
      component->component;
    for (int64_t v = first; v < last; ++v)
    {
      if (mcor_is_output(m->scanned, v))
      {
        to[m->scanned[v] * (int64_t)width] =
          mcor_get_real(m->context, m->values, v * attributes->count + c) / component->scale;
      }
    }
  }
  (void)slice;
}

/* Adds the attributes of the vertices that go to the output, see mcor_is_output. */
mcor_status mcor_add_attributes(
  mcor_context* context, const mcor_input* input, const cl_int* scanned, mcor_surface* surface)
{
  mcor_mesh* mesh = &context->mesh;
  mcor_buffer* means = &mesh->means;
  const size_t vertices = (size_t)mesh->vertex_count, real = context->cl.real_size;
  const int varying = context->attributes.varying_count;
  const mcor_component* component = context->attributes.varying;
  /* Writes the constant components, which the list of varying components lacks. The list is in the
   * order of the arrays. */
  for (int a = 0; a < input->attribute_count; ++a)
  {
    const mcor_array* array = &input->attributes[a];
    const int width = mcor_components(array);
    for (int c = 0; c < width && surface->attributes[a]; ++c)
    {
      if (component < context->attributes.varying + varying && component->attribute == a &&
        component->component == c)
      {
        ++component;
        continue;
      }
      const double value = mcor_array_at(array, 0, c);
      double* to = surface->attributes[a] + surface->point_count * width + c;
      for (cl_int i = 0; i < scanned[mesh->vertex_count]; ++i)
      {
        to[i * (int64_t)width] = value;
      }
    }
  }
  for (int first = 0; first < varying; first += MCOR_ATTRIBUTE_LIMIT)
  {
    if (first > 0) /* the correction has evaluated the first components */
    {
      MCOR_TRY(mcor_load_attributes(context, input, first));
      MCOR_TRY(mcor_reserve(context, means, vertices * (size_t)context->attributes.count * real));
      MCOR_TRY(MCOR_LAUNCH_AT_VERTICES(context, MCOR_ALL_VERTICES, "mcor_attribute_means",
        MCOR_BUFFER(&mesh->offset), MCOR_ATTRIBUTE_ARGS(context, means)));
    }
    mcor_means job = { .context = context, .input = input, .scanned = scanned, .surface = surface };
    const mcor_mapping view = { means, vertices * (size_t)context->attributes.count * real,
      &job.values };
    mcor_status status = mcor_map_all(context, &view, 1);
    MCOR_THEN(status,
      mcor_parallel_run(
        context, mesh->vertex_count, MCOR_LIGHT_GRAIN, mcor_store_means, &job, NULL));
    MCOR_TRY(mcor_unmap_all(context, &view, 1, status));
  }
  return MCOR_OK;
}

void mcor_release_attributes(mcor_context* context)
{
  mcor_attributes* attributes = &context->attributes;
  MCOR_RELEASE(context, &attributes->sorted, &attributes->nearest);
  attributes->kept = 0;
}
