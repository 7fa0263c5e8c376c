// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleSteps.h"

#include "CollectionFile.h"
#include "Job.h"
#include "ParticleFile.h"
#include "StepName.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <stdexcept>

using Pipeline = vtkStreamingDemandDrivenPipeline;

vtkStandardNewMacro(ParticleSteps);

namespace
{

using Steps = std::vector<ParticleSteps::Step>;

/// Those of a .pvd file.
Steps ListedSteps(const std::string& file, MessageCapture* messages)
{
  Steps steps;
  for (const CollectionEntry& entry : ReadCollection(file, messages))
  {
    if (steps.empty() || steps.back().Time != entry.Time)
    {
      steps.push_back({ entry.Time, {}, {} });
    }
    steps.back().Files.push_back(entry.File);
  }
  return steps;
}

/// The walls that a .pvd file lists: those of each step's time, or, where steps are in a list without times, in its order.
void AddListedWalls(const std::string& file, bool haveTimes, Steps& steps, MessageCapture* messages)
{
  const Steps walls = ListedSteps(file, messages);
  if (!haveTimes && walls.size() != steps.size())
  {
    throw std::runtime_error("--walls: " + file + " lists " + std::to_string(walls.size()) +
      " times, and there are " + std::to_string(steps.size()) + " steps");
  }
  auto next = walls.begin();
  for (ParticleSteps::Step& step : steps)
  {
    next = haveTimes ? FindStep(walls, step.Time) : next;
    if (next == walls.end() || (haveTimes && next->Time != step.Time))
    {
      throw std::runtime_error(
        "--walls: " + file + " has no walls at the time of " + step.Files.front());
    }
    step.Walls.insert(step.Walls.end(), next->Files.begin(), next->Files.end());
    ++next;
  }
}

/// One --walls: a file of all steps, of each by its number, or a list.
void AddStepWalls(const std::string& file, bool haveTimes, Steps& steps, MessageCapture* messages)
{
  if (IsCollectionFile(file))
  {
    AddListedWalls(file, haveTimes, steps, messages);
    return;
  }
  for (ParticleSteps::Step& step : steps)
  {
    std::size_t number = 0;
    if (HasStepNumber(file) && !FindStepNumber(step.Files.front(), number))
    {
      throw std::runtime_error("--walls " + file + " needs the number of each step, but the name " +
        step.Files.front() + " has none");
    }
    step.Walls.push_back(HasStepNumber(file) ? NameOfStep(file, number) : file);
  }
}

}

ParticleSteps::ParticleSteps()
{
  this->SetNumberOfInputPorts(0);
}

ParticleSteps::~ParticleSteps() = default;

void ParticleSteps::SetSteps(const std::vector<Step>* steps, MessageCapture* messages)
{
  this->Steps = steps;
  this->Messages = messages;
  this->Modified();
}

int ParticleSteps::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  std::vector<double> times;
  for (const Step& step : *this->Steps)
  {
    times.push_back(step.Time);
  }
  const double range[2] = { times.front(), times.back() };
  vtkInformation* info = outputVector->GetInformationObject(0);
  info->Set(Pipeline::TIME_STEPS(), times.data(), static_cast<int>(times.size()));
  info->Set(Pipeline::TIME_RANGE(), range, 2);
  return 1;
}

int ParticleSteps::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkInformation* info = outputVector->GetInformationObject(0);
  const double time = info->Has(Pipeline::UPDATE_TIME_STEP())
    ? info->Get(Pipeline::UPDATE_TIME_STEP())
    : this->Steps->front().Time;
  auto step = FindStep(*this->Steps, time); // one of the times that were offered
  step = step == this->Steps->end() ? step - 1 : step;
  vtkPolyData* output = vtkPolyData::GetData(outputVector);
  output->Initialize(); // the step before it, so that there are never three
  try
  {
    output->ShallowCopy(ReadParticles(step->Files, this->Messages));
  }
  catch (const std::exception& error)
  {
    this->Error = error.what();
    return 0;
  }
  output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), step->Time);
  return 1;
}

std::vector<ParticleSteps::Step>::const_iterator FindStep(
  const std::vector<ParticleSteps::Step>& steps, double time)
{
  return std::lower_bound(steps.begin(), steps.end(), time,
    [](const ParticleSteps::Step& step, double t) { return step.Time < t; });
}

std::vector<ParticleSteps::Step> ListSteps(const Job& job, MessageCapture* messages)
{
  const bool haveTimes = IsCollectionFile(job.Inputs.front());
  Steps steps = haveTimes ? ListedSteps(job.Inputs.front(), messages) : Steps();
  for (std::size_t i = 0; !haveTimes && i < job.Inputs.size(); ++i)
  {
    steps.push_back({ static_cast<double>(i) * job.TimeStep, { job.Inputs[i] }, {} });
  }
  for (const std::string& walls : job.Walls)
  {
    AddStepWalls(walls, haveTimes, steps, messages);
  }
  return steps;
}
