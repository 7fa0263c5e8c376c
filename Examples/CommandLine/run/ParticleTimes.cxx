// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleTimes.h"

#include "Failures.h"
#include "Formats.h"
#include "Job.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "Text.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkPolyDataAlgorithm.h"
#include "vtkSPHFound.h"
#include "vtkSPHSay.h"
#include "vtkSPHTemporalInterpolator.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>

namespace
{

using Pipeline = vtkStreamingDemandDrivenPipeline;
using Steps = std::vector<ParticleTimes::Step>;

/// Returns the first step that is not before this time, or the end.
Steps::const_iterator FindStep(const Steps& steps, double time)
{
  return std::lower_bound(steps.begin(), steps.end(), time,
    [](const ParticleTimes::Step& step, double t) { return step.Time < t; });
}

/// Lists the steps of a .pvd or .series file.
Steps ListedSteps(const std::string& file, std::vector<std::string>& warnings)
{
  Steps steps;
  for (const CollectionEntry& entry : ReadCollection(file, warnings))
  {
    if (steps.empty() || steps.back().Time != entry.Time)
    {
      steps.push_back({ entry.Time, {}, {} });
    }
    steps.back().Files.push_back(entry.File);
  }
  return steps;
}

/// A file's name, split into the text without the numbers, and the numbers. A number is a pair: the count of its digits, and
/// the digits, both without leading zeros. Pairs thus have the order of the numbers.
using NumberedName = std::pair<std::string, std::vector<std::pair<std::size_t, std::string>>>;

NumberedName Numbered(const std::string& name)
{
  NumberedName numbered;
  for (std::size_t at = 0, end = 0; at < name.size(); at = end)
  {
    const std::size_t begin = std::min(name.find_first_of("0123456789", at), name.size());
    end = std::min(name.find_first_not_of("0123456789", begin), name.size());
    numbered.first += name.substr(at, begin - at);
    if (end > begin)
    {
      const std::size_t first = std::min(name.find_first_not_of('0', begin), end);
      numbered.first += '\0';
      numbered.second.emplace_back(end - first, name.substr(first, end - first));
    }
  }
  return numbered;
}

/// Adds the walls of a file to all steps. If the name has %d, each step gets a file of its own: the last
/// number in the name of the step's file takes the place of %d. If the file is a list, each step gets the walls at
/// its time or, without `haveTimes`, the next walls. haveTimes: the steps come from a list. Throws if a step gets no walls.
void AddStepWalls(
  const std::string& file, bool haveTimes, Steps& steps, std::vector<std::string>& warnings)
{
  const bool areListed = IsListOfSteps(file);
  const Steps walls = areListed ? ListedSteps(file, warnings) : Steps();
  Require(!areListed || haveTimes || walls.size() == steps.size(),
    "--walls: " + file + " lists " + std::to_string(walls.size()) + " times, and there are " +
      std::to_string(steps.size()) + " steps");
  auto next = walls.begin();
  for (ParticleTimes::Step& step : steps)
  {
    const std::string& name = step.Files.front();
    if (areListed)
    {
      next = haveTimes ? FindStep(walls, step.Time) : next;
      Require(next != walls.end() && (!haveTimes || next->Time == step.Time),
        "--walls: " + file + " has no walls at the time of " + name);
      step.Walls.insert(step.Walls.end(), next->Files.begin(), next->Files.end());
      ++next;
    }
    else if (HasStepNumber(file))
    {
      // The number of WaterBody_120.vtp is 120.
      const auto numbers = Numbered(std::filesystem::path(name).filename().string()).second;
      Require(!numbers.empty(),
        "--walls " + file + " needs the number of each step, but the name " + name + " has none");
      step.Walls.push_back(
        NameOfStep(file, std::strtoull(numbers.back().second.c_str(), nullptr, 10)));
    }
    else
    {
      step.Walls.push_back(file);
    }
  }
}

/// Returns the times that the user asks for; by default, the stored times.
std::vector<double> ChooseTimes(const Job& job, const Steps& steps)
{
  std::vector<double> times = job.Times;
  if (!job.HasTimes())
  {
    std::transform(steps.begin(), steps.end(), std::back_inserter(times),
      [](const ParticleTimes::Step& step) { return step.Time; });
    return times;
  }
  const double begin = steps.front().Time, end = steps.back().Time;
  if (job.FramesPerSecond > 0.0)
  {
    const double frame = 1.0 / (job.FramesPerSecond * job.SlowMotion);
    const double count = std::floor((end - begin) / frame + 1e-9);
    Need(count < 1e6,
      "--fps makes more than a million frames of the times " + TimeText(begin) + " to " +
        TimeText(end) + "; give fewer, or another --time-step");
    for (double i = 0.0; i <= count; ++i)
    {
      times.push_back(begin + i * frame);
    }
  }
  for (double& time : times)
  {
    // A time such as 3 * 0.1 means the stored time 0.3.
    const double tolerance = 1e-12 * (end - begin);
    const auto next = FindStep(steps, time - tolerance);
    time = next != steps.end() && next->Time <= time + tolerance ? next->Time : time;
    Need(time >= begin && time <= end,
      "--times: " + TimeText(time) + " is outside the times of the steps, " + TimeText(begin) +
        " to " + TimeText(end));
  }
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}

/// This source of VTK's pipeline offers the times of the stored steps, and reads the step at the requested time.
class StoredSteps : public vtkPolyDataAlgorithm
{
public:
  static StoredSteps* New();
  vtkTypeMacro(StoredSteps, vtkPolyDataAlgorithm);

  const Steps* Known = nullptr; ///< ascending by time
  std::string Error;            ///< why the last step could not be read; empty if it could

protected:
  StoredSteps() { this->SetNumberOfInputPorts(0); }

  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector) override
  {
    std::vector<double> times;
    for (const ParticleTimes::Step& step : *this->Known)
    {
      times.push_back(step.Time);
    }
    const double range[2] = { times.front(), times.back() };
    vtkInformation* info = outputVector->GetInformationObject(0);
    info->Set(Pipeline::TIME_STEPS(), times.data(), static_cast<int>(times.size()));
    info->Set(Pipeline::TIME_RANGE(), range, 2);
    return 1;
  }

  int RequestData(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector) override
  {
    vtkInformation* info = outputVector->GetInformationObject(0);
    const double time = info->Has(Pipeline::UPDATE_TIME_STEP())
      ? info->Get(Pipeline::UPDATE_TIME_STEP())
      : this->Known->front().Time;
    auto step = FindStep(*this->Known, time); // this is one of the offered times
    step = step == this->Known->end() ? step - 1 : step;
    vtkPolyData* output = vtkPolyData::GetData(outputVector);
    output->Initialize(); // drops the step before, so that no more than two are in memory
    this->Error =
      FailureOf([output, step] { output->ShallowCopy(ReadParticles(step->Files, true)); });
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), step->Time);
    return this->Error.empty() ? 1 : 0;
  }
};
vtkStandardNewMacro(StoredSteps);

std::string TimeText(double time)
{
  return DigitsOf(time, 12);
}

ParticleTimes::ParticleTimes(Sharing& sharing)
  : Shared(sharing)
{
  const Job& job = sharing.Options;
  std::vector<std::string> notes;
  const bool haveTimes = IsListOfSteps(job.Inputs.front());
  this->Steps = haveTimes ? ListedSteps(job.Inputs.front(), notes) : this->GivenSteps(notes);
  for (const std::string& walls : job.Walls)
  {
    AddStepWalls(walls, haveTimes, this->Steps, notes);
  }
  this->Times = ChooseTimes(job, this->Steps);
  for (const std::string& note : notes)
  {
    if (LaunchedRank() == 0)
    {
      Say("warning: " + note);
    }
  }
  const bool wallsMove = std::any_of(this->Steps.begin(), this->Steps.end(),
    [this](const Step& step) { return step.Walls != this->Steps.front().Walls; });
  for (const double time : this->Times)
  {
    Need(!wallsMove || FindStep(this->Steps, time)->Time == time,
      "--times: " + TimeText(time) +
        " is between two steps, where walls of each step (--walls) are not known");
  }
  this->Reset();
}

std::vector<ParticleTimes::Step> ParticleTimes::GivenSteps(std::vector<std::string>& warnings)
{
  // If names differ only in numbers, the numbers tell the order: shells list tank_10 before tank_9.
  const Job& job = this->Shared.Options;
  std::vector<std::string> inputs = job.Inputs;
  if (std::all_of(inputs.begin(), inputs.end(),
        [words = Numbered(inputs.front()).first](const std::string& file)
        { return Numbered(file).first == words; }))
  {
    std::stable_sort(inputs.begin(), inputs.end(),
      [](const std::string& a, const std::string& b)
      { return Numbered(a).second < Numbered(b).second; });
  }
  std::vector<std::string> files;
  std::vector<double> times;
  for (const std::string& file : inputs)
  {
    const std::vector<double> steps = ::ListTimes(file);
    const bool isFilm = steps.size() > 1;
    for (std::size_t k = 0; k < (isFilm ? steps.size() : 1); ++k)
    {
      files.push_back(isFilm ? file + "#" + std::to_string(k) : file);
    }
    times.insert(times.end(), steps.begin(), steps.end());
  }
  const bool isGiven = job.Has("--time-step");
  Need(!isGiven || files.size() > 1,
    "--time-step is the time between one INPUT and the next, and there is one; leave it out");
  const bool areAll = times.size() == files.size();
  const bool areGood = areAll && !isGiven &&
    std::adjacent_find(times.begin(), times.end(), std::greater_equal<double>()) == times.end();
  if (!times.empty() && !areGood && !isGiven)
  {
    warnings.push_back("the times in the field data of the files " +
      std::string(areAll ? "do not ascend in the order of the steps" : "are missing in some") +
      ", so the steps have times of their own, from 0 on; --time-step sets what is between them");
  }
  this->AreTold = files.size() == 1 || isGiven || areGood;
  this->StoredStep = this->AreTold ? 0.0 : StoredTimeStep(inputs);
  const double step = this->StoredStep > 0.0 ? this->StoredStep : job.TimeStep;
  std::vector<Step> given;
  for (std::size_t i = 0; i < files.size(); ++i)
  {
    const double time = areGood ? times[i] : Rounded(static_cast<double>(i) * step);
    given.push_back({ time, { files[i] }, {} });
  }
  return given;
}

ParticleTimes::~ParticleTimes() = default;

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

void ParticleTimes::CheckFiles(const std::vector<std::string>& outputs) const
{
  std::vector<std::string> inputs = this->Shared.Options.InputFiles();
  for (const Step& step : this->Steps)
  {
    inputs.insert(inputs.end(), step.Files.begin(), step.Files.end());
    inputs.insert(inputs.end(), step.Walls.begin(), step.Walls.end());
  }
  OpenSources(inputs);
  CheckOutputs(outputs);
}

void ParticleTimes::Reset()
{
  this->Source = vtkSmartPointer<StoredSteps>::New();
  this->Source->Known = &this->Steps;
  this->Interpolator = vtkSmartPointer<vtkSPHTemporalInterpolator>::New();
  this->Interpolator->SetIdArrayName(Printable(this->Shared.Options.Text("--ids")).c_str());
  this->Interpolator->SetInputConnection(this->Source->GetOutputPort());
  const std::vector<double>& period = this->Shared.Options.Periodic;
  const double extent[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 }; // only lengths are known
  this->Interpolator->SetDetectPeriod(this->Shared.Options.DetectPeriod);
  if (!period.empty())
  {
    this->Interpolator->SetPeriodicBounds(vtkSPHBoundsOfPeriod(period, extent).data());
  }
}

void ParticleTimes::CheckTold()
{
  const Job& job = this->Shared.Options;
  const bool isOfTimes = !job.IsFilm() || job.Has("--numbers") || job.Has("--components");
  if (this->AreTold || job.HasTimes() || !isOfTimes)
  {
    return;
  }
  std::vector<std::string> told;
  const double step = this->Steps[1].Time - this->Steps[0].Time;
  if (this->Shared.GetCount() == 1 &&
    !FailureOf([&] { this->At(this->Steps[0].Time + 0.5 * step, told); }).empty())
  {
    this->Reset(); // without ids, particles cannot be matched
  }
  const double byVelocities = step * this->Interpolator->GetMotionRatio();
  if (this->Shared.IsFirst())
  {
    Say("warning: the files tell no times, so the steps are " +
      (this->StoredStep > 0.0 ? "as far apart as their 'dt' says, " + DigitsOf(this->StoredStep, 3)
                              : std::string("at 0, 1, 2, ...")) +
      "; give the time between them with --time-step" +
      (byVelocities > 0.0 ? ", which is about " + DigitsOf(byVelocities, 3) + " by '" +
            this->Interpolator->GetUsedVelocityArrayName() + "'"
                          : std::string()));
  }
}

Sharing::Particles ParticleTimes::At(double time, std::vector<std::string>& warnings)
{
  Messages() = {};
  this->Source->Error.clear();
  this->Interpolator->UpdateTimeStep(time);
  const std::string error = this->Source->Error;
  Messages().Check(error.empty() ? this->Interpolator->GetErrorMessage() : error);
  Messages().AddWarningsTo(warnings);
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  particles->ShallowCopy(this->Interpolator->GetOutput());
  const std::vector<std::string>& walls = FindStep(this->Steps, time)->Walls;
  if (this->WallFiles != walls)
  {
    this->Walls = ReadWalls(walls);
    this->WallFiles = walls;
  }
  return AddWalls(particles, this->Walls);
}

bool ParticleTimes::ForEach(const std::vector<std::string>& outputs,
  const std::function<void(Moment&)>& work, const std::function<void(const Moment&)>& miss)
{
  const Job& job = this->Shared.Options;
  const std::size_t count = this->Times.size();
  bool isGood = true;
  this->CheckTold();
  std::map<std::string, int> counts; // how often each warning came; only its first is printed
  for (std::size_t i = 0; i < count; ++i)
  {
    const double time = this->Times[i];
    const std::string at = "time " + TimeText(time);
    Moment moment = { i, time, outputs.empty() ? this->ListFiles(time).front() : outputs[i], "",
      nullptr, {}, "" };
    moment.Label += outputs.empty() && !job.HasTimes() ? "" : " (" + at + ")";
    moment.Progress = count == 1
      ? ""
      : "step " + std::to_string(i + 1) + " of " + std::to_string(count) + ", " + at + ": ";
    const Activity making(
      moment.Label + ": the run failed", FaultsOfDrivers(job.Surface->GetDevice()));
    moment.Error = FailureOf(
      [&]
      {
        const auto step = FindStep(this->Steps, time);
        const bool isOneFile =
          step->Time == time && step->Files.size() == 1 && step->Walls.empty();
        moment.Particles = this->Shared.Read(isOneFile ? step->Files.front() : "", true,
          [&] { return this->At(time, moment.Warnings); });
        work(moment);
      });
    if (!moment.Error.empty())
    {
      miss(moment);
      this->Reset();
      moment.Warnings = { moment.Error };
      isGood = false;
    }
    const std::string kind = moment.Error.empty() ? "warning: " : "";
    for (const std::string& warning : moment.Warnings)
    {
      // Warnings of gauges or sections outside of all fluid count as one warning, even if their numbers differ.
      if (this->Shared.IsFirst() &&
        ++counts[kind +
            (TellsOfDryPlaces(warning) ? "places are outside of all fluid" : warning)] == 1)
      {
        const bool isNamed =
          warning.compare(0, moment.Label.size() + 1, moment.Label + " ") == 0;
        Say(kind + (isNamed ? "" : moment.Label + ": ") + warning);
      }
    }
  }
  for (const auto& [sentence, times] : counts)
  {
    if (times > 1)
    {
      Say(std::to_string(times - 1) + (times == 2 ? " more step: " : " more steps: ") + sentence);
    }
  }
  return isGood;
}

bool TellsOfDryPlaces(const std::string& warning)
{
  const auto hasEnd = [&](const std::string& text) // the words behind the last value
  { return warning.find(text.substr(text.rfind('%') + 2)) != std::string::npos; };
  return hasEnd(mcor_text_of_PLACE_DRY) || hasEnd(mcor_text_of_PLACES_DRY);
}

bool MakeTable(Sharing& sharing, const std::string& what,
  const std::function<void(ParticleTimes::Moment& moment, std::string& text)>& addRows,
  const std::function<std::string()>& finish)
{
  const Job& job = sharing.Options;
  const bool isImage = job.Has("--gauge-grid");
  ParticleTimes times(sharing);
  const std::size_t count = times.Get().size();
  Require(!isImage || count == 1,
    "--gauge-grid takes one INPUT of one time, as its OUTPUT is one image");
  sharing.OnFirst([&] { times.CheckFiles({ job.Output }); });
  GrowingFile file(isImage ? "" : job.Output);
  std::string text;
  const bool isGood = times.ForEach({},
    [&](ParticleTimes::Moment& moment)
    {
      addRows(moment, text);
      Messages().AddWarningsTo(moment.Warnings);
      sharing.OnFirst([&] { file.Write(text, false); });
    },
    // If there is only one step, its error ends the program.
    [count](const ParticleTimes::Moment& moment) { Require(count > 1, moment.Error); });
  sharing.OnFirst(
    [&]
    {
      Require(!text.empty(), "no step could be measured, so no table was written");
      file.Write(text, true);
      const std::string more = finish();
      if (!job.Has("--quiet"))
      {
        std::cout << what << ", " << count << (count == 1 ? " step" : " steps") << more << "\n";
      }
    });
  return isGood;
}
