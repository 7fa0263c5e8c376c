// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "MeterRun.h"

#include "Job.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "ParticleTimes.h"
#include "SafeText.h"
#include "Sharing.h"
#include "SurfaceRun.h"
#include "TableText.h"

#include "vtkPointSet.h"
#include "vtkTable.h"

#include <iostream>
#include <stdexcept>

namespace
{

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
    sharing.OnFirst([this] { this->CheckFiles(); });
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
    return isGood;
  }

  std::size_t CountSteps() const { return this->Times.Get().size(); }

private:
  bool IsImage() const { return static_cast<bool>(this->Task.WriteImage); }

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
        table = MeasureWith(this->Task.Meter, this->Options, particles, time, this->Messages,
          this->Times.Get().size() > 1 ? label + ": " : "");
      });
    if (this->Task.Finish)
    {
      this->Task.Finish(table, time);
    }
    const std::vector<std::string> more = this->Messages->GetWarnings();
    warnings.insert(warnings.end(), more.begin(), more.end());
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

}

vtkTable* MeasureWith(vtkSPHMeter* meter, const Job& job, vtkPointSet* particles, double time,
  MessageCapture* messages, const std::string& progress)
{
  meter->SetInputData(SetUpParticles(meter, job, particles));
  meter->SetTime(time);
  Update(meter, job, messages, progress);
  return meter->GetOutput();
}

bool MakeMeterTable(
  const Job& job, const MeterTask& task, MessageCapture* messages, Sharing& sharing)
{
  MeterTable table(job, task, messages, sharing);
  const bool isGood = table.Make();
  const std::size_t steps = table.CountSteps();
  if (!job.Quiet && sharing.IsFirst())
  {
    std::cout << task.Places << ", " << steps << (steps == 1 ? " step" : " steps")
              << "; volumes: " << task.Meter->GetUsedVolume() << "\n";
  }
  return isGood;
}
