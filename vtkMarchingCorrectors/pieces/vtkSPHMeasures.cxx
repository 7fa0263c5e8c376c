// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHMeasures.h"

#include "mcor.h"
#include "vtkMath.h"
#include "vtkSPHArrays.h"

#include <algorithm>
#include <cstdint>

namespace
{
/** A number of an edge that looks as if it were random: of edges that are not run through both ways, the sum
 * with signs is 0 by chance once in 2^64. */
std::uint64_t NumberOf(std::int32_t low, std::int32_t high)
{
  std::uint64_t x = (static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high)) +
    0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}
}

//------------------------------------------------------------------------------
// One triangle after the other, so that sums have one order; about one of the points, as coordinates may be
// large.
void vtkSPHAddMeasures(vtkFieldData* run, const mcor_surface& surface)
{
  double area = 0.0, volume = 0.0;
  std::uint64_t open = 0;
  const double* origin = surface.points;
  for (std::int64_t t = 0; t < surface.triangle_count; ++t)
  {
    const std::int32_t* triangle = surface.triangles + 3 * t;
    double c[3][3], u[3], v[3], n[3];
    for (int i = 0; i < 3; ++i)
    {
      vtkMath::Subtract(surface.points + 3 * static_cast<std::int64_t>(triangle[i]), origin, c[i]);
      const std::int32_t a = triangle[i], b = triangle[(i + 1) % 3];
      const std::uint64_t number = NumberOf(std::min(a, b), std::max(a, b));
      open += a < b ? number : 0 - number;
    }
    vtkMath::Subtract(c[1], c[0], u);
    vtkMath::Subtract(c[2], c[0], v);
    vtkMath::Cross(u, v, n);
    area += 0.5 * vtkMath::Norm(n);
    volume += vtkMath::Dot(c[0], n) / 6.0;
  }
  vtkSPHAddReal(run, "Area", { area });
  if (open == 0 && surface.triangle_count > 0)
  {
    vtkSPHAddReal(run, "Volume", { volume });
  }
}
