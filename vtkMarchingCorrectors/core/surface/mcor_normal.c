/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Normals from triangles [III-D.4]: at all vertices of a preview, else only where the gradient
 * vanishes. The cross product weighs each triangle by its area. */

#include "mcor_internal.h"
#include "mcor_parallel.h"
#include "mcor_vector.h"

#include <stdlib.h>

typedef struct mcor_normals
{
  mcor_surface* surface;
  double* sums; /* [point_count][3] */
  double scale; /* a power of 2 that scales lengths to about 1 */
  bool all;
} mcor_normals;

static void mcor_store_sums(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_normals* job = data;
  for (int64_t i = first; i < last; ++i)
  {
    float* n = job->surface->normals + 3 * i;
    const double* s = job->sums + 3 * i;
    const double length = sqrt(mcor_dot(s, s));
    const bool wanted = job->all || mcor_lacks_normal(n);
    for (int a = 0; a < 3 && wanted; ++a)
    {
      n[a] = length > 0 ? (float)(s[a] / length) : (a == 2 ? 1.0f : 0.0f);
    }
  }
  (void)slice;
}

/* Triangles between two progress reports. */
#define MCOR_NORMAL_STEP (1 << 18)

mcor_status mcor_finish_normals(mcor_context* context, mcor_surface* surface)
{
  int exponent = 0;
  frexp(context->lattice.cube, &exponent);
  mcor_normals job = { .surface = surface,
    .scale = ldexp(1, -exponent),
    .all = context->run.options->preview || context->run.options->triangle_normals };
  if (!job.all && context->run.normals_lacking == 0)
  {
    return MCOR_OK;
  }
  job.sums = calloc((size_t)surface->point_count * 3 + 1, sizeof(double));
  MCOR_TRY(mcor_allocated(context, job.sums));
  mcor_status status = MCOR_OK;
  /* Runs on one thread: the order in which a point's triangles are added must not change. */
  for (int64_t i = 0; i < surface->triangle_count && status == MCOR_OK; ++i)
  {
    const int32_t* t = surface->triangles + 3 * i;
    double u[3], v[3], n[3];
    for (int a = 0; a < 3; ++a)
    {
      const double corner = surface->points[3 * (int64_t)t[0] + a];
      u[a] = (surface->points[3 * (int64_t)t[1] + a] - corner) * job.scale;
      v[a] = (surface->points[3 * (int64_t)t[2] + a] - corner) * job.scale;
    }
    mcor_cross(u, v, n);
    for (int c = 0; c < 9; ++c)
    {
      job.sums[3 * (int64_t)t[c / 3] + c % 3] += n[c % 3];
    }
    status = i % MCOR_NORMAL_STEP == 0 ? mcor_report_launch(context) : MCOR_OK;
  }
  MCOR_THEN(status,
    mcor_parallel_run(
      context, surface->point_count, MCOR_LIGHT_GRAIN, mcor_store_sums, &job, NULL));
  free(job.sums);
  return status;
}
