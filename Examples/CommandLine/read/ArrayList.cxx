// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleFile.h"

#include "SafeText.h"

#include "vtkDataArray.h"
#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSPHFound.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

namespace
{

/// "0.1 .. 0.5", of vectors "(0, 0, 0) .. (1, 2, 3)": each component's own.
std::string DescribeRange(vtkDataArray* array)
{
  const int count = array->GetNumberOfComponents();
  std::ostringstream ends[2];
  bool isKnown = true;
  for (int c = 0; c < count; ++c)
  {
    const double infinity = std::numeric_limits<double>::infinity();
    double range[2] = { infinity, -infinity };
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
    {
      const double value = array->GetComponent(i, c);
      range[0] = std::isfinite(value) ? std::min(range[0], value) : range[0];
      range[1] = std::isfinite(value) ? std::max(range[1], value) : range[1];
    }
    isKnown = isKnown && range[0] <= range[1];
    for (int e = 0; e < 2; ++e)
    {
      ends[e] << std::setprecision(9)
              << (c              ? ", "
                     : count > 1 ? "("
                                 : "")
              << range[e] << (c > 0 && c == count - 1 ? ")" : "");
    }
  }
  return isKnown ? ends[0].str() + " .. " + ends[1].str() : "no finite values";
}

std::string DescribeVolume(const vtkSPHFound& found)
{
  return !found.Volume.empty()                      ? found.Volume
    : !found.Mass.empty() && !found.Density.empty() ? found.Mass + " / " + found.Density
    : !found.Mass.empty() ? "computed from the positions and " + found.Mass
                          : "computed from the positions";
}

std::string DescribePeriod(vtkPointSet& particles)
{
  const vtkSPHPeriod found = vtkSPHFindPeriod(particles.GetFieldData());
  std::ostringstream text;
  for (std::size_t i = 0; i < found.Period.size(); ++i)
  {
    text << (i ? "," : "") << found.Period[i];
  }
  return found.Period.empty() ? "none"
                              : text.str() + " (field data " + found.Array + "; --periodic auto)";
}

}

std::string DescribeArrays(vtkPointSet& particles)
{
  std::ostringstream text;
  text << "particles         " << particles.GetNumberOfPoints() << "\n";
  vtkPointData* data = particles.GetPointData();
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = data->GetAbstractArray(i);
    auto* numbers = vtkDataArray::SafeDownCast(array);
    const int components = array->GetNumberOfComponents();
    text << "array             " << (array->GetName() ? array->GetName() : "(no name)") << ": "
         << components << (components == 1 ? " component, " : " components, ")
         << array->GetDataTypeAsString() << ", "
         << (numbers ? DescribeRange(numbers) : "not numbers") << "\n";
  }
  const vtkSPHFound found = vtkSPHFindArrays(&particles);
  const auto orNone = [](const std::string& name, const char* none)
  { return name.empty() ? none : name; };
  text << "smoothing length  "
       << orNone(found.SmoothingLength, "none (give --smoothing-length NAME, VALUE or estimate)")
       << "\nvolume            " << DescribeVolume(found) << "\nvelocity          "
       << orNone(found.Velocity, "none") << "\nfluid             ";
  if (found.Fluid.empty())
  {
    text << "all particles";
  }
  else
  {
    text << found.Fluid << " = " << found.FluidValue << " (give --fluid " << found.Fluid << "="
         << found.FluidValue << ")";
  }
  text << "\nperiod            " << DescribePeriod(particles) << "\ndimension         "
       << vtkNew<vtkMarchingCorrectors>()->FindDimension(&particles) << "\n";
  return text.str();
}
