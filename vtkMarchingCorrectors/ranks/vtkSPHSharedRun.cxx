// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// No rank may return while another rank waits for it: all ranks first agree on any problem.
#include "vtkSPHSharedRun.h"

#include "vtkBoundingBox.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkSPHFound.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHSay.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/**
 * The margin, in cubes, around the places to evaluate. With the margin, even the box of a plane of
 * points, or of a single line, contains bricks, so that space can be divided between them.
 */
constexpr double MarginCubes = 4.0;

constexpr double Infinity = std::numeric_limits<double>::infinity();

/** The ranks' callbacks for the core. A rank that fails does not leave other ranks waiting. */
class Callbacks
{
public:
  /** `whole`: the box of all ranks; null until space is divided. */
  explicit Callbacks(vtkSPHRanks& ranks, const double* whole = nullptr)
    : Ranks(ranks)
  {
    this->Core.user = this;
    this->Core.reduce_doubles = Reduce<double>;
    this->Core.reduce_counts = Reduce<std::int64_t>;
    this->Core.gather = Gather;
    std::copy_n(whole, whole ? 6 : 0, this->Core.whole_box);
  }
  Callbacks(const Callbacks&) = delete;
  void operator=(const Callbacks&) = delete;

  /** All ranks call this after the core's call, also if the core failed. */
  void End(bool failed)
  {
    if (!this->Stopped)
    {
      this->Stopped = !this->Ranks.Stop(failed) && !failed;
    }
  }

  mcor_ranks Core = {}; ///< for mcor_options during one call of the core
  bool Stopped = false; ///< this rank was told that another one failed

private:
  template <typename T>
  static int Reduce(void* user, mcor_reduction reduction, T* values, int count)
  {
    auto* self = static_cast<Callbacks*>(user);
    const vtkSPHRanks::Operation operations[] = { vtkSPHRanks::LEAST, vtkSPHRanks::GREATEST,
      vtkSPHRanks::SUM };
    self->Stopped = self->Stopped || !self->Ranks.Reduce(operations[reduction], values, count);
    return self->Stopped ? 1 : 0;
  }

  static int Gather(void* user, const void* records, std::int64_t count, std::size_t width,
    const void** all, std::int64_t* allCount)
  {
    auto* self = static_cast<Callbacks*>(user);
    const auto* first = static_cast<const char*>(records);
    const std::size_t size = first ? static_cast<std::size_t>(count) * width : 0;
    std::vector<std::vector<char>> theirs;
    if (!self->Stopped)
    {
      theirs = self->Ranks.Gather(std::vector<char>(first, first + size));
    }
    self->Stopped = theirs.empty();
    self->Gathered.clear();
    for (const std::vector<char>& each : theirs)
    {
      self->Gathered.insert(self->Gathered.end(), each.begin(), each.end());
    }
    *all = self->Gathered.data();
    *allCount = static_cast<std::int64_t>(self->Gathered.size() / width);
    return self->Stopped ? 1 : 0;
  }

  vtkSPHRanks& Ranks;
  std::vector<char> Gathered;
};

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
  const vtkSPHPeriod mine = vtkSPHFindPeriod(data);
  vtkSPHPeriod first;
  int rank = 0, firstRank = 0;
  for (const auto& theirs : ranks.Gather(std::make_pair(mine.Period, mine.Array)))
  {
    const vtkSPHPeriod found = { theirs.first, theirs.second };
    if (first.Array.empty())
    {
      first = found;
      firstRank = rank;
    }
    else if (!found.Array.empty() && found.Period != first.Period && problem.empty())
    {
      problem = vtkSPHSay(MCOR_SAY(PERIODS_DIFFER), Describe(first).c_str(), firstRank,
        Describe(found).c_str(), rank);
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

bool vtkSPHAlgorithm::vtkSharedRun::Agree(const std::string& problem)
{
  std::string sentence = problem;
  this->Ranks.Agree(sentence);
  return this->vtkRun::Agree(sentence);
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
  const vtkSPHPeriod found =
    vtkSPHFindPeriodDistributed(controller, this->Own->GetFieldData(), problem);
  problem = problem.empty() && found.IsTilted() ? vtkSPHSay(MCOR_SAY(CELL_TILTED)) : problem;
  return vtkSPHBoundsOfPeriodDistributed(controller, found.Period, this->Own);
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
  // From now on the estimate counts as if the user had given it.
  core.smoothing_length.constant = this->Globals.measured.h_estimate;
  return good;
}

// Sets the run's box to the bounds of the places to evaluate, as far as these lie within the bounds
// of the particles, and adds a margin. Along periodic axes the box is infinite.
void vtkSPHAlgorithm::vtkSharedRun::PlaceBox(const double low[3], const double high[3])
{
  const mcor_measure& measured = this->Globals.measured;
  const vtkSPHRanksSpace space(this->Options, this->Globals);
  const double margin = MarginCubes * measured.cube;
  for (int a = 0; a < 3; ++a)
  {
    const auto clamp = [&measured, a](double x)
    { return std::min(std::max(x, measured.low[a]), measured.high[a]); };
    const bool isPeriodic = space.IsPeriodic(a);
    this->Options.box[2 * a] = isPeriodic ? -Infinity : clamp(low[a]) - margin;
    this->Options.box[2 * a + 1] = isPeriodic ? Infinity : clamp(high[a]) + margin;
  }
}

// Takes the points with finite coordinates, and sets the box around the points of all ranks.
void vtkSPHAlgorithm::vtkSharedRun::PlacePoints(vtkDataSet* data)
{
  const vtkSPHRanksSpace space(this->Options, this->Globals);
  vtkBoundingBox bounds;
  this->Numbers.clear();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType i = 0; data && i < data->GetNumberOfPoints(); ++i)
  {
    vtkSPHRanksPlace place = { {}, 1 };
    data->GetPoint(i, place.At);
    if (!std::isfinite(place.At[0]) || !std::isfinite(place.At[1]) || !std::isfinite(place.At[2]))
    {
      continue;
    }
    points->InsertNextPoint(place.At);
    this->Numbers.push_back(i);
    space.Enter(place.At);
    this->PlacesOfWork.push_back(place);
    bounds.AddPoint(place.At);
  }
  this->Places = vtkSmartPointer<vtkPolyData>::New();
  this->Places->SetPoints(points);
  double box[6];
  bounds.GetBounds(box);
  this->Ranks.ReduceRanges(box, 3);
  for (int side = 0; side < 6; ++side)
  {
    const double margin = MarginCubes * this->Globals.measured.cube;
    this->Options.box[side] = box[side] + (side % 2 == 0 ? -margin : margin);
  }
}

vtkSPHParticles* vtkSPHAlgorithm::vtkSharedRun::Share(vtkSPHParticles& mine)
{
  return this->Send(mine, vtkSPHKeepUsed(this->Own, mine), this->Ranks.GetCount());
}

vtkSPHParticles* vtkSPHAlgorithm::vtkSharedRun::Send(
  vtkSPHParticles& mine, vtkPointSet* particles, int parts)
{
  this->Work.resize(static_cast<std::size_t>(mine.Core.count), 1);
  this->Space = vtkSPHRanksSpace(this->Options, this->Globals);
  const vtkSPHRanksLists to =
    this->Space.Share(this->Ranks, mine.Core, this->Work, std::move(this->PlacesOfWork), parts);
  const auto send = [this](vtkPointSet* points, const vtkSPHRanksLists& lists)
  {
    return vtkSPHMakePoints(
      vtkSPHSendTuples(this->Ranks, vtkSPHListArrays(points), lists, &this->From), points);
  };
  this->Near = send(particles, to);
  if (this->Places)
  {
    this->Points = send(this->Places, this->Space.ListOwners(this->Places));
  }
  this->Options.globals = &this->Globals;
  const vtkSPHRanksBox box = this->Space.GetBox(this->Ranks.GetRank());
  std::copy(box.begin(), box.end(), this->Options.box);
  vtkSPHWanted wanted = mine.Wanted; // an array that was found is now known by its name
  wanted.Scalar.Name =
    wanted.Scalar.Name.empty() ? mine.NameFor(MCOR_ROLE_SCALAR) : wanted.Scalar.Name;
  this->Input = std::make_unique<vtkSPHParticles>(mine.Description, this->Near, wanted);
  const bool isUsable = this->Input->Collect();
  return this->Agree(isUsable ? "" : this->Input->Error) ? this->Input.get() : nullptr;
}

const std::uint8_t* vtkSPHAlgorithm::vtkSharedRun::MarkOwned()
{
  this->Owned.clear();
  for (vtkIdType i = 0; i < this->Near->GetNumberOfPoints(); ++i)
  {
    const int owner = this->Space.FindOwner(this->Near->GetPoint(i));
    this->Owned.push_back(owner == this->Ranks.GetRank() ? 1 : 0);
  }
  this->Owned.push_back(0); // so that the result is not null, even without particles
  return this->Owned.data();
}

bool vtkSPHAlgorithm::vtkSharedRun::Call(
  vtkSPHParticles& particles, const std::function<int(mcor_context*)>& call)
{
  const std::string machine = vtkMPIController::GetProcessorName();
  const std::vector<std::string> all = this->Ranks.Gather(machine);
  const auto place = std::count(all.begin(), all.begin() + this->Ranks.GetRank(), machine);
  const auto count = std::count(all.begin(), all.end(), machine);
  Callbacks calls(this->Ranks, this->Space.IsShared() ? this->Space.Whole.data() : nullptr);
  this->Options.ranks = &calls.Core;
  std::string message;
  const int status =
    this->CallCore(particles, call, message, static_cast<int>(place), static_cast<int>(count));
  this->Options.ranks = nullptr;
  calls.End(status != MCOR_OK);
  std::int64_t cancelled = status == MCOR_CANCELLED && !calls.Stopped ? 1 : 0;
  this->Ranks.Reduce(vtkSPHRanks::GREATEST, &cancelled, 1);
  return this->Agree(message) && cancelled == 0;
}

void vtkSPHAlgorithm::vtkSharedRun::CallAside(const std::function<bool(const mcor_ranks*)>& call)
{
  Callbacks calls(this->Ranks);
  calls.End(!call(&calls.Core));
}

// Each point was sent to one rank, its owner. A particle may be on several ranks; only its owner
// sends a result.
void vtkSPHAlgorithm::vtkSharedRun::Return(vtkPointData* found, vtkDataSet* home)
{
  vtkSPHRanksLists to =
    this->Space.ListOwners(this->Places ? this->Places.Get() : static_cast<vtkDataSet*>(this->Own));
  for (std::vector<vtkIdType>& list : to)
  {
    for (vtkIdType& i : list)
    {
      i = this->Numbers.empty() ? i : this->Numbers[static_cast<std::size_t>(i)];
    }
  }
  for (const auto& array : vtkSPHReturnTuples(this->Ranks, vtkSPHListArrays(found), this->From,
         this->Places ? nullptr : this->MarkOwned(), to, home ? home->GetNumberOfPoints() : 0))
  {
    found->AddArray(array); // replaces the array of the same name
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

void vtkSPHAlgorithm::vtkSharedRun::AddExchange()
{
  this->AddShare("RankParticles", this->Space.OwnedParticles);
  this->AddShare("RankCopies", this->Space.Particles - this->Space.OwnedParticles);
  this->AddShare("RankBytesSent", this->Ranks.GetBytesSent());
}

void vtkSPHAlgorithm::vtkSharedRun::AddShares()
{
  this->AddExchange();
  this->AddShare("RankPoints",
    this->Points ? static_cast<std::int64_t>(this->Points->GetNumberOfPoints())
                 : this->Space.OwnedParticles);
  vtkDataArray* seconds = this->Filter->RunStatistics->GetArray("Seconds");
  const int total = seconds ? seconds->GetNumberOfComponents() - 1 : 0;
  this->AddShare("RankSeconds", seconds ? seconds->GetComponent(0, total) : 0.0);
}

void vtkSPHAlgorithm::vtkSharedRun::OfAll(mcor_input& core, mcor_options& options) const
{
  core.count = this->Particles;
  core.positions.data = nullptr;
  core.solid = nullptr;
  options.globals = nullptr;
}

// A rank without points has not called the core, and has no statistics.
void vtkSPHAlgorithm::vtkSharedRun::WarnOfParticles(
  const mcor_input& core, const mcor_statistics& statistics)
{
  const std::vector<mcor_statistics> all = this->Ranks.Gather(statistics);
  const auto some = std::find_if(
    all.begin(), all.end(), [](const mcor_statistics& each) { return each.fluid_particles > 0; });
  if (this->IsFirst() && some != all.end())
  {
    mcor_input input = core;
    this->OfAll(input, this->Options); // the run no longer needs its own options
    this->vtkRun::WarnOfParticles(input, *some);
  }
}
VTK_ABI_NAMESPACE_END
