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
#include "vtkSPHSay.h"

#include <iomanip>
#include <sstream>
#include <stdexcept>

namespace
{

/// Returns the range as "0.1 .. 0.5"; for vectors as "(0, 0, 0) .. (1, 2, 3)", with each
/// component's own range.
std::string DescribeRange(vtkDataArray* array)
{
  const int count = array->GetNumberOfComponents();
  std::ostringstream ends[2];
  for (int c = 0; c < count; ++c)
  {
    double range[2];
    array->GetFiniteRange(range, c);
    if (!(range[0] <= range[1]))
    {
      return "no finite values";
    }
    for (int e = 0; e < 2; ++e)
    {
      ends[e] << std::setprecision(9)
              << (c > 0          ? ", "
                     : count > 1 ? "("
                                 : "")
              << range[e] << (c > 0 && c == count - 1 ? ")" : "");
    }
  }
  return ends[0].str() + " .. " + ends[1].str();
}

/// Returns the period as "1,1,0", or nothing.
std::string TextOf(const vtkSPHPeriod& found)
{
  std::ostringstream text;
  for (const double number : found.Period)
  {
    text << (text.tellp() > 0 ? "," : "") << number;
  }
  return text.str();
}

}

std::string DescribeArrays(vtkPointSet& particles)
{
  std::ostringstream text;
  text << "particles         " << particles.GetNumberOfPoints() << "\npositions         "
       << DescribeRange(particles.GetPoints()->GetData()) << "\n";
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
  const vtkSPHPeriod period = vtkSPHFindPeriod(particles.GetFieldData());
  const auto orNone = [](const std::string& name, const char* none)
  { return name.empty() ? none : name; };
  const std::string volume = !found.Volume.empty() ? found.Volume
    : !found.Mass.empty() && !found.Density.empty()
    ? found.Mass + " / " + found.Density
    : "computed from the positions" + (found.Mass.empty() ? "" : " and " + found.Mass);
  text << "smoothing length  "
       << orNone(found.SmoothingLength, "none (give --smoothing-length NAME, VALUE or estimate)")
       << "\nvolume            " << volume << "\nvelocity          "
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
  text << "\nperiod            "
       << orNone(TextOf(period), period.Array.empty() ? "none" : "none, as its cell is tilted")
       << (period.Period.empty() ? "" : " (field data " + period.Array + "; --periodic auto)")
       << "\ndimension         " << vtkNew<vtkMarchingCorrectors>()->FindDimension(&particles)
       << "\n";
  return text.str();
}

std::vector<double> CheckedPeriod(const vtkSPHPeriod& found, const std::string& problem)
{
  if (!problem.empty() || found.Period.empty())
  {
    const bool isTilted = problem.empty() && found.IsTilted();
    throw std::runtime_error(isTilted ? vtkSPHSay(MCOR_SAY(CELL_TILTED)) + " Leave out --periodic."
        : problem.empty()             ? vtkSPHSay(MCOR_SAY(NO_PERIOD))
                                      : problem);
  }
  return found.Period;
}

std::string HintOfPeriod(vtkDataObject* particles)
{
  const vtkSPHPeriod found = vtkSPHFindPeriod(particles->GetFieldData());
  return found.Period.empty()
    ? found.Array.empty() ? "" : vtkSPHSay(MCOR_SAY(CELL_TILTED))
    : "the field data array " + Printable(found.Array) + " may be a period (" + TextOf(found) +
      "), but was not used; --periodic auto uses it, --periodic 0,0,0 confirms that there is none";
}
