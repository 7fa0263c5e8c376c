// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleFile.h"

#include "Text.h"

#include "vtkDataArray.h"
#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSPHFound.h"
#include "vtkSPHSay.h"

#include <sstream>

namespace
{

/// Returns the range as "0.1 .. 0.5"; for vectors as "(0, 0, 0) .. (1, 2, 3)", with each
/// component's own range.
std::string DescribeRange(vtkDataArray* array)
{
  std::vector<std::string> low, high;
  for (int c = 0; c < array->GetNumberOfComponents(); ++c)
  {
    double range[2];
    array->GetFiniteRange(range, c);
    if (!(range[0] <= range[1]))
    {
      return "no finite values";
    }
    low.push_back(DigitsOf(range[0], 9));
    high.push_back(DigitsOf(range[1], 9));
  }
  const auto text = [](const std::vector<std::string>& ends)
  { return ends.size() > 1 ? "(" + Joined(ends) + ")" : Joined(ends); };
  return text(low) + " .. " + text(high);
}

/// Returns the period as "1,1,0", or nothing.
std::string TextOf(const vtkSPHPeriod& found)
{
  std::vector<std::string> numbers;
  for (const double number : found.Period)
  {
    numbers.push_back(DigitsOf(number, 6));
  }
  return Joined(numbers, ",");
}

}

std::string DescribeArrays(vtkPointSet& particles)
{
  std::ostringstream text;
  text << "particles         " << particles.GetNumberOfPoints() << "\npositions         "
       << DescribeRange(particles.GetPoints()->GetData()) << "\n";
  for (vtkAbstractArray* array : ArraysOf(particles.GetPointData()))
  {
    auto* numbers = vtkDataArray::SafeDownCast(array);
    const int components = array->GetNumberOfComponents();
    text << "array             " << (array->GetName() ? array->GetName() : "(no name)") << ": "
         << components << (components == 1 ? " component, " : " components, ")
         << array->GetDataTypeAsString() << ", "
         << (numbers ? DescribeRange(numbers) : "not numbers") << "\n";
  }
  const vtkSPHFound found = vtkSPHFindArrays(&particles);
  const vtkSPHPeriod period = vtkSPHFindPeriod(particles.GetFieldData());
  const std::string value = DigitsOf(found.FluidValue, 6);
  const auto orNone = [](const std::string& name, const char* none)
  { return name.empty() ? none : name; };
  const std::string volume = !found.Volume.empty() ? found.Volume
    : !found.Mass.empty() && !found.Density.empty()
    ? found.Mass + " / " + found.Density
    : "computed from the positions" + (found.Mass.empty() ? "" : " and " + found.Mass);
  text << "smoothing length  "
       << orNone(found.SmoothingLength, "none (give --smoothing-length NAME, VALUE or estimate)")
       << "\nvolume            " << volume << "\nvelocity          "
       << orNone(found.Velocity, "none") << "\nfluid             "
       << (found.Fluid.empty()
              ? "all particles"
              : found.Fluid + " = " + value + " (give --fluid " + found.Fluid + "=" + value + ")")
       << "\nperiod            "
       << orNone(TextOf(period), period.Array.empty() ? "none" : "none, as its cell is tilted")
       << (period.Period.empty() ? "" : " (field data " + period.Array + "; --periodic auto)")
       << "\ndimension         " << vtkNew<vtkMarchingCorrectors>()->FindDimension(&particles)
       << "\n";
  return text.str();
}

std::vector<double> CheckedPeriod(const vtkSPHPeriod& found, const std::string& problem)
{
  const std::string why = found.IsTilted()
    ? vtkSPHSay(MCOR_SAY(CELL_TILTED)) + " Leave out --periodic."
    : vtkSPHSay(MCOR_SAY(NO_PERIOD));
  Require(problem.empty() && !found.Period.empty(), problem.empty() ? why : problem);
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
