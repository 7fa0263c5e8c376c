/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests the built-in device on a machine without drivers; ctest hides drivers from this program. */

#include "core_fixture.h"

static mcor_status extract_with(
  mcor_context* context, mcor_sph_kernel kernel, mcor_type precision, uint64_t* hash)
{
  CORE_SET set = core_make_block(7, 0.3, 3, core_ball);
  const double iso = 2;
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.sph_kernel = kernel;
  options.precision = precision;
  CORE_SURFACE surface = { 0 };
  const mcor_status status = mcor_extract(context, &input, &options, &surface);
  *hash = core_hash(&surface);
  return status;
}

static mcor_status extract(mcor_context* context, uint64_t* hash)
{
  return extract_with(context, MCOR_CUBIC_SPLINE, MCOR_FLOAT32, hash);
}

/* If kernels were not compiled with the library, the message names the kernels and says what to do. */
static void test_names_what_is_missing(void** state)
{
  static const struct
  {
    mcor_sph_kernel kernel;
    mcor_type precision;
    const char *words, *others;
  } cases[] = { { MCOR_SINC_6, MCOR_FLOAT32, "SPH kernel sinc6: they were not compiled", "single" },
    { MCOR_QUARTIC_SPLINE, MCOR_FLOAT64, "SPH kernel quartic in double precision:", "single" },
    { MCOR_CUBIC_SPLINE, MCOR_FLOAT64, "library. Choose precision=single, install an",
      "Install" } };
  CORE_CONTEXT context = NULL;
  CORE_OK(context, mcor_create_context(NULL, &context));
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; ++c)
  {
    uint64_t hash;
    const mcor_status status = extract_with(context, cases[c].kernel, cases[c].precision, &hash);
    assert_int_equal(status, CORE_AHEAD_ALL ? MCOR_OK : MCOR_DEVICE_ERROR);
    const char* text = mcor_last_error(context);
    CORE_CHECK(CORE_AHEAD_ALL ||
        (strstr(text, cases[c].words) && strstr(text, "MCOR_AHEAD=all") &&
          !strstr(text, cases[c].others)),
      text);
  }
}

/* If no device can do a call, the call fails, and later calls give the same as before. */
static void test_goes_on(void** state)
{
  CORE_CONTEXT context = NULL;
  CORE_OK(context, mcor_create_context(NULL, &context));
  assert_string_equal(context->cl.platform_name, "built in");
  uint64_t before, after;
  CORE_OK(context, extract(context, &before));
  setenv("MCOR_LANES", "1", 1); /* no kernel is compiled ahead for this number of lanes */
  for (int i = 0; i < 2; ++i)
  {
    assert_int_equal(extract(context, &after), MCOR_DEVICE_ERROR);
  }
  unsetenv("MCOR_LANES");
  CORE_OK(context, extract(context, &after));
  assert_true(after == before);
}

CORE_MAIN(NULL, NULL, test_goes_on, test_names_what_is_missing)
