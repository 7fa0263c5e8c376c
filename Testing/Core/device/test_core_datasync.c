/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Our programs' fdatasync: libraries that they load find it, and it waits for nothing. */

#define _GNU_SOURCE /* for RTLD_DEFAULT */

#include "core_fixture.h"

#include <dlfcn.h>
#include <unistd.h>

static void test_libraries_find_it(void** state)
{
  int ends[2];
  (void)state;
  int (*found)(int) = (int (*)(int))(size_t)dlsym(RTLD_DEFAULT, "fdatasync");
  assert_true(found != NULL);
  assert_int_equal(pipe(ends), 0);
  /* The system's has an error for what cannot be synchronised. */
  assert_int_equal(found(ends[1]), 0);
  close(ends[0]);
  close(ends[1]);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_libraries_find_it) };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
