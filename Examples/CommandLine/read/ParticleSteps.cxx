// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleSteps.h"

#include "CollectionFile.h"
#include "Job.h"
#include "ParticleFile.h"

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

//------------------------------------------------------------------------------
ParticleSteps::ParticleSteps()
{
  this->SetNumberOfInputPorts(0);
}

ParticleSteps::~ParticleSteps() = default;

//------------------------------------------------------------------------------
void ParticleSteps::SetSteps(const std::vector<Step>* steps, MessageCapture* messages)
{
  this->Steps = steps;
  this->Messages = messages;
  this->Modified();
}

//------------------------------------------------------------------------------
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

//------------------------------------------------------------------------------
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

//------------------------------------------------------------------------------
std::vector<ParticleSteps::Step>::const_iterator FindStep(
  const std::vector<ParticleSteps::Step>& steps, double time)
{
  return std::lower_bound(steps.begin(), steps.end(), time,
    [](const ParticleSteps::Step& step, double t) { return step.Time < t; });
}

//------------------------------------------------------------------------------
std::vector<ParticleSteps::Step> ListSteps(const Job& job, MessageCapture* messages)
{
  std::vector<ParticleSteps::Step> steps;
  if (!IsCollectionFile(job.Inputs.front()))
  {
    for (const std::string& input : job.Inputs)
    {
      steps.push_back({ static_cast<double>(steps.size()) * job.TimeStep, { input } });
    }
    return steps;
  }
  for (const CollectionEntry& entry : ReadCollection(job.Inputs.front(), messages))
  {
    if (steps.empty() || steps.back().Time != entry.Time)
    {
      steps.push_back({ entry.Time, {} });
    }
    steps.back().Files.push_back(entry.File);
  }
  return steps;
}
