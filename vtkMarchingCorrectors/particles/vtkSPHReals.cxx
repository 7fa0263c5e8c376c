// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHReals.h"

#include "vtkAOSDataArrayTemplate.h"
#include "vtkDoubleArray.h"

#include <algorithm>
#include <atomic>
#include <cmath>

VTK_ABI_NAMESPACE_BEGIN
double vtkSPHValueOf(const mcor_array& array, std::int64_t i)
{
  if (!array.data)
  {
    return array.constant;
  }
  return array.type == MCOR_FLOAT32 ? static_cast<const float*>(array.data)[i]
                                    : static_cast<const double*>(array.data)[i];
}

double vtkSPHScalarOf(const mcor_input& core, vtkIdType particle)
{
  const int components = core.scalar.components;
  const vtkIdType first = particle * components;
  if (core.scalar_component >= 0 && !core.scalar_dot.data)
  {
    return vtkSPHValueOf(core.scalar, first + core.scalar_component);
  }
  double sum = 0.0;
  for (vtkIdType i = first; i < first + components; ++i)
  {
    sum += vtkSPHValueOf(core.scalar, i) *
      vtkSPHValueOf(core.scalar_dot.data ? core.scalar_dot : core.scalar, i);
  }
  return core.scalar_dot.data ? sum : std::sqrt(sum);
}

vtkSmartPointer<vtkDataArray> vtkSPHAsReal(vtkDataArray* array)
{
  if (vtkAOSDataArrayTemplate<float>::FastDownCast(array) ||
    vtkAOSDataArrayTemplate<double>::FastDownCast(array))
  {
    return array;
  }
  auto copy = vtkSmartPointer<vtkDoubleArray>::New();
  copy->SetNumberOfComponents(array->GetNumberOfComponents());
  copy->SetNumberOfTuples(array->GetNumberOfTuples());
  double* to = copy->GetPointer(0);
  vtkSPHForValues(array,
    [to](auto values, vtkIdType first)
    {
      std::transform(values.begin(), values.end(), to + first,
        [](auto value) { return static_cast<double>(value); });
    });
  return copy;
}

vtkIdType vtkSPHMarkSolids(vtkDataArray* array, double fluid, std::uint8_t* solid)
{
  std::atomic<vtkIdType> fluidCount{ 0 };
  vtkSPHForValues(array,
    [&](auto values, vtkIdType first)
    {
      vtkIdType count = 0;
      std::uint8_t* to = solid + first;
      for (const auto value : values)
      {
        const bool isFluid = static_cast<double>(value) == fluid;
        *to++ = isFluid ? 0 : 1;
        count += isFluid ? 1 : 0;
      }
      fluidCount += count;
    });
  return fluidCount;
}

// An array without kinds has too many values: its first ones suffice to see that.
std::map<double, vtkIdType> vtkSPHCountValues(vtkDataArray* array, std::size_t most)
{
  std::map<double, vtkIdType> counts;
  const vtkIdType number = array->GetNumberOfTuples();
  double last = 0.0;
  vtkIdType run = 0;
  for (vtkIdType i = 0; i < number && counts.size() <= most; ++i)
  {
    const double value = array->GetComponent(i, 0);
    if (run > 0 && value != last)
    {
      counts[last] += run;
      run = 0;
    }
    last = value;
    ++run;
  }
  if (run > 0)
  {
    counts[last] += run;
  }
  return counts.size() <= most ? counts : std::map<double, vtkIdType>();
}
VTK_ABI_NAMESPACE_END
