// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHColorRange.h"

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkMath.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkTriangle.h"

#include <algorithm>
#include <cmath>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
constexpr double LeftOut = 0.01;         // share of the area at either end
constexpr vtkIdType MostSamples = 20000; // more cells tell no more

double Measure(vtkDataSet* data, const vtkIdType* corners, vtkIdType count)
{
  double first[3], before[3], at[3], sum = 0.0;
  data->GetPoint(corners[0], first);
  std::copy_n(first, 3, at);
  for (vtkIdType i = 1; i < count; ++i)
  {
    std::copy_n(at, 3, before);
    data->GetPoint(corners[i], at);
    sum += i > 1 ? vtkTriangle::TriangleArea(first, before, at) : 0.0;
  }
  return count > 2 ? sum : std::sqrt(vtkMath::Distance2BetweenPoints(first, at));
}
}

vtkSPHColorRange::vtkSPHColorRange(vtkDataSet* data, const std::vector<bool>& isLeftOut)
  : IsoValues(vtkSPHFindIsoValues(data))
{
  auto* surface = vtkPolyData::SafeDownCast(data);
  vtkCellArray* cells = surface && surface->GetNumberOfPolys() > 0 ? surface->GetPolys()
    : surface && surface->GetNumberOfLines() > 0                   ? surface->GetLines()
                                                                   : nullptr;
  const vtkIdType total = cells ? cells->GetNumberOfCells() : data->GetNumberOfPoints();
  for (vtkIdType i = 0; i < total; i += total / MostSamples + 1)
  {
    if (!cells)
    {
      if (isLeftOut.empty() || !isLeftOut[i])
      {
        this->Samples.emplace_back(i, 1.0);
      }
      continue;
    }
    vtkIdType count;
    const vtkIdType* corners;
    cells->GetCellAtId(i, count, corners);
    const bool isLine = cells == surface->GetLines();
    for (vtkIdType c = isLine ? 1 : 0; c < count; ++c)
    {
      const double measure =
        isLine ? Measure(data, corners + c - 1, 2) : Measure(data, corners, count);
      this->Samples.emplace_back(corners[c], measure);
    }
  }
}

bool vtkSPHColorRange::Find(vtkDataArray* array, double range[2]) const
{
  if (array == this->IsoValues) // each iso value counts, however small its surface is
  {
    array->GetFiniteRange(range, 0);
    return range[0] <= range[1];
  }
  std::vector<std::pair<double, double>> found; // values and their shares
  double total = 0.0;
  const int components = array->GetNumberOfComponents();
  std::vector<double> tuple(components);
  for (const auto& sample : this->Samples)
  {
    array->GetTuple(sample.first, tuple.data());
    const double value = components > 1 ? vtkMath::Norm(tuple.data(), components) : tuple[0];
    if (std::isfinite(value))
    {
      found.emplace_back(value, sample.second);
      total += sample.second;
    }
  }
  if (found.empty())
  {
    return false;
  }
  std::sort(found.begin(), found.end());
  const auto findEnd = [total](auto at) // the first value behind the share that is left out
  {
    double below = at->second;
    for (; total > 0.0 && below <= LeftOut * total; below += at->second)
    {
      ++at;
    }
    return at->first;
  };
  range[0] = findEnd(found.begin());
  range[1] = findEnd(found.rbegin());
  if (!(range[0] < range[1]))
  {
    range[0] = found.front().first;
    range[1] = found.back().first;
  }
  return true;
}
VTK_ABI_NAMESPACE_END
