// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHGauge.h"

#include "mcor.h"
#include "vtkCell.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkObjectFactory.h"
#include "vtkSPHArrays.h"
#include "vtkSPHPrint.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <iterator>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkSPHGauge);

std::vector<vtkSPHMeter::Place> vtkSPHGauge::ListPlaces(vtkDataObject* more)
{
  std::vector<Place> gauges = this->Places;
  auto* lines = vtkDataSet::SafeDownCast(more);
  for (vtkIdType i = 0; lines && i < lines->GetNumberOfCells(); ++i)
  {
    vtkCell* cell = lines->GetCell(i);
    if (cell->GetCellDimension() != 1)
    {
      continue;
    }
    Place gauge;
    gauge.Name = NameOf(lines, i, "line " + std::to_string(i));
    gauge.Numbers.resize(6);
    lines->GetPoint(cell->GetPointId(0), gauge.Numbers.data());
    lines->GetPoint(
      cell->GetPointId(static_cast<int>(cell->GetNumberOfPoints()) - 1), gauge.Numbers.data() + 3);
    gauges.push_back(gauge);
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
  vtkSPHOwned<mcor_gauges, mcor_free_gauges> gauges;
  const int status = mcor_gauge(
    context, &input, &options, lines.data(), static_cast<int64_t>(lines.size()), &gauges);
  if (status != MCOR_OK)
  {
    return status;
  }
  const vtkIdType count = gauges.count;
  const mcor_gauge_reading* readings = gauges.readings;
  vtkSPHAddColumn<vtkStringArray>(
    table, "state", count, [=](vtkIdType i) { return mcor_gauge_state_name(readings[i].state); });
  vtkSPHAddColumns<mcor_gauge_reading>(table, readings, count,
    { { "first", &mcor_gauge_reading::first }, { "last", &mcor_gauge_reading::last },
      { "depth", &mcor_gauge_reading::depth } });
  vtkSPHAddColumn<vtkIdTypeArray>(
    table, "crossings", count, [=](vtkIdType i) { return readings[i].crossing_count; });
  for (int a = 0; a < 3; ++a)
  {
    vtkSPHAddColumn<vtkDoubleArray>(table, std::string(1, "xyz"[a]).c_str(), count,
      [=](vtkIdType i) { return readings[i].place[a]; });
  }
  std::transform(readings, readings + count, std::back_inserter(outside),
    [](const mcor_gauge_reading& reading) { return reading.outside != 0; });
  statistics = gauges.statistics;
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
