/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Progress is told, and cancelling heard. */

#include "mcor_internal.h"

#include <math.h>

mcor_status mcor_report(mcor_context* context, const char* doing, double fraction, double end)
{
  const mcor_options* options = context->run.options;
  context->run.doing = doing;
  context->run.fraction = fmax(fraction, context->run.fraction); /* also in a second attempt */
  context->run.fraction_end = end;
  context->run.report_time = mcor_seconds();
  MCOR_RETURN_IF(options->progress &&
      options->progress(options->progress_user, context->run.fraction, doing) != 0,
    context, MCOR_CANCELLED, "The run was cancelled during: %s.", doing);
  return MCOR_OK;
}

/* How many launches are to come is not known: each report goes a part of what is left. */
#define MCOR_REPORT_STEP 0.125

mcor_status mcor_report_launch(mcor_context* context)
{
  const mcor_options* options = context->run.options;
  if (!options || !options->progress ||
    mcor_seconds() - context->run.report_time < context->report_interval)
  {
    return MCOR_OK;
  }
  const double rest = fmax(context->run.fraction_end - context->run.fraction, 0);
  return mcor_report(context, context->run.doing, context->run.fraction + MCOR_REPORT_STEP * rest,
    context->run.fraction_end);
}
