// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "DataFile.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "ParticleTimes.h"
#include "Runs.h"
#include "SafeText.h"
#include "Sharing.h"

#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <functional>
#include <iostream>
#include <stdexcept>
#include <utility>

namespace
{

/// A measurement at each time of the input.
struct MeterTask
{
  vtkSPHMeter* Meter;
  std::string Noun; ///< "gauge"
  std::size_t Places;
  /// Completes the table of a time, on all processes; may be empty.
  std::function<void(vtkTable* table, double time)> Finish;
  /// Writes the only table in another form; may be empty: OUTPUT is a .csv file.
  std::function<void(vtkTable* table)> WriteImage;
};

/// The steps of a table or the one of an image, and what is said of them.
class MeterTable
{
public:
  MeterTable(const Job& job, const MeterTask& task, MessageCapture* messages, Sharing& sharing)
    : Options(job)
    , Task(task)
    , Messages(messages)
    , Shared(sharing)
    , Times(job, messages)
    , File(job.Output)
  {
    sharing.OnFirst(
      [&]
      {
        std::vector<std::string> inputs = job.InputFiles();
        const std::vector<std::string> stored = this->Times.ListFiles();
        inputs.insert(inputs.end(), stored.begin(), stored.end());
        CheckOutputs(ListFiles(inputs, messages), { job.Output });
      });
    if (this->IsImage() && this->Times.Get().size() > 1)
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
    if (!this->Options.Quiet && this->Shared.IsFirst())
    {
      const std::size_t places = this->Task.Places, steps = this->Times.Get().size();
      std::cout << places << " " << this->Task.Noun << (places == 1 ? "" : "s") << ", " << steps
                << (steps == 1 ? " step" : " steps")
                << "; volumes: " << this->Task.Meter->GetUsedVolume() << "\n";
    }
    return isGood;
  }

private:
  bool IsImage() const { return static_cast<bool>(this->Task.WriteImage); }

  bool TryStep(double time)
  {
    const std::string file = Printable(this->Times.ListFiles(time).front());
    const std::string label =
      this->Options.Times.empty() ? file : file + " (time " + TimeText(time) + ")";
    const std::string error = FailureOf([&] { this->MakeStep(time, label); });
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
      this->Said.Tell("", label, error);
    }
    this->Times.Reset();
    return false;
  }

  void MakeStep(double time, const std::string& label)
  {
    std::vector<std::string> warnings;
    const vtkSmartPointer<vtkPointSet> particles = this->Shared.Read(this->Times, time, warnings);
    vtkTable* table = nullptr;
    this->Shared.OnAll(
      [&]
      {
        table = MeasureWith(this->Task.Meter, this->Options, particles, time, this->Messages,
          this->Times.Get().size() > 1 ? label + ": " : "");
      });
    if (this->Task.Finish)
    {
      this->Task.Finish(table, time);
    }
    this->Messages->AppendWarnings(warnings);
    for (const std::string& warning : warnings)
    {
      if (this->Shared.IsFirst() &&
        (!this->IsImage() || warning.find("is outside of all fluid") == std::string::npos))
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
        if (!this->IsImage())
        {
          this->File.Write([this] { return this->Text; }, isLast);
        }
        else if (isLast)
        {
          this->Task.WriteImage(this->Task.Meter->GetOutput());
        }
      });
  }

  const Job& Options;
  const MeterTask& Task;
  MessageCapture* const Messages;
  Sharing& Shared;
  ParticleTimes Times;
  GrowingFile File;
  Sentences Said;
  std::string Text;
  std::size_t Made = 0; ///< steps
};

/// An elevation map: Level is the height of the surface.
void WriteGrid(const Job& job, vtkTable* table, MessageCapture* messages)
{
  const GaugeGrid& grid = job.Grid;
  vtkNew<vtkImageData> image;
  double spacing[3] = { 1.0, 1.0, 1.0 };
  for (std::size_t a = 0; a < 2; ++a)
  {
    const double length = grid.Bounds[2 * a + 1] - grid.Bounds[2 * a];
    spacing[a] = grid.Counts[a] > 1 && length > 0.0 ? length / (grid.Counts[a] - 1) : 1.0;
  }
  image->SetDimensions(grid.Counts[0], grid.Counts[1], 1);
  image->SetOrigin(grid.Bounds[0], grid.Bounds[2], grid.Bounds[4]);
  image->SetSpacing(spacing);
  using Names = std::pair<const char*, const char*>;
  for (const Names& names :
    { Names("z", "Level"), Names("depth", "Depth"), Names("crossings", "Crossings") })
  {
    vtkAbstractArray* column = table->GetColumnByName(names.first);
    auto array = vtk::TakeSmartPointer(column->NewInstance());
    array->DeepCopy(column);
    array->SetName(names.second);
    image->GetPointData()->AddArray(array);
  }
  image->GetPointData()->SetActiveScalars("Level");
  WriteDataSet(job.Output, image, messages);
}

void AddSection(const Job& job, const Place& section, MessageCapture* messages)
{
  const char* name = section.Name.c_str();
  const double* n = section.Numbers.data();
  switch (section.Shape)
  {
    case Place::Line:
      job.Flux->AddLine(name, n, n + 3);
      break;
    case Place::Rectangle:
      job.Flux->AddRectangle(name, n, n + 3, n + 6);
      break;
    case Place::Disc:
      job.Flux->AddDisc(name, n, n + 3, n[6]);
      break;
    case Place::Box:
      job.Flux->AddBox(name, n);
      break;
    default:
    {
      const vtkSmartPointer<vtkDataSet> surface = ReadDataSet(section.File, messages);
      if (surface->GetNumberOfCells() == 0)
      {
        throw std::runtime_error(section.File + " has no triangles for section '" + section.Name +
          "'; give a file of a surface");
      }
      job.Flux->AddSurface(name, surface);
    }
  }
}

/// The integrals of fluxes in time, by trapezia between steps.
class Flowed
{
public:
  /// Adds them to the table of a step, the columns volume and mass.
  void AddTo(vtkTable* table, double time)
  {
    const double passed = this->Before.empty() ? 0.0 : time - this->Time;
    const auto rows = static_cast<std::size_t>(table->GetNumberOfRows());
    std::vector<double> now(2 * rows);
    this->Sums.resize(2 * rows);
    this->Time = time;
    for (std::size_t flux = 0; flux < 2; ++flux)
    {
      vtkNew<vtkDoubleArray> column;
      column->SetName(flux == 0 ? "volume" : "mass");
      for (std::size_t row = 0; row < rows; ++row)
      {
        const std::size_t i = 2 * row + flux;
        now[i] =
          table->GetValueByName(
                 static_cast<vtkIdType>(row), flux == 0 ? "volume_flux" : "mass_flux")
            .ToDouble();
        const double before = this->Before.empty() ? now[i] : this->Before[i];
        this->Sums[i] +=
          passed * 0.5 * (before + now[i]) + 0.0 * now[i]; // no number where there is no flux
        column->InsertNextValue(this->Sums[i]);
      }
      table->AddColumn(column);
    }
    this->Before = rows > 0 ? now : std::vector<double>();
  }

private:
  double Time = 0.0;
  std::vector<double> Before, Sums; ///< of volume and mass, for each section
};

}

vtkTable* MeasureWith(vtkSPHMeter* meter, const Job& job, vtkPointSet* particles, double time,
  MessageCapture* messages, const std::string& progress)
{
  meter->SetInputData(SetUpParticles(meter, job, particles));
  meter->SetTime(time);
  Update(meter, job, messages, progress);
  return meter->GetOutput();
}

std::size_t AddGauges(const Job& job)
{
  const std::vector<Place> gauges = ListGauges(job);
  for (const Place& gauge : gauges)
  {
    const std::vector<double>& e = gauge.Numbers;
    job.Gauge->AddGauge(gauge.Name.c_str(), e[0], e[1], e[2], e[3], e[4], e[5]);
  }
  return gauges.size();
}

bool MakeGaugeTable(const Job& job, MessageCapture* messages, Sharing& sharing)
{
  MeterTask task{ job.Gauge, "gauge", AddGauges(job), {}, {} };
  if (job.Grid.Counts[0] > 0)
  {
    task.WriteImage = [&job, messages](vtkTable* table) { WriteGrid(job, table, messages); };
  }
  return MeterTable(job, task, messages, sharing).Make();
}

bool MakeFluxTable(const Job& job, MessageCapture* messages, Sharing& sharing)
{
  const std::vector<Place> sections = ListSections(job);
  for (const Place& section : sections)
  {
    AddSection(job, section, messages);
  }
  Flowed flowed;
  const MeterTask task{ job.Flux, "section", sections.size(),
    [&flowed](vtkTable* table, double time) { flowed.AddTo(table, time); }, {} };
  return MeterTable(job, task, messages, sharing).Make();
}
