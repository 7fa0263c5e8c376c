/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Progress is told, and cancelling heard. */

#include "mcor_internal.h"

#include <math.h>

mcor_status mcor_report(mcor_context* context, const char* doing, double fraction, double end)
{
  const mcor_options* options = context->options;
  context->doing = doing;
  context->fraction = fmax(fraction, context->fraction); /* also in a second attempt */
  context->fraction_end = end;
  context->report_time = mcor_seconds();
  MCOR_RETURN_IF(
    options->progress && options->progress(options->progress_user, context->fraction, doing) != 0,
    context, MCOR_CANCELLED, "The run was cancelled during: %s.", doing);
  return MCOR_OK;
}

/* How many launches are to come is not known: each report goes a part of what is left. */
#define MCOR_REPORT_STEP 0.125

mcor_status mcor_report_launch(mcor_context* context)
{
  const mcor_options* options = context->options;
  if (!options || !options->progress ||
    mcor_seconds() - context->report_time < context->report_interval)
  {
    return MCOR_OK;
  }
  const double rest = fmax(context->fraction_end - context->fraction, 0);
  return mcor_report(
    context, context->doing, context->fraction + MCOR_REPORT_STEP * rest, context->fraction_end);
}
