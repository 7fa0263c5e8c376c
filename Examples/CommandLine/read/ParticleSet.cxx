// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleFile.h"

#include "Formats.h"
#include "Text.h"

#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHFound.h"
#include "vtkSPHSay.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

const char* const WallArrayName = "IsWall";

namespace
{

/// Returns one array in the fluid's type: the fluid's values, then the walls'. Walls without a fitting array
/// get the fluid's median of each component; in vtkGhostType they get 0, because walls are not copies.
vtkSmartPointer<vtkDataArray> Append(vtkDataArray* fluid, vtkDataArray* walls, vtkIdType wallCount)
{
  const vtkIdType count = fluid->GetNumberOfTuples();
  auto all = vtk::TakeSmartPointer(fluid->NewInstance());
  all->SetName(fluid->GetName());
  all->SetNumberOfComponents(fluid->GetNumberOfComponents());
  all->SetNumberOfTuples(count + wallCount);
  all->InsertTuples(0, count, 0, fluid);
  const bool haveOwn = walls && walls->GetNumberOfComponents() == fluid->GetNumberOfComponents();
  const bool haveMedian =
    !haveOwn && std::string(fluid->GetName()) != vtkDataSetAttributes::GhostArrayName();
  for (int c = 0; c < fluid->GetNumberOfComponents(); ++c)
  {
    std::vector<double> values(static_cast<std::size_t>(haveMedian ? count : 1));
    for (std::size_t i = 0; haveMedian && i < values.size(); ++i)
    {
      values[i] = fluid->GetComponent(static_cast<vtkIdType>(i), c);
    }
    const auto median = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), median, values.end());
    for (vtkIdType i = 0; i < wallCount; ++i)
    {
      all->SetComponent(count + i, c, haveOwn ? walls->GetComponent(i, c) : *median);
    }
  }
  return all;
}

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

vtkSmartPointer<vtkPolyData> PointsAt(vtkDataArray* places)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetData(places);
  data->SetPoints(points);
  return data;
}

std::vector<std::string> NamesOf(vtkFieldData* data)
{
  std::vector<std::string> names;
  for (vtkAbstractArray* array : vtkSPHListArrays(data))
  {
    names.emplace_back(array->GetName() ? array->GetName() : "");
  }
  return names;
}

void AddNumbers(vtkFieldData* data, const std::string& name, const std::vector<double>& numbers)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name.c_str());
  for (const double number : numbers)
  {
    array->InsertNextValue(number);
  }
  data->AddArray(array);
}

vtkSmartPointer<vtkPointSet> AddWalls(vtkPointSet* fluid, vtkPointSet* walls)
{
  if (!walls || fluid->GetNumberOfPoints() == 0)
  {
    return fluid; // without fluid there is nothing for walls to end
  }
  Require(!fluid->GetPointData()->HasArray(WallArrayName),
    std::string("the particles have an array '") + WallArrayName +
      "', the name by which --walls marks walls; use --fluid " + WallArrayName +
      "=VALUE, or rename it");
  const vtkIdType count = fluid->GetNumberOfPoints(), wallCount = walls->GetNumberOfPoints();
  const vtkSmartPointer<vtkPolyData> all =
    PointsAt(Append(fluid->GetPoints()->GetData(), walls->GetPoints()->GetData(), wallCount));
  for (vtkAbstractArray* each : vtkSPHListArrays(fluid->GetPointData()))
  {
    if (vtkDataArray* array = vtkDataArray::SafeDownCast(each)) // texts are left out
    {
      all->GetPointData()->AddArray(
        Append(array, walls->GetPointData()->GetArray(array->GetName()), wallCount));
    }
  }
  vtkNew<vtkUnsignedCharArray> marks;
  marks->SetName(WallArrayName);
  marks->SetNumberOfTuples(count + wallCount);
  marks->Fill(0.0);
  std::fill_n(marks->GetPointer(count), wallCount, 1);
  all->GetPointData()->AddArray(marks);
  all->SetFieldData(fluid->GetFieldData());
  return all;
}

std::string DescribeArrays(vtkPointSet& particles)
{
  std::ostringstream text;
  text << "particles         " << particles.GetNumberOfPoints() << "\npositions         "
       << DescribeRange(particles.GetPoints()->GetData()) << "\n";
  for (vtkAbstractArray* array : vtkSPHListArrays(particles.GetPointData()))
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
