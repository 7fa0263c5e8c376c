/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests what the core finds among named arrays and values given by hand: volumes, types of elements, the fluid, the
 * scalar, attributes, and error messages. */

#include "core_fixture.h"
#include "mcor_find.h"
#include "mcor_input.h"

#define COUNT 4

static const double x[3 * COUNT] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
static const double h[COUNT] = { 1, 1, 1, 1 }, volume[COUNT] = { 2, 2, 2, 2 },
                    mass[COUNT] = { 3, 3, 3, 3 }, density[COUNT] = { 4, 4, 4, 4 },
                    speed[COUNT] = { 0, 1, 2, 3 };
static const float v32[3 * COUNT] = { 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 };

static mcor_named of(const char* name, mcor_element type, int components, const void* data)
{
  return (mcor_named){ name, type, components, COUNT, data, { 0, 0 } };
}

static mcor_named real(const char* name, const double* data)
{
  return of(name, MCOR_ELEMENT_FLOAT64, 1, data);
}

static const mcor_named positions = { NULL, MCOR_ELEMENT_FLOAT64, 3, COUNT, x, { 0, 0 } };

static mcor_request request_of(unsigned wants)
{
  return (
    mcor_request){ .wants = wants, .find = 1, .active = -1, .scalar_component = MCOR_MAGNITUDE };
}

/* Frees the last result. Makes a new search, which must succeed. */
static void find(
  const mcor_request* request, const mcor_named* arrays, int count, mcor_found* found)
{
  mcor_free_found(found);
  assert_int_equal(mcor_find_input(request, &positions, arrays, count, NULL, found), MCOR_OK);
}

/* Frees the last result. Checks that a new search fails, and that its message has the words (see core_tells). */
static void refuse(const mcor_request* request, const mcor_named* arrays, int count,
  mcor_found* found, const char* words)
{
  mcor_free_found(found);
  assert_int_equal(
    mcor_find_input(request, &positions, arrays, count, NULL, found), MCOR_INVALID_ARGUMENT);
  CORE_CHECK(core_tells(&found->error, words), found->error.text, words);
}

/* Checks which arrays or values make the volumes, for combinations of the file's arrays and what is given by hand. */
static void test_volumes(void** state)
{
  const mcor_named all[] = { real("h", h), real("Volume", volume), real("Mass", mass),
    real("Density", density), real("V2", speed), real("M2", speed), real("D2", speed) };
  /* file: letters of the arrays that the file has (v volume, m mass, d density). given: v, m, d: an array by name; M,
   * D: a value; c: computed volumes; p: one volume for all particles; F: a flux wants them, P: a projection of the
   * density, W: with the weights M2, S: of densities summed from masses, A: of an array. used: what makes the
   * volumes. unused: what core_tells finds in the message on unused values; NULL: there is no message. */
  const struct
  {
    const char *file, *given, *used, *unused;
  } cases[] = { { "vmd", "", "Volume", NULL }, { "md", "", "Mass/Density", NULL },
    { "m", "", "Mass/", NULL }, { "d", "", "", NULL }, { "", "", "", NULL },
    { "vmd", "D", "Volume", "SIZE_BESIDE_ARRAY|density is|'Volume'" },
    { "vmd", "M", "Volume", "SIZE_BESIDE_ARRAY|mass is" }, { "vmd", "MD", "7/8", NULL },
    { "vmd", "mD", "M2/8", NULL }, { "vmd", "v", "V2", NULL },
    { "vmd", "vmd", "V2", "SIZE_BESIDE_VOLUME|mass and density are" },
    { "vmd", "vM", "V2", "SIZE_BESIDE_VOLUME|mass is" }, { "md", "D", "Mass/8", NULL },
    { "md", "M", "7/Density", NULL }, { "m", "D", "Mass/8", NULL },
    { "", "D", "", "DENSITY_WITHOUT_MASS" }, { "", "M", "7/", NULL }, { "vmd", "c", "Mass/", NULL },
    { "v", "c", "", NULL }, { "vmd", "cD", "Mass/", "SIZE_BESIDE_COMPUTED|density is" },
    { "vmd", "cv", "Mass/", "SIZE_BESIDE_COMPUTED|volume is" }, { "vmd", "p", "Volume", NULL },
    { "m", "p", "9", NULL }, { "md", "p", "Mass/Density", NULL }, { "", "p", "9", NULL },
    { "m", "pM", "9", "SIZE_BESIDE_ONE_VOLUME|mass is" },
    { "d", "vMF", "V2", "SIZE_BESIDE_VOLUME|mass is" }, { "", "vMF", "V2", NULL },
    { "m", "vDF", "V2", NULL }, { "", "vDP", "V28", NULL },
    { "m", "vDP", "V2Mass/", "SIZE_BESIDE_MASS|volume is" }, { "d", "vMP", "V27/", "SIZE_BESIDE_MASS" },
    { "m", "vPW", "V2Mass/", NULL }, { "m", "vDPW", "V2Mass/", "SIZE_BESIDE_VOLUME|density is" },
    { "", "vMPS", "V27/", NULL }, { "", "vmPAW", "V2M2/", NULL },
    { "", "vMPAW", "V27/", "SIZE_BESIDE_VOLUME|mass is" } };
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; ++c)
  {
    mcor_named arrays[8] = { all[0], all[4], all[5], all[6],
      of("Velocity", MCOR_ELEMENT_FLOAT32, 3, v32) };
    int count = 5;
    for (int k = 0; k < 3; ++k)
    {
      if (strchr(cases[c].file, "vmd"[k]))
      {
        arrays[count++] = all[1 + k];
      }
    }
    const char* given = cases[c].given;
    mcor_request request = request_of(MCOR_WANT_SIZES | (strchr(given, 'F') ? MCOR_WANT_FLOW : 0) |
      (strchr(given, 'P') ? MCOR_WANT_COLUMN : 0));
    request.names[MCOR_ROLE_VOLUME] = strchr(given, 'v') ? "V2" : NULL;
    request.names[MCOR_ROLE_MASS] = strchr(given, 'm') ? "M2" : "(automatic)";
    request.names[MCOR_ROLE_DENSITY] = strchr(given, 'd') ? "D2" : "";
    request.names[MCOR_ROLE_SCALAR] = strchr(given, 'S') ? "Density" : strchr(given, 'A') ? "D2" : NULL;
    request.names[MCOR_ROLE_WEIGHT] = strchr(given, 'W') ? "M2" : NULL;
    request.values[MCOR_ROLE_MASS] = strchr(given, 'M') ? 7 : 0;
    request.values[MCOR_ROLE_DENSITY] = strchr(given, 'D') ? 8 : 0;
    request.compute_volumes = strchr(given, 'c') != NULL;
    request.particle_volume = strchr(given, 'p') ? 9 : 0;
    CORE_OWNED(mcor_free_found) mcor_found found = { 0 };
    find(&request, arrays, count, &found);
    char used[64] = "";
    const mcor_array* sources[3] = { &found.input.volume, &found.input.mass, &found.input.density };
    for (int k = 0; k < 3; ++k)
    {
      const mcor_array* source = sources[k];
      char text[32] = "";
      snprintf(text, sizeof text, source->data ? "%s" : "%.0s%g", source->name ? source->name : "",
        source->constant);
      strcat(used, mcor_is_given(source) ? text : "");
      strcat(used, k == 1 && mcor_is_given(source) ? "/" : "");
    }
    CORE_CHECK(strcmp(used, cases[c].used) == 0, cases[c].file, cases[c].given, used);
    CORE_CHECK(cases[c].unused ? core_tells(&found.unused, cases[c].unused) : !found.unused.text,
      cases[c].file, cases[c].given, found.unused.text);
    /* Masses are found even if volumes are given. */
    assert_int_equal(mcor_is_given(&found.views[MCOR_ROLE_MASS]),
      strpbrk(cases[c].file, "m") || strpbrk(given, "mM"));
  }
}

/* Elements of any type, also with gaps between them, must be read alike. Aligned floats and doubles
 * without gaps are not copied. */
static void test_elements(void** state)
{
  const float gaps[2 * COUNT] = { 1, 0, 2, 0, 3, 0, 4, 0 };
  const double f64[COUNT] = { 1, 2, 3, 4 };
  const char odd[1 + sizeof f64] = { 0 };
  memcpy((char*)odd + 1, f64, sizeof f64);
#define ARRAY(element, type) of(#type, MCOR_ELEMENT_##element, 1, (const type[COUNT]){ 1, 2, 3, 4 })
  mcor_named arrays[] = { ARRAY(FLOAT32, float), ARRAY(FLOAT64, double), ARRAY(INT8, int8_t),
    ARRAY(UINT8, uint8_t), ARRAY(INT16, int16_t), ARRAY(UINT16, uint16_t), ARRAY(INT32, int32_t),
    ARRAY(UINT32, uint32_t), ARRAY(INT64, int64_t), ARRAY(UINT64, uint64_t),
    of("gaps", MCOR_ELEMENT_FLOAT32, 1, gaps), real("odd", (const double*)(const void*)(odd + 1)) };
  arrays[10].stride[0] = 2 * sizeof(float);
  const int count = (int)(sizeof arrays / sizeof arrays[0]);
  for (int i = 0; i < count; ++i)
  {
    mcor_request request = request_of(MCOR_WANT_SIZES);
    request.names[MCOR_ROLE_SMOOTHING_LENGTH] = arrays[i].name;
    CORE_OWNED(mcor_free_found) mcor_found found = { 0 };
    find(&request, arrays, count, &found);
    const mcor_array* length = &found.input.smoothing_length;
    const bool stays = i < 2;
    CORE_CHECK(stays == (length->data == arrays[i].data), arrays[i].name);
    assert_int_equal(length->type, i == 0 || i == 10 ? MCOR_FLOAT32 : MCOR_FLOAT64);
    assert_string_equal(length->name, arrays[i].name);
    for (int p = 0; p < COUNT; ++p)
    {
      const double value = mcor_array_at(length, p, 0);
      CORE_CHECK(value == p + 1, arrays[i].name, p, value);
    }
  }
}

/* An array that is both mass and weight is copied once: mcor_project compares the two pointers. */
static void test_one_view(void** state)
{
  const int32_t whole[COUNT] = { 1, 2, 3, 4 };
  const mcor_named arrays[] = { real("h", h), of("Mass", MCOR_ELEMENT_INT32, 1, whole),
    real("Density", density) };
  mcor_request request = request_of(MCOR_WANT_SIZES | MCOR_WANT_COLUMN);
  request.names[MCOR_ROLE_WEIGHT] = "Mass";
  CORE_OWNED(mcor_free_found) mcor_found found = { 0 };
  find(&request, arrays, 3, &found);
  assert_ptr_equal(found.views[MCOR_ROLE_WEIGHT].data, found.input.mass.data);
}

/* Checks that the fluid is found by DualSPHysics' types, by an array of 0 and 1, and by a value given by hand. Then
 * particles outside a range of an array are left out. */
static void test_fluid(void** state)
{
  const uint8_t codes[COUNT] = { 0, 1, 3, 3 }, wall[COUNT] = { 1, 0, 0, 0 };
  const double other[COUNT] = { 5, 6, 6, 6 }, halves[COUNT] = { 0, 0.5, 1, 1 },
               unknown[COUNT] = { -NAN, 0, NAN, 0 };
  const mcor_named arrays[] = { of("Type", MCOR_ELEMENT_UINT8, 1, codes),
    of("IsWall", MCOR_ELEMENT_UINT8, 1, wall), real("ptype", other),
    of(MCOR_WALL_BLOCK, MCOR_ELEMENT_UINT8, 1, wall) };
  mcor_request request = request_of(MCOR_WANT_FLUID);
  CORE_OWNED(mcor_free_found) mcor_found found = { 0 };
  request.find_fluid = 1;
  find(&request, arrays, 4, &found);
  assert_int_equal(found.which[MCOR_ROLE_FLUID], 0);
  assert_true(found.fluid_value == 3 && found.fluid_count == 2 && !found.unused_type.text);
  assert_true(found.input.solid[0] && found.input.solid[1] && !found.input.solid[2]);
  find(&request, arrays + 1, 3, &found);
  assert_true(
    found.which[MCOR_ROLE_FLUID] == 0 && found.fluid_value == 0 && found.fluid_count == 3);
  const mcor_named half = real("Type", halves); /* which are no types */
  find(&request, &half, 1, &found);
  assert_int_equal(found.which[MCOR_ROLE_FLUID], -1);
  assert_true(core_tells(&found.unused_type, "TYPE_UNUSED| 1 x 0, 1 x 0.5, 2 x 1.|{fluid Type}"));
  const mcor_named nan = real("Type", unknown);
  find(&request, &nan, 1, &found);
  assert_true(core_tells(&found.unused_type, "TYPE_UNUSED| 2 x 0, 2 x nan.|"));
  request.find_fluid = 0;
  find(&request, arrays, 4, &found);
  assert_true(found.which[MCOR_ROLE_FLUID] == -1 && !found.input.solid && found.fluid_count == 4);
  assert_true(core_tells(&found.unused_type, "TYPE_UNUSED|'Type'|seems to be 3."));
  find(&request, arrays + 3, 1, &found);
  assert_int_equal(found.unused_type.code, MCOR_SAYS_WALL_BLOCKS_UNUSED);
  for (request.find_fluid = 2; request.find_fluid > 0; --request.find_fluid) /* 1: nothing is said */
  {
    const mcor_named no_type = real("Mass", mass);
    find(&request, &no_type, 1, &found);
    CORE_CHECK(request.find_fluid == 2 ? core_tells(&found.unused_type, "NO_TYPE|arrays: Mass.")
                                       : !found.unused_type.text,
      request.find_fluid, found.unused_type.text);
  }
  const struct
  {
    const char* name;
    double low, high, fluid; /* -1: doubt is left */
  } cases[] = { { "ParticleType", 0, 1, 0 }, { "particle_type", 0, 1, 0 }, { "isFluid", 0, 1, 1 },
    { "isBoundary", 0, 1, 0 }, { "Type", 0, 3, 3 }, { "Type", 1, 3, 3 }, { "Type", 0, 1, 0 },
    { "Type", 3, 3, -1 }, { "Type", 0, 2, -1 }, { "ParticleType", 0, 3, -1 },
    { "ParticleType", 0, 0, -1 }, { "Type", -1, 3, -1 }, { "ParticleType", 0, 5, -1 },
    { "Temperature", 0, 1, -1 }, { NULL, 0, 1, -1 } };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
  {
    const double low = cases[i].low, high = cases[i].high, values[COUNT] = { high, low, low, high };
    const mcor_named array = real(cases[i].name, values);
    request.find_fluid = 1;
    find(&request, &array, 1, &found);
    const double fluid = found.which[MCOR_ROLE_FLUID] < 0 ? -1 : found.fluid_value;
    CORE_CHECK(fluid == cases[i].fluid, cases[i].name ? cases[i].name : "none", low, high, fluid);
  }
  double nine[9] = { 8, 7, 6, 5, 4, 3, 2, 1, NAN };
  const mcor_named place = { NULL, MCOR_ELEMENT_FLOAT64, 3, 9, (double[27]){ 0 }, { 0, 0 } },
                   type = { "Type", MCOR_ELEMENT_FLOAT64, 1, 9, nine, { 0, 0 } };
  for (int one = 0; one < 2; ++one) /* neither many different values nor one value tell types */
  {
    mcor_free_found(&found);
    assert_int_equal(mcor_find_input(&request, &place, &type, 1, NULL, &found), MCOR_OK);
    CORE_CHECK(!found.unused_type.text, one, found.unused_type.text);
    for (int i = 0; i < 9; ++i)
    {
      nine[i] = 4;
    }
  }
  request.names[MCOR_ROLE_FLUID] = "ptype";
  request.fluid_value = 7;
  find(&request, arrays, 4, &found);
  assert_string_equal(found.no_fluid, "No particle has ptype = 7");
  request.names[MCOR_ROLE_FLUID] = "Block: water";
  find(&request, arrays, 4, &found);
  assert_true(found.which[MCOR_ROLE_FLUID] == 3 && found.fluid_count == 3);
  const mcor_only only[] = { { "Type", 3, 3 }, { "Type", 0, 0 }, { "ptype", 5, 6 } };
  request = request_of(0);
  request.only = only;
  request.only_count = 3;
  find(&request, arrays, 4, &found);
  assert_true(found.fluid_count == 3 && found.input.solid[1] == MCOR_ABSENT);
  request.within[0] = -0.0; /* is no bound */
  find(&request, arrays, 4, &found);
  assert_int_equal(found.fluid_count, 3);
  request.within[0] = 0;
  request.within[1] = 0.5;
  request.within[4] = -1;
  request.within[5] = 1;
  request.only_count = 1;
  find(&request, arrays, 4, &found);
  assert_true(found.fluid_count == 1 && found.input.solid[3] == 0);
  request.within[5] = 0.5;
  find(&request, arrays, 4, &found);
  assert_string_equal(found.no_fluid, "No particle is within 0,0.5,0,0,-1,0.5 and left by Type=3");
  const mcor_only lacks = { "Typo", 0, 1 };
  request.only = &lacks;
  refuse(&request, arrays, 4, &found, "NO_SUCH_ARRAY|'Typo'|: Type, IsWall, ptype, WallBlock.");
}

/* The scalar may be named, be chosen as the most suitable of three arrays, or be a density summed from the particles.
 * Attributes and the arrays that fluxes need are checked, too. */
static void test_scalar_and_attributes(void** state)
{
  const int32_t id[COUNT] = { 3, 1, 2, 0 };
  const float vx[COUNT] = { 1, 4, 7, 10 }, vy[COUNT] = { 2, 5, 8, 11 }, vz[COUNT] = { 3, 6, 9, 12 };
  const mcor_named arrays[] = { real("h", h), of("Idp", MCOR_ELEMENT_INT32, 1, id),
    real("Speed", speed), of("vx", MCOR_ELEMENT_FLOAT32, 1, vx),
    of("vy", MCOR_ELEMENT_FLOAT32, 1, vy), of("vz", MCOR_ELEMENT_FLOAT32, 1, vz),
    real("vtkGhostType", speed), of("Velocity", MCOR_ELEMENT_FLOAT32, 3, v32),
    of("text", MCOR_ELEMENT_OTHER, 1, NULL), real("Mass", mass), real("Volume", volume) };
  mcor_request request =
    request_of(MCOR_WANT_SIZES | MCOR_WANT_SCALAR | MCOR_WANT_ATTRIBUTES | MCOR_WANT_FLUID);
  request.taken = "Normals\nSpeed_Y";
  request.excluded = "vz";
  request.has_iso_values = 1;
  CORE_OWNED(mcor_free_found) mcor_found found = { 0 };
  find(&request, arrays, 7, &found);
  assert_int_equal(found.which[MCOR_ROLE_SCALAR], 7);
  assert_string_equal(found.made[0].name, "Velocity");
  assert_memory_equal(found.input.scalar.data, v32, sizeof v32);
  assert_string_equal(found.iso_value_name, "Velocity_Magnitude");
  const int attributes[] = { 0, 2, 3, 4, 7 };
  assert_int_equal(found.input.attribute_count, 5);
  assert_memory_equal(found.attributes, attributes, sizeof attributes);
  assert_true(found.nearest_count == 1 && found.nearest[0] == 1);
  request.active = 2;
  request.scalar_component = 1;
  find(&request, arrays, 7, &found);
  assert_true(found.which[MCOR_ROLE_SCALAR] == 2 && found.input.scalar_component == 0);
  assert_string_equal(found.iso_value_name, "Speed");
  assert_int_equal(found.input.attribute_count, 4); /* the contoured array is not among them */
  request.active = 1;                               /* ids are not suitable */
  request.label = "along y";
  find(&request, arrays, 11, &found);
  assert_int_equal(found.which[MCOR_ROLE_SCALAR], 7);
  assert_string_equal(found.iso_value_name, "Velocity_along y");
  assert_true(found.nearest_count == 2 && found.nearest[1] == 8);
  request.names[MCOR_ROLE_SCALAR] = "Density";
  find(&request, arrays, 11, &found);
  assert_true(found.needs_densities && !found.input.scalar.data);
  mcor_take_densities(&found, density);
  assert_true(found.input.scalar.data == density && !found.input.density.data);
  find(&request, arrays, 10, &found);
  mcor_take_densities(&found, density);
  assert_true(found.input.density.data == density && found.input.mass.data == mass);
  request = request_of(MCOR_WANT_SIZES | MCOR_WANT_FLOW);
  find(&request, arrays, 11, &found);
  assert_int_equal(found.input.attribute_count, 2);
  assert_string_equal(found.input.attributes[1].name, "Density");
  assert_true(((const double*)found.input.attributes[1].data)[3] == 1.5);
  request.values[MCOR_ROLE_DENSITY] = 10;
  find(&request, arrays, 11, &found);
  assert_true(found.input.attributes[1].constant == 10 && found.attributes[1] == -1);
  assert_true(found.input.volume.data == volume && !found.unused.text);
  request = request_of(MCOR_WANT_SIZES | MCOR_WANT_COLUMN);
  request.names[MCOR_ROLE_WEIGHT] = "Mass";
  find(&request, arrays, 11, &found);
  assert_true(found.input.mass.data == mass && found.views[MCOR_ROLE_WEIGHT].data == mass);
  assert_true(found.input.volume.data == volume && !found.input.scalar.data);
}

/* Checks each message about arrays that are missing or not usable. */
static void test_errors(void** state)
{
  const double dp[COUNT] = { 0.5, 0.5, 0.5, 0.5 };
  const mcor_named arrays[] = { real("Rhop", density), real("Idp", speed), real("spacing", dp),
    of("Velocity", MCOR_ELEMENT_FLOAT32, 3, v32), of("text", MCOR_ELEMENT_OTHER, 1, NULL),
    { "short", MCOR_ELEMENT_FLOAT64, 1, 3, speed, { 0, 0 } },
    of("mass", MCOR_ELEMENT_FLOAT32, 3, v32) };
  const struct
  {
    unsigned wants;
    mcor_role role;
    const char *name, *words; /* what core_tells of the sentence */
  } cases[] = {
    { MCOR_WANT_SIZES, MCOR_ROLE_FLUID, NULL,
      "NO_SMOOTHING_LENGTH|coefh x sqrt(3) x dp|'spacing', particles are 0.5 apart: 0.65 "
      "is|: Rhop, Idp, spacing, Velocity, text, short, mass." },
    { MCOR_WANT_SIZES, MCOR_ROLE_SMOOTHING_LENGTH, "Velocity", "ARRAY_OF_VECTORS|'Velocity'|3 " },
    { MCOR_WANT_SIZES, MCOR_ROLE_MASS, "mass", "ARRAY_OF_VECTORS|The mass has 3 " },
    { MCOR_WANT_SIZES, MCOR_ROLE_SMOOTHING_LENGTH, "text", "ARRAY_WITHOUT_NUMBERS|'text'" },
    { MCOR_WANT_SIZES, MCOR_ROLE_SMOOTHING_LENGTH, "short", "ARRAY_TOO_SHORT|3 values for 4 " },
    { 0, MCOR_ROLE_FLUID, "typ", "NO_SUCH_ARRAY|'typ' for the fluid|{fluid}" },
    { MCOR_WANT_SCALAR, MCOR_ROLE_SCALAR, "T", "NO_SUCH_ARRAY|'T' for the scalar" },
    { MCOR_WANT_SCALAR, MCOR_ROLE_SCALAR_DOT, "Rhop",
      "DOT_OF_DIFFERENT_VECTORS|'Velocity' has 3|'Rhop' has 1" }
  };
  CORE_OWNED(mcor_free_found) mcor_found found = { 0 };
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; ++c)
  {
    mcor_request request = request_of(cases[c].wants);
    request.names[cases[c].role] = cases[c].name;
    request.values[MCOR_ROLE_SMOOTHING_LENGTH] = cases[c].role == MCOR_ROLE_MASS;
    refuse(&request, arrays, 7, &found, cases[c].words);
  }
  mcor_request request = request_of(MCOR_WANT_SCALAR);
  request.scalar_component = 3;
  refuse(&request, arrays, 6, &found, "NO_SUCH_COMPONENT|'Velocity'|component 3; choose 0 to 2");
  refuse(&request, arrays, 1, &found, "NO_SCALAR");
  request = request_of(MCOR_WANT_SIZES | MCOR_WANT_FLOW);
  request.values[MCOR_ROLE_SMOOTHING_LENGTH] = 1;
  refuse(&request, arrays, 3, &found, "NO_VELOCITY");
  request.estimate_smoothing_length = 1;
  request.wants = MCOR_WANT_SIZES;
  find(&request, arrays, 6, &found);
  assert_int_equal(found.unused.code, MCOR_SAYS_LENGTH_IN_VAIN);
  request.wants = MCOR_WANT_SIZES | MCOR_WANT_COLUMN;
  request.values[MCOR_ROLE_MASS] = 1;
  find(&request, arrays, 6, &found);
  assert_int_equal(found.unused.code, MCOR_SAYS_LENGTH_IN_VAIN);
}

/* The sum "Density" uses masses even if volumes are given. */
static void test_unused_beside_the_sum(void** state)
{
  const mcor_named arrays[] = { real("h", h), real("V2", volume), real("M2", mass) };
  for (int sums = 0; sums < 2; ++sums)
  {
    mcor_request request = request_of(MCOR_WANT_SIZES | MCOR_WANT_SCALAR);
    request.names[MCOR_ROLE_SCALAR] = sums ? "Density" : "h";
    request.names[MCOR_ROLE_VOLUME] = "V2";
    request.names[MCOR_ROLE_MASS] = "M2";
    request.values[MCOR_ROLE_DENSITY] = 8;
    CORE_OWNED(mcor_free_found) mcor_found found = { 0 };
    find(&request, arrays, 3, &found);
    assert_true(core_tells(&found.unused,
      sums ? "SIZE_BESIDE_VOLUME|given density is" : "SIZE_BESIDE_VOLUME|mass and density are"));
  }
}

static void test_walls(void** state)
{
  assert_true(mcor_tells_of_walls("Boundary_particles") && mcor_tells_of_walls("TANK") &&
    mcor_tells_of_walls("rb_particle_data_1"));
  assert_false(mcor_tells_of_walls("water") || mcor_tells_of_walls("") ||
    mcor_tells_of_walls(NULL) || mcor_tells_of_walls("wal"));
}

CORE_MAIN(NULL, NULL, test_volumes, test_elements, test_one_view, test_fluid,
  test_scalar_and_attributes, test_errors, test_unused_beside_the_sum, test_walls)
