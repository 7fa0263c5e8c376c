/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
/* Extracts the free surface of one particle with the installed core. */
#include <mcor.h>

#include <stdio.h>

int main(void)
{
  const float position[3] = { 1.0f, 2.0f, 3.0f };
  const double iso = 0.5;
  mcor_context* context = NULL;
  mcor_input input = { 0 };
  mcor_options options;
  mcor_surface surface = { 0 };
  mcor_status status = mcor_create_context(NULL, &context);
  input.count = 1;
  input.positions.data = position;
  input.positions.type = MCOR_FLOAT32;
  input.positions.components = 3;
  input.smoothing_length.constant = 0.1;
  mcor_set_default_options(&options);
  options.field = MCOR_WEIGHT_SUM;
  options.iso_values = &iso;
  options.iso_count = 1;
  if (status == MCOR_OK)
  {
    status = mcor_extract(context, &input, &options, &surface);
  }
  if (status != MCOR_OK)
  {
    fprintf(stderr, "%s\n", mcor_last_error(context));
  }
  printf("core %s: %ld triangles\n", MCOR_VERSION, (long)surface.triangle_count);
  status = status == MCOR_OK && surface.triangle_count > 0 ? MCOR_OK : MCOR_INVALID_DATA;
  mcor_free_surface(&surface);
  mcor_free_context(context);
  return (int)status;
}
