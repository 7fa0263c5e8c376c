// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// A probe that ranks share. Space around the points is divided. Points are sent to the rank that
// owns their place, particles to the ranks that they reach, and the results back to where the
// points are. The value at a point does not depend on other points.
#include "vtkSPHProbe.h"

#include "mcor.h"
#include "vtkDataSet.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksRun.h"
#include "vtkSPHRanksStatistics.h"
#include "vtkSPHRanksTuples.h"
#include "vtkSPHSamples.h"

#include <algorithm>
#include <cmath>
#include <limits>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/**
 * A margin around the points, in cubes, so that even a plane of points has a box with bricks to
 * cut at.
 */
constexpr double MarginCubes = 4.0;

bool IsFinite(const double at[3])
{
  return std::isfinite(at[0]) && std::isfinite(at[1]) && std::isfinite(at[2]);
}

/** Takes the points with finite coordinates; `home` lists their numbers. */
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

/** Finds the box around the places of all ranks. */
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

/** Lists where the points are within the period. */
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

/** Lists successive numbers, so many for each rank. */
vtkSPHRanksLists ListInTurn(const std::vector<vtkIdType>& counts)
{
  vtkSPHRanksLists lists;
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

/** Lists what the core says of the arrays' components. */
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

// No rank may return here while another goes on: all agree first on what one of them has found.
void vtkSPHProbe::ProcessDistributed(vtkDataSet* points, vtkDataSet* output)
{
  vtkSPHRanksRun run(this->Controller);
  if (!this->BeginDistributed(run, this->Particles))
  {
    return;
  }
  std::int64_t pointCount = points ? points->GetNumberOfPoints() : 0;
  run.Ranks.Reduce(vtkSPHRanks::SUM, &pointCount, 1);
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, run.Own, run.Ranks.MergeRanges());
  vtkSPHParticles mine(choice, run.Own);
  if (run.Particles > 0)
  {
    if (!this->AcceptDistributed(run, mine, mine.CollectParticles(), "no point is valid"))
    {
      return;
    }
    if (this->InterpolateAttributes)
    {
      mine.CollectAttributes({ "WeightSum", this->ValidPointMaskArrayName });
    }
  }
  if (run.HasFluid && pointCount > 0)
  {
    this->ProbeDistributed(run, mine, points, output);
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

void vtkSPHProbe::ProbeDistributed(
  vtkSPHRanksRun& run, vtkSPHParticles& mine, vtkDataSet* points, vtkDataSet* output)
{
  mcor_options& options = run.Options;
  this->FillProbeOptions(options);
  if (!this->MeasureDistributed(run, mine, true))
  {
    return;
  }
  std::vector<vtkIdType> numbers, from;
  const vtkSmartPointer<vtkPolyData> places = TakePoints(points, numbers);
  const std::vector<vtkSPHRanksPlace> within = ListPlaces(places, { options, run.Globals });
  FindBox(run.Ranks, within, MarginCubes * run.Globals.measured.cube, options.box);
  this->ShareDistributed(run, mine.Core, vtkSPHKeepUsed(run.Own, mine), { {}, within });
  const vtkSPHRanksLists to = run.Route.ListOwners(places);
  const vtkSmartPointer<vtkPolyData> here = vtkSPHSendParticles(run.Ranks, places, to, &from);
  vtkSPHParticles input(mine.Description, run.Near);
  if (!this->AgreeDistributed(run.Ranks, input.CollectParticles() ? "" : input.Error))
  {
    return;
  }
  if (this->InterpolateAttributes)
  {
    input.CollectAttributes({ "WeightSum", this->ValidPointMaskArrayName });
  }
  vtkSPHSamples samples(
    input, options, this->ValidPointMaskArrayName, here->GetNumberOfPoints(), this->GetNull());
  samples.NotFinite = ListNotFinite(input, run.Globals);
  vtkFieldData* statistics = this->RunStatistics;
  if (!this->CallCoreDistributed(run, input,
        [&](mcor_context* context)
        { return EvaluateAt(here, context, input.Core, options, samples, statistics); }))
  {
    return;
  }
  vtkNew<vtkPointData> found;
  samples.AddTo(found);
  const vtkSPHRanksArrays came = vtkSPHReturnTuples(run.Ranks, vtkSPHListArrays(found),
    ListInTurn(from), vtkSPHListAt(to, numbers), points ? points->GetNumberOfPoints() : 0);
  vtkSPHAddSampleShares(run.Ranks, statistics, run.Route, here->GetNumberOfPoints());
  this->WarnOfParticlesDistributed(run, input.Core, samples.Statistics);
  for (const std::string& sentence : input.ListLeftOut(samples.NotFinite.data(), "the output"))
  {
    if (run.Ranks.GetRank() == 0)
    {
      this->Warn(sentence);
    }
  }
  if (points && output)
  {
    output->ShallowCopy(points);
    for (const auto& array : came)
    {
      output->GetPointData()->AddArray(array);
    }
    this->FinishOutput(output);
  }
}
VTK_ABI_NAMESPACE_END
