/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Makes a call of mcor_extract from bytes, and checks what must hold for every call. The call does
 * not crash, and the status is in range. After a failure there is a message and an empty surface.
 * After a success indices are valid, numbers are finite, and no triangle names a point twice. A
 * context that keeps data gives the same bits as one that keeps nothing. */

#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FUZZ_PARTICLES 48

static double fuzz_threshold(fuzz_bytes* bytes)
{
  static const double values[] = { 0.1, 0.5, 0, 1, 2, 1e-6, 0.3, 0.7 };
  const unsigned b = fuzz_byte(bytes);
  return b < 252 ? values[b % 8] : b == 252 ? -1 : b == 253 ? NAN : b == 254 ? 1e30 : INFINITY;
}

static void fuzz_particles(fuzz_bytes* bytes, fuzz_call* call)
{
  mcor_input* in = &call->input;
  const size_t n = fuzz_byte(bytes) % (FUZZ_PARTICLES + 1);
  const unsigned kind = fuzz_byte(bytes);
  const double spacing = 0.5 * fuzz_scale(bytes), shift = kind & 1 ? 0 : 1e6 * fuzz_scale(bytes);
  double* x = fuzz_array(call, 0, 3 * n);
  double* h = fuzz_array(call, 1, n);
  double* v = fuzz_array(call, 2, n);
  double* a = fuzz_array(call, 3, n);
  uint8_t* solid = call->arrays[4] = malloc(n + (n == 0));
  const double constant_h = fuzz_positive(bytes);
  const double h_scale = kind & 2 ? spacing * 2 : 1, a_scale = fuzz_scale(bytes);
  FUZZ_CHECK(solid);
  for (size_t i = 0; i < n; ++i)
  {
    for (int c = 0; c < 3; ++c)
    {
      const unsigned b = fuzz_byte(bytes);
      x[3 * i + (size_t)c] = (kind & 64 ? shift : 0) +
        spacing *
          (b < 250    ? b % 7
              : b % 2 ? b * 0.1
                      : 1e5);
    }
    const unsigned b = fuzz_byte(bytes);
    h[i] = h_scale * (b & 1 ? constant_h : fuzz_positive(bytes));
    v[i] = b & 2 ? h[i] * h[i] * h[i] : fuzz_positive(bytes);
    a[i] = a_scale * fuzz_value(bytes);
    solid[i] = (b & 0xc0) == 0xc0;
  }
  in->count = (int64_t)n;
  in->positions = (mcor_array){ .data = x, .type = MCOR_FLOAT64, .components = 3 };
  in->smoothing_length = (mcor_array){ .data = kind & 4 ? h : NULL, .type = MCOR_FLOAT64 };
  in->smoothing_length.constant = h_scale * constant_h;
  in->smoothing_length_is_support_radius = kind >> 3 & 1;
  in->estimate_smoothing_length = (kind & 0x30) == 0x30;
  in->scalar = (mcor_array){ .data = a, .type = MCOR_FLOAT64 };
  in->volume = in->mass = (mcor_array){ .data = v, .type = MCOR_FLOAT64 };
  in->density = (mcor_array){ .data = kind & 4 ? h : v, .type = MCOR_FLOAT64 };
  in->solid = kind & 0x80 ? solid : NULL;
}

/* The bits of `rules` say whether the call has volumes, masses, densities and attributes, ignores
 * solids, and takes a component of the positions, or their length, as its scalar. */
static void fuzz_parts(unsigned rules, fuzz_call* call)
{
  const mcor_array none = { 0 };
  mcor_input* in = &call->input;
  in->volume = rules & 1 ? in->volume : none;
  in->mass = rules >> 1 & 1 ? in->mass : none;
  in->density = rules >> 2 & 1 ? in->density : none;
  in->ignore_solids = rules >> 3 & 1;
  call->attributes[0] = in->scalar;
  call->attributes[1] = in->positions;
  in->attributes = call->attributes;
  in->attribute_count = rules >> 4 & 1 ? 2 : 0;
  if (rules >> 5 & 1)
  {
    in->scalar = in->positions;
    in->scalar_component = (int)(rules >> 6) - 1;
  }
}

static void fuzz_options(fuzz_bytes* bytes, fuzz_call* call)
{
  mcor_options* o = &call->options;
  const unsigned what = fuzz_byte(bytes), modes = fuzz_byte(bytes);
  mcor_set_default_options(o);
  /* Only a few combinations of kernel and field are tried, because each needs its own device
   * program. */
  o->sph_kernel = (mcor_sph_kernel)(modes % 16 == 15 ? MCOR_SPH_KERNEL_COUNT
      : modes % 16 > 11                              ? MCOR_M_PRIME_4
                                                     : 0);
  o->field = (mcor_field)(modes / 16 == 15 ? 3 : modes / 16 % 3);
  o->seeds = (mcor_seed_mode)(what & 1);
  o->preview = (what & 0x0e) == 2;
  o->compact = (what & 0x0c) == 4;
  o->boundary_detection = (mcor_boundary_detection)(what == 0xff ? 2 : what >> 3 & 1);
  o->outputs |= what >> 4 & 1 ? MCOR_OUT_BOUNDARY_EIGENVALUE | MCOR_OUT_GRADIENTS |
      MCOR_OUT_WEIGHT_SUM | MCOR_OUT_RESIDUAL | MCOR_OUT_CORRECTION_LENGTH
                              : 0;
  o->outputs |=
    what >> 5 & 1 ? MCOR_OUT_BOUNDARY_FLAG | MCOR_OUT_NEAREST_PARTICLE | MCOR_OUT_ISO_VALUE : 0;
  o->triangle_normals = (what & 0xc0) == 0xc0;
  o->node_threshold = fuzz_threshold(bytes);
  o->vertex_threshold = fuzz_threshold(bytes);
  o->h_scale = fuzz_scale(bytes) * (fuzz_byte(bytes) & 1 ? 1 : 0.5);
  const unsigned cube = fuzz_byte(bytes);
  o->cube_size_factor =
    cube < 248 ? 0.5 + 0.25 * (cube % 3) : fuzz_positive(bytes) * fuzz_scale(bytes);
  o->topology = (mcor_topology)(cube >> 5 & 1);
  o->cube_size = cube > 252 ? fuzz_positive(bytes) * fuzz_scale(bytes) : 0;
  o->tolerance = cube % 16 == 15 ? fuzz_positive(bytes) * 1e-3 : 1e-6;
  o->iteration_limit = cube % 16 == 14 ? (int)fuzz_byte(bytes) * 2 - 1 : 30;
  o->iso_count = 1 + (cube % 16 == 13);
  o->iso_values = call->iso;
  call->iso[0] = fuzz_value(bytes);
  call->iso[1] = fuzz_value(bytes);
}

static void fuzz_check_lines(const mcor_surface* s)
{
  const int64_t n = s->line_count;
  FUZZ_CHECK(n >= 0 && s->line_offsets[0] == 0 && s->line_offsets[n] == s->line_point_count);
  for (int64_t l = 0; l < n; ++l)
  {
    FUZZ_CHECK(s->line_offsets[l] + 2 <= s->line_offsets[l + 1]);
  }
  for (int64_t i = 0; i < s->line_point_count; ++i)
  {
    FUZZ_CHECK(s->line_points[i] >= 0 && s->line_points[i] < s->point_count);
  }
  FUZZ_CHECK(s->triangle_count == 0 || s->band_value);
}

static void fuzz_check_surface(const mcor_surface* s, const mcor_input* in)
{
  const int64_t n = s->point_count;
  FUZZ_CHECK(n >= 0 && s->triangle_count >= 0);
  FUZZ_CHECK(s->line_offsets || n <= 3 * s->triangle_count);
  FUZZ_CHECK(fuzz_finite(s->points, 3 * n, sizeof(double)));
  FUZZ_CHECK(fuzz_finite(s->gradients, 3 * n, sizeof(double)));
  FUZZ_CHECK(fuzz_finite(s->normals, 3 * n, sizeof(float)));
  FUZZ_CHECK(fuzz_finite(s->weight_sum, n, sizeof(float)));
  FUZZ_CHECK(fuzz_finite(s->boundary_eigenvalue, n, sizeof(float)));
  FUZZ_CHECK(fuzz_finite(s->residual, n, sizeof(float)));
  FUZZ_CHECK(fuzz_finite(s->correction_length, n, sizeof(float)));
  for (int a = 0; a < s->attribute_count; ++a)
  {
    FUZZ_CHECK(fuzz_finite(s->attributes[a], n * (a ? 3 : 1), sizeof(double)));
  }
  for (int64_t t = 0; t < s->triangle_count; ++t)
  {
    const int32_t* k = s->triangles + 3 * t;
    for (int c = 0; c < 3; ++c)
    {
      FUZZ_CHECK(k[c] >= 0 && k[c] < n);
    }
    FUZZ_CHECK(k[0] != k[1] && k[1] != k[2] && k[2] != k[0]);
  }
  for (int64_t i = 0; s->nearest_particle && i < n; ++i)
  {
    FUZZ_CHECK(s->nearest_particle[i] >= 0 && s->nearest_particle[i] < in->count);
  }
  if (s->line_offsets)
  {
    fuzz_check_lines(s);
  }
}

static mcor_status fuzz_extract(mcor_context* context, const fuzz_call* call, mcor_surface* surface)
{
  memset(surface, 0, sizeof *surface);
  const mcor_status status = mcor_extract(context, &call->input, &call->options, surface);
  if (status == MCOR_OK)
  {
    FUZZ_CHECK(mcor_last_error(context)[0] == '\0');
    fuzz_check_surface(surface, &call->input);
  }
  else
  {
    fuzz_check_failure(context, status);
    FUZZ_CHECK(surface->point_count == 0 && !surface->points && !surface->triangles);
  }
  return status;
}

/* Moves all particles by exchanging their coordinates: x, y, z become y, z, x. The range of all
 * coordinates together stays. */
static void fuzz_move(fuzz_call* call)
{
  const size_t n = (size_t)call->input.count;
  const double* from = call->input.positions.data;
  double* to = fuzz_array(call, 5, 3 * n);
  for (size_t i = 0; i < 3 * n; ++i)
  {
    to[i] = from[i - i % 3 + (i + 1) % 3];
  }
  call->input.positions.data = to;
  ++call->input.particles_version;
}

static void fuzz_other_scalar(fuzz_call* call)
{
  mcor_array* scalar = &call->input.scalar;
  const size_t n = (size_t)call->input.count * (scalar->components > 1 ? 3 : 1);
  const double* from = scalar->data;
  double* to = fuzz_array(call, 6, n);
  for (size_t i = 0; i < n; ++i)
  {
    to[i] = -from[i];
  }
  scalar->data = to;
  ++call->input.scalar_version;
}

/* Changes one thing in a call. If the contents of an array change, so does its version. */
static void fuzz_change(unsigned what, fuzz_call* call)
{
  mcor_input* in = &call->input;
  mcor_options* o = &call->options;
  mcor_array* const arrays[] = { &in->volume, &in->mass, &in->density };
  switch (what % 22)
  {
    case 0:
      call->iso[0] += 0.25;
      break;
    case 1:
      o->h_scale *= 0.75;
      break;
    case 2:
      o->cube_size_factor += 0.25;
      break;
    case 3:
      o->seeds = o->seeds == MCOR_PAIRS ? MCOR_COMPLETE : MCOR_PAIRS;
      break;
    case 4:
      o->topology = o->topology == MCOR_TOPOLOGY_FIELD ? MCOR_TOPOLOGY_TABLE : MCOR_TOPOLOGY_FIELD;
      break;
    case 5:
      o->preview = !o->preview;
      break;
    case 6:
      o->node_threshold += 0.25;
      break;
    case 7:
      o->vertex_threshold += 0.25;
      break;
    case 8:
      o->boundary_detection = o->boundary_detection == MCOR_BOUNDARY_EIGENVALUE
        ? MCOR_BOUNDARY_WEIGHT_SUM
        : MCOR_BOUNDARY_EIGENVALUE;
      break;
    case 9:
      fuzz_other_scalar(call);
      break;
    case 10:
      fuzz_move(call);
      break;
    case 11:
      fuzz_move(call);
      fuzz_other_scalar(call);
      break;
    case 12:
      in->ignore_solids = !in->ignore_solids;
      call->options.wall_share = in->ignore_solids ? 0 : 0.5;
      break;
    case 13:
      in->smoothing_length.data = NULL;
      in->smoothing_length.constant *= 1.25;
      break;
    case 14:
      in->smoothing_length_is_support_radius = !in->smoothing_length_is_support_radius;
      break;
    case 15:
      in->estimate_smoothing_length = !in->estimate_smoothing_length;
      break;
    case 16:
    case 17:
    case 18:
      *arrays[what % 22 - 16] =
        mcor_is_given(arrays[what % 22 - 16]) ? (mcor_array){ 0 } : in->smoothing_length;
      break;
    case 19:
      o->level_limit = o->level_limit ? 0 : MCOR_CUBE_LEVELS - 1;
      break;
    case 20:
      o->level_limit = o->level_limit ? o->level_limit - 1 : 3;
      break;
    default:
      in->count -= in->count > 0;
      break;
  }
}

/* Compares the call's result on a context that keeps data with the result on a context that keeps
 * nothing. */
static void fuzz_compare(const fuzz_call* call)
{
  fuzz_call alone = *call;
  mcor_surface kept, fresh;
  alone.options.iso_values = alone.iso;
  alone.input.particles_version = alone.input.scalar_version = 0;
  const mcor_status status = fuzz_extract(fuzz_context(call, 0), call, &kept);
  FUZZ_CHECK(fuzz_extract(fuzz_context(call, 1), &alone, &fresh) == status);
  fuzz_check_same(&kept, &fresh);
  mcor_free_surface(&kept);
  mcor_free_surface(&fresh);
}

/* Makes a call that must fail, with the same version numbers of arrays as `call`. A later run of
 * `call` then shows whether it reuses data of the failed call. */
static void fuzz_fail_first(const fuzz_call* call)
{
  fuzz_call failing = *call;
  mcor_surface surface;
  failing.options.iteration_limit = 0;
  const mcor_status status = fuzz_extract(fuzz_context(call, 0), &failing, &surface);
  /* Two dimensions may be refused earlier: if particles lie in no plane, or if walls lie in another
   * plane than the fluid. */
  FUZZ_CHECK(status == MCOR_INVALID_ARGUMENT ||
    (status == MCOR_INVALID_DATA && failing.options.dimension != 3));
  mcor_free_surface(&surface);
}

/* Makes the call, then one with a single change, then the first call again. */
static void fuzz_calls(fuzz_call* call, unsigned change, size_t size)
{
  static uint64_t version = 0;
  call->input.particles_version = call->input.scalar_version = version += 2;
  fuzz_compare(call);
  if (size % 4 == 1)
  {
    mcor_release_memory(fuzz_context(call, 0));
  }
  fuzz_call changed = *call;
  changed.options.iso_values = changed.iso;
  changed.input.attributes = changed.attributes;
  fuzz_change(change, &changed);
  if (size % 4 == 2)
  {
    fuzz_fail_first(&changed);
  }
  fuzz_compare(&changed);
  fuzz_compare(call);
  for (size_t i = 0; i < FUZZ_ARRAYS; ++i)
  {
    if (changed.arrays[i] != call->arrays[i])
    {
      free(changed.arrays[i]);
    }
  }
}

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
  fuzz_bytes bytes = fuzz_input = (fuzz_bytes){ data, size };
  fuzz_call call = { .iso = { 0, 0 } };
  fuzz_options(&bytes, &call);
  const unsigned rules = fuzz_byte(&bytes);
  fuzz_particles(&bytes, &call);
  fuzz_parts(rules, &call);
  const unsigned change = fuzz_byte(&bytes) + (unsigned)size;
  const unsigned modules = fuzz_byte(&bytes);
  fuzz_regions(modules, &bytes, &call);
  fuzz_calls(&call, change, size);
  fuzz_other_calls(modules, &bytes, &call);
  const unsigned more = fuzz_byte(&bytes);
  if (more & 1)
  {
    fuzz_gauge(&bytes, &call);
  }
  if (more & 2)
  {
    fuzz_flatten(more >> 2, &bytes, &call);
    fuzz_calls(&call, change, size);
  }
  for (size_t i = 0; i < FUZZ_ARRAYS; ++i)
  {
    free(call.arrays[i]);
  }
  return 0;
}
