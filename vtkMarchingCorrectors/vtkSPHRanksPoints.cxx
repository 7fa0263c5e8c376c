// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksPoints.h"

#include "vtkSPHRanks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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

/** The numbers of a range of keys from `first` on, in place of the keys that each rank sent. */
std::vector<Bytes> Number(
  const std::vector<std::vector<Key>>& sent, const std::vector<Key>& distinct, std::int64_t first)
{
  std::vector<Bytes> numbers;
  for (const std::vector<Key>& keys : sent)
  {
    std::vector<std::int64_t> found(keys.size());
    auto from = distinct.begin();
    for (std::size_t i = 0; i < keys.size(); ++i)
    {
      from = std::lower_bound(from, distinct.end(), keys[i]);
      found[i] = first + (from - distinct.begin());
    }
    numbers.push_back(Pack(found.data(), found.data() + found.size()));
  }
  return numbers;
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
}

//------------------------------------------------------------------------------
// Each rank sorts a range of the keys; a rank's own keys ascend already.
vtkSmartPointer<vtkIdTypeArray> vtkSPHNumberPoints(
  vtkSPHRanks& ranks, const mcor_surface& surface, vtkIdType& total)
{
  const auto* first = reinterpret_cast<const Key*>(surface.point_keys);
  const std::vector<Key> keys(first, first + (first ? surface.point_count : 0));
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
  std::vector<Key> distinct;
  for (const Bytes& bytes : ranks.Exchange(std::move(messages)))
  {
    sent.push_back(Unpack<Key>(bytes));
    distinct.insert(distinct.end(), sent.back().begin(), sent.back().end());
  }
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  std::int64_t sum = 0;
  const std::int64_t before = CountBefore(ranks, static_cast<std::int64_t>(distinct.size()), sum);
  total = static_cast<vtkIdType>(sum);
  auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
  numbers->SetName("GlobalPointIds");
  numbers->SetNumberOfTuples(static_cast<vtkIdType>(keys.size()));
  vtkIdType* to = numbers->GetPointer(0);
  for (const Bytes& bytes : ranks.Exchange(Number(sent, distinct, before)))
  {
    const std::vector<std::int64_t> found = Unpack<std::int64_t>(bytes);
    to = std::copy(found.begin(), found.end(), to);
  }
  return numbers;
}
