/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* What people ask of the gradient of a velocity, J = S + O: S symmetric, O antisymmetric. */

#include "mcor.h"
#include "mcor_parallel.h"

#include <math.h>

typedef struct mcor_decompose_job
{
  const double* gradients;
  const mcor_flow* flow;
} mcor_decompose_job;

/* The eigenvalue in the middle of a symmetric matrix, by the roots of its characteristic polynomial
 * as cosines (O. K. Smith, Eigenvalues of a symmetric 3 x 3 matrix, Commun. ACM 4, 1961). */
static double mcor_middle_eigenvalue(const double m[3][3])
{
  const double mean = (m[0][0] + m[1][1] + m[2][2]) / 3;
  double square = 0, most = 0;
  double d[3][3];
  for (int i = 0; i < 9; ++i)
  {
    d[i / 3][i % 3] = m[i / 3][i % 3] - (i % 4 == 0 ? mean : 0);
    most = fmax(most, fabs(d[i / 3][i % 3]));
  }
  if (!(most > 0))
  {
    return mean;
  }
  for (int i = 0; i < 9; ++i)
  {
    d[i / 3][i % 3] /= most; /* so that no power overflows or vanishes */
    square += d[i / 3][i % 3] * d[i / 3][i % 3];
  }
  const double p = sqrt(square / 6);
  const double det = d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) -
    d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
    d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
  const double cosine = fmin(fmax(det / (2 * p * p * p), -1), 1);
  const double angle = acos(cosine) / 3, third = 2.0943951023931954923; /* 2 pi / 3 */
  /* The largest at `angle`, the smallest a third further, the middle one a third back. */
  return mean + most * 2 * p * cos(angle - third);
}

static void mcor_decompose(const double j[3][3], const mcor_flow* flow, int64_t i)
{
  double s[3][3], squares[3][3], trace = j[0][0] + j[1][1] + j[2][2], jj = 0;
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      s[a][b] = 0.5 * (j[a][b] + j[b][a]);
      jj += j[a][b] * j[b][a];
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      squares[a][b] = 0;
      for (int k = 0; k < 3; ++k)
      {
        const double left = j[a][k] - s[a][k], right = j[k][b] - s[k][b];
        squares[a][b] += s[a][k] * s[k][b] + left * right;
      }
    }
  }
  if (flow->divergence)
  {
    flow->divergence[i] = trace;
  }
  if (flow->q_criterion)
  {
    flow->q_criterion[i] = 0.5 * (trace * trace - jj);
  }
  if (flow->lambda2)
  {
    flow->lambda2[i] = mcor_middle_eigenvalue(squares);
  }
  for (int a = 0; a < 3 && flow->vorticity; ++a)
  {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    flow->vorticity[3 * i + a] = j[c][b] - j[b][c];
  }
  for (int k = 0; k < 9 && flow->strain_rate; ++k)
  {
    flow->strain_rate[9 * i + k] = s[k / 3][k % 3];
  }
}

static void mcor_decompose_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_decompose_job* job = data;
  for (int64_t i = first; i < last; ++i)
  {
    mcor_decompose((const double(*)[3])(job->gradients + 9 * i), job->flow, i);
  }
  (void)slice;
}

mcor_status mcor_decompose_gradients(const double* gradients, int64_t count, const mcor_flow* flow)
{
  if (!flow || count < 0 || (count > 0 && !gradients))
  {
    return MCOR_INVALID_ARGUMENT;
  }
  mcor_decompose_job job = { gradients, flow };
  mcor_parallel_for(count, MCOR_HEAVY_GRAIN, mcor_decompose_slice, &job);
  return MCOR_OK;
}
