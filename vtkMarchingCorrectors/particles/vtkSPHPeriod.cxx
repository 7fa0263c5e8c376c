// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHPeriod.h"

#include "mcor.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkPointSet.h"
#include "vtkSPHAlgorithm.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

namespace
{
bool IsNamed(const char* name, const char* wanted)
{
  return name && std::strlen(name) == std::strlen(wanted) &&
    std::equal(name, name + std::strlen(name), wanted,
      [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
}

/** The values of a numeric array, in whatever tuples; `name` becomes as it is written. Empty: there is
 * none of so many values. */
std::vector<double> ValuesOf(
  vtkFieldData* data, const char* wanted, std::size_t count, std::string* name = nullptr)
{
  for (int i = 0; data && i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    if (array && IsNamed(array->GetName(), wanted) &&
      static_cast<std::size_t>(array->GetNumberOfValues()) == count)
    {
      const int components = array->GetNumberOfComponents();
      std::vector<double> values(count);
      for (std::size_t v = 0; v < count; ++v)
      {
        values[v] = array->GetComponent(
          static_cast<vtkIdType>(v) / components, static_cast<int>(v) % components);
      }
      if (name)
      {
        *name = array->GetName();
      }
      return values;
    }
  }
  return {};
}

/** Whether there are periods, of which some may be 0. */
bool ArePeriods(const std::vector<double>& period)
{
  const std::size_t step = period.size() / 3;
  bool some = false;
  for (std::size_t a = 0; a < 3 && step > 0; ++a)
  {
    const double length = period[step * a + step - 1] - (step == 2 ? period[2 * a] : 0.0);
    if (!std::isfinite(length) || length < 0.0)
    {
      return false;
    }
    some = some || length > 0.0;
  }
  return some;
}

/** Where a period begins of which only the length is known: so that the particles lie in it, at 0 or
 * around 0 if they can. */
double BeginOfPeriod(double length, double low, double high)
{
  const double rounding = 1e-6 * length;
  const auto holds = [&](double begin)
  { return low >= begin - rounding && high <= begin + length + rounding; };
  return holds(0.0) ? 0.0 : holds(-0.5 * length) ? -0.5 * length : low;
}
} // namespace

//------------------------------------------------------------------------------
vtkSPHPeriod vtkSPHFindPeriod(vtkFieldData* data)
{
  vtkSPHPeriod found;
  found.Period = ValuesOf(data, "PeriodicBounds", 6, &found.Array);
  if (!ArePeriods(found.Period))
  {
    found.Period = ValuesOf(data, "BoxSize", 3, &found.Array);
  }
  if (!ArePeriods(found.Period))
  {
    const std::vector<double> edge = ValuesOf(data, "BoxSize", 1, &found.Array);
    found.Period.assign(edge.empty() ? 0 : 3, edge.empty() ? 0.0 : edge.front());
  }
  if (!ArePeriods(found.Period))
  {
    found.Period = ValuesOf(data, "box", 6, &found.Array);
    const std::vector<double> type = ValuesOf(data, "boundaryType", 3);
    for (std::size_t a = 0; a < 3 && !found.Period.empty(); ++a)
    {
      if (type.empty() || type[a] != 1.0) // 0: open, 2: fixed
      {
        found.Period[2 * a] = found.Period[2 * a + 1] = 0.0;
      }
    }
  }
  return ArePeriods(found.Period) ? found : vtkSPHPeriod();
}

//------------------------------------------------------------------------------
bool vtkSPHTellsOfPeriod(const char* name)
{
  return IsNamed(name, "PeriodicBounds") || IsNamed(name, "BoxSize") || IsNamed(name, "box") ||
    IsNamed(name, "boundaryType");
}

//------------------------------------------------------------------------------
std::vector<double> vtkSPHBoundsOfPeriod(const std::vector<double>& period, const double extent[6])
{
  if (period.size() != 3)
  {
    return period;
  }
  std::vector<double> bounds(6, 0.0);
  for (std::size_t a = 0; a < 3; ++a)
  {
    const double length = period[a];
    bounds[2 * a] = length > 0.0 ? BeginOfPeriod(length, extent[2 * a], extent[2 * a + 1]) : 0.0;
    bounds[2 * a + 1] = bounds[2 * a] + length;
  }
  return bounds;
}

//------------------------------------------------------------------------------
bool vtkSPHAlgorithm::CheckPeriod(const vtkSPHPeriod& found, const std::string& problem)
{
  const std::string sentence = !problem.empty() ? problem
    : !found.Period.empty()
    ? ""
    : "The particles' field data tell of no period: there is no array PeriodicBounds, "
      "BoxSize, or box with boundaryType.";
  if (!sentence.empty())
  {
    this->Fail(sentence + " Set the periodic bounds, and turn their detection off.");
  }
  return sentence.empty();
}

//------------------------------------------------------------------------------
bool vtkSPHAlgorithm::SetPeriod(vtkPointSet* particles, mcor_options& options)
{
  if (!this->DetectPeriod)
  {
    return true;
  }
  const vtkSPHPeriod found = vtkSPHFindPeriod(particles->GetFieldData());
  if (!this->CheckPeriod(found, ""))
  {
    return false;
  }
  const std::vector<double> bounds = vtkSPHBoundsOfPeriod(found.Period, particles->GetBounds());
  std::copy(bounds.begin(), bounds.end(), options.periodic);
  return true;
}
