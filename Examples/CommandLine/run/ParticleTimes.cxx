// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleTimes.h"

#include "CollectionFile.h"
#include "Ending.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OptionValue.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "SafeText.h"

#include "vtkSPHTemporalInterpolator.h"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <stdexcept>

namespace
{

/// The stored times, or those that were asked for.
std::vector<double> ListTimes(const Job& job, const std::vector<ParticleTimes::Step>& steps)
{
  std::vector<double> times = job.Times;
  for (std::size_t i = 0; job.Times.empty() && i < steps.size(); ++i)
  {
    times.push_back(steps[i].Time);
  }
  const double begin = steps.front().Time, end = steps.back().Time;
  for (double& time : times)
  {
    // 3 * 0.1 is meant to be 0.3.
    const double tolerance = 1e-12 * (end - begin);
    const auto next = FindStep(steps, time - tolerance);
    if (next != steps.end() && next->Time <= time + tolerance)
    {
      time = next->Time;
    }
    if (time < begin || time > end)
    {
      throw UsageError("--times: " + TimeText(time) + " is outside the times of the steps, " +
        TimeText(begin) + " to " + TimeText(end));
    }
  }
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}

std::string TimeText(double time)
{
  std::ostringstream stream;
  stream << std::setprecision(12) << time;
  return stream.str();
}

ParticleTimes::ParticleTimes(const Sharing& sharing)
  : Shared(sharing)
{
  const Job& job = sharing.Options;
  std::vector<std::string> notes;
  this->Steps = ListSteps(job, sharing.Messages, notes);
  this->Times = ListTimes(job, this->Steps);
  for (const std::string& note : notes)
  {
    if (LaunchedRank() == 0)
    {
      Say("warning: " + note);
    }
  }
  const bool wallsMove = std::any_of(this->Steps.begin(), this->Steps.end(),
    [this](const Step& step) { return step.Walls != this->Steps.front().Walls; });
  for (double time : this->Times)
  {
    if (wallsMove && !this->GetStored(time))
    {
      throw UsageError("--times: " + TimeText(time) +
        " is between two steps, where walls of each step (--walls) are not known");
    }
  }
  this->Reset();
}

ParticleTimes::~ParticleTimes() = default;

const ParticleTimes::Step* ParticleTimes::GetStored(double time) const
{
  const auto next = FindStep(this->Steps, time);
  return next->Time == time ? &*next : nullptr;
}

std::vector<std::string> ParticleTimes::ListFiles(double time) const
{
  std::vector<std::string> files;
  const auto next = FindStep(this->Steps, time);
  for (auto used = next->Time == time ? next : next - 1; used <= next; ++used)
  {
    files.insert(files.end(), used->Files.begin(), used->Files.end());
  }
  return files;
}

void ParticleTimes::CheckOutputs(const std::vector<std::string>& outputs) const
{
  std::vector<std::string> inputs = this->Shared.Options.InputFiles();
  for (const Step& step : this->Steps)
  {
    inputs.insert(inputs.end(), step.Files.begin(), step.Files.end());
    inputs.insert(inputs.end(), step.Walls.begin(), step.Walls.end());
  }
  ::CheckOutputs(::ListFiles(inputs, this->Shared.Messages), outputs);
}

void ParticleTimes::Reset()
{
  vtkNew<ParticleSteps> source;
  vtkNew<vtkSPHTemporalInterpolator> interpolator;
  source->SetSteps(&this->Steps, this->Shared.Messages);
  interpolator->SetIdArrayName(this->Shared.Options.IdArray.c_str());
  interpolator->SetInputConnection(source->GetOutputPort());
  this->Source = source;
  this->Interpolator = interpolator;
}

Sharing::Particles ParticleTimes::At(double time, std::vector<std::string>& warnings)
{
  MessageCapture* const messages = this->Shared.Messages;
  messages->Clear();
  this->Source->ClearError();
  this->Interpolator->UpdateTimeStep(time);
  const std::string error = this->Source->GetError();
  messages->Check(error.empty() ? this->Interpolator->GetErrorMessage() : error);
  const bool hasTimes = IsCollectionFile(this->Shared.Options.Inputs.front());
  for (const std::string& sentence : messages->GetWarnings())
  {
    warnings.push_back(Reworded(sentence, "set the time scale",
      hasTimes ? "change those in the .pvd file" : "use --time-step"));
  }
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  particles->ShallowCopy(this->Interpolator->GetOutput());
  const std::vector<std::string>& walls = FindStep(this->Steps, time)->Walls;
  if (this->WallFiles != walls)
  {
    this->Walls = ReadWalls(walls, messages);
    this->WallFiles = walls;
  }
  return AddWalls(particles, this->Walls);
}

Series::Series(Sharing& sharing)
  : Shared(sharing)
  , Options(sharing.Options)
  , Messages(sharing.Messages)
  , Times(sharing)
{
}

bool Series::MakeAll()
{
  bool isGood = true;
  Sentences said;
  for (std::size_t i = 0; i < this->Times.Get().size(); ++i)
  {
    const std::string label = this->Label(i);
    const Activity making(
      label + ": the run failed", FaultsOfDrivers(this->Options.Surface->GetDevice()));
    std::vector<std::string> warnings;
    const std::string error = FailureOf(
      [&]
      {
        const Sharing::Particles particles =
          this->Shared.Read(this->Times, this->Times.Get()[i], warnings);
        this->MakeStep(i, particles, warnings);
      });
    if (!error.empty())
    {
      this->Miss(i, error);
      this->Times.Reset();
    }
    for (const std::string& warning : error.empty() ? warnings : std::vector<std::string>{ error })
    {
      if (this->Shared.IsFirst())
      {
        said.Tell(error.empty() ? "warning: " : "", label, warning);
      }
    }
    isGood = isGood && error.empty();
  }
  said.TellCounts();
  return isGood;
}
