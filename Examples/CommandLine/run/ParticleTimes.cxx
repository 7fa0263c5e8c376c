// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleTimes.h"

#include "CollectionFile.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OptionValue.h"
#include "ParticleFile.h"
#include "SafeText.h"
#include "Sharing.h"

#include "vtkPolyData.h"
#include "vtkSPHTemporalInterpolator.h"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <stdexcept>

namespace
{

/// The stored times, or those that were asked for.
std::vector<double> ListTimes(const Job& job, const ParticleTimes::Steps& steps)
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

ParticleTimes::ParticleTimes(const Job& job, MessageCapture* messages)
  : Messages(messages)
  , HasTimes(IsCollectionFile(job.Inputs.front()))
  , Ids(job.IdArray)
  , Stored(ListSteps(job, messages, this->Notes))
  , Times(ListTimes(job, this->Stored))
{
  for (const std::string& note : this->Notes)
  {
    if (LaunchedRank() == 0)
    {
      Say("warning: " + note);
    }
  }
  const bool wallsMove = std::any_of(this->Stored.begin(), this->Stored.end(),
    [this](const ParticleSteps::Step& step) { return step.Walls != this->Stored.front().Walls; });
  for (double time : this->Times)
  {
    if (wallsMove && !this->IsStored(time))
    {
      throw UsageError("--times: " + TimeText(time) +
        " is between two steps, where walls of each step (--walls) are not known");
    }
  }
  this->Reset();
}

ParticleTimes::~ParticleTimes() = default;

std::vector<std::string> ParticleTimes::ListFiles() const
{
  std::vector<std::string> files;
  for (const ParticleSteps::Step& step : this->Stored)
  {
    files.insert(files.end(), step.Files.begin(), step.Files.end());
    files.insert(files.end(), step.Walls.begin(), step.Walls.end());
  }
  return files;
}

const std::vector<std::string>& ParticleTimes::ListWalls(double time) const
{
  return FindStep(this->Stored, time)->Walls;
}

bool ParticleTimes::IsStored(double time) const
{
  return FindStep(this->Stored, time)->Time == time;
}

std::vector<std::string> ParticleTimes::ListFiles(double time) const
{
  std::vector<std::string> files;
  const auto next = FindStep(this->Stored, time);
  for (auto used = this->IsStored(time) ? next : next - 1; used <= next; ++used)
  {
    files.insert(files.end(), used->Files.begin(), used->Files.end());
  }
  return files;
}

void ParticleTimes::Reset()
{
  vtkNew<ParticleSteps> source;
  vtkNew<vtkSPHTemporalInterpolator> interpolator;
  source->SetSteps(&this->Stored, this->Messages);
  interpolator->SetIdArrayName(this->Ids.c_str());
  interpolator->SetInputConnection(source->GetOutputPort());
  this->Source = source;
  this->Interpolator = interpolator;
}

vtkSmartPointer<vtkPointSet> ParticleTimes::At(double time, std::vector<std::string>& warnings)
{
  this->Messages->Clear();
  this->Source->ClearError();
  this->Interpolator->UpdateTimeStep(time);
  std::string error = this->Source->GetError();
  error = error.empty() ? this->Interpolator->GetErrorMessage() : error;
  this->Messages->Check(error);
  for (const std::string& sentence : this->Messages->GetWarnings())
  {
    warnings.push_back(Reworded(sentence, "set the time scale",
      this->HasTimes ? "change those in the .pvd file" : "use --time-step"));
  }
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  particles->ShallowCopy(this->Interpolator->GetOutput());
  if (this->WallFiles != this->ListWalls(time))
  {
    this->Walls = ReadWalls(this->ListWalls(time), this->Messages);
    this->WallFiles = this->ListWalls(time);
  }
  return AddWalls(particles, this->Walls);
}
