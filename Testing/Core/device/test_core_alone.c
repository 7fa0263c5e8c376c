/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The built-in device where no driver is; ctest hides them from this program. */

#include "core_fixture.h"

#include <stdlib.h>

static mcor_status extract(mcor_context* context, uint64_t* hash)
{
  core_set set = core_make_block(7, 0.3, 3, core_ball);
  const double iso = 2;
  const mcor_input input = core_input(&set);
  const mcor_options options = core_options(&iso);
  mcor_surface surface = { 0 };
  const mcor_status status = mcor_extract(context, &input, &options, &surface);
  *hash = core_hash(&surface);
  mcor_free_surface(&surface);
  core_free_set(&set);
  return status;
}

/* A call for what no device can do fails, and the next ones are as if it had not been. */
static void test_goes_on(void** state)
{
  (void)state;
  mcor_context* context = NULL;
  CORE_OK(context, mcor_create_context(NULL, &context));
  assert_string_equal(context->cl.platform_name, "built in");
  uint64_t before, after;
  CORE_OK(context, extract(context, &before));
  setenv("MCOR_LANES", "1", 1); /* of such kernels none is compiled */
  for (int i = 0; i < 2; ++i)
  {
    assert_int_equal(extract(context, &after), MCOR_DEVICE_ERROR);
  }
  unsetenv("MCOR_LANES");
  CORE_OK(context, extract(context, &after));
  assert_true(after == before);
  mcor_free_context(context);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_goes_on) };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
