// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "GaugeRun.h"

#include "DataSetFile.h"
#include "Job.h"
#include "MeterRun.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkTable.h"

namespace
{

/// A column of the table as an array of the image's points.
void AddArray(vtkImageData* image, vtkTable* table, const char* column, const char* name)
{
  auto array = vtk::TakeSmartPointer(
    vtkDataArray::SafeDownCast(table->GetColumnByName(column))->NewInstance());
  array->DeepCopy(table->GetColumnByName(column));
  array->SetName(name);
  image->GetPointData()->AddArray(array);
}

/// An elevation map: Level is the height of the surface.
void WriteGrid(const Job& job, vtkTable* table, MessageCapture* messages)
{
  const GaugeGrid& grid = job.Grid;
  vtkNew<vtkImageData> image;
  double spacing[3] = { 1.0, 1.0, 1.0 };
  for (int a = 0; a < 2; ++a)
  {
    const double length = grid.Bounds[2 * a + 1] - grid.Bounds[2 * a];
    spacing[a] = grid.Counts[a] > 1 && length > 0.0 ? length / (grid.Counts[a] - 1) : 1.0;
  }
  image->SetDimensions(grid.Counts[0], grid.Counts[1], 1);
  image->SetOrigin(grid.Bounds[0], grid.Bounds[2], grid.Bounds[4]);
  image->SetSpacing(spacing);
  AddArray(image, table, "z", "Level");
  AddArray(image, table, "depth", "Depth");
  AddArray(image, table, "crossings", "Crossings");
  image->GetPointData()->SetActiveScalars("Level");
  WriteDataSet(job.Output, image, messages);
}
}

std::vector<GaugeLine> ListGauges(const Job& job)
{
  std::vector<GaugeLine> gauges = job.Gauges;
  if (!job.GaugeFile.empty())
  {
    for (const std::string& row : ReadRows("--gauges", job.GaugeFile, "gauges", "NAME=X,Y,Z:X,Y,Z"))
    {
      gauges.push_back(ToGauge("--gauges " + job.GaugeFile, row));
    }
  }
  if (job.Grid.Counts[0] > 0)
  {
    gauges = LinesOf(job.Grid);
  }
  std::vector<std::string> names;
  for (const GaugeLine& gauge : gauges)
  {
    names.push_back(gauge.Name);
  }
  CheckNames(names, "gauges");
  return gauges;
}

void AddGauges(const Job& job, const std::vector<GaugeLine>& gauges)
{
  for (const GaugeLine& gauge : gauges)
  {
    const std::array<double, 6>& e = gauge.Ends;
    job.Gauge->AddGauge(gauge.Name.c_str(), e[0], e[1], e[2], e[3], e[4], e[5]);
  }
}

bool MakeGaugeTable(const Job& job, MessageCapture* messages, Sharing& sharing)
{
  const std::vector<GaugeLine> gauges = ListGauges(job);
  AddGauges(job, gauges);
  MeterTask task{ job.Gauge,
    std::to_string(gauges.size()) + (gauges.size() == 1 ? " gauge" : " gauges"), {}, {} };
  if (job.Grid.Counts[0] > 0)
  {
    task.WriteImage = [&job, messages](vtkTable* table) { WriteGrid(job, table, messages); };
  }
  return MakeMeterTable(job, task, messages, sharing);
}
