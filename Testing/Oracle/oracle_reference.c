/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare.h"
#include "oracle_period.h"

#include <float.h>
#include <math.h>
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

_Static_assert((int)ORACLE_SUM == (int)MCOR_SUM && (int)ORACLE_WEIGHT == (int)MCOR_WEIGHT_SUM,
  "fields in the core's order");

/* Sets the particles' volumes. source: for each particle, the particle of which it is an image;
 * NULL: there are no images. */
static void reference_volumes(
  particle_set* particles, const mcor_input* input, oracle_kernel kernel, const int64_t* source)
{
  const mcor_array* arrays[2] = { &input->mass, &input->density };
  double* read[2] = { NULL, NULL };
  for (int a = 0; a < 2 && reference_is_given(arrays[a]); ++a)
  {
    read[a] = oracle_allocate(particles->count, sizeof(double));
    for (int64_t j = 0; j < particles->count; ++j)
    {
      read[a][j] = reference_read(arrays[a], source ? source[j] : j, 0);
    }
  }
  oracle_compute_volumes(particles, kernel, 3, read[0], read[1]);
  for (int64_t j = 0; source && j < particles->count; ++j)
  {
    particles->volume[j] = particles->volume[source[j]];
  }
  free(read[0]);
  free(read[1]);
}

static void reference_edges(
  const particle_set* particles, const mcor_options* options, double edge[3])
{
  const double cube = options->cube_size > 0.0
    ? options->cube_size
    : options->cube_size_factor * oracle_smallest_h(particles);
  oracle_fit_edges(options, cube, edge);
}

/* Moves the particles into the period, and adds their images as particles, see oracle_add_images. */
static int64_t* reference_images(
  particle_set* particles, const mcor_options* options, oracle_kernel kernel, int own_volumes)
{
  const double support = oracle_support(kernel);
  double largest = 0.0, edge[3];
  for (int64_t j = 0; j < particles->count; ++j)
  {
    largest = fmax(largest, particles->smoothing_length[j]);
  }
  reference_edges(particles, options, edge);
  /* If volumes are computed, images are needed over the whole support of the unscaled h. */
  return oracle_add_images(particles, options, support * options->h_scale,
    own_volumes ? 0.0 : support * largest, fmax(edge[0], fmax(edge[1], edge[2])));
}

static void reference_particles(
  particle_set* particles, const mcor_input* input, const mcor_options* options)
{
  const oracle_kernel kernel = (oracle_kernel)options->sph_kernel;
  const int has_volume = reference_is_given(&input->volume);
  *particles = particle_set_make(input->count);
  /* Solids count in the weight that trims. If the weight itself is contoured, they count only if
   * the surface ends at solids. */
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
    particles->volume[j] = has_volume ? reference_read(&input->volume, j, 0) : 0.0;
    particles->scalar[j] = options->field == MCOR_WEIGHT_SUM ? 0.0 : reference_scalar(input, j);
  }
  int64_t* source = NULL;
  if (oracle_is_periodic(options))
  {
    source = reference_images(particles, options, kernel,
      has_volume || (reference_is_given(&input->mass) && reference_is_given(&input->density)));
  }
  if (!has_volume)
  {
    reference_volumes(particles, input, kernel, source);
  }
  free(source);
}

void oracle_create_reference(
  oracle_reference* reference, const mcor_input* input, const mcor_options* options)
{
  const int of_weight = options->field == MCOR_WEIGHT_SUM;
  const int single = options->precision == MCOR_FLOAT32;
  oracle_lattice* lattice = &reference->lattice;
  double edge[3];
  memset(reference, 0, sizeof(*reference));
  reference->unit = 0.5 * (single ? (double)FLT_EPSILON : DBL_EPSILON);
  reference_particles(&reference->particles, input, options);
  reference->field = oracle_make_field(&reference->particles, (oracle_kernel)options->sph_kernel,
    (oracle_kind)options->field, options->h_scale);
  reference_edges(&reference->particles, options, edge);
  oracle_create_lattice(lattice, &reference->field, edge, options->level_limit, 1);
  oracle_own_period(options, edge, lattice->first, lattice->end);
  reference->greatest_weight = 1.0;
  for (int64_t n = 0; n < lattice->node_count; ++n)
  {
    reference->greatest_weight = fmax(reference->greatest_weight, lattice->nodes[n].trim_weight);
  }
  reference->range =
    of_weight ? reference->greatest_weight : oracle_scalar_range(&reference->particles);
  if (!(reference->range > 0.0))
  {
    const double any = reference->particles.count > 0 ? reference->particles.scalar[0] : 0.0;
    reference->range = any != 0.0 ? fabs(any) : 1.0;
  }
  /* Rounding may change the side of a node whose value is this close to iso, relative to the range. */
  const double relative = single ? 2e-6 : 1e-13;
  reference->limits = (oracle_limits){ .iso = options->iso_count > 0 ? options->iso_values[0] : 0.5,
    .node_threshold = options->node_threshold,
    .least_weight = 1e-3,
    .least_at_vertices = options->sph_kernel == MCOR_M_PRIME_4 ? 0.05 : 1e-3,
    .close = relative * reference->range,
    .margin = relative };
  reference->field.center = reference->limits.iso;
  oracle_march(lattice, &reference->field, &reference->limits,
    options->topology == MCOR_TOPOLOGY_FIELD, reference->unit);
}

void oracle_free_reference(oracle_reference* reference)
{
  oracle_free_lattice(&reference->lattice);
  oracle_free_field(&reference->field);
  particle_set_free(&reference->particles);
  memset(reference, 0, sizeof(*reference));
}
