// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// No rank may return here while another goes on: all agree first on what one of them has found.
#include "vtkSPHSharedRun.h"

#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkSPHFound.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksStatistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/**
 * A margin around places, in cubes, so that even a plane of points, or a single line, has a box
 * with bricks to cut at.
 */
constexpr double MarginCubes = 4.0;

constexpr double Infinity = std::numeric_limits<double>::infinity();

std::string Describe(const vtkSPHPeriod& found)
{
  std::ostringstream text;
  const char* separator = " ";
  text << found.Array;
  for (const double number : found.Period)
  {
    text << separator << number;
    separator = ",";
  }
  return text.str();
}
}

vtkSPHPeriod vtkSPHFindPeriodDistributed(
  vtkMultiProcessController* controller, vtkFieldData* data, std::string& problem)
{
  vtkSPHRanks ranks(controller);
  vtkSPHPeriod first;
  int rank = 0, firstRank = 0;
  const vtkSPHPeriod mine = vtkSPHFindPeriod(data);
  for (const auto& theirs : ranks.Gather(std::make_pair(mine.Period, mine.Array)))
  {
    const vtkSPHPeriod found = { theirs.first, theirs.second };
    if (first.Period.empty())
    {
      first = found;
      firstRank = rank;
    }
    else if (!found.Period.empty() && found.Period != first.Period && problem.empty())
    {
      std::ostringstream text;
      text << "The field data of the processes give different periods: " << Describe(first)
           << " on rank " << firstRank << ", " << Describe(found) << " on rank " << rank << ".";
      problem = text.str();
    }
    ++rank;
  }
  return first;
}

std::vector<double> vtkSPHBoundsOfPeriodDistributed(
  vtkMultiProcessController* controller, const std::vector<double>& period, vtkPointSet* particles)
{
  vtkSPHRanks ranks(controller);
  double ends[6] = { Infinity, -Infinity, Infinity, -Infinity, Infinity, -Infinity };
  if (particles->GetNumberOfPoints() > 0)
  {
    particles->GetBounds(ends);
  }
  ranks.ReduceRanges(ends, 3);
  return vtkSPHBoundsOfPeriod(period, ends);
}

vtkSPHAlgorithm::vtkSharedRun::vtkSharedRun(vtkSPHAlgorithm* filter)
  : vtkRun(filter)
  , Ranks(filter->Controller)
{
}

bool vtkSPHAlgorithm::vtkSharedRun::Agree(const std::string& problem)
{
  std::string sentence = problem;
  const bool good = this->Ranks.Agree(sentence);
  if (!good)
  {
    this->Fail(sentence);
  }
  return good;
}

bool vtkSPHAlgorithm::vtkSharedRun::Begin(vtkPointSet* particles)
{
  this->Own = vtkSPHTakeParticles(this->Ranks, particles, *this->Filter, &this->Numbers);
  std::int64_t counts[2] = { this->Own->GetNumberOfPoints(), this->Filter->IsAborted() ? 1 : 0 };
  this->Sum(counts, 2);
  this->Particles = counts[0];
  return counts[1] == 0;
}

std::vector<double> vtkSPHAlgorithm::vtkSharedRun::FindPeriod(std::string& problem)
{
  vtkMultiProcessController* controller = this->Filter->Controller;
  return vtkSPHBoundsOfPeriodDistributed(controller,
    vtkSPHFindPeriodDistributed(controller, this->Own->GetFieldData(), problem).Period, this->Own);
}

bool vtkSPHAlgorithm::vtkSharedRun::Measure(vtkSPHParticles& particles, bool forSamples)
{
  const auto measure = forSamples ? mcor_measure_probe_globals : mcor_measure_globals;
  if (!this->SetPeriod() ||
    !this->Call(particles,
      [&](mcor_context* context)
      { return measure(context, &particles.Core, &this->Options, &this->Globals); }))
  {
    return false;
  }
  this->Options.dimension = this->Globals.measured.plane.axis > 0 ? 2 : 3;
  return true;
}

bool vtkSPHAlgorithm::vtkSharedRun::MeasureLengths(vtkSPHParticles& particles)
{
  mcor_input& core = particles.Core;
  if (!core.estimate_smoothing_length)
  {
    return this->SetPeriod();
  }
  const bool good = this->Measure(particles, true);
  core.estimate_smoothing_length = core.smoothing_length_is_support_radius = 0;
  core.smoothing_length = {};
  core.smoothing_length.constant = this->Globals.measured.h_estimate; // as if it had been given
  return good;
}

// The box ends where the particles do; along periods it is without end.
void vtkSPHAlgorithm::vtkSharedRun::PlaceBox(const double low[3], const double high[3])
{
  const mcor_measure& measured = this->Globals.measured;
  const vtkSPHRanksPeriod period(this->Options, this->Globals);
  const double margin = MarginCubes * measured.cube;
  for (int a = 0; a < 3; ++a)
  {
    const auto clamp = [&measured, a](double x)
    { return std::min(std::max(x, measured.low[a]), measured.high[a]); };
    const bool isPeriodic = period.Length[a] > 0.0;
    this->Options.box[2 * a] = isPeriodic ? -Infinity : clamp(low[a]) - margin;
    this->Options.box[2 * a + 1] = isPeriodic ? Infinity : clamp(high[a]) + margin;
  }
}

// Takes the points with finite coordinates, and the box around those of all ranks.
void vtkSPHAlgorithm::vtkSharedRun::PlacePoints(vtkDataSet* data)
{
  const vtkSPHRanksPeriod period(this->Options, this->Globals);
  double box[6] = { Infinity, -Infinity, Infinity, -Infinity, Infinity, -Infinity };
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType i = 0; data && i < data->GetNumberOfPoints(); ++i)
  {
    vtkSPHRanksPlace place;
    data->GetPoint(i, place.At);
    if (!std::isfinite(place.At[0]) || !std::isfinite(place.At[1]) || !std::isfinite(place.At[2]))
    {
      continue;
    }
    points->InsertNextPoint(place.At);
    this->PlaceNumbers.push_back(i);
    period.Take(place.At);
    place.Work = 1;
    this->Balance.Others.push_back(place);
    for (int a = 0; a < 3; ++a)
    {
      box[2 * a] = std::min(box[2 * a], place.At[a]);
      box[2 * a + 1] = std::max(box[2 * a + 1], place.At[a]);
    }
  }
  this->Places = vtkSmartPointer<vtkPolyData>::New();
  this->Places->SetPoints(points);
  this->Ranks.ReduceRanges(box, 3);
  for (int side = 0; side < 6; ++side)
  {
    const double margin = MarginCubes * this->Globals.measured.cube;
    this->Options.box[side] = box[side] + (side % 2 == 0 ? -margin : margin);
  }
}

void vtkSPHAlgorithm::vtkSharedRun::Scatter(const mcor_input& core, vtkPointSet* particles)
{
  this->Route = vtkSPHFindRoute(this->Ranks, core, this->Options, this->Globals, this->Balance);
  this->Near = vtkSPHSendParticles(this->Ranks, particles, this->Route.To, &this->From);
  this->Options.globals = &this->Globals;
  std::copy(this->Route.Box, this->Route.Box + 6, this->Options.box);
}

vtkSPHParticles* vtkSPHAlgorithm::vtkSharedRun::Share(vtkSPHParticles& mine, const Collect& collect)
{
  this->Scatter(mine.Core, vtkSPHKeepUsed(this->Own, mine));
  if (this->Places)
  {
    this->PlacesTo = this->Route.ListOwners(this->Places);
    this->Points =
      vtkSPHSendParticles(this->Ranks, this->Places, this->PlacesTo, &this->PlacesFrom);
  }
  this->Input = std::make_unique<vtkSPHParticles>(mine.Description, this->Near);
  const bool isUsable = collect(*this->Input);
  return this->Agree(isUsable ? "" : this->Input->Error) ? this->Input.get() : nullptr;
}

const std::uint8_t* vtkSPHAlgorithm::vtkSharedRun::MarkOwned()
{
  this->Owned.clear();
  for (vtkIdType i = 0; i < this->Near->GetNumberOfPoints(); ++i)
  {
    this->Owned.push_back(this->Owns(i) ? 1 : 0);
  }
  this->Owned.push_back(0); // not null where there are none
  return this->Owned.data();
}

bool vtkSPHAlgorithm::vtkSharedRun::Call(
  vtkSPHParticles& particles, const std::function<int(mcor_context*)>& call)
{
  int place, count;
  this->Ranks.FindNeighbors(place, count);
  vtkSPHRanksCalls calls(this->Ranks, this->Route.Partition ? this->Route.Whole.data() : nullptr);
  this->Options.ranks = calls.Get();
  std::string message;
  const int status = this->CallCore(particles, call, message, place, count);
  this->Options.ranks = nullptr;
  calls.End(status != MCOR_OK);
  std::int64_t cancelled = status == MCOR_CANCELLED && !calls.WasStopped() ? 1 : 0;
  this->Ranks.Reduce(vtkSPHRanks::GREATEST, &cancelled, 1);
  return this->Agree(message) && cancelled == 0;
}

void vtkSPHAlgorithm::vtkSharedRun::CallAside(const std::function<bool(const mcor_ranks*)>& call)
{
  vtkSPHRanksCalls calls(this->Ranks);
  calls.End(!call(calls.Get()));
}

bool vtkSPHAlgorithm::vtkSharedRun::Owns(vtkIdType near) const
{
  return this->Route.FindOwner(this->Near->GetPoint(near)) == this->Ranks.GetRank();
}

void vtkSPHAlgorithm::vtkSharedRun::Return(vtkPointData* found, vtkDataSet* home)
{
  // Tuples that came from one rank lie together.
  vtkSPHRanksLists back;
  vtkIdType next = 0;
  for (const vtkIdType count : this->Places ? this->PlacesFrom : this->From)
  {
    back.emplace_back();
    for (const vtkIdType end = next + count; next < end; ++next)
    {
      if (this->Places || this->Owns(next))
      {
        back.back().push_back(next);
      }
    }
  }
  vtkSPHRanksLists places = this->Places ? this->PlacesTo : this->Route.ListOwners(this->Own);
  const std::vector<vtkIdType>& numbers = this->Places ? this->PlaceNumbers : this->Numbers;
  for (std::vector<vtkIdType>& list : places)
  {
    for (vtkIdType& place : list)
    {
      place = numbers.empty() ? place : numbers[static_cast<std::size_t>(place)];
    }
  }
  const vtkSPHRanksArrays came = vtkSPHReturnTuples(
    this->Ranks, vtkSPHListArrays(found), back, places, home ? home->GetNumberOfPoints() : 0);
  for (const auto& array : came)
  {
    found->AddArray(array); // in place of that of its name
  }
}

void vtkSPHAlgorithm::vtkSharedRun::FindNotFinite(
  const vtkSPHParticles& input, std::vector<std::int64_t>& notFinite)
{
  const mcor_global_component* component = this->Globals.components;
  notFinite.clear();
  for (const vtkSPHAttribute& attribute : input.Interpolated)
  {
    notFinite.push_back(component->not_finite);
    component += attribute.Components;
  }
}

void vtkSPHAlgorithm::vtkSharedRun::AddShares()
{
  vtkSPHAddSampleShares(this->Ranks, this->Filter->RunStatistics, this->Route,
    this->Points ? this->Points->GetNumberOfPoints() : this->Route.OwnedParticles);
}

void vtkSPHAlgorithm::vtkSharedRun::OfAll(mcor_input& core, mcor_options& options) const
{
  core.count = this->Particles;
  core.positions.data = nullptr;
  core.solid = nullptr;
  options.globals = nullptr;
}

// A rank without points has called nothing, and has no statistics.
void vtkSPHAlgorithm::vtkSharedRun::WarnOfParticles(
  const mcor_input& core, const mcor_statistics& statistics)
{
  const std::vector<mcor_statistics> all = this->Ranks.Gather(statistics);
  const auto some = std::find_if(
    all.begin(), all.end(), [](const mcor_statistics& each) { return each.fluid_particles > 0; });
  if (this->IsFirst() && some != all.end())
  {
    mcor_input input = core;
    this->OfAll(input, this->Options); // the last that the run does with them
    this->vtkRun::WarnOfParticles(input, *some);
  }
}
VTK_ABI_NAMESPACE_END
