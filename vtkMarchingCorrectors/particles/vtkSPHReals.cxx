// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHReals.h"

#include "vtkAOSDataArrayTemplate.h"
#include "vtkDoubleArray.h"

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
  copy->DeepCopy(array);
  return copy;
}

vtkIdType vtkSPHMarkSolids(vtkDataArray* array, double fluid, std::uint8_t* solid)
{
  const vtkSmartPointer<vtkDataArray> real = vtkSPHAsReal(array);
  const vtkSPHReals values(real);
  vtkIdType fluidCount = 0;
  for (vtkIdType i = 0; i < real->GetNumberOfTuples(); ++i)
  {
    solid[i] = values(i, 0) == fluid ? 0 : 1;
    fluidCount += solid[i] ? 0 : 1;
  }
  return fluidCount;
}

// An array without kinds has too many values: its first ones suffice to see that.
std::map<double, vtkIdType> vtkSPHCountValues(vtkDataArray* array, std::size_t most)
{
  std::map<double, vtkIdType> counts;
  for (vtkIdType i = 0; i < array->GetNumberOfTuples() && counts.size() <= most; ++i)
  {
    ++counts[array->GetComponent(i, 0)];
  }
  return counts.size() <= most ? counts : std::map<double, vtkIdType>();
}
VTK_ABI_NAMESPACE_END
