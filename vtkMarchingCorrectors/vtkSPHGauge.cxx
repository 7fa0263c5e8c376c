// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHGauge.h"

#include "mcor.h"
#include "vtkAbstractArray.h"
#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkObjectFactory.h"
#include "vtkSPHArrays.h"
#include "vtkSPHPrint.h"
#include "vtkStringArray.h"
#include "vtkVariant.h"

#include <algorithm>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkSPHGauge);

void vtkSPHGauge::AddGauge(
  const char* name, double x0, double y0, double z0, double x1, double y1, double z1)
{
  this->AddPlace(name, 0, { x0, y0, z0, x1, y1, z1 });
}

void vtkSPHGauge::AddLines(vtkDataSet* lines, std::vector<Place>& gauges)
{
  vtkAbstractArray* names = lines->GetCellData()->GetAbstractArray("Name");
  for (vtkIdType i = 0; i < lines->GetNumberOfCells(); ++i)
  {
    vtkCell* cell = lines->GetCell(i);
    if (cell->GetCellDimension() != 1)
    {
      continue;
    }
    Place gauge;
    gauge.Name = names ? names->GetVariantValue(i * names->GetNumberOfComponents()).ToString()
                       : "line " + std::to_string(i);
    gauge.Numbers.resize(6);
    lines->GetPoint(cell->GetPointId(0), gauge.Numbers.data());
    lines->GetPoint(
      cell->GetPointId(static_cast<int>(cell->GetNumberOfPoints()) - 1), gauge.Numbers.data() + 3);
    gauges.push_back(gauge);
  }
}

std::vector<vtkSPHMeter::Place> vtkSPHGauge::ListPlaces(vtkDataObject* more)
{
  std::vector<Place> gauges = this->Places;
  if (auto* lines = vtkDataSet::SafeDownCast(more))
  {
    AddLines(lines, gauges);
  }
  if (gauges.empty() && !more)
  {
    const double *a = this->Point1, *b = this->Point2;
    gauges.push_back({ "gauge", 0, { a[0], a[1], a[2], b[0], b[1], b[2] } });
  }
  return gauges;
}

int vtkSPHGauge::Measure(mcor_context* context, const mcor_input& input,
  const mcor_options& options, const std::vector<Place>& places, vtkTable* table,
  std::vector<bool>& outside, mcor_statistics& statistics) const
{
  std::vector<mcor_gauge_line> lines;
  for (const Place& place : places)
  {
    mcor_gauge_line line = {};
    std::copy_n(place.Numbers.data(), 3, line.from);
    std::copy_n(place.Numbers.data() + 3, 3, line.to);
    line.name = place.Name.c_str();
    lines.push_back(line);
  }
  mcor_gauges gauges = {};
  const int status = mcor_gauge(
    context, &input, &options, lines.data(), static_cast<int64_t>(lines.size()), &gauges);
  if (status != MCOR_OK)
  {
    return status;
  }
  const auto count = static_cast<vtkIdType>(gauges.count);
  auto* states = vtkSPHAddColumn<vtkStringArray>(table, "state", count);
  auto* first = vtkSPHAddColumn<vtkDoubleArray>(table, "first", count);
  auto* last = vtkSPHAddColumn<vtkDoubleArray>(table, "last", count);
  auto* depth = vtkSPHAddColumn<vtkDoubleArray>(table, "depth", count);
  auto* crossings = vtkSPHAddColumn<vtkIdTypeArray>(table, "crossings", count);
  vtkDoubleArray* place[3] = { vtkSPHAddColumn<vtkDoubleArray>(table, "x", count),
    vtkSPHAddColumn<vtkDoubleArray>(table, "y", count),
    vtkSPHAddColumn<vtkDoubleArray>(table, "z", count) };
  for (vtkIdType i = 0; i < count; ++i)
  {
    const mcor_gauge_reading& reading = gauges.readings[i];
    outside.push_back(reading.outside != 0);
    states->SetValue(i, mcor_gauge_state_name(reading.state));
    first->SetValue(i, reading.first);
    last->SetValue(i, reading.last);
    depth->SetValue(i, reading.depth);
    crossings->SetValue(i, reading.crossing_count);
    for (int a = 0; a < 3; ++a)
    {
      place[a]->SetValue(i, reading.place[a]);
    }
  }
  statistics = gauges.statistics;
  mcor_free_gauges(&gauges);
  return status;
}

void vtkSPHGauge::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkSPHPrintMacro(Point1, Point2);
  for (const Place& gauge : this->Places)
  {
    os << indent << "Gauge " << gauge.Name << ":";
    std::for_each(
      gauge.Numbers.begin(), gauge.Numbers.end(), [&os](double number) { os << " " << number; });
    os << "\n";
  }
}
VTK_ABI_NAMESPACE_END
