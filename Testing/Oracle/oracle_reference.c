/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare.h"
#include "oracle_period.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double reference_read(const mcor_array* array, int64_t tuple, int component)
{
  const int64_t components = array->components > 0 ? array->components : 1;
  const int64_t at = tuple * components + component;
  if (!array->data)
  {
    return array->constant;
  }
  return array->type == MCOR_FLOAT32 ? (double)((const float*)array->data)[at]
                                     : ((const double*)array->data)[at];
}

static double reference_scalar(const mcor_input* input, int64_t tuple)
{
  const int components = input->scalar.components > 0 ? input->scalar.components : 1;
  double sum = 0.0;
  if (input->scalar_dot.data)
  {
    for (int c = 0; c < components; ++c)
    {
      sum +=
        reference_read(&input->scalar, tuple, c) * reference_read(&input->scalar_dot, tuple, c);
    }
    return sum;
  }
  if (components == 1 || input->scalar_component != MCOR_MAGNITUDE)
  {
    return reference_read(&input->scalar, tuple, components > 1 ? input->scalar_component : 0);
  }
  for (int c = 0; c < components; ++c)
  {
    const double value = reference_read(&input->scalar, tuple, c);
    sum += value * value;
  }
  return sqrt(sum);
}

static int reference_is_given(const mcor_array* array)
{
  return array->data != NULL || array->constant != 0.0;
}

_Static_assert(
  (int)ORACLE_KERNEL_COUNT == (int)MCOR_SPH_KERNEL_COUNT, "kernels in the core's order");

static oracle_kind reference_kind(mcor_field field)
{
  return field == MCOR_SUM ? ORACLE_SUM : field == MCOR_WEIGHT_SUM ? ORACLE_WEIGHT : ORACLE_SHEPARD;
}

/* source: what each is an image of; NULL: of itself. */
static int reference_volumes(
  oracle_particles* particles, const mcor_input* input, oracle_kernel kernel, const int64_t* source)
{
  const size_t n = (size_t)particles->count + 1;
  double* mass = reference_is_given(&input->mass) ? malloc(n * sizeof(double)) : NULL;
  double* density = reference_is_given(&input->mass) && reference_is_given(&input->density)
    ? malloc(n * sizeof(double))
    : NULL;
  int enough = (mass || !reference_is_given(&input->mass)) &&
    (density || !(reference_is_given(&input->mass) && reference_is_given(&input->density)));
  for (int64_t j = 0; enough && j < particles->count; ++j)
  {
    if (mass)
    {
      mass[j] = reference_read(&input->mass, source ? source[j] : j, 0);
    }
    if (density)
    {
      density[j] = reference_read(&input->density, source ? source[j] : j, 0);
    }
  }
  enough = enough && oracle_compute_volumes(particles, kernel, 3, mass, density);
  for (int64_t j = 0; enough && source && j < particles->count; ++j)
  {
    particles->volume[j] = particles->volume[source[j]];
  }
  free(mass);
  free(density);
  return enough;
}

static void reference_edges(
  const oracle_particles* particles, const mcor_options* options, double edge[3])
{
  const double cube = options->cube_size > 0.0
    ? options->cube_size
    : options->cube_size_factor * oracle_smallest_h(particles);
  oracle_fit_edges(options, cube, edge);
}

/* All images of a periodic box as particles. */
static int reference_images(oracle_particles* particles, const mcor_options* options,
  oracle_kernel kernel, int own_volumes, int64_t** source)
{
  const double support = oracle_support(kernel);
  double largest = 0.0, edge[3];
  for (int64_t j = 0; j < particles->count; ++j)
  {
    largest = fmax(largest, particles->smoothing_length[j]);
  }
  reference_edges(particles, options, edge);
  /* A computed volume is a sum over the whole support, not scaled. */
  return oracle_add_images(particles, options, support * options->h_scale,
    own_volumes ? 0.0 : support * largest, fmax(edge[0], fmax(edge[1], edge[2])), source);
}

static int reference_particles(
  oracle_particles* particles, const mcor_input* input, const mcor_options* options)
{
  const oracle_kernel kernel = (oracle_kernel)options->sph_kernel;
  if (!oracle_create_particles(particles, input->count))
  {
    return 0;
  }
  /* Solids count in the weight that trims; nothing but solids trims when the weight itself is
   * contoured. */
  particles->ignore_solids =
    input->ignore_solids || (options->field == MCOR_WEIGHT_SUM && !(options->wall_share > 0.0));
  for (int64_t j = 0; j < input->count; ++j)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      mcor_array xyz = input->positions;
      xyz.components = 3;
      particles->position[3 * j + axis] = reference_read(&xyz, j, axis);
    }
    particles->smoothing_length[j] = reference_read(&input->smoothing_length, j, 0) /
      (input->smoothing_length_is_support_radius ? oracle_support(kernel) : 1.0);
    particles->solid[j] = input->solid && input->solid[j];
    particles->volume[j] =
      reference_is_given(&input->volume) ? reference_read(&input->volume, j, 0) : 0.0;
    particles->scalar[j] = options->field == MCOR_WEIGHT_SUM ? 0.0 : reference_scalar(input, j);
  }
  int64_t* source = NULL;
  const int enough =
    (!oracle_is_periodic(options) ||
      reference_images(particles, options, kernel,
        reference_is_given(&input->volume) ||
          (reference_is_given(&input->mass) && reference_is_given(&input->density)),
        &source)) &&
    (reference_is_given(&input->volume) || reference_volumes(particles, input, kernel, source));
  free(source);
  return enough;
}

static void reference_set_iso(oracle_reference* reference, double iso)
{
  /* In single precision rounding may change the side of a node whose value is this close. */
  const double relative = reference->unit > 1e-10 ? 2e-6 : 1e-13;
  reference->limits.iso = iso;
  reference->field.center = iso;
  reference->limits.close = relative * reference->range;
  reference->limits.margin = relative;
  oracle_march(&reference->lattice, &reference->field, &reference->limits, reference->by_field,
    reference->unit);
}

/* Evaluates all nodes. */
static int reference_lattice(
  oracle_reference* reference, const mcor_options* options, int64_t node_limit)
{
  double edge[3];
  oracle_lattice* lattice = &reference->lattice;
  reference_edges(&reference->particles, options, edge);
  const int enough =
    oracle_create_lattice(lattice, &reference->field, edge, options->level_limit, node_limit);
  oracle_own_period(options, edge, lattice->first, lattice->end);
  reference->greatest_weight = 1.0;
  for (int64_t n = 0; enough && n < lattice->node_count; ++n)
  {
    reference->greatest_weight = fmax(reference->greatest_weight, lattice->nodes[n].trim_weight);
  }
  if (options->field == MCOR_WEIGHT_SUM)
  {
    reference->range = reference->greatest_weight;
  }
  return enough;
}

int oracle_create_reference(oracle_reference* reference, const mcor_input* input,
  const mcor_options* options, int64_t node_limit, char message[256])
{
  memset(reference, 0, sizeof(*reference));
  message[0] = '\0';
  reference->unit =
    options->precision == MCOR_FLOAT32 ? 0.5 * (double)FLT_EPSILON : 0.5 * DBL_EPSILON;
  reference->by_field = options->topology == MCOR_TOPOLOGY_FIELD;
  reference->limits.node_threshold = options->node_threshold;
  reference->limits.least_weight = 1e-3;
  reference->limits.least_at_vertices = options->sph_kernel == MCOR_M_PRIME_4 ? 0.05 : 1e-3;
  if (!reference_particles(&reference->particles, input, options) ||
    !oracle_create_field(&reference->field, &reference->particles,
      (oracle_kernel)options->sph_kernel, reference_kind(options->field), options->h_scale))
  {
    snprintf(message, 256, "out of memory for the particles");
    oracle_free_reference(reference);
    return 0;
  }
  reference->range =
    options->field == MCOR_WEIGHT_SUM ? 1.0 : oracle_scalar_range(&reference->particles);
  if (!(reference->range > 0.0))
  {
    const double any = reference->particles.count > 0 ? reference->particles.scalar[0] : 0.0;
    reference->range = any != 0.0 ? fabs(any) : 1.0;
  }
  if (!reference_lattice(reference, options, node_limit))
  {
    snprintf(message, 256, "more than %lld nodes, or out of memory", (long long)node_limit);
    oracle_free_reference(reference);
    return 0;
  }
  reference_set_iso(reference, options->iso_count > 0 ? options->iso_values[0] : 0.5);
  return 1;
}

void oracle_free_reference(oracle_reference* reference)
{
  oracle_free_lattice(&reference->lattice);
  oracle_free_field(&reference->field);
  oracle_free_particles(&reference->particles);
  memset(reference, 0, sizeof(*reference));
}
