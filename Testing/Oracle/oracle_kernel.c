/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle.h"

#include <math.h>
#include <stddef.h>

#define ORACLE_PI 3.14159265358979323846

double oracle_support(oracle_kernel kernel)
{
  return kernel == ORACLE_QUINTIC_SPLINE ? 3.0 : kernel == ORACLE_QUARTIC_SPLINE ? 2.5 : 2.0;
}

/* Integrates W and r^2 W by Simpson's rule, with the factor r^(d - 1) of a sphere or circle. M'4 is a product of
 * functions of x, y and z, so one axis is enough. */
double oracle_kernel_variance(oracle_kernel kernel, int dimensions)
{
  enum
  {
    STEPS = 6000 /* pieces of kernels end between steps */
  };
  const int d = kernel == ORACLE_M_PRIME_4 ? 1 : dimensions;
  const double step = oracle_support(kernel) / STEPS;
  double spread = 0.0, sum = 0.0;
  for (int i = 0; i <= STEPS; ++i)
  {
    const double offset[3] = { i * step, 0.0, 0.0 };
    const double share = i == 0 || i == STEPS ? 1.0 : i % 2 ? 4.0 : 2.0;
    const double w = share * oracle_kernel_value(kernel, 1.0, offset, NULL);
    sum += w * pow(i * step, d - 1);
    spread += w * pow(i * step, d + 1);
  }
  return spread / (d * sum);
}

/* Returns Monaghan's M4 without the factor 1/h^3, and its derivative in q. */
static double oracle_cubic(double q, double* slope)
{
  if (q < 1.0)
  {
    *slope = (-3.0 * q + 2.25 * q * q) / ORACLE_PI;
    return (1.0 - 1.5 * q * q + 0.75 * q * q * q) / ORACLE_PI;
  }
  *slope = -0.75 * (2.0 - q) * (2.0 - q) / ORACLE_PI;
  return 0.25 * (2.0 - q) * (2.0 - q) * (2.0 - q) / ORACLE_PI;
}

static double oracle_quadratic(double q, double* slope)
{
  *slope = 5.0 / (4.0 * ORACLE_PI) * (0.375 * q - 0.75);
  return 5.0 / (4.0 * ORACLE_PI) * (0.1875 * q * q - 0.75 * q + 0.75);
}

/* R: reach, the support radius in h. Returns the sum of factor[k] (R - k - q)^power over k = 0, 1, 2 with R - k > q,
 * divided by norm * pi. *slope: its derivative in q. */
static double oracle_spline(
  double reach, int power, const double factor[3], double norm, double q, double* slope)
{
  double value = 0.0;
  *slope = 0.0;
  for (int term = 0; term < 3; ++term)
  {
    const double u = reach - term - q;
    if (u > 0.0)
    {
      value += factor[term] * pow(u, power);
      *slope -= power * factor[term] * pow(u, power - 1);
    }
  }
  *slope /= norm * ORACLE_PI;
  return value / (norm * ORACLE_PI);
}

/* Returns norm / pi (1 - u)^power times a polynomial of u = r / support radius, as Dehnen and Aly (2012) write it. */
static double oracle_wendland(
  int power, const double factor[4], double norm, double q, double* slope)
{
  const double u = 0.5 * q;
  const double poly = factor[0] + u * (factor[1] + u * (factor[2] + u * factor[3]));
  const double rise = factor[1] + u * (2.0 * factor[2] + u * 3.0 * factor[3]);
  *slope =
    0.5 * norm / ORACLE_PI * (pow(1.0 - u, power) * rise - power * pow(1.0 - u, power - 1) * poly);
  return norm / ORACLE_PI * pow(1.0 - u, power) * poly;
}

/* The norm comes from an integral that was computed to 25 digits. */
static double oracle_sinc_6(double q, double* slope)
{
  const double norm = 0.790449589432302897356679, x = 0.5 * ORACLE_PI * q;
  if (x == 0.0)
  {
    *slope = 0.0;
    return norm;
  }
  const double s = sin(x) / x;
  *slope = norm * 6.0 * pow(s, 5.0) * 0.5 * ORACLE_PI * (cos(x) - s) / x;
  return norm * pow(s, 6.0);
}

/* Returns m(u), one factor of M'4, and its derivative in u; u = |dx| / h < 2. */
static double oracle_m_prime_4(double u, double* slope)
{
  if (u < 1.0)
  {
    *slope = -5.0 * u + 4.5 * u * u;
    return 1.0 - 2.5 * u * u + 1.5 * u * u * u;
  }
  *slope = -0.5 * (2.0 - u) * (4.0 - 3.0 * u);
  return 0.5 * (2.0 - u) * (2.0 - u) * (1.0 - u);
}

static double oracle_tensor_value(double h, const double offset[3], double gradient[3])
{
  double value[3];
  double slope[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    const double u = fabs(offset[axis]) / h;
    if (!(u < 2.0))
    {
      return 0.0;
    }
    value[axis] = oracle_m_prime_4(u, &slope[axis]) / h;
    slope[axis] *= (offset[axis] < 0.0 ? -1.0 : 1.0) / (h * h);
  }
  if (gradient)
  {
    gradient[0] = slope[0] * value[1] * value[2];
    gradient[1] = value[0] * slope[1] * value[2];
    gradient[2] = value[0] * value[1] * slope[2];
  }
  return value[0] * value[1] * value[2];
}

double oracle_kernel_value(
  oracle_kernel kernel, double h, const double offset[3], double gradient[3])
{
  if (gradient)
  {
    gradient[0] = gradient[1] = gradient[2] = 0.0;
  }
  if (kernel == ORACLE_M_PRIME_4)
  {
    return oracle_tensor_value(h, offset, gradient);
  }
  const double r = sqrt(offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2]);
  const double q = r / h;
  if (!(q < oracle_support(kernel)))
  {
    return 0.0;
  }
  static const double quartic[3] = { 1.0, -5.0, 10.0 }, quintic[3] = { 1.0, -6.0, 15.0 };
  static const double c2[4] = { 1.0, 4.0 }, c4[4] = { 1.0, 6.0, 35.0 / 3.0 },
                      c6[4] = { 1.0, 8.0, 25.0, 32.0 };
  double slope;
  const double value = kernel == ORACLE_QUADRATIC ? oracle_quadratic(q, &slope)
    : kernel == ORACLE_QUARTIC_SPLINE             ? oracle_spline(2.5, 4, quartic, 20.0, q, &slope)
    : kernel == ORACLE_QUINTIC_SPLINE             ? oracle_spline(3.0, 5, quintic, 120.0, q, &slope)
    : kernel == ORACLE_WENDLAND_C2                ? oracle_wendland(4, c2, 21.0 / 16.0, q, &slope)
    : kernel == ORACLE_WENDLAND_C4                ? oracle_wendland(6, c4, 495.0 / 256.0, q, &slope)
    : kernel == ORACLE_WENDLAND_C6 ? oracle_wendland(8, c6, 1365.0 / 512.0, q, &slope)
    : kernel == ORACLE_SINC_6      ? oracle_sinc_6(q, &slope)
                                   : oracle_cubic(q, &slope);
  if (gradient && r > 0.0)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      gradient[axis] = slope / (h * h * h * h) * offset[axis] / r;
    }
  }
  return value / (h * h * h);
}
