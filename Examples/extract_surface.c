/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The core library alone, without VTK: a drop that hangs over a pool, its free surface and an
 * isosurface of the temperature inside, each written as a Wavefront .obj file.
 *
 *   extract_surface free_surface.obj temperature.obj */
#include "mcor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SPACING 0.02

/* Temperature falls with the distance from the drop's centre. */
static float temperature_at(const float position[3])
{
  const float dx = position[0] - 0.5f, dy = position[1] - 0.5f, dz = position[2] - 0.45f;
  return 20.0f + 60.0f * expf(-4.0f * (dx * dx + dy * dy + dz * dz));
}

static int is_fluid(const float position[3])
{
  const float dx = position[0] - 0.5f, dy = position[1] - 0.5f, dz = position[2] - 0.45f;
  return position[2] < 0.2f || dx * dx + dy * dy + dz * dz < 0.18f * 0.18f;
}

/* Makes particles on a lattice in the unit cube, slightly shifted so that the lattice does not
 * show. Returns their number, 0 if memory runs out; the caller frees positions and temperatures. */
static int64_t make_particles(float** positions, float** temperatures)
{
  const int n = (int)(1.0 / SPACING);
  const size_t capacity = (size_t)n * (size_t)n * (size_t)n;
  int64_t count = 0;
  *positions = malloc(capacity * 3 * sizeof **positions);
  *temperatures = malloc(capacity * sizeof **temperatures);
  if (!*positions || !*temperatures)
  {
    return 0;
  }
  for (int64_t i = 0; i < (int64_t)capacity; ++i)
  {
    const int cell[3] = { (int)(i % n), (int)(i / n % n), (int)(i / n / n) };
    float* position = *positions + 3 * count;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double shift = 0.1 * sin(12.9898 * (double)i + 78.233 * axis);
      position[axis] = (float)((cell[axis] + 0.5 + shift) * SPACING);
    }
    if (is_fluid(position))
    {
      (*temperatures)[count++] = temperature_at(position);
    }
  }
  return count;
}

static int write_obj(const char* name, const mcor_surface* surface)
{
  FILE* file = fopen(name, "w");
  if (!file)
  {
    perror(name);
    return 1;
  }
  for (int64_t i = 0; i < surface->point_count; ++i)
  {
    const double* point = surface->points + 3 * i;
    const float* normal = surface->normals + 3 * i;
    fprintf(file, "v %.9g %.9g %.9g\nvn %.6g %.6g %.6g\n", point[0], point[1], point[2],
      (double)normal[0], (double)normal[1], (double)normal[2]);
  }
  for (int64_t i = 0; i < surface->triangle_count; ++i)
  {
    /* Wavefront files count points from 1. */
    const int32_t* corner = surface->triangles + 3 * i;
    fprintf(file, "f %d//%d %d//%d %d//%d\n", corner[0] + 1, corner[0] + 1, corner[1] + 1,
      corner[1] + 1, corner[2] + 1, corner[2] + 1);
  }
  return fclose(file) == 0 ? 0 : 1;
}

/* Extracts one surface and writes it. Returns 0 on success. */
static int extract(
  mcor_context* context, const mcor_input* input, const mcor_options* options, const char* name)
{
  mcor_surface surface = { 0 };
  if (mcor_extract(context, input, options, &surface) != MCOR_OK)
  {
    fprintf(stderr, "%s\n", mcor_last_error(context));
    return 1;
  }
  printf("%s: %lld points, %lld triangles\n", name, (long long)surface.point_count,
    (long long)surface.triangle_count);
  const int failed = surface.triangle_count == 0 || write_obj(name, &surface);
  mcor_free_surface(&surface);
  return failed;
}

static int extract_both(mcor_context* context, const char* free_surface, const char* isosurface)
{
  float *positions = NULL, *temperatures = NULL;
  mcor_input input = { 0 };
  input.count = make_particles(&positions, &temperatures);
  input.positions = (mcor_array){ .data = positions, .components = 3 };
  input.smoothing_length.constant = 1.3 * SPACING;
  input.volume.constant = SPACING * SPACING * SPACING;
  input.scalar = (mcor_array){ .data = temperatures, .components = 1 };

  mcor_options options;
  double iso = 0.5;
  mcor_set_default_options(&options);
  options.field = MCOR_WEIGHT_SUM;
  options.iso_values = &iso;
  options.iso_count = 1;
  int failed = extract(context, &input, &options, free_surface);
  if (!failed)
  {
    iso = 75.0;
    options.field = MCOR_SHEPARD;
    failed = extract(context, &input, &options, isosurface);
  }
  free(positions);
  free(temperatures);
  return failed;
}

int main(int argc, char** argv)
{
  if (argc != 3)
  {
    fprintf(stderr, "usage: %s FREE_SURFACE.obj TEMPERATURE.obj\n", argv[0]);
    return 2;
  }
  mcor_context* context = NULL;
  if (mcor_create_context(NULL, &context) != MCOR_OK)
  {
    fprintf(stderr, "%s\n", context ? mcor_last_error(context) : "out of memory");
    mcor_free_context(context);
    return 1;
  }
  const int failed = extract_both(context, argv[1], argv[2]);
  mcor_free_context(context);
  return failed;
}
