/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_vector_h
#define mcor_vector_h

/* Vectors in space. */

#include <math.h>

#define MCOR_PI 3.14159265358979323846

static inline double mcor_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void mcor_cross(const double a[3], const double b[3], double cross[3])
{
  for (int i = 0; i < 3; ++i)
  {
    cross[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
  }
}

static inline void mcor_subtract(const double a[3], const double b[3], double difference[3])
{
  for (int i = 0; i < 3; ++i)
  {
    difference[i] = a[i] - b[i];
  }
}

/* Finds the point at a place, from 0 to 1, on the way from one point to another. */
static inline void mcor_point_between(
  const double from[3], const double to[3], double place, double point[3])
{
  for (int a = 0; a < 3; ++a)
  {
    point[a] = from[a] + place * (to[a] - from[a]);
  }
}

/* Makes the vector as long as 1, unless it is 0; returns how long it was. */
static inline double mcor_normalise(double vector[3])
{
  const double length = sqrt(mcor_dot(vector, vector));
  for (int a = 0; a < 3 && length > 0; ++a)
  {
    vector[a] /= length;
  }
  return length;
}

#endif
