// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleSteps.h"

#include "CollectionFile.h"
#include "FileName.h"
#include "Job.h"
#include "ParticleFile.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <stdexcept>

using Pipeline = vtkStreamingDemandDrivenPipeline;

vtkStandardNewMacro(ParticleSteps);

namespace
{

using Steps = std::vector<ParticleSteps::Step>;

/// Steps of a .pvd file.
Steps ListedSteps(
  const std::string& file, MessageCapture* messages, std::vector<std::string>& warnings)
{
  Steps steps;
  for (const CollectionEntry& entry : ReadCollection(file, messages, warnings))
  {
    if (steps.empty() || steps.back().Time != entry.Time)
    {
      steps.push_back({ entry.Time, {}, {} });
    }
    steps.back().Files.push_back(entry.File);
  }
  return steps;
}

/// A file's name as what stands between numbers, and these: without zeros in front, each behind its
/// number of digits, so that they compare as numbers do.
using NumberedName = std::pair<std::string, std::vector<std::pair<std::size_t, std::string>>>;

NumberedName Numbered(const std::string& name)
{
  NumberedName numbered;
  auto& [words, numbers] = numbered;
  for (const char c : name)
  {
    if (c < '0' || c > '9')
    {
      words += c;
      continue;
    }
    if (words.empty() || words.back() != '\0')
    {
      words += '\0';
      numbers.emplace_back();
    }
    auto& [size, digits] = numbers.back();
    digits += c == '0' && size == 0 ? "" : std::string(1, c);
    size = digits.size();
  }
  return numbered;
}

/// Sorts files by the numbers in their names, if the names differ in nothing else: shells list
/// tank_10 before tank_9.
std::vector<std::string> InOrder(std::vector<std::string> files)
{
  const std::string words = Numbered(files.front()).first;
  if (std::all_of(files.begin(), files.end(),
        [&words](const std::string& file) { return Numbered(file).first == words; }))
  {
    std::stable_sort(files.begin(), files.end(),
      [](const std::string& a, const std::string& b)
      { return Numbered(a).second < Numbered(b).second; });
  }
  return files;
}

/// Steps of files given one by one, at the times that the files tell of.
Steps GivenSteps(const Job& job, MessageCapture* messages, std::vector<std::string>& warnings)
{
  std::vector<std::string> files;
  std::vector<double> times;
  for (const std::string& file : InOrder(job.Inputs))
  {
    const std::vector<double> steps = ListTimes(file, messages);
    const bool isFilm = steps.size() > 1;
    for (std::size_t k = 0; k < (isFilm ? steps.size() : 1); ++k)
    {
      files.push_back(isFilm ? file + "#" + std::to_string(k) : file);
    }
    if (isFilm || job.Inputs.size() > 1)
    {
      times.insert(times.end(), steps.begin(), steps.end());
    }
  }
  if (job.Has("--time-step"))
  {
    times.clear();
  }
  const bool areAll = times.size() == files.size();
  const bool ascend =
    std::adjacent_find(times.begin(), times.end(), std::greater_equal<double>()) == times.end();
  if (!times.empty() && !(areAll && ascend))
  {
    warnings.push_back("the times in the field data of the files " +
      std::string(areAll ? "do not ascend in the order of the steps" : "are missing in some") +
      ", so the steps have times of their own, from 0 on; --time-step sets what is between them");
  }
  Steps steps;
  for (std::size_t i = 0; i < files.size(); ++i)
  {
    steps.push_back(
      { !times.empty() && areAll && ascend ? times[i] : static_cast<double>(i) * job.TimeStep,
        { files[i] }, {} });
  }
  return steps;
}

/// The walls that a .pvd file lists: those of each step's time, or, where steps are in a list
/// without times, in its order.
void AddListedWalls(const std::string& file, bool haveTimes, Steps& steps, MessageCapture* messages,
  std::vector<std::string>& warnings)
{
  const Steps walls = ListedSteps(file, messages, warnings);
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

/// Adds one --walls: a file for all steps, a file for each by its number, or a list.
void AddStepWalls(const std::string& file, bool haveTimes, Steps& steps, MessageCapture* messages,
  std::vector<std::string>& warnings)
{
  if (IsCollectionFile(file))
  {
    AddListedWalls(file, haveTimes, steps, messages, warnings);
    return;
  }
  for (ParticleSteps::Step& step : steps)
  {
    if (!HasStepNumber(file))
    {
      step.Walls.push_back(file);
      continue;
    }
    const std::string name = std::filesystem::path(step.Files.front()).filename().string();
    const auto numbers = Numbered(name).second; // 120 of WaterBody_120.vtp
    if (numbers.empty())
    {
      throw std::runtime_error("--walls " + file + " needs the number of each step, but the name " +
        step.Files.front() + " has none");
    }
    step.Walls.push_back(
      NameOfStep(file, std::strtoull(numbers.back().second.c_str(), nullptr, 10)));
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
    output->ShallowCopy(ReadParticles(step->Files, this->Messages, true));
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

std::vector<ParticleSteps::Step> ListSteps(
  const Job& job, MessageCapture* messages, std::vector<std::string>& warnings)
{
  const bool haveTimes = IsCollectionFile(job.Inputs.front());
  Steps steps = haveTimes ? ListedSteps(job.Inputs.front(), messages, warnings)
                          : GivenSteps(job, messages, warnings);
  for (const std::string& walls : job.Walls)
  {
    AddStepWalls(walls, haveTimes, steps, messages, warnings);
  }
  return steps;
}
