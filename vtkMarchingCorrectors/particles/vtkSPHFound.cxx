// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHFound.h"

#include "mcor.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"

#include <deque>

VTK_ABI_NAMESPACE_BEGIN
vtkSPHPeriod vtkSPHFindPeriod(vtkFieldData* data)
{
  vtkSPHPeriod found;
  std::deque<std::vector<double>> values;
  std::vector<mcor_field_data> arrays;
  for (int i = 0; data && i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    if (!array || !mcor_tells_of_period(array->GetName()))
    {
      continue;
    }
    if (array->GetNumberOfValues() == 9)
    {
      found.Array = array->GetName(); // the sides of a tilted cell, as vectors
    }
    if (array->GetNumberOfValues() <= 6)
    {
      const int components = array->GetNumberOfComponents();
      values.emplace_back();
      for (int v = 0; v < array->GetNumberOfValues(); ++v)
      {
        values.back().push_back(array->GetComponent(v / components, v % components));
      }
      arrays.push_back({ array->GetName(), values.back().data(), array->GetNumberOfValues() });
    }
  }
  double period[6];
  int which;
  const int numbers =
    mcor_find_period(arrays.data(), static_cast<int>(arrays.size()), period, &which);
  if (numbers > 0)
  {
    found.Period.assign(period, period + numbers);
    found.Array = arrays[which].name;
  }
  return found;
}

bool vtkSPHTellsOfPeriod(const char* name)
{
  return mcor_tells_of_period(name) != 0;
}

bool vtkSPHTellsApart(const char* name)
{
  return mcor_tells_apart(name) != 0;
}

int vtkSPHPositionPriority(const char* name)
{
  return mcor_name_priority(MCOR_POSITION, name);
}

std::vector<double> vtkSPHBoundsOfPeriod(const std::vector<double>& period, const double extent[6])
{
  std::vector<double> bounds = period;
  if (period.size() == 3)
  {
    bounds.resize(6);
    mcor_place_period(period.data(), extent, bounds.data());
  }
  return bounds;
}

VTK_ABI_NAMESPACE_END
