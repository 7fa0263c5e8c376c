// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// A surface that several processes (ranks) share, see vtkSPHRanks.h.
#include "vtkMarchingCorrectors.h"

#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkMarchingCorrectorsOutput.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHSharedRun.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

/**
 * Merges the ranks' statistics: sums counts, keeps the greatest of times and of peaks, and takes
 * means over all points (one rank counts each point). Bricks, nodes and evaluations count twice
 * where two ranks' boxes meet and both ranks evaluate them.
 */
mcor_statistics MergeStatistics(const std::vector<mcor_statistics>& parts)
{
  // What is equal on all ranks with work, such as the cube size, comes from the first one of them.
  const auto known = std::find_if(
    parts.begin(), parts.end(), [](const mcor_statistics& part) { return part.cube_size > 0.0; });
  mcor_statistics all = known == parts.end() ? mcor_statistics() : *known;
  double points = 0.0, length = 0.0, squares = 0.0, vertices = 0.0, evaluations = 0.0;
  for (const mcor_statistics& one : parts)
  {
    for (int a = 0; a < 3 && one.virtual_cells > 0; ++a) // the box around both lattices
    {
      const bool isFirst = all.virtual_cells == 0;
      const std::int64_t first = one.lattice_origin[a], last = first + one.lattice_cells[a],
                         end = isFirst ? last : all.lattice_origin[a] + all.lattice_cells[a];
      all.lattice_origin[a] = isFirst ? first : std::min(all.lattice_origin[a], first);
      all.lattice_cells[a] = std::max(end, last) - all.lattice_origin[a];
    }
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
    // The product is a whole number, up to rounding errors.
    evaluations += std::round(corrected * (one.iterations_mean + 1.0));
  }
  points = std::max(points, 1.0);
  all.correction_mean = length / points;
  all.correction_deviation =
    std::sqrt(std::max(0.0, squares / points - all.correction_mean * all.correction_mean));
  all.iterations_mean = vertices > 0.0 ? evaluations / vertices - 1.0 : 0.0;
  return all;
}

using Key = std::array<std::uint64_t, MCOR_POINT_KEY>;
using Keys = std::vector<Key>;
using Numbers = std::vector<std::int64_t>;

/** About how many keys are sampled for each rank. With 64 samples, the ranks' numbers of keys differ by about an eighth. */
constexpr std::size_t SamplesPerRank = 64;

/** Returns the end of each rank's range of keys, except the last rank's. All ranks get the same ends. */
Keys FindEnds(vtkSPHRanks& ranks, const Keys& keys)
{
  const auto count = static_cast<std::size_t>(ranks.GetCount());
  auto all = static_cast<std::int64_t>(keys.size());
  ranks.Reduce(vtkSPHRanks::SUM, &all, 1);
  const std::size_t step = static_cast<std::size_t>(all) / (SamplesPerRank * count) + 1;
  Keys samples;
  for (std::size_t i = step / 2; i < keys.size(); i += step)
  {
    samples.push_back(keys[i]);
  }
  samples = ranks.Join(samples);
  std::sort(samples.begin(), samples.end());
  Keys ends;
  for (std::size_t rank = 1; rank < count && !samples.empty(); ++rank)
  {
    ends.push_back(samples[rank * samples.size() / count]);
  }
  return ends;
}

/**
 * Numbers the distinct keys of all ranks in order. Returns the numbers of this rank's keys in an
 * array called `name`. keys: must ascend. areCells: a key stands for a cell. It takes as many numbers
 * as the cell has triangles; this count is the key's last part. total: how many numbers all keys take.
 */
vtkSmartPointer<vtkIdTypeArray> NumberKeys(
  vtkSPHRanks& ranks, const Keys& keys, bool areCells, const char* name, vtkIdType& total)
{
  const auto numbersOf = [areCells](const Key& key)
  { return areCells ? static_cast<std::int64_t>(key.back()) : 1; };
  const Keys ends = FindEnds(ranks, keys);
  std::vector<Keys> sent(static_cast<std::size_t>(ranks.GetCount()));
  auto from = keys.begin();
  for (std::size_t rank = 0; rank < sent.size(); ++rank)
  {
    const auto to =
      rank < ends.size() ? std::lower_bound(from, keys.end(), ends[rank]) : keys.end();
    sent[rank].assign(from, to);
    from = to;
  }
  sent = ranks.Exchange(std::move(sent));
  Keys distinct;
  for (const Keys& theirs : sent)
  {
    distinct.insert(distinct.end(), theirs.begin(), theirs.end());
  }
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  Numbers first(1, 0); // the last entry follows all numbers
  for (const Key& key : distinct)
  {
    first.push_back(first.back() + numbersOf(key));
  }
  const Numbers all = ranks.Gather(first.back()); // how many numbers each rank has given
  const std::int64_t before =
    std::accumulate(all.begin(), all.begin() + ranks.GetRank(), std::int64_t(0));
  total = static_cast<vtkIdType>(std::accumulate(all.begin(), all.end(), std::int64_t(0)));
  std::vector<Numbers> answers;
  for (const Keys& theirs : sent)
  {
    answers.emplace_back();
    auto at = distinct.begin();
    for (const Key& key : theirs) // the numbers ascend
    {
      at = std::lower_bound(at, distinct.end(), key);
      answers.back().push_back(before + first[static_cast<std::size_t>(at - distinct.begin())]);
    }
  }
  auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
  numbers->SetName(name);
  auto key = keys.begin();
  for (const Numbers& found : ranks.Exchange(std::move(answers)))
  {
    for (const std::int64_t number : found)
    {
      const std::int64_t end = number + numbersOf(*key++);
      for (std::int64_t i = number; i < end; ++i)
      {
        numbers->InsertNextValue(static_cast<vtkIdType>(i));
      }
    }
  }
  return numbers;
}

/** The numbers of this rank's points and triangles in the whole surface, and how many points and triangles the whole surface has. */
struct NumbersInWhole
{
  vtkSmartPointer<vtkIdTypeArray> OfPoints, OfTriangles;
  vtkIdType Points, Triangles;
};

/**
 * Finds the number of each of this rank's points in the whole surface: the index that the point has
 * if one process makes the whole surface. Points with the same key have one number. Also finds the
 * numbers of this rank's triangles; the keys of these triangles ascend. Collective.
 */
NumbersInWhole NumberSurface(vtkSPHRanks& ranks, const mcor_surface& surface)
{
  static_assert(MCOR_TRIANGLE_KEY + 1 == MCOR_POINT_KEY, "a key and how many have it");
  const auto* first = reinterpret_cast<const Key*>(surface.point_keys);
  const Keys points(first, first + (first ? surface.point_count : 0));
  Keys cells; // all triangles of a cell are on one rank, one after the other
  const std::uint64_t* from = surface.triangle_keys;
  for (std::int64_t i = 0; from && i < surface.triangle_count; ++i, from += MCOR_TRIANGLE_KEY)
  {
    if (cells.empty() || cells.back()[0] != from[0] || cells.back()[1] != from[1])
    {
      cells.push_back({ from[0], from[1], 0 });
    }
    ++cells.back()[2];
  }
  NumbersInWhole numbers;
  numbers.OfPoints = NumberKeys(ranks, points, false, "GlobalPointIds", numbers.Points);
  numbers.OfTriangles = NumberKeys(ranks, cells, true, "GlobalCellIds", numbers.Triangles);
  return numbers;
}

/**
 * Measures area and volume of the whole surface into `statistics`. numbers: the numbers of this
 * rank's points in the whole surface. Collective.
 */
void MeasureSurface(vtkSPHRanks& ranks, const mcor_surface& surface, vtkIdTypeArray* numbers,
  mcor_statistics& statistics)
{
  mcor_measures measures = {};
  const Numbers own(numbers->GetPointer(0), numbers->GetPointer(0) + numbers->GetNumberOfTuples());
  // Area and volume are measured from the first point of the whole surface as origin.
  const auto first = std::find(own.begin(), own.end(), std::int64_t(0));
  for (int a = 0; a < 3; ++a)
  {
    measures.origin[a] = first == own.end() ? std::numeric_limits<double>::infinity()
                                            : surface.points[3 * (first - own.begin()) + a];
  }
  ranks.Reduce(vtkSPHRanks::LEAST, measures.origin, 3);
  mcor_measure_terms(&surface, &measures);
  ranks.Reduce(vtkSPHRanks::SUM, &measures.triangle_count, 1);
  ranks.Reduce(vtkSPHRanks::GREATEST, &measures.area_most, 1);
  ranks.Reduce(vtkSPHRanks::GREATEST, &measures.volume_most, 1);
  mcor_measure_sums(&surface, own.data(), &measures);
  ranks.Reduce(vtkSPHRanks::SUM, &measures.area, 1);
  ranks.Reduce(vtkSPHRanks::SUM, &measures.volume, 1);
  ranks.Reduce(vtkSPHRanks::SUM, &measures.open, 1);
  mcor_keep_measures(&measures, &statistics);
}
}

// No rank may return while another rank waits for it: all ranks first agree on any problem.
void vtkMarchingCorrectors::ContourDistributed(
  vtkSharedRun& run, vtkSPHParticles& mine, vtkPolyData* output)
{
  mcor_options& options = run.Options;
  mcor_statistics widening = {};
  const auto nameMade = [](const char* name) { return vtkSPHParticles::NameMade(name); };
  if (options.widen > 1.0)
  {
    vtkNew<vtkPointData> found;
    if (!this->FindWidening(run, mine, found, widening))
    {
      return;
    }
    mine.TakeWidening(found->GetArray("Widening"), found->GetArray("WideningVolume"));
    for (const auto& array : vtkSPHListArrays(found))
    {
      array->SetName(nameMade(array->GetName()).c_str());
    }
    vtkSPHAddArrays(found, run.Own->GetPointData());
  }
  options.outputs |= MCOR_OUT_POINT_KEYS | MCOR_OUT_TRIANGLE_KEYS;
  options.outputs |= mine.FromNearest.empty() ? 0 : MCOR_OUT_NEAREST_PARTICLE;
  if (!run.Measure(mine, false))
  {
    return;
  }
  double least = mcor_least_smoothing_length(&mine.Core);
  run.Ranks.Reduce(vtkSPHRanks::LEAST, &least, 1);
  this->EstimatedCells = mcor_estimate_cells(&mine.Core, &options, least);
  run.Ranks.Reduce(vtkSPHRanks::SUM, &this->EstimatedCells, 1);
  if (run.IsFirst())
  {
    this->WarnOfHugeRun();
  }
  const mcor_options whole = options;
  run.Work = vtkSPHExpectWork(run.Ranks, mine.Core, options, run.Globals);
  // Lines go on from rank to rank, so the first rank makes all of them.
  const bool hasLines = run.Globals.measured.plane.axis > 0;
  vtkSPHParticles* input = run.Send(mine, run.Own, hasLines ? 1 : run.Ranks.GetCount());
  if (!input)
  {
    return;
  }
  vtkPointData* const sent = run.Near->GetPointData();
  if (options.widen > 1.0)
  {
    input->TakeWidening(sent->GetArray(nameMade("Widening").c_str()),
      sent->GetArray(nameMade("WideningVolume").c_str()));
  }
  vtkSPHOwned<mcor_surface, mcor_free_surface> surface;
  if (run.Call(*input,
        [&](mcor_context* context)
        { return mcor_extract(context, &input->Core, &options, &surface); }))
  {
    mcor_add_widening(&surface.statistics, &widening);
    this->FinishDistributed(run, *input, whole, surface, output);
  }
}

void vtkMarchingCorrectors::FinishDistributed(vtkSharedRun& run, vtkSPHParticles& input,
  mcor_options options, mcor_surface& surface, vtkPolyData* output)
{
  vtkSPHRanks& ranks = run.Ranks;
  const bool hasLines = run.Globals.measured.plane.axis > 0;
  const NumbersInWhole numbers = NumberSurface(ranks, surface);
  const std::int64_t nodes = surface.statistics.nodes_evaluated;
  const double seconds =
    std::accumulate(surface.statistics.seconds, surface.statistics.seconds + MCOR_PHASE_COUNT, 0.0);
  surface.statistics = MergeStatistics(ranks.Gather(surface.statistics));
  if (!hasLines)
  {
    MeasureSurface(ranks, surface, numbers.OfPoints, surface.statistics);
  }
  std::int64_t lines = surface.line_count;
  ranks.Reduce(vtkSPHRanks::SUM, &lines, 1);
  vtkMarchingCorrectorsOutput builder(input, options, surface);
  double largest = builder.FindLargestFloat(this->OutputPointsPrecision);
  ranks.Reduce(vtkSPHRanks::GREATEST, &largest, 1);
  if (ranks.GetRank() == 0)
  {
    mcor_surface all = {};
    all.statistics = surface.statistics;
    all.point_count = numbers.Points;
    all.triangle_count = numbers.Triangles;
    all.line_count = lines;
    all.attribute_not_finite = surface.attribute_not_finite;
    mcor_input core = input.Core;
    mcor_options asked = options;
    run.OfAll(core, asked);
    asked.dimension = this->Dimension; // the user's choice counts, not what was found
    this->WarnOf(input, all, core, asked, largest);
  }
  this->Summarize(input, options, surface.statistics);
  builder.AddRun(this->RunStatistics);
  vtkSPHAdd(this->RunStatistics, "Points", numbers.Points);
  vtkSPHAdd(this->RunStatistics, "Triangles", numbers.Triangles);
  if (hasLines)
  {
    vtkSPHAdd(this->RunStatistics, "Lines", lines);
  }
  run.AddExchange();
  run.AddShare("RankWork", run.Space.Work);
  run.AddShare("RankNodesEvaluated", nodes);
  run.AddShare("RankTriangles", surface.triangle_count);
  run.AddShare("RankSeconds", seconds);
  builder.BuildMesh(output, this->OutputPointsPrecision,
    [&run](double* ranges, int count) { run.MergeRanges(ranges, count); });
  vtkIdTypeArray* const cells = numbers.OfTriangles;
  if (hasLines) // lines come before triangles
  {
    cells->SetNumberOfValues(output->GetNumberOfCells());
    std::iota(cells->Begin(), cells->End(), vtkIdType(0));
  }
  output->GetPointData()->SetGlobalIds(numbers.OfPoints);
  output->GetCellData()->SetGlobalIds(cells);
  vtkSPHMatchEmpty(this->Controller, output);
}
VTK_ABI_NAMESPACE_END
