// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksPoints.h"

#include "mcor_parts.h"
#include "vtkSPHRanks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Key = std::array<std::uint64_t, MCOR_POINT_KEY>;
using Keys = std::vector<Key>;
using Numbers = std::vector<std::int64_t>;

/** Samples per rank's range of keys: ranges come out even within about an eighth. */
constexpr std::int64_t Samples = 64;

/** Finds where the range of keys of each rank ends; the same on all ranks. */
Keys FindEnds(vtkSPHRanks& ranks, const Keys& keys)
{
  const auto count = static_cast<std::size_t>(ranks.GetCount());
  const auto own = static_cast<std::int64_t>(keys.size());
  std::int64_t all = own;
  ranks.Reduce(vtkSPHRanks::SUM, &all, 1);
  const auto wanted =
    static_cast<std::size_t>(std::ceil(static_cast<double>(Samples * ranks.GetCount()) *
      static_cast<double>(own) / static_cast<double>(std::max<std::int64_t>(all, 1))));
  Keys samples;
  for (std::size_t i = 0; i < wanted; ++i)
  {
    samples.push_back(keys[i * keys.size() / wanted]);
  }
  Keys sampled;
  for (const Keys& theirs : ranks.Gather(samples))
  {
    sampled.insert(sampled.end(), theirs.begin(), theirs.end());
  }
  std::sort(sampled.begin(), sampled.end());
  Keys ends;
  for (std::size_t rank = 1; rank < count && !sampled.empty(); ++rank)
  {
    ends.push_back(sampled[rank * sampled.size() / count]);
  }
  return ends;
}

using Place = Keys::const_iterator;

/** std::lower_bound() for a key that is probably near the beginning. */
Place FindAfter(Place begin, Place end, const Key& key)
{
  std::ptrdiff_t step = 1;
  while (step < end - begin && begin[step - 1] < key)
  {
    begin += step;
    step *= 2;
  }
  return std::lower_bound(begin, begin + std::min(step, end - begin), key);
}

/** Merges ascending lists; each key remains once. */
Keys Merge(const std::vector<Keys>& lists)
{
  Keys keys;
  std::vector<std::ptrdiff_t> ends(1, 0);
  for (const Keys& list : lists)
  {
    keys.insert(keys.end(), list.begin(), list.end());
    ends.push_back(static_cast<std::ptrdiff_t>(keys.size()));
  }
  for (std::size_t step = 1; step < lists.size(); step *= 2)
  {
    for (std::size_t i = 0; i + step < lists.size(); i += 2 * step)
    {
      const std::size_t end = std::min(i + 2 * step, lists.size());
      std::inplace_merge(
        keys.begin() + ends[i], keys.begin() + ends[i + step], keys.begin() + ends[end]);
    }
  }
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

/** Returns how many numbers a key takes. */
using Weight = std::int64_t (*)(const Key& key);

/** Replaces the keys that each rank has sent by their numbers. */
std::vector<Numbers> Number(
  const std::vector<Keys>& sent, const Keys& distinct, const Numbers& numbers)
{
  std::vector<Numbers> answers;
  for (const Keys& keys : sent)
  {
    answers.emplace_back();
    auto from = distinct.begin();
    for (const Key& key : keys)
    {
      from = FindAfter(from, distinct.end(), key);
      answers.back().push_back(numbers[static_cast<std::size_t>(from - distinct.begin())]);
    }
  }
  return answers;
}

/**
 * Numbers the distinct keys of all ranks in order, and returns the numbers of this rank's keys,
 * which must ascend. total: how many numbers there are. Each rank sorts a range of the keys.
 */
vtkSmartPointer<vtkIdTypeArray> NumberKeys(
  vtkSPHRanks& ranks, const Keys& keys, Weight weight, const char* name, vtkIdType& total)
{
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
  const Keys distinct = Merge(sent);
  Numbers first(1, 0); // and, last, the number behind them
  for (const Key& key : distinct)
  {
    first.push_back(first.back() + weight(key));
  }
  const Numbers all = ranks.Gather(first.back()); // how many numbers each rank has given
  const std::int64_t before =
    std::accumulate(all.begin(), all.begin() + ranks.GetRank(), std::int64_t(0));
  total = static_cast<vtkIdType>(std::accumulate(all.begin(), all.end(), std::int64_t(0)));
  for (std::int64_t& number : first)
  {
    number += before;
  }
  auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
  numbers->SetName(name);
  auto key = keys.begin();
  for (const Numbers& found : ranks.Exchange(Number(sent, distinct, first)))
  {
    for (const std::int64_t number : found)
    {
      const std::int64_t count = weight(*key++);
      for (std::int64_t i = 0; i < count; ++i)
      {
        numbers->InsertNextValue(static_cast<vtkIdType>(number + i));
      }
    }
  }
  return numbers;
}
}

// All triangles of a cell are on one rank, one behind the other, so one key stands for them all.
vtkSPHRanksNumbers vtkSPHNumber(vtkSPHRanks& ranks, const mcor_surface& surface)
{
  static_assert(MCOR_TRIANGLE_KEY + 1 == MCOR_POINT_KEY, "a key and how many have it");
  const auto* first = reinterpret_cast<const Key*>(surface.point_keys);
  const Keys points(first, first + (first ? surface.point_count : 0));
  Keys cells;
  const std::uint64_t* from = surface.triangle_keys;
  for (std::int64_t i = 0; from && i < surface.triangle_count; ++i, from += MCOR_TRIANGLE_KEY)
  {
    if (cells.empty() || cells.back()[0] != from[0] || cells.back()[1] != from[1])
    {
      cells.push_back({ from[0], from[1], 0 });
    }
    ++cells.back()[2];
  }
  vtkSPHRanksNumbers numbers;
  numbers.OfPoints = NumberKeys(
    ranks, points, [](const Key&) { return std::int64_t(1); }, "GlobalPointIds", numbers.Points);
  numbers.OfTriangles = NumberKeys(
    ranks, cells, [](const Key& cell) { return static_cast<std::int64_t>(cell[2]); },
    "GlobalCellIds", numbers.Triangles);
  return numbers;
}

void vtkSPHMeasure(vtkSPHRanks& ranks, const mcor_surface& surface, vtkIdTypeArray* numbers,
  mcor_statistics& statistics)
{
  mcor_measures measures = {};
  const Numbers own(numbers->GetPointer(0), numbers->GetPointer(0) + numbers->GetNumberOfTuples());
  const auto first =
    std::find(own.begin(), own.end(), std::int64_t(0)); // the first point of the whole surface
  for (int a = 0; a < 3; ++a)
  {
    measures.origin[a] = first == own.end() ? std::numeric_limits<double>::infinity()
                                            : surface.points[3 * (first - own.begin()) + a];
  }
  ranks.Reduce(vtkSPHRanks::LEAST, measures.origin, 3);
  mcor_measure_terms(&surface, &measures);
  ranks.Reduce(vtkSPHRanks::SUM, &measures.triangle_count, 1);
  double most[2] = { measures.area_most, measures.volume_most };
  ranks.Reduce(vtkSPHRanks::GREATEST, most, 2);
  measures.area_most = most[0];
  measures.volume_most = most[1];
  mcor_measure_sums(&surface, own.data(), &measures);
  double sums[2] = { measures.area, measures.volume };
  ranks.Reduce(vtkSPHRanks::SUM, sums, 2);
  measures.area = sums[0];
  measures.volume = sums[1];
  ranks.Reduce(vtkSPHRanks::SUM, &measures.open, 1);
  mcor_keep_measures(&measures, &statistics);
}
VTK_ABI_NAMESPACE_END
