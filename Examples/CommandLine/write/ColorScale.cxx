// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ColorScale.h"

#include "Job.h"
#include "ParticleFile.h"
#include "Text.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkPointData.h"
#include "vtkSPHColorRange.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>

namespace
{

/// The colours go from blue over green to a pale yellow. They become evenly brighter, also in grey,
/// and low values are light enough to show shading.
constexpr int StopCount = 9;
const double Stops[StopCount][3] = { { 0.200, 0.330, 0.620 }, { 0.200, 0.430, 0.690 },
  { 0.210, 0.530, 0.740 }, { 0.270, 0.620, 0.760 }, { 0.370, 0.710, 0.740 },
  { 0.510, 0.790, 0.690 }, { 0.670, 0.860, 0.630 }, { 0.830, 0.920, 0.600 },
  { 0.980, 0.970, 0.660 } };
}

ColorScale::ColorScale(const PictureOptions& options)
  : Name(options.ColorBy)
  , IsGiven(!options.ColorRange.empty())
  , HasRange(IsGiven)
{
  const int count = 256;
  this->Table->SetNumberOfTableValues(count);
  this->Table->SetVectorModeToMagnitude();
  this->Table->SetNanColor(0.6, 0.6, 0.6, 1.0);
  for (int i = 0; i < count; ++i)
  {
    const double place = static_cast<double>(i) / (count - 1) * (StopCount - 1);
    const int stop = std::min(static_cast<int>(place), StopCount - 2);
    double color[3];
    for (int c = 0; c < 3; ++c)
    {
      color[c] = Stops[stop][c] + (place - stop) * (Stops[stop + 1][c] - Stops[stop][c]);
    }
    this->Table->SetTableValue(i, color[0], color[1], color[2]);
  }
  if (this->IsGiven)
  {
    this->Table->SetTableRange(options.ColorRange[0], options.ColorRange[1]);
  }
}

void CheckColorName(const std::string& name, const std::vector<std::string>& names)
{
  const std::string nearest = NearestOf(name, names);
  Require(std::find(names.begin(), names.end(), name) != names.end(),
    "there is no array '" + name + "' to colour by" +
      (!nearest.empty()   ? nearest
          : names.empty() ? ""
                          : "; there are " + Joined(names)));
}

void ColorScale::Include(vtkDataSet* data)
{
  if (this->Name.empty() || data->GetNumberOfPoints() == 0)
  {
    return;
  }
  vtkDataArray* const ofPoints = this->ArrayOf(data);
  vtkDataArray* array = ofPoints ? ofPoints : this->CellArrayOf(data);
  if (!array)
  {
    CheckColorName(this->Name, NamesOf(data->GetPointData()));
  }
  Require(array != nullptr, "the array '" + this->Name + "' to colour by holds texts; choose one of numbers");
  if (this->Name == "BandValue" && data->GetFieldData()->HasArray("IsoValues"))
  {
    array = data->GetFieldData()->GetArray("IsoValues"); // missing bands have their colours, too
  }
  double range[2];
  array->GetFiniteRange(range, array->GetNumberOfComponents() > 1 ? -1 : 0);
  if (this->IsGiven || !(range[0] <= range[1]))
  {
    return;
  }
  if (array == ofPoints)
  {
    vtkSPHColorRange(data).Find(array, range);
  }
  const double* old = this->Table->GetTableRange();
  this->Table->SetTableRange(this->HasRange ? std::min(range[0], old[0]) : range[0],
    this->HasRange ? std::max(range[1], old[1]) : range[1]);
  this->HasRange = true;
}

vtkDataArray* ColorScale::ArrayOf(vtkDataSet* data) const
{
  return this->Name.empty() ? nullptr : data->GetPointData()->GetArray(this->Name.c_str());
}

vtkDataArray* ColorScale::CellArrayOf(vtkDataSet* data) const
{
  return this->Name.empty() ? nullptr : data->GetCellData()->GetArray(this->Name.c_str());
}

void ColorScale::Suggest(vtkDataSet* surface, const std::string& isoValueArray)
{
  vtkDataArray* values = surface->GetFieldData()->GetArray("IsoValues");
  if (this->Name.empty() && values && values->GetNumberOfTuples() > 1)
  {
    this->Name = surface->GetCellData()->HasArray("BandValue") ? "BandValue" : isoValueArray;
  }
}

std::vector<unsigned char> ColorScale::Map(vtkDataArray* array) const
{
  const auto colors =
    vtk::TakeSmartPointer(this->Table->MapScalars(array, VTK_COLOR_MODE_MAP_SCALARS, -1, VTK_RGB));
  const unsigned char* first = colors->GetPointer(0);
  return { first, first + colors->GetNumberOfValues() };
}
