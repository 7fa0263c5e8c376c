/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Quantities of the gradient of a velocity, J = S + O: S symmetric, O antisymmetric. */

#include "mcor.h"
#include "mcor_parallel.h"

#include <math.h>

typedef struct mcor_decompose_job
{
  const double* gradients;
  const mcor_flow* flow;
} mcor_decompose_job;

/* Turns the symmetric matrix so that element (p, q) becomes 0. r is the third index. */
static void mcor_rotate_away(double m[3][3], int p, int q, int r)
{
  if (fabs(m[p][q]) < 1e-18 * (fabs(m[p][p]) + fabs(m[q][q])))
  {
    m[p][q] = m[q][p] = 0;
  }
  if (m[p][q] == 0)
  {
    return;
  }
  const double theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q];
  const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
  const double c = 1 / sqrt(t * t + 1), s = t * c;
  const double change = t * m[p][q], rp = m[r][p], rq = m[r][q];
  m[p][p] -= change;
  m[q][q] += change;
  m[p][q] = m[q][p] = 0;
  m[r][p] = m[p][r] = c * rp - s * rq;
  m[r][q] = m[q][r] = s * rp + c * rq;
}

/* Returns the middle eigenvalue of a symmetric matrix, by Jacobi's rotations. The roots of the
 * characteristic polynomial would lose half of the digits where two are equal, as they are for a
 * rotation. */
static double mcor_middle_eigenvalue(double m[3][3])
{
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (!isfinite(trace))
  {
    return trace;
  }
  for (int sweep = 0; sweep < 20 && (m[0][1] != 0 || m[0][2] != 0 || m[1][2] != 0); ++sweep)
  {
    mcor_rotate_away(m, 0, 1, 2);
    mcor_rotate_away(m, 0, 2, 1);
    mcor_rotate_away(m, 1, 2, 0);
  }
  const double low = fmin(m[0][0], m[1][1]), high = fmax(m[0][0], m[1][1]);
  return fmax(low, fmin(high, m[2][2]));
}

static void mcor_decompose_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_decompose_job* job = data;
  const mcor_flow* flow = job->flow;
  for (int64_t i = first; i < last; ++i)
  {
    const double(*j)[3] = (const double(*)[3])(job->gradients + 9 * i);
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
  (void)slice;
}

mcor_status mcor_decompose_gradients(const double* gradients, int64_t count, const mcor_flow* flow)
{
  if (!flow || count < 0 || (count > 0 && !gradients))
  {
    return MCOR_INVALID_ARGUMENT;
  }
  mcor_decompose_job job = { gradients, flow };
  mcor_parallel_for(NULL, count, MCOR_HEAVY_GRAIN, mcor_decompose_slice, &job);
  return MCOR_OK;
}
