// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "GaugeRun.h"

#include "DataSetFile.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "ParticleTimes.h"
#include "SafeText.h"
#include "Sharing.h"
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
#include <stdexcept>

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

/// The steps of a table or the one of an image, and what is said of them.
class GaugeTable
{
public:
  GaugeTable(const Job& job, MessageCapture* messages, Sharing& sharing)
    : Options(job)
    , Messages(messages)
    , Shared(sharing)
    , Times(job, messages)
    , IsGrid(job.Grid.Counts[0] > 0)
    , File(job.Output)
  {
    sharing.OnFirst([this] { this->CheckFiles(); });
    if (this->IsGrid && this->Times.Get().size() > 1)
    {
      throw std::runtime_error(
        "--gauge-grid takes one INPUT of one time, as its OUTPUT is one image");
    }
  }

  bool Make()
  {
    bool isGood = true;
    for (const double time : this->Times.Get())
    {
      isGood = this->TryStep(time) && isGood;
    }
    this->Said.TellCounts();
    if (this->Made == 0)
    {
      throw std::runtime_error("no step could be measured, so no table was written");
    }
    this->Write(true);
    return isGood;
  }

  std::size_t CountSteps() const { return this->Times.Get().size(); }

private:
  void CheckFiles() const
  {
    std::vector<std::string> inputs = this->Options.InputFiles();
    const std::vector<std::string> stored = this->Times.ListFiles();
    inputs.insert(inputs.end(), stored.begin(), stored.end());
    CheckOutputs(ListFiles(inputs, this->Messages), { this->Options.Output });
  }

  std::string Label(double time) const
  {
    const std::string file = Printable(this->Times.ListFiles(time).front());
    return this->Options.Times.empty() ? file : file + " (time " + TimeText(time) + ")";
  }

  bool TryStep(double time)
  {
    const std::string error = FailureOf([&] { this->MakeStep(time); });
    if (error.empty())
    {
      return true;
    }
    if (this->Times.Get().size() == 1)
    {
      throw std::runtime_error(error);
    }
    if (this->Shared.IsFirst())
    {
      this->Said.Tell("", this->Label(time), error);
    }
    this->Times.Reset();
    return false;
  }

  void MakeStep(double time)
  {
    std::vector<std::string> warnings;
    const std::string label = this->Label(time);
    const vtkSmartPointer<vtkPointSet> particles = this->Shared.Read(this->Times, time, warnings);
    vtkTable* table = nullptr;
    this->Shared.OnAll(
      [&]
      {
        table = MeasureGauges(this->Options, particles, time, this->Messages,
          this->Times.Get().size() > 1 ? label + ": " : "");
      });
    const std::vector<std::string> more = this->Messages->GetWarnings();
    warnings.insert(warnings.end(), more.begin(), more.end());
    for (const std::string& warning : warnings)
    {
      if (this->Shared.IsFirst() &&
        (!this->IsGrid || warning.find("is outside of all fluid") == std::string::npos))
      {
        this->Said.Tell("warning: ", label, warning);
      }
    }
    this->Text += (this->Made++ == 0 ? TableHeader(table) : "") + TableRows(table);
    this->Write(false);
  }

  void Write(bool isLast)
  {
    this->Shared.OnFirst(
      [&]
      {
        if (!this->IsGrid)
        {
          this->File.Write([this] { return this->Text; }, isLast);
        }
        else if (isLast)
        {
          WriteGrid(this->Options, this->Options.Gauge->GetOutput(), this->Messages);
        }
      });
  }

  const Job& Options;
  MessageCapture* const Messages;
  Sharing& Shared;
  ParticleTimes Times;
  const bool IsGrid;
  GrowingFile File;
  Sentences Said;
  std::string Text;
  std::size_t Made = 0; ///< steps
};

}

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

void AddGauges(const Job& job, const std::vector<GaugeLine>& gauges)
{
  for (const GaugeLine& gauge : gauges)
  {
    const std::array<double, 6>& e = gauge.Ends;
    job.Gauge->AddGauge(gauge.Name.c_str(), e[0], e[1], e[2], e[3], e[4], e[5]);
  }
}

vtkTable* MeasureGauges(const Job& job, vtkPointSet* particles, double time,
  MessageCapture* messages, const std::string& progress)
{
  job.Gauge->SetInputData(SetUpParticles(job.Gauge, job, particles));
  job.Gauge->SetTime(time);
  Update(job.Gauge, job, messages, progress);
  return job.Gauge->GetOutput();
}

bool MakeGaugeTable(const Job& job, MessageCapture* messages, Sharing& sharing)
{
  const std::vector<GaugeLine> gauges = ListGauges(job);
  AddGauges(job, gauges);
  GaugeTable table(job, messages, sharing);
  const bool isGood = table.Make();
  const std::size_t steps = table.CountSteps();
  if (!job.Quiet && sharing.IsFirst())
  {
    std::cout << gauges.size() << (gauges.size() == 1 ? " gauge, " : " gauges, ") << steps
              << (steps == 1 ? " step" : " steps") << "; volumes: " << job.Gauge->GetUsedVolume()
              << "\n";
  }
  return isGood;
}
