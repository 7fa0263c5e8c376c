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

namespace
{
using Bytes = vtkSPHRanks::Bytes;
using Key = std::array<std::uint64_t, MCOR_POINT_KEY>;

/** Of all ranks' keys, for each range that a rank sorts: ranges are even up to about an eighth. */
constexpr std::int64_t Samples = 64;

template <typename T>
Bytes Pack(const T* first, const T* last)
{
  return Bytes(reinterpret_cast<const char*>(first), reinterpret_cast<const char*>(last));
}

template <typename T>
std::vector<T> Unpack(const Bytes& bytes)
{
  std::vector<T> values(bytes.size() / sizeof(T));
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(values.data()));
  return values;
}

/** Where the range of keys that each rank sorts ends: the same on all ranks. */
std::vector<Key> FindEnds(vtkSPHRanks& ranks, const std::vector<Key>& keys)
{
  const auto count = static_cast<std::size_t>(ranks.GetCount());
  const auto own = static_cast<std::int64_t>(keys.size());
  std::int64_t all = own;
  ranks.Reduce(vtkSPHRanks::SUM, &all, 1);
  const auto wanted =
    static_cast<std::size_t>(std::ceil(static_cast<double>(Samples * ranks.GetCount()) *
      static_cast<double>(own) / static_cast<double>(std::max<std::int64_t>(all, 1))));
  std::vector<Key> samples;
  for (std::size_t i = 0; i < wanted; ++i)
  {
    samples.push_back(keys[i * keys.size() / wanted]);
  }
  std::vector<Key> sampled;
  for (const Bytes& bytes : ranks.Gather(Pack(samples.data(), samples.data() + samples.size())))
  {
    const std::vector<Key> theirs = Unpack<Key>(bytes);
    sampled.insert(sampled.end(), theirs.begin(), theirs.end());
  }
  std::sort(sampled.begin(), sampled.end());
  std::vector<Key> ends;
  for (std::size_t rank = 1; rank < count && !sampled.empty(); ++rank)
  {
    ends.push_back(sampled[rank * sampled.size() / count]);
  }
  return ends;
}

using Place = std::vector<Key>::const_iterator;

/** std::lower_bound() of what is probably near the beginning. */
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

/** All keys of lists that ascend, each once. */
std::vector<Key> Merge(const std::vector<std::vector<Key>>& lists)
{
  std::vector<Key> keys;
  std::vector<std::ptrdiff_t> ends(1, 0);
  for (const std::vector<Key>& list : lists)
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

/** What numbers a key takes. */
using Weight = std::int64_t (*)(const Key& key);

/** Of a range of distinct keys the first number of each, from `first` on. */
std::vector<std::int64_t> AddUp(const std::vector<Key>& distinct, Weight weight, std::int64_t first)
{
  std::vector<std::int64_t> numbers;
  for (const Key& key : distinct)
  {
    numbers.push_back(first);
    first += weight(key);
  }
  return numbers;
}

/** The numbers of a range of keys in place of the keys that each rank sent. */
std::vector<Bytes> Number(const std::vector<std::vector<Key>>& sent,
  const std::vector<Key>& distinct, const std::vector<std::int64_t>& numbers)
{
  std::vector<Bytes> answers;
  for (const std::vector<Key>& keys : sent)
  {
    std::vector<std::int64_t> found(keys.size());
    auto from = distinct.begin();
    for (std::size_t i = 0; i < keys.size(); ++i)
    {
      from = FindAfter(from, distinct.end(), keys[i]);
      found[i] = numbers[static_cast<std::size_t>(from - distinct.begin())];
    }
    answers.push_back(Pack(found.data(), found.data() + found.size()));
  }
  return answers;
}

/** How many of all ranks' numbers are before this rank's `mine`; `total` of all. */
std::int64_t CountBefore(vtkSPHRanks& ranks, std::int64_t mine, std::int64_t& total)
{
  std::int64_t before = 0;
  const std::vector<Bytes> all = ranks.Gather(Pack(&mine, &mine + 1));
  total = 0;
  for (std::size_t rank = 0; rank < all.size(); ++rank)
  {
    const std::int64_t theirs = Unpack<std::int64_t>(all[rank]).front();
    before += static_cast<int>(rank) < ranks.GetRank() ? theirs : 0;
    total += theirs;
  }
  return before;
}

/**
 * Of each of this rank's keys, which ascend, the first of the numbers that it takes where all ranks'
 * distinct keys are numbered in order; `total` of all numbers. Each rank sorts a range of the keys.
 */
std::vector<std::int64_t> NumberKeys(
  vtkSPHRanks& ranks, const std::vector<Key>& keys, Weight weight, vtkIdType& total)
{
  const std::vector<Key> ends = FindEnds(ranks, keys);
  std::vector<Bytes> messages(static_cast<std::size_t>(ranks.GetCount()));
  const Key* from = keys.data();
  for (std::size_t rank = 0; rank < messages.size(); ++rank)
  {
    const Key* end = keys.data() + keys.size();
    const Key* to = rank < ends.size() ? std::lower_bound(from, end, ends[rank]) : end;
    messages[rank] = Pack(from, to);
    from = to;
  }
  std::vector<std::vector<Key>> sent;
  for (const Bytes& bytes : ranks.Exchange(std::move(messages)))
  {
    sent.push_back(Unpack<Key>(bytes));
  }
  const std::vector<Key> distinct = Merge(sent);
  std::int64_t mine = 0, sum = 0;
  for (const Key& key : distinct)
  {
    mine += weight(key);
  }
  const std::vector<std::int64_t> first = AddUp(distinct, weight, CountBefore(ranks, mine, sum));
  total = static_cast<vtkIdType>(sum);
  std::vector<std::int64_t> numbers;
  for (const Bytes& bytes : ranks.Exchange(Number(sent, distinct, first)))
  {
    const std::vector<std::int64_t> found = Unpack<std::int64_t>(bytes);
    numbers.insert(numbers.end(), found.begin(), found.end());
  }
  return numbers;
}

vtkSmartPointer<vtkIdTypeArray> MakeNumbers(const char* name, vtkIdType count)
{
  auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
  numbers->SetName(name);
  numbers->SetNumberOfTuples(count);
  return numbers;
}
}

vtkSmartPointer<vtkIdTypeArray> vtkSPHNumberPoints(
  vtkSPHRanks& ranks, const mcor_surface& surface, vtkIdType& total)
{
  const auto* first = reinterpret_cast<const Key*>(surface.point_keys);
  const std::vector<Key> keys(first, first + (first ? surface.point_count : 0));
  const std::vector<std::int64_t> found = NumberKeys(
    ranks, keys, [](const Key&) { return std::int64_t(1); }, total);
  auto numbers = MakeNumbers("GlobalPointIds", static_cast<vtkIdType>(found.size()));
  std::copy(found.begin(), found.end(), numbers->GetPointer(0));
  return numbers;
}

// A cell's triangles are on one rank, beside each other: one key tells of all.
vtkSmartPointer<vtkIdTypeArray> vtkSPHNumberTriangles(
  vtkSPHRanks& ranks, const mcor_surface& surface, vtkIdType& total)
{
  static_assert(MCOR_TRIANGLE_KEY + 1 == MCOR_POINT_KEY, "a key and how many have it");
  const std::uint64_t* from = surface.triangle_keys;
  const vtkIdType count = from ? surface.triangle_count : 0;
  std::vector<Key> cells;
  for (vtkIdType i = 0; i < count; ++i, from += MCOR_TRIANGLE_KEY)
  {
    if (cells.empty() || cells.back()[0] != from[0] || cells.back()[1] != from[1])
    {
      cells.push_back({ from[0], from[1], 0 });
    }
    ++cells.back()[2];
  }
  const std::vector<std::int64_t> found = NumberKeys(
    ranks, cells, [](const Key& cell) { return static_cast<std::int64_t>(cell[2]); }, total);
  auto numbers = MakeNumbers("GlobalCellIds", count);
  vtkIdType* to = numbers->GetPointer(0);
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    std::iota(to, to + cells[i][2], static_cast<vtkIdType>(found[i]));
    to += cells[i][2];
  }
  return numbers;
}

void vtkSPHMeasure(vtkSPHRanks& ranks, const mcor_surface& surface, vtkIdTypeArray* numbers,
  mcor_statistics& statistics)
{
  mcor_measures measures = {};
  const std::vector<std::int64_t> own(
    numbers->GetPointer(0), numbers->GetPointer(0) + numbers->GetNumberOfTuples());
  const auto first = std::find(own.begin(), own.end(), std::int64_t(0)); // of all
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
