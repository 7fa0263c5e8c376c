// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

#include "PeriodOfData.h"
#include "SafeText.h"

#include <vtkDataArray.h>
#include <vtkDataObject.h>
#include <vtkFieldData.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>

namespace
{

bool IsNamed(const char* name, const char* wanted)
{
  return name && std::strlen(name) == std::strlen(wanted) &&
    std::equal(name, name + std::strlen(name), wanted,
      [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
}

/// The values of a numeric array, in whatever tuples; `name` becomes as it is written. Empty: there is
/// none of so many values.
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

/// Whether there are periods, of which some may be 0.
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

} // namespace

//------------------------------------------------------------------------------
PeriodOfData FindPeriod(vtkDataObject* particles)
{
  vtkFieldData* data = particles->GetFieldData();
  PeriodOfData found;
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
  return ArePeriods(found.Period) ? found : PeriodOfData();
}

//------------------------------------------------------------------------------
void PassPeriod(vtkDataObject* from, vtkDataObject* to)
{
  vtkFieldData* data = from->GetFieldData();
  for (int i = 0; data && i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    for (const char* name : { "PeriodicBounds", "BoxSize", "box", "boundaryType" })
    {
      if (array && IsNamed(array->GetName(), name))
      {
        to->GetFieldData()->AddArray(array);
      }
    }
  }
}

//------------------------------------------------------------------------------
std::vector<double> DetectPeriod(vtkDataObject* particles)
{
  const PeriodOfData found = FindPeriod(particles);
  if (found.Period.empty())
  {
    throw std::runtime_error("The particles' field data tell of no period: there is no array "
                             "PeriodicBounds, BoxSize, or box with boundaryType. Give "
                             "--periodic LX,LY,LZ.");
  }
  return found.Period;
}

//------------------------------------------------------------------------------
std::string HintOfPeriod(vtkDataObject* particles)
{
  const PeriodOfData found = FindPeriod(particles);
  std::ostringstream hint;
  for (std::size_t i = 0; i < found.Period.size(); ++i)
  {
    hint << (i == 0 ? "the field data array " + Printable(found.Array) + " may be a period, " : ",")
         << found.Period[i];
  }
  hint << (found.Period.empty() ? ""
                                : ", which was not used; --periodic auto takes it, --periodic "
                                  "0,0,0 says that there is none");
  return hint.str();
}
