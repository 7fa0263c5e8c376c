// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "GaugeRun.h"

#include "DataSetFile.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "ParticleSteps.h"
#include "SafeText.h"
#include "Sentences.h"
#include "SurfaceRun.h"
#include "TableText.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

#include <iostream>
#include <new>
#include <stdexcept>

namespace
{

using Steps = std::vector<ParticleSteps::Step>;

std::vector<GaugeLine> ListGauges(const Job& job)
{
  std::vector<GaugeLine> gauges = job.Gauges;
  if (!job.GaugeFile.empty())
  {
    const std::vector<GaugeLine> more = ReadGauges(job.GaugeFile);
    gauges.insert(gauges.end(), more.begin(), more.end());
  }
  if (job.Grid.Counts[0] > 0)
  {
    gauges = LinesOf(job.Grid);
  }
  CheckNames(gauges);
  return gauges;
}

void CheckFiles(const Job& job, const Steps& steps, MessageCapture* messages)
{
  std::vector<std::string> inputs = job.Inputs;
  for (const ParticleSteps::Step& step : steps)
  {
    inputs.insert(inputs.end(), step.Files.begin(), step.Files.end());
  }
  if (!job.GaugeFile.empty())
  {
    inputs.push_back(job.GaugeFile);
  }
  CheckOutputs(ListFiles(inputs, messages), { job.Output });
}

/// The table of one step. Throws std::runtime_error.
vtkTable* MeasureStep(const Job& job, const ParticleSteps::Step& step, MessageCapture* messages,
  const std::string& progress)
{
  const vtkSmartPointer<vtkPointSet> particles = ReadParticles(step.Files, messages);
  job.Gauge->SetInputData(SetUpParticles(job.Gauge, job, particles));
  job.Gauge->SetTime(step.Time);
  Update(job.Gauge, job, messages, progress);
  return job.Gauge->GetOutput();
}

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

//------------------------------------------------------------------------------
bool MeasureGauges(const Job& job, MessageCapture* messages)
{
  const std::vector<GaugeLine> gauges = ListGauges(job);
  const Steps steps = ListSteps(job, messages);
  const bool isGrid = job.Grid.Counts[0] > 0;
  CheckFiles(job, steps, messages);
  if (isGrid && steps.size() > 1)
  {
    throw std::runtime_error(
      "--gauge-grid takes one INPUT of one time, as its OUTPUT is one image");
  }
  for (const GaugeLine& gauge : gauges)
  {
    const std::array<double, 6>& e = gauge.Ends;
    job.Gauge->AddGauge(gauge.Name.c_str(), e[0], e[1], e[2], e[3], e[4], e[5]);
  }
  Sentences said;
  std::string text;
  bool isGood = true;
  for (const ParticleSteps::Step& step : steps)
  {
    const std::string label = Printable(step.Files.front());
    std::string error = "host memory ran out";
    vtkTable* table = nullptr;
    try
    {
      table = MeasureStep(job, step, messages, steps.size() > 1 ? label + ": " : "");
    }
    catch (const std::bad_alloc&)
    {
    }
    catch (const std::exception& failure)
    {
      error = failure.what();
    }
    if (!table)
    {
      if (steps.size() == 1)
      {
        throw std::runtime_error(error);
      }
      said.Tell("", label, error);
      isGood = false;
      continue;
    }
    for (const std::string& warning : messages->GetWarnings())
    {
      if (!isGrid || warning.find("is outside of all fluid") == std::string::npos)
      {
        said.Tell("warning: ", label, warning);
      }
    }
    text += (text.empty() ? TableHeader(table) : "") + TableRows(table);
  }
  said.TellCounts();
  if (text.empty())
  {
    throw std::runtime_error("no step could be measured, and so there is no table");
  }
  isGrid ? WriteGrid(job, job.Gauge->GetOutput(), messages) : WriteOutput(job.Output, text);
  if (!job.Quiet)
  {
    std::cout << gauges.size() << (gauges.size() == 1 ? " gauge, " : " gauges, ") << steps.size()
              << (steps.size() == 1 ? " step\n" : " steps\n");
  }
  return isGood;
}
