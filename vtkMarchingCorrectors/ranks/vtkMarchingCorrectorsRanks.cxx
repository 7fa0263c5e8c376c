// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// A surface that several processes (ranks) share, see vtkSPHRanks.h.
#include "vtkMarchingCorrectors.h"

#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkMarchingCorrectorsInput.h"
#include "vtkMarchingCorrectorsOutput.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksSurface.h"
#include "vtkSPHSharedRun.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
template <typename T>
void Merge(vtkSPHHow how, T& all, T one)
{
  all = how == SUM ? all + one : how == MOST ? std::max(all, one) : all;
}

template <typename T, std::size_t N>
void Merge(vtkSPHHow how, T (&all)[N], const T (&one)[N])
{
  for (std::size_t i = 0; i < N; ++i)
  {
    Merge(how, all[i], one[i]);
  }
}

/** Becomes the box around both. */
void AddCells(mcor_statistics& all, const mcor_statistics& one)
{
  for (int a = 0; a < 3 && one.virtual_cells > 0; ++a)
  {
    const std::int64_t first = one.lattice_origin[a], last = first + one.lattice_cells[a];
    const bool isFirst = all.virtual_cells == 0;
    const std::int64_t end = isFirst ? last : all.lattice_origin[a] + all.lattice_cells[a];
    all.lattice_origin[a] = isFirst ? first : std::min(all.lattice_origin[a], first);
    all.lattice_cells[a] = std::max(end, last) - all.lattice_origin[a];
  }
}

/**
 * Merges statistics: sums of counts, the longest seconds, and means over all points (one rank
 * counts each point). What is evaluated on both sides of a seam counts twice among bricks, nodes
 * and evaluations.
 */
mcor_statistics MergeStatistics(const std::vector<mcor_statistics>& parts)
{
  // Takes what is global from the first rank that had work: it is the same on all of these.
  const auto known = std::find_if(
    parts.begin(), parts.end(), [](const mcor_statistics& part) { return part.cube_size > 0.0; });
  mcor_statistics all = known == parts.end() ? mcor_statistics() : *known;
  double points = 0.0, length = 0.0, squares = 0.0, vertices = 0.0, evaluations = 0.0;
  for (const mcor_statistics& one : parts)
  {
    AddCells(all, one);
    if (known != parts.end() && &one != &*known)
    {
#define STATISTIC(how, when, member, name) Merge(how, all.member, one.member);
#include "mcor_statistics.def"
    }
    const auto moved = static_cast<double>(one.correction_count);
    const auto corrected = static_cast<double>(one.vertices_corrected);
    points += moved;
    length += moved * one.correction_mean;
    squares += moved *
      (one.correction_deviation * one.correction_deviation +
        one.correction_mean * one.correction_mean);
    vertices += corrected;
    evaluations += std::round(corrected * (one.iterations_mean + 1.0)); // a whole number
  }
  points = std::max(points, 1.0);
  all.correction_mean = length / points;
  all.correction_deviation =
    std::sqrt(std::max(0.0, squares / points - all.correction_mean * all.correction_mean));
  all.iterations_mean = vertices > 0.0 ? evaluations / vertices - 1.0 : 0.0;
  return all;
}
}

// No rank may return here while another goes on: all agree first on what one of them has found.
void vtkMarchingCorrectors::ContourDistributed(vtkSharedRun& run,
  vtkMarchingCorrectorsChoice& choice, vtkMarchingCorrectorsInput& mine, vtkPolyData* output)
{
  mcor_options& options = run.Options;
  options = mcor_spell_out(&options);
  std::unique_ptr<vtkMarchingCorrectorsInput> widened;
  std::int64_t outside = 0; // of the particles that this rank was given
  if (options.widen > 1.0)
  {
    vtkNew<vtkPointData> found;
    mcor_statistics statistics = {};
    if (!this->FindWidening(run, mine, found, statistics))
    {
      return;
    }
    outside = statistics.widening_outside;
    for (int i = 0; i < found->GetNumberOfArrays(); ++i)
    {
      vtkAbstractArray* array = found->GetAbstractArray(i);
      array->SetName(vtkSPHParticles::NameMade(array->GetName()).c_str());
    }
    vtkSPHAddArrays(found, run.Own->GetPointData());
    options.widen = 1.0;
    choice.IsWidened = true;
    this->FillRequests(choice, run.Own, run.MergeRanges());
    widened = std::make_unique<vtkMarchingCorrectorsInput>(choice, run.Own);
    widened->Collect(); // as before
  }
  const vtkMarchingCorrectorsInput& own = widened ? *widened : mine;
  options.outputs |= MCOR_OUT_POINT_KEYS | MCOR_OUT_TRIANGLE_KEYS;
  options.outputs |= own.FromNearest.empty() ? 0 : MCOR_OUT_NEAREST_PARTICLE;
  if (!run.Measure(widened ? *widened : mine, false))
  {
    return;
  }
  double least = mcor_least_smoothing_length(&own.Core);
  run.Ranks.Reduce(vtkSPHRanks::LEAST, &least, 1);
  this->EstimatedCells = mcor_estimate_cells(&own.Core, &options, least);
  run.Ranks.Reduce(vtkSPHRanks::SUM, &this->EstimatedCells, 1);
  if (run.IsFirst())
  {
    this->WarnOfHugeRun();
  }
  const mcor_options whole = options;
  run.Work = this->Partition == BY_WORK
    ? vtkSPHExpectWork(run.Ranks, own.Core, options, run.Globals)
    : vtkSPHCountWork(own.Core, options);
  run.Scatter(own.Core, run.Own);
  // Arrays are found among those that came by the names of this rank's own.
  const bool isNamed =
    choice.Scalar.Name.empty() && choice.Scalar.Array && choice.Scalar.Array->GetName();
  const std::string scalarName = isNamed ? choice.Scalar.Array->GetName() : "";
  this->FillRequests(choice, run.Near);
  if (isNamed)
  {
    choice.Scalar.Array = run.Near->GetPointData()->GetAbstractArray(scalarName.c_str());
  }
  vtkMarchingCorrectorsInput input(choice, run.Near);
  if (!run.Agree(input.Collect() ? "" : input.Error))
  {
    return;
  }
  vtkSPHOwned<mcor_surface, mcor_free_surface> surface;
  if (run.Call(input,
        [&](mcor_context* context)
        { return mcor_extract(context, &input.Core, &options, &surface); }))
  {
    surface.statistics.widening_outside = outside;
    if (choice.IsWidened) // as where the core widens by itself
    {
      input.Interpolated.pop_back();
      if (surface.attribute_count > 0) // none where there was nothing to extract
      {
        std::swap(surface.widening, surface.attributes[--surface.attribute_count]);
      }
    }
    this->FinishDistributed(run, input, whole, surface, output);
  }
}

void vtkMarchingCorrectors::FinishDistributed(vtkSharedRun& run, vtkMarchingCorrectorsInput& input,
  mcor_options options, mcor_surface& surface, vtkPolyData* output)
{
  vtkSPHRanks& ranks = run.Ranks;
  const mcor_plane& plane = run.Globals.measured.plane;
  const vtkSPHRanksNumbers numbers = vtkSPHNumber(ranks, surface);
  vtkSharedRun::Shares shares = run.ListShares();
  shares.insert(shares.end(),
    { { "RankWork", run.Space.Work }, { "RankNodesEvaluated", surface.statistics.nodes_evaluated },
      { "RankTriangles", surface.triangle_count } });
  const double seconds =
    std::accumulate(surface.statistics.seconds, surface.statistics.seconds + MCOR_PHASE_COUNT, 0.0);
  surface.statistics = MergeStatistics(ranks.Gather(surface.statistics));
  const std::unique_ptr<vtkSPHRanksLines> lines = plane.axis > 0
    ? std::make_unique<vtkSPHRanksLines>(ranks, surface, numbers, plane, options.filled != 0)
    : nullptr;
  if (lines && lines->Failed)
  {
    this->Fail("Memory for the lines of all processes could not be allocated.");
    return;
  }
  if (!lines)
  {
    vtkSPHMeasure(ranks, surface, numbers.OfPoints, surface.statistics);
  }
  vtkMarchingCorrectorsOutput builder(input, options, surface);
  const std::vector<double> largest =
    ranks.Gather(builder.FindLargestFloat(this->OutputPointsPrecision));
  if (ranks.GetRank() == 0)
  {
    mcor_surface all = {};
    all.statistics = surface.statistics;
    all.point_count = numbers.Points;
    all.triangle_count = numbers.Triangles;
    all.line_count = lines ? lines->Count : 0;
    all.attribute_not_finite = surface.attribute_not_finite;
    mcor_input core = input.Core;
    mcor_options asked = options;
    run.OfAll(core, asked);
    asked.dimension = this->Dimension; // the user's choice, not what was found
    this->WarnOf(input, all, core, asked, *std::max_element(largest.begin(), largest.end()));
  }
  this->Summarize(input, options, surface.statistics);
  builder.AddRun(this->RunStatistics);
  vtkSPHAddCount(this->RunStatistics, "Points", { numbers.Points });
  vtkSPHAddCount(this->RunStatistics, "Triangles", { numbers.Triangles });
  if (lines)
  {
    vtkSPHAddCount(this->RunStatistics, "Lines", { lines->Count });
  }
  run.AddShares(shares, seconds);
  builder.BuildMesh(output, this->OutputPointsPrecision, run.MergeRanges());
  output->GetPointData()->SetGlobalIds(numbers.OfPoints);
  output->GetCellData()->SetGlobalIds(numbers.OfTriangles);
  vtkSPHMatchEmpty(ranks, output);
  if (lines)
  {
    lines->Move(ranks, output);
    vtkSPHMatchEmpty(ranks, output);
  }
}
VTK_ABI_NAMESPACE_END
