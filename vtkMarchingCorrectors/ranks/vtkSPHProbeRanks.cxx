// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// A probe that many processes share. Space around the points is divided among them; points travel to
// the rank that owns their place, particles to the ranks that they reach, and what was found there
// travels back to where the points are. A point's value does not depend on the other points.
#include "vtkSPHProbe.h"

#include "mcor.h"
#include "vtkDataSet.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksRoute.h"
#include "vtkSPHRanksStatistics.h"
#include "vtkSPHRanksTuples.h"
#include "vtkSPHSamples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace
{
using Lists = vtkSPHRanksLists;

/** Around the points, in cubes: so that a plane of them, too, has a box, and bricks to be cut at. */
constexpr double MarginCubes = 4.0;

bool IsFinite(const double at[3])
{
  return std::isfinite(at[0]) && std::isfinite(at[1]) && std::isfinite(at[2]);
}

/** The points that are somewhere, of which `home` are the numbers. */
vtkSmartPointer<vtkPolyData> TakePoints(vtkDataSet* data, std::vector<vtkIdType>& home)
{
  auto taken = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType i = 0; data && i < data->GetNumberOfPoints(); ++i)
  {
    double at[3];
    data->GetPoint(i, at);
    if (IsFinite(at))
    {
      points->InsertNextPoint(at);
      home.push_back(i);
    }
  }
  taken->SetPoints(points);
  return taken;
}

/** Around the places of all ranks. */
void FindBox(
  vtkSPHRanks& ranks, const std::vector<vtkSPHRanksPlace>& places, double margin, double box[6])
{
  const double infinity = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    box[2 * a] = infinity;
    box[2 * a + 1] = -infinity;
    for (const vtkSPHRanksPlace& place : places)
    {
      box[2 * a] = std::min(box[2 * a], place.At[a]);
      box[2 * a + 1] = std::max(box[2 * a + 1], place.At[a]);
    }
  }
  ranks.ReduceRanges(box, 3);
  for (int side = 0; side < 6; ++side)
  {
    box[side] += side % 2 == 0 ? -margin : margin;
  }
}

/** Where points are within the period. */
std::vector<vtkSPHRanksPlace> ListPlaces(vtkPolyData* points, const vtkSPHRanksPeriod& period)
{
  std::vector<vtkSPHRanksPlace> places(static_cast<std::size_t>(points->GetNumberOfPoints()));
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    points->GetPoint(static_cast<vtkIdType>(i), places[i].At);
    period.Take(places[i].At);
    places[i].Work = 1;
  }
  return places;
}

/** Of points, those that each rank owns. */
Lists ListOwners(vtkPolyData* points, const vtkSPHRanksRoute& route, int ranks)
{
  Lists owners(static_cast<std::size_t>(ranks));
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    double at[3];
    points->GetPoint(i, at);
    owners[static_cast<std::size_t>(route.FindOwner(at))].push_back(i);
  }
  return owners;
}

/** What stands at these places of the numbers. */
Lists ListAt(Lists places, const std::vector<vtkIdType>& numbers)
{
  for (std::vector<vtkIdType>& list : places)
  {
    for (vtkIdType& place : list)
    {
      place = numbers[static_cast<std::size_t>(place)];
    }
  }
  return places;
}

/** Numbers one after the other, so many for each rank. */
Lists ListInTurn(const std::vector<vtkIdType>& counts)
{
  Lists lists;
  vtkIdType next = 0;
  for (const vtkIdType count : counts)
  {
    lists.emplace_back();
    for (vtkIdType i = 0; i < count; ++i)
    {
      lists.back().push_back(next++);
    }
  }
  return lists;
}

/** As the core says of the components of the arrays. */
std::vector<std::int64_t> ListNotFinite(const vtkSPHParticles& input, const mcor_globals& globals)
{
  std::vector<std::int64_t> notFinite;
  const mcor_global_component* component = globals.components;
  for (const vtkSPHAttribute& attribute : input.Interpolated)
  {
    notFinite.push_back(component->not_finite);
    component += attribute.Components;
  }
  return notFinite;
}
}

// Nothing here may return on one rank and go on on another: what one finds, all agree on first.
void vtkSPHProbe::ProcessDistributed(vtkDataSet* points, vtkDataSet* output)
{
  vtkSPHRanks ranks(this->Controller);
  const vtkSmartPointer<vtkPolyData> own = vtkSPHTakeParticles(ranks, this->Particles);
  std::int64_t counts[3] = { own->GetNumberOfPoints(), points ? points->GetNumberOfPoints() : 0,
    this->IsAborted() ? 1 : 0 };
  ranks.Reduce(vtkSPHRanks::SUM, counts, 3);
  if (counts[2] > 0)
  {
    return;
  }
  vtkSPHParticlesChoice choice;
  this->FillChoice(choice);
  this->FindFluidDistributed(ranks, choice, own);
  vtkSPHParticles mine(choice, own);
  if (counts[0] > 0)
  {
    const bool isUsable = mine.CollectParticles();
    this->SetUsedNames(&mine);
    if (!this->AgreeDistributed(ranks, isUsable ? "" : mine.Error))
    {
      return;
    }
    if (this->InterpolateAttributes)
    {
      mine.CollectAttributes({ "WeightSum", this->ValidPointMaskArrayName });
    }
  }
  const bool hasFluid =
    counts[0] > 0 && this->HasFluidDistributed(ranks, choice, mine, "no point is valid");
  if (hasFluid && counts[1] > 0)
  {
    this->ProbeDistributed(ranks, own, mine, points, output);
  }
  else if (points && output)
  {
    mcor_options options;
    this->FillProbeOptions(options);
    const vtkSPHSamples samples(
      mine, options, this->ValidPointMaskArrayName, points->GetNumberOfPoints(), this->GetNull());
    output->ShallowCopy(points);
    samples.AddTo(output->GetPointData());
  }
}

bool vtkSPHProbe::ProbeDistributed(vtkSPHRanks& ranks, vtkPolyData* own, vtkSPHParticles& mine,
  vtkDataSet* points, vtkDataSet* output)
{
  mcor_options options;
  this->FillProbeOptions(options);
  if (!this->SetPeriodDistributed(ranks, own, options))
  {
    return false;
  }
  mcor_globals globals = {};
  const std::unique_ptr<mcor_globals, decltype(&mcor_free_globals)> freeGlobals(
    &globals, mcor_free_globals);
  if (!this->MeasureGlobalsDistributed(ranks, mine, options, true, globals))
  {
    return false;
  }
  std::vector<vtkIdType> numbers;
  const vtkSmartPointer<vtkPolyData> places = TakePoints(points, numbers);
  const std::vector<vtkSPHRanksPlace> within = ListPlaces(places, { options, globals });
  FindBox(ranks, within, MarginCubes * globals.measured.cube, options.box);
  const vtkSPHRanksRoute route =
    vtkSPHFindRoute(ranks, mine.Core, options, globals, { false, {}, within });
  const Lists to = ListOwners(places, route, ranks.GetCount());
  const vtkSmartPointer<vtkPolyData> near =
    vtkSPHSendParticles(ranks, vtkSPHKeepUsed(own, mine), route.To);
  std::vector<vtkIdType> from;
  const vtkSmartPointer<vtkPolyData> here = vtkSPHSendParticles(ranks, places, to, &from);

  vtkSPHParticles input(mine.Description, near);
  if (!this->AgreeDistributed(ranks, input.CollectParticles() ? "" : input.Error))
  {
    return false;
  }
  if (this->InterpolateAttributes)
  {
    input.CollectAttributes({ "WeightSum", this->ValidPointMaskArrayName });
  }
  options.globals = &globals;
  std::copy(route.Box, route.Box + 6, options.box);
  vtkSPHSamples samples(
    input, options, this->ValidPointMaskArrayName, here->GetNumberOfPoints(), this->GetNull());
  samples.NotFinite = ListNotFinite(input, globals);
  vtkFieldData* statistics = this->RunStatistics;
  if (!this->CallCoreDistributed(ranks, input, options,
        [&](mcor_context* context)
        { return EvaluateAt(here, context, input.Core, options, samples, statistics); }))
  {
    return false;
  }
  vtkNew<vtkPointData> found, came;
  samples.AddTo(found);
  vtkSPHReturnArrays(ranks, found, ListInTurn(from), ListAt(to, numbers),
    points ? points->GetNumberOfPoints() : 0, came);
  vtkSPHAddSampleShares(ranks, statistics, route, here->GetNumberOfPoints());
  for (const std::string& sentence : input.ListLeftOut(samples.NotFinite.data(), "the output"))
  {
    if (ranks.GetRank() == 0)
    {
      this->Warn(sentence);
    }
  }
  if (points && output)
  {
    output->ShallowCopy(points);
    for (int i = 0; i < came->GetNumberOfArrays(); ++i)
    {
      output->GetPointData()->AddArray(came->GetArray(i));
    }
    this->FinishOutput(output);
  }
  return true;
}
