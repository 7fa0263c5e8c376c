/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests how arrays are recognised by their names, and how values suggest a period and an iso
 * value. */

#include "core_fixture.h"
#include "mcor_input.h"

static void test_names(void** state)
{
  static const struct
  {
    mcor_quantity quantity;
    const char* name;
    int priority;
  } names[] = { { MCOR_SMOOTHING_LENGTH, "Smoothing_Length", 0 },
    { MCOR_SMOOTHING_LENGTH, "smoothing length", 0 }, { MCOR_SMOOTHING_LENGTH, "hsml", 2 },
    { MCOR_SMOOTHING_LENGTH, "h", 3 }, { MCOR_MASS, "m", 3 },
    { MCOR_DENSITY, "Particle-Density", 2 }, { MCOR_DENSITY, "Rhop", 4 }, { MCOR_VOLUME, "Vol", 3 },
    { MCOR_VOLUME, "VolumetricMeasure", 4 }, { MCOR_VELOCITY, "Vel", 2 },
    { MCOR_PARTICLE_ID, "Idp", 0 }, { MCOR_PARTICLE_ID, "ParticleIDs", 2 },
    { MCOR_PARTICLE_ID, "iorig", 10 }, { MCOR_PARTICLE_ID, "UnsortedParticle_ID", 12 },
    { MCOR_PARTICLE_ID, "SortedParticle_ID", -1 }, { MCOR_PARTICLE_TYPE, "Type", 1 },
    { MCOR_POSITION, "Points", 0 }, { MCOR_POSITION, "coords", 7 },
    { MCOR_QUANTITY_COUNT, "m", -1 } };
  for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i)
  {
    const int priority = mcor_name_priority(names[i].quantity, names[i].name);
    CORE_CHECK(priority == names[i].priority, names[i].name, priority);
  }
  const char* const others[] = { "", "mas", "masss", "volume of it", NULL };
  for (int i = 0; i < 5 * MCOR_QUANTITY_COUNT; ++i)
  {
    assert_int_equal(mcor_name_priority((mcor_quantity)(i / 5), others[i % 5]), -1);
  }
  const char* const apart[] = { "Idp", "particle_id", "Type", "PARTICLE IDS 2", "mk", "iorig" };
  const char* const alike[] = { "", "idea", "d", "Density", "tagged", NULL };
  for (int i = 0; i < 6; ++i)
  {
    assert_true(mcor_tells_apart(apart[i]));
    assert_false(mcor_tells_apart(alike[i]));
  }
}

/* Checks which of several arrays gives the period, that an array that is no period gives none, and
 * where a period of known length begins. */
static void test_period_of_field_data(void** state)
{
  const double bounds[6] = { -1, 1, 0, 0, 0, 0 }, cube = 2, edges[3] = { 2, 0, 4 };
  const double box[6] = { -1, 3, -2, 2, 5, 6 }, kinds[3] = { 1, 0, 2 }, empty[6] = { 0 };
  const double wrong[6] = { 1, -1, 0, 0, 0, 0 }, extent[6] = { -1, 0.5, 0, 1, 7, 8 };
  mcor_field_data all[] = { { "boundaryType", kinds, 3 }, { "box", box, 6 },
    { "BoxSize", &cube, 1 }, { "BOX_SIZE", edges, 3 }, { "PeriodicBounds", bounds, 6 },
    { NULL, bounds, 6 } };
  double period[6];
  int which;
  assert_int_equal(mcor_find_period(all, 6, period, &which), 6);
  assert_int_equal(which, 4);
  assert_memory_equal(period, bounds, sizeof bounds);
  assert_int_equal(mcor_find_period(all, 4, period, &which), 3);
  assert_int_equal(which, 3);
  assert_memory_equal(period, edges, sizeof edges);
  assert_int_equal(mcor_find_period(all, 3, period, NULL), 3);
  assert_true(period[0] == 2 && period[1] == 2 && period[2] == 2);
  assert_int_equal(mcor_find_period(all, 2, period, &which), 6);
  assert_true(which == 1 && period[0] == -1 && period[1] == 3 && period[2] == 0 && period[5] == 0);
  assert_int_equal(mcor_find_period(all, 1, period, &which), 0);
  assert_int_equal(which, -1);
  all[4].values = wrong;
  assert_int_equal(mcor_find_period(all + 4, 1, period, NULL), 0);
  all[4].values = empty;
  assert_int_equal(mcor_find_period(all + 4, 1, period, NULL), 0);
  mcor_place_period((const double[3]){ 2, 2, 2 }, extent, period);
  assert_true(period[0] == -1 && period[1] == 1); /* around 0 */
  assert_true(period[2] == 0 && period[3] == 2);  /* from 0 on */
  assert_true(period[4] == 7 && period[5] == 9);  /* from the first particle on */
  mcor_place_period((const double[3]){ 0, 2, 2 }, extent, period);
  assert_true(period[0] == 0 && period[1] == 0);
  assert_true(mcor_tells_of_period("boundarytype") && mcor_tells_of_period("Box"));
  assert_false(mcor_tells_of_period("Boxes") || mcor_tells_of_period(NULL));
}

static void test_view_ranks(void** state)
{
  const int velocity = mcor_view_priority("vel", 3, 1, 1),
            vector = mcor_view_priority("Force", 3, 1, 1),
            scalar = mcor_view_priority("Pressure", 1, 1, 1),
            mass = mcor_view_priority("Mass", 1, 1, 1),
            tensor = mcor_view_priority("Stress", 9, 1, 1),
            whole = mcor_view_priority("Count", 1, 0, 1);
  assert_true(velocity >= 0 && velocity < vector && vector < scalar && scalar < mass);
  assert_true(mass < tensor && tensor < whole);
  assert_int_equal(mcor_view_priority("Pressure", 1, 1, 0), -1);
  assert_int_equal(mcor_view_priority("Velocity", 3, 1, 0), -1);
  assert_int_equal(mcor_view_priority("Idp", 1, 0, 1), -1);
  assert_int_equal(mcor_view_priority("ParticleType", 1, 1, 1), -1);
  assert_int_equal(mcor_view_priority(NULL, 1, 1, 1), -1);
}

/* Checks the suggested iso value: usually the median, but the middle of the range if many values are equal, and the
 * logarithmic middle if values span decades. Solids and values that are not finite are left out. */
static void test_iso_values(void** state)
{
  enum
  {
    count = 200001
  };
  CORE_FREED double* value = oracle_allocate(count, sizeof *value);
  CORE_FREED double* sorted = oracle_allocate(count, sizeof *sorted);
  CORE_FREED uint8_t* solid = oracle_allocate(count, 1);
  const mcor_input input = {
    .count = count, .scalar = { value, MCOR_FLOAT64, 1, 0, "A" }, .solid = solid
  };
  for (int kind = 0; kind < 8; ++kind)
  {
    int64_t fluid = 0;
    uint32_t seed = 7;
    for (int64_t i = 0; i < count; ++i)
    {
      seed = seed * 1664525u + 1013904223u;
      const double r = seed / 4294967296.0;
      const double values[] = { r, floor(10 * r), r < 0.6 ? 3 : r, pow(10, 6 * r - 3),
        i == 17 ? -1e300 : 1e-300 * r, i == 5 ? -1 : pow(10, 6 * r - 3), r < 0.6 ? 1e-9 * r : 2 * r,
        r < 0.97 ? 0 : r };
      value[i] = i % 1000 == 3 ? NAN : i % 1000 == 4 ? INFINITY : values[kind];
      solid[i] = i % 7 == 0;
      if (isfinite(value[i]) && !solid[i])
      {
        sorted[fluid++] = value[i];
      }
    }
    qsort(sorted, (size_t)fluid, sizeof *sorted, mcor_compare_doubles);
    double range[2], iso;
    assert_true(mcor_find_iso_value(&input, NULL, range, &iso));
    assert_true(range[0] == sorted[0] && range[1] == sorted[fluid - 1]);
    const double logs = sqrt(sorted[fluid / 50] * sorted[fluid - 1 - fluid / 50]);
    const double middle = 0.5 * sorted[fluid / 20] + 0.5 * sorted[fluid - 1 - fluid / 20];
    const double expected = kind == 3 ? logs
      : kind == 2 || kind == 6        ? middle
      : kind == 7                     ? 0.5 * sorted[0] + 0.5 * sorted[fluid - 1]
                                      : sorted[(fluid - 1) / 2];
    CORE_CHECK(fabs(iso - expected) <= (kind == 3 ? 1e-12 : 0), kind, iso, expected);
  }
  memset(solid, 1, count);
  double range[2] = { 1, 2 }, iso = 3;
  assert_false(mcor_find_iso_value(&input, NULL, range, &iso));
  assert_true(range[0] == 1 && range[1] == 2 && iso == 3);
}

static int count_wrong(void* user, mcor_reduction reduction, int64_t* values, int count)
{
  *(int*)user += reduction == MCOR_SUM_OF && count == 1 && values[0] != 0;
  return 0;
}

/* Checks that a scalar whose form mcor_extract refuses is not read, and that the other ranks learn of the refusal. Each
 * array is a heap block of its exact size, for sanitizers. */
static void test_iso_value_of_wrong_scalars(void** state)
{
  CORE_FREED double* three = oracle_allocate(2 * 3, sizeof *three);
  for (int i = 0; i < 6; ++i)
  {
    three[i] = i;
  }
  const mcor_array vector = core_array(three, 3), scalar = core_array(three, 1),
                   negative = core_array(three, -3),
                   unknown = { .data = three, .type = (mcor_type)7, .components = 1 };
  const mcor_input wrong[] = { { .count = 2, .scalar = vector, .scalar_component = 3 },
    { .count = 2, .scalar = vector, .scalar_component = 1 << 30 },
    { .count = 2, .scalar = vector, .scalar_component = -2 },
    { .count = 2, .scalar = scalar, .scalar_dot = vector },
    { .count = 2, .scalar = vector, .scalar_dot = scalar }, { .count = 2, .scalar = unknown },
    { .count = 2, .scalar = negative }, { .count = 2, .scalar = vector, .scalar_dot = unknown },
    { .count = 2 } };
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i)
  {
    int heard = 0;
    const mcor_ranks ranks = { .reduce_counts = count_wrong, .user = &heard };
    double range[2] = { 1, 2 }, iso = 3;
    CORE_CHECK(!mcor_find_iso_value(&wrong[i], NULL, range, &iso) &&
        !mcor_find_iso_value(&wrong[i], &ranks, range, &iso),
      i, iso);
    assert_true(range[0] == 1 && range[1] == 2 && iso == 3 && heard == 1);
  }
  double range[2], iso;
  const mcor_input last = { .count = 2, .scalar = vector, .scalar_component = 2 };
  assert_true(mcor_find_iso_value(&last, NULL, range, &iso));
  assert_true(range[0] == 2 && range[1] == 5 && iso >= 2 && iso <= 5);
}

CORE_MAIN(NULL, NULL, test_names, test_period_of_field_data, test_view_ranks,
  test_iso_values, test_iso_value_of_wrong_scalars)
