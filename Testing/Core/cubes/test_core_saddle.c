/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Where cells are sampled: saddles of the trilinear interpolant against a search, the middle;
 * and what two samples say together. */

#include "core_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Corner values -> number of saddles in the cell, and where they are. */
static const char source[] =
  "__kernel void test_saddles(const int count, __global const real* in, __global real* out)\n"
  "{\n"
  "  const int i = get_global_id(0);\n"
  "  if (i >= count)\n"
  "    return;\n"
  "  real f[8];\n"
  "  for (int c = 0; c < 8; ++c)\n"
  "    f[c] = in[8 * i + c];\n"
  "  mcor_trilinear t;\n"
  "  mcor_topology_find_saddles(f, &t);\n"
  "  const real4 middle = mcor_topology_middle(f);\n"
  "  __global real* o = out + 10 * i;\n"
  "  o[0] = t.saddle_count;\n"
  "  for (int s = 0; s < 2; ++s)\n"
  "  {\n"
  "    o[1 + 3 * s] = s < t.saddle_count ? t.saddle[s].x : 0;\n"
  "    o[2 + 3 * s] = s < t.saddle_count ? t.saddle[s].y : 0;\n"
  "    o[3 + 3 * s] = s < t.saddle_count ? t.saddle[s].z : 0;\n"
  "  }\n"
  "  o[7] = middle.x;\n"
  "  o[8] = middle.y;\n"
  "  o[9] = middle.z;\n"
  "}\n";

/* Gradient and mixed second derivatives of the trilinear interpolant. */
static void trilinear(const double f[8], const double x[3], double gradient[3], double mixed[3])
{
  memset(gradient, 0, 3 * sizeof gradient[0]);
  memset(mixed, 0, 3 * sizeof mixed[0]);
  for (int c = 0; c < 8; ++c)
  {
    double share[3], slope[3];
    for (int a = 0; a < 3; ++a)
    {
      share[a] = c >> a & 1 ? x[a] : 1 - x[a];
      slope[a] = c >> a & 1 ? 1 : -1;
    }
    for (int a = 0; a < 3; ++a)
    {
      const int u = (a + 1) % 3, v = (a + 2) % 3;
      gradient[a] += f[c] * slope[a] * share[u] * share[v];
      mixed[a] += f[c] * share[a] * slope[u] * slope[v]; /* with respect to u and v */
    }
  }
}

/* One Newton step; 0 where there is none. */
static int newton_step(const double f[8], double x[3])
{
  double g[3], m[3];
  trilinear(f, x, g, m);
  if (m[0] == 0 || m[1] == 0 || m[2] == 0)
  {
    return 0;
  }
  /* The matrix of second derivatives has zeros on its diagonal, as the interpolant is linear along
   * each axis. */
  for (int a = 0; a < 3; ++a)
  {
    const int u = (a + 1) % 3, v = (a + 2) % 3;
    x[a] += (m[a] * g[a] - m[u] * g[u] - m[v] * g[v]) / (2 * m[u] * m[v]);
  }
  return 1;
}

/* Saddles at least `margin` inside the cell, by Newton's method from many points. */
static int search_saddles(const double f[8], double margin, double saddles[2][3])
{
  int count = 0;
  for (int start = 0; start < 125; ++start)
  {
    double x[3] = { start % 5 * 0.25, start / 5 % 5 * 0.25, start / 25 * 0.25 }, g[3], m[3];
    for (int i = 0; i < 60 && newton_step(f, x); ++i)
    {
    }
    trilinear(f, x, g, m);
    int found = fabs(g[0]) + fabs(g[1]) + fabs(g[2]) < 1e-9;
    for (int a = 0; a < 3; ++a)
    {
      found = found && x[a] > margin && x[a] < 1 - margin;
    }
    for (int s = 0; s < count; ++s)
    {
      found = found &&
        fabs(x[0] - saddles[s][0]) + fabs(x[1] - saddles[s][1]) + fabs(x[2] - saddles[s][2]) > 1e-6;
    }
    if (found && count < 2)
    {
      memcpy(saddles[count++], x, 3 * sizeof x[0]);
    }
  }
  return count;
}

static double distance_to(const double x[3], const double* out)
{
  return fmax(fabs(x[0] - out[0]), fmax(fabs(x[1] - out[1]), fabs(x[2] - out[2])));
}

static void check_saddles(const double f[8], const double out[10])
{
  double saddles[2][3];
  const int count = search_saddles(f, 1e-3, saddles), found = (int)out[0];
  for (int s = 0; s < count; ++s)
  {
    CORE_CHECK((found > 0 && distance_to(saddles[s], out + 1) < 1e-6) ||
        (found > 1 && distance_to(saddles[s], out + 4) < 1e-6),
      "saddle %g %g %g of values %g %g %g %g %g %g %g %g is missing", saddles[s][0], saddles[s][1],
      saddles[s][2], f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7]);
  }
  for (int s = 0; s < found; ++s)
  {
    double g[3], m[3];
    trilinear(f, out + 1 + 3 * s, g, m);
    CORE_CHECK(fabs(g[0]) + fabs(g[1]) + fabs(g[2]) < 1e-6, "gradient %g %g %g", g[0], g[1], g[2]);
  }
}

/* The mean of the crossings, for values that are -1 or 1: of the edges' middles. */
static void check_middle(const double f[8], const double out[10])
{
  double sum[3] = { 0, 0, 0 };
  int count = 0;
  for (int c = 0; c < 8; ++c)
  {
    for (int a = 0; a < 3; ++a)
    {
      if (!(c >> a & 1) && f[c] != f[c | 1 << a])
      {
        ++count;
        for (int b = 0; b < 3; ++b)
        {
          sum[b] += a == b ? 0.5 : c >> b & 1;
        }
      }
    }
  }
  for (int b = 0; b < 3; ++b)
  {
    CORE_CHECK(count == 0 || fabs(out[7 + b] - sum[b] / count) < 1e-12, "middle %g", out[7 + b]);
  }
}

static void test_saddles(void** state)
{
  enum
  {
    N = 4096,
    SIGNS = 256 /* the first ones have the values -1 and 1 alone, with sums that cancel */
  };
  mcor_context* context = *state;
  static double in[N][8], out[N][10];
  uint64_t seed = 5;
  int with_saddles[3] = { 0, 0, 0 };
  for (int i = 0; i < N; ++i)
  {
    for (int c = 0; c < 8; ++c)
    {
      const double value = 2 * random_unit(&seed) - 1, sign = i >> c & 1 ? 1 : -1;
      in[i][c] = i < SIGNS ? sign : i % 2 ? value : fabs(value) * sign;
    }
  }
  mcor_buffer values = { 0 }, results = { 0 };
  core_build(context, MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT64);
  core_extend_program(context, source);
  CORE_OK(context, mcor_write(context, &values, in, sizeof in));
  CORE_OK(context, mcor_reserve(context, &results, sizeof out));
  CORE_OK(context,
    MCOR_LAUNCH(context, "test_saddles", MCOR_LIGHT, N, MCOR_INT(N), MCOR_BUFFER(&values),
      MCOR_BUFFER(&results)));
  CORE_OK(context, mcor_read(context, &results, 0, out, sizeof out));
  for (int i = 0; i < N; ++i)
  {
    if (i < SIGNS)
    {
      check_middle(in[i], out[i]);
    }
    else
    {
      check_saddles(in[i], out[i]);
    }
    ++with_saddles[(int)out[i][0]];
  }
  assert_true(with_saddles[1] > 100 && with_saddles[2] > 20);
  /* Opposite corners: the saddle is in the middle, though the cubic term is 0. */
  const double* opposite = out[0x81];
  assert_true(opposite[0] == 1 && fabs(opposite[1] - 0.5) + fabs(opposite[2] - 0.5) < 1e-12);
  mcor_release(context, &values);
  mcor_release(context, &results);
}

/* Samples are below (0), above (1), or without a value (2): both must say the same. */
static void test_agreement(void** state)
{
  mcor_context* context = *state;
  static const uint8_t sides[9][2] = { { 0, 0 }, { 0, 1 }, { 0, 2 }, { 1, 0 }, { 1, 1 }, { 1, 2 },
    { 2, 0 }, { 2, 1 }, { 2, 2 } };
  /* The cells 1, 8, 15, ... of one brick; masks 0 to 2 are not of interest here. */
  const int32_t base[2] = { 0, 18 };
  uint64_t masks[5] = { 0, 0, 0, 0, 0 };
  mcor_buffer base_buffer = { 0 }, side_buffer = { 0 }, mask_buffer = { 0 };
  for (int i = 0; i < 9; ++i)
  {
    masks[3] |= UINT64_C(1) << (1 + 7 * i);
  }
  core_build(context, MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32);
  CORE_OK(context, mcor_write(context, &base_buffer, base, sizeof base));
  CORE_OK(context, mcor_write(context, &side_buffer, sides, sizeof sides));
  CORE_OK(context, mcor_write(context, &mask_buffer, masks, sizeof masks));
  CORE_OK(context,
    MCOR_LAUNCH(context, "mcor_topology_agree", MCOR_LIGHT, 1, MCOR_INT(1),
      MCOR_BUFFER(&base_buffer), MCOR_BUFFER(&side_buffer), MCOR_BUFFER(&mask_buffer)));
  CORE_OK(context, mcor_read(context, &mask_buffer, 0, masks, sizeof masks));
  assert_true(masks[3] == UINT64_C(1) << 1);
  assert_true(masks[4] == UINT64_C(1) << (1 + 7 * 4));
  mcor_release(context, &base_buffer);
  mcor_release(context, &side_buffer);
  mcor_release(context, &mask_buffer);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_saddles),
    cmocka_unit_test(test_agreement) };
  return cmocka_run_group_tests_name("saddle", tests, core_set_up, core_tear_down);
}
